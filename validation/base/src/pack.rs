//! Texts that a build script compressed into one file: two fifths of the program would be references.

use std::collections::BTreeMap;
use std::io::Read;

use flate2::read::DeflateDecoder;

/// The texts of a packed file by `FOLDER/FILE`. Tests read every text of the program.
pub fn read(packed: &[u8]) -> BTreeMap<String, String> {
    let mut all = String::new();
    let _ = DeflateDecoder::new(packed).read_to_string(&mut all);
    let mut parts = all.split('\0').map(String::from);
    std::iter::from_fn(|| Some((parts.next()?, parts.next()?))).collect()
}
