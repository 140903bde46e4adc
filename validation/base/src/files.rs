//! Output files, each either complete or absent.
//!
//! A file is written under a temporary name in its final folder, and renamed when complete. Devices, pipes,
//! links and everything else that is not a regular file are never replaced. Temporary names are random, so
//! they do not collide with names of another process or with files left by an earlier one. They are
//! registered, so that the handler of an interrupt can call [`remove_unfinished`] before the process ends.
//! Temporary files left by a killed process are removed by a later one.
//!
//! ```no_run
//! # fn main() -> Result<(), touchstone_base::files::FileError> {
//! use touchstone_base::{files::OutputFolder, record::Profile};
//! let folder = OutputFolder::create("out".as_ref())?;
//! let rows = [(2.5e-5, 1.2e-4)];
//! let profile = Profile::default()
//!     .put(&rows, "y", "m", |(y, _)| *y)
//!     .put(&rows, "u", "m/s", |(_, u)| *u);
//! folder.write("profile.csv", profile.to_csv().as_bytes())?;
//! # Ok(())
//! # }
//! ```

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, Read, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, SystemTime};

use thiserror::Error;

use crate::lock;

/// Why a file was not written.
#[derive(Debug, Error)]
pub enum FileError {
    /// The output folder does not exist and cannot be made, or cannot be written into.
    #[error("cannot write into the folder {path:?}: {reason}")]
    Folder {
        /// the folder
        path: PathBuf,
        /// error of the system
        #[source]
        reason: io::Error,
    },
    /// One file or folder could not be read.
    #[error("cannot read {path}: {reason}", path = .path.display())]
    Unread {
        /// the file or folder
        path: PathBuf,
        /// error of the system, or the fault of the content
        #[source]
        reason: io::Error,
    },
    /// One file could not be written.
    #[error("cannot write the file {path:?}: {reason}")]
    File {
        /// the file
        path: PathBuf,
        /// error of the system
        #[source]
        reason: io::Error,
    },
}

/// Temporary files that exist now.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Removes every temporary file of this process, for the handler of an interruption, just before the process
/// ends: a write that is under way on another thread then fails instead of leaving a file behind, and any
/// thread that then begins to write a file waits for the end of the process.
pub fn remove_unfinished() {
    let mut paths = lock(&UNFINISHED);
    remove_all(&mut paths);
    std::mem::forget(paths);
}

fn remove_all(paths: &mut BTreeSet<PathBuf>) -> usize {
    let removed = paths.iter().filter(|path| fs::remove_file(path).is_ok()).count();
    paths.clear();
    removed
}

/// Reads a regular file: a pipe in its place would be waited for without end.
///
/// # Errors
/// Errors of the system; or if the path is not a regular file.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    read_at_most(path, u64::MAX)
}

/// Reads up to `most` bytes of a regular file. A file may be longer than its stated size: a growing file, or
/// a file of the system with size 0.
///
/// # Errors
/// Errors of the system; or if the path is not a regular file, or the file is longer.
pub fn read_at_most(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    check_regular(path, most)?;
    bytes_of(File::open(path)?, most)
}

fn bytes_of(from: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let why = format!("it has more than {most} bytes");
        return Err(io::Error::new(io::ErrorKind::InvalidData, why));
    }
    Ok(bytes)
}

/// Reads a text of up to `most` bytes from a regular file.
///
/// # Errors
/// Errors of the system; or if the path is not a regular file, or the file is larger or not UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    check_regular(path, most)?;
    text_of(File::open(path)?, most)
}

/// Reads a text of up to `most` bytes.
///
/// # Errors
/// Errors of the system; or if there are more bytes, or they are not UTF-8.
pub fn text_of(from: impl Read, most: u64) -> io::Result<String> {
    let text = String::from_utf8(bytes_of(from, most)?);
    text.map_err(|reason| io::Error::new(io::ErrorKind::InvalidData, reason.utf8_error()))
}

/// Refuses everything but a regular file of up to `most` bytes.
///
/// # Errors
/// Errors of the system, and the refusal.
pub fn check_regular(path: &Path, most: u64) -> io::Result<()> {
    let refused = |why: String| Err(io::Error::new(io::ErrorKind::InvalidData, why));
    let file = fs::metadata(path)?;
    if !file.is_file() {
        return refused("it is not a regular file".into());
    }
    if file.len() > most {
        return refused(format!("it has {} bytes; allowed are at most {most}", file.len()));
    }
    Ok(())
}

/// Begins the name of every temporary file; random letters and digits, a hyphen and the final name follow.
const PREFIX: &str = ".unfinished-";
/// Age at which a temporary file counts as abandoned: writing a file takes seconds.
const ORPHANED_AFTER: Duration = Duration::from_secs(3600);

/// Whether this is the name of a temporary file of any version of this program.
fn is_temporary(name: &str) -> bool {
    let rest = name.strip_prefix(PREFIX).and_then(|rest| rest.split_once('-'));
    let is_random =
        |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphanumeric());
    rest.is_some_and(|(random, of)| is_random(random) && !of.is_empty())
}

/// Removes temporary files that killed processes left in a folder. Files that cannot be examined or removed
/// stay; they do no harm.
fn remove_orphans(folder: &Path) {
    let now = SystemTime::now();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_old = |file: fs::Metadata| {
            let age = file.modified().ok().and_then(|written| now.duration_since(written).ok());
            file.is_file() && age.is_some_and(|age| age > ORPHANED_AFTER)
        };
        if entry.file_name().to_str().is_some_and(is_temporary)
            && entry.metadata().is_ok_and(is_old)
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// A temporary file that goes away unless it is renamed to its final name.
struct Temporary(PathBuf);

impl Temporary {
    /// A new file in the folder of `path`. If its random name is taken, another one is tried.
    fn beside(path: &Path) -> io::Result<(Self, File)> {
        let no_name = || io::Error::new(io::ErrorKind::InvalidInput, "the path has no file name");
        let name = path.file_name().ok_or_else(no_name)?.to_string_lossy();
        loop {
            let random = RandomState::new().build_hasher().finish(); // its keys are random
            let path = path.with_file_name(format!("{PREFIX}{random:016x}-{name}"));
            let mut paths = lock(&UNFINISHED); // held, so that no interruption comes in between
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Err(reason) if reason.kind() == io::ErrorKind::AlreadyExists => {}
                opened => {
                    let file = opened?;
                    paths.insert(path.clone());
                    return Ok((Temporary(path), file));
                }
            }
        }
    }

    fn persist(self, path: &Path) -> io::Result<()> {
        fs::rename(&self.0, path)?;
        lock(&UNFINISHED).remove(&self.0);
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let mut paths = lock(&UNFINISHED);
        if paths.contains(&self.0) {
            let _ = fs::remove_file(&self.0);
            paths.remove(&self.0);
        }
    }
}

/// Writes a file so that `path` holds either its old content or all of `bytes`, at any moment.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let (temporary, mut file) = Temporary::beside(path)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    temporary.persist(path)?;
    if let Some(Ok(folder)) = path.parent().map(File::open) {
        let _ = folder.sync_all(); // makes the rename last; not every system can
    }
    Ok(())
}

/// Writes a file that the user named, so that it holds either its old content or all of `bytes`, at any
/// moment. A link is followed to the file that it leads to. A device or a pipe is written into: a file in its
/// place would take it from every other program.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let write = || match fs::metadata(path) {
        Err(_) if path.is_symlink() => Err(io::Error::other("it is a link that leads nowhere")),
        Err(_) => replace(path, bytes),
        Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if found.is_file() && is_opened(path) => {
            Err(io::Error::other("it leads to a file that is open already; name that file"))
        }
        Ok(found) if found.is_file() => replace(&fs::canonicalize(path)?, bytes),
        Ok(found) => write_into(path, &found, bytes),
    };
    write().map_err(|reason| FileError::File { path: path.into(), reason })
}

/// Whether the path is an open file of a process, as `/dev/stdout` is. Two writers of one file behind it
/// would overwrite each other.
fn is_opened(path: &Path) -> bool {
    let mut path = path.to_path_buf();
    while let Ok(target) = fs::read_link(&path) {
        let above = path.parent().filter(|above| !above.as_os_str().is_empty());
        let Ok(above) = fs::canonicalize(above.unwrap_or(Path::new("."))) else { return false };
        if above.starts_with("/proc") {
            return true;
        }
        path = above.join(target); // not in a circle, because the path leads to something
    }
    false
}

/// Writes to the end of a pipe, a device or another file that is not regular.
fn write_into(path: &Path, found: &fs::Metadata, bytes: &[u8]) -> io::Result<()> {
    let _listening = read_by_somebody(path, found)?;
    OpenOptions::new().append(true).open(path)?.write_all(bytes)
}

/// Opens a pipe if it has a reader: opening a pipe without a reader would wait for ever.
#[cfg(unix)]
fn read_by_somebody(path: &Path, found: &fs::Metadata) -> io::Result<Option<File>> {
    use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
    /// `O_NONBLOCK`: to open a pipe without a reader is then an error.
    const AT_ONCE: i32 = if cfg!(target_os = "linux") { 0o4000 } else { 4 };
    if !found.file_type().is_fifo() {
        return Ok(None);
    }
    let opened = OpenOptions::new().append(true).custom_flags(AT_ONCE).open(path);
    let unread = |_| io::Error::other("it is a pipe that nobody reads");
    opened.map(Some).map_err(unread)
}

#[cfg(not(unix))]
fn read_by_somebody(_: &Path, _: &fs::Metadata) -> io::Result<Option<File>> {
    Ok(None)
}

/// Refuses to replace anything but a regular file: a link inside an output folder leads out of it.
fn check_replaceable(path: &Path) -> io::Result<()> {
    match path.symlink_metadata() {
        Ok(found) if !(found.is_file() || found.is_dir()) => {
            let kind = if found.is_symlink() { "a link" } else { "no regular file" };
            Err(io::Error::other(format!("there is {kind} of this name; remove it")))
        }
        _ => Ok(()),
    }
}

/// Writes a probe into a folder, which is removed again.
fn probe(folder: &Path) -> io::Result<()> {
    let (_removed_on_return, mut file) = Temporary::beside(&folder.join("probe"))?;
    file.write_all(b"touchstone")?;
    file.sync_all()
}

/// A folder to write into, as a rule found writable before the first result was computed.
#[derive(Debug, Clone)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Makes the folder if necessary, writes a probe into it and removes the probe and files left by killed
    /// processes.
    pub fn create(path: &Path) -> Result<Self, FileError> {
        fs::create_dir_all(path)
            .and_then(|()| probe(path))
            .map_err(|reason| FileError::Folder { path: path.into(), reason })?;
        remove_orphans(path);
        Ok(Self::unchecked(path))
    }

    /// As [`OutputFolder::create`], of a folder inside another one, from which a link would lead out.
    pub fn create_inside(path: &Path) -> Result<Self, FileError> {
        check_replaceable(path)
            .map_err(|reason| FileError::Folder { path: path.into(), reason })?;
        Self::create(path)
    }

    /// The folder at a path, without a look at it.
    pub fn unchecked(path: &Path) -> Self {
        OutputFolder { path: path.into() }
    }

    /// Tests whether [`OutputFolder::create`] would succeed, without making the folder: if there is none, its
    /// nearest parent must be writable.
    pub fn check(path: &Path) -> Result<(), FileError> {
        // The folder above a relative path is the empty path, which is the current folder.
        let exists = |path: &&Path| path.as_os_str().is_empty() || path.symlink_metadata().is_ok();
        let nearest = path.ancestors().find(exists).unwrap_or(path);
        probe(nearest).map_err(|reason| FileError::Folder { path: path.into(), reason })
    }

    /// Where the folder is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes one file atomically; `name` may contain folders below this one, and cannot lead out of it. No
    /// link, device or pipe is followed or replaced.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, FileError> {
        let path = self.path.join(name);
        if !Path::new(name).components().all(|part| matches!(part, Component::Normal(_))) {
            let reason =
                io::Error::new(io::ErrorKind::InvalidInput, "its name leads out of its folder");
            return Err(FileError::File { path, reason });
        }
        let mut inside = self.path.clone();
        for part in Path::new(name).components() {
            inside.push(part);
            check_replaceable(&inside)
                .map_err(|reason| FileError::File { path: inside.clone(), reason })?;
        }
        if let Some(parent) = path.parent() {
            let refused = |reason| FileError::Folder { path: parent.into(), reason };
            fs::create_dir_all(parent).map_err(refused)?;
        }
        replace(&path, bytes).map_err(|reason| FileError::File { path: path.clone(), reason })?;
        Ok(path)
    }
}

/// Tests that write files share the registry of temporary files, so they take turns.
#[cfg(test)]
fn turn() -> std::sync::MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    lock(&TURN)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string();
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| name(entry).unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_whole_and_nothing_is_left_beside_it() {
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        write_atomically(&path, b"old").unwrap();
        write_atomically(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["record.json"]);
        assert!(lock(&UNFINISHED).is_empty());
    }

    /// Written in place, a file is half there for a while, and a reader of the old one loses the rest of it.
    #[cfg(unix)]
    #[test]
    fn a_reader_of_the_old_file_reads_all_of_it_while_it_is_replaced() {
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        let [old, new] = [b'o', b'n'].map(|byte| vec![byte; 1 << 22]);
        fs::write(&path, &old).unwrap();
        let mut reader = File::open(&path).unwrap();
        let mut read = vec![0; 1 << 10];
        reader.read_exact(&mut read).unwrap();
        let is_written = std::sync::atomic::AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                write_atomically(&path, &new).unwrap();
                is_written.store(true, std::sync::atomic::Ordering::Relaxed);
            });
            while !is_written.load(std::sync::atomic::Ordering::Relaxed) {
                let found = fs::read(&path).unwrap();
                assert!(found == old || found == new, "{} bytes are half a file", found.len());
            }
        });
        reader.read_to_end(&mut read).unwrap();
        assert!(read == old, "the old file was changed while it was read");
        assert!(fs::read(&path).unwrap() == new && names(folder.path()) == ["record.json"]);
    }

    #[test]
    fn a_name_that_leads_out_of_the_folder_is_refused() {
        let _turn = turn();
        let above = tempfile::tempdir().unwrap();
        let folder = OutputFolder::create(&above.path().join("below")).unwrap();
        folder.write("deeper/file", b"x").unwrap();
        for name in ["../evil", "deeper/../../evil", "/tmp/evil", "x/../../../EVIL", ".", ""] {
            let error = folder.write(name, b"x").expect_err(name).to_string();
            assert!(
                error.contains("leads out of its folder") || name.is_empty(),
                "{name:?}: {error}"
            );
        }
        assert_eq!(names(above.path()), ["below"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_a_folder_or_a_large_file_is_refused_without_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        let refused = |path: &Path| read_text(path, 4).expect_err("no text of 4 bytes").to_string();
        assert!(refused(&path).contains("not a regular file"), "{}", refused(&path));
        assert!(
            refused(folder.path()).contains("not a regular file"),
            "{}",
            refused(folder.path())
        );
        let text = folder.path().join("text");
        fs::write(&text, "four").unwrap();
        assert_eq!(read_text(&text, 4).unwrap(), "four");
        fs::write(&text, "fiver").unwrap();
        assert!(refused(&text).contains("5 bytes; allowed are at most 4"), "{}", refused(&text));
    }

    /// As root, `--junit /dev/stdout` took the device from every program of a container.
    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_pipes_are_written_into() {
        use std::os::unix::fs::{FileTypeExt, symlink};
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        let [target, link, lost, pipe] =
            ["target", "link", "lost", "pipe"].map(|name| folder.path().join(name));
        fs::write(&target, "old").unwrap();
        symlink("target", &link).unwrap();
        write_atomically(&link, b"new").unwrap();
        assert!(link.is_symlink() && fs::read(&target).unwrap() == b"new");
        symlink("nothing", &lost).unwrap();
        let error = write_atomically(&lost, b"new").unwrap_err().to_string();
        assert!(error.contains("a link that leads nowhere"), "{error}");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let error = write_atomically(&pipe, b"new").unwrap_err().to_string();
        assert!(error.contains("a pipe that nobody reads"), "{error}");
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap()
        });
        let opened = File::open(&target).unwrap();
        let number = std::os::fd::AsRawFd::as_raw_fd(&opened);
        let error =
            write_atomically(format!("/dev/fd/{number}").as_ref(), b"x").unwrap_err().to_string();
        assert!(error.contains("open already") || cfg!(not(target_os = "linux")), "{error}");
        let many = vec![b'x'; 1 << 20]; // more than a pipe holds
        while write_atomically(&pipe, &many).is_err() {
            std::thread::yield_now(); // until the reader has opened it
        }
        assert!(reader.join().unwrap() == many);
        assert!(pipe.symlink_metadata().unwrap().file_type().is_fifo());
        assert_eq!(names(folder.path()), ["link", "lost", "pipe", "target"]);
    }

    /// In a folder, such as a store that was unpacked from an archive, a link led to any file of the user.
    #[cfg(unix)]
    #[test]
    fn inside_a_folder_nothing_but_regular_files_is_written() {
        use std::os::unix::fs::symlink;
        let _turn = turn();
        let above = tempfile::tempdir().unwrap();
        fs::write(above.path().join("precious"), "mine").unwrap();
        fs::create_dir(above.path().join("other")).unwrap();
        let folder = OutputFolder::create(&above.path().join("folder")).unwrap();
        let inside = |name: &str| folder.path().join(name);
        symlink("../precious", inside("link")).unwrap();
        symlink("../new", inside("lost")).unwrap();
        symlink("../other", inside("figures")).unwrap();
        assert!(
            std::process::Command::new("mkfifo").arg(inside("pipe")).status().unwrap().success()
        );
        for name in ["link", "lost", "figures", "figures/a.png", "pipe"] {
            let error = folder.write(name, b"x").expect_err(name).to_string();
            assert!(error.contains("of this name; remove it"), "{name}: {error}");
        }
        assert!(OutputFolder::create_inside(&inside("figures")).is_err());
        assert_eq!(names(folder.path()), ["figures", "link", "lost", "pipe"]);
        assert_eq!(names(above.path()), ["folder", "other", "precious"]);
        assert_eq!(fs::read(above.path().join("precious")).unwrap(), b"mine");
        assert!(names(&above.path().join("other")).is_empty());
    }

    #[test]
    fn a_failed_write_names_the_path_and_leaves_nothing() {
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        let occupied = folder.path().join("occupied");
        fs::create_dir(&occupied).unwrap();
        fs::write(occupied.join("child"), b"").unwrap();
        let error = write_atomically(&occupied, b"bytes").unwrap_err().to_string();
        assert!(
            error.starts_with("cannot write the file") && error.contains("occupied"),
            "{error}"
        );
        assert_eq!(names(folder.path()), ["occupied"]);
        assert!(write_atomically(&folder.path().join("no/such/folder"), b"").is_err());
        assert!(write_atomically(Path::new("/"), b"").is_err());
        assert!(lock(&UNFINISHED).is_empty());
    }

    /// Process ids repeat, in containers always: a file left by a killed process blocks no later process,
    /// whatever their ids and counts.
    #[test]
    fn a_temporary_file_left_behind_does_not_block_its_folder() {
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        let left_behind: Vec<String> = (0..100)
            .map(|k| format!(".unfinished-{}-{k}-record.json", std::process::id()))
            .collect();
        for name in &left_behind {
            fs::write(folder.path().join(name), b"half a rec").unwrap();
        }
        let output = OutputFolder::create(folder.path()).unwrap();
        let path = output.write("record.json", b"whole").unwrap();
        assert_eq!(fs::read(path).unwrap(), b"whole");
        assert_eq!(names(folder.path()).len(), left_behind.len() + 1, "they may be of others");
    }

    #[test]
    fn what_killed_processes_left_behind_is_removed_after_an_hour_and_nothing_else() {
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        let minutes_ago = |count: u64| SystemTime::now() - Duration::from_secs(60 * count);
        let long_ago = minutes_ago(70);
        let make = |name: &str, time: SystemTime| {
            let file = File::create(folder.path().join(name)).unwrap();
            file.set_modified(time).unwrap();
        };
        make(".unfinished-1-0-record.json", long_ago); // as earlier versions named them
        make(".unfinished-a8Zk29xYb01q-dam-break.json", long_ago);
        make(".unfinished-a8Zk29xYb01r-series.csv", minutes_ago(50));
        let foreign = [".unfinished-", ".unfinished-notes.txt", ".unfinished-a.b-c", "record.json"];
        for name in foreign {
            make(name, long_ago);
        }
        fs::create_dir(folder.path().join(".unfinished-1-folder")).unwrap();
        OutputFolder::create(folder.path()).unwrap();
        let mut expected = foreign.to_vec();
        expected.extend([".unfinished-1-folder", ".unfinished-a8Zk29xYb01r-series.csv"]);
        expected.sort();
        assert_eq!(names(folder.path()), expected);
    }

    #[test]
    fn a_check_makes_no_folder() {
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        OutputFolder::check(&folder.path().join("a/b/c")).unwrap();
        OutputFolder::check(folder.path()).unwrap();
        assert!(names(folder.path()).is_empty());
        fs::write(folder.path().join("file"), b"in the way").unwrap();
        for path in ["file", "file/below/it"] {
            let error = OutputFolder::check(&folder.path().join(path)).unwrap_err();
            assert!(matches!(error, FileError::Folder { .. }), "{error}");
        }
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[test]
    fn an_interruption_removes_what_is_unfinished() {
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        let (temporary, mut file) = Temporary::beside(&path).unwrap();
        file.write_all(b"half a ro").unwrap();
        assert_eq!(names(folder.path()).len(), 1);
        assert_eq!(remove_all(&mut lock(&UNFINISHED)), 1);
        assert!(names(folder.path()).is_empty());
        assert!(temporary.persist(&path).is_err(), "a write under way cannot finish");
        assert!(names(folder.path()).is_empty());
        assert_eq!(remove_all(&mut lock(&UNFINISHED)), 0);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_refused_early() {
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, b"in the way").unwrap();
        let error = OutputFolder::create(&file).unwrap_err().to_string();
        assert!(error.starts_with("cannot write into the folder") && error.contains("file"));
        let error = OutputFolder::create(&file.join("below")).unwrap_err();
        assert!(matches!(error, FileError::Folder { .. }), "{error}");

        let output = OutputFolder::create(&folder.path().join("a/b")).unwrap();
        assert!(names(output.path()).is_empty(), "the probe is gone");
        let written = output.write("vtk/step.vtp", b"<x/>").unwrap();
        assert_eq!(fs::read(written).unwrap(), b"<x/>");
    }
}
