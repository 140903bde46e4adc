//! The cost of a run, estimated before its first step.

use std::f64::consts::PI;
use std::fmt;

use touchstone_report::{seconds, sig};
use touchstone_solver::{Numbers, Stepper};

/// Processor time of a step for one particle \[s\]. Over all compositions and both integrators (a
/// predictor-corrector visits its pairs as often as a leapfrog), the ratio of actual to estimated time is
/// within 0.5 and 1.9 for 90 % of the runs of the full tier of 0.05 s or more, and within 0.3 and 4.5 for
/// all, on a processor with AVX-512; the ratio of the sums is 0.81.
const STEP_OF_PARTICLE: f64 = 1e-7;
/// Processor time of a step for each neighbour of a particle \[s\].
const STEP_OF_NEIGHBOUR: f64 = 2.5e-9;
/// Memory of the stored data of one step, including its text in the record \[bytes\].
const SAMPLE: f64 = 200.0;
/// Processor time above which a run is refused \[s\].
pub const MOST_SECONDS: f64 = 24.0 * 3600.0;
/// Memory above which a run is refused \[bytes\].
pub const MOST_BYTES: f64 = 4e9;

/// Memory of a particle \[bytes\], within a factor of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Storage {
    /// The particle without its neighbours.
    pub particle: f64,
    /// Each of its neighbours.
    pub neighbour: f64,
}

impl Storage {
    /// Memory of schemes: eight particles share a list of neighbours.
    pub const LISTS: Self = Self { particle: 400.0, neighbour: 0.75 };
}

/// The cost of a run, estimated before its first step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Time steps.
    pub steps: f64,
    /// Particles, including wall particles.
    pub particles: f64,
    /// Particles whose pairs are summed: wall particles are neighbours, and few of them sum over neighbours.
    pub summed: f64,
    /// Neighbours of a particle.
    pub neighbours: f64,
    /// Pair sweeps of a step.
    pub sweeps: f64,
    /// Steps that leave data in the record.
    pub samples: f64,
    /// Memory of a particle.
    pub storage: Storage,
}

impl Size {
    /// The cost of these steps of these particles, with a kernel that reaches over `reach` spacings.
    pub fn new(steps: f64, particles: f64, reach: f64) -> Self {
        let (summed, neighbours) = (particles, PI * reach * reach);
        let storage = Storage::LISTS;
        Self { steps, particles, summed, neighbours, sweeps: 2.0, samples: 0.0, storage }
    }

    /// The cost of these steps of a simulation, with the reach of its kernel.
    pub fn of<X: Numbers>(simulation: &dyn Stepper<X>, steps: f64) -> Self {
        let particles = simulation.data().fluid_count() + simulation.data().walls().len();
        let spacing = simulation.data().fluid().next().map_or(1.0, |(m, p)| (m / p.density).sqrt());
        let reaches =
            |tenths: &i32| simulation.weight((0.1 * f64::from(*tenths) * spacing).powi(2)) > 0.0;
        let reach = 0.1 * f64::from((1..300).take_while(reaches).count() as i32);
        let summed = simulation.data().fluid_count() as f64;
        Self { summed, ..Self::new(steps, particles as f64, reach) }
    }

    /// Pair interactions.
    pub fn pairs(&self) -> f64 {
        self.sweeps * self.steps * self.summed * self.neighbours
    }

    /// Processor time \[s\].
    pub fn seconds(&self) -> f64 {
        let particles = self.sweeps * self.steps * self.particles * STEP_OF_PARTICLE;
        0.5 * (particles + self.pairs() * STEP_OF_NEIGHBOUR)
    }

    /// Memory \[bytes\].
    pub fn bytes(&self) -> f64 {
        let Storage { particle, neighbour } = self.storage;
        self.particles * (particle + neighbour * self.neighbours) + SAMPLE * self.samples
    }

    /// Whether it exceeds the limit of a run without explicit permission.
    pub fn is_too_much(&self) -> bool {
        let is_within = self.seconds() <= MOST_SECONDS && self.bytes() <= MOST_BYTES;
        !is_within // so is a size that is not a number
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { steps, particles, .. } = self;
        let (steps, particles) = (sig(steps.ceil(), 3), sig(particles.ceil(), 3));
        let (time, memory) = (seconds(self.seconds()), sig(1e-6 * self.bytes(), 2));
        write!(
            f,
            "{steps} time steps of {particles} particles, about {time} on one core and {memory} MB"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs of the full tier: steps, particles, half of the pair interactions of a step and a particle,
    /// processor seconds, bytes of the solver.
    const RUNS: [[f64; 5]; 8] = [
        [16000.0, 480.0, 25.3, 0.85, 281156.0],  // couette plain
        [35558.0, 400.0, 18.1, 1.36, 231812.0],  // couette seed
        [1938.0, 1800.0, 27.2, 0.69, 924924.0],  // dam_break modern
        [2800.0, 1096.0, 27.9, 0.77, 469016.0],  // rubber_rings seed
        [1e6, 49.0, 24.0, 4.34, 27700.0],        // extremes pressed
        [4430.0, 2518.0, 28.2, 3.13, 1064208.0], // periodic_hill carried
        [2800.0, 4392.0, 23.0, 2.88, 1966800.0], // rubber_rings seed
        [6959.0, 640.0, 46.6, 0.48, 389300.0],   // poiseuille wendland-leapfrog
    ];

    #[test]
    fn an_estimate_is_right_within_a_factor_of_three() {
        for [steps, particles, neighbours, seconds, bytes] in RUNS {
            let reach = (neighbours / PI).sqrt();
            let size = Size::new(steps, particles, reach);
            let (time, memory) = (size.seconds() / seconds, size.bytes() / bytes);
            assert!((1.0 / 3.0..3.0).contains(&time), "{size}: {time}");
            assert!((0.4..2.5).contains(&memory), "{size}: {memory}");
        }
    }

    #[test]
    fn what_is_too_much_is_told_in_hours_and_megabytes() {
        let long = Size::new(8e14, 32.0, 2.4);
        assert!(long.is_too_much() && long.to_string().contains("\u{a0}h on one core"), "{long}");
        let large = Size::new(1.0, 2e7, 3.0);
        assert!(large.is_too_much() && large.to_string().ends_with(" MB"), "{large}");
        let sampled = Size::new(1e8, 16.0, 2.4);
        assert!(!sampled.is_too_much());
        assert!(Size { samples: 1e8, ..sampled }.is_too_much());
        assert!(Size::new(f64::NAN, 1.0, 2.0).is_too_much());
    }
}
