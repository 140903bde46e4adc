//! Frames of HDF5 as `h5py` writes them, and damaged files. `frames.h5` and `table.h5` were written by
//!
//! ```python
//! import h5py, numpy as np
//! ids = np.arange(3)
//! columns = lambda t: dict(t=t, id=ids, x=ids + t, y=-ids + t, u=np.float32(ids / 4), v=ids * 1e-3,
//!                          density=1000.0 + ids)
//! with h5py.File("frames.h5", "w") as f:           # a group a frame; 10 comes after 9
//!     for k in (9, 10):
//!         for name, value in columns(k / 2).items():
//!             f.create_dataset(f"Step#{k}/{name}", data=value)
//! with h5py.File("table.h5", "w", libver="latest") as f:  # one table, in compressed chunks
//!     for name in columns(0.0):
//!         rows = [np.broadcast_to(columns(k / 2)[name], 3) for k in (9, 10)]
//!         f.create_dataset(name, data=np.concatenate(rows), chunks=(4,), compression="gzip",
//!                          shuffle=True)
//! ```

use std::fs;
use std::path::Path;

use touchstone_exchange::read::{Renamed, Results, read};

fn fixture(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name)).unwrap()
}

/// The content of a file with these bytes, or its flaws.
fn read_as(name: &str, bytes: &[u8]) -> Result<Results, String> {
    let folder = tempfile::tempdir().unwrap();
    read_in(folder.path(), name, bytes)
}

fn read_in(folder: &Path, name: &str, bytes: &[u8]) -> Result<Results, String> {
    fs::write(folder.join(name), bytes).unwrap();
    let flaws = |flaws: Vec<touchstone_exchange::flaw::Flaw>| {
        flaws.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    read(folder, &Renamed::new()).map_err(flaws)
}

#[test]
fn groups_of_frames_and_compressed_tables_are_read() {
    for name in ["frames.h5", "table.h5"] {
        let results = read_as(name, &fixture(name)).unwrap();
        let times: Vec<f64> = results.frames.iter().map(|frame| frame.time).collect();
        assert_eq!(times, [4.5, 5.0], "{name}");
        for frame in &results.frames {
            assert_eq!(frame.particles.len(), 3, "{name}");
            for (k, particle) in frame.particles.iter().enumerate() {
                let n = k as f64;
                assert_eq!(particle.id as usize, k, "{name}");
                assert_eq!(particle.position.as_slice(), [n + frame.time, frame.time - n]);
                assert_eq!(particle.velocity.as_slice(), [n / 4.0, n * 1e-3], "{name}");
                assert_eq!(particle.density, Some(1000.0 + n), "{name}");
            }
        }
    }
}

/// Cut at any length, or with any byte changed: never a panic, and never a number that is not finite.
#[test]
fn damaged_files_are_refused_or_read_but_never_panic() {
    for name in ["frames.h5", "table.h5"] {
        let whole = fixture(name);
        let (folder, mut refused) = (tempfile::tempdir().unwrap(), 0);
        for at in (0..whole.len()).step_by(31) {
            let mut changed = whole.clone();
            changed[at] ^= 0xff;
            for bytes in [&whole[..at], &changed] {
                match read_in(folder.path(), name, bytes) {
                    Ok(results) => assert!(results.frames.iter().all(|f| f.time.is_finite())),
                    Err(words) => {
                        assert!(words.contains(name), "{at}: {words}");
                        refused += 1;
                    }
                }
            }
        }
        assert!(refused > whole.len() / 62, "{name}: only {refused} were refused");
    }
}

#[test]
fn what_is_missing_or_too_wide_is_named() {
    for (name, part) in [("wide.h5", "column x: it has 2 dimensions"), ("text.h5", "column u")] {
        let words = read_as(name, &fixture(name)).unwrap_err();
        assert!(words.contains(part), "{words}");
    }
}
