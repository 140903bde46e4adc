//! Layout and drawing of one plot over two axes.

use super::axis::Mapping;
use super::canvas::{Canvas, Point, Rect, Type};
use super::colour::Colour;
use super::figure::{Align, Dash, Layer, Legend, Orientation, Plot, Series, Shape};
use super::font;
use super::frame::{Margins, TICK_EM, Texts, axes, fit, labels, margins, widest_label};
use super::geometry::{
    band_runs, clip_line, clip_polygon, runs, sample_rect, sample_segment, shift, shift_rect,
    text_rect, thin,
};
use super::legend::{self, Entry, Look, Sample};
use super::ticks::{Ticks, minus, with_exponent};

const NOTE_EM: f64 = 9.5;
const RULE_EM: f64 = 10.5;
const STRIP_ROW: f64 = 15.0;
const MARK_EM: f64 = 9.0;
/// How many points of lines, which lie a few pixels apart, the label of a point may hide.
const MARK_HIDES: usize = 2;

/// A plot with everything decided that the page around it must know.
pub(super) struct Prepared<'a> {
    plot: &'a Plot,
    size: (f64, f64),
    x: Mapping,
    y: Mapping,
    x_ticks: Ticks,
    y_ticks: Ticks,
    looks: Vec<Option<Look>>,
    failed: Vec<Failure>,
    strip: f64,
    slopes: Vec<Option<[Point; 3]>>,
    rules: Vec<Option<(Rect, Align)>>,
    marks: Vec<Mark>,
    entries: Vec<Entry>,
    legend: Legend,
    note: String,
}

/// The label of a point, which starts in the middle of the left side of its room.
struct Mark {
    text: String,
    room: Rect,
    colour: Colour,
}

/// A failed run in the strip at the upper edge.
struct Failure {
    x: f64,
    row: usize,
    align: Align,
    reason: String,
}

impl<'a> Prepared<'a> {
    pub fn new(plot: &'a Plot, size: (f64, f64)) -> Self {
        let (xs, ys) = extent(plot);
        let (x, y) = (plot.x.mapping(xs.into_iter()), plot.y.mapping(ys.into_iter()));
        let y_ticks = plot.y.place_ticks(&y, (size.1 / 42.0) as usize);
        let looks = looks(&plot.layers);
        let mut this = Self {
            plot,
            size,
            x,
            y,
            x_ticks: x_ticks(plot, &x, size.0),
            y_ticks,
            entries: entries(&plot.layers, &looks),
            looks,
            failed: Vec::new(),
            strip: 0.0,
            slopes: Vec::new(),
            rules: Vec::new(),
            marks: Vec::new(),
            legend: plot.legend,
            note: String::new(),
        };
        this.place_failures();
        this.note = this.dropped();
        let mut obstacles = this.obstacles();
        if !matches!(this.legend, Legend::Auto | Legend::Outside | Legend::Hidden) {
            sample_rect(&mut obstacles, legend::rect(&this.entries, this.data_area(), this.legend));
        }
        this.place_slopes(&mut obstacles);
        this.place_rules(&mut obstacles);
        this.place_marks(&mut obstacles);
        if this.entries.is_empty() {
            this.legend = Legend::Hidden;
        } else if this.legend == Legend::Auto {
            this.legend = legend::place(&this.entries, this.data_area(), &obstacles);
        }
        this
    }

    pub fn size(&self) -> (f64, f64) {
        self.size
    }

    /// The entries of its legend, if that is drawn.
    pub fn legend(&self) -> &[Entry] {
        if self.legend == Legend::Hidden { &[] } else { &self.entries }
    }

    /// Leaves the legend to the figure.
    pub fn hide_legend(&mut self) {
        self.legend = Legend::Hidden;
    }

    pub fn margins(&self) -> Margins {
        let overhang =
            self.x_ticks.major.last().map_or(0.0, |(_, l)| font::width(l, TICK_EM) / 2.0);
        let outside = match self.legend {
            Legend::Outside => legend::size(&self.entries).0 + 12.0,
            _ => 0.0,
        };
        let around = self.with_texts(|texts| margins(texts, widest_label(&self.y_ticks)));
        Margins { right: (overhang + 2.0).max(10.0).max(outside), ..around }
    }

    fn with_texts<R>(&self, then: impl FnOnce(&Texts) -> R) -> R {
        then(&Texts {
            title: &self.plot.title,
            note: &self.note,
            x: &with_exponent(&self.plot.x.label, self.x_ticks.exponent),
            y: &with_exponent(&self.plot.y.label, self.y_ticks.exponent),
        })
    }

    /// Draws into the canvas; the axes enclose `area`.
    pub fn draw(&self, canvas: &mut Canvas, area: Rect) {
        for layer in &self.plot.layers {
            self.background(canvas, area, layer);
        }
        axes(canvas, area, self.strip, (&self.x, &self.x_ticks), (&self.y, &self.y_ticks));
        self.with_texts(|texts| labels(canvas, area, texts, widest_label(&self.y_ticks)));
        for (i, layer) in self.plot.layers.iter().enumerate() {
            if let Layer::Rule { orientation, at, label, colour, dash } = layer {
                let ends = self.across(*orientation, *at, area);
                self.rule(canvas, area, ends, (label, *colour, *dash), self.rules[i]);
            }
        }
        for (i, layer) in self.plot.layers.iter().enumerate() {
            match layer {
                Layer::Series(series) => {
                    let look = self.looks[i].expect("every series has a look");
                    self.series(canvas, area, series, look);
                }
                Layer::Slope { order, .. } => {
                    if let Some(corners) = self.slopes[i] {
                        slope(canvas, area, *order, corners);
                    }
                }
                Layer::Text { at, text, align } => {
                    if let Some(p) = self.place(*at).map(|p| shift(p, area)) {
                        canvas.text(text, p, Type::new(RULE_EM, *align));
                    }
                }
                _ => {}
            }
        }
        for mark in &self.marks {
            let room = shift_rect(mark.room, area);
            let at = (room.left, room.top + 0.5 * room.height);
            canvas.text(&mark.text, at, Type::new(MARK_EM, Align::Start).colour(mark.colour));
        }
        self.failures(canvas, area);
        canvas.frame(area, Colour::BLACK, 1.0);
        if self.legend != Legend::Hidden {
            let place = if self.legend == Legend::Auto { Legend::TopRight } else { self.legend };
            let inner = shift_rect(self.data_area(), area);
            let rect = legend::rect(&self.entries, inner, place);
            let boxed = place != Legend::Outside;
            legend::draw(canvas, &self.entries, (rect.left, rect.top), boxed);
        }
    }

    /// The area below the strip of failures, relative to the axes' upper left corner.
    fn data_area(&self) -> Rect {
        let (width, height) = self.size;
        Rect { left: 0.0, top: self.strip, width, height: height - self.strip }
    }

    /// Where a point lies, relative to the axes' upper left corner.
    fn place(&self, (x, y): (f64, f64)) -> Option<Point> {
        let (ux, uy) = (self.x.unit(x)?, self.y.unit(y)?);
        Some((ux * self.size.0, self.strip + (1.0 - uy) * (self.size.1 - self.strip)))
    }

    fn place_failures(&mut self) {
        let mut ends: Vec<f64> = Vec::new();
        for layer in &self.plot.layers {
            let Layer::Failed(runs) = layer else { continue };
            let mut runs: Vec<_> =
                runs.iter().filter_map(|r| Some((self.x.unit(r.0)?, &r.1))).collect();
            runs.retain(|r| (-1e-9..=1.0 + 1e-9).contains(&r.0));
            runs.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (unit, reason) in runs {
                let (x, width) = (unit * self.size.0, font::width(reason, NOTE_EM));
                let [before, after] = [x - 12.0, self.size.0 - x - 12.0];
                let align = if width < after || after > before { Align::Start } else { Align::End };
                let (from, to) = match align {
                    Align::Start => (x - 8.0, x + 10.0 + width.min(after)),
                    _ => (x - 10.0 - width.min(before), x + 8.0),
                };
                let row = ends.iter().position(|&end| end < from).unwrap_or(ends.len());
                match ends.get_mut(row) {
                    Some(end) => *end = to,
                    None => ends.push(to),
                }
                self.failed.push(Failure { x, row, align, reason: reason.clone() });
            }
        }
        if !ends.is_empty() {
            self.strip = (ends.len() as f64 * STRIP_ROW + 4.0).min(0.6 * self.size.1);
        }
    }

    /// What could not be drawn, in words.
    fn dropped(&self) -> String {
        let (mut infinite, mut nonpositive, mut off) = (0, 0, 0);
        for layer in &self.plot.layers {
            let Layer::Series(s) = layer else { continue };
            for &(x, y) in &s.points {
                match self.place((x, y)) {
                    _ if !(x.is_finite() && y.is_finite()) => infinite += 1,
                    None => nonpositive += 1,
                    Some(p) if s.marked && !self.data_area().grown(0.5).contains(p) => off += 1,
                    Some(_) => {}
                }
            }
        }
        let counts = [(infinite, "not finite"), (nonpositive, "≤ 0"), (off, "off scale")];
        let parts: Vec<_> =
            counts.iter().filter(|c| c.0 > 0).map(|(n, what)| format!("{n} {what}")).collect();
        if parts.is_empty() { String::new() } else { format!("not drawn: {}", parts.join(", ")) }
    }

    /// Points that a legend or label should not hide.
    fn obstacles(&self) -> Vec<Point> {
        let mut all = Vec::new();
        for layer in &self.plot.layers {
            match layer {
                Layer::Series(s) => {
                    let joined = s.line.is_some();
                    for run in runs(&s.points, |p| self.place(p)) {
                        all.extend_from_slice(&run);
                        let r = if s.marked { 0.5 * s.size } else { 0.0 };
                        let around = [(r, 0.0), (-r, 0.0), (0.0, r), (0.0, -r)];
                        all.extend(run.iter().flat_map(|p| around.map(|d| (p.0 + d.0, p.1 + d.1))));
                        let pairs = run.windows(2).take(if joined { usize::MAX } else { 0 });
                        for pair in pairs {
                            if let Some((a, b)) = self.data_area().clip(pair[0], pair[1]) {
                                sample_segment(&mut all, a, b);
                            }
                        }
                    }
                    for (a, b) in self.bars(s) {
                        if let Some((a, b)) = self.data_area().clip(a, b) {
                            sample_segment(&mut all, a, b);
                        }
                    }
                }
                Layer::Text { at, text, align } => {
                    if let Some(p) = self.place(*at) {
                        sample_rect(&mut all, text_rect(p, text, RULE_EM, *align));
                    }
                }
                _ => {}
            }
        }
        all
    }

    /// Finds room for the labels of the rules, and makes lines and labels obstacles too.
    fn place_rules(&mut self, obstacles: &mut Vec<Point>) {
        let origin = Rect { left: 0.0, top: 0.0, width: self.size.0, height: self.size.1 };
        for layer in &self.plot.layers {
            let Layer::Rule { orientation, at, label, .. } = layer else {
                self.rules.push(None);
                continue;
            };
            let Some((a, b)) = self.across(*orientation, *at, origin) else {
                self.rules.push(None);
                continue;
            };
            let spots = rule_spots(*orientation, (a, b), font::width(label, RULE_EM));
            let area = self.data_area();
            let inside =
                |r: &Rect| area.contains((r.left, r.top)) && area.contains((r.right(), r.bottom()));
            let hidden = |r: &Rect| {
                obstacles.iter().filter(|&&p| r.grown(1.0).contains(p)).count()
                    + if inside(r) { 0 } else { 100_000 }
            };
            let best = spots.into_iter().min_by_key(|(r, _)| hidden(r));
            sample_segment(obstacles, a, b);
            if let Some((rect, _)) = best.filter(|_| !label.is_empty()) {
                sample_rect(obstacles, rect);
            }
            self.rules.push(best);
        }
    }

    /// Finds room for the labels of points, the ends of a series first, and makes them obstacles too.
    fn place_marks(&mut self, obstacles: &mut Vec<Point>) {
        let labelled: Vec<(&Series, Look)> = (self.plot.layers.iter().zip(&self.looks))
            .filter_map(|(layer, look)| match layer {
                Layer::Series(series) => Some((series, (*look)?)),
                _ => None,
            })
            .collect();
        let markers: Vec<Point> = (labelled.iter().filter(|(series, _)| series.marked))
            .flat_map(|(series, _)| series.points.iter().filter_map(|p| self.place(*p)))
            .collect();
        let last = |series: &Series| series.labels.len().saturating_sub(1);
        let points = labelled.iter().flat_map(|(series, look)| {
            let all = series.points.iter().zip(&series.labels).enumerate();
            all.map(move |(k, (p, text))| ((k != last(series)), k != 0, *p, text, look.colour))
        });
        let mut points: Vec<_> = points.collect();
        points.sort_by_key(|(is_not_last, is_not_first, ..)| *is_not_last && *is_not_first);
        let mut found: Vec<(Point, Mark)> = Vec::new();
        for (_, _, point, text, colour) in points {
            let Some(at) = self.place(point) else { continue };
            let is_same = |(other, mark): &(Point, Mark)| {
                mark.text == *text && (other.0 - at.0).hypot(other.1 - at.1) < 6.0
            };
            if found.iter().any(is_same) {
                continue;
            }
            let hidden = |room: &Rect| {
                let area = self.data_area();
                let inside = area.contains((room.left, room.top))
                    && area.contains((room.right(), room.bottom()));
                let hides = markers.iter().any(|p| room.grown(3.5).contains(*p));
                let lines = obstacles.iter().filter(|&&p| room.contains(p)).count();
                (inside && !hides && lines <= MARK_HIDES).then_some(lines)
            };
            let rooms = mark_rooms(at, font::width(text, MARK_EM)).into_iter();
            let free = rooms.filter_map(|room| Some((hidden(&room)?, room)));
            if let Some((_, room)) = free.min_by_key(|(lines, _)| *lines) {
                sample_rect(obstacles, room);
                found.push((at, Mark { text: text.clone(), room, colour }));
            }
        }
        self.marks = found.into_iter().map(|(_, mark)| mark).collect();
    }

    /// The ends of a line across the plot.
    fn across(&self, orientation: Orientation, at: f64, area: Rect) -> Option<(Point, Point)> {
        let inside = |u: &f64| (-1e-9..=1.0 + 1e-9).contains(u);
        match orientation {
            Orientation::Horizontal => {
                let u = self.y.unit(at).filter(inside)?;
                let y = area.top + self.strip + (1.0 - u) * (self.size.1 - self.strip);
                Some(((area.left, y), (area.right(), y)))
            }
            Orientation::Vertical => {
                let x = area.left + self.x.unit(at).filter(inside)? * self.size.0;
                Some(((x, area.top + self.strip), (x, area.bottom())))
            }
        }
    }

    fn rule(
        &self,
        canvas: &mut Canvas,
        area: Rect,
        ends: Option<(Point, Point)>,
        (label, colour, dash): (&str, Colour, Dash),
        spot: Option<(Rect, Align)>,
    ) {
        let (Some((a, b)), Some((rect, align))) = (ends, spot) else { return };
        canvas.dashed(&[a, b], colour, 1.2, dash);
        let rect = shift_rect(rect, area);
        let how = Type::new(RULE_EM, align).colour(colour);
        if a.0 == b.0 {
            let y = if align == Align::End { rect.top } else { rect.bottom() };
            canvas.text(label, (rect.left + 0.5 * rect.width, y), how.upright());
        } else {
            let x = if align == Align::End { rect.right() } else { rect.left };
            canvas.text(label, (x, rect.top + 0.5 * rect.height), how);
        }
    }

    /// Bands and spans lie below the grid.
    fn background(&self, canvas: &mut Canvas, area: Rect, layer: &Layer) {
        match layer {
            Layer::Band { points, colour, .. } => {
                for strip in band_runs(points, |p| self.place(p)) {
                    let clipped = clip_polygon(&strip, self.data_area());
                    if clipped.len() > 2 {
                        let moved: Vec<_> =
                            thin(&clipped).into_iter().map(|p| shift(p, area)).collect();
                        canvas.polygon(&moved, colour.tint(BAND));
                    }
                }
            }
            Layer::Span { orientation, from, to, colour, .. } => {
                let (axis, lo, hi) = match orientation {
                    Orientation::Horizontal => (&self.y, from.min(*to), from.max(*to)),
                    Orientation::Vertical => (&self.x, from.min(*to), from.max(*to)),
                };
                let u0 = axis.unit(lo).unwrap_or(0.0).clamp(0.0, 1.0);
                let u1 = axis.unit(hi).unwrap_or(1.0).clamp(0.0, 1.0);
                let inner = shift_rect(self.data_area(), area);
                let rect = match orientation {
                    Orientation::Horizontal => Rect {
                        top: inner.top + (1.0 - u1) * inner.height,
                        height: (u1 - u0) * inner.height,
                        ..inner
                    },
                    Orientation::Vertical => Rect {
                        left: inner.left + u0 * inner.width,
                        width: (u1 - u0) * inner.width,
                        ..inner
                    },
                };
                canvas.fill(rect, colour.tint(BAND));
            }
            _ => {}
        }
    }

    fn series(&self, canvas: &mut Canvas, area: Rect, series: &Series, look: Look) {
        let inner = shift_rect(self.data_area(), area);
        for (a, b) in self.bars(series) {
            self.bar(canvas, inner, (shift(a, area), shift(b, area)), look.colour);
        }
        if let Some(dash) = look.line {
            for run in runs(&series.points, |p| self.place(p).map(|p| shift(p, area))) {
                for piece in clip_line(&thin(&run), inner) {
                    canvas.dashed(&piece, look.colour, look.width, dash);
                }
            }
        }
        if let Some((shape, size)) = look.marker {
            let places =
                series.points.iter().filter_map(|&p| self.place(p)).map(|p| shift(p, area));
            let places: Vec<Point> = places.filter(|p| inner.grown(0.5).contains(*p)).collect();
            canvas.markers(&places, shape, size, look.colour, look.open);
        }
    }

    /// Error bars of a series; an end without a place on a logarithmic axis goes off the low side.
    fn bars(&self, series: &Series) -> Vec<(Point, Point)> {
        let mut bars = Vec::new();
        let (width, height) = (self.size.0, self.size.1 - self.strip);
        let low = |axis: &Mapping, v: f64| match axis.unit(v) {
            None if v <= 0.0 => Some(-1.0),
            place => place,
        };
        for (&(x, y), &(lo, hi)) in series.points.iter().zip(&series.y_bars) {
            if let (Some(p), Some(lo), Some(hi)) =
                (self.place((x, y)), low(&self.y, lo), self.y.unit(hi))
            {
                let at = |u: f64| (p.0, self.strip + (1.0 - u) * height);
                bars.push((at(lo), at(hi)));
            }
        }
        for (&(x, y), &(lo, hi)) in series.points.iter().zip(&series.x_bars) {
            if let (Some(p), Some(lo), Some(hi)) =
                (self.place((x, y)), low(&self.x, lo), self.x.unit(hi))
            {
                bars.push(((lo * width, p.1), (hi * width, p.1)));
            }
        }
        bars
    }

    fn bar(&self, canvas: &mut Canvas, inner: Rect, (a, b): (Point, Point), colour: Colour) {
        if let Some((p, q)) = inner.clip(a, b) {
            canvas.line(p, q, colour, 1.0);
        }
        let cap = if a.0 == b.0 { (3.5, 0.0) } else { (0.0, 3.5) };
        for end in [a, b].into_iter().filter(|&p| inner.contains(p)) {
            let ends = ((end.0 - cap.0, end.1 - cap.1), (end.0 + cap.0, end.1 + cap.1));
            canvas.line(ends.0, ends.1, colour, 1.0);
        }
    }

    /// Decides where the slope triangles lie, and makes them obstacles.
    fn place_slopes(&mut self, obstacles: &mut Vec<Point>) {
        for layer in &self.plot.layers {
            let Layer::Slope { order, anchor, factor } = layer else {
                self.slopes.push(None);
                continue;
            };
            let corners = match anchor {
                Some(anchor) => self.triangle(*order, *anchor, *factor),
                None => [1.0, 0.7, 0.5, 0.35, 0.25]
                    .iter()
                    .find_map(|&part| self.free_triangle(*order, factor.powf(part), obstacles)),
            };
            if let Some(corners) = corners {
                sample_rect(obstacles, around(&corners));
            }
            self.slopes.push(corners);
        }
    }

    fn triangle(&self, order: f64, (x, y): (f64, f64), factor: f64) -> Option<[Point; 3]> {
        let a = self.place((x, y)).filter(|_| order.is_finite())?;
        let b = self.place((x * factor, y))?;
        let c = self.place((x * factor, y * factor.powf(order)))?;
        Some([a, b, c])
    }

    /// The free place closest to the data.
    fn free_triangle(&self, order: f64, factor: f64, data: &[Point]) -> Option<[Point; 3]> {
        let [a, b, c] = self.triangle(order, (self.x.lo, self.y.lo), factor)?;
        let area = self.data_area();
        let steps = |length: f64| (0..(length / 6.0) as i32).map(|i| 6.0 * f64::from(i));
        let moved = |dx: f64, dy: f64| {
            [a, b, c].map(|p| (p.0 - a.0 + area.left + dx, p.1 - a.1 + area.top + dy))
        };
        let mut best = None;
        for (dx, dy) in steps(area.width).flat_map(|x| steps(area.height).map(move |y| (x, y))) {
            let corners = moved(dx, dy);
            let rect = around(&corners);
            if !(area.contains((rect.left, rect.top))
                && area.contains((rect.right(), rect.bottom())))
            {
                continue;
            }
            let gap = data.iter().map(|&p| rect.distance(p)).fold(f64::INFINITY, f64::min);
            if gap > 5.0 && best.is_none_or(|(least, _)| gap < least) {
                best = Some((gap, corners));
            }
        }
        best.map(|(_, corners)| corners)
    }

    fn failures(&self, canvas: &mut Canvas, area: Rect) {
        if self.failed.is_empty() {
            return;
        }
        let strip = Rect { height: self.strip, ..area };
        canvas.fill(strip, Colour::VERMILLION.tint(0.1));
        let line = area.top + self.strip;
        canvas.line((area.left, line), (area.right(), line), Colour::GREY, 0.7);
        for f in &self.failed {
            let at = (area.left + f.x, area.top + 2.0 + (f.row as f64 + 0.5) * STRIP_ROW);
            canvas.markers(&[at], Shape::Cross, 8.5, Colour::VERMILLION, false);
            let side = if f.align == Align::Start { 8.0 } else { -8.0 };
            let room = if f.align == Align::Start { area.width - f.x } else { f.x };
            let em = fit(&f.reason, NOTE_EM, room - 12.0);
            let how = Type::new(em, f.align).colour(Colour(150, 60, 0));
            canvas.text(&f.reason, (at.0 + side, at.1), how);
        }
    }
}

/// Opacity of bands and spans.
const BAND: f64 = 0.22;

/// Every x and every y that an automatic range should show.
fn extent(plot: &Plot) -> (Vec<f64>, Vec<f64>) {
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for layer in &plot.layers {
        match layer {
            Layer::Series(s) => {
                // A point that cannot be drawn must not stretch the other axis.
                for &(x, y) in s.points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
                    xs.push(x);
                    ys.push(y);
                }
                ys.extend(s.y_bars.iter().flat_map(|b| [b.0, b.1]));
                xs.extend(s.x_bars.iter().flat_map(|b| [b.0, b.1]));
            }
            Layer::Slope { order, anchor: Some((x, y)), factor } => {
                xs.extend([*x, x * factor]);
                ys.extend([*y, y * factor.powf(*order)]);
            }
            Layer::Rule { orientation, at, .. } => match orientation {
                Orientation::Horizontal => ys.push(*at),
                Orientation::Vertical => xs.push(*at),
            },
            Layer::Band { points, .. } => {
                xs.extend(points.iter().map(|p| p.0));
                ys.extend(points.iter().flat_map(|p| [p.1, p.2]));
            }
            Layer::Span { orientation, from, to, .. } => match orientation {
                Orientation::Horizontal => ys.extend([*from, *to]),
                Orientation::Vertical => xs.extend([*from, *to]),
            },
            Layer::Text { at, .. } => {
                xs.push(at.0);
                ys.push(at.1);
            }
            Layer::Slope { anchor: None, .. } => {}
            Layer::Failed(runs) => xs.extend(runs.iter().map(|r| r.0)),
        }
    }
    (xs, ys)
}

/// Ticks of the x axis, as many as have room for their labels.
fn x_ticks(plot: &Plot, mapping: &Mapping, width: f64) -> Ticks {
    let overlap = |t: &Ticks| {
        t.major.windows(2).any(|pair| {
            let at = |v: f64| mapping.unit(v).unwrap_or(0.0) * width;
            let half = |l: &str| 0.5 * font::width(l, TICK_EM);
            at(pair[1].0) - half(&pair[1].1) < at(pair[0].0) + half(&pair[0].1) + 7.0
        })
    };
    let most = ((width / 52.0) as usize).max(3);
    let found = (2..=most).rev().map(|n| plot.x.place_ticks(mapping, n)).find(|t| !overlap(t));
    found.unwrap_or_else(|| plot.x.place_ticks(mapping, 2))
}

fn looks(layers: &[Layer]) -> Vec<Option<Look>> {
    let (mut colours, mut shapes) = (0, 0);
    let mut look = |s: &Series| {
        let colour = s.colour.unwrap_or_else(|| {
            colours += 1;
            Colour::cycle(colours - 1)
        });
        let shape = s.marked.then(|| {
            s.shape.unwrap_or_else(|| {
                shapes += 1;
                Shape::cycle(shapes - 1)
            })
        });
        let marker = shape.map(|shape| (shape, s.size));
        Look { colour, line: s.line, width: s.width, marker, open: s.open }
    };
    layers.iter().map(|l| if let Layer::Series(s) = l { Some(look(s)) } else { None }).collect()
}

fn entries(layers: &[Layer], looks: &[Option<Look>]) -> Vec<Entry> {
    let entry = |(layer, look): (&Layer, &Option<Look>)| {
        let (name, sample) = match layer {
            // A run without a point would have a symbol in the legend and none in the plot.
            Layer::Series(s) if s.points.is_empty() => return None,
            Layer::Series(s) => (&s.name, Sample::Series((*look)?)),
            Layer::Band { name, colour, .. } | Layer::Span { name, colour, .. } => {
                (name, Sample::Patch(colour.tint(BAND)))
            }
            _ => return None,
        };
        (!name.is_empty()).then(|| Entry { name: name.clone(), sample })
    };
    layers.iter().zip(looks).filter_map(entry).collect()
}

/// The room that a slope triangle takes with its numbers.
fn around(corners: &[Point; 3]) -> Rect {
    let least = |of: fn(&Point) -> f64| corners.iter().map(of).fold(f64::INFINITY, f64::min);
    let most = |of: fn(&Point) -> f64| corners.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    let (left, top) = (least(|p| p.0), least(|p| p.1));
    let (width, height) = (most(|p| p.0) - left, most(|p| p.1) - top);
    Rect { left: left - 14.0, top: top - 14.0, width: width + 42.0, height: height + 28.0 }
}

/// A triangle with its rise beside and a 1 along its run.
fn slope(canvas: &mut Canvas, area: Rect, order: f64, corners: [Point; 3]) {
    let [a, b, c] = corners.map(|p| shift(p, area));
    for (p, q) in [(a, b), (b, c), (c, a)] {
        if let Some((p, q)) = area.clip(p, q) {
            canvas.line(p, q, Colour::GREY, 1.0);
        }
    }
    let how = |align| Type::new(RULE_EM, align).colour(Colour::GREY);
    let (align, side) = if b.0 > a.0 { (Align::Start, 5.0) } else { (Align::End, -5.0) };
    let number = minus(format!("{}", (order * 100.0).round() / 100.0));
    canvas.text(&number, (b.0 + side, 0.5 * (b.1 + c.1)), how(align));
    let below = if c.1 < b.1 { 8.5 } else { -8.5 };
    canvas.text("1", (0.5 * (a.0 + b.0), b.1 + below), how(Align::Middle));
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

/// Places for the label of a rule: both ends, both sides.
fn rule_spots(orientation: Orientation, (a, b): (Point, Point), width: f64) -> Vec<(Rect, Align)> {
    let (gap, height) = (3.5, RULE_EM);
    let corner = |left, top, width, height| Rect { left, top, width, height };
    match orientation {
        Orientation::Horizontal => {
            let (left, right) = (a.0 + 8.0, b.0 - 8.0 - width);
            let (above, below) = (a.1 - gap - height, a.1 + gap);
            vec![
                (corner(right, above, width, height), Align::End),
                (corner(left, above, width, height), Align::Start),
                (corner(right, below, width, height), Align::End),
                (corner(left, below, width, height), Align::Start),
            ]
        }
        Orientation::Vertical => {
            let (top, bottom) = (a.1 + 8.0, b.1 - 8.0 - width);
            let (before, after) = (a.0 - gap - height, a.0 + gap);
            vec![
                (corner(after, top, height, width), Align::End),
                (corner(before, top, height, width), Align::End),
                (corner(after, bottom, height, width), Align::Start),
                (corner(before, bottom, height, width), Align::Start),
            ]
        }
    }
}
