//! The runs: both experiments over resolutions and variants with their gates, and what single studies need.

use super::{
    NAME, ablation, limitations,
    metrics::{self, FRONT, HEIGHT, IMPULSE, LEVELS},
    reference::{FRONT_SPREAD, IMPULSE_SPREAD, PEERS},
    specs::{JUDGED, OTHER_IMAGES, film, in_tank, martin_moyce, planned_free, planned_tank},
    stability::{self, Extreme},
    volume_of_fluid,
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
            let gates = gates.into_iter().map(|gate| limitations::in_tank(gate, variant));
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
    let tight = "No particle may pass a wall. A splash may dent a wall of particles by half a spacing, \
                 because its surface lies that far before the first of them.";
    let kept = "Particles keep their masses, and none is added or removed.";
    let closes = "Pressure and the continuity equation (3) exchange energy exactly, and each other term \
                  reports its power. Only errors of the time step and of sampling the powers remain.";
    let momentum = "The momentum of the water is what walls and gravity give it. Only the error of sampling \
                    the force remains.";
    let slow = "Above Mach 0.3 the density changes by 5 % and the speed of sound by a sixth, and the flow \
                is no longer that of nearly incompressible water.";
    let still = "Walls at rest do no work. The bound of 5 % is for the energy that their pressure stores \
                 and gives back.";
    let ends = "A run that ends early says nothing about what comes later.";
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
        if variant == "modern" {
            gates.extend(volume_of_fluid::free_gates(&id, n));
        }
    }
    gates.into_iter().map(|gate| limitations::of_free(gate, variant, n)).collect()
}

/// Those that compare it with Martin & Moyce and with other codes.
fn free_references(id: &str) -> Vec<Gate> {
    let reference =
        |metric: MetricName, bound, because| gate(id, metric, bound, Evidence::Reference, because);
    let peers = "Three other codes agree within 0.04 on this place of the front of two-dimensional water \
                 that is released at once. The bound adds 0.1, the spread of digitised curves of the \
                 experiment, which is slower.";
    let front = "The spread of digitised curves of the experiment is 0.1 a.";
    let late = "The experiment is late and never early, because the diaphragm takes time to open and a film \
                of real water sticks. Its delay is usually assumed to be 0.175, and is 0.25 against other \
                codes.";
    let height = "The height is measured at stations that are 1/18 of the column apart.";
    let clock =
        "A diaphragm that takes time to open can only delay the height, as it delays the front.";
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
    let front = "In two series of the experiment, water arrives at H2, H3 and H4 up to 0.038 √(H/g) apart, \
                 which is √2 times the standard uncertainty of one series. Twice this uncertainty at the \
                 measured speed of 1.515 √(g H) is 0.08 H.";
    let levels =
        "The bound is twice the rms distance of two series of the experiment at H4, 0.024 H.";
    let impulse = "Two sensors side by side at 15 mm differ by 6 % in one event in this window, which is √2 \
                   times the standard uncertainty of one. The bound is twice this uncertainty, 8.5 %, for \
                   the other heights too, where none is known.";
    let spread = 2.0 * IMPULSE_SPREAD / 2.0_f64.sqrt();
    let mut gates = invariants(&id);
    gates.push(reference(FRONT.rms_shifted.into(), Bound::Below(0.08), front));
    gates.push(reference(LEVELS.rms_shifted.into(), Bound::Below(0.05), levels));
    if variant == "modern" {
        gates.extend(volume_of_fluid::tank_gates(&id));
    }
    gates.extend(
        IMPULSE.map(|sensor| reference(sensor.at(1), Bound::Within(-spread, spread), impulse)),
    );
    gates.into_iter().map(|gate| limitations::in_tank(gate, variant)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dam_break::DAM_BREAK;
    use base::spec::{Measure, RunSpec};
    use harness::{case::Case, context::Context, plan, runs::JudgedRun};

    /// The need of a run follows from its gates, and a gate on what was not asked for fails.
    #[test]
    fn what_gates_read_is_measured_and_nothing_else_that_is_costly() {
        let planned = plan::of_case(&DAM_BREAK, Tier::Quick);
        let of = |spec: &RunSpec| {
            let run = planned.iter().find(|planned| planned.spec.key() == spec.key());
            run.expect("a planned run").clone()
        };
        let is_costly =
            |gate: &Gate| super::super::run::COSTLY.iter().any(|m| gate.metric == String::from(*m));
        for run in planned.iter().filter(|run| run.gates.iter().any(is_costly)) {
            assert_eq!(run.spec.measure, Measure::All, "{:?}", run.spec);
        }
        let coarse = stability::USUAL;
        for spec in [film(Tier::Quick), planned_free(Tier::Quick, "modern", coarse).spec] {
            assert_eq!(of(&spec).spec.measure, Measure::Headline, "{spec:?}");
        }
        let extreme = stability::extremes(Tier::Quick).nth(1).expect("a column one particle wide");
        let run = of(&extreme.planned().spec);
        let failed = |spec: RunSpec| {
            let record = DAM_BREAK.run(&spec, &Context::default()).expect("a run");
            let judged = JudgedRun::new(run.clone(), record).judged;
            judged.into_iter().filter(|j| j.judgement.verdict.is_failure()).count()
        };
        assert_eq!(failed(run.spec.clone()), 0);
        assert_eq!(failed(RunSpec { measure: Measure::Headline, ..run.spec.clone() }), 1);
    }
}
