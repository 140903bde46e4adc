//! The report: from a judged suite to one page.

use touchstone_base::{
    gate::Verdict,
    manifest::Manifest,
    record::Record,
    reference::Reference,
    spec::{RunSpec, Task},
    submission::OURS,
};
use touchstone_harness::{
    case::{self, Case},
    columns::TableColumns,
    notes::Notes,
    runs::{Judged, JudgedRun, counts},
    section,
    studies::{self, Card, Picture, card::headline, cost::against_run_time},
    suite::{CaseResults, JudgedOf, Of, Suite},
};
use touchstone_report::{
    Block, Cell, Counts, DataFile, Explorer, Figure, Overview, Page, Section, Table, TableColumn,
    VERDICTS, code, counted, percent, plain,
};

use crate::{
    fluids::taylor_green::{CASE, is_modern_from_lattice},
    limitations, probes, stiffness, time,
};

/// The whole report; `made` is the time at which it is made, for people.
pub fn assemble(suite: &Suite, made: &str) -> Page {
    let (main, others): (Vec<_>, Vec<_>) =
        suite.cases.iter().partition(|results| results.studies.first::<Card>().is_some());
    let overview = |of: &[&CaseResults], caption: &str| Overview {
        caption: caption.into(),
        columns: studies::card::columns(),
        rows: of.iter().filter_map(|results| results.row.clone()).collect(),
    };
    let mut opening = vec![Block::Prose(recommended(suite)), Block::Figure(errors(&main))];
    let films = main
        .iter()
        .flat_map(|of| of.studies.of::<Picture>().filter_map(|picture| picture.film(&of.runs)));
    opening.extend(films.map(Block::Movie));
    if !others.is_empty() {
        opening.push(Block::Details {
            summary: format!("The other {}", counted(others.len(), "case", "cases")),
            blocks: vec![
                Block::Overview(overview(&others, "Errors of the other cases")),
                Block::Prose(without_a_row(&others)),
            ],
        });
    }
    let mut sections: Vec<Section> = suite.cases.iter().map(|of| case_section(suite, of)).collect();
    sections.extend([probes::section(), reading(suite)]);
    let steps = Section::new("steps", "Time steps and run time");
    sections.push(steps.child(stiffness::section(suite)).child(time::section(suite)));
    sections.extend([verdicts(suite), limitations::section(suite), about(suite)]);
    Page {
        title: "touchstone: errors, costs and limits of smoothed particle hydrodynamics".into(),
        lead: vec![format!(
            "How wrong is a particle method, what does a smaller error cost, and when does it break? \
             {:?} tier, {made}. Your own code: `touchstone probe -- COMMAND` asks it [twenty \
             questions](#probes).",
            suite.tier
        )],
        overview: overview(&main, "Errors, costs and limits of the main cases"),
        counts: suite.counts(),
        opening,
        sections,
        figure_folder: "figures".into(),
        ..Page::default()
    }
}

/// Names of cases without a number, with the counts of their gates.
fn without_a_row(others: &[&CaseResults]) -> Vec<String> {
    let none = others.iter().filter(|results| results.row.is_none());
    let link = |results: &&CaseResults| {
        let name = results.case.name();
        format!("[{}](#{name}) {}", title(results), results.counts().short())
    };
    let links: Vec<String> = none.map(link).collect();
    match links.is_empty() {
        true => Vec::new(),
        false => {
            vec![format!("Cases of many numbers, judged by their gates: {}.", links.join("; "))]
        }
    }
}

/// Meaning of *recommended*, with the largest error of a variant that is recommended elsewhere.
fn recommended(suite: &Suite) -> Vec<String> {
    let worst =
        suite.cases.iter().find(|results| results.case.name() == CASE.name).and_then(|of| {
            let is_shown = |record: &&Record| is_modern_from_lattice(record);
            let error = |record: &Record| record.value(of.studies.error()?.clone());
            let all =
                of.runs.simulations().filter(is_shown).filter_map(|record| {
                    Some((error(record)?, headline(&of.studies, record).ok()?))
                });
            all.max_by(|a, b| a.0.total_cmp(&b.0))
        });
    let recommends = |of: &&CaseResults| {
        of.studies.first::<Card>().is_some() && of.case.recommended().variant == "modern"
    };
    let cases: Vec<String> = suite.cases.iter().filter(recommends).map(title).collect();
    let named = match cases.is_empty() {
        true => String::new(),
        false => format!(", recommended in {},", cases.join(" and ")),
    };
    let but = worst.map(|(_, error)| {
        format!(
            ": in [vortices from a lattice](#taylor_green) `modern`{named} has an error of **{error}**"
        )
    });
    let best = format!("No variant is best everywhere{}.", but.unwrap_or_default());
    const WORDS: &str = "*Recommended* is the default of a case, for a reason that it states; *paper's* is \
                         the model of a paper that is known as a scan without title.";
    const NUMBERS: &str = "± is a standard uncertainty; an error is bold if it is smaller by more than \
                           twice that. *Order*: power of the spacing with which the error falls. *1/10 \
                           error*: factor in cost for a tenth of the error. *Pairs*: pair interactions. a: \
                           column width; c0: sound speed.";
    const VERDICTS: &str = "A *known limitation* is outside its bound and inside a wider one. *None up to* \
                            states the largest value that was run.";
    [best, WORDS.into(), NUMBERS.into(), VERDICTS.into()].into()
}

/// Error against run time, a panel a main case.
fn errors(main: &[&CaseResults]) -> Figure {
    let panel = |results: &&CaseResults| {
        against_run_time(&title(results), results.case, &results.studies, &results.runs)
    };
    let caption = format!(
        "What does a smaller error cost? Run time on one core; points of a line are resolutions.{}",
        session(main).unwrap_or_default()
    );
    let figure = Figure::new("errors", caption).columns(2).panel_size(148.0, 120.0);
    main.iter().filter_map(panel).fold(figure, Figure::panel)
}

/// Day and machine of the session of the other codes, and the ratio of the run times of our own runs there to
/// the run times of this report, least and largest.
fn session(main: &[&CaseResults]) -> Option<String> {
    let ratio = |results: &&CaseResults, peer: &JudgedRun| {
        let peer = &peer.record;
        let is_ours = peer.run.submission.as_ref().is_some_and(|of| of.code == OURS);
        let spec = RunSpec { submission: None, ..peer.spec() };
        let own = results.runs.all.iter().find(|run| run.planned.spec.key() == spec.key())?;
        is_ours.then_some(peer.cost.cpu_s / own.record.cost.alone_median()?)
    };
    let mut peers = main.iter().flat_map(|of| &of.runs.peers).map(|peer| &peer.record);
    let first = peers.find(|record| record.session().is_some())?;
    let (day, cpu) = (first.session()?, plain(&first.manifest.cpu));
    let all = main.iter().flat_map(|of| of.runs.peers.iter().filter_map(|peer| ratio(of, peer)));
    let all: Vec<f64> = all.filter(|ratio| ratio.is_finite()).collect();
    let ends = [f64::min, f64::max].map(|of: fn(f64, f64) -> f64| all.iter().copied().reduce(of));
    let [low, high] = ends.map(|end| end.map(|end| percent(end, 2)));
    Some(format!(
        " Other codes ran on {day} on another machine ({cpu}), in turn with ours, of which the same runs \
         took {} to {} of their time here.",
        low?, high?
    ))
}

/// How this report was made.
fn about(suite: &Suite) -> Section {
    let manifest = Manifest::of_this_process(rayon::current_num_threads());
    let made = format!("{}{} {}", cost(suite), reused(suite), provenance(&manifest));
    let section = Section::new("about", "About this report").prose(made).prose(
        "Results of other codes and [reference data](#references) are stored; all else comes from the runs \
         of this report.",
    );
    let section = of_others(suite).into_iter().fold(section, Section::prose);
    section.child(references_section())
}

/// The name of a case in words.
fn title(results: &CaseResults) -> String {
    let words = results.case.name().replace('_', " ");
    let (first, rest) = words.split_at(1);
    let named = results.studies.first::<Card>().map(|card| card.title.to_string());
    named.unwrap_or_else(|| first.to_uppercase() + rest)
}

/// How runs of other codes ended that the store has, and where they are shown.
fn of_others(suite: &Suite) -> Option<String> {
    let has_some = |of: &&CaseResults| !of.runs.submissions.is_empty();
    let link = |of: &CaseResults| {
        let name = of.case.name();
        format!("[{name}](#study-{}-submissions)", name.replace('_', "-"))
    };
    let links: Vec<String> = suite.cases.iter().filter(has_some).map(link).collect();
    let counts = Counts::of(suite.submitted().map(|of| of.judged.judgement.verdict));
    let words = format!("**Runs of other codes in the store:** {}", counts.headline());
    (!links.is_empty()).then(|| format!("{words} ({}).", links.join(", ")))
}

/// Total cost of all runs of the report.
fn cost(suite: &Suite) -> String {
    let records = || suite.cases.iter().flat_map(|results| &results.runs.all).map(|r| &r.record);
    let cost = || records().map(|record| &record.cost);
    let repeated: f64 = cost().flat_map(|cost| cost.alone_s.iter().skip(1)).sum();
    let stepping: f64 = cost().map(|cost| cost.cpu_s).sum();
    let pairs: f64 = cost().map(|cost| cost.pair_interactions as f64).sum();
    format!(
        "{} took {} of processor time for stepping and {} pair interactions.",
        counted(records().count(), "run", "runs"),
        touchstone_report::seconds(stepping + repeated),
        touchstone_report::sci(pairs, 2)
    )
}

/// Runs that were not made for this page.
fn reused(suite: &Suite) -> String {
    if suite.made.reused == 0 {
        return String::new();
    }
    let were = counted(suite.made.reused, "record was", "records were");
    let other = match suite.made.of_other_sources {
        0 => String::new(),
        count => format!(" **Made by a build of other sources: {count} of them.**"),
    };
    format!(" {were} in the store before.{other}")
}

fn provenance(made_by: &Manifest) -> String {
    let Manifest { touchstone, profile, rustc, cpu, .. } = made_by;
    let state = made_by.state();
    let cores = counted(made_by.cores, "core", "cores");
    let threads = counted(made_by.threads, "thread", "threads");
    format!(
        "Made by touchstone {touchstone} at {state} ({profile} build, {}) on {}, \
         {cores}, {threads}.",
        plain(rustc),
        plain(cpu)
    )
}

/// A gate, its verdict, and the numbers of the reasons.
struct GateRow<'a> {
    of: JudgedOf<'a>,
    reasons: String,
}

/// All verdicts, the worst first, and below each other the reasons, each once.
fn verdicts(suite: &Suite) -> Section {
    let mut notes = Notes::default();
    let mut rows = Vec::new();
    for of in suite.judged() {
        rows.push(GateRow { of, reasons: reasons(of.judged, &mut notes).join(" ") });
    }
    rows.sort_by_key(|row| std::cmp::Reverse(row.of.judged.judgement.verdict));
    let value = |value: Option<f64>| value.map_or(Cell::text("not measured"), measured);
    let margin = |margin: Option<f64>| margin.map_or(Cell::text("–"), |m| Cell::percent(m, 2));
    let gates = TableColumns::<GateRow>::default()
        .with(TableColumn::text("verdict"), |row| Cell::status(row.of.judged.judgement.verdict))
        .text("gate", |row| row.of.judged.gate.id.clone())
        .num(["value", ""], move |row| value(row.of.judged.judgement.value))
        .text("bound", |row| row.of.judged.gate.bounds())
        .num(["margin", ""], move |row| margin(row.of.judged.judgement.margin))
        .marked("run or study", judged_on)
        .text("evidence", |row| format!("{:?}", row.of.judged.gate.evidence).to_lowercase())
        .text("reasons", |row| row.reasons.clone())
        .table("", &rows);
    let reasons = notes.all().map(|(_, reason)| reason.to_string()).collect();
    Section::new(VERDICTS, "All verdicts")
        .prose(
            "A gate compares a number with a bound that has a stated reason. It passes inside the bound, is \
             a known limitation between this bound and a second one, which follows from the cause or is \
             marked as fitted to own runs, and fails otherwise; controls must lie outside. The margin is \
             the unused share of the bound: 100 % is far inside, 0 % is at the bound. For a limitation, \
             the wider bound counts. Select a gate to read its reasons.",
        )
        .block(Block::Explorer(Explorer { gates, reasons }))
}

/// How to read the sections of cases: each kind of table once.
fn reading(suite: &Suite) -> Section {
    let part = |id: &str, title: &str, paragraphs: Vec<String>| {
        Section::new(format!("reading-{id}"), title).block(Block::Prose(paragraphs))
    };
    let owned = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect();
    let mut costs = [READING, studies::cost::READING].concat();
    costs.push(studies::budget::READING);
    let compared = owned(&studies::validation::READING);
    let detected = owned(&[studies::sensitivity::READING]);
    let cases: Vec<_> = suite.cases.iter().map(|of| (of.case, &of.runs)).collect();
    let of_others = studies::submissions::reading(&cases);
    Section::new("reading", "How to read the sections")
        .child(part("costs", "Errors, orders and costs", owned(&costs)))
        .child(part("comparisons", "Comparisons with references", compared))
        .child(part("detected", "Errors that gates detect", detected))
        .child(part("others", "Runs of other codes", of_others))
        .child(part("runs", "All runs", owned(&[RUNS])))
}

/// How to read the runs of a case.
const RUNS: &str = "\
    The file of a case has a line for each run, with the settings that are not the defaults of its variant. \
    A run time that was not timed alone was measured while runs were made in parallel, and is rough.";

/// Notes for all diagrams of a kind.
const READING: [&str; 2] = [
    "A cost diagram shows one point for each run. The number at a point is the resolution. Run time is the \
     processor time of the time stepping on one core, the median of repeated runs with no other run at work; \
     bars reach from the fastest to the slowest. The pale band joins the points that no other beats in both \
     error and cost.",
    "A convergence diagram shows the error over the spacing of particles. The grey line has the \
     order that theory expects. The order in the table below it is a least-squares fit over all levels, with \
     the 95 % interval of Student's t distribution.",
];

/// Numbers of the reasons for a bound, and for a limitation.
fn reasons<'a>(judged: &'a Judged, notes: &mut Notes<'a>) -> Vec<String> {
    let limitation = judged.limitation();
    let cause = judged.gate.cause.as_ref().filter(|_| limitation.is_some());
    let texts = [Some(&*judged.gate.because), cause.map(|cause| &*cause.what), limitation];
    texts.into_iter().flatten().map(|text| notes.number(text).to_string()).collect()
}

/// The run or the study that is judged.
fn judged_on(row: &GateRow) -> String {
    match row.of.of {
        Of::Run(run) => {
            let spec = &run.planned.spec;
            let set = plain(&what(row.of.case, spec));
            format!("{} {set}", code(&spec.variant)).trim_end().to_string()
        }
        Of::Section(of) => format!("[{}](#{})", of.title, anchor(of)),
    }
}

fn case_section(suite: &Suite, results: &CaseResults) -> Section {
    let case = results.case;
    let section =
        Section::new(case.name(), title(results)).counts(results.counts()).prose(case.about());
    let recommended = case.recommended();
    let why = recommended.reason();
    let section = section.prose(format!("**Recommended: `{}`**: {why}.", recommended.variant));
    let grades = crate::graded(case.name()).into_iter();
    let grades: Vec<String> =
        grades.map(|(name, grade)| format!("Reference `{name}`: {grade}.")).collect();
    let section = if grades.is_empty() { section } else { section.prose(grades.join(" ")) };
    let section = results.sections.iter().map(study_section).fold(section, Section::child);
    let variants = variants(suite, case);
    let runs = Section::new(format!("runs-{}", case.name()), "All runs");
    let file = run_file(case, &results.runs.all);
    section.child(runs.block(Block::List(variants)).block(Block::File(file)))
}

/// The variants of a case with their descriptions: a description that several have is stated once, and of
/// one that an earlier case on the page states, its place.
fn variants(suite: &Suite, case: &dyn Case) -> Vec<String> {
    let earlier = || suite.cases.iter().map(|of| of.case).take_while(|of| of.name() != case.name());
    let stated = |about: &str| {
        let case = earlier().find(|of| of.variants().iter().any(|of| of.about == about))?;
        Some(format!("as in [{0}](#runs-{0})", case.name()))
    };
    let mut lines: Vec<(String, Vec<String>)> = Vec::new();
    for variant in case.variants() {
        let words = stated(variant.about).unwrap_or_else(|| variant.about.into());
        match lines.iter_mut().find(|line| line.0 == words) {
            Some(line) => line.1.push(code(variant.name)),
            None => lines.push((words, vec![code(variant.name)])),
        }
    }
    lines.into_iter().map(|(words, names)| format!("{}: {words}", names.join(", "))).collect()
}

/// Sections and figures share a name space; figures are named by their study.
fn anchor(of: &section::Section) -> String {
    format!("study-{}", of.id)
}

fn study_section(of: &section::Section) -> Section {
    let section = Section::new(anchor(of), &of.title).counts(counts(&of.judged));
    of.blocks.iter().cloned().fold(section, Section::block)
}

/// A measured value: a whole number as such, any other with four digits.
fn measured(value: f64) -> Cell {
    let is_whole = value == value.trunc() && value.abs() < 1e6;
    if is_whole { Cell::exact(value) } else { Cell::num(value, 4) }
}

/// A run as a line of a file; its settings are those that are not the defaults of its variant.
#[derive(serde::Serialize)]
struct RunLine {
    variant: String,
    settings: String,
    particles: usize,
    steps: u64,
    pairs: u64,
    #[serde(rename = "run_time_s")]
    run_time: f64,
    timed_alone: bool,
    status: String,
}

fn run_file(case: &dyn Case, runs: &[JudgedRun]) -> DataFile {
    let line = |run: &JudgedRun| {
        let (record, cost) = (&run.record, &run.record.cost);
        let alone = cost.alone_median();
        RunLine {
            variant: record.run.variant.clone(),
            settings: what(case, &record.spec()),
            particles: cost.particles,
            steps: cost.steps,
            pairs: cost.pair_interactions,
            run_time: alone.unwrap_or(cost.cpu_s),
            timed_alone: alone.is_some(),
            status: record.status.to_string(),
        }
    };
    let title = format!("{} (CSV)", counted(runs.len(), "run", "runs"));
    DataFile::of_rows(title, format!("{}-runs.csv", case.name()), runs.iter().map(line))
}

/// Settings that differ from the defaults of the variant, as `key=value`, and the use of the run.
pub(crate) fn what(case: &dyn Case, spec: &RunSpec) -> String {
    let mut words = case::changed(case, spec);
    match &spec.task {
        Task::Simulate => {}
        Task::Bisect(bisect) => words.push(format!("(bisects {})", bisect.setting)),
        Task::Detect(detect) => {
            words.push(format!("(smallest detected error of {})", detect.of.words()))
        }
    }
    words.extend(spec.mutation.map(|m| format!("({} × {})", m.of.words(), m.factor)));
    words.extend(spec.disorder.map(|d| format!("(disorder {} dx, seed {})", d.most, d.seed)));
    words.join(" ")
}

fn references_section() -> Section {
    let row = |name: &str| {
        let cell = Cell::marked(code(name));
        let (cell, texts) = match Reference::load(name) {
            Ok(reference) => {
                let package = &reference.package;
                let names: Vec<&str> = package.licenses.iter().map(|l| l.name.as_str()).collect();
                (cell, [package.title.clone(), reference.graded(), names.join(", ")])
            }
            Err(error) => {
                let failed = cell.with(Verdict::Fail);
                (failed, [plain(&error.to_string()), "–".into(), "–".into()])
            }
        };
        let [title, grade, licence] = texts;
        vec![cell, Cell::marked(title), Cell::text(grade), Cell::text(licence)]
    };
    let caption = "Reference data, embedded with its provenance and checked by hash.";
    let columns = ["reference", "what", "grade", "licence"].map(TableColumn::text);
    let table = Table::new(caption, columns.into());
    let table = Reference::names().into_iter().fold(table, |table, name| table.row(row(name)));
    Section::new("references", "References").block(table)
}
