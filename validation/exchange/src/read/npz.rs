//! Arrays of NumPy, one a column: `np.savez(file, t=t, id=id, x=x, y=y, u=u, v=v, density=density)`. `t` may
//! be one number for the whole file.

use std::io::Read;

use flate2::bufread::DeflateDecoder;
use rawzip::{CompressionMethod, ZipArchive};

use touchstone_base::text::short;

use super::{MOST_ROWS, Renamed, Rows, binary, columns::Heads, of_arrays};
use crate::flaw::Flaw;

/// Every array in the format of NumPy begins with these bytes.
const MAGIC: &[u8] = b"\x93NUMPY";

pub fn rows(file: &str, bytes: &[u8], renamed: &Renamed) -> Result<Rows, Vec<Flaw>> {
    let unread = |reason: rawzip::Error| vec![Flaw::of(file, reason.to_string())];
    let archive = ZipArchive::from_slice(bytes).map_err(unread)?;
    let (mut heads, mut arrays) = (Vec::new(), Vec::new());
    let mut entries = archive.entries();
    while let Some(entry) = entries.next_entry().map_err(unread)? {
        let name = String::from_utf8_lossy(entry.file_path().as_bytes());
        heads.push(name.trim_end_matches(".npy").to_string());
        arrays.push((entry.compression_method(), entry.wayfinder()));
    }
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    of_arrays(file, &Heads::new(&heads, renamed, &[]), |place| {
        let (method, place) = arrays[place];
        let entry = archive.get_entry(place).map_err(|reason| reason.to_string())?;
        match method {
            CompressionMethod::STORE => numbers(&mut entry.verifying_reader(entry.data())),
            CompressionMethod::DEFLATE => {
                numbers(&mut entry.verifying_reader(DeflateDecoder::new(entry.data())))
            }
            other => Err(format!("its compression is {other:?}; expected none or deflate")),
        }
    })
}

/// The numbers of an array of floats or of whole numbers: magic, version, length of the head, head, data.
fn numbers(array: &mut dyn Read) -> Result<Vec<f64>, String> {
    let mut bytes = Vec::new();
    let most = 8 * MOST_ROWS as u64 + (1 << 16); // numbers and head
    array.take(most + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if bytes.len() as u64 > most {
        return Err(format!(
            "it has more than {MOST_ROWS} numbers; expected fewer particles or times"
        ));
    }
    let rest = bytes.strip_prefix(MAGIC).ok_or("it is no array of NumPy")?;
    let (length, rest) = match rest {
        [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        _ => return Err("its version is not 1, 2 or 3".into()),
    };
    let (head, data) = rest.split_at_checked(length).ok_or("it ends within its head")?;
    let head = String::from_utf8_lossy(head);
    if head.contains("'fortran_order': True") {
        return Err("it has Fortran order; expected C order".into());
    }
    let kind = head.split("'descr':").nth(1).and_then(|rest| rest.split('\'').nth(1));
    let values = binary::numbers(binary::NumberFormat::of_numpy(kind.unwrap_or_default())?, data)?;
    let shape = head.split("'shape': (").nth(1).and_then(|rest| rest.split(')').next());
    let sizes = shape.unwrap_or_default().split(',').filter(|size| !size.trim().is_empty());
    let mut count = sizes.map(|size| size.trim().parse::<usize>().ok());
    let count = count.try_fold(1_usize, |all, size| all.checked_mul(size?));
    let (found, said) = (values.len(), shape.unwrap_or_default());
    match count {
        Some(count) if count == found => Ok(values),
        _ => Err(format!("it has {found} numbers; its head says ({})", short(said))),
    }
}
