//! References: published or independently computed numbers, with provenance.
//!
//! The packages of `references/` (CSV tables with a Frictionless `datapackage.json`; the format is described
//! in its README) are embedded at compile time, so the program does not read them from disk. A package
//! without provenance, or with a table that differs from its description, is refused.
//!
//! ```
//! use touchstone_base::reference::Reference;
//! let table = Reference::load("periodic_hill")?.table("profiles")?.clone();
//! assert_eq!(table.select(&[], ["re", "y"])?[1], [10.0, 1.0152625]);
//! # Ok::<(), touchstone_base::reference::ReferenceError>(())
//! ```

use std::fmt::Write;
use std::sync::OnceLock;

use serde::Deserialize;
use thiserror::Error;

use crate::pack;

/// The packages by name: tables and description of each as the build script packed them.
const EMBEDDED: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/references.rs"));

/// Why a reference was refused, in words.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{0}")]
pub struct ReferenceError(String);

fn refused<T>(words: String) -> Result<T, ReferenceError> {
    Err(ReferenceError(words))
}

/// The description of a package: `datapackage.json`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Package {
    /// Frictionless profile
    pub profile: Option<String>,
    /// name of the folder
    pub name: String,
    /// short description of the numbers
    #[serde(default)]
    pub title: String,
    /// description of the numbers
    #[serde(default)]
    pub description: String,
    /// grade of the source
    pub grade: Grade,
    /// licences of the numbers
    #[serde(default)]
    pub licenses: Vec<License>,
    /// where they come from
    #[serde(default)]
    pub sources: Vec<Source>,
    /// the tables
    #[serde(default)]
    pub resources: Vec<Resource>,
    /// how they were obtained
    #[serde(default)]
    pub method: String,
    /// how far they can be trusted
    #[serde(default)]
    pub uncertainty: String,
    /// warnings for readers
    #[serde(default)]
    pub caveats: Vec<String>,
}

/// Grade of the source of a reference.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// a formula or a definition
    Exact,
    /// two codes that share no line agree within their stated uncertainties: the package of the second one
    TwoCodes(String),
    /// a computation by one code
    OneCode,
    /// numbers of others, as printed or as their programs gave them
    Collected,
    /// read off figures
    Digitised,
}

/// A number of the table `summary` of a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// The number.
    pub value: f64,
    /// Its standard uncertainty, in the same unit.
    pub uncertainty: f64,
}

/// How far the numbers of two codes are apart.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// numbers that both have
    pub numbers: usize,
    /// greatest distance over (u₁² + u₂²)^(1/2), of their stated uncertainties
    pub worst: f64,
    /// which number that is
    pub of: String,
}

/// Terms of use.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct License {
    /// SPDX expression or `LicenseRef-…`
    pub name: String,
    /// in words
    pub title: Option<String>,
}

/// Where numbers come from.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// the citation
    pub title: String,
    /// digital object identifier
    pub doi: Option<String>,
    /// table, figure, section or file in it
    pub place: Option<String>,
    /// its own terms
    pub licence: Option<String>,
}

/// The description of one table.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resource {
    /// name of the table
    pub name: String,
    /// file in the folder
    pub path: String,
    /// `sha256:` and the digest of the file
    #[serde(default)]
    pub hash: String,
    /// the columns
    pub schema: Schema,
}

/// The columns of a table.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub struct Schema {
    /// in the order of the header
    pub fields: Vec<TableField>,
    /// form of a gap: only the empty cell
    #[serde(default)]
    pub missing_values: Vec<String>,
}

/// One column.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableField {
    /// as in the header
    pub name: String,
    /// number, integer or string
    #[serde(rename = "type")]
    pub kind: FieldKind,
    /// SI or as the source has it, `-` for none
    #[serde(default)]
    pub unit: String,
    /// description
    #[serde(default)]
    pub description: String,
}

/// Type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FieldKind {
    /// finite numbers
    Number,
    /// whole numbers
    Integer,
    /// texts
    String,
}

/// A package that passed every check.
#[derive(Debug, Clone)]
pub struct Reference {
    /// provenance
    pub package: Package,
    /// in the order of the package
    pub tables: Vec<Table>,
}

/// One table of a reference.
#[derive(Debug, Clone)]
pub struct Table {
    /// as in the package
    pub name: String,
    /// the columns in order
    pub fields: Vec<TableField>,
    /// the cells
    pub rows: Vec<Vec<String>>,
}

impl Reference {
    /// The names of all references.
    pub fn names() -> Vec<&'static str> {
        EMBEDDED.iter().map(|(name, _)| *name).collect()
    }

    /// An embedded reference, checked and read once. One is refused whose second code does not agree.
    pub fn load(name: &str) -> Result<&'static Self, ReferenceError> {
        static READ: [OnceLock<Result<Reference, ReferenceError>>; EMBEDDED.len()] =
            [const { OnceLock::new() }; EMBEDDED.len()];
        let read = || {
            let reference = Self::read(name)?;
            reference.agreement()?;
            Ok(reference)
        };
        READ[place(name)?].get_or_init(read).as_ref().map_err(Clone::clone)
    }

    fn read(name: &str) -> Result<Self, ReferenceError> {
        let (_, packed) = EMBEDDED[place(name)?];
        let texts = pack::read(packed);
        let file =
            |(path, text)| Some((String::as_str(path).split_once('/')?.1, String::as_str(text)));
        let files: Vec<(&str, &str)> = texts.iter().filter_map(file).collect();
        let package = files.iter().find(|(path, _)| *path == "datapackage.json");
        Self::from_texts(name, package.map_or("", |(_, text)| text), &files)
    }

    /// Checks and reads a reference from the text of its description and of its tables by path. The build
    /// script has checked their hashes.
    pub fn from_texts(
        name: &str,
        package: &str,
        files: &[(&str, &str)],
    ) -> Result<Self, ReferenceError> {
        let unreadable = |reason| {
            let words =
                format!("the datapackage.json of reference {name} cannot be read: {reason}");
            ReferenceError(words)
        };
        let package: Package = serde_json::from_str(package).map_err(unreadable)?;
        check_provenance(name, &package)?;
        let table = |resource| read_table(name, resource, files);
        let tables = package.resources.iter().map(table).collect::<Result<_, _>>()?;
        Ok(Reference { package, tables })
    }

    /// The number in the row of the table `summary` of a reference that has these texts; NaN if there is
    /// none, so that nothing follows from it.
    pub fn summarised(name: &str, of: &[(&str, &str)]) -> Uncertain {
        let read = || Self::load(name)?.table("summary")?.uncertain(of);
        let first = read().ok().and_then(|numbers| numbers.first().copied());
        first.unwrap_or(Uncertain { value: f64::NAN, uncertainty: f64::NAN })
    }

    /// A column of a table of a reference over another one, in the rows that have these texts; empty if there
    /// is none, so that nothing follows from it.
    pub fn curve(
        name: &str,
        table: &str,
        columns: [&str; 2],
        of: &[(&str, &str)],
    ) -> Vec<(f64, f64)> {
        let read = || Self::load(name)?.table(table)?.select(of, columns);
        read().unwrap_or_default().into_iter().map(<(f64, f64)>::from).collect()
    }

    /// How far the second code is from the first, if the grade names one.
    pub fn agreement(&self) -> Result<Option<Agreement>, ReferenceError> {
        let Grade::TwoCodes(second) = &self.package.grade else { return Ok(None) };
        let (name, found) = (&self.package.name, self.distance(&Self::read(second)?)?);
        let Agreement { worst, of, .. } = &found;
        match *worst <= 1.0 {
            true => Ok(Some(found)),
            false => refused(format!(
                "reference {name} cannot have the grade two_codes: {of} of {second} differs by {worst:.2} \
                 times both uncertainties"
            )),
        }
    }

    /// Compares each row of the table `values` of another code with the row of the table `summary` that has
    /// equal texts in the columns before `value`.
    fn distance(&self, other: &Reference) -> Result<Agreement, ReferenceError> {
        let (own, others) = (self.table("summary")?, other.table("values")?);
        let keys = &others.fields[..others.position("value")?];
        let (mut worst, mut of) = (0.0, String::new());
        for (row, theirs) in others.rows.iter().zip(others.uncertain(&[])?) {
            let texts: Vec<_> =
                keys.iter().map(|key| &*key.name).zip(row.iter().map(|cell| &**cell)).collect();
            let name = row[..keys.len()].join(" ");
            let Some(ours) = own.uncertain(&texts)?.first().copied() else {
                return refused(format!("reference {} has no number {name:?}", self.package.name));
            };
            let squares = [theirs, ours].map(|of| of.uncertainty * of.uncertainty);
            let ratio = (theirs.value - ours.value).abs() / (squares[0] + squares[1]).sqrt();
            if ratio.is_nan() || ratio >= worst {
                (worst, of) = (ratio, name);
            }
        }
        Ok(Agreement { numbers: others.rows.len(), worst, of })
    }

    /// The grade in words; with two codes, how far they are apart.
    pub fn graded(&self) -> String {
        match (&self.package.grade, self.agreement()) {
            (Grade::Exact, _) => "exact".into(),
            (Grade::TwoCodes(second), Ok(Some(Agreement { numbers, worst, .. }))) => format!(
                "two codes: {numbers} numbers of `{second}` differ by at most {worst:.2} of both \
                 uncertainties"
            ),
            (Grade::TwoCodes(_) | Grade::OneCode, _) => "one code".into(),
            (Grade::Collected, _) => "collected".into(),
            (Grade::Digitised, _) => "digitised".into(),
        }
    }

    /// A table by name.
    pub fn table(&self, name: &str) -> Result<&Table, ReferenceError> {
        let no_table = || {
            let known: Vec<&str> = self.tables.iter().map(|table| &*table.name).collect();
            let (of, known) = (&self.package.name, known.join(", "));
            ReferenceError(format!("reference {of} has no table {name:?}; there are {known}"))
        };
        self.tables.iter().find(|table| table.name == name).ok_or_else(no_table)
    }
}

impl Table {
    /// The rows that have these texts in these columns.
    pub fn rows_of(&self, of: &[(&str, &str)]) -> Result<Vec<usize>, ReferenceError> {
        let mut rows: Vec<usize> = (0..self.rows.len()).collect();
        for (column, text) in of {
            let texts = self.texts(column)?;
            rows.retain(|row| texts[*row] == *text);
        }
        Ok(rows)
    }

    /// A column as texts.
    pub fn texts(&self, column: &str) -> Result<Vec<&str>, ReferenceError> {
        let position = self.position(column)?;
        Ok(self.rows.iter().map(|row| row[position].as_str()).collect())
    }

    /// Columns of numbers without gaps, of the rows that have these texts in these columns.
    pub fn select<const N: usize>(
        &self,
        of: &[(&str, &str)],
        columns: [&str; N],
    ) -> Result<Vec<[f64; N]>, ReferenceError> {
        let mut selected = Vec::new();
        for row in self.rows_of(of)? {
            let mut numbers = [0.0; N];
            for (number, column) in numbers.iter_mut().zip(columns) {
                *number = self.number(row, column)?;
            }
            selected.push(numbers);
        }
        Ok(selected)
    }

    /// The columns `value` and `uncertainty` of the rows that have these texts in these columns.
    pub fn uncertain(&self, of: &[(&str, &str)]) -> Result<Vec<Uncertain>, ReferenceError> {
        let rows = self.select(of, ["value", "uncertainty"])?.into_iter();
        Ok(rows.map(|[value, uncertainty]| Uncertain { value, uncertainty }).collect())
    }

    fn number(&self, row: usize, column: &str) -> Result<f64, ReferenceError> {
        let text = &self.rows[row][self.position(column)?];
        let not_a_number = || {
            let place = format!("row {row}, column {column} of table {}", self.name);
            ReferenceError(format!("{place} is {text:?}, which is not a number"))
        };
        finite(text).ok_or_else(not_a_number)
    }

    fn position(&self, column: &str) -> Result<usize, ReferenceError> {
        let no_column = || {
            let known: Vec<&str> = self.fields.iter().map(|field| field.name.as_str()).collect();
            let (of, known) = (&self.name, known.join(", "));
            ReferenceError(format!("table {of} has no column {column:?}; there are {known}"))
        };
        self.fields.iter().position(|field| field.name == column).ok_or_else(no_column)
    }
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Refuses a package without description, source, method, uncertainty or licence.
fn check_provenance(name: &str, package: &Package) -> Result<(), ReferenceError> {
    let stated = |what: &str, is_stated: bool| match is_stated {
        true => Ok(()),
        false => refused(format!("reference {name} does not state {what}")),
    };
    let says = |text: &str| !text.trim().is_empty();
    stated("the name of its folder", package.name == name)?;
    stated("a title", says(&package.title))?;
    stated("a description", says(&package.description))?;
    stated("a method", says(&package.method))?;
    stated("an uncertainty", says(&package.uncertainty))?;
    stated("a licence", package.licenses.iter().any(|license| says(&license.name)))?;
    stated("a source", !package.sources.is_empty())?;
    for source in &package.sources {
        stated("the title of a source", says(&source.title))?;
        let is_located = [&source.doi, &source.place].into_iter().flatten().any(|text| says(text));
        stated(&format!("a DOI or a place in the source {:?}", source.title), is_located)?;
    }
    stated("a table", !package.resources.is_empty())?;
    for resource in &package.resources {
        for field in &resource.schema.fields {
            let (column, path) = (&field.name, &resource.path);
            stated(&format!("the unit of column {column} of {path}"), says(&field.unit))?;
            stated(&format!("what column {column} of {path} is"), says(&field.description))?;
        }
    }
    Ok(())
}

/// The index of an embedded package.
fn place(name: &str) -> Result<usize, ReferenceError> {
    let unknown = || {
        let known = Reference::names().join(", ");
        ReferenceError(format!("no reference is called {name:?}; there are {known}"))
    };
    EMBEDDED.iter().position(|(known, _)| *known == name).ok_or_else(unknown)
}

/// Reads a table, and checks its header and its cells.
fn read_table(
    name: &str,
    resource: &Resource,
    files: &[(&str, &str)],
) -> Result<Table, ReferenceError> {
    let file = format!("{name}/{}", resource.path);
    let Some((_, text)) = files.iter().find(|(known, _)| *known == resource.path) else {
        return refused(format!("the file {file}, which a reference describes, does not exist"));
    };
    let fields: Vec<&str> = resource.schema.fields.iter().map(|field| &*field.name).collect();
    let stated = fields.join(",");
    let differs = |found: String| {
        let columns = format!("reference {file} has the columns {found}");
        ReferenceError(format!("{columns}, but its package states {stated}"))
    };
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| differs(error.to_string()))?;
    if *header != *fields {
        return Err(differs(header.iter().collect::<Vec<_>>().join(",")));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| differs(error.to_string()))?;
        rows.push(record.iter().map(String::from).collect());
    }
    let table = Table { name: resource.name.clone(), fields: resource.schema.fields.clone(), rows };
    check_cells(&file, &table)?;
    Ok(table)
}

/// Refuses cells that are neither empty nor of the type of their field.
fn check_cells(file: &str, table: &Table) -> Result<(), ReferenceError> {
    for (row, cells) in table.rows.iter().enumerate() {
        for (field, text) in table.fields.iter().zip(cells) {
            let is_valid = match field.kind {
                FieldKind::String => true,
                FieldKind::Number => text.is_empty() || finite(text).is_some(),
                FieldKind::Integer => text.is_empty() || text.parse::<i64>().is_ok(),
            };
            if !is_valid {
                let TableField { name: column, kind, .. } = field;
                let place = format!("row {row}, column {column} of reference {file}");
                return refused(format!("{place} is {text:?}, not of type {kind:?}"));
            }
        }
    }
    Ok(())
}

/// The SHA-256 digest in lowercase hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(64);
    for byte in hmac_sha256::Hash::hash(bytes) {
        let _ = write!(text, "{byte:02x}");
    }
    text
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::Path;

    use serde_json::{Value, json};

    use super::*;

    const TABLE: &str = "y,u,who\n0.1,0.5,a\n0.2,-0.86636,b\n0.3,,c\n";

    fn package() -> Value {
        json!({
            "name": "sample", "title": "t", "description": "d", "method": "m", "uncertainty": "1 %",
            "grade": "one_code",
            "licenses": [{"name": "CC0-1.0"}],
            "sources": [{"title": "someone 1999", "doi": "10.1/2"}],
            "resources": [{
                "name": "profile", "path": "profile.csv",
                "schema": {"fields": [
                    {"name": "y", "type": "number", "unit": "m", "description": "height"},
                    {"name": "u", "type": "number", "unit": "m/s", "description": "velocity"},
                    {"name": "who", "type": "string", "unit": "-", "description": "by whom"},
                ]},
            }],
        })
    }

    fn load(package: &Value, table: &str) -> Result<Reference, ReferenceError> {
        Reference::from_texts("sample", &package.to_string(), &[("profile.csv", table)])
    }

    #[test]
    fn columns_come_by_name() {
        let reference = load(&package(), TABLE).unwrap();
        let table = reference.table("profile").unwrap();
        assert_eq!(table.rows.len(), 3);
        assert_eq!(table.select(&[], ["y"]).unwrap(), [[0.1], [0.2], [0.3]]);
        assert_eq!(table.select(&[("who", "b")], ["u", "y"]).unwrap(), [[-0.86636, 0.2]]);
        assert_eq!(table.texts("who").unwrap(), ["a", "b", "c"]);
        let says = |error: ReferenceError| error.to_string();
        let gap = "row 2, column u of table profile is \"\", which is not a number";
        assert_eq!(says(table.select(&[], ["u"]).unwrap_err()), gap);
        let unknown = "table profile has no column \"v\"; there are y, u, who";
        assert_eq!(says(table.texts("v").unwrap_err()), unknown);
        let unknown = "reference sample has no table \"p\"; there are profile";
        assert_eq!(says(reference.table("p").unwrap_err()), unknown);
    }

    #[test]
    fn a_table_that_is_not_there_is_refused() {
        let elsewhere = Reference::from_texts("sample", &package().to_string(), &[]).unwrap_err();
        assert!(elsewhere.to_string().ends_with("does not exist"), "{elsewhere}");
    }

    #[test]
    fn missing_provenance_is_refused_by_name() {
        for (pointer, missing) in [
            ("/title", "a title"),
            ("/method", "a method"),
            ("/uncertainty", "an uncertainty"),
            ("/resources/0/schema/fields/1/unit", "the unit of column u of profile.csv"),
            ("/sources/0/doi", "a DOI or a place in the source \"someone 1999\""),
            ("/licenses/0/name", "a licence"),
        ] {
            let mut package = package();
            *package.pointer_mut(pointer).unwrap() = json!(" ");
            let error = load(&package, TABLE).unwrap_err().to_string();
            assert_eq!(error, format!("reference sample does not state {missing}"));
        }
        for key in ["licenses", "sources", "resources"] {
            let mut package = package();
            package[key] = json!([]);
            let error = load(&package, TABLE).unwrap_err();
            assert!(error.to_string().contains("does not state"), "{error}");
        }
        let mut package = package();
        package["licence"] = json!("a misspelt key is not passed over");
        let error = load(&package, TABLE).unwrap_err().to_string();
        assert!(
            error.starts_with("the datapackage.json of reference sample cannot be read"),
            "{error}"
        );
    }

    #[test]
    fn a_header_or_a_cell_that_differs_is_refused() {
        for table in ["", "y,v,who\n", "y,u\n", "y,u,who\n1,2\n"] {
            let error = load(&package(), table).unwrap_err();
            assert!(error.to_string().contains("has the columns"), "{table}: {error}");
        }
        let error = load(&package(), "y,u,who\n1,NaN,c\n").unwrap_err().to_string();
        let expected =
            "row 0, column u of reference sample/profile.csv is \"NaN\", not of type Number";
        assert_eq!(error, expected);
    }

    /// Each table has its own hash; the build script asks only for one that its package states.
    #[test]
    fn embedded_tables_have_the_hashes_that_their_resources_state() {
        for (name, packed) in EMBEDDED {
            let texts = pack::read(packed);
            let file = |path: &str| texts[&format!("{name}/{path}")].as_str();
            let package: Package = serde_json::from_str(file("datapackage.json")).unwrap();
            assert!(!package.resources.is_empty(), "{name}");
            for Resource { path, hash, .. } in &package.resources {
                assert_eq!(
                    *hash,
                    format!("sha256:{}", sha256(file(path).as_bytes())),
                    "{name}/{path}"
                );
            }
        }
    }

    #[test]
    fn two_codes_must_agree_within_both_uncertainties() {
        let mut hill = Reference::read("periodic_hill").unwrap();
        let agreement = hill.agreement().unwrap().unwrap();
        assert!(agreement.numbers == 22 && agreement.worst <= 1.0, "{agreement:?}");
        let cell = |hill: &mut Reference, at: &str, text: &str| {
            let table = hill.tables.iter_mut().find(|table| table.name == "summary").unwrap();
            let at = table.position(at).unwrap();
            std::mem::replace(&mut table.rows[10][at], text.into())
        };
        // Separation at Re 50 is 0.52044 with 0.00066, and 0.52053 with 0.00002.
        let was = cell(&mut hill, "value", "0.5213");
        let error = hill.agreement().unwrap_err().to_string();
        assert!(
            error.contains("two_codes: 50 separation H of periodic_hill_ngsolve differs by 1.16"),
            "{error}"
        );
        assert_eq!(hill.graded(), "one code");
        cell(&mut hill, "value", &was);
        cell(&mut hill, "quantity", "parting");
        let error = hill.agreement().unwrap_err().to_string();
        assert!(error.ends_with("has no number \"50 separation H\""), "{error}");
        hill.package.grade = Grade::TwoCodes("nowhere".into());
        assert!(hill.agreement().is_err());
        hill.package.grade = Grade::OneCode;
        assert_eq!(hill.agreement(), Ok(None));
    }

    #[test]
    fn every_folder_is_embedded_and_every_package_is_sound() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references");
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
        let folders: BTreeSet<String> = entries
            .filter(|entry| entry.path().is_dir())
            .map(|entry| entry.file_name().into_string().unwrap())
            .filter(|name| !["peers", "schemas"].contains(&&**name)) // no packages of numbers
            .collect();
        let names: BTreeSet<String> = Reference::names().into_iter().map(String::from).collect();
        assert_eq!(folders, names);
        for name in Reference::names() {
            let reference = Reference::load(name).unwrap();
            assert!(reference.tables.iter().all(|table| !table.rows.is_empty()), "{name}");
        }
        let error = Reference::load("peers").unwrap_err().to_string();
        assert!(error.starts_with("no reference is called \"peers\"; there are"), "{error}");
    }

    #[test]
    fn the_columns_of_water_fall_and_their_fronts_advance() {
        let numbers = |name: &str, table: &str, column: &str| -> Vec<f64> {
            Reference::load(name)
                .unwrap()
                .table(table)
                .unwrap()
                .select(&[], [column])
                .unwrap()
                .into_flattened()
        };
        let rises = |values: &[f64]| values.windows(2).all(|w| w[0] < w[1]);
        let (mm, tank) = ("dambreak_martin_moyce", "dambreak_lobovsky");
        for (name, table, time) in [
            (mm, "front", "T"),
            (mm, "height", "tau"),
            (tank, "front", "t"),
            (tank, "levels", "t"),
            (tank, "pressure", "t"),
        ] {
            assert!(rises(&numbers(name, table, time)), "{name} {table}");
        }
        assert!(rises(&numbers(mm, "front", "Z")) && rises(&numbers(tank, "front", "x")));
        assert!(numbers(mm, "height", "H").windows(2).all(|w| w[1] < w[0]));
        assert_eq!(numbers(tank, "levels", "H1_1")[0], 1.0);
        // P1 rises at 2.43: the caveat on the origins of time.
        let (t, p) = (numbers(tank, "pressure", "t"), numbers(tank, "pressure", "P1"));
        let rise = t.iter().zip(&p).find(|(_, p)| **p > 0.1).map(|(t, _)| *t);
        assert!(rise.is_some_and(|t| (t - 2.44).abs() < 0.02), "{rise:?}");
    }
}
