//! Hypothesis H3 of the paper: pressure waves leave the walls. The lowest pressure mode between them rings
//! with the period 2L/c0 of a wave that bounces between them, whatever c0.

use super::{
    measure::{MODE, MODE_AMPLITUDE, MODE_TIME},
    runs::{ChannelTable, For},
};
use base::functions::{cos, hypot, powf, sin};
use base::gate::{Bound, Evidence, Gate};
use harness::{columns::Columns, runs::Runs, study::Study};
use report::{Cell, sig};

/// Reynolds numbers and sound speeds \[V\] that are watched.
const SETTINGS: [(f64, f64); 3] = [(5.0, 10.0), (20.0, 10.0), (20.0, 20.0)];

/// Disorder of the start \[dx\]. The instability grows from it, or from round-off if there is none, so that a
/// single run says little. The quick tier has the inner three.
const STARTS: [f64; 5] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2];

/// Adds the runs, to νt/L² = 1.5, for waves are judged by the end of a run.
pub fn runs(table: &mut ChannelTable) {
    for (re, sound) in SETTINGS {
        table.over(For::Waves, &["seed"], [&STARTS[1..4], &STARTS], |s, jitter| {
            (s.re, s.end, s.jitter, s.watch_mode) = (re, 1.5, jitter, true);
            s.c0 = Some(sound * s.speed());
        });
    }
}

/// Runs of one Reynolds number and sound speed.
struct Rings {
    re: f64,
    sound: f64,
    /// Dominant periods \[2L/c0\] of runs that did not end before there was enough to see, sorted, with their
    /// amplitudes \[ρV²\].
    modes: Vec<(f64, f64)>,
}

impl Rings {
    fn of((re, sound): (f64, f64), table: &ChannelTable, runs: &Runs) -> Self {
        let rows = table.of(For::Waves).filter(|row| row.settings.re == re);
        let rows = rows.filter(|row| row.settings.c0 == Some(sound * row.settings.speed()));
        let records = runs.records(rows.map(|row| row.run.spec.clone()));
        let modes = records.iter().filter_map(|record| record.profiles.get(MODE)).map(|mode| {
            let [times, values] = [MODE_TIME, MODE_AMPLITUDE].map(|name| mode.column(name).iter());
            let series: Vec<(f64, f64)> = times.copied().zip(values.copied()).collect();
            let (period, amplitude) = dominant_period(&series);
            (0.5 * period, amplitude)
        });
        let mut modes: Vec<(f64, f64)> = modes.collect();
        modes.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { re, sound, modes }
    }

    /// Period and amplitude of the run with the median period; NaN, which fails a gate, if there is none.
    fn typical(&self) -> (f64, f64) {
        self.modes.get(self.modes.len() / 2).copied().unwrap_or((f64::NAN, f64::NAN))
    }

    fn period(&self) -> f64 {
        self.typical().0
    }
}

/// Periods \[2L/c0\] that count as those of a bouncing wave: the next modes have 0.5 and, between a wall
/// and a free surface, 2. How far disorder lengthens the period is not known from theory.
const PERIOD: Bound = Bound::Within(0.8, 1.25);

/// The study.
pub fn study(table: &ChannelTable, runs: &Runs) -> Study {
    let found = SETTINGS.map(|setting| Rings::of(setting, table, runs));
    let because = "H3 says that waves bounce between the ghost walls, so the lowest mode has about the \
                   period 2L/c0. No theory says by how much disorder lengthens it. The median was 1.16 at \
                   c0/V = 10 and 1.09 at 20, and a value outside of 0.8 to 1.25 is a change of the \
                   program.";
    let caption = "The lowest pressure mode cos(πy/L) in Poiseuille flow of `seed` over the last 60 L/c0 of \
                   a run, which ends by divergence or at νt/L² = 1.5. Numbers are of the run of the median \
                   period, among runs whose initial places are disordered by 1e-6 to 1e-2 dx (quick tier: \
                   1e-5 to 1e-3 dx), without those that end too soon. In the exact flow the mode is 0, and \
                   a wave that bounces between the walls has the period 2L/c0.";
    let periods = |rings: &Rings| {
        rings.modes.iter().map(|(period, _)| sig(*period, 3)).collect::<Vec<String>>().join(", ")
    };
    let shown = Columns::<Rings>::default()
        .num(["Re", "-"], |rings| Cell::exact(rings.re))
        .num(["c0/V", "-"], |rings| Cell::exact(rings.sound))
        .num(["runs", "1"], |rings| Cell::count(rings.modes.len() as u64))
        .num(["amplitude", "ρV²"], |rings| Cell::sci(rings.typical().1, 2))
        .num(["dominant period", "2L/c0"], |rings| Cell::num(rings.period(), 3))
        .text("all periods", periods)
        .table(caption, &found);
    let study = Study::new("poiseuille-h3", "H3: pressure waves between the walls");
    let study = study.prose(h3(&found)).block(shown);
    found.iter().filter(|rings| rings.re == 20.0).fold(study, |study, rings| {
        let id = format!("poiseuille.h3.period.c{}", rings.sound);
        let gate = Gate::new(id, "period [2L/c0]", PERIOD, Evidence::Regression, because);
        study.judge(gate, rings.period())
    })
}

/// What the table says about H3.
fn h3(found: &[Rings; 3]) -> String {
    let [slow, low, high] = found.each_ref().map(|rings| PERIOD.contains(rings.period()));
    let verdict = match (low && high, slow) {
        (true, true) => "supported",
        (true, false) => "supported at Re 20, not at Re 5",
        _ => "open",
    };
    format!(
        "**H3** (pressure waves leave the ghost-particle walls and keep bouncing between them) is \
         **{verdict}**, by the periods of the lowest mode in the table."
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
    let taper = |k: usize| 1.0 - cos(std::f64::consts::TAU * (k as f64 + 0.5) / n);
    let value = |k: usize, (t, p): &(f64, f64)| (*t, taper(k) * (p - p1 - slope * (t - t1)));
    series.iter().enumerate().map(|(k, point)| value(k, point)).collect()
}

/// Fourier amplitude of a tapered series at a period.
fn amplitude_at(series: &[(f64, f64)], period: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (t, value) in series {
        let phase = std::f64::consts::TAU * t / period;
        re += value * cos(phase);
        im += value * sin(phase);
    }
    2.0 * hypot(re, im) / series.len() as f64
}

/// The period between 0.5 and 8 with the largest Fourier amplitude, and that amplitude.
fn dominant_period(series: &[(f64, f64)]) -> (f64, f64) {
    let series = tapered(series);
    let periods = (0..400).map(|k| 0.5 * powf(16.0, f64::from(k) / 399.0));
    let found = periods.map(|t| (t, amplitude_at(&series, t)));
    found.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((f64::NAN, f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::dominant_period;
    use base::functions::sin;

    #[test]
    fn a_sine_on_a_trend_is_found_with_its_amplitude() {
        let wave = |k: i32| {
            let t = f64::from(k) * 0.02;
            (t, 5.0 + 0.3 * t + 0.1 * sin(std::f64::consts::TAU * t / 1.9))
        };
        let series: Vec<(f64, f64)> = (0..3000).map(wave).collect();
        let (period, amplitude) = dominant_period(&series);
        assert!((period / 1.9 - 1.0).abs() < 0.01, "{period}");
        assert!((amplitude / 0.1 - 1.0).abs() < 0.05, "{amplitude}");
    }
}
