//! Limits of sizes, and safe handling of folders, paths and files, for `export`, `submit`, `symmetry` and
//! others.

#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{TOUCHSTONE, names, said, touchstone};

/// Lines of a shell, to which `touchstone` is the program.
fn shell(folder: &Path, lines: &str) -> Output {
    let lines = format!("touchstone() {{ {TOUCHSTONE} \"$@\"; }}\n{lines}");
    Command::new("sh").current_dir(folder).args(["-c", &lines]).output().unwrap()
}

fn made(folder: &Path, line: &str) {
    let output = touchstone(folder, line);
    assert!(output.status.success(), "{line}: {}", said(&output));
}

/// The command ends with 2 and this message.
fn refused(folder: &Path, line: &str, words: &str) {
    let output = touchstone(folder, line);
    let message = said(&output);
    assert!(
        output.status.code() == Some(2) && message.contains(words),
        "{line}: expected {words:?} in {message}"
    );
}

fn edit(file: &Path, edit: impl Fn(&str) -> String) {
    let text = fs::read_to_string(file).unwrap();
    let edited = edit(&text);
    assert!(edited != text, "{}", file.display());
    fs::write(file, edited).unwrap();
}

/// `run` refused them, and these made particles until the memory was full, or steps for years.
#[cfg(target_os = "linux")]
#[test]
fn what_is_too_large_for_a_run_is_too_large_for_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (out, relation) in
        [("one", ""), ("same", " --relation same"), ("other", " --relation shifted")]
    {
        let small = "export couette --set rows=8 --set columns=16 --set end=0.001 --solve";
        made(at, &format!("{small} --out {out}{relation}"));
        edit(&at.join(out).join("problem.json"), |text| {
            text.replace("\"rows\": 8", "\"rows\": 2000")
                .replace("\"columns\": 16", "\"columns\": 100000")
        });
    }
    for line in [
        "export couette --set rows=2000 --set columns=100000 --out o",
        "export rubber_rings --set spacing=1e-3 --out o",
        "export cantilever --set n=1000 --out o",
        "export oscillating_plate --set n=1000 --out o",
        "export couette --solve --set rows=500 --set columns=2000 --out o",
        "export couette --solve --set end=100 --set rows=1000 --set columns=100 --out o",
        "symmetry couette --set rows=2000 --set columns=100000",
        "symmetry taylor_green --set n=2000",
        "submit couette one --check",
        "submit couette one --store o",
        "symmetry couette --results same other",
    ] {
        let output = shell(at, &format!("ulimit -v 2000000 -t 60; touchstone {line}"));
        let message = said(&output);
        assert_eq!(output.status.code(), Some(2), "{line}: {message}");
        assert!(message.contains("without --allow-long at most 24.0"), "{line}: {message}");
        assert!(!at.join("o").exists(), "{line}");
    }
}

/// An export must not leave scripts and results of another case with its problem, and must not replace
/// foreign files.
#[test]
fn an_export_neither_mixes_problems_nor_replaces_what_is_not_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let (at, out) = (folder.path(), folder.path().join("o"));
    let first =
        "export couette --variant interface-wall --format pysph --set rows=8 --set end=0.01";
    made(at, &format!("{first} --solve --out o"));
    let all = names(&out);
    let line = "export taylor_green --out o";
    refused(at, line, "holds another problem in problem.json");
    refused(at, "export couette --variant interface-wall --set rows=10 --out o", "another problem");
    made(at, &format!("{first} --solve --out o")); // once more
    assert_eq!(names(&out), all);
    let particles = out.join("particles.csv");
    let own = fs::read_to_string(&particles).unwrap();
    fs::write(&particles, own.replacen('1', "2", 1)).unwrap();
    refused(at, &format!("{first} --out o"), "holds another particles.csv");
    fs::write(&particles, own).unwrap();
    fs::write(out.join("run_pysph.py"), "mine").unwrap();
    refused(at, &format!("{first} --out o"), "holds another run_pysph.py");
    made(at, &format!("{first} --out o --overwrite"));
    assert_eq!(names(&out), all, "it is the same problem");
    fs::write(out.join("method.json"), "mine").unwrap();
    refused(at, &format!("{first} --solve --out o"), "holds another method.json");
    refused(
        at,
        "export taylor_green --sealed 1 --method o/method.json --out o",
        "no submission can have this method",
    );
    made(at, &format!("{line} --overwrite"));
    assert_eq!(names(&out), ["README.md", "particles.csv", "problem.json"]);
    for name in ["results.csv", "curve.csv", "system.json"] {
        let other = at.join(name.replace('.', "-"));
        fs::create_dir(&other).unwrap();
        fs::write(other.join(name), "mine").unwrap();
        let line = format!("{first} --solve --out {}", other.display());
        refused(at, &line, &format!("holds another {name}"));
        assert_eq!(names(&other), [name], "nothing was written");
        assert_eq!(fs::read(other.join(name)).unwrap(), b"mine");
    }
}

/// Any text was sealed, though no submission can have it for its method.
#[test]
fn a_challenge_takes_a_method_that_a_submission_can_have() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    made(at, "export couette --set rows=8 --set end=0.001 --solve --out own");
    fs::copy(at.join("own/method.json"), at.join("m")).unwrap();
    let line = "export couette --sealed 1 --method m --out o";
    made(at, line);
    fs::remove_dir_all(at.join("o")).unwrap();
    let whole = fs::read_to_string(at.join("m")).unwrap();
    for (text, words) in [
        (String::new(), "EOF"),
        ("[]".into(), "invalid length"),
        ("<script>".into(), "expected value"),
        (whole.replace("closed", "ajar"), "unknown variant `ajar`"),
        (whole.replace("\"touchstone\"", "\"\""), "expected 1 to 100 visible characters"),
        (whole.replace("\"touchstone\"", "\"a\\u202eb\""), "\\u{202e}"),
        // Names that read as another's: a blank at an end or two in a row, Cyrillic, a mark on a letter.
        (whole.replace("\"touchstone\"", "\"touchstone \""), "single blanks between words"),
        (whole.replace("\"touchstone\"", "\" PySPH\""), "single blanks between words"),
        (whole.replace("\"touchstone\"", "\"my  code\""), "single blanks between words"),
        (whole.replace("\"touchstone\"", "\"t\u{43e}uchstone\""), "\\u{43e}"),
        (whole.replace("\"touchstone\"", "\"touchstone\u{323}\""), "characters of ASCII"),
        (whole.replace("\"touchstone\"", "\"a\u{a0}b\""), "characters of ASCII"),
        (whole.replace("\"touchstone\"", "\"Touchstone\""), "touchstone in lower case"),
    ] {
        fs::write(at.join("m"), text).unwrap();
        refused(at, line, words);
        assert!(!at.join("o").exists(), "{words}");
    }
}

/// All positions at 1e16 are equal after the subtraction of whole periods; after 70,000 steps round-off would
/// exceed 10⁻⁶ h, and errors of this size would pass. Both are refused.
#[test]
fn observers_are_not_compared_where_round_off_would_hide_every_error() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (by, out) in [("same", "same"), ("shifted", "other")] {
        made(
            at,
            &format!(
                "export taylor_green --variant plain --set n=8 --solve --relation {by} --out {out}"
            ),
        );
    }
    let line = "symmetry taylor_green --results same other";
    made(at, line);
    for side in ["same", "other"] {
        let file = at.join(side).join("results.csv");
        let whole = fs::read_to_string(&file).unwrap();
        let (head, rows) = whole.split_once('\n').unwrap();
        let of_first = |column: usize, value: &str| {
            let (row, others) = rows.split_once('\n').unwrap();
            let mut cells: Vec<&str> = row.split(',').collect();
            cells[column] = value;
            fs::write(&file, format!("{head}\n{}\n{others}", cells.join(","))).unwrap();
        };
        for (column, value) in [(2, "1e16"), (3, "-1e20"), (2, "1e300"), (3, "2e6")] {
            of_first(column, value);
            refused(at, line, "results.csv, line 2: particle 0 is at ");
        }
        of_first(2, "3.5");
        assert_eq!(touchstone(at, line).status.code(), Some(1), "a few periods are subtracted");
        fs::write(&file, whole).unwrap();
        let system = at.join(side).join("system.json");
        let whole = fs::read_to_string(&system).unwrap();
        edit(&system, |text| text.replace("\"steps\": \"unknown\"", "\"steps\": 70000"));
        refused(at, line, &format!("{side}: steps of system.json is 70000"));
        edit(&system, |text| text.replace("70000", "1000"));
        made(at, line);
        fs::write(&system, whole).unwrap();
    }
    made(at, line);
}

/// As root, `--estimates /dev/null` made a file of the device, for all programs.
#[test]
fn pipes_are_written_into_and_links_followed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    assert!(shell(at, "mkfifo pipe; echo old >target").status.success());
    symlink("target", at.join("link")).unwrap();
    let plan = "touchstone plan couette --set re=1 --estimates";
    let read = shell(
        at,
        &format!("cat pipe >got & {plan} pipe >out || exit 9; wait; {plan} /dev/stdout | cat"),
    );
    assert!(read.status.success(), "{}", said(&read));
    let got = fs::read_to_string(at.join("got")).unwrap();
    assert!(
        got.starts_with("index") && String::from_utf8_lossy(&read.stdout).contains("index"),
        "{got}"
    );
    made(at, "plan couette --set re=1 --estimates link");
    assert!(at.join("link").is_symlink());
    assert_eq!(fs::read_to_string(at.join("target")).unwrap(), got);
    refused(at, "plan couette --set re=1 --estimates pipe", "a pipe that nobody reads");
    assert!(at.join("pipe").symlink_metadata().unwrap().file_type().is_fifo());
    refused(at, "verify --no-runs elastic_bar --store . --junit pipe", "a pipe that nobody reads");
    symlink("nowhere", at.join("lost")).unwrap();
    refused(at, "verify --no-runs elastic_bar --store . --junit lost", "a link that leads nowhere");
    symlink("../precious", at.join("o")).unwrap();
    fs::create_dir(at.join("run")).unwrap();
    symlink("../target", at.join("run/record.json")).unwrap();
    refused(
        at,
        "run couette --set rows=8 --set end=0.01 --out run",
        "a link of this name; remove it",
    );
    assert_eq!(
        fs::read_to_string(at.join("target")).unwrap(),
        got,
        "it is not led out of its folder"
    );
}

/// The sign that a run is under way emptied the file that a link of its name led to, and waited at a pipe.
#[test]
fn a_store_leads_to_no_file_outside_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let (at, store) = (folder.path(), folder.path().join("store"));
    let plan = touchstone(at, "plan couette --variant seed --set rows=8 --set end=0.01");
    fs::write(at.join("plan"), [&b"\xef\xbb\xbf"[..], &plan.stdout].concat()).unwrap(); // a byte order mark
    let line = "run --specs plan --store store --threads 1";
    made(at, line);
    let record = names(&store).pop().unwrap();
    let sign = store.join(format!(".begun-{record}"));
    fs::write(at.join("precious"), "mine").unwrap();
    for target in ["../precious", "../new"] {
        fs::remove_file(store.join(&record)).unwrap();
        symlink(target, &sign).unwrap();
        made(at, line);
        assert!(sign.is_symlink() && store.join(&record).is_file());
        fs::remove_file(&sign).unwrap();
    }
    assert_eq!(fs::read_to_string(at.join("precious")).unwrap(), "mine");
    assert!(!at.join("new").exists());
    fs::remove_file(store.join(&record)).unwrap();
    let with_pipe = format!("mkfifo store/.begun-{record}; timeout 60 {TOUCHSTONE} {line}");
    assert_eq!(shell(at, &with_pipe).status.code(), Some(0), "it waits at a pipe");
    fs::remove_file(store.join(&record)).unwrap();
    symlink("../precious", store.join(&record)).unwrap();
    refused(at, line, "a link of this name; remove it");
    assert_eq!(fs::read_to_string(at.join("precious")).unwrap(), "mine");
}

/// Limits of threads in the environment cause a documented exit code, not a signal.
#[cfg(target_os = "linux")]
#[test]
fn threads_that_cannot_be_started_are_told_with_what_to_change() {
    let folder = tempfile::tempdir().unwrap();
    let run = "touchstone run couette --variant seed --set rows=8 --set end=0.01";
    for (lines, exit, words) in [
        (format!("RUST_MIN_STACK=99999999999999 {TOUCHSTONE} list"), 0, ""),
        (format!("export RUST_MIN_STACK=1; {run}"), 0, ""),
        (
            format!("ulimit -v 1000000; export RAYON_NUM_THREADS=1000; {run}"),
            2,
            "cannot be started (1000)",
        ),
        (format!("ulimit -v 1000000; {run} --threads 1000"), 2, "ask for fewer by --threads N"),
    ] {
        let output = shell(folder.path(), &lines);
        let message = said(&output);
        assert!(
            output.status.code() == Some(exit) && message.contains(words),
            "{lines}: {message}"
        );
    }
}
