//! Waves of small amplitude in a periodic box: viscosity, sound, order in time.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use touchstone_base::functions::{atan2, cos, hypot, ln, log2, sin};

use super::{Criterion, Factor, Finding, NotApplicable, Pose, Question, Reads, Solved, fit, named};

/// Wave number of one wave in the box \[1/m\].
fn wave_number(of: &Solved) -> f64 {
    TAU / of.problem.outline.domain.period[0].unwrap_or(1.0)
}

/// The velocity at the end as a multiple of the velocity at the start: particles hardly move.
fn amplitude(of: &Solved) -> Factor {
    let pairs = of.end().states.iter().zip(&of.start.states);
    fit::factor(fit::components(pairs.map(|(end, start)| [end.velocity, start.velocity])))
}

pub fn shear() -> Question {
    Question {
        id: "shear-wave",
        text: "Does a shear wave decay as exp(-νk²t)?",
        // The density is not a power of ten, so that a dynamic viscosity in place of ν is a factor. An
        // artificial viscosity α = 0.1 of approaching pairs adds α h c0/16 = 0.23 ν.
        poses: || {
            let set = ["n=32", "rho=1.5", "nu=0.001", "amplitude=1e-4", "span=0.2"];
            vec![Pose::of("shear_wave", "cubic-leapfrog", &set)]
        },
        answer: Reads::One(|of| {
            let gain = amplitude(of);
            let outline = &of.problem.outline;
            let k = wave_number(of);
            let decay = outline.medium.nu * k * k * of.end().time;
            // Sums of second order over about two spacings: (k dx)²/2.
            let order = (k * outline.medium.dx).powi(2) / 2.0;
            let uncertainty = gain.uncertainty / (gain.value * decay) + order;
            let factor = Factor { value: -ln(gain.value) / decay, uncertainty };
            let bound = "sums of second order take 1 to 4 % at 32 spacings a wave";
            let criterion =
                Criterion::new("factor of the viscosity", factor.value, [0.95, 1.04], bound);
            Ok(Finding::new(factor.of("the viscosity"), [criterion]).with(factor))
        }),
        finds: &["viscosity", "dynamic-viscosity", "artificial-viscosity"],
    }
}

/// Phase and amplitude of a standing wave v = v0 cos ωt, ρ = ρ0 − (ρ0/c0) v0' sin ωt, where v0' is v0 a
/// quarter of a wave further on, of sound that is `factor` times as fast.
fn standing(of: &Solved, factor: f64) -> Result<(f64, f64), NotApplicable> {
    let outline = &of.problem.outline;
    let (eos, k) = (&outline.medium.eos, wave_number(of));
    let states = &of.start.states;
    let (a, b) = states.iter().fold((0.0, 0.0), |(a, b), at| {
        let phase = k * at.position.x;
        (a + at.velocity.x * sin(phase), b + at.velocity.x * cos(phase))
    });
    let scale = 2.0 / states.len() as f64;
    let [a, b] = [a * scale, b * scale];
    let densities = of.end().densities()?;
    let pairs = densities.iter().zip(states).map(|(density, at)| {
        let phase = k * at.position.x;
        let shape = -(a * cos(phase) - b * sin(phase)) / (eos.sound_speed * factor);
        [density / eos.density - 1.0, shape]
    });
    let [velocity, density] = [amplitude(of).value, fit::factor(pairs).value];
    Ok((atan2(density, velocity), hypot(density, velocity)))
}

/// Uncertainty of a sound speed on fine spacing: usual kernels have the lattice sum c² over 3.6 spacings to
/// 0.1 %.
const LATTICE: f64 = 0.001;

/// The factor of the sound speed by the phase of a wave after a period, and its amplitude over the amplitude
/// at the start. The phase of an early time, less than half a turn, gives the whole turns of the late one.
fn period(early: &Solved, late: &Solved) -> Result<(f64, f64), NotApplicable> {
    let expected =
        |of: &Solved| wave_number(of) * of.problem.outline.medium.eos.sound_speed * of.end().time;
    // The factor scales the densities from which it follows: three corrections suffice.
    let mut guess = 1.0;
    for _ in 0..4 {
        let (phase, _) = standing(early, guess)?;
        guess = phase / expected(early);
    }
    let (phase, height) = standing(late, guess)?;
    let turns = ((guess * expected(late) - phase) / TAU).round();
    Ok(((phase + turns * TAU) / expected(late), height))
}

pub fn sound() -> Question {
    Question {
        id: "sound",
        text: "Does sound travel at c0, undamped?",
        poses: || {
            let set = ["nu=0", "amplitude=1e-3"];
            let wave = |more: [&'static str; 2]| {
                Pose::of("acoustic_wave", "quintic-leapfrog", &[set, more].concat())
            };
            ["n=24", "n=32"].map(|n| ["span=0.15", "span=1"].map(|span| wave([n, span]))).concat()
        },
        answer: Reads::Results(|of| {
            let [coarse_early, coarse, fine_early, fine] = named(of)?;
            let spacings = [coarse, fine].map(|of| of.problem.outline.medium.dx);
            let (coarse, _) = period(coarse_early, coarse)?;
            let (fine, height) = period(fine_early, fine)?;
            let found = [coarse, fine].map(|value| Factor { value, uncertainty: 0.0 });
            let factor = fit::limit(found, spacings);
            let factor = Factor { uncertainty: factor.uncertainty + LATTICE, ..factor };
            let words = format!(
                "{}; after one period the amplitude is {height:.3} of that at the start",
                factor.of("the sound speed")
            );
            let criteria = [
                Criterion::new(
                    "factor of the sound speed",
                    factor.value,
                    [0.98, 1.02],
                    "on fine spacing the sums of usual kernels over 3.6 spacings have c² to 0.1 %",
                ),
                Criterion::new(
                    "amplitude after a period",
                    height,
                    [0.97, 1.03],
                    "without viscosity nothing damps, and a stable step amplifies nothing",
                ),
            ];
            Ok(Finding::new(words, criteria).with(factor))
        }),
        finds: &["sound-speed", "gamma", "euler"],
    }
}

pub fn order() -> Question {
    Question {
        id: "order-in-time",
        text: "Halve the step: does the error of time fall with the stated order?",
        poses: || {
            let set = ["n=16", "nu=0", "amplitude=1e-3", "span=0.3"];
            let wave = Pose::of("acoustic_wave", "cubic-leapfrog", &set);
            [0.02, 0.01, 0.005].map(|dt| wave.clone().step(dt)).into()
        },
        answer: Reads::Results(|of| {
            if let Some(few) = of.iter().find_map(|of| of.entry.few_digits(&of.problem)) {
                return Err(format!(
                    "differences of small steps need all digits of a double: {few}"
                ));
            }
            let steps: Option<Vec<f64>> = of.iter().map(|of| of.steps()).collect();
            let steps = steps.ok_or("system.json states no steps")?;
            let halves = |k: usize| (1.8..=2.2).contains(&(steps[k + 1] / steps[k]));
            if !(halves(0) && halves(1)) {
                return Err(format!(
                    "the code does not take the step of `our_method`: its steps are {steps:?}"
                ));
            }
            let velocities = |of: &Solved| {
                of.end().states.iter().map(|at| at.velocity).collect::<Vec<Vector2<f64>>>()
            };
            let apart = |a: &Solved, b: &Solved| {
                fit::rms(velocities(a).iter().zip(velocities(b)).map(|(a, b)| (a - b).norm()))
            };
            let [long, half, quarter] = named(of)?;
            let order = log2(apart(long, half) / apart(half, quarter));
            let stated =
                long.entry.method.settings.get("time_order").and_then(serde_json::Value::as_f64);
            let words = match stated {
                Some(stated) => {
                    format!("the error of time has the order {order:.2}, stated is {stated}")
                }
                None => format!(
                    "the error of time has the order {order:.2}; method.json states no `time_order`"
                ),
            };
            let least = stated.unwrap_or(1.0) - 0.3;
            let because = "three steps, each half the one before, show an order to 0.3";
            Ok(Finding::new(words, [Criterion::at_least("order in time", order, least, because)]))
        }),
        finds: &["late-output", "euler"],
    }
}
