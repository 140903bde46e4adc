//! Extreme Couette flows, against the row-reduced matrix and the lattice symbols.

use std::f64::consts::TAU;

use nalgebra::DVector;
use solver::{CubicSpline, Kernel, Leapfrog, QuinticSpline, WendlandC2};

use super::{Entry, sci};
use crate::cases;
use crate::wave::{Polarisation, Wave, WaveSettings, fit, measure};
use base::{
    gate::{Bound, Evidence},
    record::{Record, Status},
};
use harness::{case::Tier, runner::Context};
use maths::{
    exact::couette::Couette,
    theory::channel::{Alignment, Channel, RowModel, WallRule},
};

/// Runs Couette flow to νt/L² = 0.1.
fn couette(variant: &str, set: &[String]) -> Option<Record> {
    let mut all = vec!["end=0.1".to_string()]; // unless `set` says otherwise
    all.extend_from_slice(set);
    let context = Context { threads: 1, ..Context::default() };
    cases::find("couette").ok()?.run(variant, &all, &context).ok()
}

/// The error of a run that completed, else NaN.
fn error(record: &Option<Record>) -> f64 {
    let completed = record.as_ref().filter(|record| record.status == Status::Completed);
    completed.and_then(|record| record.metric("l2@0.1")).unwrap_or(f64::NAN)
}

/// The rows of Couette flow in units of L, ν and V.
fn rows<K: Kernel>(rows: usize, h_over_dx: f64, eta2: f64) -> Option<RowModel> {
    let channel = Channel {
        rows,
        width: 1.0,
        nu: 1.0,
        wall_velocity: [0.0, 1.0],
        force: 0.0,
        wall_rule: WallRule::Ghosts,
        alignment: Alignment::Aligned,
    };
    channel.reduce::<K>(h_over_dx, eta2).ok()
}

/// Relative error at νt/L² = 0.1.
fn error_of(model: &RowModel, u: &DVector<f64>) -> f64 {
    let exact = Couette { v0: 1.0, l: 1.0, nu: 1.0 };
    model.relative_error(u, |y| exact.velocity(y, 0.1))
}

/// Relative error of the row-reduced matrix at νt/L² = 0.1, exact in time.
fn matrix_error<K: Kernel>(count: usize, h_over_dx: f64, eta2: f64) -> f64 {
    let model = rows::<K>(count, h_over_dx, eta2);
    let error = model.and_then(|model| model.at(0.1).map(|u| error_of(&model, &u)));
    error.unwrap_or(f64::NAN)
}

/// The same with the steps of a leapfrog: half a kick first, whole ones, half a kick last, between
/// the times at which the run of `record` paused.
fn stepped_error(count: usize, record: &Option<Record>) -> f64 {
    // L²/ν = 1 s in the channels.
    let dt = record.as_ref().and_then(|r| r.numerics.get("dt [s]")).and_then(|dt| dt.as_f64());
    let (Some(model), Some(dt)) = (rows::<QuinticSpline>(count, 1.0, 1e-6), dt) else {
        return f64::NAN;
    };
    let (mut u, mut start) = (DVector::zeros(count), 0.0);
    for until in [0.02, 0.05, 0.1] {
        let steps = ((until - start) / dt * (1.0 - 1e-12)).ceil();
        let dt = (until - start) / steps;
        u += model.rate(&u) * (0.5 * dt);
        for _ in 1..steps as usize {
            u += model.rate(&u) * dt;
        }
        u += model.rate(&u) * (0.5 * dt);
        start = until;
    }
    error_of(&model, &u)
}

/// Reynolds number 1e-4: viscosity alone sets the step, and rows do not slide.
pub fn slow(tier: Tier) -> Vec<Entry> {
    let rows: &[usize] = if tier == Tier::Full { &[20, 40] } else { &[20] };
    let mut entries = Vec::new();
    for &rows in rows {
        let seed = matrix_error::<CubicSpline>(rows, 1.2, 0.01);
        let quintic = matrix_error::<QuinticSpline>(rows, 1.0, 1e-6);
        for (variant, matrix) in [("seed", seed), ("quintic-pc", quintic), ("modern", f64::NAN)] {
            let set = ["re=1e-4".to_string(), format!("rows={rows}")];
            let record = couette(variant, &set);
            let found = error(&record);
            // The leapfrog is of first order in dt here, so the matrix takes its steps.
            let matrix = if variant == "modern" { stepped_error(rows, &record) } else { matrix };
            let setting = format!("Re 10⁻⁴, {rows} rows, `{variant}`");
            let what = ["Couette flow that creeps".into(), setting];
            let name = format!("slow.{variant}.{rows}");
            let entry = Entry::new(&name, what, "error/matrix", Bound::Within(0.9, 1.1)).because(
                Evidence::Theory,
                "the row-reduced matrix is the exact answer of the sums, for `modern` with its own \
                 steps; 10 % for the time step",
            );
            let text = format!("{}, matrix {}", sci(found), sci(matrix));
            entries.push(entry.found(found / matrix, text));
        }
    }
    entries
}

/// Sound a thousand times faster than the rule asks for: where rows stay in place, and, reported,
/// where they slide past each other.
pub fn stiff_sound(tier: Tier) -> Vec<Entry> {
    let end = if tier == Tier::Full { 0.1 } else { 0.02 };
    let run = |re: f64, factor: f64| {
        // Morris' rule at this Reynolds number, L = 1 mm, ν = 1e-6 m²/s: c0² = ν V/(L 0.01).
        let c0 = factor * 1e-3 * (re / 0.01).sqrt();
        // At the default Courant number 0.25 the fastest sound is beyond the weak limit of the
        // predictor-corrector, c₀h/ν = 399, and refused.
        let steps = "courant=0.2".to_string();
        let set = [format!("re={re}"), format!("c0={c0:e}"), format!("end={end}"), steps];
        match couette("seed", &set) {
            None => (f64::NAN, "a refusal".to_string()),
            Some(record) if record.status == Status::Completed => {
                let error = record.metric(&format!("l2@{end}")).unwrap_or(f64::NAN);
                (error, sci(error))
            }
            Some(record) => (f64::NAN, format!("{:?}", record.status)),
        }
    };
    let entry = |re: f64| {
        let [usual, fast] = [1.0, 1000.0].map(|factor| run(re, factor));
        let setting = format!("Couette flow, Re {re}, `seed`, νt/L² = {end}");
        let what = ["c₀ a thousand times too fast".to_string(), setting];
        let found = format!("error {} becomes {}", usual.1, fast.1);
        let name = format!("sound.couette.{re}");
        Entry::new(&name, what, "error/usual error", Bound::Within(0.95, 1.05))
            .found(fast.0 / usual.0, found)
    };
    let still = "sound does not enter the exact flow, nor that of rows in their places, but for the step: \
                 its part of the error is below 5 %";
    let sliding =
        "reported: rows that slide by a spacing swing the density, and c₀² makes that force";
    let mut entries = vec![entry(1e-3).because(Evidence::Theory, still)];
    if tier == Tier::Full {
        entries.push(entry(0.5).because(Evidence::Theory, sliding).reported());
    }
    entries
}

/// ω and γ of long waves, as factors of c₀k and νk², measured and in theory.
fn factors<K: Kernel>(h_over_dx: f64) -> Option<[[f64; 2]; 2]> {
    let mut found = [[f64::NAN; 2]; 2];
    for (k, polarisation) in [Polarisation::Sound, Polarisation::Shear].into_iter().enumerate() {
        let settings = WaveSettings { n: 20, h_over_dx, nu: 0.01, span: 0.5, ..Default::default() };
        let mut wave = Wave::new::<K>(polarisation, &settings, false).ok()?;
        let measured = measure::<K, Leapfrog>(&mut wave, &Context::default()).ok()?;
        let theory = maths::theory::time_step::Integrator::Leapfrog;
        found[k] = if k == 0 {
            let states: Vec<_> =
                measured.series.iter().map(|a| nalgebra::Vector2::new(a[0], a[1])).collect();
            let mode = fit::mode_of_step(&fit::matrix_between(&states)?, theory, wave.dt);
            [mode.omega / TAU, wave.sound.omega / TAU]
        } else {
            let values: Vec<f64> = measured.series.iter().map(|a| a[2]).collect();
            let gamma = fit::shear_of_step(fit::factor_between(&values)?, theory, wave.dt);
            [gamma, wave.shear].map(|gamma| gamma / (0.01 * TAU * TAU))
        };
    }
    Some(found)
}

/// Smoothing lengths from too short to too long.
pub fn smoothing(tier: Tier) -> Vec<Entry> {
    let all = [0.9, 1.0, 1.1, 1.2, 1.3, 1.5, 2.0, 2.5, 3.0];
    let ratios: &[f64] = if tier == Tier::Full { &all } else { &[0.9, 1.5, 3.0] };
    let mut entries = Vec::new();
    for &ratio in ratios {
        entries.push(smoothed::<CubicSpline>("cubic-leapfrog", ratio));
        entries.push(smoothed::<QuinticSpline>("plain", ratio));
        entries.push(smoothed::<WendlandC2>("wendland-leapfrog", ratio));
    }
    entries
}

fn smoothed<K: Kernel>(variant: &str, ratio: f64) -> Entry {
    let nothing = [[f64::NAN; 2]; 2];
    let [sound, shear] = factors::<K>(ratio).unwrap_or(nothing);
    let deviation = (sound[0] / sound[1] - 1.0).abs().max((shear[0] / shear[1] - 1.0).abs());
    // A step that every kernel and smoothing length stands.
    let set = [format!("h_over_dx={ratio}"), "viscous=0.2".to_string(), "courant=0.5".to_string()];
    let flow = error(&couette(variant, &set));
    let found = format!(
        "sound factor {:.4}, viscous factor {:.4}; off theory by {}; Couette error {}",
        sound[0],
        shear[0],
        sci(deviation),
        report::percent(flow, 2)
    );
    let what = ["smoothing length".to_string(), format!("{}, h/dx = {ratio}", K::NAME)];
    let name = format!("smoothing.{}.{ratio}", K::NAME);
    let because =
        "symbols of the lattice are exact; the Couette error is reported, and must be finite";
    Entry::new(&name, what, "distance from the symbols", Bound::Below(1e-3))
        .because(Evidence::Theory, because)
        .found(if flow.is_finite() { deviation } else { f64::NAN }, found)
}
