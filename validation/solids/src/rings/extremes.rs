//! Rubber that is a hundred times stiffer, very fast, at rest for long, or in two places at once.

use super::{
    RUBBER_RINGS, RingSettings,
    metrics::{HEIGHT_MAX, MOMENTUM, PIECES_MOST, WIDTH_MIN},
};
use crate::solid::largest;
use base::{
    gate::{Bound, Evidence},
    record::{Record, Status},
    spec::RunSpec,
};
use harness::{
    case::{Planned, Tier},
    extremes::{self, Entry},
    runs::Runs,
    study::Study,
};
use report::sci;

/// The runs.
pub fn plan(tier: Tier) -> Vec<Planned> {
    let [rest, flight] = STILL.map(|still| still.spec(tier));
    [of_stiffness(1.0), of_stiffness(100.0), fast_spec(), rest, flight, overlapping_spec()]
        .map(Planned::new)
        .into()
}

/// The study.
pub fn study(tier: Tier, runs: &Runs) -> Study {
    let mut entries = vec![stiffer(runs), fast(runs)];
    entries.extend(STILL.map(|still| still.entry(tier, runs)));
    entries.push(overlapping(runs));
    let lead = "No run may hang or crash, and a run that leaves its bounds must end as diverged, with \
                step, time, particle and quantity.";
    extremes::study("rubber-rings-extremes", "Extremes of rubber", lead, entries)
}

fn of_stiffness(bulk_modulus: f64) -> RunSpec {
    let set = |s: &mut RingSettings| {
        (s.spacing, s.end, s.bulk_modulus) = (0.33, 80.0, bulk_modulus);
    };
    RUBBER_RINGS.spec("leapfrog", set)
}

/// K and μ times 100: the same motion in units of L/c₀.
fn stiffer(runs: &Runs) -> Entry {
    let entry = Entry::new(
        "rings.stiffer",
        ["rings a hundred times stiffer", "K = 1 and K = 100, 3 layers, t = 80 L/c0"]
            .map(String::from),
        "distance [L, c0]",
        Bound::Below(1e-10),
    )
    .because(
        Evidence::Invariant,
        "Only K has a unit of stress, so motion in units of L and c0 must be the same, except for \
         round-off.",
    );
    let [soft, stiff] = [1.0, 100.0].map(|k| runs.completed(&of_stiffness(k)));
    let Some((soft, stiff)) = soft.zip(stiff) else { return entry };
    let (worst, steps) = (distance(soft, stiff), soft.cost.steps);
    entry.found(worst, format!("{} after {steps} steps and a collision", sci(worst, 3)))
}

/// Largest difference of centre, velocity and extents at any sample; infinite if samples differ.
fn distance(a: &Record, b: &Record) -> f64 {
    let names = ["t", "x_c", "v_c", "width", "height"];
    let worst = names.into_iter().map(|name| {
        let [a, b] = [a, b].map(|record| record.column("series", name));
        let same = a.len() == b.len() && a.len() > 10;
        let gaps = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        if same { gaps.fold(0.0, f64::max) } else { f64::INFINITY }
    });
    worst.fold(0.0, f64::max)
}

fn fast_spec() -> RunSpec {
    RUBBER_RINGS.spec("seed", |s| (s.spacing, s.speed, s.end) = (0.2, 0.5, 30.0))
}

/// Half the speed of sound each: far beyond what rubber and (12) are for.
fn fast(runs: &Runs) -> Entry {
    let entry = Entry::new(
        "rings.fast",
        ["rings at half the speed of sound each", "0.5 c0, spacing 0.2 L, variant seed"].map(String::from),
        "|Σ m v|/m V, or 0 for a typed failure",
        Bound::Below(1e-12),
    )
    .because(
        Evidence::Invariant,
        "The run must complete with exact momentum, or end as diverged with step, time and particle. What \
         the rings look like is not judged.",
    );
    let Some(record) = runs.record(&fast_spec()) else { return entry };
    match &record.status {
        Status::Completed => {
            let [momentum, pieces] =
                [MOMENTUM, PIECES_MOST].map(|key| record.value(key).unwrap_or(f64::NAN));
            entry.found(momentum, format!("completed: {} in {pieces} pieces", sci(momentum, 3)))
        }
        ended @ Status::Diverged { .. } => entry.found(0.0, ended.to_string()),
        ended => entry.found(f64::NAN, ended.to_string()),
    }
}

/// Rings that nothing acts on.
#[derive(Clone, Copy)]
struct Still {
    name: &'static str,
    what: &'static str,
    /// Time steps in the quick and the full tier.
    steps: [u32; 2],
    /// \[c0\].
    speed: f64,
    because: &'static str,
}

/// At rest, and in flight far from each other. In flight, far out, every step rounds: if that grew, it would
/// show before long. At rest nothing rounds.
const STILL: [Still; 2] = [
    Still {
        name: "rings.rest",
        what: "rings at rest",
        steps: [5_000, 100_000],
        speed: 0.0,
        because: "Without stress and motion nothing may start by itself.",
    },
    Still {
        name: "rings.flight",
        what: "rings in free flight",
        steps: [5_000, 20_000],
        speed: 0.02,
        because: "A uniform velocity strains nothing, so the shape is kept to the round-off of positions \
                  9000 L away.",
    },
];

impl Still {
    fn steps(&self, tier: Tier) -> u32 {
        match tier {
            Tier::Quick => self.steps[0],
            Tier::Full => self.steps[1],
        }
    }

    /// Two layers; a Courant step of 0.6 h/(c_p + V) is at most 0.397 L/c0 long.
    fn spec(&self, tier: Tier) -> RunSpec {
        let end = f64::from(self.steps(tier)) * 0.397;
        let set = |s: &mut RingSettings| {
            (s.spacing, s.centre, s.speed, s.end) = (0.5, 9000.0, self.speed, end);
        };
        RUBBER_RINGS.spec("seed", set)
    }

    fn entry(&self, tier: Tier, runs: &Runs) -> Entry {
        let Self { name, what, speed, because, .. } = *self;
        let steps = self.steps(tier);
        let setting = format!("at least {steps} steps at {speed} c0, 2 layers, spacing 0.5 L");
        let entry =
            Entry::new(name, [what.into(), setting], "change of extents [L]", Bound::Below(1e-9))
                .because(Evidence::Invariant, because);
        let Some(record) = runs.completed(&self.spec(tier)) else { return entry };
        let first = |name: &str| record.column("series", name).first().copied();
        let change = |name: &str, extreme| {
            let (first, extreme) = (first(name), record.value(extreme));
            first.zip(extreme).map_or(f64::NAN, |(first, extreme)| (extreme - first).abs())
        };
        let (width, height) = (change("width", WIDTH_MIN), change("height", HEIGHT_MAX));
        let change = largest([width, height]);
        entry.found(change, format!("{} after {} steps", sci(change, 3), record.cost.steps))
    }
}

fn overlapping_spec() -> RunSpec {
    RUBBER_RINGS.spec("seed", |s| s.centre = 3.9)
}

/// Rings that overlap before the first step.
fn overlapping(runs: &Runs) -> Entry {
    let entry = Entry::new(
        "rings.overlap",
        ["rings that overlap at t = 0", "outer radius 4 L, centres 3.9 L from the plane"]
            .map(String::from),
        "1 if refused",
        Bound::Equals(1.0),
    )
    .because(
        Evidence::Invariant,
        "Two bodies in one place are an error of the settings, which the message must say.",
    );
    let Some(record) = runs.record(&overlapping_spec()) else { return entry };
    let Status::Refused { reason } = &record.status else { return entry.found(0.0, "it ran") };
    entry.found(f64::from(u8::from(reason.contains("outer radius"))), format!("\"{reason}\""))
}
