//! The report: from a judged suite to one page.

use base::{
    gate::{Evidence, Verdict},
    manifest::{Known, Manifest},
    record::Record,
    reference::{Reference, ReferenceError},
    settings::Field,
    spec::{RunSpec, Task},
};
use harness::{
    case::{self, Case, Tier},
    columns::Columns,
    notes::Notes,
    runs::{Judged, JudgedRun},
    study::Study,
    suite::{CaseResults, Suite},
};
use report::{Block, Cell, Column, Counts, Page, Section, Status, Table};

/// The whole report.
pub fn assemble(suite: &Suite) -> Page {
    let counts =
        Counts { diverged: suite.diverged(), ..Counts::of(suite.judged().map(Judged::status)) };
    let manifest = Manifest::of_this_process(rayon::current_num_threads());
    let lead = vec![
        "How wrong is a particle method, what does being less wrong cost, and how far can it be pushed \
         before it breaks? Each number below was measured by this run of touchstone; each gate says what \
         it stands on."
            .to_string(),
        format!("{} tier. {}{}", tier_name(suite), provenance(&manifest), reused(suite)),
    ];
    let mut sections: Vec<Section> = vec![summary(suite)];
    sections.extend(suite.cases.iter().map(case_section));
    sections.push(references_section());
    Page {
        title: "touchstone".into(),
        lead,
        counts: Some(counts),
        sections,
        png_folder: "figures".into(),
        footer: provenance(&manifest),
    }
}

fn tier_name(suite: &Suite) -> &'static str {
    match suite.tier {
        Tier::Quick => "Quick",
        Tier::Full => "Full",
    }
}

/// What was not made for this page.
fn reused(suite: &Suite) -> String {
    let other = match suite.of_other_sources {
        0 => String::new(),
        count => format!(" **{count} of them were made by a build of other sources.**"),
    };
    match suite.reused {
        0 => String::new(),
        count => format!(" {count} records were in the store before.{other}"),
    }
}

fn provenance(m: &Manifest) -> String {
    let dirty = match m.dirty {
        Known::Yes => " with uncommitted changes",
        Known::No => "",
        Known::Unknown => " (state of the sources unknown)",
    };
    let commit: String = m.commit.chars().take(12).collect();
    format!(
        "touchstone {} at commit `{commit}`{dirty}, {} build, {}, {}, {} cores, {} threads.",
        m.touchstone, m.profile, m.rustc, m.cpu, m.cores, m.threads
    )
}

fn worst<'a>(judged: impl Iterator<Item = &'a Judged>) -> Option<Status> {
    judged.map(Judged::status).max()
}

fn summary(suite: &Suite) -> Section {
    let mut rows: Vec<(String, Vec<&Judged>)> = Vec::new();
    let link = |id: &str, title: &str| format!("[{title}](#{id})");
    for results in &suite.cases {
        let name = results.case.name();
        let runs = results.runs.all().iter().flat_map(|run| &run.judged).collect();
        rows.push((link(name, &format!("{name}: single runs")), runs));
        for study in &results.studies {
            let title = format!("{name}: {}", study.title);
            rows.push((link(&anchor(study), &title), study.judged.iter().collect()));
        }
    }
    let failed = |judged: &[&Judged]| {
        judged.iter().filter(|j| j.judgement.verdict.is_failure()).count() as u64
    };
    let verdict = |judged: &[&Judged]| worst(judged.iter().copied()).unwrap_or(Status::Reported);
    let table = Columns::<(String, Vec<&Judged>)>::default()
        .text("part", |(part, _)| part.clone())
        .num(["gates", "1"], |(_, judged)| Cell::count(judged.len() as u64))
        .num(["failed", "1"], |(_, judged)| Cell::count(failed(judged)))
        .with(Column::text("verdict"), |(_, judged)| Cell::status(verdict(judged)))
        .table("Verdicts.", rows);
    Section::new("verdicts", "Verdicts").block(table)
}

fn case_section(results: &CaseResults) -> Section {
    let case = results.case;
    let judged = || results.runs.all().iter().flat_map(|run| &run.judged);
    let mut section = Section::new(case.name(), case.name()).prose(case.about());
    if let Some(status) = worst(judged().chain(results.studies.iter().flat_map(|s| &s.judged))) {
        section = section.status(status);
    }
    section = gates(section, "Gates on single runs.", &judged().collect::<Vec<_>>());
    for study in &results.studies {
        section = section.child(study_section(study));
    }
    let variants = case.variants().iter().map(|v| format!("`{}`: {}", v.name, v.about)).collect();
    section
        .block(Block::Details { summary: "Variants".into(), blocks: vec![Block::List(variants)] })
        .block(Block::Details {
            summary: "Settings".into(),
            blocks: vec![settings_table(results).into()],
        })
        .block(Block::Details {
            summary: "Runs and what they cost".into(),
            blocks: vec![run_table(case, results.runs.all()).into()],
        })
}

/// Sections and figures share a name space; figures are named by their study.
fn anchor(study: &Study) -> String {
    format!("study-{}", study.id)
}

fn study_section(study: &Study) -> Section {
    let mut section = Section::new(anchor(study), &study.title);
    if let Some(status) = worst(study.judged.iter()) {
        section = section.status(status);
    }
    for block in &study.blocks {
        section = section.block(block.clone());
    }
    if study.judged.is_empty() {
        section
    } else {
        gates(section, "Gates.", &study.judged.iter().collect::<Vec<_>>())
    }
}

/// Adds a table of gates and below it their reasons, each once.
fn gates(section: Section, caption: &str, judged: &[&Judged]) -> Section {
    let mut notes = Notes::default();
    let rows: Vec<(&Judged, String)> = judged
        .iter()
        .map(|&judged| {
            let mut words = format!("[{}]", notes.number(&judged.gate.because));
            if let Verdict::Limitation(reason) = &judged.judgement.verdict {
                words += &format!(", limitation [{}]", notes.number(reason));
            }
            (judged, words)
        })
        .collect();
    let list = Block::List(notes.all().map(|(k, reason)| format!("[{k}] {reason}")).collect());
    let value = |value: Option<f64>| value.map_or(Cell::text("not measured"), measured);
    let margin = |margin: Option<f64>| margin.map_or(Cell::text("–"), |m| Cell::percent(m, 2));
    let table = Columns::<(&Judged, String)>::default()
        .code("gate", |(judged, _)| judged.gate.id.clone())
        .num(["value", "-"], |(judged, _)| value(judged.judgement.value))
        .text("bound", |(judged, _)| judged.gate.bounds())
        .num(["margin", "-"], |(judged, _)| margin(judged.judgement.margin))
        .text("evidence", |(judged, _)| evidence(judged.gate.evidence))
        .text("reason", |(_, notes)| notes.clone())
        .with(Column::text("verdict"), |(judged, _)| Cell::status(judged.status()))
        .table(caption, &rows);
    section.block(table).block(Block::Details { summary: "Reasons".into(), blocks: vec![list] })
}

/// A measured value: a whole number as such, any other with four digits.
fn measured(value: f64) -> Cell {
    let is_whole = value == value.trunc() && value.abs() < 1e6;
    if is_whole { Cell::exact(value) } else { Cell::num(value, 4) }
}

fn evidence(evidence: Evidence) -> &'static str {
    match evidence {
        Evidence::Analytic => "analytic",
        Evidence::Invariant => "invariant",
        Evidence::Theory => "theory",
        Evidence::Reference => "reference",
        Evidence::Regression => "regression",
    }
}

fn settings_table(results: &CaseResults) -> Table {
    let caption = "Settings, reachable by `--set key=value`; variants change some defaults.";
    Columns::<Field>::default()
        .code("setting", |field| field.name)
        .text("meaning", |field| field.doc)
        .text("unit", |field| field.unit)
        .text("allowed", |field| field.range)
        .text("default", |field| field.default().to_string())
        .table(caption, results.case.fields())
}

fn run_table(case: &dyn Case, runs: &[JudgedRun]) -> Table {
    let caption = "Every run of the plan. Seconds alone are the median of timings with nothing else of this \
                   program at work; other seconds were taken side by side and are only rough. The state is a \
                   digest of the bits at the end: the same for any number of threads.";
    let alone = |record: &Record| record.cost.alone_median().map_or(Cell::text("–"), Cell::seconds);
    Columns::of_variants()
        .text("set", |record| what(case, &record.spec()))
        .ended()
        .num(["particles", "1"], |record| Cell::count(record.cost.particles as u64))
        .steps()
        .num(["pair interactions", "1"], |r| Cell::sci(r.cost.pair_interactions as f64, 2))
        .num(["right-hand sides", "1"], |r| Cell::sci(r.cost.particle_rhs as f64, 2))
        .num(["stepping, alone", "s"], alone)
        .num(["stepping", "s"], |record| Cell::seconds(record.cost.cpu_s))
        .num(["observers", "s"], |record| Cell::seconds(record.cost.observing_s))
        .num(["solver memory", "kB"], |r| Cell::num(r.cost.solver_bytes as f64 / 1e3, 4))
        .code("state", |r| r.state.iter().flat_map(|s| s.chars()).take(8).collect::<String>())
        .table(caption, runs.iter().map(|run| &run.record))
}

/// `key=value` of what differs from the defaults of the variant, and what is done with it.
fn what(case: &dyn Case, spec: &RunSpec) -> String {
    let mut words = case::changed(case, spec);
    match &spec.task {
        Task::Simulate => {}
        Task::Bisect(bisect) => words.push(format!("(bisects {})", bisect.setting)),
        Task::Detect(detect) => words.push(format!("(smallest detected error of {})", detect.of)),
    }
    words.extend(spec.mutation.map(|m| format!("({} × {})", m.of, m.factor)));
    words.join(" ")
}

fn references_section() -> Section {
    type Row = (&'static str, Result<Reference, ReferenceError>);
    let name = |(name, found): &Row| {
        let cell = Cell::text(format!("`{name}`"));
        if found.is_err() { cell.with(Status::Fail) } else { cell }
    };
    let what = |(_, found): &Row| match found {
        Ok(reference) => reference.package.title.clone(),
        Err(error) => error.to_string(),
    };
    let licences = |(_, found): &Row| match found {
        Ok(Reference { package, .. }) => {
            let names: Vec<&str> = package.licenses.iter().map(|l| l.name.as_str()).collect();
            names.join(", ")
        }
        Err(_) => "–".into(),
    };
    let table = Columns::<Row>::default()
        .with(Column::text("reference"), name)
        .text("what", what)
        .text("licence", licences)
        .table(
            "Reference data, embedded with its provenance and checked by hash.",
            Reference::names().into_iter().map(|name| (name, Reference::load(name))),
        );
    Section::new("references", "References").block(table)
}
