//! Steady flow between two cylinders, the inner one turning: exact, with one convex and one concave wall.

use nalgebra::Vector2;
use solver::{
    Compose, Continuity, Domain, ExtrapolatingWall, Integrator, InterfaceWall, Kernel, Leapfrog,
    NoSlip, Particle, Pressure, QuinticSpline, Role, Scene, Simulation, Tait, Viscosity,
    walls::Walls,
};

use base::{
    gate::{Bound, Evidence, Gate},
    number,
    record::{self, Metric, Profile, Record, Status},
    settings::{self, Field, Settings},
};
use harness::{
    case::{self, Case, Planned, RunError, Tier, Variant},
    convergence::{Level, convergence},
    runner::{self, Context, Frames},
    suite::{JudgedRun, Study},
};
use maths::theory::Stepping;
use maths::{
    exact::TaylorCouette,
    geometry::{Curve, Row},
    metrics::norms::{Scale, l2},
    theory::{
        lattice::SquareLattice,
        time_step::{self, Medium},
    },
};
use report::{Axis, Cell, Colour, Column, Figure, Layer, Legend, Plot, Series, Shape, Table, sig};

base::settings! {
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

type Run = fn(&str, &CylinderSettings, &Context) -> Result<Record, RunError>;
type Method<W> = Compose<QuinticSpline, (Pressure<Tait>, Viscosity), Continuity, W, Leapfrog>;
type Extrapolating = ExtrapolatingWall<Tait, NoSlip>;

const NAME: &str = "taylor_couette";
const LIMIT_BOX: usize = 32;
const MOST_STEPS: f64 = 1e8;
const MOST_PARTICLES: f64 = 1e7;

/// The numbers of one run, SI units.
struct Cylinders {
    settings: CylinderSettings,
    flow: TaylorCouette,
    dx: f64,
    h: f64,
    eos: Tait,
    dt: f64,
    dt_limit: f64,
}

impl Cylinders {
    fn new(s: &CylinderSettings, allow_unstable: bool) -> Result<Self, RunError> {
        let dx = s.gap / s.layers as f64;
        let (h, speed) = (s.h_over_dx * dx, s.re * s.nu / s.gap);
        let inner = s.gap / (s.ratio - 1.0);
        // Mach 0.1, and not below what is as stiff as viscosity.
        let sound = (10.0 * speed).max(s.c0_viscous * s.nu / h);
        let medium = Medium { c0: sound, h, nu: s.nu, alpha: 0.0, delta: 0.0 };
        let lattice = SquareLattice::<QuinticSpline>::new(s.h_over_dx, s.eta2_over_h2);
        let modes = time_step::modes(&lattice, LIMIT_BOX, &medium);
        let cylinders = Self {
            settings: s.clone(),
            flow: TaylorCouette { inner, outer: inner + s.gap, speed },
            dx,
            h,
            eos: Tait::new(s.rho, sound),
            dt: (s.courant * h / (sound + speed)).min(s.viscous * h * h / s.nu),
            dt_limit: time_step::time_step_limit(&modes, <Leapfrog as Stepping>::THEORY),
        };
        cylinders.check(allow_unstable)?;
        Ok(cylinders)
    }

    fn check(&self, allow_unstable: bool) -> Result<(), RunError> {
        let Self { flow, dt, dt_limit: limit, .. } = self;
        let too_much = |what, value, most, setting| {
            if value > most {
                Err(RunError::TooMuch { what, value, most, setting })
            } else {
                Ok(())
            }
        };
        let area = std::f64::consts::PI * (flow.outer * flow.outer - flow.inner * flow.inner);
        let particles = area / (self.dx * self.dx);
        too_much(
            "the number of time steps",
            self.end() / dt,
            MOST_STEPS,
            "end, viscous or layers",
        )?;
        too_much("the number of particles", particles, MOST_PARTICLES, "layers or ratio")?;
        let support = QuinticSpline::SUPPORT * self.h;
        if flow.inner <= support {
            // Rows out to the support must fit into the inner cylinder.
            let (what, setting) = ("the support over the inner radius", "ratio or layers");
            return Err(RunError::TooMuch {
                what,
                value: support / flow.inner,
                most: 1.0,
                setting,
            });
        }
        if dt > limit && !allow_unstable {
            let integrator = <Leapfrog as Integrator<()>>::NAME;
            return Err(RunError::TimeStep { dt: *dt, limit: *limit, integrator });
        }
        Ok(())
    }

    fn end(&self) -> f64 {
        self.settings.end * self.settings.gap * self.settings.gap / self.settings.nu
    }

    /// Particles of a row, each with its share of the row's area.
    fn of_row(&self, row: &Row, role: Role, speed: f64) -> Vec<Particle> {
        let volume = row.spacing * self.dx;
        let particle = |x: &Vector2<f64>| {
            let around = Vector2::new(-x.y, x.x) / x.norm();
            Particle::fluid(*x, around * speed, self.settings.rho, volume).with_role(role)
        };
        row.points.iter().map(particle).collect()
    }

    /// Fluid in layers about the axis, and rows behind both cylinders, all with the velocity of the
    /// surface before them.
    fn particles<W: CylinderWall>(&self) -> Vec<Particle> {
        let (dx, flow) = (self.dx, &self.flow);
        let inner = Curve::circle(Vector2::zeros(), flow.inner, true, dx);
        let outer = Curve::circle(Vector2::zeros(), flow.outer, false, dx);
        let (nearest, layers) = match W::FIRST {
            0.0 => (1.0, self.settings.layers - 1),
            first => (first, self.settings.layers),
        };
        let depths = (0..layers).map(|k| -(nearest + k as f64) * dx);
        let mut particles: Vec<Particle> =
            depths.flat_map(|d| self.of_row(&inner.row(d, dx), Role::Fluid, 0.0)).collect();
        let support = QuinticSpline::SUPPORT * self.h;
        for (curve, speed) in [(inner, flow.speed), (outer, 0.0)] {
            for row in curve.rows_behind(dx, W::FIRST, support) {
                let role = if row.depth == 0.0 { Role::Interface } else { Role::Wall };
                particles.extend(self.of_row(&row, role, speed));
            }
        }
        particles
    }

    fn scene<W: CylinderWall>(&self) -> Scene<Method<W>> {
        let s = &self.settings;
        let viscosity = Viscosity { mu: s.rho * s.nu, eta2: s.eta2_over_h2 * self.h * self.h };
        let forces = (Pressure::new(self.eos), viscosity);
        let particles = self.particles::<W>();
        Scene::new(self.h, Domain::open(), particles, forces, Continuity, W::walls(self))
    }
}

/// Walls of particles behind a curve.
trait CylinderWall: Walls<()> {
    const NAME: &'static str;
    /// Depth of the first row \[dx\].
    const FIRST: f64;
    fn walls(cylinders: &Cylinders) -> Self;
}

impl CylinderWall for InterfaceWall {
    const NAME: &'static str = "interface-wall";
    const FIRST: f64 = 0.0;
    fn walls(_: &Cylinders) -> Self {
        Self
    }
}

impl CylinderWall for Extrapolating {
    const NAME: &'static str = "extrapolating-wall";
    const FIRST: f64 = 0.5;
    /// Without the centripetal acceleration of the inner surface: the pressure that balances it is below
    /// Mach² = 1e-2 of ρ c², and the flow around the axis does not depend on it.
    fn walls(cylinders: &Cylinders) -> Self {
        Self::no_slip(cylinders.eos, Vector2::zeros())
    }
}

fn run<W: CylinderWall>(
    variant: &str,
    settings: &CylinderSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let cylinders = Cylinders::new(settings, context.allow_unstable)?;
    let mut scene = cylinders.scene::<W>();
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let json = serde_json::to_value(settings).unwrap_or_default();
    let mut record = Record::new(NAME, variant, json, context.threads.max(1));
    describe::<W>(&cylinders, &mut record);
    let frames = Frames::of(context)?;
    let count = context.frames.as_ref().map_or(1, |(_, count)| *count.max(&1));
    let stops: Vec<f64> =
        (1..=count).map(|k| cylinders.end() * (k as f64 / count as f64)).collect();
    let (mut failed, dt) = (None, cylinders.dt);
    let (status, cost) =
        runner::drive(&mut simulation, dt, &stops, context, &mut (), &mut |simulation, _| {
            if let Some(frames) = &frames {
                failed = failed.take().or(frames.write(simulation, &cylinders.eos).err());
            }
        });
    if let Some(error) = failed {
        return Err(error.into());
    }
    if status == Status::Completed {
        measure(&cylinders, &simulation, &mut record);
    }
    let numbers =
        |p: &Particle| [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density];
    let state: Vec<[f64; 5]> = simulation.particles().iter().map(numbers).collect();
    record.state = Some(record::digest(state.as_flattened()));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

fn describe<W: CylinderWall>(cylinders: &Cylinders, record: &mut Record) {
    let numbers = [
        ("h/dx", cylinders.settings.h_over_dx),
        ("dx [m]", cylinders.dx),
        ("V [m/s]", cylinders.flow.speed),
        ("c0 [m/s]", cylinders.eos.sound_speed),
        ("dt [s]", cylinders.dt),
        ("dt/limit", cylinders.dt / cylinders.dt_limit),
    ];
    let integrator = <Leapfrog as Integrator<()>>::NAME;
    let words = [("kernel", QuinticSpline::NAME), ("integrator", integrator), ("walls", W::NAME)];
    let numerics = &mut record.numerics;
    numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    numerics.extend(words.map(|(name, word)| (name.to_string(), word.into())));
}

fn measure<W: CylinderWall>(
    cylinders: &Cylinders,
    simulation: &Simulation<Method<W>>,
    record: &mut Record,
) {
    let flow = &cylinders.flow;
    let mut fluid: Vec<[f64; 3]> = simulation
        .particles()
        .iter()
        .filter(|p| p.role == Role::Fluid)
        .map(|p| {
            let (x, v, r) = (p.position, p.velocity, p.position.norm());
            [r, x.perp(&v) / r, x.dot(&v) / r]
        })
        .collect();
    fluid.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let around: Vec<f64> = fluid.iter().map(|f| f[1]).collect();
    let exact: Vec<f64> = fluid.iter().map(|f| flow.velocity(f[0])).collect();
    let error = Scale::rms(&exact).and_then(|scale| l2(&around, &exact, scale));
    let square = fluid.iter().map(|f| f[2] * f[2]).sum::<f64>() / fluid.len() as f64;
    let outside = fluid.iter().filter(|f| !(flow.inner..=flow.outer).contains(&f[0])).count();
    let mut put = |name: &str, value: f64, formula: &str| {
        record.metrics.insert(name.into(), Metric::new(value, "-", formula));
    };
    put(
        "l2",
        error.unwrap_or(f64::NAN),
        "rms(u - u_exact)/rms(u_exact) over particles, u the velocity around the axis",
    );
    put("radial_rms", square.sqrt() / flow.speed, "rms of the radial velocity over V");
    put(
        "outside",
        outside as f64,
        "particles inside of the inner or outside of the outer cylinder",
    );
    let column = |of: &dyn Fn(&[f64; 3]) -> f64| fluid.iter().map(of).collect();
    let profile = Profile::default()
        .with("r", "inner radius", column(&|f| f[0] / flow.inner))
        .with("u", "V", column(&|f| f[1] / flow.speed))
        .with("u_exact", "V", column(&|f| flow.velocity(f[0]) / flow.speed));
    record.profiles.insert("velocity".into(), profile);
}

const VARIANTS: [(Variant, Run); 2] = [
    (
        Variant {
            name: InterfaceWall::NAME,
            about: "interface and wall particles of the paper, on and behind both cylinders",
        },
        run::<InterfaceWall>,
    ),
    (
        Variant {
            name: Extrapolating::NAME,
            about: "wall particles behind both cylinders that extrapolate velocity and pressure",
        },
        run::<Extrapolating>,
    ),
];

/// The flow as a [`Case`].
pub struct Gap;

fn settings(set: &[String]) -> Result<CylinderSettings, RunError> {
    let mut settings = CylinderSettings::default();
    settings::apply(&mut settings, set)?;
    settings.validate()?;
    Ok(settings)
}

impl Case for Gap {
    fn name(&self) -> &'static str {
        NAME
    }

    fn about(&self) -> &'static str {
        "Viscous flow from rest between two cylinders, the inner one turning, until it is steady: u = A r + \
         B/r, exact. Both walls are curved, the inner one convex and the outer one concave, and made of \
         rows of particles that are spaced by their own arc length."
    }

    fn variants(&self) -> Vec<Variant> {
        VARIANTS.iter().map(|(variant, _)| *variant).collect()
    }

    fn fields(&self) -> &'static [Field] {
        CylinderSettings::FIELDS
    }

    fn settings(&self, variant: &str, set: &[String]) -> Result<serde_json::Value, RunError> {
        case::find(NAME, &VARIANTS, variant, |v| v.0.name)?;
        Ok(serde_json::to_value(settings(set)?).unwrap_or_default())
    }

    fn run(&self, variant: &str, set: &[String], context: &Context) -> Result<Record, RunError> {
        let (_, run) = case::find(NAME, &VARIANTS, variant, |v| v.0.name)?;
        run(variant, &settings(set)?, context)
    }

    fn plan(&self, tier: Tier) -> Vec<Planned> {
        let levels = levels(tier);
        let all = VARIANTS.iter().flat_map(|(v, _)| levels.iter().map(move |n| (v.name, *n)));
        all.map(|(name, n)| Planned::new(name, &[format!("layers={n}")]).judged(gates(name, n)))
            .collect()
    }

    fn studies(&self, tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
        vec![study(tier, runs)]
    }
}

fn levels(tier: Tier) -> &'static [usize] {
    match tier {
        Tier::Quick => &[8, 10, 13],
        Tier::Full => &[8, 11, 16, 22, 32],
    }
}

fn gates(variant: &str, layers: usize) -> Vec<Gate> {
    let id = |metric: &str| format!("{NAME}.{variant}.{layers}.{metric}");
    let (across, of_plates) = (layers as f64, [1.9, 0.22]);
    // The matrix of plane Poiseuille flow at 10 and 20 rows: 1.9e-2, 4.6e-3; 2.2e-2, 1.0e-2.
    let most = match variant {
        "extrapolating-wall" => of_plates[0] / (across * across),
        _ => of_plates[1] / across,
    };
    vec![
        Gate::new(
            id("l2"),
            "l2",
            Bound::Below(most),
            Evidence::Theory,
            "curved walls cost no more than flat ones: the error of plane Poiseuille flow, which bends more, \
             by the row-reduced matrix of the same wall, 1.9/N^2 where it extrapolates, 0.22/N with \
             interface particles",
        ),
        Gate::new(
            id("outside"),
            "outside",
            Bound::Equals(0.0),
            Evidence::Invariant,
            "no particle passes a cylinder",
        ),
    ]
}

/// The runs of a variant with their spacings, coarse to fine.
fn ladder<'a>(tier: Tier, runs: &'a [JudgedRun], variant: &str) -> Vec<(usize, &'a Record)> {
    let records = runs.iter().map(|run| &run.record).filter(|r| r.variant == variant);
    levels(tier).iter().copied().zip(records).collect()
}

fn error(record: &Record) -> f64 {
    record.measured("l2")
}

fn levels_of(ladder: &[(usize, &Record)]) -> Vec<Level> {
    let level =
        |(n, record): &(usize, &Record)| Level { spacing: 1.0 / *n as f64, value: error(record) };
    ladder.iter().map(level).collect()
}

/// Profiles of the finest level, and error over spacing.
fn study(tier: Tier, runs: &[JudgedRun]) -> Study {
    let mut study = Study::new("taylor-couette", "Curved walls: flow between cylinders")
        .block(figure(tier, runs))
        .block(table(tier, runs));
    let of_first = "interface particles carry the velocity of the wall, and so do the rows behind: first \
                    order, as in the row-reduced matrix of flat walls; 0.3 either way tells it from second \
                    order, whatever the number of levels";
    let of_second = "walls that extrapolate linearly: second order, as in the row-reduced matrix of flat \
                     walls; 0.3 either way tells it from first order, whatever the number of levels, and \
                     not from an order that falls slowly";
    for (variant, expected, because) in
        [(InterfaceWall::NAME, 1.0, of_first), (Extrapolating::NAME, 2.0, of_second)]
    {
        let found = convergence(&levels_of(&ladder(tier, runs, variant)));
        let bound = Bound::Within(expected - 0.3, expected + 0.3);
        let id = format!("{NAME}.{variant}.order");
        let gate = Gate::new(id, "order", bound, Evidence::Theory, because);
        study = study.judge(gate, found.map_or(f64::NAN, |c| c.order));
    }
    study.prose(FALLING)
}

/// What is known of the local orders, measured once outside of the plan.
const FALLING: &str = "From one spacing to the next the order of walls that extrapolate falls, from \
     1.9 at 8 to 11 spacings to 1.6 at 22 to 32, and the scatter of a fit through all levels does not say \
     so. Part of it is the start: run by hand to 2 d^2/nu, where nothing of it is left, the orders from 8 to \
     16 and from 16 to 32 are 1.89 and 1.76, and the error at 32 is 0.00045 in place of 0.00048. The rest \
     depends on how many neighbours a sum has: at h/dx = 1.1, 1.2 and 1.5 the two orders are 1.93 and 1.82, \
     1.99 and 1.98, 2.06 and 1.80. So it is an error of the discrete sums, which a smaller spacing at the \
     same h/dx does not lessen, in a layer that does become thinner, near the walls or where rings meet; \
     which of these is not known, and 1.2 may be a place where parts cancel. A sound speed twice as high \
     moves the errors at 16 and 22 by 0.1 %, half the time step by 0.3 %.";

fn figure(tier: Tier, runs: &[JudgedRun]) -> Figure {
    let finest = levels(tier).last().copied().unwrap_or_default();
    let caption = format!(
        "Velocity around the axis over the radius at t = 1 d^2/nu, every seventeenth particle, {finest} \
         spacings across the gap, on the exact line A r + B/r (left), and the error over the spacing, with \
         the slopes of first and second order (right). Re = V d/nu = 0.5, outer radius twice the inner one."
    );
    let mut over = Plot::new("", Axis::linear("r/inner radius [-]"), Axis::linear("u/V [-]"));
    let mut fall = Plot::new("", Axis::log("dx/d [-]"), Axis::log("relative L2 error [-]"));
    for (k, (Variant { name, .. }, _)) in VARIANTS.iter().enumerate() {
        let ladder = ladder(tier, runs, name);
        let points = levels_of(&ladder).iter().map(|l| (l.spacing, l.value)).collect();
        fall = fall.layer(Series::line_markers(*name, points).cycle(k));
        let last = ladder.last().and_then(|(_, record)| record.profiles.get("velocity"));
        let Some(profile) = last else { continue };
        let [r, u, exact] = ["r", "u", "u_exact"].map(|name| profile.column(name));
        if k == 0 {
            let line = r.iter().zip(exact).map(|(r, u)| (*r, *u)).collect();
            over = over.layer(Series::line("exact", line).colour(Colour::BLACK));
        }
        let few = r.iter().zip(u).step_by(17).map(|(r, u)| (*r, *u)).collect();
        let markers = Series::markers(*name, few).colour(Colour::cycle(k));
        over = over.layer(markers.shape(Shape::cycle(k)).open().size(5.0));
    }
    fall = fall.layer(Layer::slope(1.0)).layer(Layer::slope(2.0));
    Figure::new("taylor-couette", caption)
        .columns(2)
        .panel(over.legend(Legend::Auto))
        .panel(fall.legend(Legend::Hidden))
        .panel_size(420.0, 300.0)
}

fn table(tier: Tier, runs: &[JudgedRun]) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::num("spacings across", "-"),
        Column::num("error of u", "-"),
        Column::num("radial velocity", "V"),
        Column::num("CPU time", "s"),
        Column::text("observed order"),
    ];
    let caption = "Errors at t = 1 d^2/nu. Order: least squares over all levels ± standard error, then that \
                   from one spacing to the next.";
    let mut table = Table::new(caption, columns);
    for (Variant { name, .. }, _) in &VARIANTS {
        let ladder = ladder(tier, runs, name);
        let order = convergence(&levels_of(&ladder)).map_or("–".to_string(), |c| {
            let local: Vec<String> = c.local_orders.iter().map(|p| format!("{p:.2}")).collect();
            let (order, error) = (sig(c.order, 3), sig(c.standard_error, 2));
            format!("{order} ± {error}; {}", local.join(", "))
        });
        for (k, (layers, record)) in ladder.iter().enumerate() {
            let is_last = k + 1 == ladder.len();
            table = table.row(vec![
                Cell::text(format!("`{name}`")),
                Cell::count(*layers as u64),
                Cell::percent(error(record), 3),
                Cell::sci(record.measured("radial_rms"), 2),
                Cell::seconds(record.cost.cpu_s),
                Cell::text(if is_last { order.clone() } else { String::new() }),
            ]);
        }
    }
    table
}
