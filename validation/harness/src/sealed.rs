//! Sealed problems: settings drawn where a reference holds, and gates whose bounds follow from judged runs.
//! Between the resolutions of two judged runs the bound is interpolated, logarithm over logarithm; beyond
//! them it changes with the formal order.

use serde_json::Value;
use touchstone_base::{
    functions::{exp, ln},
    gate::{Bound, Evidence, Gate},
    random::Random,
    settings::Kind,
    spec::RunSpec,
};

use crate::{
    case::{Case, Planned},
    facts::{Drawn, Draws},
    gates::GateIndex,
};

/// The bound of a judged run.
struct JudgedLevel {
    /// Spacings over a length of the problem: more is finer.
    fineness: f64,
    /// The largest magnitude of the error.
    most: f64,
    gate: Gate,
    settings: Value,
}

impl Draws {
    /// How fine a resolution is.
    fn fineness(&self, case: &dyn Case, settings: &Value) -> Option<f64> {
        let value = number(settings, self.resolution.0)?;
        Some(if is_count(case, self.resolution.0) { value } else { 1.0 / value })
    }

    /// The judged runs of a variant with gates on a metric; none if one of them is a control or has a
    /// limitation, because its bound does not describe the variant.
    fn levels(&self, index: &GateIndex, variant: &str, metric: &str) -> Vec<JudgedLevel> {
        let case = index.case;
        let set: Vec<String> = self.set.iter().map(ToString::to_string).collect();
        if !self.variants.is_empty() && !self.variants.contains(&variant) {
            return Vec::new();
        }
        let Ok(base) = case.settings(variant, &set) else { return Vec::new() };
        let may_differ = |name: &str| {
            let drawn = self.others.iter().filter(|(_, how)| !matches!(how, Drawn::Any(..)));
            let mut names = drawn.map(|(name, _)| name).chain(self.free);
            name == self.resolution.0 || names.any(|other| *other == name)
        };
        let is_alike = |spec: &RunSpec| {
            let given = base.as_object().into_iter().flatten();
            let is_plain = spec.mutation.is_none() && spec.disorder.is_none();
            spec.variant == variant
                && is_plain
                && given
                    .into_iter()
                    .all(|(name, value)| may_differ(name) || spec.settings.get(name) == Some(value))
        };
        let mut levels: Vec<JudgedLevel> = Vec::new();
        for Planned { spec, gates, .. } in index.judged() {
            if !is_alike(spec) {
                continue;
            }
            let Some(fineness) = self.fineness(case, &spec.settings) else { continue };
            for gate in gates.iter().filter(|gate| gate.metric == metric) {
                if gate.control || gate.known.is_some() {
                    return Vec::new();
                }
                let is_new = levels.iter().all(|level| level.gate.id != gate.id);
                let settings = spec.settings.clone();
                if let (true, Some(most)) = (is_new, most(gate)) {
                    levels.push(JudgedLevel { fineness, most, gate: gate.clone(), settings });
                }
            }
        }
        levels.sort_by(|a, b| a.fineness.total_cmp(&b.fineness));
        levels
    }

    /// The bound at a resolution, and where it comes from.
    fn bound(&self, levels: &[&JudgedLevel], fineness: f64) -> Option<(f64, String)> {
        let worst = |at: f64| {
            let levels = levels.iter().filter(|level| level.fineness == at);
            levels.max_by(|a, b| a.most.total_cmp(&b.most))
        };
        let before = levels.iter().rev().find(|level| level.fineness <= fineness);
        let after = levels.iter().find(|level| level.fineness >= fineness);
        let near = |level: Option<&&JudgedLevel>| level.and_then(|level| worst(level.fineness));
        match (near(before), near(after)) {
            (Some(coarse), Some(fine)) if coarse.fineness < fine.fineness => {
                let share = ln(fineness / coarse.fineness) / ln(fine.fineness / coarse.fineness);
                let most = coarse.most * exp(share * ln(fine.most / coarse.most));
                let (a, b) = (&coarse.gate.id, &fine.gate.id);
                Some((most, format!("The bound lies between those of {a} and {b}, by resolution.")))
            }
            (Some(level), _) | (None, Some(level)) => {
                let order = self.order;
                let factor = exp(order * ln(level.fineness / fineness));
                let id = &level.gate.id;
                let words = format!(
                    "The bound equals that of {id} at this resolution, with order {order}."
                );
                Some((level.most * factor, words))
            }
            (None, None) => None,
        }
    }

    /// The judged runs with the drawn values: with the values of [`Drawn::Judged`].
    fn with_values<'a>(&self, levels: &'a [JudgedLevel], settings: &Value) -> Vec<&'a JudgedLevel> {
        let is_same = |level: &&JudgedLevel| {
            let judged = self.others.iter().filter(|(_, how)| matches!(how, Drawn::Judged));
            judged.into_iter().all(|(name, _)| level.settings.get(name) == settings.get(name))
        };
        levels.iter().filter(is_same).collect()
    }
}

/// The largest magnitude that a gate allows; `None` for windows about our own theory and for counts.
fn most(gate: &Gate) -> Option<f64> {
    match (gate.bound, gate.evidence) {
        (Bound::Within(..), Evidence::Theory) => None,
        (Bound::Below(most), _) => Some(most),
        (Bound::Within(low, high), _) if low < 0.0 && high > 0.0 => Some(high.max(-low)),
        _ => None,
    }
    .filter(|most| *most > 0.0)
}

fn number(settings: &Value, name: &str) -> Option<f64> {
    settings.get(name).and_then(Value::as_f64)
}

fn is_count(case: &dyn Case, name: &str) -> bool {
    case.fields().iter().any(|field| field.name == name && field.kind == Kind::Count)
}

/// `key=value` of the settings of a sealed problem.
///
/// # Errors
/// If no judged run gives a bound.
pub fn draw(index: &GateIndex, variant: &str, random: &mut Random) -> Result<Vec<String>, String> {
    let case = index.case;
    let draws = of(case)?;
    let levels = draws.metrics.iter().map(|metric| draws.levels(index, variant, metric));
    let Some(levels) = levels.into_iter().find(|levels| !levels.is_empty()) else {
        return Err(format!(
            "{} {variant} has no sealed problems, because no bound of its errors is known at other settings; \
             variants that have: {}",
            case.name(),
            draws.variants.join(", ")
        ));
    };
    let three_digits = |value: f64| format!("{value:.2e}").parse().unwrap_or(value);
    let in_logarithm = |[low, high]: [f64; 2], share: f64| low * exp(share * ln(high / low));
    let text = |name: &str, value: f64| match is_count(case, name) {
        true => format!("{name}={}", value.round()),
        false => format!("{name}={}", three_digits(value)),
    };
    let mut set: Vec<String> = draws.set.iter().map(ToString::to_string).collect();
    let (name, ends) = draws.resolution;
    let drawn = in_logarithm(ends, random.uniform());
    set.push(match is_count(case, name) {
        true => text(name, drawn),
        // A length is a whole number of spacings.
        false => format!("{name}={}", 1.0 / (1.0 / drawn).round()),
    });
    for (name, how) in draws.others {
        let share = random.uniform(); // drawn in any case, so that the others do not depend on it
        let mut judged: Vec<f64> =
            levels.iter().filter_map(|level| number(&level.settings, name)).collect();
        judged.sort_by(f64::total_cmp);
        judged.dedup();
        let ends = judged.first().zip(judged.last()).map(|(low, high)| [*low, *high]);
        let value = match *how {
            Drawn::Any(low, high) => Some(text(name, low + share * (high - low))),
            Drawn::Judged => judged
                .get((share * judged.len() as f64) as usize)
                .map(|value| format!("{name}={value}")),
            Drawn::Between(least, most) => ends
                .map(|[low, high]| [low.max(least), high.min(most)])
                .filter(|[low, high]| low < high)
                .map(|ends| text(name, in_logarithm(ends, share))),
        };
        // A setting that the variant does not read is left out.
        let with = |one: &String| [&set[..], std::slice::from_ref(one)].concat();
        set.extend(value.filter(|one| case.settings(variant, &with(one)).is_ok()));
    }
    Ok(set)
}

/// The declaration of sealed problems of a case.
fn of(case: &dyn Case) -> Result<Draws, String> {
    case.facts().sealed.ok_or_else(|| {
        format!(
            "{} has no sealed problems: it declares no settings at which a reference holds and a bound is \
             known",
            case.name()
        )
    })
}

/// The gates of a sealed problem, one for each metric that judged runs of the variant have.
pub fn gates(index: &GateIndex, spec: &RunSpec) -> Vec<Gate> {
    let case = index.case;
    let Ok(draws) = of(case) else { return Vec::new() };
    let gate = |metric: &&str| {
        let levels = draws.levels(index, &spec.variant, metric);
        let levels = draws.with_values(&levels, &spec.settings);
        let (most, words) = draws.bound(&levels, draws.fineness(case, &spec.settings)?)?;
        let like = &levels.first()?.gate;
        let bound = match like.bound {
            Bound::Within(..) => Bound::Within(-most, most),
            _ => Bound::Below(most),
        };
        let id = format!("{}.{}.sealed.{metric}", case.name(), spec.variant);
        Some(Gate::new(id, *metric, bound, like.evidence, words + " " + &like.because))
    };
    draws.metrics.iter().filter_map(gate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(fineness: f64, most: f64) -> JudgedLevel {
        let gate = Gate::new("c.v", "l2", Bound::Below(most), Evidence::Analytic, "made up");
        JudgedLevel { fineness, most, gate, settings: Value::Null }
    }

    /// Bounds extrapolate with order 2, interpolate between judged runs, and use the largest at equal
    /// resolution.
    #[test]
    fn bounds_follow_from_those_of_judged_runs() {
        let draws = Draws {
            variants: &["v"],
            resolution: ("n", [10.0, 80.0]),
            order: 2.0,
            metrics: &["l2"],
            set: &[],
            others: &[],
            free: &[],
        };
        let levels = [level(20.0, 0.04), level(20.0, 0.02), level(80.0, 0.01)];
        let levels: Vec<&JudgedLevel> = levels.iter().collect();
        for (fineness, expected) in
            [(10.0, 0.16), (20.0, 0.04), (40.0, 0.02), (80.0, 0.01), (160.0, 0.0025)]
        {
            let (found, _) = draws.bound(&levels, fineness).expect("a bound");
            assert!((found / expected - 1.0).abs() < 1e-12, "{fineness}: {found}");
        }
        assert!(draws.bound(&[], 10.0).is_none());
    }

    /// A window about the theory of our own steps does not bound another code.
    #[test]
    fn windows_of_theory_and_counts_give_no_bound() {
        let of = |bound, evidence| most(&Gate::new("c.v", "l2", bound, evidence, "made up"));
        assert_eq!(of(Bound::Below(0.1), Evidence::Theory), Some(0.1));
        assert_eq!(of(Bound::Within(-0.2, 0.1), Evidence::Reference), Some(0.2));
        assert_eq!(of(Bound::Within(-0.2, 0.1), Evidence::Theory), None);
        assert_eq!(of(Bound::Within(0.1, 0.2), Evidence::Analytic), None);
        assert_eq!(of(Bound::Equals(0.0), Evidence::Invariant), None);
    }
}
