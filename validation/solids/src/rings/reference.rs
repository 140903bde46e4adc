//! The finite-element run of one ring against a frictionless plane, and the distance from it.

use super::{RingSettings, measure::Series};
use base::{
    record::{Metric, Record},
    reference::{Reference as Package, ReferenceError},
};

/// The law whose numbers are compared: logarithmic strain and p = K (ρ/⁰ρ − 1), the fair partner of
/// (11) and (12).
const LAW: &str = "hencky";

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
}

impl Reference {
    /// Columns of the series: centre of mass, its velocity, extents.
    pub const COLUMNS: [&'static str; 4] = ["x_c", "v_c", "width", "height"];

    /// The reference of these settings; `None` where nothing was computed for them.
    pub fn of(settings: &RingSettings) -> Option<Self> {
        let s = settings;
        let default = RingSettings::default();
        let same_rings = (s.inner, s.outer, s.centre)
            == (default.inner, default.outer, default.centre)
            && s.shear_modulus == default.shear_modulus;
        if same_rings { Self::at(s.speed).ok().flatten() } else { None }
    }

    fn at(speed: f64) -> Result<Option<Self>, ReferenceError> {
        let package = Package::load("rubber_rings")?;
        let table = package.table("summary")?;
        let (speeds, laws) = (table.numbers("speed")?, table.texts("law")?);
        let (names, values) = (table.texts("quantity")?, table.numbers("value")?);
        let spread = table.numbers("uncertainty")?;
        let of_run = |k: &usize| speeds[*k] == speed && laws[*k] == LAW;
        let summary: Vec<_> = (0..speeds.len())
            .filter(of_run)
            .map(|k| (names[k].to_string(), values[k], spread[k]))
            .collect();
        if summary.is_empty() {
            return Ok(None);
        }
        let series = package.table("series")?;
        let (speeds, laws, t) =
            (series.numbers("speed")?, series.texts("law")?, series.numbers("t")?);
        let rows: Vec<usize> =
            (0..t.len()).filter(|&k| speeds[k] == speed && laws[k] == LAW).collect();
        let mut columns = Vec::new();
        for name in Self::COLUMNS {
            let values = series.numbers(name)?;
            let spread = series.numbers(&format!("{name}_uncertainty"))?;
            columns.push(rows.iter().map(|&k| (values[k], spread[k])).collect());
        }
        let times = rows.iter().map(|&k| t[k]).collect();
        let phases = Self::phases_at(&package, speed)?;
        Ok(Some(Self { summary, phases, times, columns }))
    }

    fn phases_at(package: &Package, speed: f64) -> Result<Vec<[(f64, f64); 4]>, ReferenceError> {
        let table = package.table("phases")?;
        let (speeds, laws) = (table.numbers("speed")?, table.texts("law")?);
        let mut columns = Vec::new();
        for name in ["impulse", "impulse_1", "impulse_50", "impulse_99"] {
            columns.push((table.numbers(name)?, table.numbers(&format!("{name}_uncertainty"))?));
        }
        let of_run = |k: &usize| speeds[*k] == speed && laws[*k] == LAW;
        let row = |k: usize| [0, 1, 2, 3].map(|c: usize| (columns[c].0[k], columns[c].1[k]));
        Ok((0..speeds.len()).filter(of_run).map(row).collect())
    }

    /// A number of the summary with its uncertainty.
    pub fn number(&self, name: &str) -> Option<(f64, f64)> {
        self.summary.iter().find(|(n, ..)| n == name).map(|(_, value, spread)| (*value, *spread))
    }

    /// Adds the distances from the reference to the metrics of a run.
    pub fn compare(&self, series: &Series, record: &mut Record) {
        let mut put = |name: String, value: f64, unit: &str, formula: String| {
            record.metrics.insert(name, Metric::new(value, unit, &formula));
        };
        for name in ["restitution", "width_min", "height_max", "x_c_min"] {
            let (Some((exact, _)), Some(found)) = (self.number(name), series.metric(name)) else {
                continue;
            };
            let formula = format!("|{name} - finite elements|/finite elements");
            put(format!("{name}_error"), (found / exact - 1.0).abs(), "-", formula);
        }
        for (k, (exact, found)) in self.phases.iter().zip(series.phases()).enumerate() {
            let name = format!("impulse_error@phase{}", k + 1);
            let formula = "|impulse of the phase - finite elements|/finite elements".to_string();
            put(name, (found.impulse / exact[0].0 - 1.0).abs(), "-", formula);
        }
        for (k, name) in Self::COLUMNS.iter().enumerate() {
            let unit = if *name == "v_c" { "c0" } else { "L" };
            let formula = format!("rms over the run of {name} - finite elements");
            put(format!("{name}_rms"), self.distance(k, series), unit, formula);
        }
    }

    /// Root mean square of the distance over the common times.
    fn distance(&self, column: usize, series: &Series) -> f64 {
        let found = series.points(1 + column);
        let (mut sum, mut count) = (0.0, 0.0);
        for (t, (exact, _)) in self.times.iter().zip(&self.columns[column]) {
            let Some(k) = found.iter().position(|(time, _)| time >= t) else { continue };
            let (a, b) = (found[k.max(1) - 1], found[k.max(1)]);
            let value = a.1 + (b.1 - a.1) * ((t - a.0) / (b.0 - a.0));
            sum += (value - exact).powi(2);
            count += 1.0;
        }
        (sum / count).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_speeds_have_a_reference_and_others_have_none() {
        let at = |speed| Reference::of(&RingSettings { speed, ..RingSettings::default() });
        let paper = at(0.059).expect("the paper's speed");
        let (restitution, spread) = paper.number("restitution").expect("measured");
        assert!((restitution - 0.7956).abs() < 1e-3 && spread < 0.01);
        assert!(at(0.03).is_some() && at(0.12).is_none());
        assert!((paper.phases[0][0].0 - 1.19383).abs() < 1e-4 && paper.phases.len() == 2);
        let start = paper.columns.iter().map(|c| c[0].0).collect::<Vec<f64>>();
        assert_eq!(start, [5.0, -0.059, 8.0, 8.0]);
        let softer = RingSettings { shear_modulus: 0.2, ..RingSettings::default() };
        assert!(Reference::of(&softer).is_none());
    }
}
