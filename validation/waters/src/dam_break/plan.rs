//! The runs: both experiments over resolutions and variants with their gates, and what single studies need.

use super::{
    NAME, ablation, limitations,
    metrics::{self, FRONT, HEIGHT, IMPULSE, LEVELS},
    reference::{FRONT_SPREAD, IMPULSE_SPREAD, PEERS},
    specs::{JUDGED, OTHER_IMAGES, film, in_tank, martin_moyce, planned_free, planned_tank},
    stability::{self, Extreme},
};
use crate::water::{gate, ledger};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{MetricKey, MetricName},
};
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
    for variant in OTHER_IMAGES {
        for &n in martin_moyce(variant, tier) {
            let gates = invariants(&format!("{NAME}.martin-moyce.{variant}.{n}"));
            let gates = gates.into_iter().map(|gate| limitations::of_free(gate, variant, n));
            runs.push(planned_free(tier, variant, n).judged(gates.collect()));
        }
        for &n in in_tank(variant, tier) {
            let gates = invariants(&format!("{NAME}.lobovsky.{variant}.{n}"));
            let gates = gates.into_iter().map(|gate| limitations::in_tank(gate, variant, n));
            runs.push(planned_tank(tier, variant, n).judged(gates.collect()));
        }
    }
    runs.push(Planned::new(film(tier)));
    runs.push(planned_free(tier, "modern", stability::USUAL));
    runs.extend(stability::extremes(tier).map(Extreme::planned));
    if tier == Tier::Full {
        runs.extend(ablation::specs().map(|spec| Planned::new(spec).taking(3.0)));
        runs.extend(stability::SPEEDS.map(|c0| Planned::new(stability::at_speed(c0)).taking(2.0)));
    }
    runs
}

/// What holds whatever the water does.
fn invariants(id: &str) -> Vec<Gate> {
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
    let ends = "a run of water that does not reach its end says nothing of what comes then";
    let invariant =
        |metric: MetricKey, bound, because| gate(id, metric, bound, Evidence::Invariant, because);
    vec![
        invariant(metrics::REACHED, Bound::Above(1.0), ends),
        invariant(ledger::WORK_WALLS, Bound::Within(-0.05, 0.05), still),
        invariant(metrics::OUTSIDE, Bound::Equals(0.0), tight),
        invariant(metrics::MASS_ERROR, Bound::Equals(0.0), kept),
        invariant(ledger::ENERGY_GAP, Bound::Below(1e-3), closes),
        invariant(metrics::MOMENTUM_GAP, Bound::Below(0.01), momentum),
        gate(id, metrics::MACH, Bound::Below(0.3), Evidence::Theory, slow),
    ]
}

/// Gates of a column that runs out freely.
fn free_gates(variant: &str, n: usize) -> Vec<Gate> {
    let id = format!("{NAME}.martin-moyce.{variant}.{n}");
    let mut gates = invariants(&id);
    if n >= 20 {
        gates.extend(free_references(&id)); // coarser runs are for the order and the cost alone
    }
    gates.into_iter().map(|gate| limitations::of_free(gate, variant, n)).collect()
}

/// Those that compare it with Martin & Moyce and with other codes.
fn free_references(id: &str) -> Vec<Gate> {
    let reference =
        |metric: MetricName, bound, because| gate(id, metric, bound, Evidence::Reference, because);
    let peers = "three other codes agree within 0.04 that the front of two-dimensional water released at \
                 once is there; 0.1 is the spread of digitised curves of the experiment, which is slower";
    let front = "the spread of digitised curves of the experiment is 0.1 a";
    let late = "the diaphragm takes time to open and a film of real water sticks: the experiment is late, \
                by 0.175 as it is customary to assume, and by 0.25 against other codes; never early";
    let height = "stations of the height are 1/18 of the column apart";
    let clock = "a diaphragm that takes time to open can only delay: the height, as the front";
    let at = |(t, low, high): (f64, f64, f64)| {
        let bound = Bound::Within(low - FRONT_SPREAD, high + FRONT_SPREAD);
        reference(metrics::Z.at(t), bound, peers)
    };
    let of_experiment = [
        reference(FRONT.rms_shifted.into(), Bound::Below(FRONT_SPREAD), front),
        reference(FRONT.shift.into(), Bound::Within(0.0, 0.4), late),
        reference(HEIGHT.rms_shifted.into(), Bound::Below(1.0 / 18.0), height),
        reference(HEIGHT.shift.into(), Bound::Above(0.0), clock),
    ];
    PEERS.map(at).into_iter().chain(of_experiment).collect()
}

/// Gates of a column in the tank.
fn tank_gates(variant: &str, n: usize) -> Vec<Gate> {
    let id = format!("{NAME}.lobovsky.{variant}.{n}");
    let reference =
        |metric: MetricName, bound, because| gate(&id, metric, bound, Evidence::Reference, because);
    let front = "water of two series of the experiment arrives at H2, H3 and H4 up to 0.038 (H/g)^(1/2) \
                 apart, over 2^(1/2) the standard uncertainty of one; twice that at the measured speed of \
                 1.515 (g H)^(1/2) is 0.08 H";
    let levels = "twice the distance between two series of the experiment at H4 (rms 0.024 H)";
    let impulse = "two sensors at 15 mm, side by side in one event, differ by 6 % in this window, over \
                   2^(1/2) the standard uncertainty of one; twice that is 8.5 %, taken for the other \
                   heights too, for which none is known";
    let spread = 2.0 * IMPULSE_SPREAD / 2.0_f64.sqrt();
    let mut gates = invariants(&id);
    gates.push(reference(FRONT.rms_shifted.into(), Bound::Below(0.08), front));
    gates.push(reference(LEVELS.rms_shifted.into(), Bound::Below(0.05), levels));
    gates.extend(
        IMPULSE.map(|sensor| reference(sensor.at(1), Bound::Within(-spread, spread), impulse)),
    );
    gates.into_iter().map(|gate| limitations::in_tank(gate, variant, n)).collect()
}
