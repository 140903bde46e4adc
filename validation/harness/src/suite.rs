//! Planning, making and judging of all runs, which `verify` and `report` share.

use rayon::prelude::*;
use touchstone_base::{
    absent::Absent,
    record::{self, Record, Status},
    submission::SESSION,
};
use touchstone_report::{Counts, Subject};

use crate::{
    case::{Case, Facts, Planned, Tier},
    gates::GateIndex,
    make::{self, BatchOptions, BatchResult},
    plan,
    runs::{Judged, JudgedRun, Runs, counts},
    sealed,
    section::Section,
    studies::{self, Studies},
};

/// The runs and sections of one case.
pub struct CaseResults {
    /// The case.
    pub case: &'static dyn Case,
    /// Runs, in the order of the plan.
    pub runs: Runs,
    /// Studies.
    pub studies: Studies,
    /// The sections of its studies, in their order.
    pub sections: Vec<Section>,
    /// Its row on the first screen of the report.
    pub row: Option<Subject>,
}

impl CaseResults {
    /// How its gates ended.
    pub fn counts(&self) -> Counts {
        counts(self.judged().map(|of| of.judged))
    }

    /// Every judgement on runs of other codes that the store has.
    pub fn submitted(&self) -> impl Iterator<Item = JudgedOf<'_>> {
        let of = |run| {
            let (apply, _) = JudgedRun::applicable(run);
            apply.into_iter().map(move |judged| (run, judged))
        };
        let case = self.case;
        let all = self.runs.submissions.iter().flat_map(of);
        all.map(move |(run, judged)| JudgedOf { case, of: Of::Run(run), judged })
    }

    /// Every judgement on the case and on our own runs of it.
    pub fn judged(&self) -> impl Iterator<Item = JudgedOf<'_>> {
        let runs = self.runs.all.iter().map(|run| (Of::Run(run), &run.judged));
        let sections = self.sections.iter().map(|section| (Of::Section(section), &section.judged));
        let case = self.case;
        runs.chain(sections)
            .flat_map(move |(of, all)| all.iter().map(move |judged| JudgedOf { case, of, judged }))
    }

    /// The run of the recommended variant on its card, if it has one.
    pub fn recommended(&self) -> Option<&Record> {
        self.runs.record(self.studies.first::<studies::Card>()?.runs.first()?)
    }
}

/// The owner of a gate.
#[derive(Clone, Copy)]
pub enum Of<'a> {
    /// One run.
    Run(&'a JudgedRun),
    /// The section of a study.
    Section(&'a Section),
}

/// A judgement with its owner.
#[derive(Clone, Copy)]
pub struct JudgedOf<'a> {
    /// The case.
    pub case: &'static dyn Case,
    /// The run that was judged, or the section.
    pub of: Of<'a>,
    /// The judgement.
    pub judged: &'a Judged,
}

/// The results of all cases.
pub struct Suite {
    /// How much was run.
    pub tier: Tier,
    /// One entry per case.
    pub cases: Vec<CaseResults>,
    /// How its records came about; they themselves are in the cases. Nothing is judged if it was interrupted.
    pub made: BatchResult,
}

impl Suite {
    /// Every judgement on our own runs.
    pub fn judged(&self) -> impl Iterator<Item = JudgedOf<'_>> {
        self.cases.iter().flat_map(CaseResults::judged)
    }

    /// Every judgement on runs of other codes that the store has.
    pub fn submitted(&self) -> impl Iterator<Item = JudgedOf<'_>> {
        self.cases.iter().flat_map(CaseResults::submitted)
    }

    /// The runs of other codes that the store has.
    pub fn submissions(&self) -> impl Iterator<Item = (&CaseResults, &JudgedRun)> {
        self.cases.iter().flat_map(|of| of.runs.submissions.iter().map(move |run| (of, run)))
    }

    /// How all gates of our own runs ended, and how many simulations diverged.
    pub fn counts(&self) -> Counts {
        let all = self.cases.iter().flat_map(|case| &case.runs.all);
        let has_diverged = |run: &&JudgedRun| {
            let is_simulation = run.record.run.is_simulation();
            is_simulation && matches!(run.record.status, Status::Diverged { .. })
        };
        let diverged: Vec<&JudgedRun> = all.filter(has_diverged).collect();
        let unexpected = diverged.iter().filter(|run| !run.may_diverge()).count();
        let judged = counts(self.judged().map(|of| of.judged));
        Counts { diverged: diverged.len(), unexpected, ..judged }
    }
}

/// The plans of several cases.
pub type Plans = Vec<(&'static dyn Case, Vec<Planned>)>;

/// The plans of these cases.
pub fn plans(cases: &[&'static dyn Case], tier: Tier) -> Plans {
    cases.iter().map(|&case| (case, plan::of_case(case, tier))).collect()
}

/// Plans the cases, makes the missing runs of the store, and judges.
pub fn run(cases: &[&'static dyn Case], making: &BatchOptions) -> Suite {
    let plans = plans(cases, making.tier);
    let made = make::make(make::stored(&make::jobs(plans.clone()), making), making);
    judge(plans, making.tier, made)
}

/// Judges the records of plans: gates run by run, then studies. A pure function of the records.
pub fn judge(plans: Plans, tier: Tier, mut made: BatchResult) -> Suite {
    if made.interrupted {
        return Suite { tier, cases: Vec::new(), made }; // runs that were cut short are not judged
    }
    let of_plans: Vec<(&'static dyn Case, Runs)> = plans
        .into_iter()
        .map(|(case, plan)| {
            let mut runs = Runs::of(plan, &mut made.records);
            let index = GateIndex::of(case);
            let of_case = |records: &[Record]| {
                let of_case = records.iter().filter(|record| record.run.case == case.name());
                of_case.map(|record| submitted(&index, record.clone())).collect()
            };
            // Our runs made in turn with other codes are part of the program.
            let others = made.submissions.iter_mut();
            others.for_each(|record| drop(record.numerics.remove(SESSION)));
            (runs.submissions, runs.peers) = (of_case(&made.submissions), of_case(&made.peers));
            (case, runs)
        })
        .collect();
    let evaluated = |(case, runs): (&'static dyn Case, Runs)| {
        let (name, studies) = (case.name(), case.studies(tier));
        let mut sections = studies.evaluate(name, &runs);
        sections.extend(studies::submissions::section(name, &studies, &runs));
        let row = studies::card::row(case, &studies, &sections, &runs);
        CaseResults { case, runs, studies, sections, row }
    };
    let cases = of_plans.into_par_iter().map(evaluated).collect();
    Suite { tier, cases, made }
}

/// The run of another code, judged by the gates of our plans for the same settings: see
/// [`touchstone_base::gate::Gate::for_submission`].
pub fn submitted(index: &GateIndex, mut record: Record) -> JudgedRun {
    mark_own_metrics_absent(index.case, &mut record);
    let spec = record.spec();
    let of = spec.submission.as_deref();
    // Bounds of sealed problems apply to any method.
    let is_sealed = of.is_some_and(|of| of.seed.is_some());
    let states = is_sealed || of.is_some_and(|of| of.states_our_method);
    let gates = match is_sealed {
        true => sealed::gates(index, &spec),
        false => index.gates(&spec),
    };
    let (mut judged, mut not_of_others) = (Vec::new(), Vec::new());
    for gate in gates {
        let id = gate.id.clone();
        match gate.for_submission(states) {
            Some(gate) => judged.push(gate),
            None => not_of_others.push(id),
        }
    }
    JudgedRun { not_of_others, ..JudgedRun::new(Planned::new(spec).judged(judged), record) }
}

/// Removes metrics that only our own runs have, such as `impulse` and `impulse@phase1`, from a run of another
/// code.
pub fn mark_own_metrics_absent(case: &dyn Case, record: &mut Record) {
    let Facts { costly, stepwise, of_methods, .. } = case.facts();
    for (metrics, why) in
        [(costly, Absent::OwnTerms), (stepwise, Absent::EveryStep), (of_methods, Absent::OwnTheory)]
    {
        let is_ours = |name: &str| record::is_of(metrics, name);
        record.take_out(&|name, _| is_ours(name), &why);
        // For a diverged run the case states another reason, or none.
        let named = record.absent.iter_mut().filter(|(name, _)| is_ours(name));
        named.for_each(|(_, reason)| *reason = why.clone());
        for name in metrics.iter().map(|metric| String::from(*metric)) {
            record.absent.entry(name).or_insert_with(|| why.clone());
        }
    }
}
