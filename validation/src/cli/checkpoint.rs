//! The file of a checkpoint in the folder of a run. Its first line names the format and has the digest of
//! everything after it; the second line is the requested run as JSON; then follows its state as bytes.

use std::path::Path;

use serde::{Deserialize, Serialize};
use touchstone_base::{
    files::{self, FileError, OutputFolder},
    reference::sha256,
    spec::RunSpec,
};

use super::Failure;

/// Name of the file.
pub const CHECKPOINT: &str = "checkpoint";
/// Begins the first line; the version of the format follows.
const MAGIC: &str = "touchstone checkpoint";
/// Version of the format.
const FORMAT: u32 = 3;

/// The requested run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResumableRun {
    /// The run.
    pub spec: RunSpec,
    /// Digest of the sources of the program.
    pub sources: String,
    /// Wall time between checkpoints \[s\], if there are any.
    pub every: Option<u32>,
    /// Number of frames for ParaView.
    pub vtk: Option<u16>,
    /// May the run be long?
    pub allow_long: bool,
}

/// Writes a checkpoint of a run in this state, in place of an earlier one.
pub fn write(folder: &OutputFolder, asked: &ResumableRun, state: &[u8]) -> Result<(), FileError> {
    folder.write(CHECKPOINT, &bytes(asked, state)).map(|_| ())
}

fn bytes(asked: &ResumableRun, state: &[u8]) -> Vec<u8> {
    let head = serde_json::to_value(asked).unwrap_or_default();
    let rest = [format!("{head}\n").as_bytes(), state].concat();
    [format!("{MAGIC} {FORMAT} {}\n", sha256(&rest)).into_bytes(), rest].concat()
}

/// Reads the checkpoint of a folder: the requested run, and its state. `sources` is the digest of this
/// program's sources for a case.
///
/// # Errors
/// If there is none, or it is damaged or of another build.
pub fn read(
    folder: &Path,
    sources: fn(&str) -> String,
) -> Result<(ResumableRun, Vec<u8>), Failure> {
    let path = folder.join(CHECKPOINT);
    let bytes = files::read(&path).map_err(|reason| {
        let words = "has no checkpoint that can be read";
        Failure::usage(format!("the folder {folder:?} {words}: {reason}"))
    })?;
    parse(&bytes, &path, sources).map_err(Failure::usage)
}

/// Parses the bytes of a checkpoint. An error states why a run cannot continue from it: another kind of file,
/// another version or build of this program (the rest of the run would have other bits), or a truncated or
/// changed file.
fn parse(
    bytes: &[u8],
    path: &Path,
    sources: fn(&str) -> String,
) -> Result<(ResumableRun, Vec<u8>), String> {
    let (first, rest) = split_line(bytes);
    let line = String::from_utf8_lossy(first);
    let Some(digest) = line.strip_prefix(&format!("{MAGIC} {FORMAT} ")) else {
        let line: String = line.chars().take(40).collect();
        return Err(format!(
            "{path:?} is not a checkpoint of format {FORMAT}: its first line is {line:?}"
        ));
    };
    if digest != sha256(rest) {
        let words = "its content does not have the digest stated";
        return Err(format!("the checkpoint {path:?} is damaged or truncated: {words}"));
    }
    let (head, state) = split_line(rest);
    let asked: ResumableRun =
        serde_json::from_str(&String::from_utf8_lossy(head)).map_err(|reason| {
            format!("the settings cannot be read from the checkpoint {path:?}: {reason}")
        })?;
    let ours = sources(&asked.spec.case);
    if asked.sources != ours {
        let words = format!("was made by another build, of the sources {}", asked.sources);
        return Err(format!("the checkpoint {path:?} {words}; this one is of {ours}"));
    }
    Ok((asked, state.to_vec()))
}

/// The first line without its end, and the bytes after it.
fn split_line(bytes: &[u8]) -> (&[u8], &[u8]) {
    let end = bytes.iter().position(|byte| *byte == b'\n').unwrap_or(bytes.len());
    (&bytes[..end], bytes.get(end + 1..).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn asked() -> ResumableRun {
        let settings = serde_json::json!({"rows": 20, "text": "two\nlines"});
        let spec = RunSpec::new("couette", "seed", settings);
        ResumableRun {
            spec,
            sources: "abc".into(),
            every: Some(60),
            vtk: Some(4),
            allow_long: false,
        }
    }

    fn parsed(bytes: &[u8]) -> Result<(ResumableRun, Vec<u8>), String> {
        parse(bytes, "f".as_ref(), |_| "abc".into())
    }

    proptest! {
        /// Every byte counts: a file that was cut or changed anywhere is refused, and never half of it used.
        #[test]
        fn a_checkpoint_is_read_as_it_was_written_or_refused(
            state in prop::collection::vec(any::<u8>(), 0..150),
            place in any::<prop::sample::Index>(),
            change in 1..=255_u8,
        ) {
            let mut file = bytes(&asked(), &state);
            prop_assert_eq!(parsed(&file).unwrap(), (asked(), state));
            let place = place.index(file.len());
            prop_assert!(parsed(&file[..place]).is_err());
            file[place] ^= change;
            prop_assert!(parsed(&file).is_err());
        }
    }

    #[test]
    fn a_checkpoint_of_another_build_or_format_is_refused_by_name() {
        let file = bytes(&asked(), &[]);
        let refused = parse(&file, "f".as_ref(), |_| "xyz".into()).unwrap_err();
        assert!(refused.contains("another build, of the sources abc; this one is of xyz"));
        let refused = parsed(b"touchstone checkpoint 1 abc\n").unwrap_err();
        assert!(refused.contains("not a checkpoint of format 3"), "{refused}");
        let refused = parsed(&file[..file.len() - 1]).unwrap_err();
        assert!(refused.contains("damaged or truncated"), "{refused}");
    }
}
