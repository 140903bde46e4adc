//! Finite elements of the plate, and the distance from them.

use ::lagrangian::{Hencky, Law as _};
use base::{
    record::{MetricKey, Record},
    reference::{Reference as Package, ReferenceError},
    spec::RunSpec,
};

use super::{AMPLITUDE_RATIO, LAGRANGIAN, PERIOD, PlateSettings, settings_of};
use crate::solid::{Path, Quantities, lagrangian};

base::metrics! {
    PERIOD_ERROR = "period_error" ["-"] "period over that of finite elements of this law, less 1";
    AMPLITUDE_ERROR = "amplitude_error" ["-"]
        "amplitude_ratio over that of the same place of finite elements, less 1";
    PATH_RMS = "path_rms" ["-"]
        "root of the mean square of the distance of the tip from that of finite elements, through their \
         first three periods, over their first extreme";
    BENDING_PERIOD_ERROR = "bending_period_error" ["-"]
        "period over that of finite elements, times the root of the bending stiffness that a plate of so \
         many layers has in the method by theory, less 1";
}

/// Layers of the plates whose last column of particles the tables have.
const LAYERS: [usize; 3] = [5, 10, 20];

/// The law that a variant solves, as the tables name it: that of the paper is (10) to (12).
fn law(variant: &str) -> &'static str {
    if variant == LAGRANGIAN { Hencky::NAME } else { "jaumann" }
}

/// Why a run has no distance from finite elements.
const NOT_COMPUTED: &str = "finite elements have plates of 0.2 m and 0.02 m, 2 MPa, Poisson's ratio 0.3975, \
                            1000 kg/m^3, 0.01 c0, and the last column of 5, 10 and 20 layers";

/// Finite elements of the last column of particles.
struct Reference {
    quantities: Quantities,
    path: Path,
}

impl Reference {
    /// That of a variant with these settings; `None` where nothing was computed for them.
    fn of(variant: &str, settings: &PlateSettings) -> Option<Self> {
        let (s, default) = (settings, PlateSettings::default());
        let plate = |s: &PlateSettings| (s.length, s.thickness, s.young, s.poisson, s.rho, s.speed);
        let is_same = plate(s) == plate(&default) && LAYERS.contains(&s.n);
        is_same.then(|| Self::at(law(variant), s.n).ok()).flatten()
    }

    fn at(law: &str, layers: usize) -> Result<Self, ReferenceError> {
        let package = Package::load("oscillating_plate")?;
        let (of_law, n) = (("law", law), layers.to_string());
        let quantities = Quantities::of(package.table("summary")?, &[of_law, ("layers", &n)])?;
        let columns = [format!("x_{n}"), format!("y_{n}")];
        let [x, y] = &columns;
        let mut path = Path::of(package.table("series")?, [x, y], &[of_law])?;
        let end = quantities.get("passage_6").map_or(0.0, |[time, _]| time);
        path.0.retain(|row| row[0] <= end);
        Ok(Self { quantities, path })
    }

    fn number(&self, name: &str) -> f64 {
        self.quantities.get(name).map_or(f64::NAN, |[value, _]| value)
    }
}

/// The path that a run is compared with; empty if there is none.
pub fn path(spec: &RunSpec) -> Vec<[f64; 3]> {
    Reference::of(&spec.variant, &settings_of(spec)).map_or(Vec::new(), |known| known.path.0)
}

/// Puts the distances of a run that has been measured.
pub fn compare(settings: &PlateSettings, path: &Path, record: &mut Record) {
    let Some(exact) = Reference::of(&record.variant, settings) else {
        for metric in [PERIOD_ERROR, AMPLITUDE_ERROR, PATH_RMS, BENDING_PERIOD_ERROR] {
            record.leave_out(metric, NOT_COMPUTED);
        }
        return;
    };
    for (quantity, error) in [(PERIOD, PERIOD_ERROR), (AMPLITUDE_RATIO, AMPLITUDE_ERROR)] {
        match record.value(quantity) {
            Some(found) => record.put(error, found / exact.number(&String::from(quantity)) - 1.0),
            None => record.leave_out(error, "the tip does not pass its height of rest again"),
        }
    }
    let last = |path: &Path| path.0.last().map_or(0.0, |row| row[0]);
    if last(path) >= last(&exact.path) {
        record.put(PATH_RMS, path.distance(&exact.path) / exact.number("extreme_1"));
    } else {
        record.leave_out(PATH_RMS, "the run ends before three periods of finite elements");
    }
    let by_theory: MetricKey = BENDING_PERIOD_ERROR;
    match record.value(PERIOD_ERROR) {
        Some(error) if record.variant == LAGRANGIAN => {
            let stiffness = lagrangian::bending(settings.n, settings.poisson);
            record.put(by_theory, (1.0 + error) * stiffness.sqrt() - 1.0);
        }
        _ => record.leave_out(by_theory, "there is no period, or no theory of its layers"),
    }
}
