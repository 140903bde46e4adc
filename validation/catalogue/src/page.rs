//! The report: from a judged suite to one page.

use base::{
    gate::{Evidence, Verdict},
    manifest::{Known, Manifest},
    record::Status as Ended,
    reference::Reference,
    spec::{RunSpec, Task},
};
use harness::{
    case::{self, Case, Tier},
    runs::{Judged, JudgedRun},
    study::Study,
    suite::{CaseResults, Suite},
};
use report::{Block, Cell, Column, Counts, Page, Section, Status, Table, sig};

/// The whole report.
pub fn assemble(suite: &Suite) -> Page {
    let counts = Counts::of(suite.judged().map(Judged::status));
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
    if !suite.studies.is_empty() {
        let method = Section::new("method", "The method itself");
        sections.push(suite.studies.iter().map(study_section).fold(method, Section::child));
    }
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
    let columns = vec![
        Column::text("part"),
        Column::num("gates", "1"),
        Column::num("failed", "1"),
        Column::text("verdict"),
    ];
    let mut table = Table::new("Verdicts.", columns);
    let mut row = |id: &str, title: &str, judged: Vec<&Judged>| {
        let failed = judged.iter().filter(|j| j.judgement.verdict.is_failure()).count();
        let verdict = worst(judged.iter().copied()).unwrap_or(Status::Reported);
        table.rows.push(vec![
            Cell::text(format!("[{title}](#{id})")),
            Cell::count(judged.len() as u64),
            Cell::count(failed as u64),
            Cell::status(verdict),
        ]);
    };
    for results in &suite.cases {
        let runs = results.runs.all().iter().flat_map(|run| &run.judged).collect();
        row(results.case.name(), &format!("{}: single runs", results.case.name()), runs);
        for study in &results.studies {
            let title = format!("{}: {}", results.case.name(), study.title);
            row(&anchor(study), &title, study.judged.iter().collect());
        }
    }
    for study in &suite.studies {
        row(&anchor(study), &study.title, study.judged.iter().collect());
    }
    Section::new("verdicts", "Verdicts").block(table)
}

fn case_section(results: &CaseResults) -> Section {
    let case = results.case;
    let judged = || results.runs.all().iter().flat_map(|run| &run.judged);
    let mut section = Section::new(case.name(), case.name()).prose(case.about());
    if let Some(status) = worst(judged().chain(results.studies.iter().flat_map(|s| &s.judged))) {
        section = section.status(status);
    }
    section = section.block(gate_table("Gates on single runs.", judged()));
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
        section.block(gate_table("Gates.", study.judged.iter()))
    }
}

fn gate_table<'a>(caption: &str, judged: impl Iterator<Item = &'a Judged>) -> Table {
    let columns = vec![
        Column::text("gate"),
        Column::num("value", "-"),
        Column::text("bound"),
        Column::num("margin", "-"),
        Column::text("evidence"),
        Column::text("because"),
        Column::text("verdict"),
    ];
    let mut table = Table::new(caption, columns);
    for judged in judged {
        let Judged { gate, judgement } = judged;
        let value = judgement.value.map_or(Cell::text("not measured"), measured);
        let margin = judgement.margin.map_or(Cell::text("–"), |m| Cell::percent(m, 2));
        let because = match &judgement.verdict {
            Verdict::Limitation(reason) => format!("{} — limitation: {reason}", gate.because),
            _ => gate.because.clone(),
        };
        table.rows.push(vec![
            Cell::text(format!("`{}`", gate.id)),
            value,
            Cell::text(gate.bound.to_string()),
            margin,
            Cell::text(evidence(gate.evidence)),
            Cell::text(because),
            Cell::status(judged.status()),
        ]);
    }
    table
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
    let columns = vec![
        Column::text("setting"),
        Column::text("meaning"),
        Column::text("unit"),
        Column::text("allowed"),
        Column::text("default"),
    ];
    let mut table = Table::new(
        "Settings, reachable by `--set key=value`; variants change some defaults.",
        columns,
    );
    for field in results.case.fields() {
        table = table.row(vec![
            Cell::text(format!("`{}`", field.name)),
            Cell::text(field.doc),
            Cell::text(field.unit),
            Cell::text(field.range),
            Cell::text(field.default().to_string()),
        ]);
    }
    table
}

fn run_table(case: &dyn Case, runs: &[JudgedRun]) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::text("set"),
        Column::text("ended"),
        Column::num("particles", "1"),
        Column::num("steps", "1"),
        Column::num("pair interactions", "1"),
        Column::num("right-hand sides", "1"),
        Column::num("stepping, alone", "s"),
        Column::num("stepping", "s"),
        Column::num("observers", "s"),
        Column::num("solver memory", "kB"),
        Column::text("state"),
    ];
    let caption = "Every run of the plan. Seconds alone are the median of timings with nothing else of this \
                   program at work; other seconds were taken side by side and are only rough. The state is a \
                   digest of the bits at the end: the same for any number of threads.";
    let mut table = Table::new(caption, columns);
    for run in runs {
        let (record, cost) = (&run.record, &run.record.cost);
        let ended = match &record.status {
            Ended::Completed => "completed".to_string(),
            Ended::Diverged { step, time, particle, field, .. } => {
                format!(
                    "diverged: step {step}, t = {} s, {field} of particle {particle}",
                    sig(*time, 4)
                )
            }
            Ended::Refused { reason } => format!("refused: {reason}"),
            Ended::Interrupted { time, .. } => format!("interrupted at {} s", sig(*time, 4)),
        };
        let state: String = record.state.iter().flat_map(|s| s.chars()).take(8).collect();
        table = table.row(vec![
            Cell::text(format!("`{}`", run.planned.spec.variant)),
            Cell::text(what(case, &run.planned.spec)),
            Cell::text(ended),
            Cell::count(cost.particles as u64),
            Cell::count(cost.steps),
            Cell::sci(cost.pair_interactions as f64, 2),
            Cell::sci(cost.particle_rhs as f64, 2),
            cost.alone_median().map_or(Cell::text("–"), Cell::seconds),
            Cell::seconds(cost.cpu_s),
            Cell::seconds(cost.observing_s),
            Cell::num(cost.solver_bytes as f64 / 1e3, 4),
            Cell::text(format!("`{state}`")),
        ]);
    }
    table
}

/// `key=value` of what differs from the defaults of the variant, and what is done with it.
fn what(case: &dyn Case, spec: &RunSpec) -> String {
    let mut words = case::changed(case, spec);
    if let Task::Bisect(bisect) = &spec.task {
        words.push(format!("(bisects {})", bisect.setting));
    }
    words.join(" ")
}

fn references_section() -> Section {
    let columns = vec![Column::text("reference"), Column::text("what"), Column::text("licence")];
    let mut table =
        Table::new("Reference data, embedded with its provenance and checked by hash.", columns);
    for name in Reference::names() {
        let cells = match Reference::load(name) {
            Ok(reference) => vec![
                Cell::text(format!("`{name}`")),
                Cell::text(reference.package.title.clone()),
                Cell::text(
                    reference
                        .package
                        .licenses
                        .iter()
                        .map(|l| l.name.clone())
                        .collect::<Vec<_>>()
                        .join(", "),
                ),
            ],
            Err(error) => vec![
                Cell::text(format!("`{name}`")).with(Status::Fail),
                Cell::text(error.to_string()),
                Cell::text("–"),
            ],
        };
        table = table.row(cells);
    }
    Section::new("references", "References").block(table)
}
