//! Legends: symbols and names, below their plots.

use super::canvas::{Align, Canvas, Point, Type};
use super::figure::Look;
use super::font;
use super::svg::{self, Svg};

/// One line of a legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub name: String,
    pub look: Look,
}

/// Diameter of a marker in CSS pixels.
pub(super) const MARKER: f64 = 6.5;
const EM: f64 = 11.0;
const ROW: f64 = 17.0;
const PADDING: f64 = 7.0;
const SAMPLE: f64 = 26.0;

impl Entry {
    /// Draws the line and the marker of the entry, `SAMPLE` wide, around a height.
    fn draw(&self, canvas: &mut Canvas, (x, y): Point) {
        let look = self.look;
        if let Some(dash) = look.line {
            canvas.dashed(&[(x, y), (x + SAMPLE, y)], look.colour, look.width, dash);
        }
        if let Some(shape) = look.marker {
            canvas.markers(&[(x + 0.5 * SAMPLE, y)], shape, MARKER, look.colour, look.open);
        }
    }

    /// The sample as an SVG element.
    pub fn sample(&self) -> String {
        let mut sheet = Svg::default();
        self.draw(&mut Canvas::new(&mut sheet), (0.0, 6.0));
        svg::opening("", (SAMPLE, 12.0)) + &sheet.finish() + "</svg>"
    }
}

/// Width of an entry with the gap to the next column.
pub(super) fn column(entries: &[Entry]) -> f64 {
    SAMPLE + 7.0 + font::widest(entries.iter().map(|entry| &entry.name), EM) + 2.0 * PADDING
}

/// Rows of the entries in as many columns as fit.
fn rows(entries: &[Entry], width: f64) -> usize {
    let columns = ((width - PADDING) / column(entries)) as usize;
    entries.len().div_ceil(columns.max(1)).max(1)
}

/// Height of the entries side by side within this width; 0 if there are none.
pub(super) fn height(entries: &[Entry], width: f64) -> f64 {
    match entries {
        [] => 0.0,
        _ => rows(entries, width) as f64 * ROW + PADDING,
    }
}

/// Draws the entries side by side within this width, each column from top to bottom.
pub(super) fn draw(canvas: &mut Canvas, entries: &[Entry], (left, top): Point, width: f64) {
    let (rows, column) = (rows(entries, width), column(entries));
    for (i, entry) in entries.iter().enumerate() {
        let x = left + PADDING + (i / rows) as f64 * column;
        let y = top + PADDING + ((i % rows) as f64 + 0.5) * ROW - 2.5;
        entry.draw(canvas, (x, y));
        canvas.text(&entry.name, (x + SAMPLE + 7.0, y), Type::new(EM, Align::Start));
    }
}
