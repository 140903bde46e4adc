//! Ensembles: until when their members agree, and how what comes later is distributed.

use base::{
    gate::{Bound, Evidence, Gate},
    record::Record,
};
use report::{Axis, Cell, Colour, Dash, Figure, Layer, Legend, Plot, Series, Table, sig};

use super::validation::Found;
use crate::{
    columns::Columns,
    ensemble::{Ensemble, Ensembles, History, Number},
    horizon::{Curve, Horizon},
    quantiles::{CONFIDENCE, Quantile},
    runs::{Judged, Runs},
    study::Study,
};

/// Points of a curve that are drawn.
const DRAWN: usize = 160;
const QUARTERS: [f64; 3] = [0.25, 0.5, 0.75];

/// An ensemble, and the records of those of its members that reached their end.
struct Made<'a> {
    of: &'a Ensemble,
    records: Vec<&'a Record>,
}

/// A history of an ensemble.
struct Followed<'a> {
    of: &'a History,
    /// One a member.
    curves: Vec<Curve>,
    /// Members part by more than this.
    tolerance: f64,
    /// When they do, or why that is not known.
    horizon: Result<Horizon, String>,
}

impl<'a> Followed<'a> {
    fn of(of: &'a History, records: &[&Record], runs: &Runs) -> Self {
        let curves: Vec<Curve> = records.iter().map(|record| (of.points)(record)).collect();
        let (comparison, unit) = &of.tolerance;
        let tolerance = Found::of(comparison, runs).uncertainty() * unit;
        let horizon = Horizon::of(&curves, tolerance);
        Self { of, curves, tolerance, horizon }
    }

    /// The end of the runs; NaN if there are none.
    fn end(&self) -> f64 {
        self.curves.iter().flatten().fold(f64::NAN, |end, (t, _)| end.max(*t))
    }

    /// The time until which all members agree, at most the end of the runs; none if it is not known.
    fn agree(&self) -> Option<f64> {
        self.horizon.as_ref().ok().map(|horizon| horizon.first.min(self.end()))
    }

    fn in_words(&self) -> String {
        let end = sig(self.end(), 3);
        match &self.horizon {
            Err(reason) => format!("nothing can be said: {reason}"),
            Ok(Horizon { first, .. }) if first.is_infinite() => format!("all agree until {end}"),
            Ok(Horizon { time, .. }) if time.is_infinite() => {
                format!("most pairs agree until {end}")
            }
            Ok(_) => "a draw beyond the horizon".into(),
        }
    }
}

/// The study.
pub fn study(ensembles: &Ensembles, runs: &Runs) -> Study {
    let completed = |of: &Ensemble| of.members.iter().filter_map(|s| runs.completed(s)).collect();
    let all: Vec<Made> =
        ensembles.of.iter().map(|of| Made { of, records: completed(of) }).collect();
    let followed: Vec<(&Made, Followed)> = all
        .iter()
        .flat_map(|made| made.of.histories.iter().map(move |history| (made, history)))
        .map(|(made, history)| (made, Followed::of(history, &made.records, runs)))
        .collect();
    let numbers: Vec<(&Made, &Number)> =
        all.iter().flat_map(|made| made.of.numbers.iter().map(move |of| (made, of))).collect();
    let mut study = Study::new(&ensembles.id, "Ensembles: what a run predicts and what is a draw")
        .prose(&*ensembles.about)
        .block(figure(ensembles, &followed))
        .block(horizons(ensembles.time[1], &followed))
        .block(distributions(&numbers));
    study.judged.extend(all.iter().map(complete));
    study.judged.extend(followed.iter().filter_map(|(_, followed)| {
        followed.of.gate.clone().map(|gate| Judged::new(gate, followed.agree()))
    }));
    study.judged.extend(numbers.iter().filter_map(|(made, number)| {
        let median = quantile(made, number, 0.5).value;
        number.gate.clone().map(|gate| Judged::new(gate, Some(median).filter(|m| m.is_finite())))
    }));
    study
}

/// A distribution without those members that ended early would be that of the lucky ones.
fn complete(made: &Made) -> Judged {
    let (id, all) = (format!("{}.members", made.of.id), made.of.members.len() as f64);
    let because = "A distribution without the members that ended early is one of those that did not.";
    let name = "members that reached their end [1]";
    let gate = Gate::new(id, name, Bound::Equals(all), Evidence::Invariant, because);
    Judged::new(gate, Some(made.records.len() as f64))
}

fn values(made: &Made, number: &Number) -> Vec<f64> {
    made.records.iter().filter_map(|record| (number.value)(record)).collect()
}

fn quantile(made: &Made, number: &Number, share: f64) -> Quantile {
    Quantile::of_sample(&values(made, number), share)
}

fn horizons(unit: &str, all: &[(&Made, Followed)]) -> Table {
    let caption = format!(
        "Horizons: the median over all pairs of members of the time at which they first differ by \
         more than the tolerance, with the interval of {} % of a bootstrap over the members, and the time at \
         which the first pair parts. The tolerance is u_val of the comparison with the experiment. A dash \
         is a time that no run reaches.",
        sig(100.0 * CONFIDENCE, 2)
    );
    type Row<'a> = (&'a Made<'a>, Followed<'a>);
    let horizon = |of: fn(&Horizon) -> f64| {
        move |(_, followed): &Row| followed.horizon.as_ref().map_or(f64::NAN, of)
    };
    let show = |value| Cell::num(value, 3);
    Columns::<Row>::default()
        .code("variant", |(made, _)| made.of.variant)
        .text("resolution", |(made, _)| made.of.label.clone())
        .text("members", |(made, _)| format!("{} of {}", made.records.len(), made.of.members.len()))
        .text("history", |(_, followed)| followed.of.name.clone())
        .of(["tolerance", ""], |(_, followed)| followed.tolerance, show)
        .of(["horizon", unit], horizon(|horizon| horizon.time), show)
        .of(["from", unit], horizon(|horizon| horizon.within[0]), show)
        .of(["to", unit], horizon(|horizon| horizon.within[1]), show)
        .of(["first pair", unit], horizon(|horizon| horizon.first), show)
        .text("verdict", |(_, followed)| followed.in_words())
        .table(caption, all)
}

fn distributions(all: &[(&Made, &Number)]) -> Table {
    let caption = format!(
        "Distributions over the members. Intervals of median and quartiles lie between order statistics and \
         hold with at least {} % whatever the distribution is. Measured is each repetition that there is.",
        sig(100.0 * CONFIDENCE, 2)
    );
    type Row<'a> = (&'a Made<'a>, &'a Number);
    let show = |value| Cell::num(value, 3);
    let shown = |quantile: Quantile| {
        let [value, low, high] = [
            quantile.value,
            quantile.within.map_or(f64::NAN, |[low, _]| low),
            quantile.within.map_or(f64::NAN, |[_, high]| high),
        ]
        .map(|value| if value.is_finite() { sig(value, 3) } else { "–".into() });
        Cell { value: Some(quantile.value), ..Cell::text(format!("{value} ({low} … {high})")) }
    };
    let end = |(made, number): &Row, fold: fn(f64, f64) -> f64| {
        values(made, number).into_iter().fold(f64::NAN, fold)
    };
    let quarter = |share| move |(made, number): &Row| shown(quantile(made, number, share));
    let measured = |(_, number): &Row| {
        let all: Vec<String> = number.measured.iter().map(|value| sig(*value, 3)).collect();
        if all.is_empty() { "–".to_string() } else { all.join("; ") }
    };
    Columns::<Row>::default()
        .code("variant", |(made, _)| made.of.variant)
        .text("resolution", |(made, _)| made.of.label.clone())
        .text("number", |(_, number)| number.name[0])
        .text("unit", |(_, number)| number.name[1])
        .num(["median", ""], quarter(QUARTERS[1]))
        .num(["lower quartile", ""], quarter(QUARTERS[0]))
        .num(["upper quartile", ""], quarter(QUARTERS[2]))
        .of(["least", ""], move |row| end(row, f64::min), show)
        .of(["largest", ""], move |row| end(row, f64::max), show)
        .text("measured", measured)
        .table(caption, all)
}

fn figure(ensembles: &Ensembles, all: &[(&Made, Followed)]) -> Figure {
    let drawn = all.iter().filter(|(made, of)| made.of.is_drawn && of.of.is_drawn);
    let drawn: Vec<_> = drawn.collect();
    let columns = drawn.iter().filter(|(made, _)| made.of.id == drawn[0].0.of.id).count();
    let caption = "Median, quartiles (dark band) and range (pale band) of the members over time, of the \
                   ensembles with the finest spacing. Black is the experiment, each series for itself. The \
                   dashed line is the horizon: to its right a run is one draw.";
    let figure = Figure::new(&ensembles.id, caption).columns(columns.max(1));
    let panels = drawn.iter().map(|(made, followed)| panel(&ensembles.time, made, followed));
    panels.fold(figure, Figure::panel).panel_size(300.0, 220.0)
}

fn panel([time, unit]: &[&str; 2], made: &Made, followed: &Followed) -> Plot {
    let title = format!("{}, {}", made.of.variant, made.of.label);
    let quantiles = quantiles(&followed.curves);
    let band = |[low, high]: [usize; 2]| {
        quantiles.iter().map(|(t, all)| (*t, all[low], all[high])).collect()
    };
    let median = quantiles.iter().map(|(t, all)| (*t, all[2])).collect();
    let end = followed.end();
    let measured = followed.of.measured.iter().map(|curve| {
        let until: Curve = curve.iter().filter(|(t, _)| *t <= end).copied().collect();
        Series::line("", thinned(&until)).colour(Colour::BLACK).width(0.8)
    });
    let least = quantiles.iter().map(|(_, all)| all[0]).fold(0.0, f64::min);
    let most = quantiles.iter().map(|(_, all)| all[4]).fold(least, f64::max);
    let shown = measured.clone().flat_map(|series| series.points);
    let top = 1.05 * shown.map(|(_, y)| y).fold(most, f64::max);
    let axes = (Axis::linear(format!("{time} [{unit}]")), Axis::linear(&followed.of.name));
    let x = if end > 0.0 { axes.0.range(0.0, end) } else { axes.0 };
    let y = if top > least { axes.1.range(least, top) } else { axes.1 };
    let mut plot = Plot::new(title, x, y)
        .layer(Layer::band("", band([0, 4]), Colour::GREY))
        .layer(Layer::band("", band([1, 3]), Colour::BLUE))
        .layer(Series::line("", median).colour(Colour::BLUE));
    plot = measured.fold(plot, Plot::layer);
    if let Ok(Horizon { time, .. }) = &followed.horizon
        && time.is_finite()
    {
        let line = Series::line("", vec![(*time, least), (*time, top)]).dash(Dash::Dashed);
        plot = plot.layer(line.colour(Colour::VERMILLION).width(1.0));
    }
    plot.legend(Legend::Hidden)
}

/// Least, quartiles, median and largest of the members at each time that is drawn; none of members that are
/// not sampled at the same times.
fn quantiles(members: &[Curve]) -> Vec<(f64, [f64; 5])> {
    let Some(first) = members.first().filter(|f| members.iter().all(|m| m.len() == f.len())) else {
        return Vec::new();
    };
    let every = first.len().div_ceil(DRAWN).max(1);
    let at = |k: usize| {
        let values: Vec<f64> = members.iter().map(|member| member[k].1).collect();
        let of = |share| Quantile::of_sample(&values, share).value;
        (first[k].0, [0.0, QUARTERS[0], QUARTERS[1], QUARTERS[2], 1.0].map(of))
    };
    (0..first.len()).step_by(every).map(at).collect()
}

/// A curve with as few points as are drawn.
fn thinned(curve: &Curve) -> Curve {
    curve.iter().step_by(curve.len().div_ceil(2 * DRAWN).max(1)).copied().collect()
}
