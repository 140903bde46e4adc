//! Questions for any code, each with one short problem, criteria with reasons, and named errors that it
//! finds.
//!
//! ```text
//! question ──▶ poses ──▶ problem folders ──▶ the code ──▶ results ──▶ answer: criteria and a diagnosis
//! ```
//!
//! A pose is one problem as [`crate::problem`] writes it; questions share equal poses, and the code solves
//! each of them once. A question that the code cannot be asked is *not applicable*, with the reason, and
//! never counts as a pass.

pub mod code;
mod conduct;
mod fit;
mod floating;
mod flows;
mod operators;
mod relations;
mod solids;
mod waves;

use std::fmt;

use serde_json::{Map, Value};
use touchstone_base::{functions::log10, number, text};
use touchstone_harness::relation::Relation;

pub use code::{Code, Ran, Solved};

/// One problem that a code solves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Name of the case.
    pub case: &'static str,
    /// The variant that is exported, where walls are planes.
    pub planes: &'static str,
    /// The variant that is exported, where walls are particles.
    pub particles: &'static str,
    /// Settings, `key=value`.
    pub set: Vec<String>,
    /// Whether a time step above the stability limit is allowed.
    pub allow_unstable: bool,
    /// The reference frame, for a comparison of frames.
    pub relation: Option<Relation>,
    /// Threads that the environment asks for (`OMP_NUM_THREADS`, `RAYON_NUM_THREADS`), 1 unless stated.
    pub threads: Option<u16>,
    /// Share of the end at which the run is interrupted and continued.
    pub interrupt: Option<f64>,
    /// Rows in the water of a rigid box that floats in the tank.
    pub draft: Option<usize>,
}

impl Pose {
    /// A problem without walls.
    fn of(case: &'static str, variant: &'static str, set: &[&str]) -> Self {
        let set = set.iter().map(ToString::to_string).collect();
        Self { case, planes: variant, particles: variant, set, ..Self::default() }
    }

    /// With another variant where walls are particles.
    fn or(self, particles: &'static str) -> Self {
        Self { particles, ..self }
    }

    /// With this time step \[s\], stable or not.
    fn step(mut self, dt: f64) -> Self {
        self.set.push(format!("dt={dt}"));
        Self { allow_unstable: true, ..self }
    }

    /// In a reference frame.
    fn seen(&self, relation: Relation) -> Self {
        Self { relation: Some(relation), ..self.clone() }
    }
}

/// Vortices on slightly disordered particles, a problem of several questions.
fn vortices(more: &[&str]) -> Pose {
    let set = ["n=20", "perturb=0.05", "end=0.1"];
    Pose::of("taylor_green", "plain", &[&set[..], more].concat())
}

/// A number that decides.
#[derive(Clone, Debug)]
pub struct Criterion {
    /// The quantity.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// The allowed values, ends included.
    pub allowed: [f64; 2],
    /// Why the ends are where they are.
    pub because: &'static str,
}

impl Criterion {
    fn new(name: &'static str, value: f64, allowed: [f64; 2], because: &'static str) -> Self {
        Self { name, value, allowed, because }
    }

    fn at_most(name: &'static str, value: f64, most: f64, because: &'static str) -> Self {
        Self::new(name, value, [f64::NEG_INFINITY, most], because)
    }

    fn at_least(name: &'static str, value: f64, least: f64, because: &'static str) -> Self {
        Self::new(name, value, [least, f64::INFINITY], because)
    }

    /// A value that is not finite never passes.
    pub fn passes(&self) -> bool {
        let [low, high] = self.allowed;
        self.value.is_finite() && (low..=high).contains(&self.value)
    }
}

/// A quantity as a multiple of its right value.
#[derive(Clone, Copy, Debug)]
pub struct Factor {
    /// The multiple \[-\].
    pub value: f64,
    /// Its uncertainty \[-\]: scatter of the fit, and the order of the method at this resolution.
    pub uncertainty: f64,
}

impl fmt::Display for Factor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Two digits of the uncertainty; none below `NO_RUN_DETERMINES`.
        let shown = self.uncertainty.abs().max(NO_RUN_DETERMINES);
        let digits = (1.0 - log10(shown).floor()).clamp(1.0, 9.0) as usize;
        let value = fixed(self.value, digits);
        match self.uncertainty.abs() < NO_RUN_DETERMINES {
            true => f.write_str(value.trim_end_matches('0').trim_end_matches('.')),
            false => write!(f, "{value} ± {:.digits$}", self.uncertainty),
        }
    }
}

/// Uncertainties below this are not shown.
const NO_RUN_DETERMINES: f64 = 1e-5;

/// A number with these digits behind the point, and no sign of a 0.
fn fixed(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|digit| matches!(digit, '0' | '.')) => zero.into(),
        _ => text,
    }
}

impl Factor {
    /// `viscosity is 1.97 ± 0.03 times the stated one`.
    fn of(self, quantity: &str) -> String {
        match self.uncertainty < self.value.abs() {
            true => format!("{quantity} is {self} times the stated one"),
            false => format!("the results do not determine {quantity}"),
        }
    }
}

/// The result of a question.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The diagnosis in words.
    pub diagnosis: String,
    /// The factor of it, where it is one.
    pub factor: Option<Factor>,
    /// The numbers that decide: one to three.
    pub criteria: Vec<Criterion>,
}

impl Finding {
    fn new(diagnosis: impl Into<String>, criteria: impl Into<Vec<Criterion>>) -> Self {
        Self { diagnosis: diagnosis.into(), factor: None, criteria: criteria.into() }
    }

    fn with(self, Factor { value, uncertainty }: Factor) -> Self {
        // No sign of a 0.
        Self { factor: Some(Factor { value: value + 0.0, uncertainty }), ..self }
    }
}

/// Why a question cannot be asked.
pub type NotApplicable = String;

/// How an answer is found.
pub enum Reads {
    /// In complete results of its only pose.
    One(fn(&Solved) -> Result<Finding, NotApplicable>),
    /// In complete results of all poses.
    Results(fn(&[&Solved]) -> Result<Finding, NotApplicable>),
    /// In the results of the first pose, and in the end of the second, whatever it was.
    Ends(fn(&Ran) -> Answer),
}

/// One question.
pub struct Question {
    /// Its name in commands and documents.
    pub id: &'static str,
    /// The question.
    pub text: &'static str,
    /// The problems, in the order in which [`Question::answer`] reads their results.
    pub poses: fn() -> Vec<Pose>,
    /// Finds the answer.
    pub answer: Reads,
    /// Names of errors that it finds; tests make each of them.
    pub finds: &'static [&'static str],
}

/// The answer to a question.
#[derive(Clone, Debug)]
pub enum Answer {
    /// From results.
    Found(Finding),
    /// The code did not solve the problem, and why.
    Failed(String),
    /// The reason.
    NotApplicable(NotApplicable),
}

/// A verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All criteria pass.
    Pass,
    /// One does not, or there are no results.
    Fail,
    /// The question cannot be asked.
    NotApplicable,
}

impl Verdict {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "FAIL",
            Self::NotApplicable => "not applicable",
        }
    }
}

impl From<Result<Finding, NotApplicable>> for Answer {
    fn from(read: Result<Finding, NotApplicable>) -> Self {
        read.map_or_else(Self::NotApplicable, Self::Found)
    }
}

impl Answer {
    /// The verdict.
    pub fn verdict(&self) -> Verdict {
        match self {
            Self::Found(found) => {
                let passes =
                    !found.criteria.is_empty() && found.criteria.iter().all(Criterion::passes);
                if passes { Verdict::Pass } else { Verdict::Fail }
            }
            Self::Failed(_) => Verdict::Fail,
            Self::NotApplicable(_) => Verdict::NotApplicable,
        }
    }

    /// In words.
    pub fn words(&self) -> String {
        match self {
            Self::Found(found) => found.diagnosis.clone(),
            Self::Failed(why) | Self::NotApplicable(why) => why.clone(),
        }
    }

    /// The criteria that do not pass, in words.
    pub fn failures(&self) -> Vec<String> {
        let Self::Found(found) = self else { return Vec::new() };
        let failed = found.criteria.iter().filter(|criterion| !criterion.passes());
        failed
            .map(|of| {
                format!(
                    "{} {}, allowed {}: {}",
                    of.name,
                    text::number(of.value),
                    allowed(of),
                    of.because
                )
            })
            .collect()
    }

    /// As JSON.
    pub fn to_json(&self, question: &Question) -> Value {
        let mut all = Map::new();
        let mut put = |name: &str, value: Value| all.insert(name.into(), value);
        put("id", question.id.into());
        put("question", question.text.into());
        put("verdict", self.verdict().words().to_lowercase().into());
        put("answer", self.words().into());
        if let Self::Found(found) = self {
            if let Some(Factor { value, uncertainty }) = found.factor {
                put("factor", number::json(value));
                put("uncertainty", number::json(uncertainty));
            }
            let criterion = |of: &Criterion| {
                let mut one = Map::new();
                one.insert("name".into(), of.name.into());
                one.insert("value".into(), number::json(of.value));
                let [low, high] = of.allowed;
                let ends = [("at_least", low), ("at_most", high)];
                for (name, end) in ends.into_iter().filter(|(_, end)| end.is_finite()) {
                    one.insert(name.into(), number::json(end));
                }
                one.insert("because".into(), of.because.into());
                one.insert("passes".into(), of.passes().into());
                Value::Object(one)
            };
            put("criteria", found.criteria.iter().map(criterion).collect());
        }
        Value::Object(all)
    }
}

fn allowed(of: &Criterion) -> String {
    let [low, high] = of.allowed.map(text::number);
    match of.allowed.map(f64::is_finite) {
        [true, true] => format!("{low} to {high}"),
        [true, false] => format!("at least {low}"),
        _ => format!("at most {high}"),
    }
}

/// The questions, in the order in which a code should be mended.
pub fn questions() -> Vec<Question> {
    [
        flows::did_it_run(),
        operators::density(),
        operators::gradient(),
        operators::viscous(),
        waves::shear(),
        waves::sound(),
        relations::units(),
        relations::mirrored(),
        relations::boosted(),
        relations::shifted(),
        relations::turned(),
        relations::numbers(),
        flows::conservation(),
        flows::drag(),
        flows::stick(),
        flows::slip(),
        flows::force(),
        flows::still(),
        floating::floats(),
        solids::spin(),
        solids::bend(),
        waves::order(),
        conduct::settings(),
        conduct::restart(),
        conduct::breaks(),
    ]
    .into()
}

/// Results of all problems of a question, to be named.
fn named<'a, const N: usize>(of: &[&'a Solved]) -> Result<[&'a Solved; N], NotApplicable> {
    of.try_into().map_err(|_| format!("results of {} problems; expected {N}", of.len()))
}

/// Answers questions. `solve` is called once for each pose, in order; `report` after each answer.
pub fn ask(
    questions: &[Question],
    mut solve: impl FnMut(&Pose) -> Ran,
    mut report: impl FnMut(&Question, &Answer),
) -> Vec<Answer> {
    let mut solved: Vec<(Pose, Ran)> = Vec::new();
    let mut answers = Vec::new();
    for question in questions {
        let poses = (question.poses)();
        for pose in &poses {
            if !solved.iter().any(|(known, _)| known == pose) {
                solved.push((pose.clone(), solve(pose)));
            }
        }
        let of = |pose: &Pose| solved.iter().find(|(known, _)| known == pose).map(|(_, ran)| ran);
        let ran: Vec<&Ran> = poses.iter().filter_map(of).collect();
        let answer = answer(question, &ran);
        report(question, &answer);
        answers.push(answer);
    }
    answers
}

/// The answer to a question from the results of its poses.
fn answer(question: &Question, ran: &[&Ran]) -> Answer {
    let (ran, last) = match (&question.answer, ran) {
        (Reads::Ends(_), [all @ .., last]) => (all, Some(*last)),
        _ => (ran, None),
    };
    let mut solved = Vec::new();
    for ran in ran {
        match ran {
            Ran::Solved(one) => solved.push(&**one),
            Ran::Declined(why) => return Answer::NotApplicable(why.clone()),
            other => return Answer::Failed(other.failure()),
        }
    }
    match (&question.answer, last) {
        (Reads::One(read), _) => named(&solved).and_then(|[only]| read(only)).into(),
        (Reads::Results(read), _) => read(&solved).into(),
        (Reads::Ends(read), Some(last)) => read(last),
        (Reads::Ends(_), None) => Answer::Failed("the question has no problem".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_have_the_digits_that_are_known_and_no_sign_of_zero() {
        for (value, uncertainty, words) in [
            (1.967, 0.034, "1.967 ± 0.034"),
            (1.0, 0.0, "1"),
            (-0.0, 0.0, "0"),
            (-1e-9, 0.0, "0"),
            (0.98214, 0.0, "0.98214"),
            (-0.00002, 0.005, "0.0000 ± 0.0050"),
            (0.500322, 2.3e-5, "0.500322 ± 0.000023"),
            (-121.4, 6.3, "-121.4 ± 6.3"),
        ] {
            let found = Factor { value, uncertainty }.to_string();
            assert_eq!(found, words);
        }
    }
}
