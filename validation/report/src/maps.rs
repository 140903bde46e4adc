//! Particle maps and category maps.

use super::axis::Axis;
use super::bar::{Bar, STEPS};
use super::canvas::{Align, Canvas, Point, Rect, Type};
use super::colour::Colour;
use super::drawn::Drawn;
use super::figure::{CategoryMap, Dash, ParticleMap, Shape};
use super::font::{self, TICK_EM};
use super::frame::{Frame, Room, Texts, fit, labels, room};
use super::geometry::{clip_line, thin};
use super::legend::{self, Entry, Sample};
use super::ticks::Scale;

/// A particle map with its scales decided.
pub(super) struct Particles<'a> {
    map: &'a ParticleMap,
    frame: Frame<'a>,
    bar: Bar,
    /// Radius of a dot in CSS pixels.
    radius: f64,
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
        let frame = Frame {
            area,
            x: x.ruler((area.width / 60.0) as usize, &map.x.label),
            y: y.ruler((area.height / 42.0) as usize, &map.y.label),
            title: &map.title,
            note: if lost > 0 { format!("{lost} not finite") } else { String::new() },
        };
        Self {
            map,
            frame,
            bar: Bar::new(map.map, &map.label, map.values, data, area.height),
            radius: (0.5 * map.diameter * pixels).clamp(0.8, 9.0),
        }
    }
}

impl Drawn for Particles<'_> {
    fn bar(&mut self) -> Option<&mut Bar> {
        Some(&mut self.bar)
    }

    fn room(&self) -> Room {
        self.frame.room(if self.bar.is_shared { 14.0 } else { self.bar.width() })
    }

    fn draw(&self, canvas: &mut Canvas) {
        let area = self.frame.area;
        self.frame.draw(canvas);
        // Dots of one colour after each other, for they are one element of an SVG.
        let mut dots = vec![Vec::new(); STEPS];
        for &(x, y, value) in &self.map.points {
            let Some(at) = self.frame.place((x, y)).filter(|at| area.contains(*at)) else {
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
            let points: Vec<_> = line.points.iter().filter_map(|p| self.frame.place(*p)).collect();
            let (colour, dash) = (line.colour.unwrap_or(Colour::BLACK), line.line);
            for piece in clip_line(&thin(&points), area) {
                canvas.dashed(&piece, colour, line.width, dash.unwrap_or(Dash::Solid));
            }
        }
        canvas.frame(area, Colour::BLACK, 1.0);
        if !self.bar.is_shared {
            self.bar.draw(canvas, area);
        }
    }
}

/// Height that the names of columns take.
const NAMES: f64 = 18.0;

/// A category map with its legend.
pub(super) struct Categories<'a> {
    map: &'a CategoryMap,
    area: Rect,
    entries: Vec<Entry>,
}

impl<'a> Categories<'a> {
    pub fn new(map: &'a CategoryMap, size: (f64, f64)) -> Self {
        let entry = |(name, colour): &(String, Colour)| Entry {
            name: name.clone(),
            sample: Sample::Patch(*colour),
        };
        Self { map, area: Rect::of(size), entries: map.categories.iter().map(entry).collect() }
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
    fn legend(&self) -> &[Entry] {
        &self.entries
    }

    fn hide_legend(&mut self) {
        self.entries.clear();
    }

    fn room(&self) -> Room {
        let label = if self.map.x_label.is_empty() { 4.0 } else { 22.0 };
        let legend = if self.entries.is_empty() { 0.0 } else { legend::size(&self.entries).0 };
        let around = room(self.area, &self.texts(), font::widest(self.map.y.iter(), TICK_EM));
        Room { right: legend + 14.0, bottom: NAMES + label, ..around }
    }

    fn draw(&self, canvas: &mut Canvas) {
        let Self { map, area, .. } = self;
        labels(canvas, *area, &self.texts(), font::widest(map.y.iter(), TICK_EM));
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
