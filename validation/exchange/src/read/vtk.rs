//! Particles of ParaView, `.vtu` and `.vtp`: arrays as text, as base64, or raw after the XML, plain or
//! compressed by zlib. The time is the array `TimeValue` of the field data.

use std::{borrow::Cow, io::Read};

use roxmltree::{Document, Node, ParsingOptions};
use touchstone_base::text::{few, from_base64, short};

use super::{
    Renamed, Rows,
    binary::{self, MOST_NUMBERS, NumberFormat, Of, too_long},
    columns::{Heads, MOST_SHOWN},
    of_arrays,
};
use crate::flaw::Flaw;

/// More than these are no elements and texts of a frame.
const MOST_NODES: u32 = 1 << 16;
/// More than these are no attributes of an element, and no namespaces of a document: reading them costs the
/// square of their number.
const MOST_ATTRIBUTES: usize = 100;
/// More than these are no blocks of an array: usual are 32 kB each.
const MOST_BLOCKS: usize = 1 << 16;
/// Marks points that belong to another part of a divided grid; never an id.
const GHOSTS: &str = "vtkGhostType";

pub fn rows(file: &str, bytes: Vec<u8>, renamed: &Renamed) -> Result<Rows, Vec<Flaw>> {
    let whole = |what: String| vec![Flaw::of(file, what)];
    let (xml, appended) = parts(bytes).map_err(whole)?;
    let text = String::from_utf8(xml).map_err(|error| whole(error.to_string()))?;
    is_frugal(&text).map_err(whole)?;
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options)
        .map_err(|error| vec![Flaw::of(file, error.to_string()).at(error.pos().row.into())])?;
    let layout = ArrayLayout::of(&document, &appended).map_err(whole)?;
    let mut arrays: Vec<Array> = Vec::new();
    for node in document.descendants().filter(|node| node.has_tag_name("DataArray")) {
        let line = || document.text_pos_at(node.range().start).row.into();
        let name = node.attribute("Name").unwrap_or("Points");
        let array = Array::of(node, name);
        let flaw = |what| vec![Flaw::of(file, what).at(line()).in_column(name)];
        arrays.extend(array.map_err(flaw)?);
    }
    let all: Vec<(String, usize, usize)> = arrays.iter().enumerate().flat_map(heads).collect();
    let mut names: Vec<&str> = all.iter().map(|(name, ..)| &**name).collect();
    let mut held: Option<(usize, Vec<f64>)> = None;
    let mut read = |place: usize| {
        let (_, of, component) = all[place];
        let values = match held.take() {
            Some((before, values)) if before == of => values,
            _ => arrays[of].values(&layout)?,
        };
        let width = arrays[of].components;
        let component: Vec<f64> = values.iter().skip(component).step_by(width).copied().collect();
        held = Some((of, values));
        Ok::<_, String>(component)
    };
    let heads = Heads::new(&names, renamed, &[]);
    if !heads.of("id").is_empty() || renamed.values().any(|ours| ours == "id") {
        return of_arrays(file, &heads, read);
    }
    let flaw = |column: &str, what| vec![Flaw::of(file, what).in_column(column)];
    without_ids(&arrays).map_err(|what| flaw("id", what))?;
    let count = match heads.of("x")[..] {
        [x] => read(x).map_err(|what| flaw("x", what))?.len(),
        _ => 0, // reported with the other columns
    };
    names.push("id");
    let by_order = |place: usize| match place == all.len() {
        true => Ok((0..count).map(|k| k as f64).collect()),
        false => read(place),
    };
    let rows = of_arrays(file, &Heads::new(&names, renamed, &[]), by_order)?;
    Ok(Rows { by_order: true, ..rows })
}

/// The XML of a file, and the bytes that are appended after it.
fn parts(mut bytes: Vec<u8>) -> Result<(Vec<u8>, Vec<u8>), String> {
    const BEGIN: &[u8] = b"<AppendedData";
    const END: &[u8] = b"</AppendedData>";
    let Some(start) = bytes.windows(BEGIN.len()).position(|of| of == BEGIN) else {
        return Ok((bytes, Vec::new()));
    };
    let cut = "its appended data do not end; the file was cut short";
    let head = bytes[start..].iter().position(|byte| *byte == b'>').ok_or(cut)?;
    let rest = bytes.split_off(start + head + 1);
    bytes.extend(END);
    bytes.extend(b"</VTKFile>");
    let end = rest.windows(END.len()).rposition(|of| of == END).ok_or(cut)?;
    let data = rest[..end].trim_ascii_start();
    let data = data.strip_prefix(b"_").ok_or("its appended data do not begin with _")?;
    Ok((bytes, data.to_vec()))
}

/// Refuses a text that would cost the square of its length to read.
fn is_frugal(text: &str) -> Result<(), String> {
    let most = 2 * MOST_ATTRIBUTES;
    let quotes = |tag: &[u8]| tag.iter().filter(|byte| [b'"', b'\''].contains(byte)).count();
    if text.as_bytes().split(|byte| *byte == b'<').any(|tag| quotes(tag) > most) {
        return Err(format!("an element has more than {MOST_ATTRIBUTES} attributes"));
    }
    match text.matches("xmlns").nth(MOST_ATTRIBUTES) {
        Some(_) => Err(format!("it has more than {MOST_ATTRIBUTES} namespaces")),
        None => Ok(()),
    }
}

/// Bytes, or letters of base64.
#[derive(Clone, Copy)]
enum Stream<'a> {
    Raw(&'a [u8]),
    Letters(&'a str),
}

impl<'a> Stream<'a> {
    /// The part from this number of bytes or letters after the start.
    fn after(self, offset: usize) -> Option<Self> {
        match self {
            Self::Raw(bytes) => bytes.get(offset..).map(Self::Raw),
            Self::Letters(text) => text.get(offset..).map(Self::Letters),
        }
    }

    /// The first bytes, which are encoded together, and the rest.
    fn take(self, count: usize) -> Result<(Cow<'a, [u8]>, Self), String> {
        let cut = "it ends before the bytes of which its head says that they are there";
        match self {
            Self::Raw(bytes) => {
                let (taken, rest) = bytes.split_at_checked(count).ok_or(cut)?;
                Ok((taken.into(), Self::Raw(rest)))
            }
            Self::Letters(text) => {
                let letters = count.div_ceil(3).checked_mul(4).ok_or(cut)?;
                let (taken, rest) = text.split_at_checked(letters.min(text.len())).ok_or(cut)?;
                let bytes = from_base64(taken).ok_or("it is not base64")?;
                if bytes.len() < count {
                    return Err(cut.into());
                }
                Ok((bytes.into(), Self::Letters(rest)))
            }
        }
    }

    fn is_empty(self) -> bool {
        match self {
            Self::Raw(bytes) => bytes.is_empty(),
            Self::Letters(text) => text.is_empty(),
        }
    }
}

/// Common data of the arrays of a file.
struct ArrayLayout<'a> {
    /// Does the most significant byte come first?
    is_big: bool,
    /// Bytes of a number in the head of an array.
    width: usize,
    compressor: Option<&'a str>,
    /// The data after the XML.
    appended: Option<Stream<'a>>,
}

impl<'a> ArrayLayout<'a> {
    fn of(document: &'a Document, appended: &'a [u8]) -> Result<Self, String> {
        let root = document.root_element();
        let is_big = match root.attribute("byte_order") {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            Some(other) => {
                return Err(format!(
                    "its byte_order is {}; expected LittleEndian or BigEndian",
                    short(other)
                ));
            }
        };
        let width = match root.attribute("header_type") {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => {
                let other = short(other);
                return Err(format!("its header_type is {other}; expected UInt32 or UInt64"));
            }
        };
        let element = root.children().find(|node| node.has_tag_name("AppendedData"));
        let appended = match element.map(|of| of.attribute("encoding").unwrap_or("not stated")) {
            None => None,
            Some("raw") => Some(Stream::Raw(appended)),
            Some("base64") => {
                let text = str::from_utf8(appended.trim_ascii_end());
                Some(Stream::Letters(text.map_err(|error| error.to_string())?))
            }
            Some(other) => {
                let other = short(other);
                return Err(format!(
                    "the encoding of its appended data is {other}; expected raw or base64"
                ));
            }
        };
        Ok(Self { is_big, width, compressor: root.attribute("compressor"), appended })
    }

    /// A whole number of a head.
    fn number(&self, head: &[u8], place: usize) -> Result<usize, String> {
        let bytes = head.get(place * self.width..(place + 1) * self.width);
        let bytes = bytes.ok_or("it ends within its head")?;
        let add = |all: u64, byte: &u8| all << 8 | u64::from(*byte);
        let number = match self.is_big {
            true => bytes.iter().fold(0, add),
            false => bytes.iter().rev().fold(0, add),
        };
        usize::try_from(number).map_err(|error| error.to_string())
    }

    /// The bytes of an array, and the rest.
    fn bytes<'b>(&self, from: Stream<'b>) -> Result<(Vec<u8>, Stream<'b>), String> {
        match self.compressor {
            None => {
                let (head, _) = from.take(self.width)?;
                let count = self.number(&head, 0)?.checked_add(self.width).ok_or_else(too_long)?;
                let (all, rest) = from.take(count)?;
                Ok((all[self.width..count].to_vec(), rest))
            }
            Some("vtkZLibDataCompressor") => self.compressed(from),
            Some(other) => {
                Err(format!("it is compressed by {}; expected zlib or nothing", short(other)))
            }
        }
    }

    /// Blocks compressed by zlib, after a separately encoded header: their number, the size of each, the size
    /// of the last one or 0 if it is full, and the compressed sizes.
    fn compressed<'b>(&self, from: Stream<'b>) -> Result<(Vec<u8>, Stream<'b>), String> {
        let (start, rest) = from.take(3 * self.width)?;
        let blocks = self.number(&start, 0)?;
        let [size, last] = [self.number(&start, 1)?, self.number(&start, 2)?];
        if blocks == 0 {
            return Ok((Vec::new(), rest));
        }
        if blocks > MOST_BLOCKS {
            return Err(format!("its head says {blocks} blocks; expected at most {MOST_BLOCKS}"));
        }
        let (head, rest) = from.take((3 + blocks) * self.width)?;
        let lengths = (3..3 + blocks).map(|k| self.number(&head, k));
        let lengths: Vec<usize> = lengths.collect::<Result<_, _>>()?;
        let total = lengths.iter().try_fold(0_usize, |all, length| all.checked_add(*length));
        let (data, rest) = rest.take(total.ok_or_else(too_long)?)?;
        let (mut all, mut at) = (Vec::new(), 0);
        for (k, length) in lengths.into_iter().enumerate() {
            let expected = if k + 1 == blocks && last > 0 { last } else { size };
            let before = all.len();
            if expected > 8 * MOST_NUMBERS - before {
                return Err(too_long());
            }
            // One byte more than announced suffices to refuse the header.
            let mut reader =
                flate2::read::ZlibDecoder::new(&data[at..at + length]).take(expected as u64 + 1);
            reader.read_to_end(&mut all).map_err(|error| error.to_string())?;
            let found = all.len() - before;
            if found != expected || found == 0 {
                return Err(format!("a block has {found} bytes; its head says {expected}"));
            }
            at += length;
        }
        Ok((all, rest))
    }
}

/// An array of the file.
struct Array<'a> {
    node: Node<'a, 'a>,
    name: &'a str,
    components: usize,
    /// How many places or particles it is of, where that is stated.
    count: Option<usize>,
}

/// The parent element of an array.
fn parent<'a>(node: Node<'a, 'a>) -> &'a str {
    node.parent().map_or("", |parent| parent.tag_name().name())
}

impl<'a> Array<'a> {
    /// `None` for arrays that are neither of points nor of the whole file.
    fn of(node: Node<'a, 'a>, name: &'a str) -> Result<Option<Self>, String> {
        let (counted, usual) = match parent(node) {
            "Points" => (node.parent().and_then(|of| of.parent()), 3),
            "PointData" => (node.parent().and_then(|of| of.parent()), 1),
            "FieldData" => (None, 1),
            _ => return Ok(None),
        };
        let stated = |of: Node, attribute: &str| {
            let stated = of.attribute(attribute).map(|text| (text, text.trim().parse::<usize>()));
            stated
                .map(|(text, number)| {
                    let what = format!("{attribute} is {:?}; expected a whole number", short(text));
                    number.map_err(|_| what)
                })
                .transpose()
        };
        let count = match counted {
            Some(piece) => stated(piece, "NumberOfPoints")?,
            None => stated(node, "NumberOfTuples")?,
        };
        let components = stated(node, "NumberOfComponents")?.unwrap_or(usual);
        match components {
            0 => Err("NumberOfComponents is 0; expected at least 1".into()),
            _ => Ok(Some(Self { node, name, components, count })),
        }
    }

    /// Type of its numbers.
    fn kind(&self, is_big: bool) -> Result<NumberFormat, String> {
        NumberFormat::of_vtk(self.node.attribute("type").unwrap_or("not stated"), is_big)
    }

    /// Numbers.
    fn values(&self, layout: &ArrayLayout) -> Result<Vec<f64>, String> {
        let Self { node, components, .. } = self;
        if *components > 3 {
            return Err(format!("it has {components} components; expected 1 to 3"));
        }
        // SPHinXsys writes it with a capital.
        let format = node.attribute("format").or_else(|| node.attribute("Format"));
        let values = match &*format.unwrap_or("ascii").to_ascii_lowercase() {
            "ascii" => {
                let number = |word: &str| {
                    let what = || format!("it has {:?}; expected numbers", short(word));
                    word.parse().map_err(|_| what())
                };
                let words = self.texts().flat_map(str::split_whitespace);
                words.take(MOST_NUMBERS + 1).map(number).collect::<Result<Vec<f64>, _>>()?
            }
            "binary" => {
                let text: String = self.texts().flat_map(str::split_whitespace).collect();
                let (bytes, rest) = layout.bytes(Stream::Letters(&text))?;
                if !rest.is_empty() {
                    return Err(format!(
                        "it has more than the {} bytes that its head says",
                        bytes.len()
                    ));
                }
                binary::numbers(self.kind(layout.is_big)?, &bytes)?
            }
            "appended" => {
                let offset = node.attribute("offset").unwrap_or("not stated");
                let from = offset.trim().parse().ok().zip(layout.appended);
                let from = from.and_then(|(offset, appended)| appended.after(offset));
                let beyond =
                    || format!("its offset is {}; expected one in AppendedData", short(offset));
                let (bytes, _) = layout.bytes(from.ok_or_else(beyond)?)?;
                binary::numbers(self.kind(layout.is_big)?, &bytes)?
            }
            other => {
                let other = short(other);
                return Err(format!("its format is {other}; expected ascii, binary or appended"));
            }
        };
        if values.len() > MOST_NUMBERS {
            return Err(too_long());
        }
        let (found, said) =
            (values.len(), self.count.and_then(|count| count.checked_mul(*components)));
        match self.count {
            Some(count) if said != Some(found) => Err(format!(
                "it has {found} numbers; expected {components} for each of {count}, as the file says"
            )),
            _ if !found.is_multiple_of(*components) => {
                Err(format!("it has {found} numbers; expected {components} for each point"))
            }
            _ => Ok(values),
        }
    }

    /// The texts in it: ParaView puts elements between them.
    fn texts(&self) -> impl Iterator<Item = &'a str> {
        self.node.children().filter(Node::is_text).filter_map(|text| text.text())
    }
}

/// The heads of an array, with its place and a component: one of each component of a vector.
fn heads((place, array): (usize, &Array)) -> Vec<(String, usize, usize)> {
    let Array { name, components, node, .. } = array;
    if !(2..=3).contains(components) {
        return vec![(name.to_string(), place, 0)];
    }
    let head = |axis: &str| match parent(*node) == "Points" {
        true => axis.to_string(),
        false => format!("{name}.{axis}"),
    };
    let axes = ["x", "y", "z"].iter().take(*components).enumerate();
    axes.map(|(component, axis)| (head(axis), place, component)).collect()
}

/// Refuses to number particles by their place in a file that has whole numbers, which may be their ids.
fn without_ids(arrays: &[Array]) -> Result<(), String> {
    let may_be_ids = |array: &&Array| {
        let is_whole = array.kind(false).is_ok_and(|kind| kind.of != Of::Float);
        let is_of_points = parent(array.node) == "PointData" && array.components == 1;
        is_whole && is_of_points && array.name != GHOSTS
    };
    let names = few(arrays.iter().filter(may_be_ids).map(|array| array.name), MOST_SHOWN);
    if names.is_empty() {
        return Ok(());
    }
    Err(format!(
        "it is missing, and the file has whole numbers; expected an array id, --map id=NAME with one of \
         {names}, or none of these if particles are in the order of the problem"
    ))
}
