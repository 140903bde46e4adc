//! The column in the tank from twenty starts that differ by a millionth of a spacing: until when levels and
//! impulses agree, and how what comes after the jet has fallen back is distributed.

use base::{
    gate::{Bound, Evidence, Gate},
    record::{MetricName, Record},
};
use harness::{
    case::Tier,
    declare::Comparison,
    ensemble::{Ensemble, Ensembles, History, Number},
};

use super::{
    DamSettings, NAME,
    measure::PROBES,
    metrics::{self, IMPULSE, LEVELS},
    plan::{self, Group},
    reference::{Curve, Lobovsky, VolumeOfFluid, WINDOWS, arrival, impulse},
};
use crate::water::curve;

/// Seeds of the members.
pub const SEEDS: std::ops::RangeInclusive<u32> = 1..=20;
/// End of the runs \[(H/g)^(1/2)\]: the splash of the jet has run over all probes but the first.
pub const END: f64 = 8.0;
/// When the levels and impulses of what comes after the jet has closed are taken \[(H/g)^(1/2)\].
const LATE: [f64; 2] = [6.0, END];
/// Until when single runs are compared: levels; impulses since the arrival at P1 \[(H/g)^(1/2)\].
const LEVELS_UNTIL: f64 = 5.5;

/// All of them; none in the quick tier.
pub fn ensembles(tier: Tier, comparisons: &[Comparison]) -> Option<Ensembles> {
    let table = plan::table(tier);
    let mut of: Vec<Ensemble> = Vec::new();
    for row in table.of(Group::Ensemble) {
        let id = format!("{NAME}.ensemble.{}.{}", row.variant, row.settings.n);
        match of.iter_mut().find(|ensemble| ensemble.id == id) {
            Some(ensemble) => ensemble.members.push(row.run.spec.clone()),
            None => of.push(Ensemble {
                histories: histories(&id, row.variant, comparisons),
                numbers: numbers(&id, row.variant, row.settings.n),
                variant: row.variant,
                label: format!("H/dx = {}", row.settings.n),
                members: vec![row.run.spec.clone()],
                is_drawn: row.settings.n == plan::ENSEMBLES[1],
                id,
            }),
        }
    }
    let about = "The tank of Lobovsky et al. from twenty starts whose particles are off their lattice by up to \
                 a millionth of a spacing, which no method and no experiment knows. Levels are compared with \
                 two series of the experiment. Of its pressures there is one event, and of P2 a second \
                 sensor; the hundred repetitions of SPHERIC 10 (first peak 3710 ± 732 Pa) are of another \
                 tank and say nothing of this one.";
    let (id, time) = ("dam-break-ensembles".into(), ["time", "√(H/g)"]);
    (!of.is_empty()).then(|| Ensembles { id, about: about.into(), time, of })
}

/// Levels and impulses. Until the end of what single runs are compared by, all must agree.
fn histories(id: &str, variant: &str, comparisons: &[Comparison]) -> Vec<History> {
    // Packages are embedded and checked by a test.
    let lobovsky = Lobovsky::load().unwrap_or_default();
    let model = VolumeOfFluid::load().unwrap_or_default();
    let tolerance = |metric: MetricName, unit: f64| {
        let comparison = comparisons.iter().find(|of| of.metric == metric);
        comparison.cloned().map(|of| (of, unit))
    };
    let agree = |name: &str, until: f64| {
        let because = "Single runs are judged by this history until that time: a gate on it would judge a \
                       draw if members had parted before.";
        let metric = "time until which all members agree [√(H/g)]";
        let id = format!("{id}.{name}.agree");
        Gate::new(id, metric, Bound::Above(until), Evidence::Invariant, because)
    };
    let level = |k: usize| {
        let name = format!("H{}", k + 1);
        let gate = (variant == "modern" || k == 0).then(|| agree(&name, LEVELS_UNTIL));
        Some(History {
            name: format!("level {name} [H]"),
            points: Box::new(move |record| depth(record, k)),
            tolerance: tolerance(LEVELS.rms_shifted.into(), 1.0)?,
            measured: lobovsky.levels[k].clone(),
            is_drawn: k > 1,
            gate,
        })
    };
    let [theirs, models] = [&lobovsky.pressure, &model.pressure].map(|p| arrival(&p[0]));
    let pressed = |k: usize| {
        let name = format!("P{}", k + 1);
        let measured = &lobovsky.pressure[k];
        let gate = (variant == "modern").then(|| agree(&name, models + WINDOWS[0]));
        // On the clock of the model, by which the wave arrives.
        Some(History {
            name: format!("impulse on {name} [ρ g H √(H/g)]"),
            points: Box::new(move |record| summed(&pressure(record, k))),
            tolerance: tolerance(IMPULSE[k].at(1), impulse(measured, theirs, WINDOWS[0]))?,
            measured: vec![summed(measured).iter().map(|(t, y)| (t + models - theirs, *y)).collect()],
            is_drawn: k == 0,
            gate,
        })
    };
    (0..PROBES.len()).filter_map(level).chain((0..3).filter_map(pressed)).collect()
}

/// The level at a probe \[H\] over time.
fn depth(record: &Record, k: usize) -> Curve {
    let s: DamSettings = record.settings_as();
    curve(record, "series", ["t", &format!("H{}", k + 1)], [s.unit_time(), s.height])
}

/// The pressure on a sensor \[ρ g H\] over time.
fn pressure(record: &Record, k: usize) -> Curve {
    curve(record, "pressure", ["t", &format!("P{}", k + 1)], [1.0, 1.0])
}

/// The impulse since the start, by the trapezoidal rule.
fn summed(pressure: &Curve) -> Curve {
    let mut sum = 0.0;
    let add = |pair: &[(f64, f64)]| {
        sum += 0.5 * (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1);
        (pair[1].0, sum)
    };
    pressure.windows(2).map(add).collect()
}

/// The mean of a curve over [`LATE`]; none if it does not reach so far.
fn late(curve: &Curve) -> Option<f64> {
    let inside = curve.iter().filter(|(t, _)| (LATE[0]..=LATE[1]).contains(t));
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (_, y)| (sum + y, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// The numbers whose distribution is shown.
fn numbers(id: &str, variant: &str, n: usize) -> Vec<Number> {
    // Packages are embedded and checked by a test.
    let lobovsky = Lobovsky::load().unwrap_or_default();
    let from = arrival(&lobovsky.pressure[0]);
    let level = |k: usize, name: &'static str| Number {
        name: [name, "H"],
        value: Box::new(move |record| late(&depth(record, k))),
        measured: lobovsky.levels[k].iter().filter_map(late).collect(),
        gate: (k == 2).then(|| of_median(id, variant, n)).flatten(),
    };
    let metric = |name: [&'static str; 2], metric: MetricName, measured: Vec<f64>| Number {
        name,
        value: Box::new(move |record| record.value(metric.clone())),
        measured,
        gate: None,
    };
    let long = |k: usize| IMPULSE[k].at(WINDOWS[1]);
    let [one, other] = [&lobovsky.pressure[1], &lobovsky.aside].map(|p| impulse(p, from, WINDOWS[1]));
    let highest = lobovsky.pressure[0].iter().map(|(_, p)| *p).fold(f64::NAN, f64::max);
    vec![
        level(2, "level H3, mean of 6 ≤ t ≤ 8"),
        level(3, "level H4, mean of 6 ≤ t ≤ 8"),
        Number {
            name: ["pressure P1, mean of 6 ≤ t ≤ 8", "ρ g H"],
            value: Box::new(|record| late(&pressure(record, 0))),
            measured: Vec::new(),
            gate: None,
        },
        metric(["impulse on P1 during 2.5, over the measured one, less 1", "-"], long(0), vec![0.0]),
        metric(
            ["impulse on P2 during 2.5, over the measured one, less 1", "-"],
            long(1),
            vec![0.0, other / one - 1.0],
        ),
        metric(["largest P1", "ρ g H"], metrics::PEAK[0].into(), vec![highest]),
        metric(["noise of P2", "ρ g H"], metrics::NOISE.into(), vec![0.020]),
    ]
}

/// The gate on the median of the level at H3 after the horizon: seed, resolution, interval.
fn of_median(id: &str, variant: &str, n: usize) -> Option<Gate> {
    let (_, middle, error) = *MEDIANS.iter().find(|of| variant == "modern" && of.0 == n)?;
    let because = "TODO";
    let metric = "median of the mean level at H3 [H]";
    let bound = Bound::Within(middle - error, middle + error);
    Some(Gate::new(format!("{id}.H3.median"), metric, bound, Evidence::Regression, because))
}

const MEDIANS: [(usize, f64, f64); 2] = [(20, 0.515, 0.015), (30, 0.56, 0.011)];
