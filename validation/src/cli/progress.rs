//! How far it is: on a terminal only, so that logs and tests stay quiet.

use std::io::{self, IsTerminal};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use touchstone_harness::{context::RunProgress, tally::Done};
use touchstone_report::sig;

use super::output;

/// A bar on standard error, or nothing.
pub struct Bar {
    bar: ProgressBar,
    start: Instant,
    /// Before this there is nothing new to show.
    next: Mutex<Instant>,
    /// Part of the run that was done at the start: more than 0 of one that continues from a checkpoint.
    first: OnceLock<f64>,
}

/// Between two looks.
const EVERY: Duration = Duration::from_millis(100);
/// Parts that the work is divided into.
const PARTS: u64 = 1000;

impl Bar {
    /// A bar if standard error is a terminal.
    pub fn new() -> Self {
        let bar = if io::stderr().is_terminal() {
            ProgressBar::new(PARTS)
        } else {
            ProgressBar::hidden()
        };
        let template = "{bar:24} {percent:>3} %  {elapsed}  {wide_msg}"; // cut at the edge of the terminal
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("━╸ "));
        }
        let start = Instant::now();
        Bar { bar, start, next: Mutex::new(start), first: OnceLock::new() }
    }

    /// Shows how far a run is.
    pub fn show_run(&self, progress: RunProgress) {
        if !self.is_time() {
            return;
        }
        let RunProgress { time, end, .. } = progress;
        let elapsed = self.start.elapsed().as_secs_f64();
        let done = (time / end).clamp(0.0, 1.0);
        let left = left(elapsed, *self.first.get_or_init(|| done), done);
        let left = left.map(|seconds| format!(", {} left", touchstone_report::seconds(seconds)));
        let left = left.unwrap_or_default();
        self.show(done, format!("t = {} of {} s{left}", sig(time, 3), sig(end, 3)));
    }

    /// Shows how far the runs of a plan are.
    pub fn show_runs(&self, done: Done) {
        let Done { runs, all, share, left, last } = done;
        let mut words = format!("{runs} of {}", touchstone_report::counted(all, "run", "runs"));
        if let Some(left) = left {
            words += &format!(", {} left", touchstone_report::seconds(left));
        }
        if runs > 0 {
            words += &format!(", last {last}");
        }
        self.show(share, words);
    }

    /// Draws the bar. The elapsed time advances during a long run, and not before its start: a drawn bar
    /// stays on the screen above messages printed without [`Self::suspend`].
    fn show(&self, share: f64, words: String) {
        self.bar.set_position((share * PARTS as f64) as u64);
        self.bar.set_message(words);
        if !self.bar.is_hidden() {
            self.bar.enable_steady_tick(2 * EVERY);
        }
    }

    /// Prints a line above the bar.
    pub fn say(&self, text: &str) {
        self.suspend(|| output::say(text));
    }

    /// Hides the bar while a message is printed.
    pub fn suspend<T>(&self, say: impl FnOnce() -> T) -> T {
        self.bar.suspend(say)
    }

    /// Wipes the bar away.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    fn is_time(&self) -> bool {
        let now = Instant::now();
        let mut next = touchstone_base::lock(&self.next);
        let is_time = !self.bar.is_hidden() && now >= *next;
        if is_time {
            *next = now + EVERY;
        }
        is_time
    }
}

/// The time that the rest of a run takes \[s\], of which this part was done at the start and is done now.
fn left(elapsed: f64, first: f64, done: f64) -> Option<f64> {
    (done > first).then(|| elapsed * (1.0 - done) / (done - first))
}

#[cfg(test)]
mod tests {
    use super::left;

    /// A resumed run: half done at the start and nothing since then must not show nearly no time left.
    #[test]
    fn the_time_left_of_a_run_that_goes_on_is_by_what_it_did_since() {
        assert_eq!(left(10.0, 0.0, 0.25), Some(30.0));
        assert_eq!(left(10.0, 0.5, 0.75), Some(10.0));
        assert_eq!(left(10.0, 0.5, 0.5), None);
        assert_eq!(left(10.0, 0.0, 1.0), Some(0.0));
    }
}
