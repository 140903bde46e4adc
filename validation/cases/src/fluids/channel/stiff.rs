//! Gain of super-time-stepping of viscosity: pair interactions of `stiff` against `modern` at one error, over
//! the Reynolds number.

use touchstone_base::{gate::Cause, spec::RunSpec};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    runs::Runs,
    section::Section,
    studies::{CustomStudy, Study},
};

use super::{ChannelSettings, ChannelTable, Flow, Group, Row, measure::L2};

/// Reynolds numbers, and the largest allowed ratio of pair interactions to `modern`. At the lower one sound
/// does not limit the step, so that accuracy determines the cost.
pub const REYNOLDS: [(f64, f64); 2] = [(0.5, 1.0 / 5.0), (1e-4, 1.0 / 10.0)];

static SOUND: Cause = Cause::new(
    "By Morris' rule sound in Poiseuille flow is 2.8 times as fast as in Couette flow, and sound limits the \
     step.",
    "A sound speed chosen by the pressure of the flow, which is 0 here, and not by its force.",
);

/// The gates of a run of `stiff`: on its error, and on its pair interactions over the ones of `modern`.
/// `modern` is the error of `modern`, NaN without a run.
fn gates(flow: Flow, settings: &ChannelSettings, modern: f64) -> [Gate; 2] {
    let ChannelSettings { rows, re, .. } = *settings;
    let id = |what: &str| format!("{}.stiff.{rows}.re{re}.{what}", flow.case().name);
    let is_poiseuille = flow == Flow::Poiseuille;
    let spacing = if is_poiseuille && modern.is_finite() { modern } else { 0.0 };
    let because = "The bound is 0.1 %. Where the spacing alone has a larger error, in Poiseuille flow, the \
                   bound is the error of `modern` plus 0.02 % for time and motion.";
    let (metric, goal) = (L2.at(flow.compared_at()), Bound::Below((spacing + 2e-4).max(1e-3)));
    let l2 = Gate::new(id("l2"), metric, goal, Evidence::Analytic, because);
    let allowed = REYNOLDS.iter().find(|(of, _)| *of == re).map_or(0.0, |(_, allowed)| *allowed);
    let because = "Accuracy and sound need fewer steps, each of as many stages as the square root of its \
                   ratio to the explicit limit: the goal is a fifth of the pair interactions at Re 0.5, \
                   where sound sets the step, and a tenth below.";
    let (metric, bound) = ("pair interactions/those of modern", Bound::Below(allowed));
    let mut pairs = Gate::new(id("pairs"), metric, bound, Evidence::Theory, because);
    if is_poiseuille && rows == 40 && re > 0.1 {
        let known = "The steps that 0.75 of the limit of sound allows, counted before the run, make 1/3.7; \
                     the bound adds 5 % for pairs at the edge of the kernel.";
        pairs = pairs.with_limitation(Bound::Below(1.05 / 3.7), known, &SOUND);
    }
    [l2, pairs]
}

/// The study.
pub fn study(flow: Flow, table: &ChannelTable) -> impl Study + use<> {
    let of = |variant| table.of(Group::Stiff).filter(move |row| row.variant == variant);
    let pair = |(modern, stiff): (&Row, &Row)| {
        ([modern, stiff].map(|row| row.run.spec.clone()), stiff.settings.clone())
    };
    let pairs: Vec<([RunSpec; 2], ChannelSettings)> =
        of("modern").zip(of("stiff")).map(pair).collect();
    let section = move |runs: &Runs| {
        let id = format!("{}-stiff", flow.case().name);
        let section = Section::new(&id, "Steps that viscosity does not limit");
        pairs.iter().fold(section, |section, (specs, settings)| {
            let records = specs.each_ref().map(|spec| runs.record(spec));
            let error = |record: &Record| record.value(L2.at(flow.compared_at()));
            let errors = records.map(|record| record.and_then(error).unwrap_or(f64::NAN));
            let count = |record: &Record| record.cost.pair_interactions as f64;
            let counts = records.map(|record| record.map_or(f64::NAN, count));
            let [l2, pairs] = gates(flow, settings, errors[0]);
            section.judge(l2, errors[1]).judge(pairs, counts[1] / counts[0])
        })
    };
    CustomStudy { runs: table.planned(Group::Stiff), section }
}
