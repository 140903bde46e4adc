//! HDF5: one dataset a column, at the root of the file, or in one group a frame at the root. `t` may be one
//! number. Links to other files are not followed.

use std::path::Path;

use hdf5_reader::{Dataset, Datatype, H5Type, Hdf5File, OpenOptions, error::Error, group::Group};

use touchstone_base::{files, text::short};

use super::{MOST_BYTES, MOST_ROWS, Renamed, Rows, columns::Heads, number_in, of_arrays, too_many};
use crate::flaw::Flaw;

/// Largest size of a number in bytes.
const WIDEST: usize = 8;

/// The rows of the frames of a file.
pub fn rows(file: &str, path: &Path, renamed: &Renamed) -> Result<Vec<Rows>, Vec<Flaw>> {
    let regular = files::check_regular(path, MOST_BYTES);
    regular.map_err(|reason| vec![Flaw::of(file, format!("cannot be read: {reason}"))])?;
    let flaw = |error: Error| vec![Flaw::of(file, error.to_string())];
    let options = OpenOptions::default()
        .with_max_read_bytes(WIDEST * MOST_ROWS)
        .with_max_chunk_bytes(WIDEST * MOST_ROWS);
    let root = Hdf5File::open_with_options(path, options).and_then(|file| file.root_group());
    let root = root.map_err(flaw)?;
    let (mut groups, datasets) = root.members().map_err(flaw)?;
    if !datasets.is_empty() {
        return Ok(vec![frame(file, &root, renamed)?]);
    }
    groups.sort_by_key(|group| (number_in(group.name()), group.name().to_string()));
    if groups.is_empty() {
        let what = "it has neither datasets nor groups; expected a column each";
        return Err(vec![Flaw::of(file, what)]);
    }
    let (mut all, mut count) = (Vec::new(), 0);
    for group in groups {
        let rows = frame(&format!("{file}, group {}", group.name()), &group, renamed)?;
        count += rows.len();
        all.push(rows);
        if count > MOST_ROWS {
            return Err(vec![too_many(file)]);
        }
    }
    Ok(all)
}

fn frame(file: &str, group: &Group, renamed: &Renamed) -> Result<Rows, Vec<Flaw>> {
    let datasets = group.datasets().map_err(|error| vec![Flaw::of(file, error.to_string())])?;
    let heads: Vec<&str> = datasets.iter().map(Dataset::name).collect();
    of_arrays(file, &Heads::new(&heads, renamed, &[]), |place| numbers(&datasets[place]))
}

/// The numbers of a dataset with one dimension, or of one number.
fn numbers(of: &Dataset) -> Result<Vec<f64>, String> {
    if of.ndim() > 1 {
        return Err(format!("it has {} dimensions; expected one", of.ndim()));
    }
    fn all<T: H5Type>(of: &Dataset, number: fn(T) -> f64) -> Result<Vec<f64>, String> {
        let numbers = of.read_array::<T>().map_err(|error| error.to_string())?;
        Ok(numbers.into_iter().map(number).collect())
    }
    match of.dtype() {
        Datatype::FloatingPoint { size: 8, .. } => all(of, |number: f64| number),
        Datatype::FloatingPoint { size: 4, .. } => all(of, |number: f32| number.into()),
        Datatype::FixedPoint { size: 8, signed: true, .. } => all(of, |number: i64| number as f64),
        Datatype::FixedPoint { size: 4, signed: true, .. } => all(of, |number: i32| number.into()),
        Datatype::FixedPoint { size: 2, signed: true, .. } => all(of, |number: i16| number.into()),
        Datatype::FixedPoint { size: 1, signed: true, .. } => all(of, |number: i8| number.into()),
        Datatype::FixedPoint { size: 8, .. } => all(of, |number: u64| number as f64),
        Datatype::FixedPoint { size: 4, .. } => all(of, |number: u32| number.into()),
        Datatype::FixedPoint { size: 2, .. } => all(of, |number: u16| number.into()),
        Datatype::FixedPoint { size: 1, .. } => all(of, |number: u8| number.into()),
        other => Err(format!(
            "its type is {}; expected floats of 4 or 8 bytes, or whole numbers of 1, 2, 4 or 8",
            short(&format!("{other:?}"))
        )),
    }
}
