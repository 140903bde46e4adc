//! A drawing in pixels.
//!
//! The rasteriser has whole pixels only, so everything is drawn `scale` times larger.

use super::canvas::{Point, Sheet};
use super::colour::Colour;
use super::figure::Dash;
use super::font::{self, Align, Type};
use plotters::prelude::{BitMapBackend, Color, DrawingBackend, RGBColor, ShapeStyle, TextStyle};
use plotters::style::FontTransform;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Drawing into memory cannot fail; drawing text cannot as long as the font exists.
const DRAWN: &str = "the pixels are in memory, and the font is registered";

pub(super) struct Raster<'a> {
    pub backend: BitMapBackend<'a>,
    pub scale: f64,
}

impl Raster<'_> {
    fn pixel(&self, (x, y): Point) -> (i32, i32) {
        ((x * self.scale).round() as i32, (y * self.scale).round() as i32)
    }

    /// Lines with round joints: the rasteriser's own wide paths have spikes at sharp turns.
    fn path(&mut self, points: &[Point], colour: Colour, width: f64) {
        let stroke = rgb(colour).stroke_width((width * self.scale).round().max(1.0) as u32);
        for pair in points.windows(2) {
            let (from, to) = (self.pixel(pair[0]), self.pixel(pair[1]));
            self.backend.draw_line(from, to, &stroke).expect(DRAWN);
        }
        if width > 1.2 {
            for &joint in points.iter().skip(1).take(points.len().saturating_sub(2)) {
                self.disc(joint, 0.5 * width, colour);
            }
        }
    }
}

impl Sheet for Raster<'_> {
    fn area(&mut self, corners: &[Point], colour: Colour) {
        let pixels: Vec<_> = corners.iter().map(|&p| self.pixel(p)).collect();
        self.backend.fill_polygon(pixels, &filled(colour)).expect(DRAWN);
    }

    fn line(&mut self, points: &[Point], colour: Colour, width: f64, dash: Dash) {
        let pattern = dash.pattern();
        let Some(&first) = points.first() else { return };
        let (mut on, mut left) = (0, pattern[0]);
        let mut run = vec![first];
        for pair in points.windows(2) {
            let (mut from, to) = (pair[0], pair[1]);
            let mut length = (to.0 - from.0).hypot(to.1 - from.1);
            while length > left {
                let t = left / length;
                from = (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
                length -= left;
                run.push(from);
                if on % 2 == 0 {
                    self.path(&run, colour, width);
                }
                run = vec![from];
                on = (on + 1) % pattern.len();
                left = pattern[on];
            }
            left -= length;
            run.push(to);
        }
        if on % 2 == 0 && run.len() > 1 {
            self.path(&run, colour, width);
        }
    }

    fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        let radius = (radius * self.scale).round().max(1.0) as u32;
        self.backend.draw_circle(self.pixel(centre), radius, &filled(colour), true).expect(DRAWN);
    }

    fn text(&mut self, text: &str, (x, y): Point, how: Type) {
        // The rasteriser places the centre of the line, not its base.
        let height = how.em * font::HEIGHT_PER_EM;
        let above = 0.5 * height;
        let (place, turn) = match how.upright {
            false => ((x, y - above), FontTransform::None),
            true => ((x - above, y), FontTransform::Rotate270),
        };
        let horizontal = match how.align {
            Align::Start => HPos::Left,
            Align::Middle => HPos::Center,
            Align::End => HPos::Right,
        };
        let colour = rgb(how.colour);
        let style = TextStyle::from(font::desc(height * self.scale).transform(turn))
            .color(&colour)
            .pos(Pos::new(horizontal, VPos::Top));
        self.backend.draw_text(text, &style, self.pixel(place)).expect(DRAWN);
    }
}

impl Dash {
    /// Lengths of dashes and gaps by turns, in CSS pixels.
    pub(super) fn pattern(self) -> &'static [f64] {
        match self {
            Dash::Solid => &[f64::INFINITY],
            Dash::Dashed => &[6.5, 3.5],
            Dash::Dotted => &[1.6, 2.6],
        }
    }
}

fn rgb(colour: Colour) -> RGBColor {
    RGBColor(colour.0, colour.1, colour.2)
}

/// Returns the type of strokes: the rasteriser is compiled once for each type.
fn filled(colour: Colour) -> ShapeStyle {
    rgb(colour).filled()
}
