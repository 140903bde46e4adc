//! The lid-driven cavity: a closed box without a free surface, in which densities must not drift. Side L = 1 m,
//! speed of the lid U = 1 m/s, ρ = 1 kg/m³.

use nalgebra::{SMatrix, SVector, Vector2};
use solver::{
    ConsistentPressure, ConsistentViscosity, Continuity, Domain, EquationOfState,
    ExtrapolatingWall, InterfaceWall, Kernel, NoSlip, Particle, PlaneWall, Pressure, QuinticSpline, Role,
    ShiftAdvection, Smoothing, Stepper, Tait, Viscosity, lattice,
};

use base::{
    gate::{Bound, Evidence, Gate},
    mutation::Constant,
    record::{Profile, Record, Status},
    reference::Reference,
};
use harness::{
    case::{Case, Rules, RunError, Tier},
    columns::Columns,
    composed::{self, Best, Composed, Composition, Program, Variants},
    context::Context,
    declare::{Accuracy, CurveOf, CurvePanel, Curves, Declaration, ErrorOf, Sensitivity, Watched},
    method::{FirstRow, Method, Parts},
    pictures,
    runner::Drive,
    runs::Runs,
    simulate,
    study::Study,
    table,
};
use maths::metrics::norms::rms;
use report::{Axis, Cell, ColourMap, Figure, ParticleMap};

use crate::{
    channel::{Modern, Seed, Stabilised},
    unit_flow::{ConsistentDrift, Scales, UnitFlow, unit_settings},
};

unit_settings! {
    /// Settings of the cavity. L = U = ρ = 1.
    pub struct CavitySettings {
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
    }
}

type Extrapolating = ExtrapolatingWall<Tait, NoSlip>;
type Pairs = (Pressure<Tait>, Viscosity);
type Carried = (Pressure<Tait>, Viscosity, ShiftAdvection);
type Consistent = (ConsistentPressure<Tait>, ConsistentViscosity, ShiftAdvection);

const NAME: &str = "cavity";
const VARIANTS: [&str; 4] = ["seed", "modern", "carried", "consistent"];

fn variants() -> Vec<Composition<CavitySettings>> {
    Variants::of(&Program { run, rules: |m, s| Ok(flow(s, m, &Context::of_rules())?.rules) })
        .with(
            VARIANTS[0],
            "the paper's terms, kernel and predictor-corrector, interface and wall particles: what do they \
             do where nothing is free to give way?",
            Method::of::<Seed<Pairs, Continuity>>(),
            |s| (s.h_over_dx, s.eta2_over_h2, s.courant) = (1.2, 0.01, 0.25),
        )
        .with(
            VARIANTS[1],
            "quintic spline, h/dx 1, leapfrog, extrapolating walls, density diffusion, shifting: does what \
             suits channels suit a closed box?",
            Method::of::<Modern<Pairs, Stabilised, Extrapolating>>(),
            |_| {},
        )
        .with(
            VARIANTS[2],
            "modern with stronger shifting that takes the velocity of the new place, as in the hills",
            Method::of::<Modern<Carried, Stabilised, Extrapolating>>(),
            |s| s.shift = 3.0,
        )
        .with(
            VARIANTS[3],
            "carried with sums that are exact for linear fields, as in the vortices",
            Method::of::<Modern<Consistent, ConsistentDrift, Extrapolating>>(),
            |s| s.shift = 3.0,
        )
        .all
}

base::metrics! {
    U_RMS = "u_rms" ["U"]
        "rms over the 15 inner places of Ghia et al. on x = L/2 of mean u - finite differences";
    V_RMS = "v_rms" ["U"] "the same of v on y = L/2";
    U_GHIA = "u_ghia" ["U"] "rms of mean u - Ghia et al. there";
    V_GHIA = "v_ghia" ["U"] "rms of mean v - Ghia et al. there";
    CHANGE = "change" ["U"]
        "rms over all places of the mean over the last tenth of the run less that over the tenth before";
    VOLUME = "volume" ["-"] "sum(m/rho)/(area of the fluid) - 1 at the end";
    OUTSIDE = "outside" ["-"] "particles of the fluid outside of the cavity at the end";
}

/// The cavity.
pub const CAVITY: &dyn Case = &CASE;

static CASE: Composed<CavitySettings> = Composed {
    name: NAME,
    problem: "A closed box whose lid moves",
    best: Best {
        variant: "consistent",
        because: "at Re 1000 it is the best at every spacing",
        papers: Some("seed"),
    },
    about: "The lid of a closed box moves along itself and drives a vortex, steady at Re 100 and 1000. The \
            fluid starts at rest and fills the box, so that a density that drifts has nowhere to go. Both \
            mid-lines are compared with finite differences of this project, extrapolated, and with the \
            tables of Ghia, Ghia & Shin 1982, which these judge too.",
    variants,
    is_stable: composed::completed,
    declaration,
    plan: |tier| table(tier).plan(),
    studies,
};

fn flow(s: &CavitySettings, m: &Method, context: &Context) -> Result<UnitFlow, RunError> {
    s.flow(m, Scales { speed: 1.0, force: 0.0, area: 1.0, dt: None }, context)
}

/// Fluid at rest on a lattice, and walls on the same lattice. All that is above the lid moves with it: it is
/// a plate that slides along on the side walls.
fn particles(method: &Method, flow: &UnitFlow) -> Vec<Particle> {
    let (dx, first) = (flow.medium.dx, method.first_row.depth());
    let behind = match method.first_row {
        FirstRow::Nowhere => -first,
        _ => (flow.support / dx - first - 1e-9).floor() + first,
    };
    let count = ((1.0 / dx).round() + 2.0 * behind) as usize + 1;
    let particle = |x: Vector2<f64>| {
        let depth = [-x.x, x.x - 1.0, -x.y, x.y - 1.0].into_iter().fold(f64::MIN, f64::max) / dx;
        let role = match depth {
            depth if depth < -0.25 => Role::Fluid,
            depth if depth < 0.25 => Role::Interface,
            _ => Role::Wall,
        };
        let is_lid = role != Role::Fluid && x.y > 1.0 - 0.25 * dx;
        let velocity = Vector2::new(f64::from(u8::from(is_lid)), 0.0);
        Particle::fluid(x, velocity, 1.0, dx * dx).with_role(role)
    };
    lattice(Vector2::repeat(-behind * dx), dx, count, count).map(particle).collect()
}

/// The inner places of the mid-lines with what is expected there, of one Reynolds number.
#[derive(Clone)]
struct Line {
    quantity: &'static str,
    places: Vec<f64>,
    computed: Vec<f64>,
    ghia: Vec<f64>,
}

fn lines(re: f64) -> Result<Option<[Line; 2]>, RunError> {
    let read = |quantity: &'static str| {
        let reference = Reference::load("cavity")?;
        let table = reference.table("lines")?;
        let (all, names) = (table.numbers("re")?, table.texts("quantity")?);
        let place = table.optional("place")?;
        let is_of = |k: &usize| {
            let inner = place[*k].is_some_and(|x| x > 0.0 && x < 1.0);
            all[*k] == re && names[*k] == quantity && inner
        };
        let of: Vec<usize> = (0..all.len()).filter(is_of).collect();
        let column = |values: &[f64]| of.iter().map(|k| values[*k]).collect();
        let (computed, ghia) =
            (column(&table.numbers("value")?), column(&table.numbers("published")?));
        Ok(Line { quantity, places: of.iter().filter_map(|k| place[*k]).collect(), computed, ghia })
    };
    let refused = |error: base::reference::ReferenceError| RunError::Reference(error.to_string());
    let lines = [read("u").map_err(refused)?, read("v").map_err(refused)?];
    Ok((!lines[0].places.is_empty()).then_some(lines))
}

/// Velocities of the fluid at the places of a line: those of a quadratic field that is fitted to the particles
/// within 4.5 spacings, with weights V W, so that a boundary layer is not smoothed. NaN without a fit.
fn along(line: &Line, particles: &[Particle], dx: f64) -> Vec<f64> {
    let kernel = Smoothing::<QuinticSpline>::new(1.5 * dx);
    let component = usize::from(line.quantity == "v");
    let at = |place: &f64| {
        let mut here = Vector2::repeat(0.5);
        here[1 - component] = *place;
        let (mut moments, mut sum) = (SMatrix::<f64, 6, 6>::zeros(), SVector::<f64, 6>::zeros());
        for p in particles.iter().filter(|p| p.role == Role::Fluid) {
            let r = (p.position - here) / dx;
            let weight = p.mass / p.density * kernel.w(r.norm_squared() * dx * dx);
            if weight > 0.0 {
                let basis = SVector::from([1.0, r.x, r.y, r.x * r.x, r.x * r.y, r.y * r.y]);
                moments += basis * basis.transpose() * weight;
                sum += basis * (weight * p.velocity[component]);
            }
        }
        moments.lu().solve(&sum).map_or(f64::NAN, |fitted| fitted[0])
    };
    line.places.iter().map(at).collect()
}

/// Sums over each of the last tenths of the run.
struct Means {
    lines: Option<[Line; 2]>,
    dx: f64,
    /// Values at all places of both lines, and the number of samples, by tenth.
    sums: [Vec<f64>; 2],
    counts: [usize; 2],
}

harness::observed! { Means: changes(sums, counts), parts(), stays(lines, dx) }

/// Samples a tenth of the run.
const SAMPLES: usize = 10;

impl Means {
    fn sample(&mut self, simulation: &dyn Stepper<()>) {
        let Some(lines) = &self.lines else { return };
        let particles = simulation.particles();
        let values = lines.iter().flat_map(|line| along(line, &particles, self.dx));
        let tenth = usize::from(self.counts[0] == SAMPLES);
        self.sums[tenth].resize(lines.iter().map(|line| line.places.len()).sum(), 0.0);
        self.sums[tenth].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        self.counts[tenth] += 1;
    }

    fn measure(&self, record: &mut Record) {
        let Some(lines) = &self.lines else {
            let reason = "the reference has Reynolds numbers 100 and 1000";
            for metric in [U_RMS, V_RMS, U_GHIA, V_GHIA, CHANGE] {
                record.leave_out(metric, reason);
            }
            return;
        };
        let pairs = self.sums[0].iter().zip(&self.sums[1]);
        let count = SAMPLES as f64;
        let means: Vec<f64> = pairs.clone().map(|(a, b)| 0.5 * (a + b) / count).collect();
        record.put(CHANGE, rms(pairs.map(|(a, b)| (b - a) / count)));
        let (of_u, of_v) = means.split_at(lines[0].places.len());
        for (line, of, metrics) in
            [(&lines[0], of_u, [U_RMS, U_GHIA]), (&lines[1], of_v, [V_RMS, V_GHIA])]
        {
            for (metric, expected) in metrics.into_iter().zip([&line.computed, &line.ghia]) {
                record.put(metric, rms(of.iter().zip(expected).map(|(a, b)| a - b)));
            }
            let profile = Profile::default().with("place", "L", line.places.clone()).with(
                line.quantity,
                "U",
                of.to_vec(),
            );
            record.profiles.insert(line.quantity.into(), profile);
        }
    }
}

fn run(
    method: &Method,
    variant: &str,
    s: &CavitySettings,
    context: &Context,
) -> Result<Record, RunError> {
    let flow = flow(s, method, context)?;
    let dx = flow.medium.dx;
    let wall = |point: [f64; 2], normal: [f64; 2], speed| {
        PlaneWall::new(point.into(), normal.into(), Vector2::new(speed, 0.0))
    };
    let parts = Parts {
        mirrors: vec![
            wall([0.0, 0.0], [0.0, 1.0], 0.0),
            wall([0.0, 0.0], [1.0, 0.0], 0.0),
            wall([1.0, 1.0], [-1.0, 0.0], 0.0),
            wall([1.0, 1.0], [0.0, -1.0], 1.0),
        ],
        ..flow.parts(Domain::open(), particles(method, &flow), context)
    };
    let numbers = flow.rules.numbers([s.h_over_dx, dx]);
    let mut record = simulate::begin((NAME, variant), s, method, &numbers, context);
    let mut simulation = (method.build)(parts)?;
    let times: Vec<f64> =
        (1..=2 * SAMPLES).map(|k| s.end * (0.8 + 0.2 * k as f64 / (2 * SAMPLES) as f64)).collect();
    let mut means = Means { lines: lines(s.re)?, dx, sums: Default::default(), counts: [0; 2] };
    let pressure = |density| flow.medium.eos.pressure(density);
    (record.status, record.cost) =
        Drive::new(&mut *simulation, flow.rules.dt(), &times, &pressure, &mut means)
            .sweeps(flow.rules.sweeps())
            .at("mid-lines", &|means, simulation, _| means.sample(&*simulation))
            .run(context)?;
    let all = simulation.particles();
    if record.status == Status::Completed {
        means.measure(&mut record);
        measure(method, dx, &all, context.keep_particles, &mut record);
    }
    record.state = Some(simulate::state(&all));
    Ok(record)
}

fn measure(method: &Method, dx: f64, all: &[Particle], is_kept: bool, record: &mut Record) {
    let fluid: Vec<&Particle> = all.iter().filter(|p| p.role == Role::Fluid).collect();
    // Half of the cells of interface particles are the fluid's.
    let side = if method.first_row == FirstRow::OnSurface { 1.0 - dx } else { 1.0 };
    let volume: f64 = fluid.iter().map(|p| p.mass / p.density).sum();
    record.put(VOLUME, volume / (side * side) - 1.0);
    let is_inside = |p: &&&Particle| p.position.iter().all(|x| (0.0..=1.0).contains(x));
    record.put(OUTSIDE, (fluid.len() - fluid.iter().filter(is_inside).count()) as f64);
    if is_kept {
        let column = |of: fn(&Particle) -> f64| fluid.iter().map(|p| of(p)).collect();
        let profile = Profile::default()
            .with("x", "L", column(|p| p.position.x))
            .with("y", "L", column(|p| p.position.y))
            .with("speed", "U", column(|p| p.velocity.norm()));
        record.profiles.insert("particles".into(), profile);
    }
}

type Row = table::Row<CavitySettings, ()>;

fn table(tier: Tier) -> table::Table<CavitySettings, ()> {
    let mut table = table::Table::new(&CASE, tier);
    let sides: [&[usize]; 2] = [&[16, 22, 32], &[22, 32, 45, 64]];
    table.over((), &VARIANTS, sides, |s, n| s.n = n);
    let sides: [&[usize]; 2] = [&[32], &[32, 45, 64, 90]];
    table.over((), &VARIANTS[1..], sides, |s, n| (s.re, s.n, s.end) = (1000.0, n, 50.0));
    for row in &mut table.rows {
        let s = &row.settings;
        row.run.seconds = 0.02 * s.end * (s.n as f64 / 32.0).powi(3);
        if is_pictured(row) {
            row.run.spec = row.run.spec.clone().keep_particles();
        }
    }
    table.judge(gates);
    table
}

/// Is it the run of the picture?
fn is_pictured(row: &Row) -> bool {
    (row.variant, row.settings.n, row.settings.re) == ("consistent", 32, 1000.0)
}

fn gates(row: &Row) -> Vec<Gate> {
    Vec::new()
}

fn declaration(tier: Tier) -> Declaration {
    Declaration::default()
}

fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    Vec::new()
}
