//! The table of the runs, and their gates.

use touchstone_base::{functions::exp, record::MetricName};
use touchstone_harness::prelude::*;
use touchstone_harness::table;

use super::{
    COMPONENTWISE, CORRECTED, MOST_ENERGY_GAINED, RUBBER_RINGS, RingSettings,
    measure::NEIGHBOURS,
    metrics::{
        CONTACT_END_ERROR, ENERGY_GAINED, ENERGY_LOST, HEIGHT_MAX_ERROR, HISTORIES, HOLES_LEAST,
        IMPULSE_ERROR, MOMENTUM, PHASES, PIECES_MOST, RESTITUTION_ERROR, STRETCH_MOST,
        VOLUME_LEAST, WIDTH_MIN, WIDTH_MIN_ERROR, X_C_WORST, phase,
    },
    reference::RingReference,
};
use crate::solids::{
    causes::{CREASES, FOLDS, SHARED_IMPULSE, SOFT_CONTACT, TEARING},
    solid::{LAGRANGIAN, faces},
};

/// Purpose of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// The collision at the paper's speed.
    Paper,
    /// At another speed.
    Speed,
    /// The seed without artificial stress: the control of claim M2.
    Unstressed,
    /// Few layers, which only show how the error falls.
    Coarse,
    /// Cells of the map of outcomes that no other group has.
    Map,
}

/// The runs of a tier.
pub type Table = table::Table<RingSettings, Group>;
/// A run of the table.
pub type Row = table::Row<RingSettings, Group>;

/// The paper's speed of each ring \[c0\].
pub const SPEED: f64 = 0.059;

/// The runs of a tier, with their gates.
pub fn table(tier: Tier) -> Table {
    use Group::{Coarse, Map, Paper, Speed, Unstressed};
    const COARSE: &[f64] = &[1.0 / 3.0, 0.25];
    let mut table = Table::new(&RUBBER_RINGS, tier);
    let dx = |s: &mut RingSettings, spacing| s.spacing = spacing;
    let at = |s: &mut RingSettings, (dx, speed)| (s.spacing, s.speed) = (dx, speed);
    table.over(Paper, &["seed"], [&[0.2], &[0.2, 0.1, 0.05]], dx);
    table.over(Paper, &["leapfrog"], [&[0.2], &[0.2, 0.1]], dx);
    table.over(Paper, &[COMPONENTWISE], [&[], &[0.2]], dx);
    // Rings of 20 layers tear, and are refused.
    table.over(Paper, &[CORRECTED], [&[], &[0.2, 0.1]], dx);
    table.over(Paper, &[LAGRANGIAN], [&[0.2, 0.1], &[0.2, 0.1, 0.05]], dx);
    // 0.03 has a reference that no setting was chosen with, the others none.
    let full = [(0.2, 0.03), (0.1, 0.03), (0.2, 0.12), (0.1, 0.12), (0.2, 0.2)];
    table.over(Speed, &["seed"], [&[(0.2, 0.12)], &full], at);
    table.over(Speed, &[COMPONENTWISE, CORRECTED], [&[], &[(0.2, 0.12)]], at);
    // Beyond 0.28 c0 a crease of rings of 10 layers passes the bound of the density (docs/limits.md).
    let full =
        [(0.2, 0.03), (0.1, 0.03), (0.05, 0.03), (0.1, 0.12), (0.1, 0.2), (0.2, 0.3), (0.1, 0.25)];
    table.over(Speed, &[LAGRANGIAN], [&[(0.2, 0.03), (0.2, 0.3)], &full], at);
    let unstressed = |s: &mut RingSettings, (dx, speed)| {
        (s.spacing, s.speed, s.stabilisation.xi) = (dx, speed, 0.0);
    };
    let all = [(0.2, 0.12), (0.2, SPEED), (0.1, SPEED), (0.1, 0.12)];
    table.over(Unstressed, &["seed"], [&all[..1], &all], unstressed);
    let more = [(0.2, 0.03), (0.2, 0.3)];
    table.over(Map, &["seed"], [&more, &more[1..]], at);
    table.over(Map, &[LAGRANGIAN], [&[(0.2, 0.12)], &[(0.2, 0.12), (0.2, 0.2)]], at);
    let quick = [(0.2, 0.03), (0.2, SPEED), (0.2, 0.3)];
    table.over(Map, &["seed"], [&quick, &[(0.2, 0.03), (0.2, 0.2), (0.2, 0.3)]], unstressed);
    table.over(Coarse, &["seed", LAGRANGIAN], [COARSE; 2], dx);
    table.over(Coarse, &["leapfrog"], [&[], COARSE], dx);
    table.keep_particles(|row| {
        let RingSettings { spacing, speed, .. } = row.settings;
        let shown = [(Paper, "seed", 0.2, SPEED), (Paper, LAGRANGIAN, 0.1, SPEED)];
        let torn = (Unstressed, "seed", 0.2, 0.12);
        let this = (row.group, row.variant, spacing, speed);
        this == torn || shown.contains(&this)
    });
    table.judge(gates);
    table
}

/// Gates of a run: properties for any settings, whether the rings stay whole, distances from finite elements.
fn gates(row: &Row) -> Vec<Gate> {
    if matches!(row.group, Group::Coarse | Group::Map) {
        return Vec::new();
    }
    let (gates, s, is_lagrangian) = (gates_of(row), &row.settings, row.variant == LAGRANGIAN);
    let is_compared = row.variant != COMPONENTWISE && row.group != Group::Unstressed;
    let opposite = "Forces of pairs are opposite up to round-off.";
    let mut all = vec![
        gates.invariant(MOMENTUM, Bound::Below(1e-12), opposite),
        gates.invariant(ENERGY_GAINED, Bound::Below(MOST_ENERGY_GAINED), GAINED),
    ];
    if is_lagrangian {
        all.push(gates.invariant(ENERGY_LOST, Bound::magnitude(0.01), NOTHING_DISSIPATES));
        let volume = gates.invariant(VOLUME_LEAST, Bound::Above(0.5), INSIDE_OUT);
        let creased = |gate: Gate| gate.with_limitation(Bound::Within(0.2, 1.0), CREASED, &CREASES);
        all.push(if s.speed >= 0.2 && s.spacing < 0.15 { creased(volume) } else { volume });
    }
    all.extend(of_wholeness(row, &gates));
    let Some(exact) = RingReference::of(row.variant, s).filter(|_| is_compared) else { return all };
    let distances = Distances { row, gates, exact, allowed: 0.5 * s.spacing };
    all.push(distances.of_stretch());
    all.extend(if is_lagrangian { distances.of_lagrangian() } else { distances.of_extremes() });
    if row.group == Group::Paper {
        all.extend(distances.of_contact());
    }
    all
}

/// The gates of a run are called by what differs from the collision at the paper's speed.
fn gates_of(row: &Row) -> RunGates {
    let RingSettings { spacing, speed, .. } = row.settings;
    let xi = row.settings.stabilisation.xi;
    let speed = if speed == SPEED { String::new() } else { format!(".v{speed}") };
    let xi = if row.group == Group::Unstressed { format!(".xi{xi}") } else { String::new() };
    RUBBER_RINGS.gates(format!("{}.s{spacing}{speed}{xi}", row.variant))
}

const GAINED: &str = "Nothing drives the rings, and artificial stress gives less energy than viscosity \
    takes. Integration of stress rates in time leaves 1 %.";
const NOTHING_DISSIPATES: &str = "Nothing dissipates. Contacts that open and close within a step leave some \
    tenths of a per cent.";

const INSIDE_OUT: &str = "Neighbours stay, so a total Lagrangian body fails by being turned inside out: its \
    least volume falls to 0. At 0.5 a fold is as thin as half a spacing.";

const CREASED: &str = "At 0.2 c0 the least volume is 0.65, 0.63, 0.56, 0.53, 0.47 and 0.37 with 4, 5, 6, 8, \
    10 and 12 layers, at 0.16 c0 0.75 to 0.61; the particle is at the inner face of the fold. The bound: the \
    density at which a run counts as diverged.";

/// Gates on rings that stay whole: no piece comes off, and each stays closed around its hole. A ring that is
/// cut through once is one piece still.
fn of_wholeness(row: &Row, gates: &RunGates) -> Vec<Gate> {
    const WHOLE: &str = "Rubber does not break at strains like those in finite elements, nor at any speed \
        below a fifth of the speed of sound. The paper claims that artificial stress ensures this (claim \
        M2). A total Lagrangian body cannot tear, because its neighbours stay.";
    const CUT: &str = "Artificial stress delays the tensile instability: rings of ten layers are cut through \
        from 0.09 c0 on, those of five at 0.2 c0, and at 0.12 c0 with corrected gradients or stress \
        component by component, which is weaker at 45 degrees to the axes. The bound: a cut ring has no \
        hole.";
    let RingSettings { spacing, speed, .. } = row.settings;
    let [pieces, holes] = [(PIECES_MOST, 2.0), (HOLES_LEAST, 1.0)]
        .map(|(metric, count)| gates.reference(metric, Bound::Equals(count), WHOLE));
    let is_fine = spacing < 0.15;
    let is_cut = match (row.group, row.variant) {
        // M2: without artificial stress the tensile instability tears them.
        (Group::Unstressed, _) if speed >= 0.12 || is_fine => {
            return [pieces, holes].map(Gate::expected_to_fail).into();
        }
        // At 0.3 c0 a ring is pressed flat, and its hole closes for a while.
        (_, LAGRANGIAN) if speed > 0.25 => return vec![pieces],
        (_, LAGRANGIAN) => false,
        (_, "seed") => speed >= 0.2 || (speed >= 0.12 && is_fine),
        _ => speed >= 0.12,
    };
    let cut = |gate: Gate| gate.with_limitation(Bound::Within(0.0, 1.0), CUT, &TEARING);
    vec![pieces, if is_cut { cut(holes) } else { holes }]
}

/// Gates on the distances of a run from finite elements.
struct Distances<'a> {
    row: &'a Row,
    gates: RunGates,
    exact: RingReference,
    /// The deviation from 1 that first order allows.
    allowed: f64,
}

impl Distances<'_> {
    /// A gate on a number that may be too small and too large by as much.
    fn near_zero(&self, metric: impl Into<MetricName>, allowed: f64) -> Gate {
        const FIRST_ORDER: &str = "The surface of a body of particles is known to about a spacing, and sums \
            lack neighbours there. The error is therefore of first order in dx/thickness, for which the \
            bound has a factor of a half.";
        self.gates.reference(metric, Bound::magnitude(allowed), FIRST_ORDER)
    }

    /// Period of bending over the period of an elastic ring, minus 1, as far as it is known.
    fn softer(&self) -> f64 {
        let RingSettings { spacing, h_over_dx, .. } = self.row.settings;
        faces::known_excess((1.0 / spacing).round() as usize, h_over_dx)
    }

    /// When finite elements touch first, and when they part \[L/c0\].
    fn contact(&self) -> [f64; 2] {
        let phases = &self.exact.phases;
        [phases[0].begin, phases[phases.len() - 1].end]
    }

    /// Restitution, largest height, least width, and the path of the centre of mass.
    fn of_extremes(&self) -> Vec<Gate> {
        let (allowed, softer) = (self.allowed, self.softer());
        let [restitution, height, mut width] =
            [RESTITUTION_ERROR, HEIGHT_MAX_ERROR, WIDTH_MIN_ERROR]
                .map(|metric| self.near_zero(metric, allowed));
        let least = self.exact.number(WIDTH_MIN).map_or(f64::NAN, |width| width.value);
        let flatter = softer * (2.0 * self.row.settings.outer / least - 1.0);
        if flatter > allowed {
            width = faces::soft(width, Bound::Within(-flatter, allowed));
        }
        let (x, v) = (&self.exact.place, &self.exact.velocity);
        let least = x.iter().map(|(_, x)| *x).fold(f64::INFINITY, f64::min);
        let last = x.len() - 1;
        let allowed = allowed * (x[0].1 - least + x[last].1 - least);
        let [touch, parted] = self.contact();
        let behind = softer * (parted - touch) * v[last].1;
        let known = Bound::Within(-behind, allowed);
        let path = faces::soft(self.near_zero(X_C_WORST, allowed), known);
        vec![restitution, height, width, path]
    }

    /// How often the rings touch, when they part, and the impulse of each phase. A sample is taken every 0.25
    /// L/c0.
    fn of_contact(&self) -> Vec<Gate> {
        let twice =
            "In finite elements the rings touch twice, and fly freely for 15 L/c0 in between.";
        let phases = self.gates.reference(PHASES, Bound::Equals(2.0), twice);
        let end = CONTACT_END_ERROR.at(phase(1));
        let spacing = self.row.settings.spacing;
        if self.row.variant == LAGRANGIAN {
            let end = self.gates.reference(end, Bound::magnitude(3.0), GOAL);
            let late =
                |end: Gate| end.with_limitation(Bound::Within(-3.0, 8.3), LIGHT_TOUCH, &FOLDS);
            return vec![phases, if spacing <= 0.051 { end } else { late(end) }];
        }
        let ([touch, last], doubt) = (self.contact(), self.exact.doubt);
        let late = self.allowed * (last - touch) + doubt;
        let after = self.exact.leaves(spacing) - last;
        let end = self.gates.reference(end, Bound::Within(-late, after + late), REACH);
        if spacing > 0.1 {
            let one = phases.with_limitation(Bound::Within(1.0, 2.0), NO_GAP, &SOFT_CONTACT);
            let later = after + self.softer() * (last - touch) + doubt;
            return vec![one, faces::soft(end, Bound::Within(-late, later))];
        }
        let known = [Bound::Within(-0.09, self.allowed), Bound::Within(-self.allowed, 0.14)];
        let impulses = known.into_iter().enumerate().map(|(k, known)| {
            let gate = self.near_zero(IMPULSE_ERROR.at(phase(k)), self.allowed);
            gate.with_limitation(known, SHARED, &SHARED_IMPULSE).fitted()
        });
        [phases, end].into_iter().chain(impulses).collect()
    }

    /// The largest distance of particles that were neighbours at the start.
    fn of_stretch(&self) -> Gate {
        let because = "Neighbours at the start are at most 1.2 dx apart, and no line becomes longer than \
                       by the largest principal strain in finite elements.";
        let most = Bound::Below(NEIGHBOURS * exp(self.exact.strain));
        let gate = self.gates.reference(STRETCH_MOST, most, because);
        let RingSettings { spacing, h_over_dx, .. } = self.row.settings;
        let tears_below = match self.row.variant {
            LAGRANGIAN => 0.0,
            CORRECTED => 0.2,
            _ => 0.1,
        };
        let let_go = Bound::Below(2.0 * h_over_dx);
        let torn = |gate: Gate| gate.with_limitation(let_go, TEAR_BEGINS, &TEARING);
        if spacing < tears_below { torn(gate) } else { gate }
    }

    /// Extremes of the total Lagrangian rings.
    fn of_lagrangian(&self) -> Vec<Gate> {
        let spacing = self.row.settings.spacing;
        let small = 0.1 * spacing;
        let [restitution, width, height] = [RESTITUTION_ERROR, WIDTH_MIN_ERROR, HEIGHT_MAX_ERROR]
            .map(|metric| self.gates.reference(metric, Bound::magnitude(small), GOAL));
        let known = Bound::Within(-small, if spacing > 0.051 { 0.041 } else { 0.01 });
        let restitution = restitution.with_limitation(known, SENSITIVE, &FOLDS);
        let half = Bound::Below(0.25 * spacing / self.row.settings.outer);
        let histories = self.gates.reference(HISTORIES, half, HALF_A_SPACING);
        vec![histories, restitution, width, height]
    }
}

const GOAL: &str = "Finite elements of the same law. The bounds are the goals of the project: 2, 1 and 0.5 \
    % with 5, 10 and 20 layers, and an end of contact within 3 L/c0.";
const NO_GAP: &str = "Kernels in rings of 5 layers reach across a gap of 0.4 L, and between the two phases \
    of contact the gap in finite elements is 0.28 L. The rings never separate in between, so there is one \
    phase.";
const REACH: &str = "Kernels reach 3 dx and particles lie dx/2 inside the surface, so a ring touches the \
    plane at a distance of dx. The time lies between those when finite elements are at this distance and \
    when they touch. The bound adds first order in dx/thickness of the time since the first touch, and the \
    uncertainty of finite elements.";
const SHARED: &str = "Rings of 10 and 20 layers have 6 and 4 % less impulse in the first phase and 6 % more \
    in the second, up to 7 and 12 % at 0.03 c0. It is one error seen twice, because the sum goes with the \
    restitution. The bound: the largest of these, and the 2 % by which a quarter of the viscosity changes \
    it.";
const TEAR_BEGINS: &str = "A tear begins at the inner face: neighbours part to 2.7 dx in rings of 20 \
    layers, and with corrected gradients to 2.9 dx in rings of 10 while they fly apart. The bound: beyond \
    3 dx, the reach of the kernel, neighbours no longer interact.";
const HALF_A_SPACING: &str = "The surface of a body of particles is known to half a spacing, and so are its \
    extents over time. The bound: half a spacing over the outer diameter.";
const SENSITIVE: &str = "The restitution depends on the phase of the vibration of the rings at the second \
    contact: in finite elements the law of St. Venant and Kirchhoff changes it by +3.1 %. The folds of \
    flattened rings are a few spacings wide: the error is 2.7 to 4.4 % with 4 to 10 layers, 1.5, 1.2, 0.5 \
    and 0.6 % with 12, 14, 17 and 20, of order 2.5 from 10 to 20. It is no draw: starts that differ by 0.001 \
    dx have it within 0.02 %. The bound: the difference of the two laws and 1 %; with 20 layers 1 %.";
const LIGHT_TOUCH: &str = "At the end of the second phase the rings touch lightly, while they vibrate. The \
    bound: the 5.9 L/c0 from 99 % of the impulse to the last touch of finite elements, a sample of 0.25 \
    L/c0, and the time in which rings come apart by a spacing of 0.2 L at the speed 0.094 c0 of both.";
