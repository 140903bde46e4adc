//! One run: scene, stepping, what is measured.

use solver::{EquationOfState, Integrator, Kernel, Particle, Role, Scheme, Simulation, Stepper};

use super::{
    Column, HydrostaticSettings, NAME,
    column::{Part, TankWall, TensilePart},
};
use crate::water;
use base::record::{Profile, Record, Status};
use harness::{
    case::{Rules, RunError},
    runner::{self, Context},
    simulate::state,
};
use maths::{
    metrics::norms::{Scale, l2},
    theory::Stepping,
};

base::metrics! {
    P_L2 = "p_l2" ["-"]
        "rms(p - p_exact)/rms(p_exact) over particles, p_exact at their places, at the end";
    LEVEL_DRIFT = "level_drift" ["-"]
        "mean height of the highest particle in each strip of width dx, end less start, over H";
    GAP = "gap" ["-"]
        "mean height of the lowest particle in each strip of width dx, end less start, over dx";
    KINETIC = "kinetic" ["-"]
        "largest sum m v^2/2 over M g H, once a period over the last quarter of the run";
    OUTSIDE = "outside" ["-"] "most particles beyond bottom or sides, once a period";
}

/// What the rules choose.
pub fn rules<K: Kernel, D: Part, I: Stepping>(s: &HydrostaticSettings) -> Result<Rules, RunError> {
    let Column { dt, dt_limit, eos, .. } = Column::new::<K, D, I>(s, true)?;
    Ok(Rules { dt, dt_limit, sound_speed: eos.sound_speed })
}

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
    let numbers = [
        ("h/dx", column.settings.h_over_dx),
        ("dx [m]", column.dx),
        ("c0 [m/s]", column.eos.sound_speed),
        ("dt [s]", column.dt),
        ("dt/limit", column.dt / column.dt_limit),
    ];
    let integrator = <I as Integrator<()>>::NAME;
    let words = [("kernel", K::NAME), ("integrator", integrator), ("walls", W::NAME)];
    let mut record = water::begin((NAME, variant), settings, numbers, words, context);
    let mut history = History::new::<_, W>(&column, &simulation);
    let pressure = |density| column.eos.pressure(density);
    let (status, cost) = runner::drive(
        &mut simulation,
        column.dt,
        &times(&column),
        context,
        &mut (),
        &pressure,
        &mut |simulation, _| history.sample(&column, simulation),
    )?;
    if status == Status::Completed {
        history.metrics(&mut record);
        record.profiles.insert("pressure".into(), profile(&column, &history, &fluid(&simulation)));
    }
    record.profiles.insert("history".into(), history.profile());
    record.state = Some(state(&simulation.particles()));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

/// Once a period and at the end \[s\].
fn times(column: &Column) -> Vec<f64> {
    let end = column.end();
    let periods = (1..).map(|k| f64::from(k) * column.period()).take_while(|t| *t < end);
    periods.chain([end]).collect()
}

fn fluid(simulation: &dyn Stepper<()>) -> Vec<Particle> {
    simulation.particles().into_iter().filter(|p| p.role == Role::Fluid).collect()
}

/// What is measured of the water at one time.
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

struct History {
    /// Height of the surface \[m\].
    surface: f64,
    /// Mean heights of the lowest and of the highest particles at the start \[m\].
    start: [f64; 2],
    moments: Vec<Moment>,
}

impl History {
    fn new<S: Scheme<Extra = ()>, W: TankWall>(
        column: &Column,
        simulation: &Simulation<S>,
    ) -> Self {
        let surface = column.level::<W>();
        Self { surface, start: ends(column, &fluid(simulation)), moments: Vec::new() }
    }

    /// The exact pressure at the place of a particle \[Pa\].
    fn exact(&self, column: &Column, p: &Particle) -> f64 {
        column.exact.pressure(self.surface - p.position.y)
    }

    fn sample(&mut self, column: &Column, simulation: &dyn Stepper<()>) {
        let water = fluid(simulation);
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
        record.put(P_L2, last.pressure);
        record.put(LEVEL_DRIFT, last.level);
        record.put(GAP, last.gap);
        let later = self.moments.iter().filter(|m| m.time >= 0.75 * last.time);
        let kinetic = later.map(|m| m.kinetic).fold(0.0, f64::max);
        record.put(KINETIC, kinetic);
        let outside = self.moments.iter().map(|m| m.outside).max().unwrap_or_default();
        record.put(OUTSIDE, outside as f64);
    }

    fn profile(&self) -> Profile {
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
fn profile(column: &Column, history: &History, water: &[Particle]) -> Profile {
    let mut water = water.to_vec();
    water.sort_by(|a, b| a.position.y.total_cmp(&b.position.y));
    let s = &column.settings;
    let scale = s.rho * s.g * s.depth;
    let numbers = |of: &dyn Fn(&Particle) -> f64| water.iter().map(of).collect();
    Profile::default()
        .with("y", "H", numbers(&|p| p.position.y / s.depth))
        .with("p", "rho0 g H", numbers(&|p| column.eos.pressure(p.density) / scale))
        .with("p_exact", "rho0 g H", numbers(&|p| history.exact(column, p) / scale))
}
