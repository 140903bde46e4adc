//! Arrays of NumPy: valid ones, and archives that are damaged or much larger than they look.

use std::io::Write;

use flate2::{Compression, write::DeflateEncoder};
use rawzip::{CompressionMethod, ZipArchiveWriter};
use touchstone_exchange::read::{Renamed, read};

/// An array of floats with an arbitrary head.
fn array(order: &str, shape: &str, numbers: &[f64]) -> Vec<u8> {
    let numbers: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    of_kind("<f8", order, shape, &numbers)
}

/// An array of numbers of a kind.
fn of_kind(kind: &str, order: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
    let head = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': ({shape}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((head.len() as u16).to_le_bytes());
    bytes.extend(head.as_bytes());
    bytes.extend(numbers);
    bytes
}

/// An archive with three particles, of which one array is another one.
fn archive(changed: &str, bytes: &[u8], method: CompressionMethod) -> Vec<u8> {
    let mut all = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut all);
    for name in ["t", "id", "x", "y", "u", "v"] {
        let numbers = if name == "t" { &[0.5][..] } else { &[0.0, 1.0, 2.0] };
        let whole = array("False", &format!("{},", numbers.len()), numbers);
        let bytes = if name == changed { bytes } else { &whole };
        let name = format!("{name}.npy");
        let file = archive.new_file(&name).compression_method(method);
        let (mut entry, config) = file.start().unwrap();
        let descriptor = if method == CompressionMethod::STORE {
            let mut writer = config.wrap(&mut entry);
            writer.write_all(bytes).unwrap();
            writer.finish().unwrap().1
        } else {
            let encoder = DeflateEncoder::new(&mut entry, Compression::default());
            let mut writer = config.wrap(encoder);
            writer.write_all(bytes).unwrap();
            let (encoder, descriptor) = writer.finish().unwrap();
            encoder.finish().unwrap();
            descriptor
        };
        entry.finish(descriptor).unwrap();
    }
    archive.finish().unwrap();
    all
}

/// The message for an archive; empty if it is read.
fn said(archive: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
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

/// `savez` stores arrays as they are, `savez_compressed` deflates them. Every byte counts: of an archive that
/// was cut, or of whose array a byte was changed, nothing is read.
#[test]
fn an_archive_is_read_whole_or_not_at_all() {
    for method in [CompressionMethod::STORE, CompressionMethod::DEFLATE] {
        let whole = archive("", &[], method);
        assert_eq!(said(&whole), "", "{method:?}");
        for length in [0, 10, whole.len() / 2, whole.len() - 1] {
            assert!(said(&whole[..length]).starts_with("a.npz"), "{method:?}, {length}");
        }
    }
    let mut changed = archive("", &[], CompressionMethod::STORE);
    let place = changed.windows(4).position(|bytes| bytes == b"PK\x07\x08").unwrap();
    changed[place - 1] ^= 1; // the last byte of the first array
    assert!(said(&changed).contains("column t"), "{}", said(&changed));
    // A wrong checksum of the array: the four bytes in its directory and after its data.
    for method in [CompressionMethod::STORE, CompressionMethod::DEFLATE] {
        let mut changed = archive("", &[], method);
        for (mark, sum) in [(b"PK\x01\x02", 16), (b"PK\x07\x08", 4)] {
            let place = changed.windows(4).position(|bytes| bytes == mark).unwrap();
            changed[place + sum] ^= 1;
        }
        assert!(said(&changed).contains("column t"), "{method:?}: {}", said(&changed));
    }
    let unknown = said(&archive("", &[], CompressionMethod::ZSTD));
    assert!(unknown.contains("expected none or deflate"), "{unknown}");
}

#[test]
fn damaged_arrays_are_refused_by_name() {
    let three = [0.0, 1.0, 2.0];
    for (what, changed, bytes, expected) in [
        ("columns first", "x", array("True", "3,", &three), "Fortran order"),
        ("cut", "y", array("False", "3,", &three[..2]), "it has 2 numbers; its head says (3,)"),
        ("overflow", "u", array("False", "4294967296, 4294967296", &three), "its head says"),
        ("a row more", "v", array("False", "4,", &[0.0; 4]), "it has 4 numbers; expected 3"),
        ("longer than its head", "v", array("False", "3,", &[0.0; 4]), "its head says (3,)"),
        ("one number for all", "u", array("False", "1,", &[0.0]), "it has 1 numbers; expected 3"),
        ("one id for all", "id", array("False", "1,", &[0.0]), "it has 1 numbers; expected 3"),
        ("half floats", "y", of_kind("<f2", "False", "3,", &[0; 6]), "its type is <f2"),
        ("objects", "y", of_kind("|O", "False", "3,", &[0; 24]), "its type is |O"),
        (
            "a head of letters",
            "y",
            of_kind(&"x".repeat(9000), "False", "3,", &[]),
            "xxx... (9000 b",
        ),
        ("no array", "id", b"PK".to_vec(), "no array of NumPy"),
        // 30 million zeros take 0.2 MB of the archive.
        ("a bomb", "x", array("False", "30000000,", &vec![0.0; 30_000_000]), "more than 3000000"),
    ] {
        let words = said(&archive(changed, &bytes, CompressionMethod::DEFLATE));
        assert!(words.starts_with(&format!("a.npz, column {changed}: ")), "{what}: {words}");
        assert!(words.contains(expected), "{what}: expected {expected:?} in {words}");
    }
}

/// Integers of every width and byte order are ids.
#[test]
fn ids_are_whole_numbers_of_every_width() {
    let mut kinds = 0;
    for of in ["i", "u"] {
        for width in [1, 2, 4, 8] {
            for order in if width == 1 { &["|"][..] } else { &["<", ">"] } {
                let id = |k: u64| match *order {
                    ">" => k.to_be_bytes()[8 - width..].to_vec(),
                    _ => k.to_le_bytes()[..width].to_vec(),
                };
                let numbers: Vec<u8> = [2, 0, 1].into_iter().flat_map(id).collect();
                let kind = format!("{order}{of}{width}");
                let bytes = of_kind(&kind, "False", "3,", &numbers);
                let archive = archive("id", &bytes, CompressionMethod::STORE);
                assert_eq!(said(&archive), "", "{kind}");
                kinds += 1;
            }
        }
    }
    assert_eq!(kinds, 14);
}
