//! Every variant of every case tells all observers the same, and an error that breaks one symmetry is found
//! by the relation that is about it.

use std::collections::BTreeMap;

use harness::{
    case::{self, Case, RunError},
    relation::Relation,
    symmetry,
};
use rayon::prelude::*;
use validation::cases;

#[test]
fn every_variant_tells_all_observers_the_same() {
    let all: Vec<(&dyn Case, &str)> = cases::CASES
        .iter()
        .flat_map(|case| case.variants().into_iter().map(|v| (*case, v.name)))
        .collect();
    let relations = &Relation::ALL[1..];
    let found: Vec<_> = all
        .par_iter()
        .map(|(case, variant)| {
            let now = std::time::Instant::now();
            let spec = case::spec(*case, variant, &[]).unwrap();
            let found = symmetry::battery(*case, &spec, relations);
            (case.name(), *variant, found, now.elapsed())
        })
        .collect();
    for (case, variant, found, took) in &found {
        match found {
            Err(e) => println!("{case} {variant} REFUSED {e} {took:?}"),
            Ok(all) => {
                println!("{case} {variant} {took:?}");
                for (relation, differences) in all {
                    match differences {
                        Err(e) => println!("    n/a {e}"),
                        Ok(d) => {
                            let bad = if d.iter().all(|d| d.is_round_off()) { "ok" } else { "BAD" };
                            print!("    {bad} {relation}");
                            for d in d {
                                print!(
                                    " [{:.1e} of {:.1e} {} {}]",
                                    d.value, d.floor, d.quantity, d.particle
                                );
                            }
                            println!();
                        }
                    }
                }
            }
        }
    }
}
