//! Results of a code without particles: a profile or a series, as the case declares it. The particles of the
//! problem are placed so that they represent it, and measured as usual; metrics that the curve does not
//! determine are removed from the record by name.

use std::iter::once;

use nalgebra::Vector2;
use touchstone_base::text::number;
use touchstone_harness::{
    facts::SubmittedCurve,
    foreign::{self, ForeignParticle, Frame},
};

use super::{Head, MOST_FLAWS, MOST_ROWS, Renamed, Results, Rows, table};
use crate::{
    flaw::Flaw,
    problem::{CURVE, ExportedProblem},
};

/// The frames represented by a table.
///
/// # Errors
/// Everything that is wrong with it.
pub fn frames(
    curve: &SubmittedCurve,
    text: &str,
    renamed: &Renamed,
    problem: &ExportedProblem,
) -> Result<Results, Vec<Flaw>> {
    let rows = finite(curve, text, renamed)?;
    let (times, ascending) = (rows.column("t"), curve.columns[0].0);
    let first = rows.column(ascending);
    let line = |k: usize| rows.first_line + k as u64;
    let mut flaws = Vec::new();
    let moving = problem.moving();
    let at_start = moving.iter().filter_map(|id| problem.start_of(*id));
    let from: Vec<Vector2<f64>> = at_start.map(|placed| placed.position).collect();
    let unread = rows.unread.iter().cloned().collect();
    let mut results = Results { unread, ..Results::default() };
    let (count, mut k) = ((curve.rows)(&problem.spec), 0);
    while k < times.len() && flaws.len() < MOST_FLAWS {
        let (time, start) = (times[k], k);
        k += times[k..].iter().take_while(|t| **t == time).count().max(1);
        let flaw = |what: String, name: &str| Flaw::of(CURVE, what).at(line(start)).in_column(name);
        if start > 0 && time < times[start - 1] {
            let what = format!(
                "it is {}, after {}; expected rows sorted by t",
                number(time),
                number(times[start - 1])
            );
            flaws.push(flaw(what, "t"));
        }
        if k - start != count {
            let what =
                format!("{} rows are at t = {} s; expected {count}", k - start, number(time));
            flaws.push(flaw(what, "t"));
        }
        if let Some(two) = first[start..k].windows(2).position(|two| two[0] >= two[1]) {
            let what = format!("it is {}; expected it to ascend", number(first[start + two + 1]));
            flaws.push(flaw(what, ascending).at(line(start + two + 1)));
        }
        if (results.frames.len() + 1) * moving.len() > MOST_ROWS {
            flaws
                .push(flaw(format!("expected fewer times: at most {}", results.frames.len()), "t"));
        }
        // The start is the problem's, unless it is a time of output.
        if !flaws.is_empty() || time == 0.0 && !problem.outline.times.contains(&0.0) {
            continue;
        }
        let row = |k: usize| curve.columns.iter().map(|(name, _)| rows.column(name)[k]).collect();
        let at: Vec<Vec<f64>> = (start..k).map(row).collect();
        let placed = moving.iter().zip((curve.place)(&problem.spec, &at, &from));
        let particles = placed.map(|(&id, [position, velocity])| ForeignParticle {
            id,
            position,
            velocity,
            density: None,
        });
        results.frames.push(Frame { time, particles: particles.collect() });
        results.places.push((CURVE.into(), line(start)));
    }
    if count == 1 {
        hold(&mut results, &problem.outline.times);
    }
    if flaws.is_empty() { Ok(results) } else { Err(flaws) }
}

/// The table: finite numbers, and at least one row.
fn finite(curve: &SubmittedCurve, text: &str, renamed: &Renamed) -> Result<Rows, Vec<Flaw>> {
    let columns = curve.columns.iter().map(|(name, unit)| (*name, *unit, false));
    let columns: Vec<Head> = once(("t", "s", false)).chain(columns).collect();
    let rows = table::rows(CURVE, text, renamed, &columns)?;
    if rows.len() == 0 {
        return Err(vec![Flaw::of(CURVE, "it has no rows; expected one a point and time")]);
    }
    let wrong = |(name, ..): &Head| {
        let flaws = (0..rows.len()).filter_map(|k| rows.finite(name, k).err());
        flaws.take(MOST_FLAWS).collect::<Vec<_>>()
    };
    let flaws: Vec<Flaw> = columns.iter().flat_map(wrong).collect();
    if flaws.is_empty() { Ok(rows) } else { Err(flaws) }
}

/// A series is sampled at intervals, and its last row counts until the end if that comes before the next one.
fn hold(results: &mut Results, times: &[f64]) {
    let end = times.last().copied().unwrap_or_default();
    if let [.., before, last] = &results.frames[..]
        && !foreign::missing(&results.frames, &[end]).is_empty()
        && (0.0..last.time - before.time).contains(&(end - last.time))
    {
        results.places.extend(results.places.last().cloned());
        results.frames.push(Frame { time: end, particles: last.particles.clone() });
    }
}
