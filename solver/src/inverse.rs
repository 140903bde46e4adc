//! Inverses of small matrices. The inverses of nalgebra are compiled with code for any size.

use nalgebra::{Matrix2, Matrix3};

use crate::numbers::Symmetric;

/// Least determinant of regular moments, scaled so that it is 1 inside a body of particles; 0 if the
/// neighbours are on one line.
pub const LEAST_DETERMINANT: f64 = 1e-3;

/// The inverse of a matrix, not finite where the determinant is 0.
#[derive(Clone, Copy, Debug)]
pub struct Inverse<M> {
    /// Determinant of the matrix.
    pub determinant: f64,
    /// The inverse.
    pub matrix: M,
}

impl<M> Inverse<M> {
    /// The inverse, if the determinant is above `least`.
    #[inline(always)]
    pub fn above(self, least: f64) -> Option<M> {
        (self.determinant > least).then_some(self.matrix)
    }
}

/// Inverse of a symmetric 2 × 2 matrix.
#[inline(always)]
pub fn of_symmetric(m: Symmetric) -> Inverse<Symmetric> {
    let Symmetric { xx, yy, xy } = m;
    let determinant = xx * yy - xy * xy;
    let matrix = Symmetric::new(yy / determinant, xx / determinant, -xy / determinant);
    Inverse { determinant, matrix }
}

/// Inverse of a 2 × 2 matrix.
pub fn of_two(m: &Matrix2<f64>) -> Inverse<Matrix2<f64>> {
    let determinant = m.m11 * m.m22 - m.m21 * m.m12;
    let matrix = Matrix2::new(m.m22, -m.m12, -m.m21, m.m11).map(|x| x / determinant);
    Inverse { determinant, matrix }
}

/// Inverse of a 3 × 3 matrix.
#[inline]
pub fn of_three(m: &Matrix3<f64>) -> Inverse<Matrix3<f64>> {
    let [[a, d, g], [b, e, h], [c, f, i]] = m.data.0;
    let adjugate = [
        [e * i - h * f, g * f - d * i, d * h - g * e],
        [c * h - i * b, a * i - g * c, b * g - h * a],
        [b * f - e * c, c * d - f * a, a * e - d * b],
    ];
    let determinant = a * adjugate[0][0] + b * adjugate[0][1] + c * adjugate[0][2];
    Inverse { determinant, matrix: Matrix3::from(adjugate).map(|x| x / determinant) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_inverse_is_the_unit_matrix() {
        let three = Matrix3::new(3.0, -1.0, 2.0, 0.5, 4.0, 1.0, -2.0, 0.25, 5.0);
        let Inverse { determinant, matrix } = of_three(&three);
        assert!((three * matrix - Matrix3::identity()).norm() < 1e-15);
        assert!((determinant - three.determinant()).abs() < 1e-13);
        let two = Matrix2::new(3.0, -1.0, 0.5, 4.0);
        let Inverse { determinant, matrix } = of_two(&two);
        assert!((two * matrix - Matrix2::identity()).norm() < 1e-15);
        assert_eq!(determinant, 12.5);
        let symmetric = of_symmetric(Symmetric::new(3.0, 4.0, -1.0));
        let expected = of_two(&Matrix2::new(3.0, -1.0, -1.0, 4.0));
        let Symmetric { xx, yy, xy } = symmetric.matrix;
        assert_eq!(Matrix2::new(xx, xy, xy, yy), expected.matrix);
        assert_eq!(symmetric.determinant, expected.determinant);
    }

    #[test]
    fn an_inverse_exists_only_above_the_bound() {
        let line = || of_symmetric(Symmetric::new(2.0, 0.5, 1.0));
        assert_eq!((line().determinant, line().above(0.0)), (0.0, None));
        let thin = || of_symmetric(Symmetric::new(1.0, LEAST_DETERMINANT, 0.0));
        assert_eq!(thin().above(LEAST_DETERMINANT), None);
        assert!(thin().above(0.5 * LEAST_DETERMINANT).is_some());
        assert!(of_symmetric(Symmetric::new(f64::NAN, 1.0, 0.0)).above(0.0).is_none());
    }
}
