//! How far the collapse can be pushed: what counts as stable, the sound speed, and settings far outside of
//! the usual, each with what must come of it.

use super::{
    DAM_BREAK, DamSettings, NAME, declared,
    metrics::{DENSITY_LEAST, DENSITY_MOST, FRONT, MACH, OUTSIDE_END, REACHED, Z},
    specs,
};
use crate::{
    causes::{RATE_OF_DENSITY, SAMPLED},
    water::{
        gate,
        ledger::{ENERGY_GAP, WORK_VISCOSITY},
    },
};
use base::{
    gate::{Bound, Evidence},
    record::{Record, Status},
    spec::RunSpec,
};
use harness::{
    case::{Case, Planned, Tier},
    columns::Columns,
    runs::Runs,
    study::Study,
};
use report::{Cell, sig};

/// A run that ended, with the energy that it began with.
pub fn is_stable(record: &Record) -> bool {
    let is_below = |metric, most: f64| record.value(metric).is_some_and(|value| value < most);
    record.status == Status::Completed && is_below(ENERGY_GAP, 0.02) && is_below(MACH, 0.5)
}

/// Sound speeds \[(g H)^(1/2)\].
pub const SPEEDS: [f64; 5] = [5.0, 10.0, 20.0, 50.0, 100.0];

/// The column of Martin & Moyce with one of them.
pub fn at_speed(c0: f64) -> RunSpec {
    DAM_BREAK.spec("modern", |s| (s.n, s.c0) = (20, c0)).allow_unstable().measure_all()
}

/// The sound speed: Mach number, excursion of the density, front.
pub fn sound(runs: &Runs) -> Study {
    let caption = "Mach number, density and front of the column of Martin & Moyce over the sound speed c0, \
                   variant `modern`. The column has 20 spacings across, and artificial viscosity is \
                   proportional to c0.";
    let c0 = |record: &Record| record.settings_as::<DamSettings>().c0;
    let table = Columns::default()
        .of(["c0", "√(g H)"], c0, |value| Cell::num(value, 3))
        .ended()
        .number("Mach number", "-", MACH)
        .percent("density from", "-", DENSITY_LEAST, 1.0)
        .percent("to", "-", DENSITY_MOST, 1.0)
        .number("Z at T = 3", "a", Z.at(3))
        .number("rms of front after shift", "a", FRONT.rms_shifted)
        .percent("viscosity took", "M g H/2", WORK_VISCOSITY, -1.0)
        .steps()
        .table(caption, runs.records(SPEEDS.map(at_speed)));
    Study::new("dam-break-sound", "Sound speed").block(table)
}

/// Settings far outside of the usual.
pub struct Extreme {
    name: &'static str,
    spec: RunSpec,
    /// Must it keep water and energy? If not, it must diverge.
    holds: bool,
}

impl Extreme {
    /// The run with its gates.
    pub fn planned(self) -> Planned {
        let id = format!("{NAME}.extreme.{}", self.name.replace(' ', "-"));
        let stays = "Water in a tank stays in it.";
        let closes = "Pressure and the continuity equation (3) exchange energy exactly, and every other \
                      term reports its power. The bound of 1 % is for a coarse spacing and for sampling the \
                      powers.";
        let grows = "At twice the limit of the time step errors grow without bound, so the run must end as \
             diverged.";
        let judged =
            |metric, bound, because| gate(&id, metric, bound, Evidence::Invariant, because);
        let gates = if self.holds {
            let lost = judged(OUTSIDE_END, Bound::Equals(0.0), stays);
            let is_crowded = self.name == CROWDED;
            let lost = if is_crowded {
                lost.with_limitation(SLIPS, SLIP).because_of(&RATE_OF_DENSITY)
            } else {
                lost
            };
            let gap = judged(ENERGY_GAP, Bound::Below(0.01), closes);
            let gap = match self.name == SINGLE {
                true => gap.with_limitation(UNSEEN, IMPACTS).because_of(&SAMPLED),
                false => gap,
            };
            vec![lost, gap]
        } else {
            vec![judged(REACHED, Bound::Below(0.5), grows).even_if_diverged()]
        };
        Planned::new(self.spec).judged(gates)
    }
}

const SINGLE: &str = "a column one particle wide";
const UNSEEN: Bound = Bound::Below(0.034);
const IMPACTS: &str = "20 particles fall on each other one by one. Sampled after every step, the gap is \
                       0.0036, and 0.0010 with a quarter of the step. The bound is what a fourth run of the \
                       mean and scatter of three stays below with a probability of 97.5 % (Student's \
                       distribution, 2 degrees of freedom): with a half, a quarter and a twelfth of the \
                       step, 0.0215, 0.0155 and 0.0191.";
const CROWDED: &str = "water that starts on the surface of the walls";
const SLIPS: Bound = Bound::Within(0.0, 29.0);
const SLIP: &str = "Particles slip between those of the wall. The bound: the 29 particles of the lowest row \
                    and of the column at the back wall.";

/// Spacings along the width of the column with nothing extreme about it.
pub const USUAL: usize = 10;

/// All of them.
pub fn extremes(tier: Tier) -> impl Iterator<Item = Extreme> {
    type Row = (&'static str, fn(&mut DamSettings));
    let rows: [Row; 5] = [
        ("g x 1000", |s| (s.gravity, s.n) = (9810.0, 10)),
        (SINGLE, |s| (s.width, s.height, s.n, s.tank) = (0.01, 0.2, 1, 0.5)),
        ("a tank filled to the brim", |s| {
            (s.width, s.height, s.tank, s.rim, s.n) = (0.2, 0.1, 0.2, 1.0, 10);
        }),
        ("impact on a dry corner near by", |s| {
            (s.width, s.height, s.tank, s.n) = (0.1, 0.2, 0.13, 10);
        }),
        (CROWDED, |s| (s.n, s.offset) = (10, 0.5)),
    ];
    let mild = rows.into_iter().map(|(name, set)| Extreme {
        name,
        spec: DAM_BREAK.spec("modern", set).measure_all(),
        holds: true,
    });
    let rules = DAM_BREAK.rules(&specs::free(tier, "modern", USUAL));
    let limit = rules.ok().map(|rules| 2.0 * declared::theory(&rules));
    let spec = DAM_BREAK.spec("modern", |s| (s.n, s.dt) = (USUAL, limit)).allow_unstable();
    let spec = spec.measure_all();
    let beyond = Extreme { name: "dt at twice the limit", spec, holds: false };
    mild.chain([beyond])
}

/// What came of them.
pub fn extreme_settings(tier: Tier, runs: &Runs) -> Study {
    let caption = "The collapsing column, variant `modern`, with settings far outside of the usual, and \
                   what must come of each.";
    let all: Vec<Extreme> = extremes(tier).collect();
    let of = |record: &Record| all.iter().find(|extreme| extreme.spec.key() == record.key());
    let must = |holds: bool| if holds { "keep water and energy" } else { "end as diverged" };
    let table = Columns::default()
        .text("extreme", |record| of(record).map_or(String::new(), |of| of.name.into()))
        .changed("settings", &DAM_BREAK)
        .text("must", |record| of(record).map_or(String::new(), |of| must(of.holds).into()))
        .ended()
        .number("lost particles", "1", OUTSIDE_END)
        .metric(["energy not accounted for", "-"], ENERGY_GAP, |gap| Cell::sci(gap, 2))
        .table(caption, runs.records(all.iter().map(|extreme| extreme.spec.clone())));
    Study::new("dam-break-extremes", "Extremes").block(table).prose(scaling(tier, runs))
}

/// Gravity is a unit: the same collapse in units of (H/g)^(1/2).
fn scaling(tier: Tier, runs: &Runs) -> String {
    let z = |spec: &RunSpec| runs.record(spec).and_then(|record| record.value(Z.at(3)));
    let thousand = extremes(tier).next().and_then(|extreme| z(&extreme.spec));
    match z(&specs::free(tier, "modern", USUAL)).zip(thousand) {
        Some((one, thousand)) => format!(
            "Z at T = 3 is {} with g and {} with 1000 g: a relative difference of {}, which round-off makes.",
            sig(one, 6),
            sig(thousand, 6),
            sig((thousand / one - 1.0).abs(), 2)
        ),
        None => "Z at T = 3 was not measured with g and 1000 g.".into(),
    }
}
