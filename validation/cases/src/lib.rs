//! Every case, and the page of a report.

pub mod fluids;
pub mod lattice;
mod limitations;
pub mod page;
pub mod peers;
mod probes;
mod solids;
mod stabilisation;
pub mod stiffness;
mod time;
mod waters;

use touchstone_base::reference::Reference;
use touchstone_harness::case::{Case, RunError};

use crate::{
    fluids::{
        cavity, channel, manufactured, periodic_hill, slip_channel, taylor_couette, taylor_green,
    },
    lattice::{extremes, operators, resting_box, wave},
    solids::{cantilever, elastic_bar, elastic_wave, oscillating_plate, rings, spinning_disk},
    waters::{dam_break, elliptic_drop, hydrostatic, still_wedge},
};

pub use touchstone_harness::case::find_in;

/// Every case, in the order of the report: the five of the paper, then the supporting ones.
pub static CASES: &[&dyn Case] = &[
    &channel::COUETTE,
    &channel::POISEUILLE,
    &periodic_hill::CASE,
    &dam_break::DAM_BREAK,
    &rings::RUBBER_RINGS,
    &taylor_green::CASE,
    &taylor_couette::CASE,
    &slip_channel::CASE,
    &manufactured::CASE,
    &cavity::CASE,
    &elliptic_drop::ELLIPTIC_DROP,
    &hydrostatic::HYDROSTATIC,
    &still_wedge::STILL_WEDGE,
    &elastic_bar::ELASTIC_BAR,
    &spinning_disk::SPINNING_DISK,
    &oscillating_plate::OSCILLATING_PLATE,
    &cantilever::CANTILEVER,
    &wave::ACOUSTIC_WAVE,
    &wave::SHEAR_WAVE,
    &elastic_wave::ELASTIC_WAVE,
    &resting_box::RESTING_BOX,
    &operators::OPERATORS,
    &extremes::EXTREMES,
];

/// The case of that name.
pub fn find(name: &str) -> Result<&'static dyn Case, RunError> {
    find_in(CASES, name)
}

/// The references that cases are compared with, and these cases.
const USERS: [(&str, &[&str]); 9] = [
    ("cantilever", &["cantilever"]),
    ("cavity", &["cavity"]),
    ("dam_break_vof", &["dam_break"]),
    ("dambreak_lobovsky", &["dam_break"]),
    ("dambreak_martin_moyce", &["dam_break"]),
    ("oscillating_plate", &["oscillating_plate"]),
    ("periodic_hill", &["periodic_hill"]),
    ("periodic_hill_geometry", &["periodic_hill"]),
    ("rubber_rings", &["rubber_rings"]),
];

/// The cases that are compared with a reference.
pub fn users(reference: &str) -> &'static [&'static str] {
    USERS.iter().find(|(name, _)| *name == reference).map_or(&[], |(_, cases)| cases)
}

/// Name and grade of each reference of a case.
pub fn graded(case: &str) -> Vec<(&'static str, String)> {
    let is_user = |name: &str| users(name).contains(&case);
    let found = Reference::names().into_iter().filter(|name| is_user(name));
    found.filter_map(|name| Some((name, Reference::load(name).ok()?.graded()))).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    /// The text of all sources below a folder.
    fn sources(folder: &Path) -> String {
        let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let text = |path: std::path::PathBuf| match path.is_dir() {
            true => sources(&path),
            false => fs::read_to_string(path).unwrap(),
        };
        paths.map(text).collect()
    }

    #[test]
    fn a_reference_that_is_read_has_its_cases_named() {
        let names = Reference::names();
        for (name, cases) in USERS {
            assert!(names.contains(&name), "{name}");
            assert!(cases.iter().all(|case| find(case).is_ok()), "{name}: {cases:?}");
        }
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let text = sources(&root.join("maths/src")) + &sources(&root.join("cases/src"));
        for name in names {
            // The first argument of a function that reads it.
            let is_read = text.contains(&format!("(\"{name}\""));
            assert_eq!(is_read, !users(name).is_empty(), "{name}");
        }
    }
}
