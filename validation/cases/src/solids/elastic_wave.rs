//! Waves of an elastic solid on a lattice against the gradient symbol: both moduli, exactly.
//!
//! Stress and strain rate are sums with one symbol g(k), so that on a stress-free lattice a longitudinal wave
//! has ω² = |g|² (K + 4μ/3)/ρ and a transverse one ω² = |g|² μ/ρ, for any kernel. The leapfrog turns by θ a
//! step, 2 sin(θ/2) = ω dt, which is divided out.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use touchstone_base::{
    absent::Absent,
    functions::{acos, cos, sin},
};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Statement, Step},
    rules::PLANNED_DT,
    snapshot::Snapshot,
    table::{Row, Table},
};
use touchstone_solver::{CubicSpline, Kernel, Symmetric};

use super::solid::{Material, limits, medium_of};

touchstone_base::settings! {
    /// Settings of a wave along x on a lattice of the unit square.
    pub struct WaveSettings {
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.8..=3.0 = 1.5,
        /// particles move across the wave
        transverse: bool = false,
    }
}

/// Waves of rubber.
pub static ELASTIC_WAVE: Composed<WaveSettings> = Composed {
    name: NAME,
    problem: "A small wave in rubber",
    recommended: Recommended {
        variant: CubicSpline::NAME,
        because: "the only variant; it follows lattice theory to round-off",
        papers: None,
    },
    about: "The frequency of an infinitesimal wave in rubber on a stress-free lattice is known exactly \
            from the gradient symbol of the kernel. The shear modulus is 0.22 K, the wave has 16 \
            particles, and the effect of the time step is divided out.",
    variants,
    facts: || Facts {
        statement: Statement::new("There is no surface: x and y are periodic.", &[ALL]),
        stepwise: &[FREQUENCY_ERROR],
        ..Facts::default()
    },
    studies: |tier| Studies::judging(table(tier).plan()),
};

const NAME: &str = "elastic_wave";

touchstone_base::metrics! {
    all ALL;
    FREQUENCY_ERROR = "frequency_error" ["-"]
        "|omega - theory|/theory, the time step divided out; theory: |g| (K + 4 mu/3)^(1/2) along, |g| \
         mu^(1/2) across, over rho^(1/2)";
}

fn variants() -> Compositions<WaveSettings> {
    let equations = "equations (9) to (12), leapfrog, cubic spline: does the method have both moduli of the \
                     material?";
    Variants::of(|m, s| Ok(Wave::new(m, s)))
        .with(CubicSpline::NAME, equations, touchstone_schemes::solid::bare(), |_| {})
        .all
}

/// Particles along each side of the unit square, and their spacing.
const N: usize = 16;
const DX: f64 = 1.0 / N as f64;
/// Velocity amplitude \[c₀\]: nonlinear effects are below the round-off of the density.
const AMPLITUDE: f64 = 1e-6;
/// Density and K are 1, the shear modulus is the rubber rings'.
const RUBBER: Material = Material { density: 1.0, bulk: 1.0, shear: 0.22 };
/// Steps of a wave.
const STEPS: usize = 400;

/// Phase of particle `k` in the wave \[rad\].
fn phase(k: usize) -> f64 {
    TAU * (k % N) as f64 / N as f64
}

/// A run of a wave.
struct Wave {
    method: Method<Symmetric>,
    h_over_dx: f64,
    /// Direction of the particles' motion in a wave along x.
    direction: Vector2<f64>,
    /// ω of the wave, from the gradient symbol.
    frequency: f64,
    medium: Medium,
    /// A step is a fiftieth of the period of the wave.
    rules: Rules,
}

impl Wave {
    fn new(method: &Method<Symmetric>, s: &WaveSettings) -> Self {
        let (h_over_dx, h, properties) = (s.h_over_dx, s.h_over_dx * DX, &method.properties);
        let direction = if s.transverse { Vector2::y() } else { Vector2::x() };
        let lattice = properties.square(h_over_dx, 0.0);
        let g = lattice.gradient(Vector2::new(TAU / N as f64, 0.0)).norm() / h;
        let Material { bulk, shear, .. } = RUBBER;
        let modulus = if s.transverse { shear } else { bulk + 4.0 / 3.0 * shear };
        let frequency = g * modulus.sqrt();
        let step = Step { dt: 0.02 / frequency * TAU, number: 0.02, by: "period" };
        let medium = medium_of(&RUBBER, properties, DX, h);
        let limits = limits(properties, &RUBBER, &medium, h_over_dx, 0.0);
        let (sound_speed, end) = (RUBBER.sound_speed(), step.dt * STEPS as f64);
        let rules = Rules { step, limits, sound_speed, end };
        Self { method: method.clone(), h_over_dx, direction, frequency, medium, rules }
    }
}

impl Problem for Wave {
    type Extra = Symmetric;
    type Simulation = dyn Stepper<Symmetric>;
    /// Projections of the velocities on the wave.
    type Watch = Vec<f64>;

    fn method(&self) -> &Method<Symmetric> {
        &self.method
    }

    fn brief(&self) -> Brief {
        Brief::new(self.medium, self.rules, (N * N) as f64, "h_over_dx")
            .numbers(&[("h/dx", self.h_over_dx), (PLANNED_DT, self.rules.dt())])
    }

    fn scene(&self) -> Result<Parts<Symmetric>, RunError> {
        let places = touchstone_solver::lattice(Vector2::repeat(0.5 * DX), DX, N, N).enumerate();
        let wave = places.map(|(k, x)| {
            let velocity = self.direction * (AMPLITUDE * cos(phase(k)));
            Particle::fluid(x, velocity, RUBBER.density, DX * DX)
        });
        Ok(Parts::new(self.medium, Domain::torus(1.0, 1.0), wave.collect()))
    }

    fn watch(&self, _: &Snapshot<Symmetric>, _: &Snapshot<Symmetric>) -> Vec<f64> {
        Vec::new()
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls.every_step_of_ours("projection", |wave, amplitudes, simulation| {
            let along = |p: &Particle<Symmetric>| p.velocity.dot(&wave.direction);
            let all = simulation.particles();
            amplitudes.push(all.iter().enumerate().map(|(k, p)| along(p) * cos(phase(k))).sum());
        })
    }

    fn measure(&self, amplitudes: Vec<f64>, end: &Snapshot<Symmetric>, record: &mut Record) {
        if end.simulation().is_err() {
            return record.leave_out(FREQUENCY_ERROR, Absent::EveryStep);
        }
        let turn = self.frequency * self.rules.dt();
        record.put(FREQUENCY_ERROR, (2.0 * sin(0.5 * angle(&amplitudes)) / turn - 1.0).abs());
    }
}

/// θ of a step, from a fit to all steps.
fn angle(amplitudes: &[f64]) -> f64 {
    let (mut forward, mut square) = (0.0, 0.0);
    for a in amplitudes[..amplitudes.len().saturating_sub(1)].windows(3) {
        forward += a[1] * (a[0] + a[2]);
        square += a[1] * a[1];
    }
    acos(0.5 * forward / square)
}

/// Every run: waves along and across.
fn table(tier: Tier) -> Table<WaveSettings, ()> {
    let wave = |s: &mut WaveSettings, (h_over_dx, transverse)| {
        (s.h_over_dx, s.transverse) = (h_over_dx, transverse);
    };
    let values = [(1.2, false), (1.2, true), (1.5, false), (1.5, true)];
    let mut table = Table::new(&ELASTIC_WAVE, tier);
    table.over((), &[CubicSpline::NAME], [&values; 2], wave);
    table.judge(gates);
    table
}

fn gates(row: &Row<WaveSettings, ()>) -> Vec<Gate> {
    let because = "On a stress-free lattice the gradient symbol of the kernel is exact. The fit over 400 \
                   steps leaves 1e-9, and round-off of the strain 1e-7.";
    let kind = if row.settings.transverse { "transverse" } else { "longitudinal" };
    let id = format!("elastic_waves.{}.h{}.{kind}", row.variant, row.settings.h_over_dx);
    vec![Gate::new(id, FREQUENCY_ERROR, Bound::Below(1e-6), Evidence::Theory, because)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_harness::case::{Case, Planned};
    use touchstone_harness::context::Context;

    #[test]
    fn waves_of_rubber_have_the_symbols_of_the_lattice() {
        for Planned { spec, gates, .. } in table(Tier::Quick).plan() {
            let record = ELASTIC_WAVE.run(&spec, &Context::default()).expect("a run");
            for gate in gates {
                let judgement = gate.judge_record(&record);
                assert!(!judgement.verdict.is_failure(), "{}: {:?}", gate.id, judgement.value);
            }
        }
    }
}
