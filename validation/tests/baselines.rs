//! `submit --baseline` and `compare` of two submissions.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{names, of, read, said, touchstone};

const SUBMIT: &str = "submit couette own --baseline baseline.json";
const UPDATE: &str = "submit couette own --baseline baseline.json --update-baseline";

/// A folder with a submission of Couette flow, `own`.
fn submission() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let line = "export couette --variant seed --set rows=20 --out own --solve";
    let made = touchstone(folder.path(), line);
    assert!(made.status.success(), "{}", said(&made));
    folder
}

/// Multiplies a column of the results.
fn multiply(folder: &Path, column: &str, factor: f64) {
    let file = folder.join("own/results.csv");
    let text = read(&file);
    let (head, rows) = text.split_once('\n').unwrap();
    let place = head.split(',').position(|name| name.starts_with(column)).unwrap();
    let scaled = rows.lines().map(|row| {
        let mut cells: Vec<String> = row.split(',').map(String::from).collect();
        cells[place] = format!("{:?}", factor * cells[place].parse::<f64>().unwrap());
        cells.join(",") + "\n"
    });
    fs::write(&file, format!("{head}\n{}", scaled.collect::<String>())).unwrap();
}

/// Removes the column of the densities.
fn without_density(folder: &Path) {
    let file = folder.join("own/results.csv");
    let text = read(&file);
    let short = text.lines().map(|row| row.rsplit_once(',').unwrap().0.to_string() + "\n");
    assert!(text.lines().next().unwrap().ends_with("density[kg/m^3]"));
    fs::write(&file, short.collect::<String>()).unwrap();
}

/// The verdicts that a command prints, and its exit code.
fn verdicts(folder: &Path, line: &str) -> (Value, Option<i32>) {
    let output = touchstone(folder, line);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    (
        serde_json::from_str(&text).unwrap_or_else(|_| panic!("{}", said(&output))),
        output.status.code(),
    )
}

#[test]
fn a_metric_that_got_worse_fails_and_is_accepted_only_on_request() {
    let folder = submission();
    let at = folder.path();
    let (words, code) = of(at, SUBMIT);
    assert_eq!(code, 2, "a missing baseline is no first one: {words}");
    assert!(
        words.contains("there is no baseline baseline.json; --update-baseline writes it"),
        "{words}"
    );
    assert!(!at.join("baseline.json").exists());
    assert_eq!(of(at, UPDATE).1, 0);
    let (words, code) = of(at, SUBMIT);
    assert_eq!(code, 0, "{words}");
    assert!(words.contains("none of 30 metrics is worse than before"), "{words}");
    let first = read(&at.join("baseline.json"));
    multiply(at, "u", 0.99);
    let (found, code) = verdicts(at, &format!("{SUBMIT} --json --junit junit.xml"));
    assert_eq!(code, Some(1));
    let changes = found["baseline"].as_array().unwrap();
    let change = |name: &str| changes.iter().find(|of| of["metric"] == name).unwrap();
    let l2 = change("l2@0.1");
    assert_eq!((l2["change"].as_str(), l2["has_gate"].as_bool()), (Some("worse"), Some(true)));
    let bounds = found["judged"].as_array().unwrap().iter().filter(|of| of["metric"] == "l2@0.1");
    let bound = bounds.filter_map(|of| of["bound"]["below"].as_f64()).fold(f64::INFINITY, f64::min);
    assert_eq!(l2["resolution"].as_f64(), Some(0.01 * bound), "one percent of the bound");
    assert_eq!(change("outside")["change"], "same");
    let junit = read(&at.join("junit.xml"));
    let line = format!("l2@0.1 is worse: {} before, {} now, resolution ", l2["before"], l2["now"]);
    assert!(
        junit.contains("name=\"baseline\"><failure message=") && junit.contains(&line),
        "{junit}"
    );
    assert_eq!(read(&at.join("baseline.json")), first, "nothing is overwritten unasked");
    let (words, code) = of(at, UPDATE);
    assert!(code == 0 && words.contains(": accepted"), "{words}");
    assert_ne!(read(&at.join("baseline.json")), first);
    assert_eq!(of(at, SUBMIT).1, 0);
}

/// Improvements never fail, and a metric that came is reported.
#[test]
fn metrics_that_are_better_or_new_pass_and_metrics_that_are_gone_fail() {
    let folder = submission();
    let at = folder.path();
    let whole = read(&at.join("own/results.csv"));
    assert_eq!(of(at, UPDATE).1, 0);
    without_density(at);
    let (found, code) = verdicts(at, &format!("{SUBMIT} --json"));
    assert_eq!(code, Some(1));
    let kinds = |found: &Value, kind: &str| -> Vec<String> {
        let all = found["baseline"].as_array().unwrap().iter().filter(|of| of["change"] == kind);
        all.map(|of| of["metric"].as_str().unwrap().into()).collect()
    };
    let gone = kinds(&found, "gone");
    assert!(gone.contains(&"volume_drift".to_string()), "{gone:?}");
    assert_eq!(of(at, UPDATE).1, 0);
    fs::write(at.join("own/results.csv"), whole).unwrap();
    let (found, code) = verdicts(at, &format!("{SUBMIT} --json"));
    assert_eq!((code, kinds(&found, "new")), (Some(0), gone), "the density is back");
    multiply(at, "u", 0.99);
    assert_eq!(of(at, UPDATE).1, 0);
    multiply(at, "u", 1.0 / 0.99);
    let (found, _) = verdicts(at, &format!("{SUBMIT} --json"));
    assert!(kinds(&found, "better").contains(&"l2@0.1".to_string()), "{:#}", found["baseline"]);
}

#[test]
fn a_file_that_is_no_baseline_of_this_problem_and_code_is_refused_and_stays() {
    let folder = submission();
    let at = folder.path();
    assert_eq!(of(at, UPDATE).1, 0);
    let whole = read(&at.join("baseline.json"));
    let refused = |words: &str, text: &str| {
        fs::write(at.join("baseline.json"), text).unwrap();
        for line in [SUBMIT, UPDATE] {
            let (said, code) = of(at, line);
            assert!(code == 2 && said.contains(words), "{words}: {said}");
            assert_eq!(read(&at.join("baseline.json")), text, "{line}");
        }
    };
    refused("does not have the digest", &whole.replacen("\"rows\": 20", "\"rows\": 21", 1));
    refused("it is not a baseline", &whole[..whole.len() / 2]);
    refused("it is not a baseline", "");
    refused("it is not a baseline", "my thesis");
    let run = touchstone(at, "run couette --variant seed --rows 8 --set end=0.1 --json");
    refused("a run of touchstone itself", &String::from_utf8_lossy(&run.stdout));
    let other = "export couette --variant seed --set rows=8 --set end=0.1 --out eight --solve";
    assert!(touchstone(at, other).status.success());
    let line = "submit couette eight --baseline eight.json --update-baseline";
    assert_eq!(of(at, line).1, 0);
    refused("setting rows is 8 there, 20 in the submission", &read(&at.join("eight.json")));
    fs::write(at.join("baseline.json"), &whole).unwrap();
    let method = read(&at.join("own/method.json"));
    fs::write(at.join("own/method.json"), method.replacen("\"touchstone\"", "\"another\"", 1))
        .unwrap();
    refused("code is touchstone there, another in the submission", &whole);
    fs::write(at.join("own/method.json"), method).unwrap();
    fs::File::create(at.join("baseline.json")).unwrap().set_len(1 << 30).unwrap();
    let (words, code) = of(at, SUBMIT);
    assert!(code == 2 && words.contains("allowed are at most"), "{words}");
    fs::remove_file(at.join("baseline.json")).unwrap();
    fs::create_dir(at.join("baseline.json")).unwrap();
    let (words, code) = of(at, UPDATE);
    assert!(code == 2 && words.contains("not a regular file"), "{words}");
    let (words, code) = of(at, "submit couette own --baseline no/baseline.json --update-baseline");
    assert!(code == 2 && words.contains("cannot write the file"), "{words}");
    let (words, code) = of(at, &format!("{SUBMIT} --baseline other.json"));
    assert!(code == 2 && words.contains("cannot be used multiple times"), "{words}");
    let (words, code) = of(at, "submit couette own --store store --update-baseline");
    assert!(code == 2 && words.contains("--baseline <FILE>"), "{words}");
    multiply(at, "u", 1e6);
    let (words, code) = of(at, "submit couette own --baseline broken.json --update-baseline");
    assert!(code == 2 && words.contains("is not a baseline; nothing was written"), "{words}");
    assert!(!at.join("broken.json").exists(), "{:?}", names(at));
}

#[test]
fn two_submissions_of_one_problem_are_compared_metric_by_metric() {
    let folder = submission();
    let at = folder.path();
    let first =
        touchstone(at, "submit couette own --baseline baseline.json --update-baseline --json");
    fs::write(at.join("first.json"), first.stdout).unwrap();
    multiply(at, "u", 0.99);
    let mut tables = Vec::new();
    for before in ["first.json", "baseline.json"] {
        let (found, code) = verdicts(at, &format!("compare {before} own --json"));
        assert_eq!(code, Some(0), "no gate fails");
        tables.push(found["metrics"].clone());
    }
    assert_eq!(tables[0], tables[1]);
    let first: Value = serde_json::from_str(&read(&at.join("baseline.json"))).unwrap();
    let measured = first["metrics"].as_object().unwrap().len();
    assert_eq!(tables[0].as_array().map(Vec::len), Some(measured));
    let (words, _) = of(at, "compare first.json own");
    let row = words.lines().find(|line| line.starts_with("l2@0.1 ")).unwrap();
    assert!(row.contains(" bound ") && row.ends_with(" is worse"), "{words}");
    let other = "export couette --variant seed --set rows=8 --set end=0.1 --out eight --solve";
    assert!(touchstone(at, other).status.success());
    for (line, words) in [
        ("compare own eight", "the submissions solve two problems: couette seed, and couette"),
        ("compare own .", "one is a submission and the other is not"),
        ("compare own own/particles.csv", "neither a record nor the output of `submit --json`"),
    ] {
        let (said, code) = of(at, line);
        assert!(code == 2 && said.contains(words), "{line}: {said}");
    }
    fs::remove_file(at.join("own/problem.json")).unwrap();
    let (said, code) = of(at, "compare first.json own");
    assert!(code == 2 && said.contains("own has no problem.json, which names the case"), "{said}");
}
