//! What other codes made of exported problems, and this one in turn with them: the records of
//! `references/peers`, which the program contains.

use base::{pack, record::Record, submission::SESSION};
use harness::{make::Made, suite::Plans};

/// Packed by the build script.
const RECORDS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/peers"));
/// The day on which they were made, in one session.
const MADE: &str = include_str!("../../../references/peers/made.txt");

/// All of them. A test reads each.
pub fn records() -> impl Iterator<Item = Record> {
    let session = |mut record: Record| {
        record.numerics.insert(SESSION.into(), MADE.trim().into());
        record
    };
    let texts = pack::read(RECORDS).into_values();
    texts.filter_map(|text| Record::from_json(&text).ok()).map(session)
}

/// Adds those of the cases of the plans, except where the store has a run of the same code and method.
pub fn add(made: &mut Made, plans: &Plans) {
    for record in records() {
        let is_planned = plans.iter().any(|(case, _)| case.name() == record.case);
        if is_planned && made.submissions.iter().all(|own| own.key() != record.key()) {
            made.submissions.push(record);
        }
    }
}
