//! Runs of other codes for exported problems, and runs of this one in turn with them: the records of
//! `references/peers`, which the program contains.

use touchstone_base::{pack, record::Record, spec::RunKey, submission::SESSION};
use touchstone_harness::{make::BatchResult, suite::Plans};

/// Packed by the build script.
const RECORDS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/peers"));
/// The day on which they were made, in one session.
const MADE: &str = include_str!("../../../references/peers/made.txt");

/// All records. A test reads each.
pub fn records() -> impl Iterator<Item = Record> {
    let session = |mut record: Record| {
        record.numerics.insert(SESSION.into(), MADE.trim().into());
        record
    };
    let texts = pack::read(RECORDS).into_values();
    texts.filter_map(|text| Record::from_json(&text).ok()).map(session)
}

/// Adds the records for the cases of the plans, except where the store has a run of the same code and method.
pub fn add(made: &mut BatchResult, plans: &Plans) {
    let is_planned = |of: &Record| plans.iter().any(|(case, _)| case.name() == of.run.case);
    // Its results may be new.
    let key = |of: &Record| {
        let mut spec = of.spec();
        spec.submission.iter_mut().for_each(|submission| submission.results = None);
        spec.key()
    };
    let stored: Vec<RunKey> = made.submissions.iter().map(key).collect();
    let is_new = |of: &Record| is_planned(of) && !stored.contains(&key(of));
    made.peers = records().filter(is_new).collect();
}
