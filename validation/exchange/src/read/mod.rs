//! Reads particles at times from the formats of other codes. Each reader returns tables with the same
//! columns, from which frames are made; a flaw states its place.

#[cfg(feature = "vtk")]
mod binary;
mod columns;
pub(crate) mod curve;
mod dump;
mod table;
#[cfg(feature = "vtk")]
mod vtk;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nalgebra::Vector2;
use touchstone_base::{
    files,
    text::{few, number, short},
};
use touchstone_harness::{
    foreign::{ForeignParticle, Frame, OwnParticle},
    outline::role,
};
use touchstone_solver::Role;

use crate::flaw::Flaw;
use columns::{MOST_SHOWN, Places, THIRD};

/// Largest result of a run of a laptop \[bytes\].
pub const MOST_BYTES: u64 = 1 << 28;
/// More rows than these would not fit into the memory of a laptop.
const MOST_ROWS: usize = 3_000_000;

/// Printed flaws of one file.
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

/// A third component that differs by no more than this share of the first two is constant.
const FLAT: f64 = 1e-6;
/// Masses that differ by no more than this share are one mass, stated with few digits.
pub const SAME_MASS: f64 = 1e-4;

/// Rows of one file, column by column.
pub struct Rows {
    file: String,
    /// Line of the first row.
    first_line: u64,
    /// The least id: 0, or 1 in files whose format begins with it.
    first_id: f64,
    /// Names, such as in [`COLUMNS`], and values, all of one length.
    columns: Vec<(&'static str, Vec<f64>)>,
    /// The columns that are not read, as the file has them.
    unread: Vec<String>,
    /// The names of the third components of place and velocity, where the file has them.
    thirds: BTreeMap<&'static str, String>,
    /// Is the id the place in the file?
    by_order: bool,
}

/// Particles at times as they were read.
#[derive(Debug, Default)]
pub struct Results {
    /// Frames, ascending in time.
    pub frames: Vec<Frame>,
    /// The particles of the first frame: of fluid where files have no role, and NaN where they have no mass.
    pub own: Vec<OwnParticle>,
    /// The file of each frame, and the line of its first row where it has lines.
    pub places: Vec<(String, u64)>,
    /// The columns that were submitted.
    pub columns: BTreeSet<&'static str>,
    /// Mass, or NaN, and role of each particle for which the files state one of them.
    pub stated: BTreeMap<u32, (f64, Option<Role>)>,
    /// The columns that were not read, as the files have them.
    pub unread: BTreeSet<String>,
    /// Are particles numbered by their place in the file, because it has no ids?
    pub by_order: bool,
}

impl Results {
    /// Sentences on parts of the files that were not used, and their replacements.
    pub fn notes(&self) -> Vec<String> {
        let unread = few(&self.unread, MOST_SHOWN);
        let unread = (!unread.is_empty()).then(|| format!("columns that are not read: {unread}"));
        let by_order = self.by_order.then(|| {
            "the files have no ids: particles are numbered by their place in the file, from 0"
                .into()
        });
        unread.into_iter().chain(by_order).collect()
    }

    /// Takes the names of the columns of a file; a flaw for each that one file has and another lacks.
    fn take_columns(&mut self, rows: &Rows, first: &str) -> Vec<Flaw> {
        self.unread.extend(rows.unread.iter().cloned());
        self.by_order |= rows.by_order;
        let columns: BTreeSet<_> = rows.columns.iter().map(|(name, _)| *name).collect();
        let columns = columns.into_iter().filter(|name| !THIRD.contains(name)).collect();
        if self.columns.is_empty() {
            self.columns = columns;
            return Vec::new();
        }
        let flaw = |name: &&'static str| {
            let has = if columns.contains(name) { "is here and not" } else { "is not here, but" };
            Flaw::of(&rows.file, format!("it {has} in {first}")).in_column(*name)
        };
        self.columns.symmetric_difference(&columns).map(flaw).collect()
    }

    /// Sets mass and role of a particle from a row; returns a flaw if they differ from earlier ones.
    fn state(&mut self, id: u32, mass: f64, role: Option<Role>) -> Option<(&'static str, String)> {
        if mass.is_nan() && role.is_none() {
            return None;
        }
        let (before, role_before) = *self.stated.entry(id).or_insert((mass, role));
        let expected = "expected one for each particle, at all times";
        if (mass - before).abs() > SAME_MASS * before {
            let [mass, before] = [mass, before].map(number);
            return Some(("mass", format!("it is {mass}, and was {before} before; {expected}")));
        }
        let is_other = role != role_before;
        is_other.then(|| ("role", format!("particle {id} had another one before; {expected}")))
    }
}

/// Extensions of result files other than tables.
const ENDINGS: [&str; 3] = ["dump", "vtu", "vtp"];
/// Extensions of files that the module of Python converts.
const CONVERTED: [&str; 6] = ["pvd", "vtk", "npz", "h5", "hdf5", "gz"];

/// Reads all results of a folder: `results.csv`, or files with one of the other endings in the order of
/// their names.
///
/// # Errors
/// Every flaw that was found, at least one.
pub fn read(folder: &Path, renamed: &Renamed) -> Result<Results, Vec<Flaw>> {
    let refused = |what: String| vec![Flaw::of(folder.display().to_string(), what)];
    let names = names(folder).map_err(|reason| refused(format!("cannot be read: {reason}")));
    let mut names = names?;
    names.sort_by_key(|name| (number_in(name), name.clone()));
    if names.is_empty() {
        let endings = ENDINGS.join(", *.");
        return Err(refused(format!(
            "there are no results{}; expected {RESULTS} or *.{endings}",
            convertible(folder)
        )));
    }
    let mut kinds: Vec<&str> = names.iter().map(|name| ending(name)).collect();
    kinds.dedup();
    if kinds.len() > 1 {
        let what = format!("results in several formats ({}); leave one", kinds.join(", "));
        return Err(refused(what));
    }
    let (mut all, mut count, mut flaws) = (Vec::new(), 0, Vec::new());
    for name in names {
        match rows(folder, &name, renamed) {
            Ok(rows) => {
                count += rows.iter().map(Rows::len).sum::<usize>();
                flaws.extend(rows.iter().flat_map(Rows::not_flat));
                flaws.extend((count > MOST_ROWS).then(|| too_many(&name)));
                all.extend(rows);
            }
            Err(of_file) => flaws.extend(of_file),
        }
        if flaws.len() >= MOST_FLAWS || count > MOST_ROWS {
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

/// The names of the files of results in a folder, in no order.
///
/// # Errors
/// If the folder cannot be read.
pub fn names(folder: &Path) -> std::io::Result<Vec<String>> {
    let names = std::fs::read_dir(folder)?.flatten();
    let names = names.filter_map(|entry| entry.file_name().into_string().ok());
    Ok(names.filter(|name| is_of_results(name)).collect())
}

/// Words on a file of another format, if there is one.
fn convertible(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let found = names.filter(|name| CONVERTED.contains(&ending(name))).min();
    found.map_or(String::new(), |name| {
        format!(
            " of a format that this program reads, but {}: convert it with touchstone_sph.convert",
            short(&name)
        )
    })
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
    let bytes = || files::read_at_most(&path, MOST_BYTES).map_err(unread);
    let text = || files::read_text(&path, MOST_BYTES).map_err(unread);
    match ending(name) {
        "csv" => Ok(vec![table::rows(name, &text()?, renamed, &COLUMNS)?]),
        "dump" => dump::rows(name, &text()?, renamed),
        #[cfg(feature = "vtk")]
        "vtu" | "vtp" => Ok(vec![vtk::rows(name, bytes()?, renamed)?]),
        other => {
            let what = format!("this build does not read .{other}; its feature was left out");
            Err(vec![Flaw::of(name, what)])
        }
    }
}

/// Rows of a file that holds one array a column, read where it has this place among the heads. `t` may be one
/// number for all.
#[cfg(feature = "vtk")]
fn of_arrays(
    file: &str,
    heads: &columns::Heads,
    mut array: impl FnMut(usize) -> Result<Vec<f64>, String>,
) -> Result<Rows, Vec<Flaw>> {
    let flaw = |name: &str, what: String| vec![Flaw::of(file, what).in_column(name)];
    let places = columns::places(file, 1, heads, &COLUMNS)?;
    let mut rows = Rows::new(file, 1, heads, &places);
    for ((name, values), (_, place)) in rows.columns.iter_mut().zip(places.of) {
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

impl Rows {
    /// No rows yet, of a file that has these columns.
    fn new(file: &str, first_line: u64, heads: &columns::Heads, places: &Places) -> Self {
        let Places { of, unread } = places;
        let columns = of.iter().map(|(name, _)| (*name, Vec::new())).collect();
        let unread = unread.iter().map(|place| short(heads.all[*place])).collect();
        let third = |(name, place): &(&'static str, usize)| (*name, short(heads.all[*place]));
        let thirds = of.iter().filter(|(name, _)| THIRD.contains(name)).map(third).collect();
        Self {
            file: file.into(),
            first_line,
            first_id: 0.0,
            columns,
            unread,
            thirds,
            by_order: false,
        }
    }

    /// A flaw for each third component that is not constant: it would be lost in two dimensions.
    fn not_flat(&self) -> impl Iterator<Item = Flaw> {
        let of = |(third, [a, b]): (&'static str, [&'static str; 2])| {
            let name = self.thirds.get(third)?;
            let ends = |of: &str| {
                let start = [f64::INFINITY, f64::NEG_INFINITY];
                self.column(of).iter().fold(start, |[low, high], v| [low.min(*v), high.max(*v)])
            };
            let ([low, high], others) = (ends(third), [ends(a), ends(b)]);
            let size = others.as_flattened().iter().fold(0.0, |all: f64, end| all.max(end.abs()));
            let is_flat =
                high - low <= FLAT * size && self.column(third).iter().all(|v| !v.is_nan());
            (!is_flat && !self.column(third).is_empty()).then(|| {
                let what = format!(
                    "it is from {} to {}, and only two components are read; expected a constant, or \
                     --map {b}={name}",
                    number(low),
                    number(high)
                );
                Flaw::of(&self.file, what).in_column(name.clone())
            })
        };
        THIRD.into_iter().zip([["x", "y"], ["u", "v"]]).filter_map(of)
    }

    /// Adds a row: the number of each column at its position, or a flaw.
    fn add(&mut self, line: u64, places: &Places, cells: &[&str], flaws: &mut Vec<Flaw>) {
        for ((name, values), (_, place)) in self.columns.iter_mut().zip(&places.of) {
            let text = cells.get(*place).copied().unwrap_or_default();
            values.push(text.parse().unwrap_or_else(|_| {
                let what = format!("it is {:?}; expected a number", short(text));
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
        is_right: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<Option<f64>, Flaw> {
        let value = self.column(name).get(k).copied();
        match value.filter(|value| !is_right(*value)) {
            Some(wrong) => {
                let what = format!("it is {}; expected {expected}", number(wrong));
                Err(Flaw::of(&self.file, what).at(self.first_line + k as u64).in_column(name))
            }
            None => Ok(value),
        }
    }

    fn finite(&self, name: &str, k: usize) -> Result<Option<f64>, Flaw> {
        self.checked(name, k, f64::is_finite, "a finite number")
    }

    /// Time and particle of a row, with its role if stated; or a flaw.
    fn row(&self, k: usize) -> Result<(f64, OwnParticle, Option<Role>), Flaw> {
        let finite = |name| self.finite(name, k).map(|value| value.unwrap_or(f64::NAN));
        let is_positive = |value: f64| value.is_finite() && value > 0.0;
        let positive = |name| self.checked(name, k, is_positive, "a finite number above 0");
        let (id, first) = (finite("id")?, self.first_id);
        let is_id = |id: f64| (first..=f64::from(u32::MAX)).contains(&id) && id.fract() == 0.0;
        self.checked("id", k, is_id, &format!("a whole number, not below {first}"))?;
        let start = ForeignParticle {
            id: (id - first) as u32,
            position: Vector2::new(finite("x")?, finite("y")?),
            velocity: Vector2::new(finite("u")?, finite("v")?),
            density: positive("density")?,
        };
        let (time, mass) = (finite("t")?, positive("mass")?.unwrap_or(f64::NAN));
        let number = self.checked("role", k, |value| role(value).is_some(), "0, 1 or 2")?;
        let stated = number.and_then(role);
        Ok((time, OwnParticle { role: stated.unwrap_or(Role::Fluid), mass, start }, stated))
    }
}

/// Frames of rows that are sorted by time.
fn frames(all: &[Rows]) -> Result<Results, Vec<Flaw>> {
    let (mut results, mut flaws) = (Results::default(), Vec::new());
    for rows in all {
        flaws.extend(results.take_columns(rows, &all[0].file));
        for k in 0..rows.len() {
            if flaws.len() >= MOST_FLAWS {
                flaws
                    .push(Flaw::of(&rows.file, "more flaws like these; later lines were not read"));
                return Err(flaws);
            }
            let line = rows.first_line + k as u64;
            let (time, own, role) = match rows.row(k) {
                Ok(row) => row,
                Err(flaw) => {
                    flaws.push(flaw);
                    continue;
                }
            };
            let changed = results.state(own.start.id, own.mass, role);
            flaws.extend(
                changed.map(|(column, what)| Flaw::of(&rows.file, what).at(line).in_column(column)),
            );
            let last = results.frames.last().map(|frame| frame.time);
            if let Some(last) = last.filter(|last| time < *last) {
                let [time, last] = [time, last].map(number);
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
