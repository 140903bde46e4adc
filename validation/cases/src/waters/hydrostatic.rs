//! Water at rest in an open tank: a column of Tait fluid, compressed by its own weight, with exactly known
//! density and pressure. All motion is an effect of walls and density treatments.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{absent::Absent, mutation::Constant, random::Random, record::Status};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Drawn, Draws, Statement, Step},
    method::FirstRow,
    snapshot::{Point, Snapshot, kinetic},
    studies::{Accuracy, Sensitivity, Spacing, Watched},
    table,
};
use touchstone_maths::{
    exact, geometry,
    metrics::{
        budget::Metered,
        norms::{l2, largest, spread},
    },
};
use touchstone_schemes::water::WaterMethod;
use touchstone_solver::{EquationOfState, Tait, lattice};

use crate::{
    stabilisation::Stabilisation,
    waters::{causes::MIRRORED_PRESSURE, water},
};

touchstone_base::settings! {
    /// Settings of water at rest in an open tank.
    pub struct HydrostaticSettings {
        /// spacings from the bottom to the surface
        rows: usize ["-"] in 4..=2000 = 20,
        /// spacings across the tank
        columns: usize ["-"] in 4..=2000 = 10,
        /// depth of the water H
        depth: f64 ["m"] in 1e-6..=1e4 = 1.0,
        /// density at the surface
        rho: f64 ["kg/m^3"] in 1e-3..=1e5 = 1000.0,
        /// gravity
        g: f64 ["m/s^2"] in 1e-6..=1e6 = 9.81,
        /// g H/c0^2, which sets the sound speed
        compressibility: f64 ["-"] in 1e-8..=1.0 = 0.01,
        /// exponent of the Tait equation
        gamma: usize ["-"] in 2..=12 = 7,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.9..=3.0 = 1.2,
        /// Courant number of the time step, with the sound speed at the bottom
        courant: f64 ["-"] in 1e-6..=10.0 = 0.25,
        /// end of the run
        end: f64 ["4 H/c0"] in 1e-3..=1e5 = 20.0,
        /// random displacement of each particle at the start
        jitter: f64 ["dx"] in 0.0..=0.5 = 0.0,
        /// start with the surface density everywhere instead of the exact profile
        uniform: bool = false,
        /// stabilising terms
        stabilisation: Stabilisation = Stabilisation::default(),
        /// density diffusion delta
        diffusion: f64 ["-"] in 0.0..=1.0 = 0.1,
        /// share of gravity in the extrapolation of a wall; less than 1 only to show its effect
        wall_gravity: f64 ["g"] in 0.0..=2.0 = 1.0,
    }
}

const NAME: &str = "hydrostatic";

touchstone_base::metrics! {
    all ALL;
    P_L2 = "p_l2" ["-"]
        "rms(p - p_exact)/rms(p_exact) over particles, p_exact at their places, at the end";
    LEVEL_DRIFT = "level_drift" ["-"]
        "mean height of the highest particle in each strip of width dx, end minus start, over H";
    GAP = "gap" ["-"]
        "mean height of the lowest particle in each strip of width dx, end minus start, over dx";
    KINETIC = "kinetic" ["-"]
        "largest sum m v^2/2 over M g H, once a period over the last quarter of the run";
    OUTSIDE = "outside" ["-"] "most particles beyond bottom or sides, once a period";
    SPREAD = "spread" ["-"]
        "W/dx times the mean over the water of |share of the water at less x - x/W| at the end, W the width \
         of the tank, x from its left side";
}

/// Wendland C2 at h = 1.5 dx, long steps, and a fifth of the artificial viscosity: in water at rest there
/// is little to damp.
fn modern(s: &mut HydrostaticSettings) {
    (s.h_over_dx, s.courant, s.stabilisation.alpha) = (1.5, 0.8, 0.02);
}

fn variants() -> Compositions<HydrostaticSettings> {
    let seed = "as in the paper: cubic spline, interface and wall particles, artificial viscosity and \
                stress, XSPH, predictor-corrector";
    let modern_is = "Wendland C2, h/dx 1.5, walls that extrapolate pressure, density diffusion that keeps \
                a hydrostatic column, leapfrog";
    let plain = "modern with the diffusion of Molteni and Colagrossi: does plain diffusion level out the \
                 column?";
    Variants::of(|m, s| Ok(WaterColumn::new(m, s)))
        .with("seed", seed, touchstone_schemes::water::seed(), |_| {})
        .with("ghosts", "seed with ghosts for walls", touchstone_schemes::water::ghosts(), |_| {})
        .with("modern", modern_is, touchstone_schemes::water::modern(), modern)
        .with("extrapolating-molteni", plain, touchstone_schemes::water::molteni(), modern)
        .all
}

/// Water at rest in an open tank.
pub static HYDROSTATIC: Composed<HydrostaticSettings> = Composed {
    name: NAME,
    problem: "Water at rest in an open tank",
    recommended: Recommended {
        variant: "modern",
        because: "with 20 rows its pressure error is 0.76 \
                  %<!-- hydrostatic.modern; compressibility=0.01; p_l2 -->, the paper's 1.2 \
                  %<!-- hydrostatic.seed; compressibility=0.01; p_l2 -->, at a third of the pairs",
        papers: Some("seed"),
    },
    about: "Water rests in an open tank and is compressed by g H/c0^2 by its own weight. The exact \
            solution is rho = rho0 (1 + (gamma - 1) g d/c0^2)^(1/(gamma - 1)) at the depth d, and nothing \
            moves. After 20 acoustic periods 4 H/c0 the pressure, the level, the kinetic energy, the gap \
            between water and bottom, and the particles outside of the tank are compared with it.",
    variants,
    facts,
    studies,
};

/// Spacings from the surface of the water to the rim of the tank.
const FREEBOARD: usize = 4;
/// Particles of the box whose waves give the limit of dt.
const LIMIT_BOX: usize = 32;

/// The numbers of one run, SI units.
struct WaterColumn {
    settings: HydrostaticSettings,
    method: WaterMethod,
    exact: exact::Hydrostatic,
    medium: Medium,
    rules: Rules,
    tank: geometry::Tank,
    /// Height of the first row above bottom and its distance from the left side \[m\].
    first: f64,
    /// Height of the surface, half a spacing above the highest row \[m\].
    level: f64,
    /// The acoustic period 4 H/c₀ \[s\].
    period: f64,
}

impl WaterColumn {
    /// The numbers for a method, or why they are refused.
    fn new(m: &WaterMethod, s: &HydrostaticSettings) -> Self {
        let c0 = (s.g * s.depth / s.compressibility).sqrt();
        let (dx, gamma) = (s.depth / s.rows as f64, s.gamma as i32);
        let (h, down) = (s.h_over_dx * dx, Vector2::new(0.0, -s.g));
        let medium = Medium {
            acceleration: down,
            wall_acceleration: down * s.wall_gravity,
            ..m.properties.medium(Tait { gamma, ..Tait::new(s.rho, c0) }, dx, h).set_by(s)
        };
        let exact = water::at_rest(&medium);
        let fastest = exact.sound_speed(s.depth);
        let limits = water::limits(&m.properties, &medium, s.h_over_dx, fastest, LIMIT_BOX);
        let limits = limits.moving(h, 0.0, s.g);
        let (step, period) = (Step::courant(s.courant, h, [fastest, 0.0]), 4.0 * s.depth / c0);
        let rules = Rules { step, limits, sound_speed: c0, end: s.end * period };
        let tank = geometry::Tank { columns: s.columns, rows: s.rows + FREEBOARD, dx };
        let first = m.properties.first_row.fluid();
        let level = (s.rows as f64 + 0.5 - first) * dx;
        let (settings, method, first) = (s.clone(), m.clone(), first * dx);
        Self { settings, method, exact, medium, rules, tank, first, level, period }
    }

    /// The exact pressure at the place of a particle \[Pa\].
    fn exact_pressure(&self, p: &Point) -> f64 {
        self.exact.pressure(self.level - p.position.y)
    }

    /// A particle at rest, with the density that is exact at its position, or with the surface density.
    fn at_rest(&self, place: Vector2<f64>) -> Particle {
        let depth = if self.settings.uniform { 0.0 } else { self.level - place.y };
        let (density, dx) = (self.exact.density(depth), self.medium.dx);
        Particle::fluid(place, Vector2::zeros(), density, dx * dx)
    }

    /// The water.
    fn water(&self, walls: FirstRow) -> impl Iterator<Item = Particle> {
        let s = &self.settings;
        // Rows between rows on the walls are one less than spacings.
        let fewer = usize::from(walls == FirstRow::OnSurface);
        let mut random = Random::new(1);
        let mut jitter = move || (2.0 * random.uniform() - 1.0) * s.jitter * self.medium.dx;
        let (first, columns, rows) =
            (Vector2::repeat(self.first), s.columns - fewer, s.rows - fewer);
        lattice(first, self.medium.dx, columns, rows)
            .map(move |x| self.at_rest(x + Vector2::new(jitter(), jitter())))
    }
}

impl Problem for WaterColumn {
    type Extra = ();
    type Simulation = dyn Metered<()>;
    type Watch = ColumnHistory;

    fn method(&self) -> &WaterMethod {
        &self.method
    }

    fn brief(&self) -> Brief {
        let HydrostaticSettings { rows, columns, h_over_dx, .. } = self.settings;
        let (particles, decisive) = (rows as f64 * columns as f64, "end, courant, rows or columns");
        let brief = Brief::new(self.medium, self.rules, particles, decisive)
            .numbers(&self.rules.numbers(h_over_dx, self.medium.dx));
        Brief { samples: self.rules.end / self.period, ..brief }
    }

    /// Once a period and at the end.
    fn times(&self) -> Vec<f64> {
        let times = (1..).map(|k| f64::from(k) * self.period);
        times.take_while(|t| *t < self.rules.end).chain([self.rules.end]).collect()
    }

    /// Wall particles have the density of water at their position: the density of the interface is constant,
    /// and its effect on others is its mass by p/ρ², so that with the surface mass a compressed column would
    /// sink into the bottom.
    fn scene(&self) -> Result<Parts, RunError> {
        let of = &self.method.properties;
        let walls = water::wall_particles(of, &self.tank, &self.medium);
        let walls = walls.into_iter().map(|(place, role)| self.at_rest(place).with_role(role));
        let particles: Vec<Particle> = self.water(of.first_row).chain(walls).collect();
        water::check_above(&particles, self.level, |above| {
            let HydrostaticSettings { compressibility, gamma, depth, .. } = self.settings;
            let most = depth / ((gamma as f64 - 1.0) * above);
            ("compressibility", compressibility, format!("less than {most:.4}"))
        })?;
        let parts = Parts::new(self.medium, Domain::open(), particles);
        Ok(Parts { mirrors: self.tank.mirrors(), ..parts })
    }

    fn watch(&self, _: &Snapshot, start: &Snapshot) -> ColumnHistory {
        let mut history = ColumnHistory::new(self, start);
        history.sample(self, start);
        history
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls.at("history", |column, history, now, _, _| history.sample(column, now))
    }

    fn measure(&self, history: ColumnHistory, _: &Snapshot, record: &mut Record) {
        history.measure(record);
    }
}

/// The water at a time.
#[derive(Serialize, Deserialize)]
struct WaterSample {
    /// \[4 H/c0\].
    time: f64,
    /// Relative error of the pressure.
    pressure: Result<f64, Absent>,
    /// Mean height of the highest particles minus their height at the start \[H\].
    level: f64,
    /// Mean height of the lowest particles minus their height at the start \[dx\].
    gap: f64,
    /// Kinetic energy \[M g H\].
    kinetic: f64,
}

#[derive(Serialize, Deserialize)]
struct ColumnHistory {
    /// Mean height of the lowest particles at the start \[m\].
    low: f64,
    /// Mean height of the highest particles at the start \[m\].
    high: f64,
    samples: Vec<WaterSample>,
    /// The most particles outside of the tank.
    outside: f64,
    /// How far the water is from being spread over the tank, at the last sample \[dx\].
    spread: f64,
}

impl ColumnHistory {
    /// No sample yet of water that starts like this.
    fn new(column: &WaterColumn, start: &Snapshot) -> Self {
        let [low, high] = ends(column, &start.moving());
        Self { low, high, samples: Vec::new(), outside: 0.0, spread: 0.0 }
    }

    fn sample(&mut self, column: &WaterColumn, now: &Snapshot) {
        let water = now.moving();
        let (s, medium, tank) = (&column.settings, &column.medium, &column.tank);
        let error = now.density().map(|density| {
            let pressure = |p: &Point| medium.eos.pressure(density.of(p));
            let pressure: Vec<f64> = water.iter().map(pressure).collect();
            let exact: Vec<f64> = water.iter().map(|p| column.exact_pressure(p)).collect();
            l2(&pressure, &exact)
        });
        let [low, high] = ends(column, &water);
        let mass = water.iter().fold(0.0, |sum, p| sum + p.mass);
        let is_outside = |p: &&Point| {
            let x = p.position;
            !(0.0..=tank.width()).contains(&x.x) || x.y < 0.0
        };
        self.outside = self.outside.max(water.iter().filter(is_outside).count() as f64);
        let shares = water.iter().map(|p| (p.position.x / tank.width(), p.mass));
        self.spread = spread(shares) * tank.width() / medium.dx;
        self.samples.push(WaterSample {
            time: now.time() / column.period,
            pressure: error,
            level: (high - self.high) / s.depth,
            gap: (low - self.low) / medium.dx,
            kinetic: kinetic(water.iter().copied()) / (mass * s.g * s.depth),
        });
    }

    /// The largest kinetic energy over the last quarter of the run \[M g H\].
    fn kinetic(&self) -> f64 {
        let end = self.last(|at| at.time);
        let later = self.samples.iter().filter(|at| at.time >= 0.75 * end);
        largest(later.map(|at| at.kinetic))
    }

    fn last(&self, of: impl Fn(&WaterSample) -> f64) -> f64 {
        self.samples.last().map_or(f64::NAN, of)
    }

    /// The history, and the metrics of a run that reached its end.
    fn measure(&self, record: &mut Record) {
        if record.status == Status::Completed {
            let pressures = self.samples.iter().map(|at| at.pressure.clone());
            let pressure = pressures.reduce(|all, next| all.and(next));
            record.put_or_absent(P_L2, pressure.unwrap_or(Ok(f64::NAN)));
            record.put(LEVEL_DRIFT, self.last(|at| at.level));
            record.put(GAP, self.last(|at| at.gap));
            record.put(KINETIC, self.kinetic());
            record.put(OUTSIDE, self.outside);
            record.put(SPREAD, self.spread);
        }
        let (samples, column) = (&self.samples, |name, unit| ColumnKey::new("history", name, unit));
        record.put_column(column("t", "4 H/c0"), samples, |at| at.time);
        record.put_known_column(column("p_l2", "-"), samples, |at| at.pressure.clone());
        record.put_column(column("level_drift", "H"), samples, |at| at.level);
        record.put_column(column("gap", "dx"), samples, |at| at.gap);
        record.put_column(column("kinetic", "M g H"), samples, |at| at.kinetic);
    }
}

/// Mean heights of the lowest and of the highest particles in strips of width dx \[m\].
fn ends(column: &WaterColumn, water: &[Point]) -> [f64; 2] {
    let mut strips = vec![[f64::INFINITY, f64::NEG_INFINITY]; column.settings.columns];
    let last = strips.len() - 1;
    for Point { position, .. } in water {
        // Columns start at whole or half spacings; a float below 0 becomes 0.
        let strip = &mut strips[((position.x / column.medium.dx + 0.25) as usize).min(last)];
        *strip = [strip[0].min(position.y), strip[1].max(position.y)];
    }
    let filled: Vec<_> = strips.into_iter().filter(|s| s[0].is_finite()).collect();
    [0, 1].map(|k| filled.iter().map(|s| s[k]).sum::<f64>() / filled.len() as f64)
}

/// Purpose of a run.
#[derive(Clone, Copy, PartialEq)]
enum Group {
    /// Judged, with 20 rows.
    Judged,
    /// A start that is not at rest, judged when the water has come to rest.
    Disturbed,
    /// Controls that must fail: walls that extrapolate the pressure, or density diffusion, without gravity.
    Control,
    /// Resolutions.
    Ladder,
}

type Row = table::Row<HydrostaticSettings, Group>;

/// All runs of a tier.
fn table(tier: Tier) -> table::Table<HydrostaticSettings, Group> {
    let mut table = table::Table::new(&HYDROSTATIC, tier);
    let all: &[f64] = &[1e-4, 0.01, 0.1];
    let compressed = |s: &mut HydrostaticSettings, value: f64| s.compressibility = value;
    let across = |s: &mut HydrostaticSettings, rows| (s.rows, s.columns) = (rows, rows / 2);
    table.over(Group::Judged, &["modern"], [all, all], compressed);
    table.over(Group::Judged, &["seed", "ghosts"], [&[0.01], &[0.01]], compressed);
    table.one(Group::Control, "modern", |s| s.wall_gravity = 0.0);
    let ladder: [&[usize]; 2] = [&[10, 14, 20], &[10, 14, 20, 28, 40]];
    table.over(Group::Ladder, &["seed", "modern"], ladder, across);
    table.over(Group::Ladder, &["ghosts"], [&[], ladder[1]], across);
    table.over(Group::Control, &["extrapolating-molteni"], [&[], &[0.1]], compressed);
    table.over(Group::Disturbed, &["modern"], [&[], &[(0.1, false), (0.0, true)]], |s, start| {
        ((s.jitter, s.uniform), s.end) = (start, 40.0);
    });
    table.judge(gates);
    table
}

/// The error of the pressure over resolutions, and the errors that gates must detect. Water at rest is exact
/// for any compressibility; the judged run has 20 rows.
const SEALED: Draws = Draws {
    others: &[("compressibility", Drawn::Between(0.001, 0.05))],
    ..Draws::new(&["modern"], ("rows", [14.0, 32.0]), 1.0, &["p_l2"])
};

fn studies(tier: Tier) -> Studies {
    let table = table(tier);
    let spacing = Spacing::count(|s: &mut HydrostaticSettings| &mut s.rows, "{} rows")
        .beside(|s| &mut s.columns);
    let about = "Water at rest after 20 acoustic periods, g H/c0² = 0.01. Errors are rms, over the rms of \
                 the pressure.";
    let accuracy = Accuracy {
        about: about.into(),
        spacing: "dx/H [-]",
        slope: Some(1.0),
        ladders: table.ladders(&[Group::Ladder], &["seed", "ghosts", "modern"], spacing),
        ..Accuracy::new("hydrostatic", P_L2, "error of the pressure [-]")
    };
    let watched = [
        Watched::new(Constant::BodyForce),
        Watched::new(Constant::Density).quick(),
        Watched::new(Constant::Height),
    ];
    let run = HYDROSTATIC.spec("modern", |_| ());
    let sensitivity = Sensitivity::new(tier, [run], watched);
    Studies::judging(table.plan()).with(accuracy).with(sensitivity)
}

fn facts() -> Facts {
    let boundary = "Nothing passes floor and sides, along which water is free to slip. The surface is free: \
                    no pressure acts on it. The exact solution is at rest.";
    Facts { statement: Statement::new(boundary, &[ALL]), sealed: Some(SEALED), ..Facts::default() }
}

fn gates(row: &Row) -> Vec<Gate> {
    let known = "The pressure of water at rest is known exactly. The bound of 2 % of its rms is a fifth of \
                 the weight of one of 20 rows.";
    let mirrored = "The lowest row bears 0.8 ρ g dx too much, and errors of rows above alternate in sign, \
                    because the pressure force (5) does not act against a pressure that alternates between \
                    rows. The bound: an error of ρ g dx in every row, which is 8.7 % of the rms at 20 rows.";
    let stays = "The level of water at rest stays. The surface may settle by a tenth of one of 20 spacings, \
                 because the kernel finds no water above it.";
    let lowest = "The lowest row stays where it starts. A wall that pushes it away by a quarter of a \
                  spacing leaves a visible gap.";
    let still = "Nothing moves. The bound is the energy that raises the surface by a tenth of a spacing, \
                 (0.1 dx/H)² M g H at 20 rows.";
    let light = "Control: without gravity in the extrapolation, the bottom has the mean pressure of the \
                 water above instead of the pressure at its own depth, and the water sinks.";
    let levelled = "Control: density diffusion without the weight of the water makes its density uniform, \
                    and the column rises by 3 % of its depth.";
    let across = "The water fills the tank: its position is known to within half a spacing, of which \
                  columns one spacing apart take half.";
    let variant = row.variant;
    let (run, because) = match (row.group, row.settings.compressibility) {
        (Group::Ladder, _) => return Vec::new(),
        (Group::Disturbed, _) if row.settings.uniform => (format!("{variant}.uniform"), known),
        (Group::Disturbed, _) => (format!("{variant}.jitter{}", row.settings.jitter), known),
        (Group::Control, 0.1) => (format!("{variant}.0.1"), levelled),
        (Group::Control, _) => (format!("{variant}.no-wall-gravity"), light),
        (Group::Judged, 1e-4) => (format!("{variant}.1e-4"), known),
        (Group::Judged, of) => (format!("{variant}.{of}"), known),
    };
    let gates = HYDROSTATIC.gates(run);
    let pressure = gates.analytic(P_L2, Bound::Below(0.02), because);
    let pressure = match (row.group, variant) {
        (Group::Control, _) => return vec![pressure.expected_to_fail()],
        (_, "ghosts") => {
            pressure.with_limitation(Bound::Below(0.087), mirrored, &MIRRORED_PRESSURE)
        }
        _ => pressure,
    };
    let mut all = vec![
        pressure,
        gates.analytic(GAP, Bound::magnitude(0.25), lowest),
        gates.analytic(KINETIC, Bound::Below(2.5e-5), still),
        gates.invariant(OUTSIDE, Bound::Equals(0.0), "No particle passes a wall."),
        gates.analytic(SPREAD, Bound::Below(0.5), across),
    ];
    // A start with other densities or positions has another level than the column at rest.
    if row.group == Group::Judged {
        all.push(gates.analytic(LEVEL_DRIFT, Bound::magnitude(0.005), stays));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_base::record::MetricKey;
    /// Water put by hand: pressures 3 % too high, the highest row 0.2 dx up and half of the lowest one
    /// 0.1 dx down, all of it at 0.2 (g H)^(1/2) and later at a tenth of that, two particles out of the tank.
    #[test]
    fn what_is_measured_of_water_at_rest_is_what_was_done_to_it() {
        let spec = HYDROSTATIC.spec("modern", |_| {});
        let settings: HydrostaticSettings =
            touchstone_base::settings::of_json(&spec.settings).expect("settings");
        let method = touchstone_schemes::water::modern();
        let column = WaterColumn::new(&method, &settings);
        let (dx, g) = (column.medium.dx, settings.g);
        let water = || -> Vec<Particle> { column.water(method.properties.first_row).collect() };
        let start = ends(&column, &Snapshot::of(0.0, &water()).all());
        assert!((start[0] - 0.5 * dx).abs() < 1e-12 && (start[1] - 19.5 * dx).abs() < 1e-12);
        let mut history = ColumnHistory::new(&column, &Snapshot::of(0.0, &water()));
        history.sample(&column, &Snapshot::of(0.0, &water()));
        let mut changed = water();
        for p in &mut changed {
            let exact = column.exact.pressure(column.level - p.position.y);
            p.density = column.medium.eos.density(1.03 * exact);
            p.velocity = Vector2::new(0.12, -0.16) * (g * settings.depth).sqrt();
        }
        let pressed = Snapshot::of(2.98 * column.period, &changed);
        history.sample(&column, &pressed);
        for p in &mut changed {
            p.velocity *= 0.1;
            match p.position.y / dx {
                y if y > 19.0 => p.position.y += 0.2 * dx,
                y if y < 1.0 && p.position.x < 5.0 * dx => p.position.y -= 0.1 * dx,
                _ => {}
            }
        }
        history.sample(&column, &Snapshot::of(3.02 * column.period, &changed));
        (changed[50].position.x, changed[61].position.x) = (-0.01 * dx, 10.01 * dx);
        changed.iter_mut().for_each(|p| p.velocity *= 0.5);
        history.sample(&column, &Snapshot::of(4.0 * column.period, &changed));
        let is = |value: f64, expected: f64| {
            assert!((value - expected).abs() < 1e-9, "{value} instead of {expected}");
        };
        let [start, pressed, moved, last] = &history.samples[..] else { panic!("four samples") };
        let pressure = |at: &WaterSample| at.pressure.clone().expect("densities");
        is(pressure(start) + start.level + start.gap + start.kinetic, 0.0);
        is(pressure(pressed), 0.03);
        is(pressed.kinetic, 0.5 * 0.2 * 0.2);
        is(moved.level, 0.2 / 20.0);
        is(moved.gap, -0.05);
        let (pressure, gap) = (pressure(last), last.gap);
        let mut record = Record::new(NAME, "modern", serde_json::json!({}), 1);
        history.measure(&mut record);
        let value = |metric: MetricKey| record.value(metric).expect("a metric");
        // Faster water before the last quarter of the run does not count.
        is(value(KINETIC), 0.5 * 0.02 * 0.02);
        is(value(OUTSIDE), 2.0);
        is(value(LEVEL_DRIFT), 0.01);
        is(value(P_L2), pressure);
        is(value(GAP), gap);
    }
}
