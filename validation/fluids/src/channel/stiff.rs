//! What super-time-stepping of viscosity saves: pair interactions of `stiff` against `modern` at one error, over
//! the Reynolds number.

use solver::QuinticSpline;

use super::{Channel, ChannelCase, ChannelSettings, Flow, extremes, measure::L2};
use base::{
    gate::{Bound, Cause, Evidence, Gate},
    record::Record,
    spec::RunSpec,
};
use harness::{case::Tier, columns::Columns, runs::Runs, study::Study};
use report::Cell;

/// Reynolds numbers, and the share of the pair interactions of `modern` that is allowed. At the least one sound
/// limits no step any more, so that the cost is that of accuracy.
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
    modern: &'a Record,
    stiff: &'a Record,
}

impl Row<'_> {
    fn share(&self) -> f64 {
        let [stiff, modern] =
            [self.stiff, self.modern].map(|record| record.cost.pair_interactions as f64);
        stiff / modern
    }
}

static SOUND: Cause = Cause::new(
    "Sound sets the step of Poiseuille flow: Morris' rule, c0² = F L/δ with F L = 8 ν V/L, makes it 2.8 times as \
     fast as in Couette flow at the same Reynolds number.",
    "A sound speed that is chosen by the pressure that the flow has, which is 0 here, and not by its force.",
    "2026-11-23",
);

/// The gates of one pair.
fn gates(flow: Flow, row: &Row) -> Vec<(Gate, f64)> {
    let id = |what: &str| format!("{}.stiff.{}.re{}.{what}", flow.name(), row.rows, row.re);
    let tau = flow.compared_at();
    let [error, modern] =
        [row.stiff, row.modern].map(|record| record.value(L2.at(tau)).unwrap_or(f64::NAN));
    let spacing = match flow {
        Flow::Couette => extremes::matrix_error::<QuinticSpline>(row.rows, 1.0, 1e-6),
        Flow::Poiseuille => Some(modern),
    };
    let goal = spacing.map_or(1e-3, |spacing| (spacing + 2e-4).max(1e-3));
    let because = "0.1 %, or what the spacing makes and 0.02 % more for time and motion: of Couette flow the error \
                   of the row-reduced matrix, exact in time, of Poiseuille flow that of `modern`";
    let accurate = Gate::new(id("l2"), L2.at(tau), Bound::Below(goal), Evidence::Analytic, because);
    let mut gates = vec![(accurate, error)];
    if row.rows >= 40 {
        let because = "the steps that accuracy and sound need, each of as many stages as the square root of its \
                       ratio to the explicit limit: a fifth at Re 0.5, where sound is the faster, and a tenth below";
        let gate = Gate::new(
            id("pairs"),
            "pair interactions/those of modern",
            Bound::Below(row.allowed),
            Evidence::Theory,
            because,
        );
        let slower = flow == Flow::Poiseuille && row.rows == 40 && row.re > 1e-3;
        let known = "the steps that 0.75 of the limit of sound allows, counted before the run: 1/3.7 at Re 0.5, \
                     1/8.4 at Re 0.0125, and 5 % more for pairs at the edge of the kernel";
        let most = if row.re > 0.1 { 1.05 / 3.7 } else { 1.05 / 8.4 };
        let gate = match slower {
            true => gate.with_limitation(Bound::Below(most), known).because_of(&SOUND),
            false => gate,
        };
        gates.push((gate, row.share()));
    }
    gates
}

/// The study.
pub fn study(channel: Channel, tier: Tier, runs: &Runs) -> Study {
    let Channel { flow, case } = channel;
    let tau = flow.compared_at();
    let caption = format!(
        "Variant `stiff` (super-time-stepping of viscosity) against `modern`: relative L2 error of u at νt/L² = \
         {tau}, steps, and pair interactions, each stage counted as the pair sweep that it is."
    );
    let of = |rows: usize| {
        REYNOLDS.into_iter().filter_map(move |(re, allowed)| {
            let [modern, stiff] = pair(case, re, rows).map(|spec| runs.record(&spec));
            Some(Row { re, rows, allowed, modern: modern?, stiff: stiff? })
        })
    };
    let found: Vec<Row> = rows(tier).iter().flat_map(|rows| of(*rows)).collect();
    let error = |record: &Record| Cell::percent(record.value(L2.at(tau)).unwrap_or(f64::NAN), 3);
    let limit = |row: &&Row| {
        let s: ChannelSettings = row.stiff.settings_as();
        // Viscous number 0.4 of `modern`.
        let explicit = 0.4 * (s.width * s.h_over_dx / s.rows as f64).powi(2) / s.nu;
        Cell::num(row.stiff.cost.largest_dt_s / explicit, 3)
    };
    let table = Columns::<&Row>::default()
        .num(["rows", "1"], |row| Cell::count(row.rows as u64))
        .num(["Re", "-"], |row| Cell::exact(row.re))
        .num(["error, modern", "-"], |row| error(row.modern))
        .num(["error, stiff", "-"], |row| error(row.stiff))
        .num(["steps, modern", "1"], |row| Cell::count(row.modern.cost.steps))
        .num(["steps, stiff", "1"], |row| Cell::count(row.stiff.cost.steps))
        .num(["longest step", "viscous number 0.4"], limit)
        .num(["pairs, modern", "1"], |row| Cell::count(row.modern.cost.pair_interactions))
        .num(["pairs, stiff", "1"], |row| Cell::count(row.stiff.cost.pair_interactions))
        .num(["ratio", "-"], |row| Cell::num(1.0 / row.share(), 3))
        .table(caption, &found);
    let study =
        Study::new(&format!("{}-stiff", flow.name()), "Steps that viscosity does not limit");
    let judged = found.iter().flat_map(|row| gates(flow, row)).chain(creeping(flow, &found));
    judged.fold(study.block(table), |study, (gate, value)| study.judge(gate, value))
}

/// Below Re 0.0125 nothing costs more: 80 rows at Re 1e-4 against Re 0.0125.
fn creeping(flow: Flow, found: &[Row]) -> Vec<(Gate, f64)> {
    let pairs = |re: f64, rows: usize| {
        let row = found.iter().find(|row| (row.re, row.rows) == (re, rows));
        row.map_or(f64::NAN, |row| row.stiff.cost.pair_interactions as f64)
    };
    let mut finest: Vec<usize> = found.iter().map(|row| row.rows).collect();
    finest.sort_unstable();
    let Some(rows) = finest.last().copied() else { return Vec::new() };
    let because = "at Re 1e-4 viscosity is 125 times as stiff against sound, and the steps are those of accuracy: \
                   no more than at Re 0.0125";
    let gate = Gate::new(
        format!("{}.stiff.{rows}.creeping", flow.name()),
        "pair interactions at Re 1e-4/at Re 0.0125",
        Bound::Below(1.0),
        Evidence::Theory,
        because,
    );
    vec![(gate, pairs(1e-4, rows) / pairs(0.0125, rows))]
}
