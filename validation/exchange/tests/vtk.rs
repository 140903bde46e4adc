//! Files of ParaView as other programs write them: every encoding gives one result, and the stated types are
//! respected.

#![allow(clippy::unwrap_used)] // clippy allows it in tests, not in their helpers

use std::io::Write;

use flate2::{Compression, write::ZlibEncoder};
use touchstone_base::text::base64;
use touchstone_exchange::read::{Renamed, Results, read};

/// How a file is written.
#[derive(Clone, Copy, Debug)]
struct Style {
    format: &'static str,
    encoding: &'static str,
    wide: bool,
    big: bool,
    /// Bytes of a block that is compressed; 0 if nothing is.
    block: usize,
}

const TEXT: Style =
    Style { format: " format=\"ascii\"", encoding: "", wide: false, big: false, block: 0 };

/// Numbers as bytes of a type.
fn bytes(kind: &str, numbers: &[f64], big: bool) -> Vec<u8> {
    let of = |number: &f64| -> Vec<u8> {
        let mut bytes = match kind {
            "Float64" => number.to_le_bytes().to_vec(),
            "Float32" => (*number as f32).to_le_bytes().to_vec(),
            "Int8" | "UInt8" => vec![*number as i64 as u8],
            "Int16" | "UInt16" => (*number as i64 as u16).to_le_bytes().to_vec(),
            "Int32" | "UInt32" => (*number as i64 as u32).to_le_bytes().to_vec(),
            _ => (*number as i64).to_le_bytes().to_vec(),
        };
        if big {
            bytes.reverse();
        }
        bytes
    };
    numbers.iter().flat_map(of).collect()
}

impl Style {
    fn head(self, numbers: &[usize]) -> Vec<u8> {
        let kind = if self.wide { "Int64" } else { "Int32" };
        bytes(kind, &numbers.iter().map(|n| *n as f64).collect::<Vec<_>>(), self.big)
    }

    /// The parts of an array that are encoded apart.
    fn parts(self, data: &[u8]) -> Vec<Vec<u8>> {
        if self.block == 0 {
            return vec![[self.head(&[data.len()]), data.to_vec()].concat()];
        }
        let blocks = data.chunks(self.block).map(|block| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(block).unwrap();
            encoder.finish().unwrap()
        });
        let blocks: Vec<Vec<u8>> = blocks.collect();
        let lengths = blocks.iter().map(Vec::len);
        // The last block is of size 0 in the head if it is full.
        let head = [blocks.len(), self.block, data.len() % self.block].into_iter().chain(lengths);
        vec![self.head(&head.collect::<Vec<_>>()), blocks.concat()]
    }

    /// An array: the text of its element; `appended` grows.
    fn array(
        self,
        name: &str,
        kind: &str,
        of: usize,
        numbers: &[f64],
        after: &mut Vec<u8>,
    ) -> String {
        let parts = self.parts(&bytes(kind, numbers, self.big));
        let letters = || parts.iter().map(|part| base64(part)).collect::<String>();
        let (offset, mut text) = (after.len(), String::new());
        match (self.encoding, self.format.contains("binary")) {
            ("raw", _) => after.extend(parts.concat()),
            ("base64", _) => after.extend(letters().bytes()),
            (_, true) => text = letters(),
            _ => text = numbers.iter().map(|number| format!("{number} ")).collect(),
        }
        let components = if of == 1 { "" } else { &*format!("NumberOfComponents=\"{of}\"") };
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" {components} offset=\"{offset}\"{}>{text}\
             </DataArray>\n",
            self.format
        )
    }

    /// A file of three particles with vectors of `of` components, ids of a kind, and one more array.
    fn file(self, of: usize, ids: (&str, &str), more: (&str, &str, &[f64])) -> Vec<u8> {
        let vector = |x: [f64; 3], y: [f64; 3]| -> Vec<f64> {
            let rows = x.iter().zip(y).map(|(x, y)| vec![*x, y, 0.0][..of].to_vec());
            rows.collect::<Vec<_>>().concat()
        };
        let mut after = Vec::new();
        let time = self.array("TimeValue", "Float64", 1, &[0.5], &mut after);
        let places = vector([0.0, 1.0, 2.0], [3.0, 4.0, 5.5]);
        let points = self.array("Points", "Float64", of, &places, &mut after);
        let fast = vector([0.25, -1.0, 7.0], [1.0, 2.0, -3.0]);
        let data = [
            self.array(ids.0, ids.1, 1, &[2.0, 0.0, 1.0], &mut after),
            self.array("velocity", "Float32", of, &fast, &mut after),
            self.array("Rhop", "Float64", 1, &[1000.0, 999.5, 1e3], &mut after),
            self.array(more.0, more.1, 1, more.2, &mut after),
        ];
        let order = if self.big { "BigEndian" } else { "LittleEndian" };
        let width = if self.wide { "UInt64" } else { "UInt32" };
        let compressor = if self.block > 0 { "compressor=\"vtkZLibDataCompressor\"" } else { "" };
        let mut file = format!(
            "<VTKFile byte_order=\"{order}\" header_type=\"{width}\" {compressor}>\n<PolyData><FieldData>\
             {time}</FieldData><Piece NumberOfPoints=\"3\"><Points>{points}</Points><PointData>{}</PointData>\
             </Piece></PolyData>",
            data.concat()
        )
        .into_bytes();
        if !self.encoding.is_empty() {
            file.extend(format!("<AppendedData encoding=\"{}\">\n _", self.encoding).bytes());
            file.extend(after);
            file.extend(b"\n</AppendedData>");
        }
        file.extend(b"</VTKFile>\n");
        file
    }
}

/// The content of a file, or its flaws.
fn read_as(file: &[u8], map: &[(&str, &str)]) -> Result<Results, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vtp"), file).unwrap();
    let renamed = map.iter().map(|(ours, theirs)| (theirs.to_string(), ours.to_string()));
    let lines = |flaws: Vec<touchstone_exchange::flaw::Flaw>| {
        touchstone_exchange::flaw::lines(&flaws).join("\n")
    };
    read(folder.path(), &renamed.collect::<Renamed>()).map_err(lines)
}

/// Id, place, velocity and density.
type Row = (u32, [f64; 2], [f64; 2], Option<f64>);

fn particles(results: &Results) -> Vec<Row> {
    let [frame] = &results.frames[..] else { panic!("{} frames", results.frames.len()) };
    assert_eq!(frame.time, 0.5);
    let of = frame.particles.iter();
    of.map(|p| (p.id, p.position.into(), p.velocity.into(), p.density)).collect()
}

fn expected() -> Vec<Row> {
    vec![
        (2, [0.0, 3.0], [0.25, 1.0], Some(1000.0)),
        (0, [1.0, 4.0], [-1.0, 2.0], Some(999.5)),
        (1, [2.0, 5.5], [7.0, -3.0], Some(1000.0)),
    ]
}

#[test]
fn every_encoding_gives_one_result() {
    let mut tried = 0;
    for (format, encoding) in [
        (" format=\"ascii\"", ""),
        (" Format=\"ASCII\"", ""),
        ("", ""),
        (" format=\"binary\"", ""),
        (" format=\"appended\"", "raw"),
        (" format=\"appended\"", "base64"),
    ] {
        for k in 0..16 {
            // Blocks of 24 bytes: full for the points, not full for velocities.
            let (wide, big) = (k & 1 > 0, k & 2 > 0);
            let style =
                Style { format, encoding, wide, big, block: if k & 4 > 0 { 24 } else { 0 } };
            let of = if k & 8 > 0 { 2 } else { 3 };
            let file = style.file(of, ("id", "Int64"), ("more", "UInt16", &[1.0, 2.0, 3.0]));
            let results = read_as(&file, &[]).unwrap_or_else(|what| panic!("{style:?}: {what}"));
            assert_eq!(particles(&results), expected(), "{style:?}, {of} components");
            assert_eq!(results.unread.iter().next().map(String::as_str), Some("more"));
            tried += 1;
        }
    }
    assert_eq!(tried, 96);
}

/// Integers of every width are ids; an array that is not used is not decoded, whatever it contains.
#[test]
fn ids_are_whole_numbers_of_every_width_and_other_arrays_are_not_decoded() {
    let binary = Style { format: " format=\"binary\"", ..TEXT };
    for kind in ["Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"] {
        for name in ["id", "Idp", "OriginalID", "gid", "index", "ParticleId", "ID"] {
            for style in [Style { big: true, ..binary }, binary, TEXT] {
                let file = style.file(3, (name, kind), ("mk", "String", &[1.0, 2.0, 3.0]));
                let results = read_as(&file, &[]).unwrap_or_else(|what| panic!("{name}: {what}"));
                assert_eq!(particles(&results), expected(), "{name} of {kind}");
            }
        }
    }
    let file = binary.file(3, ("id", "Float16"), ("mk", "Int8", &[1.0, 2.0, 3.0]));
    let words = read_as(&file, &[]).unwrap_err();
    assert!(words.contains("column id: its type is Float16; expected floats of 4 or 8"), "{words}");
    let negative = Style { big: true, ..binary };
    let file = negative.file(3, ("id", "Int16"), ("density", "Int16", &[-2.0, 1.0, 1.0]));
    let words = read_as(&file, &[]).unwrap_err();
    assert!(words.contains("column density: it is -2;"), "{words}");
}

/// Particles are numbered by position only if no array can be their ids, and a note states this.
#[test]
fn ids_under_an_unknown_name_are_asked_for() {
    let file = TEXT.file(3, ("serial", "Int32"), ("kind", "UInt8", &[0.0; 3]));
    let words = read_as(&file, &[]).unwrap_err();
    assert!(
        words.contains("column id: it is missing") && words.contains("serial, kind"),
        "{words}"
    );
    let results = read_as(&file, &[("id", "serial")]).unwrap();
    assert_eq!(particles(&results), expected());
    let file = TEXT.file(3, ("serial", "Float64"), ("vtkGhostType", "UInt8", &[0.0; 3]));
    let results = read_as(&file, &[]).unwrap();
    assert_eq!(particles(&results).iter().map(|p| p.0).collect::<Vec<_>>(), [0, 1, 2]);
    assert!(results.notes().join("").contains("numbered by their place"), "{:?}", results.notes());
    // A vector of whole numbers holds no ids.
    let text = String::from_utf8(file).unwrap().replace("Float32", "Int32");
    assert!(read_as(text.as_bytes(), &[]).is_ok_and(|results| results.by_order));
    let both = TEXT.file(3, ("Idp", "Int32"), ("gid", "Int32", &[0.0, 1.0, 2.0]));
    let words = read_as(&both, &[]).unwrap_err();
    assert!(words.contains("Idp and gid may be it"), "{words}");
    assert_eq!(particles(&read_as(&both, &[("id", "Idp")]).unwrap()), expected());
}

/// A replaced text, and the message.
#[test]
fn what_a_file_says_of_itself_is_honoured() {
    let raw = Style { format: " format=\"appended\"", encoding: "raw", ..TEXT };
    let zlib = Style { format: " format=\"binary\"", block: 24, ..TEXT };
    for (style, from, to, says) in [
        (TEXT, "LittleEndian", "MiddleEndian", "its byte_order is MiddleEndian"),
        (TEXT, "UInt32", "UInt16", "its header_type is UInt16"),
        (TEXT, "NumberOfPoints=\"3\"", "NumberOfPoints=\"4\"", "expected 1 for each of 4"),
        (TEXT, "NumberOfPoints=\"3\"", "NumberOfPoints=\"x\"", "NumberOfPoints is \"x\""),
        (TEXT, "NumberOfComponents=\"3\"", "NumberOfComponents=\"0\"", "at least 1"),
        (TEXT, "NumberOfComponents=\"3\"", "NumberOfComponents=\"\"", "NumberOfComponents is \"\""),
        (TEXT, "NumberOfComponents=\"3\"", "NumberOfComponents=\"2\"", "it has 9 numbers"),
        (TEXT, "\"ascii\"", "\"utf8\"", "its format is utf8"),
        (raw, "\"raw\"", "\"gzip\"", "appended data is gzip"),
        (raw, "offset=\"0\"", "offset=\"9999\"", "its offset is 9999"),
        (raw, "offset=\"0\"", "offset=\"-1\"", "its offset is -1"),
        (raw, "\n _", " ", "do not begin with _"),
        (raw, "</AppendedData>", "", "cut short"),
        (
            zlib,
            "vtkZLibDataCompressor",
            "vtkLZ4DataCompressor",
            "compressed by vtkLZ4DataCompressor",
        ),
    ] {
        let whole = style.file(3, ("id", "Int64"), ("more", "Float64", &[1.0, 2.0, 3.0]));
        let [from, to] = [from, to].map(str::as_bytes);
        let at = whole.windows(from.len()).position(|of| of == from).unwrap();
        let changed = [&whole[..at], to, &whole[at + from.len()..]].concat();
        let words = read_as(&changed, &[]).err().unwrap_or_default();
        assert!(words.contains(says), "expected {says:?} in {words:?}");
    }
}

/// Headers that promise missing data, or more data than a computer has, cost nothing.
#[test]
fn heads_of_arrays_are_not_believed() {
    let head = |numbers: &[u64]| -> String {
        base64(&numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>())
    };
    let empty = {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(b"").unwrap();
        encoder.finish().unwrap()
    };
    let empties = [8, 0, 0].into_iter().chain([empty.len() as u64; 8]).collect::<Vec<_>>();
    let zlib = " compressor=\"vtkZLibDataCompressor\"";
    for (compressor, data, says) in [
        (zlib, head(&[(1 << 61) - 4, 8, 8]), "blocks; expected at most 65536"),
        (zlib, head(&[2, 8, 8, 1 << 62, 1 << 62]), "its head says"),
        (zlib, head(&[2, 8]), "its head says"),
        (zlib, head(&empties) + &base64(&empty.repeat(8)), "a block has 0 bytes"),
        ("", head(&[u64::MAX]), "more than"),
        ("", head(&[1 << 40]), "its head says"),
        ("", head(&[8, 0, 0]), "more than the 8 bytes"),
        ("", head(&[]), "its head says"),
        ("", "A*==".into(), "not base64"),
    ] {
        let whole = String::from_utf8(TEXT.file(3, ("id", "Int64"), ("more", "Int8", &[0.0; 3])));
        let array = "Name=\"Rhop\"  offset=\"0\" format=\"ascii\">1000 999.5 1000 ";
        let other = format!("Name=\"Rhop\" format=\"binary\">{data}");
        let text = whole.unwrap().replace("header_type=\"UInt32\"", "header_type=\"UInt64\"");
        assert!(text.contains(array), "{text}");
        let text =
            text.replace(array, &other).replace("<VTKFile", &format!("<VTKFile{compressor}"));
        let words = read_as(text.as_bytes(), &[]).unwrap_err();
        assert!(words.contains("column density: ") && words.contains(says), "{says:?}: {words}");
    }
}

/// Two-dimensional runs of codes in three dimensions may be in the plane of x and z.
#[test]
fn a_third_component_is_constant_or_named() {
    let flat = TEXT.file(3, ("id", "Int64"), ("more", "Int8", &[0.0; 3]));
    let text = String::from_utf8(flat).unwrap();
    let turned = text
        .replace("0 3 0 1 4 0 2 5.5 0", "0 0 3 1 0 4 2 0 5.5")
        .replace("0.25 1 0 -1 2 0 7 -3 0", "0.25 0 1 -1 0 2 7 0 -3");
    let words = read_as(turned.as_bytes(), &[]).unwrap_err();
    for part in ["column z: it is from 3 to 5.5", "--map y=z", "--map v=velocity.z"] {
        assert!(words.contains(part), "expected {part} in {words}");
    }
    let results = read_as(turned.as_bytes(), &[("y", "z"), ("v", "velocity.z")]).unwrap();
    assert_eq!(particles(&results), expected());
    let deep = turned.replace("0 0 3 1 0 4", "0 1 3 1 0 4");
    let words = read_as(deep.as_bytes(), &[("y", "z"), ("v", "velocity.z")]).unwrap_err();
    assert!(words.contains("column y: it is from 0 to 1"), "{words}");
    let raised = text.replace("0 3 0 1 4 0 2 5.5 0", "0 3 7 1 4 7 2 5.5 7");
    assert_eq!(particles(&read_as(raised.as_bytes(), &[]).unwrap()), expected());
}

/// Texts that cost the square of their length are refused before they are parsed.
#[test]
fn texts_that_are_slow_to_read_are_refused() {
    let spaces = |k: usize| format!("<a xmlns:n{k}=\"u{k}\">");
    let nested = (0..10_000).map(spaces).collect::<String>() + &"</a>".repeat(10_000);
    let attributes: String = (0..10_000).map(|k| format!(" a{k}=\"\"")).collect();
    for (text, says) in [
        (nested, "more than 100 namespaces"),
        (format!("<a{attributes}/>"), "more than 100 attributes"),
        ("<a></".to_string() + &"b".repeat(100_000) + ">", "expected 'a' tag"),
    ] {
        let words = read_as(format!("<VTKFile>{text}</VTKFile>").as_bytes(), &[]).unwrap_err();
        assert!(words.contains(says) && words.len() < 2000, "expected {says:?} in {words:.2000}");
    }
}
