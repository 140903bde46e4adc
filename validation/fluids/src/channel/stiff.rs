//! What super-time-stepping of viscosity saves: pair interactions of `stiff` against `modern` at one error,
//! over the Reynolds number.

use solver::QuinticSpline;

use super::{Channel, ChannelCase, ChannelSettings, Flow, extremes, measure::L2};
use base::{
    gate::{Bound, Cause, Evidence, Gate},
    record::Record,
    spec::RunSpec,
};
use harness::{case::Tier, columns::Columns, runs::Runs, study::Study};
use report::Cell;

/// Reynolds numbers, and the share of the pair interactions of `modern` that is allowed. At the least one
/// sound limits no step any more, so that the cost is that of accuracy.
const REYNOLDS: [(f64, f64); 3] = [(0.5, 1.0 / 5.0), (0.0125, 1.0 / 10.0), (1e-4, 1.0 / 10.0)];

/// Rows of a tier.
fn rows(tier: Tier) -> &'static [usize] {
    match tier {
        Tier::Quick => &[20, 40],
        Tier::Full => &[20, 40, 80],
    }
}

/// The runs of `modern` and of `stiff`.
fn pair(case: &ChannelCase, re: f64, rows: usize) -> [RunSpec; 2] {
    ["modern", "stiff"].map(|variant| case.spec(variant, |s| (s.re, s.rows) = (re, rows)))
}

/// The runs of the study.
pub fn specs(case: &ChannelCase, tier: Tier) -> Vec<RunSpec> {
    let of = |rows: &usize| REYNOLDS.map(|(re, _)| pair(case, re, *rows)).concat();
    rows(tier).iter().flat_map(of).collect()
}

/// Both runs of one Reynolds number and number of rows.
struct Row<'a> {
    re: f64,
    rows: usize,
    allowed: f64,
    /// Of `modern` and of `stiff`.
    records: [Option<&'a Record>; 2],
}

impl Row<'_> {
    /// Numbers of both; NaN for a run that is not there.
    fn both(&self, number: impl Fn(&Record) -> f64) -> [f64; 2] {
        self.records.map(|record| record.map_or(f64::NAN, &number))
    }

    fn pairs(&self) -> [f64; 2] {
        self.both(|record| record.cost.pair_interactions as f64)
    }

    fn errors(&self, tau: f64) -> [f64; 2] {
        self.both(|record| record.value(L2.at(tau)).unwrap_or(f64::NAN))
    }

    fn steps(&self) -> [f64; 2] {
        self.both(|record| record.cost.steps as f64)
    }

    /// Longest step of `stiff` over that which the viscous number allows `modern`.
    fn longest(&self) -> f64 {
        let of = |record: &Record| {
            let s: ChannelSettings = record.settings_as();
            let h = s.h_over_dx * s.width / s.rows as f64;
            record.cost.largest_dt_s * s.nu / (s.viscous * h * h)
        };
        self.both(of)[1]
    }
}

static SOUND: Cause = Cause::new(
    "Morris' rule makes sound in Poiseuille flow 2.8 times as fast as in Couette flow, and sound sets the \
     step.",
    "A sound speed chosen by the pressure of the flow, which is 0 here, and not by its force.",
);

static EDGE: Cause = Cause::new(
    "With h/dx = 1 some neighbours are at the edge of the support, where round-off decides whether they are \
     counted, though they exert no force.",
    "A count of pair sweeps in the record beside that of pair interactions.",
);

/// The gates of one pair.
fn gates(flow: Flow, row: &Row) -> Vec<(Gate, f64)> {
    let id = |what: &str| format!("{}.stiff.{}.re{}.{what}", flow.name(), row.rows, row.re);
    let tau = flow.compared_at();
    let [modern, error] = row.errors(tau);
    let spacing = match flow {
        Flow::Couette => extremes::matrix_error::<QuinticSpline>(row.rows, 1.0, 1e-6),
        Flow::Poiseuille => Some(modern).filter(|error| error.is_finite()),
    };
    let goal = spacing.map_or(1e-3, |spacing| (spacing + 2e-4).max(1e-3));
    let because = "The bound is 0.1 %, or where the spacing allows no less its error and 0.02 % for time and \
                   motion: in Couette flow that of the row-reduced matrix, which is exact in time, in \
                   Poiseuille flow that of `modern`.";
    let accurate = Gate::new(id("l2"), L2.at(tau), Bound::Below(goal), Evidence::Analytic, because);
    let mut gates = vec![(accurate, error)];
    if row.rows >= 40 {
        let because = "Accuracy and sound need fewer steps, each of as many stages as the square root of its \
                       ratio to the explicit limit: the goal is a fifth of the pair interactions at Re 0.5, \
                       where sound sets the step, and a tenth below.";
        let gate = Gate::new(
            id("pairs"),
            "pair interactions/those of modern",
            Bound::Below(row.allowed),
            Evidence::Theory,
            because,
        );
        let slower = flow == Flow::Poiseuille && row.rows == 40 && row.re > 1e-3;
        let known = "The steps that 0.75 of the limit of sound allows, counted before the run, make 1/3.7 at \
                     Re 0.5 and 1/8.4 at Re 0.0125; the bound adds 5 % for pairs at the edge of the kernel.";
        let most = if row.re > 0.1 { 1.05 / 3.7 } else { 1.05 / 8.4 };
        let gate = match slower {
            true => gate.with_limitation(Bound::Below(most), known).because_of(&SOUND),
            false => gate,
        };
        let [modern, stiff] = row.pairs();
        gates.push((gate, stiff / modern));
    }
    gates
}

/// The study.
pub fn study(channel: Channel, tier: Tier, runs: &Runs) -> Study {
    let Channel { flow, case } = channel;
    let tau = flow.compared_at();
    let caption = format!(
        "Variant `stiff` (super-time-stepping of viscosity) against `modern`: relative L2 error of u at \
         νt/L² = {tau}, steps, and pair interactions, each stage counted as one pair sweep."
    );
    let of = |rows: usize| {
        REYNOLDS.map(|(re, allowed)| {
            let records = pair(case, re, rows).map(|spec| runs.record(&spec));
            Row { re, rows, allowed, records }
        })
    };
    let found: Vec<Row> = rows(tier).iter().flat_map(|rows| of(*rows)).collect();
    let count = |number: f64| Cell::count(number as u64);
    let error = |number: f64| Cell::percent(number, 3);
    let table = Columns::<&Row>::default()
        .num(["rows", "1"], |row| Cell::count(row.rows as u64))
        .num(["Re", "-"], |row| Cell::exact(row.re))
        .num(["error, modern", "-"], |row| error(row.errors(tau)[0]))
        .num(["error, stiff", "-"], |row| error(row.errors(tau)[1]))
        .num(["steps, modern", "1"], |row| count(row.steps()[0]))
        .num(["steps, stiff", "1"], |row| count(row.steps()[1]))
        .num(["longest step over that of modern", "-"], |row| Cell::num(row.longest(), 3))
        .num(["pairs, modern", "1"], |row| count(row.pairs()[0]))
        .num(["pairs, stiff", "1"], |row| count(row.pairs()[1]))
        .num(["modern/stiff", "-"], |row| Cell::num(row.pairs()[0] / row.pairs()[1], 3))
        .table(caption, &found);
    let study =
        Study::new(&format!("{}-stiff", flow.name()), "Steps that viscosity does not limit");
    let judged = found.iter().flat_map(|row| gates(flow, row)).chain(creeping(flow, &found));
    judged.fold(study.block(table), |study, (gate, value)| study.judge(gate, value))
}

/// Below Re 0.0125 nothing costs more, on the finest rows.
fn creeping(flow: Flow, found: &[Row]) -> Option<(Gate, f64)> {
    let rows = found.last()?.rows;
    let pairs = |re: f64| {
        let row = found.iter().find(|row| (row.re, row.rows) == (re, rows));
        row.map_or(f64::NAN, |row| row.pairs()[1])
    };
    let because = "At Re 1e-4 viscosity is 125 times as stiff against sound, and accuracy sets the steps, so \
                   no more pair interactions than at Re 0.0125 are needed.";
    let gate = Gate::new(
        format!("{}.stiff.{rows}.creeping", flow.name()),
        "pair interactions at Re 1e-4/at Re 0.0125",
        Bound::Below(1.0),
        Evidence::Theory,
        because,
    );
    let known = "Both runs make 48 steps with as many stages at 40 rows, so the number of pair sweeps is the \
                 same; counted pairs differ by 1.5 %. The bound allows 5 % for pairs at the edge, as for \
                 Poiseuille flow against `modern`.";
    let gate = match flow {
        Flow::Couette => gate.with_limitation(Bound::Below(1.05), known).because_of(&EDGE),
        Flow::Poiseuille => gate,
    };
    Some((gate, pairs(1e-4) / pairs(0.0125)))
}
