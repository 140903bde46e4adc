//! The smallest deliberate error of a constant that the gates of a run detect.

use touchstone_base::{
    gate::{Evidence, Gate},
    mutation::{Constant, Detect, Mutation},
    record::Record,
    spec::RunSpec,
};

use crate::{
    bisect::{self, SearchEnd},
    case::RunError,
    context::Context,
    gates::GateIndex,
};

/// The relative errors that are tried, ascending.
const ERRORS: [f64; 10] = [0.001, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3];

touchstone_base::metrics! {
    DETECTED = "detected" ["-"]
        "smallest relative error of the constant with either sign of which the run fails a gate";
    UNDETECTED = "undetected" ["-"]
        "largest smaller error with a sign of which the run passes every gate";
}

/// Key in the numerics of a run: the gates that fail with the smallest detected error.
pub const GATES: &str = "gates";

/// The gates of a run that can detect an error of a constant, from the plans of its case. A regression gate
/// compares the program with itself and cannot. An invariant counts only for a constant of the
/// discretisation: it holds for any value of a physical constant or of the strength of a term, unless the
/// measurement takes this value from the settings, as an energy ledger does.
fn gates(index: &GateIndex, run: &RunSpec, constant: Constant) -> Vec<Gate> {
    let counts = |gate: &Gate| match gate.evidence {
        Evidence::Analytic | Evidence::Theory | Evidence::Reference => true,
        Evidence::Invariant => constant.is_of_sums(),
        Evidence::Regression => false,
    };
    index.gates(run).into_iter().filter(counts).collect()
}

/// Searches the smallest error that the gates of a run detect. The record has the settings of the run, the
/// cost of all runs together, and the two metrics, each absent with its reason where the search found no such
/// error.
///
/// # Errors
/// Errors of a run that cannot be made for reasons other than its settings.
pub fn run(
    index: &GateIndex,
    spec: &RunSpec,
    detect: &Detect,
    context: &Context,
) -> Result<Record, RunError> {
    let case = index.case;
    let mut wrong = spec.simulation().allow_unstable();
    let gates = gates(index, &wrong, detect.of);
    wrong.measure = case.facts().measure_for(&gates);
    let mut record = Record::of(spec, 1);
    // The gates that the run fails with a constant multiplied by this factor.
    let failed_at = |factor: f64| {
        wrong.mutation = Some(Mutation { of: detect.of, factor });
        let one = bisect::simulate(case, &wrong, context, &mut record.cost)?;
        let fails = |gate: &&Gate| gate.judge_record(&one).verdict.is_failure();
        Ok(gates.iter().filter(fails).map(|gate| gate.id.clone()).collect())
    };
    match smallest(detect, failed_at) {
        Ok((detected, undetected)) => {
            if let Some((_, failed)) = &detected {
                record.numerics.insert(GATES.into(), failed.join(" ").into());
            }
            let never = "no error that was tried fails a gate with both signs";
            record.put_or(DETECTED, detected.map(|(error, _)| error), never);
            record.put_or(UNDETECTED, undetected, "every error that was tried fails a gate");
        }
        Err(ended) => record.status = ended?,
    }
    Ok(record)
}

/// An error and the gates that detect it.
type Detection = (f64, Vec<String>);

/// The smallest detected error, and the largest smaller one that is not detected.
fn smallest(
    detect: &Detect,
    mut failed_at: impl FnMut(f64) -> Result<Vec<String>, SearchEnd>,
) -> Result<(Option<Detection>, Option<f64>), SearchEnd> {
    let allowed = detect.of.allowed();
    let mut middle = ERRORS.iter().position(|error| *error >= allowed).unwrap_or_default();
    let (mut low, mut high) = match detect.only_allowed {
        true => (middle, middle + 1),
        false => (0, ERRORS.len()),
    };
    let (mut detected, mut undetected) = (None, None);
    while low < high {
        let error = ERRORS[middle];
        let failed = failed(error, &mut failed_at)?;
        if failed.is_empty() {
            (undetected, low) = (Some(error), middle + 1);
        } else {
            (detected, high) = (Some((error, failed)), middle);
        }
        middle = (low + high) / 2;
    }
    Ok((detected, undetected))
}

/// The gates that the run fails with both signs of an error, or with different gates for each; none if it
/// passes all of them with one sign.
fn failed(
    error: f64,
    mut failed_at: impl FnMut(f64) -> Result<Vec<String>, SearchEnd>,
) -> Result<Vec<String>, SearchEnd> {
    let more = failed_at(1.0 + error)?;
    if more.is_empty() {
        return Ok(more);
    }
    let less = failed_at(1.0 - error)?;
    let both: Vec<String> = less.iter().filter(|id| more.contains(id)).cloned().collect();
    Ok(match (less.is_empty(), both.is_empty()) {
        (true, _) => less,
        (_, false) => both,
        _ => [more, less].concat(),
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use touchstone_base::{gate::Bound, spec::Measure};

    use super::*;
    use crate::{
        case::{Facts, Planned, Tier},
        study::Studies,
        testing::Staged,
    };

    touchstone_base::metrics! {
        FORCE = "force" ["-"] "1 of a healthy run";
    }

    /// Its only metric is the factor of the body force.
    struct Balance;

    impl Staged for Balance {
        fn called(&self) -> &'static str {
            "balance"
        }
        fn made(&self, spec: &RunSpec, _: &Context) -> Result<Record, RunError> {
            let mut record = Record::of(spec, 1);
            let factor = spec.mutation.map_or(1.0, |m| m.factor_of(Constant::BodyForce));
            match spec.measure {
                Measure::All => record.put(FORCE, factor),
                Measure::Headline => {
                    record.leave_all_out(&[FORCE], &touchstone_base::absent::Absent::NotAsked)
                }
            }
            record.cost.steps = 1;
            Ok(record)
        }
        /// The force is measured only where gates read it.
        fn stated(&self) -> Facts {
            Facts { costly: &[FORCE], ..Facts::default() }
        }
        fn studied(&self, tier: Tier) -> Studies {
            let gate = |id: &str, bound, evidence| Gate::new(id, FORCE, bound, evidence, "staged");
            let within = |d: f64| Bound::Within(1.0 - d, 1.0 + d);
            let mut gates = vec![
                gate("balance.exact", within(0.015), Evidence::Analytic),
                gate("balance.high", Bound::Below(1.003), Evidence::Theory),
                gate("balance.sum", within(0.004), Evidence::Invariant),
                gate("balance.before", within(1e-9), Evidence::Regression),
            ];
            gates.retain(|gate| tier == Tier::Full || gate.id != "balance.exact");
            Studies::judging(vec![Planned::new(spec()).judged(gates)])
        }
    }

    fn spec() -> RunSpec {
        RunSpec::new("balance", "v", json!({}))
    }

    fn found(of: Constant, only_allowed: bool) -> Record {
        let detect = Detect { of, only_allowed };
        let spec = spec().detect(detect);
        run(&GateIndex::of(&Balance), &spec, &detect, &Context::default()).unwrap()
    }

    /// 2 % exceeds 1.5 %; the gates of 0.3 and 0.4 % detect one sign only, or are invariant, or regression.
    #[test]
    fn the_smallest_error_is_the_one_that_a_gate_outside_the_program_sees_with_both_signs() {
        let record = found(Constant::BodyForce, false);
        assert_eq!((record.value(DETECTED), record.value(UNDETECTED)), (Some(0.02), Some(0.01)));
        assert_eq!(record.numerics[GATES], "balance.exact");
        assert_eq!(
            record.spec(),
            spec().detect(Detect { of: Constant::BodyForce, only_allowed: false })
        );
        assert!(record.cost.steps >= 4);
    }

    #[test]
    fn an_error_that_no_gate_sees_is_absent_with_its_reason() {
        let record = found(Constant::Viscosity, false);
        assert_eq!((record.value(DETECTED), record.value(UNDETECTED)), (None, Some(0.3)));
        assert!(record.absent.contains_key("detected"));
    }

    #[test]
    fn only_the_allowed_error_is_tried_where_that_is_asked_for() {
        let record = found(Constant::BodyForce, true);
        assert_eq!((record.value(DETECTED), record.value(UNDETECTED)), (Some(0.03), None));
        assert_eq!(record.cost.steps, 2);
    }
}
