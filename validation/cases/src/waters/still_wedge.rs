//! Still water over a wedge: corners and edges at which walls must bear the weight above them. Depth H = 1 m.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{gate::Cause, mutation::Constant, record::Status};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Draws, Statement},
    pictures,
    snapshot::{Point, Snapshot, kinetic},
    studies::{Accuracy, Sensitivity, Spacing, Watched},
    table,
};
use touchstone_maths::{
    geometry::row_behind,
    metrics::{budget::Metered, norms::rms},
};
use touchstone_report::ColourMap;
use touchstone_schemes::water::WaterMethod;
use touchstone_solver::{EquationOfState, Role, Smoothing, WendlandC2};

use super::water::{self, WaterSettings};

touchstone_base::settings! {
    /// Settings of still water over a wedge; its depth H is 1 m.
    pub struct Wedge {
        /// spacings along the depth
        n: usize ["-"] in 8..=1000 = 20,
        /// height of the wedge, which is twice as wide
        apex: f64 ["H"] in 0.0..=0.8 = 0.5,
        /// gravity
        gravity: f64 ["m/s^2"] in 1e-6..=1e6 = 9.81,
        /// sound speed
        c0: f64 ["(g H)^(1/2)"] in 1.0..=1e3 = 10.0,
        /// end of the run
        end: f64 ["4 H/c0"] in 1e-3..=1e5 = 20.0,
        /// settings of water
        water: WaterSettings = WaterSettings::default(),
    }
}

const NAME: &str = "still_wedge";
touchstone_base::metrics! {
    all ALL;
    P_L2 = "p_l2" ["rho g H"]
        "rms over particles of the mean of p - p_exact over the last quarter, eight times a period";
    P_BASE = "p_base" ["rho g H"]
        "mean over the same times of p - p_exact around a corner of the wedge, with the weights of \
         the kernel: the larger in magnitude of both corners";
    P_APEX = "p_apex" ["rho g H"] "the same around the apex";
    KINETIC = "kinetic" ["M g H"] "largest sum m v^2/2 at the same times";
    OUTSIDE = "outside" ["-"] "particles inside of the wedge or beyond floor or sides at the end";
}

fn variants() -> Compositions<Wedge> {
    let seed = "the paper's: interface and wall particles, XSPH, artificial viscosity and stress";
    let modern = "Wendland C2, density diffusion that keeps a column at rest, walls that extrapolate the \
                  pressure: do they carry water at corners too?";
    Variants::of(|m, s| Ok(Still::new(m, s)))
        .with("seed", seed, touchstone_schemes::water::seed(), |s| s.water.courant = 0.4)
        .with("modern", modern, touchstone_schemes::water::modern(), |s| {
            (s.water.alpha, s.water.courant) = (0.02, 0.8)
        })
        .all
}

/// Still water over a wedge.
pub static STILL_WEDGE: Composed<Wedge> = Composed {
    name: NAME,
    problem: "Water at rest over a wedge in a tank",
    recommended: Recommended {
        variant: "modern",
        because: "it has the smallest error of the pressure at both corners, and with 14 spacings its \
                  pressure error is 0.60 %<!-- still_wedge.modern; n=14; p_l2 --> of the pressure at depth H",
        papers: Some("seed"),
    },
    about: "Water rests in a tank over a wedge of 45 degrees, whose apex is half way to the surface. Its \
            columns are stretched to fill the tank, so that their particles are not on a lattice and must \
            first settle. The exact pressure is hydrostatic, and nothing moves.",
    variants,
    facts,
    studies,
};

/// Half of the width of the tank \[H\].
const HALF: f64 = 1.0;

/// Height of the floor \[m\].
fn floor(s: &Wedge, x: f64) -> f64 {
    (s.apex - (x - HALF).abs()).max(0.0)
}

/// The numbers of one run.
struct Still {
    settings: Wedge,
    method: WaterMethod,
    medium: Medium,
    rules: Rules,
}

impl Still {
    fn new(m: &WaterMethod, s: &Wedge) -> Self {
        let (dx, fall) = (1.0 / s.n as f64, s.gravity.sqrt());
        let end = s.end * 4.0 / (s.c0 * fall);
        let scales =
            water::WaterScales { dx, c0: s.c0 * fall, gravity: s.gravity, speed: 0.0, end };
        let (medium, rules) = s.water.medium(m, scales);
        Self { settings: s.clone(), method: m.clone(), medium, rules }
    }

    /// Times of measurement, in the last quarter of the run.
    fn samples(&self) -> f64 {
        (0.25 * SAMPLES * self.settings.end).ceil().max(1.0)
    }
}

/// Sides, floor and wedge, the water on the left.
fn walls(s: &Wedge) -> Vec<Vector2<f64>> {
    let (left, right) = (HALF - s.apex, HALF + s.apex);
    let wedge = [(left, 0.0), (HALF, s.apex), (right, 0.0)];
    let tank = [[(0.0, 1.2), (0.0, 0.0)], [(2.0 * HALF, 0.0), (2.0 * HALF, 1.2)]];
    let wedge = wedge.into_iter().filter(|_| s.apex > 0.0);
    let all = tank[0].into_iter().chain(wedge).chain(tank[1]);
    all.map(|(x, y)| Vector2::new(x, y)).collect()
}

/// Water in columns that fill the tank up to y = H, with the exact density of their places, and its walls.
fn particles(s: &Wedge, method: &WaterMethod, medium: &Medium) -> Result<Vec<Particle>, RunError> {
    let (dx, exact) = (medium.dx, water::at_rest(medium));
    let (first, behind) =
        (method.properties.first_row.fluid(), method.properties.first_row.depth());
    let at_rest = |place: Vector2<f64>, volume: f64| {
        Particle::fluid(place, Vector2::zeros(), exact.density(1.0 - place.y), volume)
    };
    let columns = (2.0 * HALF / dx).round() as usize;
    let mut particles = Vec::new();
    for i in 0..columns + 1 - (2.0 * first) as usize {
        let x = (i as f64 + first) * dx;
        let height = 1.0 - floor(s, x);
        // On the surface of a wall are half of the cells of interface particles.
        let count = (height / dx + 0.5 - first).round().max(1.0);
        let spacing = height / (count + first - 0.5);
        let y = |k: usize| 1.0 - height + (k as f64 + first) * spacing;
        particles.extend((0..count as usize).map(|k| at_rest(Vector2::new(x, y(k)), dx * spacing)));
    }
    let rows = (method.properties.support * medium.h / dx - behind - 1e-9).floor() as usize;
    let walls = walls(s);
    for k in 0..=rows {
        let depth = (behind + k as f64) * dx;
        let role = if depth > 0.0 { Role::Wall } else { Role::Interface };
        let wall = row_behind(&walls, depth, dx).into_iter();
        particles.extend(wall.map(|(place, spacing)| at_rest(place, spacing * dx).with_role(role)));
    }
    water::check_above(&particles, 1.0, |above| {
        let least = ((medium.eos.gamma - 1) as f64 * above).sqrt();
        ("c0", s.c0, format!("more than {least:.4}"))
    })?;
    Ok(particles)
}

/// Metrics over the last quarter of the run. The start is not exactly at rest, and the remaining sound must
/// not count as pressure: means over periods remove it, and the kinetic energy shows it.
#[derive(Default, Serialize, Deserialize)]
struct Moments {
    samples: f64,
    /// Sums of the errors of the pressure at the corners of the base and at the apex, and of every particle
    /// \[ρ g H\].
    corners: [f64; 3],
    errors: Vec<f64>,
    /// The largest kinetic energy \[M g H\].
    kinetic: f64,
}

/// Samples a period.
const SAMPLES: f64 = 8.0;

/// p − p_exact at the place of a particle of this density \[ρ g H\].
fn error(s: &Wedge, medium: &Medium, p: &Point, density: f64) -> f64 {
    let exact = water::at_rest(medium).pressure(1.0 - p.position.y);
    (medium.eos.pressure(density) - exact) / (s.water.rho * s.gravity)
}

impl Moments {
    fn sample(&mut self, Still { settings: s, medium, .. }: &Still, now: &Snapshot) {
        let kernel = Smoothing::<WendlandC2>::new(medium.h);
        let water = now.moving();
        let mass: f64 = water.iter().map(|p| p.mass).sum();
        let kinetic = kinetic(water.iter().copied()) / (mass * s.gravity);
        self.kinetic = self.kinetic.max(kinetic);
        self.samples += 1.0;
        let Ok(density) = now.density() else { return };
        let errors: Vec<f64> = water.iter().map(|p| error(s, medium, p, density.of(p))).collect();
        let around = |x: f64| {
            let corner = Vector2::new(x, floor(s, x));
            let weigh = |[sum, weight]: [f64; 2], (p, error): (&Point, &f64)| {
                let w = kernel.w((p.position - corner).norm_squared());
                [sum + w * error, weight + w]
            };
            let [sum, weight] = water.iter().zip(&errors).fold([0.0; 2], weigh);
            sum / weight
        };
        let corners = [HALF - s.apex, HALF + s.apex, HALF].map(around);
        self.corners.iter_mut().zip(corners).for_each(|(sum, error)| *sum += error);
        self.errors.resize(water.len(), 0.0);
        self.errors.iter_mut().zip(&errors).for_each(|(sum, error)| *sum += error);
    }

    /// Metrics at the end, and the mean error of each particle if they are kept.
    fn measure(&self, s: &Wedge, end: &Snapshot, record: &mut Record) {
        let [left, right, apex] = self.corners.map(|sum| sum / self.samples);
        let errors = self.errors.iter().map(|sum| sum / self.samples);
        let has_densities = end.density().map(|_| ());
        let base = if left.abs() > right.abs() { left } else { right };
        for (metric, value) in [(P_L2, rms(errors.clone())), (P_BASE, base), (P_APEX, apex)] {
            record.put_or_absent(metric, has_densities.clone().map(|()| value));
        }
        record.put(KINETIC, self.kinetic);
        let water = end.moving();
        let water = water.iter().map(|p| p.position);
        let is_outside = |x: &Vector2<f64>| (x.x - HALF).abs() > HALF || x.y < floor(s, x.x);
        record.put(OUTSIDE, water.clone().filter(is_outside).count() as f64);
        if OptionalOutput::of(&record.run).particles {
            let errors = water.zip(errors);
            pictures::keep(record, pictures::END, "H", ("error", "rho g H"), errors);
        }
    }
}

impl Problem for Still {
    type Extra = ();
    type Simulation = dyn Metered<()>;
    type Watch = Moments;

    fn method(&self) -> &WaterMethod {
        &self.method
    }

    fn brief(&self) -> Brief {
        let dx = self.medium.dx;
        let decisive = "end, courant, c0 or n";
        let brief = Brief::new(self.medium, self.rules, 2.0 * HALF / (dx * dx), decisive)
            .numbers(&self.rules.numbers(self.settings.water.h_over_dx, dx));
        Brief { samples: self.samples(), ..brief }
    }

    fn times(&self) -> Vec<f64> {
        let count = self.samples();
        let time = |k: usize| self.rules.end * (0.75 + 0.25 * k as f64 / count);
        (1..=count as usize).map(time).collect()
    }

    fn scene(&self) -> Result<Parts, RunError> {
        let particles = particles(&self.settings, &self.method, &self.medium)?;
        Ok(Parts::new(self.medium, Domain::open(), particles))
    }

    fn watch(&self, _: &Snapshot, _: &Snapshot) -> Moments {
        Moments::default()
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls.at("moments", |still, moments, now, _, _| moments.sample(still, now))
    }

    fn measure(&self, moments: Moments, end: &Snapshot, record: &mut Record) {
        if record.status == Status::Completed {
            moments.measure(&self.settings, end, record);
        }
    }
}

fn table(tier: Tier) -> table::Table<Wedge, ()> {
    let mut table = table::Table::new(&STILL_WEDGE, tier);
    let depths: [&[usize]; 2] = [&[10, 14, 20], &[10, 14, 20, 28, 40]];
    table.over((), &["seed"], [&[10, 14], depths[1]], |s, n| s.n = n);
    table.over((), &["modern"], depths, |s, n| s.n = n);
    table.keep_particles(|row| row.settings.n == 20);
    table.judge(gates);
    table
}

/// Why walls of particles with a density by (3) do not bear the weight above them.
static UNWEIGHED: Cause = Cause::new(
    "The density of interface and wall particles follows equation (3), which has no weight, so a wall with \
     too little density keeps it.",
    "Walls that extrapolate the pressure with the weight of the water, as in `modern`.",
);

fn gates(row: &table::Row<Wedge, ()>) -> Vec<Gate> {
    let (variant, dx) = (row.variant, 1.0 / row.settings.n as f64);
    let gates = STILL_WEDGE.gates(format!("{variant}.{}", row.settings.n));
    let known =
        "The position of a wall is known to within half a spacing: half of the weight of a row.";
    let level =
        "The level of the water must stay within a quarter of a spacing, whose weight this is.";
    let still = "The energy that raises the surface by a tenth of a spacing, (0.1 dx/H)^2 M g H.";
    let [base, apex] =
        [P_BASE, P_APEX].map(|metric| gates.analytic(metric, Bound::magnitude(0.5 * dx), known));
    let all = gates.analytic(P_L2, Bound::Below(0.25 * dx), level);
    let kinetic = gates.analytic(KINETIC, Bound::Below((0.1 * dx).powi(2)), still);
    let outside = gates.analytic(OUTSIDE, Bound::Equals(0.0), "No particle passes a wall.");
    if variant == "modern" {
        return vec![base, apex, all, kinetic, outside];
    }
    let why = "The pressure is too low, by a share that does not fall with the spacing: the bound is one and \
               a half times the largest of five spacings.";
    vec![base.with_limitation(Bound::Within(-0.53, 0.5 * dx), why, &UNWEIGHED).fitted(), outside]
}

/// Water at rest is exact at any spacing.
const SEALED: Draws = Draws::new(&["modern"], ("n", [10.0, 28.0]), 1.0, &["p_l2", "p_base"]);

fn studies(tier: Tier) -> Studies {
    let table = table(tier);
    let spacing = Spacing::count(|s: &mut Wedge| &mut s.n, "{} spacings deep");
    let accuracy = Accuracy {
        about: "Water at rest over a wedge, mean over the last five of 20 acoustic periods.".into(),
        spacing: "dx/H [-]",
        slope: Some(1.0),
        ladders: table.ladders(&[()], &["seed", "modern"], spacing),
        ..Accuracy::new("still-wedge", P_L2, "error of the pressure, rms [ρ g H]")
    };
    let watched = [Watched::new(Constant::BodyForce).quick(), Watched::new(Constant::Density)];
    let run = STILL_WEDGE.spec("modern", |_| {});
    let sensitivity = Sensitivity::new(tier, [run], watched);
    let caption = "Where is the pressure of water at rest wrong? Mean over the last quarter of the run, 20 \
                   spacings along the depth.";
    let heading = pictures::Heading {
        id: "still-wedge-errors",
        title: "Errors of still water over a wedge",
        caption,
    };
    let colours = ("p − p_exact [ρ g H]", ColourMap::Diverging);
    let picture =
        table.picture(heading, colours, [360.0, 220.0], |row| vec![row.panel(row.variant, 0.05)]);
    Studies::judging(table.plan()).with(picture).with(accuracy).with(sensitivity)
}

fn facts() -> Facts {
    let boundary = "Nothing passes floor, sides and wedge, along which water is free to slip. The surface is \
                    free: no pressure acts on it. The exact solution is at rest.";
    Facts { statement: Statement::new(boundary, &[ALL]), sealed: Some(SEALED), ..Facts::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wedge() -> Wedge {
        touchstone_base::settings::of_json(&STILL_WEDGE.spec("modern", |_| {}).settings)
            .expect("settings")
    }

    /// Sums over four samples of errors at both corners of the base and at the apex.
    #[test]
    fn the_larger_error_of_both_corners_counts_with_its_sign() {
        let samples = 4.0;
        for (left, right, base) in [(0.1, -0.2, -0.2), (-0.3, 0.2, -0.3), (0.05, 0.04, 0.05)] {
            let moments = Moments {
                samples,
                corners: [left, right, 0.07].map(|error| error * samples),
                errors: vec![0.3 * samples, -0.3 * samples],
                kinetic: 2e-6,
            };
            let mut record = Record::new("still_wedge", "modern", serde_json::json!({}), 1);
            moments.measure(&wedge(), &Snapshot::of(0.0, &[]), &mut record);
            let expected = [(P_BASE, base), (P_APEX, 0.07), (P_L2, 0.3), (KINETIC, 2e-6)];
            for (metric, expected) in expected {
                let value = record.value(metric).expect("a metric");
                assert!((value - expected).abs() < 1e-12, "{metric:?}: {value}, not {expected}");
            }
        }
    }

    /// Water with the exact pressure, and 0.01 ρ g H more on its left half, at 0.02 (g H)^(1/2) there; one
    /// particle inside of the wedge and one below the floor.
    #[test]
    fn what_is_measured_of_water_over_a_wedge_is_what_was_done_to_it() {
        let still = Still::new(&touchstone_schemes::water::modern(), &wedge());
        let Still { settings: s, method, medium, .. } = &still;
        let mut all = particles(s, method, medium).expect("particles");
        let exact = water::at_rest(medium);
        let mut half = 0.0;
        for p in all.iter_mut().filter(|p| p.role == Role::Fluid && p.position.x < HALF) {
            let pressure = exact.pressure(1.0 - p.position.y) + 0.01 * s.water.rho * s.gravity;
            p.density = medium.eos.density(pressure);
            p.velocity = Vector2::new(0.012, -0.016) * s.gravity.sqrt();
            half += p.mass;
        }
        let mass: f64 = all.iter().filter(|p| p.role == Role::Fluid).map(|p| p.mass).sum();
        let mut moments = Moments::default();
        moments.sample(&still, &Snapshot::of(0.0, &all));
        let [left, right, apex] = moments.corners;
        assert!((left - 0.01).abs() < 1e-9 && right.abs() < 1e-9, "{left} {right}");
        // On one of both sides of the apex.
        assert!((apex - 0.005).abs() < 1e-3, "{apex}");
        assert!((moments.kinetic / (0.5 * 4e-4 * half / mass) - 1.0).abs() < 1e-9);
        let mut fluid = all.iter_mut().filter(|p| p.role == Role::Fluid);
        let [one, two] = [0, 0].map(|_| fluid.next().expect("water"));
        one.position = Vector2::new(HALF, 0.9 * s.apex);
        two.position.y = -0.01;
        let mut record = Record::new("still_wedge", "modern", serde_json::json!({}), 1);
        moments.measure(s, &Snapshot::of(0.0, &all), &mut record);
        assert_eq!(record.value(OUTSIDE), Some(2.0));
    }
}
