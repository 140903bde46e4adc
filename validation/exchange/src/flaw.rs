//! What is wrong with a submission, and where.

use std::fmt;

/// One thing that is wrong or missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Name of the file in the folder.
    pub file: String,
    /// Line, counted from 1, if it has one.
    pub line: Option<u64>,
    /// Column or field, if it is of one.
    pub column: Option<String>,
    /// What it is, and what was expected.
    pub what: String,
}

impl Flaw {
    /// Of a whole file.
    pub fn of(file: impl Into<String>, what: impl Into<String>) -> Self {
        Self { file: file.into(), line: None, column: None, what: what.into() }
    }

    /// The same at a line.
    pub fn at(self, line: u64) -> Self {
        Self { line: Some(line), ..self }
    }

    /// The same in a column or field.
    pub fn in_column(self, column: impl Into<String>) -> Self {
        Self { column: Some(column.into()), ..self }
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
