//! `submit --baseline`: the metrics of an earlier version of a code, which a later one must not make worse.
//!
//! The file is the record of a submission without its curves, so that its digest finds damage.

use std::{
    collections::BTreeMap,
    io::{self, ErrorKind},
    path::Path,
};

use touchstone_base::{
    files::{self, FileError, write_atomically},
    record::{Record, Status},
    spec::RunSpec,
};

use super::{
    Exit, Failure, arguments,
    junit::Tested,
    metrics::{self, Change, MetricChange},
    output,
};

/// Largest baseline file \[bytes\].
pub const MOST_BYTES: u64 = 1 << 24;

/// The file of `--baseline`, and the record in it.
pub struct Baseline<'a> {
    file: &'a Path,
    is_updated: bool,
    record: Option<Record>,
}

impl<'a> Baseline<'a> {
    /// The baseline that a command names.
    ///
    /// # Errors
    /// If there is no such file and none is to be written, or the file is not the record of a submission.
    pub fn of(arguments: &'a arguments::Submit) -> Result<Option<Self>, Failure> {
        let Some(file) = arguments.baseline.as_deref() else { return Ok(None) };
        let is_updated = arguments.update_baseline;
        let record = match read(file) {
            Ok(record) => Some(record),
            Err(FileError::Unread { reason, .. }) if reason.kind() == ErrorKind::NotFound => {
                if !is_updated {
                    return Err(Failure::usage(format!(
                        "there is no baseline {}; --update-baseline writes it",
                        file.display()
                    )));
                }
                None
            }
            Err(error) => {
                let words = format!("{error}; it is not a baseline and stays as it is");
                return Err(Failure::usage(words));
            }
        };
        Ok(Some(Self { file, is_updated, record }))
    }

    /// The exit code of a submission with these changes, whose gates gave another. Where no gate applies, the
    /// baseline alone decides.
    pub fn exit(&self, changes: &[MetricChange], of_gates: Exit) -> Exit {
        let is_worse = changes.iter().any(|of| of.change.is_worse());
        match (is_worse && !self.is_updated, of_gates) {
            (true, _) => Exit::GateFailed,
            (false, Exit::Usage) => Exit::Pass,
            (false, of_gates) => of_gates,
        }
    }

    /// The changes beyond the resolution as a table, and their count.
    pub fn in_words(&self, changes: &[MetricChange]) -> String {
        let moved = changes.iter().filter(|of| of.change != Change::Same).cloned();
        let moved: Vec<MetricChange> = moved.collect();
        let worse = changes.iter().filter(|of| of.change.is_worse()).count();
        let all = changes.len();
        let told = match (worse, self.is_updated) {
            (0, _) => format!("none of {all} metrics is worse than before"),
            (_, true) => format!("{worse} of {all} metrics are worse, changed or gone: accepted"),
            (_, false) => format!(
                "FAIL: {worse} of {all} metrics are worse, changed or gone; --update-baseline accepts them"
            ),
        };
        let table = if moved.is_empty() { String::new() } else { metrics::table(&moved) + "\n" };
        format!("\n{table}{}", output::hanging("baseline", 10, &told))
    }

    /// The record of the earlier version; none before the first.
    ///
    /// # Errors
    /// If it is of another problem, other settings, another code, scheme or division.
    pub fn before(&self, now: &Record) -> Result<Option<&Record>, Failure> {
        let Some(before) = &self.record else { return Ok(None) };
        let [was, is] = [before, now].map(parts);
        let value = |name: &str| is.iter().find(|(own, _)| own == name).map(|(_, of)| of.as_str());
        let differ = was.iter().filter(|(name, of)| value(name) != Some(of));
        let differ: Vec<String> = differ
            .map(|(name, of)| {
                let now = value(name).unwrap_or("absent");
                format!("{name} is {of} there, {now} in the submission")
            })
            .collect();
        match differ.is_empty() && was.len() == is.len() {
            true => Ok(Some(before)),
            false => Err(Failure::usage(format!(
                "{} is the baseline of another problem or code: {}; name another file",
                self.file.display(),
                differ.join("; ")
            ))),
        }
    }

    /// Writes the record in its place, if asked to; what was done, in words.
    ///
    /// # Errors
    /// If the run did not reach its end, or the file cannot be written.
    pub fn update(&self, now: &Record) -> Result<Option<String>, Failure> {
        if !self.is_updated {
            return Ok(None);
        }
        if now.status != Status::Completed {
            let words = format!("a run that {} is not a baseline; nothing was written", now.status);
            return Err(Failure::usage(words));
        }
        let kept = Record { profiles: BTreeMap::new(), ..now.clone() };
        write_atomically(self.file, kept.to_json()?.as_bytes())?;
        let count = now.metrics.len();
        Ok(Some(format!("{}: baseline of {count} metrics", self.file.display())))
    }
}

/// The record of a submission in a file.
///
/// # Errors
/// If it cannot be read, or is damaged or something else.
pub fn read(file: &Path) -> Result<Record, FileError> {
    let no_submission = || io::Error::other("it is the record of a run of touchstone itself");
    let record = files::read_text(file, MOST_BYTES)
        .and_then(|text| Record::from_json(&text).map_err(io::Error::other))
        .and_then(|record| match record.run.submission {
            Some(_) => Ok(record),
            None => Err(no_submission()),
        });
    record.map_err(|reason| FileError::Unread { path: file.into(), reason })
}

/// The part that later versions of a code keep: problem, settings, and the names of code and scheme.
fn parts(record: &Record) -> Vec<(String, String)> {
    let RunSpec { case, variant, settings, submission, .. } = record.spec();
    let mut parts = vec![("case".into(), case), ("variant".into(), variant)];
    let settings = settings.as_object().into_iter().flatten();
    parts.extend(settings.map(|(name, value)| (format!("setting {name}"), value.to_string())));
    let by = submission.unwrap_or_default();
    let seed = by.seed.map_or("none".into(), |seed| seed.to_string());
    let of_code = [
        ("code", by.code),
        ("scheme", by.scheme),
        ("division", by.division.to_string()),
        ("seed", seed),
    ];
    parts.extend(of_code.map(|(name, of)| (name.into(), of)));
    parts
}

/// The baseline as a test case.
pub fn tested(changes: &[MetricChange]) -> Tested {
    let worse = changes.iter().filter(|of| of.change.is_worse());
    let lines: Vec<String> = worse.map(MetricChange::in_words).collect();
    match lines.len() {
        0 => Tested::Pass,
        count => Tested::Fail {
            message: format!("{count} metrics are worse than in the baseline"),
            why: lines.join("\n"),
        },
    }
}
