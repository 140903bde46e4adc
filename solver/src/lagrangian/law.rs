//! Stored-energy laws of isotropic solids in plane strain, from the displacement gradient H = F − 1, so that
//! small strains keep their digits.

use crate::Symmetric;
use nalgebra::Matrix2;

/// The moduli of small strains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moduli {
    /// K, the bulk modulus of three dimensions \[Pa\].
    pub bulk: f64,
    /// μ, the shear modulus \[Pa\].
    pub shear: f64,
}

impl Moduli {
    /// K + 4μ/3, the modulus of longitudinal waves \[Pa\].
    pub fn longitudinal(&self) -> f64 {
        self.bulk + 4.0 / 3.0 * self.shear
    }
}

/// A Kirchhoff stress τ = J σ, in parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kirchhoff {
    /// A third of its trace in three dimensions \[Pa\].
    pub mean: f64,
    /// The rest, whose trace in three dimensions is 0: τᶻᶻ = −(τˣˣ + τʸʸ) \[Pa\].
    pub deviator: Symmetric,
}

impl Kirchhoff {
    /// The first Piola-Kirchhoff stress P = τ F⁻ᵀ \[Pa\].
    #[inline(always)]
    pub fn first_piola(&self, strain: &Strain) -> Matrix2<f64> {
        let (mean, Symmetric { xx, yy, xy }) = (self.mean, self.deviator);
        let h = &strain.gradient;
        let cofactor = Matrix2::new(1.0 + h.m22, -h.m21, -h.m12, 1.0 + h.m11);
        Matrix2::new(mean + xx, xy, xy, mean + yy) * cofactor / (1.0 + strain.dilation)
    }
}

/// A displacement gradient, with quantities that all laws use.
#[derive(Clone, Copy, Debug)]
pub struct Strain {
    /// H = F − 1.
    pub gradient: Matrix2<f64>,
    /// J − 1, with J = det F.
    pub dilation: f64,
    /// b − 1 = H + Hᵀ + H Hᵀ, with b = F Fᵀ.
    pub left: Symmetric,
}

impl Strain {
    /// The strain of this displacement gradient.
    #[inline(always)]
    pub fn new(gradient: Matrix2<f64>) -> Self {
        let h = &gradient;
        let left = Symmetric {
            xx: 2.0 * h.m11 + h.m11 * h.m11 + h.m12 * h.m12,
            yy: 2.0 * h.m22 + h.m21 * h.m21 + h.m22 * h.m22,
            xy: h.m12 + h.m21 + h.m11 * h.m21 + h.m12 * h.m22,
        };
        let dilation = h.m11 + h.m22 + (h.m11 * h.m22 - h.m12 * h.m21);
        Self { gradient, dilation, left }
    }
}

/// Stored energies per reference volume, w in parts \[J/m³\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energies {
    /// Stored by the change of volume.
    pub compression: f64,
    /// Stored by the change of shape.
    pub shear: f64,
}

/// A stored energy per reference volume, w(F).
pub trait Law: Copy + Send + Sync + 'static {
    /// Name in settings and reports.
    const NAME: &'static str;
    /// Stored energy as an equation.
    const ENERGY: &'static str;
    /// The energies of compression and of shear, with the sum w.
    fn energy(moduli: &Moduli, strain: &Strain) -> Energies;
    /// τ = (∂w/∂F) Fᵀ \[Pa\]; NaN if the law has none, because the material is turned inside out.
    fn stress(moduli: &Moduli, strain: &Strain) -> Kirchhoff;
}

/// artanh(z)/z for z of at least 0, in the strains of most particles by the series Σ z²ᵏ/(2k + 1), which
/// takes a fifth of the time of the function of `libm`.
#[inline(always)]
fn artanh_over(z: f64) -> f64 {
    if z > 0.08 {
        return libm::atanh(z) / z;
    }
    // The omitted rest is below z¹⁴/15, 3e-17.
    let z2 = z * z;
    let (z4, third) = (z2 * z2, 1.0 + z2 / 3.0);
    let far = 1.0 / 9.0 + z2 / 11.0 + z4 / 13.0;
    third + z4 * (0.2 + z2 / 7.0) + z4 * z4 * far
}

/// ln(1 + x) = 2 artanh(x/(2 + x)).
#[inline(always)]
fn ln_1p(x: f64) -> f64 {
    let z = x / (2.0 + x);
    if z.abs() > 0.08 { libm::log1p(x) } else { 2.0 * z * artanh_over(z.abs()) }
}

/// w = K (J − 1 − ln J) + μ |dev ln V|² with V = b^½ (Hencky 1928): the pressure K(1/J − 1) of equation (12)
/// and a logarithmic strain.
#[derive(Clone, Copy, Debug)]
pub struct Hencky;

impl Hencky {
    /// ln J, and the deviator in the plane of ln V.
    #[inline(always)]
    fn logarithm(strain: &Strain) -> (f64, [f64; 2]) {
        let Symmetric { xx, yy, xy } = strain.left;
        // b = m + D with D = [[d, xy], [xy, −d]]: ln b = (ln det b)/2 + D atanh(r/m)/r, r² = d² + xy².
        let (m, d) = (1.0 + 0.5 * (xx + yy), 0.5 * (xx - yy));
        let z = (d * d + xy * xy).sqrt() / m;
        (ln_1p(strain.dilation), [d, xy].map(|part| 0.5 * artanh_over(z) * part / m))
    }
}

impl Law for Hencky {
    const NAME: &'static str = "hencky";
    const ENERGY: &'static str = "w = K (J - 1 - ln J) + μ |dev ln V|², V = (F Fᵀ)^½ (Hencky)";

    #[inline(always)]
    fn energy(moduli: &Moduli, strain: &Strain) -> Energies {
        let (log_j, [d, xy]) = Self::logarithm(strain);
        let shear = moduli.shear * (2.0 * (d * d + xy * xy) + log_j * log_j / 6.0);
        Energies { compression: moduli.bulk * (strain.dilation - log_j), shear }
    }

    #[inline(always)]
    fn stress(moduli: &Moduli, strain: &Strain) -> Kirchhoff {
        let (log_j, [d, xy]) = Self::logarithm(strain);
        let (two_mu, sixth) = (2.0 * moduli.shear, log_j / 6.0);
        let deviator =
            Symmetric { xx: two_mu * (sixth + d), yy: two_mu * (sixth - d), xy: two_mu * xy };
        Kirchhoff { mean: moduli.bulk * strain.dilation, deviator }
    }
}

/// w = λ (tr E)²/2 + μ E:E with E = (FᵀF − 1)/2 and λ = K − 2μ/3. It softens in compression; for tests, and
/// as the extreme among the laws.
#[derive(Clone, Copy, Debug)]
pub struct SaintVenantKirchhoff;

impl SaintVenantKirchhoff {
    /// E.
    #[inline(always)]
    fn green(strain: &Strain) -> Symmetric {
        let h = &strain.gradient;
        Symmetric {
            xx: h.m11 + 0.5 * (h.m11 * h.m11 + h.m21 * h.m21),
            yy: h.m22 + 0.5 * (h.m12 * h.m12 + h.m22 * h.m22),
            xy: 0.5 * (h.m12 + h.m21 + h.m11 * h.m12 + h.m21 * h.m22),
        }
    }
}

impl Law for SaintVenantKirchhoff {
    const NAME: &'static str = "saint_venant";
    const ENERGY: &'static str =
        "w = λ (tr E)²/2 + μ E:E, E = (FᵀF - 1)/2, λ = K - 2μ/3 (St. Venant and Kirchhoff)";

    fn energy(moduli: &Moduli, strain: &Strain) -> Energies {
        let Symmetric { xx, yy, xy } = Self::green(strain);
        let trace = xx + yy;
        let shear = moduli.shear * (xx * xx + yy * yy + 2.0 * xy * xy - trace * trace / 3.0);
        Energies { compression: 0.5 * moduli.bulk * trace * trace, shear }
    }

    #[inline(always)]
    fn stress(moduli: &Moduli, strain: &Strain) -> Kirchhoff {
        let Symmetric { xx, yy, xy } = Self::green(strain);
        let spread = (moduli.bulk - 2.0 / 3.0 * moduli.shear) * (xx + yy);
        let two_mu = 2.0 * moduli.shear;
        // τ = F S Fᵀ, and τᶻᶻ = λ tr E.
        let second =
            Matrix2::new(spread + two_mu * xx, two_mu * xy, two_mu * xy, spread + two_mu * yy);
        let f = strain.gradient + Matrix2::identity();
        let t = f * second * f.transpose();
        let mean = (t.m11 + t.m22 + spread) / 3.0;
        Kirchhoff { mean, deviator: Symmetric { xx: t.m11 - mean, yy: t.m22 - mean, xy: t.m12 } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const MODULI: Moduli = Moduli { bulk: 3.0, shear: 0.7 };

    /// Displacement gradients, small and large, with rotations.
    fn gradients() -> impl Iterator<Item = Matrix2<f64>> {
        let number = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let matrix = move |k: usize| Matrix2::from_fn(|i, j| number(7 * k + 2 * i + j + 1));
        (1..30).map(move |k| matrix(k) * [1e-6, 1e-2, 0.5, 0.8][k % 4])
    }

    fn energy<L: Law>(h: Matrix2<f64>) -> f64 {
        let Energies { compression, shear } = L::energy(&MODULI, &Strain::new(h));
        compression + shear
    }

    /// P against central differences of w, and no stress and no energy of a rotation.
    fn check<L: Law>() {
        for h in gradients() {
            let strain = Strain::new(h);
            let found = L::stress(&MODULI, &strain).first_piola(&strain);
            let (d, size) = (1e-5, h.norm().min(1.0));
            let expected = Matrix2::from_fn(|i, j| {
                let mut by = Matrix2::zeros();
                by[(i, j)] = d;
                (energy::<L>(h + by) - energy::<L>(h - by)) / (2.0 * d)
            });
            let error = (found - expected).norm();
            assert!(error < 1e-8 * size + 5e-10, "{} at {h}: {found} {expected}", L::NAME);
        }
        for (cos, sin) in [(0.6, 0.8), (-0.28, 0.96), (0.0, -1.0)] {
            let rotation = Strain::new(Matrix2::new(cos - 1.0, -sin, sin, cos - 1.0));
            let stress = L::stress(&MODULI, &rotation).first_piola(&rotation);
            assert!(
                stress.norm() < 1e-14 && L::energy(&MODULI, &rotation).compression.abs() < 1e-15
            );
        }
    }

    #[test]
    fn the_stress_is_the_derivative_of_the_energy_and_a_rotation_has_none() {
        check::<Hencky>();
        check::<SaintVenantKirchhoff>();
    }

    /// Small and large, and on both sides of the change from the series to the function.
    #[test]
    fn logarithms_are_those_of_libm() {
        for k in -190..400 {
            let x = f64::from(k) * 0.005 + 1e-4;
            assert_relative_eq!(ln_1p(x), libm::log1p(x), max_relative = 5e-16);
        }
        for z in (1..990).map(|k| f64::from(k) * 1e-3).chain([1e-9, 0.08, 0.08 + 1e-15]) {
            assert_relative_eq!(artanh_over(z), libm::atanh(z) / z, max_relative = 5e-16);
        }
        assert_eq!((ln_1p(0.0), ln_1p(1e-300), artanh_over(0.0)), (0.0, 1e-300, 1.0));
        assert!([-1.5, -2.0, f64::NAN].iter().all(|x| ln_1p(*x).is_nan()));
    }

    /// Uniaxial strain e: w = (K + 4μ/3) e²/2. Simple shear by g: w = μ g²/2.
    #[test]
    fn laws_have_the_moduli_of_small_strains() {
        fn check<L: Law>() {
            let e = 1e-4;
            let along = energy::<L>(Matrix2::new(e, 0.0, 0.0, 0.0)) / (0.5 * e * e);
            assert_relative_eq!(along, MODULI.longitudinal(), max_relative = 3e-4);
            let sheared = energy::<L>(Matrix2::new(0.0, e, 0.0, 0.0)) / (0.5 * e * e);
            assert_relative_eq!(sheared, MODULI.shear, max_relative = 3e-4);
        }
        check::<Hencky>();
        check::<SaintVenantKirchhoff>();
    }

    /// The trace of a stress has τᶻᶻ too. At small strains the mean is K tr ε and the deviator
    /// 2μ (ε − tr ε/3), of all laws; at a large uniaxial stretch by a Saint-Venant's law has
    /// τˣˣ = (λ + 2μ) E a² and τʸʸ = τᶻᶻ = λ E with E = (a² − 1)/2, so that τˣˣ − mean is two thirds of
    /// τˣˣ − τᶻᶻ.
    #[test]
    fn the_mean_stress_is_a_third_of_the_trace_in_three_dimensions() {
        fn check<L: Law>() {
            let e = 1e-6;
            let stress = L::stress(&MODULI, &Strain::new(Matrix2::new(e, 0.0, 0.0, 0.0)));
            let deviator = stress.deviator;
            for (found, expected, of) in [
                (stress.mean, 3.0 * e, "mean"),
                (deviator.xx, 2.0 * 0.7 * e * 2.0 / 3.0, "xx"),
                (deviator.yy, -2.0 * 0.7 * e / 3.0, "yy"),
            ] {
                let error = (found / expected - 1.0).abs();
                assert!(error < 1e-5, "{}, {of}: {found:e} Pa, expected {expected:e} Pa", L::NAME);
            }
        }
        check::<Hencky>();
        check::<SaintVenantKirchhoff>();
        let a = 1.7;
        let (lambda, green) = (3.0 - 1.4 / 3.0, 0.5 * (a * a - 1.0));
        let [along, across] = [(lambda + 1.4) * green * a * a, lambda * green];
        let strain = Strain::new(Matrix2::new(a - 1.0, 0.0, 0.0, 0.0));
        let stress = SaintVenantKirchhoff::stress(&MODULI, &strain);
        assert_relative_eq!(stress.mean, (along + 2.0 * across) / 3.0, max_relative = 1e-13);
        assert_relative_eq!(stress.deviator.xx, (along - across) * 2.0 / 3.0, max_relative = 1e-13);
    }

    /// Uniaxial stretch by a factor a: σ = K(1 − 1/a) + (4/3) μ ln(a)/a.
    #[test]
    fn hencky_has_the_stress_of_a_large_stretch() {
        let a: f64 = 1.7;
        let strain = Strain::new(Matrix2::new(a - 1.0, 0.0, 0.0, 0.0));
        let stress = Hencky::stress(&MODULI, &strain);
        let sigma = (stress.mean + stress.deviator.xx) / a;
        let expected = 3.0 * (1.0 - 1.0 / a) + 4.0 / 3.0 * 0.7 * libm::log(a) / a;
        assert_relative_eq!(sigma, expected, max_relative = 1e-13);
    }
}
