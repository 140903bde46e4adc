//! What is measured of the water: front, heights, levels, momentum, and pressure on the far wall.

use nalgebra::Vector2;
use solver::{EquationOfState, Evolved, Flow, Observer, Stepper, Tait};

use super::{Dam, metrics};
use base::record::{Profile, Record};

/// Heights of the sensors on the far wall \[m\], and their diameter (Lobovsky et al. 2014).
pub const SENSORS: [f64; 4] = [0.003, 0.015, 0.030, 0.080];
const DIAMETER: f64 = 0.0042;
/// Places of the level probes, from the back wall \[m\].
pub const PROBES: [f64; 4] = [0.300, 0.865, 1.114, 1.3625];

/// Where the residual height is read, and half of the width that it is read over, from the back wall
/// \[width of the column\]; at least ± 2 dx, the least width over which a lattice has an exact depth.
///
/// Not at the wall itself: the particles next to it slide down it more slowly than the water does, in a
/// layer of a few spacings, so a probe within so many spacings of it would read the layer, at a place
/// that moves with the spacing.
const HEIGHT_AT: f64 = 0.2;
const HEIGHT_OVER: f64 = 0.05;

/// A particle this far behind the surface of a wall is lost \[dx\]. A splash may dent a wall of
/// particles, whose surface lies half a spacing before the first of them.
const LOST: f64 = 0.5;

/// Depth of water at x: Σ V hat((x_i − x)/w)/w with the hat function 1 − |ξ| of half-width w.
///
/// A gauge that adds up what is wet, not one that finds the topmost drop. Exact for columns of a
/// lattice, wherever they stand, if w is a whole number of spacings.
fn depth<'a>(particles: impl Iterator<Item = (f64, &'a Evolved<()>)>, x: f64, w: f64) -> f64 {
    particles.fold(0.0, |sum, (mass, p)| {
        let hat = (1.0 - ((p.position.x - x) / w).abs()).max(0.0);
        sum + mass / p.density * hat / w
    })
}

/// x of the foremost particle of the water that counts \[m\].
fn foremost<'a>(
    particles: impl Iterator<Item = (f64, &'a Evolved<()>)>,
    counts: impl Fn(Vector2<f64>) -> bool,
) -> f64 {
    let water = particles.filter(|(_, p)| counts(p.position));
    water.map(|(_, p)| p.position.x).fold(f64::NEG_INFINITY, f64::max)
}

/// One sample: t \[s\]; front, residual height, levels \[m\]; particles outside; kinetic Mach
/// number; excursion of the density.
#[derive(Clone, Copy, Debug)]
struct Sample {
    time: f64,
    front: f64,
    height: f64,
    levels: [f64; 4],
    outside: f64,
    deepest: f64,
    speed: f64,
    density: [f64; 2],
}

/// Samples of a run.
pub struct Samples<'a> {
    dam: &'a Dam,
    /// x of the foremost particle at the start \[m\].
    start: f64,
    samples: Vec<Sample>,
    /// t, momentum and the force of walls and gravity: the last of them, the impulse so far, and the
    /// largest gap.
    balance: Option<Balance>,
}

#[derive(Clone, Copy, Debug)]
struct Balance {
    time: f64,
    start: Vector2<f64>,
    force: Vector2<f64>,
    impulse: Vector2<f64>,
    gap: f64,
}

impl<'a> Samples<'a> {
    /// None yet.
    pub fn new(dam: &'a Dam) -> Self {
        Self { dam, start: f64::NAN, samples: Vec::new(), balance: None }
    }

    /// Takes a sample of a simulation that has been brought to a time.
    pub fn sample(&mut self, simulation: &dyn Stepper<()>) {
        let (s, dx) = (&self.dam.settings, self.dam.medium.dx);
        let counts = |place| (self.dam.is_front)(place, s.height);
        let foremost = foremost(simulation.fluid(), counts);
        if self.samples.is_empty() {
            self.start = foremost;
        }
        let (width, w) = (self.dam.tank.width(), 2.0 * dx);
        let over = (HEIGHT_OVER * s.width / dx).round().max(2.0) * dx;
        let depth_of = |p: &Evolved<()>| {
            (-p.position.x).max(p.position.x - width).max(-p.position.y).max(0.0) / dx
        };
        let outside = simulation.fluid().filter(|(_, p)| depth_of(p) > LOST).count() as f64;
        let deepest = simulation.fluid().map(|(_, p)| depth_of(p)).fold(0.0, f64::max);
        let fastest = simulation.fluid().map(|(_, p)| p.velocity.norm()).fold(0.0, f64::max);
        let fold = |f: fn(f64, f64) -> f64| {
            simulation.fluid().map(|(_, p)| p.density / s.rho - 1.0).fold(f64::NAN, f)
        };
        self.samples.push(Sample {
            time: simulation.time(),
            // Water reaches a fixed distance beyond its foremost particle, by which it begins at a.
            front: s.width + foremost - self.start,
            height: depth(simulation.fluid(), HEIGHT_AT * s.width, over),
            levels: PROBES.map(|x| depth(simulation.fluid(), x, w)),
            outside,
            deepest,
            speed: fastest,
            density: [fold(f64::min), fold(f64::max)],
        });
        self.balance(simulation);
    }

    /// Momentum against the impulse of walls and gravity, by the trapezoidal rule.
    fn balance(&mut self, simulation: &dyn Stepper<()>) {
        let rates = simulation.total_rates();
        let (mut momentum, mut force) = (Vector2::zeros(), Vector2::zeros());
        for ((mass, p), rate) in simulation.fluid().zip(&rates) {
            momentum += p.velocity * mass;
            force += rate.velocity * mass;
        }
        let time = simulation.time();
        let now = match self.balance {
            None => Balance { time, start: momentum, force, impulse: Vector2::zeros(), gap: 0.0 },
            Some(b) => {
                let impulse = b.impulse + (b.force + force) * (0.5 * (time - b.time));
                let gap = (momentum - b.start - impulse).norm().max(b.gap);
                Balance { time, force, impulse, gap, ..b }
            }
        };
        self.balance = Some(now);
    }

    /// (t, front) \[s, m\].
    pub fn front(&self) -> Vec<(f64, f64)> {
        self.samples.iter().map(|s| (s.time, s.front)).collect()
    }

    /// (t, residual height) \[s, m\].
    pub fn height(&self) -> Vec<(f64, f64)> {
        self.samples.iter().map(|s| (s.time, s.height)).collect()
    }

    /// (t, level at probe k) \[s, m\].
    pub fn level(&self, k: usize) -> Vec<(f64, f64)> {
        self.samples.iter().map(|s| (s.time, s.levels[k])).collect()
    }

    /// Metrics that need no reference, and the series.
    pub fn measure(&self, mass: f64, record: &mut Record) {
        let Dam { settings: s, medium, .. } = self.dam;
        let most = |f: &dyn Fn(&Sample) -> f64| self.samples.iter().map(f).fold(f64::NAN, f64::max);
        record.put(metrics::OUTSIDE, most(&|s| s.outside));
        let last = self.samples.last().map_or(f64::NAN, |s| s.outside);
        record.put(metrics::OUTSIDE_END, last);
        record.put(metrics::OUTSIDE_DEPTH, most(&|s| s.deepest));
        record.put(metrics::MACH, most(&|s| s.speed) / medium.eos.sound_speed);
        record.put(metrics::DENSITY_MOST, most(&|s| s.density[1]));
        record.put(metrics::DENSITY_LEAST, -most(&|s| -s.density[0]));
        let scale = mass * (s.gravity * s.height).sqrt();
        let gap = self.balance.map_or(f64::NAN, |b| b.gap) / scale;
        record.put(metrics::MOMENTUM_GAP, gap);
        let column = |f: &dyn Fn(&Sample) -> f64| self.samples.iter().map(f).collect();
        let mut series = Profile::default()
            .with("t", "s", column(&|s| s.time))
            .with("front", "m", column(&|s| s.front))
            .with("height", "m", column(&|s| s.height));
        for k in 0..PROBES.len() {
            series = series.with(&format!("H{}", k + 1), "m", column(&|s| s.levels[k]));
        }
        record.profiles.insert("series".into(), series);
    }
}

/// A point of a sensor: place, share of the sensor, and the part of the kernel that lies in the tank.
struct Spot {
    place: Vector2<f64>,
    share: f64,
    inside: f64,
}

/// Pressure on the far wall, read after every step.
///
/// At a point of the wall p = Σ V p W/max(Σ V W, φ/2), φ the part of the kernel inside of the tank:
/// the mean of the water that is near, falling to 0 where less than half of the place is wet. A sensor is
/// the mean over its disk.
pub struct Gauge {
    eos: Tait,
    /// x beyond which water is in reach of the wall \[m\].
    reach: f64,
    sensors: Vec<Vec<Spot>>,
    rows: Vec<[f64; 5]>,
}

/// The kernel W(r) \[1/m²\] of r² \[m²\].
type Weight<'a> = &'a dyn Fn(f64) -> f64;

impl Gauge {
    /// Sensors on the far wall of a tank; none where the wall is not that of the experiment.
    pub fn new(dam: &Dam, support: f64, weight: Weight) -> Self {
        let wall = dam.tank.width();
        let sensors = if dam.is_lobovsky() { &SENSORS[..] } else { &[] };
        let sensors = sensors.iter().map(|y| spots((support, weight), wall, *y)).collect();
        Self { eos: dam.medium.eos, reach: wall - support, sensors, rows: Vec::new() }
    }

    fn read(&self, simulation: &dyn Stepper<()>) -> Vec<f64> {
        let near: Vec<(Vector2<f64>, f64, f64)> = simulation
            .fluid()
            .filter(|(_, p)| p.position.x > self.reach)
            .map(|(mass, p)| (p.position, mass / p.density, self.eos.pressure(p.density)))
            .collect();
        let at = |spot: &Spot| {
            let (mut wet, mut sum) = (0.0, 0.0);
            for (place, volume, pressure) in &near {
                let w = volume * simulation.weight((place - spot.place).norm_squared());
                wet += w;
                sum += w * pressure;
            }
            spot.share * sum / wet.max(0.5 * spot.inside)
        };
        self.sensors.iter().map(|spots| spots.iter().map(at).sum()).collect()
    }

    /// (t, p of sensor k) \[s, Pa\], means over blocks of this length \[s\].
    pub fn pressure(&self, k: usize, block: f64) -> Vec<(f64, f64)> {
        let mut blocks: Vec<(f64, f64, f64)> = Vec::new();
        for row in &self.rows {
            let number = (row[0] / block).floor();
            match blocks.last_mut() {
                Some((last, sum, count)) if *last == number => {
                    (*sum, *count) = (*sum + row[k + 1], *count + 1.0)
                }
                _ => blocks.push((number, row[k + 1], 1.0)),
            }
        }
        blocks.into_iter().map(|(n, sum, count)| ((n + 0.5) * block, sum / count)).collect()
    }
}

/// The points of a sensor on the wall x = `wall` at a height \[m\], weighted by the chords of its disk.
fn spots(kernel: (f64, Weight), wall: f64, height: f64) -> Vec<Spot> {
    const POINTS: usize = 5;
    let offset = |k: usize| (k as f64 + 0.5) / POINTS as f64 * 2.0 - 1.0;
    let chord = |k: usize| (1.0 - offset(k) * offset(k)).sqrt();
    let all: f64 = (0..POINTS).map(chord).sum();
    let spot = |k: usize| {
        let y = height + 0.5 * DIAMETER * offset(k);
        let place = Vector2::new(wall, y);
        Spot { place, share: chord(k) / all, inside: inside(kernel, y) }
    };
    (0..POINTS).map(spot).collect()
}

/// The integral of a kernel, of which the support \[m\] is given too, about a point of a wall at this height
/// over the quarter-plane of water.
fn inside((support, weight): (f64, Weight), height: f64) -> f64 {
    const CELLS: i32 = 40;
    let cell = support / f64::from(CELLS);
    let middle = |k: i32| (f64::from(k) + 0.5) * cell;
    let columns = (0..CELLS).map(middle);
    columns
        .flat_map(|x| (-CELLS..CELLS).map(move |j| (x, middle(j))))
        .filter(|(_, y)| height + y > 0.0)
        .fold(0.0, |sum, (x, y)| sum + cell * cell * weight(x * x + y * y))
}

impl Observer<()> for Gauge {
    fn after_step(&mut self, simulation: &dyn Stepper<()>) -> Flow {
        if !self.sensors.is_empty() {
            let p = self.read(simulation);
            self.rows.push([simulation.time(), p[0], p[1], p[2], p[3]]);
        }
        Flow::Continue
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dam_break::setup::near_the_floor;
    use solver::{Smoothing, WendlandC2};

    fn still(x: f64, y: f64) -> Evolved<()> {
        let (position, velocity) = (Vector2::new(x, y), Vector2::zeros());
        Evolved { position, velocity, density: 1000.0, extra: () }
    }

    #[test]
    fn depth_is_exact_for_a_lattice_wherever_the_probe_is() {
        let dx = 0.1;
        let water: Vec<_> =
            solver::lattice(Vector2::new(0.05, 0.05), dx, 20, 7).map(|p| still(p.x, p.y)).collect();
        let all = || water.iter().map(|p| (1000.0 * dx * dx, p));
        for x in [0.2, 0.73, 1.111, 1.8] {
            assert!((depth(all(), x, 2.0 * dx) - 0.7).abs() < 1e-12);
        }
        assert!((depth(all(), 2.0, 2.0 * dx) - 0.35).abs() < 1e-12, "half of the probe is dry");
        assert_eq!(depth(all(), 3.0, 2.0 * dx), 0.0);
        let low = |place| near_the_floor(place, 0.6);
        assert!((foremost(all(), low) - 1.95).abs() < 1e-12);
        let spray = still(9.0, 5.0);
        let with_spray = all().chain([(1.0, &spray)]);
        assert!((foremost(with_spray, low) - 1.95).abs() < 1e-12);
    }

    #[test]
    fn half_of_a_kernel_is_in_front_of_a_wall_and_a_quarter_in_a_corner() {
        let smoothing = Smoothing::<WendlandC2>::new(0.1);
        let weight = |r2| smoothing.w(r2);
        let kernel: (f64, Weight) = (smoothing.support(), &weight);
        for (height, expected) in [(0.5, 0.5), (0.0, 0.25)] {
            let part = inside(kernel, height);
            assert!((part - expected).abs() < 1e-3, "{height}: {part}");
        }
        let all: f64 = spots(kernel, 1.0, 0.3).iter().map(|s| s.share).sum();
        assert!((all - 1.0).abs() < 1e-12);
    }
}
