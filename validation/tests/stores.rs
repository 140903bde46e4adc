//! Runs of other codes in a store: judged where our own runs are, compared by code and scheme, and none is
//! lost in silence.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use serde_json::Value;
use touchstone_base::{
    record::{Record, Status},
    reference::sha256,
};

use crate::common::{of, touchstone};

/// A gate of the problem that the submissions of these tests solve.
const GATE: &str = "couette.modern.20.l2@0.1";

/// Our own results as another code's, made once.
fn solved() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let (words, code) = of(folder.path(), "export couette --variant modern --out own --solve");
        assert_eq!(code, 0, "{words}");
        folder
    });
    folder.path()
}

/// A submission by the code `code` in the folder `to`, whose velocities are ours times a factor.
fn submission(to: &Path, code: [&str; 2], factor: f64) {
    let own = solved().join("own");
    fs::create_dir(to).unwrap();
    fs::copy(own.join("problem.json"), to.join("problem.json")).unwrap();
    fs::copy(own.join("system.json"), to.join("system.json")).unwrap();
    let method = format!(
        "{{\"code\": \"{}\", \"version\": \"{}\", \"scheme\": \"s\", \"division\": \"closed\", \
         \"settings\": {{}}, \"changed\": \"nothing\"}}",
        code[0], code[1]
    );
    fs::write(to.join("method.json"), method).unwrap();
    let text = fs::read_to_string(own.join("results.csv")).unwrap();
    let mut lines = text.lines();
    let mut scaled = lines.next().unwrap().to_string() + "\n";
    let column = scaled.split(',').position(|head| head.starts_with("u[")).expect("a column");
    for line in lines {
        let mut cells: Vec<String> = line.split(',').map(String::from).collect();
        cells[column] = (factor * cells[column].parse::<f64>().unwrap()).to_string();
        scaled += &(cells.join(",") + "\n");
    }
    fs::write(to.join("results.csv"), scaled).unwrap();
}

fn records(store: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(store).unwrap().flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

/// Equal results by their names, and verdicts on the accuracy.
fn equal_results_and_accuracies_are_told(page: &str) {
    let told = page.split("Equal results, to the last bit").nth(1).expect("they are told");
    let told = told.split("</p>").next().unwrap();
    for [a, b] in [["good code 1, s", "second code 7, s"], ["good code 1, s", "good code 1, t"]] {
        let is_told =
            [format!("{a} and {b}"), format!("{b} and {a}")].iter().any(|two| told.contains(two));
        assert!(is_told, "{a} and {b}: {told}");
    }
    assert!(!told.contains("bad code"), "{told}");
    // Their only gate is on the error at one of the times: it judges the accuracy.
    for (code, verdict) in [("good code 1, s", "pass"), ("bad code 1, s", "fail")] {
        let is_its = |row: &&str| row.contains(&format!("<td>{code} ("));
        let row = page.split("<tr>").find(is_its).expect(code).to_lowercase();
        assert!(row.contains(&format!("<td>{verdict}</td>")), "{row}");
    }
}

/// `judge`, `report`, verdicts.json and JUnit did not know submissions, and a store of them alone was "604
/// gates fail".
#[test]
fn submissions_are_judged_where_our_own_runs_are() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    submission(&at.join("good"), ["good code", "1"], 1.0);
    submission(&at.join("bad"), ["bad code", "1"], 1.5);
    assert_eq!(of(at, "submit couette good --store st").1, 0);
    let judged = |line: &str| {
        let output = touchstone(at, &format!("{line} --junit junit.xml"));
        let verdicts = String::from_utf8_lossy(&output.stdout).into_owned();
        let junit = fs::read_to_string(at.join("junit.xml")).unwrap();
        (verdicts, junit, output.status.code().unwrap())
    };
    let (words, _, code) = judged("verify --no-runs couette --store st");
    assert_eq!(code, 0, "our own runs are absent and do not fail: {words}");
    assert!(
        !words.contains("gates fail") && words.contains("\nRuns of other codes: 1 "),
        "{words}"
    );
    assert!(
        words.trim_start().starts_with("runs of other codes ") && !words.contains("ur own runs"),
        "{words}"
    );
    let (words, _) = of(at, "verify --no-runs couette --store st");
    assert!(words.contains("\n1 run of another code in "), "{words}");
    assert_eq!(of(at, "submit couette bad --store st").1, 1);
    let (words, junit, code) = judged("verify --no-runs couette --store st");
    assert_eq!(code, 1, "{words}");
    let line = words.lines().find(|line| line.contains("bad code")).expect("a line");
    assert!(line.contains(GATE), "{words}");
    assert!(junit.contains("couette modern by bad code 1, s") && junit.contains("<failure"));
    assert!(!junit.contains("PySPH"), "records of the program are none of the store's");
    let (json, _, code) = judged("verify --no-runs couette --store st --json");
    assert_eq!(code, 1);
    let verdicts: Value = serde_json::from_str(&json).unwrap();
    let all = verdicts["submissions"].as_array().unwrap();
    let by = |code: &str| all.iter().find(|of| of["submission"]["code"] == code).expect("a code");
    let verdict = |of: &Value| {
        let judged = of["judged"].as_array().unwrap();
        judged.iter().find(|judged| judged["gate"] == GATE).unwrap()["verdict"].clone()
    };
    assert_eq!(["good code", "bad code"].map(|code| verdict(by(code))), ["pass", "fail"]);
    assert_eq!(["bad code", "PySPH"].map(|code| &by(code)["embedded"]), [false, true]);
    assert!(verdicts["counts"].get("fail").is_none(), "{}", verdicts["counts"]);
    submission(&at.join("borrowed"), ["second code", "7"], 1.0);
    assert_eq!(of(at, "submit couette borrowed --store st").1, 0);
    submission(&at.join("scheme"), ["good code", "1"], 1.0);
    let method = fs::read_to_string(at.join("scheme/method.json")).unwrap();
    let method = method.replace("\"scheme\": \"s\"", "\"scheme\": \"t\"");
    fs::write(at.join("scheme/method.json"), method).unwrap();
    assert_eq!(of(at, "submit couette scheme --store st").1, 0);
    let (words, code) = of(at, "report --store st --out page");
    assert!(code == 1 && words.contains("bad code"), "{words}");
    let page = fs::read_to_string(at.join("page/index.html")).unwrap();
    for part in [
        "in the store:",
        "bad code 1, s",
        "as submitted",
        "proves nothing",
        "not reviewed the scripts",
    ] {
        assert!(page.contains(part), "the page lacks {part:?}");
    }
    equal_results_and_accuracies_are_told(&page);
}

/// Gates of submissions were not compared, and a new version was another run.
#[test]
fn a_code_that_fails_in_a_new_version_is_a_new_failure() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    submission(&at.join("a"), ["code", "1"], 1.0);
    submission(&at.join("b"), ["code", "2"], 1.5);
    submission(&at.join("c"), ["code", "1"], 1.0001);
    for (from, to) in [("a", "one"), ("b", "two"), ("c", "three"), ("a", "both"), ("b", "both")] {
        let (words, code) = of(at, &format!("submit couette {from} --store {to}"));
        assert!(code < 2, "{words}");
    }
    let compared = |line: &str| {
        let output = touchstone(at, &format!("compare {line} --json"));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        (json["new_failures"].as_u64().unwrap(), output.status.code().unwrap())
    };
    assert_eq!(compared("one two"), (1, 1));
    assert_eq!(compared("one both"), (1, 1), "the old version is still there");
    assert_eq!(compared("two one"), (0, 0), "it passes now");
    assert_eq!(compared("one three"), (0, 0), "other results that pass too");
    assert_eq!(compared("one one"), (0, 0));
    let (words, _) = of(at, "compare one two");
    assert!(words.contains("version 1") && words.contains("version 2"), "{words}");
    fs::remove_file(&records(&at.join("two"))[0]).unwrap();
    submission(&at.join("d"), ["another code", "1"], 1.0);
    assert_eq!(of(at, "submit couette d --store two").1, 0);
    let (words, code) = of(at, "compare one two");
    assert!(code == 1 && words.contains("gone: 1") && words.contains("new: "), "{words}");
}

/// A second submission of one method must not replace the first without notice, in particular not a passing
/// one by a failing one.
#[test]
fn a_submission_never_takes_the_place_of_another_in_silence() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let store = at.join("st");
    submission(&at.join("a"), ["code", "1"], 1.0);
    submission(&at.join("b"), ["code", "1"], 1.5);
    assert_eq!(of(at, "submit couette a --store st").1, 0);
    assert_eq!(of(at, "submit couette b --store st").1, 1);
    assert_eq!(records(&store).len(), 2, "both are kept");
    let written = || records(&store).iter().map(|path| fs::read(path).unwrap()).collect::<Vec<_>>();
    let before = written();
    assert_eq!(of(at, "submit couette a --store st").1, 0, "the same once more");
    // Other columns first, other digits: equal results.
    let text = fs::read_to_string(at.join("a/results.csv")).unwrap();
    let swapped = |line: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells.swap(0, 1);
        cells.join(",") + "\n"
    };
    fs::write(at.join("a/results.csv"), text.lines().map(swapped).collect::<String>()).unwrap();
    assert_eq!(of(at, "submit couette a --store st").1, 0);
    assert_eq!(written(), before);
    let system = fs::read_to_string(at.join("a/system.json")).unwrap();
    let other: Value = serde_json::from_str(&system).unwrap();
    let mut other = other.as_object().unwrap().clone();
    other.insert("machine".into(), "another".into());
    fs::write(at.join("a/system.json"), serde_json::to_string(&other).unwrap()).unwrap();
    let (words, code) = of(at, "submit couette a --store st");
    assert!(code == 2 && words.contains("but differs: machine"), "{words}");
    assert_eq!(written(), before);
}

/// A record can be edited and given a matching digest: only its results can disprove it.
#[test]
fn a_forged_record_is_refused_by_its_results() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    submission(&at.join("a"), ["code", "1"], 1.5);
    assert_eq!(of(at, "submit couette a --store st").1, 1);
    let path = &records(&at.join("st"))[0];
    let record = Record::from_json(&fs::read_to_string(path).unwrap()).unwrap();
    type Forge = fn(&mut Record);
    let forgeries: [(Forge, &str); 6] = [
        (|of| of.metrics.get_mut("l2@0.1").unwrap().value = 1e-5, "l2@0.1 (1e-5 there"),
        (|of| drop(of.metrics.remove("l2@0.1")), "l2@0.1 (not measured there"),
        (
            |of| drop(of.metrics.insert("l3".into(), of.metrics["l2@0.1"].clone())),
            "there, not measured by the results",
        ),
        (|of| of.cost.wall_s *= 0.5, "but differs: cost;"),
        (|of| of.cost.pair_interactions += 1, "but differs: cost;"),
        (
            |of| {
                let (field, value_text) = ("density".into(), "NaN".into());
                of.status = Status::Diverged { step: 0, time: 0.1, particle: 0, field, value_text }
            },
            "but differs: how the run ended;",
        ),
    ];
    for (forge, says) in forgeries {
        let mut forged = record.clone();
        forge(&mut forged);
        let json = forged.to_json().unwrap();
        assert!(Record::from_json(&json).is_ok(), "its digest fits");
        fs::write(path, json).unwrap();
        let (words, code) = of(at, "submit couette a --store st");
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(code == 2 && words.contains(says), "expected {says:?} in {words}");
    }
}

/// Equal results of two codes have equal digests, and the machine of the other code is not this program's.
#[test]
fn results_have_a_digest_and_machines_are_not_mixed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    submission(&at.join("a"), ["first", "1"], 1.0);
    submission(&at.join("b"), ["second", "7"], 1.0);
    for name in ["a", "b"] {
        assert_eq!(of(at, &format!("submit couette {name} --store st")).1, 0);
    }
    let [a, b] = [0, 1].map(|k| {
        let text = fs::read_to_string(&records(&at.join("st"))[k]).unwrap();
        Record::from_json(&text).unwrap()
    });
    let results = |of: &Record| of.run.submission.clone().unwrap().results.unwrap();
    assert_eq!((results(&a), results(&a).len()), (results(&b), sha256(b"").len()));
    let run = touchstone(at, "run couette --variant modern --set rows=8 --set end=0.01 --json");
    let run = Record::from_json(&String::from_utf8_lossy(&run.stdout)).unwrap();
    assert_eq!(a.manifest.sources, run.manifest.sources, "of this build");
    // Rows of one time in another order are equal results; another number in any column makes others.
    let whole = fs::read_to_string(at.join("a/results.csv")).unwrap();
    let rows: Vec<Vec<&str>> =
        whole.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let digest = |rows: &[Vec<&str>]| {
        let store = tempfile::tempdir().unwrap();
        let head = whole.lines().next().unwrap();
        let lines: String = rows.iter().map(|row| row.join(",") + "\n").collect();
        fs::write(at.join("a/results.csv"), format!("{head}\n{lines}")).unwrap();
        let (words, code) = of(at, &format!("submit couette a --store {}", store.path().display()));
        assert!(code < 2, "{words}");
        let text = fs::read_to_string(&records(store.path())[0]).unwrap();
        results(&Record::from_json(&text).unwrap())
    };
    let frames = rows.chunk_by(|one, other| one[0] == other[0]);
    let turned: Vec<Vec<&str>> = frames.flat_map(|frame| frame.iter().rev().cloned()).collect();
    assert_eq!(digest(&turned), results(&a));
    for column in 2..7 {
        let mut other = rows.clone();
        let changed = (other[0][column].parse::<f64>().unwrap() * (1.0 + 1e-6) + 1e-12).to_string();
        other[0][column] = &changed;
        assert_ne!(digest(&other), results(&a), "column {column}");
    }
    fs::write(at.join("a/results.csv"), &whole).unwrap();
    let system = fs::read_to_string(at.join("a/system.json")).unwrap();
    let system: Value = serde_json::from_str(&system).unwrap();
    assert_eq!(a.numerics["machine"].as_str(), system["machine"].as_str());
}

/// The settings that a challenge draws for a method, or why there are none.
fn drawn(at: &Path, method: &str, arguments: &str) -> Result<String, String> {
    fs::write(at.join("method.json"), method).unwrap();
    let output = touchstone(
        at,
        &format!("export {arguments} --method method.json --out sealed --overwrite"),
    );
    let [out, error] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    match output.status.code() {
        Some(0) => Ok(out.into_owned()),
        Some(2) => Err(error.into_owned()),
        code => panic!("{code:?}: {error}"),
    }
}

/// A change of words must not draw another problem: a solver could try words until one fits.
#[test]
fn words_of_a_method_draw_nothing_and_what_it_is_does() {
    let folder = tempfile::tempdir().unwrap();
    let method = |version: &str, settings: &str, changed: &str| {
        format!(
            "{{\"code\": \"c\", \"version\": \"{version}\", \"scheme\": \"WCSPH\", \"division\": \
             \"closed\", \"settings\": {settings}, \"changed\": \"{changed}\"}}"
        )
    };
    let settings = r#"{"h": 1.5, "note": "a", "on": true, "times": [1, {"end": 2}]}"#;
    let of = |text: &str| drawn(folder.path(), text, "couette --sealed 7").unwrap();
    let first = of(&method("1", settings, "nothing"));
    let spaced = method("1", settings, "nothing").replace(": ", " :\n ");
    let same = [
        method("1", settings, "nothing 2"),
        method(
            "1",
            r#"{"times": [1.0, {"end": 2}], "note": "b", "on": true, "h": 15e-1}"#,
            "nothing",
        ),
        method("1 ", settings, "nothing"),
        method("1", settings, "nothing").replace("WCSPH", "wcsph!"),
        spaced,
    ];
    for text in same {
        assert_eq!(of(&text), first, "{text}");
    }
    let others = [
        method("2", settings, "nothing"),
        method("1", &settings.replace("1.5", "1.6"), "nothing"),
        method("1", &settings.replace("true", "false"), "nothing"),
        method("1", &settings.replace("[1,", "[3,"), "nothing"),
        method("1", &settings.replace("\"end\": 2", "\"end\": 3"), "nothing"),
        method("1", settings, "nothing").replace("closed", "open"),
        method("1", settings, "nothing").replace("WCSPH", "ISPH"),
    ];
    for text in others {
        assert_ne!(of(&text), first, "{text}");
    }
    let other_seed = drawn(folder.path(), &method("1", settings, "nothing"), "couette --sealed 8");
    assert_ne!(other_seed.unwrap(), first);
}

/// Equal numbers in any notation, anywhere among the settings of a method, have one digest.
#[test]
fn a_method_has_one_digest_however_its_numbers_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let digest = |settings: &str| {
        let method = format!(
            "{{\"code\": \"c\", \"version\": \"1\", \"scheme\": \"s\", \"division\": \"closed\", \
             \"settings\": {settings}, \"changed\": \"\"}}"
        );
        drawn(folder.path(), &method, "couette --sealed 1").unwrap();
        let problem = fs::read_to_string(folder.path().join("sealed/problem.json")).unwrap();
        let problem: Value = serde_json::from_str(&problem).unwrap();
        problem["sealed"]["method"].as_str().expect("a digest").to_string()
    };
    let first = digest(r#"{"a": 1, "b": [1, {"c": 2}]}"#);
    for same in [r#"{"b": [1.0, {"c": 2}], "a": 1}"#, r#"{"a": 10e-1, "b": [1, {"c": 2.0}]}"#] {
        assert_eq!(digest(same), first, "{same}");
    }
    for other in [
        r#"{"a": 1, "b": [1, {"c": 2.5}]}"#,
        r#"{"a": 1, "b": [{"c": 2}, 1]}"#,
        r#"{"a": 1, "b": ["1", {"c": 2}]}"#,
    ] {
        assert_ne!(digest(other), first, "{other}");
    }
}

/// Problems that no submission can solve, or no gate can judge, are not sealed.
#[test]
fn what_has_no_bound_or_is_no_method_is_not_sealed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let method = "{\"code\": \"c\", \"version\": \"1\", \"scheme\": \"s\", \"division\": \"closed\", \
                  \"settings\": {}, \"changed\": \"\"}";
    for text in
        ["", "[]", "<script>", &method.replace("closed", "none"), &method.replace("\"c\"", "\"\"")]
    {
        let words = drawn(at, text, "couette --sealed 1").unwrap_err();
        assert!(words.contains("no submission can have this method"), "{text}: {words}");
    }
    for (arguments, expected) in [
        ("elastic_bar --sealed 1", "elastic_bar has no sealed problems"),
        ("couette --variant seed --sealed 1", "variants that have: modern"),
        ("couette --variant nothing --sealed 1", "is called \"nothing\""),
    ] {
        let words = drawn(at, method, arguments).unwrap_err();
        assert!(words.contains(expected), "{arguments}: {words}");
    }
    assert!(!at.join("sealed").exists(), "nothing is written");
}

/// Settings are drawn all over the range in which the reference holds, and nowhere else.
#[test]
fn sealed_settings_lie_where_the_reference_holds() {
    let folder = tempfile::tempdir().unwrap();
    let method = fs::read_to_string(solved().join("own/method.json")).unwrap();
    for (case, name, [low, high]) in
        [("couette", "re", [0.05, 20.0]), ("hydrostatic", "compressibility", [0.001, 0.05])]
    {
        let value = |seed: u32| -> f64 {
            let set = drawn(folder.path(), &method, &format!("{case} --sealed {seed}")).unwrap();
            let value =
                set.split_whitespace().find_map(|one| one.strip_prefix(&format!("{name}=")));
            value.expect(&set).parse().unwrap()
        };
        let values: Vec<f64> = (0..24).map(value).collect();
        let [least, most] =
            [f64::min, f64::max].map(|end| values.iter().copied().reduce(end).unwrap());
        assert!(low <= least && most <= high && most > 8.0 * least, "{case}: {least} to {most}");
    }
}

/// An error that has a sign is bounded on both sides in a sealed problem, too.
#[test]
fn a_sealed_error_with_a_sign_is_bounded_on_both_sides() {
    let folder = tempfile::tempdir().unwrap();
    let method = fs::read_to_string(solved().join("own/method.json")).unwrap();
    for (case, metric) in [
        ("cantilever --variant lagrangian", "frequency_error"),
        ("periodic_hill --variant carried", "force_error"),
        ("rubber_rings --variant lagrangian", "width_min_error"),
    ] {
        drawn(folder.path(), &method, &format!("{case} --sealed 1")).unwrap();
        let problem = fs::read_to_string(folder.path().join("sealed/problem.json")).unwrap();
        let problem: Value = serde_json::from_str(&problem).unwrap();
        let gates = problem["judged_by"].as_array().unwrap();
        let gate = gates.iter().find(|gate| gate["metric"] == metric).expect(metric);
        let [low, high] = [0, 1].map(|k| gate["bound"]["within"][k].as_f64().unwrap_or(f64::NAN));
        assert!(low == -high && high > 0.0, "{case}: {gate}");
    }
}

/// Sealed problems were never judged: our own runs pass, and twice the velocity fails.
#[test]
fn sealed_problems_are_judged() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let method = fs::read_to_string(solved().join("own/method.json")).unwrap();
    let cases: [(&str, &str, &[u64]); 4] = [
        ("couette", "l2_worst", &[1, 2]),
        ("taylor_couette", "l2", &[1]),
        ("hydrostatic", "p_l2", &[1]),
        ("operators", "symbol_error", &[1]),
    ];
    for (case, metric, seeds) in cases {
        for seed in seeds {
            let _ = fs::remove_dir_all(at.join("sealed"));
            let set = drawn(at, &method, &format!("{case} --sealed {seed}")).unwrap();
            let set: String = set.split_whitespace().map(|one| format!(" --set {one}")).collect();
            let (words, code) =
                of(at, &format!("export {case}{set} --out own{case}{seed} --solve"));
            assert_eq!(code, 0, "{words}");
            let own = at.join(format!("own{case}{seed}"));
            for name in ["results.csv", "system.json"] {
                fs::copy(own.join(name), at.join("sealed").join(name)).unwrap();
            }
            let id = format!(".sealed.{metric}");
            let readme = fs::read_to_string(at.join("sealed/README.md")).unwrap();
            assert!(readme.contains(&id), "{readme}");
            let (words, code) = of(at, &format!("submit {case} sealed --store st --all"));
            assert!(code == 0 && words.contains(&id), "{case}{set}: {words}");
            double(
                &at.join("sealed/results.csv"),
                if metric == "p_l2" { "density[" } else { "u[" },
            );
            let (words, code) = of(at, &format!("submit {case} sealed --store st --all"));
            assert!(code == 1 && words.contains(&id), "twice as much, {case}{set}: {words}");
        }
    }
}

/// Multiplies a column by two, or makes densities 2 % larger where the water has its own weight.
fn double(path: &Path, column: &str) {
    let text = fs::read_to_string(path).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    let k = head.split(',').position(|name| name.starts_with(column)).expect("a column");
    let factor = if column == "u[" { 2.0 } else { 1.02 };
    let row = |row: &str| {
        let mut cells: Vec<String> = row.split(',').map(String::from).collect();
        cells[k] = (factor * cells[k].parse::<f64>().unwrap()).to_string();
        cells.join(",") + "\n"
    };
    fs::write(path, format!("{head}\n{}", rows.lines().map(row).collect::<String>())).unwrap();
}

/// `report` of a sweep judges no gates, and replaces no page of other records.
#[test]
fn a_sweep_is_shown_judged_by_nothing_and_replaces_no_page_of_other_records() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (store, values) in [("sweep", "re=0.5,1"), ("other", "re=2")] {
        let plan = format!(
            "plan couette --variant plain,seed --set rows=8,10 --set end=0.2 --set {values}"
        );
        fs::write(at.join("plan"), of(at, &plan).0).unwrap();
        assert_eq!(of(at, &format!("run --specs plan --store {store}")).1, 0);
    }
    let (text, code) = of(at, "report --store sweep");
    assert_eq!(code, 0, "{text}");
    let heads = ["variant", "re", "rows", "end", "error", "run", "time", "pairs"];
    assert!(text.lines().any(|line| line.split_whitespace().take(8).eq(heads)), "{text}");
    for (variant, runs) in [("plain ", 4), ("seed ", 4)] {
        assert_eq!(text.lines().filter(|line| line.starts_with(variant)).count(), runs, "{text}");
    }
    assert!(!text.contains("gates fail") && text.contains("No gate is judged"), "{text}");
    let page = |path: &str| fs::read_to_string(at.join(path).join("index.html")).unwrap();
    for part in ["id=\"couette-sweep-cost\"", "plain re=1", "No gate is judged"] {
        assert!(page("sweep").contains(part), "{part}");
    }
    assert_eq!(of(at, "report --store sweep").1, 0, "the same records");
    assert_eq!(of(at, "report --store sweep --out page").1, 0);
    let before = page("page");
    for line in ["report --store other --out page", "report --out page --store other --partial"] {
        let (text, code) = of(at, line);
        assert!(code == 2 && text.contains("made from other records"), "{line}: {text}");
        assert_eq!(page("page"), before, "{line}");
    }
    assert_eq!(of(at, "report --store other --out page --overwrite").1, 0);
    assert!(page("page").contains("plain re=2"));
    fs::write(at.join("page/index.html"), "my own page").unwrap();
    let (text, code) = of(at, "report --out page");
    assert!(
        code == 2 && text.contains("--overwrite") && !at.join("page/records").exists(),
        "{text}"
    );
    assert_eq!(page("page"), "my own page");
}
