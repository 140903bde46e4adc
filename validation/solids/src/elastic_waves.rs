//! Waves of an elastic solid on a lattice against the gradient symbol: both moduli, exactly.
//!
//! Stress and strain rate are both sums of the same symbol g(k), so that on a stress-free lattice a
//! longitudinal wave has ω² = |g|² (K + 4μ/3)/ρ and a transverse one ω² = |g|² μ/ρ, whatever the
//! kernel. The leapfrog turns by θ a step, 2 sin(θ/2) = ω dt, which is divided out.

use nalgebra::Vector2;
use solver::{
    CauchyStress, Compose, Continuity, CubicSpline, Domain, Flow, JaumannRate, Kernel, Leapfrog,
    Linear, Observer, Open, Particle, QuinticSpline, Scene, Scheme, Simulation, Symmetric,
    WendlandC2,
};
use std::f64::consts::TAU;

use base::gate::{Bound, Evidence, Gate};
use harness::suite::Study;
use maths::theory::lattice::SquareLattice;
use report::{Cell, Column, Table};

/// The scheme: no more than the equations (9) to (12).
pub type Plain<K> =
    Compose<K, CauchyStress<Linear>, (Continuity, JaumannRate), Open, Leapfrog, Symmetric>;

/// Particles along each side of the unit square.
const N: usize = 16;
/// Velocity amplitude \[c₀\]: what is not linear is smaller than round-off of the density.
const AMPLITUDE: f64 = 1e-6;
/// Shear modulus of the rubber rings \[K\].
const SHEAR_MODULUS: f64 = 0.22;
const STEPS: usize = 400;

/// One wave along x.
#[derive(Clone, Copy, Debug)]
pub struct ElasticWave {
    /// Whether particles move across the wave.
    pub is_transverse: bool,
    /// Smoothing length \[dx\].
    pub h_over_dx: f64,
}

impl ElasticWave {
    fn phase(&self, k: usize) -> f64 {
        TAU * (k % N) as f64 / N as f64
    }

    fn direction(&self) -> Vector2<f64> {
        if self.is_transverse { Vector2::y() } else { Vector2::x() }
    }

    /// The lattice with a cosine of velocity.
    pub fn scene<K: Kernel>(&self) -> Scene<Plain<K>> {
        let dx = 1.0 / N as f64;
        let places = solver::lattice(Vector2::repeat(0.5 * dx), dx, N, N);
        let particles = places.enumerate().map(|(k, place)| {
            let velocity = self.direction() * (AMPLITUDE * self.phase(k).cos());
            Particle::fluid(place, velocity, 1.0, dx * dx)
        });
        let eos = Linear { density: 1.0, sound_speed: 1.0 };
        let drift = (Continuity, JaumannRate { shear_modulus: SHEAR_MODULUS });
        let stress = CauchyStress { eos, tensile: () };
        let h = self.h_over_dx * dx;
        Scene::new(h, Domain::torus(1.0, 1.0), particles.collect(), stress, drift, Open)
    }

    /// |ω − theory|/theory of a scene of this wave; NaN for one that is no wave.
    pub fn frequency_error<S: Scheme<Extra = Symmetric>>(&self, scene: Scene<S>) -> f64 {
        let lattice = SquareLattice::<S::Kernel>::new(self.h_over_dx, 0.0);
        let h = self.h_over_dx / N as f64;
        let g = lattice.gradient(Vector2::new(TAU / N as f64, 0.0)).norm() / h;
        let modulus =
            if self.is_transverse { SHEAR_MODULUS } else { 1.0 + 4.0 / 3.0 * SHEAR_MODULUS };
        let omega = g * modulus.sqrt();
        let dt = 0.02 / omega * TAU;
        let mut watch = Watch { wave: *self, amplitudes: Vec::new() };
        let Ok(mut simulation) = scene.build() else { return f64::NAN };
        let _outcome = simulation.advance(dt * STEPS as f64, dt, &mut watch);
        let (mut forward, mut square) = (0.0, 0.0);
        for a in watch.amplitudes[..watch.amplitudes.len().saturating_sub(1)].windows(3) {
            forward += a[1] * (a[0] + a[2]);
            square += a[1] * a[1];
        }
        let theta = (0.5 * forward / square).acos();
        (2.0 * (0.5 * theta).sin() / (omega * dt) - 1.0).abs()
    }
}

/// A block of rubber under a little stress, S = s (1, -1), that begins to turn with ω: its stress has to
/// turn with it, dSˣʸ/dt = 2 ω s, times the factor of gradients on the lattice.
#[derive(Clone, Copy, Debug)]
pub struct Turning {
    /// Smoothing length \[dx\].
    pub h_over_dx: f64,
}

impl Turning {
    /// So small that no force moves anything within a step \[K\].
    const STRESS: f64 = 1e-6;
    /// ω dt of the one step: the error of the angle is its square.
    const ANGLE: f64 = 1e-5;

    /// The block about the origin, ω = 1.
    pub fn scene<K: Kernel>(&self) -> Scene<Plain<K>> {
        let side = N + 1;
        let dx = 1.0 / side as f64;
        let deviator = Symmetric { xx: Self::STRESS, yy: -Self::STRESS, xy: 0.0 };
        let corner = Vector2::repeat(-0.5 * dx * (side - 1) as f64);
        let particles = solver::lattice(corner, dx, side, side).map(|place| {
            let velocity = Vector2::new(-place.y, place.x);
            Particle { extra: deviator, ..Particle::fluid(place, velocity, 1.0, dx * dx) }
        });
        let eos = Linear { density: 1.0, sound_speed: 1.0 };
        let drift = (Continuity, JaumannRate { shear_modulus: SHEAR_MODULUS });
        let stress = CauchyStress { eos, tensile: () };
        let h = self.h_over_dx * dx;
        Scene::new(h, Domain::open(), particles.collect(), stress, drift, Open)
    }

    /// |turn of the stress in the middle − theory|/theory after one step.
    pub fn error<S: Scheme<Extra = Symmetric>>(&self, scene: Scene<S>) -> f64 {
        let factor = SquareLattice::<S::Kernel>::new(self.h_over_dx, 0.0).gradient_factor();
        let middle = scene.particles.len() / 2;
        let Ok(mut simulation) = scene.build() else { return f64::NAN };
        let _outcome = simulation.advance(Self::ANGLE, Self::ANGLE, &mut ());
        let turned = simulation.particles()[middle].extra.xy;
        (turned / (2.0 * Self::STRESS * Self::ANGLE * factor) - 1.0).abs()
    }

    /// The gate on it.
    pub fn gate(&self) -> Gate {
        let id = format!("elastic_waves.cubic.h{}.turning", self.h_over_dx);
        let because = "the Jaumann rate turns the stress with the body, by the factor of gradients on a \
                       lattice; one step of 1e-5 leaves 1e-10, and round-off of the strain 1e-7";
        Gate::new(id, "turning_error", Bound::Below(1e-6), Evidence::Theory, because)
    }
}

/// Projections of the velocities on the wave.
struct Watch {
    wave: ElasticWave,
    amplitudes: Vec<f64>,
}

impl<S: Scheme<Extra = Symmetric>> Observer<S> for Watch {
    fn after_step(&mut self, simulation: &Simulation<S>) -> Flow {
        let direction = self.wave.direction();
        let particles = simulation.particles();
        let part = |(k, p): (usize, &Particle<Symmetric>)| {
            p.velocity.dot(&direction) * self.wave.phase(k).cos()
        };
        self.amplitudes.push(particles.iter().enumerate().map(part).sum());
        Flow::Continue
    }
}

/// The gate on the frequency of a wave.
pub fn gate(kernel: &str, wave: &ElasticWave) -> Gate {
    let kind = if wave.is_transverse { "transverse" } else { "longitudinal" };
    let id = format!("elastic_waves.{kernel}.h{}.{kind}", wave.h_over_dx);
    let because = "the gradient symbol is exact on a stress-free lattice; at amplitude 1e-6 what is not \
                   linear is of order 1e-12, and the fit over 400 steps leaves 1e-9 or less";
    Gate::new(id, "frequency_error", Bound::Below(1e-6), Evidence::Theory, because)
}

/// The study.
pub fn study() -> Study {
    let columns = vec![
        Column::text("kernel"),
        Column::num("h/dx", "-"),
        Column::text("wave"),
        Column::num("relative error", "-"),
    ];
    let caption = "Waves of rubber (shear modulus 0.22 K) along a stress-free lattice of 16 particles, with \
                   the time step divided out: frequency against the gradient symbol. Last: how far the \
                   stress of a block turns with it.";
    let mut table = Table::new(caption, columns);
    let mut study = Study::new("elastic-waves", "Elastic waves on a lattice");
    for is_transverse in [false, true] {
        let wave = |h_over_dx| ElasticWave { is_transverse, h_over_dx };
        let errors = [
            (
                CubicSpline::NAME,
                wave(1.5),
                wave(1.5).frequency_error(wave(1.5).scene::<CubicSpline>()),
            ),
            (
                CubicSpline::NAME,
                wave(1.2),
                wave(1.2).frequency_error(wave(1.2).scene::<CubicSpline>()),
            ),
            (
                QuinticSpline::NAME,
                wave(1.0),
                wave(1.0).frequency_error(wave(1.0).scene::<QuinticSpline>()),
            ),
            (
                WendlandC2::NAME,
                wave(1.5),
                wave(1.5).frequency_error(wave(1.5).scene::<WendlandC2>()),
            ),
        ];
        for (kernel, wave, error) in errors {
            table = table.row(vec![
                Cell::text(kernel),
                Cell::num(wave.h_over_dx, 2),
                Cell::text(if is_transverse { "transverse" } else { "longitudinal" }),
                Cell::sci(error, 2),
            ]);
            study = study.judge(gate(kernel, &wave), error);
        }
    }
    let turning = Turning { h_over_dx: 1.5 };
    let error = turning.error(turning.scene::<CubicSpline>());
    table = table.row(vec![
        Cell::text(CubicSpline::NAME),
        Cell::num(turning.h_over_dx, 2),
        Cell::text("stress of a turning block"),
        Cell::sci(error, 2),
    ]);
    study.judge(turning.gate(), error).block(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_of_rubber_have_the_symbols_of_the_lattice() {
        for judged in study().judged {
            let value = judged.judgement.value;
            assert!(!judged.judgement.verdict.is_failure(), "{}: {value:?}", judged.gate.id);
        }
    }
}
