//! A problem of elasticity: its variants, what every record states, and how it is stepped.

use nalgebra::Vector2;
use solver::{Domain, Flow, Particle, Role, Stepper, Symmetric};

use super::lagrangian::{self, LAGRANGIAN, TOTAL};
use super::{Energy, Material, clamp, limits};
use base::{
    bits::Bits,
    record::Record,
    settings::{self, Settings, Values},
};
use harness::{
    case::{Rules, RunError, Step},
    composed::Variants,
    context::Context,
    method::{Medium, Method, Parts, Properties},
    outline::Sink,
    runner::{self, Drive},
    simulate,
    size::Size,
};
use maths::theory::time_step::Integrator;

/// What every problem is set by, as [`solid_settings!`](crate::solid_settings!) has it.
pub trait SharedSettings: Values {
    /// The material.
    fn material(&self) -> Material;
    /// h/dx.
    fn h_over_dx(&self) -> f64;
    /// Time step \[s\] and Courant number dt (c_p + V)/h, if they are given.
    fn given_step(&self) -> [Option<f64>; 2];
}

/// What follows from the settings of a problem before its particles are made.
#[derive(Clone, Debug, Default)]
pub struct Scales {
    /// Spacing \[m\].
    pub dx: f64,
    /// Length of a body along x \[m\].
    pub length: f64,
    /// Largest speed at the start \[m/s\].
    pub speed: f64,
    /// End of the run \[s\].
    pub end: f64,
    /// About how many particles there are.
    pub count: f64,
    /// The settings on which the number of particles and of time steps depends.
    pub decisive: &'static str,
    /// Are there two equal bodies that meet, whose particles follow each other, each with the largest speed?
    pub meet: bool,
    /// Times, equally far apart, to which steps lead exactly, which changes the length of the steps before
    /// them; 0 is as 1, the end alone.
    pub stops: usize,
    /// The acceleration of weight \[m/s²\], which only methods with weight read.
    pub gravity: Vector2<f64>,
    /// Open, unless a case has a period.
    pub domain: Domain,
    /// Densities and speeds beyond which a run counts as diverged.
    pub bounds: solver::Limits,
}

/// A problem of elasticity, stated by its settings: what differs between solid cases.
pub trait Problem: SharedSettings {
    /// Spacing, speed, end and the like.
    fn scales(&self) -> Scales;
    /// Spacing \[m\].
    fn dx(&self) -> f64 {
        self.scales().dx
    }
    /// Columns of particles along a body, as wide as the spacing, or as nearly as its length allows.
    fn columns(&self) -> usize {
        (self.scales().length / self.dx()).round() as usize
    }
    /// Largest speed at the start \[m/s\].
    fn speed(&self) -> f64 {
        self.scales().speed
    }
    /// End of the run \[s\].
    fn end(&self) -> f64 {
        self.scales().end
    }
    /// The particles at the start. Those that are held stand behind the plane x = 0, by which methods that
    /// have no held particles hold the body.
    fn particles(&self) -> Vec<Particle<Symmetric>>;
    /// What measures a run with these particles at the start, which have these energies if the method knows
    /// them.
    fn watch(&self, start: &[Particle<Symmetric>], energy: Option<Energy>) -> Box<dyn Watch>;
    /// Refuses settings that are in their ranges and make no body together, or none that this method holds.
    ///
    /// # Errors
    /// What is too large, and which settings it depends on.
    fn check(&self, _method: &Method<Symmetric>, _context: &Context) -> Result<(), RunError> {
        Ok(())
    }
    /// Displacement at the start of the particle that is at this place without stress \[m\], for methods
    /// whose stress follows from displacements.
    fn displacement(&self, _place: Vector2<f64>) -> Vector2<f64> {
        Vector2::zeros()
    }
}

/// Sees every step of a run and measures it.
pub trait Watch: Bits {
    /// Called after every step.
    fn after_step(&mut self, simulation: &dyn Stepper<Symmetric>);
    /// Keeps the particles at a stop, of a run that is asked to; velocities may be half a step old.
    fn keep(&self, _: &dyn Stepper<Symmetric>, _stop: usize, _: &mut Record) {}
    /// Puts metrics and profiles; `simulation` is at its end.
    fn measure(&mut self, simulation: &dyn Stepper<Symmetric>, record: &mut Record);
}

/// Variants of a problem.
type Alike<P> = Variants<P, Method<Symmetric>>;

/// No variants yet, of a problem that any method runs.
pub fn no_variants<P: Problem + Settings>() -> Alike<P> {
    Variants::of(|m, s: &P, context| run(m, s, context), |m, s| Ok(rules(m, s)))
}

/// The variants that every problem has; the methods: that of the paper, and its equations alone.
pub fn variants<P: Problem + Settings>([seed, bare]: [Method<Symmetric>; 2]) -> Alike<P> {
    let papers = "what the paper describes: predictor-corrector, artificial viscosity, artificial stress in \
                  principal axes, XSPH";
    let alone = "the equations (3), (9)-(12) alone, stepped by the leapfrog: what is due to them, and what \
                 to the terms that stabilise?";
    no_variants()
        .with("seed", papers, seed, |_| {})
        .with("bare", alone, bare, |s| leave_out(s, &["alpha", "beta", "xi", "xsph"]))
        .with(LAGRANGIAN, TOTAL, schemes::total::hencky(), |s| lagrangian::choose(s))
}

/// Sets the strengths of terms that a method lacks to 0.
pub fn leave_out(settings: &mut dyn Values, names: &[&str]) {
    for name in names {
        let _is_in_range = settings::set(settings, name, "0");
    }
}

/// What terms are made from.
pub fn medium(settings: &dyn Problem, method: &Properties) -> Medium {
    let Scales { dx, gravity, .. } = settings.scales();
    let medium = settings.material().medium(method, [dx, settings.h_over_dx() * dx]);
    Medium { acceleration: gravity, ..medium }.set_by(settings)
}

/// N of the step N (h/F)^(1/2) of a body force F, the usual one.
const FORCED: f64 = 0.25;

/// The time step C h/(c_p + V) for speeds of V unless it is given, and its limit.
fn rules(method: &Properties, settings: &dyn Problem) -> Rules {
    let Scales { speed, end, meet, gravity, .. } = settings.scales();
    let (material, medium) = (settings.material(), medium(settings, method));
    let usual = if method.theory == Integrator::Leapfrog { 0.4 } else { 0.25 };
    let [dt, courant] = settings.given_step();
    let courant = courant.unwrap_or(usual);
    let (h, force) = (medium.h, gravity.norm());
    let step = Step::courant(courant, h, [material.p_wave_speed(), speed]);
    let step = step.forced(FORCED, h, force).or_given(dt);
    let approach = if meet { 2.0 * speed } else { 0.0 };
    let limits =
        limits(method, &material, &medium, settings.h_over_dx(), approach).moving(h, speed, force);
    Rules { step, limits, sound_speed: material.sound_speed(), end }
}

/// One run with a method.
fn run(m: &Method<Symmetric>, s: &dyn Problem, context: &Context) -> Result<Record, RunError> {
    s.check(m, context)?;
    let scales = s.scales();
    let (what, value, most) =
        ("the spacing in lengths of the body", scales.dx / scales.length, 0.5);
    if value > most {
        return Err(RunError::TooMuch { what, value, most, setting: "n, thickness or length" });
    }
    let (material, rules, medium) = (s.material(), rules(m, s), medium(s, m));
    simulate::check_step(m.integrator, &rules, context)?;
    let size = simulate::size(m, &medium, [rules.end / rules.dt(), scales.count]);
    let size = Size { samples: size.steps, ..size };
    runner::check_size(size, scales.decisive, context)?;
    let own = [
        ("K [Pa]", material.bulk),
        ("mu [Pa]", material.shear),
        ("c_p [m/s]", material.p_wave_speed()),
    ];
    let numbers = [&rules.numbers([s.h_over_dx(), medium.dx])[..], &own].concat();
    let mut record = simulate::begin(m, &numbers, context);
    let (eos, particles) = (material.eos(), s.particles());
    let is_held = particles.iter().any(|p| p.role == Role::Wall);
    let mirrors = if is_held { vec![clamp()] } else { Vec::new() };
    let all = particles.len();
    let body = |k: usize| (2 * k / all) as u32;
    let bodies = if scales.meet { (0..all).map(body).collect() } else { Vec::new() };
    let parts = Parts::new(medium, scales.domain, particles.clone(), context);
    let mut simulation = (m.build)(Parts { mirrors, bodies, limits: scales.bounds, ..parts })?;
    if simulation.potential().is_some() {
        let by = |place| s.displacement(place);
        let view = context.outline.as_ref().map(Sink::view).unwrap_or_default();
        lagrangian::displace(&mut *simulation, |place| view.displacement(by, place));
    }
    let energy = Energy::known(&*simulation);
    let mut watch = s.watch(&particles, energy);
    let count = scales.stops.max(1);
    let stops: Vec<f64> = (1..=count).map(|k| scales.end * k as f64 / count as f64).collect();
    let mut seen = (&mut *watch, &mut record);
    Drive::new(&mut *simulation, rules.dt(), &stops, eos, &mut seen)
        .after_step("measurements", &|(watch, _), simulation| {
            watch.after_step(simulation);
            Flow::Continue
        })
        .at_positions("particles", &|(watch, record), simulation, stop| {
            if context.spec.keep.particles {
                watch.keep(simulation, stop, record);
            }
        })
        .run(context)?
        .put(&mut record);
    watch.measure(&*simulation, &mut record);
    Ok(record)
}
