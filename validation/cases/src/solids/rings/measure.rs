//! Metrics of the rings, by sample and at the end.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{
    absent::Absent,
    functions::hypot,
    record::{Record, Status},
};
use touchstone_harness::{
    pictures,
    snapshot::{Moments, Point, Snapshot, momentum},
};
use touchstone_maths::{
    geometry::{Bonds, Topology},
    metrics::contact::ContactPhase,
};
use touchstone_solver::{EquationOfState, Symmetric};

use super::{
    RingSettings,
    columns::{HEIGHT, PLACE, TIME, VELOCITY, WIDTH, series},
    metrics::{
        ENERGY_GAINED, ENERGY_LOST, HEIGHT_MAX, HOLES_LEAST, IMPULSE, MOMENTUM, PHASES,
        PIECES_MOST, RESTITUTION, STRETCH_MOST, T_IMPULSE_1, T_IMPULSE_99, TORN_AT, VOLUME_LEAST,
        WIDTH_MIN, phase,
    },
    reference,
};
use crate::solids::solid::{ElasticBody, ElasticEnergy, Watch, corners, largest};

/// Samples of a run, at most, and how many of them pass between two counts of pieces and holes.
const SAMPLES: f64 = 800.0;
const COUNTED_EVERY: usize = 8;
/// Particles at most this far apart at the start are neighbours \[dx\]: the next in a layer, and the nearest
/// one or two of adjacent layers.
pub const NEIGHBOURS: f64 = 1.2;
/// Shares of the run at which particles are kept for pictures.
pub const PICTURES: [f64; 5] = [0.16, 0.3, 0.4, 0.6, 1.0];

/// The particles in the frame whose x axis is the line of flight, as the scene orders them.
fn along_flight(settings: &RingSettings, mut particles: Vec<Point>) -> Vec<Point> {
    if settings.angle != 0.0 {
        let rotation = settings.to_flight();
        for p in &mut particles {
            (p.position, p.velocity) = (rotation * p.position, rotation * p.velocity);
        }
    }
    particles
}

/// A ring's centre of mass \[m\], its velocity \[m/s\], and its extents along and across the line of flight,
/// half a spacing beyond the outermost particles \[m\].
pub fn side(ring: &[Point], dx: f64) -> [Vector2<f64>; 3] {
    let Moments { centre, velocity, .. } = Moments::of(ring.iter().copied());
    let [low, high] = corners(ring.iter().map(|p| p.position));
    [centre, velocity, high - low + Vector2::repeat(dx)]
}

/// Where the particles of a ring are.
fn places(ring: &[Point]) -> Vec<Vector2<f64>> {
    ring.iter().map(|p| p.position).collect()
}

/// Are there two pieces, each with a hole?
fn is_whole(at: &RingSample) -> bool {
    at.counts.pieces == 2.0 && at.counts.holes >= 1.0
}

/// The ring on the left and the one on the right.
pub fn halves<T>(particles: &[T]) -> [&[T]; 2] {
    let (left, right) = particles.split_at(particles.len() / 2);
    [left, right]
}

/// The energies of particles of a snapshot unless the method knows them.
fn energies_of(
    s: &RingSettings,
    known: Option<ElasticEnergy>,
    all: &[Point],
    now: &Snapshot<Symmetric>,
) -> ElasticEnergy<Result<f64, Absent>> {
    match known {
        Some(ElasticEnergy { kinetic, compression, shear }) => {
            ElasticEnergy { kinetic: Ok(kinetic), compression: Ok(compression), shear: Ok(shear) }
        }
        None => ElasticEnergy::each(all.iter().copied(), now, &s.material()),
    }
}

/// The least volume of a particle over its volume at the start.
fn least_volume(s: &RingSettings, now: &Snapshot<Symmetric>) -> Result<f64, Absent> {
    let density = now.density()?;
    Ok(s.rho / largest(now.stored().map(|p| density.of(&p))))
}

/// Counts of both rings.
fn count(s: &RingSettings, particles: &[Point]) -> Counts {
    let least_hole = Topology::least_hole_of_ring(s.inner, s.outer);
    let found = halves(particles).map(|ring| Topology::of(&places(ring), s.dx(), least_hole));
    let pieces = found.iter().map(|ring| ring.pieces).sum::<usize>();
    let holes = found.iter().map(|ring| ring.holes).min().unwrap_or_default();
    Counts { pieces: pieces as f64, holes: holes as f64 }
}

/// Metrics of contact; `restitution` is for rings that have separated.
fn put_contact(phases: &[ContactPhase], restitution: f64, record: &mut Record) {
    record.put(PHASES, phases.len() as f64);
    let parted = phases.last().filter(|last| last.is_over).map(|_| restitution);
    let never = phases.is_empty();
    let why = if never { "the rings never touch" } else { "the rings still touch at the end" };
    record.put_or(RESTITUTION, parted, why);
    for (k, ContactPhase { impulse, times: [early, late], is_over }) in
        phases.iter().enumerate().take(2)
    {
        for (metric, value) in [(IMPULSE, impulse), (T_IMPULSE_1, early), (T_IMPULSE_99, late)] {
            let why = "the phase lasts until the end of the run";
            record.put_or(metric.at(phase(k)), is_over.then_some(*value), why);
        }
    }
}

/// Pieces and holes.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Counts {
    /// Pieces of both rings.
    pieces: f64,
    /// The fewest holes of one.
    holes: f64,
}

/// Both rings at a time, the centre and the extents of the ring on the right.
#[derive(Serialize, Deserialize)]
struct RingSample {
    /// \[L/c0\].
    time: f64,
    /// Place of the centre along the line of flight \[L\].
    place: f64,
    /// Its velocity \[c0\].
    velocity: f64,
    /// Along and across the line of flight \[L\].
    extents: Vector2<f64>,
    counts: Counts,
    /// The longest distance of neighbours \[dx\].
    stretch: f64,
    energies: ElasticEnergy<Result<f64, Absent>>,
    /// Least volume of a particle over its volume at the start.
    volume: Result<f64, Absent>,
}

/// Watches a run.
#[derive(Serialize, Deserialize)]
pub struct RingHistory {
    /// Neighbours of each ring at the start.
    bonds: [Bonds; 2],
    /// Whether neighbours stay neighbours, as in a total Lagrangian body, which cannot tear.
    stays: bool,
    next: f64,
    samples: Vec<RingSample>,
}

impl RingHistory {
    /// A series over a run with this start.
    pub fn new(s: &RingSettings, scene: &Snapshot<Symmetric>, start: &Snapshot<Symmetric>) -> Self {
        let all = along_flight(s, scene.all());
        let bonds = halves(&all).map(|ring| Bonds::of(&places(ring), NEIGHBOURS * s.dx()));
        let (known, next) = (ElasticEnergy::known(start), s.end() / SAMPLES);
        let mut this = Self { bonds, stays: known.is_some(), next, samples: Vec::new() };
        this.add(s, scene, known);
        this
    }

    /// Takes a sample.
    pub fn sample(&mut self, s: &RingSettings, now: &Snapshot<Symmetric>) {
        self.add(s, now, ElasticEnergy::known(now));
    }

    /// Adds a sample with the energies that the method knows.
    fn add(&mut self, s: &RingSettings, now: &Snapshot<Symmetric>, known: Option<ElasticEnergy>) {
        let (c0, dx, all) = (s.c0(), s.dx(), along_flight(s, now.all()));
        let [left, right] = halves(&all);
        let counts = match self.samples.last() {
            Some(last) if !self.samples.len().is_multiple_of(COUNTED_EVERY) => last.counts,
            _ => count(s, &all),
        };
        let [centre, velocity, extents] = side(right, dx);
        let bonds = self.bonds.iter().zip([left, right]);
        let stretch = largest(bonds.map(|(bonds, ring)| bonds.longest(&places(ring)) / dx));
        self.samples.push(RingSample {
            time: now.time() * c0,
            place: centre.x,
            velocity: velocity.x / c0,
            extents,
            counts,
            stretch,
            energies: energies_of(s, known, &all, now),
            volume: least_volume(s, now),
        });
    }

    /// The series, with the energies if they are known.
    fn put_series(&self, record: &mut Record) {
        let samples = &self.samples;
        record.put_column(TIME, samples, |at| at.time);
        record.put_column(PLACE, samples, |at| at.place);
        record.put_column(VELOCITY, samples, |at| at.velocity);
        record.put_column(WIDTH, samples, |at| at.extents.x);
        record.put_column(HEIGHT, samples, |at| at.extents.y);
        record.put_column(series("pieces", "1"), samples, |at| at.counts.pieces);
        let energy = |name| series(name, "J/m");
        record.put_known_column(energy("kinetic"), samples, |at| at.energies.kinetic.clone());
        record
            .put_known_column(energy("compression"), samples, |at| at.energies.compression.clone());
        record.put_known_column(energy("shear"), samples, |at| at.energies.shear.clone());
        record.put_column(series("holes", "1"), samples, |at| at.counts.holes);
        record.put_column(series("stretch", "dx"), samples, |at| at.stretch);
    }

    /// The sum of the energies of each sample \[J/m\].
    fn energy(&self) -> Result<Vec<f64>, Absent> {
        let total = |at: &RingSample| {
            let ElasticEnergy { kinetic, compression, shear } = at.energies.clone();
            Ok(kinetic? + compression? + shear?)
        };
        self.samples.iter().map(total).collect()
    }

    /// (t \[L/c0\], value) of every sample.
    fn points(&self, of: impl Fn(&RingSample) -> f64) -> Vec<(f64, f64)> {
        self.samples.iter().map(|at| (at.time, of(at))).collect()
    }

    /// The series and metrics of the whole run, and the distances of a variant from finite elements.
    pub fn put(&self, s: &RingSettings, record: &mut Record) {
        self.put_series(record);
        let all = || self.samples.iter();
        let least = |of: fn(&RingSample) -> f64| all().map(of).fold(f64::INFINITY, f64::min);
        let most = |of: fn(&RingSample) -> f64| all().map(of).fold(0.0, f64::max);
        record.put(PIECES_MOST, most(|at| at.counts.pieces));
        // A hole narrower than a disc is not detected at the start either.
        if self.samples.first().is_some_and(is_whole) {
            record.put(HOLES_LEAST, least(|at| at.counts.holes));
            if let Some(torn) = all().find(|at| !is_whole(at)).filter(|_| !self.stays) {
                record.put(TORN_AT, torn.time);
            }
        }
        record.put(STRETCH_MOST, largest(all().map(|at| at.stretch)));
        let volumes: Result<Vec<f64>, Absent> = all().map(|at| at.volume.clone()).collect();
        let smallest = |all: Vec<f64>| all.into_iter().fold(f64::INFINITY, f64::min);
        record.put_or_absent(VOLUME_LEAST, volumes.map(smallest));
        record.put(WIDTH_MIN, least(|at| at.extents.x));
        record.put(HEIGHT_MAX, most(|at| at.extents.y));
        let energy = match s.speed > 0.0 {
            true => self.energy(),
            false => Err(Absent::because("the rings are at rest at the start")),
        };
        let lost = |all: &Vec<f64>| 1.0 - all[all.len() - 1] / all[0];
        let gained = |all: &Vec<f64>| all.iter().copied().fold(0.0, f64::max) / all[0] - 1.0;
        record.put_or_absent(ENERGY_LOST, energy.as_ref().map(lost).map_err(Absent::clone));
        record.put_or_absent(ENERGY_GAINED, energy.as_ref().map(gained).map_err(Absent::clone));
        let mass = std::f64::consts::PI * (s.outer * s.outer - s.inner * s.inner);
        let velocity = self.points(|at| at.velocity);
        let phases = ContactPhase::all(&velocity, mass, ROUND_OFF * s.speed);
        let last = velocity.last().map_or(f64::NAN, |(_, velocity)| *velocity);
        put_contact(&phases, last / s.speed, record);
        reference::compare(s, &phases, record);
    }
}

/// Force of round-off, over mass and speed of a ring \[c₀/L\].
const ROUND_OFF: f64 = 1e-9;

impl Watch<RingSettings> for RingHistory {
    fn after_step(&mut self, s: &RingSettings, now: &Snapshot<Symmetric>) {
        if now.time() >= self.next {
            self.next += s.end() / SAMPLES;
            self.sample(s, now);
        }
    }

    /// x, y and the largest principal stress of the ring on the right, for pictures.
    fn keep(s: &RingSettings, now: &Snapshot<Symmetric>, stop: usize, record: &mut Record) {
        let share = (stop + 1) as f64 / s.samples as f64;
        let (Ok(density), Ok(stress)) = (now.density(), now.stress()) else { return };
        let is_frame = ((stop + 1) * pictures::FRAMES).is_multiple_of(s.samples);
        if !PICTURES.contains(&share) && !is_frame {
            return;
        }
        let all = along_flight(s, now.all());
        let eos = s.material().eos();
        let largest = |p: &Point| {
            let Symmetric { xx, yy, xy } = stress.of(p);
            0.5 * (xx + yy) + hypot(0.5 * (xx - yy), xy) - eos.pressure(density.of(p))
        };
        let [_, right] = halves(&all);
        let stressed = right.iter().map(|p| (p.position, largest(p)));
        match PICTURES.contains(&share) {
            true => {
                pictures::keep(record, &pictures::at_share(share), "L", ("stress", "Pa"), stressed)
            }
            false => pictures::keep_frame(record, share, "L", ("stress", "Pa"), stressed),
        }
    }

    fn measure(mut self, s: &RingSettings, end: &Snapshot<Symmetric>, record: &mut Record) {
        if record.status != Status::Completed {
            return self.put_series(record);
        }
        if self.samples.last().is_some_and(|last| last.time < end.time() * s.c0()) {
            self.sample(s, end);
        }
        self.put(s, record);
        let particles = along_flight(s, end.all());
        let mass = particles.iter().fold(0.0, |sum, p| sum + p.mass);
        let of_ring = 0.5 * mass * s.speed().max(f64::MIN_POSITIVE);
        record.put(MOMENTUM, momentum(&particles).norm() / of_ring);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solids::rings::RUBBER_RINGS;
    use touchstone_harness::case::Case;
    use touchstone_harness::context::Context;
    use touchstone_solver::Particle;

    #[test]
    fn centre_velocity_and_extents_are_those_of_the_ring() {
        let particles = Snapshot::of(0.0, &RingSettings::default().particles()).all();
        let [left, _] = halves(&particles);
        let [centre, velocity, extent] = side(left, 0.1);
        assert!((centre.x + 5.0).abs() < 1e-12 && centre.y.abs() < 1e-12);
        assert!((extent.x - 8.0).abs() < 1e-3 && (extent.y - 8.0).abs() < 1e-3);
        assert!((velocity.x - 0.059).abs() < 1e-12);
    }

    /// A run of made-up places: the rings of the scene, changed.
    fn watched(change: impl Fn(f64, &mut Particle<Symmetric>)) -> (Record, Vec<(f64, f64)>) {
        let settings = RingSettings::default();
        let start = Snapshot::of(0.0, &settings.particles());
        let mut series = RingHistory::new(&settings, &start, &start);
        for k in 1..40 {
            let time = f64::from(k);
            let mut particles = settings.particles();
            particles.iter_mut().for_each(|p| change(time, p));
            series.sample(&settings, &Snapshot::of(time, &particles));
        }
        let mut record = Record::new("rubber_rings", "made-up", serde_json::Value::Null, 1);
        series.put(&settings, &mut record);
        (record, series.points(|at| at.counts.holes))
    }

    /// As in rings at 0.09 to 0.12 c0: a ring opens at its rear pole into a C, still one piece.
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
        let material = RingSettings::default().material();
        let mut p = Particle::fluid(Vector2::zeros(), Vector2::new(0.6, 0.8), 1.0, 0.01);
        let of = |p| ElasticEnergy::of(&Snapshot::of(0.0, &[p]), &material).expect("every column");
        let at_rest = of(p);
        assert!((at_rest.kinetic - 0.005).abs() < 1e-15 && at_rest.compression.abs() < 1e-15);
        // Small compression: K e²/2 an area; pure shear: tau²/(2 mu) an area.
        (p.density, p.extra.xy) = (1.0 + 1e-4, 1e-4);
        let strained = of(p);
        assert!((strained.compression / (0.01 * 0.5e-8) - 1.0).abs() < 1e-3);
        assert!((strained.shear / (0.01 * 1e-8 / (2.0 * 0.22)) - 1.0).abs() < 1e-3);
    }

    /// The series had no row at t = 0 and its last row twice.
    #[test]
    fn the_series_begins_at_the_start_and_has_each_time_once() {
        // With steps that meet the end and the times of samples, and with steps that do not.
        for dt in [None, Some(0.125)] {
            let set = |s: &mut RingSettings| (s.spacing, s.end, s.dt) = (0.5, 5.0, dt);
            let spec = RUBBER_RINGS.spec("leapfrog", set);
            let record = RUBBER_RINGS.run(&spec, &Context::default()).expect("a run");
            let times = record.column(TIME);
            assert_eq!((times.first(), times.last()), (Some(&0.0), Some(&5.0)));
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
            assert_eq!(record.column(PLACE)[0], 5.0);
        }
    }
}
