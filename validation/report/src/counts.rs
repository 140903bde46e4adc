//! How gates ended, in numbers.

use super::number::counted;
use super::table::Status;
use maud::{Markup, html};

/// How many gates ended how, and how many runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Judged and inside.
    pub pass: usize,
    /// Judged and outside.
    pub fail: usize,
    /// Outside for a known reason.
    pub limitation: usize,
    /// Outside, as it should be.
    pub expected_failure: usize,
    /// Runs that diverged.
    pub diverged: usize,
}

impl Counts {
    /// The counts of the given outcomes.
    pub fn of(outcomes: impl IntoIterator<Item = Status>) -> Self {
        let all: Vec<Status> = outcomes.into_iter().collect();
        let count = |status| all.iter().filter(|outcome| **outcome == status).count();
        Self {
            pass: count(Status::Pass),
            fail: count(Status::Fail),
            limitation: count(Status::Limitation),
            expected_failure: count(Status::ExpectedFailure),
            diverged: 0,
        }
    }

    /// What came of all gates, failures first, and of the runs, in a sentence.
    pub fn headline(self) -> String {
        let of =
            |count: usize, one: &str, many: &str| (count > 0).then(|| counted(count, one, many));
        let parts = [
            of(self.fail, "gate fails", "gates fail"),
            of(self.pass, "gate passes", "gates pass"),
            of(
                self.limitation,
                "gate is outside its bound for a known reason",
                "gates are outside their bounds for known reasons",
            ),
            of(self.expected_failure, "control fails as it must", "controls fail as they must"),
            of(self.diverged, "run diverged", "runs diverged"),
        ];
        let text = parts.into_iter().flatten().collect::<Vec<_>>().join(", ");
        if text.is_empty() { "Nothing was judged".into() } else { text }
    }

    /// Marks and counts, worst first: `△ 2 ✓ 30`.
    pub fn short(self) -> String {
        let some = Status::ALL.into_iter().rev().filter(|status| self.count(*status) > 0);
        let parts: Vec<String> =
            some.map(|status| format!("{} {}", status.mark(), self.count(status))).collect();
        parts.join(" ")
    }

    /// The worst outcome, if there is any.
    pub fn worst(self) -> Option<Status> {
        Status::ALL.into_iter().rev().find(|status| self.count(*status) > 0)
    }

    fn count(self, status: Status) -> usize {
        match status {
            Status::Pass => self.pass,
            Status::Fail => self.fail,
            Status::Limitation => self.limitation,
            Status::ExpectedFailure => self.expected_failure,
        }
    }

    /// The outcomes that there are, worst first, each a link to `target(class)`.
    pub(super) fn chips(self, target: impl Fn(&str) -> String) -> Markup {
        let some = Status::ALL.into_iter().rev().filter(|status| self.count(*status) > 0);
        html! {
            p.counts {
                @for status in some {
                    a class=(status.class()) href=(target(status.class())) {
                        (status.mark()) " " (self.count(status)) " " (status.name())
                    }
                }
            }
        }
    }

    pub(super) fn html(self) -> Markup {
        let worst = self.worst().unwrap_or(Status::Pass);
        html! {
            div class=(format!("banner {}", worst.class())) {
                p.verdict { span.mark { (worst.mark()) } " " (self.headline()) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_add_up() {
        let counts = Counts::of([Status::Pass, Status::Pass, Status::ExpectedFailure]);
        assert_eq!((counts.pass, counts.fail, counts.expected_failure), (2, 0, 1));
        assert_eq!(counts.headline(), "2 gates pass, 1 control fails as it must");
        let all = Counts { fail: 1, limitation: 2, diverged: 3, ..counts };
        let headline = "1 gate fails, 2 gates pass, 2 gates are outside their bounds for known reasons, 1 \
                        control fails as it must, 3 runs diverged";
        assert_eq!(
            (all.worst(), counts.worst()),
            (Some(Status::Fail), Some(Status::ExpectedFailure))
        );
        assert_eq!(all.headline(), headline);
        assert!(all.html().into_string().contains(headline));
        assert_eq!(Counts::default().headline(), "Nothing was judged");
        let one = Counts { pass: 1, fail: 1, limitation: 1, expected_failure: 1, diverged: 1 };
        let headline = "1 gate fails, 1 gate passes, 1 gate is outside its bound for a known reason, 1 \
                        control fails as it must, 1 run diverged";
        assert_eq!(one.headline(), headline);
    }
}
