//! How gates ended, in numbers.

use super::explorer::VERDICTS;
use super::number::counted;
use super::table::{class, mark};
use maud::{Markup, html};
use touchstone_base::gate::Verdict;

/// Numbers of gates by verdict, and of runs that diverged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Gates that pass.
    pub pass: usize,
    /// Controls that failed, as they must.
    pub control: usize,
    /// Known limitations.
    pub limitation: usize,
    /// Gates that fail.
    pub fail: usize,
    /// Limitations whose cause is not known.
    pub unexplained: usize,
    /// Runs that diverged.
    pub diverged: usize,
    /// Runs that diverged although nothing planned that they may.
    pub unexpected: usize,
}

impl Counts {
    /// The counts of the given outcomes.
    pub fn of(outcomes: impl IntoIterator<Item = Verdict>) -> Self {
        let mut counts = Self::default();
        outcomes.into_iter().for_each(|outcome| *counts.of_verdict(outcome) += 1);
        counts
    }

    /// How many gates ended so.
    pub fn count(mut self, outcome: Verdict) -> usize {
        *self.of_verdict(outcome)
    }

    fn of_verdict(&mut self, outcome: Verdict) -> &mut usize {
        match outcome {
            Verdict::Pass => &mut self.pass,
            Verdict::ExpectedFailure => &mut self.control,
            Verdict::Limitation => &mut self.limitation,
            Verdict::Fail => &mut self.fail,
        }
    }

    /// Counts of the verdicts of all gates, failures first, and of the runs, in a sentence.
    pub fn headline(self) -> String {
        let of =
            |count: usize, one: &str, many: &str| (count > 0).then(|| counted(count, one, many));
        let unexplained = match self.unexplained {
            0 => String::new(),
            count => format!(" ({count} of them unexplained)"),
        };
        let limited = of(self.limitation, "known limitation", "known limitations");
        let parts = [
            of(self.fail, "gate fails", "gates fail"),
            of(self.pass, "gate passes", "gates pass"),
            limited.map(|text| text + &unexplained),
            of(self.control, "control fails as it must", "controls fail as they must"),
            of(self.diverged, "run diverged", "runs diverged"),
        ];
        let text = parts.into_iter().flatten().collect::<Vec<_>>().join(", ");
        if text.is_empty() { "Nothing was judged".into() } else { text }
    }

    /// The outcomes that there are, worst first, with their counts.
    fn worst_first(self) -> impl Iterator<Item = (Verdict, usize)> {
        let all = Verdict::ALL.into_iter().rev().map(move |verdict| (verdict, self.count(verdict)));
        all.filter(|(_, count)| *count > 0)
    }

    /// Marks and counts, worst first: `△ 2 ✓ 30`.
    pub fn short(self) -> String {
        let parts = self.worst_first().map(|(verdict, count)| format!("{} {count}", mark(verdict)));
        parts.collect::<Vec<String>>().join(" ")
    }

    /// The worst outcome, if there is any.
    pub fn worst(self) -> Option<Verdict> {
        self.worst_first().next().map(|(verdict, _)| verdict)
    }

    /// The outcomes that there are, worst first, each a link to `target(class)`.
    pub(super) fn chips(self, target: impl Fn(&str) -> String) -> Markup {
        html! {
            p.counts {
                @for (verdict, count) in self.worst_first() {
                    a class=(class(verdict)) href=(target(class(verdict))) {
                        (mark(verdict)) " " (count) " " (verdict)
                    }
                }
            }
        }
    }

    /// A note on the verdicts, as a line with links to all of them.
    pub(super) fn line(self) -> Markup {
        if self.worst().is_none() {
            return html! { p.verdict { "Nothing was judged" } };
        }
        let Self { pass, limitation, fail, .. } = self;
        let failed = match fail {
            0 => "none fails".into(),
            fail => counted(fail, "gate fails", "gates fail"),
        };
        let mut parts = vec![counted(pass, "gate passes", "gates pass"), failed];
        if limitation > 0 {
            let limited = counted(limitation, "known limitation", "known limitations");
            parts.push(format!("{limited}, {} of them unexplained", self.unexplained));
        }
        if self.diverged > 0 {
            let expected = match self.unexpected {
                0 => "all expected".into(),
                count => format!("{count} of them unexpected"),
            };
            parts.push(format!(
                "{}, {expected}",
                counted(self.diverged, "run diverged", "runs diverged")
            ));
        }
        let class = if fail > 0 { "verdict fail" } else { "verdict" };
        html! { p class=(class) { a href=(format!("#{VERDICTS}")) { (parts.join(" · ")) } } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_add_up() {
        let counts = Counts::of([Verdict::Pass, Verdict::Pass, Verdict::ExpectedFailure]);
        assert_eq!(Verdict::ALL.map(|verdict| counts.count(verdict)), [2, 1, 0, 0]);
        assert_eq!(counts.headline(), "2 gates pass, 1 control fails as it must");
        let all = Counts {
            pass: 2,
            control: 1,
            limitation: 2,
            fail: 1,
            unexplained: 1,
            diverged: 3,
            unexpected: 1,
        };
        let headline = "1 gate fails, 2 gates pass, 2 known limitations (1 of them unexplained), 1 control \
                        fails as it must, 3 runs diverged";
        assert_eq!(
            (all.worst(), counts.worst()),
            (Some(Verdict::Fail), Some(Verdict::ExpectedFailure))
        );
        assert_eq!(all.headline(), headline);
        let line = all.line().into_string();
        let words = "2 gates pass · 1 gate fails · 2 known limitations, 1 of them unexplained · 3 runs \
                     diverged, 1 of them unexpected";
        assert!(line.contains(words) && line.contains("class=\"verdict fail\""), "{line}");
        let good = Counts { pass: 2, diverged: 1, ..Counts::default() };
        assert!(
            good.line()
                .into_string()
                .contains(">2 gates pass · none fails · 1 run diverged, all expected<")
        );
        assert_eq!(Counts::default().headline(), "Nothing was judged");
        let one = Counts { diverged: 1, ..Counts::of(Verdict::ALL) };
        let headline = "1 gate fails, 1 gate passes, 1 known limitation, 1 control fails as it must, 1 run \
                        diverged";
        assert_eq!(one.headline(), headline);
    }
}
