//! The largest stable time step, measured, against linear theory; and how far the default steps of
//! the channel variants are from it.
//!
//! A box of 12 × 12 particles at rest with velocity noise of 1e-8 c₀ runs for N steps at a dt; dt is
//! bisected to 0.4 %. It grows if its energy (kinetic and acoustic) exceeds a hundred times the start
//! at some step, where the run stops, or if its mean over the last quarter of the steps exceeds that
//! over the second quarter by half. N = ½/(the growth rate a step that theory gives 0.5 % beyond the
//! limit), at least 300 and at most 12 000: so weakly growing modes have time to show.

mod baseline;
mod defaults;
mod noisy_box;

pub use defaults::{DefaultStep, measure_default};
pub use harness::bisect::{Bracket, Growth, largest_stable};
pub use noisy_box::{Limit, NOISE, NoisyBox};

use std::marker::PhantomData;

use rayon::prelude::*;
use solver::{
    CubicSpline, Integrator, Kernel, Leapfrog, PredictorCorrector, QuinticSpline, WendlandC2,
};

use base::gate::{Bound, Evidence, Gate};
use harness::{case::Tier, suite::Study};
use maths::theory::{Stepping, lattice::SquareLattice, time_step};
use report::{Axis, Cell, Colour, Column, Dash, Figure, Layer, Plot, Series, Shape, Table};

/// Particles along each side of the box: three supports of the widest kernel. Theory is that of the same
/// box. A larger one has waves between, of which one may be stiffer: with 20 limits are up to 1.6 %
/// shorter, measured and in theory, and take twice as long to find.
const SIDE: usize = 12;
/// c₀h/ν of the study; the leapfrog also without viscosity.
const STIFFNESS: [f64; 5] = [1.0, 3.0, 10.0, 30.0, 100.0];
/// Where "no viscosity" stands on the axis of c₀h/ν.
const INVISCID_AT: f64 = 1000.0;

/// One bisection: what it is called, and its doing.
pub struct Point {
    kernel: &'static str,
    h_over_dx: f64,
    integrator: &'static str,
    stiffness: f64,
    alpha: f64,
    delta: f64,
    measure: fn(&Point) -> Limit,
}

fn measure<K: Kernel, I: Stepping>(point: &Point) -> Limit {
    point.noisy_box::<K>().limit::<I>()
}

impl Point {
    /// Kernel and integrator at h/dx, c₀h/ν, α and δ.
    pub fn new<K: Kernel, I: Stepping>(
        h_over_dx: f64,
        [stiffness, alpha, delta]: [f64; 3],
    ) -> Self {
        let (kernel, integrator) = (K::NAME, <I as Integrator<()>>::NAME);
        Self { kernel, h_over_dx, integrator, stiffness, alpha, delta, measure: measure::<K, I> }
    }

    /// The box of this point, seen through its kernel.
    pub fn noisy_box<K: Kernel>(&self) -> NoisyBox<K> {
        let Point { h_over_dx, stiffness, alpha, delta, .. } = *self;
        NoisyBox { n: SIDE, h_over_dx, stiffness, alpha, delta, kernel: PhantomData }
    }

    /// What damps, in words.
    fn fluid(&self) -> String {
        let number = |name: &str, x: f64| format!("{name} = {x}");
        let parts = [
            self.stiffness.is_finite().then(|| number("c₀h/ν", self.stiffness)),
            (self.alpha > 0.0).then(|| number("α", self.alpha)),
            (self.delta > 0.0).then(|| number("δ", self.delta)),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { "nothing damps".into() } else { parts.join(", ") }
    }

    /// Name in gates.
    fn id(&self) -> String {
        let Self { kernel, h_over_dx, integrator, stiffness, alpha, delta, .. } = self;
        let damping = match (alpha > &0.0, delta > &0.0) {
            (false, false) => String::new(),
            _ => format!(".alpha{alpha}.delta{delta}"),
        };
        format!("stability.{kernel}.h{h_over_dx}.{integrator}.stiffness{stiffness}{damping}")
    }
}

/// All points of one kernel. In the quick tier: of the seed's kernel the leapfrog at every stiffness and the
/// predictor-corrector up to 10, for beyond that weak growth needs thousands of steps to show; of another
/// one the leapfrog at the ends and in the middle.
fn points_of<K: Kernel>(h_over_dx: f64, tier: Tier) -> Vec<Point> {
    let mut points = Vec::new();
    let (every, weakest) = match tier {
        Tier::Full => (1, f64::INFINITY),
        Tier::Quick if K::NAME == CubicSpline::NAME => (1, 10.0),
        Tier::Quick => (2, 0.0),
    };
    for stiffness in STIFFNESS.into_iter().step_by(every) {
        points.push(Point::new::<K, Leapfrog>(h_over_dx, [stiffness, 0.0, 0.0]));
        if stiffness <= weakest {
            points.push(Point::new::<K, PredictorCorrector>(h_over_dx, [stiffness, 0.0, 0.0]));
        }
    }
    points.push(Point::new::<K, Leapfrog>(h_over_dx, [f64::INFINITY, 0.0, 0.0]));
    for (alpha, delta) in [(1.0, 0.0), (0.0, 1.0)] {
        points.push(Point::new::<K, Leapfrog>(h_over_dx, [f64::INFINITY, alpha, delta]));
    }
    if tier == Tier::Full {
        points.push(Point::new::<K, PredictorCorrector>(h_over_dx, [f64::INFINITY, 1.0, 0.0]));
        points.push(Point::new::<K, Leapfrog>(h_over_dx, [30.0, 0.1, 0.1]));
        points.push(Point::new::<K, Leapfrog>(h_over_dx, [f64::INFINITY, 0.1, 0.0]));
    }
    points
}

fn points(tier: Tier) -> Vec<Point> {
    let mut points = points_of::<CubicSpline>(1.3, tier);
    points.extend(points_of::<QuinticSpline>(1.0, tier));
    if tier == Tier::Full {
        points.extend(points_of::<CubicSpline>(1.2, tier));
        points.extend(points_of::<WendlandC2>(2.0, tier));
    }
    points
}

/// Courant numbers at which the weak growth of the predictor-corrector is measured, and the steps.
const WEAK: [f64; 5] = [0.2, 0.3, 0.4, 0.5, 0.7];
pub const WEAK_STEPS: u64 = 300;

/// The box of that measurement.
pub fn undamped_box() -> NoisyBox<CubicSpline> {
    let kernel = PhantomData;
    let stiffness = f64::INFINITY;
    NoisyBox { n: SIDE, h_over_dx: 1.3, stiffness, alpha: 0.0, delta: 0.0, kernel }
}

/// Measured growth a step of the stiffest wave and its ω dt, at one Courant number.
fn weak_growth(courant: f64) -> [f64; 2] {
    undamped_box().stiffest_wave::<PredictorCorrector>(courant, WEAK_STEPS)
}

/// The study.
pub fn study(tier: Tier) -> Study {
    let points = points(tier);
    let variants = defaults::variants(tier);
    let (limits, (weak, steps)) = rayon::join(
        || points.par_iter().map(|point| (point.measure)(point)).collect::<Vec<Limit>>(),
        || {
            rayon::join(
                || WEAK.par_iter().map(|&courant| weak_growth(courant)).collect::<Vec<_>>(),
                || variants.par_iter().map(|v| measure_default(v)).collect::<Vec<_>>(),
            )
        },
    );
    let mut study = Study::new("time-step-limits", "The largest stable time step")
        .prose(METHOD)
        .block(figure(&points, &limits, &weak))
        .block(limits_table(&points, &limits))
        .prose(WEAK_TEXT)
        .block(weak_table(&weak))
        .prose(DEFAULTS_TEXT)
        .block(defaults::table(&steps));
    for (point, limit) in points.iter().zip(&limits) {
        study = study.judge(ratio_gate(point), limit.ratio());
        if let Some(gate) = baseline::limit_gate(&point.id()) {
            study = study.judge(gate, limit.middle());
        }
    }
    for (courant, [growth, omega_dt]) in WEAK.iter().zip(&weak) {
        study = study.judge(weak_gate(*courant), growth / theory_of_weak_growth(*omega_dt));
    }
    defaults::judge(study, &steps)
}

const METHOD: &str = "A periodic lattice of 12 × 12 particles at rest, cubic or other kernel, \
    η² = 0.01 h², velocity noise of 10⁻⁸ c₀: every wave of the box, too small to be anything but \
    linear. The longest stable dt is bisected to 0.4 %; a run grows if its energy exceeds a hundred \
    times the start, or if its mean over the last quarter exceeds that over the second by half. \
    Theory is linear stability of the same box (every wave vector, the coupled limit of sound and \
    damping, not the smaller of two limits). The predictor-corrector has no limit without damping: \
    it grows at every dt. Its limits at c₀h/ν above 10, where weak growth takes thousands of steps to \
    show, are left to the full tier.";
const WEAK_TEXT: &str = "Without damping the predictor-corrector amplifies sound by \
    ½ ln(1 + (ω dt)⁴/4) ≈ (ω dt)⁴/8 a step. Measured on the stiffest wave of the box, cubic spline, \
    h/dx = 1.3, over 300 steps; dt/h c₀ is the Courant number.";
const DEFAULTS_TEXT: &str = "How much longer the default step of each channel variant could be. The \
    limit is bisected on the Couette run itself (20 rows, walls and all, the lattice disturbed by \
    10⁻⁶ dx, 1500 steps; a run that diverges, or whose cross-flow exceeds V, is unstable), so it \
    contains walls, motion and stabilisers, which the theory beside it does not.";

/// The gate on a measured limit over its theory.
pub fn ratio_gate(point: &Point) -> Gate {
    Gate::new(
        format!("{}.ratio", point.id()),
        "measured limit/theory",
        Bound::Within(0.97, 1.03),
        Evidence::Theory,
        "linear theory of the same box is exact; bisection resolves 0.4 %, growth 0.5 %",
    )
}

/// The gate on a measured growth a step over its theory.
pub fn weak_gate(courant: f64) -> Gate {
    Gate::new(
        format!("stability.weak-growth.courant{courant}"),
        "growth a step/theory",
        Bound::Within(0.999, 1.001),
        Evidence::Theory,
        "the energy of one wave grows by 1 + (omega dt)^4/4 a step whatever its phase; noise of \
         1e-8 c0 leaves 1e-8 for round-off and nonlinearity",
    )
}

/// What linear theory gives for the growth of an undamped wave a step.
pub fn theory_of_weak_growth(omega_dt: f64) -> f64 {
    time_step::predictor_corrector_growth(omega_dt)
}

fn limits_table(points: &[Point], limits: &[Limit]) -> Table {
    let columns = vec![
        Column::text("kernel"),
        Column::num("h/dx", ""),
        Column::text("integrator"),
        Column::text("damping"),
        Column::num("measured c₀dt/h", ""),
        Column::num("theory", ""),
        Column::num("measured/theory", ""),
        Column::num("steps a run", ""),
    ];
    let table = Table::new("Longest stable step, measured and in theory.", columns);
    points.iter().zip(limits).fold(table, |table, (point, limit)| {
        table.row(vec![
            Cell::text(point.kernel),
            Cell::num(point.h_over_dx, 2),
            Cell::text(point.integrator),
            Cell::text(point.fluid()),
            Cell::num(limit.middle(), 4),
            Cell::num(limit.theory, 4),
            Cell::num(limit.ratio(), 4),
            Cell::count(limit.steps),
        ])
    })
}

fn weak_table(weak: &[[f64; 2]]) -> Table {
    let columns = vec![
        Column::num("Courant number", ""),
        Column::num("ω dt", ""),
        Column::num("measured growth", "1/step"),
        Column::num("½ ln(1 + (ω dt)⁴/4)", "1/step"),
        Column::num("(ω dt)⁴/8", "1/step"),
    ];
    let caption = "Weak instability of the predictor-corrector without damping.";
    WEAK.iter().zip(weak).fold(Table::new(caption, columns), |table, (courant, &[growth, wdt])| {
        table.row(vec![
            Cell::num(*courant, 2),
            Cell::num(wdt, 4),
            Cell::sci(growth, 4),
            Cell::sci(theory_of_weak_growth(wdt), 4),
            Cell::sci(wdt.powi(4) / 8.0, 4),
        ])
    })
}

/// The theoretical limit over c₀h/ν, without artificial damping.
fn theory_line<K: Kernel>(h_over_dx: f64, integrator: time_step::Integrator) -> Vec<(f64, f64)> {
    let lattice = SquareLattice::<K>::new(h_over_dx, noisy_box::ETA2);
    let at = |k: u32| {
        let stiffness = 0.8 * (400.0f64 / 0.8).powf(f64::from(k) / 60.0);
        let medium =
            time_step::Medium { c0: 1.0, h: 1.0, nu: 1.0 / stiffness, alpha: 0.0, delta: 0.0 };
        let modes = time_step::modes(&lattice, SIDE, &medium);
        (stiffness, time_step::time_step_limit(&modes, integrator))
    };
    (0..=60).map(at).collect()
}

fn figure(points: &[Point], limits: &[Limit], weak: &[[f64; 2]]) -> Figure {
    use time_step::Integrator::{Leapfrog as LeapfrogTheory, PredictorCorrector as MidpointTheory};
    let mut plot = Plot::new(
        "Longest stable step",
        Axis::log("sound against viscosity c₀h/ν [1]").ticks([1.0, 3.0, 10.0, 30.0, 100.0]),
        Axis::log("longest stable step c₀ dt/h [1]").ticks([0.3, 0.5, 1.0, 2.0]),
    );
    let both = [LeapfrogTheory, MidpointTheory];
    let kernels = [
        (CubicSpline::NAME, 1.3, both.map(|i| theory_line::<CubicSpline>(1.3, i))),
        (QuinticSpline::NAME, 1.0, both.map(|i| theory_line::<QuinticSpline>(1.0, i))),
    ];
    for (k, (kernel, h_over_dx, [leapfrog, midpoint])) in kernels.into_iter().enumerate() {
        let colour = Colour::cycle(k);
        plot = plot
            .layer(Series::line(format!("{kernel}, leapfrog, theory"), leapfrog).colour(colour))
            .layer(
                Series::line(format!("{kernel}, predictor-corrector, theory"), midpoint)
                    .colour(colour)
                    .dash(Dash::Dashed),
            );
        for (integrator, shape) in
            [("predictor-corrector", Shape::Square), ("leapfrog", Shape::Circle)]
        {
            let chosen = points.iter().zip(limits).filter(|(p, _)| {
                p.kernel == kernel
                    && p.h_over_dx == h_over_dx
                    && p.integrator == integrator
                    && p.alpha + p.delta == 0.0
            });
            let marks = chosen.map(|(p, l)| (p.stiffness.min(INVISCID_AT), l.middle()));
            let name = format!("{kernel}, {integrator}, measured");
            let marks = Series::markers(name, marks.collect()).colour(colour).shape(shape);
            // Where both integrators have one limit, an open square around a dot.
            let is_square = shape == Shape::Square;
            plot = plot.layer(if is_square { marks.open().size(11.0) } else { marks });
        }
    }
    plot = plot.layer(Layer::vertical(INVISCID_AT, "ν = 0"));
    Figure::new(
        "time-step-limits",
        "Left: symbols are bisected runs of 12 × 12 particles, lines linear stability of the same \
         box; at c₀h/ν ≲ 3 viscosity decides, and both integrators have the same limit. Right: \
         growth of the stiffest sound wave a step of the predictor-corrector without viscosity.",
    )
    .title("Stability of the time step")
    .panel(plot.legend(report::Legend::Outside))
    .panel(weak_plot(weak))
    .columns(2)
    .panel_size(360.0, 290.0)
}

fn weak_plot(weak: &[[f64; 2]]) -> Plot {
    let measured = weak.iter().map(|[growth, wdt]| (*wdt, *growth)).collect();
    let wave = |k: u32| 0.2 + 0.6 * f64::from(k) / 40.0;
    let line = |f: &dyn Fn(f64) -> f64| (0..=40).map(|k| (wave(k), f(wave(k)))).collect();
    Plot::new(
        "Weak instability of the predictor-corrector",
        Axis::log("ω dt of the stiffest wave [1]").ticks([0.2, 0.3, 0.4, 0.5, 0.6, 0.8]),
        Axis::log("growth of the amplitude a step [1]"),
    )
    .layer(Series::line("½ ln(1 + (ω dt)⁴/4)", line(&theory_of_weak_growth)).colour(Colour::BLACK))
    .layer(
        Series::line("(ω dt)⁴/8", line(&|x| x.powi(4) / 8.0))
            .colour(Colour::GREY)
            .dash(Dash::Dotted),
    )
    .layer(Series::markers("measured", measured))
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::gate::check_all;

    fn limit<I: Stepping>(stiffness: f64) -> Limit {
        let point = Point::new::<CubicSpline, I>(1.3, [stiffness, 0.0, 0.0]);
        (point.measure)(&point)
    }

    #[test]
    fn boxes_have_the_limits_of_theory() {
        for limit in [
            limit::<Leapfrog>(1.0),
            limit::<Leapfrog>(f64::INFINITY),
            limit::<PredictorCorrector>(1.0),
            limit::<PredictorCorrector>(10.0),
        ] {
            assert!((limit.ratio() - 1.0).abs() < 0.03, "{limit:?}");
        }
    }

    #[test]
    fn undamped_sound_grows_as_theory_says_and_not_in_the_leapfrog() {
        let [growth, omega_dt] = weak_growth(0.5);
        assert!((growth / theory_of_weak_growth(omega_dt) - 1.0).abs() < 1e-4);
        // The leapfrog's energy beats by ω dt, and that is all.
        let [growth, _] = undamped_box().stiffest_wave::<Leapfrog>(0.5, 1000);
        assert!(growth.abs() < 1e-3, "{growth}");
    }

    #[test]
    fn every_point_has_a_name_of_its_own_and_a_baseline() {
        let points = points(Tier::Full);
        let gates: Vec<Gate> = points.iter().map(ratio_gate).collect();
        assert_eq!(check_all(&gates), Ok(()));
        for point in points {
            assert!(baseline::limit_gate(&point.id()).is_some(), "{}", point.id());
        }
        for variant in defaults::variants(Tier::Full) {
            assert!(baseline::default_gate("x", variant, "margin").is_some(), "{variant}");
        }
    }
}
