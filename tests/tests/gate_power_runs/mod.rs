//! The planned runs that mutants go through, each with its gates.

use base::{gate::Gate, record::Record, spec::Task};
use fluids::channel::{self, Arrangement, ChannelSettings, Flow, Ingredient};
use harness::{
    case::{Planned, Tier, changed},
    plan,
    runner::Context,
};
use lattice::{
    acoustic_wave::Acoustic,
    shear_wave::Shear,
    stability::{self, NoisyBox, Point},
    wave::{self, Kind, Wave, WaveCase, WaveSettings},
};
use maths::{
    exact::{couette::Couette, poiseuille::Poiseuille},
    metrics::norms::{Scale, l2},
};
use serde::de::DeserializeOwned;
use solver::{
    BodyForce, Compose, Continuity, CubicSpline, DensityDiffusion, Ghosts, InterfaceWall, Kernel,
    Leapfrog, PredictorCorrector, Pressure, QuinticSpline, Scene, Scheme, Shifting, Tait, Term,
    Viscosity as Morris, WendlandC2,
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
            Measured::Record(record) => gate.value(record),
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

fn point(name: &str) -> Point {
    match name {
        "leapfrog, viscous" => Point::new::<CubicSpline, Leapfrog>(1.3, [1.0, 0.0, 0.0]),
        "leapfrog, sound" => Point::new::<CubicSpline, Leapfrog>(1.3, [f64::INFINITY, 0.0, 0.0]),
        _ => Point::new::<CubicSpline, PredictorCorrector>(1.3, [1.0, 0.0, 0.0]),
    }
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
                    Flow::Couette => channel_run::<()>(planned, fault),
                    Flow::Poiseuille => channel_run::<BodyForce>(planned, fault),
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

type Continuous<K, B, D, W, I> = Compose<K, (Pressure<Tait>, Morris, B), D, W, I>;

/// What drives a channel.
trait SpoilableDrive: channel::Drive + Spoilable<Spoiled: Term<()>> {}
impl<B: channel::Drive + Spoilable<Spoiled: Term<()>>> SpoilableDrive for B {}

fn channel_run<B: SpoilableDrive>(planned: &Planned, fault: &Fault) -> Record {
    type Stabilised = (Continuity, DensityDiffusion, Shifting);
    let variant = planned.spec.variant.as_str();
    let run = match variant {
        "plain" | "curved" => one_channel::<QuinticSpline, B, Continuity, Ghosts, Leapfrog>,
        "modern" => one_channel::<QuinticSpline, B, Stabilised, Ghosts, Leapfrog>,
        "seed" => one_channel::<CubicSpline, B, Continuity, Ghosts, PredictorCorrector>,
        "interface-wall" => {
            one_channel::<CubicSpline, B, Continuity, InterfaceWall, PredictorCorrector>
        }
        other => panic!("{other} is not considered"),
    };
    run(B::FLOW, variant, &settings(planned), fault)
}

fn one_channel<K, B, D, W, I>(
    flow: Flow,
    variant: &str,
    settings: &ChannelSettings,
    fault: &Fault,
) -> Record
where
    K: Kernel,
    B: SpoilableDrive,
    D: Ingredient + Spoilable<Spoiled: Term<()>>,
    W: Arrangement + Spoilable<Spoiled: Arrangement>,
    I: Mistaken,
{
    type Faulty<K, B, D, W, J> = Compose<
        K,
        <(Pressure<Tait>, Morris, B) as Spoilable>::Spoiled,
        <D as Spoilable>::Spoiled,
        <W as Spoilable>::Spoiled,
        J,
    >;
    let healthy = channel::scene::<Continuous<K, B, D, W, I>>;
    let context = Context::default();
    let record = if fault.integrator {
        let scene = |setup: &_| spoil::<_, _, _, _, _, I::As>(healthy(setup), fault);
        let run = channel::run_scene::<Faulty<K, B, D, W, I::As>>;
        run(flow, variant, settings, &[], &context, scene)
    } else {
        let scene = |setup: &_| spoil::<_, _, _, _, _, I>(healthy(setup), fault);
        let run = channel::run_scene::<Faulty<K, B, D, W, I>>;
        run(flow, variant, settings, &[], &context, scene)
    };
    record.expect("a planned run")
}

fn wave_run(case: &WaveCase, planned: &Planned, fault: &Fault) -> Record {
    let (variant, settings) = (planned.spec.variant.as_str(), settings(planned));
    let run = match variant {
        "cubic-leapfrog-diffusion" => diffusive_wave,
        "cubic-leapfrog" => one_wave::<CubicSpline, Leapfrog>,
        "cubic-pc" => one_wave::<CubicSpline, PredictorCorrector>,
        "quintic-leapfrog" => one_wave::<QuinticSpline, Leapfrog>,
        "quintic-pc" => one_wave::<QuinticSpline, PredictorCorrector>,
        "wendland-leapfrog" => one_wave::<WendlandC2, Leapfrog>,
        "wendland-pc" => one_wave::<WendlandC2, PredictorCorrector>,
        other => panic!("{other} is not considered"),
    };
    run(case, variant, &settings, fault)
}

fn one_wave<K: Kernel, I: Mistaken>(
    case: &WaveCase,
    variant: &str,
    settings: &WaveSettings,
    fault: &Fault,
) -> Record {
    let context = Context::default();
    let record = if fault.integrator {
        let scene = |wave: &Wave| spoil::<_, _, _, _, _, I::As>(wave.scene::<K, I>(), fault);
        wave::run_scene(case, variant, settings, &context, scene)
    } else {
        let scene = |wave: &Wave| spoil::<_, _, _, _, _, I>(wave.scene::<K, I>(), fault);
        wave::run_scene(case, variant, settings, &context, scene)
    };
    record.expect("a planned run")
}

fn diffusive_wave(
    case: &WaveCase,
    variant: &str,
    settings: &WaveSettings,
    fault: &Fault,
) -> Record {
    type Old = <Leapfrog as Mistaken>::As;
    let context = Context::default();
    let healthy = Wave::diffusive_scene::<CubicSpline, Leapfrog>;
    let record = if fault.integrator {
        let scene = |wave: &Wave| spoil::<_, _, _, _, _, Old>(healthy(wave), fault);
        wave::run_scene(case, variant, settings, &context, scene)
    } else {
        let scene = |wave: &Wave| spoil::<_, _, _, _, _, Leapfrog>(healthy(wave), fault);
        wave::run_scene(case, variant, settings, &context, scene)
    };
    record.expect("a planned run")
}

/// Measured over theoretical limit of the step.
fn limit(name: &str, fault: &Fault) -> f64 {
    let fluid = point(name).noisy_box::<CubicSpline>();
    if name.starts_with("leapfrog") {
        limit_of::<Leapfrog>(&fluid, fault)
    } else {
        limit_of::<PredictorCorrector>(&fluid, fault)
    }
}

fn limit_of<I: Mistaken>(fluid: &NoisyBox<CubicSpline>, fault: &Fault) -> f64 {
    if fault.integrator {
        fluid.limit_of(|| spoil::<_, _, _, _, _, I::As>(fluid.plain::<I>(), fault)).ratio()
    } else {
        fluid.limit_of(|| spoil::<_, _, _, _, _, I>(fluid.plain::<I>(), fault)).ratio()
    }
}

/// Measured over theoretical growth of an undamped wave.
fn weak_growth(fault: &Fault) -> f64 {
    type I = PredictorCorrector;
    fn ratio<S: Scheme<Extra = ()>>(fluid: &NoisyBox<CubicSpline>, scene: Scene<S>) -> f64 {
        let [growth, omega_dt] = fluid.stiffest_wave_of(scene, COURANT, stability::WEAK_STEPS);
        growth / stability::theory_of_weak_growth(omega_dt)
    }
    let fluid = stability::undamped_box();
    if fault.integrator {
        ratio(&fluid, spoil::<_, _, _, _, _, <I as Mistaken>::As>(fluid.plain::<I>(), fault))
    } else {
        ratio(&fluid, spoil::<_, _, _, _, _, I>(fluid.plain::<I>(), fault))
    }
}

/// u(y, t) of a spoiled reference, V, L and ν given; `None` where a flow does not use it.
type Velocity = fn(f64, f64, [f64; 3]) -> f64;

fn spoiled_velocity(flow: Flow, reference: Reference) -> Option<Velocity> {
    match (flow, reference) {
        (Flow::Couette, Reference::NoAlternation) => Some(|y, t, [v, l, nu]| {
            let term = |n: f64| {
                2.0 / (n * PI) * (n * PI * y / l).sin() * (-n * n * PI * PI * nu * t / l / l).exp()
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
