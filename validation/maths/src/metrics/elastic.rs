//! An isotropic elastic material: moduli, speeds of waves, energies.

use touchstone_base::functions::ln_1p;
use touchstone_solver::{Linear, Symmetric};

/// An isotropic elastic solid: small-strain moduli, plane strain with the 1/3 of three dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Density ⁰ρ without stress \[kg/m³\].
    pub density: f64,
    /// K, the bulk modulus of three dimensions \[Pa\].
    pub bulk: f64,
    /// μ, the shear modulus \[Pa\].
    pub shear: f64,
}

impl Material {
    /// From Young's modulus E \[Pa\] and Poisson's ratio: K = E/(3(1 − 2ν)), μ = E/(2(1 + ν)).
    pub fn from_young(density: f64, young: f64, poisson: f64) -> Self {
        let (bulk, shear) =
            (young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
        Self { density, bulk, shear }
    }

    /// (13) ⁰c = √(K/⁰ρ) \[m/s\].
    pub fn sound_speed(&self) -> f64 {
        (self.bulk / self.density).sqrt()
    }

    /// c_p = √((K + 4μ/3)/⁰ρ) \[m/s\]: the fastest wave, which limits the time step.
    pub fn p_wave_speed(&self) -> f64 {
        ((self.bulk + 4.0 / 3.0 * self.shear) / self.density).sqrt()
    }

    /// (μ/⁰ρ)^(1/2), the speed of shear waves \[m/s\].
    pub fn shear_wave_speed(&self) -> f64 {
        (self.shear / self.density).sqrt()
    }

    /// (12).
    pub fn eos(&self) -> Linear {
        Linear { density: self.density, sound_speed: self.sound_speed() }
    }

    /// m e with de = p dρ/ρ² \[J/m\], of a mass \[kg/m\] at a density \[kg/m³\].
    pub fn compression_energy(&self, mass: f64, density: f64) -> f64 {
        let ratio = density / self.density;
        let c2 = self.bulk / self.density;
        // ln(1 + x) − x/(1 + x): neither term alone is small where their difference is.
        let x = ratio - 1.0;
        mass * c2 * (ln_1p(x) - x / ratio)
    }

    /// Energy of a deviator in a volume \[m²\]: without a shear modulus no shear stress holds energy.
    pub fn shear_energy(&self, volume: f64, stress: &Symmetric) -> f64 {
        if self.shear > 0.0 { volume * norm_squared(stress) / (4.0 * self.shear) } else { 0.0 }
    }
}

/// S:S of a deviator of plane strain \[Pa²\]: Sᶻᶻ = −(Sˣˣ + Sʸʸ) counts too.
pub fn norm_squared(s: &Symmetric) -> f64 {
    let zz = s.xx + s.yy;
    s.xx * s.xx + s.yy * s.yy + zz * zz + 2.0 * s.xy * s.xy
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn rubber_has_the_moduli_and_wave_speeds_of_the_rings() {
        let rubber = Material::from_young(1000.0, 2e6, 0.3975);
        assert_relative_eq!(rubber.shear / rubber.bulk, 0.22, max_relative = 1e-3);
        let (c, cp) = (rubber.sound_speed(), rubber.p_wave_speed());
        assert_relative_eq!(cp / c, 1.137, max_relative = 1e-3);
        assert_relative_eq!(c, 57.02, max_relative = 1e-3);
        // As docs/limits.md has them: c_p over the speed of shear waves.
        for (poisson, ratio) in [(0.3975, 2.42), (0.49, 7.14), (0.499, 22.4), (0.4999, 70.7)] {
            let rubber = Material::from_young(1000.0, 2e6, poisson);
            let found = rubber.p_wave_speed() / rubber.shear_wave_speed();
            assert_relative_eq!(found, ratio, max_relative = 2e-3);
        }
        // K = E/(3(1-2nu)) and mu = E/(2(1+nu)) have 9 K mu/(3 K + mu) = E.
        let young = 9.0 * rubber.bulk * rubber.shear / (3.0 * rubber.bulk + rubber.shear);
        assert_relative_eq!(young, 2e6, max_relative = 1e-12);
    }
}
