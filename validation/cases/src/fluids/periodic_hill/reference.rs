//! The finite-element flow of this Reynolds number, and its field between the stations.

use std::sync::LazyLock;

use nalgebra::Vector2;
use touchstone_base::{
    record::MetricKey,
    reference::{Reference, ReferenceError, Uncertain},
};
use touchstone_maths::{
    geometry::Hill,
    metrics::{curve::Points, norms::rms},
};

use super::HillSettings;

/// Reynolds numbers that have a reference.
pub const REYNOLDS: [f64; 3] = [10.0, 50.0, 100.0];
/// The settings that have a reference, in words.
pub const KNOWN_SETTINGS: &str = "re = 10, 50 or 100, crest = 1 and flux = 1";

/// Read and checked once: 25 000 rows, which every run, every plan and every figure asks for.
static KNOWN: LazyLock<Result<Vec<HillReference>, ReferenceError>> =
    LazyLock::new(|| REYNOLDS.into_iter().map(HillReference::read).collect());

/// A profile across one section.
#[derive(Clone, Debug)]
pub struct Station {
    /// Place \[H\].
    pub x: f64,
    /// Heights \[H\], ascending.
    pub y: Vec<f64>,
    /// Velocity \[U_b\] at each.
    pub v: Vec<Vector2<f64>>,
}

/// Results of finite elements at one Reynolds number.
#[derive(Clone, Debug)]
pub struct HillReference {
    /// Profiles, in the order of x.
    pub stations: Vec<Station>,
    /// More of them, to start from: not to compare with.
    starts: Vec<Station>,
    /// Shear stress on the hill \[ρ U_b²\] over x \[H\].
    pub hill_shear: Points,
    re: f64,
    /// Root mean square of the uncertainty of u over all points of the profiles \[U_b\].
    pub uncertainty: f64,
}

impl HillReference {
    /// The reference of these settings; `None` where nothing was computed for their geometry, their flux or
    /// their Reynolds number.
    pub fn of(settings: &HillSettings) -> Result<Option<&'static Self>, ReferenceError> {
        let known = KNOWN.as_ref().map_err(Clone::clone)?;
        let place = REYNOLDS.iter().position(|re| *re == settings.re);
        let is_known = (settings.crest, settings.flux) == (1.0, 1.0);
        Ok(place.filter(|_| is_known).map(|place| &known[place]))
    }

    /// The content of the package for a Reynolds number.
    fn read(re: f64) -> Result<Self, ReferenceError> {
        let (package, text) = (Reference::load("periodic_hill")?, re.to_string());
        let of = [("re", &*text)];
        let hill_shear = package.table("wall")?.select(&of, ["x", "hill_shear"])?.into_iter();
        let profiles = package.table("profiles")?;
        let uncertainty = profiles.select(&of, ["u_uncertainty"])?;
        let profiles = profiles.select(&of, ["x", "y", "u", "v"])?;
        let hill = Hill::new(1.0)?;
        let height = |x: f64, s: f64| hill.wall(x) * (1.0 - s) + hill.lid() * s;
        let starts = package.table("starts")?.select(&of, ["x", "s", "u", "v"])?.into_iter();
        let starts: Vec<_> = starts.map(|[x, s, u, v]| [x, height(x, s), u, v]).collect();
        Ok(Self {
            stations: stations(&profiles),
            starts: stations(&starts),
            hill_shear: hill_shear.map(|[x, shear]| (x, shear)).collect(),
            re,
            uncertainty: rms(uncertainty.into_iter().map(|[u]| u)),
        })
    }

    /// The number in the summary for a metric.
    pub fn number(&self, metric: MetricKey) -> Option<f64> {
        Some(summary(self.re, &String::from(metric)).value).filter(|value| value.is_finite())
    }

    /// The velocity at x, at the share s of a section `gap` \[H\] high: a start that is near the flow, within
    /// 0.04 % of U_b rms, and not the flow. u·gap, whose mean over s is the flux, and v are cubic in x
    /// through the two nearest profiles on each side, linear in s between points, and 0 on the walls.
    pub fn velocity(&self, x: f64, s: f64, gap: f64) -> Vector2<f64> {
        let (count, period) = (self.starts.len(), 9.0);
        let next = self.starts.iter().position(|station| station.x > x).unwrap_or(0);
        let near = [count - 2, count - 1, 0, 1].map(|k| &self.starts[(next + k) % count]);
        let ahead = near.map(|station| {
            let distance = station.x - x;
            distance - period * (distance / period).round()
        });
        let weight = |k: usize| -> f64 {
            (0..4).filter(|&j| j != k).map(|j| ahead[j] / (ahead[j] - ahead[k])).product()
        };
        let at = |station: &Station| {
            let points = station.v.len();
            let k = s * points as f64 - 0.5;
            let low = (k.max(0.0) as usize).min(points - 2);
            let t = (k - low as f64).clamp(0.0, 1.0);
            let from_wall = (2.0 * points as f64 * s.min(1.0 - s)).clamp(0.0, 1.0);
            let v = (station.v[low] * (1.0 - t) + station.v[low + 1] * t) * from_wall;
            Vector2::new(v.x * station.gap() / gap, v.y)
        };
        near.iter().enumerate().map(|(k, station)| at(station) * weight(k)).sum()
    }
}

/// The line between bubble and stream at a Reynolds number \[H\]; empty where the flow does not separate.
pub fn bubble(re: f64) -> Vec<(f64, f64)> {
    Reference::curve("periodic_hill", "line", ["x", "y"], &[("re", &re.to_string())])
}

/// Rows of x, y, u, v as stations.
fn stations(rows: &[[f64; 4]]) -> Vec<Station> {
    let station = |rows: &[[f64; 4]]| Station {
        x: rows[0][0],
        y: rows.iter().map(|row| row[1]).collect(),
        v: rows.iter().map(|row| Vector2::new(row[2], row[3])).collect(),
    };
    rows.chunk_by(|a, b| a[0] == b[0]).map(station).collect()
}

/// The reference at this Reynolds number. A reference that cannot be read makes every run fail, so its error
/// is not repeated here.
pub fn reference(re: f64) -> Option<&'static HillReference> {
    HillReference::of(&HillSettings { re, ..HillSettings::default() }).ok().flatten()
}

/// A quantity of the summary at this Reynolds number; NaN if it has none.
pub fn summary(re: f64, quantity: &str) -> Uncertain {
    Reference::summarised("periodic_hill", &[("re", &re.to_string()), ("quantity", quantity)])
}

/// The floor as a line.
pub fn floor() -> Vec<(f64, f64)> {
    let Ok(hill) = Hill::new(1.0) else { return Vec::new() };
    (0..=360).map(|k| 0.025 * f64::from(k)).map(|x| (x, hill.wall(x))).collect()
}

impl Station {
    /// Height of the section \[H\]: the points are the middles of equal parts.
    fn gap(&self) -> f64 {
        let last = self.y.len() - 1;
        (self.y[last] - self.y[0]) * (1.0 + 1.0 / last as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::super::measure::SEPARATION;
    use super::*;

    /// A curve that could not be read is empty, too.
    #[test]
    fn there_is_a_line_of_separation_where_the_flow_separates() {
        let counts = REYNOLDS.map(|re| bubble(re).len());
        assert!(counts[0] == 0 && counts[1..].iter().all(|count| *count > 20), "{counts:?}");
    }

    /// rms distance between the start and the values at these stations \[U_b\].
    fn distance(reference: &HillReference, stations: &[Station]) -> f64 {
        let squares: Vec<f64> = stations
            .iter()
            .flat_map(|station| {
                let count = station.v.len() as f64;
                let start = move |k: usize| {
                    reference.velocity(station.x, (k as f64 + 0.5) / count, station.gap())
                };
                station.v.iter().enumerate().map(move |(k, v)| (start(k) - v).norm_squared())
            })
            .collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    }

    #[test]
    fn three_reynolds_numbers_have_a_reference_and_others_have_none() {
        let at = |re| HillReference::of(&HillSettings { re, ..HillSettings::default() });
        for re in [10.0, 50.0, 100.0] {
            let reference = at(re).expect("sound").expect("computed");
            assert_eq!((reference.stations.len(), reference.hill_shear.len()), (10, 361));
            assert!(reference.stations.iter().all(|s| s.y.len() == 200));
            assert_eq!(reference.number(SEPARATION).is_some(), re > 10.0);
            // The start: its own stations unchanged, and the finer profiles as far as it contains them.
            assert_eq!(reference.starts.len(), 29);
            assert!(reference.starts.iter().all(|s| s.y.len() == 100));
            let on_them = distance(reference, &reference.starts);
            assert!(on_them < 1e-15, "{on_them:e} at Re {re}");
            let off = distance(reference, &reference.stations);
            assert!(off < 5e-4, "{off:e} at Re {re}");
            // The flux does not depend on x, whatever the gap there.
            for x in [0.0, 0.3, 1.7, 5.5, 8.7] {
                let u = (0..200).map(|k| reference.velocity(x, (k as f64 + 0.5) / 200.0, 2.6).x);
                let flux = u.sum::<f64>() / 200.0 * 2.6;
                assert!((flux / 2.035 - 1.0).abs() < 4e-4, "{flux} at {x}");
            }
            for station in &reference.stations {
                let dy = station.y[1] - station.y[0];
                let flux = station.v.iter().map(|v| v.x * dy).sum::<f64>();
                assert!((flux / 2.035 - 1.0).abs() < 2e-4, "{flux} at {}", station.x);
            }
        }
        assert!(at(30.0).expect("sound").is_none());
    }
}
