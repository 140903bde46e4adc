//! Extreme Couette flows: creeping ones against the row-reduced matrix, sound a thousand times too fast,
//! smoothing lengths from too short to too long.

use nalgebra::DVector;
use solver::{CubicSpline, Kernel, QuinticSpline, WendlandC2};

use super::{ChannelCase, ChannelSettings, TIMES, measure::L2};
use base::{
    gate::{Bound, Evidence},
    record::Record,
    spec::RunSpec,
};
use harness::{
    case::{Case, Tier},
    extremes::{self, Entry},
    runs::Runs,
    study::Study,
};
use maths::{
    exact::couette::Couette,
    theory::channel::{Alignment, Channel, RowModel, WallRule},
};

/// νt/L² of the end and of the comparison, if nothing else is said.
const END: f64 = 0.1;

/// The runs of the study.
pub fn specs(case: &ChannelCase, tier: Tier) -> Vec<RunSpec> {
    let slow =
        slow_settings(tier).into_iter().map(|(variant, rows)| slow_spec(case, variant, rows));
    let sound = sound_settings(tier).iter().flat_map(|re| sound_specs(case, *re, tier));
    let smoothed = smoothing_lengths(tier).into_iter().map(|of| smoothed_spec(case, of));
    slow.chain(sound).chain(smoothed).collect()
}

/// The study.
pub fn study(case: &ChannelCase, tier: Tier, runs: &Runs) -> Study {
    let entries = [slow(case, tier, runs), sound(case, tier, runs), smoothing(case, tier, runs)];
    extremes::study("couette-extremes", "Extreme settings", LEAD, entries.concat())
}

const LEAD: &str = "A vanishing Reynolds number, sound a thousand times too fast, and smoothing lengths \
    that are too short or too long.";

/// The error of a run that completed.
fn error(runs: &Runs, spec: &RunSpec) -> Option<f64> {
    let record = runs.completed(spec)?;
    record.value(L2.at(record.settings_as::<ChannelSettings>().end))
}

/// An error in words.
fn text(error: Option<f64>) -> String {
    error.map_or("not measured".into(), |error| report::sci(error, 3))
}

/// The rows of Couette flow in units of L, ν and V.
fn rows<K: Kernel>(
    rows: usize,
    h_over_dx: f64,
    eta2: f64,
    alignment: Alignment,
) -> Option<RowModel> {
    let channel = Channel {
        rows,
        width: 1.0,
        nu: 1.0,
        wall_velocity: [0.0, 1.0],
        force: 0.0,
        wall_rule: WallRule::Ghosts,
        alignment,
    };
    channel.reduce::<K>(h_over_dx, eta2).ok()
}

/// Relative error at νt/L² = 0.1.
fn error_of(model: &RowModel, u: &DVector<f64>) -> f64 {
    let exact = Couette { v0: 1.0, l: 1.0, nu: 1.0 };
    model.relative_error(u, |y| exact.velocity(y, END))
}

/// Relative error of the row-reduced matrix at νt/L² = 0.1, exact in time.
pub fn matrix_error<K: Kernel>(count: usize, h_over_dx: f64, eta2: f64) -> Option<f64> {
    let model = rows::<K>(count, h_over_dx, eta2, Alignment::Aligned)?;
    let u = model.at(END)?;
    Some(error_of(&model, &u))
}

/// The same with the steps of a leapfrog of at most `dt` \[L²/ν\], equal between the times at which a run
/// pauses: half a kick first, whole ones, half a kick last.
fn stepped_error(count: usize, dt: f64) -> Option<f64> {
    let model = rows::<QuinticSpline>(count, 1.0, 1e-6, Alignment::Aligned)?;
    Some(error_of_leapfrog(&model, dt))
}

/// That of these rows.
pub fn error_of_leapfrog(model: &RowModel, dt: f64) -> f64 {
    let (mut u, mut start, mut lag) = (DVector::zeros(model.y.len()), 0.0, 0.0);
    for until in TIMES.into_iter().filter(|tau| *tau <= END) {
        let steps = ((until - start) / dt * (1.0 - 1e-12)).ceil();
        let half = 0.5 * (until - start) / steps;
        for _ in 0..steps as usize {
            u += model.rate(&u) * (lag + half);
            lag = half;
        }
        start = until;
    }
    u += model.rate(&u) * lag;
    error_of(model, &u)
}

/// Variants and rows at Reynolds number 1e-4: viscosity alone sets the step, and rows do not slide.
fn slow_settings(tier: Tier) -> Vec<(&'static str, usize)> {
    let rows: &[usize] = if tier == Tier::Full { &[20, 40] } else { &[20] };
    let variants = |rows: &usize| ["seed", "quintic-pc", "modern"].map(|variant| (variant, *rows));
    rows.iter().flat_map(variants).collect()
}

fn slow_spec(case: &ChannelCase, variant: &str, rows: usize) -> RunSpec {
    case.spec(variant, |s| (s.end, s.re, s.rows) = (END, 1e-4, rows))
}

fn slow(case: &ChannelCase, tier: Tier, runs: &Runs) -> Vec<Entry> {
    let entry = |(variant, rows): (&str, usize)| {
        let spec = slow_spec(case, variant, rows);
        let found = error(runs, &spec);
        // The leapfrog is of first order in dt here, so the matrix takes its steps; L²/ν is 1 s.
        let matrix = match variant {
            "seed" => matrix_error::<CubicSpline>(rows, 1.2, 0.01),
            "quintic-pc" => matrix_error::<QuinticSpline>(rows, 1.0, 1e-6),
            _ => case.rules(&spec).ok().and_then(|rules| stepped_error(rows, rules.dt())),
        };
        let because = "The row-reduced matrix gives the exact error of the sums, for `modern` with its own \
                       time steps. The bound adds 10 % for the time step.";
        let what =
            ["Couette flow that creeps".into(), format!("Re 10⁻⁴, {rows} rows, `{variant}`")];
        let (name, bound) = (format!("slow.{variant}.{rows}"), Bound::Within(0.9, 1.1));
        let ratio = found.zip(matrix).map_or(f64::NAN, |(found, matrix)| found / matrix);
        Entry::new(&name, what, "error/matrix", bound)
            .because(Evidence::Theory, because)
            .found(ratio, format!("{}, matrix {}", text(found), text(matrix)))
    };
    slow_settings(tier).into_iter().map(entry).collect()
}

/// Reynolds numbers at which sound is a thousand times faster than the rule asks for: where rows stay in
/// place, and, as a control, where they slide past each other.
fn sound_settings(tier: Tier) -> &'static [f64] {
    if tier == Tier::Full { &[1e-3, 0.5] } else { &[1e-3] }
}

/// With the usual sound speed, and with the fast one.
fn sound_specs(case: &ChannelCase, re: f64, tier: Tier) -> [RunSpec; 2] {
    [1.0, 1000.0].map(|factor| {
        case.spec("seed", |s| {
            s.re = re;
            s.end = if tier == Tier::Full { 0.1 } else { 0.02 };
            // Morris' rule at this Reynolds number, L = 1 mm, ν = 1e-6 m²/s: c0² = ν V/(L 0.01).
            s.c0 = Some(factor * 1e-3 * (re / 0.01).sqrt());
            // At the default Courant number 0.25 the fastest sound is beyond the weak limit of the
            // predictor-corrector, c₀h/ν = 399, and refused.
            s.courant = 0.2;
        })
    })
}

fn sound(case: &ChannelCase, tier: Tier, runs: &Runs) -> Vec<Entry> {
    let still = "Sound enters neither the exact flow nor that of rows in their places, except by the time \
                 step, whose part of the error is below 5 %.";
    let sliding = "Control: rows that slide by a spacing make the density oscillate, and the force from it \
                   is proportional to c₀², so a sound speed without a rule must spoil the flow.";
    let entry = |re: &f64| {
        let specs = sound_specs(case, *re, tier);
        let [usual, fast] = specs.each_ref().map(|spec| error(runs, spec));
        let slides = *re > 1e-3;
        let (name, bound) = (format!("sound.couette.{re}"), Bound::Within(0.95, 1.05));
        let because = if slides { sliding } else { still };
        let what = ["c₀ a thousand times too fast".into(), format!("Re {re}, `seed`")];
        let ended = |spec: &RunSpec, error: Option<f64>| match runs.record(spec) {
            Some(Record { status, .. }) if error.is_none() => status.to_string(),
            _ => text(error),
        };
        let found = format!("error {} becomes {}", ended(&specs[0], usual), ended(&specs[1], fast));
        let entry = Entry::new(&name, what, "error/usual error", bound)
            .because(Evidence::Theory, because)
            .found(fast.zip(usual).map_or(f64::NAN, |(fast, usual)| fast / usual), found);
        if slides { entry.expected_to_fail() } else { entry }
    };
    sound_settings(tier).iter().map(entry).collect()
}

/// Variants, for their kernels, and h/dx.
fn smoothing_lengths(tier: Tier) -> Vec<(&'static str, f64)> {
    let all = [0.9, 1.0, 1.1, 1.2, 1.3, 1.5, 2.0, 2.5, 3.0];
    let ratios: &[f64] = if tier == Tier::Full { &all } else { &[0.9, 1.5, 3.0] };
    let variants = ["cubic-leapfrog", "plain", "wendland-leapfrog"];
    ratios.iter().flat_map(|ratio| variants.map(|variant| (variant, *ratio))).collect()
}

fn smoothed_spec(case: &ChannelCase, (variant, ratio): (&str, f64)) -> RunSpec {
    // A step that every kernel and smoothing length stands.
    case.spec(variant, |s| {
        (s.end, s.h_over_dx, s.viscous, s.courant) = (END, ratio, 0.2, 0.5);
    })
}

/// The larger error of the row-reduced matrices of rows in columns and of rows that slid past each other.
fn smoothed_matrix(case: &ChannelCase, (variant, ratio): (&'static str, f64)) -> Option<f64> {
    let dt = case.rules(&smoothed_spec(case, (variant, ratio))).ok()?.dt();
    let reduced = match variant {
        "cubic-leapfrog" => rows::<CubicSpline>,
        "wendland-leapfrog" => rows::<WendlandC2>,
        _ => rows::<QuinticSpline>,
    };
    let error = |alignment| Some(error_of_leapfrog(&reduced(20, ratio, 1e-6, alignment)?, dt));
    Some(error(Alignment::Aligned)?.max(error(Alignment::Slid)?))
}

fn smoothing(case: &ChannelCase, tier: Tier, runs: &Runs) -> Vec<Entry> {
    let because = "The bound is the error by the row-reduced matrix with the steps of the leapfrog, for \
                   rows in columns or slid past each other, whichever is larger, and 10 % for the motion \
                   of the rows.";
    let entry = |of: (&'static str, f64)| {
        let (variant, ratio) = of;
        let (found, matrix) = (error(runs, &smoothed_spec(case, of)), smoothed_matrix(case, of));
        let what = ["smoothing length".into(), format!("`{variant}`, h/dx = {ratio}")];
        let name = format!("smoothing.couette.{variant}.{ratio}");
        let over = found.zip(matrix).map_or(f64::NAN, |(found, matrix)| found / matrix);
        Entry::new(&name, what, "error/matrix", Bound::Below(1.1))
            .because(Evidence::Theory, because)
            .found(over, format!("error {}, matrix {}", text(found), text(matrix)))
    };
    smoothing_lengths(tier).into_iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::couette::COUETTE;

    /// Any error below 100 % passed, the largest of these being 3 %.
    #[test]
    fn errors_of_all_smoothing_lengths_are_held_to_a_matrix() {
        let matrix = |of| smoothed_matrix(&COUETTE, of).expect("a wide channel");
        let all: Vec<f64> = smoothing_lengths(Tier::Full).into_iter().map(matrix).collect();
        assert!(all.len() == 27 && all.iter().all(|error| (2e-4..4e-2).contains(error)), "{all:?}");
    }
}
