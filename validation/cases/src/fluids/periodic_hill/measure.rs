//! Metrics: the field at stations and along the walls, averaged over the end of the run.

use std::ops::{AddAssign, Div};

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{
    absent::Absent,
    functions::hypot,
    record::{MetricKey, Record},
};
use touchstone_harness::{
    pictures,
    snapshot::{Point, Snapshot},
};
use touchstone_maths::metrics::{
    curve::longest_negative,
    fitted_field::{FieldPoint, FittedField},
    norms::{largest, rms},
};
use touchstone_solver::EquationOfState;

use super::{HillSetup, columns, reference::KNOWN_SETTINGS};

/// Points across a section.
pub const POINTS: usize = 200;
/// Stations \[H\].
pub const STATIONS: [f64; 10] = [0.05, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
/// Points along a wall, 0.025 H apart.
pub const WALL: usize = 361;

touchstone_base::metrics! {
    all ALL;
    FORCE = "force" ["U_b^2/H"] "mean body force of the last window";
    FLUX = "flux" ["-"] "mean flux over the flux wanted, minus 1, from the particles' volumes";
    SECTION_FLUX = "section_flux" ["-"]
        "largest |flux through a station/flux wanted - 1|, interpolated";
    DRAG_BALANCE = "drag_balance" ["-"]
        "(shear on both walls + pressure on the hill)/(force times area) - 1";
    SEPARATION = "separation" ["H"] "where the wall shear on the hill changes its sign";
    REATTACHMENT = "reattachment" ["H"] "where the wall shear on the hill changes its sign";
    L2_U = "l2_u" ["U_b"] "rms over 10 stations of 200 points of u - finite elements";
    L2_V = "l2_v" ["U_b"] "the same of v";
    FORCE_ERROR = "force_error" ["-"] "force/finite elements - 1";
    SEPARATION_ERROR = "separation_error" ["H"] "separation - finite elements";
    REATTACHMENT_ERROR = "reattachment_error" ["H"] "reattachment - finite elements";
    OUTSIDE = "outside" ["-"] "particles behind the walls at the end";
    WALL_OFFSET = "wall_offset" ["dx"]
        "largest distance of the first row of wall particles from its place";
    HILL_SHEAR_DRAG = "hill_shear_drag" ["rho U_b^2 H"]
        "integral over a period of the shear on the hill";
    LID_SHEAR_DRAG = "lid_shear_drag" ["rho U_b^2 H"]
        "integral over a period of the shear on the lid";
    HILL_PRESSURE_DRAG = "hill_pressure_drag" ["rho U_b^2 H"]
        "integral over a period of the pressure times slope of the hill";
}

/// Metrics of the field at stations and walls.
const OF_FIELD: &[MetricKey] = &[
    SECTION_FLUX,
    DRAG_BALANCE,
    SEPARATION,
    REATTACHMENT,
    L2_U,
    L2_V,
    FORCE_ERROR,
    SEPARATION_ERROR,
    REATTACHMENT_ERROR,
    HILL_SHEAR_DRAG,
    LID_SHEAR_DRAG,
    HILL_PRESSURE_DRAG,
];

/// Metrics that compare with the reference.
const COMPARED: [MetricKey; 5] = [L2_U, L2_V, FORCE_ERROR, SEPARATION_ERROR, REATTACHMENT_ERROR];

/// The body force and the flux that it drives.
#[derive(Clone, Serialize, Deserialize)]
pub struct Drive {
    /// Body force \[m/s²\].
    pub force: Result<f64, Absent>,
    /// Flux of volume \[m²/s\].
    pub flux: Result<f64, Absent>,
}

/// Sums over samples of the last part of the run.
#[derive(Default, Serialize, Deserialize)]
pub struct Window {
    /// Velocities at the points of the stations.
    sections: Vec<Vector2<f64>>,
    /// Stresses along the walls.
    wall: Vec<WallSample>,
    /// One for each stretch.
    pub drives: Vec<Drive>,
    samples: usize,
    /// Why there are no samples of the field.
    absent: Option<Absent>,
}

/// Stresses on the walls at a place along them.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct WallSample {
    /// Along the tangent of the hill.
    hill_shear: f64,
    lid_shear: f64,
    /// On the hill.
    pressure: f64,
}

impl AddAssign for WallSample {
    fn add_assign(&mut self, other: Self) {
        self.hill_shear += other.hill_shear;
        self.lid_shear += other.lid_shear;
        self.pressure += other.pressure;
    }
}

impl Div<f64> for WallSample {
    type Output = Self;

    fn div(self, by: f64) -> Self {
        let Self { hill_shear, lid_shear, pressure } = self;
        Self { hill_shear: hill_shear / by, lid_shear: lid_shear / by, pressure: pressure / by }
    }
}

/// The points of the stations.
fn places(setup: &HillSetup) -> Vec<Vector2<f64>> {
    let lid = setup.hill.lid();
    let at = |x: f64| {
        let floor = setup.floor(x);
        let y = move |k: usize| floor + (lid - floor) * (k as f64 + 0.5) / POINTS as f64;
        (0..POINTS).map(move |k| Vector2::new(x, y(k)))
    };
    STATIONS.into_iter().flat_map(at).collect()
}

/// Place along the wall.
fn along(k: usize) -> f64 {
    9.0 * k as f64 / (WALL - 1) as f64
}

fn add<T: AddAssign>(sums: &mut Vec<T>, values: impl Iterator<Item = T>) {
    for (k, value) in values.enumerate() {
        match sums.get_mut(k) {
            Some(sum) => *sum += value,
            None => sums.push(value),
        }
    }
}

impl Window {
    /// Adds a sample.
    pub fn sample(&mut self, setup: &HillSetup, now: &Snapshot) {
        let eos = setup.flow.medium.eos;
        let point = |c: &touchstone_solver::particles::SweptParticle| FieldPoint {
            position: c.position,
            volume: c.common.volume,
            velocity: c.velocity,
            pressure: eos.pressure(c.common.density) - eos.background,
        };
        let added = now.sums(|s| {
            let points = s.plain_columns().iter().map(point).collect();
            self.add(setup, points, &|r2| s.weight(r2));
        });
        self.absent = added.err().or(self.absent.take());
    }

    /// Adds a sample of these particles, with the weight of a squared distance.
    fn add(&mut self, setup: &HillSetup, points: Vec<FieldPoint>, weight: &dyn Fn(f64) -> f64) {
        let field = FittedField::new((weight, setup.flow.support), points, setup.hill.lid());
        let sections = places(setup).into_iter().map(|place| field.at(place).0);
        add(&mut self.sections, sections);
        self.samples += 1;
        add(&mut self.wall, (0..WALL).map(|k| wall(setup, &field, along(k))));
    }

    fn mean<T: Copy + Div<f64, Output = T>>(&self, sums: &[T]) -> Vec<T> {
        sums.iter().map(|sum| *sum / self.samples as f64).collect()
    }
}

/// The stresses at x.
fn wall(setup: &HillSetup, field: &FittedField, x: f64) -> WallSample {
    let (x, nu, lid) = (x.rem_euclid(setup.hill.period()), setup.flow.medium.nu, setup.hill.lid());
    let (floor, slope) = (setup.floor(x), setup.slope(x));
    let length = hypot(1.0, slope);
    let tangent = Vector2::new(1.0, slope) / length;
    let (foot, above) = (Vector2::new(x, floor), |at: Vector2<f64>| at.y - setup.floor(at.x));
    let hill = field.slope_at(foot, above, tangent) * length;
    let top = field.slope_at(Vector2::new(x, lid), |at| lid - at.y, Vector2::x());
    WallSample { hill_shear: nu * hill, lid_shear: nu * top, pressure: field.at(foot).1 }
}

/// Mean velocity along x over the fluid's area \[m/s\].
///
/// # Errors
/// Without densities.
pub fn mean_velocity(now: &Snapshot, area: f64) -> Result<f64, Absent> {
    let density = now.density()?;
    let flow = now.stored().map(|p| p.mass / density.of(&p) * p.velocity.x);
    Ok(flow.sum::<f64>() / area)
}

/// Metrics and profiles.
pub fn measure(setup: &HillSetup, window: &Window, area: f64, record: &mut Record) {
    let (sections, wall) = (window.mean(&window.sections), window.mean(&window.wall));
    let mean = |of: fn(&Drive) -> &Result<f64, Absent>| {
        let all: Vec<f64> =
            window.drives.iter().map(|drive| of(drive).clone()).collect::<Result<_, _>>()?;
        Ok::<f64, Absent>(all.iter().sum::<f64>() / all.len() as f64)
    };
    let (force, flux) = (mean(|drive| &drive.force), mean(|drive| &drive.flux));
    record.put_or_absent(FORCE, force.clone());
    let relative = |value: f64| (setup.flux() != 0.0).then_some(value);
    let none = "the flux wanted is 0, so no error relative to it exists";
    let flux =
        flux.and_then(|flux| relative(flux / setup.flux() - 1.0).ok_or(Absent::because(none)));
    record.put_or_absent(FLUX, flux);
    if let Some(absent) = &window.absent {
        return record.leave_all_out(OF_FIELD, absent);
    }
    record.put_or(SECTION_FLUX, relative(section_flux(setup, &sections)), none);
    let drags = drags(setup, &wall);
    drags.iter().for_each(|(part, drag)| record.put(*part, *drag));
    let drag: f64 = drags.iter().map(|(_, drag)| drag).sum();
    let balance = force.and_then(|force| {
        let none = || Absent::because("no body force has acted yet");
        (force != 0.0).then(|| drag / (force * area) - 1.0).ok_or_else(none)
    });
    record.put_or_absent(DRAG_BALANCE, balance);
    let [separation, reattachment] = bubble(&wall);
    let none = "no stretch of the hill has backward flow";
    record.put_or(SEPARATION, separation, none);
    record.put_or(REATTACHMENT, reattachment, none);
    compare(setup, &sections, record);
    let places = places(setup);
    record.put_column(columns::X, &places, |place| place.x);
    record.put_column(columns::Y, &places, |place| place.y);
    record.put_column(columns::U, &sections, |velocity| velocity.x);
    record.put_column(columns::V, &sections, |velocity| velocity.y);
    record.put_column(columns::ALONG, &(0..WALL).collect::<Vec<_>>(), |k| along(*k));
    record.put_column(columns::HILL_SHEAR, &wall, |at| at.hill_shear);
    record.put_column(columns::LID_SHEAR, &wall, |at| at.lid_shear);
    record.put_column(columns::PRESSURE, &wall, |at| at.pressure);
}

/// The largest error of the flux through a station, relative to the flux wanted; sections are the mean
/// velocities at the points of the stations.
fn section_flux(setup: &HillSetup, sections: &[Vector2<f64>]) -> f64 {
    let through = |k: usize| {
        let u = &sections[k * POINTS..(k + 1) * POINTS];
        let gap = setup.hill.lid() - setup.floor(STATIONS[k]);
        u.iter().map(|u| u.x).sum::<f64>() / POINTS as f64 * gap
    };
    largest((0..STATIONS.len()).map(|k| (through(k) / setup.flux() - 1.0).abs()))
}

/// Parts of the drag, by the trapezoidal rule over the period, whose ends are one point.
fn drags(setup: &HillSetup, wall: &[WallSample]) -> [(MetricKey, f64); 3] {
    let over = |f: &dyn Fn(usize) -> f64| (0..WALL - 1).map(f).sum::<f64>() * along(1);
    [
        (HILL_SHEAR_DRAG, over(&|k| wall[k].hill_shear)),
        (LID_SHEAR_DRAG, over(&|k| wall[k].lid_shear)),
        (HILL_PRESSURE_DRAG, over(&|k| wall[k].pressure * setup.slope(along(k)))),
    ]
}

/// Where the longest stretch of backward flow on the hill starts and where it ends, of at least three places.
/// One that reaches to the last crest does not count, and one that starts at the first has no start.
fn bubble(wall: &[WallSample]) -> [Option<f64>; 2] {
    let shear: Vec<f64> = wall.iter().map(|at| at.hill_shear).collect();
    let zero = |after: usize| {
        let before = after.checked_sub(1)?;
        let (a, b) = (shear[before], shear[after]);
        Some(along(before) + along(1) * a / (a - b))
    };
    let backward = longest_negative(&shear, 3);
    backward.map_or([None; 2], |stretch| [zero(stretch.start), zero(stretch.end)])
}

/// Distances from the reference.
fn compare(setup: &HillSetup, sections: &[Vector2<f64>], record: &mut Record) {
    let Some(reference) = setup.reference else {
        let reason = format!("no reference exists for these settings, only for {KNOWN_SETTINGS}");
        return record.leave_all_out(&COMPARED, &Absent::because(reason));
    };
    let exact = || reference.stations.iter().flat_map(|s| &s.v);
    record.put(L2_U, rms(sections.iter().zip(exact()).map(|(f, e)| f.x - e.x)));
    record.put(L2_V, rms(sections.iter().zip(exact()).map(|(f, e)| f.y - e.y)));
    let gap = |metric: MetricKey| Some(record.value(metric)? - reference.number(metric)?);
    let force = gap(FORCE).zip(reference.number(FORCE)).map(|(gap, exact)| gap / exact);
    let (separation, reattachment) = (gap(SEPARATION), gap(REATTACHMENT));
    let none = "the run or the reference has no backward flow";
    record.put_or(FORCE_ERROR, force, none);
    record.put_or(SEPARATION_ERROR, separation, none);
    record.put_or(REATTACHMENT_ERROR, reattachment, none);
}

/// Displacement of wall particles from their places \[dx\]: over the points along floor and lid, the largest
/// difference between the depth of the nearest particle and the depth of the first row.
fn wall_offset(setup: &HillSetup, all: &[Point]) -> f64 {
    let (dx, lid, period) = (setup.flow.medium.dx, setup.hill.lid(), setup.hill.period());
    let walls = || all.iter().filter(|p| !p.is_fluid()).map(|p| p.position);
    let distance = |from: Vector2<f64>, to: &Vector2<f64>| {
        let across = (to.x - from.x).abs().rem_euclid(period);
        hypot(across.min(period - across), to.y - from.y)
    };
    let off = |place: Vector2<f64>, depth: &dyn Fn(Vector2<f64>) -> f64| {
        let nearest =
            walls().min_by(|a, b| distance(place, a).total_cmp(&distance(place, b))).map(depth);
        (nearest.unwrap_or(f64::INFINITY) / dx - setup.first).abs()
    };
    let off_at = |x: f64| {
        let below = off(Vector2::new(x, setup.floor(x)), &|p| behind_floor(setup, p));
        below.max(off(Vector2::new(x, lid), &|p| p.y - lid))
    };
    (0..WALL).map(|k| off_at(along(k))).fold(0.0, f64::max)
}

/// Distance from the floor \[m\], positive behind it, by Gauss and Newton's iteration for its foot.
fn behind_floor(setup: &HillSetup, place: Vector2<f64>) -> f64 {
    let mut x = place.x;
    for _ in 0..20 {
        let slope = setup.slope(x);
        x += (place.x - x + (place.y - setup.floor(x)) * slope) / (1.0 + slope * slope);
    }
    let (slope, foot) = (setup.slope(x), Vector2::new(x, setup.floor(x)));
    Vector2::new(slope, -1.0).normalize().dot(&(place - foot))
}

/// Where the particles are at the end, walls and fluid.
pub fn particles(setup: &HillSetup, end: &Snapshot, is_kept: bool, record: &mut Record) {
    let all = end.all();
    record.put(WALL_OFFSET, wall_offset(setup, &all));
    let period = setup.hill.period();
    let place =
        |p: &Point| (Vector2::new(p.position.x.rem_euclid(period), p.position.y), p.velocity.x);
    let fluid: Vec<_> = all.iter().filter(|p| p.is_fluid()).map(place).collect();
    let is_outside = |x: &Vector2<f64>| !(setup.floor(x.x)..=setup.hill.lid()).contains(&x.y);
    record.put(OUTSIDE, fluid.iter().filter(|(x, _)| is_outside(x)).count() as f64);
    if is_kept {
        pictures::keep(record, pictures::END, "H", ("u", "U_b"), fluid.into_iter());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_harness::problem::Problem;
    use touchstone_maths::geometry::Hill;
    use touchstone_solver::Role;

    use crate::fluids::periodic_hill::{HillSettings, run::FLUX as BULK};
    use std::f64::consts::TAU;
    use touchstone_base::functions::{cos, sin};

    /// The scene of some settings, its kernel, and the viscosity 1/50.
    fn scene(
        set: fn(&mut HillSettings),
    ) -> (HillSetup, Box<dyn touchstone_schemes::hill::Driving>) {
        let mut settings = HillSettings::default();
        set(&mut settings);
        let method = touchstone_schemes::hill::carried();
        let setup = HillSetup::new(&method, &settings).expect("sound settings");
        let simulation = (method.build)(setup.scene().expect("a scene")).expect("a scene");
        (setup, simulation)
    }

    /// Backward flow between these places, where the floor is flat \[H\].
    const BUBBLE: [f64; 2] = [2.5, 6.0];
    /// Amplitude of the pressure \[ρ U_b²\].
    const PRESSURE: f64 = -0.3;

    /// Shape of the flow: u = Q/D (6 s (1 - s) - A s (1 - s)(1 - 2 s)) at the share s of a section of height
    /// D carries the flux Q through every section. Its slope du/ds at the floor is 6 - A, at the lid
    /// -6 - A.
    fn shape(x: f64) -> f64 {
        let [middle, half] =
            [BUBBLE[0] + BUBBLE[1], BUBBLE[1] - BUBBLE[0]].map(|twice| 0.5 * twice);
        6.0 + 4.0 * (cos(TAU * (x - middle) / 9.0) - cos(TAU * half / 9.0))
    }

    /// u, v and p: v so that the flow follows the floor.
    fn made_up(setup: &HillSetup, x: f64, y: f64) -> [f64; 3] {
        let gap = setup.hill.lid() - setup.floor(x);
        let s = (y - setup.floor(x)) / gap;
        let u = setup.flux() / gap * s * (1.0 - s) * (6.0 - shape(x) * (1.0 - 2.0 * s));
        [u, u * setup.slope(x) * (1.0 - s), PRESSURE * sin(TAU * x / 9.0)]
    }

    /// Shear stress on hill and lid of that flow.
    fn shear(setup: &HillSetup, x: f64) -> [f64; 2] {
        let gap = setup.hill.lid() - setup.floor(x);
        let scale = setup.flow.medium.nu * setup.flux() / gap.powi(2);
        [scale * (6.0 - shape(x)) * (1.0 + setup.slope(x).powi(2)), scale * (6.0 + shape(x))]
    }

    /// The record of windows that hold the made-up flow, with this force and this flux.
    fn measured(force: f64, flux: f64) -> (HillSetup, f64, Record) {
        let (setup, simulation) = scene(|s| s.n = 40);
        let mut points = Vec::new();
        for particle in simulation.particles() {
            // With the images behind the ends of the period, as a simulation has them.
            for x in [-9.0, 0.0, 9.0].map(|by| particle.position.x + by) {
                let (y, volume) = (particle.position.y, particle.mass / particle.density);
                let [u, v, pressure] = made_up(&setup, x, y);
                let (position, velocity) = (Vector2::new(x, y), Vector2::new(u, v));
                points.push(FieldPoint { position, volume, velocity, pressure });
            }
        }
        let mut window = Window::default();
        window.add(&setup, points, &|r2| simulation.weight(r2));
        for ripple in [-1e-3, 1e-3] {
            let (force, flux) = (Ok(force * (1.0 + ripple)), Ok(flux * (1.0 + 2.0 * ripple)));
            window.drives.push(Drive { force, flux });
        }
        let area = setup.area();
        let mut record = Record::new("periodic_hill", "carried", serde_json::Value::Null, 1);
        measure(&setup, &window, area, &mut record);
        (setup, area, record)
    }

    fn assert_near(record: &Record, metric: MetricKey, exact: f64, tolerance: f64) {
        let found = record.value(metric).expect("measured");
        let name = String::from(metric);
        assert!((found - exact).abs() < tolerance, "{name}: {found} is not {exact}");
    }

    /// Errors of 1 to 20 % in the fields of the hills must change the metrics.
    #[test]
    fn a_made_up_flow_is_measured_as_it_was_made() {
        let (setup, area, record) = measured(0.04, 2.0);
        assert_near(&record, SEPARATION, BUBBLE[0], 0.003);
        assert_near(&record, REATTACHMENT, BUBBLE[1], 0.003);
        assert_near(&record, SECTION_FLUX, 0.0, 2e-3);
        assert_near(&record, FORCE, 0.04, 1e-12);
        assert_near(&record, FLUX, 2.0 / BULK - 1.0, 1e-12);
        // Integrals over the period by a rule and a floor of the test's own.
        let hill = Hill::new(1.0).expect("the reference's");
        let count = 3600;
        let integral = |f: &dyn Fn(f64) -> f64| {
            let at = |k: i32| f(9.0 * (f64::from(k) + 0.5) / f64::from(count));
            (0..count).map(at).sum::<f64>() * 9.0 / f64::from(count)
        };
        let slope = |x: f64| (hill.wall(x + 1e-4) - hill.wall(x - 1e-4)) / 2e-4;
        let drags = [
            (HILL_SHEAR_DRAG, integral(&|x| shear(&setup, x)[0])),
            (LID_SHEAR_DRAG, integral(&|x| shear(&setup, x)[1])),
            (HILL_PRESSURE_DRAG, integral(&|x| PRESSURE * sin(TAU * x / 9.0) * slope(x))),
        ];
        for (metric, drag) in drags {
            assert_near(&record, metric, drag, 0.003 * drag.abs());
        }
        assert!((area / integral(&|x| hill.lid() - hill.wall(x)) - 1.0).abs() < 1e-4);
        let balance = drags.iter().map(|(_, drag)| drag).sum::<f64>() / (0.04 * area) - 1.0;
        assert_near(&record, DRAG_BALANCE, balance, 0.003);
        // Profiles are where they say they are.
        let [x, y, u, v] =
            [columns::X, columns::Y, columns::U, columns::V].map(|key| record.column(key));
        let off = |k: usize| {
            let [exact_u, exact_v, _] = made_up(&setup, x[k], y[k]);
            (u[k] - exact_u).abs().max((v[k] - exact_v).abs())
        };
        let off = (0..x.len()).map(off).fold(0.0, f64::max);
        assert!(off < 2.5e-3, "{off}");
        let [x, hill, lid] =
            [columns::ALONG, columns::HILL_SHEAR, columns::LID_SHEAR].map(|key| record.column(key));
        assert_eq!((x.len(), x[40], x[360]), (WALL, 1.0, 9.0));
        let worst = |column: &[f64], wall: usize| {
            let off = |k: usize| (column[k] - shear(&setup, x[k])[wall]).abs();
            (0..WALL).map(off).fold(0.0, f64::max)
        };
        let largest = (0..WALL).map(|k| shear(&setup, x[k])[0].abs()).fold(0.0, f64::max);
        assert!(worst(hill, 0) < 0.01 * largest && worst(lid, 1) < 0.003 * largest);
    }

    #[test]
    fn errors_that_are_put_in_are_measured() {
        let (setup, _) = scene(|_| {});
        let reference = setup.reference.expect("Re 50 has one");
        let mut record = Record::new("periodic_hill", "carried", serde_json::Value::Null, 1);
        let number = |metric: MetricKey| reference.number(metric).expect("in the summary");
        record.put(FORCE, 1.02 * number(FORCE));
        record.put(SEPARATION, number(SEPARATION) - 0.03);
        record.put(REATTACHMENT, number(REATTACHMENT) + 0.04);
        let exact = reference.stations.iter().flat_map(|station| &station.v);
        let sections: Vec<_> = exact.map(|v| v + Vector2::new(0.01, -0.02)).collect();
        let heights = reference.stations.iter().flat_map(|station| &station.y);
        assert!(places(&setup).iter().zip(heights).all(|(p, y)| (p.y - y).abs() < 1e-4));
        compare(&setup, &sections, &mut record);
        for (metric, exact) in [
            (L2_U, 0.01),
            (L2_V, 0.02),
            (FORCE_ERROR, 0.02),
            (SEPARATION_ERROR, -0.03),
            (REATTACHMENT_ERROR, 0.04),
        ] {
            assert_near(&record, metric, exact, 1e-9);
        }
    }

    /// Re 30, half the crest and half the flux were compared with a flow of other settings.
    #[test]
    fn what_has_no_reference_is_left_out_with_the_reason() {
        let others: [fn(&mut HillSettings); 3] =
            [|s| s.re = 30.0, |s| s.crest = 0.5, |s| s.flux = 0.5];
        for set in others {
            let (setup, _) = scene(set);
            let mut record = Record::new("periodic_hill", "carried", serde_json::Value::Null, 1);
            compare(&setup, &[], &mut record);
            assert!(record.metrics.is_empty());
            assert!(
                COMPARED
                    .iter()
                    .all(|m| record.absent[&String::from(*m)].to_string().contains("re = 10"))
            );
        }
    }

    #[test]
    fn the_mean_velocity_is_that_of_the_volumes() {
        let (setup, _) = scene(|_| {});
        let mut parts = setup.scene().expect("a scene");
        for p in parts.particles.iter_mut().filter(|p| p.role == Role::Fluid) {
            p.velocity.x = 0.7 + 0.1 * (p.position.y - 1.0);
        }
        let now = Snapshot::of(0.0, &parts.particles);
        let hill = Hill::new(1.0).expect("the reference's");
        let count = 900;
        let of_column = |k: i32| {
            let floor = hill.wall(9.0 * (f64::from(k) + 0.5) / f64::from(count));
            let (gap, middle) = (hill.lid() - floor, 0.5 * (hill.lid() + floor));
            gap * (0.7 + 0.1 * (middle - 1.0)) * 9.0 / f64::from(count)
        };
        let exact = (0..count).map(of_column).sum::<f64>() / setup.area();
        let found = mean_velocity(&now, setup.area()).expect("densities");
        assert!((found / exact - 1.0).abs() < 2e-3, "{found} {exact}");
    }

    #[test]
    fn a_hill_that_is_too_high_and_a_particle_behind_a_wall_are_seen() {
        let seen = |setup: &HillSetup, particles: &[touchstone_solver::Particle]| {
            let mut record = Record::new("periodic_hill", "carried", serde_json::Value::Null, 1);
            super::particles(setup, &Snapshot::of(0.0, particles), false, &mut record);
            [WALL_OFFSET, OUTSIDE].map(|metric| record.value(metric).expect("measured"))
        };
        let (setup, simulation) = scene(|_| {});
        let [offset, outside] = seen(&setup, &simulation.particles());
        assert!(offset < 0.02 && outside == 0.0);
        // The crest 2 % of H too high, a fifth of a spacing.
        let [offset, _] = seen(&setup, &scene(|s| s.crest = 1.02).1.particles());
        assert!((offset - 0.2).abs() < 0.02, "{offset}");
        let mut parts = setup.scene().expect("a scene");
        let fluid = parts.particles.iter_mut().filter(|p| p.role == Role::Fluid);
        for (p, y) in fluid.step_by(7).zip([setup.hill.lid() + 0.01, setup.hill.lid() - 0.01]) {
            p.position.y = y;
        }
        assert_eq!(seen(&setup, &parts.particles)[1], 1.0);
    }
}
