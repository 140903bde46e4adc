//! Common parts of all plots: their room, axes with ticks, titles and labels.

use super::axis::Ruler;
use super::canvas::{Align, Canvas, Point, Rect, Type};
use super::colour::Colour;
use super::font::{self, TICK_EM};

const LABEL_EM: f64 = 12.0;
const TITLE_EM: f64 = 12.5;
const NOTE_EM: f64 = 9.5;
const GRID: Colour = Colour(232, 232, 232);

/// Room of a panel: inside its axes, and around them.
pub(super) struct Room {
    pub left: f64,
    pub width: f64,
    pub right: f64,
    pub top: f64,
    pub height: f64,
    pub bottom: f64,
}

/// Two axes, the area between them, and the texts around it.
pub(super) struct Frame<'a> {
    pub area: Rect,
    pub x: Ruler,
    pub y: Ruler,
    pub title: &'a str,
    /// Note on points that could not be drawn.
    pub note: String,
}

impl Frame<'_> {
    /// The position of a point.
    pub fn place(&self, (x, y): (f64, f64)) -> Option<Point> {
        Some(self.area.at((self.x.mapping.unit(x)?, self.y.mapping.unit(y)?)))
    }

    /// The room of the frame, with this width on the right.
    pub fn room(&self, right: f64) -> Room {
        let with = |text: &str, without: f64, extra: f64| {
            without + if text.is_empty() { 0.0 } else { extra }
        };
        Room {
            left: self.y.width() + with(&self.y.label, 10.0, 24.0),
            width: self.area.width,
            right,
            top: with(self.title, 8.0, 17.0) + with(&self.note, 0.0, 13.0),
            height: self.area.height,
            bottom: with(&self.x.label, 22.0, 20.0),
        }
    }

    /// Grid, ticks, tick labels and texts.
    pub fn draw(&self, canvas: &mut Canvas) {
        let area = self.area;
        let major = |of: &Ruler| of.major.iter().map(|tick| tick.0).collect::<Vec<f64>>();
        let (x_major, y_major) = (major(&self.x), major(&self.y));
        let mut lines = |xs: &[f64], ys: &[f64], length: (f64, f64), colour, width| {
            for at in xs.iter().map(|x| area.at((*x, 0.0))) {
                canvas.line(at, (at.0, at.1 - length.1), colour, width);
            }
            for at in ys.iter().map(|y| area.at((0.0, *y))) {
                canvas.line(at, (at.0 + length.0, at.1), colour, width);
            }
        };
        lines(&x_major, &y_major, (area.width, area.height), GRID, 0.7);
        lines(&x_major, &y_major, (5.0, 5.0), Colour::BLACK, 1.0);
        lines(&self.x.minor, &self.y.minor, (3.0, 3.0), Colour::BLACK, 0.7);
        for (unit, label) in &self.x.major {
            let at = (area.at((*unit, 0.0)).0, area.bottom() + 12.0);
            canvas.text(label, at, Type::new(TICK_EM, Align::Middle));
        }
        for (unit, label) in &self.y.major {
            let at = (area.left - 6.0, area.at((0.0, *unit)).1);
            canvas.text(label, at, Type::new(TICK_EM, Align::End));
        }
        self.draw_texts(canvas);
    }

    /// Title, note and labels of the axes.
    fn draw_texts(&self, canvas: &mut Canvas) {
        let Self { area, x, y, title, note } = self;
        let (middle, centre) = area.at((0.5, 0.5));
        let set = |text: &str, em, room| Type::new(fit(text, em, room), Align::Middle);
        let wide = area.width + 40.0;
        canvas.text(title, (middle, area.top - 13.0), set(title, TITLE_EM, wide));
        canvas.text(&x.label, (middle, area.bottom() + 31.0), set(&x.label, LABEL_EM, wide));
        let upright = set(&y.label, LABEL_EM, area.height + 20.0).upright();
        canvas.text(&y.label, (area.left - y.width() - 21.0, centre), upright);
        let warning = Type::new(NOTE_EM, Align::End).colour(Colour(150, 60, 0));
        let above = area.top - if title.is_empty() { 8.5 } else { 28.0 };
        canvas.text(note, (area.right(), above), warning);
    }
}

/// The em at which a text is no wider than `room`, at most `em`.
pub(super) fn fit(text: &str, em: f64, room: f64) -> f64 {
    let width = font::width(text, em);
    if width > room { em * room / width } else { em }
}
