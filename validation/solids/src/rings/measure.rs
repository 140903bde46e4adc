//! What is measured of the rings, sample by sample and at the end.

use nalgebra::Vector2;
use solver::{Flow as Going, Observer, Particle, Stepper, Symmetric};
use std::collections::HashMap;

use super::{Rings, metrics::*};
use crate::solid::Energy;
use base::record::{Profile, Record};

/// Samples of a run, at most, and how many of them pass between two counts of fragments.
const SAMPLES: f64 = 800.0;
const FRAGMENTS_EVERY: usize = 8;
/// Particles closer than this belong together \[dx\].
const BOND: f64 = 1.5;

/// One ring at one time, in the frame whose x axis is the line of flight.
#[derive(Clone, Copy, Debug, Default)]
pub struct Side {
    /// Centre of mass \[m\].
    pub centre: Vector2<f64>,
    /// Its velocity \[m/s\].
    pub velocity: Vector2<f64>,
    /// Extent along the line of flight, half a spacing beyond the outermost particles \[m\].
    pub width: f64,
    /// Extent across it \[m\].
    pub height: f64,
}

/// The particles in the frame whose x axis is the line of flight, as the scene orders them.
pub fn along_flight(
    rings: &Rings,
    simulation: &dyn Stepper<Symmetric>,
) -> Vec<Particle<Symmetric>> {
    let mut particles = simulation.particles();
    if rings.settings.angle != 0.0 {
        let rotation = rings.to_flight();
        for p in &mut particles {
            (p.position, p.velocity) = (rotation * p.position, rotation * p.velocity);
        }
    }
    particles
}

/// A ring's centre, velocity and extents.
pub fn side(ring: &[Particle<Symmetric>], dx: f64) -> Side {
    let (mut mass, mut centre, mut momentum) = (0.0, Vector2::zeros(), Vector2::zeros());
    let (mut low, mut high) = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
    for p in ring {
        mass += p.mass;
        centre += p.position * p.mass;
        momentum += p.velocity * p.mass;
        (low, high) = (low.inf(&p.position), high.sup(&p.position));
    }
    let extent = high - low + Vector2::repeat(dx);
    Side { centre: centre / mass, velocity: momentum / mass, width: extent.x, height: extent.y }
}

/// Connected pieces of a ring: particles within [`BOND`] spacings of each other hold together.
pub fn fragments(ring: &[Particle<Symmetric>], dx: f64) -> usize {
    let reach = BOND * dx;
    let cell = |p: Vector2<f64>| ((p.x / reach).floor() as i64, (p.y / reach).floor() as i64);
    let mut cells: HashMap<(i64, i64), Vec<usize>> = HashMap::new();
    for (k, p) in ring.iter().enumerate() {
        cells.entry(cell(p.position)).or_default().push(k);
    }
    let mut is_counted = vec![false; ring.len()];
    let mut pieces = 0;
    for start in 0..ring.len() {
        if std::mem::replace(&mut is_counted[start], true) {
            continue;
        }
        pieces += 1;
        let mut open = vec![start];
        while let Some(k) = open.pop() {
            let (x, y) = cell(ring[k].position);
            let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (x + i, y + j)));
            for &other in around.filter_map(|c| cells.get(&c)).flatten() {
                let near = (ring[k].position - ring[other].position).norm() <= reach;
                if near && !std::mem::replace(&mut is_counted[other], true) {
                    open.push(other);
                }
            }
        }
    }
    pieces
}

/// Watches a run.
pub struct Series<'a> {
    rings: &'a Rings,
    every: f64,
    next: f64,
    samples: usize,
    pieces: usize,
    most_pieces: usize,
    rows: Vec<[f64; COLUMNS]>,
}

const COLUMNS: usize = 10;
const NAMES: [(&str, &str); COLUMNS] = [
    ("t", "L/c0"),
    ("x_c", "L"),
    ("v_c", "c0"),
    ("width", "L"),
    ("height", "L"),
    ("pieces", "1"),
    ("kinetic", "J/m"),
    ("compression", "J/m"),
    ("shear", "J/m"),
    ("mirror", "dx"),
];

impl<'a> Series<'a> {
    /// A series over a run.
    pub fn new(rings: &'a Rings) -> Self {
        let every = rings.settings.end / rings.c0 / SAMPLES;
        let (samples, pieces, most_pieces) = (0, 2, 2);
        Self { rings, every, next: 0.0, samples, pieces, most_pieces, rows: Vec::new() }
    }

    /// Takes a sample: the ring on the right, whose centre has x > 0.
    pub fn sample(&mut self, time: f64, particles: &[Particle<Symmetric>]) {
        let (rings, dx) = (self.rings, self.rings.medium.dx);
        let (left, right) = particles.split_at(particles.len() / 2);
        if self.samples.is_multiple_of(FRAGMENTS_EVERY) {
            self.pieces = fragments(left, dx) + fragments(right, dx);
            self.most_pieces = self.most_pieces.max(self.pieces);
        }
        self.samples += 1;
        let ring = side(right, dx);
        let energies = Energy::of_all(particles, &rings.material);
        let mirror = mirror_error(left, right) / dx;
        self.rows.push([
            time * rings.c0,
            ring.centre.x,
            ring.velocity.x / rings.c0,
            ring.width,
            ring.height,
            self.pieces as f64,
            energies.kinetic,
            energies.compression,
            energies.shear,
            mirror,
        ]);
    }

    /// (t \[L/c0\], column number `k`) of every sample.
    pub fn points(&self, k: usize) -> Vec<(f64, f64)> {
        self.rows.iter().map(|row| (row[0], row[k])).collect()
    }

    /// The series as columns.
    pub fn profile(&self) -> Profile {
        Profile::of_rows(&NAMES, &self.rows)
    }

    /// Metrics of the whole run.
    pub fn measure(&self, record: &mut Record) {
        let (Some(first), Some(last)) = (self.rows.first(), self.rows.last()) else { return };
        let column = |k: usize| self.rows.iter().map(move |row| row[k]);
        let least = |k: usize| column(k).fold(f64::INFINITY, f64::min);
        let speed = self.rings.settings.speed;
        record.put(RESTITUTION, last[2] / speed);
        record.put(PIECES, last[5]);
        record.put(PIECES_MOST, self.most_pieces as f64);
        record.put(WIDTH_MIN, least(3));
        record.put(HEIGHT_MAX, column(4).fold(f64::NEG_INFINITY, f64::max));
        record.put(X_C_MIN, least(1));
        record.put(X_C_END, last[1]);
        let energy = |row: &[f64; COLUMNS]| row[6] + row[7] + row[8];
        record.put(ENERGY_LOST, 1.0 - energy(last) / energy(first));
        let largest = self.rows.iter().map(energy).fold(0.0, f64::max);
        record.put(ENERGY_GAINED, largest / energy(first) - 1.0);
        let late = self.rows.iter().filter(|row| row[0] >= 0.9 * last[0]);
        let pushed = late.map(|row| (row[2] - last[2]).abs()).fold(0.0, f64::max);
        record.put(PUSHED_BY_ITSELF, pushed / speed);
        record.put(MIRROR, column(9).fold(0.0, f64::max));
        let phases = self.phases();
        record.put(PHASES, phases.len() as f64);
        for (k, found) in phases.iter().enumerate().take(2) {
            record.put(IMPULSE.at(phase(k)), found.impulse);
            for (metric, time) in T_IMPULSE.iter().zip(found.times) {
                record.put(metric.at(phase(k)), time);
            }
        }
    }

    /// Phases of contact: where the force on a ring is above 1 % of its largest, with pauses of less
    /// than 5 L/c0 bridged, as in `references/rubber_rings`.
    pub fn phases(&self) -> Vec<Phase> {
        // The last sample may stand at the time of the one before it.
        let force = |w: &[[f64; COLUMNS]]| match w[1][0] - w[0][0] {
            dt if dt > 0.0 => (w[1][2] - w[0][2]) / dt,
            _ => 0.0,
        };
        let forces: Vec<f64> = self.rows.windows(2).map(force).collect();
        let least = TOUCH * forces.iter().copied().fold(0.0, f64::max);
        let mut spans: Vec<[usize; 2]> = Vec::new();
        for k in (0..forces.len()).filter(|&k| forces[k] > least) {
            match spans.last_mut() {
                Some([_, end]) if self.rows[k][0] - self.rows[*end][0] < PAUSE => *end = k + 1,
                _ => spans.push([k, k + 1]),
            }
        }
        spans.into_iter().map(|[start, end]| self.phase(&self.rows[start..=end])).collect()
    }

    fn phase(&self, rows: &[[f64; COLUMNS]]) -> Phase {
        let s = &self.rings.settings;
        let mass = std::f64::consts::PI * (s.outer * s.outer - s.inner * s.inner);
        let (first, last) = (rows[0][2], rows[rows.len() - 1][2]);
        let times = SHARES.map(|share| {
            let wanted = first + share * (last - first);
            let crossing = rows.windows(2).find(|w| w[0][2] < wanted && w[1][2] >= wanted);
            crossing.map_or(f64::NAN, |w| {
                let part = (wanted - w[0][2]) / (w[1][2] - w[0][2]);
                w[0][0] + part * (w[1][0] - w[0][0])
            })
        });
        Phase { impulse: mass * (last - first), times }
    }
}

/// One phase of contact.
#[derive(Clone, Copy, Debug)]
pub struct Phase {
    /// Mass of a ring times the change of its velocity \[ρ c₀ L²\].
    pub impulse: f64,
    /// When [`SHARES`] of it have passed \[L/c₀\].
    pub times: [f64; 3],
}

/// Shares of a phase's impulse whose times are kept.
pub const SHARES: [f64; 3] = [0.01, 0.5, 0.99];
/// Force, over the largest, above which rings touch; pause that ends a phase \[L/c₀\].
const TOUCH: f64 = 0.01;
const PAUSE: f64 = 5.0;

/// Largest distance of a particle from the mirror image of its partner.
fn mirror_error(left: &[Particle<Symmetric>], right: &[Particle<Symmetric>]) -> f64 {
    let error = |(l, r): (&Particle<Symmetric>, &Particle<Symmetric>)| {
        Vector2::new(l.position.x + r.position.x, l.position.y - r.position.y).norm()
    };
    left.iter().zip(right).map(error).fold(0.0, f64::max)
}

/// |Σ m v| over the momentum of one ring.
pub fn momentum_error(rings: &Rings, particles: &[Particle<Symmetric>]) -> f64 {
    let momentum: Vector2<f64> = particles.iter().map(|p| p.velocity * p.mass).sum();
    let mass: f64 = particles.iter().map(|p| p.mass).sum();
    momentum.norm() / (0.5 * mass * rings.v.max(f64::MIN_POSITIVE))
}

impl Observer<Symmetric> for Series<'_> {
    fn after_step(&mut self, simulation: &dyn Stepper<Symmetric>) -> Going {
        if simulation.time() >= self.next {
            self.next += self.every;
            self.sample(simulation.time(), &along_flight(self.rings, simulation));
        }
        Going::Continue
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{rings::RingSettings, solid::Rubber};
    use harness::{context::Context, method::Method};
    use solver::Leapfrog;

    fn rings() -> Rings {
        let method = Method::of::<Rubber<(), Leapfrog>>();
        Rings::new(&RingSettings::default(), &method, &Context::default()).unwrap()
    }

    #[test]
    fn a_ring_is_one_piece_and_a_cut_one_is_two() {
        let rings = rings();
        let particles = rings.particles();
        let (left, _) = particles.split_at(particles.len() / 2);
        assert_eq!(fragments(left, rings.medium.dx), 1);
        let cut: Vec<_> = left.iter().filter(|p| p.position.y.abs() > 0.3).copied().collect();
        assert_eq!(fragments(&cut, rings.medium.dx), 2);
        let side = side(left, rings.medium.dx);
        assert!((side.centre.x + 5.0).abs() < 1e-12 && side.centre.y.abs() < 1e-12);
        assert!((side.width - 8.0).abs() < 1e-3 && (side.height - 8.0).abs() < 1e-3);
        assert!((side.velocity.x - 0.059).abs() < 1e-12);
    }

    #[test]
    fn energies_are_those_of_simple_states() {
        let material = rings().material;
        let mut p = Particle::fluid(Vector2::zeros(), Vector2::new(0.6, 0.8), 1.0, 0.01);
        let at_rest = Energy::of_all(&[p], &material);
        assert!((at_rest.kinetic - 0.005).abs() < 1e-15 && at_rest.compression.abs() < 1e-15);
        // Small compression: K e²/2 an area; pure shear: tau²/(2 mu) an area.
        (p.density, p.extra.xy) = (1.0 + 1e-4, 1e-4);
        let strained = Energy::of_all(&[p], &material);
        assert!((strained.compression / (0.01 * 0.5e-8) - 1.0).abs() < 1e-3);
        assert!((strained.shear / (0.01 * 1e-8 / (2.0 * 0.22)) - 1.0).abs() < 1e-3);
    }
}
