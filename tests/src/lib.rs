//! Shared code of the cross-crate tests: random numbers, patches of particles, and the rates of one
//! right-hand side.

pub mod foreign_solver;
pub mod new_term;
pub mod new_wall;
pub mod row_matrix;

use std::{collections::BTreeMap, fs, path::Path};

use nalgebra::Vector2;
use touchstone_base::{
    functions::{cos, sin},
    random,
};
use touchstone_solver::{
    Compose, Domain, Engine, Integrator, Kernel, Open, Outcome, Particle, Physics, Rate, Scene,
    Stepper, Term, integrator::Stepped, lattice, numbers::Numbers, physics::Particles,
};

/// The text of a committed snapshot; `None` if there is none.
pub fn snapshot(name: &str) -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    let text = fs::read_to_string(folder.join(format!("{name}.snap"))).ok()?;
    Some(text.split_once("\n---\n")?.1.to_string())
}

/// The numbers of a snapshot by their names, for each variant and run.
pub type Kept = BTreeMap<(String, String), BTreeMap<String, f64>>;

/// The tables of a snapshot, one a variant, with the variant in the first cell, without means of profiles.
fn tables(name: &str) -> impl Iterator<Item = (String, Vec<Vec<String>>)> {
    let text = snapshot(name).unwrap_or_default();
    let parts: Vec<String> = text.split("\n\n").map(String::from).collect();
    parts.into_iter().filter_map(|part| {
        let rows = part.lines().filter(|line| line.contains('|') && !line.starts_with("profiles "));
        let rows: Vec<Vec<String>> =
            rows.map(|row| row.split('|').map(|cell| cell.trim().to_string()).collect()).collect();
        Some((rows.first()?[0].clone(), rows))
    })
}

/// The metrics that the snapshot of a case holds: rows are metrics, columns runs.
pub fn kept_numbers(case: &str) -> Kept {
    let mut kept = Kept::new();
    for (variant, rows) in tables(case) {
        let is_metric = |row: &&Vec<String>| !row[0].starts_with("profiles ");
        for row in rows[1..].iter().filter(is_metric) {
            let metric = row[0].split(' ').next().unwrap_or_default();
            for (run, cell) in rows[0].iter().zip(row).skip(1) {
                let numbers = kept.entry((variant.clone(), run.clone())).or_default();
                numbers.extend(cell.parse().ok().map(|value| (metric.to_string(), value)));
            }
        }
    }
    kept
}

/// The work that the snapshot of a case holds: rows are runs, columns kinds of work.
pub fn kept_work(case: &str) -> Kept {
    let mut kept = Kept::new();
    for (variant, rows) in tables(&format!("work.{case}")) {
        for row in &rows[1..] {
            let numbers = kept.entry((variant.clone(), row[0].clone())).or_default();
            let of_row = rows[0].iter().zip(row).skip(1);
            numbers.extend(of_row.filter_map(|(of, cell)| Some((of.clone(), cell.parse().ok()?))));
        }
    }
    kept
}

/// Fails unless a magnitude is at most `most`; the message names it. NaN fails.
#[track_caller]
pub fn assert_small(what: &str, found: f64, most: f64) {
    assert!(
        found.abs() <= most,
        "{what}: expected at most {most:e} in magnitude, and it is {found:e}"
    );
}

/// Fails unless a number is within the tolerance of the expected one; the message names it. NaN fails.
#[track_caller]
pub fn assert_near(what: &str, found: f64, expected: f64, tolerance: f64) {
    let apart = (found - expected).abs();
    assert!(
        apart <= tolerance,
        "{what}: expected {expected} within {tolerance:e}, and it is {found}"
    );
}

/// A plane vector.
pub type V2 = Vector2<f64>;

/// Random vectors and orders, equal on every machine.
pub struct Random(random::Random);

impl Random {
    /// The stream of this seed.
    pub fn new(seed: u64) -> Self {
        Self(random::Random::new(seed))
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    /// Each component uniform in [low, high).
    pub fn vector(&mut self, low: f64, high: f64) -> V2 {
        Vector2::new(self.between(low, high), self.between(low, high))
    }

    /// Permutes the items.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for k in (1..items.len()).rev() {
            items.swap(k, self.between(0.0, k as f64 + 1.0) as usize);
        }
    }
}

/// Particles at rest, without terms: one scheme for each kernel, in which the rates of any terms can be
/// computed.
type Still<K, X> = Compose<K, (), (), Open, NoStep, X>;

/// Makes no step.
struct NoStep;

impl<P: Physics> Integrator<P> for NoStep {
    const NAME: &'static str = "none";
    type Memory = ();

    fn step(_: &mut Engine<P>, (): &mut (), _: &mut Particles<P>, _: f64) -> Stepped {
        Ok(())
    }
}

/// d/dt of every particle by these terms, in the order of the particles.
pub fn rates<K: Kernel, T: Term<X>, X: Numbers>(
    h: f64,
    domain: Domain,
    particles: &[Particle<X>],
    mut terms: T,
) -> Vec<Rate<X>> {
    terms.prepare(particles.iter().map(|p| p.velocity.norm()).fold(0.0, f64::max));
    let scene = Scene::<Still<K, X>>::new(h, domain, particles.to_vec(), (), (), Open);
    let mut still = scene.build().expect("a sound scene");
    assert_eq!(still.advance(0.0, 1.0, &mut ()), Outcome::Reached);
    let mut rates = vec![Rate::default(); particles.len()];
    // As they are stored, which is in another order.
    for ((k, particle), rate) in still.checkpoint().particles.iter().zip(still.rates(&terms)) {
        rates[*k as usize] = Rate { position: rate.position + particle.velocity, ..rate };
    }
    rates
}

/// The rates of particles in an open domain.
pub fn open_rates<K: Kernel, F: Term<X>, D: Term<X>, X: Numbers>(
    h: f64,
    particles: &[Particle<X>],
    forces: F,
    drift: D,
) -> Vec<Rate<X>> {
    rates::<K, _, X>(h, Domain::open(), particles, (forces, drift))
}

/// Σ numbers / Σ |numbers|.
pub fn relative_sum(numbers: impl Iterator<Item = f64>) -> f64 {
    let (sum, size) = numbers.fold((0.0, 0.0), |(s, a), x| (s + x, a + x.abs()));
    assert!(size > 0.0, "a sum of nothing shows nothing");
    sum / size
}

/// A square lattice of n × n particles in the unit square, density 1, moved by up to `jitter`
/// spacings, with smooth velocities of size 0.1 that fit the period.
pub fn patch(n: usize, jitter: f64, seed: u64) -> Vec<Particle> {
    let (mut random, dx) = (Random::new(seed), 1.0 / n as f64);
    lattice(Vector2::repeat(0.5 * dx), dx, n, n)
        .map(|point| {
            let position = point + random.vector(-jitter, jitter) * dx;
            let k = 2.0 * std::f64::consts::PI;
            let (x, y) = (k * position.x, k * position.y);
            let velocity = Vector2::new(sin(x) * cos(y), 0.5 * sin(y) - 0.3 * cos(x)) * 0.1;
            Particle::fluid(position, velocity, 1.0, dx * dx)
        })
        .collect()
}

/// Largest difference of positions, velocities and densities, each against its own scale. Places
/// are compared modulo the periods.
pub fn difference(a: &[Particle], b: &[Particle], period: [Option<f64>; 2]) -> f64 {
    assert_eq!(a.len(), b.len());
    let mut largest = 0.0_f64;
    for (a, b) in a.iter().zip(b) {
        let mut apart = a.position - b.position;
        for axis in 0..2 {
            if let Some(period) = period[axis] {
                apart[axis] -= (apart[axis] / period).round() * period;
            }
        }
        let parts = [apart.amax(), (a.velocity - b.velocity).amax(), (a.density - b.density).abs()];
        for part in parts {
            // A NaN must not hide behind a maximum.
            largest = if part > largest || part.is_nan() { part } else { largest };
        }
    }
    largest
}

/// The bits of a state, so that equal means equal.
pub fn bits(particles: &[Particle]) -> Vec<[u64; 5]> {
    let numbers = |p: &Particle| {
        [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density].map(f64::to_bits)
    };
    particles.iter().map(numbers).collect()
}
