//! Colours that survive colour blindness, and two colour maps.

/// An sRGB colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// Black: reference curves.
    pub const BLACK: Self = Self(0, 0, 0);
    /// Mid grey: annotations.
    pub const GREY: Self = Self(110, 110, 110);
    /// White.
    pub const WHITE: Self = Self(255, 255, 255);
    /// Okabe–Ito blue.
    pub const BLUE: Self = Self(0, 114, 178);
    /// Okabe–Ito vermillion.
    pub const VERMILLION: Self = Self(213, 94, 0);
    /// Okabe–Ito bluish green.
    pub const GREEN: Self = Self(0, 158, 115);
    /// Okabe–Ito reddish purple.
    pub const PURPLE: Self = Self(204, 121, 167);
    /// Okabe–Ito orange.
    pub const ORANGE: Self = Self(230, 159, 0);
    /// Okabe–Ito sky blue.
    pub const SKY: Self = Self(86, 180, 233);
    /// Okabe–Ito yellow; too pale for lines, good for cells.
    pub const YELLOW: Self = Self(240, 228, 66);

    /// A dark brown in addition to the Okabe–Ito colours: darker than vermillion for every colour vision.
    pub const BROWN: Self = Self(112, 66, 20);

    /// The colour of the `i`th of many series; never black, the colour of references and of our runs among
    /// others.
    pub fn cycle(i: usize) -> Self {
        const CYCLE: [Colour; 7] = [
            Colour::BLUE,
            Colour::VERMILLION,
            Colour::GREEN,
            Colour::PURPLE,
            Colour::ORANGE,
            Colour::SKY,
            Colour::BROWN,
        ];
        CYCLE[i % CYCLE.len()]
    }

    /// This colour over white with the given opacity, as an opaque colour.
    pub fn tint(self, opacity: f64) -> Self {
        Self::WHITE.mix(self, opacity)
    }

    /// Whether white text on this colour is easier to read than black (relative luminance).
    pub(super) fn is_dark(self) -> bool {
        let linear = |c: u8| (f64::from(c) / 255.0).powf(2.2);
        0.2126 * linear(self.0) + 0.7152 * linear(self.1) + 0.0722 * linear(self.2) < 0.179
    }

    /// `self` at `t = 0`, `other` at `t = 1`.
    fn mix(self, other: Self, t: f64) -> Self {
        let lerp = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * t).round() as u8;
        Self(lerp(self.0, other.0), lerp(self.1, other.1), lerp(self.2, other.2))
    }
}

/// How a value becomes a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourMap {
    /// Dark blue to yellow (viridis): magnitudes.
    Sequential,
    /// Blue, white, red-brown: signed values; automatic ranges are symmetric about zero.
    Diverging,
}

const SEQUENTIAL: [Colour; 9] = [
    Colour(68, 1, 84),
    Colour(71, 44, 122),
    Colour(59, 81, 139),
    Colour(44, 113, 142),
    Colour(33, 144, 141),
    Colour(39, 173, 129),
    Colour(92, 200, 99),
    Colour(170, 220, 50),
    Colour(253, 231, 37),
];

const DIVERGING: [Colour; 9] = [
    Colour(5, 48, 97),
    Colour(33, 102, 172),
    Colour(67, 147, 195),
    Colour(146, 197, 222),
    Colour(236, 236, 236),
    Colour(244, 165, 130),
    Colour(214, 96, 77),
    Colour(178, 24, 43),
    Colour(103, 0, 31),
];

impl ColourMap {
    /// The colour at `t` in [0, 1]; outside values take the end colours.
    pub fn at(self, t: f64) -> Colour {
        let anchors = match self {
            Self::Sequential => &SEQUENTIAL,
            Self::Diverging => &DIVERGING,
        };
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        let position = t * (anchors.len() - 1) as f64;
        let below = (position.floor() as usize).min(anchors.len() - 2);
        anchors[below].mix(anchors[below + 1], position - below as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_maps_reach_their_ends_and_stay_inside() {
        assert_eq!(ColourMap::Sequential.at(-3.0), SEQUENTIAL[0]);
        assert_eq!(ColourMap::Sequential.at(7.0), SEQUENTIAL[8]);
        assert_eq!(ColourMap::Diverging.at(0.5), DIVERGING[4]);
        assert_eq!(ColourMap::Sequential.at(f64::NAN), SEQUENTIAL[0]);
    }
}
