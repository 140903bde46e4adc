//! A folder of records by key: `CASE-VARIANT-KEY.json`, each written completely or not at all. Runs are
//! independent of each other, so several processes on several machines may fill a store in any order.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use touchstone_base::{
    files::{self, FileError, OutputFolder},
    lock,
    record::{Record, Status},
    spec::RunSpec,
    submission::SESSION,
};

/// A folder of records.
#[derive(Debug)]
pub struct Store {
    folder: OutputFolder,
}

/// Largest record \[bytes\]: one with a million particles has 100 MB.
pub const MOST_BYTES: u64 = 1 << 30;

/// Begins the name of the record of a run that another code made.
const SUBMITTED: &str = "submitted-";

/// Prefix of the file that states that a run is under way, or why it failed. Its age is the time since the
/// last sign of life, which separates a run that continues from the remains of a killed process.
const BEGUN: &str = ".begun-";
/// Wall time between signs of life, and without one until a run counts as dead.
const SIGN_EVERY: Duration = Duration::from_secs(20);
const DEAD_AFTER: Duration = Duration::from_secs(120);
/// Largest text of a reason for a failure \[bytes\].
const MOST_REASON: u64 = 1 << 16;

/// Why a store has no record of a run.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pending {
    /// Not begun since the last record, if any.
    Missing,
    /// Begun, with a sign of life within two minutes.
    Running,
    /// Begun and ended without notice, as by a kill or a failing machine.
    Stopped,
    /// Ended without a record, for this reason.
    Failed(String),
}

/// A run under way, as its store reports it to other processes. A failure to write this file stops no run.
pub struct RunLease<'a> {
    folder: &'a OutputFolder,
    name: String,
    last: Mutex<Instant>,
}

impl RunLease<'_> {
    /// Makes the file anew: writing through a link would empty its target, and a pipe would block.
    fn sign(&self) {
        self.remove();
        let _ = File::create_new(self.folder.path().join(&self.name));
    }

    fn remove(&self) {
        let path = self.folder.path().join(&self.name);
        if path.symlink_metadata().is_ok_and(|found| found.is_file()) {
            let _ = fs::remove_file(path);
        }
    }

    /// A sign of life, if the last one was long ago.
    pub fn beat(&self) {
        let mut last = lock(&self.last);
        if last.elapsed() >= SIGN_EVERY {
            *last = Instant::now();
            self.sign();
        }
    }

    /// The run has ended; without a record if there is a reason.
    pub fn end(self, failed: Option<&str>) {
        match failed {
            Some(why) => drop(self.folder.write(&self.name, why.as_bytes())),
            None => self.remove(),
        }
    }
}

impl Store {
    /// The store in a folder, which is made if it does not exist.
    ///
    /// # Errors
    /// If the folder cannot be made or written to.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        Ok(Self { folder: OutputFolder::create(path)? })
    }

    /// The store in a folder that is read, and need not be writable.
    pub fn to_read(path: &Path) -> Self {
        Self { folder: OutputFolder::unchecked(path) }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The name of the record of a run.
    pub fn name(spec: &RunSpec) -> String {
        let who = if spec.submission.is_some() { SUBMITTED } else { "" };
        format!("{who}{}-{}-{}.json", spec.case, spec.variant, spec.key())
    }

    /// The records of runs that other codes made of a case, sorted by file name; a file that cannot be read
    /// as one is an error in its place.
    pub fn submissions(&self, case: &str) -> Vec<Result<Record, FileError>> {
        let begin = format!("{SUBMITTED}{case}-");
        let of_its_name = |path: PathBuf| {
            let mut record = read(path.clone())?;
            record.numerics.remove(SESSION); // of the records that the program contains alone
            let expected = Self::name(&record.spec());
            if path.ends_with(&expected) {
                return Ok(record);
            }
            // A copy would count twice.
            let what = format!("its content belongs to {expected}");
            let reason = io::Error::new(io::ErrorKind::InvalidData, what);
            Err(FileError::Unread { path, reason })
        };
        let paths = paths(self.path(), &begin).unwrap_or_default();
        paths.into_iter().map(of_its_name).collect()
    }

    /// The record of a run, if there is one. An interrupted record, or one with fewer measurements than
    /// the run asks for, does not count: the run will be made again.
    ///
    /// # Errors
    /// If a file in its place cannot be read as a record.
    pub fn find(&self, spec: &RunSpec) -> Result<Option<Record>, FileError> {
        let record = match read(self.path().join(Self::name(spec))) {
            Err(FileError::Unread { reason, .. }) if reason.kind() == io::ErrorKind::NotFound => {
                return Ok(None);
            }
            read => read?,
        };
        let is_of_run = record.spec() == RunSpec { measure: <_>::default(), ..spec.clone() };
        let is_whole = !matches!(record.status, Status::Interrupted { .. });
        let serves = is_of_run && is_whole && record.measured() >= spec.measure;
        Ok(serves.then_some(record))
    }

    /// Writes a record and replaces an older one of the same run.
    ///
    /// # Errors
    /// If the file cannot be written, or a document cannot hold the record.
    pub fn write(&self, record: &Record) -> Result<PathBuf, FileError> {
        let name = Self::name(&record.spec());
        let path = self.path().join(&name);
        let refused = |reason| FileError::File { path, reason: io::Error::other(reason) };
        self.folder.write(&name, record.to_json().map_err(refused)?.as_bytes())
    }

    /// Marks a run as under way.
    pub fn begin(&self, spec: &RunSpec) -> RunLease<'_> {
        let name = format!("{BEGUN}{}", Self::name(spec));
        let begun = RunLease { folder: &self.folder, name, last: Mutex::new(Instant::now()) };
        begun.sign();
        begun
    }

    /// Why there is no record of a run.
    pub fn pending(&self, spec: &RunSpec) -> Pending {
        let path = self.path().join(format!("{BEGUN}{}", Self::name(spec)));
        let found = path.symlink_metadata().ok().filter(|found| found.is_file());
        let text = found.as_ref().and_then(|_| files::read_text(&path, MOST_REASON).ok());
        let (Some(found), Some(text)) = (found, text) else { return Pending::Missing };
        // The clock of another machine may be ahead a little.
        let age =
            found.modified().map(|time| time.elapsed().unwrap_or_else(|ahead| ahead.duration()));
        match age {
            // In one line: it could look like other lines of the list that it is shown in.
            _ if !text.is_empty() => {
                Pending::Failed(text.split_whitespace().collect::<Vec<_>>().join(" "))
            }
            Ok(age) if age < DEAD_AFTER => Pending::Running,
            _ => Pending::Stopped,
        }
    }

    /// Every record of the folder, sorted by file name.
    ///
    /// # Errors
    /// If the folder or a file of it cannot be read, or a `.json` file is not a record.
    pub fn all(path: &Path) -> Result<Vec<Record>, FileError> {
        let refused = |reason| FileError::Unread { path: path.to_path_buf(), reason };
        paths(path, "").map_err(refused)?.into_iter().map(read).collect()
    }

    /// All records of a folder, with an error for each file that is not a record; empty if the folder cannot
    /// be read.
    pub fn each(path: &Path) -> impl Iterator<Item = Result<Record, FileError>> {
        paths(path, "").unwrap_or_default().into_iter().map(read)
    }
}

/// The files of records in a folder with names that start with `begin`, sorted. Unfinished files of a killed
/// process are not included: their names start with a dot.
fn paths(folder: &Path, begin: &str) -> io::Result<Vec<PathBuf>> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder)?.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(begin) && name.ends_with(".json") && !name.starts_with('.')
    });
    paths.sort();
    Ok(paths)
}

fn read(path: PathBuf) -> Result<Record, FileError> {
    let text = files::read_text(&path, MOST_BYTES);
    let record = text.and_then(|text| Record::from_json(&text).map_err(io::Error::other));
    record.map_err(|reason| FileError::Unread { path, reason })
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use std::time::SystemTime;
    use touchstone_base::mutation::{Constant, Detect, Mutation};
    use touchstone_base::record::MetricKey;

    use super::*;

    fn record(status: Status) -> Record {
        let mut record = Record::new("c", "v", json!({"rows": 20}), 1);
        record.manifest.sources = "abc".into();
        Record { status, ..record }
    }

    #[test]
    fn a_record_comes_back_and_that_of_another_run_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("records")).unwrap();
        let whole = record(Status::Completed);
        assert_eq!(store.find(&whole.spec()).unwrap(), None);
        store.write(&whole).unwrap();
        assert_eq!(store.find(&whole.spec()).unwrap().as_ref(), Some(&whole));
        let finer = whole.spec().with_setting("rows", 40);
        assert_eq!(store.find(&finer).unwrap(), None);
        let path = store.path().join(Store::name(&whole.spec()));
        let of = Constant::Viscosity;
        // A mutated run that was taken for a healthy one passed.
        let others = [
            finer,
            RunSpec { variant: "w".into(), ..whole.spec() },
            whole.spec().allow_unstable(),
            whole.spec().keep_particles(),
            whole.spec().mutated(Mutation { of, factor: 1.03 }),
            whole.spec().detect(Detect { of, only_allowed: false }),
        ];
        for other in others {
            let in_its_place = store.path().join(Store::name(&other));
            fs::copy(&path, &in_its_place).unwrap();
            assert_eq!(store.find(&other).unwrap(), None, "the record of another run");
            fs::remove_file(in_its_place).unwrap();
        }
        assert_eq!(Store::all(store.path()).unwrap(), [whole]);
    }

    /// A record with more metrics than requested serves; one with fewer is made again.
    #[test]
    fn a_record_serves_whoever_asks_for_no_more_than_was_measured() {
        const GAP: MetricKey = MetricKey::new("gap", "-", "E(t) - E(0)");
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let (mut all, mut headline) = (record(Status::Completed), record(Status::Completed));
        all.put(GAP, 0.0);
        headline.leave_all_out(&[GAP], &touchstone_base::absent::Absent::NotAsked);
        let spec = all.spec();
        let serves = |spec: &RunSpec| store.find(spec).unwrap().is_some();
        store.write(&all).unwrap();
        assert!(serves(&spec) && serves(&spec.clone().measure_all()));
        store.write(&headline).unwrap();
        assert!(serves(&spec) && !serves(&spec.clone().measure_all()));
    }

    /// A running run, a killed one and a failed one have different states.
    #[test]
    fn what_has_no_record_says_why() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let spec = record(Status::Completed).spec();
        assert_eq!(store.pending(&spec), Pending::Missing);
        let begun = store.begin(&spec);
        assert_eq!(store.pending(&spec), Pending::Running);
        assert!(Store::all(store.path()).unwrap().is_empty(), "it is no record");
        let now = SystemTime::now();
        for time in [now - 2 * DEAD_AFTER, now + 2 * DEAD_AFTER] {
            let file = File::options().write(true).open(folder.path().join(&begun.name)).unwrap();
            file.set_modified(time).unwrap();
            assert_eq!(store.pending(&spec), Pending::Stopped, "a clock was set back");
        }
        *begun.last.lock().unwrap() -= SIGN_EVERY;
        begun.beat();
        assert_eq!(store.pending(&spec), Pending::Running, "it gave a sign of life");
        begun.end(Some("the disk\n is full"));
        assert_eq!(store.pending(&spec), Pending::Failed("the disk is full".into()));
        store.begin(&spec).end(None);
        assert_eq!(store.pending(&spec), Pending::Missing);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    /// A link of that name in a store emptied the file that it led to, and a pipe was waited for.
    #[cfg(unix)]
    #[test]
    fn a_sign_of_life_is_never_written_through_a_link_or_a_pipe() {
        let above = tempfile::tempdir().unwrap();
        let store = Store::open(&above.path().join("store")).unwrap();
        let spec = record(Status::Completed).spec();
        let sign = store.path().join(format!("{BEGUN}{}", Store::name(&spec)));
        let victim = above.path().join("victim");
        let make: [&dyn Fn(); 3] = [
            &|| std::os::unix::fs::symlink(&victim, &sign).unwrap(), // to nothing at first
            &|| {
                fs::write(&victim, "precious").unwrap();
                std::os::unix::fs::symlink(&victim, &sign).unwrap();
            },
            &|| {
                assert!(std::process::Command::new("mkfifo").arg(&sign).status().unwrap().success())
            },
        ];
        for (k, make) in make.into_iter().enumerate() {
            make();
            let begun = store.begin(&spec);
            assert_eq!(store.pending(&spec), Pending::Missing, "{k}: nobody signed");
            begun.end(Some("a reason"));
            store.begin(&spec).end(None);
            assert!(sign.symlink_metadata().is_ok_and(|found| !found.is_file()), "{k}");
            assert_eq!(fs::read_to_string(&victim).unwrap_or_default(), ["", "precious"][k.min(1)]);
            fs::remove_file(&sign).unwrap();
        }
        assert!(fs::exists(&victim).unwrap());
    }

    #[test]
    fn a_store_that_is_only_read_is_not_written_to() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::to_read(&folder.path().join("records"));
        let whole = record(Status::Completed);
        assert_eq!(store.find(&whole.spec()).unwrap(), None);
        assert!(!store.path().exists());
        Store::open(store.path()).unwrap().write(&whole).unwrap();
        assert_eq!(store.find(&whole.spec()).unwrap(), Some(whole));
    }

    #[test]
    fn what_was_cut_short_or_spoiled_is_made_again() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let cut = record(Status::Interrupted { step: 1, time: 0.1 });
        store.write(&cut).unwrap();
        assert_eq!(store.find(&cut.spec()).unwrap(), None);
        let path = store.write(&record(Status::Completed)).unwrap();
        fs::write(folder.path().join(".unfinished-1-0-c.json"), "{").unwrap();
        assert_eq!(Store::all(store.path()).unwrap().len(), 1);
        fs::write(&path, "{").unwrap();
        let words = |error: FileError| error.to_string();
        assert!(words(store.find(&cut.spec()).unwrap_err()).contains("the record cannot be read"));
        assert!(words(Store::all(store.path()).unwrap_err()).contains("the record cannot be read"));
        fs::remove_file(&path).unwrap();
        fs::create_dir(&path).unwrap();
        let found = store.find(&cut.spec());
        assert!(matches!(found, Err(FileError::Unread { .. })), "{found:?}");
    }
}
