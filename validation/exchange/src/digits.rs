//! Digits of submitted numbers: rates over a short time, and equality to round-off, need all digits of a
//! double.

use touchstone_harness::foreign::{ForeignParticle, Frame};

/// Numbers with at most this many digits count as rounded: of unrounded numbers one in 10⁵ is as short.
const FEW: usize = 11;
/// Number of different rounded values that exclude a coincidence.
const DIFFERENT: usize = 3;
/// Bounds up to this one are bounds of round-off.
pub const ROUND_OFF: f64 = 1e-6;

/// A column of particles: its name and its value for a particle, NaN if the particle has none.
type Column = (&'static str, fn(&ForeignParticle) -> f64);

const COLUMNS: [Column; 5] = [
    ("x", |of| of.position.x),
    ("y", |of| of.position.y),
    ("u", |of| of.velocity.x),
    ("v", |of| of.velocity.y),
    ("density", |of| of.density.unwrap_or(f64::NAN)),
];

/// Digits of a number in its shortest exact text, as a double or as a float of 4 bytes.
fn digits(value: f64) -> usize {
    let short = value as f32;
    let text = if f64::from(short) == value { format!("{short:e}") } else { format!("{value:e}") };
    let mantissa = text.split('e').next().unwrap_or_default();
    mantissa.bytes().filter(u8::is_ascii_digit).count()
}

/// Describes the first column of a frame whose numbers all have few digits. Numbers equal to the start's,
/// which may be round, do not count.
pub fn few(frame: &Frame, start: &dyn Fn(u32) -> Option<ForeignParticle>) -> Option<String> {
    COLUMNS.into_iter().find_map(|(name, value)| {
        let moved = frame.particles.iter().filter_map(|placed| {
            let (now, before) = (value(placed), value(&start(placed.id)?));
            (now != before && now.is_finite() && now != 0.0).then_some(now)
        });
        let (mut most, mut different) = (0, Vec::new());
        for value in moved {
            most = most.max(digits(value));
            if most > FEW {
                return None;
            }
            if different.len() < DIFFERENT && !different.contains(&value) {
                different.push(value);
            }
        }
        (different.len() == DIFFERENT)
            .then(|| format!("all digits of {name}, which has at most {most}"))
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    /// Places of a lattice are round: they are no rounding of a file as long as nothing has moved.
    #[test]
    fn numbers_of_the_start_say_nothing_of_digits() {
        let x = |id: u32| 0.25 * f64::from(id);
        let moving = |id: u32, u: f64| ForeignParticle {
            id,
            position: Vector2::new(x(id), 0.0),
            velocity: Vector2::new(f64::from(id) * u, 0.0),
            density: Some(1000.0),
        };
        let start = |id: u32| Some(moving(id, 0.0));
        let frame =
            |u: f64| Frame { time: 1.0, particles: (0..9).map(|id| moving(id, u)).collect() };
        assert_eq!(few(&frame(1.0 / 3.0), &start), None);
        let of_halves = few(&frame(0.5), &start);
        assert_eq!(of_halves.as_deref(), Some("all digits of u, which has at most 2"));
    }

    #[test]
    fn digits_of_decimals_and_of_short_floats_are_counted() {
        let third = 1.0 / 3.0;
        for (value, expected) in [
            (0.25, 2),
            (-1500.0, 2),
            (third, 16),
            (f64::from(1.0_f32 / 3.0), 8),
            (0.3333333, 7),
            (1e300, 1),
            (-1.000002e-7, 7),
        ] {
            assert_eq!(digits(value), expected, "{value}");
        }
    }
}
