//! One run: scene, stepping, what is measured.

use solver::{EquationOfState, Integrator, Kernel, Particle, Role, Scheme, Simulation};

use super::{
    Column, HydrostaticSettings, NAME,
    column::{Part, TankWall, TensilePart},
};
use base::{
    number,
    record::{self, Metric, Profile, Record, Status},
};
use harness::{
    case::RunError,
    runner::{self, Context, Frames},
};
use maths::{
    metrics::norms::{Scale, l2},
    theory::Stepping,
};

/// One run of a composition.
pub fn run<K, R, D, W, I>(
    variant: &str,
    settings: &HydrostaticSettings,
    context: &Context,
) -> Result<Record, RunError>
where
    K: Kernel,
    R: TensilePart,
    D: Part,
    W: TankWall,
    I: Stepping,
{
    let column = Column::new::<K, D, I>(settings, context.allow_unstable)?;
    let mut scene = column.scene::<K, R, D, W, I>();
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let json = serde_json::to_value(settings).unwrap_or_default();
    let mut record = Record::new(NAME, variant, json, context.threads.max(1));
    describe(&column, [K::NAME, <I as Integrator<()>>::NAME, W::NAME], &mut record);
    let frames = Frames::of(context)?;
    let mut seen = Seen::new::<_, W>(&column, &simulation);
    let mut failed = None;
    let stops = stops(&column, context);
    let (status, cost) = runner::drive(
        &mut simulation,
        column.dt,
        &stops,
        context,
        &mut (),
        &mut |simulation, _| {
            seen.look(&column, simulation);
            if let Some(frames) = &frames {
                failed = failed.take().or(frames.write(simulation, &column.eos).err());
            }
        },
    );
    if let Some(error) = failed {
        return Err(error.into());
    }
    if status == Status::Completed {
        seen.metrics(&mut record);
        record.profiles.insert("pressure".into(), profile(&column, &seen, &water(&simulation)));
    }
    record.profiles.insert("history".into(), seen.history());
    record.state = Some(record::digest(&state(&simulation.particles())));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

/// What the run chose.
fn describe(column: &Column, [kernel, integrator, walls]: [&str; 3], record: &mut Record) {
    let numbers = [
        ("h/dx", column.settings.h_over_dx),
        ("dx [m]", column.dx),
        ("c0 [m/s]", column.eos.sound_speed),
        ("dt [s]", column.dt),
        ("dt/limit", column.dt / column.dt_limit),
    ];
    let words = [("kernel", kernel), ("integrator", integrator), ("walls", walls)];
    let numerics = &mut record.numerics;
    numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    numerics.extend(words.map(|(name, word)| (name.to_string(), word.into())));
}

/// Once a period and at the end, and at the times of frames \[s\].
fn stops(column: &Column, context: &Context) -> Vec<f64> {
    let end = column.end();
    let frames = context.frames.as_ref().map_or(1, |(_, count)| *count.max(&1));
    let frames = (1..=frames).map(|k| end * (k as f64 / frames as f64));
    let mut stops: Vec<f64> = (1..)
        .map(|k| f64::from(k) * column.period())
        .take_while(|t| *t < end)
        .chain(frames)
        .collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup();
    stops
}

fn water<S: Scheme<Extra = ()>>(simulation: &Simulation<S>) -> Vec<Particle> {
    simulation.particles().into_iter().filter(|p| p.role == Role::Fluid).collect()
}

fn state(particles: &[Particle]) -> Vec<f64> {
    let numbers =
        |p: &Particle| [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density];
    particles.iter().flat_map(numbers).collect()
}

/// What is seen of the water at one time.
struct Moment {
    /// t \[4 H/c₀\].
    time: f64,
    /// rms of p − p_exact over rms of p_exact, over particles.
    pressure: f64,
    /// Mean height of the highest particles less that at the start \[H\].
    level: f64,
    /// Mean height of the lowest particles less that at the start \[dx\].
    gap: f64,
    /// Kinetic energy \[M g H\].
    kinetic: f64,
    outside: usize,
}

struct Seen {
    /// Height of the surface \[m\].
    surface: f64,
    /// Mean heights of the lowest and of the highest particles at the start \[m\].
    start: [f64; 2],
    moments: Vec<Moment>,
}

impl Seen {
    fn new<S: Scheme<Extra = ()>, W: TankWall>(
        column: &Column,
        simulation: &Simulation<S>,
    ) -> Self {
        let surface = column.level::<W>();
        Self { surface, start: ends(column, &water(simulation)), moments: Vec::new() }
    }

    /// The exact pressure at the place of a particle \[Pa\].
    fn exact(&self, column: &Column, p: &Particle) -> f64 {
        column.exact.pressure(self.surface - p.position.y)
    }

    fn look<S: Scheme<Extra = ()>>(&mut self, column: &Column, simulation: &Simulation<S>) {
        let water = water(simulation);
        let (s, tank) = (&column.settings, column.tank());
        let pressure: Vec<f64> = water.iter().map(|p| column.eos.pressure(p.density)).collect();
        let exact: Vec<f64> = water.iter().map(|p| self.exact(column, p)).collect();
        let error = Scale::rms(&exact).and_then(|scale| l2(&pressure, &exact, scale));
        let [low, high] = ends(column, &water);
        let (mass, kinetic) = water.iter().fold((0.0, 0.0), |(mass, kinetic), p| {
            (mass + p.mass, kinetic + 0.5 * p.mass * p.velocity.norm_squared())
        });
        let is_outside = |p: &&Particle| {
            let x = p.position;
            !(0.0..=tank.width()).contains(&x.x) || x.y < 0.0
        };
        self.moments.push(Moment {
            time: simulation.time() / column.period(),
            pressure: error.unwrap_or(f64::NAN),
            level: (high - self.start[1]) / s.depth,
            gap: (low - self.start[0]) / column.dx,
            kinetic: kinetic / (mass * s.g * s.depth),
            outside: water.iter().filter(is_outside).count(),
        });
    }

    fn metrics(&self, record: &mut Record) {
        let Some(last) = self.moments.last() else { return };
        let mut put = |name: &str, value: f64, formula: &str| {
            record.metrics.insert(name.into(), Metric::new(value, "-", formula));
        };
        put(
            "p_l2",
            last.pressure,
            "rms(p - p_exact)/rms(p_exact) over particles, p_exact at their places, at the end",
        );
        put(
            "level_drift",
            last.level,
            "mean height of the highest particle in each strip of width dx, end less start, over H",
        );
        put(
            "gap",
            last.gap,
            "mean height of the lowest particle in each strip of width dx, end less start, over dx",
        );
        let later = self.moments.iter().filter(|m| m.time >= 0.75 * last.time);
        let kinetic = later.map(|m| m.kinetic).fold(0.0, f64::max);
        put(
            "kinetic",
            kinetic,
            "largest sum m v^2/2 over M g H, once a period over the last quarter of the run",
        );
        let outside = self.moments.iter().map(|m| m.outside).max().unwrap_or_default();
        put("outside", outside as f64, "most particles beyond bottom or sides, once a period");
    }

    fn history(&self) -> Profile {
        let column = |of: fn(&Moment) -> f64| self.moments.iter().map(of).collect();
        Profile::default()
            .with("t", "4 H/c0", column(|m| m.time))
            .with("p_l2", "-", column(|m| m.pressure))
            .with("level_drift", "H", column(|m| m.level))
            .with("gap", "dx", column(|m| m.gap))
            .with("kinetic", "M g H", column(|m| m.kinetic))
    }
}

/// Mean heights of the lowest and of the highest particles in strips of width dx \[m\].
fn ends(column: &Column, water: &[Particle]) -> [f64; 2] {
    let mut strips = vec![[f64::INFINITY, f64::NEG_INFINITY]; column.settings.columns];
    let last = strips.len() - 1;
    for Particle { position, .. } in water {
        // Columns start at whole or half spacings; a float below 0 becomes 0.
        let strip = &mut strips[((position.x / column.dx + 0.25) as usize).min(last)];
        *strip = [strip[0].min(position.y), strip[1].max(position.y)];
    }
    let filled: Vec<_> = strips.into_iter().filter(|s| s[0].is_finite()).collect();
    [0, 1].map(|k| filled.iter().map(|s| s[k]).sum::<f64>() / filled.len() as f64)
}

/// Height, pressure and exact pressure of every particle, the lowest first.
fn profile(column: &Column, seen: &Seen, water: &[Particle]) -> Profile {
    let mut water = water.to_vec();
    water.sort_by(|a, b| a.position.y.total_cmp(&b.position.y));
    let s = &column.settings;
    let scale = s.rho * s.g * s.depth;
    let numbers = |of: &dyn Fn(&Particle) -> f64| water.iter().map(of).collect();
    Profile::default()
        .with("y", "H", numbers(&|p| p.position.y / s.depth))
        .with("p", "rho0 g H", numbers(&|p| column.eos.pressure(p.density) / scale))
        .with("p_exact", "rho0 g H", numbers(&|p| seen.exact(column, p) / scale))
}
