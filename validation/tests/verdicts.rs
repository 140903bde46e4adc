//! Input of other programs: verdicts as JSON and as JUnit XML.

use std::fs;
use std::path::Path;
use std::process::Command;

use roxmltree::Document;
use serde_json::Value;

/// The verdicts of this command line, as JSON and as JUnit XML.
fn verdicts(folder: &Path, line: &str) -> (Value, String) {
    let words = line.split(' ').chain(["--json", "--junit", "junit.xml"]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    let output = command.current_dir(folder).args(words).output().unwrap();
    let json = serde_json::from_slice(&output.stdout).expect("a document");
    (json, fs::read_to_string(folder.join("junit.xml")).unwrap())
}

/// A case with passes, limitations and controls, and without records, so that its gates fail.
fn of_a_case() -> [(Value, String); 2] {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    ["verify hydrostatic --store store", "verify --no-runs hydrostatic --store empty"]
        .map(|line| verdicts(folder.path(), line))
}

/// Every gate with the end of its run; a study counts as completed.
fn entries(verdicts: &Value) -> Vec<(&Value, bool)> {
    let list = |value: &'_ Value| value.as_array().expect("a list").len();
    assert!(list(&verdicts["runs"]) > 0);
    let all = ["runs", "studies"].into_iter().flat_map(|key| verdicts[key].as_array().unwrap());
    let of = |of: &'_ Value| of.get("status").is_none_or(|status| status["kind"] == "completed");
    all.flat_map(|one| one["judged"].as_array().unwrap().iter().map(move |gate| (gate, of(one))))
        .collect()
}

fn is_inside(bound: &Value, value: f64) -> bool {
    let (kind, ends) = bound.as_object().unwrap().iter().next().unwrap();
    let end = |value: &Value| value.as_f64().unwrap();
    match kind.as_str() {
        "below" => value <= end(ends),
        "above" => value >= end(ends),
        "equals" => value == end(ends),
        "within" => end(&ends[0]) <= value && value <= end(&ends[1]),
        other => panic!("{other} is no bound"),
    }
}

/// The verdict by the keys, as in `docs/records.md`.
fn judged_again(gate: &Value, is_completed: bool) -> &'static str {
    let is = |key: &str| gate[key].as_bool().unwrap();
    let Some(value) = gate["value"].as_f64() else {
        return match !is_completed && is("may_end_early") && gate["value"].is_null() {
            true if is("control") => "expected-failure",
            true => "limitation",
            false => "fail",
        };
    };
    let is_known = !gate["known"].is_null() && is_inside(&gate["known"], value);
    match is_inside(&gate["bound"], value) {
        true if is("control") => "fail",
        true => "pass",
        false if is("control") => "expected-failure",
        false if is_known => "limitation",
        false => "fail",
    }
}

/// A script can recompute every verdict, including limitations, from the numbers of the file.
#[test]
fn a_script_can_judge_every_gate_from_its_own_numbers() {
    let mut kinds = std::collections::BTreeSet::new();
    for (verdicts, _) in of_a_case() {
        for (gate, is_completed) in entries(&verdicts) {
            for key in ["metric", "unit", "bound", "known", "evidence", "because", "cause"] {
                assert!(gate.get(key).is_some(), "{key} is not stated: {gate}");
            }
            let verdict = gate["verdict"].as_str().unwrap();
            assert_eq!(judged_again(gate, is_completed), verdict, "{gate}");
            assert_eq!(gate["unit"].is_null(), gate["value"].is_null(), "{gate}");
            let has = |key: &str| !gate[key].is_null();
            assert!(verdict != "limitation" || (has("known") && has("cause") && has("reason")));
            kinds.insert(verdict.to_string());
        }
    }
    let expected = ["expected-failure", "fail", "limitation", "pass"];
    assert!(kinds.iter().eq(expected), "{kinds:?}");
}

/// The stated numbers of tests and failures equal the numbers of elements.
#[test]
fn junit_counts_what_it_holds() {
    for (verdicts, xml) in of_a_case() {
        let document = Document::parse(&xml).expect("well-formed");
        let below = |node: roxmltree::Node, name: &str| {
            node.descendants().filter(|node| node.has_tag_name(name)).count().to_string()
        };
        let mut cases = 0;
        for suite in document.descendants().filter(|node| node.has_tag_name("testsuite")) {
            for (attribute, name) in
                [("tests", "testcase"), ("failures", "failure"), ("skipped", "skipped")]
            {
                let stated = suite.attribute(attribute).map(String::from);
                assert_eq!(stated, Some(below(suite, name)), "{attribute}: {xml}");
            }
            cases += 1;
        }
        assert_eq!(cases, 1);
        let count = |verdict: &str| {
            let all = entries(&verdicts).into_iter();
            all.filter(|(gate, _)| verdict.is_empty() || gate["verdict"] == verdict).count()
        };
        assert_eq!(below(document.root(), "testcase"), count("").to_string());
        assert_eq!(below(document.root(), "failure"), count("fail").to_string());
    }
}

/// "1 known limitations".
#[test]
fn number_and_verb_agree() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.current_dir(folder.path()).args(["verify", "hydrostatic", "--store", "store"]);
    let text = String::from_utf8(command.output().unwrap().stdout).unwrap();
    let limited = "1 known limitation";
    assert!(text.contains(&format!("\n{limited}; `touchstone explain")), "{text}");
    assert!(
        text.contains(&format!(" gates pass, {limited}, 1 control fails as it must")),
        "{text}"
    );
}
