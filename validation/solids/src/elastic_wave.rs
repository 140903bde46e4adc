//! Waves of an elastic solid on a lattice against the gradient symbol: both moduli, exactly.
//!
//! Stress and strain rate are both sums of the same symbol g(k), so that on a stress-free lattice a
//! longitudinal wave has ω² = |g|² (K + 4μ/3)/ρ and a transverse one ω² = |g|² μ/ρ, whatever the
//! kernel. The leapfrog turns by θ a step, 2 sin(θ/2) = ω dt, which is divided out.

use nalgebra::Vector2;
use solver::{
    CauchyStress, Compose, Continuity, CubicSpline, Domain, Flow, JaumannRate, Kernel, Leapfrog,
    Linear, Observer, Open, Particle, QuinticSpline, Scene, Scheme, Stepper, Symmetric, WendlandC2,
};
use std::f64::consts::TAU;

use base::{
    gate::{Bound, Evidence, Gate},
    number,
    record::{Cost, MetricKey, Record, Status},
    spec::RunSpec,
};
use harness::{
    case::{Planned, RunError, Variant},
    composed::{Composed, Composition},
    declare::Declaration,
    runner::{self, Context},
    runs::Runs,
    study::Study,
};
use maths::theory::lattice::SquareLattice;
use report::{Cell, Column, Table};

base::settings! {
    /// Settings of a wave along x on a lattice of the unit square.
    pub struct WaveSettings {
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.8..=3.0 = 1.5,
        /// particles move across the wave
        transverse: bool = false,
        /// in place of a wave: a block under a little stress begins to rotate
        rotation: bool = false,
    }
}

/// Waves of rubber.
pub static ELASTIC_WAVE: Composed<WaveSettings> = Composed {
    name: NAME,
    about: "A wave of rubber (shear modulus 0.22 K) of infinitesimal amplitude along a stress-free lattice \
            of 16 particles: its frequency is known exactly from the gradient symbol of the kernel, once the \
            time step is divided out. In place of a wave: a block under a little stress that begins to \
            rotate, whose stress has to rotate with it.",
    variants,
    is_stable: |record| record.status == Status::Completed,
    declaration: |_| Declaration::default(),
    plan: |_| plan(),
    studies: |_, runs| vec![study(runs)],
};

const NAME: &str = "elastic_wave";

base::metrics! {
    FREQUENCY_ERROR = "frequency_error" ["-"]
        "|omega - theory|/theory, the time step divided out; theory: |g| (K + 4 mu/3)^(1/2) along, |g| \
         mu^(1/2) across, over rho^(1/2)";
    TURNING_ERROR = "turning_error" ["-"]
        "|S_xy - theory|/theory in the middle after one step; theory: 2 omega s dt times the factor of \
         gradients on the lattice";
}

fn variants() -> Vec<Composition<WaveSettings>> {
    fn variant<K: Kernel>(about: &'static str) -> Composition<WaveSettings> {
        Composition {
            variant: Variant { name: K::NAME, about },
            adjust: |_| {},
            run: run::<K>,
            rules: |_| Err(RunError::NoRules { case: NAME.into() }),
            lacks: Vec::new(),
        }
    }
    vec![
        variant::<CubicSpline>("equations (9) to (12), leapfrog, cubic spline"),
        variant::<QuinticSpline>("the same with the quintic spline"),
        variant::<WendlandC2>("the same with Wendland C2"),
    ]
}

/// What one run measured.
struct Measured {
    error: f64,
    status: Status,
    cost: Cost,
    dt: f64,
}

fn run<K: Kernel>(variant: &str, s: &WaveSettings, context: &Context) -> Result<Record, RunError> {
    let json = serde_json::to_value(s).unwrap_or_default();
    let mut record = Record::new(NAME, variant, json, context.threads.max(1));
    let WaveSettings { h_over_dx, transverse: is_transverse, rotation } = *s;
    let (metric, measured) = if rotation {
        let block = Turning { h_over_dx };
        (TURNING_ERROR, block.measure(block.scene::<K>(), context)?)
    } else {
        let wave = ElasticWave { is_transverse, h_over_dx };
        (FREQUENCY_ERROR, wave.measure(wave.scene::<K>(), context)?)
    };
    let Measured { error, status, cost, dt } = measured;
    record.put(metric, error);
    let numbers = [("h/dx", h_over_dx), ("dt [s]", dt)];
    record.numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    record.numerics.insert("kernel".into(), K::NAME.into());
    record.numerics.insert("integrator".into(), "leapfrog".into());
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

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

/// Equation (12) at density and sound speed 1.
fn pressure(density: f64) -> f64 {
    density - 1.0
}

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
        self.measure(scene, &Context::default()).map_or(f64::NAN, |measured| measured.error)
    }

    fn measure<S: Scheme<Extra = Symmetric>>(
        &self,
        scene: Scene<S>,
        context: &Context,
    ) -> Result<Measured, RunError> {
        let lattice = SquareLattice::<S::Kernel>::new(self.h_over_dx, 0.0);
        let h = self.h_over_dx / N as f64;
        let g = lattice.gradient(Vector2::new(TAU / N as f64, 0.0)).norm() / h;
        let modulus =
            if self.is_transverse { SHEAR_MODULUS } else { 1.0 + 4.0 / 3.0 * SHEAR_MODULUS };
        let omega = g * modulus.sqrt();
        let dt = 0.02 / omega * TAU;
        let mut watch = Watch { wave: *self, amplitudes: Vec::new() };
        let mut simulation = scene.build()?;
        let end = [dt * STEPS as f64];
        let (status, cost) = runner::drive(
            &mut simulation,
            dt,
            &end,
            context,
            &mut watch,
            &pressure,
            &mut |_, _| {},
        )?;
        let (mut forward, mut square) = (0.0, 0.0);
        for a in watch.amplitudes[..watch.amplitudes.len().saturating_sub(1)].windows(3) {
            forward += a[1] * (a[0] + a[2]);
            square += a[1] * a[1];
        }
        let theta = (0.5 * forward / square).acos();
        let error = (2.0 * (0.5 * theta).sin() / (omega * dt) - 1.0).abs();
        Ok(Measured { error, status, cost, dt })
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
        self.measure(scene, &Context::default()).map_or(f64::NAN, |measured| measured.error)
    }

    fn measure<S: Scheme<Extra = Symmetric>>(
        &self,
        scene: Scene<S>,
        context: &Context,
    ) -> Result<Measured, RunError> {
        let factor = SquareLattice::<S::Kernel>::new(self.h_over_dx, 0.0).gradient_factor();
        let middle = scene.particles.len() / 2;
        let mut simulation = scene.build()?;
        let dt = Self::ANGLE;
        let (status, cost) =
            runner::drive(&mut simulation, dt, &[dt], context, &mut (), &pressure, &mut |_, _| {})?;
        let shear = simulation.particles()[middle].extra.xy;
        let error = (shear / (2.0 * Self::STRESS * Self::ANGLE * factor) - 1.0).abs();
        Ok(Measured { error, status, cost, dt })
    }

    /// The gate on it.
    pub fn gate(&self) -> Gate {
        let id = format!("elastic_waves.cubic.h{}.turning", self.h_over_dx);
        let because = "the Jaumann rate turns the stress with the body, by the factor of gradients on a \
                       lattice; one step of 1e-5 leaves 1e-10, and round-off of the strain 1e-7";
        Gate::new(id, TURNING_ERROR, Bound::Below(1e-6), Evidence::Theory, because)
    }
}

/// Projections of the velocities on the wave.
struct Watch {
    wave: ElasticWave,
    amplitudes: Vec<f64>,
}

impl Observer<Symmetric> for Watch {
    fn after_step(&mut self, simulation: &dyn Stepper<Symmetric>) -> Flow {
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
    Gate::new(id, FREQUENCY_ERROR, Bound::Below(1e-6), Evidence::Theory, because)
}

/// The waves, each along and across, in the order of the table.
const WAVES: [(&str, f64); 4] = [
    (CubicSpline::NAME, 1.5),
    (CubicSpline::NAME, 1.2),
    (QuinticSpline::NAME, 1.0),
    (WendlandC2::NAME, 1.5),
];

fn waves() -> impl Iterator<Item = (&'static str, ElasticWave)> {
    [false, true].into_iter().flat_map(|is_transverse| {
        WAVES.map(|(kernel, h_over_dx)| (kernel, ElasticWave { is_transverse, h_over_dx }))
    })
}

/// The rotating block.
const BLOCK: Turning = Turning { h_over_dx: 1.5 };

fn wave_spec(kernel: &str, wave: &ElasticWave) -> RunSpec {
    let ElasticWave { is_transverse, h_over_dx } = *wave;
    ELASTIC_WAVE.spec(kernel, |s| (s.transverse, s.h_over_dx) = (is_transverse, h_over_dx))
}

fn block_spec() -> RunSpec {
    let h_over_dx = BLOCK.h_over_dx;
    ELASTIC_WAVE.spec(CubicSpline::NAME, |s| (s.rotation, s.h_over_dx) = (true, h_over_dx))
}

fn plan() -> Vec<Planned> {
    let planned = |(kernel, wave): (&str, ElasticWave)| {
        Planned::new(wave_spec(kernel, &wave)).judged(vec![gate(kernel, &wave)])
    };
    let mut plan: Vec<Planned> = waves().map(planned).collect();
    plan.push(Planned::new(block_spec()).judged(vec![BLOCK.gate()]));
    plan
}

/// The errors in a table.
fn study(runs: &Runs) -> Study {
    let columns = vec![
        Column::text("kernel"),
        Column::num("h/dx", "-"),
        Column::text("wave"),
        Column::num("relative error", "-"),
    ];
    let caption = "Waves of rubber (shear modulus 0.22 K) along a stress-free lattice of 16 particles, with \
                   the time step divided out: frequency against the gradient symbol. Last: how far the \
                   stress of a block rotates with it.";
    let row = |kernel: &str, what: &str, h_over_dx: f64, spec: &RunSpec, metric: MetricKey| {
        let error = runs.record(spec).and_then(|record| record.value(metric));
        let error = Cell::sci(error.unwrap_or(f64::NAN), 2);
        vec![Cell::text(kernel), Cell::num(h_over_dx, 2), Cell::text(what), error]
    };
    let mut table = Table::new(caption, columns);
    for (kernel, wave) in waves() {
        let what = if wave.is_transverse { "transverse" } else { "longitudinal" };
        let spec = wave_spec(kernel, &wave);
        table = table.row(row(kernel, what, wave.h_over_dx, &spec, FREQUENCY_ERROR));
    }
    let what = "stress of a rotating block";
    let last = row(CubicSpline::NAME, what, BLOCK.h_over_dx, &block_spec(), TURNING_ERROR);
    Study::new("elastic-waves", "Elastic waves on a lattice").block(table.row(last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use harness::case::Case;

    #[test]
    fn waves_of_rubber_have_the_symbols_of_the_lattice() {
        for Planned { spec, gates, .. } in plan() {
            let record = ELASTIC_WAVE.run(&spec, &Context::default()).expect("a run");
            for gate in gates {
                let judgement = gate.judge(gate.value(&record));
                assert!(!judgement.verdict.is_failure(), "{}: {:?}", gate.id, judgement.value);
            }
        }
    }
}
