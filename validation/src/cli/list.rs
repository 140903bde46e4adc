//! `list`: cases, variants and settings.

use serde_json::{Value, json};
use touchstone_base::settings::Field;
use touchstone_harness::case::{Case, Recommended, Variant};

use super::{Failure, Session, arguments, output};

pub fn list(arguments: &arguments::List, session: &Session) -> Result<(), Failure> {
    let Some(name) = &arguments.case else {
        let all = || session.cases.iter().map(|case| json(*case)).collect();
        return output::answer(arguments.json, all, || overview(session));
    };
    let case = touchstone_cases::find_in(session.cases, name)?;
    output::answer(arguments.json, || json(case), || details(case))
}

/// A line a case: the problem, and the variants for it; then why the case recommends it.
fn overview(session: &Session) -> String {
    let row = |case: &&dyn Case| {
        let Recommended { variant, papers, .. } = case.recommended();
        let names = [case.name(), case.problem(), variant, papers.unwrap_or_default()];
        names.map(String::from).to_vec()
    };
    let heads = ["case", "problem", "recommended", "the paper's"];
    let reason = |case: &&dyn Case| {
        let recommended = case.recommended();
        let words = format!("{} {}: {}", case.name(), recommended.variant, recommended.reason());
        format!("  {}", output::wrap(&words, "    ").trim_start())
    };
    let reasons: String = session.cases.iter().map(reason).collect();
    output::table(&heads, session.cases.iter().map(row))
        + "\nThe recommended variant runs unless another one is named. No variant has the\nsmallest error \
           in every case; the reasons:\n"
        + &reasons
        + "\n`touchstone list CASE` shows all variants and settings of a case, `touchstone run CASE` \
           runs it.\n"
}

fn details(case: &dyn Case) -> String {
    let mut text = format!("{}\n{}\n", case.name(), output::wrap(case.about(), "    "));
    text += "variants\n";
    for variant in case.variants() {
        text += &format!("  {:<18} {}\n", variant.name, variant.about);
        let differs = differences(case, variant.name).join(" ");
        if !differs.is_empty() {
            text += &output::wrap(&differs, &" ".repeat(21));
        }
    }
    let recommended = case.recommended();
    let Recommended { variant, papers, .. } = recommended;
    let papers = papers.map(|name| format!("; `{name}` is the paper's")).unwrap_or_default();
    let reason = recommended.reason();
    let words =
        format!("`{variant}` is recommended and runs by default{papers}. The reason: {reason}");
    text += &output::wrap(&words, "  ");
    let row = |field: &Field| {
        vec![field.name.into(), field.default.to_string(), field.range.into(), field.doc.into()]
    };
    let heads = ["settings", "default", "range [unit]", ""];
    text + "\n" + &output::table(&heads, case.fields().iter().map(row))
}

/// Settings in which a variant differs from the defaults, as `key=value`.
fn differences(case: &dyn Case, variant: &str) -> Vec<String> {
    let Ok(settings) = case.settings(variant, &[]) else { return Vec::new() };
    let default = |name: &str| {
        let field = case.fields().iter().find(|field| field.name == name);
        field.map(|field| Value::from(field.default))
    };
    let differs = |(name, value): &(&String, &Value)| default(name).as_ref() != Some(*value);
    let text = |(name, value): (&String, &Value)| format!("{name}={value}");
    settings.as_object().into_iter().flatten().filter(differs).map(text).collect()
}

fn json(case: &dyn Case) -> Value {
    let variant = |variant: &Variant| {
        let settings = case.settings(variant.name, &[]).unwrap_or_default();
        json!({"name": variant.name, "about": variant.about, "settings": settings})
    };
    let setting = |field: &Field| {
        json!({
            "name": field.name, "unit": field.unit, "doc": field.doc,
            "kind": field.kind.to_string(), "range": field.range, "default": Value::from(field.default),
        })
    };
    let recommended = case.recommended();
    json!({
        "name": case.name(), "problem": case.problem(), "about": case.about(),
        "default_variant": recommended.variant,
        "recommended_variant": recommended.variant,
        "recommended_because": recommended.reason(),
        "papers_variant": recommended.papers,
        "variants": case.variants().iter().map(variant).collect::<Value>(),
        "settings": case.fields().iter().map(setting).collect::<Value>(),
    })
}
