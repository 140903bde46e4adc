//! What a suite comes to, as a person reads it in one screen: a line a case, then what needs attention.

use ::report;
use base::gate::Verdict;
use harness::{
    runs::Judged,
    studies::headline,
    suite::{CaseResults, Suite},
};
use report::Counts;

use super::{explain, output};

/// Failures that are told in full; of more the names are.
const IN_FULL: usize = 5;

/// A line a case; then the failures in full, the number of limitations, and all counts in a sentence.
pub fn summary(suite: &Suite) -> String {
    let heads = [
        "case",
        "fail",
        "limited",
        "control",
        "pass",
        "error",
        "variant",
        "cost",
        "worst gate",
        "margin",
    ];
    let mut text = output::table(&heads, suite.cases.iter().map(row));
    text += "The error is that of the best variant, its cost that on one core; the margin is the unused\n\
             share of the bound of the worst gate; for a known limitation, of its wider bound.\n";
    text += &failures(suite);
    let counts = suite.counts();
    let limited = counts.count(Verdict::Limitation);
    if limited > 0 {
        let limited = Counts::of(std::iter::repeat_n(Verdict::Limitation, limited));
        text += &format!(
            "\n{}; `touchstone explain --status limitation` lists what limits them, by cause.\n",
            limited.headline()
        );
    }
    text + &format!("\n{}\n", counts.headline())
}

/// How the gates of a case ended, the error of its best variant with the cost, and the gate that is the
/// closest to failing, with the unused share of its bound.
fn row(results: &CaseResults) -> Vec<String> {
    let counts = results.counts();
    let mut row = vec![results.case.name().to_string()];
    let columns = [Verdict::Fail, Verdict::Limitation, Verdict::ExpectedFailure, Verdict::Pass];
    row.extend(columns.map(|verdict| counts.count(verdict).to_string()));
    row.extend(match results.best() {
        Some((card, best)) => [
            headline(card, best).unwrap_or_else(|_| "none".into()),
            best.variant.clone(),
            report::seconds(best.cost.alone_median().unwrap_or(best.cost.cpu_s)),
        ],
        None => Default::default(),
    });
    let worst = worst(results.judged().map(|(_, judged)| judged));
    row.push(worst.map_or(String::new(), |judged| judged.gate.id.clone()));
    let margin = worst.and_then(|judged| judged.judgement.margin);
    row.push(margin.map_or(String::new(), |margin| report::percent(margin, 2)));
    row
}

/// The judgement that is closest to failing: of the worst verdict and, among equals, of the least margin. A
/// control that fails as it must has none.
pub fn worst<'a>(all: impl Iterator<Item = &'a Judged>) -> Option<&'a Judged> {
    let rank = |judged: &Judged| match judged.judgement.verdict {
        Verdict::Fail => 0,
        Verdict::Limitation => 1,
        Verdict::Pass | Verdict::ExpectedFailure => 2,
    };
    let margin = |judged: &Judged| judged.judgement.margin.unwrap_or(f64::INFINITY);
    all.min_by(|a, b| rank(a).cmp(&rank(b)).then_with(|| margin(a).total_cmp(&margin(b))))
}

fn failures(suite: &Suite) -> String {
    let of_case = |results| {
        let judged = CaseResults::judged(results).filter(|(_, j)| j.judgement.verdict.is_failure());
        judged.map(move |(of, judged)| (results.case, of, judged))
    };
    let all: Vec<_> = suite.cases.iter().flat_map(of_case).collect();
    let mut text: String = all
        .iter()
        .take(IN_FULL)
        .map(|(case, of, judged)| format!("\n{}", explain::in_full(*case, *of, judged)))
        .collect();
    let more: Vec<&str> = all.iter().skip(IN_FULL).map(|(_, _, j)| j.gate.id.as_str()).collect();
    if !more.is_empty() {
        let words = report::counted(more.len(), "more gate fails", "more gates fail");
        let words = format!("{words}: {}", more.join(", "));
        text += &format!("\n{}", output::wrap(&words, ""));
    }
    text
}
