//! What a store has of plans.

use harness::{
    case::{Case, Planned},
    make::Made,
    store::{Found, Store},
};

use super::World;

/// The records of plans that a store has, and how many runs it lacks or has of other sources alone.
pub fn stored(
    plans: &[(&'static dyn Case, Vec<Planned>)],
    store: &Store,
    any_build: bool,
    world: &World,
) -> (Made, [usize; 2]) {
    let (mut made, mut missing, mut other) = (Made::default(), 0, 0);
    for spec in plans.iter().flat_map(|(_, plan)| plan).map(|planned| &planned.spec) {
        let record = match store.find(spec, &(world.sources)(&spec.case)) {
            Found::Same(record) => record,
            Found::Other(record) if any_build => {
                made.of_other_sources += 1;
                record
            }
            Found::Other(_) => {
                other += 1;
                continue;
            }
            Found::Nothing => {
                missing += 1;
                continue;
            }
        };
        made.reused += 1;
        made.records.insert(spec.key(), *record);
    }
    (made, [missing, other])
}
