//! A drawing in pixels.
//!
//! The rasteriser knows whole pixels only, so everything is drawn `scale` times larger. Its first error is
//! kept and reported at the end, which keeps the drawing code free of `?`.

use super::canvas::{Point, Sheet};
use super::colour::Colour;
use super::figure::Dash;
use super::font::{self, Align, Type};
use plotters::prelude::{BitMapBackend, DrawingBackend, RGBColor, TextStyle};
use plotters::style::FontTransform;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::io;

pub(super) struct Raster<'a> {
    backend: BitMapBackend<'a>,
    scale: f64,
    error: Option<io::Error>,
}

impl<'a> Raster<'a> {
    pub fn new(backend: BitMapBackend<'a>, scale: f64) -> Self {
        Self { backend, scale, error: None }
    }

    /// The first error, if there was one.
    pub fn finish(mut self) -> io::Result<()> {
        let last = self.backend.present();
        self.note(last);
        self.error.map_or(Ok(()), Err)
    }

    fn note<E: std::fmt::Display>(&mut self, result: Result<(), E>) {
        if let Err(e) = result {
            self.error.get_or_insert(io::Error::other(e.to_string()));
        }
    }

    fn pixel(&self, (x, y): Point) -> (i32, i32) {
        ((x * self.scale).round() as i32, (y * self.scale).round() as i32)
    }

    /// Bars and round joints: the rasteriser's own wide paths have spikes at sharp turns.
    fn path(&mut self, points: &[Point], colour: Colour, width: f64) {
        for pair in points.windows(2) {
            self.bar(pair[0], pair[1], colour, width);
        }
        if width > 1.2 {
            for &joint in points.iter().skip(1).take(points.len().saturating_sub(2)) {
                self.disc(joint, 0.5 * width, colour);
            }
        }
    }

    /// A segment as a filled rectangle along it.
    fn bar(&mut self, a: Point, b: Point, colour: Colour, width: f64) {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let length = dx.hypot(dy);
        if length == 0.0 {
            return;
        }
        let (nx, ny) = (-0.5 * width * dy / length, 0.5 * width * dx / length);
        let corners = [
            (a.0 + nx, a.1 + ny),
            (b.0 + nx, b.1 + ny),
            (b.0 - nx, b.1 - ny),
            (a.0 - nx, a.1 - ny),
        ];
        self.area(&corners, colour);
    }

    fn dashed(&mut self, points: &[Point], colour: Colour, width: f64, pattern: &[f64]) {
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
}

impl Sheet for Raster<'_> {
    fn area(&mut self, corners: &[Point], colour: Colour) {
        let pixels: Vec<_> = corners.iter().map(|&p| self.pixel(p)).collect();
        let result = self.backend.fill_polygon(pixels, &rgb(colour));
        self.note(result);
    }

    fn line(&mut self, points: &[Point], colour: Colour, width: f64, dash: Dash) {
        match dash {
            Dash::Solid => self.path(points, colour, width),
            _ => self.dashed(points, colour, width, dash.pattern()),
        }
    }

    fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        let radius = (radius * self.scale).round().max(1.0) as u32;
        let result = self.backend.draw_circle(self.pixel(centre), radius, &rgb(colour), true);
        self.note(result);
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
        let result = self.backend.draw_text(text, &style, self.pixel(place));
        self.note(result);
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
