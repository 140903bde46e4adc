//! The finite-element run of one ring against a frictionless plane, and the distance from it.

use std::sync::OnceLock;

use ::lagrangian::{Hencky, Law as _};

use super::{
    LAGRANGIAN, RingSettings,
    measure::{Phase, Series},
    metrics::{
        COMPARED, CONTACT_BEGIN_ERROR, CONTACT_END_ERROR, IMPULSE_ERROR, RMS, X_C_END_ERROR,
        X_C_WORST, phase,
    },
};
use base::{
    record::{MetricKey, Record},
    reference::{Reference as Package, ReferenceError, Table},
};

/// The law of (10) to (12), as the tables name it.
const JAUMANN: &str = "jaumann";

/// The law that a variant solves, as the tables name it.
fn law(variant: &str) -> &'static str {
    if variant == LAGRANGIAN { Hencky::NAME } else { JAUMANN }
}

/// Read and checked once: every run and every figure asks for it.
static PACKAGE: OnceLock<Package> = OnceLock::new();

fn package() -> Result<&'static Package, ReferenceError> {
    if let Some(package) = PACKAGE.get() {
        return Ok(package);
    }
    let package = Package::load("rubber_rings")?;
    Ok(PACKAGE.get_or_init(|| package))
}

/// Which rows of a table are looked for: of a law, at a speed.
type Of = (&'static str, f64);

fn rows(table: &Table, (law, speed): Of) -> Result<Vec<usize>, ReferenceError> {
    let (speeds, laws) = (table.numbers("speed")?, table.texts("law")?);
    Ok((0..table.len()).filter(|&k| speeds[k] == speed && laws[k] == law).collect())
}

/// The values of a column with their uncertainties.
fn column(table: &Table, name: &str, of: Of) -> Result<Vec<(f64, f64)>, ReferenceError> {
    let (values, spread) = (table.numbers(name)?, table.numbers(&format!("{name}_uncertainty"))?);
    Ok(rows(table, of)?.into_iter().map(|k| (values[k], spread[k])).collect())
}

/// Largest principal logarithmic strain on the finest mesh.
fn largest_strain(checks: &Table, (law, speed): Of) -> Result<f64, ReferenceError> {
    let (names, laws) = (checks.texts("check")?, checks.texts("law")?);
    let (speeds, values) = (checks.optional("speed")?, checks.numbers("value")?);
    let is_it = |k: &usize| {
        let is_strain = names[*k] == "greatest principal logarithmic strain";
        is_strain && laws[*k] == law && speeds[*k] == Some(speed)
    };
    // Coarse meshes come first.
    Ok((0..checks.len()).rev().find(is_it).map_or(f64::NAN, |k| values[k]))
}

/// What finite elements say of one speed.
#[derive(Clone, Debug)]
pub struct Reference {
    /// (name, value, uncertainty).
    summary: Vec<(String, f64, f64)>,
    /// Phases of contact: impulse \[ρ c₀ L²\] and times of [`super::measure::SHARES`] of it, with
    /// their uncertainties.
    pub phases: Vec<[(f64, f64); 4]>,
    /// Times \[L/c0\] and, at each, the columns of [`Reference::COLUMNS`] with their uncertainties.
    pub times: Vec<f64>,
    /// One list a column.
    pub columns: Vec<Vec<(f64, f64)>>,
    /// Least distance of the ring from the plane at these times \[L\].
    gap: Vec<f64>,
    /// Largest principal logarithmic strain at any time and place \[-\].
    pub strain: f64,
}

/// The faces of the right ring at a time of the table \[L\]; empty at any other.
pub fn outlines(speed: f64, time: f64) -> Result<Vec<Vec<(f64, f64)>>, ReferenceError> {
    let package = package()?;
    let table = package.table("outlines")?;
    let (t, faces) = (table.numbers("t")?, table.texts("face")?);
    let (x, y) = (table.numbers("x")?, table.numbers("y")?);
    let rows = rows(table, (JAUMANN, speed))?;
    let face = |name: &str| {
        let of_face = rows.iter().filter(|&&k| (t[k] - time).abs() < 1e-9 && faces[k] == name);
        let half: Vec<(f64, f64)> = of_face.map(|&k| (x[k], y[k])).collect();
        let mirrored = half.iter().rev().map(|(x, y)| (*x, -y));
        half.iter().copied().chain(mirrored).collect::<Vec<_>>()
    };
    let faces = ["outer", "inner"].map(face).into_iter();
    Ok(faces.filter(|line| !line.is_empty()).collect())
}

/// Why a run has no distance from finite elements.
const NOT_COMPUTED: &str =
    "finite elements have rings of 3 and 4 L, 0.22 K, at 0.059 and 0.03 c0, to 200 L/c0";

/// Names the metrics that need a reference as absent.
pub fn leave_out(record: &mut Record) {
    let errors = COMPARED.map(|(_, error)| error);
    for metric in errors.into_iter().chain(RMS).chain([X_C_WORST, X_C_END_ERROR]) {
        record.leave_out(metric, NOT_COMPUTED);
    }
}

impl Reference {
    /// Columns of the series: centre of mass, its velocity, extents.
    pub const COLUMNS: [&'static str; 4] = ["x_c", "v_c", "width", "height"];

    /// The reference of a variant with these settings; `None` where nothing was computed for them.
    pub fn of(variant: &str, settings: &RingSettings) -> Option<Self> {
        let s = settings;
        let default = RingSettings::default();
        let same_rings = (s.inner, s.outer, s.centre)
            == (default.inner, default.outer, default.centre)
            && s.shear_modulus == default.shear_modulus
            && s.end == default.end;
        if same_rings { Self::at((law(variant), s.speed)).ok().flatten() } else { None }
    }

    fn at(of: Of) -> Result<Option<Self>, ReferenceError> {
        let package = package()?;
        let table = package.table("summary")?;
        let rows = rows(table, of)?;
        if rows.is_empty() {
            return Ok(None);
        }
        let (names, values) = (table.texts("quantity")?, table.numbers("value")?);
        let spread = table.numbers("uncertainty")?;
        let summary = rows.iter().map(|&k| (names[k].to_string(), values[k], spread[k])).collect();
        let series = package.table("series")?;
        let columns = Self::COLUMNS.map(|name| column(series, name, of));
        let columns = columns.into_iter().collect::<Result<_, _>>()?;
        let t = series.numbers("t")?;
        let times = self::rows(series, of)?.into_iter().map(|k| t[k]).collect();
        let phases = package.table("phases")?;
        let [impulse, early, half, late] = ["impulse", "impulse_1", "impulse_50", "impulse_99"]
            .map(|name| column(phases, name, of));
        let (impulse, early, half, late) = (impulse?, early?, half?, late?);
        let phase = |k: usize| [impulse[k], early[k], half[k], late[k]];
        let phases = (0..impulse.len()).map(phase).collect();
        let gap = column(series, "gap", of)?.into_iter().map(|(gap, _)| gap).collect();
        let strain = largest_strain(package.table("checks")?, of)?;
        Ok(Some(Self { summary, phases, times, columns, gap, strain }))
    }

    /// A number of the summary with its uncertainty.
    pub fn number(&self, quantity: MetricKey) -> Option<(f64, f64)> {
        let quantity = String::from(quantity);
        let found = self.summary.iter().find(|(name, ..)| *name == quantity)?;
        Some((found.1, found.2))
    }

    /// When the ring of finite elements comes within this distance \[L\] of the plane before phase `k`, and
    /// when it is farther away again \[L/c₀\]. Where it never is farther between two phases, the time when it
    /// is farthest.
    pub fn within(&self, reach: f64, k: usize) -> [f64; 2] {
        let start = |k: usize| self.phases.get(k).map_or(f64::INFINITY, |phase| phase[1].0);
        let end = |k: usize| self.phases.get(k).map_or(f64::INFINITY, |phase| phase[3].0);
        let gaps = |from: f64, to: f64| {
            let all = self.times.iter().copied().zip(self.gap.iter().copied());
            all.filter(move |(t, _)| from < *t && *t < to)
        };
        let before = if k == 0 { f64::NEG_INFINITY } else { end(k - 1) };
        let farthest = |from, to| gaps(from, to).max_by(|a, b| a.1.total_cmp(&b.1));
        let time = |found: Option<(f64, f64)>| found.map_or(f64::NAN, |(t, _)| t);
        let far = |(_, gap): &(f64, f64)| *gap > reach;
        let comes = gaps(before, start(k)).rfind(far);
        let leaves = gaps(end(k), start(k + 1)).find(far);
        [
            time(comes.or_else(|| farthest(before, start(k)))),
            time(leaves.or_else(|| farthest(end(k), start(k + 1)))),
        ]
    }

    /// Adds the distances from the reference to the metrics of a run that has been measured.
    pub fn compare(&self, series: &Series, record: &mut Record) {
        for (quantity, error) in COMPARED {
            let (exact, found) = (self.number(quantity), record.value(quantity));
            match exact.zip(found) {
                Some(((exact, _), found)) => record.put(error, found / exact - 1.0),
                None => record.leave_out(error, "the run has no number to compare"),
            }
        }
        self.compare_phases(&series.phases(), record);
        for (k, rms) in RMS.into_iter().enumerate() {
            let distances = self.distances(k, series);
            let squares = distances.iter().fold(0.0, |sum, distance| sum + distance * distance);
            record.put(rms, (squares / distances.len() as f64).sqrt());
        }
        let path = self.distances(0, series);
        let worst = path.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        record.put(X_C_WORST, worst.unwrap_or(f64::NAN));
        record.put(X_C_END_ERROR, path.last().copied().unwrap_or(f64::NAN));
    }

    /// Begin, end and impulse of each phase. Of a run that has not as many phases, only the first begin and
    /// the last end have a partner.
    fn compare_phases(&self, found: &[Phase], record: &mut Record) {
        let is_same = found.len() == self.phases.len();
        let last = self.phases.len().saturating_sub(1);
        for (k, [(impulse, _), (begin, _), _, (end, _)]) in self.phases.iter().enumerate() {
            let [first, partner] =
                [found.first(), if k == last { found.last() } else { found.get(k) }];
            let mut put = |metric: MetricKey, found: Option<f64>| match found {
                Some(error) => record.put(metric.at(phase(k)), error),
                None => record.leave_out(metric.at(phase(k)), UNLIKE),
            };
            let of = |has_partner: bool| partner.filter(|found| has_partner && found.is_over);
            let beginning = if k == 0 { first } else { of(is_same) };
            put(CONTACT_BEGIN_ERROR, beginning.map(|found| found.times[0] - begin));
            put(CONTACT_END_ERROR, of(is_same || k == last).map(|found| found.times[2] - end));
            put(IMPULSE_ERROR, of(is_same).map(|found| found.impulse / impulse - 1.0));
        }
    }

    /// Less finite elements, at each of their times that the samples enclose.
    fn distances(&self, column: usize, series: &Series) -> Vec<f64> {
        let found = series.points(1 + column);
        let between = |(t, (exact, _)): (&f64, &(f64, f64))| {
            let k = found.iter().position(|(time, _)| time >= t)?.max(1);
            let [(t0, y0), (t1, y1)] = [found[k - 1], found[k]];
            Some(y0 + (y1 - y0) * ((t - t0) / (t1 - t0)) - exact)
        };
        self.times.iter().zip(&self.columns[column]).filter_map(between).collect()
    }
}

/// Why a phase is not compared.
const UNLIKE: &str =
    "the rings have another number of phases than finite elements, or still touch at the end";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rings::metrics::RESTITUTION;

    #[test]
    fn outlines_have_the_extents_of_the_series() {
        let paper = Reference::of("seed", &RingSettings::default()).expect("the paper's speed");
        for time in [32.0, 60.0, 80.0, 120.0, 200.0] {
            let lines = outlines(0.059, time).expect("a table");
            assert_eq!(lines.len(), 2);
            let at = paper.times.iter().position(|t| *t == time).expect("a time of the series");
            let extent = |of: fn(&(f64, f64)) -> f64| {
                let all = || lines[0].iter().map(of);
                all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
            };
            let (width, height) = (paper.columns[2][at].0, paper.columns[3][at].0);
            let (found_width, found_height) = (extent(|p| p.0), extent(|p| p.1));
            // Every fourth node of the face is there.
            assert!((found_width - width).abs() < 0.02, "{found_width} for {width} at {time}");
            assert!((found_height - height).abs() < 0.02, "{found_height} for {height} at {time}");
        }
        assert!(outlines(0.059, 33.0).expect("a table").is_empty());
        assert!(outlines(0.12, 32.0).expect("a table").is_empty());
    }

    #[test]
    fn two_speeds_have_a_reference_and_others_have_none() {
        let at = |speed| Reference::of("seed", &RingSettings { speed, ..RingSettings::default() });
        let paper = at(0.059).expect("the paper's speed");
        let (restitution, spread) = paper.number(RESTITUTION).expect("measured");
        assert!((restitution - 0.8004).abs() < 1e-3 && spread < 0.01);
        assert!(at(0.03).is_some() && at(0.12).is_none());
        assert!((paper.phases[0][0].0 - 1.19129).abs() < 1e-4 && paper.phases.len() == 2);
        let start = paper.columns.iter().map(|c| c[0].0).collect::<Vec<f64>>();
        assert_eq!(start, [5.0, -0.059, 8.0, 8.0]);
        let other = Reference::of(LAGRANGIAN, &RingSettings::default()).expect("its law");
        assert_eq!(other.number(RESTITUTION).map(|(value, _)| value), Some(0.795617));
        let softer = RingSettings { shear_modulus: 0.2, ..RingSettings::default() };
        assert!(Reference::of("seed", &softer).is_none());
    }
}
