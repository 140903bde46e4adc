//! The judged runs: variants over spacings at the paper's speed, other speeds, a turned scene.

use super::LONG_STEPS;
use base::gate::{Bound, Evidence, Gate};
use harness::case::{Planned, Tier};

/// Variants over spacings: the ladder of error against run time.
pub const LADDER: [&str; 4] = ["seed", "leapfrog", "no-artificial-stress", "componentwise"];

/// Spacings of a variant.
pub fn spacings(variant: &str, tier: Tier) -> &'static [f64] {
    match (tier, variant) {
        // The cheapest variant shows what the spacing does.
        (Tier::Quick, "leapfrog") => &[0.2, 0.1],
        // Without artificial stress rings are torn at twice the speed, see below.
        (Tier::Quick, "no-artificial-stress") => &[],
        (Tier::Quick, _) => &[0.2],
        (Tier::Full, "leapfrog") => &[0.2, 0.1],
        (Tier::Full, _) => &[0.2, 0.1, 0.05],
    }
}

/// Speeds beside the paper's 0.059: 0.03 has a reference that no setting was chosen with, 0.12 and
/// 0.2 none.
pub fn speeds(tier: Tier) -> &'static [f64] {
    match tier {
        Tier::Quick => &[0.03, 0.12],
        Tier::Full => &[0.01, 0.03, 0.12, 0.2],
    }
}

/// Degrees by which the turned scene is turned.
pub const ANGLE: f64 = 30.0;

/// The runs: first the ladder, variant by variant.
pub fn plan(tier: Tier) -> Vec<Planned> {
    let mut runs = Vec::new();
    for variant in LADDER {
        for &spacing in spacings(variant, tier) {
            let run = Planned::new(variant, &[format!("spacing={spacing}")]);
            runs.push(run.judged(gates(variant, spacing)).taking(seconds(spacing)));
        }
    }
    for &speed in speeds(tier) {
        for variant in ["seed", "no-artificial-stress", "componentwise"] {
            if tier == Tier::Quick
                && (variant == "componentwise" || speed == 0.03)
                && variant != "seed"
            {
                continue;
            }
            // What depends on the axes is broken at any spacing.
            let is_coarse = tier == Tier::Quick || variant == "componentwise";
            for &spacing in if is_coarse { &[0.2][..] } else { &[0.2, 0.1] } {
                let set = [format!("spacing={spacing}"), format!("speed={speed}")];
                let run = Planned::new(variant, &set).taking(seconds(spacing));
                runs.push(run.judged(fast_gates(variant, spacing, speed)));
            }
        }
    }
    if tier == Tier::Full {
        // Whether rings of ten layers hold depends on the step at 0.12 c0, and on strength and reach.
        for more in [&["speed=0.12", "courant=0.8"][..], &["xi=0.1"], &["h_over_dx=1.2"]] {
            let set: Vec<String> =
                ["spacing=0.1"].iter().chain(more).map(|text| text.to_string()).collect();
            runs.push(Planned::new("seed", &set).taking(seconds(0.1)));
        }
        let set = ["spacing=0.2".into(), format!("angle={ANGLE}")];
        runs.extend(["seed", "componentwise"].map(|variant| Planned::new(variant, &set)));
    }
    runs
}

/// Roughly what a run takes \[s\]: particles times steps.
fn seconds(spacing: f64) -> f64 {
    12.0 * (0.1 / spacing).powi(3)
}

fn gate(id: String, metric: &str, bound: Bound, evidence: Evidence, because: &str) -> Gate {
    Gate::new(format!("rubber_rings.{id}.{metric}"), metric, bound, evidence, because)
}

/// Gates of a run at the paper's speed.
fn gates(variant: &str, spacing: f64) -> Vec<Gate> {
    let id = || format!("{variant}.s{spacing}");
    let mut gates = invariants(variant, &id());
    let whole =
        "a ring is one piece: rubber does not break, and finite elements find no strain near that";
    let pieces = gate(id(), "pieces_most", Bound::Equals(2.0), Evidence::Reference, whole);
    match (variant, spacing) {
        // M2 at the paper's speed; at spacing 0.2 L the rings hold all the same.
        ("no-artificial-stress", 0.1) => gates.push(pieces.expected_to_fail()),
        ("no-artificial-stress", _) => gates.push(pieces.reported()),
        _ => gates.push(pieces),
    }
    if variant == "no-artificial-stress" || variant == "componentwise" {
        return gates;
    }
    let free = "rings that have parted fly freely: what goes on inside a ring moves no centre of mass. The \
                momentum of both would not show it, for one is the mirror image of the other";
    let bound = Bound::Below(1e-10);
    gates.push(gate(id(), "pushed_by_itself", bound, Evidence::Invariant, free));
    let mirror = gate(id(), "mirror", Bound::Below(1e-6), Evidence::Invariant, MIRROR);
    gates.push(if spacing < 0.1 {
        mirror.with_limitation(
            "round-off grows faster in finer rings: 1e-13 dx at spacing 0.2, 1e-11 at 0.1, and beyond 1e-6 \
             at 0.05 with two right-hand sides a step",
        )
    } else {
        mirror
    });
    gates.extend(reference_gates(&id(), spacing));
    gates
}

/// Distances from finite elements; no setting was chosen with those at 0.03 c0.
fn reference_gates(id: &str, spacing: f64) -> Vec<Gate> {
    let mut gates = Vec::new();
    let first_order = "a surface of particles is known to about a spacing, and sums are short of \
                       neighbours there: first order in dx/thickness, with a factor of a half";
    let allowed = 0.5 * spacing;
    for metric in ["restitution_error", "height_max_error"] {
        gates.push(gate(
            id.into(),
            metric,
            Bound::Below(allowed),
            Evidence::Reference,
            first_order,
        ));
    }
    gates.extend(phase_gates(id, spacing, allowed));
    let soft = "the same; a ring of few layers is too soft in bending, as published SPH beams are by 7 \
                to 12 %, and is flattened more";
    let width =
        gate(id.into(), "width_min_error", Bound::Below(allowed), Evidence::Reference, soft);
    gates.push(width.with_limitation(
        "rings of 5 and 10 layers are flattened further than finite elements by more than that; it falls \
         with the spacing",
    ));
    gates
}

/// Gates on the phases of contact.
fn phase_gates(id: &str, spacing: f64, allowed: f64) -> Vec<Gate> {
    let gate = |metric: &str, bound: Bound, because: &str| {
        gate(id.to_string(), metric, bound, Evidence::Reference, because)
    };
    let because = "finite elements touch twice, and fly free for 15 L/c0 in between";
    let phases = gate("phases", Bound::Equals(2.0), because);
    if spacing > 0.1 {
        return vec![phases.with_limitation(
            "kernels of 5 layers reach 0.6 L across the gap that opens in between: the rings never let go",
        )];
    }
    let because = "the impulse of a phase is momentum given and taken while rings are in touch; particles \
                   touch from 3 dx on, first order in dx";
    let impulse = |metric: &str| {
        gate(metric, Bound::Below(allowed), because).with_limitation(
            "rings of 10 and 20 layers share the impulse otherwise: 5 to 6 % less in the first phase, 6 to \
             7 % more in the second, at 0.03 c0 7 and 12 %. One error seen twice, for the sum goes with \
             the restitution. Viscosity has a part in it (a quarter leaves 4 and 6 %), XSPH has none; the \
             rest is not explained",
        )
    };
    vec![phases, impulse("impulse_error@phase1"), impulse("impulse_error@phase2")]
}

const MIRROR: &str = "the scene is its own mirror image to the last bit; sums take neighbours in another \
                      order, and round-off of 1e-16 grows while rings bend";

fn invariants(variant: &str, id: &str) -> Vec<Gate> {
    let momentum = "forces of pairs are equal and opposite, so only round-off is left";
    let gained = "nothing drives the rings: artificial stress gives less than viscosity takes; stress \
                  rates in time leave 1 %";
    let budget = "what all terms add is what the energy changes by; powers at 200 times by the trapezoidal \
                  rule leave about (dt/period)²/12 of a wave through the thickness, which carries some of it";
    let courant = "the step is the one that was set, for waves of pressure and shear together, at c_p and \
                   not at c0 (R8): half of what theory allows, about 1.2 with this artificial viscosity, \
                   or two thirds";
    let most = if variant == "leapfrog" { LONG_STEPS } else { 0.6 };
    vec![
        gate(id.into(), "momentum", Bound::Below(1e-12), Evidence::Invariant, momentum),
        gate(id.into(), "courant", Bound::Below(most + 1e-7), Evidence::Invariant, courant),
        gate(id.into(), "energy_gained", Bound::Below(0.01), Evidence::Invariant, gained),
        gate(id.into(), "energy_gap", Bound::Below(0.02), Evidence::Invariant, budget),
    ]
}

/// Gates at another speed.
fn fast_gates(variant: &str, spacing: f64, speed: f64) -> Vec<Gate> {
    let id = || format!("{variant}.s{spacing}.v{speed}");
    let mut gates = invariants(variant, &id());
    let whole =
        "M2: with artificial stress rings stay in one piece at any speed below a fifth of sound";
    let pieces = gate(id(), "pieces_most", Bound::Equals(2.0), Evidence::Reference, whole);
    gates.push(match variant {
        // M2 fails here: a ring of ten layers loses a piece of each.
        "seed" if (speed, spacing) == (0.2, 0.1) => pieces.with_limitation(
            "at 0.2 c0 each the paper's artificial stress no longer holds rings of ten layers together: M2 \
             ends between 0.12 and 0.2 c0",
        ),
        "seed" => pieces,
        // M2: without artificial stress the tensile instability tears the rings.
        "no-artificial-stress" if speed == 0.12 => pieces.expected_to_fail(),
        _ => pieces.reported(),
    });
    if variant == "seed" && speed == 0.03 {
        gates.extend(reference_gates(&id(), spacing));
    }
    gates
}
