//! The runs: variants over spacings at the paper's speed, other speeds, a rotated scene.

use super::{
    LONG_STEPS, MOST_ENERGY_GAINED, RUBBER_RINGS, RingSettings, extremes, metrics::*,
    reference::Reference,
};
use crate::solid::faces;
use base::{
    gate::{Bound, Evidence, Gate},
    record::{MetricKey, MetricName},
    spec::RunSpec,
};
use harness::case::{Planned, Tier};

/// Variants over spacings.
const VARIANTS: [&str; 4] = ["seed", "leapfrog", "no-artificial-stress", "componentwise"];

/// The paper's speed of each ring \[c0\].
pub const SPEED: f64 = 0.059;
/// The spacing of rings of five layers \[L\].
pub const FIVE_LAYERS: f64 = 0.2;
/// The run without artificial stress that is shown torn: variant, spacing, speed.
pub const TORN: (&str, f64, f64) = ("no-artificial-stress", FIVE_LAYERS, 0.12);
/// The run of which pictures are shown.
pub const PICTURED: (&str, f64, f64) = ("seed", FIVE_LAYERS, SPEED);

/// Spacings of a variant that are judged.
pub fn spacings(variant: &str, tier: Tier) -> &'static [f64] {
    match (tier, variant) {
        // The cheapest variant shows what the spacing does.
        (_, "leapfrog") => &[FIVE_LAYERS, 0.1],
        // Without artificial stress rings are torn at twice the speed, see below.
        (Tier::Quick, "no-artificial-stress") => &[],
        (Tier::Quick, _) => &[FIVE_LAYERS],
        (Tier::Full, _) => &[FIVE_LAYERS, 0.1, 0.05],
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

/// Two rings of a variant at a spacing \[L\] and a speed \[c0\].
pub fn collision(variant: &str, spacing: f64, speed: f64) -> RunSpec {
    let spec = RUBBER_RINGS.spec(variant, |s| (s.spacing, s.speed) = (spacing, speed));
    let is_pictured = [PICTURED, TORN].contains(&(variant, spacing, speed));
    if is_pictured { spec.keep_particles() } else { spec }
}

/// The scene rotated by 30 degrees.
pub fn rotated(variant: &str) -> RunSpec {
    RUBBER_RINGS.spec(variant, |s| (s.spacing, s.angle) = (FIVE_LAYERS, 30.0))
}

/// Pictures of the film.
pub const FRAMES: usize = 21;

/// The collision with a picture every few L/c0.
pub fn film() -> RunSpec {
    collision("leapfrog", FIVE_LAYERS, SPEED).keep_particles().keep_pictures(FRAMES)
}

/// Every collision of the table of fracture: first the paper's speed, then others, then other settings.
pub fn collisions(tier: Tier) -> Vec<Planned> {
    let mut runs = Vec::new();
    for variant in VARIANTS {
        for &spacing in spacings(variant, tier) {
            let run = Planned::new(collision(variant, spacing, SPEED)).taking(seconds(spacing));
            runs.push(run.judged(gates(variant, spacing)));
        }
    }
    for &speed in speeds(tier) {
        for variant in ["seed", "no-artificial-stress", "componentwise"] {
            for &spacing in spacings_at(variant, speed, tier) {
                let run = Planned::new(collision(variant, spacing, speed)).taking(seconds(spacing));
                runs.push(run.judged(fast_gates(variant, spacing, speed)));
            }
        }
    }
    if tier == Tier::Full {
        // Whether rings of ten layers hold depends on the step at 0.12 c0, and on strength and reach.
        let special = |set: fn(&mut RingSettings)| RUBBER_RINGS.planned("seed", set);
        let special = [
            special(|s| (s.spacing, s.speed, s.courant) = (0.1, 0.12, 0.8)),
            special(|s| (s.spacing, s.xi) = (0.1, 0.1)),
            special(|s| (s.spacing, s.h_over_dx) = (0.1, 1.2)),
        ];
        runs.extend(special.map(|run| run.taking(seconds(0.1))));
    }
    runs
}

/// Spacings of a variant at another speed than the paper's.
pub fn spacings_at(variant: &str, speed: f64, tier: Tier) -> &'static [f64] {
    match (tier, variant) {
        (_, "leapfrog") => &[],
        (Tier::Quick, "seed") => &[FIVE_LAYERS],
        (Tier::Quick, "no-artificial-stress") if speed != 0.03 => &[FIVE_LAYERS],
        (Tier::Quick, _) => &[],
        // What depends on the axes is broken at any spacing.
        (Tier::Full, "componentwise") => &[FIVE_LAYERS],
        (Tier::Full, _) => &[FIVE_LAYERS, 0.1],
    }
}

/// The runs that are not of the declaration.
pub fn plan(tier: Tier) -> Vec<Planned> {
    let mut runs = collisions(tier);
    runs.push(Planned::new(film()));
    if tier == Tier::Full {
        runs.extend(ROTATED.map(|variant| Planned::new(rotated(variant))));
    }
    runs.extend(extremes::plan(tier));
    runs
}

/// Variants whose scene is rotated as well.
pub const ROTATED: [&str; 2] = ["seed", "componentwise"];

/// Roughly what a run takes \[s\]: particles times steps.
fn seconds(spacing: f64) -> f64 {
    12.0 * (0.1 / spacing).powi(3)
}

/// A gate on what holds whatever the settings.
fn invariant(id: &str, metric: MetricKey, bound: Bound, because: &str) -> Gate {
    RUBBER_RINGS.gate(id, metric, bound, Evidence::Invariant, because)
}

/// A gate on what finite elements say.
fn reference(id: &str, metric: impl Into<MetricName>, bound: Bound, because: &str) -> Gate {
    RUBBER_RINGS.gate(id, metric, bound, Evidence::Reference, because)
}

/// Gates of a run at the paper's speed.
fn gates(variant: &str, spacing: f64) -> Vec<Gate> {
    let id = &format!("{variant}.s{spacing}");
    let mut gates = invariants(variant, id);
    let because =
        "a ring is one piece: rubber does not break, and finite elements find no strain near that";
    gates.extend(whole(id, because).map(|gate| match (variant, spacing) {
        // M2 at the paper's speed; at spacing 0.2 L the rings hold all the same.
        ("no-artificial-stress", 0.1) => gate.expected_to_fail(),
        ("no-artificial-stress", _) => gate.reported(),
        _ => gate,
    }));
    if variant == "no-artificial-stress" || variant == "componentwise" {
        return gates;
    }
    let free = "rings that have parted fly freely: what goes on inside a ring moves no centre of mass. The \
                momentum of both would not show it, for one is the mirror image of the other";
    let bound = Bound::Below(1e-10);
    gates.push(invariant(id, PUSHED_BY_ITSELF, bound, free));
    gates.push(invariant(id, MIRROR, Bound::Below(1e-6), EXACT_MIRROR));
    gates.extend(reference_gates(id, spacing, SPEED));
    gates
}

/// Gates on rings that stay whole: no piece comes off, and each stays closed around its hole. A ring that is
/// cut through once is one piece still.
fn whole(id: &str, because: &str) -> [Gate; 2] {
    [(PIECES_MOST, 2.0), (HOLES_LEAST, 1.0)]
        .map(|(metric, count)| reference(id, metric, Bound::Equals(count), because))
}

/// Distances from finite elements; no setting was chosen with those at 0.03 c0.
fn reference_gates(id: &str, spacing: f64, speed: f64) -> Vec<Gate> {
    let mut gates = Vec::new();
    let first_order = "a surface of particles is known to about a spacing, and sums are short of \
                       neighbours there: first order in dx/thickness, with a factor of a half";
    let allowed = 0.5 * spacing;
    for metric in [RESTITUTION_ERROR, HEIGHT_MAX_ERROR] {
        gates.push(reference(id, metric, Bound::Below(allowed), first_order));
    }
    gates.extend(phase_gates(id, spacing, allowed));
    let soft = "the same; a ring of few layers is too soft in bending, as published SPH beams are by 7 \
                to 12 %, and is flattened more";
    let width = reference(id, WIDTH_MIN_ERROR, Bound::Below(allowed), soft);
    let known = flattened(spacing, speed);
    gates.push(match known > allowed {
        true => width.with_limitation(Bound::Below(known), FLATTENED),
        false => width,
    });
    gates
}

/// Why rings of few layers become too flat.
const FLATTENED: &str = "velocity gradients and forces miss neighbours at faces, so that a ring of few layers is \
                         too soft in bending and is flattened further than finite elements. The bound: the same \
                         kinetic energy bends a ring by as much further as its period of bending is longer, \
                         from sums over its layers, and 7 % as plates have it";

/// How much further than finite elements rings of this spacing \[L\] and speed \[c0\] can be flattened, over the
/// least width.
fn flattened(spacing: f64, speed: f64) -> f64 {
    let settings = RingSettings { speed, ..RingSettings::default() };
    let width = Reference::of(&settings).and_then(|reference| reference.number(WIDTH_MIN));
    let further = faces::known_excess((1.0 / spacing).round() as usize, settings.h_over_dx);
    width.map_or(f64::NAN, |(width, _)| further * (2.0 * settings.outer - width) / width)
}

/// Gates on the phases of contact.
fn phase_gates(id: &str, spacing: f64, allowed: f64) -> Vec<Gate> {
    let because = "finite elements touch twice, and fly free for 15 L/c0 in between";
    let phases = reference(id, PHASES, Bound::Equals(2.0), because);
    if spacing > 0.1 {
        return vec![phases.with_limitation(
            Bound::Within(1.0, 2.0),
            "kernels of 5 layers reach 0.6 L across the gap that opens in between: the rings never let go",
        )];
    }
    let because = "the impulse of a phase is momentum given and taken while rings are in touch; particles \
                   touch from 3 dx on, first order in dx";
    let impulse = |k: usize| {
        reference(id, IMPULSE_ERROR.at(phase(k)), Bound::Below(allowed), because).with_limitation(
            Bound::Below(0.15),
            "rings of 10 and 20 layers share the impulse otherwise: 5 to 6 % less in the first phase, 6 to \
             7 % more in the second, at 0.03 c0 7 and 12 %. One error seen twice, for the sum goes with \
             the restitution. Viscosity has a part in it (a quarter leaves 4 and 6 %), XSPH has none; the \
             rest is not explained",
        )
    };
    vec![phases, impulse(0), impulse(1)]
}

const EXACT_MIRROR: &str = "the scene is its own mirror image to the last bit; sums take neighbours in \
                            another order, and round-off of 1e-16 grows while rings bend, the faster the \
                            finer they are";

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
        invariant(id, MOMENTUM, Bound::Below(1e-12), momentum),
        invariant(id, COURANT, Bound::Below(most + 1e-7), courant),
        invariant(id, ENERGY_GAINED, Bound::Below(MOST_ENERGY_GAINED), gained),
        invariant(id, ENERGY_GAP, Bound::Below(0.02), budget),
    ]
}

/// What is seen of `seed`.
const TORN_OPEN: &str = "M2 fails: at 0.12 c0 each rings of ten layers tear from the inner face of the \
                         rear pole and are cut through, like a C, at 71 L/c0; so they do at 0.09 and 0.10 \
                         c0, and at 0.08 they hold";
const TORN_FAST: &str = "M2 fails: at 0.2 c0 each rings of 5 and of 10 layers are cut through, at 62 and \
                         48 L/c0; from 0.09 c0 on others are as well";
const BROKEN: &str = "at 0.2 c0 each the paper's artificial stress no longer holds rings of ten layers \
                      together: a piece of each comes off";

/// A ring that is cut through has no hole.
fn torn(holes: Gate, reason: &str) -> Gate {
    holes.with_limitation(Bound::Within(0.0, 1.0), reason)
}

/// Gates at another speed.
fn fast_gates(variant: &str, spacing: f64, speed: f64) -> Vec<Gate> {
    let id = &format!("{variant}.s{spacing}.v{speed}");
    let mut gates = invariants(variant, id);
    let because = "rubber does not break at any speed below a fifth of sound; M2 says that artificial \
                   stress is enough for that";
    let [pieces, holes] = whole(id, because);
    gates.extend(match (variant, speed, spacing) {
        // M2 fails here: a ring of ten layers loses a piece of each.
        ("seed", 0.2, 0.1) => {
            [pieces.with_limitation(Bound::Within(2.0, 4.0), BROKEN), torn(holes, TORN_FAST)]
        }
        ("seed", 0.2, _) => [pieces, torn(holes, TORN_FAST)],
        ("seed", 0.12, 0.1) => [pieces, torn(holes, TORN_OPEN)],
        ("seed", ..) => [pieces, holes],
        // M2: without artificial stress the tensile instability tears the rings.
        ("no-artificial-stress", 0.12, _) => [pieces, holes].map(Gate::expected_to_fail),
        _ => [pieces, holes].map(Gate::reported),
    });
    if variant == "seed" && speed == 0.03 {
        gates.extend(reference_gates(id, spacing, speed));
    }
    gates
}
