//! Tests of commands on an artificial case, whose runs end as their variant states.

mod documents;

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Parser;
use serde_json::{Value, json};
use touchstone_base::{
    files::OutputFolder,
    gate::{Bound, Cause, Evidence, Gate, Verdict},
    record::{MetricKey, Record, Status},
    reference::Reference,
    settings::Field,
    spec::RunSpec,
};
use touchstone_cases::page;
use touchstone_harness::{
    case::{self, Case, Planned, Recommended, RunError, Tier, Variant},
    context::Context,
    gates::GateIndex,
    looks::look_of,
    make::{self, BatchOptions, BatchResult},
    runs::{Judged, Runs},
    section::Section,
    store::Store,
    studies::{Accuracy, Card, CustomStudy, Studies},
    suite::{self, Suite},
};
use touchstone_report::{Page, check_page};

use super::{
    Exit, Session, WrongReference, arguments::Arguments, checkpoint::ResumableRun, conclude,
    dispatch, judged::Verdicts, partial,
};

/// A case whose variants are the ways in which a run can end.
struct Staged {
    name: &'static str,
    planned: &'static [&'static str],
}

fn gate(of: &str, metric: &str) -> Gate {
    let because = "the error of a run that is staged is 1";
    Gate::new(format!("staged.{of}.{metric}"), metric, Bound::Below(2.0), Evidence::Theory, because)
}

impl Case for Staged {
    fn family(&self) -> &'static str {
        ""
    }
    fn recommended(&self) -> Recommended {
        Recommended { variant: "right", because: "it is staged", papers: None }
    }
    fn name(&self) -> &'static str {
        self.name
    }

    fn problem(&self) -> &'static str {
        "Nothing moves"
    }
    fn about(&self) -> &'static str {
        "Nothing moves."
    }

    fn variants(&self) -> Vec<Variant> {
        let variant = |name| Variant { name, about: "as it says" };
        ["right", "wrong", "diverging", "panicking", "stopping"].map(variant).to_vec()
    }

    fn fields(&self) -> &'static [Field] {
        &[]
    }

    fn settings(&self, variant: &str, set: &[String]) -> Result<Value, RunError> {
        let mut settings = json!({ "re": 1.0 });
        let known: Vec<&'static str> = self.variants().iter().map(|known| known.name).collect();
        if !known.contains(&variant) {
            let (what, name) = (format!("variant of {}", self.name), variant.into());
            return Err(RunError::Unknown { what, name, known });
        }
        for (key, value) in set.iter().filter_map(|text| text.split_once('=')) {
            settings[key] = value.parse::<f64>().map_or(value.into(), Value::from);
        }
        Ok(settings)
    }

    fn run(&self, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
        assert!(spec.variant != "panicking", "staged panic");
        if spec.variant == "stopping" {
            STOP.store(STOPS.swap(false, Ordering::Relaxed), Ordering::Relaxed);
        }
        let mut record = Record::of(spec, 1);
        if context.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            record.status = Status::Interrupted { step: 64, time: 0.1 };
            return Ok(record);
        }
        record.put(ERROR, if spec.variant == "wrong" { 3.0 } else { 1.0 });
        if spec.variant == "diverging" {
            let (field, value_text) = ("density".into(), "NaN".into());
            record.status = Status::Diverged { step: 7, time: 0.1, particle: 3, field, value_text };
        }
        Ok(record)
    }

    fn studies(&self, _: Tier) -> Studies {
        let set = ["re=1".to_string()];
        let spec = |variant: &str| case::spec(self, variant, &set).expect("staged settings");
        let planned = |variant: &&str| {
            let name = format!("{}.{variant}", self.name);
            let planned = Planned::new(spec(variant)).judged(vec![gate(&name, "error")]);
            Planned { timed: self.name == "timed", ..planned }
        };
        let runs: Vec<Planned> = self.planned.iter().map(planned).collect();
        let card = || Card::made_up(ERROR, vec![spec("right")]);
        let (name, card) = (self.name, (self.name == "main").then(card));
        let section = move |runs: &Runs| {
            let count = runs.all.len() as f64;
            let id = format!("{name}-count");
            let section = Section::new(&id, "How many").prose("Runs are counted.");
            section.judge(gate(name, "count"), count)
        };
        let count = CustomStudy { runs: runs.clone(), section };
        Studies::judging(runs).with(count).with_all(card)
    }
}

const ERROR: MetricKey = MetricKey::new("error", "-", "as staged");

/// Records of staged runs may be reused: they are all made by this build.
fn sources(_: &str) -> String {
    "staged".into()
}

static RIGHT: Staged = Staged { name: "right", planned: &["right"] };
static WRONG: Staged = Staged { name: "wrong", planned: &["right", "wrong"] };
static PANICKING: Staged = Staged { name: "panicking", planned: &["right", "panicking"] };
static DIVERGING: Staged = Staged { name: "diverging", planned: &["diverging"] };
static MAIN: Staged = Staged { name: "main", planned: &["right"] };
static TIMED: Staged = Staged { name: "timed", planned: &["right"] };
static STOPPING: Staged = Staged { name: "stopping", planned: &["stopping"] };
static ALL: [&dyn Case; 4] = [&RIGHT, &WRONG, &PANICKING, &DIVERGING];
static SOUND: [&dyn Case; 2] = [&RIGHT, &WRONG];
static NEVER: AtomicBool = AtomicBool::new(false);
/// A run of `stopping` sets the first if the second is set.
static STOP: AtomicBool = AtomicBool::new(false);
static STOPS: AtomicBool = AtomicBool::new(true);
static ALREADY: AtomicBool = AtomicBool::new(true);

/// Runs a command line on these cases; `OUT` in it is the folder `out`.
fn run_on(
    cases: &'static [&'static dyn Case],
    interrupt: &'static AtomicBool,
    line: &str,
    out: &Path,
) -> Exit {
    let line = line.replace("OUT", out.to_str().expect("a plain path"));
    let words = std::iter::once("touchstone").chain(line.split(' '));
    let arguments = Arguments::try_parse_from(words).expect("a sound command line");
    let session = Session { cases, sources, references: |_| vec![], interrupt };
    conclude(|| dispatch(&arguments.command, &session))
}

fn exit_with(interrupt: &'static AtomicBool, line: &str, out: &Path) -> Exit {
    run_on(&ALL, interrupt, line, out)
}

/// Commands that keep records keep them in a folder of their own.
fn exit(line: &str) -> Exit {
    let folder = tempfile::tempdir().expect("a folder");
    let keeps = line.starts_with("verify");
    let line = if keeps { format!("{line} --store OUT/records") } else { line.to_string() };
    exit_with(&NEVER, &line, folder.path())
}

#[test]
fn every_ending_of_a_run_has_its_exit_code() {
    assert_eq!(exit("run right --variant right"), Exit::Pass);
    assert_eq!(exit("run right --variant diverging"), Exit::Diverged);
    assert_eq!(exit("run right --variant panicking"), Exit::Bug);
    assert_eq!(exit("run none"), Exit::Usage);
    let out = tempfile::tempdir().expect("a folder");
    let line = "run right --variant right --out OUT/new";
    assert_eq!(exit_with(&ALREADY, line, out.path()), Exit::Interrupted);
    assert!(!out.path().join("new").exists(), "a folder without a result is removed again");
}

#[test]
fn a_run_of_the_plan_is_judged_and_another_one_is_not() {
    assert_eq!(exit("run wrong --variant wrong --set re=1"), Exit::GateFailed);
    assert_eq!(exit("run wrong --variant wrong --set re=2"), Exit::Pass);
}

#[test]
fn verify_ends_with_the_verdict() {
    assert_eq!(exit("verify right"), Exit::Pass);
    assert_eq!(exit("verify right wrong --tier full --threads 2"), Exit::GateFailed);
    // Its error was inside the bound until the divergence.
    assert_eq!(exit("verify diverging"), Exit::GateFailed);
    assert_eq!(exit("verify panicking"), Exit::Bug, "a panic on another thread is one too");
    let folder = tempfile::tempdir().expect("a folder");
    let line = "verify right --store OUT/records";
    assert_eq!(exit_with(&ALREADY, line, folder.path()), Exit::Interrupted);
}

/// Runs that were timed alone took half of the time of `verify couette` on 16 threads.
#[test]
fn verify_measures_seconds_only_on_request() {
    static OF: [&dyn Case; 1] = [&TIMED];
    let folder = tempfile::tempdir().expect("a folder");
    let timings = |line: &str| {
        assert_eq!(run_on(&OF, &NEVER, line, folder.path()), Exit::Pass, "{line}");
        let records = Store::all(&folder.path().join("records")).expect("a store");
        records.iter().map(|record| record.cost.alone_s.len()).collect::<Vec<_>>()
    };
    assert_eq!(timings("verify timed --store OUT/records"), [0]);
    assert_eq!(timings("verify timed --timings --store OUT/records"), [3]);
    assert_eq!(timings("verify timed --store OUT/records"), [3], "a timed run serves as well");
    assert_eq!(run_on(&OF, &NEVER, "report --out OUT", folder.path()), Exit::Pass);
}

/// An interrupt while a store is read must not judge the records read so far.
#[test]
fn an_interrupt_while_a_store_is_read_judges_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(exit_with(&NEVER, "verify right --store OUT/records", folder.path()), Exit::Pass);
    for line in [
        "verify right --no-runs --store OUT/records",
        "report --store OUT/records --out OUT/report",
        "explain right --reports OUT",
    ] {
        assert_eq!(exit_with(&ALREADY, line, folder.path()), Exit::Interrupted, "{line}");
    }
    for name in ["index.html", "verdicts.json"] {
        assert!(!folder.path().join("report").join(name).exists(), "{name}");
    }
}

#[test]
fn a_report_is_whole_and_explain_reads_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let in_folder = |line: &str| run_on(&SOUND, &NEVER, line, folder.path());
    assert_eq!(in_folder("report --out OUT"), Exit::GateFailed);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect(name);
    check_page(&read("index.html")).expect("a page that opens");
    let verdicts: Verdicts = serde_json::from_str(&read("verdicts.json")).expect("verdicts");
    assert_eq!((verdicts.runs.len(), verdicts.counts[&Verdict::Fail]), (3, 1));
    for run in &verdicts.runs {
        let name = format!("records/{}-{}-{}.json", run.case, run.variant, run.key);
        assert_eq!(
            Record::from_json(&read(&name)).expect("a record").run.key().to_string(),
            run.key
        );
    }
    for (gate, expected) in [
        ("staged.right.right.error", Exit::Pass),
        ("staged.right.count", Exit::Pass), // of a study: known from the report
        ("staged", Exit::Pass),
        ("staged.right.right.eror", Exit::Usage),
    ] {
        let line = format!("explain {gate} --reports OUT");
        assert_eq!(in_folder(&line), expected, "{gate}");
    }
}

/// A page without the time at which it was made.
fn undated(page: &str) -> String {
    let (before, rest) = page.split_once("Quick tier, ").expect("a tier");
    format!("{before}{}", rest.split_once(" UTC").expect("a time").1)
}

/// The page was there after the last run only, more than a minute after the first case was complete. Here the
/// case that has a card is planned last, and a run of another one stops the program.
#[test]
fn the_page_is_there_when_one_case_is_complete_and_ends_as_it_would_have_without() {
    static CASES: [&dyn Case; 3] = [&STOPPING, &WRONG, &MAIN];
    let folder = tempfile::tempdir().expect("a folder");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect(name);
    let line = "report --out OUT --threads 1";
    assert_eq!(run_on(&CASES, &STOP, line, folder.path()), Exit::Interrupted);
    let early = read("index.html");
    check_page(&early).expect("a page that opens");
    let words = "Not complete when this page was written:</strong> 1 of 3 cases complete; 3 runs without a \
                 record: 3 missing. Still to come: stopping, wrong.";
    assert!(early.contains(words), "{early}");
    let verdicts: Verdicts = serde_json::from_str(&read("verdicts.json")).expect("verdicts");
    assert_eq!(verdicts.counts.into_iter().collect::<Vec<_>>(), [(Verdict::Pass, 2)]);
    std::fs::remove_dir_all(folder.path().join("records")).expect("removed");
    STOP.store(false, Ordering::Relaxed);
    assert_eq!(run_on(&CASES, &STOP, line, folder.path()), Exit::GateFailed);
    let page = page::assemble(&judged(&CASES), "of old UTC");
    let expected = Page { made_from: "records".into(), ..page }.html();
    assert!(undated(&read("index.html")) == undated(&expected), "the page differs");
}

/// A case whose run diverges or fails is complete when all its runs have ended.
#[test]
fn a_run_that_fails_keeps_no_case_from_being_shown() {
    static CASES: [&dyn Case; 3] = [&DIVERGING, &PANICKING, &MAIN];
    let folder = tempfile::tempdir().expect("a folder");
    let session = Session { cases: &CASES, sources, references: |_| vec![], interrupt: &NEVER };
    let (plans, store) = (suite::plans(&CASES, Tier::Quick), Store::open(folder.path()));
    let (store, told) = (store.expect("a store"), Mutex::new(Vec::new()));
    let early = |made: BatchResult| {
        let (_, words) = partial::of_made(plans.clone(), Tier::Quick, folder.path(), made);
        told.lock().expect("sound").push(words);
        None
    };
    let making = BatchOptions { store: Some(&store), ..session.making(Tier::Quick) };
    let jobs = make::jobs(plans.clone());
    let made = session.make(&jobs, making, Some(1), Some(&early)).expect("made");
    assert_eq!((made.records.len(), made.failed.len()), (3, 1));
    let expected = [
        ("1 of 3 cases complete; 3 runs without a record: 3 missing", "diverging, panicking"),
        ("2 of 3 cases complete; 2 runs without a record: 2 missing", "panicking"),
        ("2 of 3 cases complete; 1 run without a record: 1 failed", "panicking"),
    ];
    let expected = expected.map(|(words, names)| Some([words, names].map(String::from)));
    assert_eq!(told.into_inner().expect("sound"), expected);
}

/// The runs took minutes: they are kept.
#[test]
fn a_page_that_may_not_open_is_told_and_kept() {
    static TWICE: [&dyn Case; 2] = [&RIGHT, &RIGHT]; // so are their anchors
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().to_str().expect("a plain path");
    let arguments = Arguments::try_parse_from(["touchstone", "report", "--out", out]);
    let session = Session { cases: &TWICE, sources, references: |_| vec![], interrupt: &NEVER };
    assert_eq!(conclude(|| dispatch(&arguments.expect("sound").command, &session)), Exit::Bug);
    let html = std::fs::read_to_string(folder.path().join("index.html")).expect("a page");
    assert!(check_page(&html).is_err_and(|reason| reason.contains("used twice")));
}

/// One number of a table was changed, and is none.
fn changed(cases: &[&str]) -> Vec<WrongReference> {
    const USERS: &[&str] = &["right"];
    if !cases.contains(&"right") {
        return vec![];
    }
    let package = include_str!("../../../references/cavity/datapackage.json");
    let table =
        include_str!("../../../references/cavity/lines.csv").replacen("0.0547", "0.O547", 1);
    let published = include_str!("../../../references/cavity/published.csv");
    let tables = [("lines.csv", table.as_str()), ("published.csv", published)];
    let refused = Reference::from_texts("cavity", package, &tables);
    refused.err().into_iter().map(|error| (error, USERS)).collect()
}

/// Some tables could be changed and every gate passed; others failed gates that did not name the table.
#[test]
fn a_changed_table_fails_every_case_that_uses_it_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().to_str().expect("a plain path");
    let spec = case::spec(&RIGHT, "right", &[]).expect("staged settings");
    std::fs::write(folder.path().join("specs"), spec.canonical()).expect("a file");
    let fails = |line: String| {
        let words = ["touchstone"].into_iter().chain(line.split(' '));
        let arguments = Arguments::try_parse_from(words).expect("a sound command line");
        let session = Session { cases: &SOUND, sources, references: changed, interrupt: &NEVER };
        dispatch(&arguments.command, &session).err().map(|failure| {
            assert_eq!(failure.exit, Exit::GateFailed);
            failure.reason.to_string()
        })
    };
    let output = OutputFolder::create(folder.path()).expect("a folder");
    let asked =
        ResumableRun { spec, sources: sources(""), every: Some(60), vtk: None, allow_long: false };
    super::checkpoint::write(&output, &asked, &[]).expect("a checkpoint");
    for line in [
        format!("run --resume {out}"),
        format!("verify right --store {out}/store"),
        format!("verify --store {out}/store"),
        format!("verify --no-runs --store {out}"),
        format!("report --out {out}/report"),
        "run right --variant right".into(),
        format!("run --specs {out}/specs --store {out}/store"),
        "stability right".into(),
    ] {
        let words = fails(line.clone()).unwrap_or_else(|| panic!("{line} passes"));
        for part in ["of reference cavity/lines.csv is \"0.O547\"", "it judges right"] {
            assert!(words.contains(part), "{line}: {words}");
        }
    }
    for line in [format!("verify wrong --store {out}/store"), "run wrong --variant right".into()] {
        assert_eq!(fails(line.clone()), None, "{line}: it does not use the table");
    }
}

/// A second report makes no runs, a store is judged and rendered without a run, and a comparison of two
/// reports finds a new failure.
#[test]
fn records_are_reused_judged_rendered_and_compared() {
    let folder = tempfile::tempdir().expect("a folder");
    let on = |cases: &'static [&'static dyn Case], line: &str| {
        let line = line.replace("OUT", folder.path().to_str().expect("a plain path"));
        let arguments = Arguments::try_parse_from(line.split(' ')).expect("sound");
        let session = Session { references: |_| vec![], cases, sources, interrupt: &NEVER };
        conclude(|| dispatch(&arguments.command, &session))
    };
    static GOOD: [&dyn Case; 1] = [&RIGHT];
    let good = |line: &str| on(&GOOD, line);
    assert_eq!(good("touchstone verify --no-runs --store OUT/none"), Exit::Usage);
    assert_eq!(good("touchstone report --out OUT/a"), Exit::Pass);
    let record = std::fs::read_dir(folder.path().join("a/records")).expect("a store").next();
    let path = record.expect("a record").expect("a file").path();
    let time = || std::fs::metadata(&path).and_then(|file| file.modified()).expect("a time");
    let made = time();
    assert_eq!(good("touchstone report --out OUT/a"), Exit::Pass);
    assert_eq!(made, time(), "nothing was made again");
    assert_eq!(good("touchstone verify right --store OUT/a/records --fresh"), Exit::Pass);
    let afresh = time();
    assert!(afresh > made, "it was not made afresh");
    assert_eq!(good("touchstone report --out OUT/a --fresh"), Exit::Pass);
    assert!(time() > afresh, "it was not made afresh");
    let line = "touchstone verify --no-runs --store OUT/a/records --junit OUT/junit.xml";
    assert_eq!(good(line), Exit::Pass);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect(name);
    assert!(
        read("junit.xml")
            .contains("<testcase classname=\"right\" name=\"staged.right.right.error\">")
    );
    assert_eq!(good("touchstone report --store OUT/a/records --out OUT/b"), Exit::Pass);
    assert_eq!(good("touchstone compare OUT/a OUT/b"), Exit::Pass);
    assert_eq!(on(&SOUND, "touchstone report --out OUT/c"), Exit::GateFailed);
    assert_eq!(good("touchstone compare OUT/a OUT/c --json"), Exit::GateFailed);
    // The gates of `wrong` are missing in the other direction.
    assert_eq!(good("touchstone compare OUT/c OUT/a"), Exit::GateFailed);
    assert_eq!(good("touchstone compare OUT/c/records OUT/a/records"), Exit::GateFailed);
    // A store with a missing run fails its gates, unless `--partial` is given.
    assert_eq!(on(&SOUND, "touchstone verify --no-runs --store OUT/a/records"), Exit::GateFailed);
    assert_eq!(on(&SOUND, "touchstone report --store OUT/a/records --out OUT/d"), Exit::GateFailed);
    let partial = "touchstone report --store OUT/a/records --out OUT/d --partial";
    assert_eq!(on(&SOUND, partial), Exit::Pass);
    assert!(read("d/index.html").contains("Of the runs of this case are without a record"));
    // Studies of incomplete cases are not evaluated.
    let verdicts = read("d/verdicts.json");
    let is_judged = |gate: &str| verdicts.contains(&format!("\"{gate}\""));
    let gates = ["staged.right.count", "staged.wrong.count", "staged.wrong.wrong.error"];
    assert_eq!(gates.map(is_judged), [true, false, false], "{verdicts}");
    assert_eq!(good(partial), Exit::Pass);
    assert!(!read("d/index.html").contains("without a record"));
}

/// A count that is exact has no margin, and was named as the gate that is the closest to failing.
#[test]
fn the_gate_closest_to_failing_is_one_with_a_margin() {
    let judged = |id: &str, bound, value, control: bool| {
        let gate = Gate::new(id, "l2", bound, Evidence::Theory, "made up");
        Judged::new(if control { gate.expected_to_fail() } else { gate }, Some(value))
    };
    let count = judged("count", Bound::Equals(0.0), 0.0, false);
    let control = judged("control", Bound::Below(1.0), 2.0, true);
    let near = judged("near", Bound::Below(1.0), 0.9, false);
    let far = judged("far", Bound::Below(1.0), 0.1, false);
    let failed = judged("failed", Bound::Below(1.0), 7.0, false);
    let worst = |all: &[&Judged]| {
        let id = |judged: &Judged| judged.gate.id.clone();
        super::summary::worst(all.iter().copied()).map(id).unwrap_or_default()
    };
    assert_eq!(worst(&[&count, &control, &far, &near]), "near");
    assert_eq!(worst(&[&far, &count, &control]), "far");
    assert_eq!(worst(&[&near, &failed, &far, &count]), "failed");
    assert_eq!(worst(&[]), "");
}

#[test]
fn a_plan_is_run_line_by_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let spec = |variant: &str| RunSpec::new("right", variant, json!({"re": 1.0}));
    let lines = [spec("right"), spec("diverging")].map(|spec| spec.canonical() + "\n").concat();
    std::fs::write(folder.path().join("specs.jsonl"), lines).expect("a file");
    let go = |rest: &str| {
        let line = format!("run --specs OUT/specs.jsonl --store OUT/store {rest}");
        exit_with(&NEVER, line.trim_end(), folder.path())
    };
    let count = || std::fs::read_dir(folder.path().join("store")).expect("a store").count();
    assert_eq!(go("--index 2"), Exit::Usage);
    assert_eq!(go("--index 2..4"), Exit::Usage);
    assert_eq!(go("--index 1"), Exit::Diverged);
    assert_eq!(count(), 1);
    assert_eq!(go(&format!("--only {}", spec("right").key())), Exit::Pass);
    assert_eq!(go("--only 0123456789abcdef"), Exit::Usage);
    assert_eq!((go(""), count()), (Exit::Diverged, 2));
    assert_eq!((go("--index 0..1"), go("--index 0..9")), (Exit::Pass, Exit::Diverged));
    for wrong in ["1..1", "3..2", "..2", "1..", "-1", "1...2", "18446744073709551615", "a"] {
        let line = format!("touchstone run --specs f --store s --index={wrong}");
        assert!(Arguments::try_parse_from(line.split(' ')).is_err(), "{wrong}");
    }
}

/// How `run --specs` of these lines ends, and how many records there are then.
fn of_lines(lines: &[&str]) -> (Exit, usize) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("specs"), lines.join("\n")).expect("a file");
    let exit = exit_with(&NEVER, "run --specs OUT/specs --store OUT/store", folder.path());
    let entries = std::fs::read_dir(folder.path().join("store")).into_iter().flatten().flatten();
    // Hidden files state the fate of runs without a record.
    let is_record = |name: std::ffi::OsString| !name.to_string_lossy().starts_with('.');
    (exit, entries.filter(|entry| is_record(entry.file_name())).count())
}

/// Six equal lines were made six times, and `1`, `1.0` and no value had different keys.
#[test]
fn a_run_is_made_once_however_often_and_however_it_is_written() {
    let line =
        |settings: &str| format!(r#"{{"case":"right","variant":"right","settings":{settings}}}"#);
    let lines =
        ["{\"re\":1}", "{\"re\":1.0}", "{\"re\":1e0}", "{}", "{}", "{\"re\": 10e-1}"].map(line);
    assert_eq!(of_lines(&lines.each_ref().map(String::as_str)), (Exit::Pass, 1));
    assert_eq!(of_lines(&[&line("{\"re\":1}"), &line("{\"re\":2}")]), (Exit::Pass, 2));
}

/// An array job took 0 for a run that diverged, or was refused; and one line ended all others.
#[test]
fn the_worst_of_all_lines_is_the_exit_code_and_costs_no_other_line() {
    let [right, diverging, panicking] = ["right", "diverging", "panicking"]
        .map(|variant| format!(r#"{{"case":"right","variant":"{variant}","settings":{{}}}}"#));
    let no_spec = r#"{"case":"right","variant":"right","settings":null}"#;
    assert_eq!(of_lines(&[&right]), (Exit::Pass, 1));
    assert_eq!(of_lines(&[no_spec, &right]), (Exit::Usage, 1));
    assert_eq!(of_lines(&["not json", &right]), (Exit::Usage, 1));
    assert_eq!(of_lines(&[no_spec, &right, &diverging]), (Exit::Usage, 2));
    assert_eq!(of_lines(&[&panicking, no_spec, &right, &diverging]), (Exit::Bug, 2));
    assert_eq!(of_lines(&[no_spec]), (Exit::Usage, 0));
}

/// Commands on a store whose records were made by a build of other sources.
#[test]
fn a_build_judges_its_own_records_unless_any_build_will_do() {
    static GOOD: [&dyn Case; 1] = [&RIGHT];
    let folder = tempfile::tempdir().expect("a folder");
    let build = |sources: fn(&str) -> String, line: &str| {
        let line = line.replace("OUT", folder.path().to_str().expect("a plain path"));
        let words = std::iter::once("touchstone").chain(line.split(' '));
        let arguments = Arguments::try_parse_from(words).expect("a sound command line");
        let session = Session { cases: &GOOD, sources, references: |_| vec![], interrupt: &NEVER };
        conclude(|| dispatch(&arguments.command, &session))
    };
    let other: fn(&str) -> String = |_| "other".into();
    assert_eq!(build(sources, "verify --store OUT"), Exit::Pass);
    for (line, of_its_own, of_another) in [
        ("verify --no-runs --store OUT", Exit::Pass, Exit::GateFailed),
        ("verify --no-runs --store OUT --any-build", Exit::Pass, Exit::Pass),
        ("report --store OUT --out OUT/page", Exit::Pass, Exit::GateFailed),
        ("report --store OUT --out OUT/page --any-build", Exit::Pass, Exit::Pass),
    ] {
        assert_eq!(build(sources, line), of_its_own, "{line}");
        assert_eq!(build(other, line), of_another, "{line}");
    }
    let unknown: fn(&str) -> String = |_| touchstone_base::manifest::UNKNOWN.into();
    assert_eq!(build(unknown, "verify --store OUT"), Exit::Pass);
    assert_eq!(
        build(unknown, "verify --no-runs --store OUT"),
        Exit::GateFailed,
        "of whom are they?"
    );
}

/// Puts a non-empty folder in place of a file: its parent is writable, but the file cannot be written, even
/// by root.
fn block(path: &Path) {
    std::fs::create_dir_all(path.join("child")).expect("a folder in the way");
}

/// A full disk took the computation of a whole report with it.
#[test]
fn a_record_that_cannot_be_kept_is_reported_all_the_same() {
    static GOOD: [&dyn Case; 1] = [&RIGHT];
    let folder = tempfile::tempdir().expect("a folder");
    let in_folder = |line: &str| run_on(&GOOD, &NEVER, line, folder.path());
    let spec = case::spec(&RIGHT, "right", &["re=1".to_string()]).expect("staged settings");
    let record = format!("records/right-right-{}.json", spec.key());
    block(&folder.path().join(&record));
    assert_eq!(in_folder("report --out OUT"), Exit::Usage);
    let page = std::fs::read_to_string(folder.path().join("index.html")).expect("a page");
    check_page(&page).expect("a page that opens");
    let verdicts = std::fs::read_to_string(folder.path().join("verdicts.json")).expect("verdicts");
    let verdicts: Verdicts = serde_json::from_str(&verdicts).expect("verdicts");
    let of = |verdict| verdicts.counts.get(&verdict);
    assert_eq!((of(Verdict::Pass), of(Verdict::Fail)), (Some(&2), None));
    assert_eq!(in_folder("verify --store OUT/records"), Exit::Usage);
}

#[test]
fn a_file_of_a_report_that_cannot_be_written_keeps_no_other_from_being_written() {
    static GOOD: [&dyn Case; 1] = [&RIGHT];
    let folder = tempfile::tempdir().expect("a folder");
    block(&folder.path().join("out/verdicts.json"));
    block(&folder.path().join("blocked/junit.xml"));
    let out = |line: &str| run_on(&GOOD, &NEVER, line, folder.path());
    assert_eq!(out("report --out OUT/out --junit OUT/blocked/junit.xml"), Exit::Usage);
    assert!(folder.path().join("out/index.html").is_file());
    // Either alone is an error, too.
    assert_eq!(out("report --out OUT/out --junit OUT/junit.xml"), Exit::Usage);
    assert!(folder.path().join("junit.xml").is_file());
    let line = "verify --store OUT/store --junit OUT/blocked/junit.xml";
    assert_eq!(out(line), Exit::Usage);
}

#[test]
fn more_threads_than_can_be_asked_for_are_clamped() {
    for (variable, expected) in [
        (None, 0),
        (Some("2"), 0),
        (Some("1024"), 0),
        (Some("many"), 0),
        (Some(""), 0),
        (Some("1025"), 1024),
        (Some("100000"), 1024),
        (Some("100000000000000000000000"), 1024),
    ] {
        assert_eq!(super::threads_of(variable), expected, "{variable:?}");
    }
}

#[test]
fn notes_tell_each_reason_once() {
    let limited = |id: &str, reason: &str| {
        let gate = Gate::new(id, "error", Bound::Below(2.0), Evidence::Theory, "staged");
        Judged::new(
            gate.with_limitation(Bound::Below(4.0), reason, &Cause::new("It is so.", "Time.")),
            Some(3.0),
        )
    };
    let all = [limited("a", "one"), limited("b", "two"), limited("c", "one")];
    let text = super::judged::table(&all);
    let lines: Vec<&str> = text.lines().skip(1).collect();
    assert!(lines[0].starts_with("known limitation [1]  a"), "{text}");
    assert!(lines[1].starts_with("known limitation [2]  b"), "{text}");
    assert!(lines[2].starts_with("known limitation [1]  c"), "{text}");
    assert_eq!(lines[3..], ["[1]  one", "[2]  two"], "{text}");
}

#[test]
fn tables_are_aligned() {
    let rows = [vec!["a".into(), "−1.5".into()], vec!["νt/L²".into(), "10".into()]];
    let text = super::output::table(&["name", "value"], rows);
    assert_eq!(text, "name   value\na       −1.5\nνt/L²     10\n");
    let [one, two, three] = ["1", "2", "3"].map(|digit| digit.repeat(48));
    let wrapped = super::output::wrap(&[&*one, &two, &three].join(" "), "   ");
    assert_eq!(wrapped, format!("   {one} {two}\n   {three}\n"), "100 columns and no more");
}

/// The suite of some cases, made and judged.
fn judged(cases: &[&'static dyn Case]) -> Suite {
    let making = BatchOptions::new(Tier::Quick, &sources);
    suite::run(cases, &making)
}

/// `verify` must not print a line for each of 606 gates.
#[test]
fn verify_is_a_line_a_case_then_each_failure_in_full() {
    let text = super::summary::summary(&judged(&SOUND));
    let lines: Vec<&str> = text.lines().collect();
    assert!(
        lines[1].starts_with("right ") && lines[1].contains("staged.right.right.error"),
        "{text}"
    );
    assert!(lines[2].starts_with("wrong "), "{text}");
    let counts: Vec<&str> = lines[2].split_whitespace().skip(1).take(4).collect();
    assert_eq!(counts, ["1", "0", "0", "2"], "fail, limited, control, pass: {text}");
    assert_eq!(lines[6], "staged.wrong.wrong.error", "{text}");
    for part in ["at most 2", "the error of a run that is staged is 1", "3.0000: FAIL"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(text.ends_with("1 gate fails, 4 gates pass\n"), "{text}");
    assert!(!text.contains("explain"), "nothing is limited: {text}");
}

#[test]
fn a_run_ends_with_error_bound_cost_and_the_next_command() {
    let couette = touchstone_cases::find("couette").expect("a case");
    let spec = |set: &str| case::spec(couette, "plain", &[set.to_string()]).expect("settings");
    let mut record = Record::new("couette", "plain", spec("rows=20").settings, 1);
    let of = |metric: &str, most: f64| {
        let because = "staged";
        Gate::new("couette.staged", metric, Bound::Below(most), Evidence::Theory, because)
    };
    let studies = couette.studies(Tier::Quick);
    let card: &Card = studies.first().expect("a card");
    record.put(card.metric.clone(), 0.0123);
    let end = |gates: Vec<Gate>| {
        let judged = gates.into_iter().map(|gate| Judged::of_record(gate, &record));
        let judged: Vec<Judged> = judged.collect();
        super::summary::outcome(&GateIndex::of(couette), &spec("rows=20"), &record, &judged)
            .concat()
    };
    let has = |text: &str, parts: &[&str]| {
        for part in parts {
            assert!(text.contains(part), "{part}: {text}");
        }
    };
    let metric = &card.metric.name;
    let finer = "next   touchstone run couette --variant plain --set rows=40";
    has(&end(vec![of(metric, 0.0246)]), &["error  1.2 %", "at most 2.46 %: pass, 50", finer]);
    has(&end(vec![of(metric, 0.01)]), &["fail", "next   touchstone explain couette.staged"]);
    let nearest = "the nearest run with a bound is couette --variant modern --set end=1.5: l2_worst at \
        most 1 %";
    has(
        &end(Vec::new()).replace("\n       ", " "),
        &["bound  none", nearest, "next   touchstone run"],
    );
}

/// `run periodic_hill`, at Re 50, ended with "at Re 10", and a dam break in the tank of Lobovsky et al. with
/// "Martin & Moyce": both were the words of the runs on the card.
#[test]
fn a_run_states_the_error_by_its_own_settings() {
    let tank = ["width=0.6", "height=0.3", "tank=1.61", "rim=2", "end=6"];
    type Of<'a> = (&'a str, &'a [&'a str], &'a [&'a str], &'a [&'a str]);
    let runs: [Of; 5] = [
        ("periodic_hill", &["re=50"], &["Re 50"], &["Re 10"]),
        ("poiseuille", &["re=5", "rows=10"], &["Re 5,", "10 rows"], &["Re 0.5"]),
        ("rubber_rings", &["speed=0.03"], &["0.03 c0"], &["0.059"]),
        ("dam_break", &tank, &["Lobovsky", "0.012\u{a0}H"], &["Martin"]),
        ("dam_break", &["n=10"], &["Martin", "a/dx = 10", "0.012\u{a0}a"], &["Lobovsky"]),
    ];
    for (name, set, says, not) in runs {
        let case = touchstone_cases::find(name).expect("a case");
        let set: Vec<String> = set.iter().map(|text| text.to_string()).collect();
        let spec = case::spec(case, case.recommended().variant, &set).expect("settings");
        let studies = case.studies(Tier::Quick);
        let card: &Card = studies.first().expect("a card");
        let mut record = Record::new(name, &spec.variant, spec.settings.clone(), 1);
        record.put(card.metric.clone(), 0.0123);
        let [text, _] = super::summary::outcome(&GateIndex::of(case), &spec, &record, &[]);
        let text = text.split("bound ").next().unwrap_or_default().replace('\n', " ");
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ").replace(" H", "\u{a0}H");
        says.iter().for_each(|words| {
            let words = words.replace('\u{a0}', " ");
            assert!(text.replace('\u{a0}', " ").contains(&words), "{name}: {words}: {text}");
        });
        not.iter().for_each(|words| assert!(!text.contains(words), "{name}: {words}: {text}"));
    }
}

/// A case has one error, on its card, in its first figure and in documents.
#[test]
fn page_list_run_and_readme_state_the_same_number_of_a_case() {
    let readme = include_str!("../../../README.md");
    for &case in touchstone_cases::CASES {
        let (name, studies) = (case.name(), case.studies(Tier::Quick));
        let Some(metric) = studies.error() else { continue };
        let recommended = case.recommended();
        let spec = case::spec(case, recommended.variant, &[]).expect("settings");
        let mut record = Record::new(name, &spec.variant, spec.settings.clone(), 1);
        record.put(metric.clone(), 0.0123);
        let page =
            touchstone_harness::studies::card::headline(&studies, &record).expect("an error");
        let (run, named) = super::summary::error_of(&studies, &record);
        assert_eq!(named, metric.name, "{name}");
        if studies.first::<Card>().is_some() {
            assert!(run.starts_with(&page), "{name}: `run` states {run}, the page {page}");
            let of = format!("{name}.{};", recommended.variant);
            let end = format!("; {} ", metric.name);
            let card: &Card = studies.first().expect("a card");
            let shown = card.runs.first().expect("the run of the recommended variant");
            let states = |text: &str| {
                let sources = text.split("<!-- ").filter_map(|text| text.split("-->").next());
                let set = |source: &str| {
                    let set = source.strip_prefix(&of)?.strip_suffix(&end)?;
                    Some(set.split_whitespace().map(str::to_string).collect::<Vec<_>>())
                };
                sources.filter_map(set).any(|set| {
                    let of = case::spec(case, recommended.variant, &set).expect("settings");
                    (of.variant, of.settings) == (shown.variant.clone(), shown.settings.clone())
                })
            };
            assert!(states(recommended.because), "{name}: `list` has no {end}of {of}");
            assert!(states(readme), "{name}: README has no {end}of {of}");
        }
    }
}

/// A fitted shift of the clock makes the distance nearly independent of the method, so the headline of the
/// dam break is the distance without shift; both are printed, with the uncertainty of the experiment.
#[test]
fn a_dam_break_states_both_distances_from_its_experiment() {
    let case = touchstone_cases::find("dam_break").expect("a case");
    let spec = case::spec(case, "modern", &[]).expect("settings");
    let mut record = Record::new("dam_break", "modern", spec.settings.clone(), 1);
    let put = [("front_away@2", -0.0576), ("front_rms", 0.2815), ("front_rms_shifted", 0.037)];
    for (name, value) in put.into_iter().chain([("front_shift", 0.2225)]) {
        record.put(MetricKey::new(name, "-", "made up"), value);
    }
    let text = super::summary::outcome(&GateIndex::of(case), &spec, &record, &[])
        .concat()
        .replace(['\u{a0}', '\n'], " ");
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in
        ["error −0.058 a, front at T = 2", "(± 0.10 a)", "0.28 a as released", "0.037 a after"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(!text.contains("3.7 %"), "{text}");
}

/// Pictures on cards were of another variant, Reynolds number or tank than the number below them.
#[test]
fn the_picture_of_a_card_is_of_the_run_that_it_states() {
    for (case, tier) in
        touchstone_cases::CASES.iter().flat_map(|case| [(case, Tier::Quick), (case, Tier::Full)])
    {
        let studies = case.studies(tier);
        let Some(card) = studies.first::<Card>() else { continue };
        assert!(card.pictured(&studies).is_some(), "{} in {tier:?}: {}", case.name(), card.picture);
    }
}

/// `stiff` had colour, line and marker of `consistent` beside it.
#[test]
fn variants_of_one_figure_differ_in_their_looks() {
    for case in touchstone_cases::CASES {
        let studies = case.studies(Tier::Full);
        for accuracy in studies.of::<Accuracy>() {
            let looks = accuracy.ladders.iter().enumerate();
            let looks: Vec<_> = looks.map(|(k, of)| look_of(of.variant, k)).collect();
            for (k, look) in looks.iter().enumerate() {
                let alike = looks[..k].iter().position(|other| other == look);
                let name = |k: usize| accuracy.ladders[k].variant;
                assert_eq!(alike.map(name), None, "{}: as {}", accuracy.id, name(k));
            }
        }
    }
}

/// Every case with a ladder of resolutions has a finer run, whichever setting is its resolution.
#[test]
fn the_next_run_has_half_the_spacing() {
    for (name, finer) in [("rubber_rings", "spacing=0.05"), ("dam_break", "n=40")] {
        let case = touchstone_cases::find(name).expect("a case");
        let spec = case::spec(case, case.recommended().variant, &[]).expect("settings");
        let words = super::summary::finer(case, &case.studies(Tier::Quick), &spec);
        assert!(words.as_ref().is_some_and(|words| words.ends_with(finer)), "{name}: {words:?}");
    }
}

/// `run` of plate, disk, bar and cantilever was of the paper's variant, which is wrong by 7 to 35 %.
#[test]
fn a_plain_run_is_of_the_recommended_variant_and_list_says_why() {
    for case in touchstone_cases::CASES {
        let (name, recommended) = (case.name(), case.recommended());
        for variant in [Some(recommended.variant), recommended.papers].into_iter().flatten() {
            let is_one = case.variants().iter().any(|one| one.name == variant);
            assert!(is_one, "{name} has no variant {variant}, which its declaration names");
        }
        assert!(
            recommended.reason().len() > 30,
            "why it is recommended of {name}: {:?}",
            recommended.because
        );
        let studies = case.studies(Tier::Quick);
        let shown = studies.of::<Card>().flat_map(|card| &card.runs);
        let shown: Vec<&str> = shown.map(|spec| &*spec.variant).collect();
        let named: Vec<&str> =
            [Some(recommended.variant), recommended.papers].into_iter().flatten().collect();
        assert!(shown.is_empty() || shown == named, "{name}: {shown:?} on the card, not {named:?}");
    }
    let bar = touchstone_cases::find("elastic_bar").expect("a case");
    let spec = case::spec(bar, bar.recommended().variant, &[]).expect("settings");
    let record = bar.run(&spec, &Context::default()).expect("a run");
    let error = record.metrics["travel_error"].value;
    assert!(error.abs() < 2e-3, "a pulse in a plain bar comes {error} of its time late, not 0.002");
}

#[test]
fn the_problem_of_a_case_has_at_most_ten_words() {
    for case in touchstone_cases::CASES {
        let words = case.problem().split_whitespace().count();
        assert!((2..=10).contains(&words), "{}: {}", case.name(), case.problem());
    }
}

#[test]
fn every_command_has_a_page_of_the_manual_and_every_shell_its_completions() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(exit_with(&NEVER, "man OUT", folder.path()), Exit::Pass);
    for name in ["touchstone.1", "touchstone-run.1", "touchstone-verify.1"] {
        let page = std::fs::read_to_string(folder.path().join(name)).expect(name);
        assert!(page.contains(".SH OPTIONS"), "{name}: {page}");
    }
    assert!(!folder.path().join("touchstone-help.1").exists());
    for shell in ["bash", "zsh", "fish"] {
        assert_eq!(exit(&format!("completions {shell}")), Exit::Pass);
    }
}

#[test]
fn gates_are_listed_by_their_last_verdict() {
    let folder = tempfile::tempdir().expect("a folder");
    let in_folder = |line: &str| run_on(&SOUND, &NEVER, line, folder.path());
    let line = "explain --status fail --reports OUT";
    assert_eq!(in_folder(line), Exit::Usage, "there is no report yet");
    assert_eq!(in_folder("report --out OUT"), Exit::GateFailed);
    assert_eq!(in_folder(line), Exit::Pass);
    assert_eq!(in_folder("explain staged.right.r --status pass --reports OUT"), Exit::Pass);
}

fn limited(id: &str, cause: &Cause) -> Judged {
    let gate = Gate::new(id, "error", Bound::Below(2.0), Evidence::Theory, "staged");
    Judged::new(gate.with_limitation(Bound::Below(4.0), "why", cause), Some(3.0))
}

#[test]
fn limitations_are_listed_by_cause_those_of_most_gates_first() {
    let causes = [("One.", "Mend one."), ("Two.", "Mend two.")];
    let [one, two] = causes.map(|(what, mend)| Cause::new(what, mend));
    let all = [limited("a", &one), limited("b", &two), limited("c", &two)];
    let text = super::explain::listed(all.iter().collect(), Verdict::Limitation);
    let at = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part}: {text}"));
    assert!(at("Two. What would remove it: Mend two.") < at("    b"));
    assert!(at("    b") < at("    c") && at("    c") < at("One."), "{text}");
    assert!(!text.contains("since"), "a date that says nothing: {text}");
}
