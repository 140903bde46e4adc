//! The row of a case on the first screen of the report: the errors of the recommended variant and of the
//! paper's, the order of the error, the price of a tenth of it, and the setting at which runs break.

use serde_json::Value;
use touchstone_base::{
    functions::{ln, powf},
    record::{MetricKey, MetricName, Record, Status},
    spec::RunSpec,
};
use touchstone_report::{
    Block, Cell, Figure, Subject, TableColumn, code, exact, plain, sci, seconds, sig,
};

use super::{
    Accuracy, Comparison, Comparisons, CurvePanel, Curves, Ladder, Level, Map, cost,
    validation::ComparisonResult,
};
use crate::{
    case::Case,
    convergence::{Label, convergence, slope},
    pictures::Picture,
    runs::{Planned, Runs},
    section::Section,
    study::{Studies, Study},
};

/// Summary of a case at the top of the report: its error with the recommended variant and with the paper's.
pub struct Card {
    /// Name of the problem.
    pub title: &'static str,
    /// The study with the picture: the still of its film, or else its first panel that shows the first of the
    /// runs, at any resolution ([`Card::pictured`]).
    pub picture: &'static str,
    /// The scene of the picture, if it is not the scene of the runs; otherwise empty.
    pub pictured_scene: &'static str,
    /// The error, also of the ladders of the case ([`Accuracy::error`]).
    pub metric: MetricName,
    /// The words for the error of a run.
    pub stated: fn(&RunSpec) -> Stated,
    /// Further numbers of a run in a sentence, if it has them.
    pub beside: Option<fn(&Record) -> Option<String>>,
    /// The run of the recommended variant and the run of the paper's.
    pub runs: Vec<RunSpec>,
    /// Where runs of these variants break.
    pub breaks: Breaks,
}

impl Card {
    /// The panel of the figure on the card: the first that shows the first run of the card, at any resolution
    /// of the ladders of the case; with another scene, that shows its variant.
    pub fn pictured(&self, studies: &Studies) -> Option<usize> {
        let wanted = self.runs.first()?;
        let levels = studies.of::<Accuracy>().flat_map(|accuracy| &accuracy.ladders);
        let levels: Vec<&RunSpec> =
            levels.flat_map(|ladder| &ladder.levels).map(|level| &level.run.spec).collect();
        let is_resolution = |name: &str| {
            let values = levels.iter().filter(|spec| spec.variant == wanted.variant);
            let mut values = values.map(|spec| &spec.settings[name]);
            values.next().is_some_and(|first| values.any(|value| value != first))
        };
        let is_shown = |spec: &RunSpec| {
            let (Some(a), Some(b)) = (spec.settings.as_object(), wanted.settings.as_object())
            else {
                return false;
            };
            let mut differ = a.iter().filter(|(name, value)| b.get(*name) != Some(*value));
            let is_other = !self.pictured_scene.is_empty();
            spec.variant == wanted.variant
                && (is_other || differ.all(|(name, _)| is_resolution(name)))
        };
        let curves =
            studies.of::<Curves>().find(|curves| curves.id == self.picture).map(|curves| {
                let shows =
                    |panel: &CurvePanel| panel.lines.iter().any(|line| is_shown(&line.spec));
                curves.panels.iter().position(shows)
            });
        let mut pictures = studies.of::<Picture>();
        let picture = pictures.find(|picture| picture.heading.id == self.picture);
        let place = |of: &Picture| of.panels.iter().position(|panel| is_shown(&panel.spec));
        curves.unwrap_or_else(|| picture.and_then(place))
    }

    /// The card of a case that a test makes up, which breaks nowhere.
    #[doc(hidden)]
    pub fn made_up(metric: MetricKey, runs: Vec<RunSpec>) -> Self {
        let stated = |_: &RunSpec| Stated {
            name: "made up".into(),
            against: "nothing",
            uncertainty: None,
            unit: "",
        };
        let breaks =
            Breaks { value: |_| 0.0, words: ["", ""], has_broken: |_| Some(false), sign: "" };
        let (title, picture, pictured_scene, metric) = ("Main", "none", "", metric.into());
        Card { title, picture, pictured_scene, metric, stated, beside: None, runs, breaks }
    }
}

impl Studies {
    /// The first ladder of several resolutions.
    pub fn ladder(&self) -> Option<&Ladder> {
        let mut ladders = self.of::<Accuracy>().flat_map(|accuracy| &accuracy.ladders);
        ladders.find(|ladder| ladder.levels.len() > 1)
    }

    /// The error of the case: of its card, or else of its first ladder.
    pub fn error(&self) -> Option<&MetricName> {
        let ladder = self.first::<Accuracy>().map(|accuracy| &accuracy.error);
        self.first::<Card>().map(|card| &card.metric).or(ladder)
    }

    /// A value of this error, of a run, in its unit.
    pub fn number(&self, record: &Record, value: f64) -> String {
        if let Some(card) = self.first::<Card>() {
            return (card.stated)(&record.run).number(value);
        }
        let metric = self.error().and_then(|metric| record.metrics.get(&metric.name));
        match metric.map_or("-", |metric| &*metric.unit) {
            "-" | "1" => touchstone_report::percent(value, 2),
            unit => format!("{}\u{a0}{unit}", touchstone_report::sig(value, 2)),
        }
    }
}

/// The card is shown before all sections.
impl Study for Card {
    fn runs(&self) -> Vec<Planned> {
        self.runs.iter().cloned().map(Planned::new).collect()
    }

    fn evaluate(&self, _: &str, _: &Runs) -> Option<Section> {
        None
    }
}

/// The words for an error, which depend on the settings of the run.
pub struct Stated {
    /// Name, with the conditions of the run.
    pub name: String,
    /// The reference.
    pub against: &'static str,
    /// Standard uncertainty of the reference, in the unit of the error; none if it is exact.
    pub uncertainty: Option<f64>,
    /// Unit of the error; empty for a share, which is shown in per cent.
    pub unit: &'static str,
}

impl Stated {
    /// The words for a share against an exact reference. In the name, each `{setting}` is replaced by its
    /// value.
    pub fn new(run: &RunSpec, name: &str, against: &'static str) -> Self {
        let all = run.settings.as_object().into_iter().flatten();
        let name = all.fold(name.to_string(), |name, (setting, _)| {
            name.replace(&format!("{{{setting}}}"), &Self::setting(&run.settings, setting))
        });
        Self { name, against, uncertainty: None, unit: "" }
    }

    /// The text of a setting.
    fn setting(settings: &Value, name: &str) -> String {
        settings[name].as_f64().map_or_else(|| settings[name].to_string(), touchstone_report::exact)
    }

    /// A number in the unit of the error.
    pub fn number(&self, value: f64) -> String {
        if self.unit.is_empty() {
            return touchstone_report::percent(value, 2);
        }
        format!("{}\u{a0}{}", touchstone_report::sig(value, 2), self.unit)
    }

    /// The name and the reference.
    pub fn in_words(&self) -> String {
        let uncertainty = self.uncertainty.map(|u| format!(" (± {})", self.number(u)));
        format!("{}, against {}{}", self.name, self.against, uncertainty.unwrap_or_default())
    }
}

/// The setting over which a case looks for the value at which runs break.
pub struct Breaks {
    /// The value of the setting in a run.
    pub value: fn(&RunSpec) -> f64,
    /// The words before and after its values.
    pub words: [&'static str; 2],
    /// Whether the result of a run is broken although it may have reached its end; none if the run does not
    /// answer the question, such as a control.
    pub has_broken: fn(&Record) -> Option<bool>,
    /// The sign of that in words.
    pub sign: &'static str,
}

/// The columns of the table on the first screen.
pub fn columns() -> Vec<TableColumn> {
    let numbers = [
        "error",
        "order",
        "paper's error",
        "pairs for 1/10 error",
        "time for 1/10 error",
        "breaks at",
        "paper's breaks at",
    ];
    let numbers = numbers.map(|head| TableColumn::num(head, ""));
    [vec![TableColumn::text("recommended")], numbers.into()].concat()
}

/// Content of a row.
struct Answer<'a> {
    case: &'static dyn Case,
    studies: &'a Studies,
    runs: &'a Runs,
    metric: &'a MetricName,
    /// The run of the recommended variant, and the run of the paper's, if they are in the plan.
    shown: [Option<RunSpec>; 2],
}

/// Orders in the spacing of a ladder, and its finest level.
struct Orders {
    error: f64,
    pairs: f64,
    time: f64,
    finest: cost::LadderPoint,
}

/// The recommended variant and the paper's.
fn shown_variants(case: &dyn Case) -> [Option<&'static str>; 2] {
    let recommended = case.recommended();
    [Some(recommended.variant), recommended.papers]
}

/// The row of a case; none if no number is the error of the case.
pub fn row(
    case: &'static dyn Case,
    studies: &Studies,
    sections: &[Section],
    runs: &Runs,
) -> Option<Subject> {
    let card = studies.first::<Card>();
    let names = shown_variants(case);
    let planned = match card {
        Some(card) => card.runs.clone(),
        None => {
            studies.first::<Accuracy>()?.finest(&names.into_iter().flatten().collect::<Vec<_>>())
        }
    };
    let run_of = |name| planned.iter().find(|run| Some(&*run.variant) == name).cloned();
    let shown = names.map(run_of);
    shown.iter().flatten().next()?;
    let about = match card.zip(shown[0].as_ref()) {
        Some((card, first)) if card.pictured_scene.is_empty() => (card.stated)(first).name,
        Some((card, first)) => {
            format!("{} (picture: {})", (card.stated)(first).name, card.pictured_scene)
        }
        None => case.problem().into(),
    };
    let answer = Answer { case, studies, runs, metric: studies.error()?, shown };
    Some(Subject {
        id: case.name().into(),
        title: card.map_or(case.name().replace('_', " "), |card| card.title.into()),
        about,
        picture: card.and_then(|card| picture(card, studies, sections, runs)),
        cells: answer.cells(),
    })
}

impl Answer<'_> {
    fn cells(&self) -> Vec<Cell> {
        let [first, second] = self.shown.each_ref().map(Option::as_ref);
        let size = |spec: Option<&RunSpec>| {
            let record = self.runs.completed(spec?)?;
            record.value(self.metric.clone()).map(f64::abs)
        };
        let sizes = [size(first), size(second)];
        // Better only if the difference is larger than its expanded uncertainty, k = 2, which must be known.
        let doubt = |k: usize| {
            let spec = self.shown[k].as_ref()?;
            self.uncertainty(spec).or(self.reference(spec).is_none().then_some(0.0))
        };
        let doubt = doubt(0).zip(doubt(1)).map(|(own, other)| (own * own + other * other).sqrt());
        let wins = |k: usize| match (sizes[k], sizes[1 - k], doubt) {
            (Some(own), Some(other), Some(doubt)) => own + 2.0 * doubt < other,
            _ => false,
        };
        let dash = || Cell::text("–");
        let error = |spec, wins| self.error(spec, wins);
        let variant = code(self.case.recommended().variant);
        let recommended = Cell::marked(format!("[{variant}](#runs-{})", self.case.name()));
        let mut cells = vec![recommended, first.map_or_else(dash, |spec| error(spec, wins(0)))];
        let [order, pairs, time] = self.price();
        cells.push(order);
        cells.push(second.map_or_else(dash, |spec| error(spec, wins(1))));
        cells.extend([pairs, time]);
        cells.extend([first, second].map(|spec| spec.map_or_else(dash, |spec| self.breaks(spec))));
        cells
    }

    /// The error of a run, with its uncertainty if the case declares the comparison; a link to the gate that
    /// judges the number, else to the study that shows the run.
    fn error(&self, spec: &RunSpec, wins: bool) -> Cell {
        let Some(run) = self.runs.judged(spec) else { return Cell::text("not run") };
        let error = match headline(self.studies, &run.record) {
            Ok(error) => error,
            Err(status) => return Cell::text(status),
        };
        let gate = run.judged.iter().find(|judged| judged.gate.metric == self.metric.name);
        let target = gate.map_or_else(|| self.study(), |judged| judged.gate.id.clone());
        let link = format!("[{error}](#{target})");
        let words = |value| format!("± {}", self.studies.number(&run.record, value));
        let remark = self.uncertainty(spec).map(words).unwrap_or_default();
        Cell::marked(if wins { format!("**{link}**") } else { link }).because(remark)
    }

    /// The standard uncertainty of the error of a run, if it is known.
    fn uncertainty(&self, spec: &RunSpec) -> Option<f64> {
        self.compared(spec).map(|found| found.uncertainty()).filter(|u| u.is_finite())
    }

    /// The uncertainty of the reference of a run, if it has one.
    fn reference(&self, spec: &RunSpec) -> Option<f64> {
        self.studies.first::<Card>().and_then(|card| (card.stated)(spec).uncertainty)
    }

    /// The comparison of the error of a run with a reference that has an uncertainty: as the case declares
    /// it, or else by the levels of its variant up to this run.
    fn compared(&self, spec: &RunSpec) -> Option<ComparisonResult> {
        let is_this = |of: &&Comparison| {
            let finest = of.levels.last().map(|level| level.run.spec.key());
            of.reference > 0.0 && of.metric == *self.metric && finest == Some(spec.key())
        };
        let declared = self.studies.of::<Comparisons>().flat_map(|of| &of.0).find(is_this);
        let of_ladder = || {
            let ladders = self.studies.of::<Accuracy>().filter(|of| of.error == *self.metric);
            let mut ladders = ladders.flat_map(|of| &of.ladders);
            let ladder = ladders.find(|ladder| ladder.variant == spec.variant)?;
            let is_run = |level: &Level| level.run.spec.key() == spec.key();
            let place = ladder.levels.iter().position(is_run)?;
            Some(Comparison {
                what: String::new(),
                against: "",
                metric: self.metric.clone(),
                levels: ladder.levels[..=place].to_vec(),
                inputs: Vec::new(),
                reference: self.reference(spec)?,
                because: "",
            })
        };
        let compared = declared.cloned().or_else(of_ladder);
        compared.map(|of| ComparisonResult::of(&of, self.runs))
    }

    /// The anchor of the errors over resolutions of the case, or of the case.
    fn study(&self) -> String {
        let has_ladder = |of: &&Accuracy| of.ladders.iter().any(|ladder| ladder.levels.len() > 1);
        let accuracy = self.studies.first::<Accuracy>().filter(has_ladder);
        accuracy.map_or(self.case.name().into(), |of| format!("study-{}-work-precision", of.id))
    }

    /// The ladder of the recommended variant, if the run of the table is its finest.
    fn ladder(&self) -> Result<(&Accuracy, &Ladder), String> {
        let first = self.shown[0].as_ref().ok_or("not run")?;
        let accuracy = self.studies.first::<Accuracy>().ok_or("one resolution")?;
        let ladder = accuracy.ladders.iter().find(|ladder| ladder.variant == first.variant);
        let ladder = ladder.filter(|ladder| ladder.levels.len() > 1).ok_or("one resolution")?;
        let finest = ladder.levels.last().map(|level| level.run.spec.key());
        let is_own = finest == Some(first.key());
        is_own.then_some((accuracy, ladder)).ok_or_else(|| "one resolution".into())
    }

    /// The observed order p of the error in the spacing, if its interval of 95 % is above 0 and the levels
    /// determine the numerical uncertainty, and the factors by which pair interactions and run
    /// time grow until the error is a tenth: 10^(q/p), where q is the order at which they grow.
    fn price(&self) -> [Cell; 3] {
        match self.orders() {
            Ok(Orders { error, pairs, time, finest }) => {
                let link = |text: String| Cell::marked(format!("[{text}](#{})", self.study()));
                let factor = |q: f64, now: String| {
                    let factor = powf(10.0, q / error);
                    match factor.is_finite() {
                        true => link(format!("× {}", sig(factor, 2))).because(format!("of {now}")),
                        false => Cell::text("–").because("not timed"),
                    }
                };
                let [now, run_time] = [sci(finest.pairs, 2), seconds(finest.median())];
                [link(sig(error, 2)), factor(pairs, now), factor(time, run_time)]
            }
            Err(why) => [Cell::text("–").because(why), Cell::text("–"), Cell::text("–")],
        }
    }

    fn orders(&self) -> Result<Orders, String> {
        let (accuracy, ladder) = self.ladder()?;
        let points = cost::points(self.metric, ladder, self.runs);
        let levels: Vec<_> = points.iter().map(cost::LadderPoint::level).collect();
        let found = convergence(&levels, accuracy.slope);
        let found = found.map_err(|_| format!("{} resolutions", levels.len()))?;
        let compared = self.shown[0].as_ref().and_then(|spec| self.compared(spec));
        let is_sure = compared.is_none_or(|found| found.is_conclusive());
        if !is_sure || found.label == Label::FloorReached || found.interval[0] <= 0.0 {
            return Err("not determined".into());
        }
        let x: Vec<f64> = points.iter().map(|point| ln(point.spacing)).collect();
        let growth = |of: fn(&cost::LadderPoint) -> f64| {
            let y: Vec<f64> = points.iter().map(|point| ln(of(point))).collect();
            -slope(&x, &y).0
        };
        let [pairs, time] = [growth(|point| point.pairs), growth(cost::LadderPoint::median)];
        let finest = points.into_iter().last().ok_or("one resolution")?;
        Ok(Orders { error: found.order, pairs, time, finest })
    }

    /// The smallest value of a setting at which a run of the variant broke, or the largest at which none did.
    fn breaks(&self, spec: &RunSpec) -> Cell {
        let Some(card) = self.studies.first::<Card>() else { return Cell::text("–") };
        let Breaks { words: [before, after], sign, .. } = card.breaks;
        let map = self.studies.first::<Map>();
        let target = map.map_or_else(|| self.study(), |map| format!("study-{}", map.id));
        let link = |words: &str, value: f64| {
            let value = format!("{before}{}{after}", exact(value)).replace(' ', "\u{a0}");
            Cell::marked(format!("[{words}{value}](#{target})"))
        };
        match broken_at(card, &spec.variant, self.runs) {
            Some(Broken::At(value)) => link("", value).because(sign),
            Some(Broken::NotFrom(low, high)) if low == high => {
                Cell::text("–").because(format!("only {before}{}{after} was run", exact(low)))
            }
            Some(Broken::NotFrom(_, high)) => link("none up to ", high),
            None => Cell::text("–").because("not tried"),
        }
    }
}

/// The error of a run in the words of its case, as `run`, `verify` and the report state it.
///
/// # Errors
/// How the run ended, if the error was not measured.
pub fn headline(studies: &Studies, record: &Record) -> Result<String, String> {
    let value = studies.error().and_then(|metric| record.value(metric.clone()));
    value
        .map(|value| studies.number(record, value))
        .ok_or_else(|| plain(&record.status.to_string()))
}

/// The cost of a run in words.
pub fn cost(record: &Record) -> String {
    let known = |number: f64, words: fn(f64) -> String| match number > 0.0 {
        true => words(number),
        false => "unknown".into(),
    };
    let time = known(record.cost.alone_median().unwrap_or(record.cost.cpu_s), seconds);
    let pairs = known(record.cost.pair_interactions as f64, |pairs| sci(pairs, 2));
    format!("{time} on one core, {pairs} pairs")
}

/// Where runs of a variant break.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Broken {
    /// The smallest value of the setting at which one did.
    At(f64),
    /// The smallest and the largest value, if none did.
    NotFrom(f64, f64),
}

/// Where the simulations of a variant break; none if no run answers the question.
fn broken_at(card: &Card, variant: &str, runs: &Runs) -> Option<Broken> {
    let own = runs.simulations().filter(|record| {
        let is_plain = record.run.mutation.is_none() && record.run.disorder.is_none();
        record.run.variant == variant && is_plain
    });
    let answers = own.filter_map(|record| {
        let is_refused = matches!(record.status, Status::Refused { .. });
        let has_broken = (card.breaks.has_broken)(record).filter(|_| !is_refused)?;
        let broken = has_broken || record.status != Status::Completed;
        Some(((card.breaks.value)(&record.run), broken))
    });
    let (broken, whole): (Vec<_>, Vec<_>) = answers.partition(|(_, broken)| *broken);
    let least = broken.iter().map(|(value, _)| *value).reduce(f64::min);
    let of_whole = |of: fn(f64, f64) -> f64| whole.iter().map(|(value, _)| *value).reduce(of);
    let not = of_whole(f64::min).zip(of_whole(f64::max));
    least.map(Broken::At).or(not.map(|(low, high)| Broken::NotFrom(low, high)))
}

/// The picture of a card, as small as a row is.
fn picture(card: &Card, studies: &Studies, sections: &[Section], runs: &Runs) -> Option<Figure> {
    let (id, panel) = (card.picture, card.pictured(studies)?);
    let mut films = studies.of::<Picture>().filter(|picture| picture.heading.id == id);
    let (plot, caption) = match films.find_map(|picture| picture.film(runs)) {
        Some(film) => (film.frames.get(film.still)?.clone(), film.caption),
        None => {
            let mut blocks = sections.iter().flat_map(|section| &section.blocks);
            let figure = blocks.find_map(|block| match block {
                Block::Figure(figure) if figure.id == id => Some(figure),
                _ => None,
            })?;
            (figure.panels.get(panel)?.clone(), figure.caption.clone())
        }
    };
    let small = Figure::new(format!("{id}-small"), caption).panel(plot.small());
    Some(small.panel_size(150.0, 90.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::tests::{ERROR, comparison, run, spec};

    fn made_up() -> Card {
        Card {
            title: "Made up",
            picture: "none",
            pictured_scene: "",
            metric: ERROR.into(),
            stated: |run| Stated {
                name: format!("distance at n = {}", run.settings["n"]),
                against: "nothing",
                uncertainty: Some(0.5),
                unit: "a",
            },
            beside: None,
            runs: vec![spec("good", 1), spec("bad", 1)],
            breaks: Breaks {
                value: |run| run.settings["n"].as_f64().unwrap_or(f64::NAN),
                words: ["n = ", ""],
                has_broken: |record| Some(record.value(ERROR)? > 1.0),
                sign: "it is torn",
            },
        }
    }

    /// The card must not state "completed for" the value of a torn run, or of a variant that diverged in
    /// another run.
    #[test]
    fn a_variant_breaks_at_its_least_value_that_is_torn_or_diverges() {
        let of = |variant: &str, n, error: f64| run(spec(variant, n), |r| r.put(ERROR, error));
        let mut diverged = of("bad", 4, 0.1);
        let (field, value_text) = ("density".into(), "NaN".into());
        diverged.record.status =
            Status::Diverged { step: 1, time: 0.1, particle: 0, field, value_text };
        let good = [of("good", 2, 0.5), of("good", 7, 0.9)];
        let all = |more: Vec<_>| Runs::new(good.iter().cloned().chain(more).collect());
        let at = |variant: &str, runs: &Runs| broken_at(&made_up(), variant, runs);
        let torn = all(vec![of("bad", 1, 0.5), of("bad", 5, 2.0), of("bad", 6, 0.5)]);
        assert_eq!(at("good", &torn), Some(Broken::NotFrom(2.0, 7.0)));
        assert_eq!(at("bad", &torn), Some(Broken::At(5.0)));
        assert_eq!(at("bad", &all(vec![of("bad", 5, 2.0), diverged])), Some(Broken::At(4.0)));
        assert_eq!(at("bad", &all(Vec::new())), None);
    }

    /// The case of a row.
    struct MadeUp;

    impl Case for MadeUp {
        fn name(&self) -> &'static str {
            "case"
        }
        fn family(&self) -> &'static str {
            "none"
        }
        fn problem(&self) -> &'static str {
            "made up"
        }
        fn about(&self) -> &'static str {
            "Made up."
        }
        fn variants(&self) -> Vec<crate::case::Variant> {
            Vec::new()
        }
        fn recommended(&self) -> crate::case::Recommended {
            let because = "it is good";
            crate::case::Recommended { variant: "good", because, papers: Some("bad") }
        }
        fn fields(&self) -> &'static [touchstone_base::settings::Field] {
            &[]
        }
        fn settings(
            &self,
            _: &str,
            _: &[String],
        ) -> Result<serde_json::Value, crate::case::RunError> {
            Ok(serde_json::json!({}))
        }
        fn run(
            &self,
            _: &RunSpec,
            _: &crate::context::Context,
        ) -> Result<Record, crate::case::RunError> {
            Err(crate::case::RunError::NoRules("case".into()))
        }
        fn studies(&self, _: crate::case::Tier) -> Studies {
            Studies::default()
        }
    }

    /// The cells of a row of these errors of `good` at n = 10, 20 and 40, and of `bad` at 40; pairs are n⁴.
    fn cells(errors: [f64; 3], of_bad: f64, reference: f64) -> Vec<Cell> {
        let of = |variant: &str, n: usize, error: f64| {
            run(spec(variant, n), |record| {
                record.put(ERROR, error);
                record.cost.pair_interactions = (n as u64).pow(4);
                record.cost.alone_s = vec![1e-3 * (n as f64).powi(3)];
            })
        };
        let levels = [10, 20, 40];
        let mut all: Vec<_> =
            levels.into_iter().zip(errors).map(|(n, e)| of("good", n, e)).collect();
        all.push(of("bad", 40, of_bad));
        let runs = Runs::new(all);
        let compared = Comparison { reference, ..comparison("good", &levels) };
        let levels = compared.levels.clone();
        let refine = std::sync::Arc::new(|_: &RunSpec, _| None);
        let ladder = Ladder { variant: "good", levels, order: None, refine };
        let accuracy =
            Accuracy { ladders: vec![ladder], ..Accuracy::new("case", ERROR, "Error [-]") };
        let shown = vec![spec("good", 40), spec("bad", 40)];
        let exact = |run: &RunSpec| Stated { uncertainty: None, ..(made_up().stated)(run) };
        let card = Card { runs: shown, stated: exact, ..made_up() };
        let comparisons = Comparisons(vec![compared]);
        let studies = Studies::default().with(accuracy).with(comparisons).with(card);
        row(&MadeUp, &studies, &[], &runs).expect("a row").cells
    }

    fn texts(cells: &[Cell]) -> Vec<String> {
        let text = |cell: &Cell| {
            let shown = cell.text.replace(['*', '[', '\u{a0}'], " ");
            shown.split("](").next().unwrap_or_default().trim().to_string()
        };
        cells.iter().map(text).collect()
    }

    /// Errors of order 2, pairs of order 4 and seconds of order 3: a tenth takes 10^(4/2) and 10^(3/2).
    #[test]
    fn the_price_of_a_tenth_follows_from_the_ladder() {
        let [coarse, middle, fine] = [10.0, 20.0, 40.0].map(|n: f64| 8.0 / (n * n));
        let good = cells([coarse, middle, fine], 0.5, 0.0);
        let expected = ["`good`", "0.0050 a", "2.0", "0.50 a", "× 100", "× 32"];
        assert_eq!(texts(&good)[..6], expected);
        assert!(good[1].text.starts_with("**[") && !good[3].text.starts_with("**"), "{good:?}");
        // An error that a finer level does not lower has no price; the reason is below the dash.
        let floor = cells([coarse, middle, middle], 0.01, 0.0);
        assert_eq!(texts(&floor)[2..6], ["–", "0.010 a", "–", "–"]);
        assert_eq!(floor[2].remark, "not determined");
        assert!(floor[3].text.starts_with("**["), "the paper's is better: {:?}", floor[3]);
    }

    /// A case whose recommended variant had no ladder showed the error of the paper's as its own.
    #[test]
    fn a_variant_without_a_run_has_no_error() {
        let bad = run(spec("bad", 40), |record| record.put(ERROR, 0.5));
        let refine = std::sync::Arc::new(|_: &RunSpec, _| None);
        let levels = comparison("bad", &[40]).levels;
        let ladder = Ladder { variant: "bad", levels, order: None, refine };
        let accuracy =
            Accuracy { ladders: vec![ladder], ..Accuracy::new("case", ERROR, "Error [-]") };
        let studies = Studies::default().with(accuracy);
        let cells = row(&MadeUp, &studies, &[], &Runs::new(vec![bad])).expect("a row").cells;
        assert_eq!(texts(&cells)[..4], ["`good`", "–", "–", "50 %"]);
    }

    /// The uncertainty of an error is u_val, which includes the reference's: here (0.6² + 0.4²)^(1/2),
    /// because u_num is 3/2 of the range of the levels 0.6, 0.2 and 0.2.
    #[test]
    fn an_error_has_the_uncertainty_of_its_comparison() {
        let cells = cells([0.6, 0.2, 0.2], 0.5, 0.4);
        assert_eq!(cells[1].remark, "± 0.72\u{a0}a");
        assert_eq!(cells[3].remark, "", "a run that is compared nowhere has none");
        assert_eq!(cells[2].remark, "not determined");
    }

    /// An error has the unit and the words of the run that has it.
    #[test]
    fn an_error_is_stated_with_the_settings_of_its_run() {
        let judged = run(spec("good", 3), |r| r.put(ERROR, -0.0576));
        let studies = Studies::default().with(made_up());
        assert_eq!(headline(&studies, &judged.record), Ok("−0.058\u{a0}a".into()));
        let stated = (made_up().stated)(&judged.record.run).in_words();
        assert_eq!(stated, "distance at n = 3, against nothing (± 0.50\u{a0}a)");
    }
}
