//! Runs that other codes made of a case: how they were judged, and as points beside our own ladders.

use base::submission::Division;
use report::Cell;

use crate::{
    columns::Columns,
    declare::{Accuracy, Declaration, Level, Peer},
    runs::{JudgedRun, Runs},
    study::Study,
};

/// The submissions as other codes of an accuracy study: those whose problem is a level of a ladder.
pub fn peers(accuracy: &Accuracy, runs: &Runs) -> Vec<Peer> {
    let of = |run: &JudgedRun| {
        let (record, of) = (&run.record, run.record.submission.as_ref()?);
        let levels = accuracy.ladders.iter().chain(&accuracy.more).flat_map(|of| &of.levels);
        let is_same = |level: &&Level| level.run.spec.settings == record.settings;
        let level = levels.into_iter().find(is_same)?;
        Some(Peer {
            name: format!("{of} ({})", of.division),
            label: level.label.clone(),
            seconds: Some(record.cost.cpu_s).filter(|seconds| seconds.is_finite())?,
            spacing: level.spacing,
            error: accuracy.error.value(record, runs)?,
            timed: "processor time as submitted".into(),
        })
    };
    let mut peers: Vec<Peer> = runs.submissions().iter().filter_map(of).collect();
    peers.sort_by(|a, b| a.name.cmp(&b.name).then(b.spacing.total_cmp(&a.spacing)));
    peers
}

/// All submissions of a case, if there are any: the closed division, then the open one.
pub fn study(case: &str, declared: &Declaration, runs: &Runs) -> Option<Study> {
    if runs.submissions().is_empty() {
        return None;
    }
    let id = format!("{}-submissions", case.replace('_', "-"));
    let study = Study::new(&id, "Runs of other codes")
        .prose(
            "Particles that other codes wrote, measured by the code that measures our own runs and judged by \
             the bounds of the same gates; known limitations of our own method are no excuse. A gate is not \
             applicable if the results do not determine its metric.",
        );
    let of = |division: Division| {
        let is_of = |run: &&JudgedRun| {
            run.record.submission.as_ref().is_some_and(|of| of.division == division)
        };
        runs.submissions().iter().filter(is_of).collect::<Vec<_>>()
    };
    let tables = [
        (Division::Closed, "Closed division: our particles, spacing and support of the kernel."),
        (Division::Open, "Open division: other particles or another resolution, at a stated cost."),
    ];
    let some = tables.into_iter().map(|(division, caption)| (of(division), caption));
    let some = some.filter(|(runs, _)| !runs.is_empty());
    let add = |study: Study, (of, caption): (Vec<&JudgedRun>, &str)| {
        study.block(table(declared, caption, of, runs))
    };
    Some(some.fold(study, add))
}

fn table(declared: &Declaration, caption: &str, of: Vec<&JudgedRun>, runs: &Runs) -> report::Table {
    let words =
        |run: &JudgedRun| run.record.submission.as_ref().map_or(String::new(), |of| of.to_string());
    let error = |run: &JudgedRun| {
        let error = declared.accuracy.first().map(|accuracy| &accuracy.error);
        let error = error.and_then(|error| error.value(&run.record, runs));
        error.map_or(Cell::text("–"), |error| Cell::percent(error, 2))
    };
    let gates = |run: &JudgedRun| {
        let (apply, others) = run.applicable();
        let failed = apply.iter().filter(|judged| judged.judgement.verdict.is_failure()).count();
        let passed = apply.len() - failed;
        format!("{passed} pass, {failed} fail, {} not applicable", others.len())
    };
    Columns::<&JudgedRun>::default()
        .text("code", |run| words(run))
        .code("variant of the problem", |run| &run.record.variant)
        .num(["particles", "1"], |run| Cell::count(run.record.cost.particles as u64))
        .num(["error", "-"], |run| error(run))
        .num(["processor time", "s"], |run| match run.record.cost.cpu_s {
            seconds if seconds.is_finite() => Cell::seconds(seconds),
            _ => Cell::text("unknown"),
        })
        .text("gates", |run| gates(run))
        .text("ended", |run| run.record.status.to_string())
        .table(caption, of)
}
