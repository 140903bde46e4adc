//! Submissions of other codes: our own results return the metrics of the run, and damaged ones are refused
//! with file, line and column.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use touchstone_base::functions::cos;
use touchstone_base::record::Record;
use touchstone_base::reference::Reference;
use touchstone_base::spec::RunSpec;
use touchstone_base::submission::OURS;

use crate::common::{read, said, touchstone};

/// A folder with a whole submission of Couette flow with eight rows, made once.
fn whole() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let line = "export couette --variant seed --set rows=8 --set end=0.1 --out whole --solve";
        let made = touchstone(folder.path(), line);
        assert!(made.status.success(), "{}", said(&made));
        folder
    });
    folder.path()
}

/// A copy of the whole submission in a separate folder.
fn copy() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("copy");
    fs::create_dir(&copy).unwrap();
    for entry in fs::read_dir(whole().join("whole")).unwrap().flatten() {
        fs::copy(entry.path(), copy.join(entry.file_name())).unwrap();
    }
    (folder, copy)
}

/// For a job of continuous integration: the verdicts as an entry of verdicts.json and as test cases, of a
/// submission that passes and of one whose velocities are 10 % too large.
#[test]
fn verdicts_on_a_submission_are_written_for_other_programs() {
    let folder = tempfile::tempdir().unwrap();
    let export = "export couette --variant seed --set rows=20 --out own --solve";
    assert!(touchstone(folder.path(), export).status.success());
    let line = "submit couette own --store store --json --junit junit.xml";
    let verdicts = || {
        let made = touchstone(folder.path(), line);
        let verdicts: serde_json::Value = serde_json::from_slice(&made.stdout).expect("JSON alone");
        (made.status.code(), verdicts, read(&folder.path().join("junit.xml")))
    };
    let (code, passed, junit) = verdicts();
    let judged = passed["judged"].as_array().expect("judgements");
    let skipped = passed["not_applicable"].as_object().expect("reasons").len();
    assert_eq!((code, &passed["submission"]["code"]), (Some(0), &OURS.into()));
    assert!(judged.iter().all(|of| of["verdict"] == "pass"), "{passed}");
    let count = judged.len() + skipped;
    assert!(
        !judged.is_empty() && junit.contains(&format!("tests=\"{count}\" failures=\"0\"")),
        "{junit}"
    );
    assert!(junit.contains("name=\"couette.seed.20.l2@0.1\"></testcase>"), "{junit}");
    let results = folder.path().join("own/results.csv");
    let text = read(&results);
    let (head, rows) = text.split_once('\n').expect("a head");
    let u = head.split(',').position(|name| name.starts_with("u[")).expect("velocities");
    let faster = rows.lines().map(|row| {
        let mut cells: Vec<String> = row.split(',').map(String::from).collect();
        cells[u] = (1.1 * cells[u].parse::<f64>().expect("a number")).to_string();
        cells.join(",") + "\n"
    });
    fs::write(&results, format!("{head}\n{}", faster.collect::<String>())).unwrap();
    fs::remove_dir_all(folder.path().join("store")).unwrap();
    let (code, failed, junit) = verdicts();
    let fails = |of: &&serde_json::Value| of["verdict"] == "fail";
    let count = failed["judged"].as_array().expect("judgements").iter().filter(fails).count();
    assert_eq!(code, Some(1), "{junit}");
    assert!(count > 0 && junit.matches("<failure message").count() == count, "{junit}");
    let refused = touchstone(folder.path(), &format!("{line} --check"));
    assert_eq!(refused.status.code(), Some(2));
}

/// Measured from their particles alone, with no step made: the values of the run, except for round-off.
#[test]
fn our_own_results_are_measured_as_the_run_was() {
    let cases = [
        "couette --variant seed --set rows=8",
        "poiseuille --variant seed --set rows=8",
        "taylor_green --set n=16",
        "dam_break --variant seed --set n=8 --set end=1",
        "elliptic_drop --set n=10",
        "taylor_couette --variant extrapolating-wall",
        "operators --variant quintic-density --set n=16",
        "operators --variant cubic-laplacian --set n=16",
        "operators --variant wendland-divergence-corrected --set n=16 --set disorder=0",
    ];
    for line in cases {
        let folder = tempfile::tempdir().unwrap();
        let made = touchstone(folder.path(), &format!("export {line} --out own --solve"));
        assert!(made.status.success(), "{line}: {}", said(&made));
        let case = line.split(' ').next().unwrap();
        let submitted = touchstone(folder.path(), &format!("submit {case} own --store store"));
        let file = fs::read_dir(folder.path().join("store")).unwrap().flatten().next();
        let file = file.unwrap_or_else(|| panic!("{line}: {}", said(&submitted)));
        let found = Record::from_json(&read(&file.path())).unwrap();
        let run = touchstone(folder.path(), &format!("run {line} --json"));
        let own = Record::from_json(&String::from_utf8_lossy(&run.stdout)).unwrap();
        let mut compared = 0;
        for (name, metric) in &found.metrics {
            let (found, own) = (metric.value, own.metrics[name].value);
            assert!(
                (found - own).abs() <= 1e-12 * own.abs().max(1.0),
                "{name} of {line}: the submission has {found}, the run {own}"
            );
            compared += 1;
        }
        assert!(compared >= 3, "{line}: only {compared} metrics were compared");
        let of = found.run.submission.as_ref().expect("the record says who made the run");
        assert_eq!((&*of.code, &*of.scheme), ("touchstone", &*own.run.variant), "{line}");
        let counts = |of: &Record| [of.cost.steps, of.cost.pair_interactions];
        assert_eq!(counts(&found), counts(&own), "counts of {line} as system.json states them");
    }
}

/// A submission of the profile or series that `run --out` writes under this name, whose columns have L = 1 m
/// and c0 = 1 m/s for units.
fn of_curve(line: &str, file: &str) -> (tempfile::TempDir, Record) {
    let (folder, case) = (tempfile::tempdir().unwrap(), line.split(' ').next().unwrap());
    for command in [&*format!("export {line} --out own"), &format!("run {line} --out run")] {
        let made = touchstone(folder.path(), command);
        assert!(made.status.success(), "{command}: {}", said(&made));
    }
    let own = folder.path().join("own");
    let written = read(&folder.path().join("run").join(file));
    let (header, rows) = written.split_once('\n').unwrap();
    let header = header.replace("[L/c0]", "[s]").replace("[L]", "[m]").replace("[c0]", "[m/s]");
    fs::write(own.join("curve.csv"), format!("{header}\n{rows}")).unwrap();
    for file in ["method.json", "system.json"] {
        fs::copy(whole().join("whole").join(file), own.join(file)).unwrap();
    }
    let submitted = touchstone(folder.path(), &format!("submit {case} own --store store"));
    let file = fs::read_dir(folder.path().join("store")).ok().and_then(|mut all| all.next());
    let file = file.unwrap_or_else(|| panic!("{line}: {}", said(&submitted))).unwrap();
    let record = Record::from_json(&read(&file.path())).unwrap();
    (folder, record)
}

/// For a code without particles the metrics of its curve equal the run that wrote it, and all others are
/// removed by name.
#[test]
fn our_own_profile_or_path_is_measured_as_the_run_was() {
    for (line, file, least, left_out) in [
        ("couette --variant seed --set rows=8", "profile.csv", 20, "p_rms"),
        ("poiseuille --variant modern --set rows=8", "profile.csv", 20, "v_rms"),
        ("cantilever --variant lagrangian --set n=4", "end.csv", 20, "energy_change"),
        ("dam_break --variant modern --set n=8", "series.csv", 6, "mach"),
        ("rubber_rings --variant lagrangian --set spacing=0.25", "series.csv", 10, "momentum"),
    ] {
        let (folder, found) = of_curve(line, file);
        let own = Record::from_json(&read(&folder.path().join("run/record.json"))).unwrap();
        for (name, metric) in &found.metrics {
            let (found, own) = (metric.value, own.metrics[name].value);
            let difference = (found - own).abs();
            assert!(difference <= 1e-12 * own.abs().max(1.0), "{name} of {line}: {found}, {own}");
        }
        for (name, column) in found
            .profiles
            .iter()
            .flat_map(|(name, curve)| curve.columns.iter().map(move |column| (name, column)))
        {
            let own = own.profiles[name].column(&column.name);
            let is_near =
                |(found, own): (&f64, &f64)| (found - own).abs() <= 1e-12 * own.abs().max(1.0);
            let is_own = own.len() == column.values.len();
            let is_own = is_own && column.values.iter().zip(own).all(is_near);
            assert!(is_own, "{} of {name} of {line}", column.name);
        }
        assert!(found.metrics.len() >= least, "{line}: {:?}", found.metrics.keys());
        let lacking = own.metrics.keys().filter(|name| !found.metrics.contains_key(*name));
        lacking.for_each(|name| assert!(found.absent.contains_key(name), "{line}: {name}"));
        assert!(
            found.absent[left_out].to_string().contains("particles"),
            "{line}: {:?}",
            found.absent
        );
        assert_eq!((found.state, found.cost.particles), (None, own.cost.particles), "{line}");
    }
}

/// The number of particles of a curve of the open division is unknown.
#[test]
fn a_curve_of_the_open_division_has_no_number_of_particles() {
    let line = "couette --variant seed --set rows=8 --set end=0.1";
    let (folder, closed) = of_curve(line, "profile.csv");
    edit(&folder.path().join("own"), "method.json", "\"closed\"", "\"open\"");
    let open = submitted(folder.path(), "couette own", "open");
    let particles = open["cost"]["particles"].as_u64().unwrap_or(0);
    assert_eq!((closed.cost.particles, particles), (40, 0), "{}", open["cost"]);
}

/// Each time of a path placed all particles of the problem, so that a bar of 33 layers had too many rows.
#[test]
fn a_path_of_a_fine_bar_is_measured_in_a_coarse_scene() {
    let folder = tempfile::tempdir().unwrap();
    let line = "export cantilever --variant lagrangian --set n=33 --out own";
    let made = touchstone(folder.path(), line);
    assert!(made.status.success(), "{}", said(&made));
    let own = folder.path().join("own");
    let row = |k: usize| {
        let t = 0.01 * k as f64;
        let [x, y] = [(0.01, 12.0), (0.065, 6.0)].map(|(size, rate)| size * (cos(rate * t) - 1.0));
        format!("{t},{x},{y}\n")
    };
    let rows: String = (0..=400).map(row).collect();
    fs::write(own.join("curve.csv"), format!("t[s],x[m],y[m]\n{rows}")).unwrap();
    for file in ["method.json", "system.json"] {
        fs::copy(whole().join("whole").join(file), own.join(file)).unwrap();
    }
    let submitted = touchstone(folder.path(), "submit cantilever own --store store");
    let file = fs::read_dir(folder.path().join("store")).ok().and_then(|mut all| all.next());
    let file = file.unwrap_or_else(|| panic!("{}", said(&submitted))).unwrap();
    let record = Record::from_json(&read(&file.path())).unwrap();
    assert_eq!((&record.run.settings["n"], record.cost.particles), (&33.into(), 33 * 578));
    let frequency = record.metrics["frequency"].value;
    assert!((frequency - 6.0 / std::f64::consts::TAU).abs() < 1e-3, "{frequency}");
    fs::write(own.join("curve.csv"), format!("t[s],x[m],y[m]\n{rows}4.0,0,0\n")).unwrap();
    let words = said(&touchstone(folder.path(), "submit cantilever own --store store"));
    assert!(words.contains("2 rows are at t = 4 s; expected 1"), "{words}");
}

/// A damaged curve is refused as particles are.
#[test]
fn a_damaged_curve_is_refused_with_file_line_and_column() {
    let line = "couette --variant seed --set rows=8 --set end=0.1";
    let (folder, _) = of_curve(line, "profile.csv");
    let own = folder.path().join("own");
    let whole = read(&own.join("curve.csv"));
    let lines: Vec<&str> = whole.lines().collect();
    let ended = |lines: &[&str]| lines.join("\n") + "\n";
    let without = |k: usize| ended(&[&lines[..k], &lines[k + 1..]].concat());
    let swapped = ended(&[&lines[..2], &[lines[3], lines[2]], &lines[4..]].concat());
    let instead = |k: usize, row: &str| whole.replacen(lines[k], row, 1);
    let time = lines[1].split(',').next().unwrap();
    let beyond = format!("{time},2,0,0");
    let more = ended(&[&lines[..9], &[&*beyond], &lines[9..]].concat());
    let later = ended(&[&lines[..1], &lines[9..17], &lines[1..9], &lines[17..]].concat());
    let place: Vec<&str> = lines[2].splitn(3, ',').collect();
    let twice = instead(3, &format!("{},{},0,0", place[0], place[1]));
    let last = lines.len() - 8;
    for (what, text, says) in [
        ("unit", whole.replacen("u[m/s]", "u[mm/s]", 1), "line 1, column u: its unit is mm/s"),
        ("column", whole.replacen("u[m/s]", "w[m/s]", 1), "line 1, column u: it is missing"),
        ("a row less", without(3), "line 2, column t: 7 rows are at t"),
        ("a row more", more, "line 2, column t: 9 rows are at t"),
        ("times not sorted", later, "line 10, column t: it is"),
        ("not sorted", swapped, "column y: it is"),
        ("a word", instead(4, &format!("{time},fast,0,0")), "line 5, column y: it is \"fast\""),
        ("not finite", instead(4, &format!("{time},0.1,NaN,0")), "line 5, column u: it is NaN"),
        ("a place twice", twice, "line 4, column y: it is"),
        ("no rows", ended(&lines[..1]), "it has no rows"),
        ("a time less", ended(&lines[..last]), "no particles at t ="),
        ("a digit less", whole[..whole.len() - 2].into(), "the last line does not end"),
        ("no end of the last line", whole.trim_end().into(), "the last line does not end"),
    ] {
        fs::write(own.join("curve.csv"), text).unwrap();
        let output = touchstone(folder.path(), "submit couette own --store other");
        assert_eq!(output.status.code(), Some(2), "{what}: {}", said(&output));
        let words = said(&output);
        assert!(words.contains("curve.csv") && words.contains(says), "{what}: {words}");
        assert!(!folder.path().join("other").exists(), "{what}: nothing is recorded");
    }
    fs::remove_file(own.join("curve.csv")).unwrap();
    fs::create_dir(own.join("curve.csv")).unwrap();
    let words = said(&touchstone(folder.path(), "submit couette own --store other"));
    assert!(words.contains("curve.csv: cannot be read"), "a folder: {words}");
    fs::remove_dir(own.join("curve.csv")).unwrap();
    fs::write(own.join("curve.csv"), &whole).unwrap();
    let output = touchstone(folder.path(), "submit dam_break own --variant seed --store other");
    assert_eq!(output.status.code(), Some(2), "of another case: {}", said(&output));
}

type Damage = fn(&Path);

fn edit(folder: &Path, file: &str, from: &str, to: &str) {
    let text = read(&folder.join(file));
    assert!(text.contains(from), "{file} has no {from}");
    fs::write(folder.join(file), text.replacen(from, to, 1)).unwrap();
}
/// Changes the value of a column in a line, counted from 1.
fn set(folder: &Path, line: usize, column: usize, value: &str) {
    let path = folder.join("results.csv");
    let mut lines: Vec<String> = read(&path).lines().map(String::from).collect();
    let mut cells: Vec<&str> = lines[line - 1].split(',').collect();
    cells[column] = value;
    lines[line - 1] = cells.join(",");
    fs::write(path, lines.join("\n") + "\n").unwrap();
}
fn drop_lines(folder: &Path, from: usize, to: usize) {
    let path = folder.join("results.csv");
    let text = read(&path);
    let kept = text.lines().enumerate().filter(|(k, _)| !(from..to).contains(&(k + 1)));
    fs::write(&path, kept.map(|(_, line)| format!("{line}\n")).collect::<String>()).unwrap();
}

/// Repeats the first frame at a later time, `by` after the first or the last one.
fn shifted(folder: &Path, file: &str, by: f64) {
    let text = read(&folder.join(file));
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    let last = if by < 0.01 { 41 } else { lines.len() };
    let again = |line: &String| {
        let (time, rest) = line.split_once(',').unwrap();
        format!("{},{rest}", time.parse::<f64>().unwrap() + by)
    };
    let later: Vec<String> = lines[1..41].iter().map(again).collect();
    lines.splice(last..last, later);
    fs::write(folder.join(file), lines.join("\n") + "\n").unwrap();
}
/// A dump in place of the table.
fn dump(folder: &Path, atoms: &str, rows: &str) {
    fs::remove_file(folder.join("results.csv")).unwrap();
    let heads = "ITEM: TIME\n0.1\nITEM: NUMBER OF ATOMS\n";
    let text = format!("{heads}{atoms}\nITEM: ATOMS id x y vx vy c_rho\n{rows}");
    fs::write(folder.join("a.dump"), text).unwrap();
}

/// Changes of a whole submission, and the names in the message.
const DAMAGES: [(&str, Damage, &[&str]); 52] = [
    (
        "no method",
        |f| fs::remove_file(f.join("method.json")).unwrap(),
        &["method.json", "expected code"],
    ),
    (
        "no machine",
        |f| fs::remove_file(f.join("system.json")).unwrap(),
        &["system.json", "expected machine"],
    ),
    ("no results", |f| fs::remove_file(f.join("results.csv")).unwrap(), &["expected results.csv"]),
    (
        "another division",
        |f| edit(f, "method.json", "\"closed\"", "\"half\""),
        &["method.json, line", "closed"],
    ),
    (
        "no version",
        |f| edit(f, "method.json", "\"version\"", "\"versio\""),
        &["method.json, line", "version"],
    ),
    (
        "an empty code",
        |f| edit(f, "method.json", "\"touchstone\"", "\"\""),
        &["method.json, column code"],
    ),
    (
        "negative threads",
        |f| edit(f, "system.json", "\"threads\": 1", "\"threads\": -1"),
        &["system.json, column threads", "a whole number from 1"],
    ),
    (
        "seconds in words",
        |f| edit(f, "system.json", "\"threads\": 1", "\"threads\": \"some\""),
        &["system.json, line", "unknown"],
    ),
    (
        "another unit",
        |f| edit(f, "results.csv", "x[m]", "x[mm]"),
        &["results.csv, line 1, column x", "mm; expected m"],
    ),
    (
        "a column is missing",
        |f| edit(f, "results.csv", "v[m/s]", "w[m/s]"),
        &["results.csv, line 1, column v", "missing"],
    ),
    (
        "a column twice",
        |f| edit(f, "results.csv", "y[m]", "x[m]"),
        &["results.csv, line 1, column x", "twice"],
    ),
    ("not a number", |f| set(f, 3, 4, "fast"), &["results.csv, line 3, column u", "\"fast\""]),
    ("not finite", |f| set(f, 5, 5, "NaN"), &["results.csv, line 5, column v", "finite"]),
    ("infinite", |f| set(f, 5, 2, "inf"), &["results.csv, line 5, column x", "finite"]),
    (
        "an id that is no whole number",
        |f| set(f, 4, 1, "1.5"),
        &["results.csv, line 4, column id", "whole"],
    ),
    ("a negative id", |f| set(f, 4, 1, "-3"), &["results.csv, line 4, column id"]),
    ("a particle twice", |f| set(f, 3, 1, "0"), &["results.csv", "column id", "twice"]),
    (
        "two kinds of flaws of one column at each of three times, all of which are told",
        |f| [3, 43, 83].into_iter().for_each(|line| set(f, line, 1, "0")),
        &[
            "particle 0 is there twice at t = 0.1 s",
            "1 of 40 moving particles are missing at t = 0.1 s",
        ],
    ),
    (
        "a particle of another problem",
        |f| set(f, 3, 1, "100000"),
        &["results.csv, line 3, column id", "not in the problem"],
    ),
    ("a negative density", |f| set(f, 6, 6, "-1"), &["results.csv, line 6, column density"]),
    ("a particle less", |f| drop_lines(f, 4, 5), &["results.csv, line 2, column id", "1 of"]),
    ("not sorted", |f| set(f, 3, 0, "0.001"), &["results.csv, line 3, column t", "sorted"]),
    ("no times", |f| drop_lines(f, 10, 1_000_000), &["results.csv, column t", "no particles at t"]),
    (
        "a line is cut",
        |f| {
            let t = read(&f.join("results.csv"));
            fs::write(f.join("results.csv"), &t[..t.len() - 40]).unwrap()
        },
        &["results.csv, line"],
    ),
    ("no density", |f| set(f, 6, 6, "0"), &["results.csv, line 6, column density", "above 0"]),
    (
        "a machine of control characters",
        |f| edit(f, "system.json", "\"machine\": \"", "\"machine\": \"\\u001b[2J"),
        &["system.json, column machine", "U+001B, which nobody sees"],
    ),
    (
        "a time twice but for round-off",
        |f| shifted(f, "results.csv", 1e-9),
        &["results.csv, line 42, column t", "round-off"],
    ),
    (
        "a time before the start",
        |f| set(f, 2, 0, "-1"),
        &["results.csv, line 2, column t", "start"],
    ),
    (
        "a role that does not exist",
        |f| {
            let text = read(&f.join("results.csv")).replace('\n', ",7\n");
            fs::write(f.join("results.csv"), text.replacen(",7", ",role", 1)).unwrap()
        },
        &["results.csv, line 2, column role", "it is 7; expected 0, 1 or 2"],
    ),
    ("a time after the end", |f| shifted(f, "results.csv", 1.0), &["column t", "after the end"]),
    (
        "a crowd",
        |f| {
            edit(f, "method.json", "\"closed\"", "\"open\"");
            let rows: String =
                (0..1100).map(|k| format!("0,{k},1e-5,1e-5,0,0,1000,1e-6\n")).collect();
            let heads = "t[s],id,x[m],y[m],u[m/s],v[m/s],density[kg/m^3],mass[kg/m]\n";
            fs::write(f.join("results.csv"), heads.to_string() + &rows).unwrap()
        },
        &["results.csv, line 2, column id", "1100 particles are in a square"],
    ),
    (
        "a crowd, each in another period",
        |f| {
            let problem: serde_json::Value =
                serde_json::from_str(&read(&f.join("problem.json"))).unwrap();
            let period = problem["domain"]["period"][0]["value"].as_f64().unwrap();
            edit(f, "method.json", "\"closed\"", "\"open\"");
            let row =
                |k: u32| format!("0,{k},{},1e-5,0,0,1000,1e-6\n", period * f64::from(k) + 1e-5);
            let heads = "t[s],id,x[m],y[m],u[m/s],v[m/s],density[kg/m^3],mass[kg/m]\n";
            fs::write(
                f.join("results.csv"),
                heads.to_string() + &(0..1100).map(row).collect::<String>(),
            )
            .unwrap()
        },
        &["results.csv, line 2, column id", "1100 particles are in a square"],
    ),
    (
        "a constant that is wrong on purpose",
        |f| {
            let with = "\"spec\": {\n    \"allow_unstable\": true,";
            edit(f, "problem.json", "\"spec\": {", with)
        },
        &["problem.json has more"],
    ),
    (
        "a dump of atoms that are not there",
        |f| dump(f, "1000000000000", "1 0 0 0 0 1000\n"),
        &["a.dump, line 4", "1000000000000 atoms"],
    ),
    (
        "a dump with a row that has more values",
        |f| dump(f, "1", "1 7 7 0 0 0 0 1000\n"),
        &["a.dump, line 6", "8 values; expected 6"],
    ),
    ("a dump that was cut", |f| dump(f, "1", "1 0 0 0 0 10"), &["a.dump, line 6", "cut short"]),
    ("a dump without atoms", |f| dump(f, "0", ""), &["a.dump", "no rows"]),
    (
        "a grid in two pieces, of which the second would be taken for all",
        |f| {
            fs::remove_file(f.join("results.csv")).unwrap();
            let head = "<DataArray NumberOfComponents=\"3\" format=\"ascii\">";
            let piece = format!("<Piece><Points>{head}0 0 0</DataArray></Points></Piece>");
            fs::write(f.join("a.vtu"), format!("<VTKFile>{piece}{piece}</VTKFile>")).unwrap()
        },
        &["a.vtu, line 1, column x", "there twice; expected once"],
    ),
    (
        "another case",
        |f| edit(f, "problem.json", "\"case\": \"couette\"", "\"case\": \"poiseuille\""),
        &["problem.json is of the case poiseuille"],
    ),
    (
        "half a thread",
        |f| edit(f, "system.json", "\"threads\": 1", "\"threads\": 0.5"),
        &["system.json, column threads: it is 0.5; expected a whole number from 1 to"],
    ),
    (
        "a fraction of a step",
        |f| {
            let text = read(&f.join("system.json"));
            let steps = text.lines().find(|line| line.contains("steps")).unwrap();
            edit(f, "system.json", steps, "\"steps\": 1.999,")
        },
        &["system.json, column steps: it is 1.999; expected a whole number"],
    ),
    (
        "the id after the last one",
        |f| set(f, 7, 1, "40"),
        &[
            "results.csv, line 7, column id: particle 40 is not in the problem, whose ids are 0 to 39",
        ],
    ),
    (
        "ids from 1",
        |f| {
            let text = read(&f.join("results.csv"));
            let later = |line: &str| {
                let cells: Vec<&str> = line.splitn(3, ',').collect();
                let id = cells[1].parse::<f64>().map_or("id".into(), |id| (id + 1.0).to_string());
                format!("{},{id},{}\n", cells[0], cells[2])
            };
            fs::write(f.join("results.csv"), text.lines().map(later).collect::<String>()).unwrap()
        },
        &["1 of 40 moving particles are missing", "the first with the id 0; each id is one higher"],
    ),
    (
        "another mass than that of the problem",
        |f| add(f, "mass[kg/m]", "1.6e-8"),
        &[
            "results.csv, column mass: particle 0 has 1.6e-8 kg/m, in the problem",
            "and 17 more like",
        ],
    ),
    (
        "particles behind a wall",
        |f| add(f, "role", "1"),
        &["results.csv, column role: particle 0 has the role 1, in the problem 0"],
    ),
    (
        "a mass that no list of neighbours can be made of",
        |f| {
            edit(f, "method.json", "\"closed\"", "\"open\"");
            add(f, "mass", "1e-323")
        },
        &["results.csv, line 2, column mass: particle 0 has", "expected 1e-6 to 1000000 times"],
    ),
    (
        "a mass of ten million particles of this spacing",
        |f| {
            edit(f, "method.json", "\"closed\"", "\"open\"");
            add(f, "mass", &(1e7 * 1000.0 * 1.25e-4 * 1.25e-4).to_string())
        },
        &["results.csv, line 2, column mass: particle 0 has", "expected 1e-6 to 1000000 times"],
    ),
    (
        "a document of another version",
        |f| edit(f, "problem.json", "\"schema\": 1", "\"schema\": 2"),
        &["problem.json: schema is 2; this program reads schema 1"],
    ),
    (
        "own particles without masses",
        |f| edit(f, "method.json", "\"closed\"", "\"open\""),
        &["results.csv, line 2, column mass: it is missing; in the open division each particle"],
    ),
    (
        "own particles that begin late",
        |f| {
            edit(f, "method.json", "\"closed\"", "\"open\"");
            add(f, "mass", "1.5625e-5")
        },
        &["results.csv, line 2, column t: the first frame is not at t = 0"],
    ),
    (
        "own particles with a gap in their numbers",
        |f| {
            edit(f, "method.json", "\"closed\"", "\"open\"");
            add(f, "mass", "1.5625e-5");
            set(f, 7, 1, "45")
        },
        &[
            "line 2, column id: ids of the first frame are not 0, 1, 2 and so on, each once: 6 is in",
        ],
    ),
    (
        "a document that repeats itself",
        |f| {
            fs::write(f.join("method.json"), format!("{{\"{}\": 1}}", "x".repeat(1 << 20))).unwrap()
        },
        &["method.json, line 1: unknown field `xxx", "... (1048", "expected code, version"],
    ),
];

/// Adds a column with one value.
fn add(folder: &Path, head: &str, value: &str) {
    let text = read(&folder.join("results.csv")).replace('\n', &format!(",{value}\n"));
    let text = text.replacen(value, head, 1);
    fs::write(folder.join("results.csv"), text).unwrap();
}

#[test]
fn a_damaged_submission_is_refused_with_file_line_and_column() {
    for (what, damage, expected) in DAMAGES {
        let (folder, copy) = copy();
        damage(&copy);
        for line in ["submit couette copy --store store", "submit couette copy --check"] {
            let output = touchstone(folder.path(), line);
            let words = said(&output);
            assert_eq!(output.status.code(), Some(2), "{what}: {words}");
            for part in expected {
                assert!(words.contains(part), "{what}: expected {part:?} in {words}");
            }
            assert!(!words.contains("bug of touchstone"), "{what}: {words}");
            assert!(words.len() < 4000, "{what}: {} characters", words.len());
        }
        let kept = fs::read_dir(folder.path().join("store")).map_or(0, Iterator::count);
        assert_eq!(kept, 0, "{what}: something was recorded");
    }
}

#[test]
fn everything_that_is_missing_is_told_at_once() {
    let (folder, copy) = copy();
    fs::remove_file(copy.join("method.json")).unwrap();
    let text =
        read(&copy.join("results.csv")).replacen("x[m]", "pos_x", 1).replacen("u[m/s]", "vel", 1);
    fs::write(copy.join("results.csv"), text).unwrap();
    let words = said(&touchstone(folder.path(), "submit couette copy --check"));
    for part in ["method.json", "column x", "column u"] {
        assert!(words.contains(part), "expected {part} in {words}");
    }
    fs::copy(whole().join("whole/method.json"), copy.join("method.json")).unwrap();
    let mapped = touchstone(folder.path(), "submit couette copy --check --map x=pos_x,u=vel");
    assert_eq!(mapped.status.code(), Some(0), "{}", said(&mapped));
    for (map, says) in [
        ("x=pos_x,u=vel,density=rhoo", "column density: --map names rhoo, which is not there"),
        ("x=pos_x,u=pos_x", "named twice"),
        ("x=pos_x,x=vel", "named twice"),
        ("x=", "expected OURS=THEIRS"),
    ] {
        let refused =
            touchstone(folder.path(), &format!("submit couette copy --check --map {map}"));
        assert_eq!(refused.status.code(), Some(2), "{map}");
        assert!(said(&refused).contains(says), "{map}: {}", said(&refused));
    }
}

/// The record of the only submission in a store, as its document.
fn submitted(folder: &Path, line: &str, store: &str) -> serde_json::Value {
    let output = touchstone(folder, &format!("submit {line} --store {store}"));
    let mut files =
        fs::read_dir(folder.join(store)).unwrap_or_else(|_| panic!("{}", said(&output)));
    let file = files.next().unwrap_or_else(|| panic!("{}", said(&output))).unwrap();
    serde_json::from_str(&read(&file.path())).unwrap()
}

/// Columns that are read and not read are reported; unknown costs are not in the record.
#[test]
fn unknown_costs_have_no_keys_and_columns_that_are_not_read_are_told() {
    let (folder, copy) = copy();
    let unknown =
        ["threads", "seconds", "steps", "interactions"].map(|of| format!("\"{of}\": \"unknown\""));
    let text = format!("{{\"machine\": \"unknown\", {}}}", unknown.join(", "));
    fs::write(copy.join("system.json"), text).unwrap();
    add(&copy, "temperature", "7");
    let words = said(&touchstone(folder.path(), "submit couette copy --check"));
    assert!(words.contains("columns that are not read: temperature"), "{words}");
    for given in ["--variant seed", "--set rows=8"] {
        let output = touchstone(folder.path(), &format!("submit couette copy --check {given}"));
        let words = said(&output);
        assert!(output.status.code() == Some(2) && words.contains("leave out --variant and --set"));
    }
    let record = submitted(folder.path(), "couette copy", "store");
    assert_eq!(record["cost"], serde_json::json!({"particles": 40}));
    // Each of the threads takes the seconds of the time loop.
    let known = r#""threads": 4, "seconds": 1.5, "steps": "unknown", "interactions": "unknown""#;
    fs::write(copy.join("system.json"), format!("{{\"machine\": \"m\", {known}}}")).unwrap();
    let cost = submitted(folder.path(), "couette copy", "known")["cost"].clone();
    let of = |name: &str| cost[name].as_f64();
    assert_eq!(["wall_s", "cpu_s", "threads"].map(of), [1.5, 6.0, 4.0].map(Some), "{cost}");
}

/// A problem with a document that contradicts its settings is refused.
#[test]
fn a_problem_that_contradicts_its_own_settings_is_refused_by_field() {
    let (folder, copy) = copy();
    let export =
        touchstone(folder.path(), "export couette --variant plain --set rows=20 --out gated");
    assert!(export.status.success(), "{}", said(&export));
    let document = read(&folder.path().join("gated/problem.json"));
    let changed = |pointer: &str, value: serde_json::Value| {
        let mut document: serde_json::Value = serde_json::from_str(&document).unwrap();
        *document.pointer_mut(pointer).unwrap_or_else(|| panic!("no {pointer}")) = value;
        fs::write(copy.join("problem.json"), document.to_string()).unwrap();
        said(&touchstone(folder.path(), "submit couette copy --check"))
    };
    for (pointer, value, field) in [
        (
            "/material/kinematic_viscosity/value",
            1.000001e-6.into(),
            "material.kinematic_viscosity.value",
        ),
        ("/particles/spacing/value", 1e-4.into(), "particles.spacing.value"),
        ("/particles/spacing/unit", "mm".into(), "particles.spacing.unit"),
        ("/particles/count", 7.into(), "particles.count"),
        ("/times/value/0", 0.5.into(), "times.value[0]"),
        ("/times/value", serde_json::json!([0.1]), "times.value"),
        ("/walls/planes/0/point/value/1", 0.1.into(), "walls.planes[0].point.value[1]"),
        ("/walls/planes", serde_json::json!([]), "walls.planes"),
        ("/domain/period/0", "none".into(), "domain.period[0]"),
        ("/acceleration/value/0", 9.81.into(), "acceleration.value[0]"),
        ("/our_method/support_radius/value", 1.0.into(), "our_method.support_radius.value"),
    ] {
        let words = changed(pointer, value);
        let says = format!("problem.json, column {field}: it is ");
        assert!(words.contains(&says), "{pointer}: expected {says} in {words}");
    }
    let gates: serde_json::Value = serde_json::from_str(&document).unwrap();
    let gates = gates["judged_by"].as_array().unwrap();
    assert!(gates.len() > 1, "{gates:?}");
    for (k, gate) in gates.iter().enumerate() {
        let (kind, was) = gate["bound"].as_object().unwrap().iter().next().unwrap();
        let wider = if was.is_array() { serde_json::json!([0, 7]) } else { 7.into() };
        let words = changed(&format!("/judged_by/{k}/bound/{kind}"), wider);
        let says = format!("problem.json, column judged_by {}", gate["id"].as_str().unwrap());
        assert!(words.contains(&says), "expected {says} in {words}");
    }
    // The words of another version are no other problem; and these results are of other times.
    let words = changed("/about", "in other words".into());
    assert!(!words.contains("problem.json"), "{words}");
}

/// Rows of the first frame of a code that chose its particles itself are in any order.
#[test]
fn the_order_of_own_particles_does_not_count() {
    let folder = tempfile::tempdir().unwrap();
    let line =
        "export couette --variant extrapolating-wall --set rows=8 --set end=0.1 --out own --solve";
    let made = touchstone(folder.path(), line);
    assert!(made.status.success(), "{}", said(&made));
    let own = folder.path().join("own");
    edit(&own, "method.json", "\"closed\"", "\"open\"");
    let rows = |file: &str| -> Vec<BTreeMap<String, String>> {
        let text = read(&own.join(file));
        let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let heads: Vec<&str> =
            lines.next().unwrap().into_iter().map(|head| head.split('[').next().unwrap()).collect();
        let row = |cells: Vec<&str>| {
            heads.iter().map(|h| h.to_string()).zip(cells.into_iter().map(String::from)).collect()
        };
        lines.map(row).collect()
    };
    let (start, moved) = (rows("particles.csv"), rows("results.csv"));
    let columns = ["id", "x", "y", "u", "v", "density"];
    let text = |time: &str, of: &BTreeMap<String, String>, fixed: &BTreeMap<String, String>| {
        let cells: Vec<&str> = columns.iter().map(|name| &*of[*name]).collect();
        format!("{time},{},{},{}\n", cells.join(","), fixed["mass"], fixed["role"])
    };
    let mut first: Vec<String> = start.iter().map(|row| text("0", row, row)).collect();
    let mut times: Vec<&str> =
        moved.iter().map(|row| &*row["t"]).filter(|time| *time != "0").collect();
    times.dedup();
    let mut later = String::new();
    for time in times {
        let now = moved.iter().filter(|row| row["t"] == *time);
        let of_id: BTreeMap<&str, _> = now.map(|row| (&*row["id"], row)).collect();
        for row in &start {
            later += &text(time, of_id.get(&*row["id"]).copied().unwrap_or(row), row);
        }
    }
    let mut metrics = Vec::new();
    for store in ["ordered", "shuffled"] {
        let head = "t,id,x,y,u,v,density,mass,role\n";
        fs::write(own.join("results.csv"), format!("{head}{}{later}", first.concat())).unwrap();
        metrics.push(submitted(folder.path(), "couette own", store)["metrics"].clone());
        let (a, b) = first.split_at(first.len() / 3);
        first = b.iter().rev().chain(a).cloned().collect();
    }
    assert!(metrics[0].as_object().unwrap().len() > 5, "{}", metrics[0]);
    assert_eq!(metrics[0], metrics[1]);
    // Curves that follow our own particles are not of others, and masses are a part of the results.
    let first = submitted(folder.path(), "couette own", "first");
    assert!(
        first["profiles"].as_object().is_none_or(|all| all.is_empty()),
        "{}",
        first["profiles"]
    );
    let mass: f64 = start[0]["mass"].parse().unwrap();
    let all = read(&own.join("results.csv"));
    let heavier = all.replace(&format!(",{},", start[0]["mass"]), &format!(",{},", 1.01 * mass));
    assert_ne!(all, heavier);
    fs::write(own.join("results.csv"), heavier).unwrap();
    let other = submitted(folder.path(), "couette own", "heavier");
    assert_ne!(first["submission"]["results"], other["submission"]["results"]);
}

/// Writes positions, velocities and densities with `digits` digits; with 0 as floats of 4 bytes.
fn round(folder: &Path, digits: usize) {
    let text = read(&folder.join("results.csv"));
    let round = |(k, cell): (usize, &str)| match cell.parse::<f64>() {
        Ok(value) if k > 1 && digits > 0 => format!("{value:.*e}", digits - 1),
        Ok(value) if k > 1 => f64::from(value as f32).to_string(),
        _ => cell.into(),
    };
    let line = |line: &str| line.split(',').enumerate().map(round).collect::<Vec<_>>().join(",");
    let lines: String = text.lines().map(|of| line(of) + "\n").collect();
    fs::write(folder.join("results.csv"), lines).unwrap();
}

/// Few digits of a file are no flaw of the method: metrics that they do not determine are not applicable,
/// with the name of the column.
#[test]
fn rounding_of_a_file_is_no_flaw_of_a_method() {
    for (line, gate, digits, other) in [
        (
            "operators --variant quintic-laplacian --set n=24 --set disorder=0 --set h_over_dx=1.5",
            "operators.quintic-laplacian.24.symbol_error",
            &[6, 7, 9, 11, 0][..],
            None,
        ),
        (
            "operators --variant quintic-gradient --set n=24 --set disorder=0 --set h_over_dx=1.5",
            "operators.quintic-gradient.24.symbol_error",
            &[7],
            None,
        ),
        (
            "elastic_bar --variant lagrangian",
            "elastic_bar.lagrangian.pulse40.momentum_error",
            &[7, 0],
            Some("elastic_bar.lagrangian.pulse40.energy_change"),
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let made = touchstone(folder.path(), &format!("export {line} --solve --out own"));
        assert!(made.status.success(), "{line}: {}", said(&made));
        let own = folder.path().join("own");
        let whole = read(&own.join("results.csv"));
        let case = line.split(' ').next().unwrap();
        let told = |digits: usize| {
            fs::write(own.join("results.csv"), &whole).unwrap();
            round(&own, digits);
            let out =
                touchstone(folder.path(), &format!("submit {case} own --all --store s{digits}"));
            format!("{}{}", String::from_utf8_lossy(&out.stdout), said(&out))
        };
        for digits in digits {
            let words = told(*digits);
            let line = words.lines().find(|line| line.starts_with(gate));
            assert!(
                line.is_some_and(|line| line.contains("not given: all digits of ")),
                "{gate} with {digits} digits: {words}"
            );
            assert!(!words.contains("FAIL"), "{words}");
            other
                .iter()
                .for_each(|gate| assert!(words.contains(&format!("pass     {gate}")), "{words}"));
        }
        let words = told(12);
        assert!(!words.contains("not given: all digits"), "12 digits are all but a few: {words}");
        let words = told(17);
        assert!(words.contains(&format!("pass     {gate}")), "{words}");
    }
}

/// A bound of 0 is none of round-off: that no particle is outside is judged however few digits there are.
#[test]
fn counts_are_judged_with_few_digits() {
    let folder = tempfile::tempdir().unwrap();
    let line = "export couette --variant plain --set rows=20 --solve --out own";
    let made = touchstone(folder.path(), line);
    assert!(made.status.success(), "{}", said(&made));
    round(&folder.path().join("own"), 9);
    let output = touchstone(folder.path(), "submit couette own --all --store store");
    let words = String::from_utf8_lossy(&output.stdout);
    assert!(words.contains("pass     couette.plain.20.outside"), "{words}{}", said(&output));
}

/// A series is held from its last row to the end.
#[test]
fn a_series_is_held_at_its_last_row() {
    let folder = tempfile::tempdir().unwrap();
    let made = touchstone(folder.path(), "export dam_break --variant modern --set n=8 --out own");
    assert!(made.status.success(), "{}", said(&made));
    let own = folder.path().join("own");
    for file in ["method.json", "system.json"] {
        fs::copy(whole().join("whole").join(file), own.join(file)).unwrap();
    }
    let problem: serde_json::Value =
        serde_json::from_str(&read(&own.join("problem.json"))).unwrap();
    let times: Vec<f64> = serde_json::from_value(problem["times"]["value"].clone()).unwrap();
    let end = *times.last().unwrap();
    let mut rows: Vec<(f64, f64)> = times.iter().map(|t| (*t, 0.06 + 0.1 * t / end)).collect();
    rows.pop();
    rows.push((end * (1.0 - 1e-3), 0.2));
    let of = |rows: &[(f64, f64)], store: &str| {
        let rows: String = rows.iter().map(|(t, front)| format!("{t},{front}\n")).collect();
        fs::write(own.join("curve.csv"), format!("t[s],front[m]\n{rows}")).unwrap();
        submitted(folder.path(), "dam_break own", store)["metrics"].clone()
    };
    let held = of(&rows, "held");
    rows.push((end, 0.2));
    let stated = of(&rows, "stated");
    assert!(held.as_object().unwrap().keys().any(|name| name.starts_with("z@")), "{held}");
    assert_eq!(held, stated);
    rows.last_mut().unwrap().1 = 0.16;
    assert_ne!(of(&rows, "other"), stated, "what comes last counts");
    // Its next row would be long before the end.
    rows.truncate(times.len() - 1);
    let (last, front) = *rows.last().unwrap();
    rows.push((last + 1e-3 * (end - last), front));
    let rows: String = rows.iter().map(|(t, front)| format!("{t},{front}\n")).collect();
    fs::write(own.join("curve.csv"), format!("t[s],front[m]\n{rows}")).unwrap();
    let words = said(&touchstone(folder.path(), "submit dam_break own --check"));
    assert!(words.contains(&format!("no particles at t = {end} s")), "{words}");
}

/// A method that was changed after the seed was known is refused, and so are settings that were not drawn.
#[test]
fn a_sealed_problem_holds_its_method_and_its_settings() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::copy(whole().join("whole/method.json"), at.join("method.json")).unwrap();
    let line = |seed: u32, out: &str| {
        format!(
            "export taylor_green --variant consistent --sealed {seed} --method method.json --out {out}"
        )
    };
    let drawn = |seed: u32, out: &str| {
        let output = touchstone(at, &line(seed, out));
        assert!(output.status.success(), "{}", said(&output));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let (once, twice, other) = (drawn(7, "a"), drawn(7, "b"), drawn(8, "c"));
    assert_eq!(once, twice, "the same seed draws the same settings");
    assert_ne!(once, other, "another seed draws others");
    // Particles at rest suffice: the check comes before they are measured.
    let problem = read(&at.join("a/problem.json"));
    let spec: serde_json::Value = serde_json::from_str(&problem).unwrap();
    let spec: RunSpec = serde_json::from_value(spec["spec"].clone()).unwrap();
    assert!(spec.settings["seed"] != 1, "the start was drawn: {}", spec.settings);
    for (file, from, to, expected) in [
        ("method.json", "\"version\": \"", "\"version\": \"1", "changed afterwards"),
        ("problem.json", "\"seed\": 7", "\"seed\": 9", "settings differ"),
    ] {
        let copy = at.join("copy");
        let _ = fs::remove_dir_all(&copy);
        fs::create_dir(&copy).unwrap();
        for name in ["problem.json", "method.json"] {
            fs::copy(at.join("a").join(name), copy.join(name)).unwrap();
        }
        fs::copy(whole().join("whole/system.json"), copy.join("system.json")).unwrap();
        fs::copy(whole().join("whole/results.csv"), copy.join("results.csv")).unwrap();
        let text = read(&copy.join(file));
        // The last one: the settings of vortices have a seed, too.
        let place = text.rfind(from).unwrap_or_else(|| panic!("{file} has no {from}: {text}"));
        fs::write(
            copy.join(file),
            format!("{}{to}{}", &text[..place], &text[place + from.len()..]),
        )
        .unwrap();
        let words = said(&touchstone(at, "submit taylor_green copy --check"));
        assert!(words.contains(expected), "{file}: expected {expected:?} in {words}");
    }
}

/// The records of other codes in `references/peers` are readable, hold no particles, and were measured with
/// the present tables of the dam break.
#[test]
fn the_records_of_other_codes_are_sound() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../references/peers/records");
    let files = fs::read_dir(&folder).unwrap().count();
    assert_eq!(
        touchstone_cases::peers::records().count(),
        files,
        "the program contains all that is there"
    );
    let mut codes = std::collections::BTreeSet::new();
    // The front at T = 2 by volume of fluid, from H = 2a to a.
    let row = [("scene", "martin_moyce"), ("quantity", "front_at_1")];
    let front = 2.0 * Reference::summarised("dam_break_vof", &row).value;
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let record = Record::from_json(&read(&entry.path()));
        let record = record.unwrap_or_else(|error| panic!("{:?}: {error}", entry.path()));
        if let [Some(z), Some(away)] = ["z@2", "front_away@2"].map(|name| record.metric(name)) {
            assert!((z - away - front).abs() < 1e-3, "{:?}: of other tables", entry.path());
        }
        codes.insert(record.run.submission.expect("the code that made it").code);
        assert!(!record.profiles.contains_key("particles"), "{:?}", entry.path());
    }
    let expected = [
        "DualSPHysics",
        "JAX-SPH",
        "LAMMPS",
        "PySPH",
        "SPHinXsys",
        "TrixiParticles.jl",
        "pySPlisHSPlasH",
        "salva2d",
        OURS,
    ];
    assert_eq!(codes.into_iter().collect::<Vec<_>>(), expected);
}

/// Stress is not among the results: metrics without it are measured, and nothing counts as diverged.
#[test]
fn a_solid_is_measured_without_its_stress_and_without_what_needs_every_step() {
    for (line, expected) in [
        ("rubber_rings --variant leapfrog --set spacing=0.5", "width_min"),
        ("elastic_bar --variant seed --set n=10", "momentum_error"),
        ("acoustic_wave", ""),
        ("cantilever --variant lagrangian --set n=4 --set end=0.05", ""),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let made = touchstone(folder.path(), &format!("export {line} --out own --solve"));
        assert!(made.status.success(), "{line}: {}", said(&made));
        let case = line.split(' ').next().unwrap();
        let words = said(&touchstone(folder.path(), &format!("submit {case} own --store store")));
        let file = fs::read_dir(folder.path().join("store")).unwrap().flatten().next();
        let record = Record::from_json(&read(&file.expect(&words).path())).unwrap();
        assert_eq!(record.status, touchstone_base::record::Status::Completed, "{line}");
        assert!(expected.is_empty() || record.metrics.contains_key(expected), "{line}: {expected}");
        let stepwise =
            ["frequency", "trajectory_error", "travel_error", "contact_begin_error@phase1"];
        for name in stepwise {
            assert!(!record.metrics.contains_key(name), "{line}: {name} is judged");
        }
    }
}

/// A copy of a record under another name would count twice; it is reported by its name.
#[test]
fn a_copied_record_does_not_count() {
    let (folder, _copy) = copy();
    let words = said(&touchstone(folder.path(), "submit couette copy --store store"));
    let store = folder.path().join("store");
    let file = fs::read_dir(&store).unwrap().flatten().next().expect(&words).path();
    fs::copy(file, store.join("submitted-couette-seed-0123456789abcdef.json")).unwrap();
    let words = said(&touchstone(folder.path(), "verify --no-runs couette --store store"));
    let told = words.lines().find(|line| line.contains("0123456789abcdef"));
    assert!(told.is_some_and(|line| line.contains("is ignored")), "{words}");
}

/// Byte order marks, and line ends of other systems, are no flaw.
#[test]
fn byte_order_marks_and_line_ends_of_windows_are_read() {
    let (folder, copy) = copy();
    for name in ["method.json", "system.json", "problem.json", "results.csv"] {
        let text = read(&copy.join(name)).replace('\n', "\r\n");
        fs::write(copy.join(name), format!("\u{feff}{text}")).unwrap();
    }
    let output = touchstone(folder.path(), "submit couette copy --check");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
}

/// The law of the paper was stated of variants with a stored energy, and with a factor of two dimensions.
#[test]
fn a_problem_states_the_law_of_its_own_method() {
    let folder = tempfile::tempdir().unwrap();
    for (case, variant, law) in [
        ("rubber_rings", "seed", "2 μ (ε̇ - tr(ε̇) I/3) + S·Ωᵀ + Ω·S"),
        ("rubber_rings", "lagrangian", "w = K (J - 1 - ln J) + μ |dev ln V|²"),
        ("cantilever", "lagrangian-saint-venant", "w = λ (tr E)²/2 + μ E:E"),
        ("couette", "seed", "dv/dt = -(1/ρ) ∇p + ν ∇²v + g"),
    ] {
        let line = format!("export {case} --variant {variant} --out {variant}-{case}");
        let made = touchstone(folder.path(), &line);
        assert!(made.status.success(), "{line}: {}", said(&made));
        for file in ["problem.json", "README.md"] {
            let text = read(&folder.path().join(format!("{variant}-{case}/{file}")));
            assert!(text.contains(law), "{file} of {case}, {variant}, lacks {law}");
            let is_of_rate = law.contains('Ω');
            assert_eq!(text.contains("Jaumann rate"), is_of_rate, "{file} of {case}, {variant}");
        }
    }
}

/// Each quantity of the last row, whichever of the observers has more of it.
fn each_quantity_is_compared(folder: &tempfile::TempDir, last: usize, row: &[&str]) {
    let other = folder.path().join("other");
    for (column, quantity) in [(3, "place"), (4, "velocity"), (5, "velocity"), (6, "density")] {
        for by in [1e-9, -1e-9] {
            let changed = row[column].parse::<f64>().unwrap() * (1.0 + by);
            set(&other, last, column, &changed.to_string());
            let related = touchstone(folder.path(), "symmetry elliptic_drop --results same other");
            let told = String::from_utf8_lossy(&related.stdout);
            let is_found = related.status.code() == Some(1) && told.contains(quantity);
            assert!(is_found, "{quantity} {by}: {told}");
        }
        set(&other, last, column, row[column]);
    }
}

/// A distant observer has larger numbers with larger round-off.
#[test]
fn round_off_is_that_of_the_larger_numbers() {
    let folder = tempfile::tempdir().unwrap();
    for by in ["same", "shifted"] {
        let line = format!("export elliptic_drop --set n=8 --solve --relation {by} --out {by}");
        let made = touchstone(folder.path(), &line);
        assert!(made.status.success(), "{}", said(&made));
    }
    let other = folder.path().join("shifted");
    let results = read(&other.join("results.csv"));
    let x: f64 = results.lines().last().unwrap().split(',').nth(2).unwrap().parse().unwrap();
    let codes = [3e-13, 1e-11].map(|by| {
        set(&other, results.lines().count(), 2, &(x + by).to_string());
        touchstone(folder.path(), "symmetry elliptic_drop --results same shifted").status.code()
    });
    assert_eq!(codes, [Some(0), Some(1)]);
}

/// Two observers of one problem, as files: our own solver gives equal results for both; if one number differs
/// by a billionth, the particle is named; files that are no pair of observers are refused.
#[test]
fn observers_are_compared_and_only_if_they_are_of_one_problem() {
    let folder = tempfile::tempdir().unwrap();
    let of = |line: &str| touchstone(folder.path(), line);
    for (by, out) in [("same", "same"), ("turned", "other")] {
        let small = "export elliptic_drop --set n=8 --solve";
        let made = of(&format!("{small} --relation {by} --out {out}"));
        assert!(made.status.success(), "{}", said(&made));
    }
    let related = of("symmetry elliptic_drop --results same other");
    let told = String::from_utf8_lossy(&related.stdout);
    assert!(related.status.success() && told.contains("round-off  "), "{told}");
    let other = folder.path().join("other");
    let results = read(&other.join("results.csv"));
    let last = results.lines().count();
    let row: Vec<&str> = results.lines().last().unwrap().split(',').collect();
    let x = row[2].parse::<f64>().unwrap();
    // The bound of round-off grows with the square of the stated steps.
    set(&other, last, 2, &(x + 1e-12).to_string());
    let system = folder.path().join("same/system.json");
    let stated = read(&system);
    let of_steps = |steps: u32| {
        let mut changed: serde_json::Value = serde_json::from_str(&stated).unwrap();
        changed["steps"] = steps.into();
        fs::write(&system, changed.to_string()).unwrap();
        of("symmetry elliptic_drop --results same other").status.code()
    };
    assert_eq!([1000, 1].map(of_steps), [Some(0), Some(1)]);
    // Fewer steps were made until the first time than until the last: there it is an error.
    let first: Vec<&str> = results.lines().nth(1).unwrap().split(',').collect();
    let shift = |by: f64| (first[2].parse::<f64>().unwrap() + by).to_string();
    set(&other, last, 2, &(x + 7e-11).to_string());
    assert_eq!(of_steps(1000), Some(0), "at the end");
    set(&other, last, 2, row[2]);
    set(&other, 2, 2, &shift(7e-11));
    assert_eq!(of_steps(1000), Some(1), "at t = {} s of {} s", first[0], row[0]);
    set(&other, 2, 2, first[2]);
    fs::write(&system, &stated).unwrap();
    each_quantity_is_compared(&folder, last, &row);
    set(&other, last, 2, &(x + 1e-9).to_string());
    let related = of("symmetry elliptic_drop --results same other");
    let told = String::from_utf8_lossy(&related.stdout);
    assert!(related.status.code() == Some(1) && told.contains("not the same"), "{told}");
    assert!(
        told.contains(&format!("place of particle {} at", row[1].trim_end_matches(".0"))),
        "{told}"
    );
    let refused = |line: &str, words: &str| {
        let output = of(line);
        assert!(output.status.code() == Some(2) && said(&output).contains(words), "{output:?}");
    };
    let exact = read(&other.join("results.csv"));
    round(&other, 8);
    refused("symmetry elliptic_drop --results same other", "all digits of x, which");
    fs::write(other.join("results.csv"), exact).unwrap();
    refused("symmetry elliptic_drop --results other same", "the first of relation same");
    refused("symmetry elliptic_drop --results same missing", "cannot be read");
    let finer = of("export elliptic_drop --set n=10 --solve --relation turned --out finer");
    assert!(finer.status.success(), "{}", said(&finer));
    let line = "symmetry elliptic_drop --results same finer";
    refused(line, "two problems of the same variant and settings");
    refused("submit elliptic_drop other --check", "`touchstone symmetry --results`");
    refused("export couette --relation turned --out x", "cannot be turned out of its axes");
    refused("export couette --relation upside-down --out x", "is none of same, turned");
    drop_lines(&other, last, last + 1);
    refused("symmetry elliptic_drop --results same other", "1 of");
    edit(&other, "problem.json", "\"turned\"", "\"tilted\"");
    refused("symmetry elliptic_drop --results same other", "\"tilted\" is none of");
    edit(&other, "problem.json", "\"relation\": \"tilted\"", "\"later\": 1");
    refused("symmetry elliptic_drop --results same other", "`export --relation` wrote");
    assert!(!folder.path().join("x").exists(), "a problem that is refused leaves no folder");
}
