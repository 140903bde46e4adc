//! Hypothesis H3 of the paper: pressure waves leave the walls. The lowest pressure mode between them rings
//! with the period 2L/c0 of a wave that bounces between them, whatever c0.

use super::{
    ChannelCase,
    measure::{MODE, MODE_AMPLITUDE, MODE_TIME, WINDOW},
    starts::disorder,
};
use base::functions::{cos, hypot, powf, sin};
use base::{
    gate::{Bound, Evidence, Gate},
    record::Record,
    spec::RunSpec,
};
use harness::{case::Tier, columns::Columns, runs::Runs, study::Study};
use report::{Axis, Cell, Figure, Layer, Legend, Plot, Series, Table, sci, sig};

/// Reynolds numbers and sound speeds \[V\] that are watched.
const SETTINGS: [(f64, f64); 3] = [(5.0, 10.0), (20.0, 10.0), (20.0, 20.0)];

/// Disorder of the start \[dx\]. The instability grows from it, or from round-off if there is none,
/// so that a single run says little.
const STARTS: [f64; 5] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2];

/// Those of a tier.
fn wave_starts(tier: Tier) -> &'static [f64] {
    if tier == Tier::Full { &STARTS } else { &STARTS[1..4] }
}

/// νt/L² to which waves are watched: longer, for they are judged by how they grow at the end.
const WATCHED: f64 = 1.5;

fn spec(case: &ChannelCase, (re, sound): (f64, f64), jitter: f64) -> RunSpec {
    let spec = case.spec("seed", |s| {
        (s.re, s.end, s.jitter, s.watch_mode) = (re, WATCHED, jitter, true);
        s.c0 = Some(sound * s.speed());
    });
    spec.allow_unstable()
}

/// The runs of the study.
pub fn specs(case: &ChannelCase, tier: Tier) -> Vec<RunSpec> {
    let of = |setting| wave_starts(tier).iter().map(move |jitter| spec(case, setting, *jitter));
    SETTINGS.into_iter().flat_map(of).collect()
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

impl Ringing {
    /// `None` of a run that was over before the window was full.
    fn of(record: &Record) -> Option<Self> {
        let mode = record.profiles.get(MODE)?;
        let times = mode.column(MODE_TIME).iter().copied();
        let series: Vec<(f64, f64)> =
            times.zip(mode.column(MODE_AMPLITUDE).iter().copied()).collect();
        let (period, amplitude) = dominant_period(&series);
        let (early, late): (Vec<_>, Vec<_>) = series.iter().partition(|(t, _)| *t < -0.5 * WINDOW);
        let growth = amplitude_at(&tapered(&late), period) / amplitude_at(&tapered(&early), period);
        Some(Self { series, period: 0.5 * period, amplitude, growth })
    }
}

/// Runs of one Reynolds number and sound speed.
struct Rings {
    re: f64,
    sound: f64,
    /// By period.
    runs: Vec<Ringing>,
}

impl Rings {
    /// The runs of one Re and c0/V from all starts.
    fn of(case: &ChannelCase, (re, sound): (f64, f64), tier: Tier, records: &Runs) -> Self {
        let specs = wave_starts(tier).iter().map(|jitter| spec(case, (re, sound), *jitter));
        let ringing = |spec: RunSpec| Ringing::of(records.record(&spec)?);
        let mut runs: Vec<Ringing> = specs.filter_map(ringing).collect();
        runs.sort_by(|a, b| a.period.total_cmp(&b.period));
        Self { re, sound, runs }
    }

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

/// Periods \[2L/c0\] that count as those of a bouncing wave: the next modes have 0.5 and, between a wall
/// and a free surface, 2. How far disorder lengthens the period is not known from theory.
const PERIOD: Bound = Bound::Within(0.8, 1.25);

/// The study.
pub fn study(case: &ChannelCase, tier: Tier, runs: &Runs) -> Study {
    let found = SETTINGS.map(|setting| Rings::of(case, setting, tier, runs));
    let because = "H3 says that waves bounce between the ghost walls, so the lowest mode has about the \
                   period 2L/c0. No theory says by how much disorder lengthens it. The median was 1.16 at \
                   c0/V = 10 and 1.09 at 20, and a value outside of 0.8 to 1.25 is a change of the \
                   program.";
    let mut study = Study::new("poiseuille-h3", "H3: pressure waves between the walls");
    study = study.prose(h3(&found));
    let caption = "Lowest pressure mode cos(πy/L) across the channel in Poiseuille flow of variant `seed` \
                   at Re 20, less its mean over 2L/c0. Time is in crossings of the channel by sound, so a \
                   wave that bounces between the walls has the period 2. Each line is the run of the \
                   median period.";
    let mut plot = Plot::new(
        "",
        Axis::linear("time before the end (t − t_end) c0/L [-]"),
        Axis::linear("pressure mode less its drift [ρV²]"),
    );
    for rings in found.iter().filter(|rings| rings.re == 20.0) {
        let id = format!("poiseuille.h3.period.c{}", rings.sound);
        let gate = Gate::new(id, "period [2L/c0]", PERIOD, Evidence::Regression, because);
        // NaN, which fails, if no run filled its window.
        study = study.judge(gate, rings.median(|run| run.period));
        let Some(run) = rings.typical() else { continue };
        let name = format!("c0/V = {}", rings.sound);
        plot = plot.layer(Series::line(name, without_drift(&run.series)));
    }
    let plot = plot.layer(Layer::horizontal(0.0, "")).legend(Legend::Auto);
    let figure = Figure::new("poiseuille-waves", caption).panel(plot).panel_size(620.0, 260.0);
    study.block(waves_table(tier, &found)).block(figure)
}

fn waves_table(tier: Tier, found: &[Rings]) -> Table {
    let caption = format!(
        "The lowest pressure mode cos(πy/L) in Poiseuille flow of `seed` over the last 60 L/c0 of a run. A \
         run ends by divergence or at νt/L² = {WATCHED}. Numbers are medians of runs whose initial places \
         are disordered by {} dx, without those that end too soon. In the exact flow the mode is 0, and a \
         wave that bounces between the walls has the period 2L/c0. Growth is the amplitude at the dominant \
         period in the last 30 L/c0 over that in the 30 before.",
        disorder(wave_starts(tier))
    );
    let periods = |rings: &Rings| {
        let periods: Vec<String> = rings.runs.iter().map(|run| sig(run.period, 3)).collect();
        periods.join(", ")
    };
    Columns::<Rings>::default()
        .num(["Re", "-"], |rings| Cell::exact(rings.re))
        .num(["c0/V", "-"], |rings| Cell::exact(rings.sound))
        .num(["runs", "1"], |rings| Cell::count(rings.runs.len() as u64))
        .num(["amplitude", "ρV²"], |rings| Cell::sci(rings.median(|run| run.amplitude), 2))
        .num(["growth", "1"], |rings| Cell::num(rings.median(|run| run.growth), 2))
        .num(["dominant period", "2L/c0"], |rings| Cell::num(rings.median(|run| run.period), 3))
        .text("all periods", periods)
        .table(caption, found.iter().filter(|rings| !rings.runs.is_empty()))
}

/// What the table says about H3.
fn h3(found: &[Rings]) -> String {
    let at = |re: f64, sound: f64| found.iter().find(|r| (r.re, r.sound) == (re, sound));
    let (Some(slow), Some(low), Some(high)) = (at(5.0, 10.0), at(20.0, 10.0), at(20.0, 20.0))
    else {
        return "**H3** is **open**: nothing was measured.".into();
    };
    let period = |rings: &Rings| sig(rings.median(|run| run.period), 3);
    let amplitude = |rings: &Rings| rings.median(|run| run.amplitude);
    let verdict = match (low.bounces() && high.bounces(), slow.bounces()) {
        (true, true) => "supported",
        (true, false) => "supported at Re 20, not at Re 5",
        _ => "open",
    };
    let slow_rings =
        if slow.bounces() { "has this period as well" } else { "does not have this period" };
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
        "**H3** (pressure waves leave the ghost-particle walls and keep bouncing between them) is \
         **{verdict}**. At Re 20 the median period of the lowest mode is {} times 2L/c0 at c0 = 10 V and \
         {} times at 20 V; 1 is the period of a wave that bounces between the walls. At Re 5 and c0 = 10 V \
         the mode {slow_rings} ({} times 2L/c0). Its amplitude is {} ρV² there, and {} ρV² at Re 20, {} \
         times as much. From the last but one interval of 30 L/c0 to the last, {}.",
        period(low),
        period(high),
        period(slow),
        sci(amplitude(slow), 2),
        sci(amplitude(low), 2),
        sig(amplitude(low) / amplitude(slow), 2),
        growth.join(", ")
    )
}

/// Each value less the mean over a period of a bouncing wave around it, where the series has one.
fn without_drift(series: &[(f64, f64)]) -> Vec<(f64, f64)> {
    const HALF: f64 = 1.0;
    let [Some(first), Some(last)] = [series.first(), series.last()].map(|end| end.map(|(t, _)| *t))
    else {
        return Vec::new();
    };
    let inside = |t: f64| t - HALF >= first && t + HALF <= last;
    let less_mean = |&(t, value): &(f64, f64)| {
        let from = series.partition_point(|(other, _)| *other < t - HALF);
        let to = series.partition_point(|(other, _)| *other <= t + HALF);
        let sum = series[from..to].iter().fold(0.0, |sum, (_, value)| sum + value);
        (t, value - sum / (to - from) as f64)
    };
    series.iter().filter(|(t, _)| inside(*t)).map(less_mean).collect()
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
    use super::{dominant_period, without_drift};
    use base::functions::sin;

    #[test]
    fn a_drift_is_taken_away_and_a_wave_stays() {
        let wave = |t: f64| 0.1 * sin(std::f64::consts::PI * t);
        let series: Vec<(f64, f64)> =
            (0..=1000).map(|k| 0.01 * f64::from(k)).map(|t| (t, 5.0 + 0.3 * t + wave(t))).collect();
        let found = without_drift(&series);
        assert!((800..=802).contains(&found.len()));
        assert!(found.iter().all(|(t, value)| (value - wave(*t)).abs() < 2e-3));
        assert!(without_drift(&[]).is_empty());
    }

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
