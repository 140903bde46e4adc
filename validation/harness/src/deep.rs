//! The deep tier: the declaration of the full tier, with ladders of two more levels, maps of 20 starts a
//! cell, and tables of the errors detected by gates over every judged run. It is made for clusters: its runs
//! are independent of each other, and some exceed the usual limit of a run, which must be allowed explicitly.

use serde_json::Value;
use touchstone_base::functions::powf;
use touchstone_base::mutation::Disorder;
use touchstone_base::spec::{Keep, RunKey, RunSpec, Task};

use crate::{
    case::{self, Case, Planned, Tier},
    declare::{Accuracy, Declaration, Ladder, Level, Map},
    plan,
};

/// Levels by which a ladder of the deep tier is longer.
pub const FINER: i32 = 2;
/// Starts of each cell of a map.
pub const STARTS: usize = 20;
/// The disorder between the starts of a cell \[spacings\], which is one start in the full tier: more than
/// round-off, and far less than the resolution of a map.
const DISORDER: f64 = 0.01;

/// Extends the declaration of the full tier to the deep tier.
pub fn deepened(mut declared: Declaration, case: &dyn Case) -> Declaration {
    watch_all(&mut declared, case);
    declared.accuracy.iter_mut().for_each(|accuracy| refine(accuracy, case));
    declared.maps.iter_mut().for_each(|map| start_often(map, case));
    declared
}

/// Ladders go on by their last ratio.
fn refine(accuracy: &mut Accuracy, case: &dyn Case) {
    for ladder in &mut accuracy.ladders {
        let Some(last) = ladder.levels.last().map(|level| level.run.spec.clone()) else { continue };
        let next = |k| finer(ladder, &last, k, case);
        let more: Vec<Level> = (1..=FINER).filter_map(next).collect();
        ladder.levels.extend(more);
    }
    accuracy.about +=
        " In the deep tier each ladder goes two levels further by the ratio of its last two.";
}

/// A run `steps` levels finer: each number in which the last two levels of the ladder differ goes on by their
/// ratio, whole numbers rounded. None if the case has no such run.
fn finer(ladder: &Ladder, from: &RunSpec, steps: i32, case: &dyn Case) -> Option<Level> {
    let [.., coarse, fine] = ladder.levels.as_slice() else { return None };
    let number = |level: &Level, name: &String| level.run.spec.settings.get(name)?.as_f64();
    let (mut spec, mut spacing) = (RunSpec { keep: Keep::default(), ..from.clone() }, fine.spacing);
    for (name, value) in from.settings.as_object()? {
        let Some((a, b)) = number(coarse, name).zip(number(fine, name)).filter(|(a, b)| a != b)
        else {
            continue;
        };
        let exact = value.as_f64()? * powf(b / a, f64::from(steps));
        let next = if value.is_u64() { Value::from(exact.round() as u64) } else { exact.into() };
        spacing = match value.is_u64() {
            true => fine.spacing * b / next.as_f64()?,
            false => fine.spacing * powf(fine.spacing / coarse.spacing, f64::from(steps)),
        };
        spec = spec.with_setting(name, next);
    }
    let is_finer = spacing < fine.spacing;
    let spec = case::resolved(case, spec).ok().filter(|_| is_finer)?;
    let resolution = fine.resolution.finer(fine.spacing / spacing);
    Some(Level { run: Planned::new(spec), spacing, resolution })
}

/// Adds starts to the cells of a map: values of the one setting in which the starts of a cell differ, spread
/// by equal ratios between the least and the largest of the map. Where all cells have one start, the others
/// are disordered.
fn start_often(map: &mut Map, case: &dyn Case) {
    let cells = || map.panels.iter().flat_map(|panel| &panel.cells).flatten();
    let varied = cells().find_map(|cell| setting_of_starts(cell));
    let value = |spec: &RunSpec| spec.settings[varied.as_ref()?].as_f64();
    let values = cells().flatten().filter_map(value);
    let (least, most) = values.fold((f64::MAX, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    let cells = map.panels.iter_mut().flat_map(|panel| &mut panel.cells).flatten();
    for cell in cells.filter(|cell| !cell.is_empty()) {
        let (first, more) = (cell[0].clone(), STARTS.saturating_sub(cell.len()));
        let start = |k: usize| match &varied {
            None => Some(first.clone().disordered(Disorder { most: DISORDER, seed: 1 + k as u32 })),
            Some(name) => {
                // A quarter off the middle of each part, so that none falls on a start that is there.
                let at = powf(most / least, (k as f64 + 0.25) / more as f64) * least;
                case::resolved(case, first.clone().with_setting(name, at)).ok()
            }
        };
        cell.extend((0..more).filter_map(start));
    }
}

/// The setting in which the first two starts of a cell differ.
fn setting_of_starts(cell: &[RunSpec]) -> Option<String> {
    let [one, other, ..] = cell else { return None };
    let mut settings = one.settings.as_object()?.iter();
    let differs = settings.find(|(name, value)| other.settings.get(name) != Some(value));
    differs.map(|(name, _)| name.clone())
}

/// Errors of constants are searched in every judged run of the case, not in the few of the full tier.
fn watch_all(declared: &mut Declaration, case: &dyn Case) {
    let all = [case.plan(Tier::Full), declared.runs()].concat();
    let Some(sensitivity) = &mut declared.sensitivity else { return };
    let known: Vec<RunKey> = sensitivity.runs.iter().map(RunSpec::key).collect();
    for Planned { spec, gates, .. } in plan::merged(all) {
        let is_healthy = spec.task == Task::Simulate && spec.mutation.is_none();
        if is_healthy && !gates.is_empty() && !known.contains(&spec.key()) {
            sensitivity.runs.push(spec);
        }
    }
}
