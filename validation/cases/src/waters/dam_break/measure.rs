//! Metrics of the water: front, heights, levels, potential energy, and pressure on the far wall.

use std::{collections::BTreeSet, ops::ControlFlow};

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::absent::Absent;
use touchstone_harness::prelude::*;
use touchstone_harness::snapshot::{Point, Snapshot};
use touchstone_maths::metrics::{
    curve::fallen_back,
    gauge::{self, Spot, Weight, depth, probe},
};
use touchstone_solver::EquationOfState;

use super::{Dam, columns, metrics};

/// Heights of the sensors on the far wall \[m\], and their diameter (Lobovsky et al. 2014).
pub const SENSORS: [f64; 4] = [0.003, 0.015, 0.030, 0.080];
const DIAMETER: f64 = 0.0042;
/// Places of the level probes, from the back wall \[m\].
pub const PROBES: [f64; 4] = [0.300, 0.865, 1.114, 1.3625];

/// Where the residual height is read, and half of the width that it is read over, from the back wall
/// \[width of the column\]; at least ± 2 dx, or less where that would reach behind the wall.
///
/// Not at the wall itself: the particles next to it slide down more slowly than the water, in a layer of a
/// few spacings, so a probe within it would measure the layer, at a place that depends on the spacing.
const HEIGHT_AT: f64 = 0.2;
const HEIGHT_OVER: f64 = 0.05;

/// A particle this far behind the surface of a wall is lost \[dx\]. A splash may dent a wall of particles,
/// whose surface is half a spacing before the first of them.
const LOST: f64 = 0.5;

/// Findings in a part of the water.
struct Findings {
    /// x of the foremost particle below a quarter of the height of the column \[m\]: spray does not count.
    foremost: f64,
    /// x \[m\] and volume \[m²\] of the particles within reach of a probe.
    near: Vec<[f64; 2]>,
    /// Whether a particle is behind a wall.
    has_lost: bool,
    /// The largest speed \[m/s\].
    fastest: f64,
}

impl Findings {
    /// Findings in these particles of the volumes [m²], with these probes (x and half of the width [m]).
    fn of(
        water: &[Point],
        dam: &Dam,
        volume: impl Fn(&Point) -> f64,
        probes: &[(f64, f64)],
    ) -> Self {
        let low = water.iter().filter(|p| p.position.y < 0.25 * dam.settings.height);
        let values = water.iter().map(|p| [p.position.x, volume(p)]);
        // A volume that is not a number makes every depth undefined.
        let is_near = |[x, volume]: &[f64; 2]| {
            !volume.is_finite() || probes.iter().any(|(place, w)| (x - place).abs() < *w)
        };
        Self {
            foremost: low.map(|p| p.position.x).fold(f64::NEG_INFINITY, f64::max),
            near: values.filter(is_near).collect(),
            has_lost: water.iter().any(|p| dam.is_lost(p.position)),
            fastest: water.iter().map(|p| p.velocity.norm()).fold(f64::NAN, f64::max),
        }
    }

    fn and(mut self, other: Self) -> Self {
        self.near.extend(other.near);
        Self {
            foremost: self.foremost.max(other.foremost),
            near: self.near,
            has_lost: self.has_lost || other.has_lost,
            fastest: self.fastest.max(other.fastest),
        }
    }
}

/// The floor under water at rest \[m\]: half a spacing below its lowest particle, whose area at rest states
/// the spacing. Variants place their lowest row half a spacing or a whole one above the surface of the wall.
fn floor(water: &[Point], density: f64) -> f64 {
    let lowest = water.iter().min_by(|a, b| a.position.y.total_cmp(&b.position.y));
    lowest.map_or(f64::NAN, |p| p.position.y - 0.5 * (p.mass / density).sqrt())
}

/// Mean height of the mass of all particles \[m\].
fn centre(water: &Snapshot) -> f64 {
    let moments = water.of_moving(|p| [p.mass, p.mass * p.position.y]);
    let add = |[all, sum]: [f64; 2], [mass, moment]: [f64; 2]| [all + mass, sum + moment];
    let [mass, moment] = moments.fold([0.0; 2], add);
    moment / mass
}

/// The water at a time.
#[derive(Serialize, Deserialize)]
struct TankSample {
    /// \[s\].
    time: f64,
    /// Place of the front \[m\].
    front: f64,
    /// Residual height \[m\].
    height: Result<f64, Absent>,
    /// Levels at H1 to H4 \[m\].
    levels: [Result<f64, Absent>; 4],
    /// Potential energy \[M g H/2\].
    potential: f64,
}

/// Samples of a run.
#[derive(Serialize, Deserialize)]
pub struct Samples {
    /// x of the foremost particle at the start \[m\].
    foremost: f64,
    /// The floor under the water at the start \[m\].
    floor: f64,
    series: Vec<TankSample>,
    /// Height of the centre of mass at the start/(H/2) - 1.
    released: f64,
    /// The most particles outside at any time.
    outside_most: f64,
    /// Particles outside at the last sample.
    outside: f64,
    /// The largest speed \[m/s\].
    fastest: f64,
    /// Numbers of the particles that have left over the rim.
    spilled: BTreeSet<usize>,
}

impl Dam {
    /// Whether a place is behind the surface of a wall by more than the depth of a dent.
    fn is_lost(&self, x: Vector2<f64>) -> bool {
        let behind = (-x.x).max(x.x - self.tank.width()).max(-x.y).max(0.0);
        behind / self.medium.dx > LOST
    }
}

impl Samples {
    /// None yet.
    pub fn new() -> Self {
        Self {
            foremost: f64::NAN,
            floor: f64::NAN,
            series: Vec::new(),
            released: f64::NAN,
            outside_most: f64::NAN,
            outside: f64::NAN,
            fastest: f64::NAN,
            spilled: BTreeSet::new(),
        }
    }

    /// Takes a sample of a simulation that has been brought to a time.
    pub fn sample(&mut self, dam: &Dam, now: &Snapshot) {
        let (s, dx) = (&dam.settings, dam.medium.dx);
        let (over, width) = ((HEIGHT_OVER * s.width / dx).round().max(2.0), dam.tank.width());
        let [h1, h2, h3, h4] = PROBES.map(|x| probe(x, 2.0, dx, width));
        let probes = [probe(HEIGHT_AT * s.width, over, dx, width), h1, h2, h3, h4];
        let density = now.density();
        let volume = |p: &Point| density.as_ref().map_or(0.0, |density| p.mass / density.of(p));
        let parts = now.in_parts(|water| Findings::of(water, dam, volume, &probes));
        let Some(found) = parts.into_iter().reduce(Findings::and) else { return };
        let (centre, half) = (centre(now), 0.5 * s.height);
        if self.released.is_nan() {
            self.foremost = found.foremost;
            self.floor = floor(&now.moving(), dam.medium.eos.density);
            self.released = centre / half - 1.0;
        }
        let depth_at = |(place, w)| match &density {
            Ok(_) => Ok(depth(&found.near, place, w)),
            Err(absent) => Err(absent.clone()),
        };
        // Water reaches a fixed distance beyond its foremost particle, by which it begins at a.
        let front = s.width + found.foremost - self.foremost;
        let [height, levels @ ..] = probes.map(depth_at);
        let (time, potential) = (now.time(), (centre - self.floor) / half);
        self.series.push(TankSample { time, front, height, levels, potential });
        self.look_at_walls(dam, now, &found);
    }

    /// Counts lost particles, without particles that have left over the rim: the walls are several spacings
    /// thick, so such a particle is first above them, or a dent in their upper end. Measures the speed of the
    /// water that has not left.
    fn look_at_walls(&mut self, dam: &Dam, now: &Snapshot, found: &Findings) {
        let reach = LOST * dam.medium.dx;
        // Particles by their numbers are copies, which most samples do without.
        if self.spilled.is_empty() && !found.has_lost {
            self.fastest = self.fastest.max(found.fastest);
            (self.outside_most, self.outside) = (self.outside_most.max(0.0), 0.0);
            return;
        }
        let mut lost = 0.0;
        let all = now.all().into_iter().enumerate();
        for (k, p) in all.filter(|(_, p)| p.is_fluid()) {
            let is_lost = dam.is_lost(p.position);
            if is_lost && p.position.y >= dam.rim - reach {
                self.spilled.insert(k);
            }
            if !self.spilled.contains(&k) {
                lost += f64::from(is_lost);
                self.fastest = self.fastest.max(p.velocity.norm());
            }
        }
        (self.outside_most, self.outside) = (self.outside_most.max(lost), lost);
    }

    /// The most by which the front is behind where it has been, until it is two spacings from the far wall,
    /// from which water comes back \[m\].
    fn fallen_back(&self, dam: &Dam) -> f64 {
        let fronts: Vec<f64> = self.series.iter().map(|at| at.front).collect();
        fallen_back(&fronts, dam.settings.width, dam.tank.width() - 2.0 * dam.medium.dx)
    }

    /// Metrics that need no reference, and the series.
    pub fn measure(&self, dam: &Dam, record: &mut Record) {
        record.put(metrics::OUTSIDE, self.outside_most);
        record.put(metrics::OUTSIDE_END, self.outside);
        record.put(metrics::SPILLED, self.spilled.len() as f64 / (dam.columns * dam.rows) as f64);
        record.put(metrics::RELEASED, self.released);
        record.put(metrics::FRONT_BACK, self.fallen_back(dam) / dam.settings.width);
        record.put(metrics::MACH, self.fastest / dam.medium.eos.sound_speed);
        record.put_column(columns::TIME, &self.series, |at| at.time);
        record.put_column(columns::FRONT, &self.series, |at| at.front);
        record.put_known_column(columns::HEIGHT, &self.series, |at| at.height.clone());
        for (k, level) in columns::LEVELS.into_iter().enumerate() {
            record.put_known_column(level, &self.series, |at| at.levels[k].clone());
        }
        record.put_column(columns::POTENTIAL, &self.series, |at| at.potential);
    }
}

/// Blocks over which pressures are averaged \[(H/g)^(1/2)\], for the record.
const BLOCK: f64 = 0.01;

/// Pressure on the far wall, read after every step: the means over the disks of sensors.
#[derive(Serialize, Deserialize)]
pub struct Gauge {
    /// x beyond which water is in reach of the wall \[m\].
    reach: f64,
    sensors: Vec<Vec<Spot>>,
    /// Times \[s\], and the pressure at each sensor \[Pa\].
    rows: Vec<(f64, Vec<f64>)>,
}

impl Gauge {
    /// Sensors on the far wall of a tank; none where the wall is not the experiment's.
    pub fn new(dam: &Dam, support: f64, weight: Weight) -> Self {
        let wall = dam.tank.width();
        let sensors = if dam.is_lobovsky() { &SENSORS[..] } else { &[] };
        let of = |y: &f64| gauge::sensor((support, weight), wall, [*y, DIAMETER]);
        let sensors = sensors.iter().map(of).collect();
        Self { reach: wall - support, sensors, rows: Vec::new() }
    }

    fn read(&self, dam: &Dam, now: &Snapshot) -> Result<Vec<f64>, Absent> {
        let (density, reach, eos) = (now.density()?, self.reach, dam.medium.eos);
        let near = now.in_parts(|water| {
            let near = water.iter().filter(|p| p.position.x > reach).map(|p| (p, density.of(p)));
            let of =
                |(p, density): (&Point, _)| (p.position, p.mass / density, eos.pressure(density));
            near.map(of).collect::<Vec<_>>()
        });
        let weight = |r2| now.weight(r2);
        let read = |sensor: &Vec<Spot>| gauge::pressure(sensor, near.iter().flatten(), &weight);
        Ok(self.sensors.iter().map(read).collect())
    }

    /// Reads the sensors after a step.
    pub fn after_step(&mut self, dam: &Dam, now: &Snapshot) -> ControlFlow<()> {
        if let (false, Ok(p)) = (self.sensors.is_empty(), self.read(dam, now)) {
            self.rows.push((now.time(), p));
        }
        ControlFlow::Continue(())
    }

    /// Pressures over time, means over blocks of [`BLOCK`], in the units of the column.
    pub fn measure(&self, dam: &Dam, record: &mut Record) {
        let (unit, scale) = (dam.settings.unit_time(), dam.unit_pressure());
        let block = |(time, _): &(f64, Vec<f64>)| (time / (BLOCK * unit)).floor();
        let blocks: Vec<_> = self.rows.chunk_by(|a, b| block(a) == block(b)).collect();
        let middle = |rows: &&[_]| (block(&rows[0]) + 0.5) * (BLOCK * unit) / unit;
        record.put_column(columns::PRESSURE_TIME, &blocks, middle);
        for (k, sensor) in columns::PRESSURES.into_iter().enumerate() {
            record.put_column(sensor, &blocks, |rows| {
                rows.iter().map(|(_, p)| p[k]).sum::<f64>() / rows.len() as f64 / scale
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::waters::dam_break::lobovsky;
    use touchstone_harness::method::Parts;
    use touchstone_harness::snapshot::Snapshot;
    use touchstone_solver::{Particle, Smoothing, WendlandC2};

    impl Samples {
        /// Samples with these t, front, residual height, levels \[s, m\] and potential energy \[M g H/2\].
        pub fn made_up(rows: impl Iterator<Item = [f64; 8]>) -> Self {
            let sample = |[time, front, height, levels @ .., potential]: [f64; 8]| {
                let (height, levels) = (Ok(height), levels.map(Ok));
                TankSample { time, front, height, levels, potential }
            };
            Self { series: rows.map(sample).collect(), ..Self::new() }
        }

        fn row(&self, row: usize) -> [f64; 8] {
            let TankSample { time, front, height, levels, potential } = &self.series[row];
            let known = |of: &Result<f64, Absent>| of.clone().expect("densities");
            let [h1, h2, h3, h4] = levels.each_ref().map(known);
            [*time, *front, known(height), h1, h2, h3, h4, *potential]
        }
    }

    impl Gauge {
        /// A gauge that has read these t \[s\] and pressures \[Pa\].
        pub fn made_up(rows: Vec<[f64; 5]>) -> Self {
            let rows = rows.into_iter().map(|[time, p @ ..]| (time, p.to_vec())).collect();
            Self { reach: 0.0, sensors: Vec::new(), rows }
        }
    }

    /// A simulation of these particles in place of the particles of a dam break, without walls.
    fn at_start(particles: Vec<Particle>) -> Snapshot<'static> {
        Snapshot::of(0.0, &particles)
    }

    /// Water of the density at rest from one column to another, `rows` rows high, with this velocity.
    fn water(dam: &Dam, from: usize, to: usize, rows: usize, v: Vector2<f64>) -> Vec<Particle> {
        let dx = dam.medium.dx;
        let first = Vector2::new(from as f64 + 0.5, 0.5) * dx;
        touchstone_solver::lattice(first, dx, to - from, rows)
            .map(|x| Particle::fluid(x, v, dam.settings.water.rho, dx * dx))
            .collect()
    }

    fn record(dam: &Dam, measure: impl Fn(&mut Record)) -> Record {
        let mut record = Record::new(
            "dam_break",
            "modern",
            touchstone_base::settings::to_json(&dam.settings),
            1,
        );
        measure(&mut record);
        record
    }

    fn is(value: f64, expected: f64) {
        let error = (value - expected).abs();
        assert!(error <= 1e-9 * expected.abs().max(1e-3), "{value} instead of {expected}");
    }

    #[test]
    fn front_height_and_levels_are_those_of_water_put_by_hand() {
        let tank = Dam::changed(|s| {
            lobovsky(s);
            s.n = 10;
        })
        .unwrap();
        let dx = tank.medium.dx;
        let mut samples = Samples::new();
        for (from, to, rows) in [(0, 20, 10), (3, 40, 4), (5, 50, 2)] {
            let mut all = water(&tank, from, to, rows, Vector2::zeros());
            // Spray above a quarter of the column does not count.
            all.push(Particle::fluid(Vector2::new(1.55, 0.2), Vector2::zeros(), 1e3, 1e-12));
            samples.sample(&tank, &at_start(all));
        }
        // Front, residual height, whose probe reads from 2 to 6 spacings, and levels.
        for (row, front, height, levels) in [
            (0, 0.0, 10.0, [10.0, 0.0, 0.0, 0.0]),
            (1, 20.0, 4.0 * (1.0 - 0.5 * 0.25), [4.0, 4.0, 4.0, 0.0]),
            (2, 30.0, 2.0 * 0.125, [2.0; 4]),
        ] {
            let [_, reached, fallen, found @ .., _] = samples.row(row);
            is(reached, 0.6 + front * dx);
            is(fallen, height * dx);
            for (level, expected) in found.into_iter().zip(levels) {
                assert!((level - expected * dx).abs() < 1e-6 * dx, "{level}: {expected} dx");
            }
        }
        // Water that ends at 45 spacings fills a part of the range of H4, from 43.42 to 47.42.
        let mut samples = Samples::new();
        samples.sample(&tank, &at_start(water(&tank, 30, 45, 3, Vector2::zeros())));
        let hat = |k: f64| (1.0 - (k + 0.5 - 1.3625 / dx).abs() / 2.0) / 2.0;
        is(samples.row(0)[6], 3.0 * dx * (hat(44.0) + hat(43.0)));
    }

    /// A table that lost its heights passed every gate: front, heights and levels are areas over x.
    #[test]
    fn potential_energy_is_that_of_water_put_by_hand_and_heights_are_seen() {
        let free = Dam::changed(|s| s.n = 10).unwrap();
        let (dx, height) = (free.medium.dx, free.settings.height);
        let as_it_is = |y: f64| y;
        for (place, released) in [
            (&as_it_is as &dyn Fn(f64) -> f64, 0.0),
            (&|y| y + 0.5 * dx, 1.0 / 20.0), // the lowest row a whole spacing above the wall
            (&|_| 1e-3, 1e-3 / (0.5 * height) - 1.0),
            (&|y| 10.0 * y, 9.0),
        ] {
            let mut samples = Samples::new();
            for rows in [20, 5] {
                // An equal mass on fewer rows, or all over the floor.
                let mut all = water(&free, 0, 200 / rows, rows, Vector2::zeros());
                all.iter_mut().for_each(|p| p.position.y = place(p.position.y));
                samples.sample(&free, &at_start(all));
            }
            let record = record(&free, |record| samples.measure(&free, record));
            is(record.value(metrics::RELEASED).expect("a metric"), released);
            let [start, end] = [0, 1].map(|k| samples.row(k)[7]);
            let row = |k: usize| place((k as f64 + 0.5) * dx);
            let mean = |rows: usize| (0..rows).map(row).sum::<f64>() / rows as f64;
            let floor = row(0) - 0.5 * dx;
            is(start, 2.0 * (mean(20) - floor) / height);
            is(end, 2.0 * (mean(5) - floor) / height);
        }
    }

    #[test]
    fn what_is_behind_the_walls_and_how_fast_is_measured() {
        let free = Dam::changed(|s| s.n = 10).unwrap();
        let (dx, width) = (free.medium.dx, free.tank.width());
        let at = |x, y| Particle::fluid(Vector2::new(x, y) * dx, Vector2::zeros(), 1e3, dx * dx);
        let mut particles = water(&free, 0, 10, 20, Vector2::zeros());
        particles[7].velocity = Vector2::new(0.3, -0.4);
        let mut samples = Samples::new();
        samples.sample(&free, &at_start(particles.clone()));
        // Half a spacing is a dent; more than that is lost.
        particles.extend([
            at(-0.495, 3.0),
            at(-0.51, 5.0),
            at(3.0, -2.5),
            at(width / dx + 0.75, 5.0),
        ]);
        samples.sample(&free, &at_start(particles.clone()));
        particles.truncate(202);
        samples.sample(&free, &at_start(particles));
        let record = record(&free, |record| samples.measure(&free, record));
        let value = |metric| record.value(metric).expect("a metric");
        assert_eq!((value(metrics::OUTSIDE), value(metrics::OUTSIDE_END)), (3.0, 1.0));
        is(value(metrics::MACH), 0.5 / free.medium.eos.sound_speed);
    }

    /// Water that the far wall throws up may fall behind it: six particles of `modern` at H/dx = 30 counted
    /// as lost through the wall.
    #[test]
    fn a_particle_that_left_over_the_rim_counted_as_one_that_passed_a_wall() {
        let dam = Dam::changed(|s| s.n = 10).unwrap();
        let (dx, width, rim) = (dam.medium.dx, dam.tank.width(), dam.rim);
        assert!((rim / (1.25 * 0.1143) - 1.0).abs() < 0.5 / 25.0, "{rim}");
        let mut samples = Samples::new();
        for (over, through) in [
            ([-dx, rim], [-dx, 0.9 * rim]),
            ([0.6 * dx, rim - 0.4 * dx], [0.6 * dx, 0.9 * rim]),
            ([4.0 * dx, -9.0 * dx], [2.0 * dx, 0.9 * rim]),
        ] {
            // A drop that falls behind the far wall is faster than the water that counts.
            let at = |[x, y]: [f64; 2], v: f64| {
                Particle::fluid(Vector2::new(width + x, y), Vector2::new(0.0, v), 1e3, dx * dx)
            };
            let mut all = water(&dam, 0, 10, 20, Vector2::zeros());
            let fall = if over[1] < rim - dx { -2.0 } else { -0.2 };
            all.extend([at(over, fall), at(through, 0.5)]);
            samples.sample(&dam, &at_start(all));
        }
        let record = record(&dam, |record| samples.measure(&dam, record));
        let value = |metric| record.value(metric).expect("a metric");
        assert_eq!((value(metrics::OUTSIDE), value(metrics::OUTSIDE_END)), (1.0, 1.0));
        is(value(metrics::SPILLED), 1.0 / 200.0);
        is(value(metrics::MACH), 0.5 / dam.medium.eos.sound_speed);
    }

    #[test]
    fn a_sensor_reads_a_linear_pressure_at_its_height_and_less_where_it_is_half_dry() {
        let tank = Dam::changed(|s| {
            lobovsky(s);
            s.n = 60;
        })
        .unwrap();
        let (dx, eos, weight) = (tank.medium.dx, tank.medium.eos, 1e3 * 9.81);
        let pressure = |y: f64| weight * (0.5 - y);
        // Water behind the floor too, so that no kernel is cut and each mean is the value in its middle.
        let wall = |share: f64| {
            let first = Vector2::new(1.61 - 9.5 * dx, -29.5 * dx);
            let at = |x: Vector2<f64>| {
                let density = eos.density(pressure(x.y));
                Particle {
                    mass: share * density * dx * dx,
                    ..Particle::fluid(x, Vector2::zeros(), density, 1.0)
                }
            };
            let particles = touchstone_solver::lattice(first, dx, 10, 60).map(at).collect();
            let parts = Parts { particles, ..tank.scene().expect("a scene") };
            (tank.method.build)(parts).expect("a scene")
        };
        let full = wall(1.0);
        let gauge = Gauge::new(&tank, 2.0 * tank.medium.h, &|r2| full.weight(r2));
        let read = gauge.read(&tank, &Snapshot::ours(&*full)).expect("densities");
        for (value, height) in read.iter().zip(SENSORS) {
            let error = (value / pressure(height) - 1.0).abs();
            assert!(error < 2e-3, "{height} m: {error}");
        }
        // Only the highest sensor has no floor in its reach: a half of its kernel is in the tank, and a
        // quarter of this is wet, half of the full value.
        let dry = wall(0.25);
        let dry = gauge.read(&tank, &Snapshot::ours(&*dry)).expect("densities")[3] / read[3];
        assert!((dry - 0.5).abs() < 5e-3, "{dry}");
    }

    #[test]
    fn pressures_are_means_over_blocks_of_time() {
        let tank = Dam::changed(lobovsky).unwrap();
        let (unit, scale) = (tank.settings.unit_time(), tank.unit_pressure());
        let row = |k: u32| {
            let t = 0.002 * f64::from(k) + 0.001;
            let step = if k < 10 { 0.0 } else { 4.0 * scale };
            [t * unit, t * scale, 10.0 * t * scale, 0.0, step]
        };
        let gauge = Gauge::made_up((0..20).map(row).collect());
        let record = record(&tank, |record| gauge.measure(&tank, record));
        let t = record.column(columns::PRESSURE_TIME);
        let [one, two, _, four] = columns::PRESSURES.map(|sensor| record.column(sensor));
        assert_eq!(t.len(), 4);
        for k in 0..4 {
            is(t[k], 0.01 * k as f64 + 0.005);
            is(one[k], t[k]);
            is(two[k], 10.0 * t[k]);
            is(four[k], if k < 2 { 0.0 } else { 4.0 });
        }
    }

    /// The disks of the experiment are 4.2 mm across, at 3, 15, 30 and 80 mm. Over a disk of radius R the
    /// mean of the square of the distance along one axis from its middle is R²/4; five chords, each in the
    /// middle of its fifth, have 5 % more. A linear pressure, which has no curvature, does not show how wide
    /// a sensor is.
    #[test]
    fn a_sensor_is_as_wide_as_in_the_experiment() {
        let tank = Dam::changed(lobovsky).unwrap();
        let smoothing = Smoothing::<WendlandC2>::new(0.01);
        let gauge = Gauge::new(&tank, smoothing.support(), &|r2| smoothing.w(r2));
        assert_eq!(gauge.sensors.len(), 4, "sensors on the far wall");
        let radius = 2.1e-3;
        for (spots, height) in gauge.sensors.iter().zip([3e-3, 15e-3, 30e-3, 80e-3]) {
            let mean = |f: &dyn Fn(f64) -> f64| -> f64 {
                spots.iter().map(|spot| spot.share * f(spot.place.y - height)).sum()
            };
            let off = mean(&|y| y);
            assert!(off.abs() < 1e-12, "the middle of the sensor at {height} m is {off} m off");
            let square = mean(&|y| y * y) / (0.25 * radius * radius);
            let expected = "1 for 4.2 mm, 4 for twice as much";
            assert!((0.95..1.1).contains(&square), "mean square {square} of R²/4, {expected}");
            let wall = tank.tank.width();
            let off = spots.iter().map(|spot| (spot.place.x - wall).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12, "the sensor at {height} m is {off} m away from the far wall");
        }
    }
}
