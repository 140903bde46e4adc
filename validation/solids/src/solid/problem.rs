//! A problem of elasticity: its variants, what every record states, and how it is stepped.

use solver::{
    CubicSpline, EquationOfState, Integrator, Kernel, Linear, Observer, Scene, Scheme, Simulation,
    Stepper, Symmetric,
};

use super::{Bare, Method, Plain, Seed, Solid};
use base::{
    number,
    record::{self, Cost, Record, Status},
    settings::{Settings, Value},
};
use harness::{
    case::{RunError, Variant},
    composed::Composition,
    runner::{self, Context},
};

/// Settings by [`solid_settings!`](crate::solid_settings!).
pub trait SharedSettings: Settings {
    /// What all solid cases share.
    fn solid(&self) -> Solid;
}

/// A problem of elasticity, stated by its settings: what differs between solid cases.
pub trait Problem: SharedSettings {
    /// Name of the case.
    const NAME: &'static str;

    /// Spacing \[m\].
    fn dx(&self) -> f64;
    /// Largest speed at the start \[m/s\].
    fn speed(&self) -> f64;
    /// One run with a method.
    fn run<M: Method>(
        variant: &str,
        settings: &Self,
        context: &Context,
    ) -> Result<Record, RunError>;
}

/// The methods as variants of a problem.
pub fn variants<P: Problem>() -> Vec<Composition<P>> {
    fn entry<P: Problem, M: Method>(name: &'static str, about: &'static str) -> Composition<P> {
        Composition {
            variant: Variant { name, about },
            adjust: leave_out::<P, M>,
            run: P::run::<M>,
            rules: |s| Ok(s.solid().rules(s.dx(), s.speed(), M::COURANT)),
            lacks: M::UNUSED.to_vec(),
        }
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

/// Settings of terms that a method lacks are 0, or stay what they are where that is out of range.
fn leave_out<P: Problem, M: Method>(settings: &mut P) {
    for name in M::UNUSED {
        if let Some(Value::Real(_)) = settings.get(name) {
            let _out_of_range = settings.set(name, "0");
        }
    }
}

/// A record of a run of the method `M`, with what it chose, and the time step \[s\].
pub fn begin<P: Problem, M: Method>(
    variant: &str,
    settings: &P,
    context: &Context,
) -> Result<(Record, f64), RunError> {
    let (solid, dx) = (settings.solid(), settings.dx());
    let dt = solid.time_step(solid.rules(dx, settings.speed(), M::COURANT), context)?;
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
    Ok((record, dt))
}

/// A run that has ended.
pub struct Finished<S: Scheme> {
    /// The simulation at its end.
    pub simulation: Simulation<S>,
    /// How it ended.
    pub status: Status,
    /// What it took.
    pub cost: Cost,
}

/// Steps a scene to its end \[s\] with an observer; refused where more than ten million steps would be
/// needed.
pub fn run_to<S: Scheme<Extra = Symmetric>>(
    mut scene: Scene<S>,
    [dt, end]: [f64; 2],
    eos: Linear,
    context: &Context,
    observer: &mut dyn Observer<S::Extra>,
) -> Result<Finished<S>, RunError> {
    let (value, most) = (end / dt, 1e7);
    if value > most {
        return Err(RunError::TooMuch { what: "the steps", value, most, setting: "end or dt" });
    }
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let pressure = |density| eos.pressure(density);
    // No stop but the end: one would bring the leapfrog's velocities to a whole step.
    let (status, cost) =
        runner::drive(&mut simulation, dt, &[end], context, observer, &pressure, &mut |_, _| {})?;
    Ok(Finished { simulation, status, cost })
}

/// A digest of the state at the end.
pub fn digest(simulation: &dyn Stepper<Symmetric>) -> String {
    let numbers = |p: solver::Particle<Symmetric>| {
        let Symmetric { xx, yy, xy } = p.extra;
        [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density, xx, yy, xy]
    };
    let all: Vec<[f64; 8]> = simulation.particles().into_iter().map(numbers).collect();
    record::digest(all.as_flattened())
}
