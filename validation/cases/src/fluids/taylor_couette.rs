//! Steady flow between two cylinders, the inner one turning: exact, with one convex and one concave wall.

use nalgebra::Vector2;
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Draws, Statement, Step},
    problem::Simple,
    snapshot::{Point, Snapshot},
    studies::{Accuracy, CurveOf, CurvePanel, Curves, Ladder, ORDER, Spacing},
    table::{Row, Table},
};
use touchstone_maths::{
    exact::TaylorCouette,
    geometry::{Curve, ParticleRow},
    metrics::norms::l2,
};
use touchstone_schemes::flow;
use touchstone_solver::Tait;

use crate::fluids::unit_flow::LIMIT_BOX;

touchstone_base::settings! {
    /// Settings of the flow between two cylinders, the inner one turning.
    pub struct CylinderSettings {
        /// spacings across the gap
        layers: usize ["-"] in 6..=1000 = 16,
        /// radius of the outer cylinder
        ratio: f64 ["inner radius"] in 1.01..=10.0 = 2.0,
        /// Reynolds number V d/nu, V the speed of the inner surface, d the gap
        re: f64 ["-"] in 1e-9..=1e4 = 0.5,
        /// width of the gap d
        gap: f64 ["m"] in 1e-9..=1e3 = 1e-3,
        /// kinematic viscosity
        nu: f64 ["m^2/s"] in 1e-12..=1e3 = 1e-6,
        /// density
        rho: f64 ["kg/m^3"] in 1e-3..=1e5 = 1000.0,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.9..=3.0 = 1.0,
        /// eta^2 of the viscous term
        eta2_over_h2: f64 ["h^2"] in 1e-12..=1.0 = 1e-6,
        /// least sound speed
        c0_viscous: f64 ["nu/h"] in 0.0..=100.0 = 2.2,
        /// Courant number of the time step
        courant: f64 ["-"] in 1e-6..=10.0 = 1.0,
        /// viscous number of the time step
        viscous: f64 ["h^2/nu"] in 1e-6..=10.0 = 0.4,
        /// end of the run, from rest
        end: f64 ["d^2/nu"] in 1e-6..=1e4 = 1.0,
    }
}

const NAME: &str = "taylor_couette";
const INTERFACE: &str = "interface-wall";
const EXTRAPOLATING: &str = "extrapolating-wall";
/// The settings on which time and memory of a run depend.
const DECISIVE: &str = "end, viscous, layers or ratio";

const fn velocity(name: &'static str, unit: &'static str) -> ColumnKey {
    ColumnKey::new("velocity", name, unit)
}

const RADIUS: ColumnKey = velocity("r", "inner radius");
const VELOCITY: ColumnKey = velocity("u", "V");
const EXACT_VELOCITY: ColumnKey = velocity("u_exact", "V");

touchstone_base::metrics! {
    all ALL;
    L2 = "l2" ["-"] "rms(u - u_exact)/rms(u_exact) over particles, u the velocity around the axis";
    RADIAL_RMS = "radial_rms" ["-"] "rms of the radial velocity over V";
    OUTSIDE = "outside" ["-"] "particles inside of the inner or outside of the outer cylinder";
}

/// The numbers of one run, SI units.
struct Cylinders {
    settings: CylinderSettings,
    flow: TaylorCouette,
    /// Walls extrapolate the pressure without the centripetal acceleration of the inner surface: the pressure
    /// that balances it is below Mach² = 1e-2 of ρ c², and the flow around the axis does not depend on it.
    medium: Medium,
    rules: Rules,
}

impl Cylinders {
    fn new(method: &Method, s: &CylinderSettings) -> Result<Self, RunError> {
        let dx = s.gap / s.layers as f64;
        let (h, speed) = (s.h_over_dx * dx, s.re * s.nu / s.gap);
        let inner = s.gap / (s.ratio - 1.0);
        // Mach 0.1, and at least the sound speed as stiff as viscosity.
        let sound_speed = (10.0 * speed).max(s.c0_viscous * s.nu / h);
        let medium = method.properties.medium(Tait::new(s.rho, sound_speed), dx, h).set_by(s);
        let medium = Medium { nu: s.nu, ..medium };
        let step = Step::courant(s.courant, h, [sound_speed, speed]).viscous(s.viscous, h, s.nu);
        let limits = method.properties.limits_in(&medium, s.h_over_dx, LIMIT_BOX);
        let (limits, end) = (limits.moving(h, speed, 0.0), s.end * s.gap * s.gap / s.nu);
        let rules = Rules { step, limits, sound_speed, end };
        let flow = TaylorCouette { inner, outer: inner + s.gap, speed };
        // Rows out to the support must fit into the inner cylinder.
        let share = method.properties.support * h / inner;
        if share >= 1.0 {
            let (what, setting) = ("the support over the inner radius", "ratio or layers");
            return Err(RunError::TooMuch { what, value: share, most: 1.0, setting });
        }
        Ok(Self { settings: s.clone(), flow, medium, rules })
    }

    /// Fluid in layers about the axis, and rows behind both cylinders, all with the velocity of the
    /// surface before them.
    fn particles(&self, method: &Method) -> Vec<Particle> {
        let (Self { flow, settings: s, .. }, &Medium { dx, h, .. }) = (self, &self.medium);
        let inner = Curve::circle(Vector2::zeros(), flow.inner, true, dx);
        let outer = Curve::circle(Vector2::zeros(), flow.outer, false, dx);
        let first = method.properties.first_row.depth();
        let (nearest, layers) = if first == 0.0 { (1.0, s.layers - 1) } else { (first, s.layers) };
        let fluid = (0..layers).map(|k| (inner.row(-(nearest + k as f64) * dx, dx), 0.0));
        let behind = |curve: &Curve| curve.rows_behind(dx, first, method.properties.support * h);
        let inside = behind(&inner).into_iter().map(|row| (row, flow.speed));
        let outside = behind(&outer).into_iter().map(|row| (row, 0.0));
        let particles = |(row, speed): (ParticleRow, f64)| {
            let around = |x: Vector2<f64>| Vector2::new(-x.y, x.x) / x.norm() * speed;
            row.particles(dx, s.rho, around).collect::<Vec<Particle>>()
        };
        fluid.chain(inside).chain(outside).flat_map(particles).collect()
    }
}

fn pose(method: &Method, s: &CylinderSettings) -> Result<Simple, RunError> {
    let (cylinders, m) = (Cylinders::new(method, s)?, method.clone());
    let Cylinders { medium, rules, flow, .. } = cylinders;
    let numbers = rules.numbers(s.h_over_dx, medium.dx);
    let numbers = [&numbers[..], &[("V [m/s]", flow.speed)]].concat();
    let walls = method.properties.support * medium.h; // behind both cylinders
    let area = std::f64::consts::PI * ((flow.outer + walls).powi(2) - (flow.inner - walls).powi(2));
    let size = (area / (medium.dx * medium.dx), DECISIVE);
    let scene = move || Ok(Parts::new(medium, Domain::open(), cylinders.particles(&m)));
    let at_end = move |end: &Snapshot, record: &mut Record| {
        measure(&flow, &end.moving(), record);
    };
    Ok(Simple::new(method, (medium, rules), size, &numbers, scene, at_end))
}

/// A particle in polar coordinates.
struct Polar {
    /// \[m\].
    radius: f64,
    /// Velocity around the axis \[m/s\].
    around: f64,
    /// Velocity away from the axis \[m/s\].
    outwards: f64,
}

impl Polar {
    fn of(p: &Point) -> Self {
        let (x, v, radius) = (p.position, p.velocity, p.position.norm());
        Self { radius, around: x.perp(&v) / radius, outwards: x.dot(&v) / radius }
    }
}

fn measure(flow: &TaylorCouette, fluid: &[Point], record: &mut Record) {
    let mut fluid: Vec<Polar> = fluid.iter().map(Polar::of).collect();
    fluid.sort_by(|a, b| a.radius.total_cmp(&b.radius));
    let around: Vec<f64> = fluid.iter().map(|f| f.around).collect();
    let exact: Vec<f64> = fluid.iter().map(|f| flow.velocity(f.radius)).collect();
    let square = fluid.iter().map(|f| f.outwards * f.outwards).sum::<f64>() / fluid.len() as f64;
    let outside = fluid.iter().filter(|f| !(flow.inner..=flow.outer).contains(&f.radius)).count();
    record.put(L2, l2(&around, &exact));
    record.put(RADIAL_RMS, square.sqrt() / flow.speed);
    record.put(OUTSIDE, outside as f64);
    record.put_column(RADIUS, &fluid, |f| f.radius / flow.inner);
    record.put_column(VELOCITY, &fluid, |f| f.around / flow.speed);
    record.put_column(EXACT_VELOCITY, &fluid, |f| flow.velocity(f.radius) / flow.speed);
}

fn variants() -> Compositions<CylinderSettings> {
    let interface =
        "interface and wall particles (section 4.2 of the paper) on and behind both cylinders";
    let extrapolating =
        "wall particles behind both cylinders that extrapolate velocity and pressure";
    Variants::of(pose)
        .with(INTERFACE, interface, flow::cylinders_interface(), |_| {})
        .with(EXTRAPOLATING, extrapolating, flow::cylinders_extrapolating(), |_| {})
        .all
}

/// Flow between two cylinders.
pub static CASE: Composed<CylinderSettings> = Composed {
    name: NAME,
    problem: "Flow between two cylinders, the inner one turning",
    recommended: Recommended {
        variant: EXTRAPOLATING,
        because: "with 8 spacings across the gap its velocity error is 0.57 \
                  %<!-- taylor_couette.extrapolating-wall; layers=8; l2 -->, that of `interface-wall` 0.74 \
                  %<!-- taylor_couette.interface-wall; layers=8; l2 -->, whose order is lower",
        papers: Some(INTERFACE),
    },
    about: "Viscous flow between two cylinders, of which the inner one turns, becomes steady with the exact \
            velocity u = A r + B/r. It starts from rest. Both walls are curved, the inner one convex and the \
            outer one concave, and made of rows of particles that are spaced by their own arc length.",
    variants,
    facts,
    studies,
};

/// The runs: both walls, over the spacings across the gap.
fn table(tier: Tier) -> Table<CylinderSettings, ()> {
    let mut table = Table::new(&CASE, tier);
    let layers: [&[usize]; 2] = [&[8, 10, 13], &[8, 11, 16, 22, 32]];
    table.over((), &[INTERFACE, EXTRAPOLATING], layers, |s, layers| s.layers = layers);
    table.judge(|row| gates(row.variant, row.settings.layers));
    table
}

fn gates(variant: &str, layers: usize) -> Vec<Gate> {
    let across = layers as f64;
    // The matrix of plane Poiseuille flow at 10 and 20 rows: 1.9e-2, 4.6e-3; 2.2e-2, 1.0e-2.
    let most = if variant == EXTRAPOLATING { 1.9 / (across * across) } else { 0.22 / across };
    let because = "Curved walls must have no larger error than flat ones. The bound is the error of plane \
                   Poiseuille flow, whose profile is more curved, by the row-reduced matrix of the same \
                   wall: 1.9/N^2 where it extrapolates, 0.22/N with interface particles.";
    let inside = "No particle passes a cylinder.";
    let (gates, bound) = (CASE.gates(format!("{variant}.{layers}")), Bound::Below(most));
    vec![
        gates.theory(L2, bound, because).of_others(bound, because),
        gates.invariant(OUTSIDE, Bound::Equals(0.0), inside),
    ]
}

/// The flow is exact for any spacing.
const SEALED: Draws =
    Draws::new(&["extrapolating-wall", "interface-wall"], ("layers", [8.0, 32.0]), 1.0, &["l2"]);

fn studies(tier: Tier) -> Studies {
    let table = table(tier);
    Studies::judging(table.plan()).with(profiles(&table)).with(accuracy(&table))
}

fn facts() -> Facts {
    let boundary = "No slip: at both cylinders the velocity is that of the cylinder. The outer one rests; \
                    the inner one turns, with the velocities that its particles have at the start, however \
                    long it turns.";
    Facts { statement: Statement::new(boundary, &[ALL]), sealed: Some(SEALED), ..Facts::default() }
}

/// Both walls with the order that they should have.
fn accuracy(table: &Table<CylinderSettings, ()>) -> Accuracy {
    let because = "As in the row-reduced matrix of flat walls, interface particles and the rows behind \
                   them, which carry the velocity of the wall, are of first order, and walls that \
                   extrapolate linearly of second. A tolerance of 0.3 distinguishes them for any number of \
                   levels, but does not detect an order that falls slowly.";
    let spacing = Spacing::count(|s: &mut CylinderSettings| &mut s.layers, "{} spacings across");
    let ladder = |(variant, expected): (&'static str, f64)| {
        let bound = Bound::Within(expected - 0.3, expected + 0.3);
        let id = format!("{NAME}.{variant}.order");
        let order = Gate::new(id, ORDER, bound, Evidence::Theory, because);
        Ladder { order: Some(order), ..table.ladder(&[()], variant, spacing) }
    };
    let about = "Flow between cylinders, steady after t = d²/ν, at Re = V d/ν = 0.5; the gap d equals the \
                 inner radius.";
    Accuracy {
        about: about.into(),
        spacing: "dx/d [-]",
        ladders: [(INTERFACE, 1.0), (EXTRAPOLATING, 2.0)].map(ladder).into(),
        ..Accuracy::new("taylor-couette", L2, "relative L2 error of the velocity [-]")
    }
}

/// Velocity over the radius at the finest level, and how far it is from the exact one.
fn profiles(table: &Table<CylinderSettings, ()>) -> Curves {
    let finest = table.rows.iter().map(|row| row.settings.layers).max().unwrap_or_default();
    let caption = format!(
        "Where between the cylinders is the velocity wrong? Velocity u around the axis at t = d²/ν, Re 0.5, \
         {finest} spacings across the gap d: every seventeenth particle, and the exact A r + B/r. The inner \
         cylinder turns with speed V, the outer one, of twice its radius, rests."
    );
    let flow = TaylorCouette { inner: 1.0, outer: CylinderSettings::default().ratio, speed: 1.0 };
    let line = |row: &Row<CylinderSettings, ()>, is_difference: bool| {
        CurveOf::new(row.variant, row.run.spec.clone(), move |record: &Record| {
            let shown = |(r, u): (f64, f64)| match is_difference {
                true => (r, 100.0 * (u - flow.velocity(r))),
                false => (r, u),
            };
            record.curve([RADIUS, VELOCITY]).into_iter().step_by(17).map(shown).collect()
        })
    };
    let lines = |is_difference: bool| {
        let rows = table.rows.iter().filter(|row| row.settings.layers == finest);
        rows.map(|row| line(row, is_difference)).collect()
    };
    let ends = [flow.inner, flow.outer];
    let exact = (0..=100).map(|k| ends[0] + (ends[1] - ends[0]) * f64::from(k) / 100.0);
    let exact = ("exact", exact.map(|r| (r, flow.velocity(r))).collect());
    let axis = "r/inner radius [-]";
    let velocity = CurvePanel::linear("velocity", [axis, "u/V [-]"], lines(false), exact);
    let title = "computed minus exact";
    let axes = [axis, "(u − u_exact)/V [%]"];
    let difference = CurvePanel::of_differences(title, axes, lines(true), ends);
    let panels = [velocity, difference].map(|panel| CurvePanel { symbols: true, ..panel });
    let title = "Velocity between the cylinders";
    Curves::new("taylor-couette-profiles", title, caption, panels.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use touchstone_solver::Role;

    fn value(record: &Record, metric: touchstone_base::record::MetricKey) -> f64 {
        record.value(metric).expect("a metric")
    }

    /// Made-up particles 2 % too fast, drifting inwards by 1 % of V, one of them inside of the inner
    /// cylinder, two beyond the outer one, and wall particles that do not count.
    #[test]
    fn errors_drift_and_escaped_particles_are_those_of_made_up_particles() {
        let flow = TaylorCouette { inner: 1e-3, outer: 2e-3, speed: 0.5 };
        let at = |k: usize, r: f64| {
            let angle = 0.7 * k as f64;
            let out = Vector2::new(
                touchstone_base::functions::cos(angle),
                touchstone_base::functions::sin(angle),
            );
            let velocity = Vector2::new(-out.y, out.x) * (1.02 * flow.velocity(r)) - out * 5e-3;
            Particle::fluid(out * r, velocity, 1000.0, 1e-8)
        };
        let radii = [1.5e-3, 2.01e-3, 1.9e-3, 0.99e-3, 1.1e-3, 2.3e-3, 1.999e-3];
        let mut particles: Vec<Particle> = (0..).zip(radii).map(|(k, r)| at(k, r)).collect();
        particles.extend([at(9, 0.5e-3), at(10, 2.5e-3)].map(|p| p.with_role(Role::Wall)));
        let mut record = Record::new(NAME, INTERFACE, serde_json::json!({}), 1);
        measure(&flow, &Snapshot::of(1.0, &particles).moving(), &mut record);
        assert_relative_eq!(value(&record, L2), 0.02, max_relative = 1e-12);
        assert_relative_eq!(value(&record, RADIAL_RMS), 0.01, max_relative = 1e-12);
        assert_eq!(value(&record, OUTSIDE), 3.0);
        let [r, u, exact] = [RADIUS, VELOCITY, EXACT_VELOCITY].map(|key| record.column(key));
        assert!(r.len() == 7 && r.is_sorted());
        assert_relative_eq!(r[2], 1.5, max_relative = 1e-12);
        // A r + B/r with A = -1/3 and B = 4/3 of V and the inner radius.
        assert_relative_eq!(exact[2], 7.0 / 18.0, max_relative = 1e-12);
        assert_relative_eq!(u[2], 1.02 * 7.0 / 18.0, max_relative = 1e-12);
    }

    /// Re = V d/nu, and a run ends at a multiple of d^2/nu.
    #[test]
    fn speed_radii_and_end_follow_from_the_settings() {
        let method = flow::cylinders_interface();
        let settings = CylinderSettings { end: 0.5, ratio: 3.0, ..CylinderSettings::default() };
        let cylinders = Cylinders::new(&method, &settings).expect("a flow");
        assert_relative_eq!(cylinders.flow.speed, 0.5e-3, max_relative = 1e-12);
        assert_relative_eq!(cylinders.flow.inner, 0.5e-3, max_relative = 1e-12);
        assert_relative_eq!(cylinders.flow.outer, 1.5e-3, max_relative = 1e-12);
        assert_relative_eq!(cylinders.rules.end, 0.5, max_relative = 1e-12);
        let particles = cylinders.particles(&method);
        let turning = |p: &&Particle| p.role != Role::Fluid && p.position.norm() < 0.6e-3;
        let walls: Vec<&Particle> = particles.iter().filter(turning).collect();
        assert!(!walls.is_empty());
        for p in walls {
            let around = p.position.perp(&p.velocity) / p.position.norm();
            assert_relative_eq!(around, 0.5e-3, max_relative = 1e-9);
        }
        let fluid: f64 = particles.iter().filter(|p| p.role == Role::Fluid).map(|p| p.mass).sum();
        let area = std::f64::consts::PI * (1.5e-3 * 1.5e-3 - 0.5e-3 * 0.5e-3);
        // Interface particles on both cylinders have half a row each.
        assert_relative_eq!(fluid / (1000.0 * area), 15.0 / 16.0, max_relative = 0.01);
    }
}
