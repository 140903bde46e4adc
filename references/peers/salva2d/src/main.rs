//! Runs the exported problem of the folder in which it is started with salva2d: a fluid without viscosity
//! that falls between walls of particles at rest.

use std::{error::Error, fmt::Write as _, fs};

use nalgebra::Vector2;
use salva2d::{
    LiquidWorld,
    object::{Boundary, Fluid, interaction_groups::InteractionGroups},
    solver::{ArtificialViscosity, DFSPHSolver},
};
use serde_json::{Value, json};

/// Courant number of the fastest fall: the code's own coefficient, which it does not use yet.
const COURANT: f64 = 0.4;

/// Of this process, which has one thread; NaN where the system does not tell.
fn processor_seconds() -> f64 {
    let text = fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse().ok()).map_or(f64::NAN, |ns: f64| ns * 1e-9)
}

fn number(value: &Value) -> f64 {
    value["value"].as_f64().unwrap_or(f64::NAN)
}

fn numbers(value: &Value) -> Vec<f64> {
    let all = value["value"].as_array().into_iter().flatten();
    all.filter_map(Value::as_f64).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let problem: Value = serde_json::from_str(&fs::read_to_string("problem.json")?)?;
    let text = fs::read_to_string("particles.csv")?;
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().unwrap_or("").split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(str::parse).collect()).collect::<Result<_, _>>()?;
    let column = |name: &str| {
        let k = heads.iter().position(|head| head.split('[').next() == Some(name));
        k.ok_or(format!("particles.csv has no column {name}"))
    };
    let [x, y, role] = [column("x")?, column("y")?, column("role")?];
    let place = |row: &&Vec<f64>| Vector2::new(row[x] as f32, row[y] as f32);
    let fluid: Vec<&Vec<f64>> = rows.iter().filter(|row| row[role] == 0.0).collect();
    let wall = rows.iter().filter(|row| row[role] > 0.0).map(|row| place(&row)).collect();

    let (material, dx) = (&problem["material"], number(&problem["particles"]["spacing"]));
    let (rho, c0) = (number(&material["density"]), number(&material["sound_speed"]));
    let support = number(&problem["our_method"]["support_radius"]);
    let alpha = number(&material["artificial_viscosity_alpha"]);
    let gravity = numbers(&problem["acceleration"]);
    let height = fluid.iter().map(|row| row[y]).fold(0.0, f64::max);
    let fastest = (2.0 * gravity[1].abs() * height).sqrt();
    let longest = COURANT * dx / fastest;

    let (radius, factor) = (0.5 * dx, support / dx);
    let mut world = LiquidWorld::new(<DFSPHSolver>::new(), radius as f32, factor as f32, 1.0);
    let places = fluid.iter().map(|row| place(row)).collect();
    let mut water = Fluid::new(places, radius as f32, rho as f32, InteractionGroups::default());
    // Its artificial viscosity takes the radius of the support, which is two smoothing lengths, for h.
    let mut viscosity = ArtificialViscosity::new(1.0, 0.0);
    (viscosity.alpha, viscosity.speed_of_sound) = (0.5 * alpha as f32, c0 as f32);
    water.nonpressure_forces.push(Box::new(viscosity));
    let water = world.add_fluid(water);
    world.add_boundary(Boundary::new(wall, InteractionGroups::default()));

    let ids: Vec<usize> = (0..rows.len()).filter(|k| rows[*k][role] == 0.0).collect();
    let mut results = String::from("t[s],id,x[m],y[m],u[m/s],v[m/s]\n");
    let (mut now, mut steps, mut seconds) = (0.0, 0_u64, 0.0);
    let down = Vector2::new(gravity[0] as f32, gravity[1] as f32);
    for time in numbers(&problem["times"]) {
        let begin = processor_seconds();
        let count = ((time - now) / longest * (1.0 - 1e-9)).ceil() as u64;
        for _ in 0..count {
            world.step(((time - now) / count as f64) as f32, &down);
        }
        seconds += processor_seconds() - begin;
        (now, steps) = (time, steps + count);
        let water = world.fluids().get(water).ok_or("the fluid is lost")?;
        for ((id, x), v) in ids.iter().zip(&water.positions).zip(&water.velocities) {
            writeln!(results, "{time:?},{id},{:?},{:?},{:?},{:?}", x.x, x.y, v.x, v.y)?;
        }
    }
    hand_in(results, [longest, support, alpha, seconds], steps)
}

/// Writes the three files of a submission.
fn hand_in(
    results: String,
    [longest, support, alpha, seconds]: [f64; 4],
    steps: u64,
) -> Result<(), Box<dyn Error>> {
    let method = json!({
        "code": "salva2d", "version": "0.11.0", "scheme": "DFSPH", "division": "closed",
        "settings": { "step": longest, "support": support, "alpha": alpha },
        "changed": "incompressible, no density; volumes of 0.8 dx²; cubic spline of the same support; f32",
    });
    let name = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = name.lines().find(|line| line.starts_with("model name"));
    let name = name.and_then(|line| line.split(": ").nth(1)).unwrap_or("unknown");
    let system = json!({
        "machine": name, "threads": 1, "seconds": seconds, "steps": steps, "interactions": "unknown",
    });
    fs::write("results.csv", results)?;
    fs::write("method.json", serde_json::to_string_pretty(&method)?)?;
    fs::write("system.json", serde_json::to_string_pretty(&system)?)?;
    Ok(())
}
