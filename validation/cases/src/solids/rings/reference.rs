//! The finite-element run of one ring against a frictionless plane, and the distance from it.

use touchstone_base::{
    absent::Absent,
    record::{MetricKey, Record},
    reference::{Reference, Uncertain},
};
use touchstone_maths::metrics::{contact::ContactPhase, curve::Points, history, norms::rms};
use touchstone_solver::lagrangian::{Hencky, Law as _};

use super::{
    RingSettings,
    columns::{HEIGHT, PLACE, TIME, VELOCITY, WIDTH},
    metrics::{
        COMPARED, CONTACT_BEGIN_ERROR, CONTACT_END_ERROR, HEIGHT_RMS, HISTORIES, IMPULSE_ERROR,
        OF_HISTORIES, RMS, WIDTH_RMS, X_C_RMS, X_C_WORST, phase,
    },
};
use crate::solids::solid::{LAGRANGIAN, Quantities, largest, quantities};

const PACKAGE: &str = "rubber_rings";
/// The law of (10) to (12), as the tables name it.
const JAUMANN: &str = "jaumann";

/// A phase of contact.
#[derive(Clone, Debug)]
pub struct Phase {
    /// \[ρ c₀ L²\].
    pub impulse: f64,
    /// When 1 % of the impulse has passed \[L/c0\].
    pub begin: f64,
    /// When 99 % of the impulse have passed \[L/c0\].
    pub end: f64,
}

/// Results of finite elements for one law and speed.
#[derive(Clone, Debug)]
pub struct RingReference {
    quantities: Quantities,
    /// Phases of contact.
    pub phases: Vec<Phase>,
    /// The uncertainty of the end of the last phase \[L/c0\].
    pub doubt: f64,
    /// [`PLACE`] over t \[L/c0\].
    pub place: Points,
    /// [`VELOCITY`] over t \[L/c0\].
    pub velocity: Points,
    /// [`WIDTH`] over t \[L/c0\].
    pub width: Points,
    /// [`HEIGHT`] over t \[L/c0\].
    pub height: Points,
    /// The uncertainty of [`HISTORIES`], from the uncertainties of the histories.
    pub uncertainty: f64,
    /// Least distance of the ring from the plane \[L\] over t \[L/c0\].
    gap: Vec<(f64, f64)>,
    /// Largest principal logarithmic strain at any time and place \[-\].
    pub strain: f64,
}

/// The faces of the right ring at a time of the table \[L\]; none at any other.
pub fn outlines(speed: f64, time: f64) -> Vec<Vec<(f64, f64)>> {
    let [speed, time] = [speed, time].map(|number| format!("{number:?}"));
    let face = |name| {
        let of = [("law", JAUMANN), ("speed", &*speed), ("t", &*time), ("face", name)];
        let half = Reference::curve(PACKAGE, "outlines", ["x", "y"], &of);
        let mirrored = half.clone().into_iter().rev().map(|(x, y)| (x, -y));
        half.into_iter().chain(mirrored).collect::<Vec<_>>()
    };
    ["outer", "inner"].map(face).into_iter().filter(|line| !line.is_empty()).collect()
}

/// Adds the distances from finite elements to a record with metrics and series, or the reason for their
/// absence.
pub fn compare(s: &RingSettings, phases: &[ContactPhase], record: &mut Record) {
    let Some(exact) = RingReference::of(&record.run.variant, s) else {
        let errors = COMPARED.map(|(_, error)| error);
        let lacks = Absent::because(
            "finite elements have rings of 3 and 4 L, 0.22 K, at 0.059 and 0.03 c0, to 200 L/c0",
        );
        return record.leave_all_out(&[&errors[..], &OF_HISTORIES].concat(), &lacks);
    };
    for (quantity, error) in COMPARED {
        let pair = exact.number(quantity).zip(record.value(quantity));
        let value = pair.map(|(exact, found)| found / exact.value - 1.0);
        record.put_or(error, value, "the run has no number to compare");
    }
    exact.compare_phases(phases, record);
    exact.compare_histories(record);
}

impl RingReference {
    /// The reference of the law of a variant with these settings; `None` where nothing was computed for them.
    pub fn of(variant: &str, settings: &RingSettings) -> Option<Self> {
        let rings = |s: &RingSettings| (s.inner, s.outer, s.centre, s.shear_modulus, s.end);
        if rings(settings) != rings(&RingSettings::default()) {
            return None;
        }
        let law = if variant == LAGRANGIAN { Hencky::NAME } else { JAUMANN };
        let speed = settings.speed.to_string();
        let of = [("law", law), ("speed", &*speed)];
        let curve = |table, columns| Reference::curve(PACKAGE, table, columns, &of);
        let [place, velocity, width, height] =
            [PLACE, VELOCITY, WIDTH, HEIGHT].map(|column| curve("series", ["t", column.name]));
        let doubts = ["x_c_uncertainty", "width_uncertainty", "height_uncertainty"]
            .map(|name| rms(curve("series", ["t", name]).into_iter().map(|(_, doubt)| doubt)));
        let begins = curve("phases", ["impulse_1", "impulse"]);
        let ends = curve("phases", ["impulse_99", "impulse_99_uncertainty"]);
        let (_, doubt) = *ends.last()?;
        let phases = begins.into_iter().zip(ends);
        let strain = [("check", "greatest principal logarithmic strain"), of[0], of[1]];
        let strains = Reference::curve(PACKAGE, "checks", ["mesh", "value"], &strain);
        Some(Self {
            quantities: quantities(PACKAGE, &of)?,
            phases: phases
                .map(|((begin, impulse), (end, _))| Phase { impulse, begin, end })
                .collect(),
            doubt,
            uncertainty: largest(doubts) / diameter(&width),
            place,
            velocity,
            width,
            height,
            gap: curve("series", ["t", "gap"]),
            // The finest mesh comes last.
            strain: strains.last().map_or(f64::NAN, |(_, strain)| *strain),
        })
    }

    /// A number of the summary.
    pub fn number(&self, quantity: MetricKey) -> Option<Uncertain> {
        self.quantities.get(&String::from(quantity)).copied()
    }

    /// When the ring of finite elements is farther than this distance \[L\] from the plane after the last
    /// phase \[L/c₀\].
    pub fn leaves(&self, reach: f64) -> f64 {
        let end = self.phases[self.phases.len() - 1].end;
        let mut gaps = self.gap.iter();
        gaps.find(|(t, gap)| *t > end && *gap > reach).map_or(f64::NAN, |(t, _)| *t)
    }

    /// Distances of centre, velocity and extents over the times of finite elements, all of which a run must
    /// have.
    fn compare_histories(&self, record: &mut Record) {
        let histories = [
            (PLACE, &self.place),
            (VELOCITY, &self.velocity),
            (WIDTH, &self.width),
            (HEIGHT, &self.height),
        ];
        let found: Result<Vec<Vec<f64>>, _> = histories
            .map(|(column, exact)| history::differences(&record.curve([TIME, column]), exact))
            .into_iter()
            .collect();
        let found = match found {
            Ok(found) => found,
            Err(why) => return record.leave_all_out(&OF_HISTORIES, &Absent::because(why)),
        };
        for (metric, differences) in RMS.into_iter().zip(&found) {
            record.put(metric, rms(differences.iter().copied()));
        }
        let lengths = [X_C_RMS, WIDTH_RMS, HEIGHT_RMS].map(|key| record.value(key));
        let lengths = lengths.map(|length| length.unwrap_or(f64::NAN));
        record.put(HISTORIES, largest(lengths) / diameter(&self.width));
        let path = &found[0];
        let worst = path.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        record.put(X_C_WORST, worst.unwrap_or(f64::NAN));
    }

    /// Begin, end and impulse of each phase. If a run has another number of phases, only the first begin and
    /// the last end have a counterpart.
    fn compare_phases(&self, found: &[ContactPhase], record: &mut Record) {
        const UNLIKE: &str = "the rings have another number of phases than finite elements, or still touch \
                              at the end";
        let is_same = found.len() == self.phases.len();
        let is_over = |found: &&ContactPhase| found.is_over;
        for (k, Phase { impulse, begin, end }) in self.phases.iter().enumerate() {
            let same = found.get(k).filter(|_| is_same).filter(is_over);
            let first = if k == 0 { found.first() } else { same };
            let is_last = k + 1 == self.phases.len();
            let last = if is_last { found.last().filter(is_over) } else { same };
            for (metric, error) in [
                (CONTACT_BEGIN_ERROR, first.map(|found| found.times[0] - begin)),
                (CONTACT_END_ERROR, last.map(|found| found.times[1] - end)),
                (IMPULSE_ERROR, same.map(|found| found.impulse / impulse - 1.0)),
            ] {
                record.put_or(metric.at(phase(k)), error, UNLIKE);
            }
        }
    }
}

/// The outer diameter \[L\]: the width before the rings touch.
fn diameter(width: &Points) -> f64 {
    width.first().map_or(f64::NAN, |(_, width)| *width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solids::rings::metrics::RESTITUTION;

    #[test]
    fn outlines_have_the_extents_of_the_series() {
        let paper = RingReference::of("seed", &RingSettings::default()).expect("the paper's speed");
        for time in [32.0, 60.0, 80.0, 120.0, 200.0] {
            let lines = outlines(0.059, time);
            assert_eq!(lines.len(), 2);
            let at =
                paper.place.iter().position(|(t, _)| *t == time).expect("a time of the series");
            let extent = |of: fn(&(f64, f64)) -> f64| {
                let all = || lines[0].iter().map(of);
                all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
            };
            let (width, height) = (paper.width[at].1, paper.height[at].1);
            let (found_width, found_height) = (extent(|p| p.0), extent(|p| p.1));
            // Every fourth node of the face is there.
            assert!((found_width - width).abs() < 0.02, "{found_width} for {width} at {time}");
            assert!((found_height - height).abs() < 0.02, "{found_height} for {height} at {time}");
        }
        assert!(outlines(0.059, 33.0).is_empty());
        assert!(outlines(0.12, 32.0).is_empty());
    }

    #[test]
    fn two_speeds_have_a_reference_and_others_have_none() {
        let at =
            |speed| RingReference::of("seed", &RingSettings { speed, ..RingSettings::default() });
        let paper = at(0.059).expect("the paper's speed");
        let restitution = paper.number(RESTITUTION).expect("measured");
        assert!((restitution.value - 0.8004).abs() < 1e-3 && restitution.uncertainty < 0.01);
        assert!(at(0.03).is_some() && at(0.12).is_none());
        assert!((paper.phases[0].impulse - 1.19129).abs() < 1e-4 && paper.phases.len() == 2);
        let start = [&paper.place, &paper.velocity, &paper.width, &paper.height].map(|of| of[0].1);
        assert_eq!(start, [5.0, -0.059, 8.0, 8.0]);
        let other = RingReference::of(LAGRANGIAN, &RingSettings::default()).expect("its law");
        assert_eq!(other.number(RESTITUTION).map(|found| found.value), Some(0.795617));
        let softer = RingSettings { shear_modulus: 0.2, ..RingSettings::default() };
        assert!(RingReference::of("seed", &softer).is_none());
    }
}
