//! A case that consists of a table of compositions (variants with their methods), a declaration, a plan, and
//! studies of its own.

use std::{fmt::Display, rc::Rc};

use base::{
    gate::{Bound, Evidence, Gate},
    record::{MetricName, Record},
    settings::{self, Field, Settings},
    spec::RunSpec,
};

pub use crate::case::Best;
use crate::{
    case::{Case, Planned, Rules, RunError, Tier, Variant},
    context::Context,
    declare::Declaration,
    deep::deepened,
    method::{Knob, Method},
    rules::state_steps,
};

/// What runs a variant with these settings.
pub type Run<T> = dyn Fn(&T, &Context) -> Result<Record, RunError>;

/// What states the rules of a variant.
pub type Ruled<T> = dyn Fn(&T) -> Result<Rules, RunError>;

/// A variant: its name, its settings before `--set`, and its method.
pub struct Composition<T> {
    /// Name and description.
    pub variant: Variant,
    /// How it changes the default settings.
    pub adjust: fn(&mut T),
    /// What runs it.
    pub run: Box<Run<T>>,
    /// What states its rules.
    pub rules: Box<Ruled<T>>,
    /// Settings that none of its terms and walls reads: the variant refuses them.
    pub lacks: Vec<&'static str>,
}

/// What runs any of some methods with settings.
type RunBy<M, T> = dyn Fn(&M, &T, &Context) -> Result<Record, RunError>;

/// What their rules choose from settings.
type RulesBy<M, T> = dyn Fn(&M, &T) -> Result<Rules, RunError>;

/// Variants that are run alike, one after another.
pub struct Variants<T, M> {
    run: Rc<RunBy<M, T>>,
    rules: Rc<RulesBy<M, T>>,
    /// Those so far.
    pub all: Vec<Composition<T>>,
}

impl<T: Settings + 'static, X: 'static, D: ?Sized + 'static> Variants<T, Method<X, D>> {
    /// An empty list of variants: what runs each method with settings, and what the rules choose from these.
    pub fn of(
        run: impl Fn(&Method<X, D>, &T, &Context) -> Result<Record, RunError> + 'static,
        rules: impl Fn(&Method<X, D>, &T) -> Result<Rules, RunError> + 'static,
    ) -> Self {
        Self { run: Rc::new(run), rules: Rc::new(rules), all: Vec::new() }
    }

    /// Adds a variant: name, description, method, and a function that changes the default settings.
    #[must_use]
    pub fn with(
        mut self,
        name: &'static str,
        about: &'static str,
        method: Method<X, D>,
        adjust: fn(&mut T),
    ) -> Self {
        let (run, rules) = (Rc::clone(&self.run), Rc::clone(&self.rules));
        let method = Rc::new(method);
        let is_setting = |name: &&str| T::FIELDS.iter().any(|field| field.name == *name);
        let lacks = Knob::others(&method.uses).filter(is_setting).collect();
        let ruled = Rc::clone(&method);
        self.all.push(Composition {
            variant: Variant { name, about },
            adjust,
            run: Box::new(move |settings, context| run(&method, settings, context)),
            rules: Box::new(move |settings| rules(&ruled, settings)),
            lacks,
        });
        self
    }
}

/// A table of compositions as a [`Case`].
pub struct Composed<T> {
    /// Name on the command line.
    pub name: &'static str,
    /// The problem in at most ten words.
    pub problem: &'static str,
    /// The variant that runs unless another one is named, and why.
    pub best: Best,
    /// The problem in words.
    pub about: &'static str,
    /// The variants.
    pub variants: fn() -> Vec<Composition<T>>,
    /// The declaration from which the studies common to all cases are made.
    pub declaration: fn(Tier) -> Declaration,
    /// The judged runs beside those of the declaration.
    pub plan: fn(Tier) -> Vec<Planned>,
}

impl<T: Settings + 'static> Composed<T> {
    /// The run of a variant with its default settings, changed by `set`. A name that no variant has, or a
    /// value out of range, makes a run that is refused, with the reason in its record.
    pub fn spec(&self, variant: &str, set: impl FnOnce(&mut T)) -> RunSpec {
        self.spec_of(variant, &self.chosen(variant, set))
    }

    /// The settings of a variant, changed.
    pub fn chosen(&self, variant: &str, set: impl FnOnce(&mut T)) -> T {
        let found = self.composition(variant).ok();
        let mut settings = found.map_or_else(T::default, |(_, defaults)| defaults);
        set(&mut settings);
        settings
    }

    /// The run of a variant with these settings.
    pub fn spec_of(&self, variant: &str, settings: &T) -> RunSpec {
        RunSpec::new(self.name, variant, serde_json::to_value(settings).unwrap_or_default())
    }

    /// A gate on a metric of a run, called `case.run.metric`.
    ///
    /// # Panics
    /// If the gate is unsound, see [`Gate::new`].
    pub fn gate(
        &self,
        run: impl Display,
        metric: impl Into<MetricName>,
        bound: Bound,
        evidence: Evidence,
        because: &str,
    ) -> Gate {
        let metric = String::from(metric.into());
        Gate::new(format!("{}.{run}.{metric}", self.name), metric, bound, evidence, because)
    }

    /// The composition of that name, and its settings before any is set.
    fn composition(&self, variant: &str) -> Result<(Composition<T>, T), RunError> {
        let mut all = (self.variants)();
        let known: Vec<_> = all.iter().map(|of| of.variant.name).collect();
        let Some(place) = known.iter().position(|name| *name == variant) else {
            return Err(RunError::Variant { case: self.name, name: variant.into(), known });
        };
        let (chosen, mut defaults) = (all.swap_remove(place), T::default());
        (chosen.adjust)(&mut defaults);
        Ok((chosen, defaults))
    }

    /// The composition of a run and its settings.
    fn resolve(&self, spec: &RunSpec) -> Result<(Composition<T>, T), RunError> {
        let (chosen, defaults) = self.composition(&spec.variant)?;
        let settings: T = serde_json::from_value(spec.settings.clone()).map_err(|reason| {
            RunError::Settings { case: self.name.into(), reason: reason.to_string() }
        })?;
        settings.validate()?;
        let is_changed = |key: &&&str| settings.get(key) != defaults.get(key);
        if let Some(key) = chosen.lacks.iter().find(is_changed) {
            let (key, variant) = (key.to_string(), spec.variant.clone());
            return Err(RunError::Unused { key, variant });
        }
        Ok((chosen, settings))
    }
}

impl<T: Settings + 'static> Case for Composed<T> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn family(&self) -> &'static str {
        T::MODULE.split("::").next().unwrap_or_default()
    }

    fn problem(&self) -> &'static str {
        self.problem
    }

    fn about(&self) -> &'static str {
        self.about
    }

    fn best(&self) -> Best {
        self.best
    }

    fn variants(&self) -> Vec<Variant> {
        (self.variants)().into_iter().map(|v| v.variant).collect()
    }

    fn fields(&self) -> &'static [Field] {
        T::FIELDS
    }

    fn settings(&self, variant: &str, set: &[String]) -> Result<serde_json::Value, RunError> {
        let (chosen, mut settings) = self.composition(variant)?;
        settings::apply(&mut settings, set)?;
        settings.validate()?;
        let mut keys =
            set.iter().filter_map(|text| text.split_once('=')).map(|(key, _)| key.trim());
        match keys.find(|key| chosen.lacks.contains(key)) {
            Some(key) => Err(RunError::Unused { key: key.into(), variant: variant.into() }),
            None => Ok(serde_json::to_value(settings).unwrap_or_default()),
        }
    }

    fn run(&self, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
        let (chosen, settings) = self.resolve(spec)?;
        // All settings in their usual form, those that the spec leaves out included.
        let json = serde_json::to_value(&settings).unwrap_or_default();
        let spec = RunSpec { settings: json, ..spec.clone() };
        let mut record = (chosen.run)(&settings, &Context { spec, ..context.clone() })?;
        state_steps(&mut record);
        Ok(record)
    }

    fn rules(&self, spec: &RunSpec) -> Result<Rules, RunError> {
        let (chosen, settings) = self.resolve(spec)?;
        (chosen.rules)(&settings)
    }

    fn declaration(&self, tier: Tier) -> Declaration {
        let declared = (self.declaration)(tier.declared());
        if tier == Tier::Deep { deepened(declared, self) } else { declared }
    }

    fn plan(&self, tier: Tier) -> Vec<Planned> {
        (self.plan)(tier.declared())
    }
}
