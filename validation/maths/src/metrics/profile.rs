//! A particle field at stations: SPH interpolation (1) with Shepard's normalisation.

use nalgebra::Vector2;
use thiserror::Error;

/// Particles as an interpolation sees them; slices of one length. Images across a periodic boundary
/// and ghosts behind a wall are passed like any other particle.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Positions \[m\].
    pub positions: &'a [Vector2<f64>],
    /// Volumes V = m/ρ \[m²\].
    pub volumes: &'a [f64],
    /// The values to interpolate \[any unit\].
    pub values: &'a [f64],
}

/// Why a field cannot be interpolated.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum ProfileError {
    /// The slices of the field differ in length.
    #[error(
        "the field has {positions} positions, {volumes} volumes, {values} values: not equally many"
    )]
    Lengths {
        /// Number of positions.
        positions: usize,
        /// Number of volumes.
        volumes: usize,
        /// Number of values.
        values: usize,
    },
    /// A station has no particle in reach, or a particle in reach is not finite.
    #[error(
        "station {station} at ({x}, {y}) m cannot be interpolated: its Shepard sum of V W is {weight}"
    )]
    Station {
        /// Index of the station.
        station: usize,
        /// Its position \[m\].
        x: f64,
        /// Its position \[m\].
        y: f64,
        /// Σ V W there; 1 inside a body of particles.
        weight: f64,
    },
}

/// `kernel` is W \[1/m²\] of r² \[m²\].
/// f(x) = Σⱼ Vⱼ fⱼ W(|x - xⱼ|) / Σⱼ Vⱼ W(|x - xⱼ|) at every station, in order. Constant fields are
/// exact everywhere, linear ones only where the particles lie symmetrically about the station; in
/// general the error is of second order in h. Every station looks at every particle.
///
/// # Errors
/// [`ProfileError`] for slices of different lengths and for stations out of reach of all particles.
pub fn interpolate(
    kernel: impl Fn(f64) -> f64,
    field: Field,
    stations: &[Vector2<f64>],
) -> Result<Vec<f64>, ProfileError> {
    let Field { positions, volumes, values } = field;
    if positions.len() != volumes.len() || positions.len() != values.len() {
        let (positions, volumes, values) = (positions.len(), volumes.len(), values.len());
        return Err(ProfileError::Lengths { positions, volumes, values });
    }
    let at = |(station, x): (usize, &Vector2<f64>)| {
        let (mut sum, mut weight) = (0.0, 0.0);
        for j in 0..positions.len() {
            let vw = volumes[j] * kernel((x - positions[j]).norm_squared());
            // A NaN must be seen, a far-away particle must not turn 0 × ∞ into one.
            if vw != 0.0 {
                sum += vw * values[j];
                weight += vw;
            }
        }
        if weight > 0.0 && weight.is_finite() && sum.is_finite() {
            Ok(sum / weight)
        } else {
            Err(ProfileError::Station { station, x: x.x, y: x.y, weight })
        }
    };
    stations.iter().enumerate().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::kernel::{CubicSpline, QuinticSpline, Smoothing};

    const DX: f64 = 0.1;

    fn lattice() -> Vec<Vector2<f64>> {
        let at = |k: i32| (f64::from(k) + 0.5) * DX;
        (-10..20).flat_map(|j| (-10..20).map(move |i| Vector2::new(at(i), at(j)))).collect()
    }

    fn profile(f: impl Fn(&Vector2<f64>) -> f64, stations: &[Vector2<f64>]) -> Vec<f64> {
        let positions = lattice();
        let values: Vec<_> = positions.iter().map(f).collect();
        let volumes = vec![DX * DX; positions.len()];
        let field = Field { positions: &positions, volumes: &volumes, values: &values };
        let kernel = Smoothing::<QuinticSpline>::new(DX);
        interpolate(|r2| kernel.w(r2), field, stations).expect("in reach")
    }

    #[test]
    fn constants_are_exact_and_linear_fields_nearly() {
        let stations: Vec<_> = (0..37).map(|k| Vector2::new(0.31, 0.027 * f64::from(k))).collect();
        // At the edge of the particles, where half of the kernel is empty, and in their corner.
        let edge = [Vector2::new(-1.0, 0.5), Vector2::new(-1.0, -1.0)];
        for (value, x) in profile(|_| 3.0, &edge).iter().zip(&edge) {
            assert!(
                (value - 3.0).abs() < 1e-14,
                "a constant of 3 is {value} at ({}, {})",
                x.x,
                x.y
            );
        }
        for value in profile(|_| 3.0, &stations) {
            assert!((value - 3.0).abs() < 1e-14, "a constant of 3 is {value}");
        }
        for (value, x) in profile(|r| r.y, &stations).iter().zip(&stations) {
            assert!((value - x.y).abs() < 1e-3 * DX);
        }
    }

    /// The kernel smears a parabola by its variance, σ² = 0.483 h² for the quintic.
    #[test]
    fn parabola_is_smeared_by_the_variance() {
        let stations: Vec<_> = (0..9).map(|k| Vector2::new(0.5, 0.1 * f64::from(k))).collect();
        for (value, x) in profile(|r| r.y * r.y, &stations).iter().zip(&stations) {
            let smear = (value - x.y * x.y) / (DX * DX);
            assert!((smear - 0.483).abs() < 2e-3, "{smear}");
        }
    }

    #[test]
    fn stations_out_of_reach_and_broken_fields_are_errors() {
        let kernel = |r2: f64| Smoothing::<CubicSpline>::new(DX).w(r2);
        let (positions, station) = ([Vector2::zeros()], [Vector2::new(1.0, 0.0)]);
        let field = Field { positions: &positions, volumes: &[0.01], values: &[1.0] };
        let lonely = interpolate(kernel, field, &station);
        let expected = ProfileError::Station { station: 0, x: 1.0, y: 0.0, weight: 0.0 };
        assert_eq!(lonely, Err(expected));
        let nan = interpolate(kernel, Field { values: &[f64::NAN], ..field }, &positions);
        assert!(matches!(nan, Err(ProfileError::Station { .. })));
        let short = interpolate(kernel, Field { values: &[], ..field }, &positions);
        assert_eq!(short, Err(ProfileError::Lengths { positions: 1, volumes: 1, values: 0 }));
    }
}
