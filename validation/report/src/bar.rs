//! Colour bars: which value has which colour.

use super::axis::{Axis, Ruler};
use super::canvas::{Align, Canvas, Rect, Type};
use super::colour::{Colour, ColourMap};
use super::font::TICK_EM;
use super::frame::fit;

const GAP: f64 = 12.0;
const WIDTH: f64 = 13.0;
/// Colours of a bar and of the dots: each is one more element.
pub(super) const STEPS: usize = 32;

/// A colour bar with its scale decided.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bar {
    map: ColourMap,
    values: Ruler,
    /// Whether the figure draws it for all panels.
    pub is_shared: bool,
}

impl Bar {
    /// The colour bar of a map with this height, for given ends or for the range of the data, symmetric if
    /// the map is.
    pub fn new(
        map: ColourMap,
        label: &str,
        given: Option<(f64, f64)>,
        data: impl Iterator<Item = f64>,
        height: f64,
    ) -> Self {
        let (lo, hi) = given.unwrap_or_else(|| {
            let finite = data.filter(|v| v.abs() < 1e150);
            let ends = finite
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
            let most = ends.0.abs().max(ends.1.abs());
            if map == ColourMap::Diverging { (-most, most) } else { ends }
        });
        let axis = Axis::linear(label);
        let axis = if lo < hi { axis.range(lo, hi) } else { axis };
        let mapping = axis.mapping([lo, hi].into_iter());
        let values = axis.ruler(mapping, (height / 36.0) as usize);
        Self { map, values, is_shared: false }
    }

    /// The index of the colour of a value.
    pub fn step(&self, value: f64) -> Option<usize> {
        Some(((self.values.mapping.unit(value)? * STEPS as f64) as usize).min(STEPS - 1))
    }

    pub fn colour(&self, step: usize) -> Colour {
        self.map.at((step as f64 + 0.5) / STEPS as f64)
    }

    /// Room for the bar.
    pub fn width(&self) -> f64 {
        let bar = GAP + WIDTH + 8.0 + self.values.width();
        bar + if self.values.label.is_empty() { 6.0 } else { 26.0 }
    }

    /// Draws the bar right of an area.
    pub fn draw(&self, canvas: &mut Canvas, area: Rect) {
        let bar = Rect { left: area.right() + GAP, width: WIDTH, ..area };
        for step in 0..STEPS {
            // Each step reaches to the top, so that no seam shows between two.
            let from = bar.at((0.5, step as f64 / STEPS as f64));
            canvas.line(from, bar.at((0.5, 1.0)), self.colour(step), WIDTH);
        }
        canvas.frame(bar);
        let Ruler { major, label, .. } = &self.values;
        for (x, y) in major.iter().map(|(unit, _)| bar.at((1.0, *unit))) {
            canvas.line((x, y), (x + 4.0, y), Colour::BLACK, 1.0);
        }
        for (unit, label) in major {
            let (x, y) = bar.at((1.0, *unit));
            canvas.text(label, (x + 7.0, y), Type::new(TICK_EM, Align::Start));
        }
        let em = fit(label, 12.0, area.height + 20.0);
        let x = bar.right() + 20.0 + self.values.width();
        canvas.text(label, (x, bar.at((0.0, 0.5)).1), Type::new(em, Align::Middle).upright());
    }
}
