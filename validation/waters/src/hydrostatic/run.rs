//! One run: scene, stepping, what is measured.

use solver::{EquationOfState, Particle, Role, Stepper};

use super::{HydrostaticSettings, NAME, column::Column};
use crate::water::WaterMethod;
use base::record::{Profile, Record, Status};
use harness::{
    case::RunError,
    composed::Program,
    runner::{Context, Drive},
    simulate,
};
use maths::metrics::norms::{Scale, l2};

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

/// Runs of the variants.
pub const PROGRAM: Program<HydrostaticSettings, WaterMethod> = Program {
    run,
    rules: |method, settings| Ok(Column::new(settings, method, &Context::of_rules())?.rules),
};

fn run(
    method: &WaterMethod,
    variant: &str,
    settings: &HydrostaticSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let column = Column::new(settings, method, context)?;
    let Column { medium, rules, .. } = &column;
    let mut simulation = (method.build)(column.parts(method, context))?;
    let numbers = rules.numbers([settings.h_over_dx, medium.dx]);
    let mut record = simulate::begin((NAME, variant), settings, method, &numbers, context);
    let start = ends(&column, &fluid(&*simulation));
    let mut history = History { column: &column, start, moments: Vec::new() };
    history.sample(&*simulation);
    let pressure = |density| medium.eos.pressure(density);
    (record.status, record.cost) =
        Drive::new(&mut *simulation, rules.dt(), &times(&column), &pressure, &mut history)
            .at("history", &|history, simulation, _| history.sample(&*simulation))
            .run(context)?;
    if record.status == Status::Completed {
        history.metrics(&mut record);
        record.profiles.insert("pressure".into(), profile(&column, fluid(&*simulation)));
    }
    record.profiles.insert("history".into(), history.profile());
    record.state = Some(simulate::state(&simulation.particles()));
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

base::bits! { Moment { time, pressure, level, gap, kinetic, outside } }

struct History<'a> {
    column: &'a Column,
    /// Mean heights of the lowest and of the highest particles at the start \[m\].
    start: [f64; 2],
    moments: Vec<Moment>,
}

harness::observed! { History<'_>: changes(moments), parts(), stays(column, start) }

impl History<'_> {
    fn sample(&mut self, simulation: &dyn Stepper<()>) {
        let (water, column) = (fluid(simulation), self.column);
        let (s, medium, tank) = (&column.settings, &column.medium, column.tank());
        let pressure: Vec<f64> = water.iter().map(|p| medium.eos.pressure(p.density)).collect();
        let exact: Vec<f64> = water.iter().map(|p| column.exact_pressure(p)).collect();
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
            gap: (low - self.start[0]) / medium.dx,
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
        let strip = &mut strips[((position.x / column.medium.dx + 0.25) as usize).min(last)];
        *strip = [strip[0].min(position.y), strip[1].max(position.y)];
    }
    let filled: Vec<_> = strips.into_iter().filter(|s| s[0].is_finite()).collect();
    [0, 1].map(|k| filled.iter().map(|s| s[k]).sum::<f64>() / filled.len() as f64)
}

/// Height, pressure and exact pressure of every particle, the lowest first.
fn profile(column: &Column, mut water: Vec<Particle>) -> Profile {
    water.sort_by(|a, b| a.position.y.total_cmp(&b.position.y));
    let s = &column.settings;
    let scale = s.rho * s.g * s.depth;
    let numbers = |of: &dyn Fn(&Particle) -> f64| water.iter().map(of).collect();
    Profile::default()
        .with("y", "H", numbers(&|p| p.position.y / s.depth))
        .with("p", "rho0 g H", numbers(&|p| column.medium.eos.pressure(p.density) / scale))
        .with("p_exact", "rho0 g H", numbers(&|p| column.exact_pressure(p) / scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        hydrostatic::HYDROSTATIC,
        water::{Modern, method},
    };
    use harness::method::Parts;
    use nalgebra::Vector2;

    /// Water put by hand: pressures 3 % too high, the highest row 0.2 dx up and half of the lowest one
    /// 0.1 dx down, all of it at 0.02 (g H)^(1/2), two particles out of the tank.
    #[test]
    fn what_is_measured_of_water_at_rest_is_what_was_done_to_it() {
        let spec = HYDROSTATIC.spec("modern", |_| {});
        let settings: HydrostaticSettings =
            serde_json::from_value(spec.settings).expect("settings");
        let (method, context) = (method::<Modern>(), Context::default());
        let column = Column::new(&settings, &method, &context).expect("sound settings");
        let (dx, g) = (column.medium.dx, settings.g);
        let water = || -> Vec<Particle> {
            let all = column.parts(&method, &context).particles.into_iter();
            all.filter(|p| p.role == Role::Fluid).collect()
        };
        let simulation = |particles: Vec<Particle>| {
            let parts = Parts { particles, ..column.parts(&method, &context) };
            let mut simulation = (method.build)(parts).expect("a scene");
            simulation.advance(0.0, 1.0, &mut ());
            simulation
        };
        let start = ends(&column, &water());
        assert!((start[0] - 0.5 * dx).abs() < 1e-12 && (start[1] - 19.5 * dx).abs() < 1e-12);
        let mut history = History { column: &column, start, moments: Vec::new() };
        history.sample(&*simulation(water()));
        let mut changed = water();
        for p in &mut changed {
            let exact = column.exact_pressure(p);
            p.density = column.medium.eos.density(1.03 * exact);
            p.velocity = Vector2::new(0.012, -0.016) * (g * settings.depth).sqrt();
        }
        history.sample(&*simulation(changed.clone()));
        for p in &mut changed {
            match p.position.y / dx {
                y if y > 19.0 => p.position.y += 0.2 * dx,
                y if y < 1.0 && p.position.x < 5.0 * dx => p.position.y -= 0.1 * dx,
                _ => {}
            }
        }
        history.sample(&*simulation(changed.clone()));
        (changed[50].position.x, changed[61].position.x) = (-0.01 * dx, 10.01 * dx);
        history.sample(&*simulation(changed));
        let is = |value: f64, expected: f64| {
            assert!((value - expected).abs() < 1e-9, "{value} instead of {expected}");
        };
        let [first, pressed, moved, out] = &history.moments[..] else { panic!("four moments") };
        is(first.pressure + first.level + first.gap + first.kinetic, 0.0);
        is(pressed.pressure, 0.03);
        is(pressed.kinetic, 0.5 * 0.02 * 0.02);
        is(moved.level, 0.2 / 20.0);
        is(moved.gap, -0.05);
        assert_eq!([first, pressed, moved, out].map(|m| m.outside), [0, 0, 0, 2]);
        let mut record = Record::new(NAME, "modern", serde_json::json!({}), 1);
        for (moment, time) in history.moments.iter_mut().zip([0.0, 2.98, 3.02, 4.0]) {
            moment.time = time;
        }
        (history.moments[1].kinetic, history.moments[2].kinetic) = (0.5, 3e-4);
        history.metrics(&mut record);
        let value = |metric: base::record::MetricKey| record.value(metric).expect("a metric");
        is(value(KINETIC), 3e-4);
        is(value(OUTSIDE), 2.0);
        is(value(LEVEL_DRIFT), 0.01);
        is(value(P_L2), history.moments[3].pressure);
        is(value(GAP), history.moments[3].gap);
    }
}
