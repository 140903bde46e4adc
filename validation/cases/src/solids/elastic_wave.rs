//! Waves of an elastic solid on a lattice against the gradient symbol: both moduli, exactly.
//!
//! Stress and strain rate are sums with one symbol g(k), so that on a stress-free lattice a longitudinal wave
//! has ω² = |g|² (K + 4μ/3)/ρ and a transverse one ω² = |g|² μ/ρ, for any kernel. The leapfrog turns by θ a
//! step, 2 sin(θ/2) = ω dt, which is divided out.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
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

use super::solid::{Material, limits};

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
    Variants::of(|m: &Method<Symmetric>, s: &WaveSettings| {
        Ok(Wave { settings: s.clone(), method: m.clone() })
    })
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
impl WaveSettings {
    /// The scene: a lattice with a cosine of velocity.
    fn parts(&self, method: &Method<Symmetric>) -> Parts<Symmetric> {
        let places = touchstone_solver::lattice(Vector2::repeat(0.5 * DX), DX, N, N).enumerate();
        let wave = places.map(|(k, x)| {
            let velocity = self.direction() * (AMPLITUDE * cos(phase(k)));
            Particle::fluid(x, velocity, RUBBER.density, DX * DX)
        });
        let medium = RUBBER.medium(&method.properties, [DX, self.h_over_dx * DX]);
        Parts::new(medium, Domain::torus(1.0, 1.0), wave.collect())
    }

    /// Direction of the particles' motion in a wave along x.
    fn direction(&self) -> Vector2<f64> {
        if self.transverse { Vector2::y() } else { Vector2::x() }
    }

    /// ω of the wave, from the gradient symbol.
    fn frequency(&self, method: &Method<Symmetric>) -> f64 {
        let h = self.h_over_dx / N as f64;
        let lattice = method.properties.square([self.h_over_dx, 0.0]);
        let g = lattice.gradient(Vector2::new(TAU / N as f64, 0.0)).norm() / h;
        let Material { bulk, shear, .. } = RUBBER;
        let modulus = if self.transverse { shear } else { bulk + 4.0 / 3.0 * shear };
        g * modulus.sqrt()
    }

    /// A fiftieth of the period of the wave.
    fn rules(&self, method: &Method<Symmetric>) -> Rules {
        let dt = 0.02 / self.frequency(method) * TAU;
        let step = Step { dt, number: 0.02, by: "period" };
        let medium = RUBBER.medium(&method.properties, [DX, self.h_over_dx / N as f64]);
        let limits = limits(&method.properties, &RUBBER, &medium, self.h_over_dx, 0.0);
        let end = dt * STEPS as f64;
        Rules { step, limits, sound_speed: RUBBER.sound_speed(), end }
    }
}

/// Phase of particle `k` in the wave \[rad\].
fn phase(k: usize) -> f64 {
    TAU * (k % N) as f64 / N as f64
}

/// A run of a wave.
struct Wave {
    settings: WaveSettings,
    method: Method<Symmetric>,
}

impl Problem for Wave {
    type Extra = Symmetric;
    type Simulation = dyn Stepper<Symmetric>;
    type Watch = Watch;

    fn method(&self) -> &Method<Symmetric> {
        &self.method
    }

    fn brief(&self) -> Brief {
        let rules = self.settings.rules(&self.method);
        let h_over_dx = self.settings.h_over_dx;
        let medium = RUBBER.medium(&self.method.properties, [DX, h_over_dx * DX]);
        Brief::new(medium, rules, (N * N) as f64, "h_over_dx")
            .numbers(&[("h/dx", h_over_dx), (PLANNED_DT, rules.dt())])
    }

    fn times(&self) -> Vec<f64> {
        vec![self.settings.rules(&self.method).end]
    }

    fn scene(&self) -> Result<Parts<Symmetric>, RunError> {
        Ok(self.settings.parts(&self.method))
    }

    fn watch(&self, _: &Snapshot<Symmetric>, _: &Snapshot<Symmetric>) -> Watch {
        Watch { direction: self.settings.direction(), amplitudes: Vec::new() }
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls.every_step_of_ours("projection", |_, watch, simulation| watch.after_step(simulation))
    }

    fn measure(&self, watch: Watch, end: &Snapshot<Symmetric>, record: &mut Record) {
        if end.simulation().is_err() {
            return record.leave_out(FREQUENCY_ERROR, Absent::EveryStep);
        }
        let dt = self.settings.rules(&self.method).dt();
        let turn = self.settings.frequency(&self.method) * dt;
        record.put(FREQUENCY_ERROR, (2.0 * sin(0.5 * watch.angle()) / turn - 1.0).abs());
    }
}

/// Projections of the velocities on the wave.
#[derive(Serialize, Deserialize)]
struct Watch {
    direction: Vector2<f64>,
    amplitudes: Vec<f64>,
}

impl Watch {
    /// θ of a step, from a fit to all steps.
    fn angle(&self) -> f64 {
        let (mut forward, mut square) = (0.0, 0.0);
        for a in self.amplitudes[..self.amplitudes.len().saturating_sub(1)].windows(3) {
            forward += a[1] * (a[0] + a[2]);
            square += a[1] * a[1];
        }
        acos(0.5 * forward / square)
    }

    fn after_step(&mut self, simulation: &dyn Stepper<Symmetric>) {
        let particles = simulation.particles();
        let part =
            |(k, p): (usize, &Particle<Symmetric>)| p.velocity.dot(&self.direction) * cos(phase(k));
        self.amplitudes.push(particles.iter().enumerate().map(part).sum());
    }
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
