//! What a sound speed costs and what it buys: error and work over c0, everything else as it is.

use super::{
    CASE,
    plan::{BEST, seconds},
    run::L2,
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Record, Status},
    spec::RunSpec,
};
use harness::{
    case::{Planned, Tier},
    runs::Runs,
    study::Study,
};
use report::{Axis, Figure, Plot, Series, exact};

/// Sound speeds \[U\]: from below what holds the vortices together to eight times it.
const SPEEDS: [f64; 6] = [5.0, 7.0, 10.0, 14.0, 20.0, 40.0];

/// The sound speed of all other runs \[U\].
const USUAL: f64 = 10.0;

/// A variant whose sums are conservative, and one whose sums are exact for linear fields.
const VARIANTS: [&str; 2] = ["modern", BEST];

fn side(tier: Tier) -> usize {
    match tier {
        Tier::Quick => 24,
        Tier::Full => 50,
    }
}

fn spec(tier: Tier, variant: &str, c0: f64) -> RunSpec {
    CASE.spec(variant, |s| (s.n, s.perturb, s.c0) = (side(tier), 0.2, c0))
}

/// The runs of a tier.
pub fn plan(tier: Tier) -> impl Iterator<Item = Planned> {
    let run = move |variant, c0: f64| {
        let share = (1.0 + c0) / (1.0 + USUAL);
        Planned::new(spec(tier, variant, c0)).taking(seconds(side(tier)) * share)
    };
    VARIANTS.into_iter().flat_map(move |variant| SPEEDS.map(|c0| run(variant, c0)))
}

/// Error over sound speed and over work.
pub fn study(tier: Tier, runs: &Runs) -> Study {
    let n = side(tier);
    let caption = format!(
        "Error and work over the sound speed c0, Taylor-Green vortices at Re 100 from the disturbed lattice, \
         {n} x {n} particles, time step in proportion to 1/(c0 + U). Numbers at points are c0/U; a speed at \
         which the run diverged has no point."
    );
    let error = "relative L2 error of the velocity [-]";
    let mut over_speed = Plot::new("Error", Axis::log("c0 [U]"), Axis::log(error));
    let mut over_work =
        Plot::new("Error against work", Axis::log("pair interactions [-]"), Axis::log(""));
    let mut study = Study::new("taylor-green-sound", "What the sound speed costs and what it buys");
    for (k, variant) in VARIANTS.into_iter().enumerate() {
        let made = |c0| runs.record(&spec(tier, variant, c0));
        let ended = |record: &&Record| record.status == Status::Completed;
        let error = |c0| made(c0).filter(ended).and_then(|record| record.value(L2));
        let points: Vec<_> = SPEEDS.into_iter().filter_map(|c0| Some((c0, error(c0)?))).collect();
        let pairs = |c0| made(c0).map_or(f64::NAN, |record| record.cost.pair_interactions as f64);
        let work = points.iter().map(|(c0, error)| (pairs(*c0), *error)).collect();
        let labels = points.iter().map(|(c0, _)| exact(*c0));
        over_work = over_work.layer(Series::line_markers(variant, work).cycle(k).labels(labels));
        over_speed = over_speed.layer(Series::line_markers(variant, points).cycle(k));
        let fastest = SPEEDS[SPEEDS.len() - 1];
        let ratio = error(fastest).zip(error(USUAL)).map_or(f64::NAN, |(fast, usual)| fast / usual);
        study = study.judge(gate(variant, n), ratio);
    }
    let figure = Figure::new("taylor-green-sound", caption).panel(over_speed).panel(over_work);
    study.block(figure.columns(2))
}

fn gate(variant: &str, n: usize) -> Gate {
    let because = "Sound four times as fast takes four times the work and must not be needed: \
                   compressibility at c0 = 10 U is (U/c0)^2 = 1 % of the pressure, and what irregular \
                   particles add to the pressure grows as c0^2, so that the error has been seen to rise.";
    let id = format!("taylor_green.{variant}.{n}.sound_speed");
    Gate::new(
        id,
        "error at c0 = 40 U over error at 10 U",
        Bound::Above(1.0),
        Evidence::Regression,
        because,
    )
}
