//! Errors and run times of other codes, from the tables of references.

use base::reference::{Reference, ReferenceError, Table};
use harness::declare::Peer;

/// The rows of the table `errors` of a package that `is_like` keeps and whose time was measured. `resolution`
/// and `error`, in per cent, are columns; `label` puts a resolution in words.
pub fn peers(
    package: &str,
    [resolution, error]: [&str; 2],
    label: impl Fn(f64) -> String,
    timed: &str,
    is_like: impl Fn(&Table) -> Result<Vec<bool>, ReferenceError>,
) -> Result<Vec<Peer>, ReferenceError> {
    let package = Reference::load(package)?;
    let table = package.table("errors")?;
    let (codes, schemes) = (table.texts("code")?, table.texts("scheme")?);
    let (resolutions, errors) = (table.optional(resolution)?, table.optional(error)?);
    let (seconds, is_like) = (table.optional("seconds")?, is_like(table)?);
    let peer = |k: usize| {
        Some(Peer {
            name: format!("{}, {}", codes[k], schemes[k]),
            label: label(resolutions[k]?),
            seconds: seconds[k]?,
            error: errors[k]? / 100.0,
            timed: timed.into(),
        })
    };
    Ok((0..codes.len()).filter(|k| is_like[*k]).filter_map(peer).collect())
}
