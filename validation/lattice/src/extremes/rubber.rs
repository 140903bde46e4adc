//! Rubber that is nearly incompressible, a hundred times stiffer, very fast, at rest for long, or in
//! two places at once.

use super::{Entry, sci};
use crate::cases;
use base::{
    gate::{Bound, Evidence},
    record::{Profile, Record, Status},
};
use harness::{case::Tier, runner::Context};

/// A run of a case of the elastic solid; the words of the refusal if it is refused.
fn run(case: &str, variant: &str, set: &[&str]) -> Result<Record, String> {
    let case = cases::find(case).map_err(|error| error.to_string())?;
    let set: Vec<String> = set.iter().map(|text| (*text).to_string()).collect();
    case.run(variant, &set, &Context::default()).map_err(|error| error.to_string())
}

fn words(what: &str, setting: &str) -> [String; 2] {
    [what.to_string(), setting.to_string()]
}

/// K and μ times 100: the same motion in units of L/c₀.
pub fn stiffer(_: Tier) -> Vec<Entry> {
    let entry = Entry::new(
        "rings.stiffer",
        words("rings a hundred times stiffer", "K = 1 and K = 100, 3 layers, t = 80 L/c0"),
        "distance [L, c0]",
        Bound::Below(1e-10),
    )
    .because(
        Evidence::Invariant,
        "nothing but K has a unit of stress, so motion in units of L and c0 is the same but for round-off",
    );
    let set = ["spacing=0.33", "end=80"];
    let soft = run("rubber_rings", "leapfrog", &set);
    let stiff = run("rubber_rings", "leapfrog", &[&set[..], &["bulk_modulus=100"]].concat());
    match (soft, stiff) {
        (Ok(soft), Ok(stiff)) => {
            let worst = distance(&soft, &stiff);
            let steps = soft.cost.steps;
            entry.found(worst, format!("{} after {steps} steps and a collision", sci(worst)))
        }
        (soft, stiff) => entry.found(f64::NAN, format!("{:?}", soft.err().or(stiff.err()))),
    }
    .into()
}

/// Largest difference of centre, velocity and extents at any sample; infinite if samples differ.
fn distance(a: &Record, b: &Record) -> f64 {
    let series = |r: &Record| r.profiles.get("series").cloned().unwrap_or_default();
    let column = |p: &Profile, name: &str| {
        p.columns.iter().find(|c| c.name == name).map_or(Vec::new(), |c| c.values.clone())
    };
    let (a, b) = (series(a), series(b));
    let names = ["t", "x_c", "v_c", "width", "height"];
    let worst = names.into_iter().map(|name| {
        let (a, b) = (column(&a, name), column(&b, name));
        let same = a.len() == b.len() && a.len() > 10;
        let gaps = a.iter().zip(&b).map(|(a, b)| (a - b).abs());
        if same { gaps.fold(0.0, f64::max) } else { f64::INFINITY }
    });
    worst.fold(0.0, f64::max)
}

/// Half the speed of sound each: far beyond what rubber and (12) are for.
pub fn fast(_: Tier) -> Vec<Entry> {
    let entry = Entry::new(
        "rings.fast",
        words("rings at half the speed of sound each", "0.5 c0, spacing 0.2 L, variant seed"),
        "|Σ m v|/m V, or 0 for a typed failure",
        Bound::Below(1e-12),
    )
    .because(
        Evidence::Invariant,
        "the run completes with its momentum exact, or ends as diverged with step, time and particle; \
         what the rings look like is not judged",
    );
    match run("rubber_rings", "seed", &["spacing=0.2", "speed=0.5", "end=30"]) {
        Ok(record) => match &record.status {
            Status::Completed => {
                let momentum = record.measured("momentum");
                let pieces = record.measured("pieces_most");
                let found = format!("completed: {} in {pieces} pieces", sci(momentum));
                entry.found(momentum, found)
            }
            Status::Diverged { step, field, particle, .. } => {
                let found = format!("diverged at step {step}: {field} of particle {particle}");
                entry.found(0.0, found)
            }
            other => entry.found(f64::NAN, format!("{other:?}")),
        },
        Err(words) => entry.found(f64::NAN, words),
    }
    .into()
}

/// Rings that nothing acts on: at rest, and in flight far from each other.
pub fn alone(tier: Tier) -> Vec<Entry> {
    // In flight, far out, every step rounds: if that grew, it would show before long. At rest nothing rounds.
    let [rest, flight] = if tier == Tier::Full { [100_000, 20_000] } else { [5_000; 2] };
    let one = |name: &str, what: &str, steps: u32, speed: f64, because: &str| {
        // Two layers; a Courant step of 0.6 h/(c_p + V) is at most 0.397 L/c0 long.
        let set = ["spacing=0.5".into(), "centre=9000".into(), format!("speed={speed}")];
        let end = format!("end={}", f64::from(steps) * 0.397);
        let set: Vec<&str> = set.iter().map(String::as_str).chain([end.as_str()]).collect();
        let setting = format!("at least {steps} steps at {speed} c0, 2 layers, spacing 0.5 L");
        let entry = Entry::new(name, [what.to_string(), setting], "change of extents [L]", {
            Bound::Below(1e-9)
        })
        .because(Evidence::Invariant, because);
        match run("rubber_rings", "seed", &set) {
            Ok(record) => {
                let extent = |name: &str| record.measured(name);
                let first = |name: &str| first_of(&record, name);
                let change = (first("width") - extent("width_min"))
                    .abs()
                    .max((extent("height_max") - first("height")).abs());
                let found = format!("{} after {} steps", sci(change), record.cost.steps);
                entry.found(change, found)
            }
            Err(words) => entry.found(f64::NAN, words),
        }
    };
    vec![
        one(
            "rings.rest",
            "rings at rest",
            rest,
            0.0,
            "no stress, no motion: nothing may start by itself",
        ),
        one(
            "rings.flight",
            "rings in free flight",
            flight,
            0.02,
            "a uniform velocity strains nothing: shape is kept to the round-off of places 9000 L away",
        ),
    ]
}

fn first_of(record: &Record, name: &str) -> f64 {
    let series = record.profiles.get("series");
    let column = series.and_then(|s| s.columns.iter().find(|c| c.name == name));
    column.and_then(|c| c.values.first()).copied().unwrap_or(f64::NAN)
}

/// Rings that overlap before the first step.
pub fn overlapping(_: Tier) -> Vec<Entry> {
    let entry = Entry::new(
        "rings.overlap",
        words("rings that overlap at t = 0", "outer radius 4 L, centres 3.9 L from the plane"),
        "1 if refused",
        Bound::Equals(1.0),
    )
    .because(
        Evidence::Invariant,
        "two bodies in one place are a mistake of the settings, and named so",
    );
    match run("rubber_rings", "seed", &["centre=3.9"]) {
        Ok(_) => entry.found(0.0, "it ran".into()),
        Err(words) => {
            entry.found(f64::from(u8::from(words.contains("outer radius"))), format!("\"{words}\""))
        }
    }
    .into()
}

/// Poisson's ratios towards 1/2 at the same Young's modulus.
pub fn incompressible(_: Tier) -> Vec<Entry> {
    const RATIOS: [f64; 6] = [0.3, 0.4, 0.45, 0.49, 0.499, 0.4999];
    let entry = Entry::new(
        "plate.poisson",
        words("rubber that hardly changes its volume", "Poisson's ratio 0.3 to 0.4999, the same E"),
        "dt c_p/h over that at 0.3, less 1",
        Bound::Below(0.01),
    )
    .because(
        Evidence::Theory,
        "dt follows 1/c_p, that is sqrt((1 + nu)(1 - 2 nu)/(1 - nu)); the tip's 0.01 c0 beside c_p leaves \
         0.3 %",
    );
    let step = |poisson: f64| -> Option<f64> {
        let set = [format!("poisson={poisson}"), "n=2".into(), "end=0.01".into()];
        let set: Vec<&str> = set.iter().map(String::as_str).collect();
        let record = run("oscillating_plate", "bare", &set).ok()?;
        record.numerics.get("dt [s]").and_then(serde_json::Value::as_f64)
    };
    let theory = |nu: f64| ((1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu)).sqrt();
    let steps: Vec<f64> = RATIOS.iter().map(|&nu| step(nu).unwrap_or(f64::NAN)).collect();
    let scaled = |k: usize| steps[k] / theory(RATIOS[k]) / (steps[0] / theory(RATIOS[0])) - 1.0;
    // A NaN stays: a run that failed must not pass.
    let worst = (1..RATIOS.len()).map(|k| scaled(k).abs());
    let worst = worst.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a });
    let found =
        format!("{}; dt from {} to {} s", sci(worst), sci(steps[0]), sci(steps[RATIOS.len() - 1]));
    entry.found(worst, found).into()
}
