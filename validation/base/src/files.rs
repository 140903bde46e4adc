//! Output files: whole or absent, never half written, never with a NaN inside.
//!
//! Everything is written beside its place under a temporary name and renamed when complete.
//! The temporary names are registered, so that a handler of ctrl-c can call
//! [`remove_unfinished`] before the process ends.
//!
//! ```no_run
//! # fn main() -> Result<(), base::files::FileError> {
//! use base::files::{CsvTable, OutputFolder};
//! let folder = OutputFolder::create("out".as_ref())?;
//! let mut profile = CsvTable::new(&["t[s]", "y[m]", "u[m/s]"])?;
//! profile.numbers(&[0.1, 2.5e-5, 1.2e-4])?;
//! folder.write("profile.csv", &profile.into_bytes())?;
//! # Ok(())
//! # }
//! ```

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use thiserror::Error;

/// Why a file was not written.
#[derive(Debug, Error)]
pub enum FileError {
    /// The output folder does not exist and cannot be made, or cannot be written into.
    #[error("cannot write into the folder {path:?}: {reason}")]
    Folder {
        /// the folder
        path: PathBuf,
        /// what the system said
        #[source]
        reason: io::Error,
    },
    /// One file could not be written.
    #[error("cannot write the file {path:?}: {reason}")]
    File {
        /// the file
        path: PathBuf,
        /// what the system said
        #[source]
        reason: io::Error,
    },
    /// A table was given a NaN or an infinity.
    #[error("column {column} of row {row} is {value}, which is not finite")]
    NotFinite {
        /// header of the column
        column: String,
        /// row, counted from 0 after the header
        row: usize,
        /// `NaN`, `inf` or `-inf`
        value: String,
    },
    /// A row has not as many cells as the header.
    #[error("row {row} has {found} cells, the header has {expected}")]
    Width {
        /// row, counted from 0 after the header
        row: usize,
        /// columns of the header
        expected: usize,
        /// cells of the row
        found: usize,
    },
    /// A column header without its unit.
    #[error("the column header {column:?} lacks a unit: write it as name[unit], name[-] for none")]
    NoUnit {
        /// the header
        column: String,
    },
}

/// Temporary files that exist now.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes every temporary file of this process and says how many there were.
///
/// For the handler of an interruption, just before the process ends: a write that is under way
/// on another thread then fails instead of leaving a file behind.
pub fn remove_unfinished() -> usize {
    let mut paths = unfinished();
    let removed = paths.iter().filter(|path| fs::remove_file(path).is_ok()).count();
    paths.clear();
    removed
}

/// A temporary file that goes away unless it is renamed to its final name.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// A new file beside `path`, with a name that no other thread or process uses.
    fn beside(path: &Path) -> io::Result<(Self, File)> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let no_name = || io::Error::new(io::ErrorKind::InvalidInput, "the path has no file name");
        let name = path.file_name().ok_or_else(no_name)?.to_string_lossy();
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        // The end of the name stays: some writers choose the format by it.
        let path = path.with_file_name(format!(".unfinished-{}-{count}-{name}", process::id()));
        let mut paths = unfinished(); // held, so that no interruption comes in between
        let file = OpenOptions::new().write(true).create_new(true).open(&path)?;
        paths.insert(path.clone());
        Ok((Temporary { path }, file))
    }

    fn rename(self, path: &Path) -> io::Result<()> {
        fs::rename(&self.path, path)
    }
}

impl Drop for Temporary {
    /// Removes the file if it was not renamed: then there is nothing to remove.
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
        unfinished().remove(&self.path);
    }
}

/// Writes a file so that `path` holds either its old content or all of `bytes`, at any moment.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let write = || -> io::Result<()> {
        let (temporary, mut file) = Temporary::beside(path)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        temporary.rename(path)?;
        if let Some(Ok(folder)) = path.parent().map(File::open) {
            let _ = folder.sync_all(); // makes the rename last; not every system can
        }
        Ok(())
    };
    write().map_err(|reason| FileError::File { path: path.into(), reason })
}

/// Lets `write` fill a temporary file by its name, which then becomes `path`: for writers that open
/// files themselves.
pub fn write_atomically_by<E: Into<io::Error>>(
    path: &Path,
    write: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<(), FileError> {
    let written = || -> io::Result<()> {
        let (temporary, file) = Temporary::beside(path)?;
        drop(file);
        write(&temporary.path).map_err(E::into)?;
        File::open(&temporary.path)?.sync_all()?;
        temporary.rename(path)
    };
    written().map_err(|reason| FileError::File { path: path.into(), reason })
}

/// A folder that was found writable before the first result was computed.
#[derive(Debug, Clone)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Makes the folder if need be and writes a probe into it, which is removed again.
    pub fn create(path: &Path) -> Result<Self, FileError> {
        let probe = || -> io::Result<()> {
            fs::create_dir_all(path)?;
            let (_removed_on_return, mut file) = Temporary::beside(&path.join("probe"))?;
            file.write_all(b"touchstone")?;
            file.sync_all()
        };
        probe().map_err(|reason| FileError::Folder { path: path.into(), reason })?;
        Ok(OutputFolder { path: path.into() })
    }

    /// Where the folder is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes one file atomically; `name` may contain folders below this one.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, FileError> {
        let path = self.path.join(name);
        if let Some(parent) = path.parent() {
            let refused = |reason| FileError::Folder { path: parent.into(), reason };
            fs::create_dir_all(parent).map_err(refused)?;
        }
        write_atomically(&path, bytes)?;
        Ok(path)
    }
}

/// One cell of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// written as the shortest text that reads back to the same bits
    Number(f64),
    /// written as it is, quoted if need be
    Text(String),
    /// not measured
    Empty,
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Cell::Number(number)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.into())
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Cell::Empty, Cell::Number)
    }
}

/// A CSV table under a header with units; refuses NaN and infinity.
#[derive(Debug)]
pub struct CsvTable {
    columns: Vec<String>,
    rows: usize,
    writer: csv::Writer<Vec<u8>>,
}

impl CsvTable {
    /// A table with its header row, each column as `name[unit]`.
    pub fn new(columns: &[&str]) -> Result<Self, FileError> {
        let lacks_unit = |column: &&&str| !(column.contains('[') && column.ends_with(']'));
        if let Some(column) = columns.iter().find(lacks_unit) {
            return Err(FileError::NoUnit { column: (*column).into() });
        }
        let mut table = CsvTable {
            columns: columns.iter().map(|column| (*column).into()).collect(),
            rows: 0,
            writer: csv::Writer::from_writer(Vec::new()),
        };
        table.write(columns);
        Ok(table)
    }

    /// Adds a row of numbers.
    pub fn numbers(&mut self, row: &[f64]) -> Result<(), FileError> {
        self.cells(&row.iter().copied().map(Cell::Number).collect::<Vec<_>>())
    }

    /// Adds a row of numbers, texts and gaps; on error the table stays as it was.
    pub fn cells(&mut self, row: &[Cell]) -> Result<(), FileError> {
        if row.len() != self.columns.len() {
            let (expected, found) = (self.columns.len(), row.len());
            return Err(FileError::Width { row: self.rows, expected, found });
        }
        let texts = row.iter().zip(&self.columns).map(|(cell, column)| match cell {
            Cell::Number(value) if value.is_finite() => Ok(format!("{value:?}")),
            Cell::Number(value) => Err(FileError::NotFinite {
                column: column.clone(),
                row: self.rows,
                value: value.to_string(),
            }),
            Cell::Text(text) => Ok(text.clone()),
            Cell::Empty => Ok(String::new()),
        });
        let texts = texts.collect::<Result<Vec<_>, _>>()?;
        self.write(&texts);
        self.rows += 1;
        Ok(())
    }

    /// The whole table, lines ended by `\n`.
    pub fn into_bytes(self) -> Vec<u8> {
        self.writer.into_inner().expect("writing into memory cannot fail")
    }

    fn write(&mut self, cells: &[impl AsRef<[u8]>]) {
        self.writer.write_record(cells).expect("writing rows of one width into memory cannot fail");
    }
}

/// Tests that write files share the registry of temporary files, so they take turns.
#[cfg(test)]
fn turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
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
        assert!(unfinished().is_empty());
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
        assert!(unfinished().is_empty());
    }

    #[test]
    fn an_interruption_removes_what_is_unfinished() {
        let _turn = turn();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        let (temporary, mut file) = Temporary::beside(&path).unwrap();
        file.write_all(b"half a ro").unwrap();
        assert_eq!(names(folder.path()).len(), 1);
        assert_eq!(remove_unfinished(), 1);
        assert!(names(folder.path()).is_empty());
        assert!(temporary.rename(&path).is_err(), "a write under way cannot finish");
        assert!(names(folder.path()).is_empty());
        assert_eq!(remove_unfinished(), 0);
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

    #[test]
    fn a_table_has_units_and_keeps_every_bit() {
        let mut table = CsvTable::new(&["t[s]", "u[m/s]", "code[-]"]).unwrap();
        table.cells(&[0.1.into(), 1e-300.into(), "SPH, plain".into()]).unwrap();
        table.cells(&[(0.1 + 0.2).into(), None.into(), "".into()]).unwrap();
        let text = String::from_utf8(table.into_bytes()).unwrap();
        let expected = "t[s],u[m/s],code[-]\n0.1,1e-300,\"SPH, plain\"\n0.30000000000000004,,\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn a_table_refuses_nan_gaps_in_width_and_missing_units() {
        let mut table = CsvTable::new(&["t[s]", "u[m/s]"]).unwrap();
        table.numbers(&[0.0, 1.0]).unwrap();
        for (value, text) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (-f64::INFINITY, "-inf")] {
            let error = table.numbers(&[0.1, value]).unwrap_err().to_string();
            assert_eq!(error, format!("column u[m/s] of row 1 is {text}, which is not finite"));
        }
        let error = table.numbers(&[0.1]).unwrap_err().to_string();
        assert_eq!(error, "row 1 has 1 cells, the header has 2");
        assert_eq!(table.into_bytes(), b"t[s],u[m/s]\n0.0,1.0\n");
        assert!(matches!(CsvTable::new(&["t[s]", "u"]), Err(FileError::NoUnit { .. })));
    }
}
