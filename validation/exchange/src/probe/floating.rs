//! A rigid box in water at rest: at which depth does no force act on it?

use serde_json::{Value, json};
use touchstone_base::record::Profile;

use super::{Criterion, Factor, Finding, Pose, Question, Reads, Solved, fixed, named};
use crate::problem::ExportedProblem;

/// Sides of the box \[dx\].
const SIDE: usize = 10;
/// Its density over the density of the water.
const LIGHT: f64 = 0.5;
/// Rows in the water in the two problems, one less and one more than at rest.
const DRAFTS: [usize; 2] = [4, 6];

/// Uncertainty of the buoyancy: with the deeper draft the box and the water that moves with it are up to a
/// fifth heavier, and the draft at rest lies 0.1 rows nearer to this one.
const ADDED_MASS: f64 = 0.02;

/// Words for another code.
const BOUNDARY: &str = "Nothing passes floor and sides, along which water is free to slip. The surface is \
                        free: no pressure acts on it. The particles of body 1 are a rigid box without \
                        friction, of the mass of all its particles, which moves as the pressure of the \
                        water and its weight make it, and does not turn. It starts at rest.";

/// Makes a box of the water in the middle of the tank, this many rows deep, and of rows above the surface.
pub fn put_in(problem: &mut ExportedProblem, draft: usize) {
    let (dx, eos) = (problem.outline.medium.dx, problem.outline.medium.eos);
    let table = &problem.outline.particles;
    let fluid: Vec<usize> = problem.moving().into_iter().map(|k| k as usize).collect();
    let extent = |name: &str| {
        let values = fluid.iter().map(|k| table.column(name)[*k]);
        values.fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(x), high.max(x)])
    };
    let ([left, right], [_, surface]) = (extent("x"), extent("y"));
    let (middle, side) = (0.5 * (left + right), SIDE as f64 * dx);
    let is_in_box =
        |x: f64, y: f64| (x - middle).abs() < 0.5 * side && y > surface - (draft as f64 - 0.5) * dx;
    let mass = LIGHT * eos.density * dx * dx;
    let mut rows: Vec<Vec<f64>> = Vec::new();
    problem.outline.bodies.clear();
    let mut put = |row: Vec<f64>, body: u32| {
        rows.push(row);
        problem.outline.bodies.push(body);
    };
    let names: Vec<String> = table.columns.iter().map(|column| column.name.clone()).collect();
    let count = table.column("id").len();
    for k in 0..count {
        let of = |name: &str| table.column(name)[k];
        let is_box = of("role") == 0.0 && is_in_box(of("x"), of("y"));
        let value = |name: &String| if is_box && name == "mass" { mass } else { of(name) };
        put(names.iter().map(value).collect(), u32::from(is_box));
    }
    for k in 0..SIDE * (SIDE - draft) {
        let x = middle + ((k % SIDE) as f64 + 0.5) * dx - 0.5 * side;
        let y = surface + (k / SIDE + 1) as f64 * dx;
        let value = |name: &String| match &**name {
            "id" => (count + k) as f64,
            "x" => x,
            "y" => y,
            "density" => eos.density,
            "mass" => mass,
            _ => 0.0,
        };
        put(names.iter().map(value).collect(), 1);
    }
    let mut particles = Profile::default();
    for (column, of) in table.columns.iter().enumerate() {
        let values = rows.iter().map(|row| row[column]).collect();
        particles = particles.with(&of.name, &of.unit, values);
    }
    (problem.outline.particles, problem.boundary) = (particles, BOUNDARY);
    problem.gates.clear();
}

/// The box in the document of a problem.
pub fn statement(problem: &ExportedProblem) -> Value {
    let quantity = |value: f64, unit: &str| json!({ "value": value, "unit": unit });
    let side = SIDE as f64 * problem.outline.medium.dx;
    let density = LIGHT * problem.outline.medium.eos.density;
    json!({
        "body": 1,
        "width": quantity(side, "m"),
        "height": quantity(side, "m"),
        "density": quantity(density, "kg/m^3"),
        "mass": quantity(density * side * side, "kg/m"),
        "about": "a rigid box that moves without turning; column body of the particles",
    })
}

/// How far the box has risen \[dx\].
fn rise(of: &Solved) -> f64 {
    let moving = of.problem.moving();
    let is_box = |k: usize| of.problem.outline.bodies[moving[k] as usize] == 1;
    let pairs = of.start.states.iter().zip(&of.end().states).enumerate();
    let (sum, count) =
        pairs.filter(|(k, _)| is_box(*k)).fold((0.0, 0.0), |(sum, count), (_, (a, b))| {
            (sum + b.position.y - a.position.y, count + 1.0)
        });
    sum / count / of.problem.outline.medium.dx
}

pub fn floats() -> Question {
    Question {
        id: "floating",
        text: "Does a body of half the density float half out?",
        poses: || {
            let tank = ["rows=20", "columns=30", "end=2"];
            let tank = || Pose::of("hydrostatic", "ghosts", &tank).or("modern");
            DRAFTS.map(|draft| Pose { draft: Some(draft), ..tank() }).into()
        },
        answer: Reads::Results(|of| {
            let [shallow, deep] = named(of)?.map(rise);
            // By Archimedes the force is proportional to the draft beyond its value at rest; both drafts have
            // nearly equal added masses.
            let [less, more] = DRAFTS.map(|rows| rows as f64);
            let draft = less - (more - less) * shallow / (deep - shallow);
            let factor = Factor { value: LIGHT * SIDE as f64 / draft, uncertainty: ADDED_MASS };
            let (from, to) = (fixed(shallow, 2), fixed(deep, 2));
            let moved =
                format!("from {less} and {more} rows it has risen by {from} and {to} spacings");
            let has_buoyancy = deep - shallow > 0.1 * shallow.abs();
            let floats = has_buoyancy && (0.0..SIDE as f64).contains(&draft);
            let words = match (has_buoyancy, floats) {
                (false, _) => format!("no buoyancy: {moved}"),
                (true, false) => format!("a force acts on it at every depth: {moved}"),
                (true, true) => format!(
                    "no force acts on it with {} of its {SIDE} rows in the water: {}; {moved}",
                    fixed(draft, 1),
                    factor.of("the buoyancy")
                ),
            };
            let criteria = [
                Criterion::new(
                    "factor of the buoyancy",
                    factor.value,
                    [0.95, 1.05],
                    "unequal added masses are 0.02, and a box that is 0.1 spacings larger on each side 0.04",
                ),
                Criterion::at_least(
                    "rise from the larger minus rise from the smaller draft [dx]",
                    deep - shallow,
                    0.2,
                    "each starts one row from rest and swings through 0.6 rows in the time",
                ),
            ];
            let found = Finding::new(words, criteria);
            Ok(if floats { found.with(factor) } else { found })
        }),
        finds: &["no-buoyancy", "buoyancy", "mass-for-volume"],
    }
}
