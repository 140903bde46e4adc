//! The planned runs that mutants go through, each with its gates.

use base::functions::{exp, sin};
use base::{gate::Gate, record::Record, spec::Task};
use fluids::channel::{self, ChannelSettings, Flow, Modern, Seed, Setup, Stabilised};
use harness::{
    case::{Planned, Tier, changed},
    context::Context,
    method::{self, Boundary, FromMedium, Method},
    plan,
};
use lattice::{
    acoustic_wave::Acoustic,
    shear_wave::Shear,
    stability::{self, Pair, Plain, Point},
    wave::{self, Diffusive, Kind, Wave, WaveCase, WaveSettings},
};
use maths::{
    exact::{couette::Couette, poiseuille::Poiseuille},
    metrics::norms::{Scale, l2},
};
use serde::de::DeserializeOwned;
use solver::{
    BodyForce, Compose, Continuity, CubicSpline, InterfaceWall, Kernel, Leapfrog,
    PredictorCorrector, QuinticSpline, SceneError, Stepper, Term, WendlandC2, walls::Walls,
};
use std::f64::consts::PI;
use touchstone_tests::spoil::{Fault, Mistaken, Spoilable, spoil};
use validation::cases::find;

/// Groups of gates, in the order of the table.
pub const GROUPS: [&str; 5] = ["couette", "poiseuille", "acoustic_wave", "shear_wave", "stability"];

/// What is wrong with a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// (-1)ⁿ missing in the Couette series.
    NoAlternation,
    /// The Couette series of one term.
    OneTerm,
    /// The Poiseuille series added to the parabola.
    SeriesAdded,
    /// Another fluid.
    Viscosity,
    /// V for the mean velocity.
    MeanVelocity,
    /// The limit of dt is half as long again.
    TimeStep,
    /// Half the growth.
    WeakGrowth,
}

/// A run and its gates.
pub enum Job {
    Channel(Flow, Planned),
    Wave(&'static WaveCase, Planned),
    Limit(&'static str, Gate),
    WeakGrowth(Gate),
}

/// What came out of a job.
pub enum Measured {
    Record(Box<Record>),
    /// The one number of a study.
    Number(f64),
    /// The errors of profiles against another reference.
    Errors(Vec<(String, f64)>),
}

impl Measured {
    pub fn value(&self, gate: &Gate) -> Option<f64> {
        match self {
            Measured::Record(record) => record.metric(&gate.metric),
            Measured::Number(value) => Some(*value),
            Measured::Errors(errors) => {
                errors.iter().find(|(metric, _)| *metric == gate.metric).map(|(_, error)| *error)
            }
        }
    }

    /// Whether the gate is on something that was looked at: all of it, but for a reference.
    pub fn is_about(&self, gate: &Gate) -> bool {
        !matches!(self, Measured::Errors(_)) || self.value(gate).is_some()
    }

    pub fn state(&self) -> Option<String> {
        match self {
            Measured::Record(record) => record.state.clone(),
            _ => None,
        }
    }
}

/// Points of the stability study: one for each integrator and kind of limit.
const LIMITS: [&str; 3] = ["leapfrog, viscous", "predictor-corrector, viscous", "leapfrog, sound"];
/// Courant number of the weak growth.
const COURANT: f64 = 0.5;

fn pair(name: &str) -> Pair {
    if name.starts_with("leapfrog") { Pair::cubic_leapfrog() } else { Pair::cubic_pc() }
}

fn point(name: &str) -> Point {
    let stiffness = if name.ends_with("sound") { f64::INFINITY } else { 1.0 };
    Point::new(&pair(name), 1.3, [stiffness, 0.0, 0.0])
}

/// The settings of a planned run.
fn settings<T: DeserializeOwned>(planned: &Planned) -> T {
    serde_json::from_value(planned.spec.settings.clone()).expect("planned settings")
}

fn is_modern(planned: &Planned) -> bool {
    planned.spec.variant == "modern"
}

/// Runs of the quick tier at 10 and 20 rows, and at Re 0.5 and 20, that have gates.
fn is_considered(planned: &Planned) -> bool {
    if planned.gates.is_empty() || planned.spec.task != Task::Simulate {
        return false;
    }
    let s: ChannelSettings = settings(planned);
    if is_modern(planned) { s.re == 0.5 || s.re == 20.0 } else { s.rows == 10 || s.rows == 20 }
}

pub fn jobs() -> Vec<Job> {
    let plan = |name: &str| plan::of_case(find(name).expect("a case"), Tier::Quick);
    let channel = |flow, name| {
        let considered = plan(name).into_iter().filter(is_considered);
        let (modern, ladders): (Vec<_>, Vec<_>) = considered.partition(is_modern);
        ladders.into_iter().chain(modern).map(move |planned| Job::Channel(flow, planned))
    };
    let wave = |case: &'static WaveCase| {
        plan(case.name).into_iter().map(move |planned| Job::Wave(case, planned))
    };
    let mut jobs: Vec<Job> = channel(Flow::Couette, "couette").collect();
    jobs.extend(channel(Flow::Poiseuille, "poiseuille"));
    jobs.extend(wave(<Acoustic as Kind>::CASE).chain(wave(<Shear as Kind>::CASE)));
    jobs.extend(LIMITS.map(|name| Job::Limit(name, stability::ratio_gate(&point(name)))));
    jobs.push(Job::WeakGrowth(stability::weak_gate(COURANT)));
    jobs
}

impl Job {
    pub fn group(&self) -> &'static str {
        match self {
            Job::Channel(Flow::Couette, _) => "couette",
            Job::Channel(Flow::Poiseuille, _) => "poiseuille",
            Job::Wave(case, _) => case.name,
            Job::Limit(..) | Job::WeakGrowth(_) => "stability",
        }
    }

    pub fn gates(&self) -> &[Gate] {
        match self {
            Job::Channel(_, planned) | Job::Wave(_, planned) => &planned.gates,
            Job::Limit(_, gate) | Job::WeakGrowth(gate) => std::slice::from_ref(gate),
        }
    }

    pub fn name(&self) -> String {
        match self {
            Job::Channel(_, planned) | Job::Wave(_, planned) => {
                let case = find(self.group()).expect("a case");
                format!(
                    "{} {} {:?}",
                    self.group(),
                    planned.spec.variant,
                    changed(case, &planned.spec)
                )
            }
            Job::Limit(name, _) => format!("limit {name}"),
            Job::WeakGrowth(_) => "weak growth".into(),
        }
    }

    /// The part of a fault that this run can see: its types contain it.
    pub fn sees(&self, fault: &Fault) -> Fault {
        const N: Fault = Fault::NONE;
        let mut seen = *fault;
        let (variant, flow) = match self {
            Job::Channel(flow, planned) => (planned.spec.variant.as_str(), Some(*flow)),
            _ => ("", None),
        };
        if variant != "modern" {
            seen.shifting = N.shifting;
        }
        if variant != "modern" && !self.diffuses() {
            seen.diffusion = N.diffusion;
        }
        if flow != Some(Flow::Poiseuille) {
            seen.force = N.force;
        }
        if flow != Some(Flow::Couette) {
            (seen.wall_velocity, seen.wall_particles) = (N.wall_velocity, N.wall_particles);
        }
        if variant != "interface-wall" {
            (seen.wall_particles, seen.wall_rows) = (N.wall_particles, N.wall_rows);
        }
        if variant == "interface-wall" || flow.is_none() {
            (seen.wall_velocity, seen.mirrors) = (N.wall_velocity, N.mirrors);
        }
        if !(flow == Some(Flow::Poiseuille) && ["curved", "modern"].contains(&variant)) {
            seen.curvature = N.curvature;
        }
        seen
    }

    /// Whether density diffusion is in a wave.
    fn diffuses(&self) -> bool {
        matches!(self, Job::Wave(_, planned) if planned.spec.variant.ends_with("diffusion"))
    }

    pub fn run(&self, fault: &Fault) -> Measured {
        match self {
            Job::Channel(flow, planned) => {
                let record = match flow {
                    Flow::Couette => channel_run::<()>(*flow, planned, fault),
                    Flow::Poiseuille => channel_run::<BodyForce>(*flow, planned, fault),
                };
                Measured::Record(Box::new(record))
            }
            Job::Wave(case, planned) => Measured::Record(Box::new(wave_run(case, planned, fault))),
            Job::Limit(name, _) => Measured::Number(limit(name, fault)),
            Job::WeakGrowth(_) => Measured::Number(weak_growth(fault)),
        }
    }

    /// The run of the case itself.
    pub fn run_unwrapped(&self) -> Option<Measured> {
        let (Job::Channel(_, planned) | Job::Wave(_, planned)) = self else { return None };
        let case = find(self.group()).expect("a case");
        let record = case.run(&planned.spec, &Context::default());
        Some(Measured::Record(Box::new(record.expect("a planned run"))))
    }

    /// What was measured against another reference; `None` where that is not in use.
    pub fn against(&self, healthy: &Measured, reference: Reference) -> Option<Measured> {
        match (self, healthy) {
            (Job::Channel(flow, _), Measured::Record(record)) => {
                let velocity = spoiled_velocity(*flow, reference)?;
                Some(Measured::Errors(errors(record, velocity)))
            }
            (Job::Limit(..), Measured::Number(ratio)) if reference == Reference::TimeStep => {
                Some(Measured::Number(ratio / 1.5))
            }
            (Job::WeakGrowth(_), Measured::Number(r)) if reference == Reference::WeakGrowth => {
                Some(Measured::Number(2.0 * r))
            }
            _ => None,
        }
    }
}

/// What drives a channel.
trait SpoilableDrive: FromMedium + Term<()> + Spoilable<Spoiled: Term<()>> {}
impl<B: FromMedium + Term<()> + Spoilable<Spoiled: Term<()>>> SpoilableDrive for B {}

type Simulation = Box<dyn Stepper<()>>;

/// The simulation of these parts with a fault, in the scheme of a healthy one.
trait Faulty {
    fn build(parts: method::Parts, fault: &Fault) -> Result<Simulation, SceneError>;
}

impl<K, F, D, W, I> Faulty for Compose<K, F, D, W, I>
where
    K: Kernel,
    F: FromMedium + Term<()> + Spoilable<Spoiled: Term<()>>,
    D: FromMedium + Term<()> + Spoilable<Spoiled: Term<()>>,
    W: Boundary + Walls<()> + Spoilable<Spoiled: Walls<()>>,
    I: Mistaken,
{
    fn build(parts: method::Parts, fault: &Fault) -> Result<Simulation, SceneError> {
        let healthy = method::scene::<Self>(parts);
        if fault.integrator {
            Ok(Box::new(spoil::<_, _, _, _, _, I::As>(healthy, fault).build()?))
        } else {
            Ok(Box::new(spoil::<_, _, _, _, _, I>(healthy, fault).build()?))
        }
    }
}

fn channel_run<B: SpoilableDrive>(flow: Flow, planned: &Planned, fault: &Fault) -> Record {
    type Fluid<B> = channel::Fluid<B>;
    let run = match planned.spec.variant.as_str() {
        "plain" | "curved" => one_channel::<Modern<Fluid<B>, Continuity>>,
        "modern" => one_channel::<Modern<Fluid<B>, Stabilised>>,
        "seed" => one_channel::<Seed<Fluid<B>, Continuity>>,
        "interface-wall" => one_channel::<Seed<Fluid<B>, Continuity, InterfaceWall>>,
        other => panic!("{other} is not considered"),
    };
    run(flow, planned, fault)
}

fn one_channel<S>(flow: Flow, planned: &Planned, fault: &Fault) -> Record
where
    S: method::Standard<Extra = ()> + Faulty,
{
    let (method, context) = (Method::of::<S>(), Context::default());
    let setup = Setup::new(flow, &settings(planned), &method, &context).expect("settings");
    let simulation = S::build(setup.parts(&method, &context), fault).expect("a scene");
    let record = channel::measured(&setup, &method, &planned.spec.variant, simulation, &context);
    record.expect("a planned run")
}

fn wave_run(case: &WaveCase, planned: &Planned, fault: &Fault) -> Record {
    let run = match planned.spec.variant.as_str() {
        "cubic-leapfrog-diffusion" => one_wave::<Diffusive<CubicSpline, Leapfrog>>,
        "cubic-leapfrog" => one_wave::<wave::Scheme<CubicSpline, Leapfrog>>,
        "cubic-pc" => one_wave::<wave::Scheme<CubicSpline, PredictorCorrector>>,
        "quintic-leapfrog" => one_wave::<wave::Scheme<QuinticSpline, Leapfrog>>,
        "quintic-pc" => one_wave::<wave::Scheme<QuinticSpline, PredictorCorrector>>,
        "wendland-leapfrog" => one_wave::<wave::Scheme<WendlandC2, Leapfrog>>,
        "wendland-pc" => one_wave::<wave::Scheme<WendlandC2, PredictorCorrector>>,
        other => panic!("{other} is not considered"),
    };
    run(case, planned, fault)
}

fn one_wave<S>(case: &WaveCase, planned: &Planned, fault: &Fault) -> Record
where
    S: method::Standard<Extra = ()> + Faulty,
{
    let (method, context) = (Method::of::<S>(), Context::default());
    let settings: WaveSettings = settings(planned);
    let wave = Wave::new(case.polarisation, &settings, &method, &context).expect("settings");
    let simulation = S::build(wave.parts(&context), fault).expect("a scene");
    let variant = &planned.spec.variant;
    wave::measured(case, &wave, &method, variant, simulation, &context).expect("a planned run")
}

/// Measured over theoretical limit of the step.
fn limit(name: &str, fault: &Fault) -> f64 {
    let (fluid, pair) = (point(name).noisy_box(), pair(name));
    let method = pair.plain();
    let build = if name.starts_with("leapfrog") {
        <Plain<CubicSpline, Leapfrog> as Faulty>::build
    } else {
        <Plain<CubicSpline, PredictorCorrector> as Faulty>::build
    };
    fluid.limit_of(method, || build(fluid.parts(method), fault)).ratio()
}

/// Measured over theoretical growth of an undamped wave.
fn weak_growth(fault: &Fault) -> f64 {
    let (fluid, pair) = (stability::undamped_box(), Pair::cubic_pc());
    let method = pair.plain();
    let build = <Plain<CubicSpline, PredictorCorrector> as Faulty>::build;
    let simulation = build(fluid.parts(method), fault).expect("a scene");
    let [growth, omega_dt] =
        fluid.stiffest_wave_of(method, simulation, COURANT, stability::WEAK_STEPS);
    growth / stability::theory_of_weak_growth(omega_dt)
}

/// u(y, t) of a spoiled reference, V, L and ν given; `None` where a flow does not use it.
type Velocity = fn(f64, f64, [f64; 3]) -> f64;

fn spoiled_velocity(flow: Flow, reference: Reference) -> Option<Velocity> {
    match (flow, reference) {
        (Flow::Couette, Reference::NoAlternation) => Some(|y, t, [v, l, nu]| {
            let term = |n: f64| {
                2.0 / (n * PI) * sin(n * PI * y / l) * exp(-n * n * PI * PI * nu * t / l / l)
            };
            v * (y / l + (1..200).map(|n| term(f64::from(n))).sum::<f64>())
        }),
        (Flow::Couette, Reference::OneTerm) => {
            Some(|y, t, [v0, l, nu]| Couette { v0, l, nu }.velocity_by_series(y, t, 1))
        }
        (Flow::Couette, Reference::Viscosity) => {
            Some(|y, t, [v0, l, nu]| Couette { v0, l, nu: 1.02 * nu }.velocity(y, t))
        }
        (Flow::Poiseuille, Reference::SeriesAdded) => Some(|y, t, [v, l, nu]| {
            let flow = Poiseuille { v, l, nu };
            2.0 * flow.steady(y) - flow.velocity(y, t)
        }),
        (Flow::Poiseuille, Reference::Viscosity) => {
            // The force stays.
            Some(|y, t, [v, l, nu]| Poiseuille { v: v / 1.02, l, nu: 1.02 * nu }.velocity(y, t))
        }
        (Flow::Poiseuille, Reference::MeanVelocity) => {
            Some(|y, t, [v, l, nu]| Poiseuille { v: 1.5 * v, l, nu }.velocity(y, t))
        }
        _ => None,
    }
}

/// `l2@τ` and `l2_worst` of a record's row means against another reference, by the same norm.
pub fn errors(record: &Record, velocity: Velocity) -> Vec<(String, f64)> {
    let setting = |key: &str| record.settings[key].as_f64().expect("a number");
    let (l, nu) = (setting("width"), setting("nu"));
    let v = setting("re") * nu / l;
    let (mut errors, mut worst) = (Vec::new(), 0.0_f64);
    for (name, profile) in &record.profiles {
        let Some(tau) = name.strip_prefix("u@") else { continue };
        let tau: f64 = tau.parse().expect("a number");
        let column = |name: &str| {
            let found = profile.columns.iter().find(|column| column.name == name);
            &found.expect("a column").values
        };
        let exact: Vec<f64> =
            column("y").iter().map(|&y| velocity(y, tau * l * l / nu, [v, l, nu])).collect();
        let scale = Scale::rms(&exact).expect("a flow");
        let error = l2(column("u"), &exact, scale).expect("finite values");
        errors.push((format!("l2@{tau}"), error));
        if tau >= 0.1 {
            worst = worst.max(error);
        }
    }
    errors.push(("l2_worst".into(), worst));
    errors
}
