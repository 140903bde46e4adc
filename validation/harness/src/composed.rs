//! A case that is a table of compositions with a plan and studies.

use crate::{
    case::{self, Case, Planned, RunError, Tier, Variant},
    runner::Context,
    suite::{JudgedRun, Study},
};
use base::{
    record::Record,
    settings::{self, Field, Settings},
};

/// A variant: its name, its settings before `--set`, and the program that its types make.
pub struct Composition<T> {
    /// Name and description.
    pub variant: Variant,
    /// Changes the default settings.
    pub adjust: fn(&mut T),
    /// Runs it: name of the variant, settings.
    pub run: fn(&str, &T, &Context) -> Result<Record, RunError>,
    /// Settings that none of its types reads: there they are refused.
    pub lacks: Vec<&'static str>,
}

/// Those of the optional settings that are not in use.
pub fn lacking(optional: &[&'static str], uses: &[&str]) -> Vec<&'static str> {
    optional.iter().copied().filter(|key| !uses.contains(key)).collect()
}

impl<T: Settings> Composition<T> {
    /// The settings of this variant with `key=value` texts applied.
    pub fn settings(&self, set: &[String]) -> Result<T, RunError> {
        let mut settings = T::default();
        (self.adjust)(&mut settings);
        settings::apply(&mut settings, set)?;
        settings.validate()?;
        for assignment in set {
            let key = assignment.split('=').next().unwrap_or_default().trim();
            if self.lacks.contains(&key) {
                let (key, variant) = (key.to_string(), self.variant.name.to_string());
                return Err(RunError::Unused { key, variant });
            }
        }
        Ok(settings)
    }
}

/// A table of compositions as a [`Case`].
pub struct Composed<T> {
    /// Name on the command line.
    pub name: &'static str,
    /// The problem in words.
    pub about: &'static str,
    /// The variants.
    pub variants: fn() -> Vec<Composition<T>>,
    /// The judged runs.
    pub plan: fn(Tier) -> Vec<Planned>,
    /// What the runs say together.
    pub studies: fn(Tier, &[JudgedRun]) -> Vec<Study>,
}

impl<T: Settings> Composed<T> {
    /// The settings of a variant with `key=value` texts applied.
    pub fn settings_of(&self, variant: &str, set: &[String]) -> Result<T, RunError> {
        let variants = (self.variants)();
        case::find(self.name, &variants, variant, |v| v.variant.name)?.settings(set)
    }
}

impl<T: Settings> Case for Composed<T> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn about(&self) -> &'static str {
        self.about
    }

    fn variants(&self) -> Vec<Variant> {
        (self.variants)().into_iter().map(|v| v.variant).collect()
    }

    fn fields(&self) -> &'static [Field] {
        T::FIELDS
    }

    fn settings(&self, variant: &str, set: &[String]) -> Result<serde_json::Value, RunError> {
        Ok(serde_json::to_value(self.settings_of(variant, set)?).unwrap_or_default())
    }

    fn run(&self, variant: &str, set: &[String], context: &Context) -> Result<Record, RunError> {
        let variants = (self.variants)();
        let chosen = case::find(self.name, &variants, variant, |v| v.variant.name)?;
        (chosen.run)(variant, &chosen.settings(set)?, context)
    }

    fn plan(&self, tier: Tier) -> Vec<Planned> {
        (self.plan)(tier)
    }

    fn studies(&self, tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
        (self.studies)(tier, runs)
    }
}
