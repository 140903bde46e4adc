//! The lid-driven cavity: a closed box without a free surface, in which densities must not drift. Side
//! L = 1 m, speed of the lid U = 1 m/s, ρ = 1 kg/m³.

use nalgebra::{SMatrix, SVector, Vector2};
use serde::{Deserialize, Serialize};
use touchstone_base::{
    absent::Absent,
    gate::{Cause, Evidence},
    mutation::Constant,
    record::{MetricKey, Status},
    reference::{Reference, ReferenceError},
};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Draws, Statement},
    method::FirstRow,
    pictures,
    snapshot::{Point, Snapshot},
    studies::{Accuracy, CurveOf, CurvePanel, Curves, ORDER, Sensitivity, Spacing, Watched},
    table,
};
use touchstone_maths::metrics::norms::rms;
use touchstone_report::ColourMap;
use touchstone_schemes::flow;
use touchstone_solver::{PlaneWall, QuinticSpline, Role, Smoothing, lattice};

use crate::fluids::unit_flow::{FlowScales, Numerics, UnitFlow};

touchstone_base::settings! {
    /// Settings of the cavity. L = U = ρ = 1.
    pub struct Cavity {
        /// Reynolds number U L/ν
        re: f64 ["-"] in 1e-3..=1e4 = 100.0,
        /// spacings along a side
        n: usize ["-"] in 8..=1000 = 32,
        /// end of the run, from rest
        end: f64 ["L/U"] in 1e-6..=1e4 = 15.0,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.9..=3.0 = 1.0,
        /// sound speed
        c0: f64 ["U"] in 2.0..=1e4 = 10.0,
        /// numerical settings
        numerics: Numerics = Numerics::default(),
    }
}

/// Place along each mid-line, and the velocity across it.
const MID_LINES: [[ColumnKey; 2]; 2] = [
    [ColumnKey::new("u", "place", "L"), ColumnKey::new("u", "u", "U")],
    [ColumnKey::new("v", "place", "L"), ColumnKey::new("v", "v", "U")],
];

touchstone_base::metrics! {
    all ALL;
    U_RMS = "u_rms" ["U"] "rms of mean u - finite differences at the inner places of Ghia et al. on x = L/2";
    V_RMS = "v_rms" ["U"] "the same of v on y = L/2";
    U_GHIA = "u_ghia" ["U"] "rms of mean u - Ghia et al. there";
    V_GHIA = "v_ghia" ["U"] "rms of mean v - Ghia et al. there";
    STRENGTH = "strength" ["-"]
        "sum w w_ref/sum w_ref^2 - 1, w = u and v at all these places, ref the finite differences";
    RETURN = "return" ["-"] "(least mean u)/(least u of the finite differences) - 1, at these places";
    VOLUME = "volume" ["-"] "(sum m/rho at the end)/(sum m/rho at the start) - 1";
    OUTSIDE = "outside" ["-"] "particles of the fluid outside of the cavity at the end";
}

const NAME: &str = "cavity";

fn variants() -> Compositions<Cavity> {
    let seed = "the paper's, with interface and wall particles: are they enough for a moving lid?";
    let modern = "extrapolating walls, density diffusion, shifting: as good as in channels?";
    let carried = "modern with stronger shifting that takes the velocity of the new place";
    let consistent = "carried with sums that are exact for linear fields, as in the vortices";
    let mirrored =
        "consistent with mirror particles, along which fluid slips for the continuity equation";
    let strong: fn(&mut Cavity) = |s| s.numerics.shift = 3.0;
    let old: fn(&mut Cavity) =
        |s| (s.h_over_dx, s.numerics.eta2_over_h2, s.numerics.courant) = (1.2, 0.01, 0.25);
    Variants::of(Closed::new)
        .with("seed", seed, flow::cavity_seed(), old)
        .with("modern", modern, flow::cavity_modern(), |_| {})
        .with("carried", carried, flow::cavity_carried(), strong)
        .with(CONSISTENT, consistent, flow::cavity_consistent(), strong)
        .with(RECOMMENDED, mirrored, flow::cavity_mirrored(), strong)
        .all
}

const CONSISTENT: &str = "consistent";
const RECOMMENDED: &str = "mirrored";

/// The cavity.
pub static CASE: Composed<Cavity> = Composed {
    name: NAME,
    problem: "A closed box whose lid moves",
    recommended: Recommended {
        variant: RECOMMENDED,
        because: "its errors at Re 100 are the smallest at every spacing and fall with the second order; \
                  return flow error −5.7 %<!-- cavity.mirrored; n=16; return --> with 16 spacings a side, \
                  at Re 1000 more than that of `consistent` below 45 spacings",
        papers: Some("seed"),
    },
    about: "The lid of a closed box drives a vortex, steady at Re 100 and 1000. The fluid starts at rest \
            and fills the box, so its volume must stay. Both mid-lines are compared with finite \
            differences of this project and with Ghia, Ghia & Shin 1982.",
    variants,
    facts,
    studies,
};

/// The numbers of one run.
struct Closed {
    settings: Cavity,
    method: Method,
    flow: UnitFlow,
    places: Vec<Place>,
}

impl Closed {
    fn new(method: &Method, s: &Cavity) -> Result<Self, RunError> {
        let Cavity { re, n, end, h_over_dx, c0, .. } = *s;
        let scales =
            FlowScales { re, n, h_over_dx, c0, end, speed: 1.0, force: 0.0, area: 1.0, dt: None };
        let flow = UnitFlow::new(&method.properties, &s.numerics, scales);
        let places = places(s.re).map_err(|error| RunError::Reference(error.to_string()))?;
        Ok(Self { settings: s.clone(), method: method.clone(), flow, places })
    }
}

/// Fluid at rest on a lattice, and walls of particles on the same lattice. All particles above the lid move
/// with it: the lid is a plate that slides along on the side walls.
fn particles(method: &Method, flow: &UnitFlow) -> Vec<Particle> {
    let (dx, first) = (flow.medium.dx, method.properties.first_row.depth());
    let behind = match method.properties.first_row {
        FirstRow::Nowhere => -first,
        _ => (flow.support / dx - first - 1e-9).floor() + first,
    };
    let count = ((1.0 / dx).round() + 2.0 * behind) as usize + 1;
    let particle = |x: Vector2<f64>| {
        let role = match x.add_scalar(-0.5).amax() - 0.5 {
            depth if depth < -0.25 * dx => Role::Fluid,
            depth if depth < 0.25 * dx => Role::Interface,
            _ => Role::Wall,
        };
        let is_lid = role != Role::Fluid && x.y > 1.0 - 0.25 * dx;
        let velocity = Vector2::new(f64::from(u8::from(is_lid)), 0.0);
        Particle::fluid(x, velocity, 1.0, dx * dx).with_role(role)
    };
    lattice(Vector2::repeat(-behind * dx), dx, count, count).map(particle).collect()
}

/// Floor, sides and lid of a cavity whose walls mirror the fluid.
fn mirrors() -> Vec<PlaneWall> {
    let (x, y) = (Vector2::x(), Vector2::y());
    let rest = Vector2::zeros();
    let low = [x, y].map(|normal| PlaneWall::new(rest, normal, rest));
    let high = [(x, rest), (y, x)].map(|(n, velocity)| PlaneWall::new(x + y, -n, velocity));
    [low, high].concat()
}

/// A component of the velocity at an inner point of a mid-line.
#[derive(Clone)]
struct Place {
    position: Vector2<f64>,
    component: usize,
    /// Its value by finite differences.
    exact: f64,
    /// Its value by Ghia et al.
    ghia: f64,
}

impl Place {
    /// The coordinate along the mid-line.
    fn along(&self) -> f64 {
        self.position[1 - self.component]
    }
}

fn places(re: f64) -> Result<Vec<Place>, ReferenceError> {
    let reference = Reference::load("cavity")?;
    let table = reference.table("lines")?;
    let re = re.to_string();
    let line = |component: usize| -> Result<Vec<Place>, ReferenceError> {
        let of = [("re", &*re), ("quantity", ["u", "v"][component])];
        let rows = table.select(&of, ["place", "value", "published"])?.into_iter();
        let inner = rows.filter(|[along, ..]| *along > 0.0 && *along < 1.0);
        let position = |along| [Vector2::new(0.5, along), Vector2::new(along, 0.5)][component];
        let place = |[along, exact, ghia]: [f64; 3]| Place {
            position: position(along),
            component,
            exact,
            ghia,
        };
        Ok(inner.map(place).collect())
    };
    Ok([line(0)?, line(1)?].concat())
}

/// Moving particles with their volumes \[m²\].
///
/// # Errors
/// Without densities.
fn volumes(now: &Snapshot) -> Result<Vec<(Point, f64)>, Absent> {
    let density = now.density()?;
    Ok(now.moving().into_iter().map(|p| (p, p.mass / density.of(&p))).collect())
}

/// The velocity at a point, from a quadratic field fitted to the fluid within 4.5 spacings with weights V W,
/// so that a boundary layer is not smoothed. NaN without a fit.
fn velocity(place: &Place, fluid: &[(Point, f64)], dx: f64) -> f64 {
    let kernel = Smoothing::<QuinticSpline>::new(1.5 * dx);
    let (mut moments, mut sum) = (SMatrix::<f64, 6, 6>::zeros(), SVector::<f64, 6>::zeros());
    for (p, volume) in fluid {
        let r = (p.position - place.position) / dx;
        let weight = volume * kernel.w(r.norm_squared() * dx * dx);
        if weight > 0.0 {
            let basis = SVector::from([1.0, r.x, r.y, r.x * r.x, r.x * r.y, r.y * r.y]);
            moments += basis * basis.transpose() * weight;
            sum += basis * (weight * p.velocity[place.component]);
        }
    }
    moments.lu().solve(&sum).map_or(f64::NAN, |fitted| fitted[0])
}

/// Samples of the last fifth of the run.
const SAMPLES: usize = 20;

/// Metrics from the mean velocities at these points over the last fifth of the run.
fn measure(places: &[Place], means: &[f64], record: &mut Record) {
    if places.is_empty() {
        return record.leave_out(STRENGTH, Absent::because("the reference has Re 100 and 1000"));
    }
    let all = || means.iter().zip(places);
    for (component, (own, ghia)) in [(U_RMS, U_GHIA), (V_RMS, V_GHIA)].into_iter().enumerate() {
        let of = || all().filter(move |(_, place)| place.component == component);
        record.put(own, rms(of().map(|(mean, place)| mean - place.exact)));
        record.put(ghia, rms(of().map(|(mean, place)| mean - place.ghia)));
        let (rows, [place, velocity]) = (of().collect::<Vec<_>>(), MID_LINES[component]);
        record.put_column(place, &rows, |(_, place)| place.along());
        record.put_column(velocity, &rows, |(mean, _)| **mean);
    }
    let sum = |of: fn(f64, f64) -> f64| all().map(|(m, p)| of(*m, p.exact)).sum::<f64>();
    let least = |of: fn(f64, f64) -> f64| {
        let along = all().filter(|(_, place)| place.component == 0);
        along.map(|(m, p)| of(*m, p.exact)).fold(f64::INFINITY, f64::min)
    };
    record.put(RETURN, least(|mean, _| mean) / least(|_, exact| exact) - 1.0);
    record.put(STRENGTH, sum(|mean, exact| mean * exact) / sum(|_, exact| exact * exact) - 1.0);
}

/// Metrics that need the volume of each particle.
const OF_VOLUMES: &[MetricKey] = &[U_RMS, V_RMS, U_GHIA, V_GHIA, STRENGTH, RETURN, VOLUME];

/// Means of the velocity at the places of the mid-lines.
#[derive(Serialize, Deserialize)]
struct Means {
    means: Vec<f64>,
    /// Σ m of the fluid at the start, whose density is 1.
    volume: f64,
}

impl Problem for Closed {
    type Extra = ();
    type Simulation = dyn Stepper<()>;
    type Watch = Means;
    const READS_START: bool = true;

    fn method(&self) -> &Method {
        &self.method
    }

    fn brief(&self) -> Brief {
        self.flow.brief()
    }

    fn times(&self) -> Vec<f64> {
        let time = |k: usize| self.settings.end * (0.8 + 0.2 * k as f64 / SAMPLES as f64);
        (1..=SAMPLES).map(time).collect()
    }

    fn scene(&self) -> Result<Parts, RunError> {
        let parts = self.flow.parts(Domain::open(), particles(&self.method, &self.flow));
        Ok(match self.method.properties.first_row {
            FirstRow::Nowhere => Parts { mirrors: mirrors(), ..parts },
            _ => parts,
        })
    }

    fn watch(&self, scene: &Snapshot, _: &Snapshot) -> Means {
        let volume = scene.moving().iter().map(|p| p.mass).sum();
        Means { means: vec![0.0; self.places.len()], volume }
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls.at("mid-lines", |cavity, Means { means, .. }, now, _, _| {
            let (Ok(fluid), dx) = (volumes(now), cavity.flow.medium.dx) else { return };
            for (mean, place) in means.iter_mut().zip(&cavity.places) {
                *mean += velocity(place, &fluid, dx) / SAMPLES as f64;
            }
        })
    }

    fn measure(&self, Means { means, volume }: Means, end: &Snapshot, record: &mut Record) {
        let mut all = end.all();
        if record.status == Status::Completed {
            all.retain(Point::is_fluid);
            match volumes(end) {
                Ok(fluid) => {
                    measure(&self.places, &means, record);
                    let now = fluid.iter().map(|(_, volume)| volume).sum::<f64>();
                    record.put(VOLUME, now / volume - 1.0);
                }
                Err(absent) => record.leave_all_out(OF_VOLUMES, &absent),
            }
            let beyond = all.iter().map(|p| p.position.add_scalar(-0.5).amax() - 0.5);
            record.put(OUTSIDE, beyond.filter(|beyond| *beyond > 0.0).count() as f64);
        }
        if OptionalOutput::of(&record.run).particles {
            let speeds = all.iter().map(|p| (p.position, p.velocity.norm()));
            pictures::keep(record, pictures::END, "L", ("speed", "U"), speeds);
        }
    }
}

type Row = table::Row<Cavity, f64>;

/// The runs, by Reynolds number.
fn table(tier: Tier) -> table::Table<Cavity, f64> {
    let mut table = table::Table::new(&CASE, tier);
    let side = |s: &mut Cavity, n: usize| s.n = n;
    table.over(100.0, &["seed", "modern"], [&[16], &[16]], side);
    let steady = ["carried", CONSISTENT, RECOMMENDED];
    table.over(100.0, &steady, [&[14, 16, 22], &[16, 22, 32, 45, 64]], side);
    table.over(1000.0, &steady, [&[], &[32, 45, 64]], |s, n| {
        (s.re, s.n, s.end) = (1000.0, n, 50.0);
    });
    let finest = if tier == Tier::Quick { 22 } else { 64 };
    table.keep_particles(|row| row.variant == RECOMMENDED && row.settings.n == finest);
    table.judge(gates);
    table
}

/// Why densities drift.
static RAMP: Cause = Cause::new(
    "A continuity equation that is exact for linear fields does not conserve the volume of a closed box.",
    "A continuity equation that conserves volume, as in `carried`.",
);

/// Why the return flow at Re 100 is too weak.
static CORNERS: Cause = Cause::new(
    "The continuity equation uses the velocity of wall particles: 0.3 to 0.5 U dx flow through the corners \
     of the lid, which shifting carries back.",
    "Mirror particles along which the fluid slips for the continuity equation, as in `mirrored`.",
);

/// Why the vortex is too weak.
static LAYERS: Cause = Cause::unexplained(
    "The vortex of the cavity is too weak by an error of first order or less.",
    "Mirror particles, whose errors are of second order, as in `mirrored`.",
);

const INSIDE: &str = "No particle passes a wall.";
const HALF: &str =
    "The position of a wall is known to within dx/2; the mean slope of the lines is U/L.";
const CLOSED: &str =
    "The box is closed. Pressures of the order ρ U^2 change densities by (U/c0)^2.";
const DRIVEN: &str = "A lid speed that is wrong by 3 % must be detected. Only compression, (U/c0)^2 = 1 %, \
                      makes the vortex stronger; slip and smoothing may weaken it by twice as much.";

/// Gates of errors of second order.
fn second_order(gates: &RunGates, s: &Cavity) -> Vec<Gate> {
    // The least of n² times the error with 16 to 128 intervals: `compute.py uniform` of the reference.
    let of = if s.re > 100.0 { [164.0, 212.0, 496.0, 452.0] } else { [7.4, 8.7, 18.8, 45.7] };
    let [u, v, strength, back] = of.map(|of| of / (s.n * s.n) as f64);
    let second = "Mirror particles are of second order. The bound is the error of finite differences of \
                  second order with the same spacing everywhere.";
    let falls = "The volume falls by 0.02 to 0.08 % in each L/U: the bound is 0.1 %.";
    let (half_dx, mach2) = (Bound::Below(0.5 / s.n as f64), 1.0 / (s.c0 * s.c0));
    let line =
        |metric, most| gates.reference(metric, Bound::Below(most), second).of_others(half_dx, HALF);
    let driven = |metric, weaker: f64| {
        let bound = Bound::Within(-weaker.max(0.02), mach2);
        gates.reference(metric, bound, &format!("{DRIVEN} Until it does, {second}"))
    };
    let volume = gates.invariant(VOLUME, Bound::magnitude(mach2), CLOSED);
    let known = Bound::Within(-0.001 * s.end, mach2);
    vec![
        gates.invariant(OUTSIDE, Bound::Equals(0.0), INSIDE),
        volume.with_limitation(known, falls, &RAMP),
        driven(STRENGTH, strength),
        driven(RETURN, back),
        line(U_RMS, u),
        line(V_RMS, v),
    ]
}

fn gates(Row { group: re, variant, settings: s, .. }: &Row) -> Vec<Gate> {
    let gates = CASE.gates(format!("{variant}.re{re}.{}", s.n));
    let control =
        "Control: by equation (3), densities of wall particles beside a sliding lid keep falling.";
    let rises = "The volume falls by 0.13 to 0.3 % in each L/U: the bound is 0.4 %.";
    let weak =
        "It is too weak at any spacing; layers at Re 1000 are a third as thick as at Re 100.";
    let (half_dx, mach2) = (Bound::Below(0.5 / s.n as f64), 1.0 / (s.c0 * s.c0));
    let inside = gates.invariant(OUTSIDE, Bound::Equals(0.0), INSIDE);
    let volume = gates.invariant(VOLUME, Bound::magnitude(mach2), CLOSED);
    let strength = gates.reference(STRENGTH, Bound::Within(-0.02, mach2), DRIVEN);
    // The lid and its layer are most of the strength, which does not show that the return flow is weak.
    let back = gates.reference(RETURN, Bound::Within(-0.02, mach2), DRIVEN);
    let [u, v] = [U_RMS, V_RMS].map(|metric| gates.reference(metric, half_dx, HALF));
    let control = gates.reference(U_RMS, half_dx, control);
    let limited = |gate: &Gate, low, why: &str, cause| {
        gate.clone().with_limitation(Bound::Within(low, mach2), why, cause)
    };
    let ramp = limited(&volume, -0.004 * s.end, rises, &RAMP);
    let weaker = |low| limited(&strength, low, weak, &LAYERS).fitted();
    // The error left in the limit, and that in proportion to dx/L, of runs with 14 to 64 spacings.
    let slow = |[left, of_dx]: [f64; 2], cause| {
        let why = "It is too weak by an error of first order (`consistent` at Re 100) or less.";
        limited(&back, -left - of_dx / s.n as f64, why, cause).fitted()
    };
    match (*variant, *re == 100.0) {
        ("seed", _) => vec![control.expected_to_fail().may_end_early()],
        ("modern", _) => vec![inside],
        (RECOMMENDED, _) => second_order(&gates, s),
        ("carried", true) => vec![inside, volume, weaker(-0.05), slow([0.06, 2.7], &CORNERS)],
        ("carried", false) => vec![inside, volume, weaker(-0.13), slow([0.1, 3.8], &LAYERS)],
        (_, true) => vec![inside, ramp, strength, u, v, slow([0.0, 4.0], &CORNERS)],
        (_, false) => vec![inside, ramp, weaker(-0.13), slow([0.07, 3.8], &LAYERS)],
    }
}

/// The reference is of Re 100 and 1000; errors at Re 100 are judged.
const SEALED: Draws = Draws::new(&["consistent"], ("n", [14.0, 28.0]), 1.0, &["u_rms", "v_rms"]);

fn studies(tier: Tier) -> Studies {
    let table = table(tier);
    let spacing = Spacing::count(|s: &mut Cavity| &mut s.n, "{} spacings a side");
    let because =
        "Mirror particles and sums are of second order, and nothing of first order is left.";
    let bound = Bound::Above(1.8);
    let id = format!("{NAME}.{RECOMMENDED}.order");
    let order = Gate::new(id, ORDER, bound, Evidence::Theory, because);
    let ladders = |re: f64| {
        let mut ladders = table.ladders(&[re], &["carried", CONSISTENT, RECOMMENDED], spacing);
        let judged = ladders.last_mut().filter(|_| re == 100.0);
        judged.into_iter().for_each(|ladder| ladder.order = Some(order.clone()));
        ladders
    };
    let accuracy = |re: f64| Accuracy {
        about: format!(
            "The lid-driven cavity at Re {re}, steady, against finite differences of this project."
        ),
        ladders: ladders(re),
        ..Accuracy::new(&format!("{NAME}-{re}"), U_RMS, "rms error of u on x = L/2 [U]")
    };
    let accuracy = [100.0, 1000.0].map(accuracy).into_iter();
    let caption = "How fast does the fluid go round? Speed of the particles of `mirrored` at the end, finest \
                   spacing; it is 0 at walls and in the middle of the vortex.";
    let heading = pictures::Heading { id: "cavity-picture", title: "The cavity", caption };
    let panel = |r: &Row| vec![r.panel(format!("Re {}", r.group), 1.0 / r.settings.n as f64)];
    let picture =
        table.picture(heading, ("speed [U]", ColourMap::Sequential), [300.0, 270.0], panel);
    let speed = Watched::new(Constant::WallSpeed).quick().faults(&[-1.0, 0.5]);
    let coarse = CASE.spec(CONSISTENT, |s| s.n = 16);
    Studies::judging(table.plan())
        .with(curves(&table))
        .with(picture)
        .with_all(accuracy.filter(|of| !of.ladders.is_empty()))
        .with(Sensitivity::new(tier, [coarse], [speed]))
}

fn facts() -> Facts {
    let boundary = "No slip: at floor and sides the velocity is 0, at the lid it is (U, 0), U = 1 m/s. \
                    Nothing passes a wall. The lid is a plate that slides along on the sides, so that \
                    particles of walls above y = L move with it, those above the sides too.";
    Facts { statement: Statement::new(boundary, &[ALL]), sealed: Some(SEALED), ..Facts::default() }
}

/// Both mid-lines of the finest runs.
fn curves(table: &table::Table<Cavity, f64>) -> Curves {
    let finest = table.rows.iter().map(|row| row.settings.n).max().unwrap_or_default();
    let panel = |(re, k): (f64, usize)| {
        let rows = table.of(re).filter(|row| row.settings.n == finest);
        let line = |row: &Row| CurveOf::columns(row.variant, row.run.spec.clone(), MID_LINES[k]);
        let known = places(re).unwrap_or_default().into_iter().filter(|place| place.component == k);
        let known = known.map(|place| (place.along(), place.exact)).collect();
        let axes = [["y/L [-]", "u/U [-]"], ["x/L [-]", "v/U [-]"]][k];
        let known = ("finite differences", known);
        let lines = rows.map(line).collect();
        let panel = CurvePanel::linear(&format!("Re {re}"), axes, lines, known);
        CurvePanel { symbols: true, ..panel }
    };
    let panels = [(100.0, 0), (100.0, 1), (1000.0, 0), (1000.0, 1)].map(panel);
    let caption = format!(
        "Is the vortex as strong as by finite differences? Mean velocity on the mid-lines at the places of \
         Ghia et al., {finest} spacings a side."
    );
    let panels = panels.into_iter().filter(|panel| !panel.lines.is_empty()).collect();
    Curves::new("cavity-mid-lines", "Velocity on the mid-lines", caption, panels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn setup() -> (Method, UnitFlow) {
        let settings = CASE.chosen(CONSISTENT, |s| s.n = 20);
        let method = flow::cavity_consistent();
        let Closed { flow, .. } = Closed::new(&method, &settings).expect("settings");
        (method, flow)
    }

    /// The lid is a plate that slides along on the side walls: particles above y = L move with it, in front
    /// of the cavity and above its sides, and no others do. Sides that end below the lid with a lid between
    /// them would drive the same water with less return flow: the solution at the corners would depend on the
    /// walls, not on the problem.
    #[test]
    fn all_particles_above_the_lid_and_no_others_move_with_it() {
        let (method, flow) = setup();
        for p in particles(&method, &flow) {
            let is_above = p.position.y > 1.0 - 1e-9;
            let expected = if is_above && p.role != Role::Fluid { 1.0 } else { 0.0 };
            assert_eq!((p.velocity.x, p.velocity.y), (expected, 0.0), "{:?}", p.position);
            let inside = p.position.add_scalar(-0.5).amax() < 0.5 - 1e-9;
            assert_eq!(p.role == Role::Fluid, inside, "{:?}", p.position);
        }
    }

    /// The walls that mirror are the sides of the cavity, before which the fluid fills its lattice, and of
    /// them only the lid moves, along itself.
    #[test]
    fn the_walls_of_mirrored_fluid_enclose_it_and_the_lid_moves_along_itself() {
        let settings = CASE.chosen(RECOMMENDED, |s| s.n = 20);
        let case = Closed::new(&flow::cavity_mirrored(), &settings).expect("settings");
        let Parts { particles, mirrors, .. } = case.scene().expect("a scene");
        assert_eq!((particles.len(), mirrors.len()), (400, 4));
        for wall in &mirrors {
            let nearest = particles.iter().map(|p| wall.depth(p.position)).fold(1.0, f64::min);
            assert!((nearest - 0.025).abs() < 1e-12, "{wall:?}: {nearest}");
            let is_lid = wall.normal.y < 0.0;
            let expected = Vector2::new(f64::from(u8::from(is_lid)), 0.0);
            assert_eq!(wall.velocity, expected, "{wall:?}");
        }
        assert!(particles.iter().all(|p| p.role == Role::Fluid && p.velocity == Vector2::zeros()));
    }

    /// A quadratic field is read exactly at any place.
    #[test]
    fn the_velocity_at_a_place_is_that_of_a_quadratic_field() {
        let (method, flow) = setup();
        let mut all = particles(&method, &flow);
        let field = |x: Vector2<f64>| {
            Vector2::new(
                0.3 + x.y * (2.0 - x.x) - 0.7 * x.y * x.y,
                -0.1 + x.x * x.x - 0.4 * x.x * x.y,
            )
        };
        all.iter_mut().for_each(|p| p.velocity = field(p.position));
        for (at, component) in
            [([0.5, 0.03], 0), ([0.5, 0.517], 0), ([0.97, 0.5], 1), ([0.211, 0.5], 1)]
        {
            let position = Vector2::from(at);
            let place = Place { position, component, exact: 0.0, ghia: 0.0 };
            let fluid = volumes(&Snapshot::of(0.0, &all)).expect("densities");
            let found = velocity(&place, &fluid, flow.medium.dx);
            assert!((found - field(position)[component]).abs() < 1e-9, "{at:?}: {found}");
        }
    }

    /// Velocities 5 % too large at all points, and 0.1 U too large at one.
    #[test]
    fn what_is_too_much_at_the_places_is_measured() {
        let places = places(100.0).expect("a reference");
        let of = |component: usize| {
            let of = places.iter().filter(move |place| place.component == component);
            of.map(|place| place.exact).collect::<Vec<f64>>()
        };
        let measured = |means: &[f64]| {
            let mut record = Record::new(NAME, RECOMMENDED, serde_json::json!({}), 1);
            measure(&places, means, &mut record);
            move |metric: MetricKey| record.value(metric).expect("a metric")
        };
        let is = |value: f64, expected: f64| {
            assert!((value - expected).abs() < 1e-12, "{value}, not {expected}");
        };
        let more: Vec<f64> = places.iter().map(|place| 1.05 * place.exact).collect();
        let value = measured(&more);
        is(value(STRENGTH), 0.05);
        is(value(RETURN), 0.05);
        for (metric, component) in [(U_RMS, 0), (V_RMS, 1)] {
            is(value(metric), 0.05 * rms(of(component).into_iter()));
        }
        let mut one: Vec<f64> = places.iter().map(|place| place.exact).collect();
        let first = places.iter().position(|place| place.component == 1).expect("a place");
        one[first] += 0.1;
        let value = measured(&one);
        is(value(U_RMS), 0.0);
        is(value(V_RMS), 0.1 / (of(1).len() as f64).sqrt());
        is(value(RETURN), 0.0);
    }
}
