//! Drawing primitives in CSS pixels on top of a plotters backend.
//!
//! A backend knows whole pixels only, so everything is drawn `scale` times larger. The first error
//! is kept and reported at the end, which keeps the drawing code free of `?`.

use super::colour::Colour;
use super::figure::{Align, Dash, Shape};
use super::font;
use plotters::prelude::{DrawingBackend, RGBColor, ShapeStyle, TextStyle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform};

/// A point in CSS pixels, y downwards.
pub(super) type Point = (f64, f64);

/// A rectangle in CSS pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rect {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Rect {
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub fn contains(&self, (x, y): Point) -> bool {
        x >= self.left && x <= self.right() && y >= self.top && y <= self.bottom()
    }

    /// The rectangle grown by `by` on every side.
    pub fn grown(&self, by: f64) -> Self {
        Self {
            left: self.left - by,
            top: self.top - by,
            width: self.width + 2.0 * by,
            height: self.height + 2.0 * by,
        }
    }

    /// Distance of a point, 0 inside.
    pub fn distance(&self, (x, y): Point) -> f64 {
        let dx = (self.left - x).max(x - self.right()).max(0.0);
        let dy = (self.top - y).max(y - self.bottom()).max(0.0);
        dx.hypot(dy)
    }

    /// The part of the segment that lies inside (Liang and Barsky).
    pub fn clip(&self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let sides = [
            (-dx, a.0 - self.left),
            (dx, self.right() - a.0),
            (-dy, a.1 - self.top),
            (dy, self.bottom() - a.1),
        ];
        for (step, room) in sides {
            if step == 0.0 && room < 0.0 {
                return None;
            } else if step < 0.0 {
                enter = enter.max(room / step);
            } else if step > 0.0 {
                leave = leave.min(room / step);
            }
        }
        let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        (enter <= leave).then(|| (at(enter), at(leave)))
    }
}

/// Whether the target keeps shapes or pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Vector,
    Raster,
}

/// How a text is set.
#[derive(Debug, Clone, Copy)]
pub(super) struct Type {
    pub em: f64,
    pub colour: Colour,
    pub align: Align,
    /// Reads upwards.
    pub upright: bool,
}

impl Type {
    pub fn new(em: f64, align: Align) -> Self {
        Self { em, colour: Colour::BLACK, align, upright: false }
    }

    pub fn colour(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    pub fn upright(self) -> Self {
        Self { upright: true, ..self }
    }
}

/// A drawing in progress.
pub(super) struct Canvas<B: DrawingBackend> {
    backend: B,
    scale: f64,
    kind: Kind,
    error: Option<String>,
}

impl<B: DrawingBackend> Canvas<B> {
    pub fn new(backend: B, scale: f64, kind: Kind) -> Self {
        Self { backend, scale, kind, error: None }
    }

    /// Completes the drawing; the first error of all its steps.
    pub fn finish(mut self) -> Result<(), String> {
        let last = self.backend.present();
        self.note(last);
        self.error.map_or(Ok(()), Err)
    }

    fn note<E: std::fmt::Display>(&mut self, result: Result<(), E>) {
        if let Err(e) = result
            && self.error.is_none()
        {
            self.error = Some(e.to_string());
        }
    }

    fn pixel(&self, (x, y): Point) -> (i32, i32) {
        ((x * self.scale).round() as i32, (y * self.scale).round() as i32)
    }

    fn stroke(&self, colour: Colour, width: f64) -> ShapeStyle {
        let pixels = (width * self.scale).round().max(1.0) as u32;
        rgb(colour).stroke_width(pixels)
    }

    /// A filled rectangle.
    pub fn fill(&mut self, rect: Rect, colour: Colour) {
        let (a, b) = (self.pixel((rect.left, rect.top)), self.pixel((rect.right(), rect.bottom())));
        let result = self.backend.draw_rect(a, b, &rgb(colour), true);
        self.note(result);
    }

    /// The outline of a rectangle.
    pub fn frame(&mut self, r: Rect, colour: Colour, width: f64) {
        let corners =
            [(r.left, r.top), (r.right(), r.top), (r.right(), r.bottom()), (r.left, r.bottom())];
        self.outline(&corners, colour, width);
    }

    /// The closed outline of a polygon.
    pub fn outline(&mut self, corners: &[Point], colour: Colour, width: f64) {
        let closed: Vec<_> = corners.iter().chain(&corners[..1]).copied().collect();
        self.path(&closed, colour, width);
    }

    /// A filled polygon.
    pub fn polygon(&mut self, corners: &[Point], colour: Colour) {
        let pixels: Vec<_> = corners.iter().map(|&p| self.pixel(p)).collect();
        let result = self.backend.fill_polygon(pixels, &rgb(colour));
        self.note(result);
    }

    /// A filled disc.
    pub fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        let radius = (radius * self.scale).round().max(1.0) as u32;
        let result = self.backend.draw_circle(self.pixel(centre), radius, &rgb(colour), true);
        self.note(result);
    }

    /// A solid line from `a` to `b`.
    pub fn line(&mut self, a: Point, b: Point, colour: Colour, width: f64) {
        self.path(&[a, b], colour, width);
    }

    /// A solid line through the points.
    pub fn path(&mut self, points: &[Point], colour: Colour, width: f64) {
        match self.kind {
            Kind::Vector => {
                let mut pixels: Vec<_> = points.iter().map(|&p| self.pixel(p)).collect();
                pixels.dedup();
                let result = self.backend.draw_path(pixels, &self.stroke(colour, width));
                self.note(result);
            }
            // The rasteriser's own wide paths have spikes at sharp turns: bars and round joints.
            Kind::Raster => {
                for pair in points.windows(2) {
                    self.bar(pair[0], pair[1], colour, width);
                }
                if width > 1.2 {
                    for &joint in points.iter().skip(1).take(points.len().saturating_sub(2)) {
                        self.disc(joint, 0.5 * width, colour);
                    }
                }
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
        self.polygon(&corners, colour);
    }

    /// A line through the points in the given pattern.
    pub fn dashed(&mut self, points: &[Point], colour: Colour, width: f64, dash: Dash) {
        let pattern: &[f64] = match dash {
            Dash::Solid => return self.path(points, colour, width),
            Dash::Dashed => &[6.5, 3.5],
            Dash::Dotted => &[1.6, 2.6],
            Dash::DashDot => &[7.0, 2.6, 1.6, 2.6],
        };
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

    /// A marker of the given diameter.
    pub fn marker(&mut self, at: Point, shape: Shape, size: f64, colour: Colour, open: bool) {
        let r = 0.5 * size;
        let around = |corners: &[Point]| -> Vec<Point> {
            corners.iter().map(|c| (at.0 + r * c.0, at.1 + r * c.1)).collect()
        };
        let corners = match shape {
            Shape::Circle => {
                self.disc(at, r, colour);
                if open {
                    self.disc(at, r - OPEN_STROKE, Colour::WHITE);
                }
                return;
            }
            Shape::Cross | Shape::Plus => {
                let d = if shape == Shape::Cross { (0.85, 0.85) } else { (1.15, 0.0) };
                let ends = around(&[(-d.0, -d.1), d, (-d.1, d.0), (d.1, -d.0)]);
                self.line(ends[0], ends[1], colour, 1.5);
                self.line(ends[2], ends[3], colour, 1.5);
                return;
            }
            Shape::Square => around(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
            Shape::Triangle => around(&[(0.0, -1.15), (1.08, 0.75), (-1.08, 0.75)]),
            Shape::Down => around(&[(0.0, 1.15), (-1.08, -0.75), (1.08, -0.75)]),
            Shape::Diamond => around(&[(0.0, -1.25), (1.1, 0.0), (0.0, 1.25), (-1.1, 0.0)]),
        };
        self.polygon(&corners, if open { Colour::WHITE } else { colour });
        if open {
            self.outline(&corners, colour, OPEN_STROKE);
        }
    }

    /// A text, vertically centred on the digits' height at the point.
    pub fn text(&mut self, text: &str, at: Point, how: Type) {
        if text.is_empty() {
            return;
        }
        let em = how.em * self.scale;
        // Where each backend puts the baseline, for the anchor that asks for it.
        let (size, vertical, below) = match self.kind {
            Kind::Vector => (em * 1.24, VPos::Center, 0.5 * font::X_HEIGHT * how.em),
            Kind::Raster => {
                let size = em * font::HEIGHT_PER_EM;
                (size, VPos::Top, 0.5 * size / self.scale)
            }
        };
        let shift = 0.5 * font::DIGIT_HEIGHT * how.em - below;
        let (place, turn) = match how.upright {
            false => ((at.0, at.1 + shift), FontTransform::None),
            true => ((at.0 + shift, at.1), FontTransform::Rotate270),
        };
        let horizontal = match how.align {
            Align::Start => HPos::Left,
            Align::Middle => HPos::Center,
            Align::End => HPos::Right,
        };
        let colour = rgb(how.colour);
        let style = TextStyle::from(font::desc(size).transform(turn))
            .color(&colour)
            .pos(Pos::new(horizontal, vertical));
        let result = self.backend.draw_text(text, &style, self.pixel(place));
        self.note(result);
    }
}

/// Outline of open markers.
const OPEN_STROKE: f64 = 1.3;

fn rgb(colour: Colour) -> RGBColor {
    RGBColor(colour.0, colour.1, colour.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clipping_keeps_the_inside() {
        let r = Rect { left: 0.0, top: 0.0, width: 10.0, height: 10.0 };
        assert_eq!(r.clip((-5.0, 5.0), (15.0, 5.0)), Some(((0.0, 5.0), (10.0, 5.0))));
        assert_eq!(r.clip((-5.0, 11.0), (15.0, 11.0)), None);
        assert_eq!(r.clip((2.0, 2.0), (3.0, 3.0)), Some(((2.0, 2.0), (3.0, 3.0))));
    }
}
