//! The command line as a user has it: exit codes, messages, files, interrupts; and random settings.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::panic::AssertUnwindSafe;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Output, Stdio};
use std::sync::{
    Mutex,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};
use std::thread::sleep;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use rayon::prelude::*;
use serde_json::Value;
use touchstone_base::{
    absent::Absent,
    record::{Cost, Record, Status},
    settings::Field,
    spec::RunSpec,
};
use touchstone_harness::case::{Case, Tier, spec};
use touchstone_harness::problem::Steps;
use touchstone_harness::runner::Context;
use touchstone_harness::size::Size;

use crate::common::send;

fn touchstone_in(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.current_dir(folder).args(arguments).output().unwrap()
}

/// Runs the program in a separate empty folder.
fn touchstone(arguments: &[&str]) -> Output {
    touchstone_in(tempfile::tempdir().unwrap().path(), arguments)
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Exit code 2, nothing on standard output, and every one of these texts in the message.
#[track_caller]
fn refused(arguments: &[&str], says: &[&str]) {
    let output = touchstone(arguments);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    for words in says {
        assert!(message.contains(words), "{arguments:?} should say {words:?}: {message}");
    }
}

/// All files below a folder, relative to it.
fn files(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|below| format!("{name}/{below}")));
        } else {
            found.push(name);
        }
    }
    found.sort();
    found
}

/// A short run of `case` with more arguments.
fn short<'a>(case: &'a str, rest: &[&'a str]) -> Vec<&'a str> {
    let short = ["run", case, "--variant", "seed", "--rows", "8", "--set", "end=0.1"];
    [&short, rest].concat()
}

#[test]
fn help_version_and_lists_are_results() {
    for arguments in [&["--help"][..], &["--version"], &["help", "run"], &["list"]] {
        let output = touchstone(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert!(!output.stdout.is_empty() && output.stderr.is_empty(), "{arguments:?}");
    }
    let text = stdout(&touchstone(&["list", "couette"]));
    for word in [
        "`consistent` is recommended and runs by default",
        "h_over_dx",
        "0.8 to 5.0 [-]",
        "Reynolds number",
    ] {
        assert!(text.contains(word), "{word}: {text}");
    }
    let json = |arguments: &[&str]| -> Value {
        serde_json::from_str(&stdout(&touchstone(arguments))).unwrap()
    };
    let one = json(&["list", "couette", "--json"]);
    assert_eq!(json(&["list", "--json"])[0], one);
    assert_eq!(one["default_variant"], "consistent");
    let rows = one["settings"].as_array().unwrap().iter().find(|s| s["name"] == "rows").unwrap();
    assert_eq!((&rows["unit"], &rows["default"]), (&"-".into(), &20.into()));
}

#[test]
fn unknown_names_are_refused_with_the_nearest() {
    refused(&[], &["Usage"]);
    refused(&["frobnicate"], &["unrecognized subcommand"]);
    refused(&["run", "couete"], &["did you mean couette?", "poiseuille"]);
    refused(&["list", "Couette"], &["did you mean couette?"]);
    refused(&["verify", "lid"], &["no case is called \"lid\"; there are"]);
    refused(&["run", "couette", "--variant", "modrn"], &["did you mean modern?", "seed"]);
    refused(&["run", "couette", "--set", "row=8"], &["did you mean rows?"]);
    refused(&["run", "couette", "--set", "rows"], &["key=value"]);
    refused(&["stability", "acoustic_wave"], &["acoustic_wave declares no largest stable time"]);
    refused(&["stability", "--theory", "extremes"], &["extremes has no rule for its time step"]);
    refused(&["explain", "no.such.gate"], &["no gate is called \"no.such.gate\""]);
}

/// Super-time-stepping takes viscosity out of the contest, which `modern` is bound by.
#[test]
fn the_limits_of_every_variant_are_shown_without_a_run() {
    let output = touchstone(&["stability", "--theory", "--json", "couette"]);
    let rows: Vec<Value> = serde_json::from_str(&stdout(&output)).unwrap();
    let row = |variant: &str| rows.iter().find(|row| row["variant"] == variant).unwrap();
    let (modern, stiff) = (row("modern"), row("stiff"));
    assert_eq!(modern["bound_by"], "viscosity");
    assert_eq!(stiff["bound_by"], "sound or elastic waves");
    let number = |row: &Value, name: &str| row[name].as_f64().unwrap();
    assert!(number(stiff, "sweeps") < 0.5 * number(modern, "sweeps"));
    let table = stdout(&touchstone(&["stability", "--theory"]));
    for case in touchstone_cases::CASES.iter().filter(|case| case.name() != "extremes") {
        assert!(table.contains(&format!("{}\nvariant ", case.name())), "{}", case.name());
    }
    let widest = table.lines().map(|line| line.chars().count()).max();
    assert!(widest <= Some(100), "{widest:?} columns");
}

#[test]
fn senseless_settings_are_refused_with_their_range() {
    for (set, says) in [
        ("rows=1", "setting rows is \"1\"; allowed is a whole number, 4 to 2000 [-]"),
        ("rows=1e9", "allowed is a whole number, 4 to 2000 [-]"),
        ("rows=-8", "setting rows is \"-8\"; allowed is a whole number, 4 to 2000 [-]"),
        ("rows=8.5", "setting rows is \"8.5\"; allowed is a whole number"),
        ("h_over_dx=0", "setting h_over_dx is \"0\"; allowed is a number, 0.8 to 5.0 [-]"),
        ("re=-1", "setting re is \"-1\"; allowed is a number, 1e-9 to 1e6 [-]"),
        ("re=NaN", "setting re is \"NaN\"; allowed is a number"),
        ("end=inf", "setting end is \"inf\"; allowed is a number"),
        ("re=fast", "setting re is \"fast\"; allowed is a number, 1e-9 to 1e6 [-]"),
        ("re=", "setting re is \"\"; allowed is a number"),
        ("wall_curvature=1", "true or false"),
        ("dt=1e-15", "--allow-long"),
        ("columns=2", "setting columns is 2, which is allowed only with a narrower kernel"),
    ] {
        refused(&["run", "couette", "--set", set], &[says]);
    }
    refused(&["run", "couette", "--rows", "-3"], &["rows is \"-3\""]);
    refused(&["run", "couette", "--threads", "0"], &["1..=1024"]);
    refused(&["verify", "--threads", "1025"], &["1..=1024"]);
    refused(&["run", "couette", "--vtk", "0"], &["1..=9999"]);
    let many = ["run", "couette", "--rows", "2000", "--set", "columns=100000"];
    refused(&many, &["MB; without --allow-long", "at most", "rows or columns"]);
    let unused = ["run", "couette", "--variant", "seed", "--set", "shift=0.1"];
    refused(&unused, &["\"shift\" has no effect in variant seed"]);
}

/// These stepped in silence, some for thousands of hours, or were ended by the system for their memory.
#[test]
fn a_run_of_years_or_of_more_memory_than_there_is_is_refused() {
    let runs: [(&str, &[&str], &[&str]); 6] = [
        ("acoustic_wave", &["dt=1e-15"], &["\u{a0}h on one core", "span, dt"]),
        ("shear_wave", &["nu=1e-300"], &["--allow-long", "nu or n"]),
        ("elliptic_drop", &["dt=1e-15", "n=6"], &["\u{a0}h on one core", "end, dt"]),
        ("elliptic_drop", &["strain=1e-9", "dt=1e-15"], &["--allow-long", "end, dt"]),
        ("couette", &["rows=2000", "columns=10000"], &["8424 MB", "rows or columns"]),
        ("extremes", &["steps=100000000", "n=400"], &["--allow-long", "time step"]),
    ];
    for (case, sets, says) in runs {
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let start = Instant::now();
        refused(&[&["run", case][..], &sets].concat(), says);
        assert!(start.elapsed() < Duration::from_secs(5), "{case}: {:?}", start.elapsed());
    }
    // More than 10^10 steps are refused under any permission.
    let asked = ["run", "acoustic_wave", "--set", "dt=1e-15", "--allow-long"];
    refused(&asked, &["the number of time steps would be"]);
}

#[test]
fn a_run_says_what_it_takes_before_its_first_step() {
    let message = stderr(&touchstone(&short("couette", &[])));
    let first = message.lines().next().unwrap_or_default();
    assert!(first.starts_with("estimate: ") && first.contains(" on one core and "), "{first}");
    assert_eq!(message.matches("estimate: ").count(), 1, "{message}");
    // For a run of one simulation, the estimated steps are the actual ones.
    let steps = |text: &str| text.split(' ').nth(1).and_then(|word| word.parse::<f64>().ok());
    let estimate = steps(first).unwrap();
    let output = touchstone(&short("couette", &["--json"]));
    let made = Record::from_json(&stdout(&output)).unwrap().cost.steps as f64;
    assert!((estimate / made - 1.0).abs() < 0.1, "{estimate} against {made}");
}

#[test]
fn a_time_step_beyond_the_limit_needs_a_word_and_may_diverge() {
    let far_beyond = ["--set", "jitter=0.01", "--set", "dt=0.05"];
    let with = |rest: &[&'static str]| short("couette", &[&far_beyond, rest].concat());
    refused(&with(&[]), &["dt is 5.0000e-2 s", "at most", "--allow-unstable"]);
    let output = touchstone(&with(&["--allow-unstable", "--json"]));
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(stderr(&output).contains("diverged after"));
    let record = Record::from_json(&stdout(&output)).unwrap();
    assert!(matches!(record.status, Status::Diverged { .. }));

    let message = stderr(&touchstone(&with(&[])));
    let limit = message.split("at most ").nth(1).unwrap().split(' ').next().unwrap();
    let just_beyond = format!("dt={}", 1.005 * limit.parse::<f64>().unwrap());
    refused(&short("couette", &["--set", &just_beyond]), &["--allow-unstable"]);
    // Other damping contributes to the limit.
    let diffused = ["run", "couette", "--rows", "10", "--set", "end=0.1", "--set", "diffusion=2"];
    refused(&diffused, &["dt is", "--allow-unstable"]);
    let output = touchstone(&short("couette", &["--set", &just_beyond, "--allow-unstable"]));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_run_prints_its_record_or_its_metrics() {
    let output = touchstone(&short("couette", &[]));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let (text, words) = (stdout(&output), stderr(&output));
    for part in ["l2_worst", "\nerror  ", "\nbound  ", "\ncost   ", "\nnext   touchstone "] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!words.contains("l2_worst"), "results go to standard output: {words}");
    let output = touchstone(&short("couette", &["--json", "--threads", "2"]));
    assert_eq!((output.status.code(), stderr(&output)), (Some(0), String::new()));
    let record = Record::from_json(&stdout(&output)).unwrap();
    assert_eq!((record.status, record.run.settings["rows"].as_u64()), (Status::Completed, Some(8)));
    assert!(record.metrics["l2@0.1"].value < 0.05);
}

#[test]
fn verdicts_are_results_and_how_they_came_about_is_not() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    let output =
        touchstone_in(folder.path(), &["verify", "--no-runs", "couette", "--store", "empty"]);
    let (text, words) = (stdout(&output), stderr(&output));
    assert_eq!(output.status.code(), Some(1), "{text}{words}");
    assert!(text.starts_with("case ") && text.contains("\ncouette "), "{text}");
    assert!(text.contains(" more gates fail: ") && text.lines().count() < 110, "{text}");
    assert!(words.contains("; the store lacks ") && words.contains(" runs in "), "{words}");
    let all = touchstone_in(
        folder.path(),
        &["verify", "--no-runs", "couette", "--store", "empty", "--all"],
    );
    let gates = stdout(&all).lines().filter(|line| line.starts_with("FAIL ")).count();
    assert!(gates > 20 && stdout(&all).ends_with(&text), "{gates} gates, then the same");
}

#[test]
fn a_run_writes_its_files_whole() {
    let folder = tempfile::tempdir().unwrap();
    let output = touchstone_in(folder.path(), &short("poiseuille", &["--vtk", "3"]));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let out = folder.path().join("reports/run-poiseuille-seed");
    let expected = [
        "profile.csv",
        "record.json",
        "vtk/particles.pvd",
        "vtk/particles_0000.vtu",
        "vtk/particles_0001.vtu",
        "vtk/particles_0002.vtu",
    ];
    assert_eq!(files(&out), expected);
    let record = Record::from_json(&fs::read_to_string(out.join("record.json")).unwrap()).unwrap();
    assert_eq!(record.run.variant, "seed");
    let profile = fs::read_to_string(out.join("profile.csv")).unwrap();
    let mut lines = profile.lines();
    assert_eq!(lines.next(), Some("t[s],y[m],u[m/s],u_exact[m/s]"));
    assert_eq!(lines.count(), 3 * 8, "three times, eight rows");
    assert!(profile.contains("\n0.1,"), "nu t/L^2 = 0.1 is t = 0.1 s here: {profile}");
    // Without --out and --vtk nothing is written.
    let empty = tempfile::tempdir().unwrap();
    assert_eq!(touchstone_in(empty.path(), &short("couette", &[])).status.code(), Some(0));
    assert_eq!(files(empty.path()), Vec::<String>::new());
}

/// The record that the command prints.
#[track_caller]
fn record_of(folder: &Path, arguments: &[&str]) -> Record {
    let output = touchstone_in(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
    Record::from_json(&stdout(&output)).unwrap()
}

/// Samples are so close together that the step of 9.76e-5 s that was planned is never taken.
#[test]
fn a_record_states_the_step_that_was_used_and_the_one_that_was_planned() {
    let folder = tempfile::tempdir().unwrap();
    let run = ["run", "elliptic_drop", "--variant", "seed", "--set", "n=12", "--json"];
    let record = record_of(folder.path(), &run);
    let number = |name: &str| record.numerics[name].as_f64().unwrap();
    let end = 0.8 / 100.0;
    assert!(number("dt [s]") <= end / 80.0 * (1.0 + 1e-12), "{}", number("dt [s]"));
    assert!(number("dt [s]") < 0.99 * number("dt [s] planned"), "{:?}", record.numerics);
    let ratio = number("dt [s]") / number("dt [s] planned");
    assert!((number("dt/limit") / number("dt/limit planned") / ratio - 1.0).abs() < 1e-12);
}

/// A short run of each case.
const SHORT: [&str; 23] = [
    "couette --variant seed --set rows=8 --set end=0.1",
    "poiseuille --set rows=8 --set end=0.1",
    "taylor_green --set n=20 --set end=0.1",
    "periodic_hill --set n=8 --set end=0.5",
    "dam_break --set n=8 --set end=0.5",
    "rubber_rings --variant leapfrog --set spacing=0.5 --set end=20",
    "elliptic_drop --set n=12",
    "hydrostatic --set rows=8 --set columns=8 --set end=1",
    "taylor_couette --set layers=6 --set end=0.5",
    "slip_channel --set n=8",
    "acoustic_wave",
    "shear_wave --set span=0.2",
    "elastic_bar --set n=24",
    "spinning_disk --variant bare --set n=8 --set end=0.1 --set courant=0.8",
    "oscillating_plate --set n=4 --set end=0.1",
    "cantilever --variant lagrangian --set n=4 --set end=0.02",
    "elastic_wave",
    "extremes --set steps=40",
    "resting_box",
    "operators --set n=16 --set steps=12",
    "manufactured --set n=12",
    "cavity --set n=8 --set end=0.5",
    "still_wedge --set n=8 --set end=1",
];

/// Each case writes the requested number of frames, at equal intervals and with all fields, and a profile
/// whose parts add up; everything else equals the run without them, including the metrics that are left out
/// by default.
#[test]
fn watching_does_not_change_a_run() {
    let names: Vec<&str> = SHORT.iter().filter_map(|run| run.split(' ').next()).collect();
    let all: Vec<&str> = touchstone_cases::CASES.iter().map(|case| case.name()).collect();
    assert!(all.iter().all(|name| names.contains(name)), "{all:?} against {names:?}");
    for run in SHORT {
        let folder = tempfile::tempdir().unwrap();
        let arguments: Vec<&str> = ["run"].into_iter().chain(run.split(' ')).collect();
        let unwatched = record_of(folder.path(), &[&arguments[..], &["--json"]].concat());
        let watch = ["--json", "--profile", "--metrics", "all", "--vtk", "4", "--out", "here"];
        let watched = record_of(folder.path(), &[&arguments[..], &watch].concat());
        assert!(watched.cost.steps > 10, "{run}");
        assert_eq!(watched.state, unwatched.state, "{run}");
        let work = |Cost { steps, pair_interactions, particle_rhs, .. }: &Cost| {
            [*steps, *pair_interactions, *particle_rhs]
        };
        assert_eq!(work(&watched.cost), work(&unwatched.cost), "{run}");
        assert_eq!(unwatched.cost.breakdown, None, "{run}");
        let breakdown = watched.cost.breakdown.as_ref().expect("a profile");
        // Another program may take a while between two clocks, so that seconds are not compared.
        for part in breakdown.stepping.iter().chain(&breakdown.observing) {
            let is_sound = part.times > 0 && part.seconds >= 0.0 && part.seconds.is_finite();
            assert!(is_sound, "{run}: {part:?}");
        }
        let most = breakdown.stepping.iter().map(|part| part.times).max();
        assert!(most >= Some(breakdown.steps), "{run}: a part of each step was seen");
        assert_eq!(breakdown.steps, watched.cost.steps, "{run}");
        assert!(breakdown.observing.iter().any(|part| part.name == "frames"), "{run}");
        let shown = |of: &Record, name| format!("{:?}", of.metrics.get(name)); // some may be NaN
        for name in unwatched.metrics.keys() {
            assert_eq!(shown(&watched, name), shown(&unwatched, name), "{run}: {name}");
        }
        let unasked = unwatched.absent.iter().filter(|(_, why)| **why == Absent::NotAsked).count();
        assert_eq!(unwatched.metrics.len() + unasked, watched.metrics.len(), "{run}");
        let read = |name: &str| fs::read_to_string(folder.path().join("here").join(name)).unwrap();
        let attribute = |line: &str| line.split('"').nth(1).and_then(|text| text.parse().ok());
        let times: Vec<f64> =
            read("vtk/particles.pvd").split("timestep=").skip(1).filter_map(attribute).collect();
        let end = times.last().copied().unwrap();
        assert_eq!(times.len(), 4, "{run}");
        for (k, time) in times.iter().enumerate() {
            let late = time - end * (k + 1) as f64 / 4.0;
            let a_step = (1.0 + 1e-9) * watched.cost.largest_dt_s;
            assert!((-1e-9 * end..=a_step).contains(&late), "{run}: {times:?}");
        }
        let frame = read("vtk/particles_0003.vtu");
        let is_solid = ["rubber", "elastic", "spinning", "oscillating", "cantilever"]
            .iter()
            .any(|s| run.starts_with(s));
        let fields = ["velocity", "density", "pressure", "mass", "role", "id"].map(|f| (f, true));
        for (field, is_there) in fields.into_iter().chain([("deviatoric stress xx", is_solid)]) {
            assert_eq!(frame.contains(&format!("Name=\"{field}\"")), is_there, "{run}: {field}");
        }
        assert!(read("profile.csv").lines().count() > 8, "{run}");
    }
}

/// No table repeats its last sample, as for rings or a disk of the leapfrog, and a table whose first number
/// is not finite is not empty.
#[test]
fn no_table_repeats_a_time_or_ends_early() {
    for run in SHORT {
        let folder = tempfile::tempdir().unwrap();
        let arguments: Vec<&str> = ["run"].into_iter().chain(run.split(' ')).collect();
        let record =
            record_of(folder.path(), &[&arguments[..], &["--json", "--out", "here"]].concat());
        for (name, profile) in &record.profiles {
            let path = folder.path().join(format!("here/{name}.csv"));
            let Ok(text) = fs::read_to_string(path) else { continue };
            let rows: Vec<&str> = text.lines().skip(1).collect();
            assert_eq!(rows.len(), profile.columns[0].values.len(), "{run}: {name}");
            let times = rows.iter().filter_map(|row| row.split(',').next());
            let times: Vec<&str> = times.collect();
            let is_series = profile.columns[0].name == "t";
            assert!(!is_series || times.windows(2).all(|w| w[0] != w[1]), "{run}: {name}");
            let starts = ["couette", "poiseuille", "taylor_green", "dam", "elliptic", "hydro"];
            let starts = is_series && starts.iter().any(|case| run.starts_with(case));
            assert!(!starts || times[0] == "0", "{run}: {name} begins at {}", times[0]);
        }
    }
}

/// A run that diverges reports this with and without frames, and its frames end before.
#[test]
fn a_watched_run_that_diverges_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let run = ["--set", "jitter=0.01", "--set", "dt=0.05", "--allow-unstable", "--vtk", "3"];
    let output = touchstone_in(folder.path(), &short("couette", &run));
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(stderr(&output).contains("diverged after"));
}

/// State of each run in a store, by file name.
fn states(store: &Path) -> BTreeMap<String, Option<String>> {
    let is_whole = |name: &String| name.ends_with(".json") && !name.starts_with('.');
    let records = files(store).into_iter().filter(is_whole);
    let read = |name: String| {
        let record = Record::from_json(&fs::read_to_string(store.join(&name)).unwrap()).unwrap();
        (name, record.state)
    };
    records.map(read).collect()
}

/// A killed process loses only its present run.
#[cfg(unix)]
#[test]
fn a_killed_report_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let (specs, whole, killed) = ("specs.jsonl", "whole", "killed");
    let sweep = ["plan", "couette", "--variant", "seed", "--set", "rows=20,22,24,26,28,30"];
    let planned = touchstone_in(folder.path(), &sweep);
    assert_eq!(planned.status.code(), Some(0), "{}", stderr(&planned));
    fs::write(folder.path().join(specs), &planned.stdout).unwrap();
    let make = |store| ["run", "--specs", specs, "--threads", "1", "--store", store];
    let output = touchstone_in(folder.path(), &make(whole));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let expected = states(&folder.path().join(whole));
    assert!(expected.len() == 6 && expected.values().all(Option::is_some), "{expected:?}");

    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.current_dir(folder.path()).args(make(killed)).stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    let store = folder.path().join(killed);
    let start = Instant::now();
    while (!store.exists() || states(&store).is_empty()) && start.elapsed().as_secs() < 20 {
        sleep(Duration::from_millis(1));
    }
    child.kill().unwrap(); // SIGKILL
    child.wait().unwrap();
    let before = states(&store);
    assert!((1..6).contains(&before.len()), "{before:?}");
    let output = touchstone_in(folder.path(), &make(killed));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let reused = format!("{} of them were in the store before", before.len());
    assert!(stderr(&output).contains(&reused), "{}", stderr(&output));
    assert_eq!(states(&store), expected);
}

#[test]
fn a_folder_that_cannot_be_written_is_refused_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "in the way").unwrap();
    let below = file.join("below");
    let start = Instant::now();
    let long = ["run", "couette", "--rows", "400", "--out", below.to_str().unwrap()];
    refused(&long, &["cannot write into the folder", "below"]);
    refused(&["report", "--out", below.to_str().unwrap()], &["cannot write into the folder"]);
    assert!(start.elapsed() < Duration::from_secs(3));
    // A folder made for a run that is refused is removed again.
    let new = folder.path().join("new");
    let refused_run = ["run", "couette", "--set", "dt=1", "--out", new.to_str().unwrap()];
    refused(&refused_run, &["--allow-unstable"]);
    assert!(!new.exists());
}

#[test]
fn rows_that_are_given_twice_are_refused() {
    let words = "setting rows is given twice, as \"10\" and as \"8\"; give one of them";
    refused(&short("couette", &["--set", "rows=10"]), &[words]);
}

/// Plain runs neither compute nor judge an energy ledger that was not requested.
#[test]
fn a_run_says_which_metrics_and_gates_were_not_asked_for() {
    let run = |rest: &[&'static str]| {
        let output = touchstone(&[&["run", "dam_break", "--all", "--set", "n=20"], rest].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stdout(&output)
    };
    let (plain, all) = (run(&[]), run(&["--metrics", "all"]));
    assert!(plain.contains("(not asked for: --metrics all)"), "{plain}");
    assert!(plain.contains("more gates on metrics not asked for (--metrics all): 3"), "{plain}");
    assert!(!plain.contains(".energy_gap") && all.contains(".energy_gap"), "{all}");
    assert!(!all.contains("not asked for"), "{all}");
}

#[test]
fn a_folder_with_the_record_of_another_case_is_not_mixed_with() {
    let folder = tempfile::tempdir().unwrap();
    let into = |case, rest: &[&'static str]| {
        let all = short(case, &[&["--out", "here"][..], rest].concat());
        touchstone_in(folder.path(), &all)
    };
    let longer = ["--out", "here", "--set", "end=1", "--vtk", "2"];
    let arguments = [&["run", "elastic_bar"][..], &longer].concat();
    assert_eq!(touchstone_in(folder.path(), &arguments).status.code(), Some(0));
    assert!(files(&folder.path().join("here")).len() > 5, "tables and frames");
    assert_eq!(into("couette", &["--overwrite"]).status.code(), Some(0));
    assert_eq!(into("couette", &[]).status.code(), Some(0), "its own record is replaced");
    let output = into("poiseuille", &[]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    for word in ["couette", "poiseuille", "--overwrite"] {
        assert!(message.contains(word), "{word}: {message}");
    }
    assert_eq!(into("poiseuille", &["--overwrite"]).status.code(), Some(0));
    assert_eq!(files(&folder.path().join("here")), ["profile.csv", "record.json"], "of this run");
    let text = fs::read_to_string(folder.path().join("here/record.json")).unwrap();
    assert_eq!(Record::from_json(&text).unwrap().run.case, "poiseuille");
}

/// The folder was found writable before the run, and then its disk was full.
#[test]
fn a_record_that_cannot_be_written_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("here/record.json/child")).unwrap();
    let output = touchstone_in(folder.path(), &short("couette", &["--out", "here"]));
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("cannot write the file \"here/record.json\""));
    let record = Record::from_json(&stdout(&output)).unwrap();
    assert_eq!((record.run.case.as_str(), record.status), ("couette", Status::Completed));
}

#[test]
fn an_unknown_gate_is_answered_by_a_few_names() {
    let output = touchstone(&["explain", "couette.l2wrst"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("the nearest of"), "{message}");
    assert!(message.len() < 600, "{} bytes: {message}", message.len());
}

/// Starts a long run, sends it a signal once it is under way, and returns its output.
#[cfg(unix)]
fn interrupted(out: &Path, signal: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_touchstone"))
        .args(["run", "couette", "--variant", "seed", "--rows", "400", "--threads", "1"])
        .args(["--vtk", "2", "--out", out.to_str().unwrap()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !out.join("vtk").exists() && start.elapsed() < Duration::from_secs(10) {
        sleep(Duration::from_millis(10));
    }
    sleep(Duration::from_millis(200));
    let pid = child.id().to_string();
    assert!(Command::new("kill").args([signal, &pid]).status().unwrap().success());
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() && start.elapsed() < Duration::from_secs(10) {
        sleep(Duration::from_millis(10));
    }
    let _ = child.kill(); // has no effect on a child that has ended
    child.wait_with_output().unwrap()
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_the_run_in_order_and_leaves_no_part() {
    for signal in ["-INT", "-TERM"] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let output = interrupted(&out, signal);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(130), "{message}");
        assert!(message.contains("touchstone: interrupted: after"), "{message}");
        assert!(message.contains("no record is written"), "{message}");
        assert_eq!(files(folder.path()), Vec::<String>::new());
    }
}

/// Starts a run that writes checkpoints, and waits until its line of standard error begins like this.
#[cfg(unix)]
fn started(folder: &Path, arguments: &[&str], line: &str) -> (Child, BufReader<ChildStderr>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.current_dir(folder).args(arguments).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut first = String::new();
    said.read_line(&mut first).unwrap();
    assert!(first.starts_with(line), "{first}");
    (child, said)
}

/// A record as text, without times and memory, which depend on the machine, and the number of its restarts.
fn told(folder: &Path) -> (String, u32) {
    let text = fs::read_to_string(folder.join("record.json")).unwrap();
    let mut record = Record::from_json(&text).unwrap();
    let resumed = record.cost.resumed;
    let none = Cost { wall_s: 0.0, cpu_s: 0.0, observing_s: 0.0, ..record.cost.clone() };
    record.cost = Cost { solver_bytes: 0, resumed: 0, ..none };
    (record.to_json().unwrap(), resumed)
}

/// Checkpoints with other numbers and a matching digest, and the expected messages. The numbers begin after
/// two lines: time and step of the state, eight bytes each, and the number of steps, of which the last byte
/// alone is below 128.
#[cfg(unix)]
fn forged(whole: &[u8]) -> Vec<(Vec<u8>, &'static str)> {
    let lines: Vec<&[u8]> = whole.splitn(3, |byte| *byte == b'\n').collect();
    let [first, head, numbers] = lines[..] else { panic!("two lines and numbers") };
    let first = String::from_utf8_lossy(first).into_owned();
    let (format, _) = first.rsplit_once(' ').unwrap();
    let head = String::from_utf8_lossy(head).into_owned();
    let sealed = |head: &str, numbers: &[u8]| {
        let rest = [head.as_bytes(), b"\n", numbers].concat();
        [format!("{format} {}\n", touchstone_base::reference::sha256(&rest)).as_bytes(), &rest]
            .concat()
    };
    let with = |place: usize, number: [u8; 8]| {
        let mut numbers = numbers.to_vec();
        numbers[place..place + 8].copy_from_slice(&number);
        sealed(&head, &numbers)
    };
    let last = 16 + numbers[16..].iter().position(|byte| *byte < 128).unwrap();
    let most = [&[0xFF; 9][..], &[1]].concat();
    let steps = [&numbers[..16], &most, &numbers[last + 1..]].concat();
    let endless = sealed(&head, &steps);
    vec![
        (sealed(&head.replace("\"n\":56", "\"n\":57"), numbers), "particles of another scene"),
        (sealed(&head.replace("\"n\":56", "\"n\":-1"), numbers), "setting n is"),
        (with(0, 1e9_f64.to_le_bytes()), "a time outside its interval"),
        (with(0, f64::NAN.to_le_bytes()), "a time outside its interval"),
        (endless, "a count that no run reaches"),
        // The length of a list of observations.
        (sealed(&head, &numbers[..numbers.len() - 40]), "not one of this run"),
    ]
}

/// A run that is killed, goes on, is interrupted and goes on again ends with the record, the tables and the
/// frames of one that was left alone; and a checkpoint that was cut is refused.
#[cfg(unix)]
#[test]
fn a_killed_run_goes_on_to_an_equal_record() {
    let folder = tempfile::tempdir().unwrap();
    let run = ["run", "dam_break", "--set", "n=56", "--vtk", "4", "--threads", "1", "--out"];
    let output = touchstone_in(folder.path(), &[&run[..], &["alone"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));

    let watched = ["killed", "--checkpoint-every", "1"];
    let (mut child, _said) = started(folder.path(), &[&run[..], &watched].concat(), "estimate: ");
    let checkpoint = folder.path().join("killed/checkpoint");
    let start = Instant::now();
    while !checkpoint.exists() && start.elapsed() < Duration::from_secs(60) {
        sleep(Duration::from_millis(10));
    }
    assert_eq!(child.try_wait().unwrap(), None, "it has ended before it was killed");
    send("-KILL", &child);
    child.wait().unwrap();
    assert!(!folder.path().join("killed/record.json").exists());

    let again = touchstone_in(folder.path(), &[&run[..], &["killed"]].concat());
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("touchstone run --resume killed continues it"));
    let whole = fs::read(&checkpoint).unwrap();
    fs::write(&checkpoint, &whole[..whole.len() - 1]).unwrap();
    let resume = ["run", "--resume", "killed", "--threads", "1"];
    let cut = touchstone_in(folder.path(), &resume);
    assert_eq!(cut.status.code(), Some(2));
    assert!(stderr(&cut).contains("killed/checkpoint\" is damaged or truncated"), "{cut:?}");
    for (changed, words) in forged(&whole) {
        fs::write(&checkpoint, changed).unwrap();
        let output = touchstone_in(folder.path(), &resume);
        assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
        assert!(stderr(&output).contains(words), "{words}: {}", stderr(&output));
    }
    fs::write(&checkpoint, &whole).unwrap();

    let (mut child, mut said) = started(folder.path(), &resume, "estimate: ");
    send("-INT", &child);
    let mut message = String::new();
    said.read_to_string(&mut message).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{message}");
    assert!(message.contains("touchstone run --resume killed continues it"), "{message}");

    let output = touchstone_in(folder.path(), &resume);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let [(alone, _), (killed, resumed)] =
        ["alone", "killed"].map(|name| told(&folder.path().join(name)));
    assert_eq!(killed, alone);
    assert_eq!(resumed, 2);
    let names = files(&folder.path().join("alone"));
    let mut of_killed = files(&folder.path().join("killed"));
    of_killed.retain(|name| !name.contains(".unfinished-")); // what it was writing when it was killed
    assert_eq!(of_killed, names, "the checkpoint is gone");
    for name in names.iter().filter(|name| *name != "record.json") {
        let read = |run: &str| fs::read(folder.path().join(run).join(name)).unwrap();
        assert!(read("killed") == read("alone"), "{name}");
    }
}

#[test]
fn checkpoints_are_refused_where_they_make_no_sense() {
    let every = ["run", "couette", "--checkpoint-every"];
    refused(&[&every[..], &["10"]].concat(), &["--checkpoint-every needs --out DIR"]);
    refused(&[&every[..], &["0", "--out", "o"]].concat(), &["0 is not in 1.."]);
    refused(&["run", "--resume", "nowhere"], &["\"nowhere\" has no checkpoint"]);
    let alone = "run --resume DIR, whose checkpoint holds case, variant and settings";
    refused(&["run", "couette", "--resume", "o"], &["cannot be used with", alone]);
    let with_specs = ["run", "--specs", "-", "--store", "s", "--checkpoint-every", "9"];
    refused(&with_specs, &["cannot be used with"]);
}

/// A run that a plan refuses for its length is made with the flag named in the refusal.
#[cfg(unix)]
#[test]
fn runs_of_a_plan_may_be_long_if_this_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let plan = ["plan", "extremes", "--set", "n=400", "--set", "steps=100000000"];
    let planned = touchstone_in(folder.path(), &plan);
    fs::write(folder.path().join("specs"), &planned.stdout).unwrap();
    let make = ["run", "--specs", "specs", "--store", "store"];
    let output = touchstone_in(folder.path(), &make);
    assert!(stderr(&output).contains("1 refused"), "{}", stderr(&output));
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.current_dir(folder.path()).args(make).arg("--allow-long").stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    sleep(Duration::from_millis(500));
    assert_eq!(child.try_wait().unwrap(), None, "it is under way");
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn doctor_finds_this_program_sound() {
    let output = touchstone(&["doctor", "--verbose"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", stdout(&output), stderr(&output));
    for word in ["commit", "references  ok", "writing     ok", "self-check  ok", "sha256:"] {
        assert!(stdout(&output).contains(word), "{word}: {}", stdout(&output));
    }
    let text = stdout(&touchstone(&["doctor"]));
    assert!(text.lines().count() <= 8 && !text.contains("sha256:"), "{text}");
}

#[test]
fn doctor_makes_no_folder_and_fails_where_it_cannot_write() {
    let folder = tempfile::tempdir().unwrap();
    let output = touchstone_in(folder.path(), &["doctor", "--out", "a/b/c"]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    fs::write(folder.path().join("file"), "in the way").unwrap();
    let output = touchstone_in(folder.path(), &["doctor", "--out", "file/below"]);
    assert!(stdout(&output).contains("writing     FAIL"), "{}", stdout(&output));
    assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
}

#[test]
fn a_hundred_thousand_threads_are_clamped() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.env("RAYON_NUM_THREADS", "100000").args(short("couette", &["--json"]));
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("RAYON_NUM_THREADS is more than 1024"));
    assert_eq!(Record::from_json(&stdout(&output)).unwrap().cost.threads, 1024);
}

/// Sines and exponentials of the C library have other last bits on a processor without FMA, and this variable
/// makes it believe that it is on one.
#[cfg(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64"))]
#[test]
fn bits_do_not_depend_on_the_instructions_that_the_c_library_finds() {
    let record = |case: &str, sets: [&str; 2], tunables: Option<&str>| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
        command.env_remove("GLIBC_TUNABLES").envs(tunables.map(|value| ("GLIBC_TUNABLES", value)));
        let sets = ["--set", sets[0], "--set", sets[1], "--json"];
        let output = command.args(["run", case]).args(sets).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{case}: {}", stderr(&output));
        Record::from_json(&stdout(&output)).unwrap()
    };
    let short = [("taylor_green", ["n=30", "end=0.02"]), ("acoustic_wave", ["n=40", "span=0.1"])];
    for (case, sets) in short {
        let [with, without] = [None, Some("glibc.cpu.hwcaps=-FMA,-AVX2")]
            .map(|tunables| record(case, sets, tunables));
        assert!(with.state.is_some() && with.cost.steps > 5, "{case}");
        assert_eq!(with.state, without.state, "{case}");
        let metrics = |of: &Record| format!("{:?}", of.metrics); // some may be NaN
        assert_eq!(metrics(&with), metrics(&without), "{case}");
    }
}

/// A record that cannot be printed is an error. Rust opens `/dev/null` where standard output is closed;
/// `>/dev/null` by the user is no error.
#[cfg(target_os = "linux")]
#[test]
fn a_document_for_a_closed_standard_output_is_an_error() {
    let program = env!("CARGO_BIN_EXE_touchstone");
    for line in ["run couette --set rows=8 --set end=0.01 --json", "list --json"] {
        let run = |to: &str| {
            let line = format!("'{program}' {line} {to}");
            Command::new("bash").args(["-c", &line]).output().unwrap()
        };
        for to in [">&-", ">/dev/full"] {
            let output = run(to);
            assert_eq!(output.status.code(), Some(2), "{line} {to}: {}", stderr(&output));
            assert!(stderr(&output).contains("standard output"), "{line} {to}: {output:?}");
        }
        assert_eq!(run(">/dev/null").status.code(), Some(0), "{line}");
    }
    let line = format!("'{program}' --help >/dev/full");
    let help = Command::new("bash").args(["-c", &line]).output().unwrap();
    assert_eq!(help.status.code(), Some(2), "{}", stderr(&help));
}

/// A program that reads half a document must not take it for a whole one.
#[cfg(target_os = "linux")]
#[test]
fn a_document_that_nobody_reads_to_its_end_is_an_error() {
    let program = env!("CARGO_BIN_EXE_touchstone");
    let line = format!("set -o pipefail; (sleep 1; '{program}' list couette --json) | true");
    let output = Command::new("bash").args(["-c", &line]).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("cannot write to standard output"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_reader_that_goes_away_is_no_bug_and_a_full_disk_is_told() {
    let run = |shell: &str| {
        let program = env!("CARGO_BIN_EXE_touchstone");
        let line = format!("set -o pipefail; '{program}' list couette {shell}");
        Command::new("bash").args(["-c", &line]).output().unwrap()
    };
    assert_eq!(run("| true").status.code(), Some(0));
    let full = run("> /dev/full");
    assert_eq!(full.status.code(), Some(2));
    assert!(stderr(&full).contains("cannot write to standard output"));
}

/// An empty store lacks all runs.
#[test]
fn a_store_without_records_lacks_them_all() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    let output = touchstone_in(
        folder.path(),
        &["verify", "--no-runs", "taylor_couette", "--store", "empty"],
    );
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    let words = message.split_whitespace().collect::<Vec<_>>().join(" ");
    let after = |text: &str| -> usize {
        let (_, rest) = words.split_once(text).unwrap_or_else(|| panic!("{text:?}: {words}"));
        let number: String = rest.chars().take_while(char::is_ascii_digit).collect();
        number.parse().unwrap()
    };
    let [planned, lacking, other] =
        ["runs of the quick tier: ", "the store lacks ", "and has "].map(after);
    assert!(planned > 0 && lacking == planned && other == 0, "{words}");
}

/// Memory in MB and time in seconds: the memory of a run at its end is within a factor of three of the
/// estimate.
#[test]
fn a_plan_states_memory_in_megabytes_and_time_in_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let run = ["couette", "--set", "rows=60", "--set", "columns=60", "--set", "end=0.001"];
    let planned = touchstone_in(
        folder.path(),
        &[&["plan"], &run[..], &["--estimates", "estimates.csv"]].concat(),
    );
    assert!(planned.status.success(), "{}", stderr(&planned));
    let table = fs::read_to_string(folder.path().join("estimates.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("index[-],time[s],memory[MB]"));
    let row: Vec<f64> =
        lines.next().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    let output = touchstone(&[&["run"], &run[..], &["--json", "--threads", "1"]].concat());
    let record: Record = Record::from_json(&stdout(&output)).unwrap();
    let ratio = 1e6 * row[2] / record.cost.solver_bytes as f64;
    assert!((0.3..3.0).contains(&ratio), "{} MB for {} bytes", row[2], record.cost.solver_bytes);
    // 8 threads or a debugger slow a run down, and nothing makes it a thousand times as fast.
    let ratio = row[1] / record.cost.cpu_s;
    assert!((1e-2..1e2).contains(&ratio), "{} s for {} s", row[1], record.cost.cpu_s);
}

/// Numbers of sensors that no water reached are absent, an error of a flow that has hardly begun is not
/// stated against finite elements, and `run periodic_hill` is the run of README.
#[test]
fn a_short_run_says_what_it_did_not_reach_and_a_default_one_is_planned() {
    let tank = ["width=0.6", "height=0.3", "tank=1.61", "rim=2", "n=10", "end=1"];
    let set = tank.iter().flat_map(|set| ["--set", set]);
    let line: Vec<&str> = ["run", "dam_break", "--json"].into_iter().chain(set).collect();
    let record = Record::from_json(&stdout(&touchstone(&line))).unwrap();
    for name in ["H3_away", "H4_away", "peak_P1"] {
        assert!(!record.metrics.contains_key(name), "{:?}", record.metrics[name]);
        assert!(record.absent[name].to_string().contains("before water comes"), "{record:?}");
    }
    assert!(record.metrics["H1_away"].value > 0.0, "the tank is not dry");

    let said = |end: &str| {
        let line = ["run", "periodic_hill", "--set", "n=4", "--set", "re=10", "--set", end];
        stdout(&touchstone(&line)).split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let short = said("end=0.5");
    assert!(short.contains("(not steady: about 76 % of the start from rest is left)"), "{short}");
    assert!(!said("end=10").contains("steady"), "0.4 % is left");

    for (name, variant) in
        [("periodic_hill", "carried"), ("couette", "modern"), ("dam_break", "modern")]
    {
        let case = touchstone_cases::find(name).unwrap();
        let of_run = spec(case, variant, &[]).unwrap().settings;
        let mut plan = touchstone_harness::plan::of_case(case, Tier::Quick).into_iter();
        assert!(plan.any(|planned| planned.spec.settings == of_run), "{name} {variant}");
    }
}

/// Pairs and memory of every variant are estimated within these factors of the counted ones; periodic copies,
/// which a narrow scene has more of than particles, and the pairs of interface particles are not estimated.
const ESTIMATED: [f64; 2] = [2.5, 3.0];

/// Wall particles without neighbour lists must not count as particles with neighbours: 6.7 times the pairs of
/// a small dam break.
#[test]
fn the_size_of_a_run_is_estimated_within_a_factor_of_what_it_counts() {
    let mut all = Vec::new();
    for &case in touchstone_cases::CASES {
        for variant in case.variants() {
            for set in [Vec::new(), vec!["n=10".to_string()]] {
                let Ok(spec) = spec(case, variant.name, &set) else { continue };
                let (stop, told) = (AtomicBool::new(false), Mutex::new(None));
                let tell = |size: &Size| {
                    told.lock().unwrap().get_or_insert(*size);
                    stop.store(size.seconds() > 0.05, Ordering::Relaxed);
                };
                let context =
                    Context { interrupt: Some(&stop), estimate: Some(&tell), ..Context::default() };
                let made = case.run(&RunSpec { allow_unstable: true, ..spec }, &context);
                let told = told.into_inner().unwrap();
                if let (Ok(Record { cost, .. }), Some(size)) = (made, told)
                    && cost.steps > 0
                {
                    let pairs = size.pairs() / size.steps * cost.steps as f64;
                    let ratios = [
                        pairs / cost.pair_interactions as f64,
                        size.bytes() / cost.solver_bytes as f64,
                    ];
                    all.push((format!("{} {} {set:?}", case.name(), variant.name), ratios));
                }
            }
        }
    }
    assert!(all.len() > 60, "{} runs", all.len());
    let is_wrong = |(_, ratios): &(String, [f64; 2])| {
        ratios.iter().zip(ESTIMATED).any(|(ratio, most)| !(1.0 / most..=most).contains(ratio))
    };
    all.retain(is_wrong);
    assert!(all.is_empty(), "pairs and memory, estimated over counted: {all:#?}");
}

fn assignment(case: usize) -> impl Strategy<Value = String> {
    let keys: Vec<&'static str> =
        touchstone_cases::CASES[case].fields().iter().map(|field| field.name).collect();
    let key = prop_oneof![8 => prop::sample::select(keys), 1 => Just("Rows"), 1 => Just("")];
    let number = prop_oneof![
        1 => (-320i32..=310, 1.0..10.0f64).prop_map(|(power, digits)| format!("{digits}e{power}")),
        6 => (-6i32..=3, 1.0..10.0f64).prop_map(|(power, digits)| format!("{digits}e{power}")),
        4 => (0u64..300).prop_map(|count| count.to_string()),
        1 => any::<f64>().prop_map(|number| number.to_string()),
        1 => prop::sample::select(vec!["auto", "true", "false", "NaN", "-inf", "", "0", "-1"])
            .prop_map(String::from),
        1 => ".{0,12}",
    ];
    (key, number).prop_map(|(key, value)| format!("{key}={value}"))
}

/// Settings that make a scene small, among the settings of the case.
fn small(case: &dyn Case, variant: &str) -> Vec<String> {
    let all = ["rows=5", "columns=0", "layers=6", "n=8", "spacing=0.5"].map(String::from);
    let is_known = |set: &String| case.settings(variant, std::slice::from_ref(set)).is_ok();
    all.into_iter().filter(is_known).collect()
}

/// The ends of the ranges of the settings of a case, as `key=value`.
fn ends(case: &dyn Case) -> Vec<String> {
    // The most particles that are allowed take minutes to be placed.
    let is_large =
        |name: &str, end: f64| ["n", "rows", "columns", "layers"].contains(&name) && end > 100.0;
    let of = |field: &Field| {
        let words = field.range.split(' ').filter(|word| word.parse::<f64>().is_ok());
        let name = field.name;
        words.map(move |end| (name, end)).collect::<Vec<_>>()
    };
    let ends = case.fields().iter().flat_map(of);
    let ends = ends.filter(|(name, end)| !is_large(name, end.parse().unwrap_or(0.0)));
    ends.map(|(name, end)| format!("{name}={end}")).collect()
}

/// Runs that are estimated to take less processor time than this are made to their end \[s\].
const TO_THE_END: f64 = 0.005;

/// Whether a run of these settings started after its estimate was printed; otherwise the refusal must name a
/// setting. A long run is stopped after its first step. Each metric of a record is finite.
fn is_begun(case: &dyn Case, variant: &str, set: &[String]) -> bool {
    let run = format!("{} {variant} {}", case.name(), set.join(" "));
    let (stop, told) = (AtomicBool::new(false), AtomicUsize::new(0));
    let tell = |size: &Size| {
        assert!(!size.is_too_much(), "{run} is begun, and is too much: {size}");
        told.fetch_add(1, Ordering::Relaxed);
        stop.store(size.seconds() > TO_THE_END, Ordering::Relaxed);
    };
    let context = Context { interrupt: Some(&stop), estimate: Some(&tell), ..Context::default() };
    let made = std::panic::catch_unwind(AssertUnwindSafe(|| {
        let spec = spec(case, variant, set)?;
        case.run(&RunSpec { allow_unstable: true, ..spec }, &context)
    }));
    match made.unwrap_or_else(|_| panic!("{run} panics, and should be refused or run")) {
        Err(error) => {
            let words = error.to_string();
            let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
            let names = || words.split(|letter| !is_part(letter));
            let is_named = case.fields().iter().any(|field| names().any(|name| name == field.name));
            assert!(is_named, "{run} is refused without the name of a setting: {words:?}");
            assert!(
                !words.contains("NaN"),
                "{run} is refused with NaN in place of a value: {words:?}"
            );
            false
        }
        Ok(record) => {
            let told = told.load(Ordering::Relaxed);
            let is_none = record.cost.steps == 0; // an experiment without a simulation
            assert!(told == 1 || is_none, "{run} told its size {told} times, expected once");
            for (name, metric) in &record.metrics {
                assert!(metric.value.is_finite(), "{run}: {name} is {}", metric.value);
            }
            true
        }
    }
}

/// Settings that make a run small and short, but for the one that is set.
fn small_but(case: &dyn Case, variant: &str, set: &str) -> Vec<String> {
    let end = case.fields().iter().find(|field| field.name == "end").and_then(|field| {
        let default = field.default.to_string().parse::<f64>().ok()?;
        Some(format!("end={}", (0.01 * default).max(field.limits[0])))
    });
    let key = |text: &str| text.split('=').next().map(String::from);
    let all = small(case, variant).into_iter().chain(end);
    let others = all.filter(|text| key(text) != key(set));
    others.chain([set.to_string()]).collect()
}

/// A step that was given was cut to 0.4 of it, so that runs reached each of their samples.
#[test]
fn a_given_step_is_taken_in_every_case() {
    let of_case = |case: &&'static dyn Case| {
        let (case, variant) = (*case, case.recommended().variant);
        let set = small(case, variant);
        let has_step = case.fields().iter().any(|field| field.name == "dt");
        // The number of the samples of the rings is a setting.
        if !has_step || case.name() == "rubber_rings" {
            return None;
        }
        let rules = spec(case, variant, &set).and_then(|spec| case.rules(&spec)).ok()?;
        let set = [set, vec![format!("dt={:?}", 0.97 * rules.dt_limit())]].concat();
        let spec = spec(case, variant, &set).unwrap();
        let record = case.run(&spec, &Context::default()).unwrap();
        let number = |name: &str| record.numerics[name].as_f64().unwrap();
        Some((case.name(), number("dt [s]") / number("dt [s] planned")))
    };
    let found: Vec<(&str, f64)> = touchstone_cases::CASES.par_iter().filter_map(of_case).collect();
    assert!(found.len() > 8, "{found:?}");
    let cut: Vec<_> = found.iter().filter(|(_, share)| *share < 0.9).collect();
    assert!(cut.is_empty(), "{cut:?}");
}

/// The ends of the range of each setting of each case, in each case's first and last variant: refused with
/// the name of a setting, or started after the estimate.
#[test]
fn the_ends_of_every_range_are_refused_or_run() {
    let of_case = |case: &&'static dyn Case| {
        let (variants, ends) = (case.variants(), ends(*case));
        let both = [variants.first(), variants.last()].into_iter().flatten().map(|v| v.name);
        let each = both.flat_map(|variant| ends.iter().map(move |end| (variant, end)));
        let with = |(variant, end): (&'static str, &String)| {
            (*case, variant, small_but(*case, variant, end))
        };
        each.map(with).collect::<Vec<_>>()
    };
    let all: Vec<(&dyn Case, &str, Vec<String>)> =
        touchstone_cases::CASES.iter().flat_map(of_case).collect();
    let begun = all.par_iter().filter(|(case, variant, set)| is_begun(*case, variant, set)).count();
    let refusals = all.len() - begun;
    assert!(begun > 200 && refusals > 50, "{begun} runs, {refusals} refusals");
}

/// Runs that are estimated to take more memory are not drawn \[bytes\].
const MOST_BYTES: f64 = 5e8;

/// Any settings are refused with words or run; the runs are stopped after a few steps.
#[test]
fn no_settings_make_a_run_panic() {
    let count = touchstone_cases::CASES.len();
    let drawn = (0..count).prop_flat_map(|case| {
        let set = prop::collection::vec(assignment(case), 0..4);
        (Just(case), any::<prop::sample::Index>(), set, any::<bool>())
    });
    let config = ProptestConfig { cases: 50 * count as u32, ..ProptestConfig::default() };
    // Number of runs of each case that started: a test of refusals only would be none.
    let begun: Vec<AtomicUsize> = (0..count).map(|_| AtomicUsize::new(0)).collect();
    let mut runner = TestRunner::new(config);
    let result = runner.run(&drawn, |(index, variant, mut set, allow_unstable)| {
        let case = touchstone_cases::CASES[index];
        let variants = case.variants();
        let variant = variants[variant.index(variants.len())].name;
        set.extend(small(case, variant)); // whatever came before
        let stop = AtomicBool::new(false);
        let context = Context { interrupt: Some(&stop), ..Context::default() };
        let run = |spec: RunSpec| {
            std::thread::scope(|scope| {
                scope.spawn(|| {
                    sleep(Duration::from_millis(5));
                    stop.store(true, Ordering::Relaxed);
                });
                case.run(&spec, &context)
            })
        };
        let size = |spec: &RunSpec| case.pose(spec)?.size(spec, Steps::All, false);
        let spec = spec(case, variant, &set).map(|spec| RunSpec { allow_unstable, ..spec });
        let bytes = spec.as_ref().map_or(0.0, |spec| size(spec).map_or(0.0, |size| size.bytes()));
        if bytes > MOST_BYTES {
            return Ok(()); // a machine of tests may not have the 4 GB of the largest run
        }
        match spec.and_then(run) {
            Err(error) => prop_assert!(error.to_string().len() > 10),
            Ok(record) => {
                begun[index].fetch_add(1, Ordering::Relaxed);
                prop_assert_eq!(&record.run.settings, &case.settings(variant, &set).unwrap());
                let text = record.to_json();
                prop_assert!(text.is_ok(), "{:?}", text);
            }
        }
        Ok(())
    });
    result.unwrap();
    for (case, begun) in touchstone_cases::CASES.iter().zip(&begun) {
        let begun = begun.load(Ordering::Relaxed);
        assert!(begun >= 3, "{}: {begun} runs got past the refusals", case.name());
    }
}

proptest! {
    /// Texts that are no assignments.
    #[test]
    fn no_text_makes_settings_panic(set in prop::collection::vec(".{0,40}", 0..4)) {
        let _ = touchstone_cases::CASES[0].settings("seed", &set);
    }
}

/// Seventeen commands were listed, of which five were modes of others.
#[test]
fn thirteen_commands_are_listed_and_earlier_names_say_the_new_one() {
    let help = stdout(&touchstone(&["--help"]));
    let listed = help.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let names = listed.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let names: Vec<&str> = names.filter(|name| !["", "help"].contains(name)).collect();
    assert!(names.len() <= 13, "{names:?}");
    for (old, new) in [
        ("judge --store records --any-build", "verify --no-runs"),
        ("challenge couette --seed 1 --method m --out o", "export --sealed"),
        ("relate couette a b --map x=X", "symmetry CASE --results"),
    ] {
        let output = touchstone(&old.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(2), "{old}");
        assert!(stderr(&output).contains(&format!("is `touchstone {new}")), "{}", stderr(&output));
    }
}
