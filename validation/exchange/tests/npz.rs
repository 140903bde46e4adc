//! Arrays of NumPy: what is read, and archives that are damaged or much larger than they look.

use std::io::{Cursor, Write};

use exchange::read::{Renamed, read};
use zip::{ZipWriter, write::SimpleFileOptions};

/// An array of floats with a head that says what it likes.
fn array(order: &str, shape: &str, numbers: &[f64]) -> Vec<u8> {
    let head = format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': ({shape}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((head.len() as u16).to_le_bytes());
    bytes.extend(head.as_bytes());
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}

/// What is said of an archive with three particles, of which one array is another one; nothing if it is read.
fn said(changed: &str, bytes: &[u8]) -> String {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for name in ["t", "id", "x", "y", "u", "v"] {
        archive.start_file(format!("{name}.npy"), SimpleFileOptions::default()).unwrap();
        let numbers = if name == "t" { &[0.5][..] } else { &[0.0, 1.0, 2.0] };
        let whole = array("False", &format!("{},", numbers.len()), numbers);
        archive.write_all(if name == changed { bytes } else { &whole }).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let archive = archive.finish().unwrap().into_inner();
    std::fs::write(folder.path().join("a.npz"), archive).unwrap();
    match read(folder.path(), &Renamed::new()) {
        Ok(results) => {
            assert_eq!(results.frames.len(), 1);
            assert_eq!(results.frames[0].time, 0.5);
            assert_eq!(results.frames[0].particles.len(), 3);
            String::new()
        }
        Err(flaws) => flaws.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"),
    }
}

#[test]
fn damaged_arrays_are_refused_by_name() {
    let three = [0.0, 1.0, 2.0];
    assert_eq!(said("", &[]), "");
    for (what, changed, bytes, expected) in [
        ("columns first", "x", array("True", "3,", &three), "order of Fortran"),
        ("cut", "y", array("False", "3,", &three[..2]), "it has 2 numbers; its head says (3,)"),
        ("overflow", "u", array("False", "4294967296, 4294967296", &three), "its head says"),
        ("a row more", "v", array("False", "4,", &[0.0; 4]), "it has 4 numbers; expected 3"),
        ("no array", "id", b"PK".to_vec(), "no array of NumPy"),
        // 30 million zeros take 0.2 MB of the archive.
        ("a bomb", "x", array("False", "30000000,", &vec![0.0; 30_000_000]), "more than 3000000"),
    ] {
        let words = said(changed, &bytes);
        assert!(words.starts_with(&format!("a.npz, column {changed}: ")), "{what}: {words}");
        assert!(words.contains(expected), "{what}: expected {expected:?} in {words}");
    }
}
