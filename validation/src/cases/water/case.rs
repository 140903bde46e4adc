//! A case of water: a table of variants with a plan and studies.

use crate::{
    case::{self, Case, Planned, RunError, Tier, Variant},
    record::Record,
    runner::Context,
    settings::{self, Field, Settings},
    suite::{JudgedRun, Study},
};

/// One run: name of the variant, settings.
pub type Run<T> = fn(&str, &T, &Context) -> Result<Record, RunError>;

/// A variant: its name, its settings before `--set`, and the program that its types make.
pub struct WaterVariant<T> {
    /// Name and description.
    pub variant: Variant,
    /// Changes the default settings.
    pub adjust: fn(&mut T),
    /// Runs it.
    pub run: Run<T>,
    /// Optional settings that its types read.
    pub uses: Vec<&'static str>,
}

/// A table of variants as a [`Case`].
pub struct WaterCase<T> {
    /// Name on the command line.
    pub name: &'static str,
    /// The problem in words.
    pub about: &'static str,
    /// The variants.
    pub variants: fn() -> Vec<WaterVariant<T>>,
    /// Settings that some variants do not read: there they are refused.
    pub optional: &'static [&'static str],
    /// The judged runs.
    pub plan: fn(Tier) -> Vec<Planned>,
    /// What the runs say together.
    pub studies: fn(Tier, &[JudgedRun]) -> Vec<Study>,
}

impl<T: Settings> WaterCase<T> {
    /// The settings of a variant with `key=value` texts applied, and what runs them.
    pub fn chosen(&self, variant: &str, set: &[String]) -> Result<(T, Run<T>), RunError> {
        let variants = (self.variants)();
        let chosen = case::find(self.name, &variants, variant, |v| v.variant.name)?;
        let mut settings = T::default();
        (chosen.adjust)(&mut settings);
        settings::apply(&mut settings, set)?;
        settings.validate()?;
        for assignment in set {
            let key = assignment.split('=').next().unwrap_or_default().trim();
            if self.optional.contains(&key) && !chosen.uses.contains(&key) {
                let (key, variant) = (key.to_string(), variant.to_string());
                return Err(RunError::Unused { key, variant });
            }
        }
        Ok((settings, chosen.run))
    }
}

impl<T: Settings> Case for WaterCase<T> {
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
        Ok(serde_json::to_value(self.chosen(variant, set)?.0).unwrap_or_default())
    }

    fn run(&self, variant: &str, set: &[String], context: &Context) -> Result<Record, RunError> {
        let (settings, run) = self.chosen(variant, set)?;
        run(variant, &settings, context)
    }

    fn plan(&self, tier: Tier) -> Vec<Planned> {
        (self.plan)(tier)
    }

    fn studies(&self, tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
        (self.studies)(tier, runs)
    }
}
