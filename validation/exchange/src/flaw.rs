//! Flaws of a submission, with their places.

use std::{collections::BTreeMap, fmt};

use touchstone_base::text::{first, short};

/// Message for a text whose last line has no end: the rest of its last number may be missing.
pub const CUT: &str = "the last line does not end; the file was cut short";
/// Printed characters of a flaw: repeated parts of a file are cut where they are repeated, and here again,
/// where a library repeats them.
const MOST_CHARACTERS: usize = 1000;
/// Printed flaws of one kind.
const MOST_OF_A_KIND: usize = 3;

/// One thing that is wrong or missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Name of the file in the folder.
    pub file: String,
    /// Line, counted from 1, if it has one.
    pub line: Option<u64>,
    /// Column or field, if it is of one.
    pub column: Option<String>,
    /// The flaw, and the expected content.
    pub what: String,
}

impl Flaw {
    /// A flaw of a whole file.
    pub fn of(file: impl Into<String>, what: impl Into<String>) -> Self {
        let what = first(&what.into(), MOST_CHARACTERS);
        Self { file: file.into(), line: None, column: None, what }
    }

    /// The flaw at a line.
    pub fn at(self, line: u64) -> Self {
        Self { line: Some(line), ..self }
    }

    /// The flaw in a column or field.
    pub fn in_column(self, column: impl Into<String>) -> Self {
        Self { column: Some(short(&column.into())), ..self }
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        self.line.map_or(Ok(()), |line| write!(f, ", line {line}"))?;
        self.column.as_ref().map_or(Ok(()), |column| write!(f, ", column {column}"))?;
        write!(f, ": {}", self.what)
    }
}

impl Flaw {
    /// The common part of flaws of one kind: the column, and the first words of the description.
    fn kind(&self) -> (Option<&str>, Vec<&str>) {
        let is_word = |word: &&str| word.chars().all(|c| c.is_alphabetic() || c == ',' || c == ';');
        let words = self.what.split_whitespace().filter(is_word).take(3);
        (self.column.as_deref(), words.collect())
    }
}

/// The flaws, one a line: three of a kind, then how many others of it there are.
pub fn lines(flaws: &[Flaw]) -> Vec<String> {
    let mut kinds: Vec<Vec<&Flaw>> = Vec::new();
    let mut places = BTreeMap::new();
    for flaw in flaws {
        let place = *places.entry(flaw.kind()).or_insert(kinds.len());
        kinds.resize_with(kinds.len().max(place + 1), Vec::new);
        kinds[place].push(flaw);
    }
    let of_kind = |flaws: Vec<&Flaw>| {
        let more = flaws.len().saturating_sub(MOST_OF_A_KIND);
        let told = flaws.into_iter().take(MOST_OF_A_KIND).map(Flaw::to_string);
        told.chain((more > 0).then(|| format!("and {more} more like this"))).collect::<Vec<_>>()
    };
    kinds.into_iter().flat_map(of_kind).collect()
}
