//! Comparisons of the quick tier with finer runs, and with the declarations of cases.
//!
//! `ladders.json` has, for each comparison, the levels of the quick tier and the result of a finer run: the
//! finest run of the full tier with these settings, and for the hills at Re 10, which the full tier lacks, a
//! run with 20 spacings per hill. Values come from records. To make it again, make both tiers and the other
//! runs:
//!
//! ```sh
//! touchstone plan > quick.jsonl && touchstone run --specs quick.jsonl --store quick
//! touchstone plan --tier full > full.jsonl && touchstone run --specs full.jsonl --store full
//! touchstone plan periodic_hill --variant carried,interface-wall \
//!     --set re=10 --set end=10 --set n=20 > hills.jsonl
//! touchstone run --specs hills.jsonl --store full
//! STORES=quick:full cargo test -p touchstone-tests --test properties comparisons::make -- --ignored
//! ```

use std::fs;
use std::path::PathBuf;

use serde_json::{Value, json};
use touchstone_base::record::Record;
use touchstone_base::spec::RunSpec;
use touchstone_harness::case::Tier;
use touchstone_harness::convergence::{ErrorLevel, convergence};
use touchstone_harness::studies::validation::{Comparison, Comparisons, Numerical, numerical};

/// The setting that is refined, and its value in the finer run.
const FINER: [(&str, &str, f64); 5] = [
    ("couette", "rows", 80.0),
    ("poiseuille", "rows", 80.0),
    ("periodic_hill", "n", 20.0),
    ("dam_break", "n", 80.0),
    ("rubber_rings", "spacing", 0.05),
];

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/ladders.json")
}

/// All comparisons of a tier with the names of their cases.
fn declared(tier: Tier) -> Vec<(&'static str, Comparison)> {
    let of = |case: &&'static dyn touchstone_harness::case::Case| {
        let name = case.name();
        let studies = case.studies(tier);
        let all: Vec<Comparison> =
            studies.of::<Comparisons>().flat_map(|of| of.0.clone()).collect();
        all.into_iter().map(move |of| (name, of))
    };
    touchstone_cases::CASES.iter().flat_map(of).collect()
}

/// A ladder of the file.
struct Ladder {
    what: [String; 3],
    levels: Vec<ErrorLevel>,
    finer: ErrorLevel,
}

fn level(of: &Value) -> ErrorLevel {
    let number = |key: &str| of[key].as_f64().expect("a number");
    ErrorLevel { spacing: number("spacing"), value: number("value") }
}

fn ladders() -> Vec<Ladder> {
    let text = fs::read_to_string(path()).expect("ladders.json");
    let all: Value = serde_json::from_str(&text).expect("JSON");
    let of = |of: &Value| Ladder {
        what: ["case", "what", "metric"].map(|key| of[key].as_str().expect("a name").into()),
        levels: of["levels"].as_array().expect("levels").iter().map(level).collect(),
        finer: level(&of["finer"]),
    };
    all.as_array().expect("a list").iter().map(of).collect()
}

/// The file has every comparison of the quick tier, with its levels.
#[test]
fn stored_ladders_are_those_of_the_quick_tier() {
    let (declared, stored) = (declared(Tier::Quick), ladders());
    assert_eq!(declared.len(), stored.len());
    for ((case, of), ladder) in declared.iter().zip(&stored) {
        assert_eq!([*case, &of.what, &of.metric.name], ladder.what.each_ref().map(String::as_str));
        let spacings: Vec<f64> = of.levels.iter().map(|level| level.spacing).collect();
        let in_file: Vec<f64> = ladder.levels.iter().map(|level| level.spacing).collect();
        assert_eq!(spacings, in_file, "{case} {}", of.what);
        assert!(ladder.finer.spacing <= 0.51 * spacings.last().expect("levels"));
    }
}

/// An interval of 95 % holds for 19 of 20. A row where it does not hold is marked.
#[test]
fn finer_runs_lie_within_the_intervals_of_the_quick_tier() {
    let (mut rows, mut held) = (Vec::new(), 0);
    let all = ladders();
    for Ladder { what: [case, what, _], levels, finer } in &all {
        let Numerical { expanded, how, .. } = numerical(levels);
        let error = levels.last().expect("levels").value;
        let is_held = (finer.value - error).abs() <= expanded;
        held += usize::from(is_held);
        rows.push(format!(
            "{case} {what}: {error:.5} ± {expanded:.5} ({how}), {:.5} at {:.3}: {is_held}",
            finer.value, finer.spacing
        ));
    }
    println!("{}", rows.join("\n"));
    assert!(
        20 * held >= 19 * all.len() && all.len() >= 20,
        "{held} of these:\n{}",
        rows.join("\n")
    );
}

/// Against exact solutions a finer run has a smaller error where the ladder converges, and where it stops an
/// error nearer to the limit than to the finest level.
#[test]
fn finer_runs_converge_or_stop_as_the_quick_tier_says() {
    let mut said = Vec::new();
    for ((case, of), ladder) in declared(Tier::Quick).into_iter().zip(ladders()) {
        if !of.is_exact() {
            continue;
        }
        let Numerical { limit, expanded, .. } = numerical(&ladder.levels);
        let finest = ladder.levels.last().expect("levels").value;
        let order = convergence(&ladder.levels, None).expect("an order");
        let stops = finest > expanded && !order.label.is_one_order();
        let holds = match stops {
            true => (ladder.finer.value - limit).abs() < (ladder.finer.value - finest).abs(),
            false => order.interval[0] > 0.0 && ladder.finer.value < finest,
        };
        assert!(holds, "{case} {}: {finest}, {limit} and {}", of.what, ladder.finer.value);
        said.push(stops);
    }
    assert_eq!(said, [true, false, true, false], "the paper's variant stops, the other converges");
}

/// The records of a folder.
fn records(folder: &str) -> Vec<Record> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let texts = paths.filter_map(|path| fs::read_to_string(path).ok());
    texts.filter_map(|text| Record::from_json(&text).ok()).collect()
}

#[test]
#[ignore = "makes the file again from the stores that the variable STORES names"]
fn make() {
    let stores = std::env::var("STORES").expect("STORES=quick:full");
    let records: Vec<Record> = stores.split(':').flat_map(records).collect();
    let value = |spec: &RunSpec, metric: &str| {
        let is_it = |record: &&Record| {
            let of = record.spec();
            (&of.case, &of.variant, &of.settings) == (&spec.case, &spec.variant, &spec.settings)
                && (of.mutation.is_none(), of.disorder.is_none()) == (true, true)
                && of.task == spec.task
        };
        let found = records.iter().find(is_it).and_then(|record| record.metrics.get(metric));
        found.unwrap_or_else(|| panic!("no record of {} with {metric}", spec.canonical())).value
    };
    let ladder = |(case, of): (&str, Comparison)| {
        let metric = &of.metric.name;
        let levels = of.levels.iter().map(
            |level| json!({ "spacing": level.spacing, "value": value(&level.run.spec, metric) }),
        );
        let (_, setting, finer) = FINER.into_iter().find(|finer| finer.0 == case).expect("a case");
        let finest = &of.levels.last().expect("levels").run.spec;
        let is_whole = finest.settings[setting].is_u64();
        let spec = RunSpec {
            settings: {
                let mut settings = finest.settings.clone();
                settings[setting] = if is_whole { json!(finer as u64) } else { json!(finer) };
                settings
            },
            ..finest.clone()
        };
        let spacing = if setting == "spacing" { finer } else { 1.0 / finer };
        json!({
            "case": case, "what": of.what, "metric": metric,
            "levels": levels.collect::<Vec<_>>(),
            "finer": { "spacing": spacing, "value": value(&spec, metric) },
        })
    };
    let all: Vec<Value> = declared(Tier::Quick).into_iter().map(ladder).collect();
    let lines: Vec<String> = all.iter().map(Value::to_string).collect();
    fs::write(path(), format!("[\n{}\n]\n", lines.join(",\n"))).expect("written");
}

/// u_D of a comparison: absolute for a length, relative for a ratio.
#[test]
fn uncertainties_of_references_are_as_stated() {
    let all = declared(Tier::Full);
    let found = |case: &str, metric: &str, against: &str| {
        let is_it = |(name, of): &&(&str, Comparison)| {
            *name == case && of.metric.name == metric && of.against.contains(against)
        };
        all.iter().filter(is_it).map(|(_, of)| of.reference).collect::<Vec<f64>>()
    };
    for (case, metric, against, expected) in [
        // 2 · 0.021 H of 2 a; of heights in H.
        ("dam_break", "front_away@2", "volume of fluid", &[0.042, 0.028][..]),
        // An impulse is compared as a share: 0.055/1.58131 and so on.
        ("dam_break", "impulse_P1_away@1", "volume of fluid", &[0.034_781]),
        ("dam_break", "impulse_P2_away@1", "volume of fluid", &[0.027_077]),
        ("dam_break", "impulse_P3_away@1", "volume of fluid", &[0.021_934]),
        ("dam_break", "impulse_P4_away@1", "volume of fluid", &[0.181_403]),
        // Two sensors differ by 0.06, which is √2 times the standard uncertainty of one.
        ("dam_break", "impulse_P1@1", "experiment", &[0.042_426]),
        ("dam_break", "front_rms_shifted", "experiment", &[0.1, 0.041]),
    ] {
        let found = found(case, metric, against);
        assert_eq!(found.len(), expected.len(), "{case} {metric}: {found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{case} {metric}: {found}, not {expected}");
        }
    }
    for (case, of) in &all {
        assert!(of.reference.is_finite() && of.reference >= 0.0, "{case} {}", of.what);
        assert_eq!(of.is_exact(), ["couette", "poiseuille"].contains(case), "{case} {}", of.what);
    }
}

/// u_input of a comparison is the change of the first level by a height that is wrong by half of the last
/// digit that is stated, of a = 2.25 inches and H = 300 mm.
#[test]
fn inputs_are_those_of_the_first_level() {
    let mut count = 0;
    for (case, of) in declared(Tier::Full) {
        for [plain, changed] in &of.inputs {
            count += 1;
            assert_eq!(*plain, of.levels[0].run.spec, "{case} {}", of.what);
            let factor = changed.mutation.expect("a mutation").factor;
            let expected = if of.what.contains("tank") || of.what.contains("impulse") {
                1.0 + 0.5 / 300.0
            } else {
                1.0 + 0.005 / 2.25
            };
            assert!((factor - expected).abs() < 1e-12, "{case} {}: {factor}", of.what);
            assert_eq!(RunSpec { mutation: None, ..changed.clone() }, *plain);
        }
    }
    assert_eq!(count, 2 + 6, "the experiments of column and tank");
}
