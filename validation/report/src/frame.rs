//! What plots and maps share: the room that they take, axes with ticks, titles and labels.

use super::axis::Ruler;
use super::canvas::{Align, Canvas, Point, Rect, Type};
use super::colour::Colour;
use super::font::{self, TICK_EM};

const LABEL_EM: f64 = 12.0;
const TITLE_EM: f64 = 12.5;
const NOTE_EM: f64 = 9.5;
const GRID: Colour = Colour(232, 232, 232);

/// Room that a panel takes: what its axes enclose, and around it.
pub(super) struct Room {
    pub left: f64,
    pub width: f64,
    pub right: f64,
    pub top: f64,
    pub height: f64,
    pub bottom: f64,
}

/// The texts around the axes of a panel.
pub(super) struct Texts<'a> {
    pub title: &'a str,
    /// What could not be drawn.
    pub note: &'a str,
    pub x: &'a str,
    pub y: &'a str,
}

/// Two axes, what they enclose, and the texts around them.
pub(super) struct Frame<'a> {
    pub area: Rect,
    pub x: Ruler,
    pub y: Ruler,
    pub title: &'a str,
    /// What could not be drawn.
    pub note: String,
}

impl Frame<'_> {
    fn texts(&self) -> Texts<'_> {
        Texts { title: self.title, note: &self.note, x: &self.x.label, y: &self.y.label }
    }

    /// Where a point lies.
    pub fn place(&self, (x, y): (f64, f64)) -> Option<Point> {
        Some(self.area.at((self.x.mapping.unit(x)?, self.y.mapping.unit(y)?)))
    }

    /// With so much room on the right.
    pub fn room(&self, right: f64) -> Room {
        Room { right, ..room(self.area, &self.texts(), self.y.width()) }
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
        labels(canvas, area, &self.texts(), self.y.width());
    }
}

/// The em at which a text is no wider than `room`, at most `em`.
pub(super) fn fit(text: &str, em: f64, room: f64) -> f64 {
    let width = font::width(text, em);
    if width > room { em * room / width } else { em }
}

/// The room for an area and these texts beside y ticks of the given width.
pub(super) fn room(area: Rect, texts: &Texts, y_labels: f64) -> Room {
    let with =
        |text: &str, without: f64, extra: f64| without + if text.is_empty() { 0.0 } else { extra };
    Room {
        left: y_labels + with(texts.y, 10.0, 24.0),
        width: area.width,
        right: 10.0,
        top: with(texts.title, 8.0, 17.0) + with(texts.note, 0.0, 13.0),
        height: area.height,
        bottom: with(texts.x, 22.0, 20.0),
    }
}

/// Title, note and axis labels; `y_labels` is the width of the tick labels on the left.
pub(super) fn labels(canvas: &mut Canvas, area: Rect, texts: &Texts, y_labels: f64) {
    let (middle, centre) = area.at((0.5, 0.5));
    let set = |text: &str, em, room| Type::new(fit(text, em, room), Align::Middle);
    let wide = area.width + 40.0;
    canvas.text(texts.title, (middle, area.top - 13.0), set(texts.title, TITLE_EM, wide));
    canvas.text(texts.x, (middle, area.bottom() + 31.0), set(texts.x, LABEL_EM, wide));
    let y = set(texts.y, LABEL_EM, area.height + 20.0).upright();
    canvas.text(texts.y, (area.left - y_labels - 21.0, centre), y);
    let warning = Type::new(NOTE_EM, Align::End).colour(Colour(150, 60, 0));
    let above = area.top - if texts.title.is_empty() { 8.5 } else { 28.0 };
    canvas.text(texts.note, (area.right(), above), warning);
}
