//! What is known to lie outside of its gate, how far, and why: bounds that follow from what other settings,
//! spacings and variants do.

use super::{
    metrics::{self, FRONT, HEIGHT, IMPULSE, LEVELS, Z},
    reference::PEERS,
};
use crate::{
    causes::{FREE_SLIP, NO_SLIP_IMAGES, PRESSED_THROUGH, TENSION, TWO_DIMENSIONS, VISCOSITY},
    water::ledger,
};
use base::{
    gate::{Bound, Cause, Evidence, Gate},
    record::MetricName,
};

/// Is it a gate on this metric?
fn is_on(gate: &Gate, metric: impl Into<MetricName>) -> bool {
    gate.metric == metric.into().name()
}

/// Why a gate has a wider bound, and where that comes from.
type Why = (&'static Cause, &'static str);

fn limited(gate: Gate, known: Bound, (cause, reason): Why) -> Gate {
    gate.with_limitation(known, reason).because_of(cause)
}

/// Known to be low, down to this number.
fn down_to(gate: Gate, low: f64, why: Why) -> Gate {
    let known = match gate.bound {
        Bound::Within(_, high) => Bound::Within(low, high),
        _ => Bound::Above(low),
    };
    limited(gate, known, why)
}

/// Known to be high, up to this number.
fn up_to(gate: Gate, high: f64, why: Why) -> Gate {
    let known = match gate.bound {
        Bound::Within(low, _) => Bound::Within(low, high),
        _ => Bound::Below(high),
    };
    limited(gate, known, why)
}

/// The gate of a column that runs out freely, with its limitation, if it has one.
pub fn of_free(gate: Gate, variant: &str, n: usize) -> Gate {
    let [z2, z3] = PEERS.map(|(t, ..)| Z.at(t));
    match variant {
        "ghosts" => of_free_ghosts(gate),
        "ghosts-slip" => may_lose(gate, 5.0),
        "modern" if n > 40 && is_on(&gate, z3.clone()) => up_to(gate, 4.125, AHEAD),
        "seed" if is_on(&gate, z2) => down_to(gate, if n < 40 { 2.35 } else { 2.44 }, THICK),
        "seed" if is_on(&gate, z3) => down_to(gate, if n < 40 { 3.51 } else { 3.68 }, THICK),
        "seed" if is_on(&gate, FRONT.shift) && n < 40 => down_to(gate, -0.05, THICK),
        "seed" if is_on(&gate, HEIGHT.shift) => down_to(gate, -0.11 * 20.0 / n as f64, LAYER),
        _ => gate,
    }
}

/// The gate of a column in the tank, with its limitation, if it has one.
pub fn in_tank(gate: Gate, variant: &str) -> Gate {
    let sensor = IMPULSE.into_iter().position(|sensor| is_on(&gate, sensor.at(1)));
    match (variant, sensor) {
        ("ghosts", _) => of_ghosts_in_tank(gate, sensor),
        ("ghosts-split", _) => may_lose(gate, 5.0),
        ("seed", None) if is_on(&gate, FRONT.rms_shifted) => up_to(gate, 0.22, SPENT),
        ("seed", Some(3)) => down_to(gate, -1.35, PULLED),
        ("seed", Some(k)) => down_to(gate, [-0.86, -0.65, -0.52][k], SPENT),
        ("modern", None) if is_on(&gate, FRONT.rms_shifted) => up_to(gate, 0.14, FAST),
        ("modern", Some(k)) => {
            let (model, share) = [(0.265, 0.16), (0.194, 0.15), (-0.049, 0.21), (-0.527, 0.33)][k];
            let impulse = |share: f64| (1.0 + model) * (1.0 + share) - 1.0;
            limited(gate, Bound::Within(impulse(-share), impulse(share)), MODEL)
        }
        _ => gate,
    }
}

/// So many particles may be behind a wall of mirror particles.
fn may_lose(gate: Gate, particles: f64) -> Gate {
    match is_on(&gate, metrics::OUTSIDE) {
        true => limited(gate, Bound::Within(0.0, particles), CROSSED),
        false => gate,
    }
}

/// Of ghosts in the column that runs out freely: what four other spacings have, 10, 14, 28 and 40, whose
/// noise is another.
fn of_free_ghosts(gate: Gate) -> Gate {
    let [z2, z3] = PEERS.map(|(t, ..)| Z.at(t));
    let low = [(z2, 2.30), (z3, 3.32), (FRONT.shift.into(), -0.15), (HEIGHT.shift.into(), -0.12)];
    let high = [
        (ledger::WORK_WALLS, 1.12),
        (ledger::ENERGY_GAP, 0.0165),
        (metrics::MACH, 0.60),
        (FRONT.rms_shifted, 0.19),
    ];
    if is_on(&gate, metrics::OUTSIDE) {
        return may_lose(gate, 5.0);
    }
    if let Some((_, low)) = low.into_iter().find(|(metric, _)| is_on(&gate, metric.clone())) {
        return down_to(gate, low, MIRRORED);
    }
    match high.into_iter().find(|(metric, _)| is_on(&gate, *metric)) {
        Some((_, high)) => up_to(gate, high, MIRRORED),
        None => gate,
    }
}

/// Of ghosts in the tank, judged by what was measured until the run ended.
fn of_ghosts_in_tank(gate: Gate, sensor: Option<usize>) -> Gate {
    let high = [
        (ledger::WORK_WALLS, 1.11),
        (ledger::ENERGY_GAP, 0.096),
        (metrics::MOMENTUM_GAP, 0.035),
        (metrics::MACH, 0.60),
        (FRONT.rms_shifted, 0.30),
        (LEVELS.rms_shifted, 0.059),
    ];
    let gate = match sensor {
        Some(k) => down_to(gate, [-0.79, -0.49, -0.69, -2.17][k], ENDS),
        None if is_on(&gate, metrics::REACHED) => down_to(gate, 0.36, ENDS),
        None if is_on(&gate, metrics::OUTSIDE) => may_lose(gate, 10.0),
        None => match high.into_iter().find(|(metric, _)| is_on(&gate, *metric)) {
            Some((_, high)) => up_to(gate, high, ENDS),
            None => gate,
        },
    };
    match gate.evidence {
        Evidence::Reference => gate.may_end_early(),
        _ => gate.even_if_diverged(),
    }
}

const MIRRORED: Why = (
    &NO_SLIP_IMAGES,
    "At a/dx = 10, 14, 28 and 40 (which diverges at t = 0.184 s) the walls do work of 0.64, 0.66, 0.49 \
     and 0.29 M g H/2 on the water, and energy is off by 0.006, 0.008, 0.009 and 0.002. The bounds of work \
     (1.12) and energy (0.0165) are what a fifth run of that mean and scatter stays below with a \
     probability of 97.5 % (Student's distribution, 3 degrees of freedom); those of front and height are \
     the farthest of the four, and that of the Mach number is 0.60, as in the tank. `ghosts-slip`, whose \
     images keep the velocity along the wall, has a work of 0.001, Z = 2.58 and 4.00, and Mach 0.12.",
);
const CROSSED: Why = (
    &PRESSED_THROUGH,
    "The lowest row of a layer that is stretched sinks into the plane of the floor at 0.05 to 0.2 √(g H), \
     and feels no force across the plane there. `ghosts-slip` loses 1 particle on the endless floor and 5 \
     in the tank, `ghosts-split` none and 3, and `ghosts` without XSPH 10 in the tank. The bound is 10 for \
     `ghosts` in the tank, and 5 elsewhere.",
);
const ENDS: Why = (
    &NO_SLIP_IMAGES,
    "At H/dx = 20 the run diverges after 54 % of its time; if this share is proportional to the spacing, \
     it is 36 % at 30. The bounds of work (1.11 M g H/2) and energy (0.096) were found at 20 without XSPH, \
     and those of momentum (0.035) and Mach number (0.60) with it. Those of front, levels and impulses are \
     the largest errors of `seed` at h/dx = 1.2 and of `ghosts-slip`. `ghosts-split` reaches the end at 20 \
     and 30, but its floor drags the water, which strikes the far wall at 3.94 instead of 2.44 √(H/g).",
);
const AHEAD: Why = (
    &FREE_SLIP,
    "A computation of this model by volume of fluid, reference `dam_break_vof`, has Z = 4.081 ± 0.024 at \
     T = 3. The bound is this place with its uncertainty and 0.02 a, by which a front may differ from it. \
     `modern-sticking`, whose viscosity sees the walls, has 3.98 at a/dx = 80, as those codes do.",
);
const THICK: Why = (
    &VISCOSITY,
    "The bounds are what `modern-sticking` has at a/dx = 20 with 1.4 times the artificial viscosity of this \
     run, by sound speeds of 100 √(g H) for a/dx = 20 and 50 for 40. It has Z = 2.35 and 2.44 at T = 2, \
     Z = 3.51 and 3.68 at T = 3, and shifts of the front of -0.05 and 0.05.",
);
const LAYER: Why = (
    &VISCOSITY,
    "Particles next to the back wall lag: at 0.2 a from it and τ = 2.45 the height is too large by 0.10 \
     (unit 2a) at a/dx = 20 and by 0.05 at 40. The shift is proportional to artificial viscosity: it is \
     -0.053 with half of alpha and -0.187 with twice the sound speed, which in proportion is -0.106 and \
     -0.094 with the viscosity of this run at 20. The bound is -0.11 at 20 and half of it at 40.",
);
const SPENT: Why = (
    &VISCOSITY,
    "Viscosity takes 73 % of the energy, and the water strikes the far wall at 3.04 instead of 2.44 \
     √(H/g). With alpha = 0.2 at H/dx = 20, three times this viscosity, the front is 0.22 H off, and the \
     impulses on P1, P2 and P3 lack 85, 57 and 36 %. The bounds are these errors; they also take from the \
     impulse that remains the 5, 17 and 25 % that the finest run of `modern-sticking` lacks.",
);
const PULLED: Why = (
    &TENSION,
    "The little water that rises to 80 mm has lost density, and the impulse on P4 is negative, an error \
     below -100 %. Five runs at H/dx = 20 that differ in alpha or in XSPH alone have errors of -12 to -103 \
     %. The bound is their mean less twice their standard deviation, -135 %.",
);
const FAST: Why = (
    &TWO_DIMENSIONS,
    "The front runs at 1.70, 1.74 and 1.76 √(g H) at H/dx = 30, 60 and 120, at 1.515 in the experiment, and \
     at 1.761 ± 0.014 in a computation of this model by volume of fluid, reference `dam_break_vof`, which is \
     0.119 H from the experiment after its best shift. The bound adds 0.02 H, by which a front may differ \
     from that computation.",
);
const MODEL: Why = (
    &TWO_DIMENSIONS,
    "A computation of this model by volume of fluid, reference `dam_break_vof`, differs from the experiment \
     by 27, 19, -5 and -53 % at P1 to P4. The bound is this difference and, either way, 10 % of that \
     impulse and its uncertainty, which is 6, 5, 11 and 23 %.",
);
