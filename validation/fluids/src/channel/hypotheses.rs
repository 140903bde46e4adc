//! Hypotheses H3–H5 of the paper: pressure waves leave the walls (H3), grow with the Reynolds number
//! until the run is unstable (H4), and a lower sound speed stabilises (H5). And what cures it.

use rayon::prelude::*;
use solver::{
    BodyForce, Compose, Continuity, CubicSpline, EquationOfState, Flow as Going, Ghosts, Observer,
    PredictorCorrector, Pressure, Scheme, Simulation, Tait, Viscosity,
};

use super::{
    ChannelSettings, Flow, Setup, scene,
    starts::{DISORDER, Job, Longer, Outcome, Starts, run_all, starts_up_to},
};
use base::gate::{Bound, Evidence, Gate};
use harness::{
    case::{Case, Tier},
    suite::Study,
};
use report::{
    Axis, Block, CategoryMap, Cell, Colour, Column, Figure, Layer, Legend, Plot, Series, Status,
    Table, exact, sci, sig,
};

/// The studies of the hypotheses.
pub fn studies(case: &'static dyn Case, tier: Tier) -> Vec<Study> {
    let map = Map::run(case, tier);
    let cures = match tier {
        Tier::Quick => cures_elsewhere(),
        Tier::Full => cures(case),
    };
    vec![waves(tier), map.study(), cures]
}

/// Sound speeds of the map \[V\].
const SOUND: [f64; 3] = [5.0, 10.0, 20.0];

/// The sound speed at which H4 is judged \[V\]: Morris' rule with 1 % density variation.
const JUDGED_SOUND: f64 = 10.0;

fn reynolds(tier: Tier) -> &'static [f64] {
    match tier {
        Tier::Quick => &[1.0, 5.0, 20.0],
        Tier::Full => &[0.5, 1.0, 5.0, 10.0, 20.0, 50.0],
    }
}

/// νt/L² at which the runs of the map and of the cures end.
const END: f64 = 1.0;

/// Above this Reynolds number the full tier takes one start instead of three; the quick tier always.
const MANY_STARTS: f64 = 20.0;

fn starts(tier: Tier, re: f64) -> &'static [f64] {
    starts_up_to(if tier == Tier::Full { MANY_STARTS } else { 0.0 }, re)
}

/// How many starts a cell has, in words.
fn starts_in_words(tier: Tier) -> String {
    match tier {
        Tier::Quick => "Each has one start, disordered by 1e-4 dx: one sample and no more.".into(),
        Tier::Full => format!(
            "Up to Re {MANY_STARTS} each has {} starts, disordered by {} dx; above one, 1e-4 dx, which is \
             one sample and no more.",
            DISORDER.len(),
            disorder(&DISORDER)
        ),
    }
}

/// How the time step of the map follows from the sound speed.
#[derive(Clone, Copy, PartialEq)]
enum Step {
    /// dt = 0.25 h/(c0 + V): the Courant number is fixed, a lower c0 has longer steps.
    Courant,
    /// The dt of the highest sound speed of the map for all of them.
    Fixed,
}

const STEP_NAMES: [&str; 2] = ["fixed Courant number", "fixed time step"];

/// Rules for the step in a tier: in the quick one the first alone.
fn rules(tier: Tier) -> &'static [Step] {
    if tier == Tier::Full { &[Step::Courant, Step::Fixed] } else { &[Step::Courant] }
}

/// Runs of the map.
struct Map {
    tier: Tier,
    /// \[step rule\]\[Re\]\[c0\]
    cells: Vec<Vec<Vec<Starts>>>,
}

/// The settings of a cell: V = Re ν/L with the defaults ν = 1e-6 m²/s, L = 1e-3 m.
fn map_settings(step: Step, re: f64, sound: f64) -> Vec<String> {
    let v = re * 1e-3;
    let mut set = vec![format!("re={re}"), format!("c0={}", sound * v), format!("end={END}")];
    if step == Step::Fixed {
        let highest = SOUND.last().copied().unwrap_or(sound);
        let (h, nu) = (1.2 * 1e-3 / 20.0, 1e-6);
        let dt = (0.25 * h / ((highest + 1.0) * v)).min(0.125 * h * h / nu);
        set.push(format!("dt={dt:e}"));
    }
    set
}

impl Map {
    fn run(case: &'static dyn Case, tier: Tier) -> Self {
        let highest = SOUND.len() - 1;
        let mut jobs = Vec::new();
        for &step in rules(tier) {
            for &re in reynolds(tier) {
                // At the highest sound speed both rules have the same step.
                let count = if step == Step::Fixed { highest } else { highest + 1 };
                jobs.extend(SOUND[..count].iter().map(|&sound| Job {
                    variant: "seed",
                    set: map_settings(step, re, sound),
                    starts: starts(tier, re),
                }));
            }
        }
        let mut found = run_all(case, &jobs).into_iter();
        let mut rows = |count: usize| -> Vec<Vec<Starts>> {
            reynolds(tier).iter().map(|_| found.by_ref().take(count).collect()).collect()
        };
        let mut cells = vec![rows(highest + 1)];
        if rules(tier).contains(&Step::Fixed) {
            let mut fixed = rows(highest);
            for (fixed, courant) in fixed.iter_mut().zip(&cells[0]) {
                fixed.extend(courant.last().cloned());
            }
            cells.push(fixed);
        }
        Self { tier, cells }
    }

    fn study(&self) -> Study {
        let rules = match self.tier {
            Tier::Full => {
                "at fixed Courant number 0.25 (left) and at the fixed time step of the highest sound \
                 speed (right)"
            }
            Tier::Quick => {
                "at fixed Courant number 0.25 (the full tier has a fixed time step beside it)"
            }
        };
        let caption = format!(
            "Outcome of the seed's Poiseuille flow (cubic spline, h/dx 1.2, ghosts, \
             predictor-corrector, 20 rows) to νt/L² = {} over Reynolds number and sound speed, {rules}. \
             {} A cell says how many failed, and the median outcome, which is an error in per cent \
             (worst relative L2 from νt/L² = 0.1 on) or, after a t, the νt/L² of the divergence. A \
             run fails when it diverges or its error exceeds 5 %.",
            END,
            starts_in_words(self.tier),
        );
        let figure = Figure::new("poiseuille-map", caption).columns(self.cells.len());
        let figure = (0..self.cells.len()).fold(figure, |figure, k| figure.panel(self.panel(k)));
        let set = map_settings(Step::Courant, 20.0, JUDGED_SOUND);
        let command = format!(
            "One start of the cell Re 20, c0/V = 10 at fixed Courant number again: `touchstone run \
             poiseuille --variant seed --set {} --set jitter=1e-4 --allow-unstable`. Starts that differ in \
             nothing but round-off can end differently, so single runs are no evidence.",
            set.join(" --set ")
        );
        let mut study =
            Study::new("poiseuille-h4-h5", "H4 and H5: when the seed's run becomes unstable");
        study = study.block(figure).block(Block::List(vec![self.h4(), self.h5()])).prose(command);
        let gate = Gate::new(
            "poiseuille.map.first-failing-re",
            "first_failing_re",
            Bound::Within(2.2, 14.0),
            Evidence::Regression,
            "H4: with the seed's settings and c0 = 10 V every start holds Re 1, and every start fails at \
             Re 5, where only a perfect lattice holds (0.99 %, but 5.6 % with a disorder of 1e-6 dx). The \
             ends are half-way in the logarithm between 1 and 5, and between 10 and 20, so no outcome of \
             the map lies at an end",
        );
        study.judge(gate, self.first_failing().unwrap_or(f64::NAN))
    }

    fn panel(&self, rule: usize) -> CategoryMap {
        let names = ["none fails, ≤ 1 %", "none fails, ≤ 5 %", "some fail", "all fail"];
        let colours = [Colour::GREEN, Colour::YELLOW, Colour::ORANGE, Colour::VERMILLION];
        let cell = |starts: &Starts| {
            let kind = match (starts.failed(), starts.median()?) {
                (0, Outcome::Reached(error)) if error <= 0.01 => 0,
                (0, _) => 1,
                (failed, _) if failed < starts.count() => 2,
                _ => 3,
            };
            Some((kind, starts.text()))
        };
        let rows = &self.cells[rule];
        CategoryMap {
            title: STEP_NAMES[rule].into(),
            x_label: "Re [-]".into(),
            y_label: "c0/V [-]".into(),
            x: reynolds(self.tier).iter().map(|re| exact(*re)).collect(),
            y: SOUND.iter().map(|c| exact(*c)).collect(),
            categories: names.iter().map(|n| n.to_string()).zip(colours).collect(),
            cells: (0..SOUND.len())
                .map(|c| rows.iter().map(|row| row.get(c).and_then(cell)).collect())
                .collect(),
        }
    }

    /// (Re, starts) at the sound speed of H4 and fixed Courant number.
    fn judged(&self) -> Vec<(f64, &Starts)> {
        let c = SOUND.iter().position(|s| *s == JUDGED_SOUND);
        let rows = reynolds(self.tier).iter().zip(&self.cells[0]);
        rows.filter_map(|(re, row)| Some((*re, row.get(c?)?))).collect()
    }

    /// The lowest Re at which most starts fail.
    fn first_failing(&self) -> Option<f64> {
        self.judged().into_iter().find(|(_, starts)| starts.mostly_fails()).map(|(re, _)| re)
    }

    fn h4(&self) -> String {
        let judged = self.judged();
        let counts: Vec<String> = judged
            .iter()
            .map(|(re, starts)| format!("Re {re}: {} of {}", starts.failed(), starts.count()))
            .collect();
        let share: Vec<f64> =
            judged.iter().map(|(_, s)| s.failed() as f64 / s.count() as f64).collect();
        let rises = share.windows(2).all(|pair| pair[0] <= pair[1]);
        let (first, last) = (share.first(), share.last());
        let few = self.tier == Tier::Quick;
        let verdict = match (first, last) {
            (Some(0.0), Some(1.0)) if rises && few => "indicated by one start a cell",
            (Some(0.0), Some(1.0)) if rises => "supported",
            (_, Some(0.0)) if rises => "refuted here",
            _ => "open",
        };
        format!(
            "**H4** (with rising Re the waves grow until the run is unstable) **{verdict}**: at c0 = \
             {JUDGED_SOUND} V and fixed Courant number there fail {}. Supported means that none fails at \
             the lowest Re, all at the highest, and never fewer at a higher one. It says that runs fail, \
             not that waves are the reason.",
            counts.join(", ")
        )
    }

    /// Compares the life at the lowest and the highest sound speed, for each rule and Re.
    fn h5(&self) -> String {
        let mut words = Vec::new();
        let (mut first, mut second, mut overlap, mut rescued) = (0, 0, 0, 0);
        for (rows, name) in self.cells.iter().zip(STEP_NAMES) {
            for (row, re) in rows.iter().zip(reynolds(self.tier)) {
                let (low, high) = (&row[0], &row[row.len() - 1]);
                let said = match low.longer(high) {
                    Longer::NothingFails => continue,
                    Longer::First => {
                        first += 1;
                        "the lower lives longer"
                    }
                    Longer::Second => {
                        second += 1;
                        "the higher lives longer"
                    }
                    Longer::Overlap => {
                        overlap += 1;
                        "open, the ranges overlap"
                    }
                };
                rescued += usize::from(high.mostly_fails() && !low.mostly_fails());
                let (low, high) = (low.text(), high.text());
                words.push(format!("Re {re}, {name}: {said} ({low} against {high})"));
            }
        }
        let (low, high) = (SOUND[0], SOUND[SOUND.len() - 1]);
        let rescue = match rescued {
            0 => "Nowhere on the map does the lower sound speed turn a flow that fails from most starts \
                  into one that does not."
                .to_string(),
            n => format!(
                "In {n} of these the lower sound speed turns a flow that fails from most starts into one \
                 that does not."
            ),
        };
        format!(
            "**H5** (a lower sound speed stabilises the run) **{}{}**. Of c0 = {low} V and {high} V, by the \
             ranges over the starts: {}. {rescue}",
            h5_verdict(first, second, overlap),
            if self.tier == Tier::Quick { ", from one start a cell" } else { "" },
            words.join("; ")
        )
    }
}

/// The verdict on H5 from the number of comparisons in which the lower sound speed lived longer, the
/// higher did, and the ranges overlapped.
fn h5_verdict(first: usize, second: usize, overlap: usize) -> &'static str {
    match (first, second, overlap) {
        (0, 0, 0) => "open: nothing fails",
        (0, 0, _) => "open: all ranges overlap",
        (_, 0, 0) => "supported",
        (0, _, 0) => "refuted",
        (_, 0, _) => "open: supported in some comparisons, undecided in others",
        (0, _, _) => "refuted where it is decided, open elsewhere",
        _ => "refuted as a rule: it helps in some comparisons and harms in others",
    }
}

/// Disorders as a list.
fn disorder(starts: &[f64]) -> String {
    let words: Vec<String> = starts.iter().map(|start| format!("{start:e}")).collect();
    words.join(", ")
}

const CURES_ID: &str = "poiseuille-cures";
const CURES_TITLE: &str = "What cures the instability";

/// What was tried against the instability.
const CURES: [(&str, &str); 10] = [
    ("seed", "nothing"),
    ("cure-leapfrog", "staggered leapfrog"),
    ("cure-stress", "artificial stress, ξ 0.3, n 4"),
    ("cure-viscosity", "artificial viscosity, α 0.1"),
    ("cure-xsph", "XSPH, ε 0.5"),
    ("cure-diffusion", "density diffusion 0.1"),
    ("cure-background", "background pressure 0.05 ρc0²"),
    ("cure-shifting", "particle shifting 0.5"),
    ("cure-both", "shifting and density diffusion"),
    ("modern", "`modern`: quintic, leapfrog, both"),
];

/// Where they are not run.
fn cures_elsewhere() -> Study {
    let text = format!(
        "What cures the instability, {} changes of the seed at three Reynolds numbers, is run in the full \
         tier only.",
        CURES.len() - 1
    );
    Study::new(CURES_ID, CURES_TITLE).prose(text)
}

fn cures(case: &'static dyn Case) -> Study {
    let (tier, list) = (Tier::Full, [5.0, 20.0, 50.0]);
    let jobs: Vec<Job> = CURES
        .iter()
        .flat_map(|(variant, _)| {
            list.iter().map(|re| Job {
                variant,
                set: vec![format!("re={re}"), format!("end={END}")],
                starts: starts(tier, *re),
            })
        })
        .collect();
    let found = run_all(case, &jobs);
    let mut columns =
        vec![Column::text("seed with"), Column::num("first Re at which most fail", "-")];
    columns.extend(list.iter().map(|re| Column::text(format!("Re {re}"))));
    let caption = format!(
        "Cures of the instability at 20 rows, c0 by Morris' rule, to νt/L² = {}. {} A cell \
         says how many failed, and the median outcome: worst relative L2 error from νt/L² = 0.1 on, or, \
         after a t, the νt/L² of the divergence. A run fails when it diverges or its error exceeds 5 %.",
        END,
        starts_in_words(tier),
    );
    let mut table = Table::new(caption, columns);
    for (row, (_, what)) in found.chunks(list.len()).zip(CURES) {
        let first = row.iter().zip(list).find(|(s, _)| s.mostly_fails()).map(|(_, re)| re);
        let mut cells = vec![Cell::text(what)];
        cells.push(first.map_or(Cell::text("none"), Cell::exact));
        cells.extend(row.iter().map(outcome));
        table = table.row(cells);
    }
    let fails = |name: &str| {
        let k = CURES.iter().position(|(variant, _)| *variant == name);
        k.is_some_and(|k| found[k * list.len()..][..list.len()].iter().any(Starts::mostly_fails))
    };
    Study::new(CURES_ID, CURES_TITLE).prose(cures_in_words(fails)).block(table)
}

/// What the table of cures shows, from the numbers.
fn cures_in_words(fails: impl Fn(&str) -> bool) -> String {
    let names = |wanted: bool| {
        let tried = CURES.iter().skip(1);
        let of_this_kind = tried.filter(|(variant, _)| fails(variant) == wanted);
        let names: Vec<&str> = of_this_kind.map(|(_, what)| *what).collect();
        if names.is_empty() { "none".to_string() } else { names.join("; ") }
    };
    let mut words = vec![
        format!(
            "From most starts these hold every Reynolds number of the table: {}.",
            names(false)
        ),
        format!("These fail from most starts at some: {}.", names(true)),
    ];
    if fails("seed") {
        words.insert(0, "The seed as it is fails.".into());
    }
    if fails("seed") && fails("cure-leapfrog") {
        let text = "Time integration alone is not the cause: the leapfrog, which neither damps nor \
                    amplifies sound, fails as well.";
        words.push(text.into());
    }
    if fails("seed") && !fails("cure-shifting") && !fails("cure-background") {
        let text = "What keeps particles apart cures it (shifting), and so does what keeps the pressure \
                    positive (background pressure), which points to the tensile instability where p < 0. \
                    A background pressure in proportion to ρc0² pushes where the particles are not in \
                    order, and its error in the table is the price.";
        words.push(text.into());
    }
    if !fails("cure-shifting") && fails("cure-background") {
        let text = "What keeps particles apart cures it (shifting). A background pressure of 0.05 ρc0² \
                    does not do so from most starts, so that the tensile instability where p < 0 is the \
                    cause is not shown here.";
        words.push(text.into());
    }
    words.join(" ")
}

fn outcome(starts: &Starts) -> Cell {
    let cell = Cell::text(starts.text());
    match (starts.failed(), starts.median()) {
        (0, Some(Outcome::Reached(error))) if error <= 0.01 => cell.with(Status::Pass),
        (0, Some(_)) => cell,
        _ => cell.with(Status::Limitation),
    }
}

type Seed = Compose<
    CubicSpline,
    (Pressure<Tait>, Viscosity, BodyForce),
    Continuity,
    Ghosts,
    PredictorCorrector,
>;

/// Amplitude of the lowest pressure mode cos(πy/L), in ρV², after every step.
struct Mode {
    eos: Tait,
    width: f64,
    scale: f64,
    series: Vec<(f64, f64)>,
}

impl<S: Scheme<Extra = ()>> Observer<S> for Mode {
    fn after_step(&mut self, simulation: &Simulation<S>) -> Going {
        let (mut mode, mut count) = (0.0, 0.0);
        for (_, e) in simulation.fluid() {
            let phase = std::f64::consts::PI * e.position.y / self.width;
            mode += 2.0 * self.eos.pressure(e.density) / self.scale * phase.cos();
            count += 1.0;
        }
        self.series.push((simulation.time(), mode / count));
        Going::Continue
    }
}

/// What the lowest pressure mode of one run does.
#[derive(Clone)]
struct Ringing {
    /// (t c0/L from the end of the run, amplitude \[ρV²\]).
    series: Vec<(f64, f64)>,
    /// Dominant period \[2L/c0\] and its amplitude \[ρV²\].
    period: f64,
    amplitude: f64,
    /// Amplitude at that period in the second half of the window over that in the first.
    growth: f64,
}

/// Length of the window, the last part of a run \[L/c0\].
const WINDOW: f64 = 60.0;

/// Disorder of the start \[dx\]. The instability grows from it, or from round-off if there is none,
/// so that a single run says little.
const STARTS: [f64; 5] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2];

/// Those of a tier.
fn wave_starts(tier: Tier) -> &'static [f64] {
    if tier == Tier::Full { &STARTS } else { &STARTS[1..4] }
}

/// νt/L² to which waves are watched: longer, for they are judged by how they grow at the end.
const WATCHED: f64 = 1.5;

/// Watches the end of the seed's Poiseuille flow from a disordered start: divergence or [`WATCHED`].
/// `None` for a run that is over before the window is full.
fn ringing(re: f64, sound: f64, jitter: f64) -> Option<Ringing> {
    let defaults = ChannelSettings::default();
    let v = re * defaults.nu / defaults.width;
    let settings = ChannelSettings { re, c0: Some(sound * v), jitter, ..defaults };
    let setup =
        Setup::new::<CubicSpline, PredictorCorrector>(Flow::Poiseuille, &settings, &[], true)
            .ok()?;
    let mut simulation = scene::<Seed>(&setup).build().ok()?;
    let crossing = setup.settings.width / setup.eos.sound_speed;
    let scale = setup.settings.rho * setup.v * setup.v;
    let mut mode = Mode { eos: setup.eos, width: setup.settings.width, scale, series: Vec::new() };
    let _diverged_or_not = simulation.advance(setup.time(WATCHED), setup.dt, &mut mode);
    let since_end = |t: f64| (t - simulation.time()) / crossing;
    let all = mode.series.iter().map(|(t, p)| (since_end(*t), *p));
    let series: Vec<(f64, f64)> = all.filter(|(t, _)| *t >= -WINDOW).collect();
    if since_end(0.0) > -WINDOW {
        return None;
    }
    let (period, amplitude) = dominant_period(&series);
    let (early, late): (Vec<_>, Vec<_>) = series.iter().partition(|(t, _)| *t < -0.5 * WINDOW);
    let growth = amplitude_at(&tapered(&late), period) / amplitude_at(&tapered(&early), period);
    Some(Ringing { series, period: 0.5 * period, amplitude, growth })
}

/// The runs of one Re and c0/V from all starts, by period.
fn ringings(tier: Tier, re: f64, sound: f64) -> Vec<Ringing> {
    let runs = wave_starts(tier).par_iter().map(|&jitter| ringing(re, sound, jitter));
    let mut found: Vec<Ringing> = runs.collect::<Vec<_>>().into_iter().flatten().collect();
    found.sort_by(|a, b| a.period.total_cmp(&b.period));
    found
}

/// Runs of one Reynolds number and sound speed.
struct Rings {
    re: f64,
    sound: f64,
    /// By period.
    runs: Vec<Ringing>,
}

impl Rings {
    /// The run of the median period.
    fn typical(&self) -> Option<&Ringing> {
        self.runs.get(self.runs.len() / 2)
    }

    fn median(&self, of: impl Fn(&Ringing) -> f64) -> f64 {
        let mut values: Vec<f64> = self.runs.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
    }

    /// Has the median the period of a wave that bounces between the walls?
    fn bounces(&self) -> bool {
        PERIOD.contains(self.median(|run| run.period))
    }
}

/// Periods \[2L/c0\] that count as those of a bouncing wave.
const PERIOD: Bound = Bound::Within(0.8, 1.25);

/// H3: the lowest pressure mode between the walls rings with the period 2L/c0 of a wave that
/// bounces between them, whatever c0.
fn waves(tier: Tier) -> Study {
    // (Re, c0/V)
    let settings = [(5.0, 10.0), (20.0, 10.0), (20.0, 20.0)];
    let runs = |&(re, sound): &(f64, f64)| Rings { re, sound, runs: ringings(tier, re, sound) };
    let found: Vec<Rings> = settings.iter().map(runs).collect();
    let because = "H3: waves bounce between the ghost walls, so the lowest mode has the period \
                   2L/c0, up to the dispersion of the kernel and the gaps that disorder opens";
    let mut study = Study::new("poiseuille-h3", "H3: pressure waves between the walls");
    study = study.prose(h3(&found));
    let caption = "Lowest pressure mode of the seed's Poiseuille flow at Re 20 against time before the \
                   end of the run in crossings of the channel by sound, for two sound speeds, each the run \
                   of the median period: equal periods on this axis are periods in proportion to 1/c0.";
    let mut plot =
        Plot::new("", Axis::linear("(t − t_end) c0/L [-]"), Axis::linear("pressure mode [ρV²]"));
    for rings in found.iter().filter(|rings| rings.re == 20.0) {
        let id = format!("poiseuille.h3.period.c{}", rings.sound);
        let gate = Gate::new(id, "period", PERIOD, Evidence::Theory, because);
        // NaN, which fails, if no run filled its window.
        study = study.judge(gate, rings.median(|run| run.period));
        let Some(run) = rings.typical() else { continue };
        let name = format!("c0/V = {}", rings.sound);
        plot = plot.layer(Series::line(name, run.series.clone()));
    }
    let plot = plot.layer(Layer::horizontal(0.0, "")).legend(Legend::Auto);
    let figure = Figure::new("poiseuille-waves", caption).panel(plot).panel_size(620.0, 260.0);
    study.block(waves_table(tier, &found)).block(figure)
}

fn waves_table(tier: Tier, found: &[Rings]) -> Table {
    let columns = vec![
        Column::num("Re", "-"),
        Column::num("c0/V", "-"),
        Column::num("runs", "1"),
        Column::num("amplitude", "ρV²"),
        Column::num("growth", "1"),
        Column::num("dominant period", "2L/c0"),
        Column::text("all periods"),
    ];
    let caption = format!(
        "The lowest pressure mode cos(πy/L) of the seed's Poiseuille flow over the last 60 L/c0 of a run, \
         which ends by divergence or at νt/L² = {WATCHED}: medians of runs whose initial places are \
         disordered by {} dx, without those that are over too soon. In the flow the mode is exactly 0. A \
         wave that bounces between the walls has the period 2L/c0. Growth is the amplitude at the dominant \
         period in the last 30 L/c0 over that in the 30 before.",
        disorder(wave_starts(tier))
    );
    let mut table = Table::new(caption, columns);
    for rings in found.iter().filter(|rings| !rings.runs.is_empty()) {
        let periods: Vec<String> = rings.runs.iter().map(|r| sig(r.period, 3)).collect();
        table = table.row(vec![
            Cell::exact(rings.re),
            Cell::exact(rings.sound),
            Cell::count(rings.runs.len() as u64),
            Cell::sci(rings.median(|run| run.amplitude), 2),
            Cell::num(rings.median(|run| run.growth), 2),
            Cell::num(rings.median(|run| run.period), 3),
            Cell::text(periods.join(", ")),
        ]);
    }
    table
}

/// What the table says about H3.
fn h3(found: &[Rings]) -> String {
    let at = |re: f64, sound: f64| found.iter().find(|r| (r.re, r.sound) == (re, sound));
    let (Some(slow), Some(low), Some(high)) = (at(5.0, 10.0), at(20.0, 10.0), at(20.0, 20.0))
    else {
        return "**H3 open**: nothing was measured.".into();
    };
    let period = |rings: &Rings| sig(rings.median(|run| run.period), 3);
    let amplitude = |rings: &Rings| rings.median(|run| run.amplitude);
    let verdict = match (low.bounces() && high.bounces(), slow.bounces()) {
        (true, true) => "supported",
        (true, false) => "supported at Re 20, not at Re 5",
        _ => "open",
    };
    let slow_rings =
        if slow.bounces() { "rings with that period as well" } else { "does not have that period" };
    let growth: Vec<String> = found
        .iter()
        .map(|r| (r, r.median(|run| run.growth)))
        .filter(|(_, growth)| growth.is_finite())
        .map(|(r, growth)| {
            let word = if growth > 1.25 {
                "grows"
            } else if growth < 0.8 {
                "decays"
            } else {
                "keeps its size"
            };
            format!("at Re {} and c0 = {} V it {word} ({} times)", r.re, r.sound, sig(growth, 2))
        })
        .collect();
    format!(
        "**H3** (pressure waves leave the ghost-particle walls and keep bouncing between them) \
         **{verdict}**: at Re 20 the median period of the lowest mode is {} times 2L/c0 at c0 = 10 V and {} \
         times at 20 V, and 1 is the period of a wave that bounces between the walls. At Re 5 and c0 = 10 V \
         the mode {slow_rings} ({} times 2L/c0); its amplitude there is {} ρV², and {} ρV² at Re 20, {} \
         times as much. From the last but one 30 L/c0 to the last, {}.",
        period(low),
        period(high),
        period(slow),
        sci(amplitude(slow), 2),
        sci(amplitude(low), 2),
        sig(amplitude(low) / amplitude(slow), 2),
        growth.join(", ")
    )
}

/// The series without its trend and with tapered ends, so that slow growth is not taken for a wave.
fn tapered(series: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let n = series.len() as f64;
    let (mut t1, mut p1, mut t2, mut tp) = (0.0, 0.0, 0.0, 0.0);
    for (t, p) in series {
        t1 += t / n;
        p1 += p / n;
        t2 += t * t / n;
        tp += t * p / n;
    }
    let slope = (tp - t1 * p1) / (t2 - t1 * t1);
    let taper = |k: usize| 1.0 - (std::f64::consts::TAU * (k as f64 + 0.5) / n).cos();
    let value = |k: usize, (t, p): &(f64, f64)| (*t, taper(k) * (p - p1 - slope * (t - t1)));
    series.iter().enumerate().map(|(k, point)| value(k, point)).collect()
}

/// Fourier amplitude of a tapered series at a period.
fn amplitude_at(series: &[(f64, f64)], period: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (t, value) in series {
        let phase = std::f64::consts::TAU * t / period;
        re += value * phase.cos();
        im += value * phase.sin();
    }
    2.0 * re.hypot(im) / series.len() as f64
}

/// The period between 0.5 and 8 with the largest Fourier amplitude, and that amplitude.
fn dominant_period(series: &[(f64, f64)]) -> (f64, f64) {
    let series = tapered(series);
    let periods = (0..400).map(|k| 0.5 * 16.0_f64.powf(f64::from(k) / 399.0));
    let found = periods.map(|t| (t, amplitude_at(&series, t)));
    found.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((f64::NAN, f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::{dominant_period, h5_verdict};

    #[test]
    fn overlapping_ranges_leave_h5_open() {
        assert_eq!(h5_verdict(2, 0, 0), "supported");
        assert!(h5_verdict(2, 0, 1).starts_with("open"));
        assert!(h5_verdict(0, 0, 3).starts_with("open"));
        assert!(h5_verdict(1, 1, 1).starts_with("refuted as a rule"));
    }

    #[test]
    fn a_sine_on_a_trend_is_found_with_its_amplitude() {
        let wave = |k: i32| {
            let t = f64::from(k) * 0.02;
            (t, 5.0 + 0.3 * t + 0.1 * (std::f64::consts::TAU * t / 1.9).sin())
        };
        let series: Vec<(f64, f64)> = (0..3000).map(wave).collect();
        let (period, amplitude) = dominant_period(&series);
        assert!((period / 1.9 - 1.0).abs() < 0.01, "{period}");
        assert!((amplitude / 0.1 - 1.0).abs() < 0.05, "{amplitude}");
    }
}
