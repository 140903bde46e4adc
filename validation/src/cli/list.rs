//! `list`: cases, variants and settings.

use harness::case::Case;
use serde_json::{Value, json};
use validation::cases;

use super::{Exit, Outcome, World, arguments, output};

/// The variant that runs unless another one is named.
pub fn default_variant(case: &dyn Case) -> &'static str {
    let variants = case.variants();
    let preferred = variants.iter().find(|variant| variant.name == "modern");
    preferred.or(variants.first()).map_or("", |variant| variant.name)
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

fn overview(world: &World) -> String {
    let mut text = String::new();
    for case in world.cases {
        let names: Vec<_> = case.variants().iter().map(|variant| variant.name).collect();
        text += &format!("{}\n", case.name());
        text += &output::wrap(case.about(), 100, "    ");
        text += &output::wrap(&format!("variants: {}", names.join(", ")), 100, "    ");
    }
    text + "\ntouchstone list CASE shows variants and settings, touchstone run CASE runs one\n"
}

fn details(case: &dyn Case) -> String {
    let mut text = format!("{}\n{}\n", case.name(), output::wrap(case.about(), 100, "    "));
    let default = default_variant(case);
    text += "variants (* by default)\n";
    for variant in case.variants() {
        let mark = if variant.name == default { "*" } else { " " };
        text += &format!("{mark} {:<18} {}\n", variant.name, variant.about);
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
    json!({
        "name": case.name(), "about": case.about(), "default_variant": default_variant(case),
        "variants": variants, "settings": settings,
    })
}
