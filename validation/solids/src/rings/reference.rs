//! The finite-element run of one ring against a frictionless plane, and the distance from it.

use super::{
    RingSettings,
    measure::Series,
    metrics::{self, COMPARED, IMPULSE_ERROR, RMS},
};
use base::{
    record::{MetricKey, Record},
    reference::{Reference as Package, ReferenceError, Table},
};

/// The law whose numbers are compared: logarithmic strain and p = K (ρ/⁰ρ − 1), the fair partner of
/// (11) and (12).
const LAW: &str = "hencky";

/// The rows of a table that are of this speed.
fn rows(table: &Table, speed: f64) -> Result<Vec<usize>, ReferenceError> {
    let (speeds, laws) = (table.numbers("speed")?, table.texts("law")?);
    Ok((0..table.len()).filter(|&k| speeds[k] == speed && laws[k] == LAW).collect())
}

/// The values of a column at this speed, with their uncertainties.
fn column(table: &Table, name: &str, speed: f64) -> Result<Vec<(f64, f64)>, ReferenceError> {
    let (values, spread) = (table.numbers(name)?, table.numbers(&format!("{name}_uncertainty"))?);
    Ok(rows(table, speed)?.into_iter().map(|k| (values[k], spread[k])).collect())
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
        let rows = rows(table, speed)?;
        if rows.is_empty() {
            return Ok(None);
        }
        let (names, values) = (table.texts("quantity")?, table.numbers("value")?);
        let spread = table.numbers("uncertainty")?;
        let summary = rows.iter().map(|&k| (names[k].to_string(), values[k], spread[k])).collect();
        let series = package.table("series")?;
        let columns = Self::COLUMNS.map(|name| column(series, name, speed));
        let columns = columns.into_iter().collect::<Result<_, _>>()?;
        let t = series.numbers("t")?;
        let times = self::rows(series, speed)?.into_iter().map(|k| t[k]).collect();
        let phases = package.table("phases")?;
        let [impulse, early, half, late] = ["impulse", "impulse_1", "impulse_50", "impulse_99"]
            .map(|of| column(phases, of, speed));
        let (impulse, early, half, late) = (impulse?, early?, half?, late?);
        let phase = |k: usize| [impulse[k], early[k], half[k], late[k]];
        let phases = (0..impulse.len()).map(phase).collect();
        Ok(Some(Self { summary, phases, times, columns }))
    }

    /// A number of the summary with its uncertainty.
    pub fn number(&self, quantity: MetricKey) -> Option<(f64, f64)> {
        let quantity = String::from(quantity);
        let found = self.summary.iter().find(|(name, ..)| *name == quantity)?;
        Some((found.1, found.2))
    }

    /// Adds the distances from the reference to the metrics of a run that has been measured.
    pub fn compare(&self, series: &Series, record: &mut Record) {
        for (quantity, error) in COMPARED {
            let (exact, found) = (self.number(quantity), record.value(quantity));
            if let Some(((exact, _), found)) = exact.zip(found) {
                record.put(error, (found / exact - 1.0).abs());
            }
        }
        for (k, (exact, found)) in self.phases.iter().zip(series.phases()).enumerate() {
            let error = (found.impulse / exact[0].0 - 1.0).abs();
            record.put(IMPULSE_ERROR.at(metrics::phase(k)), error);
        }
        for (k, rms) in RMS.into_iter().enumerate() {
            record.put(rms, self.distance(k, series));
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
        let (restitution, spread) = paper.number(metrics::RESTITUTION).expect("measured");
        assert!((restitution - 0.7956).abs() < 1e-3 && spread < 0.01);
        assert!(at(0.03).is_some() && at(0.12).is_none());
        assert!((paper.phases[0][0].0 - 1.19383).abs() < 1e-4 && paper.phases.len() == 2);
        let start = paper.columns.iter().map(|c| c[0].0).collect::<Vec<f64>>();
        assert_eq!(start, [5.0, -0.059, 8.0, 8.0]);
        let softer = RingSettings { shear_modulus: 0.2, ..RingSettings::default() };
        assert!(Reference::of(&softer).is_none());
    }
}
