//! The judged runs: both experiments over resolutions and variants, and their gates.

use super::LOBOVSKY;
use crate::{
    case::{Planned, Tier},
    gate::{Bound, Evidence, Gate},
};

/// The variants that are judged.
pub const JUDGED: [&str; 3] = ["seed", "ghosts", "modern"];

/// Spacings along the width of the column of Martin & Moyce.
pub fn martin_moyce(variant: &str, tier: Tier) -> &'static [usize] {
    match (tier, variant) {
        (Tier::Quick, "modern") => &[20, 40],
        (Tier::Quick, _) => &[20],
        (Tier::Full, _) => &[20, 40, 80],
    }
}

/// Spacings along the height of the column of Lobovsky et al.
pub fn lobovsky(variant: &str, tier: Tier) -> &'static [usize] {
    match (tier, variant) {
        (Tier::Quick, "modern" | "seed") => &[30],
        (Tier::Quick, _) => &[],
        (Tier::Full, "modern") => &[30, 60, 120],
        (Tier::Full, _) => &[30, 60],
    }
}

/// The settings of a run of Lobovsky's column.
pub fn in_tank(n: usize) -> Vec<String> {
    let mut set: Vec<String> = LOBOVSKY.map(String::from).to_vec();
    set.push(format!("n={n}"));
    set
}

/// The runs: Martin & Moyce variant by variant, then Lobovsky et al.
pub fn plan(tier: Tier) -> Vec<Planned> {
    let mut runs = Vec::new();
    for variant in JUDGED {
        for &n in martin_moyce(variant, tier) {
            let run = Planned::new(variant, &[format!("n={n}")]);
            runs.push(run.judged(free_gates(variant, n)));
        }
    }
    for variant in JUDGED {
        for &n in lobovsky(variant, tier) {
            runs.push(Planned::new(variant, &in_tank(n)).judged(tank_gates(variant, n)));
        }
    }
    runs
}

fn gate(id: &str, metric: &str, bound: Bound, evidence: Evidence, because: &str) -> Gate {
    Gate::new(format!("dam_break.{id}.{metric}"), metric, bound, evidence, because)
}

/// What holds whatever the water does.
fn invariants(id: &str) -> Vec<Gate> {
    let tight = "a wall that lets water through is none";
    let closes = "pressure and (3) exchange energy exactly, and each other term reports its power: what is \
                  left is the time step and the sampling of the powers";
    let momentum = "what walls and gravity give is what the water has; the rest is sampling the force";
    let slow = "weakly compressible: Mach 0.3, beyond which density changes by 5 % and the speed of sound \
                by a sixth, is no water";
    vec![
        gate(id, "outside", Bound::Equals(0.0), Evidence::Invariant, tight),
        gate(id, "energy_gap", Bound::Below(1e-3), Evidence::Invariant, closes),
        gate(id, "momentum_gap", Bound::Below(0.01), Evidence::Invariant, momentum),
        gate(id, "mach", Bound::Below(0.3), Evidence::Theory, slow),
    ]
}

/// Gates of a column that runs out freely.
fn free_gates(variant: &str, n: usize) -> Vec<Gate> {
    let id = format!("martin-moyce.{variant}.{n}");
    invariants(&id)
}

/// Gates of a column in the tank.
fn tank_gates(variant: &str, n: usize) -> Vec<Gate> {
    let id = format!("lobovsky.{variant}.{n}");
    invariants(&id)
}
