//! Particles on a lattice: waves, stability limits of the time step, extreme settings.

pub(crate) mod extremes;
pub(crate) mod operators;
pub(crate) mod resting_box;
pub(crate) mod wave;

use nalgebra::Vector2;
use touchstone_harness::prelude::*;

/// A periodic square with this side \[m\] and n × n particles. `start` gives a particle's place and velocity
/// from its place on the lattice, first counted in spacings and then in metres.
fn torus(
    (side, n): (f64, usize),
    medium: Medium,
    mut start: impl FnMut(Vector2<f64>, Vector2<f64>) -> (Vector2<f64>, Vector2<f64>),
) -> Parts {
    let Medium { dx, density, .. } = medium;
    let places = touchstone_solver::lattice(Vector2::repeat(0.5 * dx), dx, n, n);
    let labels = touchstone_solver::lattice(Vector2::zeros(), 1.0, n, n);
    let particle = |(label, place)| {
        let (place, velocity) = start(label, place);
        Particle::fluid(place, velocity, density, dx * dx)
    };
    let particles = labels.zip(places).map(particle).collect();
    Parts::new(medium, Domain::torus(side, side), particles)
}

#[cfg(test)]
mod tests {
    use touchstone_harness::{
        case::{Case, Tier},
        make::BatchOptions,
        runs::Judged,
        suite,
    };

    /// The judgements of the quick tier of some cases.
    pub fn judged(cases: &[&'static dyn Case]) -> Vec<Judged> {
        let sources = |_: &str| String::new();
        let making = BatchOptions::new(Tier::Quick, &sources);
        suite::run(cases, &making).judged().map(|of| of.judged.clone()).collect()
    }
}
