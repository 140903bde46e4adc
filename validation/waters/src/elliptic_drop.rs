//! A free drop that a uniform strain pulls into an ellipse (Monaghan 1994): free surface, no walls, and
//! an exact solution.

use harness::composed::{Composed, Composition, lacking};
use maths::theory::Stepping;
use nalgebra::Vector2;
use solver::{
    ArtificialStress, ArtificialViscosity, BodyForce, Compose, Continuity, CubicSpline,
    DensityDiffusion, Domain, EquationOfState, Integrator, Kernel, Leapfrog, Open, Particle,
    PredictorCorrector, Pressure, Scene, Scheme, Simulation, Tait, WendlandC2, Xsph,
};

use super::water::{Ingredient, Ledger, Medium, OPTIONAL};
use base::{
    gate::{Bound, Evidence, Gate},
    number,
    record::{self, Metric, Profile, Record},
};
use harness::{
    case::{Case, Planned, RunError, Tier, Variant},
    runner::{self, Context},
    suite::{JudgedRun, Study},
};
use maths::exact::EllipticDrop as Exact;
use report::{
    self, Axis, Cell, Colour, ColourMap, Column, Figure, ParticleMap, Plot, Series, Table, sig,
};

crate::water_settings! {
    /// Settings of a drop that is cut from a square lattice.
    pub struct DropSettings {
        /// particles across the drop
        n: usize ["-"] in 6..=2000 = 40,
        /// radius R
        radius: f64 ["m"] in 1e-9..=1e6 = 1.0,
        /// initial rate of strain A
        strain: f64 ["1/s"] in 1e-9..=1e9 = 100.0,
        /// gravity, in which the drop falls freely
        gravity: f64 ["A^2 R"] in 0.0..=100.0 = 0.0,
        /// sound speed; the fastest water moves at 1.4 A R
        c0: f64 ["A R"] in 1.0..=1e4 = 14.0,
        /// end of the run; at 0.8 the drop is four times as long as wide
        end: f64 ["1/A"] in 1e-6..=10.0 = 0.8,
    }
}

const NAME: &str = "elliptic_drop";
/// Samples of a run.
const SAMPLES: usize = 80;

type Water<R = ()> = (Pressure<Tait, R>, ArtificialViscosity<Tait>, BodyForce);
type Seed =
    Compose<CubicSpline, Water<ArtificialStress>, (Continuity, Xsph), Open, PredictorCorrector>;
type Modern = Compose<WendlandC2, Water, (Continuity, DensityDiffusion), Open, Leapfrog>;
type Plain = Compose<WendlandC2, (Pressure<Tait>, BodyForce), Continuity, Open, Leapfrog>;

fn variant<S>(
    name: &'static str,
    about: &'static str,
    adjust: fn(&mut DropSettings),
) -> Composition<DropSettings>
where
    S: Scheme<Extra = (), Walls = Open>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
    S::Integrator: Stepping,
{
    let lacks = lacking(OPTIONAL, &[S::Forces::uses(), S::Drift::uses()].concat());
    Composition { variant: Variant { name, about }, adjust, run: run::<S>, lacks }
}

/// The strain moves rows apart to two spacings, and the Wendland kernel needs h/dx of 1.2 at least for
/// its sums to be those of a continuum: 2.5 leaves 1.25 at the end.
fn modern(s: &mut DropSettings) {
    (s.h_over_dx, s.alpha, s.courant) = (2.5, 0.02, 0.6);
}

fn variants() -> Vec<Composition<DropSettings>> {
    vec![
        variant::<Seed>(
            "seed",
            "the paper's terms: cubic spline, predictor-corrector, artificial viscosity and stress, XSPH",
            |_| {},
        ),
        variant::<Modern>(
            "modern",
            "Wendland C2, h/dx 2.5, leapfrog, density diffusion, little artificial viscosity",
            modern,
        ),
        variant::<Plain>("plain", "modern without dissipation: (3), (5) and (7) alone", modern),
    ]
}

/// A drop as particles, and the exact one of the same second moment.
struct Drop {
    medium: Medium,
    exact: Exact,
    particles: Vec<Particle>,
}

impl Drop {
    fn new(s: &DropSettings) -> Self {
        let (dx, rate) = (2.0 * s.radius / s.n as f64, s.strain * s.radius);
        let circle = Exact::circle(s.radius, s.strain);
        let tip = circle.after(s.end / s.strain);
        let gravity = Vector2::new(0.0, -s.gravity * s.strain * rate);
        let fall = gravity.norm() * s.end / s.strain;
        let speed = (tip.strain * tip.b).max(rate) + fall;
        let medium = Medium::new(s.numerics(), dx, s.c0 * rate, gravity, speed);
        let corner = Vector2::repeat(0.5 * dx - s.radius);
        let particles: Vec<Particle> = solver::lattice(corner, dx, s.n, s.n)
            .filter(|x| x.norm() <= s.radius)
            .map(|x| {
                let inside = 1.0 - x.norm_squared() / (s.radius * s.radius);
                let density = medium.eos.density(s.rho * circle.central_pressure() * inside);
                let velocity = Vector2::new(-x.x, x.y) * s.strain;
                Particle::fluid(x, velocity, density, dx * dx)
            })
            .collect();
        let exact = Exact::circle(shape(particles.iter().map(seen)).axes[0], s.strain);
        Self { medium, exact, particles }
    }
}

fn seen(p: &Particle) -> (f64, Vector2<f64>, Vector2<f64>) {
    (p.mass, p.position, p.velocity)
}

/// Mean place and velocity, and the semi-axes of the ellipse of the same second moments:
/// a² = 4 Σ m (x − x_c)²/Σ m.
struct Shape {
    mass: f64,
    centre: Vector2<f64>,
    velocity: Vector2<f64>,
    axes: [f64; 2],
}

fn shape(particles: impl Iterator<Item = (f64, Vector2<f64>, Vector2<f64>)> + Clone) -> Shape {
    let (mut mass, mut centre, mut velocity) = (0.0, Vector2::zeros(), Vector2::zeros());
    for (m, x, v) in particles.clone() {
        mass += m;
        centre += x * m;
        velocity += v * m;
    }
    (centre, velocity) = (centre / mass, velocity / mass);
    let squares = particles.fold(Vector2::zeros(), |sum, (m, x, _)| {
        let r: Vector2<f64> = x - centre;
        sum + r.component_mul(&r) * m
    });
    let axes = [squares.x, squares.y].map(|s| 2.0 * (s / mass).sqrt());
    Shape { mass, centre, velocity, axes }
}

/// t, semi-axes, the exact ones \[s, m\].
type Row = [f64; 5];

/// What is seen through time.
struct Seen {
    rows: Vec<Row>,
    /// Largest errors of momentum and of the place of the centre.
    free_fall: [f64; 2],
}

impl Seen {
    fn sample<S: Scheme<Extra = ()>>(&mut self, drop: &Drop, simulation: &Simulation<S>) {
        let (t, g) = (simulation.time(), drop.medium.gravity);
        let particles = simulation.particles();
        let now = shape(particles.iter().map(seen));
        let exact = drop.exact.after(t);
        self.rows.push([t, now.axes[0], now.axes[1], exact.a, exact.b]);
        let scale = drop.exact.strain * drop.exact.a + g.norm() * t;
        let velocity = (now.velocity - g * t).norm() / scale;
        let place = (now.centre - g * (0.5 * t * t)).norm() / (scale * t + drop.exact.a);
        self.free_fall = [self.free_fall[0].max(velocity), self.free_fall[1].max(place)];
    }

    fn measure(&self, record: &mut Record) {
        let worst = |k: usize| {
            let error = |row: &Row| (row[k] / row[k + 2] - 1.0).abs();
            self.rows.iter().map(error).fold(0.0, f64::max)
        };
        let mut put = |name: &str, value: f64, formula: &str| {
            record.metrics.insert(name.into(), Metric::new(value, "-", formula));
        };
        let formula = "max over samples of |a - a_exact|/a_exact, a^2 = 4 sum m (x - x_c)^2/sum m";
        put("a_error", worst(1), formula);
        put("b_error", worst(2), "the same of the semi-axis b along y, which grows");
        let formula = "max of |v_c - g t|/(A R + g t), v_c the velocity of the centre of mass";
        put("momentum_error", self.free_fall[0], formula);
        let formula = "max of |x_c - g t^2/2|/(R + (A R + g t) t), x_c the centre of mass";
        put("centre_error", self.free_fall[1], formula);
        let last = self.rows[self.rows.len() - 1];
        put("b_end", last[2] / last[4], "b/b_exact at the end");
        put("a_end", last[1] / last[3], "a/a_exact at the end");
        let names = [("t", "s"), ("a", "m"), ("b", "m"), ("a_exact", "m"), ("b_exact", "m")];
        let add = |profile: Profile, (k, (name, unit)): (usize, &(&str, &str))| {
            profile.with(name, unit, self.rows.iter().map(|row| row[k]).collect())
        };
        let series = names.iter().enumerate().fold(Profile::default(), add);
        record.profiles.insert("series".into(), series);
    }
}

fn run<S>(variant: &str, s: &DropSettings, context: &Context) -> Result<Record, RunError>
where
    S: Scheme<Extra = (), Walls = Open>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
    S::Integrator: Stepping,
{
    let drop = Drop::new(s);
    let medium = &drop.medium;
    let uses = [S::Forces::uses(), S::Drift::uses()].concat();
    let [dt, limit] =
        medium.time_step::<S::Kernel, S::Integrator>(&uses, context.allow_unstable)?;
    let (forces, drift) = (S::Forces::new::<S::Kernel>(medium), S::Drift::new::<S::Kernel>(medium));
    let mut ledger = Ledger::new(medium.water(), &forces, &drift);
    let particles = drop.particles.clone();
    let mut scene = Scene::<S>::new(medium.h, Domain::open(), particles, forces, drift, Open);
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let json = serde_json::to_value(s).unwrap_or_default();
    let mut record = Record::new(NAME, variant, json, context.threads.max(1));
    let numbers = [
        ("dx [m]", medium.dx),
        ("c0 [m/s]", medium.eos.sound_speed),
        ("dt [s]", dt),
        ("dt/limit", dt / limit),
    ];
    let numbers = numbers.map(|(name, value)| (name.to_string(), number::json(value)));
    record.numerics.extend(numbers);
    record.numerics.insert("kernel".into(), S::Kernel::NAME.into());
    record.numerics.insert("integrator".into(), S::Integrator::NAME.into());
    let mut seen = Seen { rows: Vec::new(), free_fall: [0.0; 2] };
    let times: Vec<f64> =
        (0..=SAMPLES).map(|k| s.end / s.strain * k as f64 / SAMPLES as f64).collect();
    (record.status, record.cost) =
        runner::drive(&mut simulation, dt, &times, context, &mut (), &mut |simulation, _| {
            seen.sample(&drop, simulation);
            ledger.sample(simulation);
        });
    seen.measure(&mut record);
    let start = shape(drop.particles.iter().map(self::seen));
    let kinetic = start.mass * (s.strain * start.axes[0]).powi(2) / 4.0;
    ledger.measure(kinetic, "initial kinetic energy", &mut record);
    finish(&drop, &simulation, context, &mut record);
    Ok(record)
}

/// Extents, digest and particles at the end.
fn finish<S: Scheme<Extra = ()>>(
    drop: &Drop,
    simulation: &Simulation<S>,
    context: &Context,
    record: &mut Record,
) {
    let particles = simulation.particles();
    let centre = shape(particles.iter().map(seen)).centre;
    let half = particles.iter().map(|p| (p.position - centre).y.abs()).fold(0.0, f64::max);
    let exact = drop.exact.after(simulation.time());
    let value = (half + 0.5 * drop.medium.dx) / exact.b;
    let formula =
        "distance of the outermost particle from the centre along y, plus dx/2, over b_exact";
    record.metrics.insert("tip_end".into(), Metric::new(value, "-", formula));
    let numbers =
        |p: &Particle| [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density];
    let state: Vec<[f64; 5]> = particles.iter().map(numbers).collect();
    record.state = Some(record::digest(state.as_flattened()));
    if context.keep_particles {
        let column = |f: &dyn Fn(&Particle) -> f64| particles.iter().map(f).collect();
        let profile = Profile::default()
            .with("x", "m", column(&|p| p.position.x - centre.x))
            .with("y", "m", column(&|p| p.position.y - centre.y))
            .with("p", "Pa", column(&|p| drop.medium.eos.pressure(p.density)));
        record.profiles.insert("particles".into(), profile);
    }
}

/// The drop as a [`Case`].
pub const ELLIPTIC_DROP: &dyn Case = &Composed {
    name: NAME,
    about: "A free drop in two dimensions, at first a circle, pulled into an ellipse by the uniform strain \
            that it starts with; its semi-axes follow an ordinary differential equation exactly. No wall and \
            no gravity, or gravity in which it falls freely, which must change nothing.",
    variants,
    plan,
    studies: |_, runs| vec![study(runs)],
};

/// Particles across the drop.
fn ladder(tier: Tier, variant: &str) -> &'static [usize] {
    match (tier, variant) {
        (Tier::Quick, "seed") => &[20],
        (Tier::Quick, _) => &[20, 40],
        (Tier::Full, _) => &[20, 40, 80],
    }
}

fn plan(tier: Tier) -> Vec<Planned> {
    let mut runs = Vec::new();
    for variant in ["seed", "modern", "plain"] {
        for n in ladder(tier, variant) {
            let run = Planned::new(variant, &[format!("n={n}")]);
            let run = run.taking(0.7 * (*n as f64 / 40.0).powi(3));
            runs.push(run.judged(gates(&format!("{variant}.{n}"), *n)));
        }
    }
    for narrow in ["1.5", "2"] {
        let set = ["n=40".to_string(), format!("h_over_dx={narrow}")];
        let gates = invariants(&format!("modern.h{narrow}"));
        runs.push(Planned::new("modern", &set).judged(gates));
    }
    for variant in ["seed", "modern"] {
        let set = ["n=20".into(), format!("gravity={FALL}")];
        runs.push(Planned::new(variant, &set).judged(invariants(&format!("{variant}.falling"))));
    }
    runs
}

/// Gravity of the falling drop \[A² R\].
const FALL: f64 = 1.0;

fn gate(id: &str, metric: &str, bound: Bound, evidence: Evidence, because: &str) -> Gate {
    Gate::new(format!("{NAME}.{id}.{metric}"), metric, bound, evidence, because)
}

fn gates(id: &str, n: usize) -> Vec<Gate> {
    let axes = "semi-axes within 1 % at 40 particles across; the surface is known to a share of the \
                spacing, so of first order in it";
    let bound = Bound::Below(0.01 * (40.0 / n as f64).max(0.5));
    let mut gates = invariants(id);
    gates.extend(["a_error", "b_error"].map(|m| {
        let gate = gate(id, m, bound, Evidence::Analytic, axes);
        if id.starts_with("seed") { gate.with_limitation(STRINGS) } else { gate }
    }));
    gates
}

const STRINGS: &str = "the strain leaves half a spacing along x and two along y: the cubic spline at h/dx \
                       1.5 lets particles form strings there, and artificial stress, which rises with the \
                       fourth power of W, pushes them apart";

fn invariants(id: &str) -> Vec<Gate> {
    let round_off = "forces of pairs are equal and opposite, and the only other force is gravity, which \
                     both integrators integrate exactly: round-off of some thousand steps";
    let closes = "pressure and (3) exchange energy exactly and every other term is accounted for: 0.1 % is \
                  for the time step and for sampling the powers";
    vec![
        gate(id, "momentum_error", Bound::Below(1e-11), Evidence::Invariant, round_off),
        gate(id, "centre_error", Bound::Below(1e-11), Evidence::Invariant, round_off),
        gate(id, "energy_gap", Bound::Below(1e-3), Evidence::Invariant, closes),
    ]
}

fn study(runs: &[JudgedRun]) -> Study {
    let mut study = Study::new("elliptic-drop", "Semi-axes of a free drop")
        .block(figure(runs))
        .block(table(runs));
    for variant in ["seed", "modern"] {
        let of = |gravity: f64| {
            let mut of_variant =
                runs.iter().map(|run| &run.record).filter(|r| r.variant == variant);
            of_variant.find(|r| r.setting("n") == 20.0 && r.setting("gravity") == gravity)
        };
        let (Some(still), Some(falling)) = (of(0.0), of(FALL)) else { continue };
        let change = |name: &str| (still.measured(name) - falling.measured(name)).abs();
        let because = "gravity acts on all particles alike, so a drop that falls deforms like one that \
                       does not; round-off of its places, in a flow that is smooth";
        let id = format!("{NAME}.{variant}.falls-in-shape");
        let gate = Gate::new(
            id,
            "difference of a_end and b_end",
            Bound::Below(1e-9),
            Evidence::Invariant,
            because,
        );
        study = study.judge(gate, change("a_end").max(change("b_end")));
    }
    study
}

fn figure(runs: &[JudgedRun]) -> Figure {
    let caption = "Left: semi-axes of the drop over time, 40 particles across, and the exact ones (`seed` in \
                   the full tier only). Right: the drop of the variant `modern` at the end, coloured by \
                   pressure over the exact pressure at its centre at the start; dots have the size of an \
                   initial spacing, and the strain has left two of them between rows.";
    let axes = (Axis::linear("A t [-]"), Axis::linear("semi-axis [R]"));
    let mut plot = Plot::new("", axes.0, axes.1);
    let at_40 = |variant: &str| {
        // The first: h/dx 2.5.
        let is_it = |r: &&Record| r.variant == variant && r.setting("n") == 40.0;
        runs.iter().map(|run| &run.record).find(is_it)
    };
    let points = |record: &Record, name: &str| -> Vec<(f64, f64)> {
        let Some(series) = record.profiles.get("series") else { return Vec::new() };
        let (a, r) = (record.setting("strain"), record.setting("radius"));
        let points = series.column("t").iter().zip(series.column(name));
        points.map(|(t, y)| (a * t, y / r)).collect()
    };
    let mut drop = None;
    if let Some(record) = at_40("modern") {
        let exact = |name: &str, axis| Series::line(name, points(record, axis));
        plot = plot.layer(exact("exact", "a_exact").colour(Colour::BLACK));
        plot = plot.layer(exact("", "b_exact").colour(Colour::BLACK));
        drop = Some(picture(record));
    }
    for (k, variant) in ["seed", "modern"].into_iter().enumerate() {
        let Some(record) = at_40(variant) else { continue };
        for (name, axis) in [(variant, "a"), ("", "b")] {
            let sparse = points(record, axis).into_iter().step_by(8).collect();
            let markers = Series::markers(name, sparse).colour(Colour::cycle(k));
            plot = plot.layer(markers.shape(report::Shape::cycle(k)).open());
        }
    }
    let figure = Figure::new("elliptic-drop", caption).columns(2).panel(plot);
    match drop {
        Some(drop) => figure.panel(drop).panel_size(360.0, 320.0),
        None => figure,
    }
}

fn picture(record: &Record) -> ParticleMap {
    let empty = Profile::default();
    let profile = record.profiles.get("particles").unwrap_or(&empty);
    let (a, r) = (record.setting("strain"), record.setting("radius"));
    let scale = record.setting("rho") * Exact::circle(r, a).central_pressure();
    let xy = profile.column("x").iter().zip(profile.column("y"));
    let points = xy.zip(profile.column("p")).map(|((x, y), p)| (x / r, y / r, p / scale)).collect();
    let axes = (Axis::linear("x [R]").range(-0.7, 0.7), Axis::linear("y [R]"));
    let title = format!("A t = {}", sig(record.setting("end"), 2));
    ParticleMap::new(&title, axes, "p/p(0) [-]", ColourMap::Sequential, points)
        .diameter(2.0 / record.setting("n"))
}

fn table(runs: &[JudgedRun]) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::num("particles across", "1"),
        Column::num("h/dx", "-"),
        Column::num("gravity", "A^2 R"),
        Column::num("error of a", "-"),
        Column::num("error of b", "-"),
        Column::num("tip over b", "-"),
        Column::num("energy that viscosity took", "-"),
        Column::num("that artificial stress gave", "-"),
        Column::num("energy not accounted for", "-"),
        Column::num("steps", "1"),
    ];
    let caption = "Largest errors of the semi-axes until A t = 0.8, where the drop is four times as long \
                   as wide and its rows of particles are two spacings apart: a kernel that does not reach \
                   across them has an error that no spacing takes away. Energies in units of the initial \
                   kinetic one.";
    let mut table = Table::new(caption, columns);
    for record in runs.iter().map(|run| &run.record) {
        table = table.row(vec![
            Cell::text(format!("`{}`", record.variant)),
            Cell::num(record.setting("n"), 3),
            Cell::num(record.setting("h_over_dx"), 2),
            Cell::num(record.setting("gravity"), 2),
            Cell::percent(record.measured("a_error"), 2),
            Cell::percent(record.measured("b_error"), 2),
            Cell::num(record.measured("tip_end"), 4),
            Cell::percent(-record.measured("work_viscosity"), 2),
            Cell::percent(record.measured("work_stress"), 2),
            Cell::sci(record.measured("energy_gap"), 2),
            Cell::count(record.cost.steps),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ran(variant: &str, set: &[&str]) -> Record {
        let set: Vec<String> = set.iter().map(|text| text.to_string()).collect();
        ELLIPTIC_DROP.run(variant, &set, &Context::default()).expect("a run")
    }

    #[test]
    fn the_particles_of_the_start_are_the_exact_drop() {
        let drop = Drop::new(&DropSettings::default());
        let start = shape(drop.particles.iter().map(seen));
        assert!(
            (start.axes[0] - 1.0).abs() < 5e-3 && (start.axes[0] - start.axes[1]).abs() < 1e-12
        );
        assert!(start.velocity.norm() < 1e-12 && start.centre.norm() < 1e-12);
        let pressure = |p: &Particle| drop.medium.eos.pressure(p.density);
        let most = drop.particles.iter().map(pressure).fold(0.0, f64::max);
        let exact = 1000.0 * drop.exact.central_pressure();
        assert!((most / exact - 1.0).abs() < 0.02, "{most} {exact}");
    }

    #[test]
    fn a_drop_falls_freely_and_keeps_its_momentum() {
        for variant in ["seed", "modern", "plain"] {
            let short = ["n=12", "end=0.2"];
            let (still, falling) =
                (ran(variant, &short), ran(variant, &[&short[..], &["gravity=2"]].concat()));
            for record in [&still, &falling] {
                assert!(record.measured("momentum_error") < 1e-13);
                assert!(record.measured("centre_error") < 1e-13);
            }
            let difference = still.measured("b_end") - falling.measured("b_end");
            assert!(difference.abs() < 1e-10, "{variant}: {difference:e}");
        }
    }

    #[test]
    fn a_drop_that_makes_no_sense_is_refused() {
        let refused = |variant: &str, set: &str| {
            ELLIPTIC_DROP.run(variant, &[set.to_string()], &Context::default()).err()
        };
        assert!(matches!(refused("modern", "n=2"), Some(RunError::Setting(_))));
        assert!(matches!(refused("modern", "xsph=0.1"), Some(RunError::Unused { .. })));
        assert!(matches!(refused("modern", "courant=3"), Some(RunError::TimeStep { .. })));
        assert!(matches!(refused("modrn", "n=20"), Some(RunError::Variant { .. })));
    }
}
