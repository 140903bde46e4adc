//! The interface of a benchmark case: description of the problem, settings, variants to compare, and
//! studies.

use serde_json::Value;
use touchstone_base::{
    record::Record,
    settings::{self, Field, Kind},
    spec::{RunSpec, SpecError, Task},
};

use crate::{context::Context, problem::AnyProblem, study::Studies};
pub use crate::{
    error::RunError,
    facts::{Drawn, Draws, Facts, Parameter, Statement, SubmittedCurve},
    limits::TimeStepLimits,
    rules::{PLANNED_DT, Rules, Step},
    runs::{Planned, Tier},
};

/// One named composition of types with its default settings.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    /// Name on the command line.
    pub name: &'static str,
    /// Description of the variant, one line.
    pub about: &'static str,
}

/// The variant of a case that runs unless another one is named. No variant has the smallest error in every
/// case and every metric.
#[derive(Clone, Copy, Debug)]
pub struct Recommended {
    /// Name.
    pub variant: &'static str,
    /// The reason, with numbers: each is followed by a comment that names its source, as in the documents,
    /// and a test compares the two.
    pub because: &'static str,
    /// The variant that is the paper's, or comes closest to it.
    pub papers: Option<&'static str>,
}

impl Recommended {
    /// The reason without the comments that name the sources of its numbers.
    pub fn reason(&self) -> String {
        let mut parts = self.because.split("<!-- ");
        let first = parts.next().unwrap_or_default().to_string();
        let after = |part: &'static str| part.split_once(" -->").map_or("", |(_, after)| after);
        parts.map(after).fold(first, |text, part| text + part)
    }
}

/// A benchmark.
pub trait Case: Sync {
    /// Name on the command line.
    fn name(&self) -> &'static str;
    /// The family that it belongs to, by the name of its crate.
    fn family(&self) -> &'static str;
    /// The problem in at most ten words, for lists.
    fn problem(&self) -> &'static str;
    /// The problem in words, a paragraph.
    fn about(&self) -> &'static str;
    /// The variants to compare.
    fn variants(&self) -> Vec<Variant>;
    /// The variant that the case recommends.
    fn recommended(&self) -> Recommended;
    /// The settings.
    fn fields(&self) -> &'static [Field];
    /// All settings of a variant with `key=value` texts applied, as the record states them.
    fn settings(&self, variant: &str, set: &[String]) -> Result<Value, RunError>;
    /// A run of these settings, before its particles are made.
    ///
    /// # Errors
    /// The first setting that no run can have.
    fn pose(&self, spec: &RunSpec) -> Result<Box<dyn AnyProblem>, RunError> {
        Err(RunError::NoRules(spec.case.clone()))
    }
    /// Simulates a run.
    ///
    /// # Errors
    /// If it is refused.
    fn run(&self, spec: &RunSpec, context: &Context) -> Result<Record, RunError>;
    /// Time step and sound speed that follow from the settings of a run, without making any step.
    ///
    /// # Errors
    /// As [`Case::pose`], or if the case states no rules.
    fn rules(&self, spec: &RunSpec) -> Result<Rules, RunError> {
        let brief = self.pose(spec)?.brief();
        if brief.is_limited { Ok(brief.rules) } else { Err(RunError::NoRules(spec.case.clone())) }
    }
    /// The facts that depend on neither tier nor run.
    fn facts(&self) -> Facts {
        Facts::default()
    }
    /// The studies of a tier: the one source of its runs, gates, tables and figures.
    fn studies(&self, tier: Tier) -> Studies;
}

/// One simulation of a case. Settings that are refused give a record too, with the reason.
///
/// # Errors
/// Why it cannot be made for another reason than its settings.
pub fn record_of(case: &dyn Case, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
    match case.run(spec, context) {
        Err(refusal) if refusal.is_refusal() => Ok(Record::refused(spec, refusal.to_string())),
        made => made,
    }
}

/// The run of a case with the settings that `key=value` texts describe.
pub fn spec(case: &dyn Case, variant: &str, set: &[String]) -> Result<RunSpec, RunError> {
    Ok(RunSpec::new(case.name(), variant, case.settings(variant, set)?))
}

/// The run that a document describes, with every setting of its case in its usual form, so that equal runs
/// have equal keys however they are written. Settings that it leaves out have the default of the variant.
///
/// # Errors
/// The first name, setting or field that no run of the case can have.
pub fn resolved(case: &dyn Case, spec: RunSpec) -> Result<RunSpec, RunError> {
    spec.check()?;
    let Value::Object(given) = &spec.settings else {
        let (value, allowed) = (spec.settings.to_string(), "an object of settings by name");
        return Err(SpecError { field: "settings", value, allowed }.into());
    };
    let defaults = case.settings(&spec.variant, &[])?;
    let is_default = |name: &String, value: &Value| match (defaults.get(name), value.as_f64()) {
        (Some(default), Some(number)) => default.as_f64() == Some(number),
        (default, _) => default == Some(value),
    };
    let others = given.iter().filter(|(name, value)| !is_default(name, value));
    let set: Vec<String> =
        others.map(|(name, value)| format!("{name}={}", settings::text(value))).collect();
    let settings = case.settings(&spec.variant, &set)?;
    if let Task::Bisect(bisect) = &spec.task {
        let is_real = |field: &&Field| matches!(field.kind, Kind::Real | Kind::RealOrAuto);
        let end = bisect.end.map(|_| "end");
        for key in std::iter::once(bisect.setting.as_str()).chain(end) {
            let mut fields = case.fields().iter().filter(is_real);
            if !fields.any(|field| field.name == key) {
                return Err(settings::unknown(case.fields(), key).into());
            }
        }
    }
    Ok(RunSpec { settings, ..spec })
}

/// The command that makes a run.
pub fn command(case: &dyn Case, spec: &RunSpec) -> String {
    let set = changed(case, spec).into_iter().map(|assignment| format!(" --set {assignment}"));
    format!("touchstone run {} --variant {}{}", case.name(), spec.variant, set.collect::<String>())
}

/// The settings in which a run differs from the defaults of its variant, with their values.
pub fn changes(case: &dyn Case, spec: &RunSpec) -> Vec<(&'static Field, settings::Value)> {
    let defaults = case.settings(&spec.variant, &[]).unwrap_or_default();
    let given = case.fields().iter().filter_map(|of| Some((of, of.of_json(&spec.settings)?)));
    given.filter(|(field, value)| field.of_json(&defaults) != Some(*value)).collect()
}

/// [`changes`] as `key=value`.
pub fn changed(case: &dyn Case, spec: &RunSpec) -> Vec<String> {
    changes(case, spec).into_iter().map(assignment).collect()
}

/// A setting with its value as `key=value`, without the decimals of a whole number.
pub fn assignment((field, value): (&'static Field, settings::Value)) -> String {
    match value {
        settings::Value::Real(real) => format!("{}={real}", field.name),
        other => format!("{}={other}", field.name),
    }
}

/// The case of that name among these.
pub fn find_in(cases: &[&'static dyn Case], name: &str) -> Result<&'static dyn Case, RunError> {
    let known = || cases.iter().map(|case| case.name()).collect();
    let unknown = || RunError::Unknown { what: "case".into(), name: name.into(), known: known() };
    cases.iter().copied().find(|case| case.name() == name).ok_or_else(unknown)
}
