//! Legends: what stands for what, and where it hides nothing.

use super::canvas::{Align, Canvas, Point, Rect, Type};
use super::colour::Colour;
use super::figure::{Dash, Legend, Shape};
use super::font;

/// How a series is drawn, after the palette was consulted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Look {
    pub colour: Colour,
    pub line: Option<Dash>,
    pub width: f64,
    pub marker: Option<Shape>,
    pub open: bool,
}

/// The sample beside a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sample {
    Series(Look),
    Patch(Colour),
}

/// One line of a legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub name: String,
    pub sample: Sample,
}

impl Entry {
    pub fn colour(&self) -> Colour {
        match self.sample {
            Sample::Series(look) => look.colour,
            Sample::Patch(colour) => colour,
        }
    }
}

/// Diameter of a marker in CSS pixels.
pub(super) const MARKER: f64 = 6.5;
const EM: f64 = 11.0;
const ROW: f64 = 17.0;
const PADDING: f64 = 7.0;
const SAMPLE: f64 = 26.0;
const INSET: f64 = 8.0;

/// Width and height of the box around the entries, one below the other.
pub(super) fn size(entries: &[Entry]) -> (f64, f64) {
    (column(entries) + PADDING, entries.len() as f64 * ROW + 2.0 * PADDING - 5.0)
}

/// Width of an entry with the gap to the next column.
fn column(entries: &[Entry]) -> f64 {
    SAMPLE + 7.0 + font::widest(entries.iter().map(|entry| &entry.name), EM) + PADDING
}

/// Rows of the entries in as many columns as fit side by side.
fn rows_within(entries: &[Entry], width: f64) -> usize {
    let columns = ((width - PADDING) / (column(entries) + PADDING)) as usize;
    entries.len().div_ceil(columns.max(1)).max(1)
}

/// Height of the entries side by side within this width; 0 if there are none.
pub(super) fn height_within(entries: &[Entry], width: f64) -> f64 {
    match entries {
        [] => 0.0,
        _ => rows_within(entries, width) as f64 * ROW + PADDING,
    }
}

/// Draws the entries side by side within this width, each column from top to bottom.
pub(super) fn draw_within(canvas: &mut Canvas, entries: &[Entry], (left, top): Point, width: f64) {
    for (i, entries_of_column) in entries.chunks(rows_within(entries, width)).enumerate() {
        let left = left + i as f64 * (column(entries) + PADDING);
        draw(canvas, entries_of_column, (left, top), false);
    }
}

/// Draws the entries in a box whose corner is `at`.
pub(super) fn draw(canvas: &mut Canvas, entries: &[Entry], (left, top): Point, boxed: bool) {
    let (width, height) = size(entries);
    if boxed {
        let area = Rect { left, top, width, height };
        canvas.fill(area, Colour::WHITE);
        canvas.frame(area, Colour(190, 190, 190), 0.7);
    }
    for (i, entry) in entries.iter().enumerate() {
        let y = top + PADDING + (i as f64 + 0.5) * ROW - 2.5;
        let x = left + PADDING;
        match entry.sample {
            Sample::Series(look) => sample(canvas, look, (x, y)),
            Sample::Patch(colour) => {
                let patch = Rect { left: x + 4.0, top: y - 5.5, width: SAMPLE - 8.0, height: 11.0 };
                canvas.fill(patch, colour);
                canvas.frame(patch, Colour(150, 150, 150), 0.6);
            }
        }
        canvas.text(&entry.name, (x + SAMPLE + 7.0, y), Type::new(EM, Align::Start));
    }
}

fn sample(canvas: &mut Canvas, look: Look, (x, y): Point) {
    if let Some(dash) = look.line {
        canvas.dashed(&[(x, y), (x + SAMPLE, y)], look.colour, look.width, dash);
    }
    if let Some(shape) = look.marker {
        canvas.markers(&[(x + 0.5 * SAMPLE, y)], shape, MARKER, look.colour, look.open);
    }
}

/// The corner of the area where the box hides none of the obstacles, else outside.
pub(super) fn place(entries: &[Entry], area: Rect, obstacles: &[Point]) -> Legend {
    let corners = [Legend::TopRight, Legend::TopLeft, Legend::BottomRight, Legend::BottomLeft];
    let free = |corner: &Legend| {
        let rect = rect(entries, area, *corner);
        area.encloses(&rect) && !obstacles.iter().any(|&p| rect.grown(4.0).contains(p))
    };
    corners.into_iter().find(free).unwrap_or(Legend::Outside)
}

/// The box at a place of the area.
pub(super) fn rect(entries: &[Entry], area: Rect, place: Legend) -> Rect {
    let (width, height) = size(entries);
    let left = match place {
        Legend::TopLeft | Legend::BottomLeft => area.left + INSET,
        Legend::Outside => area.right() + INSET,
        _ => area.right() - INSET - width,
    };
    let top = match place {
        Legend::BottomLeft | Legend::BottomRight => area.bottom() - INSET - height,
        Legend::Outside => area.top - 4.0,
        _ => area.top + INSET,
    };
    Rect { left, top, width, height }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_legend_avoids_data_or_leaves() {
        let entries = vec![Entry { name: "SPH".into(), sample: Sample::Patch(Colour::BLUE) }];
        let area = Rect { left: 0.0, top: 0.0, width: 300.0, height: 200.0 };
        assert_eq!(place(&entries, area, &[]), Legend::TopRight);
        assert_eq!(place(&entries, area, &[(280.0, 20.0)]), Legend::TopLeft);
        let everywhere: Vec<_> =
            (0..3000).map(|i| (f64::from(i % 60) * 5.0, f64::from(i / 60) * 4.0)).collect();
        assert_eq!(place(&entries, area, &everywhere), Legend::Outside);
    }
}
