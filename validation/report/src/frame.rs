//! What plots and maps share: margins, axes with ticks, titles and labels.

use super::axis::Mapping;
use super::canvas::{Align, Canvas, Rect, Type};
use super::colour::Colour;
use super::font;
use super::ticks::Ticks;

/// Em of tick labels, in CSS pixels.
pub(super) const TICK_EM: f64 = 11.0;
const LABEL_EM: f64 = 12.0;
const TITLE_EM: f64 = 12.5;
const NOTE_EM: f64 = 9.5;
const GRID: Colour = Colour(232, 232, 232);

/// Room around the axes of a panel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Margins {
    pub left: f64,
    pub right: f64,
    pub top: f64,
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

/// The em at which a text is no wider than `room`, at most `em`.
pub(super) fn fit(text: &str, em: f64, room: f64) -> f64 {
    let width = font::width(text, em);
    if width > room { em * room / width } else { em }
}

/// Width of the widest tick label.
pub(super) fn widest_label(ticks: &Ticks) -> f64 {
    ticks.major.iter().map(|(_, l)| font::width(l, TICK_EM)).fold(0.0, f64::max)
}

/// Margins for these texts beside y ticks of the given width.
pub(super) fn margins(texts: &Texts, y_labels: f64) -> Margins {
    let with =
        |text: &str, without: f64, extra: f64| without + if text.is_empty() { 0.0 } else { extra };
    Margins {
        left: y_labels + with(texts.y, 10.0, 24.0),
        right: 10.0,
        top: with(texts.title, 8.0, 17.0) + with(texts.note, 0.0, 13.0),
        bottom: with(texts.x, 22.0, 20.0),
    }
}

/// Grid, ticks and tick labels.
pub(super) fn axes(
    canvas: &mut Canvas,
    area: Rect,
    (x, x_ticks): (&Mapping, &Ticks),
    (y, y_ticks): (&Mapping, &Ticks),
) {
    let places = |axis: &Mapping, ticks: &Ticks| {
        let major: Vec<f64> = ticks.major.iter().filter_map(|tick| axis.unit(tick.0)).collect();
        (major, ticks.minor.iter().filter_map(|v| axis.unit(*v)).collect::<Vec<f64>>())
    };
    let ((x_major, x_minor), (y_major, y_minor)) = (places(x, x_ticks), places(y, y_ticks));
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
    lines(&x_minor, &y_minor, (3.0, 3.0), Colour::BLACK, 0.7);
    for (v, label) in &x_ticks.major {
        let Some(unit) = x.unit(*v) else { continue };
        let at = (area.at((unit, 0.0)).0, area.bottom() + 12.0);
        canvas.text(label, at, Type::new(TICK_EM, Align::Middle));
    }
    for (v, label) in &y_ticks.major {
        let Some(unit) = y.unit(*v) else { continue };
        let at = (area.left - 6.0, area.at((0.0, unit)).1);
        canvas.text(label, at, Type::new(TICK_EM, Align::End));
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
