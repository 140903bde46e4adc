//! The clocks of a run. A test can set the time: see [`crate::context::Context::clock`].

use std::ops::{AddAssign, Sub};
use std::sync::OnceLock;
use std::time::Instant;

use cpu_time::{ProcessTime, ThreadTime};

/// Wall time and processor time since some moment \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Time that passed.
    pub wall: f64,
    /// Time that processors worked.
    pub cpu: f64,
}

impl Sub for Reading {
    type Output = Self;
    fn sub(self, before: Self) -> Self {
        Self { wall: self.wall - before.wall, cpu: self.cpu - before.cpu }
    }
}

impl AddAssign for Reading {
    fn add_assign(&mut self, more: Self) {
        self.wall += more.wall;
        self.cpu += more.cpu;
    }
}

/// Now by the clocks of the system, with the processor time of this thread, or of the whole process if the
/// run has several threads: runs side by side share a process.
pub fn system(threads: usize) -> Reading {
    static START: OnceLock<Instant> = OnceLock::new();
    let cpu = match threads {
        0 | 1 => ThreadTime::now().as_duration(),
        _ => ProcessTime::now().as_duration(),
    };
    let wall = START.get_or_init(Instant::now).elapsed();
    Reading { wall: wall.as_secs_f64(), cpu: cpu.as_secs_f64() }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::{scope, sleep};
    use std::time::Duration;

    use super::*;

    /// Runs side by side would each take the time of all.
    #[test]
    fn a_run_of_one_thread_is_not_charged_for_the_work_of_others() {
        let is_over = AtomicBool::new(false);
        let [alone, all] = scope(|scope| {
            scope.spawn(|| {
                while !is_over.load(Ordering::Relaxed) {
                    std::hint::spin_loop()
                }
            });
            let before = [1, 2].map(system);
            sleep(Duration::from_millis(200));
            let after = [1, 2].map(system);
            is_over.store(true, Ordering::Relaxed);
            [0, 1].map(|k| after[k] - before[k])
        });
        assert!(alone.wall >= 0.2 && alone.cpu < 0.02, "it only waited: {alone:?}");
        assert!(all.cpu > alone.cpu + 0.02, "the other thread works: {all:?} against {alone:?}");
    }
}
