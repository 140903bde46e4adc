//! Steps a simulation through the times of interest: the only time loop of the program. It measures the
//! cost, shows progress, writes frames and stops at an interrupt; cases contain only what differs.

use std::sync::{PoisonError, atomic::Ordering};
use std::time::{Duration, Instant};

use base::mutation::Constant;
use base::record::{Cost, Status};
use cpu_time::{ProcessTime, ThreadTime};
use solver::{Flow, Numbers, Observer, Outcome, Stepper};

pub use crate::context::{Context, Progress};
use crate::{
    error::RunError,
    frames::{self, Frames},
    size::Size,
};

/// Wall time after which it is shown again how far a run is.
const SHOW_EVERY: Duration = Duration::from_millis(200);

/// Obeys an interrupt after every step, however long steps take, and shows how far a run is.
struct Watch<'a> {
    context: &'a Context<'a>,
    end: f64,
    shown: Instant,
}

impl Watch<'_> {
    fn show<X: Numbers>(&mut self, simulation: &(impl Stepper<X> + ?Sized), dt: f64) {
        if let Some(show) = self.context.progress {
            let particle_steps = simulation.work().steps * simulation.fluid_count() as u64;
            show(Progress { time: simulation.time(), end: self.end, dt, particle_steps });
            self.shown = Instant::now();
        }
    }
}

impl<X: Numbers> Observer<X> for Watch<'_> {
    #[inline]
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> Flow {
        if self.context.progress.is_some() && self.shown.elapsed() >= SHOW_EVERY {
            self.show(simulation, simulation.dt());
        }
        match self.context.interrupt {
            Some(flag) if flag.load(Ordering::Relaxed) => Flow::Stop,
            _ => Flow::Continue,
        }
    }
}

/// Sums the time that observers and frames take.
struct Timed<'a, 'f, X> {
    observer: &'a mut dyn Observer<X>,
    frames: &'a mut Option<Frames<'f>>,
    seconds: f64,
}

impl<X: Numbers> Observer<X> for Timed<'_, '_, X> {
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> Flow {
        let start = Instant::now();
        let mut flow = self.observer.after_step(simulation);
        if let Some(frames) = self.frames
            && frames.after_step(simulation) == Flow::Stop
        {
            flow = Flow::Stop;
        }
        self.seconds += start.elapsed().as_secs_f64();
        flow
    }
}

/// What all schemes with the same extra fields share of [`drive`].
struct Run<'a, X> {
    context: &'a Context<'a>,
    dt: f64,
    watch: Watch<'a>,
    observer: &'a mut dyn Observer<X>,
    frames: Option<Frames<'a>>,
    cost: Cost,
}

impl<X: Numbers> Run<'_, X> {
    /// Steps to a time; how the run ended, if it did not get there.
    fn step_to<D>(&mut self, simulation: &mut D, until: f64) -> Option<Status>
    where
        D: Stepper<X> + ?Sized,
    {
        let Self { dt, watch, observer, frames, cost, .. } = self;
        let mut timed = Timed { observer: &mut **observer, frames, seconds: 0.0 };
        let (wall, cpu, process) = (Instant::now(), ThreadTime::now(), ProcessTime::now());
        let before = simulation.work().steps;
        let outcome = simulation.advance(until, *dt, &mut (watch, &mut timed));
        // Runs side by side share a process, so the process's clock is only right for a run that
        // itself has threads.
        if simulation.work().steps > before {
            cost.largest_dt_s = cost.largest_dt_s.max(simulation.dt());
        }
        let elapsed = if cost.threads > 1 { process.elapsed() } else { cpu.elapsed() };
        cost.wall_s += wall.elapsed().as_secs_f64() - timed.seconds;
        cost.cpu_s += (elapsed.as_secs_f64() - timed.seconds).max(0.0);
        cost.observing_s += timed.seconds;
        match outcome {
            Outcome::Reached => None,
            Outcome::Diverged(divergence) => Some(Status::Diverged {
                step: divergence.step,
                time: divergence.time,
                particle: divergence.fault.particle as usize,
                field: divergence.fault.field.into(),
                value_text: format!("{:.6e}", divergence.fault.value),
            }),
            Outcome::Stopped => {
                let (step, time) = (simulation.work().steps, simulation.time());
                Some(Status::Interrupted { step, time })
            }
        }
    }

    /// The last frame of a run that reached its end, and what was counted.
    fn finish<D>(self, simulation: &D, status: &Status) -> Result<Cost, RunError>
    where
        D: Stepper<X> + ?Sized,
    {
        if let Some(frames) = self.frames {
            let has_ended = *status == Status::Completed;
            frames.finish(has_ended.then_some(simulation))?;
        }
        let work = simulation.work();
        Ok(Cost {
            threads: self.context.threads.max(1),
            steps: work.steps,
            pair_interactions: work.pair_interactions,
            particle_rhs: work.right_hand_sides,
            particles: simulation.fluid_count(),
            solver_bytes: simulation.bytes() as u64,
            ..self.cost
        })
    }
}

/// More time steps than this are refused, whatever is allowed.
const MOST_STEPS: f64 = 1e10;

/// Refuses a run that takes more time or memory than a run may, unless the context allows it, and more than
/// 10¹⁰ time steps in any case.
///
/// # Errors
/// What it would take, and the settings on which this depends.
pub fn check_size(size: Size, settings: &'static str, context: &Context) -> Result<(), RunError> {
    if size.is_too_much() && !context.allow_long {
        return Err(RunError::TooLong { size, settings });
    }
    if size.steps.is_nan() || size.steps > MOST_STEPS {
        let (what, value, most) = ("the number of time steps", size.steps, MOST_STEPS);
        return Err(RunError::TooMuch { what, value, most, setting: settings });
    }
    Ok(())
}

/// Steps through `times` \[s\], ascending; `at(simulation, k)` is called at the k-th. Returns how the
/// run ended, and its cost: that of the stepping, and separately that of the observers and of `at`.
///
/// `observer` is called after every step. Frames show `pressure` \[Pa\] as a function of density \[kg/m³\].
///
/// # Errors
/// If it would take more time or memory than a run may, or a frame cannot be written: the run stops at once.
pub fn drive<X: Numbers, D: Stepper<X> + ?Sized>(
    simulation: &mut D,
    dt: f64,
    times: &[f64],
    context: &Context,
    observer: &mut dyn Observer<X>,
    pressure: &dyn Fn(f64) -> f64,
    at: &mut dyn FnMut(&mut D, usize),
) -> Result<(Status, Cost), RunError> {
    let dt = context.mutation.map_or(dt, |mutation| dt * mutation.factor_of(Constant::TimeStep));
    let end = times.last().copied().unwrap_or_default();
    let size = Size::of(simulation, ((end - simulation.time()) / dt).max(times.len() as f64));
    check_size(size, "the end, the time step or the spacing", context)?;
    if let Some(tell) = context.estimate {
        tell(&size);
    }
    let mut watch = Watch { context, end, shown: Instant::now() };
    watch.show(simulation, dt);
    let frames = context.frames.as_ref().map(|frames| Frames::new(frames, end, pressure));
    let cost = Cost { threads: context.threads.max(1), ..Cost::default() };
    let mut run = Run { context, dt, watch, observer, frames: frames.transpose()?, cost };
    let mut status = Status::Completed;
    for (k, &until) in times.iter().enumerate() {
        if let Some(ended) = run.step_to(simulation, until) {
            status = ended;
            break;
        }
        let start = Instant::now();
        at(simulation, k);
        run.cost.observing_s += start.elapsed().as_secs_f64();
    }
    let cost = run.finish(simulation, &status)?;
    if let Some(at_the_end) = context.at_the_end {
        let columns = frames::columns(&simulation.particles(), pressure);
        *at_the_end.lock().unwrap_or_else(PoisonError::into_inner) = Some(columns);
    }
    Ok((status, cost))
}

#[cfg(test)]
mod tests {
    use base::functions::sin;
    use std::sync::{Mutex, atomic::AtomicBool};

    use nalgebra::Vector2;
    use solver::{
        Compose, Continuity, CubicSpline, Domain, Leapfrog, Open, Particle, Pressure, Tait, lattice,
    };

    use super::*;
    use crate::{
        method::{Method, Parts},
        simulate::state,
    };

    const DT: f64 = 1e-3;

    type Sound = Compose<CubicSpline, Pressure<Tait>, Continuity, Open, Leapfrog>;

    /// A sound wave in a periodic box.
    fn wave() -> Box<dyn Stepper<()>> {
        let method = Method::<()>::of::<Sound>();
        let (n, dx) = (12, 1.0 / 12.0);
        let medium = method.medium(Tait::new(1.0, 1.0), [dx, 1.3 * dx]);
        let speed = |x: Vector2<f64>| Vector2::new(0.01 * sin(std::f64::consts::TAU * x.x), 0.0);
        let places = lattice(Vector2::repeat(0.5 * dx), dx, n, n);
        let particles = places.map(|x| Particle::fluid(x, speed(x), 1.0, dx * dx)).collect();
        let domain = Domain::torus(1.0, 1.0);
        (method.build)(Parts::new(medium, domain, particles, &Context::default())).unwrap()
    }

    /// Takes so long over each step, and does something at one of them.
    struct Slow<F> {
        each: Duration,
        steps: u64,
        at: (u64, F),
    }

    impl<F: Fn()> Observer<()> for Slow<F> {
        fn after_step(&mut self, _: &dyn Stepper<()>) -> Flow {
            std::thread::sleep(self.each);
            self.steps += 1;
            if self.steps == self.at.0 {
                (self.at.1)();
            }
            Flow::Continue
        }
    }

    /// Steps of a large disk take a second: an interrupt was looked at after 64 of them.
    #[test]
    fn an_interrupt_is_obeyed_after_the_next_step() {
        let flag = AtomicBool::new(false);
        let context = Context { interrupt: Some(&flag), ..Context::default() };
        let set = || flag.store(true, Ordering::Relaxed);
        let mut slow = Slow { each: Duration::ZERO, steps: 0, at: (3, set) };
        let (times, mut wave) = ([1000.0 * DT], wave());
        let (status, cost) =
            drive(&mut *wave, DT, &times, &context, &mut slow, &|_| 0.0, &mut |_, _| {}).unwrap();
        assert!(matches!(status, Status::Interrupted { .. }), "{status:?}");
        assert!(cost.steps <= 4, "{} steps", cost.steps);
    }

    #[test]
    fn progress_is_shown_at_once_and_by_wall_time_and_changes_nothing() {
        let shown: Mutex<Vec<(Instant, f64)>> = Mutex::default();
        let show = |p: Progress| shown.lock().unwrap().push((Instant::now(), p.time));
        let watched = Context { progress: Some(&show), ..Context::default() };
        let mut states = Vec::new();
        for context in [Context::default(), watched] {
            let mut slow = Slow { each: Duration::from_millis(25), steps: 0, at: (0, || ()) };
            let (times, mut wave) = ([10.0 * DT, 40.0 * DT], wave());
            drive(&mut *wave, DT, &times, &context, &mut slow, &|_| 0.0, &mut |_, _| {}).unwrap();
            states.push((state(&wave.particles()), wave.work().steps));
        }
        assert_eq!(states[0], states[1]);
        let shown = shown.into_inner().unwrap();
        assert!(shown.len() >= 4, "in 40 steps of 25 ms: {shown:?}");
        assert_eq!(shown[0].1, 0.0, "before the first step, which may take long");
        assert!(shown.windows(2).all(|pair| pair[1].0 - pair[0].0 >= SHOW_EVERY), "{shown:?}");
    }
}
