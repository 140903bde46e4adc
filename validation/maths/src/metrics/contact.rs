//! Phases of contact of a body, from the velocity of its centre.

/// One phase of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPhase {
    /// Mass of the body times the change of its velocity.
    pub impulse: f64,
    /// When 1 and 99 % of it have passed.
    pub times: [f64; 2],
    /// Does it end before the run does?
    pub is_over: bool,
}

/// Shares of a phase's impulse whose times are kept.
const SHARES: [f64; 2] = [0.01, 0.99];
/// Force, over the largest, above which bodies touch; pause that ends a phase \[L/c₀\].
const TOUCH: f64 = 0.01;
const PAUSE: f64 = 5.0;

impl ContactPhase {
    /// The phases in which the force on a body, in units of its mass, is above 1 % of its largest and above
    /// `least`, with pauses of less than 5 L/c0 bridged, as in `references/rubber_rings`; from (t, v) of
    /// every sample and the mass.
    pub fn all(samples: &[(f64, f64)], mass: f64, least: f64) -> Vec<Self> {
        let force = |w: &[(f64, f64)]| (w[1].1 - w[0].1) / (w[1].0 - w[0].0);
        let forces: Vec<f64> = samples.windows(2).map(force).collect();
        let least = (TOUCH * forces.iter().copied().fold(0.0, f64::max)).max(least);
        let mut spans: Vec<[usize; 2]> = Vec::new();
        for k in (0..forces.len()).filter(|&k| forces[k] > least) {
            match spans.last_mut() {
                Some([_, end]) if samples[k].0 - samples[*end].0 < PAUSE => *end = k + 1,
                _ => spans.push([k, k + 1]),
            }
        }
        let phase = |[start, end]: [usize; 2]| {
            let is_over = end + 1 < samples.len();
            Self { is_over, ..Self::of(&samples[start..=end], mass) }
        };
        spans.into_iter().map(phase).collect()
    }

    fn of(samples: &[(f64, f64)], mass: f64) -> Self {
        let (first, last) = (samples[0].1, samples[samples.len() - 1].1);
        let times = SHARES.map(|share| {
            let wanted = first + share * (last - first);
            let crossing = samples.windows(2).find(|w| w[0].1 < wanted && w[1].1 >= wanted);
            crossing.map_or(f64::NAN, |w| {
                let part = (wanted - w[0].1) / (w[1].1 - w[0].1);
                w[0].0 + part * (w[1].0 - w[0].0)
            })
        });
        Self { impulse: mass * (last - first), times, is_over: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A constant force from 20 to 30 with a pause of 2, a rest of 10, and one from 40 until the end.
    #[test]
    fn short_pauses_are_bridged_and_a_phase_until_the_end_is_not_over() {
        let velocity = |t: f64| match t {
            ..20.0 => -1.0,
            ..24.0 => -1.0 + 0.1 * (t - 20.0),
            ..26.0 => -0.6,
            ..30.0 => -0.6 + 0.1 * (t - 26.0),
            ..40.0 => -0.2,
            _ => -0.2 + 0.1 * (t - 40.0),
        };
        let samples: Vec<(f64, f64)> =
            (0..=200).map(|k| 0.25 * f64::from(k)).map(|t| (t, velocity(t))).collect();
        let [first, second] = ContactPhase::all(&samples, 3.0, 1e-9)[..] else { panic!("two") };
        assert!((first.impulse - 3.0 * 0.8).abs() < 1e-12 && first.is_over);
        let [early, late] = first.times;
        assert!((early - 20.08).abs() < 1e-9 && (late - 29.92).abs() < 1e-9, "{early} {late}");
        assert!((second.impulse - 3.0).abs() < 1e-9 && !second.is_over);
    }
}
