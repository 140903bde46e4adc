//! The periodic hill: a curved lower wall, convex at the crest and concave at the foot, and a flat lid.

use touchstone_base::reference::{Reference, ReferenceError};

/// The height for which the pieces are tabulated \[mm\].
const TABULATED: f64 = 28.0;
/// Period \[H\].
const PERIOD: f64 = 9.0;
/// Height of the channel \[H\].
const CHANNEL: f64 = 3.035;

/// The channel over periodic hills (`references/periodic_hill_geometry`): y of the lower wall from six
/// cubic pieces, mirrored about x = 4.5 H.
pub struct Hill {
    /// H \[m\].
    height: f64,
    pieces: Vec<Piece>,
}

/// y = Σ aₙ xⁿ \[mm\] up to x = end \[mm\].
struct Piece {
    end: f64,
    a: [f64; 4],
}

impl Hill {
    /// A hill of this height \[m\].
    pub fn new(height: f64) -> Result<Self, ReferenceError> {
        let reference = Reference::load("periodic_hill_geometry")?;
        let rows = reference.table("segments")?.select(&[], ["x_end", "a0", "a1", "a2", "a3"])?;
        let pieces = rows.into_iter().map(|[end, a @ ..]| Piece { end, a }).collect();
        Ok(Self { height, pieces })
    }

    /// Period along x \[m\].
    pub fn period(&self) -> f64 {
        PERIOD * self.height
    }

    /// Height of the lid \[m\].
    pub fn lid(&self) -> f64 {
        CHANNEL * self.height
    }

    /// Height of the lower wall at x \[m\], any period.
    pub fn wall(&self, x: f64) -> f64 {
        let within = x.rem_euclid(self.period());
        let from_crest = within.min(self.period() - within) / self.height * TABULATED;
        let piece = self.pieces.iter().find(|piece| from_crest <= piece.end);
        // The pieces end at the foot; the table limits every piece to the height of the hill.
        let y = piece.map_or(0.0, |piece| piece.at(from_crest));
        y.clamp(0.0, TABULATED) / TABULATED * self.height
    }
}

impl Piece {
    /// y at x \[mm\].
    fn at(&self, x: f64) -> f64 {
        self.a.iter().rev().fold(0.0, |sum, a| sum * x + a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The conditions that the package states of the pieces: height, slope and curvature agree at the breaks,
    /// and the wall ends at 0. A wrong digit violates them.
    #[test]
    fn the_pieces_join_with_their_slope_and_curvature() {
        let hill = Hill::new(1.0).expect("a sound reference");
        let derivatives = |piece: &Piece, x: f64| {
            let [_, a1, a2, a3] = piece.a;
            [piece.at(x), a1 + x * (2.0 * a2 + 3.0 * a3 * x), 2.0 * a2 + 6.0 * a3 * x]
        };
        assert_eq!(hill.pieces.len(), 6);
        for pair in hill.pieces.windows(2) {
            let x = pair[0].end;
            for (a, b) in derivatives(&pair[0], x).into_iter().zip(derivatives(&pair[1], x)) {
                assert!((a - b).abs() < 2e-11 * (1.0 + a.abs()), "at {x} mm: {a} {b}");
            }
        }
        let last = &hill.pieces[5];
        let [height, slope, _] = derivatives(last, last.end);
        assert!(height.abs() < 1e-9 && slope.abs() < 1e-9, "{height} {slope}");
    }

    #[test]
    fn the_wall_is_one_high_symmetric_and_periodic() {
        let hill = Hill::new(0.5).expect("a sound reference");
        assert_eq!((hill.wall(0.0), hill.wall(2.25), hill.period()), (0.5, 0.0, 4.5));
        for k in 0..90 {
            let x = 0.05 * f64::from(k) + 0.01;
            let [y, mirrored, next] = [x, 4.5 - x, x + 4.5].map(|x| hill.wall(x));
            assert!((y - mirrored).abs() < 1e-12 && (y - next).abs() < 1e-12, "at {x}");
            assert!((0.0..=0.5).contains(&y));
        }
        // Half-way down: a point of the table, 14 mm of 28.
        assert!((hill.wall(14.0 / 56.0) - 0.5 * hill.pieces[1].at(14.0) / 28.0).abs() < 1e-12);
    }
}
