//! Runs of other codes for a case: their verdicts, and their errors over run time together with ours.

use std::collections::BTreeSet;

use touchstone_base::{
    gate::Verdict,
    record::{Record, name_and_mark},
    submission::{Division, OURS, Submission},
};
use touchstone_report::{Axis, Cell, Figure, Plot, Series, Shape, percent, plain, seconds};

use super::{Accuracy, Card, Comparisons, anchor, cost::error_of};
use crate::{
    case::Case,
    columns::TableColumns,
    looks,
    runs::{Judged, JudgedRun, Runs},
    section::Section,
    study::Studies,
};

/// The code, its scheme and the variant of its problem; of a run of ours the variant.
fn name(run: &JudgedRun, of: &Submission) -> String {
    let Record { run: told, .. } = &run.record;
    match of.code.as_str() {
        OURS if run.record.session().is_some() => format!("ours, {}", told.variant),
        code => format!("{code}, {} ({})", of.scheme, told.variant),
    }
}

/// A submission with an error.
struct SubmissionMark<'a> {
    of: &'a Submission,
    /// Code, scheme and the variant of its problem; of ours the variant.
    name: String,
    /// How many; 0 of a profile or a series of the open division.
    particles: usize,
    /// When it was made together with others.
    session: Option<&'a str>,
    error: f64,
    /// NaN if unknown \[s\].
    seconds: f64,
}

impl SubmissionMark<'_> {
    /// Whether it is a run that the program contains. Other codes may choose any name.
    fn is_ours(&self) -> bool {
        self.of.code == OURS && self.session.is_some()
    }
}

/// The submissions with an error of this study; for equal methods and numbers of particles only the fastest,
/// because a longer run has no other error.
fn marks<'a>(accuracy: &Accuracy, runs: &'a Runs) -> Vec<SubmissionMark<'a>> {
    let of = |run: &'a JudgedRun| {
        let (record, of) = (&run.record, run.record.run.submission.as_ref()?);
        Some(SubmissionMark {
            of,
            name: name(run, of),
            particles: record.cost.particles,
            session: record.session(),
            error: error_of(&accuracy.error, record)?,
            seconds: record.cost.cpu_s,
        })
    };
    let mut marks: Vec<SubmissionMark> = runs.of_others().filter_map(of).collect();
    marks.sort_by(|a, b| a.name.cmp(&b.name).then(a.seconds.total_cmp(&b.seconds)));
    let mut first: Vec<SubmissionMark> = Vec::new();
    for mark in marks {
        let is_same = |of: &SubmissionMark| of.particles == mark.particles && of.name == mark.name;
        if mark.particles == 0 || !first.iter().any(is_same) {
            first.push(mark);
        }
    }
    first
}

/// Where another code is better than ours in one session: in error at an equal number of particles, or in
/// time at no more error, at any resolution.
fn better(marks: &[SubmissionMark]) -> Option<String> {
    let (ours, others): (Vec<&SubmissionMark>, Vec<&SubmissionMark>) =
        marks.iter().partition(|m| m.is_ours());
    if ours.is_empty() || others.is_empty() {
        return None;
    }
    let least = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
    let mut found = Vec::new();
    for peer in others {
        let with = || ours.iter().filter(|own| own.session == peer.session);
        let equal = with().filter(|own| own.particles == peer.particles);
        let error = least(&mut equal.map(|own| own.error));
        let many = Some(peer.particles).filter(|many| *many > 0);
        let many = many.map_or(String::new(), |many| format!("{many} particles, "));
        let who = format!("{} ({many}{})", plain(&peer.name), peer.of.division);
        if error.is_finite() && peer.error < error {
            let [its, best] = [peer.error, error].map(|error| percent(error, 2));
            found.push(format!(
                "{who} has an error of {its}, the best of ours in this problem {best}"
            ));
        }
        let as_good = with().filter(|own| own.error <= peer.error);
        let time = least(&mut as_good.map(|own| own.seconds));
        if time.is_finite() && peer.seconds < time {
            let [its, best] = [peer.seconds, time].map(seconds);
            found.push(format!(
                "{who} takes {its}, the fastest of ours in this problem with no more error {best}"
            ));
        }
    }
    Some(match found.is_empty() {
        true => "No other code below is more accurate than ours in this problem with as many particles, or \
                 faster with no more error."
            .into(),
        false => format!("Better than ours: {}.", found.join("; ")),
    })
}

/// Most names in a legend: a thousand took 2 GB to draw. The table has all.
const MOST_NAMED: usize = 24;

/// Marks by their names: ours and the most accurate of the others, and all others.
fn named<'m, 'a>(
    marks: &'m [SubmissionMark<'a>],
) -> (Vec<&'m [SubmissionMark<'a>]>, Vec<&'m [SubmissionMark<'a>]>) {
    let mut all: Vec<&[SubmissionMark]> = marks.chunk_by(|a, b| a.name == b.name).collect();
    let rank = |marks: &&[SubmissionMark]| {
        let least = marks.iter().map(|mark| mark.error).fold(f64::INFINITY, f64::min);
        if marks[0].is_ours() { -1.0 } else { least }
    };
    if all.len() > MOST_NAMED {
        all.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
    }
    let others = all.split_off(all.len().min(MOST_NAMED));
    all.sort_by(|a, b| a[0].name.cmp(&b[0].name));
    (all, others)
}

/// Error against run time, a panel for each division in which other codes are.
fn figure(id: &str, accuracy: &Accuracy, marks: &[SubmissionMark]) -> Figure {
    let elsewhere = match marks.iter().any(|mark| mark.session.is_none()) {
        true => " Runs from the store were made elsewhere: their seconds compare with no others.",
        false => "",
    };
    let caption =
        format!("Which code reaches an error fastest? Labels are numbers of particles.{elsewhere}");
    let figure = Figure::new(id, caption).panel_size(480.0, 330.0);
    let panel = |division: Division| {
        let is_of = |mark: &&SubmissionMark| mark.of.division == division || mark.is_ours();
        let is_shown = |mark: &&SubmissionMark| mark.seconds.is_finite() && is_of(mark);
        let has_others = marks.iter().filter(is_shown).any(|mark| !mark.is_ours());
        let (x, y) = (Axis::log("run time on one core [s]"), Axis::log(&accuracy.label));
        let plot = Plot::new(format!("{division} division"), x, y);
        let series = |(k, all): (usize, &[SubmissionMark])| {
            let shown = all.iter().filter(is_shown);
            let points = shown.clone().map(|mark| (mark.seconds, mark.error)).collect();
            let labels = shown.map(|mark| match mark.particles {
                0 => String::new(),
                particles => particles.to_string(),
            });
            // Schemes of one code differ in line and marker.
            let subject = if all[0].is_ours() { "ours" } else { &*all[0].of.code };
            let colour = looks::look_of(subject, k).colour;
            Series::line(&all[0].name, points).cycle(k).colour(colour).labels(labels)
        };
        let (named, others) = named(marks);
        let others: Vec<_> = others.into_iter().flatten().filter(is_shown).collect();
        let points = others.iter().map(|mark| (mark.seconds, mark.error)).collect();
        let words = format!("others ({})", others.len());
        let others = Series::line(words, points).open_markers(Shape::Circle);
        let layers = named.into_iter().enumerate().map(series);
        has_others.then(|| layers.fold(plot, Plot::layer).layer(others))
    };
    let panels = [Division::Closed, Division::Open].into_iter().filter_map(panel);
    panels.fold(figure, Figure::panel)
}

/// Runs with fewer particles measure mostly the fixed cost of a step.
const FEW: usize = 120;

/// How to read runs of other codes; `cases` are all cases with their runs.
pub fn reading(cases: &[(&dyn Case, &Runs)]) -> Vec<String> {
    let words = [MEASURED, DIVISIONS].map(String::from);
    words.into_iter().chain(provenance(cases)).collect()
}

const MEASURED: &str = "Particles of other codes, measured by the code that measures our own runs and \
             judged by the same gates; known limitations of our own method do not apply. A gate is not \
             applicable if its metric needs data that no file holds or that were not submitted, or if its \
             bound follows from our own kernel, support and step. A record alone proves nothing: \
             `touchstone submit` measures its results again and refuses a stored record that contradicts \
             them. Versions, seconds and steps are as submitted, because this program cannot check them.";
const DIVISIONS: &str = "Closed division: our particles, spacing and support of the kernel. Open division: \
             other particles or another resolution, at a stated cost. In parentheses is the variant whose \
             problem a code ran. Gates on the error judge the accuracy; a dash: no gate does. Tables omit \
             coarser runs that the figure shows and no gate judges.";

/// Place and time of the runs that the program contains, and notes for their reader.
fn provenance(cases: &[(&dyn Case, &Runs)]) -> Option<String> {
    let peers = || cases.iter().flat_map(|(_, runs)| &runs.peers).map(|run| &run.record);
    let day = peers().find_map(Record::session)?;
    let of = peers().filter_map(|record| record.run.submission.as_deref());
    let versions: BTreeSet<String> = of.map(|of| format!("{} {}", of.code, of.version)).collect();
    let versions = Vec::from_iter(versions).join("; ");
    let mut words = format!(
        "Records that the program contains (`references/peers`) were made on {day} on another machine, in \
         turn with ours, each on one thread while other programs were at work, by {}. Their seconds compare \
         only with each other. The authors of the codes have not reviewed the scripts: a run that is worse \
         than published results may be an error of the script.",
        plain(&versions)
    );
    if peers().any(|record| (1..=FEW).contains(&record.cost.particles)) {
        words += " Seconds with 60 to 120 particles measure the overhead of a step, not the speed of a code.";
    }
    let late = cases.iter().filter_map(|(case, runs)| {
        let late = case.facts().late_variant?;
        let is_ours = |of: &Submission| of.code == OURS;
        let mut runs = runs.peers.iter().map(|run| &run.record.run);
        runs.any(|run| run.variant == late && run.submission.as_deref().is_some_and(is_ours))
            .then_some(late)
    });
    words.extend(late.map(|late| {
        format!(
            " Our `{late}` was added after the first results of the others, of which two were better than \
             ours; omit it to compare first attempts."
        )
    }));
    Some(words)
}

/// Number of pairs of equal results that are named.
const MOST_EQUAL: usize = 10;

/// Results that several codes submitted.
fn equal(runs: &Runs) -> Option<String> {
    let mut found = Vec::new();
    let of = |run: &JudgedRun| run.record.run.submission.as_deref().cloned();
    let all: Vec<Submission> = runs.of_others().filter_map(of).collect();
    for (k, one) in all.iter().enumerate().filter(|(_, one)| one.results.is_some()) {
        let is_borrowed = |other: &&Submission| {
            other.results == one.results && (&other.code, &other.scheme) != (&one.code, &one.scheme)
        };
        found.extend(
            all[k + 1..]
                .iter()
                .filter(is_borrowed)
                .map(|other| plain(&format!("{one} and {other}"))),
        );
    }
    for run in runs.of_others() {
        let is_same =
            |own: &&JudgedRun| own.record.state.is_some() && own.record.state == run.record.state;
        let ours = of(run).filter(|of| of.code != OURS).zip(runs.all.iter().find(is_same));
        found.extend(ours.map(|(of, own)| {
            format!("{} and our own `{}`", plain(&of.to_string()), own.record.run.variant)
        }));
    }
    let more = found.len().saturating_sub(MOST_EQUAL);
    found.truncate(MOST_EQUAL);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    let words = "**Equal results, to the last bit, were handed in:**";
    (!found.is_empty()).then(|| format!("{words} {}{more}.", found.join("; ")))
}

/// All submissions of a case, if there are any: the closed division, then the open one.
pub fn section(case: &str, studies: &Studies, runs: &Runs) -> Option<Section> {
    runs.of_others().next()?;
    let id = anchor(case, "submissions");
    let accuracy = studies.of();
    let found = accuracy.map(|of| (of, marks(of, runs))).find(|(_, marks)| !marks.is_empty());
    let first = found.as_ref().and_then(|(_, marks)| better(marks));
    let words = first.into_iter().chain(equal(runs));
    let section = words.fold(Section::new(&id, "Runs of other codes"), Section::prose);
    let section = match &found {
        Some((accuracy, marks)) => section.block(figure(&format!("{id}-cost"), accuracy, marks)),
        None => section,
    };
    Some(section.block(table(studies, runs)))
}

/// A run of another code in the table of a case.
struct TableRow<'a> {
    of: &'a Submission,
    run: &'a JudgedRun,
    /// NaN without a study that has it.
    error: f64,
    /// Name of the error.
    what: &'a str,
}

impl TableRow<'_> {
    /// The name, with the version of a run that the program does not contain.
    fn code(&self) -> String {
        match self.run.record.session() {
            Some(_) => name(self.run, self.of),
            None => format!("{} ({})", self.of, self.run.record.run.variant),
        }
    }

    /// Whether the figure shows a finer run of this code, and no gate judges this one.
    fn is_only_coarser(&self, all: &[Self]) -> bool {
        let particles = |row: &Self| row.run.record.cost.particles;
        let is_contained = self.run.record.session().is_some() && particles(self) > 0;
        let is_finer = |row: &Self| {
            (row.of.division, row.code()) == (self.of.division, self.code())
                && particles(row) > particles(self)
        };
        is_contained && self.run.applicable().0.is_empty() && all.iter().any(is_finer)
    }
}

/// The runs of the closed division, then of the open one, the best first.
fn table(studies: &Studies, runs: &Runs) -> touchstone_report::Table {
    let rows = runs.of_others().filter_map(|run| {
        let mut all = studies.of::<Accuracy>();
        let found = all.find_map(|of| Some((error_of(&of.error, &run.record)?, &*of.label)));
        let (error, what) = found.unwrap_or((f64::NAN, ""));
        Some(TableRow { of: run.record.run.submission.as_deref()?, run, error, what })
    });
    let mut rows: Vec<TableRow> = rows.collect();
    rows.sort_by(|a, b| a.of.division.cmp(&b.of.division).then(a.error.total_cmp(&b.error)));
    let shown: Vec<&TableRow> = rows.iter().filter(|row| !row.is_only_coarser(&rows)).collect();
    let accuracy = accuracy_metrics(studies);
    let others = accuracy.clone();
    let particles = |row: &TableRow| match row.run.record.cost.particles {
        0 => Cell::text("–"),
        particles => Cell::count(particles as u64),
    };
    TableColumns::<TableRow>::default()
        .text("division", |row| row.of.division.to_string())
        .text("code", TableRow::code)
        .num(["particles", "1"], particles)
        .text("measure", |row| row.what.to_string())
        .of(["error", "-"], |row| row.error, |error| Cell::percent(error, 2))
        .of(["processor time", ""], |row| row.run.record.cost.cpu_s, Cell::seconds)
        .text("accuracy", move |row| of_gates(row.run, &accuracy)[0].clone())
        .text("other gates that fail", move |row| of_gates(row.run, &others)[1].clone())
        .table("Runs of other codes, the best first.", shown)
}

/// Names, without their times, of the metrics that say how accurate a run is.
fn accuracy_metrics(studies: &Studies) -> Vec<String> {
    let errors = studies.of::<Accuracy>().flat_map(|of| [Some(&of.error), of.judged.as_ref()]);
    let errors = errors.flatten().map(|metric| &metric.name);
    let compared = studies.of::<Comparisons>().flat_map(|of| &of.0).map(|of| &of.metric.name);
    let shown = studies.of::<Card>().map(|of| &of.metric.name);
    errors.chain(compared).chain(shown).map(|name| name_and_mark(name).0.to_string()).collect()
}

/// The verdict on the accuracy, and the names of other gates that fail.
fn of_gates(run: &JudgedRun, accuracy: &[String]) -> [String; 2] {
    let (apply, _) = run.applicable();
    let fails = |judged: &&&Judged| judged.judgement.verdict.is_failure();
    let (of_error, others): (Vec<&Judged>, Vec<&Judged>) = apply
        .into_iter()
        .partition(|of| accuracy.iter().any(|name| *name == name_and_mark(&of.gate.metric).0));
    let verdict = match (of_error.is_empty(), of_error.iter().any(|of| fails(&of))) {
        (true, _) => "–".to_string(),
        (_, true) => Verdict::Fail.to_string(),
        _ => Verdict::Pass.to_string(),
    };
    let failing: Vec<String> =
        others.iter().filter(fails).map(|judged| judged.gate.metric.clone()).collect();
    [verdict, if failing.is_empty() { "–".into() } else { failing.join(", ") }]
}

#[cfg(test)]
mod tests {
    use touchstone_base::{
        gate::{Bound, Evidence, Gate},
        record::Metric,
    };

    use super::*;
    use crate::{
        runs::Planned,
        studies::tests::{ERROR, column, run, spec, tables},
    };

    fn of(code: &str) -> Submission {
        let [version, scheme, method] = ["1", "scheme", ""].map(String::from);
        let (code, division) = (code.to_string(), Division::Closed);
        Submission { code, version, scheme, division, method, ..Submission::default() }
    }

    fn mark<'a>(
        of: &'a Submission,
        session: &'a str,
        rows: usize,
        error: f64,
        s: f64,
    ) -> SubmissionMark<'a> {
        let (name, particles, session) = (of.code.clone(), rows, Some(session));
        SubmissionMark { of, name, particles, session, error, seconds: s }
    }

    /// A run of a code with this number of particles, seconds and error; the same error at another time and a
    /// number that is not an accuracy, each with a gate that it fails.
    fn run_of(code: &str, particles: usize, seconds: f64, error: f64) -> JudgedRun {
        let gate = |metric: &str, most: f64| {
            let (id, bound) = (format!("case.{metric}"), Bound::Below(most));
            Gate::new(id, metric, bound, Evidence::Analytic, "made up")
        };
        let spec = spec("seed", 8);
        let mut record = Record::of(&spec, 1);
        for (name, value) in [("error", error), ("error@2", 1.0), ("noise", 1.0)] {
            record.metrics.insert(name.into(), Metric::new(value, "-", "made up"));
        }
        record.run.submission = Some(Box::new(of(code)));
        (record.cost.particles, record.cost.cpu_s) = (particles, seconds);
        let gates = vec![gate("error", 10.0), gate("error@2", 0.1), gate("noise", 0.1)];
        JudgedRun::new(Planned::new(spec).judged(gates), record)
    }

    fn of_others(submissions: Vec<JudgedRun>) -> Runs {
        let mut runs = Runs::new(Vec::new());
        runs.submissions = submissions;
        runs
    }

    fn accuracy() -> Accuracy {
        Accuracy::new("case", ERROR, "Error [-]")
    }

    /// Among runs of one code with equal numbers of particles only the fastest is shown; curves, which have
    /// no particles, are all shown.
    #[test]
    fn the_fastest_of_one_code_with_as_many_particles_is_shown() {
        let of = [(10, 3.0, 0.3), (10, 1.0, 0.2), (20, 2.0, 0.1), (0, 5.0, 0.5), (0, 6.0, 0.6)];
        let runs = of_others(of.map(|(count, s, error)| run_of("code", count, s, error)).into());
        let shown: Vec<f64> = marks(&accuracy(), &runs).iter().map(|mark| mark.error).collect();
        assert_eq!(shown, [0.2, 0.1, 0.5, 0.6]);
    }

    /// Errors at all times belong to the accuracy, which one failing gate fails; the best is the first.
    #[test]
    fn the_table_has_the_best_first_and_the_accuracy_apart() {
        let runs = of_others(vec![run_of("worse", 10, 1.0, 0.3), run_of("better", 10, 1.0, 0.2)]);
        let studies = Studies::default().with(accuracy());
        let section = section("case", &studies, &runs).expect("there are others");
        let table = tables(&section)[0];
        assert_eq!(column(table, "error"), ["20 %", "30 %"]);
        assert_eq!(
            column(table, "accuracy"),
            [Verdict::Fail.to_string(), Verdict::Fail.to_string()]
        );
        assert_eq!(column(table, "other gates that fail"), ["noise"; 2]);
    }

    /// Equal results are reported for two codes, and for a code that submitted ours, but not within one code
    /// or among ours.
    #[test]
    fn equal_results_are_told_of_different_codes() {
        let with = |code: &str, results: &str| {
            let mut run = run_of(code, 10, 1.0, 0.1);
            run.record.state = Some("state".into());
            run.record.run.submission.as_mut().expect("a submission").results =
                Some(results.into());
            run
        };
        let told = |all: &[(&str, &str)]| {
            equal(&of_others(all.iter().map(|of| with(of.0, of.1)).collect()))
        };
        assert!(told(&[("one", "a"), ("one", "a")]).is_none(), "one code twice");
        assert!(told(&[("one", "a"), ("two", "b")]).is_none(), "other results");
        assert!(told(&[("one", "a"), ("two", "a")]).is_some_and(|words| words.contains("two")));
        let of = |code| {
            let mut own = run(spec("seed", 8), |_| ());
            own.record.state = Some("state".into());
            let mut runs = Runs::new(vec![own]);
            runs.submissions = vec![with(code, "a")];
            equal(&runs)
        };
        assert!(of("one").is_some_and(|words| words.contains("our own")));
        assert!(of(OURS).is_none());
    }

    /// A page of a thousand submissions took 2 GB, for a legend of a thousand lines.
    #[test]
    fn a_figure_names_the_best_of_many_codes_and_counts_the_others() {
        let all: Vec<Submission> = (0..100).map(|k| of(&format!("code-{k:02}"))).collect();
        let error = |k: usize| 0.01 * (1.0 + (k as f64 - 50.5).abs());
        let mut marks: Vec<SubmissionMark> =
            all.iter().enumerate().map(|(k, of)| mark(of, "a", 10, error(k), 1.0)).collect();
        let ours = of(OURS);
        marks.push(mark(&ours, "a", 10, 9.0, 1.0));
        let (shown, others) = named(&marks);
        let names: Vec<&str> = shown.iter().map(|marks| &*marks[0].name).collect();
        assert_eq!([names.len(), others.len()], [MOST_NAMED, 101 - MOST_NAMED]);
        assert!(names.contains(&OURS) && names.contains(&"code-50") && !names.contains(&"code-00"));
        assert!(names.is_sorted());
        let (few, none) = named(&marks[..3]);
        assert!(few.len() == 3 && none.is_empty());
    }

    /// At equal resolution errors compare, at no more error times, and nothing across sessions.
    #[test]
    fn what_is_better_than_ours_in_the_same_session_is_said() {
        let (ours, peer) = (of(OURS), of("other"));
        let said = |marks: &[SubmissionMark]| better(marks).expect("there are both");
        let own = [mark(&ours, "a", 10, 0.02, 1.0), mark(&ours, "a", 20, 0.005, 4.0)];
        let with = |error, seconds, session| {
            let [coarse, fine] = [(10, 0.02, 1.0), (20, 0.005, 4.0)]
                .map(|(rows, error, s)| mark(&ours, "a", rows, error, s));
            said(&[coarse, fine, mark(&peer, session, 10, error, seconds)])
        };
        assert!(with(0.03, 2.0, "a").starts_with("No other code"));
        let text = with(0.01, 5.0, "a");
        assert!(
            text.contains("the best of ours in this problem 2.0") && !text.contains("takes"),
            "{text}"
        );
        let text = with(0.03, 0.5, "a");
        assert!(
            text.contains("with no more error 1.0") && !text.contains("has an error"),
            "{text}"
        );
        assert!(with(0.01, 0.5, "b").starts_with("No other code"), "another session");
        assert!(better(&own).is_none(), "ours alone");
    }
}
