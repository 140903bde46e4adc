//! Reads particles at times from the formats of other codes. Each reader gives tables with the same columns,
//! from which frames are made; a flaw says what is wrong, and where.

#[cfg(any(feature = "npz", feature = "vtk"))]
mod binary;
pub mod curve;
mod dump;
#[cfg(feature = "hdf5")]
mod hdf5;
#[cfg(feature = "npz")]
mod npz;
mod table;
#[cfg(feature = "vtk")]
mod vtk;

use std::collections::BTreeMap;
use std::path::Path;

use base::files;
use harness::{
    outline::role,
    playback::{Frame, Own, Placed},
};
use nalgebra::Vector2;
use solver::Role;

use crate::flaw::Flaw;

/// More than this is no result of a run of a laptop \[bytes\].
pub const MOST_BYTES: u64 = 1 << 28;
/// More rows than these would not fit into the memory of a laptop.
const MOST_ROWS: usize = 3_000_000;

/// Flaws that are told of one file.
const MOST_FLAWS: usize = 20;

/// A column: name, unit, and whether results may lack it.
pub type Head = (&'static str, &'static str, bool);

/// The columns of results.
pub const COLUMNS: [Head; 9] = [
    ("t", "s", false),
    ("id", "-", false),
    ("x", "m", false),
    ("y", "m", false),
    ("u", "m/s", false),
    ("v", "m/s", false),
    ("density", "kg/m^3", true),
    ("mass", "kg/m", true),
    ("role", "-", true),
];

/// Name of the table of results.
pub const RESULTS: &str = "results.csv";

/// New names of columns: ours by theirs.
pub type Renamed = BTreeMap<String, String>;

/// Rows of one file, column by column.
pub struct Rows {
    file: String,
    /// Line of the first row.
    first_line: u64,
    /// Names, such as those of [`COLUMNS`], and values, all of one length.
    columns: Vec<(&'static str, Vec<f64>)>,
}

/// Particles at times as they were read.
#[derive(Debug, Default)]
pub struct Results {
    /// Frames, ascending in time.
    pub frames: Vec<Frame>,
    /// The particles of the first frame: of fluid where files have no role, and NaN where they have no mass.
    pub own: Vec<Own>,
    /// The file of each frame, and the line of its first row where it has lines.
    pub places: Vec<(String, u64)>,
}

/// Endings of files with results, beside the table.
const ENDINGS: [&str; 6] = ["dump", "npz", "vtu", "vtp", "h5", "hdf5"];

/// Reads all results of a folder: `results.csv`, or files with one of the other endings in the order of
/// their names.
///
/// # Errors
/// Every flaw that was found, at least one.
pub fn read(folder: &Path, renamed: &Renamed) -> Result<Results, Vec<Flaw>> {
    let mut names = Vec::new();
    let refused = |what: String| vec![Flaw::of(folder.display().to_string(), what)];
    let entries = std::fs::read_dir(folder);
    let entries = entries.map_err(|reason| refused(format!("cannot be read: {reason}")))?;
    for entry in entries.flatten() {
        names.extend(entry.file_name().into_string().ok().filter(|name| is_of_results(name)));
    }
    names.sort_by_key(|name| (number_in(name), name.clone()));
    if names.is_empty() {
        let endings = ENDINGS.join(", *.");
        return Err(refused(format!("there are no results; expected {RESULTS} or *.{endings}")));
    }
    let mut kinds: Vec<&str> = names.iter().map(|name| ending(name)).collect();
    kinds.dedup();
    if kinds.len() > 1 {
        let what = format!("results in several formats ({}); leave one", kinds.join(", "));
        return Err(refused(what));
    }
    let (mut all, mut flaws) = (Vec::new(), Vec::new());
    for name in names {
        match rows(folder, &name, renamed) {
            Ok(rows) => all.extend(rows),
            Err(of_file) => flaws.extend(of_file),
        }
        if flaws.len() >= MOST_FLAWS || all.iter().map(Rows::len).sum::<usize>() > MOST_ROWS {
            flaws.extend(all.last().filter(|_| flaws.is_empty()).map(|of| too_many(&of.file)));
            return Err(flaws);
        }
    }
    if flaws.is_empty() { frames(&all) } else { Err(flaws) }
}

fn too_many(file: &str) -> Flaw {
    Flaw::of(
        file,
        format!("there are more than {MOST_ROWS} rows; expected fewer particles or times"),
    )
}

fn ending(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(_, ending)| ending)
}

fn is_of_results(name: &str) -> bool {
    name == RESULTS || ENDINGS.contains(&ending(name))
}

/// The last number in a name, so that frame 10 comes after frame 9.
fn number_in(name: &str) -> u64 {
    let digits = name.rsplit(|c: char| !c.is_ascii_digit()).find(|part| !part.is_empty());
    digits.and_then(|digits| digits.parse().ok()).unwrap_or(0)
}

fn rows(folder: &Path, name: &str, renamed: &Renamed) -> Result<Vec<Rows>, Vec<Flaw>> {
    let path = folder.join(name);
    let unread = |reason: std::io::Error| vec![Flaw::of(name, format!("cannot be read: {reason}"))];
    let text = || files::read_text(&path, MOST_BYTES).map_err(unread);
    match ending(name) {
        "csv" => Ok(vec![table::rows(name, &text()?, renamed, &COLUMNS)?]),
        "dump" => dump::rows(name, &text()?, renamed),
        #[cfg(feature = "vtk")]
        "vtu" | "vtp" => Ok(vec![vtk::rows(name, &text()?, renamed)?]),
        #[cfg(feature = "npz")]
        "npz" => Ok(vec![npz::rows(name, &path, renamed)?]),
        #[cfg(feature = "hdf5")]
        "h5" | "hdf5" => hdf5::rows(name, &path, renamed),
        other => {
            let what = format!("this build does not read .{other}; its feature was left out");
            Err(vec![Flaw::of(name, what)])
        }
    }
}

/// The new names, and those of names that a format is known for.
fn known_too(known: &[(&str, &str)], renamed: &Renamed) -> Renamed {
    let mut all = renamed.clone();
    for (theirs, ours) in known {
        all.entry(theirs.to_string()).or_insert_with(|| ours.to_string());
    }
    all
}

/// Where each column of ours is among these heads.
///
/// # Errors
/// Those that are missing, twice, or in another unit.
fn places(
    file: &str,
    line: u64,
    heads: &[&str],
    renamed: &Renamed,
    columns: &[Head],
) -> Result<Vec<(&'static str, usize)>, Vec<Flaw>> {
    let (mut found, mut flaws) = (Vec::<(&'static str, usize)>::new(), Vec::new());
    for (place, head) in heads.iter().enumerate() {
        let (theirs, unit) = match head.trim().split_once('[') {
            Some((name, unit)) => (name.trim(), Some(unit.trim_end().trim_end_matches(']'))),
            None => (head.trim(), None),
        };
        let ours = renamed.get(theirs).map_or(theirs, String::as_str);
        let column = columns.iter().copied().find(|(name, ..)| *name == ours);
        let Some((name, expected, _)) = column else { continue };
        if let Some(unit) = unit.filter(|unit| *unit != expected) {
            let what = format!("its unit is {unit}; expected {expected}");
            flaws.push(Flaw::of(file, what).at(line).in_column(name));
        }
        if found.iter().any(|(known, _)| *known == name) {
            flaws.push(Flaw::of(file, "it is there twice; expected once").at(line).in_column(name));
        }
        found.push((name, place));
    }
    for (name, unit, may_lack) in columns.iter().copied() {
        if !may_lack && !found.iter().any(|(known, _)| *known == name) {
            let what = format!(
                "it is missing; expected a column {name} in {unit}, or --map {name}=NAME; the columns are {}",
                heads.join(", ")
            );
            flaws.push(Flaw::of(file, what).at(line).in_column(name));
        }
    }
    if flaws.is_empty() { Ok(found) } else { Err(flaws) }
}

/// Rows of a file that holds one array a column, read where it has this place among the heads. `t` may be one
/// number for all.
#[cfg(any(feature = "hdf5", feature = "npz", feature = "vtk"))]
fn of_arrays(
    file: &str,
    heads: &[&str],
    renamed: &Renamed,
    mut array: impl FnMut(usize) -> Result<Vec<f64>, String>,
) -> Result<Rows, Vec<Flaw>> {
    let flaw = |name: &str, what: String| vec![Flaw::of(file, what).in_column(name)];
    let places = places(file, 1, heads, renamed, &COLUMNS)?;
    let mut rows = Rows::new(file, 1, &places);
    for ((name, values), (_, place)) in rows.columns.iter_mut().zip(places) {
        *values = array(place).map_err(|what| flaw(name, what))?;
    }
    let count = rows.column("x").len();
    for (name, values) in &mut rows.columns {
        if *name == "t" && values.len() == 1 {
            values.resize(count, values[0]);
        }
        if values.len() != count {
            let what = format!("it has {} numbers; expected {count}, as many as x", values.len());
            return Err(flaw(name, what));
        }
    }
    Ok(rows)
}

/// A regular file that is not too long.
#[cfg(any(feature = "hdf5", feature = "npz"))]
fn open(file: &str, path: &Path) -> Result<std::fs::File, Vec<Flaw>> {
    let opened = files::check_regular(path, MOST_BYTES).and_then(|()| std::fs::File::open(path));
    opened.map_err(|reason| vec![Flaw::of(file, reason.to_string())])
}

impl Rows {
    /// No rows yet, of a file that has these columns.
    fn new(file: &str, first_line: u64, places: &[(&'static str, usize)]) -> Self {
        let columns = places.iter().map(|(name, _)| (*name, Vec::new())).collect();
        Self { file: file.into(), first_line, columns }
    }

    /// Adds a row: of each column the number that stands at its place, with a flaw where none does.
    fn add(
        &mut self,
        line: u64,
        places: &[(&'static str, usize)],
        cells: &[&str],
        flaws: &mut Vec<Flaw>,
    ) {
        for ((name, values), (_, place)) in self.columns.iter_mut().zip(places) {
            let text = cells.get(*place).copied().unwrap_or_default();
            values.push(text.parse().unwrap_or_else(|_| {
                let what = format!("it is {text:?}; expected a number");
                flaws.push(Flaw::of(&self.file, what).at(line).in_column(*name));
                f64::NAN
            }));
        }
    }

    fn len(&self) -> usize {
        self.columns.first().map_or(0, |(_, values)| values.len())
    }

    /// The values of a column, none if it is not there.
    fn column(&self, name: &str) -> &[f64] {
        self.columns.iter().find(|(of, _)| *of == name).map_or(&[], |(_, values)| values)
    }

    /// The value of a column in row k, if the column is there; a flaw unless it is right.
    fn checked(
        &self,
        name: &str,
        k: usize,
        is_right: fn(f64) -> bool,
        expected: &str,
    ) -> Result<Option<f64>, Flaw> {
        let value = self.column(name).get(k).copied();
        match value.filter(|value| !is_right(*value)) {
            Some(wrong) => {
                let what = format!("it is {wrong}; expected {expected}");
                Err(Flaw::of(&self.file, what).at(self.first_line + k as u64).in_column(name))
            }
            None => Ok(value),
        }
    }

    fn finite(&self, name: &str, k: usize) -> Result<Option<f64>, Flaw> {
        self.checked(name, k, f64::is_finite, "a finite number")
    }

    /// Time and particle of a row, or what is wrong with it.
    fn row(&self, k: usize) -> Result<(f64, Own), Flaw> {
        let finite = |name| self.finite(name, k).map(|value| value.unwrap_or(f64::NAN));
        let is_positive = |value: f64| value.is_finite() && value > 0.0;
        let positive = |name| self.checked(name, k, is_positive, "a finite number above 0");
        let id = finite("id")?;
        let is_id = |id: f64| (0.0..=f64::from(u32::MAX)).contains(&id) && id.fract() == 0.0;
        self.checked("id", k, is_id, "a whole number, not below 0")?;
        let start = Placed {
            id: id as u32,
            position: Vector2::new(finite("x")?, finite("y")?),
            velocity: Vector2::new(finite("u")?, finite("v")?),
            density: positive("density")?,
        };
        let (time, mass) = (finite("t")?, positive("mass")?.unwrap_or(f64::NAN));
        let number = self.checked("role", k, |value| role(value).is_some(), "0, 1 or 2")?;
        let role = number.and_then(role).unwrap_or(Role::Fluid);
        Ok((time, Own { role, mass, start }))
    }
}

/// Frames of rows that are sorted by time.
fn frames(all: &[Rows]) -> Result<Results, Vec<Flaw>> {
    let (mut results, mut flaws) = (Results::default(), Vec::new());
    for rows in all {
        for k in 0..rows.len() {
            if flaws.len() >= MOST_FLAWS {
                flaws.push(Flaw::of(
                    &rows.file,
                    "more flaws like these; nothing after them was read",
                ));
                return Err(flaws);
            }
            let line = rows.first_line + k as u64;
            let (time, own) = match rows.row(k) {
                Ok(row) => row,
                Err(flaw) => {
                    flaws.push(flaw);
                    continue;
                }
            };
            let last = results.frames.last().map(|frame| frame.time);
            if let Some(last) = last.filter(|last| time < *last) {
                let what = format!("it is {time}, after {last}; expected rows sorted by t");
                flaws.push(Flaw::of(&rows.file, what).at(line).in_column("t"));
                continue;
            }
            if last != Some(time) {
                results.frames.push(Frame { time, particles: Vec::new() });
                results.places.push((rows.file.clone(), line));
            }
            if results.frames.len() == 1 {
                results.own.push(own);
            }
            if let Some(frame) = results.frames.last_mut() {
                frame.particles.push(own.start);
            }
        }
    }
    if results.frames.is_empty() && flaws.is_empty() {
        let file = all.first().map_or("results", |rows| &rows.file);
        flaws.push(Flaw::of(file, "it has no rows; expected one a particle and time"));
    }
    if flaws.is_empty() { Ok(results) } else { Err(flaws) }
}
