//! `list`: cases, variants and settings.

use harness::case::{Case, Tier};
use serde_json::{Value, json};
use validation::cases;

use super::{Exit, Outcome, World, arguments, output};

/// The variant that runs unless another one is named: the best one of the card of the case, else `modern`.
pub fn default_variant(case: &dyn Case) -> &'static str {
    let card = case.declaration(Tier::Quick).card;
    let best = card.and_then(|card| card.runs.into_iter().next()).map(|spec| spec.variant);
    let preferred = best.as_deref().unwrap_or("modern");
    let variants = case.variants();
    let found = variants.iter().find(|variant| variant.name == preferred);
    found.or(variants.first()).map_or("", |variant| variant.name)
}

pub fn list(arguments: &arguments::List, world: &World) -> Outcome {
    let text = match &arguments.case {
        None if arguments.json => {
            pretty(&Value::Array(world.cases.iter().map(|case| json(*case)).collect()))
        }
        None => overview(world),
        Some(name) => {
            let case = cases::find_in(world.cases, name)?;
            if arguments.json { pretty(&json(case)) } else { details(case) }
        }
    };
    if arguments.json {
        output::print_whole(&text)?;
    } else {
        output::print(&text)?;
    }
    Ok(Exit::Pass)
}

fn pretty(value: &Value) -> String {
    format!("{value:#}\n")
}

/// A line a case: the problem, and the variants for it.
fn overview(world: &World) -> String {
    let row = |case: &&dyn Case| {
        let shown = Shown::of(*case);
        let name = |variant: &Option<String>| variant.clone().unwrap_or_default();
        vec![
            case.name().to_string(),
            case.problem().to_string(),
            shown.default.to_string(),
            name(&shown.best),
            name(&shown.papers),
        ]
    };
    let rows: Vec<Vec<String>> = world.cases.iter().map(row).collect();
    let heads = ["case", "problem", "variant that runs", "best", "the paper's"];
    output::table(&heads, &rows)
        + "\nThe best variant is the one that the report shows first, for its error and cost.\n\
           `touchstone list CASE` shows all variants and settings of a case, `touchstone run CASE` runs it.\n"
}

/// The variants of a case that have a name of their own.
struct Shown {
    /// Runs unless another one is named.
    default: &'static str,
    /// The first of the card of the case, if it has one.
    best: Option<String>,
    /// The second of it.
    papers: Option<String>,
}

impl Shown {
    fn of(case: &dyn Case) -> Self {
        let card = case.declaration(Tier::Quick).card;
        let mut runs = card.into_iter().flat_map(|card| card.runs).map(|spec| spec.variant);
        Self { default: default_variant(case), best: runs.next(), papers: runs.next() }
    }

    /// What a variant is, in words.
    fn marks(&self, variant: &str) -> String {
        let is = |of: &Option<String>| of.as_deref() == Some(variant);
        let marks = [
            (self.default == variant, "runs by default"),
            (is(&self.best), "best"),
            (is(&self.papers), "the paper's"),
        ];
        let words: Vec<&str> = marks.into_iter().filter(|(is, _)| *is).map(|(_, w)| w).collect();
        if words.is_empty() { String::new() } else { format!(" ({})", words.join(", ")) }
    }
}

fn details(case: &dyn Case) -> String {
    let mut text = format!("{}\n{}\n", case.name(), output::wrap(case.about(), 100, "    "));
    let shown = Shown::of(case);
    text += "variants\n";
    for variant in case.variants() {
        let marks = shown.marks(variant.name);
        text += &format!("  {:<18} {}{marks}\n", variant.name, variant.about);
        let differs = differences(case, variant.name).join(" ");
        if !differs.is_empty() {
            text += &output::wrap(&differs, 100, &" ".repeat(21));
        }
    }
    let fields: Vec<Vec<String>> = case
        .fields()
        .iter()
        .map(|field| {
            let default = field.default().to_string();
            vec![field.name.into(), default, field.range.into(), field.doc.into()]
        })
        .collect();
    text + "\n" + &output::table(&["settings", "default", "range [unit]", ""], &fields)
}

/// Settings in which a variant differs from the defaults, as `key=value`.
fn differences(case: &dyn Case, variant: &str) -> Vec<String> {
    let Ok(settings) = case.settings(variant, &[]) else { return Vec::new() };
    let default = |name: &str| {
        let field = case.fields().iter().find(|field| field.name == name);
        field.and_then(|field| serde_json::to_value(field.default()).ok())
    };
    let differs = |(name, value): &(&String, &Value)| default(name).as_ref() != Some(*value);
    let text = |(name, value): (&String, &Value)| format!("{name}={value}");
    settings
        .as_object()
        .map(|all| all.iter().filter(differs).map(text).collect())
        .unwrap_or_default()
}

fn json(case: &dyn Case) -> Value {
    let variants: Vec<Value> = case
        .variants()
        .iter()
        .map(|variant| {
            let settings = case.settings(variant.name, &[]).unwrap_or_default();
            json!({"name": variant.name, "about": variant.about, "settings": settings})
        })
        .collect();
    let settings: Vec<Value> = case
        .fields()
        .iter()
        .map(|field| {
            json!({
                "name": field.name, "unit": field.unit, "doc": field.doc,
                "kind": field.kind.to_string(), "range": field.range, "default": field.default(),
            })
        })
        .collect();
    let Shown { default, best, papers } = Shown::of(case);
    json!({
        "name": case.name(), "problem": case.problem(), "about": case.about(),
        "default_variant": default, "best_variant": best, "papers_variant": papers,
        "variants": variants, "settings": settings,
    })
}
