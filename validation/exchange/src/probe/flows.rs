//! Short flows with an exact solution.

use std::f64::consts::PI;

use nalgebra::Vector2;
use touchstone_base::functions::{cos, exp, ln};
use touchstone_maths::exact::StartUp;

use super::{
    Criterion, Factor, Finding, NotApplicable, Pose, Question, Reads, Solved, code::State, fit,
    fixed, named,
};

/// Number of a setting of the problem.
fn setting(of: &Solved, name: &str) -> Result<f64, NotApplicable> {
    let value = of.problem.spec.settings[name].as_f64();
    value.ok_or_else(|| format!("the problem has no number {name}"))
}

/// Vortices on disordered particles.
pub fn mild() -> Pose {
    Pose::of("taylor_green", "plain", &["n=16", "perturb=0.2", "end=0.1"])
}

pub fn did_it_run() -> Question {
    Question {
        id: "ran",
        text: "Did it run? Are times, steps and particles those of a run?",
        poses: || vec![mild()],
        answer: Reads::One(|of| {
            let outline = &of.problem.outline;
            // A way as short as the disorder of the start tells one run from another.
            let end = of.moments.iter().find(|at| at.time > 0.012).unwrap_or(&of.start);
            let pairs = of.start.states.iter().zip(&end.states);
            // By the velocities at both ends.
            let moved = pairs.map(|(a, b)| {
                let way = outline.domain.nearest(b.position - a.position);
                [way, (a.velocity + b.velocity) * (0.5 * end.time)]
            });
            let factor = fit::factor(fit::components(moved.clone()));
            let off = fit::rms(moved.map(|[way, expected]| (way - expected).norm()));
            let off = off / disorder(of);
            let mut words =
                format!("particles moved {factor} times the way that their velocities make");
            let mut criteria = vec![
                Criterion::new(
                    "way over velocity times time",
                    factor.value,
                    [0.9, 1.1],
                    "a mean of both velocities gives the way to 2 %; a copy of the start has 0",
                ),
                Criterion::at_most(
                    "distance from that way over the disorder of the start",
                    off,
                    1.0,
                    "shifting that removes the share s of the disorder takes s; another start is (1 + (1 - \
                     s)^2)^(1/2) away, at least 1",
                ),
            ];
            if let Some(steps) = of.steps() {
                let medium = &outline.medium;
                let least = of.end().time * medium.sound_speed / (4.0 * medium.h);
                words += &format!("; it states {steps} steps");
                criteria.push(Criterion::at_least(
                    "steps over the least number",
                    steps / least,
                    1.0,
                    "no explicit step is longer than four times h/c0",
                ));
            }
            Ok(Finding::new(words, criteria).with(factor))
        }),
        finds: &["copy-of-start", "other-results", "no-run"],
    }
}

/// Rms distance of the particles from their lattice at the start \[m\].
fn disorder(of: &Solved) -> f64 {
    let dx = of.problem.outline.medium.dx;
    let from_lattice = |x: f64| x - ((x / dx).floor() + 0.5) * dx;
    fit::rms(of.start.states.iter().map(|at| at.position.map(from_lattice).norm()))
}

/// Allowed energy over the energy of the exact flow at the end.
const ENERGY: [f64; 2] = [0.98, 1.01];

pub fn conservation() -> Question {
    Question {
        id: "conservation",
        text: "Is momentum kept, and energy lost only to the viscosity?",
        poses: || vec![super::vortices(&["re=1000"])],
        answer: Reads::One(|of| {
            let sizes =
                of.start.states.iter().fold(0.0, |sum, at| sum + at.mass * at.velocity.norm());
            let momentum = (fit::momentum(of.end()) - fit::momentum(&of.start)).norm() / sizes;
            let (nu, k) = (of.problem.outline.medium.nu, 2.0 * PI);
            let expected = exp(-4.0 * nu * k * k * of.end().time);
            let energies =
                |at| [fit::kinetic(at), fit::elastic(at, &of.problem.outline.medium.eos)];
            let [before, after] = [&of.start, of.end()].map(energies);
            let energy = (after[0] + after[1]) / (before[0] + before[1]) / expected;
            let words = format!(
                "momentum changed by {momentum:.1e} of its size, energy is {energy:.3} times its value \
                 after the viscous decay"
            );
            let criteria = [
                Criterion::at_most(
                    "change of momentum",
                    momentum,
                    1e-6,
                    "forces of pairs that are equal and opposite change it by round-off",
                ),
                Criterion::new(
                    "energy over its value after the viscous decay",
                    energy,
                    ENERGY,
                    "the viscosity of the disorder takes up to 1 %",
                ),
            ];
            Ok(Finding::new(words, criteria))
        }),
        finds: &["one-sided", "twice-counted", "missed-neighbours", "artificial-viscosity"],
    }
}

/// Distance from the lower plate over the width, and velocity along the plates.
fn profile(of: &Solved, states: &[State]) -> Result<Vec<[f64; 2]>, NotApplicable> {
    let width = setting(of, "width")?;
    Ok(states.iter().map(|at| [at.position.y / width, at.velocity.x]).collect())
}

fn couette() -> Pose {
    Pose::of("couette", "plain", &["rows=10"]).or("extrapolating-wall")
}

/// The exact flow between the plates, at the speed V = Re ν/L \[m/s\].
fn start_up(of: &Solved) -> Result<StartUp, NotApplicable> {
    let [l, nu] = [setting(of, "width")?, setting(of, "nu")?];
    Ok(StartUp { v: setting(of, "re")? * nu / l, l, nu })
}

pub fn drag() -> Question {
    Question {
        id: "moving-wall",
        text: "Does a moving wall drag the fluid, at its own speed?",
        poses: || vec![couette()],
        answer: Reads::One(|of| {
            let speed = start_up(of)?.v;
            let all = profile(of, &of.end().states)?;
            let (start, slope) = fit::line(&all);
            let off = fit::rms(all.iter().map(|[y, u]| u - start - slope * y));
            let [low, high] = [start / speed, (start + slope) / speed];
            // Walls that act δ behind their place have u(0) = f V δ/(L + 2 δ), u(L) = f V (L + δ)/(L + 2 δ).
            let behind = low / (high - low) * setting(of, "rows")?;
            let is_displaced = (0.05..1.0).contains(&behind.abs());
            let value = if is_displaced { high + low } else { high };
            let factor = Factor { value, uncertainty: 0.005 + off / speed };
            let other = match is_displaced {
                true => format!("the walls act {} spacings behind their place", fixed(behind, 2)),
                false => format!("the other wall has {} of it", fixed(low, 3)),
            };
            let words = format!("{}, {other}", factor.of("the speed of the moving wall"));
            let because = "second-order sums have the steady profile, a straight line, to 1 %";
            let criteria = [
                Criterion::new("velocity at the moving wall", high, [0.98, 1.02], because),
                Criterion::new("velocity at the resting wall", low, [-0.02, 0.02], because),
            ];
            Ok(Finding::new(words, criteria).with(factor))
        }),
        finds: &["wall-speed", "wall-at-rest", "wall-sign", "wall-place"],
    }
}

pub fn stick() -> Question {
    Question {
        id: "no-slip",
        text: "Does the fluid stick to the wall, as asked?",
        poses: || vec![couette()],
        answer: Reads::One(|of| {
            let flow = start_up(of)?;
            let time = 0.1 * flow.l * flow.l / flow.nu;
            let at = of
                .moments
                .iter()
                .min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()));
            let at = at.unwrap_or(&of.start);
            let row = 1.0 / setting(of, "rows")?;
            let [mut beside, mut inside] = [0.0_f64; 2];
            for [y, u] in profile(of, &at.states)? {
                let off = (u - flow.couette(y * flow.l, at.time)).abs() / flow.v;
                let place = if y.min(1.0 - y) < row { &mut beside } else { &mut inside };
                *place = if off.is_nan() { f64::NAN } else { place.max(off) };
            }
            let words = format!(
                "at νt/L² = 0.1 the rows beside the walls are off by {beside:.3} of the wall's speed, \
                 the others by {inside:.3}"
            );
            let because = "ten rows of a second-order method have the exact velocity to 1 %";
            let criteria = [
                Criterion::at_most("error beside the walls", beside, 0.03, because),
                Criterion::at_most("error inside", inside, 0.03, because),
            ];
            Ok(Finding::new(words, criteria))
        }),
        finds: &["slip", "wall-term"],
    }
}

pub fn slip() -> Question {
    Question {
        id: "free-slip",
        text: "Does the fluid slip along the wall, as asked?",
        poses: || vec![Pose::of("slip_channel", "plain", &[]).or("extrapolating-wall")],
        answer: Reads::One(|of| {
            // u = U (1 + cos πy/L exp(−π²νt/L²)), L = U = 1.
            let (states, nu) = (&of.end().states, of.problem.outline.medium.nu);
            let decay = PI * PI * nu * of.end().time;
            let half_wave = |at: &State| cos(PI * at.position.y);
            let mean = |value: &dyn Fn(&State) -> f64| {
                states.iter().fold(0.0, |sum, at| sum + value(at)) / states.len() as f64
            };
            let kept = mean(&|at| at.velocity.x);
            let gain = 2.0 * mean(&|at| at.velocity.x * half_wave(at));
            let exact = |at: &State| 1.0 + half_wave(at) * exp(-decay);
            let row = 1.0 / setting(of, "n")?;
            let beside = states.iter().filter(|at| (at.position.y - 0.5).abs() > 0.5 - row);
            let beside = fit::rms(beside.map(|at| at.velocity.x - exact(at)));
            let factor = Factor { value: -ln(gain) / decay, uncertainty: 0.02 };
            let momentum =
                format!("the momentum along it is {} of its first value", fixed(kept, 3));
            let words = match kept {
                // By the exact solution a wall that sticks has taken half of the momentum.
                low if low < 0.75 => format!("the wall sticks: {momentum}"),
                low if low < KEPT[0] => format!("the wall slips with friction: {momentum}"),
                _ => format!("the wall slips: {momentum}; {}", factor.of("the viscosity")),
            };
            let criteria = [
                Criterion::new("momentum", kept, KEPT, "no force acts along a wall that slips"),
                Criterion::new(
                    "factor of the viscosity",
                    factor.value,
                    [0.95, 1.04],
                    "sums of second order take 1 to 2 % at 20 rows, and a step of 0.25 h²/ν as much",
                ),
                Criterion::at_most(
                    "rms error beside the walls",
                    beside,
                    0.02,
                    "4 % of a decay by 0.5 are 2 % of the velocity",
                ),
            ];
            Ok(Finding::new(words, criteria).with(factor))
        }),
        finds: &["stick", "wall-term"],
    }
}

/// Allowed momentum over the momentum of the start.
const KEPT: [f64; 2] = [0.99, 1.01];

pub fn force() -> Question {
    Question {
        id: "body-force",
        text: "Does a body force drive the right flow?",
        poses: || {
            vec![
                Pose::of("poiseuille", "plain", &["rows=20", "end=0.02", "re=0.5"])
                    .or("extrapolating-wall"),
            ]
        },
        answer: Reads::One(|of| {
            let flow = start_up(of)?;
            let middle = profile(of, &of.end().states)?;
            let middle = middle.into_iter().filter(|[y, _]| (y - 0.5).abs() < 0.25);
            // Beyond the layers that the walls have slowed, u = F t to 1 %.
            let pairs = middle.map(|[y, u]| [u, flow.poiseuille(y * flow.l, of.end().time)]);
            let factor = fit::factor(pairs);
            let factor = Factor { uncertainty: factor.uncertainty + 0.005, ..factor };
            let because = "before the walls' layers meet, the middle has u = F t at any order";
            let criterion =
                Criterion::new("factor of the body force", factor.value, [0.98, 1.02], because);
            Ok(Finding::new(factor.of("the body force"), [criterion]).with(factor))
        }),
        finds: &["body-force", "force-twice"],
    }
}

fn tank(end: &str) -> Pose {
    Pose::of("hydrostatic", "ghosts", &["rows=10", "columns=10", end]).or("modern")
}

pub fn still() -> Question {
    Question {
        id: "still-water",
        text: "Does still water stay still, with p = ρ g d?",
        poses: || vec![tank("end=0.02"), tank("end=1")],
        answer: Reads::Results(|of| {
            // Until a wave of the surface or of a wall arrives, gravity that the pressure of the start
            // does not hold accelerates the middle of the tank as a free fall.
            let [short, long] = named(of)?;
            let (early, g) = (short.end(), short.problem.outline.medium.acceleration);
            let side = setting(short, "depth")?;
            let is_inside = |x: Vector2<f64>| x.iter().all(|x| (0.3..=0.7).contains(&(x / side)));
            let fall = g.norm_squared() * early.time;
            let pairs = short.start.states.iter().zip(&early.states);
            let pairs = pairs.filter(|(start, _)| is_inside(start.position));
            let fitted = fit::factor(pairs.map(|(_, at)| [1.0 + at.velocity.dot(&g) / fall, 1.0]));
            let factor = Factor { uncertainty: fitted.uncertainty + 0.01, ..fitted };
            let (late, medium) = (long.end(), &long.problem.outline.medium);
            let depth = setting(long, "depth")?;
            let speeds: Vec<(Vector2<f64>, f64)> =
                late.states.iter().map(|at| (at.position, at.velocity.norm())).collect();
            let unit = (medium.acceleration.norm() * depth).sqrt();
            let speed = fit::rms(speeds.iter().map(|(_, speed)| speed / unit));
            let fastest = speeds.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let place = fastest.map_or(String::new(), |(x, speed)| {
                format!(
                    "; the fastest particle, {:.3} (gH)^(1/2), is at x = {:.2}, y = {:.2} m",
                    speed / unit,
                    x.x,
                    x.y
                )
            });
            let words = format!(
                "{}; after 4 H/c0 the speed is {speed:.4} (gH)^(1/2) rms{place}",
                factor.of("gravity, if the pressure force is right,")
            );
            let unsettled = medium.dx / depth * unit / medium.eos.sound_speed;
            let criteria = [
                Criterion::new(
                    "factor of gravity",
                    factor.value,
                    [0.95, 1.05],
                    "the start has the exact pressure, and a linear gradient, which sums have to 1 %",
                ),
                Criterion::at_most(
                    "speed over (gH)^(1/2)",
                    speed,
                    unsettled,
                    "pressures that are wrong by one row of depth, ρ g dx, move water at g dx/c0",
                ),
            ];
            Ok(Finding::new(words, criteria).with(factor))
        }),
        finds: &["gravity", "corner"],
    }
}
