//! Particle maps and category maps.

use super::axis::{Axis, Mapping};
use super::bar::{Bar, STEPS};
use super::canvas::{Align, Canvas, Point, Rect, Type};
use super::colour::Colour;
use super::drawn::Drawn;
use super::figure::{CategoryMap, Dash, ParticleMap, Shape};
use super::font;
use super::frame::{Margins, TICK_EM, Texts, axes, fit, labels, margins, widest_label};
use super::geometry::{clip_line, thin};
use super::legend::{self, Entry, Sample};
use super::ticks::{Scale, Ticks, with_exponent};

/// A particle map with its scales decided.
pub(super) struct Particles<'a> {
    map: &'a ParticleMap,
    area: Rect,
    x: Mapping,
    y: Mapping,
    x_ticks: Ticks,
    y_ticks: Ticks,
    bar: Bar,
    /// Radius of a dot in CSS pixels.
    radius: f64,
    note: String,
}

impl<'a> Particles<'a> {
    pub fn new(map: &'a ParticleMap, room: (f64, f64)) -> Self {
        let linear = |axis: &Axis| Axis { scale: Scale::Linear, ..axis.clone() };
        let (x_axis, y_axis) = (linear(&map.x), linear(&map.y));
        let mut x = x_axis.mapping(map.points.iter().map(|p| p.0));
        let mut y = y_axis.mapping(map.points.iter().map(|p| p.1));
        // A dot on the border is seen whole.
        for axis in [&mut x, &mut y] {
            axis.lo -= 0.5 * map.diameter;
            axis.hi += 0.5 * map.diameter;
        }
        let (width, height) = (x.hi - x.lo, y.hi - y.lo);
        let pixels = (room.0 / width).min(room.1 / height);
        let area = Rect::of((pixels * width, pixels * height));
        let lost = map.points.iter().filter(|p| !(p.0 + p.1 + p.2).is_finite()).count();
        let data = map.points.iter().map(|p| p.2);
        Self {
            map,
            area,
            x_ticks: x.ticks((area.width / 60.0) as usize),
            y_ticks: y.ticks((area.height / 42.0) as usize),
            x,
            y,
            bar: Bar::new(map.map, &map.label, map.values, data, area.height),
            radius: (0.5 * map.diameter * pixels).clamp(0.8, 9.0),
            note: if lost > 0 { format!("{lost} not finite") } else { String::new() },
        }
    }

    fn with_texts<R>(&self, then: impl FnOnce(&Texts) -> R) -> R {
        then(&Texts {
            title: &self.map.title,
            note: &self.note,
            x: &with_exponent(&self.map.x.label, self.x_ticks.exponent),
            y: &with_exponent(&self.map.y.label, self.y_ticks.exponent),
        })
    }

    fn place(&self, (x, y): (f64, f64)) -> Option<Point> {
        Some(self.area.at((self.x.unit(x)?, self.y.unit(y)?)))
    }
}

impl Drawn for Particles<'_> {
    fn size(&self) -> (f64, f64) {
        (self.area.width, self.area.height)
    }

    fn bar(&mut self) -> Option<&mut Bar> {
        Some(&mut self.bar)
    }

    fn margins(&self) -> Margins {
        let around = self.with_texts(|texts| margins(texts, widest_label(&self.y_ticks)));
        Margins { right: if self.bar.is_shared { 14.0 } else { self.bar.width() }, ..around }
    }

    fn draw(&self, canvas: &mut Canvas) {
        axes(canvas, self.area, (&self.x, &self.x_ticks), (&self.y, &self.y_ticks));
        self.with_texts(|texts| labels(canvas, self.area, texts, widest_label(&self.y_ticks)));
        // Dots of one colour after each other, for they are one element of an SVG.
        let mut dots = vec![Vec::new(); STEPS];
        for &(x, y, value) in &self.map.points {
            let Some(at) = self.place((x, y)).filter(|at| self.area.contains(*at)) else {
                continue;
            };
            match self.bar.step(value) {
                Some(step) => dots[step].push(at),
                None => canvas.markers(&[at], Shape::Cross, 8.0, Colour::BLACK, false),
            }
        }
        for (step, mut dots) in dots.into_iter().enumerate() {
            // Row by row, for near dots have short coordinates.
            let row = |at: &Point| (at.1 / (4.0 * self.radius)).round() as i64;
            dots.sort_by(|a, b| row(a).cmp(&row(b)).then(a.0.total_cmp(&b.0)));
            dots.into_iter().for_each(|at| canvas.disc(at, self.radius, self.bar.colour(step)));
        }
        for line in &self.map.lines {
            let points: Vec<_> = line.points.iter().filter_map(|p| self.place(*p)).collect();
            let (colour, dash) = (line.colour.unwrap_or(Colour::BLACK), line.line);
            for piece in clip_line(&thin(&points), self.area) {
                canvas.dashed(&piece, colour, line.width, dash.unwrap_or(Dash::Solid));
            }
        }
        canvas.frame(self.area, Colour::BLACK, 1.0);
        if !self.bar.is_shared {
            self.bar.draw(canvas, self.area);
        }
    }
}

/// Height that the names of columns take.
const NAMES: f64 = 18.0;

/// A category map with its legend.
pub(super) struct Categories<'a> {
    map: &'a CategoryMap,
    size: (f64, f64),
    entries: Vec<Entry>,
}

impl<'a> Categories<'a> {
    pub fn new(map: &'a CategoryMap, size: (f64, f64)) -> Self {
        let entry = |(name, colour): &(String, Colour)| Entry {
            name: name.clone(),
            sample: Sample::Patch(*colour),
        };
        Self { map, size, entries: map.categories.iter().map(entry).collect() }
    }

    fn texts(&self) -> Texts<'_> {
        Texts { title: &self.map.title, note: "", x: "", y: &self.map.y_label }
    }

    fn cell(&self, canvas: &mut Canvas, rect: Rect, cell: Option<&(usize, String)>) {
        let known = cell.and_then(|(i, text)| Some((self.map.categories.get(*i)?.1, text)));
        let Some((colour, text)) = known else {
            canvas.frame(rect.grown(-0.5), Colour::LIGHT_GREY, 1.0);
            return;
        };
        canvas.fill(rect, colour);
        let em = fit(text, 11.0, rect.width - 4.0).min(0.8 * rect.height);
        let ink = if colour.is_dark() { Colour::WHITE } else { Colour::BLACK };
        let at = (rect.left + 0.5 * rect.width, rect.top + 0.5 * rect.height);
        canvas.text(text, at, Type::new(em, Align::Middle).colour(ink));
    }
}

impl Drawn for Categories<'_> {
    fn size(&self) -> (f64, f64) {
        self.size
    }

    fn legend(&self) -> &[Entry] {
        &self.entries
    }

    fn hide_legend(&mut self) {
        self.entries.clear();
    }

    fn margins(&self) -> Margins {
        let label = if self.map.x_label.is_empty() { 4.0 } else { 22.0 };
        Margins {
            right: if self.entries.is_empty() {
                14.0
            } else {
                legend::size(&self.entries).0 + 14.0
            },
            bottom: NAMES + label,
            ..margins(&self.texts(), widest(&self.map.y))
        }
    }

    fn draw(&self, canvas: &mut Canvas) {
        let (map, area) = (self.map, Rect::of(self.size));
        labels(canvas, area, &self.texts(), widest(&map.y));
        let width = area.width / map.x.len().max(1) as f64;
        let height = area.height / map.y.len().max(1) as f64;
        for (column, name) in map.x.iter().enumerate() {
            let x = area.left + (column as f64 + 0.5) * width;
            let how = Type::new(fit(name, TICK_EM, width - 4.0), Align::Middle);
            canvas.text(name, (x, area.bottom() + 11.0), how);
        }
        for (row, name) in map.y.iter().enumerate() {
            let top = area.bottom() - (row as f64 + 1.0) * height;
            let at = (area.left - 6.0, top + 0.5 * height);
            canvas.text(name, at, Type::new(TICK_EM, Align::End));
            for column in 0..map.x.len() {
                let cell = map.cells.get(row).and_then(|r| r.get(column)).and_then(Option::as_ref);
                let left = area.left + column as f64 * width;
                self.cell(canvas, Rect { left, top, width, height }.grown(-1.0), cell);
            }
        }
        let below = (area.left + 0.5 * area.width, area.bottom() + NAMES + 9.0);
        let em = fit(&map.x_label, 12.0, area.width + 40.0);
        canvas.text(&map.x_label, below, Type::new(em, Align::Middle));
        legend::draw(canvas, &self.entries, (area.right() + 8.0, area.top - 4.0), false);
    }
}

fn widest(names: &[String]) -> f64 {
    names.iter().map(|name| font::width(name, TICK_EM)).fold(0.0, f64::max)
}
