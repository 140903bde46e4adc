//! Elastic bodies without an exact solution of the method: rotation and bending.

use std::f64::consts::PI;

use touchstone_base::functions::{atan2, cos, sin};

use super::{Criterion, Factor, Finding, Pose, Question, Reads, fit};

pub fn spin() -> Question {
    Question {
        id: "spin",
        text: "Does a spinning disk keep its angular momentum and its shape?",
        poses: || vec![Pose::of("spinning_disk", "lagrangian", &["n=6", "end=0.1"])],
        answer: Reads::One(|of| {
            let (start, end) = (&of.start.states, &of.end().states);
            let spin = |all: &[super::code::State]| {
                all.iter().fold(0.0, |sum, at| sum + at.mass * at.position.perp(&at.velocity))
            };
            let kept = spin(end) / spin(start);
            let (along, across) =
                start.iter().zip(end).fold((0.0, 0.0), |(along, across), (a, b)| {
                    (along + a.position.dot(&b.position), across + a.position.perp(&b.position))
                });
            let angle = atan2(across, along);
            let (c, s) = (cos(angle), sin(angle));
            let turned = nalgebra::Matrix2::new(c, -s, s, c);
            let off = start.iter().zip(end).map(|(a, b)| (b.position - turned * a.position).norm());
            let radius = start.iter().fold(0.0, |most: f64, at| most.max(at.position.norm()));
            let off = fit::rms(off) / radius;
            let words = format!(
                "after a tenth of a turn the angular momentum is {kept:.4} of its first value, and particles \
                 are {off:.4} radii from a rigid turn"
            );
            let criteria = [
                Criterion::new(
                    "angular momentum",
                    kept,
                    [0.99, 1.01],
                    "no torque acts on a free disk",
                ),
                Criterion::at_most(
                    "distance from a rigid turn",
                    off,
                    0.01,
                    "centrifugal strain is 0.0025 at a rim of 0.05 c0",
                ),
            ];
            Ok(Finding::new(words, criteria))
        }),
        finds: &["rotation-as-strain"],
    }
}

/// Frequency of the first mode of a plate seven times as long as thick, over the frequency of thin plates:
/// by 20 layers of the total Lagrangian method, which for a plate ten times as long as thick agrees with
/// finite elements to 0.05 %.
const BEND: f64 = 0.9915;

pub fn bend() -> Question {
    Question {
        id: "bending",
        text: "Does a bar of five layers bend as much as it should?",
        poses: || {
            vec![Pose::of("oscillating_plate", "lagrangian", &["n=5", "length=0.14", "end=0.25"])]
        },
        answer: Reads::One(|of| {
            // The velocities at the start are the first mode.
            let free = |k: &usize| of.start.states[*k].velocity.norm() > 0.0;
            let all: Vec<usize> = (0..of.start.states.len()).filter(free).collect();
            let pair = |k: usize| (&of.start.states[k], &of.end().states[k]);
            let velocity = fit::factor(fit::components(all.iter().map(|k| {
                let (a, b) = pair(*k);
                [b.velocity, a.velocity]
            })));
            let way = fit::factor(fit::components(all.iter().map(|k| {
                let (a, b) = pair(*k);
                [b.position - a.position, a.velocity]
            })));
            // x = (v0/ω) sin ωt, v = v0 cos ωt: a quarter of a period of thin plates has passed.
            let quarter = of.end().time;
            let phase = atan2(way.value * (0.5 * PI / quarter), velocity.value);
            let factor = Factor { value: phase / (0.5 * PI) / BEND, uncertainty: 0.01 };
            let words = format!(
                "{}: {}",
                factor.of("the frequency of bending"),
                match factor.value {
                    low if low < 0.96 =>
                        "it is too soft (plane stress in place of plane strain gives 0.92)",
                    high if high > 1.04 => "it is too stiff",
                    _ => "as it should be",
                }
            );
            let because =
                "five layers of a consistent method have the frequency of finite elements to 1 %";
            let criterion =
                Criterion::new("factor of the frequency", factor.value, [0.96, 1.04], because);
            Ok(Finding::new(words, [criterion]).with(factor))
        }),
        finds: &["plane-stress", "one-sided-gradient"],
    }
}
