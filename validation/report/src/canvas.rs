//! Drawing primitives in CSS pixels, on a sheet of text or of pixels.

use super::colour::Colour;
use super::figure::{Dash, Shape};
use super::font;
pub(super) use super::font::{Align, Type};

/// A point in CSS pixels, y downwards.
pub(super) type Point = (f64, f64);

/// A rectangle in CSS pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Rect {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Rect {
    /// A rectangle whose upper left corner is the origin.
    pub fn of((width, height): (f64, f64)) -> Self {
        Self { left: 0.0, top: 0.0, width, height }
    }

    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// The point at these shares of the width, and of the height from the bottom.
    pub fn at(&self, (x, y): (f64, f64)) -> Point {
        (self.left + x * self.width, self.bottom() - y * self.height)
    }

    fn corners(&self) -> [Point; 4] {
        let (left, right, top, bottom) = (self.left, self.right(), self.top, self.bottom());
        [(left, top), (right, top), (right, bottom), (left, bottom)]
    }

    pub fn contains(&self, (x, y): Point) -> bool {
        x >= self.left && x <= self.right() && y >= self.top && y <= self.bottom()
    }

    /// The point inside that is nearest to a point.
    pub fn nearest(&self, (x, y): Point) -> Point {
        (x.clamp(self.left, self.right()), y.clamp(self.top, self.bottom()))
    }

    /// Whether another rectangle is completely inside.
    pub fn encloses(&self, other: &Self) -> bool {
        self.contains((other.left, other.top)) && self.contains((other.right(), other.bottom()))
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

    /// The part of the segment inside (Liang and Barsky).
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

/// A surface for drawing.
pub(super) trait Sheet {
    /// A filled polygon.
    fn area(&mut self, corners: &[Point], colour: Colour);
    /// A line through the points in the given pattern; closed if it ends where it begins.
    fn line(&mut self, points: &[Point], colour: Colour, width: f64, dash: Dash);
    /// A filled disc.
    fn disc(&mut self, centre: Point, radius: f64, colour: Colour);
    /// A text with its point on its base line; upright text reads upwards, to the left of its point.
    fn text(&mut self, text: &str, at: Point, how: Type);
    /// From here on shapes belong to a series of this name; to none if it is empty.
    fn series(&mut self, _name: &str) {}
}

/// A part of a sheet, whose points count from a corner of it.
pub(super) struct Canvas<'a> {
    sheet: &'a mut dyn Sheet,
    corner: Point,
}

impl<'a> Canvas<'a> {
    /// The whole sheet.
    pub fn new(sheet: &'a mut dyn Sheet) -> Self {
        Self { sheet, corner: (0.0, 0.0) }
    }

    /// The part of a canvas to the right of and below the corner of a rectangle.
    pub fn from(&mut self, area: Rect) -> Canvas<'_> {
        let corner = self.moved((area.left, area.top));
        Canvas { sheet: self.sheet, corner }
    }

    fn moved(&self, (x, y): Point) -> Point {
        (x + self.corner.0, y + self.corner.1)
    }

    fn all_moved(&self, points: &[Point]) -> Vec<Point> {
        points.iter().map(|at| self.moved(*at)).collect()
    }

    /// A filled rectangle.
    pub fn fill(&mut self, rect: Rect, colour: Colour) {
        self.polygon(&rect.corners(), colour);
    }

    /// The outline of a rectangle.
    pub fn frame(&mut self, rect: Rect) {
        self.outline(&rect.corners(), Colour::BLACK, 1.0);
    }

    /// The outline of a polygon.
    fn outline(&mut self, corners: &[Point], colour: Colour, width: f64) {
        let closed: Vec<Point> = corners.iter().chain(&corners[..1]).copied().collect();
        self.dashed(&closed, colour, width, Dash::Solid);
    }

    /// A filled polygon.
    pub fn polygon(&mut self, corners: &[Point], colour: Colour) {
        self.sheet.area(&self.all_moved(corners), colour);
    }

    /// A filled disc.
    pub fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        self.sheet.disc(self.moved(centre), radius, colour);
    }

    /// A solid line from `a` to `b`.
    pub fn line(&mut self, a: Point, b: Point, colour: Colour, width: f64) {
        self.dashed(&[a, b], colour, width, Dash::Solid);
    }

    /// A line through the points in the given pattern.
    pub fn dashed(&mut self, points: &[Point], colour: Colour, width: f64, dash: Dash) {
        self.sheet.line(&self.all_moved(points), colour, width, dash);
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
            Shape::Cross => {
                let d = 0.85 * r;
                for &(x, y) in all {
                    self.line((x - d, y - d), (x + d, y + d), colour, 1.5);
                    self.line((x - d, y + d), (x + d, y - d), colour, 1.5);
                }
                return;
            }
            Shape::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Shape::Triangle => &[(0.0, -1.15), (1.08, 0.75), (-1.08, 0.75)],
            Shape::Down => &[(0.0, 1.15), (-1.08, -0.75), (1.08, -0.75)],
            Shape::Diamond => &[(0.0, -1.25), (1.1, 0.0), (0.0, 1.25), (-1.1, 0.0)],
        };
        let around = |(x, y): &Point| corners.iter().map(|c| (x + r * c.0, y + r * c.1)).collect();
        let polygons: Vec<Vec<Point>> = all.iter().map(around).collect();
        let fill = if open { Colour::WHITE } else { colour };
        polygons.iter().for_each(|polygon| self.polygon(polygon, fill));
        let outlined = polygons.iter().filter(|_| open);
        outlined.for_each(|polygon| self.outline(polygon, colour, OPEN_STROKE));
    }

    /// From here on shapes belong to a series of this name; to none if it is empty.
    pub fn series(&mut self, name: &str) {
        self.sheet.series(name);
    }

    /// A text, vertically centred on the digits' height at the point.
    pub fn text(&mut self, text: &str, at: Point, how: Type) {
        if !text.is_empty() {
            let (x, y) = self.moved(at);
            let below = 0.5 * font::DIGIT_HEIGHT * how.em;
            let base = if how.upright { (x + below, y) } else { (x, y + below) };
            self.sheet.text(text, base, how);
        }
    }
}

/// Outline of open markers.
const OPEN_STROKE: f64 = 1.3;

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
