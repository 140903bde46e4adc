//! What is measured of the rings, sample by sample and at the end.

use nalgebra::Vector2;
use solver::{Flow as Going, Observer, Particle, Stepper, Symmetric};

use super::{Rings, metrics::*};
use crate::solid::{Energy, largest};
use base::record::{MetricKey, Profile, Record};
use maths::geometry::{Bonds, Topology};

/// Samples of a run, at most, and how many of them pass between two counts of pieces and holes.
const SAMPLES: f64 = 800.0;
const COUNTED_EVERY: usize = 8;
/// Particles that are no farther apart at the start are neighbours \[dx\]: the next in a layer, and the
/// nearest one or two of the layers beside it.
pub const NEIGHBOURS: f64 = 1.2;

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

/// A ring's centre of mass \[m\], its velocity \[m/s\], and its extents along and across the line of flight,
/// half a spacing beyond the outermost particles \[m\].
pub fn side(ring: &[Particle<Symmetric>], dx: f64) -> [Vector2<f64>; 3] {
    let (mut mass, mut centre, mut momentum) = (0.0, Vector2::zeros(), Vector2::zeros());
    let (mut low, mut high) = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
    for p in ring {
        mass += p.mass;
        centre += p.position * p.mass;
        momentum += p.velocity * p.mass;
        (low, high) = (low.inf(&p.position), high.sup(&p.position));
    }
    [centre / mass, momentum / mass, high - low + Vector2::repeat(dx)]
}

/// Where the particles of a ring are.
fn places(ring: &[Particle<Symmetric>]) -> Vec<Vector2<f64>> {
    ring.iter().map(|p| p.position).collect()
}

/// Are there two pieces, each with a hole?
fn is_whole([pieces, holes]: [f64; 2]) -> bool {
    pieces == 2.0 && holes >= 1.0
}

/// The ring on the left and the one on the right.
fn halves(particles: &[Particle<Symmetric>]) -> [&[Particle<Symmetric>]; 2] {
    let (left, right) = particles.split_at(particles.len() / 2);
    [left, right]
}

/// Watches a run.
pub struct Series<'a> {
    rings: &'a Rings,
    every: f64,
    /// Area below which a hole is none of a ring \[m²\].
    least_hole: f64,
    /// Neighbours of each ring at the start.
    bonds: [Bonds; 2],
    /// Is each ring seen as one at the start? Not if its hole is narrower than a disc.
    is_seen: bool,
    next: f64,
    samples: usize,
    /// Largest energies of contacts and of modes that deform no particle, of a simulation that knows them
    /// \[J/m\].
    held: Option<[f64; 2]>,
    /// Pieces of both rings at the last count, and the fewest holes of one.
    counted: Vec<f64>,
    rows: Vec<[f64; COLUMNS]>,
}

harness::observed! {
    Series<'_>:
    changes(next, samples, held, counted, rows), parts(),
    stays(rings, every, least_hole, bonds, is_seen)
}

const COLUMNS: usize = 12;
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
    ("holes", "1"),
    ("stretch", "dx"),
];

impl<'a> Series<'a> {
    /// A series over a run.
    pub fn new(rings: &'a Rings) -> Self {
        let every = rings.settings.end / rings.c0 / SAMPLES;
        let least_hole = Topology::least_hole_of_ring(rings.settings.inner, rings.settings.outer);
        let start = rings.particles();
        let bonds =
            halves(&start).map(|ring| Bonds::of(&places(ring), NEIGHBOURS * rings.medium.dx));
        let (is_seen, next, samples, held) = (false, every, 0, None);
        let (counted, rows) = (Vec::new(), Vec::new());
        let mut this =
            Self { rings, every, least_hole, bonds, is_seen, next, samples, held, counted, rows };
        this.is_seen = is_whole(this.count(&start));
        this
    }

    /// Pieces of both rings, and the fewest holes of one.
    fn count(&self, particles: &[Particle<Symmetric>]) -> [f64; 2] {
        let found = halves(particles)
            .map(|ring| Topology::of(&places(ring), self.rings.medium.dx, self.least_hole));
        let holes = found.iter().map(|ring| ring.holes).min().unwrap_or_default();
        [found.iter().map(|ring| ring.pieces).sum::<usize>() as f64, holes as f64]
    }

    /// Takes a sample: the ring on the right, whose centre has x > 0. The energies are those of the particles
    /// unless the simulation knows them.
    pub fn sample(&mut self, time: f64, particles: &[Particle<Symmetric>], known: Option<Energy>) {
        let (rings, dx) = (self.rings, self.rings.medium.dx);
        let [left, right] = halves(particles);
        if self.samples.is_multiple_of(COUNTED_EVERY) {
            self.counted = self.count(particles).into();
        }
        self.samples += 1;
        let [centre, velocity, extent] = side(right, dx);
        if let Some(Energy { of_loads, of_modes, .. }) = known {
            let [loads, modes] = self.held.unwrap_or_default();
            self.held = Some([loads.max(of_loads), modes.max(of_modes)]);
        }
        let Energy { kinetic, compression, shear, .. } =
            known.unwrap_or_else(|| Energy::of_all(particles, &rings.material));
        let bonds = self.bonds.iter().zip([left, right]);
        let stretch = largest(bonds.map(|(bonds, ring)| bonds.longest(&places(ring)) / dx));
        self.rows.push([
            time * rings.c0,
            centre.x,
            velocity.x / rings.c0,
            extent.x,
            extent.y,
            self.counted[0],
            kinetic,
            compression,
            shear,
            mirror_error(left, right) / dx,
            self.counted[1],
            stretch,
        ]);
    }

    /// Time of the last sample \[L/c₀\].
    pub fn last_time(&self) -> Option<f64> {
        self.rows.last().map(|row| row[0])
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
        record.put(PIECES, last[5]);
        let most = |k: usize| column(k).fold(0.0, f64::max);
        record.put(PIECES_MOST, most(5));
        if self.is_seen {
            record.put(HOLES_LEAST, least(10));
            if let Some(torn) = self.rows.iter().find(|row| !is_whole([row[5], row[10]])) {
                record.put(TORN_AT, torn[0]);
            }
        }
        let stretched = self.rows.iter().max_by(|a, b| a[11].total_cmp(&b[11]));
        if let Some(row) = stretched {
            record.put(STRETCH_MOST, row[11]);
            record.put(T_STRETCH_MOST, row[0]);
        }
        record.put(WIDTH_MIN, least(3));
        record.put(HEIGHT_MAX, most(4));
        record.put(X_C_MIN, least(1));
        record.put(X_C_END, last[1]);
        record.put(MIRROR, most(9));
        let late = self.rows.iter().filter(|row| row[0] >= 0.9 * last[0]);
        let pushed = late.map(|row| (row[2] - last[2]).abs()).fold(0.0, f64::max);
        let energy = |row: &[f64; COLUMNS]| row[6] + row[7] + row[8];
        let largest = self.rows.iter().map(energy).fold(0.0, f64::max);
        for (metric, value) in [
            (PUSHED_BY_ITSELF, pushed / speed),
            (ENERGY_LOST, 1.0 - energy(last) / energy(first)),
            (ENERGY_GAINED, largest / energy(first) - 1.0),
        ] {
            let moving = (speed > 0.0).then_some(value);
            put_or(record, metric, moving, "the rings are at rest at the start");
        }
        let held = self.held.filter(|_| speed > 0.0);
        for (k, metric) in [CONTACT_MOST, MODES_MOST].into_iter().enumerate() {
            let share = held.map(|held| held[k] / energy(first));
            put_or(
                record,
                metric,
                share,
                "its forces derive from no energy, or the rings are at rest",
            );
        }
        self.measure_contact(last[2] / speed, record);
    }

    /// Metrics of contact; `restitution` is that of rings that have parted.
    fn measure_contact(&self, restitution: f64, record: &mut Record) {
        let phases = self.phases();
        record.put(PHASES, phases.len() as f64);
        let parted = phases.last().filter(|last| last.is_over).map(|_| restitution);
        let never = phases.is_empty();
        let why = if never { "the rings never touch" } else { "the rings still touch at the end" };
        put_or(record, RESTITUTION, parted, why);
        const METRICS: [MetricKey; 4] = [IMPULSE, T_IMPULSE_1, T_IMPULSE_50, T_IMPULSE_99];
        for (k, Phase { impulse, times: [early, half, late], is_over }) in
            phases.into_iter().enumerate().take(2)
        {
            for (metric, value) in METRICS.into_iter().zip([impulse, early, half, late]) {
                put_or(record, metric.at(phase(k)), is_over.then_some(value), NOT_OVER);
            }
        }
    }

    /// Phases of contact: where the force on a ring is above 1 % of its largest, with pauses of less
    /// than 5 L/c0 bridged, as in `references/rubber_rings`.
    pub fn phases(&self) -> Vec<Phase> {
        let force = |w: &[[f64; COLUMNS]]| (w[1][2] - w[0][2]) / (w[1][0] - w[0][0]);
        let forces: Vec<f64> = self.rows.windows(2).map(force).collect();
        let least = TOUCH * forces.iter().copied().fold(0.0, f64::max);
        let mut spans: Vec<[usize; 2]> = Vec::new();
        for k in (0..forces.len()).filter(|&k| forces[k] > least) {
            match spans.last_mut() {
                Some([_, end]) if self.rows[k][0] - self.rows[*end][0] < PAUSE => *end = k + 1,
                _ => spans.push([k, k + 1]),
            }
        }
        spans.into_iter().map(|span| self.phase(span)).collect()
    }

    fn phase(&self, [start, end]: [usize; 2]) -> Phase {
        let rows = &self.rows[start..=end];
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
        let is_over = end + 1 < self.rows.len();
        Phase { impulse: mass * (last - first), times, is_over }
    }
}

/// One phase of contact.
#[derive(Clone, Copy, Debug)]
pub struct Phase {
    /// Mass of a ring times the change of its velocity \[ρ c₀ L²\].
    pub impulse: f64,
    /// When [`SHARES`] of it have passed \[L/c₀\].
    pub times: [f64; 3],
    /// Does it end before the run does?
    pub is_over: bool,
}

/// Why a phase has no impulse.
const NOT_OVER: &str = "the phase lasts until the end of the run";

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
            let known = Energy::known(simulation);
            self.sample(simulation.time(), &along_flight(self.rings, simulation), known);
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
    fn centre_velocity_and_extents_are_those_of_the_ring() {
        let rings = rings();
        let particles = rings.particles();
        let (left, _) = particles.split_at(particles.len() / 2);
        let [centre, velocity, extent] = side(left, rings.medium.dx);
        assert!((centre.x + 5.0).abs() < 1e-12 && centre.y.abs() < 1e-12);
        assert!((extent.x - 8.0).abs() < 1e-3 && (extent.y - 8.0).abs() < 1e-3);
        assert!((velocity.x - 0.059).abs() < 1e-12);
    }

    /// A run of made-up places: the rings of the scene, changed.
    fn watched(change: impl Fn(f64, &mut Particle<Symmetric>)) -> (Record, Vec<(f64, f64)>) {
        let rings = rings();
        let mut series = Series::new(&rings);
        for k in 0..40 {
            let time = f64::from(k);
            let mut particles = rings.particles();
            particles.iter_mut().for_each(|p| change(time, p));
            series.sample(time, &particles, None);
        }
        let mut record = Record::new("rubber_rings", "made-up", serde_json::Value::Null, 1);
        series.measure(&mut record);
        (record, series.points(10))
    }

    /// Seen from outside at 0.09 to 0.12 c0: a ring opens at its rear pole into a C. It is one piece still.
    #[test]
    fn a_ring_that_is_cut_at_its_rear_pole_is_torn() {
        // From t = 11 on the two halves of the right ring's rear move apart, 0.05 dx each a unit of time.
        let open = |time: f64, p: &mut Particle<Symmetric>| {
            let moved = if p.position.x > 5.0 { 0.005 * (time - 11.0).max(0.0) } else { 0.0 };
            p.position.y += moved * p.position.y.signum();
        };
        let (record, holes) = watched(open);
        assert_eq!(record.value(PIECES_MOST), Some(2.0));
        assert_eq!(record.value(HOLES_LEAST), Some(0.0));
        // 1.5 dx apart at t = 16, 1.7 at 18; counted at every eighth sample.
        assert_eq!(record.value(TORN_AT), Some(24.0));
        assert!(holes.iter().all(|(t, holes)| *holes == if *t < 24.0 { 1.0 } else { 0.0 }));
        let stretch = record.value(STRETCH_MOST).unwrap();
        assert!((stretch - 3.85).abs() < 0.1, "{stretch} dx: 1 + 28 x 0.1");
        assert_eq!(record.value(T_STRETCH_MOST), Some(39.0));
    }

    #[test]
    fn rings_that_move_and_bend_are_whole_and_a_ring_in_two_is_not() {
        let bend = |time: f64, p: &mut Particle<Symmetric>| {
            p.position.y *= 1.0 + 0.005 * time;
            p.position.x *= 1.0 - 0.005 * time;
        };
        let (record, _) = watched(bend);
        assert_eq!((record.value(HOLES_LEAST), record.value(PIECES_MOST)), (Some(1.0), Some(2.0)));
        assert_eq!(record.value(TORN_AT), None);
        let stretch = record.value(STRETCH_MOST).unwrap();
        assert!((1.2..1.45).contains(&stretch), "{stretch} dx: at most 1.2 x 1.195");
        let split = |time: f64, p: &mut Particle<Symmetric>| {
            if p.position.x < 0.0 && time > 20.0 {
                p.position.y += 0.3 * p.position.y.signum();
            }
        };
        let (record, _) = watched(split);
        assert_eq!((record.value(HOLES_LEAST), record.value(PIECES_MOST)), (Some(0.0), Some(3.0)));
        assert_eq!(record.value(TORN_AT), Some(24.0));
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
