//! ParaView files: particles as `PolyData` (`.vtp`), a run as a collection (`.pvd`).
//!
//! Arrays are base64 in the file, so floats are stored without loss. `Verts` are always written: without
//! them ParaView opens the file and shows nothing. The plane is z = 0, and vectors get a third
//! component that is zero, because the filters of ParaView expect three.
//! Positions must be finite. Fields may hold a NaN: ParaView draws it in a colour of its own,
//! and a state that diverged is worth inspecting.
//!
//! ```
//! use base::vtk::{Collection, Particles};
//! let positions = [[0.0, 0.0], [1.0, 0.5]];
//! let file = Particles::new(0.25, &positions)?
//!     .scalar("p", &[1.0, 2.0])?
//!     .vector("v", &[[0.1, 0.0], [0.2, 0.0]])?
//!     .to_xml();
//! let mut collection = Collection::default();
//! collection.push(0.25, "particles_0001.vtp");
//! # assert!(file.contains("<Verts>") && collection.to_xml().contains("timestep=\"0.25\""));
//! # Ok::<(), base::vtk::VtkError>(())
//! ```

use std::fmt::Write;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::text::{base64, escaped};

/// Why particles cannot be written, in words.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{0}")]
pub struct VtkError(String);

/// Particles at one time, with their fields.
#[derive(Debug, Clone)]
pub struct Particles {
    time: f64,
    points: Vec<[f64; 3]>,
    arrays: Vec<Array>,
}

#[derive(Debug, Clone)]
struct Array {
    name: String,
    components: usize,
    values: Vec<f64>,
}

impl Particles {
    /// Particles at their positions: arrays of two numbers or nalgebra's `Vector2`.
    pub fn new<P: Copy + Into<[f64; 2]>>(time: f64, positions: &[P]) -> Result<Self, VtkError> {
        let points: Vec<[f64; 3]> = positions.iter().map(|position| lift(*position)).collect();
        for (particle, [x, y, _]) in points.iter().copied().enumerate() {
            if !(x.is_finite() && y.is_finite()) {
                let place = format!("particle {particle} is at ({x}, {y})");
                return Err(VtkError(format!("{place}, which is not finite")));
            }
        }
        Ok(Particles { time, points, arrays: Vec::new() })
    }

    /// Adds a field with one number a particle.
    pub fn scalar(self, name: &str, values: &[f64]) -> Result<Self, VtkError> {
        self.array(name, 1, values.len(), values.to_vec())
    }

    /// Adds a field with a plane vector a particle.
    pub fn vector<P: Copy + Into<[f64; 2]>>(
        self,
        name: &str,
        values: &[P],
    ) -> Result<Self, VtkError> {
        let lifted = values.iter().flat_map(|value| lift(*value)).collect();
        self.array(name, 3, values.len(), lifted)
    }

    /// Adds a field with three numbers a particle, such as a symmetric stress.
    pub fn triple(self, name: &str, values: &[[f64; 3]]) -> Result<Self, VtkError> {
        self.array(name, 3, values.len(), values.as_flattened().to_vec())
    }

    fn array(
        mut self,
        name: &str,
        components: usize,
        found: usize,
        values: Vec<f64>,
    ) -> Result<Self, VtkError> {
        let expected = self.points.len();
        if found != expected {
            let words = format!("array {name} has {found} values for {expected} particles");
            return Err(VtkError(words));
        }
        if self.arrays.iter().any(|known| known.name == name) {
            return Err(VtkError(format!("there are two arrays called {name}")));
        }
        self.arrays.push(Array { name: name.into(), components, values });
        Ok(self)
    }

    /// The text of a `.vtp` file.
    pub fn to_xml(&self) -> String {
        let count = self.points.len();
        let mut xml = String::from(concat!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" ",
            "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n"
        ));
        let one_tuple = "Name=\"TimeValue\" NumberOfTuples=\"1\"";
        data_array(&mut xml, "Float64", one_tuple, &floats(&[self.time]));
        let _ = write!(
            xml,
            "</FieldData>\n<Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" \
             NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData>\n"
        );
        for Array { name, components, values } in &self.arrays {
            let attributes =
                format!("Name=\"{}\" NumberOfComponents=\"{components}\"", escaped(name));
            data_array(&mut xml, "Float64", &attributes, &floats(values));
        }
        xml.push_str("</PointData>\n<Points>\n");
        let attributes = "Name=\"Points\" NumberOfComponents=\"3\"";
        data_array(&mut xml, "Float64", attributes, &floats(self.points.as_flattened()));
        xml.push_str("</Points>\n<Verts>\n");
        data_array(&mut xml, "Int64", "Name=\"connectivity\"", &integers(0..count));
        data_array(&mut xml, "Int64", "Name=\"offsets\"", &integers(1..count + 1));
        xml.push_str("</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n");
        xml
    }
}

/// The files of a run by time: the text of a `.pvd` file.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Collection {
    files: Vec<(f64, String)>,
}

impl Collection {
    /// Adds a file, by its path relative to the collection.
    pub fn push(&mut self, time: f64, file: &str) {
        self.files.push((time, file.into()));
    }

    /// Forgets the files of which this is false.
    pub fn retain(&mut self, is_there: impl Fn(&str) -> bool) {
        self.files.retain(|(_, file)| is_there(file));
    }

    /// Number of files.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// Is there no file yet?
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// The text of the `.pvd` file; write it again after every added file.
    pub fn to_xml(&self) -> String {
        let mut xml = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n",
        );
        for (time, file) in &self.files {
            let file = escaped(file);
            let _ = writeln!(xml, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>");
        }
        xml.push_str("</Collection>\n</VTKFile>\n");
        xml
    }
}

fn lift(plane: impl Into<[f64; 2]>) -> [f64; 3] {
    let [x, y] = plane.into();
    [x, y, 0.0]
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
    use nalgebra::Vector2;

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

    #[test]
    fn a_file_is_well_formed_and_its_counts_agree() {
        let positions = [Vector2::new(0.1, 0.2), Vector2::new(0.3, 0.4), Vector2::new(0.5, 0.6)];
        let particles = Particles::new(0.5, &positions).unwrap();
        let particles = particles.scalar("p & <q>", &[1.0, f64::NAN, 3.0]).unwrap();
        let xml = particles.vector("v", &positions).unwrap().triple("S", &[[1.0; 3]; 3]).unwrap();
        let xml = xml.to_xml();
        let tags = tags(&xml);
        assert_eq!(tags.iter().filter(|tag| tag.starts_with("DataArray")).count(), 7);
        assert!(xml.contains("NumberOfPoints=\"3\" NumberOfVerts=\"3\""));
        assert!(xml.contains("Name=\"p &amp; &lt;q&gt;\""));
        assert_eq!(array(&xml, "TimeValue"), 0.5_f64.to_le_bytes());
        let flat = floats(&[0.1, 0.2, 0.0, 0.3, 0.4, 0.0, 0.5, 0.6, 0.0]);
        assert_eq!(array(&xml, "Points"), flat);
        assert_eq!(array(&xml, "v"), flat);
        assert_eq!(array(&xml, "connectivity"), integers([0, 1, 2].into_iter()));
        assert_eq!(array(&xml, "offsets"), integers([1, 2, 3].into_iter()));
        assert_eq!(array(&xml, "p &amp; &lt;q&gt;").len(), 24);
    }

    #[test]
    fn no_particles_are_a_file_too() {
        let xml = Particles::new::<[f64; 2]>(0.0, &[]).unwrap().scalar("p", &[]).unwrap().to_xml();
        tags(&xml);
        assert!(array(&xml, "connectivity").is_empty());
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_name() {
        let particles = Particles::new(0.0, &[[0.0, 0.0], [1.0, 0.0]]).unwrap();
        let error = particles.clone().scalar("rho", &[1.0]).unwrap_err().to_string();
        assert_eq!(error, "array rho has 1 values for 2 particles");
        let twice = particles.scalar("rho", &[1.0; 2]).unwrap().scalar("rho", &[1.0; 2]);
        assert_eq!(twice.unwrap_err().to_string(), "there are two arrays called rho");
        let error = Particles::new(0.0, &[[0.0, f64::NAN]]).unwrap_err().to_string();
        assert_eq!(error, "particle 0 is at (0, NaN), which is not finite");
    }

    #[test]
    fn a_collection_lists_its_files_in_order() {
        let mut collection = Collection::default();
        collection.push(0.0, "a.vtp");
        collection.push(1e-9, "b&c.vtp");
        let xml = collection.to_xml();
        let tags = tags(&xml);
        assert_eq!(tags[3], "DataSet timestep=\"0.0\" part=\"0\" file=\"a.vtp\"/");
        assert_eq!(tags[4], "DataSet timestep=\"1e-9\" part=\"0\" file=\"b&amp;c.vtp\"/");
    }
}
