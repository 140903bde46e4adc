//! ParaView files: particles as `UnstructuredGrid` (`.vtu`), a run as a collection (`.pvd`).
//!
//! Arrays are base64 in the file, so floats are stored without loss. Each particle has a cell of its own:
//! without cells ParaView opens the file and shows nothing. The plane is z = 0, and vectors get a third
//! component of zero, because the filters of ParaView expect three. Positions must be finite. Fields may
//! contain NaN: ParaView draws it in a separate colour, which helps to inspect a diverged state.
//!
//! ```
//! use touchstone_base::{record::Profile, vtk};
//! let place = Profile::default().with("x", "m", vec![0.0, 1.0]).with("y", "m", vec![0.0, 0.5]);
//! let velocity = place.with("u", "m/s", vec![0.1, 0.2]).with("v", "m/s", vec![0.0; 2]);
//! let file = vtk::particles(0.25, &velocity.with("p", "Pa", vec![1.0, 2.0]))?;
//! let collection = vtk::collection(&[(0.25, "particles_0001.vtu".into())]);
//! # assert!(file.contains("<Cells>") && collection.contains("timestep=\"0.25\""));
//! # Ok::<(), std::io::Error>(())
//! ```

use std::collections::BTreeSet;
use std::fmt::Write;
use std::io;

use crate::{
    record::Profile,
    text::{base64, escaped},
};

/// Two columns as vectors in the plane z = 0.
fn vectors(columns: &Profile, names: [&str; 2]) -> Vec<[f64; 3]> {
    let [x, y] = names.map(|name| columns.column(name));
    x.iter().zip(y).map(|(x, y)| [*x, *y, 0.0]).collect()
}

/// The text of a `.vtu` file: particles at one time. The columns `x` and `y` are the positions, `u` and `v`
/// the array `velocity`, and each other column is an array.
///
/// # Errors
/// If a place is not finite, an array has another length, or two have one name.
pub fn particles(time: f64, columns: &Profile) -> io::Result<String> {
    let [points, velocities] = [["x", "y"], ["u", "v"]].map(|names| vectors(columns, names));
    let is_lost = |[x, y, _]: &[f64; 3]| !(x.is_finite() && y.is_finite());
    if let Some(particle) = points.iter().position(is_lost) {
        let [x, y, _] = points[particle];
        let place = format!("particle {particle} is at ({x}, {y})");
        return Err(io::Error::other(format!("{place}, which is not finite")));
    }
    let count = points.len();
    let mut xml = String::from(concat!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" ",
        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n"
    ));
    let one_tuple = "Name=\"TimeValue\" NumberOfTuples=\"1\"";
    data_array(&mut xml, "Float64", one_tuple, &floats(&[time]));
    let _ = write!(
        xml,
        "</FieldData>\n<Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{count}\">\n\
         <PointData>\n"
    );
    let others = columns.columns.iter().filter(|c| !["x", "y", "u", "v"].contains(&&*c.name));
    let others = others.map(|column| (&*column.name, 1, &*column.values));
    let mut names = BTreeSet::new();
    for (name, components, values) in
        [("velocity", 3, velocities.as_flattened())].into_iter().chain(others)
    {
        let found = values.len() / components;
        if found != count {
            let words = format!("array {name} has {found} values for {count} particles");
            return Err(io::Error::other(words));
        }
        if !names.insert(name) {
            return Err(io::Error::other(format!("there are two arrays called {name}")));
        }
        let attributes = format!("Name=\"{}\" NumberOfComponents=\"{components}\"", escaped(name));
        data_array(&mut xml, "Float64", &attributes, &floats(values));
    }
    xml.push_str("</PointData>\n<Points>\n");
    let attributes = "Name=\"Points\" NumberOfComponents=\"3\"";
    data_array(&mut xml, "Float64", attributes, &floats(points.as_flattened()));
    xml.push_str("</Points>\n<Cells>\n");
    data_array(&mut xml, "Int64", "Name=\"connectivity\"", &integers(0..count));
    data_array(&mut xml, "Int64", "Name=\"offsets\"", &integers(1..count + 1));
    // Type 1 is a single point.
    data_array(&mut xml, "UInt8", "Name=\"types\"", &vec![1; count]);
    xml.push_str("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    Ok(xml)
}

/// The text of a `.pvd` file: the files of a run by time, with their paths relative to it.
pub fn collection(files: &[(f64, String)]) -> String {
    let mut xml = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n",
    );
    for (time, file) in files {
        let file = escaped(file);
        let _ = writeln!(xml, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>");
    }
    xml.push_str("</Collection>\n</VTKFile>\n");
    xml
}

fn floats(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn integers(values: impl Iterator<Item = usize>) -> Vec<u8> {
    values.flat_map(|value| (value as i64).to_le_bytes()).collect()
}

/// One `DataArray`: the number of bytes and the bytes, encoded together.
fn data_array(xml: &mut String, kind: &str, attributes: &str, bytes: &[u8]) {
    let mut block = (bytes.len() as u64).to_le_bytes().to_vec();
    block.extend_from_slice(bytes);
    let text = base64(&block);
    let _ = writeln!(
        xml,
        "<DataArray type=\"{kind}\" {attributes} format=\"binary\">{text}</DataArray>"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::from_base64;

    /// Reads the tags of a document and checks that every one is closed in order.
    fn tags(xml: &str) -> Vec<String> {
        let (mut open, mut all) = (Vec::new(), Vec::new());
        for tag in xml.split('<').skip(1).map(|rest| rest.split('>').next().unwrap()) {
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(name.to_string()), "closed out of order");
            } else if !tag.starts_with('?') && !tag.ends_with('/') {
                open.push(tag.split(' ').next().unwrap().to_string());
            }
            all.push(tag.to_string());
        }
        assert!(open.is_empty(), "not closed: {open:?}");
        all
    }

    /// The bytes of a named array, after checking that its header agrees with its length.
    fn array(xml: &str, name: &str) -> Vec<u8> {
        let tag = format!("Name=\"{name}\"");
        let content = xml.split(&tag).nth(1).unwrap().split(['<', '>']).nth(1).unwrap();
        let bytes = from_base64(content).unwrap();
        let (header, data) = bytes.split_first_chunk::<8>().unwrap();
        assert_eq!(u64::from_le_bytes(*header), data.len() as u64);
        data.to_vec()
    }

    fn placed(x: &[f64], y: &[f64]) -> Profile {
        let place = Profile::default().with("x", "m", x.to_vec()).with("y", "m", y.to_vec());
        place.with("u", "m/s", x.to_vec()).with("v", "m/s", y.to_vec())
    }

    #[test]
    fn a_file_is_well_formed_and_its_counts_agree() {
        let columns = placed(&[0.1, 0.3, 0.5], &[0.2, 0.4, 0.6]);
        let columns = columns.with("p & <q>", "Pa", vec![1.0, f64::NAN, 3.0]);
        let xml = particles(0.5, &columns).unwrap();
        let tags = tags(&xml);
        assert_eq!(tags.iter().filter(|tag| tag.starts_with("DataArray")).count(), 7);
        assert!(xml.contains("NumberOfPoints=\"3\" NumberOfCells=\"3\""));
        assert!(xml.contains("Name=\"p &amp; &lt;q&gt;\""));
        assert_eq!(array(&xml, "TimeValue"), 0.5_f64.to_le_bytes());
        let flat = floats(&[0.1, 0.2, 0.0, 0.3, 0.4, 0.0, 0.5, 0.6, 0.0]);
        assert_eq!(array(&xml, "Points"), flat);
        assert_eq!(array(&xml, "velocity"), flat);
        assert_eq!(array(&xml, "connectivity"), integers([0, 1, 2].into_iter()));
        assert_eq!(array(&xml, "offsets"), integers([1, 2, 3].into_iter()));
        assert_eq!(array(&xml, "types"), [1; 3]);
        assert_eq!(array(&xml, "p &amp; &lt;q&gt;").len(), 24);
    }

    #[test]
    fn no_particles_are_a_file_too() {
        let xml = particles(0.0, &Profile::default().with("p", "Pa", Vec::new())).unwrap();
        tags(&xml);
        assert!(array(&xml, "connectivity").is_empty());
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_name() {
        let refused = |columns: Profile| particles(0.0, &columns).unwrap_err().to_string();
        let two = || placed(&[0.0, 1.0], &[0.0, 0.0]);
        let error = refused(two().with("rho", "kg/m^3", vec![1.0]));
        assert_eq!(error, "array rho has 1 values for 2 particles");
        let twice = two().with("rho", "-", vec![1.0; 2]).with("rho", "-", vec![1.0; 2]);
        assert_eq!(refused(twice), "there are two arrays called rho");
        let error = refused(placed(&[0.0], &[f64::NAN]));
        assert_eq!(error, "particle 0 is at (0, NaN), which is not finite");
    }

    #[test]
    fn a_collection_lists_its_files_in_order() {
        let xml = collection(&[(0.0, "a.vtu".into()), (1e-9, "b&c.vtu".into())]);
        let tags = tags(&xml);
        assert_eq!(tags[3], "DataSet timestep=\"0.0\" part=\"0\" file=\"a.vtu\"/");
        assert_eq!(tags[4], "DataSet timestep=\"1e-9\" part=\"0\" file=\"b&amp;c.vtu\"/");
    }
}
