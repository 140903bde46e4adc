//! Ensembles: the time until which their members agree, and the distribution after it.

use touchstone_base::{
    gate::{Bound, Evidence, Gate},
    record::Record,
    spec::RunSpec,
};
use touchstone_report::{
    Axis, BandPoint, Cell, Colour, Dash, Figure, Layer, Plot, Series, Table, sig,
};

use super::{PointsOf, anchor};
use crate::{
    columns::TableColumns,
    horizon::{Horizon, TimeSeries},
    quantiles::{CONFIDENCE, Quantile},
    runs::{Judged, Planned, Runs},
    section::Section,
    study::Study,
};

/// Points of a curve that are drawn.
const DRAWN: usize = 160;
/// Shares of the members below the quartiles and the median.
const LOWER: f64 = 0.25;
const MEDIAN: f64 = 0.5;
const UPPER: f64 = 0.75;

/// The ensembles of a case: runs that differ only by a small disorder of their start. Before their horizon
/// all members agree; after it each is one sample of a distribution.
pub struct Ensembles {
    /// The runs, in one or two sentences.
    pub about: String,
    /// Name of the time, and its unit.
    pub time: [&'static str; 2],
    /// The ensembles.
    pub of: Vec<Ensemble>,
}

/// The runs of one variant that differ in the seed of their disorder.
pub struct Ensemble {
    /// Name with which its gates begin.
    pub id: String,
    /// Name of the variant.
    pub variant: &'static str,
    /// The resolution in words, such as `H/dx = 20`.
    pub label: String,
    /// Its runs.
    pub members: Vec<RunSpec>,
    /// Quantities over time.
    pub histories: Vec<History>,
    /// The numbers whose distribution is shown.
    pub numbers: Vec<MemberNumber>,
    /// Is it drawn?
    pub is_drawn: bool,
}

/// A history, by which members part.
pub struct History {
    /// Name with its unit, as for an axis.
    pub name: String,
    /// Points of a record.
    pub points: PointsOf,
    /// Members part where they differ by more than this, the standard uncertainty of the experiment.
    pub tolerance: f64,
    /// Points of each experiment.
    pub measured: Vec<Vec<(f64, f64)>>,
    /// Is it drawn?
    pub is_drawn: bool,
    /// A gate on the time until which all members agree.
    pub gate: Option<Gate>,
}

/// A number of a record.
pub type NumberOf = Box<dyn Fn(&Record) -> Option<f64> + Send + Sync>;

/// A number that each member gives, and which has a distribution.
pub struct MemberNumber {
    /// Name, and unit.
    pub name: [&'static str; 2],
    /// Value of a record, if measured.
    pub value: NumberOf,
    /// Value of each experiment.
    pub measured: Vec<f64>,
    /// A gate on the median.
    pub gate: Option<Gate>,
}

/// An ensemble, and the records of the members that reached their end.
struct CompletedEnsemble<'a> {
    of: &'a Ensemble,
    records: Vec<&'a Record>,
}

/// A history of an ensemble.
struct Followed<'a> {
    of: &'a History,
    /// One a member.
    curves: Vec<TimeSeries>,
    /// When they do, or why that is not known.
    horizon: Result<Horizon, String>,
}

impl<'a> Followed<'a> {
    fn of(of: &'a History, records: &[&Record]) -> Self {
        let curves: Vec<TimeSeries> = records.iter().map(|record| (of.points)(record)).collect();
        let horizon = Horizon::of(&curves, of.tolerance);
        Self { of, curves, horizon }
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
            Err(reason) => format!("inconclusive: {reason}"),
            Ok(Horizon { first, .. }) if first.is_infinite() => format!("all agree until {end}"),
            Ok(Horizon { time, .. }) if time.is_infinite() => {
                format!("most pairs agree until {end}")
            }
            Ok(Horizon { time, .. }) => format!("predictable until {}", sig(*time, 3)),
        }
    }
}

impl Study for Ensembles {
    fn runs(&self) -> Vec<Planned> {
        let members = self.of.iter().flat_map(|ensemble| &ensemble.members);
        members.map(|spec| Planned::new(spec.clone())).collect()
    }

    fn evaluate(&self, case: &str, runs: &Runs) -> Option<Section> {
        Some(evaluate(case, self, runs))
    }
}

fn evaluate(case: &str, ensembles: &Ensembles, runs: &Runs) -> Section {
    let made = |of| -> CompletedEnsemble {
        CompletedEnsemble {
            of,
            records: of.members.iter().filter_map(|spec| runs.completed(spec)).collect(),
        }
    };
    let all: Vec<CompletedEnsemble> = ensembles.of.iter().map(made).collect();
    let (mut followed, mut numbers) = (Vec::new(), Vec::new());
    for made in &all {
        let of = |of| (made, Followed::of(of, &made.records));
        followed.extend(made.of.histories.iter().map(of));
        let values = |of: &MemberNumber| {
            made.records.iter().filter_map(|record| (of.value)(record)).collect()
        };
        numbers.extend(made.of.numbers.iter().map(|of| (made, of, values(of))));
    }
    let id = anchor(case, "ensembles");
    let mut section = Section::new(&id, "Ensembles: predictable results and chance")
        .prose(&*ensembles.about)
        .block(figure(&id, &ensembles.time, &followed))
        .block(horizons(ensembles.time[1], &followed))
        .block(distributions(&numbers));
    section.judged.extend(all.iter().map(complete));
    section.judged.extend(followed.iter().filter_map(|(_, followed)| {
        let gate = followed.of.gate.clone();
        gate.map(|gate| Judged::in_unit(ensembles.time[1], gate, followed.agree()))
    }));
    section.judged.extend(numbers.iter().filter_map(|(_, number, values)| {
        let median = Quantile::of_sample(values, 0.5).value;
        let median = Some(median).filter(|median| median.is_finite());
        number.gate.clone().map(|gate| Judged::in_unit(number.name[1], gate, median))
    }));
    section
}

/// A distribution without the members that ended early would be biased.
fn complete(made: &CompletedEnsemble) -> Judged {
    let (id, all) = (format!("{}.members", made.of.id), made.of.members.len() as f64);
    let because =
        "A distribution without the members that ended early is one of those that did not.";
    let name = "members that reached the end [1]";
    let gate = Gate::new(id, name, Bound::Equals(all), Evidence::Invariant, because);
    Judged::new(gate, Some(made.records.len() as f64))
}

/// A number of an ensemble with its values, one a member.
type Numbered<'a> = (&'a CompletedEnsemble<'a>, &'a MemberNumber, Vec<f64>);

fn horizons(unit: &str, all: &[(&CompletedEnsemble, Followed)]) -> Table {
    let caption = format!(
        "Horizons: the median over all pairs of members of the time at which they first differ by \
         more than the tolerance, with the interval of {} % of a bootstrap over the members, and the time at \
         which the first pair parts. The tolerance is the standard uncertainty of the experiment. A dash \
         is a time that no run reaches.",
        sig(100.0 * CONFIDENCE, 2)
    );
    type Row<'a> = (&'a CompletedEnsemble<'a>, Followed<'a>);
    let horizon = |of: fn(&Horizon) -> f64| {
        move |(_, followed): &Row| followed.horizon.as_ref().map_or(f64::NAN, of)
    };
    let show = |value| Cell::num(value, 3);
    TableColumns::<Row>::default()
        .code("variant", |(made, _)| made.of.variant)
        .text("resolution", |(made, _)| made.of.label.clone())
        .text("members", |(made, _)| format!("{} of {}", made.records.len(), made.of.members.len()))
        .text("history", |(_, followed)| followed.of.name.clone())
        .of(["tolerance", ""], |(_, followed)| followed.of.tolerance, show)
        .of(["horizon", unit], horizon(|horizon| horizon.time), show)
        .of(["from", unit], horizon(|horizon| horizon.within[0]), show)
        .of(["to", unit], horizon(|horizon| horizon.within[1]), show)
        .of(["first pair", unit], horizon(|horizon| horizon.first), show)
        .text("verdict", |(_, followed)| followed.in_words())
        .table(caption, all)
}

fn distributions(all: &[Numbered]) -> Table {
    let caption = format!(
        "Distributions over the members. Intervals of median and quartiles lie between order statistics and \
         hold with at least {} % for any distribution. Every existing repetition is measured.",
        sig(100.0 * CONFIDENCE, 2)
    );
    let show = |value| Cell::num(value, 3);
    let quarter = |share: f64| {
        move |(.., values): &Numbered| {
            let Quantile { value, within } = Quantile::of_sample(values, share);
            let [low, high] = within.unwrap_or([f64::NAN; 2]);
            let [shown, low, high] = [value, low, high]
                .map(|value| if value.is_finite() { sig(value, 3) } else { "–".into() });
            Cell { value: Some(value), ..Cell::text(format!("{shown} ({low} … {high})")) }
        }
    };
    let end = |fold: fn(f64, f64) -> f64| {
        move |(.., values): &Numbered| values.iter().copied().fold(f64::NAN, fold)
    };
    let measured = |(_, number, _): &Numbered| {
        let all: Vec<String> = number.measured.iter().map(|value| sig(*value, 3)).collect();
        if all.is_empty() { "–".to_string() } else { all.join("; ") }
    };
    TableColumns::<Numbered>::default()
        .code("variant", |(made, ..)| made.of.variant)
        .text("resolution", |(made, ..)| made.of.label.clone())
        .text("number", |(_, number, _)| number.name[0])
        .text("unit", |(_, number, _)| number.name[1])
        .num(["median", ""], quarter(MEDIAN))
        .num(["lower quartile", ""], quarter(LOWER))
        .num(["upper quartile", ""], quarter(UPPER))
        .of(["least", ""], end(f64::min), show)
        .of(["largest", ""], end(f64::max), show)
        .text("measured", measured)
        .table(caption, all)
}

fn figure(id: &str, time: &[&str; 2], all: &[(&CompletedEnsemble, Followed)]) -> Figure {
    let drawn = all.iter().filter(|(made, of)| made.of.is_drawn && of.of.is_drawn);
    let drawn: Vec<_> = drawn.collect();
    let columns = drawn.iter().filter(|(made, _)| made.of.id == drawn[0].0.of.id).count();
    let caption = "How far is a run of chaotic water determined? Median, quartiles (dark band) and range \
                   (pale band) of members that differ by round-off, finest spacing. Black is the \
                   experiment, each series for itself. To the right of the dashed line, the horizon, a run \
                   is one draw.";
    let figure = Figure::new(id, caption).columns(columns.max(1));
    let panels = drawn.iter().map(|(made, followed)| panel(time, made, followed));
    panels.fold(figure, Figure::panel).panel_size(300.0, 220.0)
}

fn panel([time, unit]: &[&str; 2], made: &CompletedEnsemble, followed: &Followed) -> Plot {
    let title = format!("{}, {}", made.of.variant, made.of.label);
    let quantiles = quantiles(&followed.curves);
    let range = |of: &Quantiles| BandPoint { x: of.time, lower: of.least, upper: of.largest };
    let middle = |of: &Quantiles| BandPoint { x: of.time, lower: of.lower, upper: of.upper };
    let median = quantiles.iter().map(|of| (of.time, of.median)).collect();
    let end = followed.end();
    let measured = followed.of.measured.iter().map(|curve| {
        let until: TimeSeries = curve.iter().filter(|(t, _)| *t <= end).copied().collect();
        Series::line("", until).colour(Colour::BLACK).width(0.8)
    });
    let least = quantiles.iter().map(|of| of.least).fold(f64::NAN, f64::min);
    let most = quantiles.iter().map(|of| of.largest).fold(f64::NAN, f64::max);
    let (x, y) = (Axis::linear(format!("{time} [{unit}]")), Axis::linear(&followed.of.name));
    let mut plot = Plot::new(title, x, y)
        .layer(Layer::Band { points: quantiles.iter().map(range).collect(), colour: Colour::GREY })
        .layer(Layer::Band { points: quantiles.iter().map(middle).collect(), colour: Colour::BLUE })
        .layer(Series::line("", median).colour(Colour::BLUE));
    plot = measured.fold(plot, Plot::layer);
    if let Ok(Horizon { time, .. }) = &followed.horizon
        && time.is_finite()
    {
        let line = Series::line("", vec![(*time, least), (*time, most)]).dash(Dash::Dashed);
        plot = plot.layer(line.colour(Colour::VERMILLION).width(1.0));
    }
    plot.without_legend()
}

/// The members of an ensemble at a time.
struct Quantiles {
    time: f64,
    least: f64,
    /// Lower quartile.
    lower: f64,
    median: f64,
    /// Upper quartile.
    upper: f64,
    largest: f64,
}

/// The members at each drawn time; none for members sampled at different times.
fn quantiles(members: &[TimeSeries]) -> Vec<Quantiles> {
    let Some(first) = members.first().filter(|f| members.iter().all(|m| m.len() == f.len())) else {
        return Vec::new();
    };
    let every = first.len().div_ceil(DRAWN).max(1);
    let at = |k: usize| {
        let values: Vec<f64> = members.iter().map(|member| member[k].1).collect();
        let of = |share| Quantile::of_sample(&values, share).value;
        Quantiles {
            time: first[k].0,
            least: of(0.0),
            lower: of(LOWER),
            median: of(MEDIAN),
            upper: of(UPPER),
            largest: of(1.0),
        }
    };
    (0..first.len()).step_by(every).map(at).collect()
}

#[cfg(test)]
mod tests {
    use touchstone_base::record::Status;
    use touchstone_report::Block;

    use super::*;
    use crate::{
        runs::JudgedRun,
        studies::tests::{ERROR, column, evaluate, run, spec, tables},
    };

    const ALL: usize = 20;

    /// Members k = 1 … 20 whose history is (k − 10.5) 1e-6 exp(2t) until t = 8 and whose number is k.
    fn member(n: usize) -> JudgedRun {
        run(spec("seed", n), |record| record.put(ERROR, n as f64))
    }

    fn ensembles() -> Ensembles {
        let points = |record: &Record| {
            let own = 1e-6 * (record.value(ERROR).unwrap_or(f64::NAN) - 10.5);
            let at = |k: u32| 0.01 * f64::from(k);
            (0..=800).map(at).map(|t| (t, own * touchstone_base::functions::exp(2.0 * t))).collect()
        };
        let gate = |name: &str, bound| {
            Gate::new(format!("case.{name}"), name, bound, Evidence::Invariant, "made up")
        };
        let history = History {
            name: "level [H]".into(),
            points: Box::new(points),
            tolerance: 0.06,
            measured: vec![vec![(0.0, 0.0), (9.0, 1.0)]],
            is_drawn: true,
            gate: Some(gate("agree", Bound::Above(4.0))),
        };
        let number = MemberNumber {
            name: ["number", "1"],
            value: Box::new(|record| record.value(ERROR)),
            measured: vec![3.0, 4.0],
            gate: Some(gate("median", Bound::Within(9.0, 12.0))),
        };
        let of = Ensemble {
            id: "case.ensemble".into(),
            variant: "seed",
            label: "n = 1".into(),
            members: (1..=ALL).map(|n| spec("seed", n)).collect(),
            histories: vec![history],
            numbers: vec![number],
            is_drawn: true,
        };
        Ensembles { about: "Made up.".into(), time: ["time", "s"], of: vec![of] }
    }

    /// The names of the gates that fail, and the study.
    fn judged(members: Vec<JudgedRun>) -> (Vec<String>, Section) {
        let study = evaluate(&ensembles(), Runs::new(members));
        let failed = study.judged.iter().filter(|of| of.judgement.verdict.is_failure());
        (failed.map(|of| of.gate.id.clone()).collect(), study)
    }

    fn all() -> Vec<JudgedRun> {
        (1..=ALL).map(member).collect()
    }

    fn row(study: &Section, table: usize, heads: &[&str]) -> Vec<String> {
        heads.iter().map(|head| column(tables(study)[table], head)[0].clone()).collect()
    }

    #[test]
    fn a_known_divergence_and_known_quantiles_are_shown_and_judged() {
        let (failed, study) = judged(all());
        assert_eq!(failed, [""; 0]);
        let agree = study.judged.iter().find(|judged| judged.gate.id == "case.agree");
        let agree = agree.and_then(|judged| judged.judgement.value).expect("a time");
        assert!((agree - 4.03).abs() < 1e-9, "all agree until {agree}");
        // The first pair, 19 e-6 apart, parts at ln(0.06/19e-6)/2 = 4.03, and the
        // median, of 6e-6, at ln(0.06/6e-6)/2 = 4.61: each at the next sample.
        let found = row(&study, 0, &["members", "tolerance", "horizon", "first pair", "verdict"]);
        assert_eq!(found, ["20 of 20", "0.0600", "4.61", "4.03", "predictable until 4.61"]);
        let heads = ["median", "lower quartile", "upper quartile", "least", "largest", "measured"];
        let found = row(&study, 1, &heads);
        let quartiles = ["10.5 (6.00 … 15.0)", "5.75 (2.00 … 10.0)", "15.2 (11.0 … 19.0)"];
        assert_eq!(found[..3], quartiles);
        assert_eq!(found[3..], ["1.00", "20.0", "3.00; 4.00"]);
        let figure = study.blocks.iter().find_map(|block| match block {
            Block::Figure(figure) => Some(figure),
            _ => None,
        });
        let [plot] = figure.expect("a figure").panels.as_slice() else { panic!("one plot") };
        // Two bands, the median, one series of the experiment until the end of the runs, the horizon.
        assert_eq!(plot.layers.len(), 5);
        // The history of member k is (k − 10.5) 1e-6 exp(2t): at t = 8 the range is ± 9.5, the quartiles ±
        // 4.75.
        let unit = 1e-6 * touchstone_base::functions::exp(16.0);
        for (layer, ends) in plot.layers.iter().zip([[-9.5, 9.5], [-4.75, 4.75]]) {
            let Layer::Band { points, .. } = layer else { panic!("a band") };
            let BandPoint { x, lower, upper } = points.last().expect("points");
            assert!((x - 8.0).abs() < 0.05);
            let unit = unit * touchstone_base::functions::exp(2.0 * (x - 8.0));
            for (found, expected) in [lower, upper].into_iter().zip(ends) {
                assert!((found / unit / expected - 1.0).abs() < 1e-9, "{found}, not {expected}");
            }
            assert!((100..=DRAWN).contains(&points.len()), "{} of 801 points", points.len());
        }
        let [Layer::Series(measured), Layer::Series(horizon)] = &plot.layers[3..] else {
            panic!("two lines")
        };
        assert_eq!(measured.points, [(0.0, 0.0)], "the runs end at 8, before the second point");
        let is_late = |(t, _): &(f64, f64)| (t - 4.61).abs() < 1e-9;
        assert!(horizon.points.len() == 2 && horizon.points.iter().all(is_late), "{horizon:?}");
    }

    #[test]
    fn a_member_that_diverged_or_is_missing_fails_its_gate_and_the_others_are_shown() {
        let mut diverged = all();
        diverged[4].record.status = Status::Interrupted { step: 1, time: 0.1 };
        for members in [diverged, all()[1..].to_vec()] {
            let (failed, study) = judged(members);
            assert_eq!(failed, ["case.ensemble.members"]);
            assert_eq!(row(&study, 0, &["members"]), ["19 of 20"]);
        }
    }

    #[test]
    fn what_cannot_be_told_has_its_reason_and_fails_its_gate() {
        let reason = |study: &Section| row(study, 0, &["horizon", "verdict"]);
        let (failed, one) = judged(all()[..1].to_vec());
        assert_eq!(failed, ["case.ensemble.members", "case.agree", "case.median"]);
        assert_eq!(reason(&one), ["–", "inconclusive: 1 members; 6 are needed"]);
        assert_eq!(row(&one, 1, &["median"]), ["1.00 (– … –)"]);
        let (failed, none) = judged(Vec::new());
        assert_eq!(failed.len(), 3);
        assert_eq!(row(&none, 1, &["median", "least"]), ["– (– … –)", "–"]);
    }

    #[test]
    fn members_that_never_part_agree_until_the_end_of_the_runs() {
        let same = |n| run(spec("seed", n), |record| record.put(ERROR, 10.5));
        let (failed, study) = judged((1..=ALL).map(same).collect());
        assert_eq!(failed, [""; 0]);
        assert_eq!(row(&study, 0, &["horizon", "verdict"]), ["–", "all agree until 8.00"]);
        let but_one = |n| run(spec("seed", n), |record| record.put(ERROR, 10.5 + (n / ALL) as f64));
        let (_, study) = judged((1..=ALL).map(but_one).collect());
        assert_eq!(row(&study, 0, &["horizon", "verdict"]), ["–", "most pairs agree until 8.00"]);
    }
}
