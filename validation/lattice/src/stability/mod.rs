//! A lattice at rest: the largest stable time step, measured, against linear theory.
//!
//! A box of 12 × 12 particles at rest with velocity noise of 1e-8 c₀ runs for N steps at a dt; dt is
//! bisected to 0.4 %. It grows if its energy (kinetic and acoustic) exceeds a hundred times the start
//! at some step, where the run stops, or if its mean over the last quarter of the steps exceeds that
//! over the second quarter by half. N = ½/(the growth rate a step that theory gives 0.5 % beyond the
//! limit), at least 300 and at most 12 000: so weakly growing modes have time to show.

mod baseline;
mod beyond;
mod noisy_box;
mod studies;

pub use noisy_box::{Limit, NoisyBox, Pair, Plain, Theory};

use std::rc::Rc;

use base::{
    gate::{Bound, Evidence, Gate},
    record::{MetricKey, Record, Status},
    spec::{Bisect, RunSpec},
};
use harness::{
    bisect::{Bracket, STABLE, UNSTABLE},
    case::{Planned, Tier},
    composed::{Best, Composed, Composition},
    declare::Declaration,
    runs::Runs,
};
use maths::theory::time_step;

use crate::extremes;

base::settings! {
    /// Settings of a periodic lattice at rest with velocity noise; its side, its density and its sound
    /// speed are 1.
    pub struct BoxSettings {
        /// particles along each side
        n: usize ["-"] in 4..=400 = 12,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.3,
        /// ratio of sound to viscosity, c0 h/nu; auto: no viscosity
        stiffness: Option<f64> ["-"] in 1e-6..=1e9 = Some(10.0),
        /// alpha of the artificial viscosity, on every pair
        alpha: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// delta of the density diffusion
        delta: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// time step
        courant: f64 ["h/c0"] in 1e-9..=1e3 = 0.25,
        /// number of time steps
        steps: usize ["-"] in 4..=100000000 = 300,
        /// do all steps; otherwise the run is over as soon as its energy exceeds a hundred times that of
        /// the start
        to_the_end: bool = false,
    }
}

/// Did the energy grow?
pub const GREW: MetricKey = MetricKey::new(
    "grew",
    "-",
    "1 if the energy exceeded a hundred times that of the start at some step, or in the mean of the last \
     quarter of the steps 1.5 times that of the second; else 0",
);
/// The energy of the end.
pub const ENERGY: MetricKey =
    MetricKey::new("energy_ratio", "-", "kinetic and acoustic energy at the end/at the start");
/// Growth of the stiffest wave.
pub const WAVE_GROWTH: MetricKey = MetricKey::new(
    "wave_growth",
    "1/step",
    "ln(amplitude at the end/at the start)/steps, of the sound wave of highest frequency",
);
/// Phase that the stiffest wave turns by in a step.
pub const WAVE_ANGLE: MetricKey =
    MetricKey::new("wave_angle", "-", "omega dt of that wave on the lattice, exact in time");

/// A lattice at rest.
pub static RESTING_BOX: Composed<BoxSettings> = Composed {
    name: "resting_box",
    problem: "Small noise at rest: is the time step stable?",
    best: Best {
        variant: "cubic-leapfrog",
        because: "all have the limit that theory predicts, and this one takes the fewest pairs a step",
        papers: None,
    },
    about: "Velocity noise of 1e-8 c0 excites every wave of a periodic lattice at rest. Its energy grows \
            if the time step is beyond the limit that linear theory of the same box predicts.",
    variants,
    is_stable,
    declaration: |_| Declaration::default(),
    plan,
    studies: studies::all,
};

fn is_stable(record: &Record) -> bool {
    record.status == Status::Completed && record.value(GREW) == Some(0.0)
}

fn variants() -> Vec<Composition<BoxSettings>> {
    let about = "one kernel and one integrator; the equations, and damping if it is set";
    let variant = |pair: Pair| {
        let (name, pair) = (pair.name, Rc::new(pair));
        let ruled = Rc::clone(&pair);
        let adjust: fn(&mut BoxSettings) = match pair.h_over_dx {
            1.0 => |s| s.h_over_dx = 1.0,
            2.0 => |s| s.h_over_dx = 2.0,
            _ => |_| (),
        };
        Composition::new(
            (name, about),
            adjust,
            move |variant, settings, context| noisy_box::run(&pair, variant, settings, context),
            move |settings| noisy_box::rules(&ruled, settings),
            Vec::new(),
        )
    };
    Pair::all().map(variant).collect()
}

/// Particles along each side of the box: three supports of the widest kernel. Theory is that of the same
/// box. A larger one has waves between, of which one may be stiffer: with 20 limits are up to 1.6 %
/// shorter, measured and in theory, and take twice as long to find.
const SIDE: usize = 12;
/// c₀h/ν of the study; the leapfrog also without viscosity.
const STIFFNESS: [f64; 5] = [1.0, 3.0, 10.0, 30.0, 100.0];

/// One bisection: kernel and integrator, the box, theory.
pub struct Point {
    variant: &'static str,
    kernel: &'static str,
    integrator: &'static str,
    settings: BoxSettings,
    theory: Theory,
}

impl Point {
    /// Kernel and integrator at h/dx, c₀h/ν, α and δ.
    pub fn new(pair: &Pair, h_over_dx: f64, [stiffness, alpha, delta]: [f64; 3]) -> Self {
        let stiffness = stiffness.is_finite().then_some(stiffness);
        let mut settings =
            BoxSettings { n: SIDE, h_over_dx, stiffness, alpha, delta, ..Default::default() };
        let theory = NoisyBox::new(&settings).theory(pair.plain());
        (settings.courant, settings.steps) = (theory.limit, theory.steps);
        let (kernel, integrator) = (pair.plain().kernel, pair.plain().integrator);
        Self { variant: pair.name, kernel, integrator, settings, theory }
    }

    /// The box of this point.
    pub fn noisy_box(&self) -> NoisyBox {
        NoisyBox::new(&self.settings)
    }

    /// c₀h/ν, infinite without viscosity.
    fn stiffness(&self) -> f64 {
        self.settings.stiffness.unwrap_or(f64::INFINITY)
    }

    /// The bisection.
    fn spec(&self) -> RunSpec {
        let bisect = Bisect {
            setting: "courant".into(),
            guess: self.theory.limit,
            unit: 1.0,
            resolution: noisy_box::RESOLUTION,
            end: None,
        };
        RESTING_BOX
            .spec(self.variant, |s| *s = self.settings.clone())
            .allow_unstable()
            .bisect(bisect)
    }

    /// What it found, beside theory.
    fn limit(&self, runs: &Runs) -> Limit {
        let bracket = |record: &Record| {
            let [stable, unstable] = [STABLE, UNSTABLE].map(|name| record.metric(name));
            Some(Bracket { stable: stable?, unstable: unstable? })
        };
        Limit { measured: runs.completed(&self.spec()).and_then(bracket), theory: self.theory }
    }

    /// What damps, in words.
    fn fluid(&self) -> String {
        let number = |name: &str, x: f64| format!("{name} = {x}");
        let BoxSettings { stiffness, alpha, delta, .. } = self.settings;
        let parts = [
            stiffness.map(|stiffness| number("c₀h/ν", stiffness)),
            (alpha > 0.0).then(|| number("α", alpha)),
            (delta > 0.0).then(|| number("δ", delta)),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { "nothing damps".into() } else { parts.join(", ") }
    }

    /// Name in gates.
    fn id(&self) -> String {
        let Self { kernel, integrator, .. } = self;
        let BoxSettings { h_over_dx, alpha, delta, .. } = self.settings;
        let damping = match alpha > 0.0 || delta > 0.0 {
            false => String::new(),
            true => format!(".alpha{alpha}.delta{delta}"),
        };
        let stiffness = self.stiffness();
        format!("stability.{kernel}.h{h_over_dx}.{integrator}.stiffness{stiffness}{damping}")
    }
}

/// All points of one kernel. In the quick tier: of the seed's kernel the leapfrog at every stiffness and the
/// predictor-corrector up to 10, for beyond that weak growth needs thousands of steps to show; of another
/// one the leapfrog at the ends and in the middle.
fn points_of([leapfrog, midpoint]: &[Pair; 2], h_over_dx: f64, tier: Tier) -> Vec<Point> {
    let mut points = Vec::new();
    let (every, weakest) = match tier {
        Tier::Full => (1, f64::INFINITY),
        Tier::Quick if leapfrog.name == "cubic-leapfrog" => (1, 10.0),
        Tier::Quick => (2, 0.0),
    };
    let mut add = |pair, damping| points.push(Point::new(pair, h_over_dx, damping));
    for stiffness in STIFFNESS.into_iter().step_by(every) {
        add(leapfrog, [stiffness, 0.0, 0.0]);
        if stiffness <= weakest {
            add(midpoint, [stiffness, 0.0, 0.0]);
        }
    }
    add(leapfrog, [f64::INFINITY, 0.0, 0.0]);
    add(leapfrog, [f64::INFINITY, 1.0, 0.0]);
    add(leapfrog, [f64::INFINITY, 0.0, 1.0]);
    if tier == Tier::Full {
        add(midpoint, [f64::INFINITY, 1.0, 0.0]);
        add(leapfrog, [30.0, 0.1, 0.1]);
        add(leapfrog, [f64::INFINITY, 0.1, 0.0]);
    }
    points
}

fn points(tier: Tier) -> Vec<Point> {
    let cubic = [Pair::cubic_leapfrog(), Pair::cubic_pc()];
    let mut points = points_of(&cubic, 1.3, tier);
    points.extend(points_of(&Pair::quintic(), 1.0, tier));
    let damped =
        [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [10.0, 0.0, 0.0], [30.0, 0.0, 0.0], [30.0, 0.1, 0.1]];
    points.extend(damped.map(|damping| Point::new(&Pair::cubic_super(), 1.3, damping)));
    if tier == Tier::Full {
        points.extend(points_of(&cubic, 1.2, tier));
        points.extend(points_of(&Pair::wendland(), 2.0, tier));
    }
    points
}

/// Courant numbers at which the weak growth of the predictor-corrector is measured.
const WEAK: [f64; 5] = [0.2, 0.3, 0.4, 0.5, 0.7];
/// Steps of that measurement.
pub const WEAK_STEPS: usize = 300;

/// The box of that measurement.
pub fn undamped_box() -> NoisyBox {
    NoisyBox { n: SIDE, h_over_dx: 1.3, stiffness: f64::INFINITY, alpha: 0.0, delta: 0.0 }
}

/// Measures the growth of the stiffest wave at one Courant number.
fn weak_growth(variant: &str, courant: f64) -> RunSpec {
    let set = |s: &mut BoxSettings| {
        (s.n, s.h_over_dx, s.stiffness) = (SIDE, 1.3, None);
        (s.courant, s.steps, s.to_the_end) = (courant, WEAK_STEPS, true);
    };
    RESTING_BOX.spec(variant, set).allow_unstable()
}

/// The same of the predictor-corrector.
fn weak(courant: f64) -> RunSpec {
    weak_growth("cubic-pc", courant)
}

fn plan(tier: Tier) -> Vec<Planned> {
    // A bisection takes about a dozen runs, a step of a box about 50 µs.
    let seconds = |point: &Point| 6e-4 * point.theory.steps as f64;
    let limits = points(tier);
    let limits = limits.iter().map(|point| Planned::new(point.spec()).taking(seconds(point)));
    let weak = WEAK.map(|courant| Planned::new(weak(courant)).taking(0.02));
    limits.chain(weak).chain(extremes::plan(beyond::experiments())).collect()
}

/// The gate on a measured limit over its theory.
pub fn ratio_gate(point: &Point) -> Gate {
    Gate::new(
        format!("{}.ratio", point.id()),
        "measured limit/theory",
        Bound::Within(0.97, 1.03),
        Evidence::Theory,
        "Linear theory of the same box is exact. Bisection resolves 0.4 %, and the criterion of growth 0.5 \
         %.",
    )
}

/// The gate on a measured growth a step over its theory.
pub fn weak_gate(courant: f64) -> Gate {
    Gate::new(
        format!("stability.weak-growth.courant{courant}"),
        "growth a step/theory",
        Bound::Within(0.999, 1.001),
        Evidence::Theory,
        "The energy of one wave grows by the factor 1 + (omega dt)^4/4 a step, whatever its phase. Noise \
         of 1e-8 c0 leaves 1e-8 for round-off and nonlinearity.",
    )
}

/// What linear theory gives for the growth of an undamped wave a step.
pub fn theory_of_weak_growth(omega_dt: f64) -> f64 {
    time_step::predictor_corrector_growth(omega_dt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::gate::check_all;
    use harness::{case::Case, context::Context};

    fn limit(pair: &Pair, stiffness: f64) -> Limit {
        let fluid = Point::new(pair, 1.3, [stiffness, 0.0, 0.0]).noisy_box();
        let method = pair.plain();
        fluid.limit_of(method, || (method.build)(fluid.parts(method)))
    }

    #[test]
    fn boxes_have_the_limits_of_theory() {
        let (leapfrog, midpoint) = (Pair::cubic_leapfrog(), Pair::cubic_pc());
        for limit in [
            limit(&Pair::cubic_super(), 1.0),
            limit(&Pair::cubic_super(), 10.0),
            limit(&leapfrog, 1.0),
            limit(&leapfrog, f64::INFINITY),
            limit(&midpoint, 1.0),
            limit(&midpoint, 10.0),
        ] {
            assert!((limit.ratio() - 1.0).abs() < 0.03, "{limit:?}");
        }
    }

    #[test]
    fn undamped_sound_grows_as_theory_says_and_not_in_the_leapfrog() {
        let record = |spec: RunSpec| RESTING_BOX.run(&spec, &Context::default()).expect("a run");
        let run = record(weak(0.5));
        let [growth, angle] =
            [WAVE_GROWTH, WAVE_ANGLE].map(|key| run.value(key).expect("a number"));
        assert!((growth / theory_of_weak_growth(angle) - 1.0).abs() < 1e-4);
        // The leapfrog's energy beats by ω dt, and that is all.
        let run = record(weak_growth("cubic-leapfrog", 0.5));
        assert!(run.value(WAVE_GROWTH).expect("measured").abs() < 3e-3, "{:?}", run.metrics);
    }

    /// What the plan bisects is what the limit of a scene is bisected by.
    #[test]
    fn a_planned_limit_is_that_of_its_scene() {
        let point = Point::new(&Pair::cubic_leapfrog(), 1.3, [1.0, 0.0, 0.0]);
        let spec = point.spec();
        let record =
            harness::make::run(&RESTING_BOX, &spec, &Context::default()).expect("a record");
        let found = limit(&Pair::cubic_leapfrog(), 1.0).measured.expect("a limit");
        assert_eq!(record.metric(STABLE), Some(found.stable));
        assert_eq!(record.metric(UNSTABLE), Some(found.unstable));
    }

    #[test]
    fn a_step_beyond_the_limit_is_refused_unless_allowed() {
        let spec = RESTING_BOX.spec("cubic-leapfrog", |s| s.courant = 2.0);
        assert!(RESTING_BOX.run(&spec, &Context::default()).is_err());
        let record = RESTING_BOX.run(&spec.allow_unstable(), &Context::default()).expect("a run");
        assert!(!is_stable(&record) && record.value(GREW) == Some(1.0));
    }

    #[test]
    fn every_point_has_a_name_of_its_own_and_a_baseline() {
        let points = points(Tier::Full);
        let gates: Vec<Gate> = points.iter().map(ratio_gate).collect();
        assert_eq!(check_all(&gates), Ok(()));
        for point in points {
            assert!(baseline::limit_gate(&point.id()).is_some(), "{}", point.id());
        }
    }
}
