//! Layout and drawing of one plot over two axes.

use super::axis::{Axis, Mapping, Ruler};
use super::bar::Bar;
use super::canvas::{Align, Canvas, Point, Rect, Type};
use super::colour::Colour;
use super::dots::{Scaled, draw_cell};
use super::figure::{BandPoint, Dot, Layer, Look, Plot, Series, Shape};
use super::font::{self, TICK_EM};
use super::frame::{Frame, Room};
use super::geometry::{clip_line, runs, sample_rect, sample_segment, thin};
use super::legend::{Entry, MARKER};

const MARK_EM: f64 = 9.0;
/// Number of points of lines, a few pixels apart, that the label of a point may hide.
const MARK_HIDES: usize = 2;
/// Least room for each label of an axis: along x and along y.
const X_TICK: f64 = 80.0;
const Y_TICK: f64 = 70.0;
/// Opacity of bands.
const BAND: f64 = 0.22;

/// A plot with everything decided but its place: all points count from the upper left corner of the axes.
pub(super) struct Prepared<'a> {
    plot: &'a Plot,
    frame: Frame<'a>,
    series: Vec<&'a Series>,
    marks: Vec<Mark<'a>>,
    dots: Option<Scaled<'a>>,
}

/// The label of a point, which starts in the middle of the left side of its room.
struct Mark<'a> {
    point: Point,
    text: &'a str,
    room: Rect,
    colour: Colour,
    series: &'a str,
}

impl<'a> Prepared<'a> {
    pub fn new(plot: &'a Plot, size: (f64, f64), [xs, ys]: &[Vec<f64>; 2]) -> Self {
        let (xs, ys) = (xs.iter().copied(), ys.iter().copied());
        let (mut x, mut y) = (plot.x.mapping(xs), plot.y.mapping(ys));
        let mut area = Rect::of(size);
        let mut dots = plot.dots().map(|dots| {
            // A dot on the border is completely visible.
            for axis in [&mut x, &mut y] {
                axis.lo -= 0.5 * dots.diameter;
                axis.hi += 0.5 * dots.diameter;
            }
            let (width, height) = (x.hi - x.lo, y.hi - y.lo);
            let pixels = (size.0 / width).min(size.1 / height);
            area = Rect::of((pixels * width, pixels * height));
            Scaled::new(dots, area.height, pixels)
        });
        let series = plot.layers.iter().filter_map(|layer| match layer {
            Layer::Series(series) => Some(series),
            _ => None,
        });
        let mut frame = Frame {
            area,
            x: x_ruler(&plot.x, x, area.width),
            y: plot.y.ruler(y, (area.height / Y_TICK) as usize),
            title: &plot.title,
            note: String::new(),
        };
        if plot.is_small {
            [&mut frame.x, &mut frame.y].into_iter().for_each(Ruler::clear);
            dots.iter_mut().for_each(|dots| dots.bar.is_shared = true);
        }
        let mut this = Self { plot, frame, series: series.collect(), marks: Vec::new(), dots };
        this.frame.note = this.dropped();
        this.place_marks();
        this
    }

    /// The plot, and the axes by which a place becomes a value.
    pub fn parts(&self) -> (&'a Plot, [&Ruler; 2]) {
        (self.plot, [&self.frame.x, &self.frame.y])
    }

    /// Its colour bar, if it has one.
    pub fn bar(&mut self) -> Option<&mut Bar> {
        self.dots.as_mut().map(|dots| &mut dots.bar)
    }

    /// The bar, unless the figure draws it.
    fn own_bar(&self) -> Option<&Bar> {
        self.dots.as_ref().map(|dots| &dots.bar).filter(|bar| !bar.is_shared)
    }

    /// Note on points that could not be drawn.
    fn dropped(&self) -> String {
        let is_lost = |dot: &&Dot| !(dot.x.is_finite() && dot.y.is_finite());
        let dots = self.plot.dots().into_iter().flat_map(|dots| &dots.points);
        let mut infinite = dots.filter(is_lost).count();
        let (mut nonpositive, mut off) = (0, 0);
        for series in &self.series {
            for &(x, y) in &series.points {
                match self.frame.place((x, y)) {
                    _ if !(x.is_finite() && y.is_finite()) => infinite += 1,
                    None => nonpositive += 1,
                    Some(p)
                        if series.look.marker.is_some()
                            && !self.frame.area.grown(0.5).contains(p) =>
                    {
                        off += 1
                    }
                    Some(_) => {}
                }
            }
        }
        let counts = [(infinite, "not finite"), (nonpositive, "≤ 0"), (off, "off scale")];
        let parts: Vec<_> =
            counts.iter().filter(|c| c.0 > 0).map(|(n, what)| format!("{n} {what}")).collect();
        if parts.is_empty() { String::new() } else { format!("not drawn: {}", parts.join(", ")) }
    }

    /// Points of lines and bars, a few pixels apart, which a label should not hide.
    fn obstacles(&self) -> Vec<Point> {
        let mut all = Vec::new();
        for series in &self.series {
            let mut segments = self.bars(series);
            if series.look.line.is_some() {
                let runs = runs(&series.points, |p| self.frame.place(p));
                segments.extend(runs.iter().flat_map(|run| run.windows(2)).map(|p| (p[0], p[1])));
            }
            for (a, b) in segments.into_iter().filter_map(|(a, b)| self.frame.area.clip(a, b)) {
                sample_segment(&mut all, a, b);
            }
        }
        all
    }

    /// Finds room for the labels of points, the ends of a series first, and makes them obstacles too.
    fn place_marks(&mut self) {
        let mut obstacles = self.obstacles();
        let markers: Vec<Point> =
            (self.series.iter().filter(|series| series.look.marker.is_some()))
                .flat_map(|series| series.points.iter().filter_map(|p| self.frame.place(*p)))
                .collect();
        let points = self.series.iter().flat_map(|series| {
            let last = series.labels.len().saturating_sub(1);
            let all = series.points.iter().zip(&series.labels).enumerate();
            all.map(move |(k, (p, text))| (k != 0 && k != last, *p, text, *series))
        });
        let mut points: Vec<_> = points.collect();
        points.sort_by_key(|(is_between, ..)| *is_between);
        for (_, point, text, series) in points {
            let Some(at) = self.frame.place(point) else { continue };
            let is_same = |Mark { text: other, point: (x, y), .. }: &Mark| {
                other == text && (x - at.0).hypot(y - at.1) < 6.0
            };
            if self.marks.iter().any(is_same) {
                continue;
            }
            let hidden = |room: &Rect| {
                let hides = markers.iter().any(|p| room.grown(3.5).contains(*p));
                let lines = obstacles.iter().filter(|&&p| room.contains(p)).count();
                (self.frame.area.encloses(room) && !hides && lines <= MARK_HIDES).then_some(lines)
            };
            let rooms = mark_rooms(at, font::width(text, MARK_EM)).into_iter();
            let free = rooms.filter_map(|room| Some((hidden(&room)?, room)));
            if let Some((_, room)) = free.min_by_key(|(lines, _)| *lines) {
                sample_rect(&mut obstacles, room);
                let (colour, series) = (series.look.colour, &*series.name);
                self.marks.push(Mark { point: at, text, room, colour, series });
            }
        }
    }

    /// Error bars of a series; an end without a place on a logarithmic axis goes off the low side.
    fn bars(&self, series: &Series) -> Vec<(Point, Point)> {
        let bar = |(&(x, y), &(lo, hi)): (&(f64, f64), &(f64, f64))| {
            let x_axis = &self.frame.x.mapping;
            let low = x_axis.unit(lo).or((lo <= 0.0).then_some(-1.0))?;
            let (_, y) = self.frame.place((x, y))?;
            let at = |unit: f64| (unit * self.frame.area.width, y);
            Some((at(low), at(x_axis.unit(hi)?)))
        };
        series.points.iter().zip(&series.x_bars).filter_map(bar).collect()
    }

    fn draw_band(&self, canvas: &mut Canvas, points: &[BandPoint], colour: Colour) {
        let ends = |BandPoint { x, lower, upper }| {
            Some((self.frame.place((x, lower))?, self.frame.place((x, upper))?))
        };
        for run in runs(points, ends) {
            let (lower, upper): (Vec<Point>, Vec<Point>) = run.into_iter().unzip();
            let outline = lower.into_iter().chain(upper.into_iter().rev());
            let outline: Vec<Point> = outline.map(|p| self.frame.area.nearest(p)).collect();
            if outline.len() > 2 {
                canvas.polygon(&thin(&outline), colour.tint(BAND));
            }
        }
    }

    fn draw_series(&self, canvas: &mut Canvas, series: &Series) {
        let look = series.look;
        for (a, b) in self.bars(series) {
            if let Some((p, q)) = self.frame.area.clip(a, b) {
                canvas.line(p, q, look.colour, 1.0);
            }
            for (x, y) in [a, b].into_iter().filter(|&p| self.frame.area.contains(p)) {
                canvas.line((x, y - 3.5), (x, y + 3.5), look.colour, 1.0);
            }
        }
        if let Some(dash) = look.line {
            for run in runs(&series.points, |p| self.frame.place(p)) {
                for piece in clip_line(&thin(&run), self.frame.area) {
                    canvas.dashed(&piece, look.colour, look.width, dash);
                }
            }
        }
        if let Some(shape) = look.marker {
            let places = series.points.iter().filter_map(|&p| self.frame.place(p));
            let places: Vec<Point> =
                places.filter(|p| self.frame.area.grown(0.5).contains(*p)).collect();
            canvas.markers(&places, shape, MARKER, look.colour, look.open);
        }
    }

    /// Entries of the legend, if there is one: series, and cells as squares. A series without a point has no
    /// symbol in the plot, and no entry.
    pub fn legend(&self) -> Vec<Entry> {
        let entry = |layer: &Layer| match layer {
            Layer::Series(series) if series.points.is_empty() => None,
            Layer::Series(Series { name, look, .. }) => {
                Some(Entry { name: name.clone(), look: *look })
            }
            Layer::Cells { name, colour, .. } => {
                let (colour, marker) = (*colour, Some(Shape::Square));
                let look = Look { colour, line: None, width: 0.0, marker, open: false };
                Some(Entry { name: name.clone(), look })
            }
            _ => None,
        };
        let layers = self.plot.layers.iter().filter(|_| self.plot.legend);
        layers.filter_map(entry).filter(|entry| !entry.name.is_empty()).collect()
    }

    /// The room that it takes with its colour bar.
    pub fn room(&self) -> Room {
        let last = self.frame.x.major.last();
        let overhang = last.map_or(0.0, |(_, label)| font::width(label, TICK_EM) / 2.0);
        let bar = self.own_bar().map_or(0.0, Bar::width);
        self.frame.room((overhang + 2.0).max(10.0).max(bar))
    }

    /// Draws the plot; the upper left corner of its axes is the canvas's.
    pub fn draw(&self, canvas: &mut Canvas) {
        let area = self.frame.area;
        // Bands are below the grid.
        for layer in &self.plot.layers {
            if let Layer::Band { points, colour } = layer {
                self.draw_band(canvas, points, *colour);
            }
        }
        self.frame.draw(canvas);
        for layer in &self.plot.layers {
            if let Layer::Cells { cells, colour, name } = layer {
                canvas.series(name);
                cells.iter().for_each(|cell| draw_cell(canvas, &self.frame, cell, *colour));
            }
        }
        canvas.series("");
        if let Some(dots) = &self.dots {
            dots.draw(canvas, &self.frame);
        }
        for series in &self.series {
            canvas.series(&series.name);
            self.draw_series(canvas, series);
        }
        for mark in &self.marks {
            canvas.series(mark.series);
            let at = mark.room.at((0.0, 0.5));
            canvas.text(mark.text, at, Type::new(MARK_EM, Align::Start).colour(mark.colour));
        }
        canvas.series("");
        canvas.frame(area);
        if let Some(bar) = self.own_bar() {
            bar.draw(canvas, area);
        }
    }
}

/// Every x and every y that an automatic range should show.
pub(super) fn extent(plot: &Plot) -> [Vec<f64>; 2] {
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for layer in &plot.layers {
        match layer {
            Layer::Series(s) => {
                // A point that cannot be drawn must not stretch the other axis.
                for &(x, y) in s.points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
                    xs.push(x);
                    ys.push(y);
                }
                xs.extend(s.x_bars.iter().flat_map(|b| [b.0, b.1]));
            }
            Layer::Band { points, .. } => {
                xs.extend(points.iter().map(|p| p.x));
                ys.extend(points.iter().flat_map(|p| [p.lower, p.upper]));
            }
            Layer::Dots(dots) => {
                xs.extend(dots.points.iter().map(|p| p.x));
                ys.extend(dots.points.iter().map(|p| p.y));
            }
            Layer::Cells { .. } => {}
        }
    }
    [xs, ys]
}

/// The x axis with as many ticks as have room for their labels.
fn x_ruler(axis: &Axis, mapping: Mapping, width: f64) -> Ruler {
    let overlap = |ruler: &Ruler| {
        ruler.major.windows(2).any(|pair| {
            let half = |label: &str| 0.5 * font::width(label, TICK_EM);
            pair[1].0 * width - half(&pair[1].1) < pair[0].0 * width + half(&pair[0].1) + 7.0
        })
    };
    let most = ((width / X_TICK) as usize).max(3);
    let found = (2..=most).rev().map(|count| axis.ruler(mapping, count)).find(|r| !overlap(r));
    found.unwrap_or_else(|| axis.ruler(mapping, 2))
}

/// Places for the label of a point: right, left, above, below, and between.
fn mark_rooms((x, y): Point, width: f64) -> [Rect; 8] {
    let (side, off) = (6.0, 5.0);
    let [right, left, middle] = [x + side, x - side - width, x - 0.5 * width];
    let [above, centred, below] = [y - off - MARK_EM, y - 0.5 * MARK_EM, y + off];
    [
        (right, centred),
        (middle, above),
        (middle, below),
        (left, centred),
        (right, above),
        (right, below),
        (left, above),
        (left, below),
    ]
    .map(|(left, top)| Rect { left, top, width, height: MARK_EM })
}
