//! Taylor-Green vortices: too slow a sound, too fast a sound, disturbed lattices.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use solver::{
    Compose, Continuity, DensityDiffusion, Domain, Leapfrog, Limits, Open, Particle, Pressure,
    QuinticSpline, Shifting, Tait, Viscosity,
};

use super::{
    EXTREMES, Experiment, ExtremeSettings, Simulation, drive,
    experiment::{completed, measured, sci},
};
use base::functions::{cos, exp, sin};
use base::{
    gate::{Bound, Evidence},
    random::Random,
    record::{MetricKey, Record, Status},
    spec::RunSpec,
};
use harness::{
    case::{RunError, Tier},
    context::Context,
    extremes::Entry,
    method::{Medium, Method, Parts},
};
use report::percent;

/// The modern composition of the channels, in a periodic box.
type Modern = Compose<
    QuinticSpline,
    (Pressure<Tait>, Viscosity),
    (Continuity, DensityDiffusion, Shifting),
    Open,
    Leapfrog,
>;

const VELOCITY_ERROR: MetricKey =
    MetricKey::new("l2", "-", "rms(v - v_exact)/rms(v_exact) over the particles at the end");
const PEAK_ENERGY: MetricKey =
    MetricKey::new("peak_energy", "-", "largest kinetic energy at 20 times/that of the start");
const ENERGY_RATIO: MetricKey =
    MetricKey::new("energy_ratio", "-", "kinetic energy at the end/the exact one");

/// U = L = ρ = 1.
struct Vortex {
    settings: ExtremeSettings,
    /// Spacing.
    dx: f64,
    /// Smoothing length.
    h: f64,
    eos: Tait,
}

impl Vortex {
    fn new(settings: &ExtremeSettings) -> Self {
        let dx = 1.0 / settings.n as f64;
        let eos = Tait::new(1.0, 1.0 / settings.mach);
        Self { settings: settings.clone(), dx, h: settings.h_over_dx * dx, eos }
    }

    fn exact(&self, place: Vector2<f64>, t: f64) -> Vector2<f64> {
        let decay = exp(-2.0 * TAU * TAU / self.settings.re * t);
        let (x, y) = (TAU * place.x, TAU * place.y);
        Vector2::new(-cos(x) * sin(y), sin(x) * cos(y)) * decay
    }

    fn parts(&self, method: &Method) -> Parts {
        let &Self { dx, h, eos, .. } = self;
        let ExtremeSettings { n, re, jitter, mach, .. } = self.settings;
        let mut random = Random::new(3);
        let mut shake = || Vector2::new(random.normal(), random.normal()) * (jitter * dx);
        let particles = solver::lattice(Vector2::repeat(0.5 * dx), dx, n, n)
            .map(|x| x + shake())
            .map(|x| Particle::fluid(x, self.exact(x, 0.0), 1.0, dx * dx))
            .collect();
        let medium = method.medium(eos, [dx, h]);
        let medium =
            Medium { nu: 1.0 / re, eta2_over_h2: 1e-6, diffusion: 0.1, shift: 0.5, ..medium };
        let limits = Limits { density: [0.1, 10.0], speed: 10.0 * (1.0 + 1.0 / mach) };
        let torus = Domain::torus(1.0, 1.0);
        Parts { limits, ..Parts::new(medium, torus, particles, &Context::default()) }
    }
}

/// Runs a vortex.
pub fn run(
    variant: &str,
    settings: &ExtremeSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let (vortex, method) = (Vortex::new(settings), Method::of::<Modern>());
    let ExtremeSettings { mach, re, end, .. } = *settings;
    let h = vortex.h;
    let dt = (h / (1.0 + 1.0 / mach)).min(0.25 * h * h * re);
    let times: Vec<f64> = (1..=20).map(|k| end * f64::from(k) / 20.0).collect();
    let mut simulation = (method.build)(vortex.parts(&method))?;
    let (start, mut peak) = (kinetic(&*simulation), 1.0f64);
    let look = |peak: &mut f64, simulation: &mut Simulation, _: usize| {
        *peak = peak.max(kinetic(simulation) / start);
    };
    let run = (&method, variant, settings);
    let stepping = (dt, &times[..], vortex.eos);
    let mut record = drive(run, &mut *simulation, stepping, context, &mut peak, &look)?;
    if record.status == Status::Completed {
        let (mut difference, mut scale) = (0.0, 0.0);
        for particle in simulation.particles() {
            let exact = vortex.exact(particle.position, simulation.time());
            difference += (particle.velocity - exact).norm_squared();
            scale += exact.norm_squared();
        }
        let decay = exp(-4.0 * TAU * TAU / re * simulation.time());
        record.put(VELOCITY_ERROR, (difference / scale).sqrt());
        record.put(PEAK_ENERGY, peak);
        record.put(ENERGY_RATIO, kinetic(&*simulation) / (start * decay));
    }
    Ok(record)
}

fn kinetic(simulation: &Simulation) -> f64 {
    simulation.fluid().map(|(mass, e)| 0.5 * mass * e.velocity.norm_squared()).sum()
}

fn vortex(mach: f64, jitter: f64, end: f64) -> RunSpec {
    EXTREMES.spec("vortex", |s| (s.mach, s.jitter, s.end) = (mach, jitter, end))
}

/// Mach number 0.5: not weakly compressible any more.
pub fn fast() -> Vec<Experiment> {
    let runs = [0.5, 0.1].map(|mach| vortex(mach, 0.1, 0.5)).into();
    let judge = |records: &[&Record]| {
        let what = [
            "Taylor-Green vortex, sound too slow".into(),
            "Mach 0.5, Re 100, lattice disturbed by 10 %".to_string(),
        ];
        let metric = "error more than at Mach 0.1";
        let entry = Entry::new("mach", what, metric, Bound::Below(0.25)).because(
            Evidence::Theory,
            "Compressibility adds an error proportional to the square of the \
                                        Mach number.",
        );
        let [slow, usual] = [0, 1].map(|k| completed(records[k], VELOCITY_ERROR));
        let entry = match slow.zip(usual) {
            Some((slow, usual)) => {
                let [error, at_usual] = [slow, usual].map(|error| percent(error, 2));
                let found = format!("velocity error {error}, at Mach 0.1 {at_usual}");
                entry.found(slow - usual, found)
            }
            None => entry.found(f64::NAN, [0, 1].map(|k| records[k].status.to_string()).join("; ")),
        };
        vec![entry]
    };
    vec![Experiment::new(runs, 2.0, judge)]
}

/// Sound a thousand times faster than needed.
pub fn stiff_sound(tier: Tier) -> Vec<Experiment> {
    let end = if tier == Tier::Full { 0.02 } else { 0.002 };
    let runs = [1e-4, 0.1].map(|mach| vortex(mach, 0.0, end)).into();
    let judge = move |records: &[&Record]| {
        let setting = format!("Taylor-Green, Mach 10⁻⁴, t = {end}");
        let what = ["c₀ a thousand times too fast".to_string(), setting];
        let because = "The incompressible flow does not depend on c₀. After a few steps 1 % is noise; at \
                       Mach 0.1 the sound of the start is more.";
        let usual = format!("; at Mach 0.1 {}", sci(completed(records[1], VELOCITY_ERROR)));
        let entry = Entry::new("sound.vortex", what, "error of the velocity", Bound::Below(0.01))
            .because(Evidence::Theory, because);
        vec![measured(entry, records[0], VELOCITY_ERROR, &usual)]
    };
    vec![Experiment::new(runs, 4.0, judge)]
}

/// Lattices disturbed by 1, 10 and 30 % of the spacing.
pub fn jittered() -> Vec<Experiment> {
    let by = |jitter: f64| {
        Experiment::of(vortex(0.1, jitter, 0.5), 1.0, move |record| {
            let setting = format!("Taylor-Green, {} dx", percent(jitter, 0));
            let what = ["disturbed lattice".to_string(), setting];
            let name = format!("jitter.{jitter}");
            let metric = "largest kinetic energy/initial";
            let because = "Viscosity only takes energy, and pressure starts at 0.";
            let entry = Entry::new(&name, what, metric, Bound::Below(1.01))
                .because(Evidence::Invariant, because);
            let value = |metric| completed(record, metric);
            let (error, ratio) = (value(VELOCITY_ERROR), value(ENERGY_RATIO));
            match (value(PEAK_ENERGY), error.zip(ratio)) {
                (Some(peak), Some((error, ratio))) => {
                    let (error, energy) = (percent(error, 1), percent(ratio - 1.0, 1));
                    let found = format!(
                        "{peak:.4}; at t = 0.5 energy off by {energy}, velocity by {error}"
                    );
                    entry.found(peak, found)
                }
                _ => entry.found(f64::NAN, record.status.to_string()),
            }
        })
    };
    [0.01, 0.1, 0.3].map(by).into()
}
