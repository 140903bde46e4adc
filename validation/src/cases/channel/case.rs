//! A channel flow as a [`Case`].

use super::{ChannelSettings, ChannelVariant, Flow};
use crate::{
    case::{self, Case, Planned, RunError, Tier, Variant},
    record::Record,
    runner::Context,
    settings::{Field, Settings},
    suite::{JudgedRun, Study},
};

/// A channel flow: what drives it, its variants and its plan.
pub struct ChannelCase {
    /// Name on the command line.
    pub name: &'static str,
    /// The problem in words.
    pub about: &'static str,
    /// What drives the fluid.
    pub flow: Flow,
    /// Its variants.
    pub variants: fn() -> Vec<ChannelVariant>,
    /// Its judged runs.
    pub plan: fn(Tier) -> Vec<Planned>,
    /// Its studies.
    pub studies: fn(Tier, &[JudgedRun]) -> Vec<Study>,
}

impl Case for ChannelCase {
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
        ChannelSettings::FIELDS
    }

    fn settings(&self, variant: &str, set: &[String]) -> Result<serde_json::Value, RunError> {
        let variants = (self.variants)();
        let chosen = case::find(self.name, &variants, variant, |v| v.variant.name)?;
        Ok(serde_json::to_value(chosen.settings(set)?).unwrap_or_default())
    }

    fn run(&self, variant: &str, set: &[String], context: &Context) -> Result<Record, RunError> {
        let variants = (self.variants)();
        let chosen = case::find(self.name, &variants, variant, |v| v.variant.name)?;
        let settings = chosen.settings(set)?;
        (chosen.run)(self.flow, variant, &settings, context)
    }

    fn plan(&self, tier: Tier) -> Vec<Planned> {
        (self.plan)(tier)
    }

    fn studies(&self, tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
        (self.studies)(tier, runs)
    }
}
