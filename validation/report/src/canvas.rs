//! Drawing primitives in CSS pixels, as SVG or as pixels.
//!
//! The rasteriser knows whole pixels only, so everything is drawn `scale` times larger. Its first error is
//! kept and reported at the end, which keeps the drawing code free of `?`.

use super::colour::Colour;
use super::figure::{Align, Dash, Shape};
use super::{font, svg::Svg};
pub(super) use super::{font::Type, svg::Point};
use plotters::prelude::{BitMapBackend, DrawingBackend, RGBColor, TextStyle};
use plotters::style::FontTransform;
use plotters::style::text_anchor::{HPos, Pos, VPos};

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

    fn corners(&self) -> [Point; 4] {
        let (left, right, top, bottom) = (self.left, self.right(), self.top, self.bottom());
        [(left, top), (right, top), (right, bottom), (left, bottom)]
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

/// A drawing in progress.
pub(super) enum Canvas<'a> {
    /// As text.
    Vector(Svg),
    /// As pixels.
    Raster(Raster<'a>),
}

/// A drawing in pixels.
pub(super) struct Raster<'a> {
    backend: BitMapBackend<'a>,
    scale: f64,
    error: Option<String>,
}

impl Canvas<'_> {
    /// The text of a drawing as text, or the first error of one in pixels.
    pub fn finish(self) -> Result<String, String> {
        match self {
            Self::Vector(svg) => Ok(svg.finish()),
            Self::Raster(raster) => raster.finish().map(|()| String::new()),
        }
    }

    /// A filled rectangle.
    pub fn fill(&mut self, rect: Rect, colour: Colour) {
        match self {
            Self::Vector(svg) => svg.area(&rect.corners(), colour),
            Self::Raster(raster) => raster.fill(rect, colour),
        }
    }

    /// The outline of a rectangle.
    pub fn frame(&mut self, rect: Rect, colour: Colour, width: f64) {
        self.outline(&rect.corners(), colour, width, None);
    }

    /// The closed outline of a polygon, over a filling if there is one.
    fn outline(&mut self, corners: &[Point], colour: Colour, width: f64, fill: Option<Colour>) {
        match self {
            Self::Vector(svg) => svg.outline(corners, colour, width, fill),
            Self::Raster(raster) => {
                if let Some(fill) = fill {
                    raster.polygon(corners, fill);
                }
                let closed: Vec<_> = corners.iter().chain(&corners[..1]).copied().collect();
                raster.path(&closed, colour, width);
            }
        }
    }

    /// A filled polygon.
    pub fn polygon(&mut self, corners: &[Point], colour: Colour) {
        match self {
            Self::Vector(svg) => svg.area(corners, colour),
            Self::Raster(raster) => raster.polygon(corners, colour),
        }
    }

    /// A filled disc.
    pub fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        match self {
            Self::Vector(svg) => svg.disc(centre, radius, colour),
            Self::Raster(raster) => raster.disc(centre, radius, colour),
        }
    }

    /// A solid line from `a` to `b`.
    pub fn line(&mut self, a: Point, b: Point, colour: Colour, width: f64) {
        self.path(&[a, b], colour, width);
    }

    /// A solid line through the points.
    pub fn path(&mut self, points: &[Point], colour: Colour, width: f64) {
        self.dashed(points, colour, width, Dash::Solid);
    }

    /// A line through the points in the given pattern.
    pub fn dashed(&mut self, points: &[Point], colour: Colour, width: f64, dash: Dash) {
        match self {
            Self::Vector(svg) => svg.line(points, (colour, width), dash),
            Self::Raster(raster) if dash == Dash::Solid => raster.path(points, colour, width),
            Self::Raster(raster) => raster.dashed(points, colour, width, dash.pattern()),
        }
    }

    /// Markers of the given diameter.
    pub fn markers(&mut self, all: &[Point], shape: Shape, size: f64, colour: Colour, open: bool) {
        let r = 0.5 * size;
        let corners: &[Point] = match shape {
            Shape::Circle => {
                all.iter().for_each(|at| self.disc(*at, r, colour));
                let inner = all.iter().filter(|_| open);
                inner.for_each(|at| self.disc(*at, r - OPEN_STROKE, Colour::WHITE));
                return;
            }
            Shape::Cross | Shape::Plus => {
                let (dx, dy) =
                    if shape == Shape::Cross { (0.85 * r, 0.85 * r) } else { (1.15 * r, 0.0) };
                for &(x, y) in all {
                    self.line((x - dx, y - dy), (x + dx, y + dy), colour, 1.5);
                    self.line((x - dy, y + dx), (x + dy, y - dx), colour, 1.5);
                }
                return;
            }
            Shape::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Shape::Triangle => &[(0.0, -1.15), (1.08, 0.75), (-1.08, 0.75)],
            Shape::Down => &[(0.0, 1.15), (-1.08, -0.75), (1.08, -0.75)],
            Shape::Diamond => &[(0.0, -1.25), (1.1, 0.0), (0.0, 1.25), (-1.1, 0.0)],
        };
        for &(x, y) in all {
            let corners: Vec<Point> = corners.iter().map(|c| (x + r * c.0, y + r * c.1)).collect();
            match open {
                true => self.outline(&corners, colour, OPEN_STROKE, Some(Colour::WHITE)),
                false => self.polygon(&corners, colour),
            }
        }
    }

    /// A text, vertically centred on the digits' height at the point.
    pub fn text(&mut self, text: &str, at: Point, how: Type) {
        if text.is_empty() {
            return;
        }
        let below = 0.5 * font::DIGIT_HEIGHT * how.em;
        match self {
            Self::Vector(svg) => {
                let base = if how.upright { (at.0 + below, at.1) } else { (at.0, at.1 + below) };
                svg.text(text, base, how);
            }
            Self::Raster(raster) => raster.text(text, at, how),
        }
    }
}

impl<'a> Raster<'a> {
    pub fn new(backend: BitMapBackend<'a>, scale: f64) -> Self {
        Self { backend, scale, error: None }
    }

    fn finish(mut self) -> Result<(), String> {
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

    fn fill(&mut self, rect: Rect, colour: Colour) {
        let (a, b) = (self.pixel((rect.left, rect.top)), self.pixel((rect.right(), rect.bottom())));
        let result = self.backend.draw_rect(a, b, &rgb(colour), true);
        self.note(result);
    }

    fn polygon(&mut self, corners: &[Point], colour: Colour) {
        let pixels: Vec<_> = corners.iter().map(|&p| self.pixel(p)).collect();
        let result = self.backend.fill_polygon(pixels, &rgb(colour));
        self.note(result);
    }

    fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        let radius = (radius * self.scale).round().max(1.0) as u32;
        let result = self.backend.draw_circle(self.pixel(centre), radius, &rgb(colour), true);
        self.note(result);
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
        self.polygon(&corners, colour);
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

    fn text(&mut self, text: &str, at: Point, how: Type) {
        let size = how.em * self.scale * font::HEIGHT_PER_EM;
        // From the digits' centre to the centre of the line, which is what the rasteriser places.
        let shift = 0.5 * font::DIGIT_HEIGHT * how.em - 0.5 * size / self.scale;
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
            Dash::DashDot => &[7.0, 2.6, 1.6, 2.6],
        }
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
