//! The look of a curve by its subject, a variant or a code: one colour in all figures of a page.

use touchstone_report::{
    Colour, Dash, Look, Series,
    Shape::{self, Circle, Diamond, Down, Square, Triangle},
};

use Dash::{Dashed, Dotted, Solid};

/// Names with their looks. Variants that are drawn together differ in colour, or, if one is the other with
/// other walls, in the line.
const KNOWN: [(&str, Colour, Dash, Shape); 31] = [
    ("recommended", Colour::BLUE, Solid, Circle),
    ("the paper's", Colour::VERMILLION, Dashed, Square),
    ("modern", Colour::BLUE, Solid, Circle),
    ("curved", Colour::BLUE, Solid, Circle),
    ("mirrored", Colour::BLUE, Solid, Circle),
    ("lagrangian", Colour::BLUE, Solid, Circle),
    ("seed", Colour::VERMILLION, Dashed, Square),
    ("carried", Colour::GREEN, Solid, Triangle),
    ("consistent", Colour::PURPLE, Dashed, Diamond),
    ("plain", Colour::ORANGE, Dotted, Down),
    ("bare", Colour::PURPLE, Dotted, Down),
    ("interface-wall", Colour::SKY, Dashed, Triangle),
    ("extrapolating-wall", Colour::BROWN, Dotted, Circle),
    ("single-sweep", Colour::BROWN, Dotted, Diamond),
    ("wendland-leapfrog", Colour::GREEN, Dotted, Triangle),
    ("stiff", Colour::BLACK, Dashed, Down),
    ("leapfrog", Colour::GREEN, Dashed, Triangle),
    ("componentwise", Colour::PURPLE, Dotted, Diamond),
    ("corrected", Colour::SKY, Dotted, Down),
    ("modern-interface", Colour::BLUE, Dotted, Circle),
    ("seed-interface", Colour::VERMILLION, Dotted, Square),
    ("consistent-interface", Colour::PURPLE, Dotted, Diamond),
    ("ours", Colour::BLACK, Solid, Circle),
    ("DualSPHysics", Colour::BLUE, Solid, Circle),
    ("JAX-SPH", Colour::VERMILLION, Dashed, Square),
    ("LAMMPS", Colour::GREEN, Solid, Triangle),
    ("PySPH", Colour::PURPLE, Dashed, Diamond),
    ("SPHinXsys", Colour::ORANGE, Dotted, Down),
    ("TrixiParticles.jl", Colour::SKY, Dashed, Triangle),
    ("pySPlisHSPlasH", Colour::BROWN, Solid, Square),
    ("salva2d", Colour::SKY, Dotted, Diamond),
];

/// The look of curves of a variant or a code; for any other subject, of the `k`th of many curves.
pub fn look_of(subject: &str, k: usize) -> Look {
    let cycled = Series::line("", Vec::new()).cycle(k).look;
    let known = KNOWN.iter().find(|known| known.0 == subject);
    known.map_or(cycled, |&(_, colour, dash, shape)| Look {
        colour,
        line: Some(dash),
        marker: Some(shape),
        open: dash != Solid,
        ..cycled
    })
}

/// A line with markers that is named after its subject, in its look; see [`look_of`].
pub fn line(subject: &str, points: Vec<(f64, f64)>, k: usize) -> Series {
    Series { look: look_of(subject, k), ..Series::line(subject, points) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variant_has_one_colour_at_any_place() {
        let looks = [look_of("seed", 0), look_of("seed", 5)];
        assert_eq!(looks[0], looks[1]);
        assert_ne!(looks[0].colour, look_of("modern", 0).colour);
        assert_ne!(look_of("νt/L² = 1", 0), look_of("νt/L² = 1", 1));
        for (k, known) in KNOWN.iter().enumerate() {
            assert!(KNOWN[..k].iter().all(|other| other.0 != known.0), "{} twice", known.0);
        }
    }
}
