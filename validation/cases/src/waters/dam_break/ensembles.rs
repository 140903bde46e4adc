//! The column in the tank from twenty starts that differ by a millionth of a spacing: the time until which
//! levels and impulses agree, and the distribution after the jet has fallen back.

use touchstone_harness::prelude::*;
use touchstone_harness::studies::{Ensemble, Ensembles, History, MemberNumber};
use touchstone_maths::metrics::curve::{Points, integral, integrals, mean};

use super::{
    NAME, columns,
    metrics::IMPULSE,
    plan::{self, Group, Table},
    reference::{
        IMPULSE_SPREAD, LEVEL_SPREAD, LEVELS_UNTIL, LOBOVSKY, MODEL, WINDOWS, arrival, depth,
        pressure,
    },
};

/// Times of the levels after the jet has closed \[(H/g)^(1/2)\].
const LATE: [f64; 2] = [6.0, plan::UNTIL];

/// All ensembles, of `modern` and `seed` at two spacings; none in the quick tier.
pub fn ensembles(tier: Tier, table: &Table) -> Option<Ensembles> {
    let ensemble = |(n, variant): (usize, &'static str)| {
        let rows = table.of(Group::Ensemble).filter(|row| row.variant == variant);
        let rows = rows.filter(|row| row.settings.n == n);
        let id = format!("{NAME}.ensemble.{variant}.{n}");
        Ensemble {
            histories: histories(&id, variant),
            numbers: numbers(&id, variant, n),
            variant,
            label: format!("H/dx = {n}"),
            members: rows.map(|row| row.run.spec.clone()).collect(),
            is_drawn: n == plan::ENSEMBLES[1],
            id,
        }
    };
    let about = "The tank of Lobovsky et al. from twenty starts whose particles are off their lattice by \
                 up to a millionth of a spacing, far less than any method or experiment resolves. Levels \
                 are compared with two series of the experiment. Of its pressures there is one event, and \
                 of P2 a second sensor. Two spacings have different \
                 distributions, by more than their intervals: what comes beyond the horizon depends on the \
                 spacing too, so the scatter of an ensemble is not its error.";
    let both = |n| ["modern", "seed"].map(|variant| ensemble((n, variant)));
    let of = || plan::ENSEMBLES.into_iter().flat_map(both).collect();
    let time = ["time", "√(H/g)"];
    (tier != Tier::Quick).then(|| Ensembles { about: about.into(), time, of: of() })
}

/// Levels and impulses. All members must agree until the end of the comparison of single runs.
fn histories(id: &str, variant: &str) -> Vec<History> {
    let agree = |name: &str, until: f64| {
        let because = "Single runs are judged by this history until that time: a gate on it would judge a \
                       draw if members had parted before.";
        let metric = "time until which all members agree [√(H/g)]";
        let id = format!("{id}.{name}.agree");
        Gate::new(id, metric, Bound::Above(until), Evidence::Invariant, because)
    };
    let level = |k: usize| {
        let name = columns::LEVELS[k].name;
        let gate = (variant == "modern" || k == 0).then(|| agree(name, LEVELS_UNTIL));
        History {
            name: format!("level {name} [H]"),
            points: Box::new(move |record| depth(record, k)),
            tolerance: LEVEL_SPREAD,
            measured: LOBOVSKY.levels[k].clone(),
            is_drawn: k > 1,
            gate,
        }
    };
    let [theirs, models] = [&LOBOVSKY.pressure, &MODEL.pressure].map(|p| arrival(&p[0]));
    let pressed = |k: usize| {
        let name = columns::PRESSURES[k].name;
        let measured = &LOBOVSKY.pressure[k];
        let gate = (variant == "modern").then(|| agree(name, models + WINDOWS[0]));
        // On the clock of the model, by which the wave arrives.
        let later = |(t, y): (f64, f64)| (t + models - theirs, y);
        History {
            name: format!("impulse on {name} [ρ g H √(H/g)]"),
            points: Box::new(move |record| integrals(&pressure(record, k))),
            tolerance: IMPULSE_SPREAD * integral(measured, theirs, WINDOWS[0]),
            measured: vec![integrals(measured).into_iter().map(later).collect()],
            is_drawn: k == 0,
            gate,
        }
    };
    (0..4).map(level).chain((0..3).map(pressed)).collect()
}

/// The mean of a curve over [`LATE`]; none if it does not reach so far.
fn late(curve: &Points) -> Option<f64> {
    Some(mean(curve, LATE)).filter(|mean| !mean.is_nan())
}

/// The numbers whose distribution is shown, which are judged in `modern`.
fn numbers(id: &str, variant: &str, n: usize) -> Vec<MemberNumber> {
    let known = MEDIANS.iter().find(|of| variant == "modern" && of.n == n);
    let judged =
        |name: &str, median: &str, known| judged(format!("{id}.{name}.median"), median, known);
    let [level, impulse] =
        ["level H3, mean of 6 ≤ t ≤ 8", "impulse on P3 during 2.5, over the measured one, minus 1"];
    let of_level = "median of the level at H3, mean of 6 ≤ t ≤ 8 [H]";
    let of_impulse = "median of the impulse on P3 during 2.5, over the measured one, minus 1";
    vec![
        MemberNumber {
            name: [level, "H"],
            value: Box::new(|record| late(&depth(record, 2))),
            measured: LOBOVSKY.levels[2].iter().filter_map(late).collect(),
            gate: known.map(|of| judged("H3", of_level, of.level)),
        },
        MemberNumber {
            name: [impulse, "-"],
            value: Box::new(|record| record.value(IMPULSE[2].at(WINDOWS[1]))),
            measured: vec![0.0],
            gate: known.map(|of| judged("P3", of_impulse, of.impulse)),
        },
    ]
}

/// Known values of a median of `modern`.
#[derive(Clone, Copy)]
struct KnownMedian {
    /// Median of forty other starts, seeds 21 to 60.
    median: f64,
    /// Their scatter.
    scatter: f64,
    /// Median of twenty starts with 3 % more gravity.
    more: f64,
    /// Median of twenty starts with 3 % less gravity.
    less: f64,
}

/// The known medians at H/dx.
struct KnownMedians {
    n: usize,
    /// Level at H3.
    level: KnownMedian,
    /// Impulse on P3.
    impulse: KnownMedian,
}

const MEDIANS: [KnownMedians; 2] = [
    KnownMedians {
        n: 20,
        level: KnownMedian { median: 0.5150, scatter: 0.0108, more: 0.549, less: 0.476 },
        impulse: KnownMedian { median: 0.1284, scatter: 0.0046, more: 0.174, less: 0.099 },
    },
    KnownMedians {
        n: 30,
        level: KnownMedian { median: 0.5629, scatter: 0.0100, more: 0.526, less: 0.521 },
        impulse: KnownMedian { median: 0.1218, scatter: 0.0039, more: 0.153, less: 0.083 },
    },
];

/// The gate on a median.
fn judged(id: String, metric: &str, known: KnownMedian) -> Gate {
    let KnownMedian { median, scatter, more, less } = known;
    // A median of normal numbers scatters by (π/2)^(1/2) = 1.25 of their mean's.
    let bound = 4.0 * 1.25 * scatter * (1.0_f64 / 20.0 + 1.0 / 40.0).sqrt();
    let because = format!(
        "Forty other starts, seeds 21 to 60, have the median {median} with a scatter of {scatter}. The bound \
         is four standard errors of a difference from it of a median of twenty. With 3 % more and less \
         gravity the median is {more} and {less}."
    );
    let bound = Bound::Within(median - bound, median + bound);
    Gate::new(id, metric, bound, Evidence::Regression, because)
}

#[cfg(test)]
mod tests {
    use std::thread;
    use touchstone_base::{
        mutation::{Constant, Disorder, Mutation},
        spec::RunSpec,
    };
    use touchstone_harness::studies::Study;
    use touchstone_harness::{
        case::{self, Case},
        context::Context,
        runs::{JudgedRun, Planned, Runs},
    };

    use super::*;
    use crate::waters::dam_break::DAM_BREAK;

    fn of_full_tier() -> Ensembles {
        ensembles(Tier::Full, &plan::table(Tier::Full)).expect("ensembles")
    }

    /// Eight members of the coarse ensemble of `modern`, changed in some way, and the gates that they fail.
    fn failed(change: impl Fn(RunSpec, u32) -> RunSpec + Sync) -> Vec<String> {
        let mut ensembles = of_full_tier();
        ensembles.of.truncate(1);
        ensembles.of[0].members.truncate(8);
        let members: Vec<Planned> =
            ensembles.of[0].members.iter().cloned().map(Planned::new).collect();
        let make = |(planned, seed): (Planned, u32)| {
            let changed = change(planned.spec.clone(), seed);
            let record = DAM_BREAK.run(&changed, &Context::default()).expect("a run");
            JudgedRun::new(planned, record)
        };
        let made = thread::scope(|scope| {
            let one = |member| scope.spawn(|| make(member));
            let all: Vec<_> = members.into_iter().zip(1..).map(one).collect();
            all.into_iter().map(|run| run.join().expect("a run")).collect()
        });
        let runs = Runs::new(made);
        let section = ensembles.evaluate(NAME, &runs).expect("a section");
        let failed = section.judged.iter().filter(|judged| judged.judgement.verdict.is_failure());
        failed.map(|judged| judged.gate.id.clone()).collect()
    }

    #[test]
    fn an_ensemble_passes_with_other_seeds_and_fails_with_three_per_cent_of_gravity() {
        let of = |seed| Disorder { most: 1e-6, seed };
        assert_eq!(failed(|spec, seed| spec.disordered(of(100 + seed))), [""; 0]);
        for factor in [1.03, 0.97] {
            let gravity = Mutation { of: Constant::BodyForce, factor };
            let failed = failed(|spec, _| spec.mutated(gravity));
            let expected =
                ["H3", "P3"].map(|of| format!("dam_break.ensemble.modern.20.{of}.median"));
            assert_eq!(failed, expected, "gravity times {factor}");
        }
    }

    #[test]
    fn members_are_runs_of_the_full_tier_alone_and_differ_in_their_seed() {
        assert!(ensembles(Tier::Quick, &plan::table(Tier::Quick)).is_none());
        let all = of_full_tier().of;
        let count = |of: &Ensemble| (of.members.len(), of.histories.len(), of.numbers.len());
        assert_eq!(all.iter().map(count).collect::<Vec<_>>(), [(20, 7, 2); 4]);
        let [one, other] = [0, 19].map(|k| all[0].members[k].clone());
        assert_eq!(one.disorder.map(|of| (of.most, of.seed)), Some((1e-6, 1)));
        assert_eq!(RunSpec { disorder: other.disorder, ..one.clone() }, other);
        assert!(case::changed(&DAM_BREAK, &one).contains(&"end=8".to_string()));
    }

    /// The wave arrives at 2.375 in the model and at 2.46 in the experiment, whose impulse is moved to the
    /// clock of the model; single runs are judged by impulses for 1 after the arrival of the model, and by
    /// levels until 5.5.
    #[test]
    fn histories_are_on_the_clock_of_the_model_and_are_judged_until_single_runs_are() {
        let all = of_full_tier().of;
        let of = &all[0];
        assert_eq!(of.variant, "modern");
        for (k, name) in ["P1", "P2", "P3"].into_iter().enumerate() {
            let history = &of.histories[4 + k];
            assert!(history.name.contains(name), "{}", history.name);
            let gate = history.gate.as_ref().expect("a gate");
            let Bound::Above(until) = gate.bound else { panic!("{:?}", gate.bound) };
            assert!((until - 3.375).abs() < 0.006, "{name}: {until}");
            let [measured] = &history.measured[..] else { panic!("one event") };
            let rises = measured.iter().find(|(_, y)| *y > 0.01).expect("a rise").0;
            assert!(k > 0 || (2.36..2.40).contains(&rises), "{name} rises at {rises}");
        }
        for history in &of.histories[..4] {
            let bound = history.gate.as_ref().expect("a gate").bound;
            assert_eq!(bound, Bound::Above(5.5), "{}", history.name);
        }
    }

    #[test]
    fn a_mean_of_what_comes_late_needs_a_run_that_reaches_so_far() {
        let rising: Points = (0..=800).map(|k| 0.01 * f64::from(k)).map(|t| (t, t)).collect();
        assert!(late(&rising).is_some_and(|mean| (mean - 7.0).abs() < 1e-9));
        assert_eq!(late(&rising[..500].to_vec()), None);
        let sum = integrals(&rising);
        assert!(sum.last().is_some_and(|(t, y)| (t - 8.0).abs() < 1e-9 && (y - 32.0).abs() < 1e-9));
    }
}
