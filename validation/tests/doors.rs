//! Robustness: malformed specs, damaged stores, signals, full disks.

#![cfg(unix)]

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use touchstone_base::record::Record;

use crate::common::{TOUCHSTONE, names, said, send, touchstone};

/// The program by way of a shell, after these words.
fn by_shell(folder: &Path, before: &str, line: &str) -> Command {
    let mut command = Command::new("sh");
    command.current_dir(folder).args(["-c", &format!("{before}; exec {TOUCHSTONE} {line}")]);
    command
}

const SPEC: &str = r#"{"case":"couette","variant":"seed","settings":{"rows":8,"end":0.01}}"#;
const MAKE: &str = "run --specs specs --store store --threads 1";

/// Makes the runs of these lines.
fn make(folder: &Path, lines: &[&str]) -> Output {
    fs::write(folder.join("specs"), lines.join("\n")).unwrap();
    touchstone(folder, MAKE)
}

/// Every field is checked: 10^9 pictures, a resolution that is never reached, a variant that is a path.
#[test]
fn a_line_that_no_run_can_have_is_told_with_its_field_and_costs_no_other_line() {
    let couette = |variant: &str, settings: &str, rest: &str| {
        format!(r#"{{"case":"couette","variant":"{variant}","settings":{settings}{rest}}}"#)
    };
    let bisect = |setting: &str, resolution: &str| {
        let task = format!(
            r#","task":{{"bisect":{{"setting":"{setting}","guess":1,"unit":1,"resolution":{resolution}}}}}"#
        );
        couette("seed", "{}", &task)
    };
    let odd = [
        (couette("x/../../../../EVIL", "{}", ""), "letters, digits, - and _ (column "),
        (couette("sed", "{}", ""), "no variant of couette is called \"sed\" (did you mean seed?)"),
        (couette("seed", "null", ""), "null, expected an object of settings by name"),
        (
            couette("seed", "{\"re\":1,\"re\":2}", ""),
            "setting re is given twice, the first time as 1",
        ),
        (couette("seed", "{\"re\":-1}", ""), "setting re is \"-1\""),
        (couette("seed", "{\"ra\":1}", ""), "no setting is called \"ra\""),
        (bisect("dt", "0"), "task.bisect.resolution is 0.0; allowed is 1e-6 to 1"),
        (bisect("dt", "-1"), "task.bisect.resolution is -1.0"),
        (bisect("nothing", "0.1"), "no setting is called \"nothing\""),
        ("{".into(), "EOF while parsing an object (column 1)"),
    ];
    for (line, words) in odd {
        let folder = tempfile::tempdir().unwrap();
        let output = make(folder.path(), &[SPEC, "", &line]);
        let message = said(&output);
        assert_eq!(output.status.code(), Some(2), "{line}: {message}");
        assert!(
            message.contains("line 3 of specs: ") && message.contains(words),
            "{line}: {message}"
        );
        assert_eq!(names(folder.path()), ["specs", "store"], "{line}");
        assert_eq!(names(&folder.path().join("store")).len(), 1, "{line}: {message}");
    }
}

/// The estimate itself made the scene: 11 GB, and then no other run was made.
#[cfg(target_os = "linux")]
#[test]
fn a_scene_that_is_too_large_is_counted_and_not_made() {
    let folder = tempfile::tempdir().unwrap();
    let large = r#"{"case":"couette","variant":"seed","settings":{"rows":2000,"columns":100000}}"#;
    fs::write(folder.path().join("specs"), format!("{large}\n{SPEC}\n")).unwrap();
    let output = by_shell(folder.path(), "ulimit -v 2000000", MAKE).output().unwrap();
    let message = said(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("2 runs in 2 lines: 1 completed, 0 diverged, 1 refused"), "{message}");
}

/// "5.89·10⁹ time steps of 0 particles", with advice to change settings that the case lacks.
#[test]
fn a_run_that_is_too_long_is_told_with_its_particles_and_settings() {
    let folder = tempfile::tempdir().unwrap();
    for (case, particles) in [
        ("elastic_bar --variant seed --set end=1e5", 240.0),
        ("spinning_disk --variant seed --set end=1e4", 201.0),
    ] {
        let message = said(&touchstone(folder.path(), &format!("run {case}")));
        let count = message.split(" time steps of ").nth(1).and_then(|rest| rest.split(' ').next());
        let count: f64 = count.and_then(|count| count.parse().ok()).expect(&message);
        assert!((count / particles - 1.0_f64).abs() < 0.1, "{particles} particles: {message}");
        assert!(message.trim_end().ends_with("change end, dt or n"), "{message}");
    }
}

#[test]
fn a_damaged_and_an_older_record_are_told_by_name_and_made_again() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(make(folder.path(), &[SPEC]).status.code(), Some(0));
    let [name] = &names(&folder.path().join("store"))[..] else { panic!("one record") };
    let path = folder.path().join("store").join(name);
    let whole = fs::read_to_string(&path).unwrap();
    let odd = [
        (
            whole.replace("\"schema\": 3", "\"schema\": 2"),
            "schema 2 and was made by an older version",
        ),
        (whole.replacen("\"value\": ", "\"value\": 1", 1), "it was damaged or changed"),
        (whole[..whole.len() / 2].into(), "the record cannot be read"),
    ];
    for (text, words) in odd {
        fs::write(&path, text).unwrap();
        let output = touchstone(folder.path(), MAKE);
        let message = said(&output);
        assert_eq!(output.status.code(), Some(0), "{message}");
        assert!(message.contains(words) && message.contains(name), "{words}: {message}");
        assert!(message.contains("0 of them were in the store before"), "{message}");
        Record::from_json(&fs::read_to_string(&path).unwrap()).expect("it is whole again");
    }
}

/// Opening a pipe must not block.
#[test]
fn a_pipe_in_place_of_a_record_is_told_and_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(make(folder.path(), &[SPEC]).status.code(), Some(0));
    let path = folder.path().join("store").join(&names(&folder.path().join("store"))[0]);
    fs::remove_file(&path).unwrap();
    assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
    for line in [MAKE, "compare store store"] {
        if line != MAKE {
            fs::remove_file(&path).unwrap();
            assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        }
        let mut command = Command::new(TOUCHSTONE);
        command.current_dir(folder.path()).args(line.split(' ')).stdout(Stdio::null());
        let (code, message) = ended(command.stderr(Stdio::piped()).spawn().unwrap(), 20.0);
        assert!(message.contains("not a regular file"), "{line}: {code:?} {message}");
    }
}

/// `compare`, `explain`, `run --out` and `run --resume` must not block on a pipe.
#[test]
fn a_pipe_in_place_of_what_a_run_or_a_report_left_is_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["verdicts.json", "record.json", "checkpoint"] {
        assert!(Command::new("mkfifo").arg(folder.path().join(name)).status().unwrap().success());
    }
    let not_regular = "not a regular file";
    for (line, exit, words) in [
        ("compare . .", 2, not_regular),
        ("explain couette --reports .", 2, not_regular),
        ("explain --status fail --reports .", 2, not_regular),
        ("run --resume .", 2, not_regular),
        (
            "run couette --variant seed --rows 8 --set end=0.01 --out . --overwrite",
            2,
            "there is no regular file of this name",
        ),
    ] {
        let mut command = Command::new(TOUCHSTONE);
        command.current_dir(folder.path()).args(line.split(' ')).stdout(Stdio::null());
        let (code, message) = ended(command.stderr(Stdio::piped()).spawn().unwrap(), 20.0);
        assert_eq!(code, Some(exit), "{line}: {message}");
        assert!(message.contains(words), "{line}: {message}");
    }
}

/// Two reports whose verdicts were damaged were compared without them: "nothing changed".
#[test]
fn verdicts_that_cannot_be_read_are_told_and_not_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(make(folder.path(), &[SPEC]).status.code(), Some(0));
    fs::create_dir(folder.path().join("report")).unwrap();
    fs::rename(folder.path().join("store"), folder.path().join("report/records")).unwrap();
    assert_eq!(touchstone(folder.path(), "compare report report").status.code(), Some(0));
    fs::write(folder.path().join("report/verdicts.json"), b"{\"tier\": \"quick\xff").unwrap();
    for line in ["compare report report", "explain couette --reports report"] {
        let output = touchstone(folder.path(), line);
        let message = said(&output);
        assert_eq!(output.status.code(), Some(2), "{line}: {message}");
        assert!(message.contains("cannot read report/verdicts.json"), "{line}: {message}");
    }
}

/// A figure of runs that were missing was empty, which was called a bug of the program.
#[test]
fn a_report_of_older_records_fails_its_gates_and_is_no_bug() {
    let folder = tempfile::tempdir().unwrap();
    let plan = touchstone(folder.path(), "plan couette");
    let plan = String::from_utf8(plan.stdout).unwrap();
    let is_small = |line: &&str| line.contains("\"rows\":10,");
    let line = plan.lines().find(is_small).expect("a run of 10 rows");
    assert_eq!(make(folder.path(), &[line]).status.code(), Some(0));
    let path = folder.path().join("store").join(&names(&folder.path().join("store"))[0]);
    let whole = fs::read_to_string(&path).unwrap();
    // As it was before records had a digest.
    let (head, _) = whole.rsplit_once(",\n  \"digest\"").expect("a digest");
    fs::write(&path, head.replace("\"schema\": 3", "\"schema\": 2") + "\n}\n").unwrap();
    submit_as(folder.path(), "[a](javascript:alert%281%29) *b* `c` <i>");
    for (line, exit) in [
        ("verify --no-runs couette --store store", 1),
        ("report --store store --out report", 1),
        ("compare store store", 2),
    ] {
        let output = touchstone(folder.path(), line);
        let message = said(&output);
        assert_eq!(output.status.code(), Some(exit), "{line}: {message}");
        assert!(message.contains("made by an older version"), "{line}: {message}");
    }
    let page = fs::read_to_string(folder.path().join("report/index.html")).unwrap();
    assert!(
        page.contains(">[a](javascript:alert%281%29) *b* `c` &lt;i&gt; "),
        "a name is plain text"
    );
    assert!(!page.contains("href=\"javascript"));
}

/// Puts results of a code of this name into the store of a folder.
fn submit_as(folder: &Path, name: &str) {
    let export = "export couette --variant seed --set rows=8 --set end=0.1 --solve --out own";
    assert!(touchstone(folder, export).status.success());
    let method = folder.join("own/method.json");
    let text = fs::read_to_string(&method).unwrap();
    fs::write(&method, text.replace("\"touchstone\"", &format!("\"{name}\""))).unwrap();
    let submitted = touchstone(folder, "submit couette own --store store"); // no gate judges it
    assert!(said(&submitted).contains("store/submitted-couette-seed-"), "{}", said(&submitted));
}

/// Waits for a child for up to `seconds` \[s\]; returns its exit code and its output.
fn ended(mut child: Child, seconds: f64) -> (Option<i32>, String) {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() && start.elapsed().as_secs_f64() < seconds {
        sleep(Duration::from_millis(5));
    }
    let _ = child.kill(); // has no effect on a child that has ended
    let output = child.wait_with_output().unwrap();
    (output.status.code(), said(&output))
}

/// A signal ends commands, runs with many frames and long lists of specs within a second, with an exit code
/// other than 0.
#[test]
fn a_signal_ends_every_command_within_a_second() {
    let folder = tempfile::tempdir().unwrap();
    let lines: Vec<String> =
        (0..20_000).map(|k| SPEC.replace("0.01", &format!("0.01{k}"))).collect();
    fs::write(folder.path().join("specs"), lines.join("\n")).unwrap();
    let many: String = (2..=600).map(|k| format!(",{k}")).collect();
    let plan = format!("plan couette --set re=1{many} --set c0=1{many}");
    for (line, signal) in [
        (MAKE, "-INT"),
        (&plan, "-TERM"),
        ("stability --tier full", "-HUP"),
        ("verify couette poiseuille --store other", "-INT"),
        ("report --out report", "-TERM"),
        ("run couette --rows 200 --vtk 9999 --out out --set end=1e-4", "-INT"),
        ("run extremes --set n=400 --set steps=100000000 --allow-long", "-TERM"),
    ] {
        for delay in [30, 400] {
            let mut command = Command::new(TOUCHSTONE);
            command.current_dir(folder.path()).args(line.split(' ')).stdout(Stdio::null());
            let child = command.stderr(Stdio::piped()).spawn().unwrap();
            sleep(Duration::from_millis(delay));
            let start = Instant::now();
            send(signal, &child);
            let (code, message) = ended(child, 20.0);
            let (took, name) = (start.elapsed().as_secs_f64(), &line[..line.len().min(40)]);
            // Before it listens a signal ends it as the system does.
            let is_over = matches!(code, Some(130) | None);
            assert!(is_over, "{name} {signal} after {delay} ms: {code:?} {message}");
            assert!(took < 2.0, "{name} {signal} after {delay} ms: {took:.2} s, {message}");
        }
    }
    let is_part = |name: &String| name.contains("unfinished");
    let all: Vec<PathBuf> =
        ["", "out/vtk", "store", "other", "report"].map(|at| folder.path().join(at)).into();
    let parts = all.iter().flat_map(|path| names(path)).filter(is_part);
    assert_eq!(parts.collect::<Vec<_>>(), Vec::<String>::new());
}

/// Work to which a first signal gives 0.7 s ends at once by a second one, without the message of the first.
#[test]
fn a_second_signal_does_not_wait() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    let mut command = Command::new(TOUCHSTONE);
    command.current_dir(folder.path()).args("report --store empty --out out".split(' '));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    lines.find(|line| line.contains("the store lacks")).expect("it has begun to judge");
    send("-INT", &child);
    lines.find(|line| line.contains("interrupt once more to end at once")).expect("it listens");
    send("-INT", &child);
    let rest: Vec<String> = lines.collect();
    assert_eq!((child.wait().unwrap().code(), rest), (Some(130), Vec::new()));
}

#[test]
fn the_last_setting_of_a_sweep_is_the_fastest() {
    let folder = tempfile::tempdir().unwrap();
    let output = touchstone(folder.path(), "plan couette --set re=1,2 --set rows=10,20");
    let text = String::from_utf8(output.stdout).unwrap();
    let number = |line: &str, name: &str| {
        let rest = line.split(&format!("\"{name}\":")).nth(1).expect(name);
        rest.split([',', '}']).next().unwrap().parse::<f64>().unwrap()
    };
    let all: Vec<_> = text.lines().map(|line| (number(line, "re"), number(line, "rows"))).collect();
    assert_eq!(all, [(1.0, 10.0), (1.0, 20.0), (2.0, 10.0), (2.0, 20.0)]);
}

/// `nohup touchstone …` ended with the terminal.
#[test]
fn the_end_of_the_terminal_is_ignored_if_nohup_asks_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let line = "run couette --variant seed --rows 60 --threads 1";
    for (before, expected) in [("trap '' HUP", Some(0)), ("true", Some(130))] {
        let mut command = by_shell(folder.path(), before, line);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        sleep(Duration::from_millis(300));
        send("-HUP", &child);
        let (code, message) = ended(child, 60.0);
        assert_eq!(code, expected, "{before}: {message}");
    }
}

/// The process was ended by the system, and a part of a file was left.
#[test]
fn a_limit_of_the_size_of_files_is_told_and_leaves_no_part() {
    let folder = tempfile::tempdir().unwrap();
    let line = "run couette --variant seed --rows 8 --set end=0.01 --out out";
    let output = by_shell(folder.path(), "ulimit -f 1", line).output().unwrap();
    let message = said(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("cannot write the file \"out/record.json\""), "{message}");
    assert_eq!(names(&folder.path().join("out")), Vec::<String>::new());
    let printed = String::from_utf8(output.stdout).unwrap();
    Record::from_json(&printed).expect("what was computed is printed");
}

/// One frame that could not be written ended the run and lost it.
#[test]
fn a_run_with_a_frame_that_cannot_be_written_has_its_record_and_ends_with_2() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("out/vtk/particles_0001.vtu/in the way")).unwrap();
    let line = "run couette --variant seed --rows 8 --set end=0.01 --out out --vtk 3";
    let output = touchstone(folder.path(), line);
    let message = said(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    for words in ["particles_0001.vtu", "the run goes on", "frames or checkpoints not written: 1"] {
        assert!(message.contains(words), "{words}: {message}");
    }
    let record = fs::read_to_string(folder.path().join("out/record.json")).unwrap();
    Record::from_json(&record).expect("the record of a run that went on");
}

/// A checkpoint that cannot be written names the last one that could, from which the run can continue.
#[test]
fn a_checkpoint_that_cannot_be_written_names_the_last_good_one() {
    let folder = tempfile::tempdir().unwrap();
    let line = "run dam_break --set n=80 --threads 1 --out out --checkpoint-every 1";
    let mut command = Command::new(TOUCHSTONE);
    command.current_dir(folder.path()).args(line.split(' ')).stdout(Stdio::null());
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let out = folder.path().join("out");
    let start = Instant::now();
    while !out.join("checkpoint").exists() && start.elapsed() < Duration::from_secs(60) {
        sleep(Duration::from_millis(5));
    }
    // The folder is missing, so nothing can be written.
    fs::rename(&out, folder.path().join("kept")).unwrap();
    fs::write(&out, "in the way").unwrap();
    let told = lines.find(|line| line.contains("the run goes on"));
    fs::remove_file(&out).unwrap();
    fs::rename(folder.path().join("kept"), &out).unwrap();
    let told = told.expect("a line that says that the run goes on");
    assert!(told.contains("the last good checkpoint is "), "{told}");
    let rest: Vec<String> = lines.collect();
    assert_eq!(child.wait().unwrap().code(), Some(2), "{rest:?}");
    assert!(names(&out).contains(&"record.json".to_string()), "{:?}", names(&out));
}

/// The escape characters of a spec and of arguments reached the terminal.
#[test]
fn control_characters_are_shown_and_not_sent_to_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let escape = "\u{1b}]0;title\u{7}\u{9b}2J";
    let unknown = SPEC.replace("settings", r"\u001b]0;title\u0007\u009b2J");
    fs::write(folder.path().join("specs"), format!("{unknown}\n{escape}\n")).unwrap();
    fs::create_dir(folder.path().join("out")).unwrap();
    fs::write(folder.path().join("out/checkpoint"), escape).unwrap();
    let verdicts = r#"{"tier":"quick","commit":"","counts":{},"runs":[],"studies":[]}"#;
    fs::write(folder.path().join("verdicts.json"), verdicts).unwrap();
    for line in [
        MAKE.to_string(),
        "run --resume out".into(),
        format!("run {escape}"),
        format!("run couette --variant {escape}"),
        format!("run couette --set {escape}=1"),
        format!("run couette --set re={escape}"),
        format!("run couette --rows {escape}"),
        format!("run --{escape}"),
        format!("run couette --vtk {escape}"),
        format!("plan couette --set re={escape}"),
        format!("verify --no-runs --store {escape}"),
        format!("explain {escape} --reports ."),
        format!("compare {escape} {escape}"),
    ] {
        let output = touchstone(folder.path(), &line);
        let text = said(&output) + &String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(2), "{line:?}: {text:?}");
        let sent: Vec<char> = text.chars().filter(|c| c.is_control() && *c != '\n').collect();
        assert_eq!(sent, [], "{line:?}: {text:?}");
        assert!(!text.is_empty(), "{line:?}");
    }
}

#[test]
fn a_setting_that_is_given_twice_and_a_sweep_without_end_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let values: String = (1..=400).map(|k| format!(",{k}")).collect();
    let cube = ["re", "rows", "c0"].map(|key| format!(" --set {key}=1{values}")).concat();
    for (line, words) in [
        (
            "run couette --set re=1 --set re=2".to_string(),
            "re is given twice, as \"1\" and as \"2\"",
        ),
        ("plan couette --set re=1,3 --set re=2".into(), "re is given twice, as \"1\" and as \"2\""),
        (format!("plan couette{cube}"), "the sweep has 6.45·10⁷ runs; allowed are at most 1000000"),
        ("run --specs nofile --store s".into(), "cannot read nofile: No such file"),
        ("run --specs . --store s".into(), "cannot read .: Is a directory"),
    ] {
        let output = touchstone(folder.path(), &line);
        let message = said(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(words), "{words}: {message}");
    }
    assert_eq!(names(folder.path()), Vec::<String>::new());
}
