//! Makes the runs of a plan without stored records: first the runs that are not timed, in parallel and the
//! longest first, on all threads if the others would wait for it; then the timed runs, one at a time
//! while this program does nothing else, in rounds over all of them, so that a change of the machine's speed
//! affects every variant alike. If a caller waits for the first complete case, one case is made in this way
//! before all others.

use std::collections::{BTreeMap, BTreeSet};

use touchstone_base::{
    manifest::UNKNOWN,
    record::{Record, Status},
};

pub use crate::jobs::{BatchOptions, BatchResult, Finished, Job, OnProgress, jobs};
use crate::{batch::Batch, runs::Tier, studies::Card};

/// The stored runs of a plan, and the missing ones.
#[derive(Default)]
pub struct StoredRuns {
    /// Records found.
    pub made: BatchResult,
    /// The runs that it lacks.
    pub missing: Vec<Job>,
    /// Runs that have only a record from other sources.
    pub other: usize,
}

/// Looks up the records of the jobs. A record made from other sources does not serve unless allowed, nor does
/// the record of a refused run if longer runs are allowed now: trying again takes no time. The record of a
/// timed run must have been made while no other run was. After an interrupt, see
/// [`BatchResult::interrupted`], the result may be incomplete.
pub fn stored(jobs: &[Job], making: &BatchOptions) -> StoredRuns {
    let mut stored = StoredRuns::default();
    for job in jobs {
        if making.is_interrupted() {
            stored.made.interrupted = true;
            break;
        }
        let spec = &job.planned.spec;
        let serves = |record: &Record| match record.status {
            Status::Refused { .. } => !making.allow_long,
            Status::Completed => !job.planned.timed || !record.cost.alone_s.is_empty(),
            _ => true,
        };
        let found = match making.store {
            Some(store) if !making.fresh => store.find(spec),
            _ => Ok(None),
        };
        let made = &mut stored.made;
        let record = found.unwrap_or_else(|error| {
            made.unsound.entry(spec.key()).or_insert(error);
            None
        });
        let sources = (making.sources)(&spec.case);
        let is_other = |record: &Record| record.manifest.sources != sources || sources == UNKNOWN;
        let is_other = record.as_ref().is_some_and(is_other);
        if let Some(record) = record.filter(|of| serves(of) && (making.reuse_other || !is_other)) {
            made.reused += 1;
            made.of_other_sources += usize::from(is_other);
            made.records.insert(spec.key(), record);
        } else {
            stored.other += usize::from(is_other);
            stored.missing.push(job.clone());
        }
    }
    let cases: BTreeSet<_> = jobs.iter().map(|job| job.case.name()).collect();
    let submissions = |case| making.store.map(|store| store.submissions(case)).unwrap_or_default();
    for read in cases.into_iter().flat_map(submissions) {
        match read {
            Ok(record) => stored.made.submissions.push(record),
            Err(error) => stored.made.unread.push(error),
        }
    }
    stored
}

/// Makes the runs that the store lacks. A refused or diverged run has a record; a run that fails otherwise
/// has none, see [`BatchResult::failed`]. For records that the store cannot keep see
/// [`BatchResult::not_kept`].
pub fn make(StoredRuns { made, missing, .. }: StoredRuns, making: &BatchOptions) -> BatchResult {
    let batch = Batch::new(&missing, made, making);
    let first = making.finished.and_then(|_| first(&missing, making.tier));
    let (early, later) = missing.iter().partition(|job| Some(job.case.name()) == first);
    batch.make_all(early);
    batch.make_all(later);
    batch.made()
}

/// The main case (a case with a card) with the least total time of its runs.
fn first(missing: &[Job], tier: Tier) -> Option<&'static str> {
    let mut cases = BTreeMap::new();
    for job in missing {
        cases.entry(job.case.name()).or_insert((job.case, 0.0)).1 += job.planned.seconds;
    }
    cases.retain(|_, (case, _)| case.studies(tier).first::<Card>().is_some());
    let least = cases.iter().min_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b));
    least.map(|(name, _)| *name)
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicBool, Ordering};

    use serde_json::{Value, json};
    use touchstone_base::{
        mutation::{Constant, Detect},
        record::MetricKey,
        spec::{Bisect, RunSpec},
    };

    use super::*;
    use crate::{
        case::{RunError, spec},
        context::Context,
        runs::Planned,
        store::Store,
        studies::Studies,
        suite,
        tally::Done,
        testing::Staged,
    };

    /// Every run of it completes at once.
    struct Quick;

    const ERROR: MetricKey = MetricKey::new("error", "-", "as staged");

    impl Staged for Quick {
        fn called(&self) -> &'static str {
            "quick"
        }
        fn set(&self, set: &[String]) -> Value {
            json!({ "set": set })
        }
        fn made(&self, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
            let mut record = Record::of(spec, 1);
            record.put(ERROR, 1.0);
            (record.cost.wall_s, record.cost.cpu_s) = (7.0, 0.02);
            record.cost.threads = context.threads;
            match spec.settings["set"][0].as_str() {
                Some("k=panic") => panic!("staged"),
                Some("k=cut") => {
                    record.status = Status::Interrupted { step: 1, time: 0.1 };
                    Ok(record)
                }
                Some("k=slow") => {
                    record.cost.cpu_s = 0.3;
                    Ok(record)
                }
                Some("k=file") => Err(RunError::Reference("staged".into())),
                Some("k=long") if !context.allow_long => Err(RunError::NoScene("staged")), // a refusal
                _ => Ok(record),
            }
        }
        fn studied(&self, _: Tier) -> Studies {
            let planned = |k: i32| Planned::new(spec(self, "v", &[format!("k={k}")]).unwrap());
            Studies::judging(vec![planned(1), planned(2), planned(3).timed()])
        }
    }

    /// A case of this name, with a card if it is a main one.
    struct Named(&'static str, bool);

    impl Staged for Named {
        fn called(&self) -> &'static str {
            self.0
        }
        fn set(&self, set: &[String]) -> Value {
            Quick.set(set)
        }
        fn made(&self, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
            Quick.made(spec, context)
        }
        fn studied(&self, _: Tier) -> Studies {
            let card = || Card::made_up(ERROR, Vec::new());
            Studies::default().with_all(self.1.then(card))
        }
    }

    static DEAR: Named = Named("dear", true);
    static CHEAP: Named = Named("cheap", true);
    static SIDE: Named = Named("side", false);

    /// The first case of a page is the main case with the least total time, and not a case without a card,
    /// however cheap.
    #[test]
    fn the_cheapest_of_the_main_cases_is_made_first() {
        let of = |case: &'static Named, k: &str, seconds: f64| {
            let spec = RunSpec::new(case.0, "v", json!({ "set": [format!("k={k}")] }));
            Job { case, planned: Planned { seconds, ..Planned::new(spec) } }
        };
        let all =
            [of(&DEAR, "1", 2.0), of(&SIDE, "1", 0.1), of(&CHEAP, "1", 2.5), of(&DEAR, "2", 2.0)];
        let last = Mutex::new(Vec::new());
        let progress = |done: Done| last.lock().unwrap().push(done.last.to_string());
        let sources = |_: &str| "one".to_string();
        let making =
            BatchOptions { progress: Some(&progress), ..BatchOptions::new(Tier::Quick, &sources) };
        let finished = |_: BatchResult| ();
        made(&all, &BatchOptions { finished: Some(&finished), ..making });
        let order: Vec<String> = last.into_inner().unwrap();
        let first = order.iter().find(|name| !name.is_empty()).expect("a run");
        assert!(first.contains("cheap"), "{order:?}");
        assert_eq!(super::first(&all[1..2], Tier::Quick), None);
    }

    fn job(k: &str) -> Job {
        let settings = json!({ "set": [format!("k={k}")] });
        Job { case: &Quick, planned: Planned::new(RunSpec::new("quick", "v", settings)) }
    }

    /// Makes the runs that a store lacks, by a build of these sources.
    fn made(jobs: &[Job], making: &BatchOptions) -> BatchResult {
        make(stored(jobs, making), making)
    }

    /// Records of another build were reused, and no test reached that branch.
    #[test]
    fn a_record_of_other_sources_is_made_again_unless_any_build_will_do() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let jobs = [job("1"), job("2")];
        // Reused records, records of other sources, and the sources of the first record, for a build of these
        // sources.
        let build = |sources: &'static str, reuse_other: bool| {
            let of = move |_: &str| sources.to_string();
            let making = BatchOptions {
                store: Some(&store),
                reuse_other,
                ..BatchOptions::new(Tier::Quick, &of)
            };
            let made = made(&jobs, &making);
            let first = made.records[&jobs[0].planned.spec.key()].manifest.sources.clone();
            (made.reused, made.of_other_sources, first)
        };
        let (one, other) = (|| "one".to_string(), || "other".to_string());
        assert_eq!(build("one", false), (0, 0, one()), "an empty store");
        assert_eq!(build("one", false), (2, 0, one()), "its own records");
        assert_eq!(build("other", true), (2, 2, one()), "any build will do");
        assert_eq!(build("other", false), (0, 0, other()), "those of another build are made again");
        let unknown = touchstone_base::manifest::UNKNOWN;
        assert_eq!(build(unknown, false), (0, 0, unknown.into()), "unknown and known differ");
        assert_eq!(build(unknown, false), (0, 0, unknown.into()), "so do unknown and unknown");
    }

    /// `--fresh` removed 87 records and was interrupted: one was left.
    #[test]
    fn a_record_that_is_made_afresh_stays_until_its_successor_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let jobs: Vec<Job> = (0..50).map(|k| job(&k.to_string())).collect();
        let sources = |_: &str| "one".to_string();
        let making =
            BatchOptions { store: Some(&store), ..BatchOptions::new(Tier::Quick, &sources) };
        made(&jobs, &making);
        let (stop, fresh) = (AtomicBool::new(false), true);
        let progress = |done: Done| stop.store(done.runs > 0, Ordering::Relaxed);
        let (interrupt, progress): (_, Option<&OnProgress>) = (Some(&stop), Some(&progress));
        let cut = made(&jobs, &BatchOptions { interrupt, progress, fresh, ..making });
        assert!(cut.interrupted && (1..50).contains(&cut.records.len()), "{}", cut.records.len());
        assert_eq!(Store::all(store.path()).unwrap().len(), 50);
        let again = made(&jobs, &BatchOptions { fresh, ..making });
        assert_eq!((again.reused, again.records.len()), (0, 50));
    }

    /// One record in 87 was damaged, and all commands used it for ever or refused the store.
    #[test]
    fn a_damaged_record_is_told_and_made_again() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let (jobs, sources) = ([job("1"), job("2")], |_: &str| "one".to_string());
        let making =
            BatchOptions { store: Some(&store), ..BatchOptions::new(Tier::Quick, &sources) };
        made(&jobs, &making);
        let path = store.path().join(Store::name(&jobs[1].planned.spec));
        let whole = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, whole.replace("1.0", "1e-12")).unwrap();
        let again = made(&jobs, &making);
        assert_eq!((again.reused, again.unsound.len(), again.records.len()), (1, 1, 2));
        let words = again.unsound.values().next().expect("one").to_string();
        assert!(words.contains("quick-v-") && words.contains("damaged"), "{words}");
        assert_eq!(made(&jobs, &making).reused, 2);
    }

    /// A line of a plan that needed 11 GB ended the process, and all other lines with it.
    #[test]
    fn a_run_that_fails_costs_no_other_its_record() {
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(|_| ())); // the panic is staged
        let sources = |_: &str| "one".to_string();
        let mut jobs = ["1", "panic", "2", "file", "3", "long"].map(job);
        jobs[4].planned.timed = true;
        let beside = made(&jobs, &BatchOptions::new(Tier::Quick, &sources));
        jobs.iter_mut().for_each(|job| job.planned.timed = true);
        let alone = made(&jobs, &BatchOptions::new(Tier::Quick, &sources));
        std::panic::set_hook(hook);
        for made in [beside, alone] {
            let failed: Vec<_> = [1, 3].map(|k| &made.failed[&jobs[k].planned.spec.key()]).into();
            assert!(matches!(failed[..], [RunError::Bug, RunError::Reference(_)]), "{failed:?}");
            let refused = &made.records[&jobs[5].planned.spec.key()].status;
            assert!(matches!(refused, Status::Refused { .. }), "{refused:?}");
            assert_eq!((made.records.len(), made.failed.len()), (4, 2));
        }
    }

    /// Two threads with one long run at the end: one of them would have nothing to do.
    #[test]
    fn the_longest_runs_are_made_first() {
        let sources = |_: &str| "one".to_string();
        let planned = |k: &str, seconds| {
            let job = job(k);
            Job { planned: Planned { seconds, ..job.planned }, ..job }
        };
        let jobs = [planned("1", 1.0), planned("2", 7.0), planned("3", 2.0)];
        let shares = Mutex::new(Vec::new());
        let progress = |done: Done| shares.lock().unwrap().push(done.share);
        let progress: Option<&OnProgress> = Some(&progress);
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        one.install(|| {
            made(&jobs, &BatchOptions { progress, ..BatchOptions::new(Tier::Quick, &sources) })
        });
        assert_eq!(shares.into_inner().unwrap(), [0.0, 0.7, 0.9, 1.0]);
    }

    /// The deep tier took 4.5 hours on 16 threads; 15 waited for one run most of the time.
    #[test]
    fn a_large_run_for_which_the_others_would_wait_is_made_on_all_threads() {
        let sources = |_: &str| "one".to_string();
        let planned = |k: &str, seconds, is_large| {
            let job = job(k);
            Job { planned: Planned { seconds, is_large, ..job.planned }, ..job }
        };
        // 23 s, of which each of four threads has 5.75 s.
        let jobs = [
            planned("1", 1.0, true),
            planned("2", 9.0, false),
            planned("3", 10.0, true),
            planned("4", 3.0, true),
        ];
        let order = Mutex::new(Vec::new());
        let progress = |done: Done| order.lock().unwrap().push(done.share);
        let progress: Option<&OnProgress> = Some(&progress);
        let four = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
        let made = |jobs: &[Job]| {
            let making = BatchOptions { progress, ..BatchOptions::new(Tier::Quick, &sources) };
            let made = four.install(|| made(jobs, &making));
            jobs.iter()
                .map(|job| made.records[&job.planned.spec.key()].cost.threads)
                .collect::<Vec<_>>()
        };
        assert_eq!(made(&jobs), [1, 1, 4, 1]);
        assert_eq!(order.lock().unwrap()[..2], [0.0, 10.0 / 23.0], "it is the first");
        assert_eq!(made(&jobs[..1]), [4], "a run alone has all threads");
        let timed = Job { planned: jobs[2].planned.clone().timed(), ..jobs[2].clone() };
        assert_eq!(made(&[timed]), [1], "seconds are compared on one thread");
    }

    /// A run refused for its length is made when longer runs are allowed.
    #[test]
    fn a_run_that_was_too_long_is_made_when_it_may_be_long() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let (jobs, sources) = ([job("long")], |_: &str| "one".to_string());
        let making =
            BatchOptions { store: Some(&store), ..BatchOptions::new(Tier::Quick, &sources) };
        let completed = |making: &BatchOptions| {
            let made = made(&jobs, making);
            (made.reused, made.records.values().all(|r| r.status == Status::Completed))
        };
        assert_eq!(completed(&making), (0, false));
        assert_eq!(completed(&making), (1, false));
        assert_eq!(completed(&BatchOptions { allow_long: true, ..making }), (0, true));
    }

    /// An interrupted lookup must not fail the gates of records that it has not read.
    #[test]
    fn a_look_into_a_store_that_is_cut_short_says_so() {
        let sources = |_: &str| "one".to_string();
        let looked = |stop: bool| {
            let stop = AtomicBool::new(stop);
            let making =
                BatchOptions { interrupt: Some(&stop), ..BatchOptions::new(Tier::Quick, &sources) };
            let StoredRuns { made, missing, .. } = stored(&[job("1")], &making);
            (made.interrupted, missing.len())
        };
        assert_eq!([false, true].map(looked), [(false, 1), (true, 0)]);
    }

    /// A record of a run made along with others does not serve as timed, and the quiet phase measures
    /// processor time.
    #[test]
    fn a_timed_run_is_made_alone_and_its_time_is_that_of_the_processor() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let sources = |_: &str| "one".to_string();
        let making =
            BatchOptions { store: Some(&store), ..BatchOptions::new(Tier::Quick, &sources) };
        let plain = job("1");
        let timed = Job { planned: plain.planned.clone().timed(), ..plain.clone() };
        let alone = |job: &Job, making: &BatchOptions| {
            let made = made(std::slice::from_ref(job), making);
            (made.reused, made.records[&job.planned.spec.key()].cost.alone_s.clone())
        };
        assert_eq!(alone(&plain, &making), (0, vec![]), "made beside others");
        assert_eq!(alone(&timed, &making), (0, vec![0.02; 3]), "so it is made again, three times");
        assert_eq!(alone(&timed, &making), (1, vec![0.02; 3]));
        assert_eq!(alone(&plain, &making), (1, vec![0.02; 3]), "one that was timed serves as well");
    }

    #[test]
    fn the_quick_tier_repeats_only_what_takes_a_tenth_of_a_second() {
        let sources = |_: &str| "one".to_string();
        let timings = |tier: Tier, k: &str| {
            let job = Job { planned: job(k).planned.timed(), ..job(k) };
            let made = made(std::slice::from_ref(&job), &BatchOptions::new(tier, &sources));
            made.records[&job.planned.spec.key()].cost.alone_s.len()
        };
        assert_eq!([Tier::Quick, Tier::Full].map(|tier| timings(tier, "1")), [3, 3]);
        assert_eq!([Tier::Quick, Tier::Full].map(|tier| timings(tier, "slow")), [1, 3]);
    }

    /// A search that was cut short would be kept as one that found no limit.
    #[test]
    fn what_is_interrupted_is_no_record_whatever_its_task() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let sources = |_: &str| "one".to_string();
        let making =
            BatchOptions { store: Some(&store), ..BatchOptions::new(Tier::Quick, &sources) };
        let cut = job("cut").planned.spec;
        let bisect =
            Bisect { setting: "dt".into(), guess: 1.0, unit: 1.0, resolution: 0.1, end: None };
        let detect = Detect { of: Constant::Viscosity, only_allowed: false };
        for spec in [cut.clone(), cut.clone().bisect(bisect), cut.detect(detect)] {
            for planned in [Planned::new(spec.clone()), Planned::new(spec.clone()).timed()] {
                let made = made(&[Job { case: &Quick, planned }], &making);
                let stored = Store::all(store.path()).unwrap();
                assert_eq!((made.records.len(), stored.len()), (0, 0), "{spec:?}");
            }
        }
    }

    /// A full disk or a read-only folder: here a file in place of the folder.
    #[test]
    fn records_that_cannot_be_kept_are_judged_and_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("records");
        let store = Store::open(&path).unwrap();
        std::fs::remove_dir(&path).unwrap();
        std::fs::write(&path, "in the way").unwrap();
        let shown = Mutex::new(Vec::new());
        let show = |done: Done| shown.lock().unwrap().push((done.runs, done.all));
        let making = BatchOptions {
            store: Some(&store),
            progress: Some(&show),
            ..BatchOptions::new(Tier::Quick, &|_| "abc".into())
        };
        let suite = suite::run(&[&Quick], &making);
        let values = suite.cases[0].runs.all.iter().map(|run| run.record.value(ERROR));
        assert_eq!(values.collect::<Vec<_>>(), [Some(1.0); 3]);
        assert_eq!(suite.made.not_kept.len(), 3);
        for error in suite.made.not_kept.values() {
            let words = error.to_string();
            assert!(words.contains("cannot write") && words.contains("records"), "{words}");
        }
        assert_eq!(shown.lock().unwrap()[0], (0, 3), "shown before the first run ends");
    }

    /// The folder is made again if it is removed while runs are made.
    #[test]
    fn a_store_that_is_removed_while_runs_are_made_is_there_again() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("records")).unwrap();
        std::fs::remove_dir(store.path()).unwrap();
        let jobs = jobs(suite::plans(&[&Quick], Tier::Quick));
        let making = BatchOptions {
            store: Some(&store),
            ..BatchOptions::new(Tier::Quick, &|_| "abc".into())
        };
        let made = make(stored(&jobs, &making), &making);
        assert_eq!((made.records.len(), made.not_kept.len()), (3, 0));
        assert_eq!(Store::all(store.path()).unwrap().len(), 3);
    }
}
