//! A problem of elasticity: its variants, the common part of its records, and its stepping.

use std::ops::ControlFlow;

use nalgebra::Vector2;
use serde::{Serialize, de::DeserializeOwned};
use touchstone_base::settings::{self, Settings, Values};
use touchstone_harness::prelude::*;
use touchstone_harness::{case::Step, method::Properties, relation::View, snapshot::Snapshot};
use touchstone_maths::theory::time_step::Integrator;
use touchstone_solver::{PlaneWall, Role, Symmetric};

use super::{
    Material,
    lagrangian::{self, LAGRANGIAN, TOTAL},
    limits, medium_of,
};

/// The numbers that the settings of every solid state.
#[derive(Clone, Copy, Debug)]
pub struct SolidParameters {
    /// The material.
    pub material: Material,
    /// h/dx.
    pub h_over_dx: f64,
    /// Time step, if it is given \[s\].
    pub dt: Option<f64>,
    /// Courant number dt (c_p + V)/h, if it is given.
    pub courant: Option<f64>,
}

/// Quantities of a problem that follow from its settings without particles.
#[derive(Clone, Debug, Default)]
pub struct SolidScales {
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
    pub bounds: touchstone_solver::DivergenceBounds,
}

impl SolidScales {
    /// Scales of a plate of `n` layers, of this length and thickness \[m\].
    pub fn of_layers(n: usize, [length, thickness]: [f64; 2]) -> Self {
        let (dx, decisive) = (thickness / n as f64, "end, dt, n, length or thickness");
        Self { dx, length, count: length / dx * n as f64, decisive, ..Self::default() }
    }
}

/// The plane at x = 0 that holds a plate without held particles.
pub fn clamp() -> PlaneWall {
    PlaneWall::new(Vector2::zeros(), Vector2::x(), Vector2::zeros())
}

/// Elastic bodies, stated by the settings of a case: the differences between cases of solids.
pub trait ElasticBody: Values + Sized {
    /// Measures a run.
    type Watch: Watch<Self>;
    /// Material, h/dx and time step.
    fn common(&self) -> SolidParameters;
    /// The material.
    fn material(&self) -> Material {
        self.common().material
    }
    /// Spacing, speed, end and the like.
    fn scales(&self) -> SolidScales;
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
    /// The particles at the start. Clamped particles are behind the plane x = 0, by which methods without
    /// clamped particles hold the body.
    fn particles(&self) -> Vec<Particle<Symmetric>>;
    /// The observer of a run, of its particles before and with a deliberate error.
    fn watch(&self, scene: &Snapshot<Symmetric>, start: &Snapshot<Symmetric>) -> Self::Watch;
    /// Refuses settings that are in their ranges and make no body together.
    ///
    /// # Errors
    /// The quantity that is too large, and its settings.
    fn check(&self) -> Result<(), RunError> {
        Ok(())
    }
    /// Why this method is not known to hold the body, if so.
    fn unstable(&self, _method: &Properties) -> Option<RunError> {
        None
    }
    /// Displacement at the start of the particle that is at this place without stress \[m\], for methods
    /// whose stress follows from displacements.
    fn displacement(&self, _place: Vector2<f64>) -> Vector2<f64> {
        Vector2::zeros()
    }
}

/// Observes every step of a run of a body and measures it.
pub trait Watch<B>: Serialize + DeserializeOwned {
    /// Called after every step.
    fn after_step(&mut self, body: &B, now: &Snapshot<Symmetric>);
    /// Keeps the particles at a stop, if the run keeps particles; velocities may be half a step old.
    fn keep(_: &B, _: &Snapshot<Symmetric>, _stop: usize, _: &mut Record) {}
    /// Puts metrics and profiles at the end.
    fn measure(self, body: &B, end: &Snapshot<Symmetric>, record: &mut Record);
}

/// Variants of a problem.
type Alike<B> = Variants<B, Method<Symmetric>>;

/// No variants yet, of a problem that any method runs.
pub fn no_variants<B: ElasticBody + Settings + Clone>() -> Alike<B> {
    Variants::of(|m, s: &B| Solid::new(m, s.clone()))
}

/// The variants of every problem; the methods: the paper's, and its equations alone.
pub fn variants<B: ElasticBody + Settings + Clone>(
    [seed, bare]: [Method<Symmetric>; 2],
) -> Alike<B> {
    let papers = "the paper's: predictor-corrector, artificial viscosity, artificial stress in principal \
                  axes, XSPH";
    let alone = "equations (3), (9)-(12) alone, with the leapfrog: which errors are theirs, which those of \
                 stabilisers?";
    no_variants()
        .with("seed", papers, seed, |_| {})
        .with("bare", alone, bare, |s| leave_out(s, &["alpha", "beta", "xi", "xsph"]))
        .with(LAGRANGIAN, TOTAL, touchstone_schemes::total::hencky(), |s| lagrangian::choose(s))
}

/// Sets the strengths of terms that a method lacks to 0.
pub fn leave_out(settings: &mut dyn Values, names: &[&str]) {
    for name in names {
        let _is_in_range = settings::set(settings, name, "0");
    }
}

/// Constants of the terms.
pub fn medium(settings: &impl ElasticBody, method: &Properties) -> Medium {
    let SolidScales { dx, gravity, .. } = settings.scales();
    let SolidParameters { material, h_over_dx, .. } = settings.common();
    let medium = medium_of(&material, method, dx, h_over_dx * dx);
    Medium { acceleration: gravity, ..medium }.set_by(settings)
}

/// N of the step N (h/F)^(1/2) of a body force F, the usual one.
const FORCED: f64 = 0.25;

/// The time step C h/(c_p + V) for speeds of V unless it is given, and its limit.
fn rules(method: &Properties, settings: &impl ElasticBody) -> Rules {
    let SolidScales { speed, end, meet, gravity, .. } = settings.scales();
    let SolidParameters { material, h_over_dx, dt, courant } = settings.common();
    let medium = medium(settings, method);
    let usual = if method.theory == Integrator::Leapfrog { 0.4 } else { 0.25 };
    let courant = courant.unwrap_or(usual);
    let (h, force) = (medium.h, gravity.norm());
    let step = Step::courant(courant, h, [material.p_wave_speed(), speed]);
    let step = step.forced(FORCED, h, force).or_given(dt);
    let approach = if meet { 2.0 * speed } else { 0.0 };
    let limits = limits(method, &material, &medium, h_over_dx, approach).moving(h, speed, force);
    Rules { step, limits, sound_speed: material.sound_speed(), end }
}

/// A run of bodies with a method.
struct Solid<B> {
    method: Method<Symmetric>,
    body: B,
    scales: SolidScales,
    medium: Medium,
    rules: Rules,
}

impl<B: ElasticBody> Solid<B> {
    fn new(method: &Method<Symmetric>, body: B) -> Result<Self, RunError> {
        body.check()?;
        let scales = body.scales();
        let (what, value, most) =
            ("the spacing in lengths of the body", scales.dx / scales.length, 0.5);
        if value > most {
            return Err(RunError::TooMuch { what, value, most, setting: "n, thickness or length" });
        }
        let (medium, rules) = (medium(&body, &method.properties), rules(&method.properties, &body));
        Ok(Self { method: method.clone(), body, scales, medium, rules })
    }
}

impl<B: ElasticBody> Problem for Solid<B> {
    type Extra = Symmetric;
    type Simulation = dyn Stepper<Symmetric>;
    type Watch = B::Watch;
    const READS_START: bool = true;

    fn method(&self) -> &Method<Symmetric> {
        &self.method
    }

    fn brief(&self) -> Brief {
        let Self { medium, rules, scales, .. } = self;
        let SolidParameters { material, h_over_dx, .. } = self.body.common();
        let brief = Brief::new(*medium, *rules, scales.count, scales.decisive)
            .numbers(&rules.numbers(h_over_dx, medium.dx))
            .numbers(&[
                ("K [Pa]", material.bulk),
                ("mu [Pa]", material.shear),
                ("c_p [m/s]", material.p_wave_speed()),
            ]);
        let unstable = self.body.unstable(&self.method.properties);
        Brief { unstable, samples: rules.end / rules.dt(), ..brief }
    }

    fn times(&self) -> Vec<f64> {
        let count = self.scales.stops.max(1);
        (1..=count).map(|k| self.scales.end * k as f64 / count as f64).collect()
    }

    fn scene(&self) -> Result<Parts<Symmetric>, RunError> {
        let particles = self.body.particles();
        let is_held = particles.iter().any(|p| p.role == Role::Wall);
        let mirrors = if is_held { vec![clamp()] } else { Vec::new() };
        let all = particles.len();
        let body = |k: usize| (2 * k / all) as u32;
        let bodies = if self.scales.meet { (0..all).map(body).collect() } else { Vec::new() };
        let parts = Parts::new(self.medium, self.scales.domain, particles);
        Ok(Parts { mirrors, bodies, limits: self.scales.bounds, ..parts })
    }

    fn prepare(&self, simulation: &mut Self::Simulation, view: &View) {
        if simulation.potential().is_some() {
            let by = |place| self.body.displacement(place);
            lagrangian::displace(simulation, |place| view.displacement(by, place));
        }
    }

    fn watch(&self, scene: &Snapshot<Symmetric>, start: &Snapshot<Symmetric>) -> Self::Watch {
        self.body.watch(scene, start)
    }

    fn calls(&self, calls: Calls<Self>, output: OptionalOutput) -> Calls<Self> {
        calls
            .after_step("measurements", |solid, watch, now| {
                watch.after_step(&solid.body, now);
                ControlFlow::Continue(())
            })
            .when(output.particles, |calls| {
                calls.at_positions("particles", |solid, _, now, stop, record| {
                    B::Watch::keep(&solid.body, now, stop, record);
                })
            })
    }

    fn measure(&self, watch: Self::Watch, end: &Snapshot<Symmetric>, record: &mut Record) {
        watch.measure(&self.body, end, record);
    }
}
