//! Runs the plans of cases, side by side, and judges them: what `verify` and `report` share.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::{
    case::{Case, Planned, RunError, Tier},
    runner::Context,
};
use base::{
    gate::{Gate, Judgement, Verdict},
    record::Record,
};
use report::Block;

/// A run of a plan with its record and its judgements.
#[derive(Clone, Debug)]
pub struct JudgedRun {
    /// Name of the case.
    pub case: &'static str,
    /// What was planned.
    pub planned: Planned,
    /// What came out.
    pub record: Record,
    /// One judgement a gate.
    pub judged: Vec<Judged>,
}

/// A gate and its judgement.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The gate.
    pub gate: Gate,
    /// The judgement.
    pub judgement: Judgement,
}

impl Judged {
    /// Judges a value.
    pub fn new(gate: Gate, value: Option<f64>) -> Self {
        let judgement = gate.judge(value);
        Self { gate, judgement }
    }
}

/// A statement from many runs: what the report shows, and the gates on it.
#[derive(Clone, Debug)]
pub struct Study {
    /// Anchor in the report: letters, digits, hyphens.
    pub id: String,
    /// Title of the section.
    pub title: String,
    /// Prose, figures, tables.
    pub blocks: Vec<Block>,
    /// Judgements on what was found.
    pub judged: Vec<Judged>,
}

impl Study {
    /// An empty study.
    pub fn new(id: &str, title: &str) -> Self {
        Self { id: id.into(), title: title.into(), blocks: Vec::new(), judged: Vec::new() }
    }

    /// The same with one more block.
    pub fn block(mut self, block: impl Into<Block>) -> Self {
        self.blocks.push(block.into());
        self
    }

    /// The same with one more paragraph.
    pub fn prose(self, text: impl Into<String>) -> Self {
        self.block(Block::Prose(vec![text.into()]))
    }

    /// The same with a judged value.
    pub fn judge(mut self, gate: Gate, value: f64) -> Self {
        self.judged.push(Judged::new(gate, Some(value)));
        self
    }
}

/// Everything of one case.
pub struct CaseResults {
    /// The case.
    pub case: &'static dyn Case,
    /// Its runs, in the order of the plan.
    pub runs: Vec<JudgedRun>,
    /// Its studies.
    pub studies: Vec<Study>,
}

/// Everything.
pub struct Suite {
    /// How much was run.
    pub tier: Tier,
    /// One entry a case.
    pub cases: Vec<CaseResults>,
    /// Studies of the method itself.
    pub studies: Vec<Study>,
}

impl Suite {
    /// Every judgement.
    pub fn judged(&self) -> impl Iterator<Item = &Judged> {
        let of_cases = self.cases.iter().flat_map(|case| {
            let runs = case.runs.iter().flat_map(|run| &run.judged);
            runs.chain(case.studies.iter().flat_map(|study| &study.judged))
        });
        of_cases.chain(self.studies.iter().flat_map(|study| &study.judged))
    }

    /// Gates that failed.
    pub fn failures(&self) -> usize {
        self.judged().filter(|j| j.judgement.verdict.is_failure()).count()
    }

    /// Gates that passed.
    pub fn passes(&self) -> usize {
        self.judged().filter(|j| j.judgement.verdict == Verdict::Pass).count()
    }
}

/// Told after each run and each case's studies: how many are done, how many there are, the name.
pub type Progress<'a> = dyn Fn(usize, usize, &str) + Sync + 'a;

/// How a suite is watched and stopped.
#[derive(Default)]
pub struct Watch<'a> {
    /// Told after each run.
    pub progress: Option<&'a Progress<'a>>,
    /// Set from outside to stop.
    pub interrupt: Option<&'a AtomicBool>,
}

/// Runs the plans of `cases` side by side on the threads of the current pool, each run serial, then
/// the studies. `of_the_method` adds the studies that belong to no case.
pub fn run(
    cases: &[&'static dyn Case],
    tier: Tier,
    of_the_method: Option<fn(Tier) -> Vec<Study>>,
    watch: &Watch,
) -> Result<Suite, RunError> {
    let plans: Vec<(&'static dyn Case, Planned)> = cases
        .iter()
        .flat_map(|&case| case.plan(tier).into_iter().map(move |planned| (case, planned)))
        .collect();
    let parts = cases.len() + usize::from(of_the_method.is_some());
    let told = Told { watch, all: plans.len() + parts, done: AtomicUsize::new(0) };
    let mut results = run_longest_first(plans, &told)?;
    let mut suite = Suite { tier, cases: Vec::new(), studies: Vec::new() };
    if watch.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
        return Ok(suite); // nothing can be said of runs that were cut short
    }
    let mut judged = Vec::new();
    for &case in cases {
        let rest = results.iter().position(|r| r.case != case.name()).unwrap_or(results.len());
        judged.push((case, results.drain(..rest).collect::<Vec<JudgedRun>>()));
    }
    // Side by side: at the end of a study that is parallel itself a thread would wait for the other.
    let study = |(case, runs): (&'static dyn Case, Vec<JudgedRun>)| {
        let studies = case.studies(tier, &runs);
        told.done(&format!("{} studies", case.name()));
        CaseResults { case, runs, studies }
    };
    let method = || {
        let studies = of_the_method.map_or_else(Vec::new, |studies| studies(tier));
        told.done("studies of the method");
        studies
    };
    (suite.studies, suite.cases) =
        rayon::join(method, || judged.into_par_iter().map(study).collect());
    Ok(suite)
}

/// Counts what is done, and says so.
struct Told<'a> {
    watch: &'a Watch<'a>,
    all: usize,
    done: AtomicUsize,
}

impl Told<'_> {
    fn done(&self, name: &str) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(progress) = self.watch.progress {
            progress(done.min(self.all), self.all, name);
        }
    }
}

/// Runs the plans side by side, and returns them in the order given. Each thread takes the longest run
/// that is left.
fn run_longest_first(
    plans: Vec<(&'static dyn Case, Planned)>,
    told: &Told,
) -> Result<Vec<JudgedRun>, RunError> {
    let mut order: Vec<usize> = (0..plans.len()).collect();
    order.sort_by(|&a, &b| plans[b].1.seconds.total_cmp(&plans[a].1.seconds));
    let next = AtomicUsize::new(0);
    let work = |_: rayon::BroadcastContext<'_>| {
        let mut mine = Vec::new();
        while let Some(&k) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
            let (case, planned) = &plans[k];
            mine.push((k, run_planned(*case, planned.clone(), told.watch.interrupt)?));
            told.done(&format!("{} {}", case.name(), planned.variant));
        }
        Ok(mine)
    };
    let results: Result<Vec<Vec<(usize, JudgedRun)>>, RunError> =
        rayon::broadcast(work).into_iter().collect();
    let mut results: Vec<(usize, JudgedRun)> = results?.into_iter().flatten().collect();
    results.sort_by_key(|(k, _)| *k);
    Ok(results.into_iter().map(|(_, run)| run).collect())
}

/// Runs and judges one planned run. A run that diverges is a result, and its gates fail.
pub fn run_planned(
    case: &'static dyn Case,
    planned: Planned,
    interrupt: Option<&AtomicBool>,
) -> Result<JudgedRun, RunError> {
    let context = Context { threads: 1, interrupt, keep_particles: true, ..Context::default() };
    let record = case.run(planned.variant, &planned.set, &context)?;
    let judge = |gate: &Gate| Judged::new(gate.clone(), gate.value(&record));
    let judged = planned.gates.iter().map(judge).collect();
    Ok(JudgedRun { case: case.name(), planned, record, judged })
}
