//! What is said of the limits: figure, tables, gates.

use solver::{CubicSpline, Kernel, QuinticSpline};

use base::functions::powf;
use base::record::Record;
use harness::{case::Tier, columns::Columns, runs::Runs, study::Study};
use maths::theory::{lattice::SquareLattice, time_step};
use report::{Axis, Cell, Colour, Dash, Figure, Layer, Plot, Series, Shape, Table};

use super::{
    Limit, Point, SIDE, WAVE_ANGLE, WAVE_GROWTH, WEAK, baseline, beyond, noisy_box, points,
    ratio_gate, theory_of_weak_growth, weak, weak_gate,
};
use crate::extremes;

/// Where "no viscosity" stands on the axis of c₀h/ν.
const INVISCID_AT: f64 = 1000.0;

/// The studies of the case.
pub fn all(tier: Tier, runs: &Runs) -> Vec<Study> {
    let beyond = extremes::study(beyond::TITLE, beyond::LEAD, beyond::experiments(), runs);
    vec![limits(tier, runs), beyond]
}

fn limits(tier: Tier, runs: &Runs) -> Study {
    let points = points(tier);
    let limits: Vec<Limit> = points.iter().map(|point| point.limit(runs)).collect();
    let growth = |courant: f64| {
        let record = runs.completed(&weak(courant));
        let value = |key| record.and_then(|record: &Record| record.value(key)).unwrap_or(f64::NAN);
        [value(WAVE_GROWTH), value(WAVE_ANGLE)]
    };
    let weak = WEAK.map(growth);
    let mut study = Study::new("time-step-limits", "The largest stable time step")
        .prose(METHOD)
        .block(figure(&points, &limits, &weak))
        .block(limits_table(&points, &limits))
        .prose(WEAK_TEXT)
        .block(weak_table(&weak));
    for (point, limit) in points.iter().zip(&limits) {
        study = study.judge(ratio_gate(point), limit.ratio());
        if let Some(gate) = baseline::limit_gate(&point.id()) {
            study = study.judge(gate, limit.middle());
        }
    }
    for (courant, [growth, angle]) in WEAK.iter().zip(&weak) {
        study = study.judge(weak_gate(*courant), growth / theory_of_weak_growth(*angle));
    }
    study
}

const METHOD: &str = "The longest stable dt is found by bisection to 0.4 %. The box is a periodic lattice \
    of 12 × 12 particles at rest, with the cubic or another kernel, η² = 0.01 h², and velocity noise of \
    10⁻⁸ c₀, which excites every wave and is too small for nonlinear effects. A run grows if its energy \
    exceeds a hundred times the start, or if its mean over the last quarter exceeds that over the second \
    by half. Theory is linear stability of the same box, with every wave vector and with sound and damping \
    together. The predictor-corrector has no limit without damping, because it grows at every dt. Its \
    limits at c₀h/ν above 10, where weak growth takes thousands of steps to show, are left to the full \
    tier.";
const WEAK_TEXT: &str = "Without damping the predictor-corrector amplifies sound by ½ ln(1 + (ω dt)⁴/4) ≈ \
    (ω dt)⁴/8 a step.";

fn limits_table(points: &[Point], limits: &[Limit]) -> Table {
    Columns::<(&Point, &Limit)>::default()
        .text("kernel", |(point, _)| point.kernel)
        .num(["h/dx", ""], |(point, _)| Cell::num(point.settings.h_over_dx, 2))
        .text("integrator", |(point, _)| point.integrator)
        .text("damping", |(point, _)| point.fluid())
        .num(["measured c₀dt/h", ""], |(_, limit)| Cell::num(limit.middle(), 4))
        .num(["theory", ""], |(_, limit)| Cell::num(limit.theory.limit, 4))
        .num(["measured/theory", ""], |(_, limit)| Cell::num(limit.ratio(), 4))
        .num(["steps a run", ""], |(_, limit)| Cell::count(limit.theory.steps as u64))
        .table("Longest stable step, measured and in theory.", points.iter().zip(limits))
}

fn weak_table(weak: &[[f64; 2]]) -> Table {
    let caption = "Weak instability of the predictor-corrector without damping. It is measured on the \
                   stiffest wave of the box, for the cubic spline and h/dx = 1.3, over 300 steps; the \
                   Courant number is c₀ dt/h.";
    Columns::<(&f64, &[f64; 2])>::default()
        .num(["Courant number", ""], |(courant, _)| Cell::num(**courant, 2))
        .num(["ω dt", ""], |(_, [_, wdt])| Cell::num(*wdt, 4))
        .num(["measured growth", "1/step"], |(_, [growth, _])| Cell::sci(*growth, 4))
        .num(["½ ln(1 + (ω dt)⁴/4)", "1/step"], |(_, [_, wdt])| {
            Cell::sci(theory_of_weak_growth(*wdt), 4)
        })
        .num(["(ω dt)⁴/8", "1/step"], |(_, [_, wdt])| Cell::sci(wdt.powi(4) / 8.0, 4))
        .table(caption, WEAK.iter().zip(weak))
}

/// The theoretical limit over c₀h/ν, without artificial damping.
fn theory_line<K: Kernel>(h_over_dx: f64, integrator: time_step::Integrator) -> Vec<(f64, f64)> {
    let lattice = SquareLattice::of::<K>(h_over_dx, noisy_box::ETA2);
    let at = |k: u32| {
        let stiffness = 0.8 * powf(400.0 / 0.8, f64::from(k) / 60.0);
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
        Axis::log("sound over viscosity c₀h/ν [-]").ticks([1.0, 3.0, 10.0, 30.0, 100.0]),
        Axis::log("longest stable step c₀ dt/h [-]").ticks([0.3, 0.5, 1.0, 2.0]),
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
                    && p.settings.h_over_dx == h_over_dx
                    && p.integrator == integrator
                    && p.settings.alpha + p.settings.delta == 0.0
            });
            let marks = chosen.map(|(p, l)| (p.stiffness().min(INVISCID_AT), l.middle()));
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
        "Left: longest stable time step by bisection on a periodic lattice (symbols), and by linear \
         stability theory of this lattice (lines). Below c₀h/ν of about 3 viscosity decides, and both \
         integrators have the same limit. Right: growth of the stiffest sound wave a step in the \
         predictor-corrector without viscosity.",
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
        Axis::log("ω dt of the stiffest wave [-]").ticks([0.2, 0.3, 0.4, 0.5, 0.6, 0.8]),
        Axis::log("growth of the amplitude per step [-]"),
    )
    .layer(Series::line("½ ln(1 + (ω dt)⁴/4)", line(&theory_of_weak_growth)).colour(Colour::BLACK))
    .layer(
        Series::line("(ω dt)⁴/8", line(&|x| x.powi(4) / 8.0))
            .colour(Colour::GREY)
            .dash(Dash::Dotted),
    )
    .layer(Series::markers("measured", measured))
}
