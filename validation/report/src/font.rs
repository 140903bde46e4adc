//! The one font of the figures: a subset of DejaVu Sans, embedded in the program.

use super::colour::Colour;
use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};
use std::sync::OnceLock;

/// The font file (licence in its folder).
pub(super) static BYTES: &[u8] = include_bytes!("../assets/DejaVuSans-subset.ttf");

/// Family list of the SVG; a page embeds the first, Verdana has nearly the same widths.
pub(super) const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// Ascent minus descent over the em: the rasteriser sizes text by this height.
pub(super) const HEIGHT_PER_EM: f64 = (1901.0 + 483.0) / 2048.0;

/// Height of a digit over the em.
pub(super) const DIGIT_HEIGHT: f64 = 1493.0 / 2048.0;

/// Em of tick labels, in CSS pixels.
pub(super) const TICK_EM: f64 = 11.0;

/// The end of a text at its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Align {
    /// The text starts at the point.
    Start,
    /// The text is centred on the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// How a text is set.
#[derive(Debug, Clone, Copy)]
pub(super) struct Type {
    pub em: f64,
    pub colour: Colour,
    pub align: Align,
    /// Reads upwards.
    pub upright: bool,
}

impl Type {
    pub fn new(em: f64, align: Align) -> Self {
        Self { em, colour: Colour::BLACK, align, upright: false }
    }

    pub fn colour(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    pub fn upright(self) -> Self {
        Self { upright: true, ..self }
    }
}

/// A font description of the given size, in the rasteriser's sense of size.
pub(super) fn desc(size: f64) -> FontDesc<'static> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered =
        REGISTERED.get_or_init(|| register_font(FAMILY, FontStyle::Normal, BYTES).is_ok());
    assert!(registered, "the embedded font is a valid TrueType file");
    FontDesc::new(FontFamily::Name(FAMILY), size, FontStyle::Normal)
}

/// Width of the widest of these texts, 0 if there is none.
pub(super) fn widest<'a>(texts: impl Iterator<Item = &'a String>, em: f64) -> f64 {
    texts.map(|text| width(text, em)).fold(0.0, f64::max)
}

/// Width of a text whose em is `em`.
pub(super) fn width(text: &str, em: f64) -> f64 {
    const FINE: f64 = 1000.0;
    let ((left, _), (right, _)) =
        desc(FINE * HEIGHT_PER_EM).layout_box(text).expect("the font is registered");
    f64::from(right - left) / FINE * em
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_plausible() {
        // Digits of DejaVu Sans are 1303/2048 em wide.
        assert!((width("00", 10.0) - 12.72).abs() < 0.05);
        assert!(width("10⁻³ρ₀", 10.0) > 30.0);
    }
}
