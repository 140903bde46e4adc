//! A solid case around a problem: variants, settings, and what every record states.

use std::marker::PhantomData;

use solver::{
    CubicSpline, Integrator, Kernel, Linear, Observer, Scene, Scheme, Simulation, Symmetric,
};

use super::{Bare, Method, Plain, Seed, Solid};
use base::{
    number,
    record::{self, Cost, Record, Status},
    settings::{self, Field, Settings, Value},
};
use harness::{
    case::{self, Case, Planned, RunError, Tier, Variant},
    runner::{self, Context, Frames},
    suite::{JudgedRun, Study},
};

/// A problem of elasticity: what differs between solid cases.
pub trait Problem: Send + Sync + 'static {
    /// Name on the command line.
    const NAME: &'static str;
    /// The problem in words.
    const ABOUT: &'static str;
    /// Its settings, by [`solid_settings!`](crate::solid_settings!).
    type Settings: Settings;

    /// One run with a method.
    fn run<M: Method>(
        variant: &str,
        settings: &Self::Settings,
        context: &Context,
    ) -> Result<Record, RunError>;
    /// The judged runs.
    fn plan(tier: Tier) -> Vec<Planned>;
    /// What the runs say together.
    fn studies(tier: Tier, runs: &[JudgedRun]) -> Vec<Study>;
}

/// A problem as a [`Case`].
pub struct SolidCase<P>(PhantomData<P>);

impl<P> SolidCase<P> {
    /// The case of the problem `P`.
    pub const CASE: Self = Self(PhantomData);
}

type Run<S> = fn(&str, &S, &Context) -> Result<Record, RunError>;

/// A method as a variant of a problem.
struct SolidVariant<S> {
    variant: Variant,
    unused: &'static [&'static str],
    run: Run<S>,
}

fn variants<P: Problem>() -> Vec<SolidVariant<P::Settings>> {
    fn entry<P: Problem, M: Method>(
        name: &'static str,
        about: &'static str,
    ) -> SolidVariant<P::Settings> {
        SolidVariant { variant: Variant { name, about }, unused: M::UNUSED, run: P::run::<M> }
    }
    vec![
        entry::<P, Seed>(
            "seed",
            "what the paper describes: predictor-corrector, artificial viscosity, artificial stress in \
             principal axes, XSPH",
        ),
        entry::<P, Plain>("plain", "the same terms without XSPH, stepped by the leapfrog"),
        entry::<P, Bare>(
            "bare",
            "the equations (3), (9)-(12) and nothing that stabilises, stepped by the leapfrog",
        ),
    ]
}

impl<S: Settings> SolidVariant<S> {
    /// The settings with `key=value` texts applied; those of absent terms are 0 or, where that is
    /// out of range, what they are.
    fn settings(&self, set: &[String]) -> Result<S, RunError> {
        let key = |text: &String| text.split('=').next().unwrap_or_default().trim().to_string();
        if let Some(key) = set.iter().map(key).find(|key| self.unused.contains(&key.as_str())) {
            return Err(RunError::Unused { key, variant: self.variant.name.into() });
        }
        let mut settings = S::default();
        for absent in self.unused {
            if let Some(Value::Real(_)) = settings.get(absent) {
                settings.set(absent, "0")?;
            }
        }
        settings::apply(&mut settings, set)?;
        settings.validate()?;
        Ok(settings)
    }
}

impl<P: Problem> SolidCase<P> {
    fn variant<T>(
        name: &str,
        then: impl FnOnce(&SolidVariant<P::Settings>) -> Result<T, RunError>,
    ) -> Result<T, RunError> {
        let variants = variants::<P>();
        then(case::find(P::NAME, &variants, name, |v| v.variant.name)?)
    }
}

impl<P: Problem> Case for SolidCase<P> {
    fn name(&self) -> &'static str {
        P::NAME
    }

    fn about(&self) -> &'static str {
        P::ABOUT
    }

    fn variants(&self) -> Vec<Variant> {
        variants::<P>().into_iter().map(|v| v.variant).collect()
    }

    fn fields(&self) -> &'static [Field] {
        P::Settings::FIELDS
    }

    fn settings(&self, variant: &str, set: &[String]) -> Result<serde_json::Value, RunError> {
        let settings = Self::variant(variant, |v| v.settings(set))?;
        Ok(serde_json::to_value(settings).unwrap_or_default())
    }

    fn run(&self, variant: &str, set: &[String], context: &Context) -> Result<Record, RunError> {
        Self::variant(variant, |v| (v.run)(variant, &v.settings(set)?, context))
    }

    fn plan(&self, tier: Tier) -> Vec<Planned> {
        P::plan(tier)
    }

    fn studies(&self, tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
        P::studies(tier, runs)
    }
}

/// A record of a run of the method `M`, with what it chose.
pub fn describe<P: Problem, M: Method>(
    variant: &str,
    settings: &P::Settings,
    solid: &Solid,
    [dx, dt]: [f64; 2],
    context: &Context,
) -> Record {
    let json = serde_json::to_value(settings).unwrap_or_default();
    let mut record = Record::new(P::NAME, variant, json, context.threads.max(1));
    let material = &solid.material;
    let numbers = [
        ("h/dx", solid.h_over_dx),
        ("dx [m]", dx),
        ("K [Pa]", material.bulk),
        ("mu [Pa]", material.shear),
        ("c0 [m/s]", material.sound_speed()),
        ("c_p [m/s]", material.p_wave_speed()),
        ("dt [s]", dt),
        ("dt c_p/h", dt * material.p_wave_speed() / solid.h(dx)),
    ];
    let numerics = &mut record.numerics;
    numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    numerics.insert("kernel".into(), CubicSpline::NAME.into());
    numerics.insert("integrator".into(), M::Integrator::NAME.into());
    record
}

/// The times of a run: its end \[s\], and the times of frames before it.
///
/// A stop brings the leapfrog's velocities to a whole step, so there is none that nobody asked for.
/// Refused where more than ten million steps would be needed.
fn steps_and_frames(end: f64, dt: f64, context: &Context) -> Result<Vec<f64>, RunError> {
    let (value, most) = (end / dt, 1e7);
    if value > most {
        return Err(RunError::TooMuch { what: "the steps", value, most, setting: "end or dt" });
    }
    let count = context.frames.as_ref().map_or(1, |(_, count)| *count.max(&1));
    Ok((1..=count).map(|k| end * (k as f64 / count as f64)).collect())
}

/// A run that is over.
pub struct Ran<S: Scheme> {
    /// The simulation at its end.
    pub simulation: Simulation<S>,
    /// How it ended.
    pub status: Status,
    /// What it took.
    pub cost: Cost,
}

/// Steps a scene to its end with an observer, writing frames if the context asks for any.
pub fn run_to<S: Scheme<Extra = Symmetric>>(
    mut scene: Scene<S>,
    [dt, end]: [f64; 2],
    eos: Linear,
    context: &Context,
    observer: &mut impl Observer<S>,
) -> Result<Ran<S>, RunError> {
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let times = steps_and_frames(end, dt, context)?;
    let mut simulation = scene.build()?;
    let frames = Frames::of(context)?;
    let mut failed = None;
    let (status, cost) =
        runner::drive(&mut simulation, dt, &times, context, observer, &mut |simulation, _| {
            if let Some(frames) = &frames {
                failed = failed.take().or(frames.write(simulation, &eos).err());
            }
        });
    match failed {
        Some(error) => Err(error.into()),
        None => Ok(Ran { simulation, status, cost }),
    }
}

/// A digest of the state at the end.
pub fn digest<S: Scheme<Extra = Symmetric>>(simulation: &Simulation<S>) -> String {
    let numbers = |p: solver::Particle<Symmetric>| {
        let Symmetric { xx, yy, xy } = p.extra;
        [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density, xx, yy, xy]
    };
    let all: Vec<[f64; 8]> = simulation.particles().into_iter().map(numbers).collect();
    record::digest(all.as_flattened())
}
