//! Particles as ParaView's unstructured grid: one vertex a particle, numbers as text that reads back equal.

use std::fmt::Write;

use crate::problem::Problem;

pub fn particles(problem: &Problem) -> String {
    let particles = &problem.outline.particles;
    let count = particles.column("id").len();
    let mut xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" \
         byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{count}\" \
         NumberOfCells=\"{count}\">\n<PointData>\n"
    );
    let array = |xml: &mut String, kind: &str, name: &str, components: usize, values: &[String]| {
        let _ = writeln!(
            xml,
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"ascii\">{}</DataArray>",
            values.join(" ")
        );
    };
    let text = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>();
    let vectors = |x: &str, y: &str| -> Vec<String> {
        let pairs = particles.column(x).iter().zip(particles.column(y));
        pairs.flat_map(|(x, y)| [x.to_string(), y.to_string(), "0".into()]).collect()
    };
    for name in ["id", "role", "density", "pressure", "mass"] {
        array(&mut xml, "Float64", name, 1, &text(particles.column(name)));
    }
    array(&mut xml, "Float64", "velocity", 3, &vectors("u", "v"));
    xml += "</PointData>\n<Points>\n";
    array(&mut xml, "Float64", "Points", 3, &vectors("x", "y"));
    xml += "</Points>\n<Cells>\n";
    let whole = |range: std::ops::Range<usize>| range.map(|k| k.to_string()).collect::<Vec<_>>();
    array(&mut xml, "Int64", "connectivity", 1, &whole(0..count));
    array(&mut xml, "Int64", "offsets", 1, &whole(1..count + 1));
    array(&mut xml, "UInt8", "types", 1, &vec!["1".to_string(); count]);
    xml + "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
}
