//! How each term and each wall is constructed from the parameters of a medium, and which settings it reads.

use touchstone_solver::{
    AcousticDamper, ArtificialStress, ArtificialViscosity, BodyForce, CauchyStress,
    ConjugateStress, ConsistentContinuity, ConsistentJaumannRate, ConsistentPressure,
    ConsistentViscosity, Continuity, CurvedNoSlip, DensityDiffusion, ExtrapolatingWall, FluidPairs,
    Ghosts, InterfaceWall, JaumannRate, Linear, NoSlip, Open, PlaneWall, Pressure, ShiftAdvection,
    Shifting, SlipAtWalls, SlipGhosts, Split, Tait, Viscosity, Xsph,
    terms::{Axes, Hydrostatic, InTension},
};

use crate::medium::{Medium, MediumSetting};

/// A term that can be constructed from a medium.
pub trait FromMedium: Sized {
    /// The term with the constants of a medium.
    fn new(medium: &Medium) -> Self;
    /// Adds the settings that this term reads and some other terms do not, including the settings of the
    /// terms inside it.
    fn uses(_: &mut Vec<MediumSetting>) {}
    /// Adds the term as an equation, and the terms inside it.
    fn state(_: &mut Vec<&'static str>);
}

/// `Type [generics] (settings that it reads; the terms inside it) = |medium| value, equation`.
macro_rules! from_medium {
    ($($type:ty [$($generics:tt)*] ($($setting:ident),* $(; $($inner:ident),+)?) =
        $new:expr, $text:expr;)+) => {$(
        impl<$($generics)*> FromMedium for $type {
            fn new(medium: &Medium) -> Self {
                let new: fn(&Medium) -> Self = $new;
                new(medium)
            }
            fn uses(settings: &mut Vec<MediumSetting>) {
                settings.extend_from_slice(&[$(MediumSetting::$setting),*]);
                $($($inner::uses(settings);)+)?
            }
            fn state(terms: &mut Vec<&'static str>) {
                let text: &'static str = $text;
                terms.extend(Some(text).filter(|text| !text.is_empty()));
                $($($inner::state(terms);)+)?
            }
        }
    )+};
}

from_medium! {
    () [] () = |_| (), "";
    Tait [] () = |m| m.eos, "";
    Linear [] () = |m| Self { density: m.eos.density, sound_speed: m.eos.sound_speed }, "";
    Continuity [] () = |_| Continuity, "dρ_i/dt = Σ m_j v_ij·∇W_ij, v_ij = v_i - v_j";
    ConsistentContinuity [] () = |_| ConsistentContinuity,
        "dρ_i/dt = -ρ_i ∇·v, gradients exact for linear fields";
    ConsistentPressure<Tait> [] () = |m| ConsistentPressure { eos: m.eos },
        "dv_i/dt += -∇p/ρ_i, gradients exact for linear fields";
    ConsistentViscosity [] () = |m| ConsistentViscosity { nu: m.nu },
        "dv_i/dt += ν ∇²v, 0 for linear fields on any particles";
    Viscosity [] (Eta2) =
        |m| Viscosity { mu: m.density * m.nu, eta2: m.eta2_over_h2 * m.h * m.h },
        "dv_i/dt += 2 ρ0 ν Σ m_j/(ρ_i ρ_j) (r_ij·∇W_ij)/(r_ij² + eta2_over_h2 h²) v_ij";
    BodyForce [] () = |m| BodyForce(m.acceleration), "dv_i/dt += g";
    ArtificialStress [] (Xi, Exponent) = |m| Self::new(m.xi, m.exponent, m.w_at_spacing),
        "artificial stress: p_i/ρ_i² + p_j/ρ_j² plus (R_i + R_j) (W_ij/W(dx))^exponent, R = xi |p|/ρ² where \
         p < 0, else 0";
    InTension<A> [A: Axes] (Xi, Exponent) = |m| Self::new(m.xi, m.exponent, m.w_at_spacing),
        "artificial stress: σ_i/ρ_i² + σ_j/ρ_j² plus (R_i + R_j) (W_ij/W(dx))^exponent, R = -xi σ/ρ² where σ \
         is tension, else 0";
    ArtificialViscosity<E, ALL> [E: FromMedium + Copy, const ALL: bool] (Alpha, Beta) =
        |m| Self::new(m.alpha, m.beta, m.h, E::new(m)),
        if ALL {
            "artificial viscosity: dv_i/dt += -Σ m_j Π_ij ∇W_ij, Π_ij = -(alpha (c_i + c_j)/2 + beta |μ|) \
             μ 2/(ρ_i + ρ_j), μ = h v_ij·r_ij/(r_ij² + 0.01 h²)"
        } else {
            "artificial viscosity: dv_i/dt += -Σ m_j Π_ij ∇W_ij of pairs that approach, Π_ij = (-alpha (c_i \
             + c_j)/2 μ + beta μ²) 2/(ρ_i + ρ_j), μ = h v_ij·r_ij/(r_ij² + 0.01 h²)"
        };
    Xsph [] (Xsph) = |m| Xsph { epsilon: m.xsph },
        "XSPH: dr_i/dt = v_i - xsph Σ 2 m_j/(ρ_i + ρ_j) W_ij v_ij";
    DensityDiffusion [] (Diffusion) = |m| Self::new(m.diffusivity()),
        "density diffusion: dρ_i/dt += 2 diffusion h c0 Σ m_j/ρ_j F_ij (ρ_j - ρ_i), ∇W = -F r";
    DensityDiffusion<Hydrostatic> [] (Diffusion) = |m| DensityDiffusion {
        diffusivity: m.diffusivity(),
        rest: Hydrostatic { eos: m.eos, gravity: m.acceleration },
    },
        "density diffusion: dρ_i/dt += 2 diffusion h c0 Σ m_j/ρ_j F_ij (ρ0/c0²) (w_j - w_i - g·(r_j - r_i)), \
         ∇W = -F r, dw = dp/ρ";
    AcousticDamper [] (Damper) = |m| Self { bulk: m.bulk_viscosity() },
        "acoustic damper: dv_i/dt += damper ρ0 c0 h Σ m_j (D_i/ρ_i² + D_j/ρ_j²) ∇W_ij, D_i = -Σ m_j/ρ_i \
         v_ij·∇W_ij, 0 of particles of a wall";
    Shifting [] (Shift) = |m| Shifting::new(m.shift, m.h, m.w_at_spacing),
        "shifting: dr_i/dt = v_i - shift v_max h Σ m_j/ρ_j (1 + 0.2 (W_ij/W(dx))⁴) ∇W_ij";
    ShiftAdvection [] (Shift) = |m| ShiftAdvection(Shifting::new(m.shift, m.h, m.w_at_spacing)),
        "dv_i/dt += (δu_i·∇) v, δu the velocity of shifting";
    JaumannRate [] () = |m| JaumannRate { shear_modulus: m.shear_modulus },
        "dS/dt as above, with the velocity gradient -Σ m_j/ρ_j v_ij ∇W_ij";
    ConsistentJaumannRate [] () = |m| Self(JaumannRate::new(m)),
        "dS/dt as above, gradients exact for linear fields";
    Pressure<E, R> [E: FromMedium, R: FromMedium] (; R) =
        |m| Self { eos: E::new(m), tensile: R::new(m) },
        "dv_i/dt += -Σ m_j (p_i/ρ_i² + p_j/ρ_j²) ∇W_ij";
    CauchyStress<E, R> [E: FromMedium, R: FromMedium] (; R) =
        |m| Self { eos: E::new(m), tensile: R::new(m) },
        "dv_i/dt += Σ m_j (σ_i/ρ_i² + σ_j/ρ_j²)·∇W_ij";
    ConjugateStress<E, R> [E: FromMedium, R: FromMedium] (; R) =
        |m| Self { eos: E::new(m), tensile: R::new(m) },
        "dv_i/dt += (∇·σ)/ρ, the sum that is conjugate to the corrected velocity gradient";
    Split<E, T> [E: FromMedium, T: FromMedium] (; E, T) =
        |m| Self(E::new(m), T::new(m), m.explicit_limit()), "";
    FluidPairs<T> [T: FromMedium] (; T) = |m| Self(T::new(m)),
        "the next term without pairs of a moving particle and a particle of a wall";
    SlipAtWalls<T> [T: FromMedium] (; T) = |m| Self(T::new(m)),
        "the next term with the velocity v - 2 (v·n) n of mirror particles in place of their own";
    (A, B) [A: FromMedium, B: FromMedium] (; A, B) = |m| (A::new(m), B::new(m)), "";
    (A, B, C) [A: FromMedium, B: FromMedium, C: FromMedium] (; A, B, C) =
        |m| (A::new(m), B::new(m), C::new(m)), "";
    (A, B, C, D) [A: FromMedium, B: FromMedium, C: FromMedium, D: FromMedium] (; A, B, C, D) =
        |m| (A::new(m), B::new(m), C::new(m), D::new(m)), "";
}

/// Position of the first row of boundary particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstRow {
    /// There are no boundary particles: mirror particles, or no wall.
    Nowhere,
    /// On the surface: interface particles.
    OnSurface,
    /// Half a spacing behind it.
    Behind,
}

impl FirstRow {
    /// Distance of the first row behind the surface \[dx\]; half a spacing also without boundary particles,
    /// for the fluid begins half a spacing before a mirroring wall.
    pub fn depth(self) -> f64 {
        if self == Self::OnSurface { 0.0 } else { 0.5 }
    }

    /// Distance of the first row of fluid before the surface \[dx\].
    pub fn fluid(self) -> f64 {
        if self == Self::OnSurface { 1.0 } else { 0.5 }
    }
}

/// Walls that can be constructed from a medium and from the planes that mirror the fluid.
pub trait Boundary: Sized {
    /// The name in reports.
    const NAME: &str;
    /// Position of its boundary particles.
    const FIRST_ROW: FirstRow;
    /// Whether the walls are mirrors to which a fluid sticks.
    const NO_SLIP_MIRRORS: bool = false;
    /// The settings that only some walls read and these do.
    const USES: &[MediumSetting] = &[];
    /// The walls.
    fn new(medium: &Medium, mirrors: Vec<PlaneWall>) -> Self;
}

impl Boundary for Open {
    const NAME: &str = "none";
    const FIRST_ROW: FirstRow = FirstRow::Nowhere;
    fn new(_: &Medium, _: Vec<PlaneWall>) -> Self {
        Self
    }
}

impl Boundary for Ghosts {
    const NAME: &str = "ghosts";
    const NO_SLIP_MIRRORS: bool = true;
    const FIRST_ROW: FirstRow = FirstRow::Nowhere;
    const USES: &[MediumSetting] = &[MediumSetting::WallCurvature];
    fn new(_: &Medium, walls: Vec<PlaneWall>) -> Self {
        Self { walls }
    }
}

impl Boundary for SlipGhosts {
    const NAME: &str = "ghosts along which water slips";
    const FIRST_ROW: FirstRow = FirstRow::Nowhere;
    fn new(_: &Medium, walls: Vec<PlaneWall>) -> Self {
        Self { walls }
    }
}

impl Boundary for InterfaceWall {
    const NAME: &str = "interface-wall";
    const FIRST_ROW: FirstRow = FirstRow::OnSurface;
    fn new(_: &Medium, _: Vec<PlaneWall>) -> Self {
        Self
    }
}

impl Boundary for ExtrapolatingWall<Tait, CurvedNoSlip> {
    const NAME: &str = "extrapolating-wall with curvature";
    const FIRST_ROW: FirstRow = FirstRow::Behind;
    fn new(m: &Medium, _: Vec<PlaneWall>) -> Self {
        Self::new(m.eos, m.wall_acceleration)
    }
}

impl Boundary for ExtrapolatingWall<Tait, NoSlip> {
    const NAME: &str = "extrapolating-wall";
    const FIRST_ROW: FirstRow = FirstRow::Behind;
    fn new(m: &Medium, _: Vec<PlaneWall>) -> Self {
        Self::new(m.eos, m.wall_acceleration)
    }
}

// Along walls at rest. Their pressure is not below 0, because above a free surface a wall must not
// attract the water.
impl Boundary for ExtrapolatingWall<Tait> {
    const NAME: &str = "extrapolating-wall";
    const FIRST_ROW: FirstRow = FirstRow::Behind;
    const USES: &[MediumSetting] = &[MediumSetting::WallGravity];
    fn new(m: &Medium, _: Vec<PlaneWall>) -> Self {
        Self { least_pressure: 0.0, ..Self::new(m.eos, m.wall_acceleration) }
    }
}
