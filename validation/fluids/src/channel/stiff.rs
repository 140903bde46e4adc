//! What super-time-stepping of viscosity saves: pair interactions of `stiff` against `modern` at one error,
//! over the Reynolds number.

use super::{ChannelSettings, ChannelTable, Flow, For, measure::L2};
use base::{gate::*, record::Record};
use harness::{columns::Columns, runs::Runs, study::Study};
use report::Cell;

/// Reynolds numbers, and the share of the pair interactions of `modern` that is allowed. At the lower one
/// sound limits no step any more, so that the cost is that of accuracy.
pub const REYNOLDS: [(f64, f64); 2] = [(0.5, 1.0 / 5.0), (1e-4, 1.0 / 10.0)];

static SOUND: Cause = Cause::new(
    "Morris' rule makes sound in Poiseuille flow 2.8 times as fast as in Couette flow, and sound sets the \
     step.",
    "A sound speed chosen by the pressure of the flow, which is 0 here, and not by its force.",
);

/// The runs of `modern` and of `stiff` at one Reynolds number and number of rows.
type Pair<'a> = (&'a ChannelSettings, [Option<&'a Record>; 2]);

/// A number of both; NaN for a run that is not there.
fn both((_, records): &Pair, number: impl Fn(&Record) -> f64) -> [f64; 2] {
    records.map(|record| record.map_or(f64::NAN, &number))
}

fn errors(pair: &Pair, flow: Flow) -> [f64; 2] {
    both(pair, |record| record.value(L2.at(flow.compared_at())).unwrap_or(f64::NAN))
}

/// Pair interactions of `stiff` over those of `modern`.
fn share(pair: &Pair) -> f64 {
    let [modern, stiff] = both(pair, |record| record.cost.pair_interactions as f64);
    stiff / modern
}

/// The gates of one pair.
fn gates(flow: Flow, pair: &Pair) -> Vec<(Gate, f64)> {
    let ChannelSettings { rows, re, .. } = *pair.0;
    let id = |what: &str| format!("{}.stiff.{rows}.re{re}.{what}", flow.case().name);
    let [modern, error] = errors(pair, flow);
    let is_poiseuille = flow == Flow::Poiseuille;
    let spacing = if is_poiseuille && modern.is_finite() { modern } else { 0.0 };
    let because = "The bound is 0.1 %, or in Poiseuille flow where the spacing allows no less the error of \
                   `modern` and 0.02 % for time and motion.";
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
        pairs = pairs.with_limitation(Bound::Below(1.05 / 3.7), known).because_of(&SOUND);
    }
    vec![(l2, error), (pairs, share(pair))]
}

/// The study.
pub fn study(flow: Flow, table: &ChannelTable, runs: &Runs) -> Study {
    let caption = format!(
        "Variant `stiff` (super-time-stepping of viscosity) against `modern`: relative L2 error of u at \
         νt/L² = {}, and pair interactions, each stage counted as one pair sweep.",
        flow.compared_at()
    );
    let of = |variant| table.of(For::Stiff).filter(move |row| row.variant == variant);
    let found: Vec<Pair> = of("modern")
        .zip(of("stiff"))
        .map(|(a, b)| (&a.settings, [a, b].map(|row| runs.record(&row.run.spec))))
        .collect();
    let error = move |k: usize| move |pair: &Pair| Cell::percent(errors(pair, flow)[k], 3);
    let shown = Columns::<Pair>::default()
        .num(["rows", "1"], |(s, _)| Cell::count(s.rows as u64))
        .num(["Re", "-"], |(s, _)| Cell::exact(s.re))
        .num(["error, modern", "-"], error(0))
        .num(["error, stiff", "-"], error(1))
        .num(["pairs, modern/stiff", "-"], |pair| Cell::num(1.0 / share(pair), 3))
        .table(caption, &found);
    let (id, title) =
        (format!("{}-stiff", flow.case().name), "Steps that viscosity does not limit");
    let judged = found.iter().flat_map(|pair| gates(flow, pair));
    judged
        .fold(Study::new(&id, title).block(shown), |study, (gate, value)| study.judge(gate, value))
}
