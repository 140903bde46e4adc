//! Hypotheses H3–H5 of the paper: pressure waves leave the walls (H3), grow with the Reynolds number
//! until the run is unstable (H4), and a lower sound speed stabilises (H5). And what cures it.

use rayon::prelude::*;
use solver::{
    BodyForce, Compose, Continuity, CubicSpline, EquationOfState, Flow as Going, Ghosts, Observer,
    PredictorCorrector, Pressure, Scheme, Simulation, Tait, Viscosity,
};

use super::{ChannelSettings, Flow, Setup, scene};
use crate::{
    case::{Case, Tier},
    gate::{Bound, Evidence, Gate},
    record::{Record, Status},
    report::{
        Axis, Block, CategoryMap, Cell, Colour, Column, Figure, Layer, Legend, Plot, Series, Table,
        percent, sig,
    },
    runner::Context,
    suite::Study,
};

/// The studies of the hypotheses.
pub fn studies(case: &'static dyn Case, tier: Tier) -> Vec<Study> {
    let map = Map::run(case, tier);
    vec![waves(), map.study(), cures(case, tier)]
}

/// Sound speeds of the map \[V\].
const SOUND: [f64; 4] = [5.0, 10.0, 20.0, 40.0];

fn reynolds(tier: Tier) -> &'static [f64] {
    match tier {
        Tier::Quick => &[1.0, 5.0, 20.0, 50.0, 100.0],
        Tier::Full => &[0.5, 1.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0],
    }
}

fn sounds(tier: Tier) -> &'static [f64] {
    match tier {
        Tier::Quick => &SOUND[..3],
        Tier::Full => &SOUND,
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

/// Runs of the map: \[step rule\]\[Re\]\[c0\].
struct Map {
    tier: Tier,
    records: [Vec<Vec<Option<Record>>>; 2],
}

impl Map {
    fn run(case: &'static dyn Case, tier: Tier) -> Self {
        let end = if tier == Tier::Full { 1.5 } else { 1.0 };
        let records = [Step::Courant, Step::Fixed].map(|step| {
            let run = |re: f64, sound: f64| {
                // V = Re ν/L with the defaults ν = 1e-6 m²/s, L = 1e-3 m.
                let v = re * 1e-3;
                let mut set =
                    vec![format!("re={re}"), format!("c0={}", sound * v), format!("end={end}")];
                if step == Step::Fixed {
                    let highest = sounds(tier).last().copied().unwrap_or(sound);
                    let (h, nu) = (1.2 * 1e-3 / 20.0, 1e-6);
                    let dt = (0.25 * h / ((highest + 1.0) * v)).min(0.125 * h * h / nu);
                    set.push(format!("dt={dt:e}"));
                }
                let context = Context { allow_unstable: true, ..Context::default() };
                case.run("seed", &set, &context).ok()
            };
            let row = |&re: &f64| sounds(tier).par_iter().map(|&c| run(re, c)).collect();
            reynolds(tier).par_iter().map(row).collect()
        });
        Self { tier, records }
    }

    fn study(&self) -> Study {
        let caption = "Outcome of the seed's Poiseuille flow (cubic spline, h/dx 1.2, ghosts, \
                       predictor-corrector, 20 rows) over Reynolds number and sound speed, at \
                       fixed Courant number 0.25 (left) and at the fixed time step of the \
                       highest sound speed (right). In a cell: worst relative L2 error from \
                       νt/L² = 0.1 on, or νt/L² of the divergence.";
        let figure = Figure::new("poiseuille-map", caption)
            .columns(2)
            .panel(self.panel(0, "fixed Courant number"))
            .panel(self.panel(1, "fixed time step"));
        let mut study =
            Study::new("poiseuille-h4-h5", "H4 and H5: when the seed's run becomes unstable");
        study = study.block(figure).block(Block::List(vec![self.h4(), self.h5()]));
        let gate = Gate::new(
            "poiseuille.map.first-failing-re",
            "first_failing_re",
            Bound::Within(10.0, 50.0),
            Evidence::Regression,
            "H4: with the seed's settings and c0 = 10 V a run survives Re 5 and not Re 50; a \
             solver in which it survives or fails earlier is another solver",
        );
        study.judge(gate, self.first_failing(0, 10.0).unwrap_or(f64::NAN))
    }

    fn panel(&self, rule: usize, title: &str) -> CategoryMap {
        let names = ["within 1 %", "within 5 %", "wrong", "diverged"];
        let colours = [Colour::GREEN, Colour::YELLOW, Colour::ORANGE, Colour::VERMILLION];
        let cell = |record: &Option<Record>| {
            let record = record.as_ref()?;
            Some(match &record.status {
                Status::Diverged { time, .. } => (3, sig(*time, 2)),
                _ => {
                    let worst = record.metric("l2_worst").unwrap_or(f64::NAN);
                    let kind = if worst <= 0.01 {
                        0
                    } else if worst <= 0.05 {
                        1
                    } else {
                        2
                    };
                    (kind, percent(worst, 2))
                }
            })
        };
        let rows = &self.records[rule];
        CategoryMap {
            title: title.into(),
            x_label: "Re [-]".into(),
            y_label: "c0/V [-]".into(),
            x: reynolds(self.tier).iter().map(|re| sig(*re, 3)).collect(),
            y: sounds(self.tier).iter().map(|c| sig(*c, 3)).collect(),
            categories: names.iter().map(|n| n.to_string()).zip(colours).collect(),
            cells: (0..sounds(self.tier).len())
                .map(|c| rows.iter().map(|row| cell(&row[c])).collect())
                .collect(),
        }
    }

    /// The lowest Re that diverged at this sound speed.
    fn first_failing(&self, rule: usize, sound: f64) -> Option<f64> {
        let c = sounds(self.tier).iter().position(|s| *s == sound)?;
        let failed = |row: &&Vec<Option<Record>>| {
            matches!(row[c].as_ref().map(|r| &r.status), Some(Status::Diverged { .. }))
        };
        let k = self.records[rule].iter().position(|row| failed(&row))?;
        Some(reynolds(self.tier)[k])
    }

    fn h4(&self) -> String {
        match self.first_failing(0, 10.0) {
            Some(re) => format!(
                "**H4 supported**: at c0 = 10 V every Reynolds number below {re} reaches its \
                 end, and Re = {re} diverges."
            ),
            None => {
                "**H4 refuted here**: no Reynolds number of the map diverges at c0 = 10 V.".into()
            }
        }
    }

    /// Compares the time of divergence at the lowest and the highest sound speed, for each rule.
    fn h5(&self) -> String {
        let mut words = Vec::new();
        let (mut longer, mut shorter) = (0, 0);
        for (rule, name) in ["fixed Courant number", "fixed time step"].iter().enumerate() {
            for (row, re) in self.records[rule].iter().zip(reynolds(self.tier)) {
                let life = |record: &Option<Record>| match record.as_ref().map(|r| &r.status) {
                    Some(Status::Diverged { time, .. }) => Some(*time),
                    _ => None,
                };
                let (low, high) = (life(&row[0]), life(&row[row.len() - 1]));
                let said = match (low, high) {
                    (None, None) => continue,
                    (None, Some(_)) => "only the higher diverges",
                    (Some(_), None) => "only the lower diverges",
                    (Some(a), Some(b)) if a > b => "the lower lives longer",
                    _ => "the higher lives longer",
                };
                let lower_is_better = low.unwrap_or(f64::MAX) > high.unwrap_or(f64::MAX);
                longer += usize::from(lower_is_better);
                shorter += usize::from(!lower_is_better);
                words.push(format!("Re {re}, {name}: {said}"));
            }
        }
        let verdict = match (longer, shorter) {
            (0, 0) => "open: nothing diverged",
            (_, 0) => "supported",
            (0, _) => "refuted",
            _ => "refuted as a rule: it helps in some runs and harms in others",
        };
        let (low, high) = (sounds(self.tier)[0], sounds(self.tier)[sounds(self.tier).len() - 1]);
        format!(
            "**H5 {verdict}**. Of c0 = {low} V and {high} V: {}. At no Reynolds number that \
             diverges does a lower sound speed make the run reach its end with a right answer; \
             what does is in the table of cures.",
            words.join("; ")
        )
    }
}

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

fn cures(case: &'static dyn Case, tier: Tier) -> Study {
    let (list, end): (&[f64], f64) = match tier {
        Tier::Quick => (&[20.0, 50.0], 1.0),
        Tier::Full => (&[5.0, 20.0, 50.0, 100.0, 200.0, 500.0], 1.5),
    };
    let context = Context { allow_unstable: true, ..Context::default() };
    let jobs: Vec<(usize, f64)> =
        (0..CURES.len()).flat_map(|k| list.iter().map(move |re| (k, *re))).collect();
    let records: Vec<Option<Record>> = jobs
        .par_iter()
        .map(|&(k, re)| {
            let set = [format!("re={re}"), format!("end={end}")];
            case.run(CURES[k].0, &set, &context).ok()
        })
        .collect();
    let mut columns = vec![Column::text("seed with"), Column::num("first failing Re", "-")];
    columns.extend(list.iter().map(|re| Column::text(format!("Re {re}"))));
    let caption = format!(
        "Cures of the instability at 20 rows, c0 by Morris' rule, to νt/L² = {end}: worst \
         relative L2 error from νt/L² = 0.1 on where the run survives, else νt/L² at which it \
         diverged. A run fails when it diverges or its error exceeds 5 %."
    );
    let mut table = Table::new(caption, columns);
    for (k, (_, what)) in CURES.iter().enumerate() {
        let row = &records[k * list.len()..(k + 1) * list.len()];
        let first = row.iter().zip(list).find(|(r, _)| fails(r)).map(|(_, re)| *re);
        let mut cells = vec![Cell::text(*what)];
        cells.push(first.map_or(Cell::text("none"), |re| Cell::num(re, 3)));
        cells.extend(row.iter().map(outcome));
        table = table.row(cells);
    }
    Study::new("poiseuille-cures", "What cures the instability")
        .prose(
            "Time integration is not the cause: the leapfrog, which neither damps nor amplifies \
             sound, fails as well. What keeps particles apart cures it (shifting), or what keeps \
             the pressure positive (background pressure), so the cause is the tensile \
             instability where p < 0. Artificial stress, viscosity and XSPH postpone it. A \
             background pressure in proportion to ρc0² costs accuracy: it pushes where the \
             particles are not in order.",
        )
        .block(table)
}

fn fails(record: &Option<Record>) -> bool {
    let Some(record) = record else { return true };
    let worst = record.metric("l2_worst").unwrap_or(f64::NAN);
    record.status != Status::Completed || worst.is_nan() || worst > 0.05
}

fn outcome(record: &Option<Record>) -> Cell {
    use crate::report::Status as Shown;
    match record.as_ref().map(|r| (&r.status, r.metric("l2_worst").unwrap_or(f64::NAN))) {
        Some((Status::Completed, worst)) => {
            let cell = Cell::percent(worst, 2);
            if worst <= 0.01 { cell.with(Shown::Pass) } else { cell }
        }
        Some((Status::Diverged { time, .. }, _)) => {
            Cell::text(format!("diverged at {}", sig(*time, 2))).with(Shown::Limitation)
        }
        _ => Cell::text("refused"),
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
}

/// Length of the window, the last part of a run \[L/c0\].
const WINDOW: f64 = 60.0;

/// Disorder of the start \[dx\]. The instability grows from it, or from round-off if there is none,
/// so that a single run says little.
const STARTS: [f64; 5] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2];

/// Watches the end of the seed's Poiseuille flow from a disordered start: divergence or νt/L² = 1.5.
/// `None` for a run that is over before the window is full.
fn ringing(re: f64, sound: f64, jitter: f64) -> Option<Ringing> {
    let defaults = ChannelSettings::default();
    let v = re * defaults.nu / defaults.width;
    let settings = ChannelSettings { re, c0: Some(sound * v), jitter, ..defaults };
    let setup =
        Setup::new::<CubicSpline, PredictorCorrector>(Flow::Poiseuille, &settings, true).ok()?;
    let mut simulation = scene::<Seed>(&setup).build().ok()?;
    let crossing = setup.settings.width / setup.eos.sound_speed;
    let scale = setup.settings.rho * setup.v * setup.v;
    let mut mode = Mode { eos: setup.eos, width: setup.settings.width, scale, series: Vec::new() };
    let _diverged_or_not = simulation.advance(setup.time(1.5), setup.dt, &mut mode);
    let since_end = |t: f64| (t - simulation.time()) / crossing;
    let all = mode.series.iter().map(|(t, p)| (since_end(*t), *p));
    let series: Vec<(f64, f64)> = all.filter(|(t, _)| *t >= -WINDOW).collect();
    if since_end(0.0) > -WINDOW {
        return None;
    }
    let (period, amplitude) = dominant_period(&series);
    Some(Ringing { series, period: 0.5 * period, amplitude })
}

/// The runs of one Re and c0/V from all starts, by period.
fn ringings(re: f64, sound: f64) -> Vec<Ringing> {
    let runs = STARTS.par_iter().map(|&jitter| ringing(re, sound, jitter));
    let mut found: Vec<Ringing> = runs.collect::<Vec<_>>().into_iter().flatten().collect();
    found.sort_by(|a, b| a.period.total_cmp(&b.period));
    found
}

/// H3: the lowest pressure mode between the walls rings with the period 2L/c0 of a wave that
/// bounces between them, whatever c0.
fn waves() -> Study {
    // (Re, c0/V)
    let runs = [(5.0, 10.0), (20.0, 10.0), (20.0, 20.0), (50.0, 10.0)];
    let found = runs.map(|(re, sound)| (re, sound, ringings(re, sound)));
    let columns = vec![
        Column::num("Re", "-"),
        Column::num("c0/V", "-"),
        Column::num("runs", "1"),
        Column::num("amplitude", "ρV²"),
        Column::num("dominant period", "2L/c0"),
        Column::text("all periods"),
    ];
    let caption = "The lowest pressure mode cos(πy/L) of the seed's Poiseuille flow over the last 60 L/c0 \
                   of a run, which ends by divergence or at νt/L² = 1.5: medians of runs whose initial \
                   places are disordered by 1e-6 to 1e-2 dx, without those that are over too soon. In the \
                   flow the mode is exactly 0. A wave that bounces between the walls has the period 2L/c0.";
    let mut table = Table::new(caption, columns);
    for (re, sound, rings) in &found {
        let Some(median) = rings.get(rings.len() / 2) else { continue };
        let periods: Vec<String> = rings.iter().map(|r| sig(r.period, 3)).collect();
        table = table.row(vec![
            Cell::num(*re, 3),
            Cell::num(*sound, 3),
            Cell::count(rings.len() as u64),
            Cell::sci(median.amplitude, 2),
            Cell::num(median.period, 3),
            Cell::text(periods.join(", ")),
        ]);
    }
    let because = "H3: waves bounce between the ghost walls, so the lowest mode has the period \
                   2L/c0, up to the dispersion of the kernel and the gaps that disorder opens";
    let gate = |sound: f64| {
        let id = format!("poiseuille.h3.period.c{sound}");
        Gate::new(id, "period", Bound::Within(0.8, 1.25), Evidence::Theory, because)
    };
    let medians: Vec<(f64, &Ringing)> = found
        .iter()
        .filter(|(re, ..)| *re == 20.0)
        .filter_map(|(_, sound, rings)| Some((*sound, rings.get(rings.len() / 2)?)))
        .collect();
    let rings = |(sound, r): &&(f64, &Ringing)| gate(*sound).bound.contains(r.period);
    let verdict = if medians.iter().filter(rings).count() == 2 {
        "**H3 supported**, with a correction: up to Re 5 there is no wave, only round-off and \
         the slow pressure of rows sliding past each other. From Re 20 on, once the rows lose \
         their order, the lowest mode rings with the period of a wave that bounces between the \
         walls, at half the period for twice the sound speed, and grows until the run ends (H4)."
    } else {
        "**H3 open**: the lowest mode does not ring with the period of a bouncing wave at both sound \
         speeds of Re 20."
    };
    let mut study =
        Study::new("poiseuille-h3", "H3: pressure waves between the walls").prose(verdict);
    let caption = "Lowest pressure mode of the seed's Poiseuille flow at Re 20 against time before the \
                   end of the run in crossings of the channel by sound, for two sound speeds, each the run \
                   of the median period: equal periods on this axis are periods in proportion to 1/c0.";
    let mut plot =
        Plot::new("", Axis::linear("(t − t_end) c0/L [-]"), Axis::linear("pressure mode [ρV²]"));
    for (sound, ring) in &medians {
        plot = plot.layer(Series::line(format!("c0/V = {sound}"), ring.series.clone()));
        study = study.judge(gate(*sound), ring.period);
    }
    let plot = plot.layer(Layer::horizontal(0.0, "")).legend(Legend::Auto);
    let figure = Figure::new("poiseuille-waves", caption).panel(plot).panel_size(620.0, 260.0);
    study.block(table).block(figure)
}

/// The period between 0.5 and 8 with the largest Fourier amplitude, and that amplitude. The trend is
/// removed and the ends are tapered, so that slow growth is not taken for a wave.
fn dominant_period(series: &[(f64, f64)]) -> (f64, f64) {
    let n = series.len() as f64;
    let (mut t1, mut p1, mut t2, mut tp) = (0.0, 0.0, 0.0, 0.0);
    for (t, p) in series {
        t1 += t / n;
        p1 += p / n;
        t2 += t * t / n;
        tp += t * p / n;
    }
    let slope = (tp - t1 * p1) / (t2 - t1 * t1);
    let amplitude = |period: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (k, (t, p)) in series.iter().enumerate() {
            let taper = 1.0 - (std::f64::consts::TAU * (k as f64 + 0.5) / n).cos();
            let value = taper * (p - p1 - slope * (t - t1));
            let phase = std::f64::consts::TAU * t / period;
            re += value * phase.cos();
            im += value * phase.sin();
        }
        2.0 * re.hypot(im) / n
    };
    let periods = (0..400).map(|k| 0.5 * 16.0_f64.powf(f64::from(k) / 399.0));
    let found = periods.map(|t| (t, amplitude(t)));
    found.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((f64::NAN, f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::dominant_period;

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
