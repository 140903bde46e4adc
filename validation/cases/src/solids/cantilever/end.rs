//! Observations of a bar: the path of its end, its energies, its middle line when the end is lowest.

use super::{
    AVERAGE_Y_ERROR, BENDING_FREQUENCY_ERROR, BENDING_SAG_ERROR, COMPARED, CantileverSettings,
    ENERGY_CHANGE, FREQUENCY_ERROR, OF_METHODS, PATH_RMS, Watch, elements,
};
use crate::solids::solid::{self, ElasticBody, ElasticEnergy, Path, lagrangian};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{absent::Absent, record::MetricKey};
use touchstone_harness::prelude::*;
use touchstone_harness::snapshot::{Point, Snapshot, kinetic};
use touchstone_maths::metrics::history::passes;
use touchstone_solver::Symmetric;

/// Times and displacements of the end.
pub const COLUMNS: [ColumnKey; 3] = [
    ColumnKey::new("end", "t", "s"),
    ColumnKey::new("end", "x", "m"),
    ColumnKey::new("end", "y", "m"),
];

touchstone_base::metrics! {
    all OF_PATH;
    MEAN_X = "mean_x" ["m"]
        "half the sum of the greatest and the least displacement of the end along the bar";
    MEAN_Y = "mean_y" ["m"] "the same upwards";
    AMPLITUDE_X = "amplitude_x" ["m"] "half the difference of the two along the bar";
    AMPLITUDE_Y = "amplitude_y" ["m"] "the same upwards";
    FREQUENCY = "frequency" ["Hz"]
        "whole periods between the first and the last time at which the end falls through mean_y, over the \
         time between them";
    AVERAGE_X = "average_x" ["m"] "mean displacement along the bar between these two times";
    AVERAGE_Y = "average_y" ["m"] "the same upwards";
    HARMONIC_X = "harmonic_x" ["m"]
        "amplitude of the sinusoid of that frequency in the displacement along the bar between these times";
    HARMONIC_Y = "harmonic_y" ["m"] "the same upwards";
    FIRST_LEAST_Y = "first_least_y" ["m"] "least displacement upwards in the first swing";
}

/// The quantities of [`COMPARED`](super::COMPARED), in this order; averages, harmonics and the frequency need
/// two falls, and the least height of the first swing needs to be passed.
fn measure(path: &Path) -> Vec<(MetricKey, Option<f64>)> {
    let [[mean_x, amplitude_x], [mean_y, amplitude_y]] =
        [0, 1].map(|axis| path.mean_and_amplitude(axis));
    let falls = |(time, falls)| if falls { Some(time) } else { None };
    let times: Vec<f64> = passes(path.heights(), mean_y).filter_map(falls).collect();
    let second = times.get(1).copied().unwrap_or(f64::INFINITY);
    let swing = Path(path.0[..path.0.partition_point(|at| at.time < second)].to_vec());
    let periods = if let [first, .., last] = times[..] {
        let frequency = (times.len() - 1) as f64 / (last - first);
        let (average, harmonic) = path.harmonic([first, last], frequency);
        [frequency, average.x, average.y, harmonic.x, harmonic.y].map(Some)
    } else {
        [None; 5]
    };
    let all = [mean_x, mean_y, amplitude_x, amplitude_y].map(Some);
    let [_, first_least_y] = swing.extremes(1);
    let values = all.into_iter().chain(periods).chain([first_least_y]);
    COMPARED.into_iter().map(|(metric, _)| metric).zip(values).collect()
}

/// Samples of a run: every 0.0025 s of 4 s, as finite elements have them.
const SAMPLES: f64 = 1600.0;
/// Samples per sample of the energy.
const ENERGY_EVERY: usize = 10;
/// Fewer points of a path, such as another code's, do not determine its metrics.
pub const LEAST_POINTS: usize = 400;

/// The motion of the end.
#[derive(Serialize, Deserialize)]
pub struct End {
    /// When it is sampled next \[s\].
    pub until: f64,
    /// The path of the end.
    pub path: Path,
    /// The energies of every tenth sample.
    pub energies: Vec<EnergySample>,
}

/// Energies at a time.
#[derive(Serialize, Deserialize)]
pub struct EnergySample {
    /// \[s\].
    time: f64,
    /// \[J/m\].
    kinetic: f64,
    /// Change of the total energy since the start \[J/m\].
    change: Result<f64, Absent>,
}

impl End {
    fn sample(&mut self, s: &CantileverSettings, now: &Snapshot<Symmetric>) {
        let (all, columns) = (now.all(), s.columns());
        let middle = |column: usize| {
            let rows = (0..s.n).map(|row| all[row * columns + column].position);
            rows.fold(Vector2::zeros(), |sum, x| sum + x) / s.n as f64
        };
        // The line through the last two columns, continued by half a spacing: the end has no curvature.
        let end = 1.5 * middle(columns - 1) - 0.5 * middle(columns - 2);
        self.path.push(now.time(), end - Vector2::new(s.length, 0.0));
        if self.path.0.len().is_multiple_of(ENERGY_EVERY) {
            self.energies.push(EnergySample::of(s, now));
        }
    }
}

impl EnergySample {
    /// At the start, when nothing has moved.
    pub fn start() -> Self {
        Self { time: 0.0, kinetic: 0.0, change: Ok(0.0) }
    }

    /// The energy of the weight is 0 at the start, because the bar is along y = 0.
    fn of(s: &CantileverSettings, now: &Snapshot<Symmetric>) -> Self {
        let time = now.time();
        if let Some(known) = ElasticEnergy::known(now) {
            return Self { time, kinetic: known.kinetic, change: Ok(known.total()) };
        }
        let of_points = ElasticEnergy::of_points(now.stored(), now, &s.material());
        let change = of_points.map(|mut found| {
            let height = |p: Point| p.mass * p.position.y;
            let height = now.stored().map(height).fold(0.0, |sum, one| sum + one);
            found.compression += s.gravity * height;
            found.total()
        });
        Self { time, kinetic: kinetic(now.stored()), change }
    }
}

impl Watch<CantileverSettings> for End {
    fn after_step(&mut self, s: &CantileverSettings, now: &Snapshot<Symmetric>) {
        if now.time() >= self.until {
            self.until = now.time() + s.end / SAMPLES;
            self.sample(s, now);
        }
    }

    fn measure(mut self, s: &CantileverSettings, end: &Snapshot<Symmetric>, record: &mut Record) {
        self.energies.push(EnergySample::of(s, end));
        let most =
            |most: f64, of: f64| if of.abs() > most.abs() || of.is_nan() { of } else { most };
        let kinetic = self.energies.iter().map(|of| of.kinetic).fold(0.0, most);
        let changes = self.energies.iter().map(|of| of.change.clone());
        let changes = changes.collect::<Result<Vec<f64>, Absent>>();
        let change = changes.map(|all| all.into_iter().fold(0.0, most) / kinetic);
        record.put_or_absent(ENERGY_CHANGE, change);
        let energy = |name, unit| ColumnKey::new("energy", name, unit);
        record.put_column(energy("t", "s"), &self.energies, |of| of.time);
        record.put_column(energy("kinetic", "J/m"), &self.energies, |of| of.kinetic);
        record.put_known_column(energy("change", "J/m"), &self.energies, |of| of.change.clone());
        let path = self.path;
        path.put(COLUMNS, record);
        if path.0.len() < LEAST_POINTS {
            let why = Absent::NotGiven(format!("{LEAST_POINTS} times, for the path of the end"));
            let all = COMPARED.into_iter().flat_map(|(metric, error)| [metric, error]);
            let all = all.chain([PATH_RMS]).chain(OF_METHODS.iter().copied());
            all.for_each(|metric| record.leave_out(metric, why.clone()));
            return;
        }
        for (metric, value) in measure(&path) {
            record.put_or(metric, value, "the run is too short for it");
        }
        let exact = elements(&record.run.variant, s);
        // All but the first swing was measured over 4 s.
        let is_whole = s.end == CantileverSettings::default().end;
        let (whole, first) = COMPARED.split_at(if is_whole { 0 } else { COMPARED.len() - 1 });
        let lacks = "the run is too short, or finite elements have no such bar: they have 0.35 m and 0.02 m, \
                     1.4 MPa, Poisson's ratio 0.4, 1000 kg/m^3, under 2 and 0.2 m/s^2 for 4 s";
        whole.iter().for_each(|(_, error)| record.leave_out(*error, Absent::because(lacks)));
        let of_path = (PATH_RMS, "harmonic_y");
        solid::compare(exact.as_ref(), first, of_path, (&path, lacks), record);
        compare_with_theory(s, record);
    }
}

/// Puts the distances of a total Lagrangian bar from one that bends as finite elements would with the
/// stiffness that the method has by theory.
fn compare_with_theory(settings: &CantileverSettings, record: &mut Record) {
    let [frequency, sag] = [FREQUENCY_ERROR, AVERAGE_Y_ERROR].map(|error| record.value(error));
    let is_known = record.run.variant != "seed";
    let Some((frequency, sag)) = frequency.zip(sag).filter(|_| is_known) else {
        let lacks = if is_known { "no distance from finite elements" } else { "no theory" };
        return record.leave_all_out(OF_METHODS, &Absent::because(format!("there is {lacks}")));
    };
    let stiffness = lagrangian::bending(settings.n, settings.solid.poisson);
    record.put(BENDING_FREQUENCY_ERROR, (1.0 + frequency) / stiffness.sqrt() - 1.0);
    record.put(BENDING_SAG_ERROR, (1.0 + sag) * stiffness - 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::TAU;
    use touchstone_base::functions::{cos, sin};
    use touchstone_harness::method::Parts;
    use touchstone_maths::metrics::path::PathPoint;

    /// −0.06 (1 − cos 2πft), with a second harmonic along the bar.
    fn swing(frequency: f64, end: f64) -> Path {
        let row = |k: i32| {
            let t = 0.0025 * f64::from(k);
            let angle = TAU * frequency * t;
            let x = -0.01 + 0.01 * cos(angle) + 0.002 * sin(2.0 * angle);
            PathPoint::new(t, Vector2::new(x, -0.06 * (1.0 - cos(angle))))
        };
        Path((0..).map(row).take_while(|at| at.time <= end).collect())
    }

    #[test]
    fn a_path_that_was_made_up_has_its_frequency_mean_and_amplitude() {
        let found = measure(&swing(1.1, 4.0));
        let value = |key: MetricKey| {
            let name = String::from(key);
            let one = found.iter().find(|(other, _)| String::from(*other) == name);
            one.and_then(|(_, value)| *value).expect("measured")
        };
        assert_relative_eq!(value(FREQUENCY), 1.1, max_relative = 1e-6);
        assert_relative_eq!(value(AVERAGE_Y), -0.06, max_relative = 1e-4);
        assert_relative_eq!(value(HARMONIC_Y), 0.06, max_relative = 1e-4);
        assert_relative_eq!(value(AVERAGE_X), -0.01, max_relative = 1e-3);
        assert_relative_eq!(value(HARMONIC_X), 0.01, max_relative = 1e-3);
        assert_relative_eq!(value(MEAN_Y), -0.06, max_relative = 1e-5);
        assert_relative_eq!(value(AMPLITUDE_Y), 0.06, max_relative = 1e-5);
        assert_relative_eq!(value(FIRST_LEAST_Y), -0.12, max_relative = 1e-5);
    }

    /// A run of half a second ends in the first swing, one of 0.3 s before its least height.
    #[test]
    fn a_short_path_has_no_frequency_and_a_shorter_one_no_least_height() {
        let has = |end: f64, key: MetricKey| {
            let found = measure(&swing(1.1, end));
            found.iter().any(|(other, value)| *other == key && value.is_some())
        };
        assert!(has(0.5, FIRST_LEAST_Y) && !has(0.5, FREQUENCY) && !has(0.5, AVERAGE_Y));
        assert!(!has(0.3, FIRST_LEAST_Y) && has(0.3, MEAN_Y));
    }

    /// The frequency goes with the root of the stiffness, the sag with its inverse.
    #[test]
    fn a_bar_of_the_stiffness_of_theory_has_no_distance_from_theory() {
        let s = CantileverSettings { n: 5, ..CantileverSettings::default() };
        let stiffness = lagrangian::bending(5, s.solid.poisson);
        assert!((stiffness - 1.0).abs() > 1e-3, "5 layers have the stiffness of a bar");
        for (more, frequency, sag) in [(1.0, 0.0, 0.0), (1.21, 0.1, -0.21 / 1.21)] {
            let mut record =
                Record::new("cantilever", lagrangian::LAGRANGIAN, serde_json::json!({}), 1);
            record.put(FREQUENCY_ERROR, (more * stiffness).sqrt() - 1.0);
            record.put(AVERAGE_Y_ERROR, 1.0 / (more * stiffness) - 1.0);
            compare_with_theory(&s, &mut record);
            let value = |metric| record.value(metric).expect("a metric");
            assert_relative_eq!(value(BENDING_FREQUENCY_ERROR), frequency, epsilon = 1e-12);
            assert_relative_eq!(value(BENDING_SAG_ERROR), sag, epsilon = 1e-12);
        }
    }

    /// Stretched and turned: the end is where the line through the last columns ends.
    #[test]
    fn the_end_is_half_a_spacing_beyond_the_last_column() {
        let s = CantileverSettings { n: 4, ..CantileverSettings::default() };
        let method = touchstone_schemes::total::hencky();
        let (medium, domain) = (solid::medium(&s, &method.properties), Domain::open());
        let parts = Parts::new(medium, domain, s.particles());
        let mut simulation =
            (method.build)(Parts { mirrors: vec![solid::clamp()], ..parts }).expect("a scene");
        let place = |x: Vector2<f64>| Vector2::new(0.01 * x.x + 0.3 * x.y, -0.2 * x.x);
        lagrangian::displace(&mut *simulation, place);
        let mut end = End { until: 0.0, path: Path::start(), energies: Vec::new() };
        end.sample(&s, &Snapshot::ours(&*simulation));
        let found = end.path.0[1].displacement;
        assert_relative_eq!(found.x, 0.01 * 0.35, max_relative = 1e-9);
        assert_relative_eq!(found.y, -0.2 * 0.35, max_relative = 1e-9);
    }
}
