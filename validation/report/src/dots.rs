//! Dots coloured by a value, and cells coloured by an outcome.

use super::bar::{Bar, STEPS};
use super::canvas::{Align, Canvas, Point, Rect, Type};
use super::colour::Colour;
use super::figure::{Dot, Dots, GridCell, Shape};
use super::frame::{Frame, fit};

/// Dots with their scale decided.
pub(super) struct Scaled<'a> {
    dots: &'a Dots,
    pub bar: Bar,
    /// Radius of a dot in CSS pixels.
    radius: f64,
}

impl<'a> Scaled<'a> {
    /// Dots next to a bar of this height, with these CSS pixels for a unit of x and y.
    pub fn new(dots: &'a Dots, height: f64, pixels: f64) -> Self {
        let data = dots.points.iter().map(|p| p.value);
        Self {
            dots,
            bar: Bar::new(dots.map, &dots.label, dots.values, data, height),
            radius: (0.5 * dots.diameter * pixels).clamp(0.8, 9.0),
        }
    }

    pub fn draw(&self, canvas: &mut Canvas, frame: &Frame) {
        // Dots of one colour after each other, because they are one element of an SVG.
        let mut all = vec![Vec::new(); STEPS];
        for &Dot { x, y, value } in &self.dots.points {
            let Some(at) = frame.place((x, y)).filter(|at| frame.area.contains(*at)) else {
                continue;
            };
            match self.bar.step(value) {
                Some(step) => all[step].push(at),
                None => canvas.markers(&[at], Shape::Cross, 8.0, Colour::BLACK, false),
            }
        }
        for (step, mut dots) in all.into_iter().enumerate() {
            // Row by row, for near dots have short coordinates.
            let row = |at: &Point| (at.1 / (4.0 * self.radius)).round() as i64;
            dots.sort_by(|a, b| row(a).cmp(&row(b)).then(a.0.total_cmp(&b.0)));
            dots.into_iter().for_each(|at| canvas.disc(at, self.radius, self.bar.colour(step)));
        }
    }
}

/// Texts on cells, which keep their colours on a dark page: not the black that the style sheet turns light.
const INK: Colour = Colour(1, 1, 1);

/// Draws the cell of a column and a row, with its text.
pub(super) fn draw_cell(
    canvas: &mut Canvas,
    frame: &Frame,
    GridCell { column, row, text }: &GridCell,
    colour: Colour,
) {
    let (x, y) = (*column as f64, *row as f64);
    let corners = (frame.place((x, y + 1.0)), frame.place((x + 1.0, y)));
    let (Some((left, top)), Some((right, bottom))) = corners else { return };
    let cell = Rect { left, top, width: right - left, height: bottom - top }.grown(-1.0);
    canvas.fill(cell, colour);
    let em = fit(text, 11.0, cell.width - 4.0).min(0.8 * cell.height);
    let ink = if colour.is_dark() { Colour::WHITE } else { INK };
    canvas.text(text, cell.at((0.5, 0.5)), Type::new(em, Align::Middle).colour(ink));
}
