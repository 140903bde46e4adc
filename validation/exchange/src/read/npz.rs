//! Arrays of NumPy, one a column: `np.savez(file, t=t, id=id, x=x, y=y, u=u, v=v, density=density)`. `t` may
//! be one number for the whole file.

use std::collections::BTreeMap;
use std::path::Path;

use npyz::npz::NpzArchive;

use super::{COLUMNS, MOST_BYTES, Renamed, Rows, places};
use crate::flaw::Flaw;

pub fn rows(file: &str, path: &Path, renamed: &Renamed) -> Result<Rows, Vec<Flaw>> {
    let flaw = |what: String| vec![Flaw::of(file, what)];
    let unread = |reason: std::io::Error| flaw(format!("cannot be read: {reason}"));
    let size = std::fs::metadata(path).map_err(unread)?;
    if !size.is_file() || size.len() > MOST_BYTES {
        return Err(flaw(format!("it is no regular file of at most {MOST_BYTES} bytes")));
    }
    let mut archive = NpzArchive::open(path).map_err(unread)?;
    let names: Vec<String> = archive.array_names().map(String::from).collect();
    let heads: Vec<&str> = names.iter().map(String::as_str).collect();
    let places = places(file, 1, &heads, renamed, &[])?;
    let mut columns: BTreeMap<&'static str, Vec<f64>> = BTreeMap::new();
    for (name, place) in places {
        let unread = |what: String| vec![Flaw::of(file, what).in_column(name)];
        let array = archive.by_name(&names[place]).map_err(|e| unread(e.to_string()))?;
        let Some(array) = array else { return Err(unread("it is missing".into())) };
        if array.len() > MOST_BYTES / 8 {
            return Err(unread(format!("it has {} numbers; that is too many", array.len())));
        }
        columns.insert(name, numbers(array).map_err(unread)?);
    }
    let rows = columns.get("x").map_or(0, Vec::len);
    if let Some(times) = columns.get_mut("t").filter(|times| times.len() == 1) {
        *times = vec![times[0]; rows];
    }
    for (name, ..) in COLUMNS {
        if let Some(other) = columns.get(name).map(Vec::len).filter(|other| *other != rows) {
            let what = format!("it has {other} numbers; expected {rows}, as many as x");
            return Err(vec![Flaw::of(file, what).in_column(name)]);
        }
    }
    Ok(Rows { file: file.into(), first_line: 1, columns })
}

/// The numbers of an array of floats or of whole numbers.
fn numbers<R: std::io::Read>(array: npyz::NpyFile<R>) -> Result<Vec<f64>, String> {
    let what = format!("it is an array of {}; expected f8, f4 or i8", array.dtype().descr());
    let array = match array.try_data::<f64>() {
        Ok(data) => return data.collect::<Result<_, _>>().map_err(|e| e.to_string()),
        Err(array) => array,
    };
    let array = match array.try_data::<f32>() {
        Ok(data) => {
            return data
                .map(|x| x.map(f64::from))
                .collect::<Result<_, _>>()
                .map_err(|e| e.to_string());
        }
        Err(array) => array,
    };
    match array.try_data::<i64>() {
        Ok(data) => {
            data.map(|x| x.map(|x| x as f64)).collect::<Result<_, _>>().map_err(|e| e.to_string())
        }
        Err(_) => Err(what),
    }
}
