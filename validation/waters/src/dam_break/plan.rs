//! The runs: both experiments over resolutions and variants with their gates, and what single studies need.

use super::{
    NAME, ablation,
    metrics::{self, FRONT, HEIGHT, IMPULSE, LEVELS},
    reference::{FRONT_SPREAD, IMPULSE_SPREAD, PEERS},
    specs::{JUDGED, film, in_tank, martin_moyce, planned_free, planned_tank},
    stability,
};
use crate::water::{gate, ledger};
use base::gate::{Bound, Evidence, Gate, Purpose};
use harness::case::{Planned, Tier};

/// The runs: Martin & Moyce variant by variant, then Lobovsky et al., then those of single studies.
pub fn plan(tier: Tier) -> Vec<Planned> {
    let mut runs = Vec::new();
    for variant in JUDGED {
        for &n in martin_moyce(variant, tier) {
            runs.push(planned_free(tier, variant, n).judged(free_gates(variant, n)));
        }
    }
    for variant in JUDGED {
        for &n in in_tank(variant, tier) {
            runs.push(planned_tank(tier, variant, n).judged(tank_gates(variant, n)));
        }
    }
    runs.push(Planned::new(film(tier)));
    runs.push(planned_free(tier, "modern", stability::USUAL));
    runs.extend(stability::extremes(tier).map(|extreme| Planned::new(extreme.spec)));
    if tier == Tier::Full {
        runs.extend(ablation::specs().map(|spec| Planned::new(spec).taking(3.0)));
        runs.extend(stability::SPEEDS.map(|c0| Planned::new(stability::at_speed(c0)).taking(2.0)));
    }
    runs
}

/// What holds whatever the water does.
fn invariants(variant: &str, id: &str) -> Vec<Gate> {
    let tight = "a wall that lets water through is none; a splash may dent one of particles, whose surface \
                 lies half a spacing before the first of them: beyond that it is through";
    let kept = "particles keep their masses, and none comes or goes";
    let closes = "pressure and (3) exchange energy exactly, and each other term reports its power: what is \
                  left is the time step and the sampling of the powers";
    let momentum =
        "what walls and gravity give is what the water has; the rest is sampling the force";
    let slow = "weakly compressible: Mach 0.3, beyond which density changes by 5 % and the speed of sound \
                by a sixth, is no water";
    let still =
        "walls that stand still do no work; 5 % is for what their pressure stores and gives back";
    let gates = vec![
        gate(id, ledger::WORK_WALLS, Bound::Within(-0.05, 0.05), Evidence::Invariant, still),
        gate(id, metrics::OUTSIDE, Bound::Equals(0.0), Evidence::Invariant, tight),
        gate(id, metrics::MASS_ERROR, Bound::Equals(0.0), Evidence::Invariant, kept),
        gate(id, ledger::ENERGY_GAP, Bound::Below(1e-3), Evidence::Invariant, closes),
        gate(id, metrics::MOMENTUM_GAP, Bound::Below(0.01), Evidence::Invariant, momentum),
        gate(id, metrics::MACH, Bound::Below(0.3), Evidence::Theory, slow),
    ];
    match variant {
        "ghosts" => gates.into_iter().map(mirrored).collect(),
        _ => gates,
    }
}

fn mirrored(gate: Gate) -> Gate {
    let reason = match gate.metric.as_str() {
        "mass_error" => return gate.even_if_diverged(),
        "outside" => CROSSED,
        _ => MIRRORED,
    };
    gate.with_limitation(reason).even_if_diverged()
}

const MIRRORED: &str = "ghosts carry the opposite velocity, as the paper has it, along the wall too: along a \
                        wall that water runs past they double the difference that (3) sums, and in \
                        disorder that is noise of the density, which does work. `ghosts-slip`, which \
                        differs in that alone, ends the run, and its walls do none (1e-17) until a particle \
                        has crossed one";
const CROSSED: &str = "in the plane of a ghost wall the water and its images push a particle alike from both \
                       sides, and its own image not at all: pressed that near, it may cross, with \
                       `ghosts-slip` too";
const THICK: &str = "artificial viscosity takes 37 to 48 % of the energy at these resolutions, so the front \
                     is later than the diaphragm made it";
const SPENT: &str = "artificial viscosity takes 73 % of the energy until the end, so what reaches the far \
                     wall is late, at 3.04 instead of 2.44, and slow";
const TENSION: &str = "the impulse is negative, a net tension: what little water comes to 80 mm has lost \
                       density there, and nothing cuts the equation of state at 0; and it comes late and \
                       slow, for artificial viscosity takes 73 % of the energy";

const LAYER: &str = "particles next to the back wall lag, in a layer of a few spacings that at a/dx 20 \
                     reaches the probe at 0.2 a: at tau 2.45 the height over 2a is 0.10 more than measured \
                     there, 0.05 at 0.3 a and 0.02 at 0.5 a; at a/dx 40 0.05, 0.03 and 0.01. One \
                     run each at 20: alpha 0.05 instead of 0.1 halves the shift, -0.09 to -0.05, so \
                     artificial viscosity has a part in it; without artificial stress it stays";

/// Gates of a column that runs out freely.
fn free_gates(variant: &str, n: usize) -> Vec<Gate> {
    let id = format!("{NAME}.martin-moyce.{variant}.{n}");
    let mut gates = invariants(variant, &id);
    if n < 20 {
        return gates; // for the order and the cost alone
    }
    let peers = "three other codes agree within 0.04 that the front of two-dimensional water released at \
                 once is there; 0.1 is the spread of digitised curves of the experiment, which is slower";
    for (t, low, high) in PEERS {
        let bound = Bound::Within(low - FRONT_SPREAD, high + FRONT_SPREAD);
        let gate = gate(&id, metrics::Z.at(t), bound, Evidence::Reference, peers);
        gates.push(if n < 40 { gate.reported() } else { gate });
    }
    let front = "the spread of digitised curves of the experiment is 0.1 a";
    let bound = Bound::Below(FRONT_SPREAD);
    gates.push(gate(&id, FRONT.rms_shifted, bound, Evidence::Reference, front));
    let late = "the diaphragm takes time to open and a film of real water sticks: the experiment is late, \
                by 0.175 as it is customary to assume, and by 0.25 against other codes; never early";
    gates.push(gate(&id, FRONT.shift, Bound::Within(0.0, 0.4), Evidence::Reference, late));
    let height = "stations of the height are 1/18 of the column apart";
    let bound = Bound::Below(1.0 / 18.0);
    gates.push(gate(&id, HEIGHT.rms_shifted, bound, Evidence::Reference, height));
    let clock = "a diaphragm that takes time to open can only delay: the height, as the front";
    gates.push(gate(&id, HEIGHT.shift, Bound::Above(0.0), Evidence::Reference, clock));
    let limited = |gate: Gate| match (variant, gate.evidence, gate.metric.as_str()) {
        ("ghosts", Evidence::Reference, _) => gate.when_measured().with_limitation(MIRRORED),
        ("seed", Evidence::Reference, "height_shift") => gate.with_limitation(LAYER),
        ("seed", Evidence::Reference, "front_shift" | "z@2" | "z@3")
            if gate.purpose == Purpose::Judge =>
        {
            gate.with_limitation(THICK)
        }
        _ => gate,
    };
    gates.into_iter().map(limited).collect()
}

/// Gates of a column in the tank.
fn tank_gates(variant: &str, n: usize) -> Vec<Gate> {
    let id = format!("{NAME}.lobovsky.{variant}.{n}");
    let mut gates = invariants(variant, &id);
    let front = "3 % of the way to the far wall; what the gate adds is not known, and a shift of the clock \
                 takes out only a part of it";
    gates.push(gate(&id, FRONT.rms_shifted, Bound::Below(0.1), Evidence::Reference, front));
    let levels = "twice the distance between two series of the experiment at H4 (rms 0.024 H)";
    gates.push(gate(&id, LEVELS.rms_shifted, Bound::Below(0.05), Evidence::Reference, levels));
    let impulse = "two sensors at 15 mm, side by side in one event, differ by 6 % in this window: the spread \
                   of two places in one event, that of P2, taken for the other heights too, for which none \
                   is known; three times that";
    for (k, sensor) in IMPULSE.into_iter().enumerate() {
        let bound = Bound::Within(-3.0 * IMPULSE_SPREAD, 3.0 * IMPULSE_SPREAD);
        let gate = gate(&id, sensor.at(1), bound, Evidence::Reference, impulse);
        let is_high = k >= 2;
        gates.push(if is_high { gate.with_limitation(TONGUE) } else { gate });
    }
    let limited = |gate: Gate| match (variant, &gate.purpose, gate.evidence) {
        ("ghosts", _, Evidence::Reference) => gate.when_measured().with_limitation(MIRRORED),
        ("seed", _, Evidence::Reference) if gate.metric == "impulse_P4@1" => {
            gate.with_limitation(TENSION)
        }
        ("seed", _, Evidence::Reference) if gate.metric.starts_with("impulse") => {
            gate.with_limitation(SPENT)
        }
        _ => gate,
    };
    gates.into_iter().map(limited).collect()
}

const TONGUE: &str = "the tongue that reaches the far wall is 9 to 14 % thinner than measured (metric \
                      `tongue`), so what presses at 30 mm, near its upper side, is weaker, and what presses \
                      at 80 mm, above it, later: by the same at H/dx 60 and 120, and particles within 12 mm \
                      have the pressure that is read, so it is neither the spacing nor the sensor. What the \
                      water of the experiment has beside it is a gate, friction on the floor and a third \
                      dimension. At 15 mm it is 6 and 17 % weaker at 60 and 120, within the bound. At 30 a \
                      support of 30 mm mixes in the pressure at the floor, which hides it at P3, and at P2, \
                      where 0.2 % is a cancellation";
