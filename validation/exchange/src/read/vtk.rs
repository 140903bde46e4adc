//! Particles of ParaView, `.vtu` and `.vtp`: arrays as text or base64, plain or compressed by zlib. The time
//! is the array `TimeValue` of the field data.

use std::io::Read;

use base::text::from_base64;
use roxmltree::{Document, Node, ParsingOptions};

use super::{
    COLUMNS, Renamed, Rows,
    binary::{MOST_NUMBERS, too_long},
    known_too, of_arrays,
};
use crate::flaw::Flaw;

/// More than these are no elements and texts of a frame.
const MOST_NODES: u32 = 1 << 16;

/// Names that need no `--map`.
const KNOWN: [(&str, &str); 4] =
    [("rho", "density"), ("velocity.x", "u"), ("velocity.y", "v"), ("TimeValue", "t")];

pub fn rows(file: &str, text: &str, renamed: &Renamed) -> Result<Rows, Vec<Flaw>> {
    let renamed = known_too(&KNOWN, renamed);
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)
        .map_err(|error| vec![Flaw::of(file, error.to_string()).at(error.pos().row.into())])?;
    let root = document.root_element();
    let line = |node: Node| u64::from(document.text_pos_at(node.range().start).row);
    let mut arrays: Vec<(String, Vec<f64>)> = Vec::new();
    for node in root.descendants().filter(|node| node.has_tag_name("DataArray")) {
        let parent = node.parent().map_or("", |parent| parent.tag_name().name());
        if !["PointData", "Points", "FieldData"].contains(&parent) {
            continue;
        }
        let name = node.attribute("Name").unwrap_or("Points");
        let flaw = |what: String| vec![Flaw::of(file, what).at(line(node)).in_column(name)];
        let values = values(root, node).map_err(flaw)?;
        if arrays.iter().map(|(_, of)| of.len()).sum::<usize>() > COLUMNS.len() * MOST_NUMBERS {
            return Err(flaw("the arrays before it have too many numbers".into()));
        }
        let components: usize =
            node.attribute("NumberOfComponents").and_then(|n| n.parse().ok()).unwrap_or(1);
        if components < 2 {
            arrays.push((name.into(), values));
            continue;
        }
        for (k, axis) in ["x", "y"].iter().enumerate() {
            let values = values.iter().skip(k).step_by(components).copied().collect();
            let name = if parent == "Points" { axis.to_string() } else { format!("{name}.{axis}") };
            arrays.push((name, values));
        }
    }
    // Without numbers, particles are in the order of the problem.
    let has_ids = arrays.iter().any(|(name, _)| name == "id");
    if !has_ids && !renamed.values().any(|ours| ours == "id") {
        let count = arrays.iter().find(|(name, _)| name == "x").map_or(0, |(_, x)| x.len());
        arrays.push(("id".into(), (0..count).map(|k| k as f64).collect()));
    }
    let heads: Vec<&str> = arrays.iter().map(|(name, _)| name.as_str()).collect();
    of_arrays(file, &heads, &renamed, |place| Ok(arrays[place].1.clone()))
}

/// The numbers of an array.
fn values(root: Node, node: Node) -> Result<Vec<f64>, String> {
    let text = node.text().unwrap_or_default();
    match node.attribute("format") {
        Some("ascii") => {
            let number =
                |word: &str| word.parse().map_err(|_| format!("it has {word:?}; expected numbers"));
            let numbers = text.split_whitespace().take(MOST_NUMBERS + 1).map(number);
            let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
            if numbers.len() > MOST_NUMBERS { Err(too_long()) } else { Ok(numbers) }
        }
        Some("binary") => {
            let is_wide = root.attribute("header_type") == Some("UInt64");
            let width = if is_wide { 8 } else { 4 };
            let bytes = match root.attribute("compressor") {
                None => plain(text.trim(), width)?,
                Some("vtkZLibDataCompressor") => compressed(text.trim(), width)?,
                Some(other) => {
                    return Err(format!("it is compressed by {other}; expected zlib or nothing"));
                }
            };
            super::binary::numbers(node.attribute("type").unwrap_or_default(), &bytes)
        }
        other => Err(format!(
            "its format is {}; expected ascii or binary (inline base64)",
            other.unwrap_or("not stated")
        )),
    }
}

/// A whole number of so many bytes.
fn number(bytes: &[u8], at: usize, width: usize) -> Result<usize, String> {
    let bytes = bytes.get(at * width..(at + 1) * width).ok_or("it ends within its head")?;
    Ok(bytes.iter().rev().fold(0_u64, |all, byte| all << 8 | u64::from(*byte)) as usize)
}

/// A block with the number of its bytes before it.
fn plain(text: &str, width: usize) -> Result<Vec<u8>, String> {
    let bytes = base64(text)?;
    let count = number(&bytes, 0, width)?;
    match bytes.get(width..).filter(|rest| rest.len() == count) {
        Some(rest) => Ok(rest.to_vec()),
        None => {
            let found = bytes.len().saturating_sub(width);
            Err(format!("it has {found} bytes; its head says {count}"))
        }
    }
}

/// Blocks that zlib compressed; before them their number, the size of each, that of the last one, and the
/// compressed sizes, encoded apart.
fn compressed(text: &str, width: usize) -> Result<Vec<u8>, String> {
    let cut = "it ends within its head";
    let letters = |bytes: usize| bytes.div_ceil(3).checked_mul(4);
    let before = |bytes: usize| letters(bytes).and_then(|end| text.get(..end)).ok_or(cut);
    let start = base64(before(3 * width)?)?;
    let [blocks, size, last] = [0, 1, 2].map(|k| number(&start, k, width));
    let (blocks, size, last) = (blocks?, size?, last?);
    let head = before(blocks.checked_add(3).and_then(|n| n.checked_mul(width)).ok_or(cut)?)?;
    let (sizes, data) = (base64(head)?, base64(&text[head.len()..])?);
    let (mut all, mut at) = (Vec::new(), 0_usize);
    for k in 0..blocks {
        let length = number(&sizes, 3 + k, width)?;
        let end = at.checked_add(length).ok_or("a block is too long")?;
        let block = data.get(at..end).ok_or("it ends within a block")?;
        let expected = if k + 1 == blocks && last > 0 { last } else { size };
        let before = all.len();
        if expected > 8 * MOST_NUMBERS - before {
            return Err(too_long());
        }
        // One byte more than was announced is enough to see that the head is wrong.
        let mut reader = flate2::read::ZlibDecoder::new(block).take(expected as u64 + 1);
        reader.read_to_end(&mut all).map_err(|error| error.to_string())?;
        let found = all.len() - before;
        if found != expected {
            return Err(format!("a block has {found} bytes; its head says {expected}"));
        }
        at = end;
    }
    Ok(all)
}

/// The bytes of a text.
fn base64(text: &str) -> Result<Vec<u8>, String> {
    from_base64(text).ok_or_else(|| "it is no base64".into())
}
