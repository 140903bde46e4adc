//! Cases that tests make up: a test states only the parts that it needs.

use serde_json::{Value, json};
use touchstone_base::{record::Record, settings::Field, spec::RunSpec};

use crate::{
    case::{Case, Facts, Recommended, RunError, Variant},
    context::Context,
    runs::Tier,
    study::Studies,
};

/// A case with one variant, `v`, in which nothing moves.
pub trait Staged: Sync {
    /// Its name.
    fn called(&self) -> &'static str;
    /// Its settings with these `key=value` texts.
    fn set(&self, _: &[String]) -> Value {
        json!({})
    }
    /// Its runs.
    fn made(&self, spec: &RunSpec, context: &Context) -> Result<Record, RunError>;
    /// Its facts.
    fn stated(&self) -> Facts {
        Facts::default()
    }
    /// Its studies.
    fn studied(&self, _: Tier) -> Studies {
        Studies::default()
    }
}

impl<T: Staged> Case for T {
    fn family(&self) -> &'static str {
        ""
    }
    fn recommended(&self) -> Recommended {
        Recommended { variant: "v", because: "it is staged", papers: None }
    }
    fn name(&self) -> &'static str {
        self.called()
    }
    fn problem(&self) -> &'static str {
        "Nothing moves"
    }
    fn about(&self) -> &'static str {
        "Nothing moves."
    }
    fn variants(&self) -> Vec<Variant> {
        vec![Variant { name: "v", about: "the only one" }]
    }
    fn fields(&self) -> &'static [Field] {
        &[]
    }
    fn settings(&self, _: &str, set: &[String]) -> Result<Value, RunError> {
        Ok(self.set(set))
    }
    fn run(&self, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
        self.made(spec, context)
    }
    fn facts(&self) -> Facts {
        self.stated()
    }
    fn studies(&self, tier: Tier) -> Studies {
        self.studied(tier)
    }
}
