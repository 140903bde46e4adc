//! Comparisons with references for other programs: a part of the verdicts.

use serde::{Deserialize, Serialize};
use touchstone_harness::studies::validation::{Comparison, ComparisonResult, Comparisons};
use touchstone_harness::suite::{CaseResults, Suite};

/// A comparison with a reference. A number that is not known, or has no meaning, is missing.
#[derive(Debug, Serialize, Deserialize)]
pub struct ComparisonVerdict {
    /// name of the case
    pub case: String,
    /// the variant and the compared quantity
    pub what: String,
    /// the reference
    pub with: String,
    /// the number of the record
    pub metric: String,
    /// E, result minus reference, of the finest level
    #[serde(rename = "E")]
    pub error: Option<f64>,
    /// ends of the interval of 95 % of the limit of E, by the ladder alone
    pub interval: Option<[f64; 2]>,
    /// the order of an error against an exact reference, and the ends of its interval of 95 %
    pub order: Option<[f64; 3]>,
    /// how the interval was found
    pub from: String,
    /// standard uncertainty by the ladder
    pub u_num: Option<f64>,
    /// standard uncertainty by the inputs
    pub u_input: Option<f64>,
    /// standard uncertainty of the reference
    #[serde(rename = "u_D")]
    pub u_reference: Option<f64>,
    /// root of the sum of squares of these
    pub u_val: Option<f64>,
    /// name of the verdict
    pub verdict: String,
    /// the verdict in words
    pub words: String,
}

fn known(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

fn all<const N: usize>(values: [f64; N]) -> Option<[f64; N]> {
    Some(values).filter(|values| values.iter().all(|value| value.is_finite()))
}

/// The comparisons of all cases.
pub fn of(suite: &Suite) -> Vec<ComparisonVerdict> {
    let pairs = suite.cases.iter().flat_map(|results| {
        let of_case = results.studies.of::<Comparisons>().flat_map(|of| &of.0);
        of_case.map(move |comparison| (results, comparison))
    });
    let one = |(results, comparison): (&CaseResults, &Comparison)| {
        let found = ComparisonResult::of(comparison, &results.runs);
        let uncertain = |value: f64| known(value).filter(|_| found.exact.is_none());
        let order = found.exact.as_ref().and_then(|order| order.as_ref().ok());
        ComparisonVerdict {
            case: results.case.name().into(),
            what: comparison.what.clone(),
            with: comparison.against.into(),
            metric: comparison.metric.name.clone(),
            error: known(found.error),
            interval: all(found.interval()),
            order: order.and_then(|of| all([of.order, of.interval[0], of.interval[1]])),
            from: found.numerical.how.clone(),
            u_num: uncertain(found.numerical.standard),
            u_input: uncertain(found.input),
            u_reference: uncertain(found.reference),
            u_val: uncertain(found.uncertainty()),
            verdict: found.conclusion().name().into(),
            words: found.in_words(),
        }
    };
    pairs.map(one).collect()
}
