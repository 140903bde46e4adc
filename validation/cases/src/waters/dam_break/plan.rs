//! The runs: both experiments over resolutions and variants, the ladder of resolutions, and the ensembles,
//! with their gates and known limitations.

use std::ops::RangeInclusive;

use touchstone_base::{gate::Cause, record::MetricName};
use touchstone_harness::prelude::*;
use touchstone_harness::table;

use super::{
    DAM_BREAK, DamSettings, lobovsky,
    metrics::{
        FRONT, FRONT_AWAY, FRONT_BACK, HEIGHT, HEIGHT_AWAY, IMPULSE, IMPULSE_AWAY, LEVEL_AWAY,
        LEVELS, MACH, MASS_ERROR, MOMENTUM_GAP, OUTSIDE, POTENTIAL_AWAY, REACHED, RELEASED,
        RINGING, Z,
    },
    reference::{FRONT_SPREAD, IMPULSE_SPREAD, PEERS, PeerFronts, WINDOWS},
};
use crate::waters::{
    causes::{
        DAMPED_SPLASH, FREE_SLIP, NO_SLIP_IMAGES, PRESSED_THROUGH, RINGS, TWO_DIMENSIONS,
        UNCERTAIN_REFERENCE, VISCOSITY, WIDE_KERNEL,
    },
    water::ledger::{ENERGY_GAP, WORK_WALLS},
};

/// Purpose of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Group {
    /// The column of Martin & Moyce, judged.
    Free,
    /// The tank of Lobovsky et al., judged.
    Tank,
    /// The column of Martin & Moyce over resolutions.
    Ladder,
    /// The tank of Lobovsky et al. from many starts.
    Ensemble,
}

/// The runs of this case in a tier.
pub type Table = table::Table<DamSettings, Group>;
/// A run of this case.
pub type Row = table::Row<DamSettings, Group>;

/// H/dx of the ensembles.
pub const ENSEMBLES: [usize; 2] = [20, 30];
/// Seeds of the members of an ensemble.
const SEEDS: RangeInclusive<u32> = 1..=20;
/// Their end \[(H/g)^(1/2)\]: the splash of the jet has run over all probes but the first.
pub const UNTIL: f64 = 8.0;

/// All runs of a tier. Spacings are fractions of the width of the column of Martin & Moyce, and of the height
/// of the column of Lobovsky et al.; successive ones of a ladder differ by about √2, and each fills the
/// column.
pub fn table(tier: Tier) -> table::Table<DamSettings, Group> {
    use Group::{Ensemble, Free, Ladder, Tank};
    let mut table = table::Table::new(&DAM_BREAK, tier);
    let across = |s: &mut DamSettings, n: usize| s.n = n;
    let along = |s: &mut DamSettings, n: usize| {
        lobovsky(s);
        s.n = n;
    };
    table.over(Free, &["seed", "ghosts"], [&[20], &[20]], across);
    table.over(Free, &["modern"], [&[20], &[20, 40, 80]], across);
    table.over(Tank, &["modern"], [&[30], &[30, 60, 120]], along);
    table.over(Free, &["ghosts-slip", "damped", "modern-sticking"], [&[], &[20]], across);
    table.over(Tank, &["damped"], [&[], &[30, 60]], along);
    let ladder: [&[usize]; 2] = [&[7, 10, 14, 20], &[10, 14, 20, 28, 40]];
    table.over(Ladder, &["seed", "modern"], ladder, across);
    for n in if tier == Tier::Quick { &[][..] } else { &ENSEMBLES } {
        for variant in ["modern", "seed"] {
            table.starts(Ensemble, variant, SEEDS, |s| {
                along(s, *n);
                s.end = UNTIL;
            });
        }
    }
    let finest = if tier == Tier::Quick { 30 } else { 120 };
    table.keep_particles(|row| row.group == Tank && row.settings.n == finest);
    for row in &mut table.rows {
        row.run.spec.allow_unstable = row.variant == "ghosts";
    }
    table.judge(gates);
    table
}

/// The gates of a run.
fn gates(row: &Row) -> Vec<Gate> {
    let DamSettings { width, height, n, .. } = row.settings;
    let scene = match row.group {
        Group::Free => "martin-moyce",
        Group::Tank => "lobovsky",
        Group::Ladder | Group::Ensemble => return Vec::new(),
    };
    let gates = &DAM_BREAK.gates(format!("{scene}.{}.{n}", row.variant));
    let mut all = invariants(gates, width.min(height) / (n as f64 * height));
    match (row.group, row.variant) {
        (Group::Tank, _) => {
            all.extend([tank_references(gates), tank_model(gates), tank_rings(gates)].concat());
        }
        (_, "modern") => all.extend([free_references(gates), free_model(gates, n)].concat()),
        (_, "seed") => {
            all.extend(free_references(gates));
            all.push(potential(gates, FREE_POTENTIAL));
        }
        // Which of its jets hit a wall between two samples of the force is chance.
        (_, "ghosts") => all.retain(|gate| gate.metric != String::from(MOMENTUM_GAP)),
        _ => {}
    }
    let known = known(row);
    let limited = |gate: Gate| match known.iter().find(|known| known.0.name == gate.metric) {
        Some((_, to, (cause, reason))) => {
            let bound = widened(gate.bound, *to);
            let gate = gate.with_limitation(bound, *reason, cause);
            // These two follow from the reference by volume of fluid, the others from runs.
            let is_of_reference = [AHEAD.1, FAST.1].contains(reason);
            if is_of_reference { gate } else { gate.fitted() }
        }
        None => gate,
    };
    all.into_iter().map(limited).collect()
}

/// A bound that reaches to a value outside of it.
fn widened(bound: Bound, to: f64) -> Bound {
    match bound {
        Bound::Within(low, high) => Bound::Within(low.min(to), high.max(to)),
        Bound::Equals(value) => Bound::Within(value.min(to), value.max(to)),
        Bound::Below(_) => Bound::Below(to),
        Bound::Above(_) => Bound::Above(to),
    }
}

/// Gates that hold for any motion of the water. Walls made only of images with other velocities have no other
/// gates: neither is the wall of the experiment.
fn invariants(gates: &RunGates, dx: f64) -> Vec<Gate> {
    let tight = "No particle may pass a wall, whose surface lies half a spacing before its first particles.";
    let kept = "Particles keep their masses, and none is added or removed.";
    let closes =
        "Each term reports its power: only errors of the time step and of sampling it remain.";
    let momentum =
        "Only walls and gravity change momentum: the error of sampling the force remains.";
    let slow =
        "Above Mach 0.3 the density changes by 5 %, and water is no longer nearly incompressible.";
    let still = "Walls at rest do no work. The bound allows for the energy that their pressure stores and \
                 returns.";
    let ends = "A run that ends early has no later results.";
    let filled = "The column is H high, so its centre is at H/2. Its lowest row is half a spacing to a \
                  whole one above the wall, a difference of up to dx/2.";
    // The small compressibility of water is not a theory of a method.
    let of_water =
        |metric, bound, because| gates.theory(metric, bound, because).of_others(bound, because);
    vec![
        of_water(RELEASED, Bound::magnitude(dx), filled),
        gates.invariant(REACHED, Bound::Above(1.0), ends),
        gates.invariant(WORK_WALLS, Bound::magnitude(0.05), still),
        gates.invariant(OUTSIDE, Bound::Equals(0.0), tight),
        gates.invariant(MASS_ERROR, Bound::Equals(0.0), kept),
        gates.invariant(ENERGY_GAP, Bound::Below(1e-3), closes),
        gates.invariant(MOMENTUM_GAP, Bound::Below(0.01), momentum),
        of_water(MACH, Bound::Below(0.3), slow),
    ]
}

/// Gates of a column that runs out freely: Martin & Moyce and other codes.
fn free_references(gates: &RunGates) -> Vec<Gate> {
    let peers = "Three other codes agree within 0.04 on this place. The bound adds 0.1, the spread of \
                 digitised curves of the experiment, which is slower.";
    let front = "The spread of digitised curves of the experiment is 0.1 a.";
    let late = "The experiment can only be late, because the diaphragm takes time to open and a film of \
                real water adheres. Its delay is 0.25 against other codes.";
    let height = "The height is measured at stations that are 1/18 of the column apart.";
    let clock =
        "A diaphragm that takes time to open can only delay the height, as it delays the front.";
    let place = |PeerFronts { time, least, most }| {
        let bound = Bound::Within(least - FRONT_SPREAD, most + FRONT_SPREAD);
        gates.reference(Z.at(time), bound, peers)
    };
    let [second, third] = PEERS.map(place);
    vec![
        second,
        third,
        gates.reference(FRONT.rms_shifted, Bound::Below(FRONT_SPREAD), front),
        gates.reference(FRONT.shift, Bound::Within(0.0, 0.4), late),
        gates.reference(HEIGHT.rms_shifted, Bound::Below(1.0 / 18.0), height),
        gates.reference(HEIGHT.shift, Bound::Above(0.0), clock),
        runs_out(gates),
    ]
}

/// The gate on a front that falls back.
fn runs_out(gates: &RunGates) -> Gate {
    let because = "Water that spreads over a dry floor never flows back. The bound of 0.1 a is the spread \
                   of digitised curves of a front.";
    gates.invariant(FRONT_BACK, Bound::Below(FRONT_SPREAD), because)
}

/// Bound of the potential energy of the column of Martin & Moyce \[M g H/2\].
const FREE_POTENTIAL: f64 = 0.003;

/// The gate on the potential energy, which depends on heights and gravity.
fn potential(gates: &RunGates, most: f64) -> Gate {
    let because = "By the slope of the curve by volume of fluid, which is known to 0.003 M g H/2, in the \
                   tank to 0.0012, 3 % of gravity moves it by 0.0060 and 0.0039, rms. The bound is half of \
                   this, so that either sign of it is outside.";
    gates.reference(POTENTIAL_AWAY, Bound::Below(most), because)
}

/// Gates of the method on the column of Martin & Moyce: the same model by volume of fluid.
fn free_model(gates: &RunGates, n: usize) -> Vec<Gate> {
    let front =
        "By volume of fluid the front is known to 0.008 a, a being the width of the column.";
    let height =
        "The bound is 1 % of the column. By volume of fluid the height is known to 0.003 H.";
    let height = gates.reference(HEIGHT_AWAY, Bound::Below(0.01), height);
    let mut all = vec![height, potential(gates, FREE_POTENTIAL)];
    if n >= 40 {
        all.push(gates.reference(FRONT_AWAY.at(2), Bound::magnitude(0.02), front));
    }
    all
}

/// Gates of a column in the tank: Lobovsky et al.
fn tank_references(gates: &RunGates) -> Vec<Gate> {
    let front = "Water arrives up to 0.038 √(H/g) apart in two series of the experiment, which is √2 times \
                 the standard uncertainty of one. Twice this at the measured speed of 1.515 √(g H) is 0.08 \
                 H.";
    let levels =
        "The bound is twice the rms distance of two series of the experiment at H4, 0.024 H.";
    let impulse = "Two sensors side by side at 15 mm differ by 6 %, which is √2 times the standard \
                   uncertainty of one. The bound is twice this, 8.5 %, also at the other heights.";
    let model = "By volume of fluid this model differs from the experiment by 26, 17, -7 and -60 % at P1 to \
                 P4. The bound adds, either way, 10 % of that impulse, 9 % at P2, and its uncertainty, which \
                 is 3, 3, 2 and 18 %.";
    let of_model = [(0.257, 0.13), (0.173, 0.12), (-0.074, 0.12), (-0.600, 0.28)];
    let impulses = IMPULSE.into_iter().zip(of_model).map(|(sensor, (away, share))| {
        let gate = gates.reference(sensor.at(1), Bound::magnitude(2.0 * IMPULSE_SPREAD), impulse);
        let of = |share: f64| (1.0 + away) * (1.0 + share) - 1.0;
        gate.with_limitation(Bound::Within(of(-share), of(share)), model, &TWO_DIMENSIONS)
    });
    let front = gates.reference(FRONT.rms_shifted, Bound::Below(0.08), front);
    let levels = gates.reference(LEVELS.rms_shifted, Bound::Below(0.05), levels);
    [front, levels, runs_out(gates)].into_iter().chain(impulses).collect()
}

/// Gates of the method on the column of Lobovsky et al.: the same model by volume of fluid.
fn tank_model(gates: &RunGates) -> Vec<Gate> {
    let level = "The bound is 1 % of the column. By volume of fluid these levels differ by 0.003 to 0.006 \
                 H, rms, between cells of 5 and 2.5 mm.";
    let impulse = "The bound is 10 % of the impulse. By volume of fluid it is known to 3, 3, 2 and 18 % at \
                   P1 to P4 during 1 √(H/g), and to 2, 2, 3 and 5 % during 2.5.";
    let uncertain = "The impulse by volume of fluid is 0.116 ± 0.021 ρ g H √(H/g), 0.131 with twice the \
                     step, of first order 0.101 without a step. These runs have 0.104, 0.103 and 0.102 at \
                     H/dx 30, 60 and 120. The bound adds this uncertainty, 18 %, to 10 %.";
    let mut all: Vec<Gate> =
        LEVEL_AWAY.map(|away| gates.reference(away, Bound::Below(0.01), level)).into();
    for (window, k) in WINDOWS.into_iter().flat_map(|window| (0..4).map(move |k| (window, k))) {
        let tenth = Bound::magnitude(0.1);
        let gate = gates.reference(IMPULSE_AWAY[k].at(window), tenth, impulse);
        all.push(match (window, k) {
            // Only a thin jet reaches the uppermost sensor during the first window.
            (1.0, 3) => {
                gate.with_limitation(Bound::magnitude(0.28), uncertain, &UNCERTAIN_REFERENCE)
            }
            _ => gate,
        });
    }
    all.push(potential(gates, 0.0019));
    all
}

/// Gates on the ringing of the pressure.
fn tank_rings(gates: &RunGates) -> Vec<Gate> {
    let because = "Once the jet has struck, the pressure changes within 0.5 √(H/g) by 0.018 to 0.036 ρ g H \
        in the experiment and by 0.011 to 0.020 by volume of fluid, rms.";
    RINGING.map(|ringing| gates.reference(ringing, Bound::Below(0.04), because)).into()
}

/// Why a gate has a wider bound, and where that comes from.
type Why = (&'static Cause, &'static str);

/// The metrics of a run with known limitations of their gates, their size, and the reason.
fn known(row: &Row) -> Vec<(MetricName, f64, Why)> {
    let [z2, z3] = PEERS.map(|of| Z.at(of.time));
    match (row.group, row.variant) {
        (Group::Free, "seed") => vec![
            (z2, 2.35, THICK),
            (z3, 3.51, THICK),
            (FRONT.shift.into(), -0.05, THICK),
            (HEIGHT.shift.into(), -0.11, LAYER),
            (POTENTIAL_AWAY.into(), 0.0263, THICK),
        ],
        (Group::Free, "ghosts") => vec![
            (OUTSIDE.into(), 5.0, CROSSED),
            (WORK_WALLS.into(), 0.96, MIRRORED),
            (ENERGY_GAP.into(), 0.046, MIRRORED),
            (MACH.into(), 0.60, MIRRORED),
        ],
        (Group::Free, "modern") if row.settings.n > 40 => vec![(z3, 4.125, AHEAD)],
        (Group::Tank, "modern") => {
            let rings = RINGING.map(|ringing| (ringing.into(), 0.35, RINGING_AS_EVER));
            [vec![(FRONT.rms_shifted.into(), 0.14, FAST)], rings.into()].concat()
        }
        (Group::Tank, "damped") => {
            let rings = RINGING.map(|ringing| (ringing.into(), 0.1, RINGING_LESS));
            let others = vec![
                (FRONT.rms_shifted.into(), 0.14, FAST),
                (OUTSIDE.into(), 3.0, SPLASHED),
                (MOMENTUM_GAP.into(), 0.015, SPLASHED),
                (POTENTIAL_AWAY.into(), 0.003, WIDE),
            ];
            [others, rings.into()].concat()
        }
        _ => Vec::new(),
    }
}

const MIRRORED: Why = (
    &NO_SLIP_IMAGES,
    "Such runs are chaotic: in ten, at a/dx = 10, 14, 17 to 22, 24 and 28, the walls do work of 0.57 M g \
     H/2 on the water, with a scatter of 0.16, and energy is off by 0.016 with a scatter of 0.013. The \
     bounds of both are the limits below which a further run of that mean and scatter stays with a \
     probability of 97.5 % (Student's distribution, 9 degrees of freedom), and that of the Mach number is \
     its largest in the tank.",
);
const CROSSED: Why = (
    &PRESSED_THROUGH,
    "The lowest row of a layer that is stretched sinks into the plane of the floor, and feels no force \
     across it there. Walls along which water slips put such a particle back; behind them 5 were lost in the \
     tank before they did, which is the bound.",
);
const AHEAD: Why = (
    &FREE_SLIP,
    "By volume of fluid Z is 4.081 ± 0.024 at T = 3. The bound adds 0.02 a, by which a front may differ \
     from it. `modern-sticking`, whose viscosity sees the walls, has 3.98 at a/dx = 80, as those codes do.",
);
const THICK: Why = (
    &VISCOSITY,
    "The bounds are the results of `modern-sticking` at a/dx = 20 with 1.4 times the artificial viscosity \
     of this run, by a sound speed of 100 √(g H).",
);
const LAYER: Why = (
    &VISCOSITY,
    "Particles next to the back wall lag in proportion to artificial viscosity: the shift is -0.053 with \
     half of alpha and -0.187 with twice the sound speed, which in proportion is -0.106 and -0.094 with the \
     viscosity of this run.",
);
const FAST: Why = (
    &TWO_DIMENSIONS,
    "The front runs at 1.70, 1.74 and 1.76 √(g H) at H/dx = 30, 60 and 120, at 1.515 in the experiment, and \
     at 1.761 ± 0.014 by volume of fluid, whose front is 0.119 H from the experiment after its best shift. \
     The bound adds 0.02 H, by which a front may differ from that one.",
);
const RINGING_AS_EVER: Why =
    (&RINGS, "0.30, 0.27, 0.23 and 0.10 at P1 to P4 with H/dx = 30. The bound adds a sixth.");
const RINGING_LESS: Why =
    (&RINGS, "The bound is a third of what `modern` has at P1 with as many spacings, 0.30.");
const SPLASHED: Why = (
    &DAMPED_SPLASH,
    "At H/dx = 30 one or two particles are behind a surface at some time with sound speeds of 14, 20 and 28 \
     √(g H), at 60 three; the gap is 0.0105 to 0.0146 and 0.003. Without the damper it is at most 0.0007.",
);
const WIDE: Why = (
    &WIDE_KERNEL,
    "`modern` with h/dx 2 has 0.0022, 0.0025 and 0.0029 with sound speeds of 14, 20 and 28 √(g H).",
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::waters::dam_break::DAM_BREAK;
    use touchstone_base::{
        mutation::{Constant, Mutation},
        spec::{Measure, RunSpec},
    };
    use touchstone_harness::{case::Case, context::Context, plan, runs::JudgedRun};

    /// Gravity that was 3 % too large passed all gates that read particles.
    #[test]
    fn gravity_that_is_3_percent_off_fails_the_gate_on_the_potential_energy() {
        let table = table(Tier::Quick);
        for group in [Group::Free, Group::Tank] {
            let row = table.of(group).find(|row| row.variant == "modern").expect("a run");
            let mut gates = row.run.gates.iter();
            let gate = gates.find(|gate| gate.metric == String::from(POTENTIAL_AWAY));
            let gate = gate.expect("a gate on the potential energy");
            for (factor, is_failure) in [(1.0, false), (0.97, true), (1.03, true)] {
                let mut spec = row.run.spec.clone();
                (spec.measure, spec.mutation) =
                    (Measure::Headline, Some(Mutation { of: Constant::BodyForce, factor }));
                spec.keep = RunSpec::default().keep;
                let record = DAM_BREAK.run(&spec, &Context::default()).expect("a run");
                let judged = gate.judge_record(&record);
                assert_eq!(
                    judged.verdict.is_failure(),
                    is_failure,
                    "{group:?}, {factor}: {judged:?}"
                );
            }
        }
    }

    /// The measured metrics of a run follow from its gates, and a gate on a metric that was not measured
    /// fails.
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
        let ladder = DAM_BREAK.spec("modern", |s| s.n = 10);
        assert_eq!(of(&ladder).spec.measure, Measure::Headline);
        let table = table(Tier::Quick);
        let row = table.of(Group::Free).find(|row| row.variant == "modern");
        let run = of(&row.expect("a judged column").run.spec);
        let failed = |spec: RunSpec| {
            let record = DAM_BREAK.run(&spec, &Context::default()).expect("a run");
            let judged = JudgedRun::new(run.clone(), record).judged;
            judged.into_iter().filter(|j| j.judgement.verdict.is_failure()).count()
        };
        assert_eq!(failed(run.spec.clone()), 0);
        assert_eq!(failed(RunSpec { measure: Measure::Headline, ..run.spec.clone() }), 3);
    }
}
