//! A case that consists of a table of compositions (variants with their methods), facts, and studies.

use std::{fmt::Display, marker::PhantomData, rc::Rc};

use touchstone_base::{
    absent::Absent,
    gate::{Bound, Evidence, Gate},
    record::{MetricName, Record},
    settings::{self, Field, SettingError, Settings, Values},
    spec::RunSpec,
};

pub use crate::case::Recommended;
use crate::{
    case::{Case, RunError, Tier, Variant},
    context::Context,
    facts::Facts,
    method::{MediumSetting, Method},
    problem::{AnyProblem, Problem},
    rules::state_steps,
    studies::Change,
    study::Studies,
};

/// The run with settings, without their types.
type Pose = dyn Fn(&dyn Values) -> Result<Box<dyn AnyProblem>, RunError>;

/// A variant: its name, its method, and its settings before `--set`.
pub struct Composition {
    variant: Variant,
    settings: Box<dyn Values>,
    pose: Box<Pose>,
    /// Settings that its terms and walls do not read: the variant refuses them.
    lacks: Vec<&'static str>,
    /// Settings of a run that differ from the variant's, as `key=value`.
    changed: String,
}

/// The variants of a case with these settings.
pub struct Compositions<T> {
    all: Vec<Composition>,
    settings: PhantomData<fn(T)>,
}

/// The run of any of some methods with settings.
type PoseBy<M, T> = dyn Fn(&M, &T) -> Result<Box<dyn AnyProblem>, RunError>;

/// Variants that are run alike, one after another.
pub struct Variants<T, M> {
    pose: Rc<PoseBy<M, T>>,
    /// The compositions so far.
    pub all: Compositions<T>,
}

impl<T: Settings, M: 'static> Variants<T, M> {
    /// An empty list of variants: the run of each method with settings.
    pub fn of<P: Problem + 'static>(
        pose: impl Fn(&M, &T) -> Result<P, RunError> + 'static,
    ) -> Self {
        let all = Compositions { all: Vec::new(), settings: PhantomData };
        Self { pose: Rc::new(move |m, s| Ok(Box::new(pose(m, s)?))), all }
    }

    /// Adds a variant that refuses settings: name and description, method, the names of the refused settings,
    /// and a function that changes the default settings.
    #[must_use]
    pub fn lacking(
        mut self,
        [name, about]: [&'static str; 2],
        method: M,
        lacks: Vec<&'static str>,
        adjust: impl FnOnce(&mut T),
    ) -> Self {
        let (pose, mut settings) = (Rc::clone(&self.pose), Box::new(T::default()));
        adjust(&mut settings);
        let pose = Box::new(move |settings: &dyn Values| pose(&method, &typed(settings)));
        let (variant, changed) = (Variant { name, about }, String::new());
        self.all.all.push(Composition { variant, settings, pose, lacks, changed });
        self
    }
}

impl<T: Settings, X: 'static, D: ?Sized + 'static> Variants<T, Method<X, D>> {
    /// Adds a variant: name, description, method, and a function that changes the default settings. It
    /// refuses settings that its terms and walls do not read.
    #[must_use]
    pub fn with(
        self,
        name: &'static str,
        about: &'static str,
        method: Method<X, D>,
        adjust: impl FnOnce(&mut T),
    ) -> Self {
        let lacks = MediumSetting::others(&method.properties.uses, T::all());
        self.lacking([name, about], method, lacks, adjust)
    }
}

/// Settings of another instance of this settings type.
fn typed<T: Settings>(settings: &dyn Values) -> T {
    let mut of_type = T::default();
    of_type.put(&settings.values());
    of_type
}

impl Composition {
    fn variants(all: &[Self]) -> Vec<Variant> {
        all.iter().map(|of| of.variant).collect()
    }

    /// The variant with this name.
    fn named(case: &'static str, mut all: Vec<Self>, variant: &str) -> Result<Self, RunError> {
        let known: Vec<_> = all.iter().map(|of| of.variant.name).collect();
        let (what, name) = (format!("variant of {case}"), variant.into());
        match known.iter().position(|name| *name == variant) {
            Some(place) => Ok(all.swap_remove(place)),
            None => Err(RunError::Unknown { what, name, known }),
        }
    }

    /// The variant of a run, with the settings of the run.
    fn of_run(case: &'static str, all: Vec<Self>, spec: &RunSpec) -> Result<Self, RunError> {
        let mut chosen = Self::named(case, all, &spec.variant)?;
        let settings = &mut *chosen.settings;
        let (fields, before) = (settings.fields(), settings.values());
        let refused = |SettingError(reason)| RunError::Settings { case: case.into(), reason };
        settings::read(settings, &spec.settings).map_err(refused)?;
        settings::validate(settings)?;
        let now = settings.values();
        let changed =
            fields.iter().zip(now.iter().zip(&before)).filter(|(_, (now, was))| now != was);
        let changed = changed.map(|(field, (now, _))| format!("{}={now}", field.name));
        chosen.changed = changed.collect::<Vec<_>>().join(" ");
        let is_changed = |key: &&&str| {
            let place = fields.iter().position(|field| field.name == **key);
            place.is_some_and(|k| now[k] != before[k])
        };
        match chosen.lacks.iter().find(is_changed) {
            Some(key) => Err(chosen.unused(key)),
            None => Ok(chosen),
        }
    }

    fn unused(&self, key: &str) -> RunError {
        RunError::Unused { key: key.into(), variant: self.variant.name.into() }
    }

    /// The settings with `key=value` texts applied.
    fn set(mut self, texts: &[String]) -> Result<serde_json::Value, RunError> {
        let settings = &mut *self.settings;
        settings::apply(settings, texts)?;
        settings::validate(settings)?;
        let mut set = texts.iter().filter_map(|text| text.split_once('='));
        match set.find(|(key, _)| self.lacks.contains(&key.trim())) {
            Some((key, _)) => Err(self.unused(key.trim())),
            None => Ok(settings::to_json(settings)),
        }
    }

    /// Runs it.
    fn run(self, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
        // All settings in canonical form, including those that the spec leaves out.
        let settings = settings::to_json(&*self.settings);
        let spec = RunSpec { settings, ..spec.clone() };
        let made = (self.pose)(&*self.settings)?.simulate(&Context { spec, ..context.clone() });
        let mut record = made.map_err(|error| match error {
            RunError::Scene(scene) if !self.changed.is_empty() => {
                RunError::SceneOf { set: self.changed, scene }
            }
            other => other,
        })?;
        state_steps(&mut record);
        record.take_out(&|_, metric| !metric.value.is_finite(), &Absent::because(NO_NUMBER));
        Ok(record)
    }
}

/// Why a metric of a run is absent whose value is not finite: the gates on it fail.
const NO_NUMBER: &str =
    "with these settings its formula has no finite value, such as a mean of no values";

/// A table of compositions as a [`Case`].
pub struct Composed<T> {
    /// Name on the command line.
    pub name: &'static str,
    /// The problem in at most ten words.
    pub problem: &'static str,
    /// The variant that runs unless another one is named, and why.
    pub recommended: Recommended,
    /// The problem in words.
    pub about: &'static str,
    /// The variants.
    pub variants: fn() -> Compositions<T>,
    /// The facts that depend on neither tier nor run.
    pub facts: fn() -> Facts,
    /// The studies of the quick or the full tier.
    pub studies: fn(Tier) -> Studies,
}

impl<T: Settings> Composed<T> {
    /// The run of a variant with its default settings, changed by `set`. A name that no variant has, or a
    /// value out of range, makes a run that is refused, with the reason in its record.
    pub fn spec(&self, variant: &str, set: impl FnOnce(&mut T)) -> RunSpec {
        self.spec_of(variant, &self.chosen(variant, set))
    }

    /// The settings of a variant, changed.
    pub fn chosen(&self, variant: &str, set: impl FnOnce(&mut T)) -> T {
        let mut settings = self.defaults(variant);
        set(&mut settings);
        settings
    }

    /// The settings of a variant before any is set.
    pub fn defaults(&self, variant: &str) -> T {
        let found = Composition::named(self.name, (self.variants)().all, variant);
        found.map_or_else(|_| T::default(), |found| typed(&*found.settings))
    }

    /// A run of this case with its settings changed; none if the result is out of range.
    pub fn altered(&self, spec: &RunSpec, set: impl FnOnce(&mut T)) -> Option<RunSpec> {
        let mut settings: T = settings::of_json(&spec.settings).ok()?;
        set(&mut settings);
        settings::validate(&settings).ok()?;
        Some(RunSpec { settings: settings::to_json(&settings), ..spec.clone() })
    }

    /// The run of a variant with these settings.
    pub fn spec_of(&self, variant: &str, settings: &T) -> RunSpec {
        RunSpec::new(self.name, variant, settings::to_json(settings))
    }

    /// The gates of a run of this name.
    pub fn gates(&self, run: impl Display) -> RunGates {
        RunGates { name: format!("{}.{run}", self.name) }
    }

    /// Runs of a variant, each with one change of the settings that `base` sets.
    pub fn changes(
        &self,
        variant: &str,
        base: impl Fn(&mut T),
        changes: &[SettingChange<T>],
    ) -> Vec<Change> {
        let change = |(what, part, set): &SettingChange<T>| {
            let mut settings = self.chosen(variant, &base);
            set(&mut settings);
            Change::new(*what, part, self.spec_of(variant, &settings))
        };
        changes.iter().map(change).collect()
    }
}

/// A change of settings: its name, the part of the error that it affects, and the function that sets it.
pub type SettingChange<T> = (&'static str, &'static str, fn(&mut T));

/// The gates of a run, called `case.run.metric`.
pub struct RunGates {
    /// `case.run`.
    name: String,
}

impl RunGates {
    /// A gate on a metric.
    ///
    /// # Panics
    /// If the gate is unsound, see [`Gate::new`].
    pub fn gate(
        &self,
        metric: impl Into<MetricName>,
        bound: Bound,
        evidence: Evidence,
        because: &str,
    ) -> Gate {
        let metric = String::from(metric.into());
        Gate::new(format!("{}.{metric}", self.name), metric, bound, evidence, because)
    }

    /// A gate whose bound follows from an exact solution.
    pub fn analytic(&self, metric: impl Into<MetricName>, bound: Bound, because: &str) -> Gate {
        self.gate(metric, bound, Evidence::Analytic, because)
    }

    /// A gate whose bound follows from a law that holds for every solution.
    pub fn invariant(&self, metric: impl Into<MetricName>, bound: Bound, because: &str) -> Gate {
        self.gate(metric, bound, Evidence::Invariant, because)
    }

    /// A gate whose bound follows from the theory of the method.
    pub fn theory(&self, metric: impl Into<MetricName>, bound: Bound, because: &str) -> Gate {
        self.gate(metric, bound, Evidence::Theory, because)
    }

    /// A gate whose bound follows from an experiment or an independent computation.
    pub fn reference(&self, metric: impl Into<MetricName>, bound: Bound, because: &str) -> Gate {
        self.gate(metric, bound, Evidence::Reference, because)
    }
}

impl<T: Settings> Case for Composed<T> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn family(&self) -> &'static str {
        T::MODULE.split("::").nth(1).unwrap_or_default()
    }

    fn problem(&self) -> &'static str {
        self.problem
    }

    fn about(&self) -> &'static str {
        self.about
    }

    fn recommended(&self) -> Recommended {
        self.recommended
    }

    fn variants(&self) -> Vec<Variant> {
        Composition::variants(&(self.variants)().all)
    }

    fn fields(&self) -> &'static [Field] {
        T::all()
    }

    fn settings(&self, variant: &str, set: &[String]) -> Result<serde_json::Value, RunError> {
        Composition::named(self.name, (self.variants)().all, variant)?.set(set)
    }

    fn run(&self, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
        Composition::of_run(self.name, (self.variants)().all, spec)?.run(spec, context)
    }

    fn pose(&self, spec: &RunSpec) -> Result<Box<dyn AnyProblem>, RunError> {
        let found = Composition::of_run(self.name, (self.variants)().all, spec)?;
        (found.pose)(&*found.settings)
    }

    fn facts(&self) -> Facts {
        (self.facts)()
    }

    fn studies(&self, tier: Tier) -> Studies {
        let studies = (self.studies)(tier.declared());
        if tier == Tier::Deep { studies.deepened() } else { studies }
    }
}
