//! The domain: periodic or open along each axis.

use nalgebra::Vector2;

/// The domain: its extent and its periodic axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Domain {
    /// Lower corner of the period \[m\]; of no meaning on open axes.
    pub low: Vector2<f64>,
    /// Period along x and y \[m\], `None` on an open axis.
    pub period: [Option<f64>; 2],
}

impl Domain {
    /// Open along both axes.
    pub fn open() -> Self {
        Self { low: Vector2::zeros(), period: [None, None] }
    }

    /// Periodic along x from 0, open along y: a channel section.
    pub fn channel(length: f64) -> Self {
        Self { low: Vector2::zeros(), period: [Some(length), None] }
    }

    /// Periodic along both axes from the origin.
    pub fn torus(length: f64, height: f64) -> Self {
        Self { low: Vector2::zeros(), period: [Some(length), Some(height)] }
    }

    /// A difference of two places \[m\] between the nearest images of both.
    pub fn nearest(&self, mut apart: Vector2<f64>) -> Vector2<f64> {
        for (of, period) in apart.iter_mut().zip(self.period) {
            *of -= period.map_or(0.0, |period| (*of / period).round() * period);
        }
        apart
    }

    /// The copy of a point inside the period. A point already inside keeps its bits.
    pub fn wrap(&self, mut point: Vector2<f64>) -> Vector2<f64> {
        for axis in 0..2 {
            if let Some(period) = self.period[axis] {
                let turns = ((point[axis] - self.low[axis]) / period).floor();
                if turns != 0.0 {
                    point[axis] -= turns * period;
                }
            }
        }
        point
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_is_by_whole_periods_along_periodic_axes_only() {
        let domain = Domain::channel(2.0);
        assert_eq!(domain.wrap(Vector2::new(-0.5, -9.0)), Vector2::new(1.5, -9.0));
        assert_eq!(domain.wrap(Vector2::new(5.25, 9.0)), Vector2::new(1.25, 9.0));
        assert_eq!(domain.wrap(Vector2::new(2.0, 0.0)), Vector2::new(0.0, 0.0));
        assert_eq!(Domain::open().wrap(Vector2::new(7.0, 7.0)), Vector2::new(7.0, 7.0));
    }
}
