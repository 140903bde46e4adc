//! The elastic solid of the paper, and with gradients that are exact for linear fields and forces that are
//! conjugate to them.
//!
//! The stabilisers of the corrected variants are the stabilisers of `plain`, for a reason. A wave without a
//! gradient symbol, such as alternating velocities, changes no stress. In tension σ it grows at the rate s,
//! s² = 0.33 σ/(ρ dx²) at h = 1.5 dx, with any correction of gradients, because a correction is a factor on a
//! lattice. Artificial stress in principal axes (ξ = 0.3, n = 4) lowers the largest s² to 0.18, and
//! artificial viscosity slows the remaining growth. So tearing is delayed and not prevented, as without
//! correction.

use touchstone_harness::method::{Boundary, FirstRow, Medium};
use touchstone_solver::{
    ArtificialViscosity, BodyForce, CauchyStress, ComponentStress, Compose, ConjugateStress,
    ConsistentContinuity, ConsistentJaumannRate, Continuity, CubicSpline, JaumannRate, Leapfrog,
    Linear, Open, PlaneWall, PredictorCorrector, PrincipalStress, Symmetric, Xsph, walls::Walls,
};

use crate::{methods, stepped};

type Method = crate::Method<Symmetric>;

/// (9), (10) and (12) with the artificial stress `R`, and (15) with (16) and (17).
type Stabilised<R> = (CauchyStress<Linear, R>, ArtificialViscosity<Linear>);
/// Forces of a body with weight.
type Heavy<R> = (CauchyStress<Linear, R>, ArtificialViscosity<Linear>, BodyForce);
/// The paper's terms: the forces `F` and XSPH (22).
type Rubber<F, I = PredictorCorrector, W = Open> =
    Compose<CubicSpline, F, (Continuity, JaumannRate, Xsph), W, I, Symmetric>;
/// The leapfrog without XSPH.
type Leaping<F, W = Open> =
    Compose<CubicSpline, F, (Continuity, JaumannRate), W, Leapfrog, Symmetric>;
/// Rubber with corrected gradients.
type Corrected<F> = Compose<
    CubicSpline,
    F,
    (ConsistentContinuity, ConsistentJaumannRate),
    Open,
    Leapfrog,
    Symmetric,
>;

methods! { stepped => Method:
    /// The paper's.
    seed: Rubber<Stabilised<PrincipalStress>>;
    /// The paper's, with artificial stress component by component.
    componentwise: Rubber<Stabilised<ComponentStress>>;
    /// The paper's terms with the leapfrog.
    leapfrog: Rubber<Stabilised<PrincipalStress>, Leapfrog>;
    /// The paper's, clamped.
    clamped_seed: Rubber<Stabilised<PrincipalStress>, PredictorCorrector, Clamp>;
    /// The paper's method for a clamped body with weight.
    heavy_seed: Rubber<Heavy<PrincipalStress>, PredictorCorrector, Clamp>;
    /// The terms of [`leapfrog`] without XSPH, clamped.
    clamped_plain: Leaping<Stabilised<PrincipalStress>, Clamp>;
    /// Corrected gradients, not clamped.
    corrected: Corrected<(ConjugateStress<Linear, PrincipalStress>, ArtificialViscosity<Linear>)>;
    /// (3), (9)–(12) alone, stepped by the leapfrog: nothing stabilises, and nothing dissipates.
    bare: Leaping<CauchyStress<Linear>>;
    /// [`bare`], clamped.
    clamped_bare: Leaping<CauchyStress<Linear>, Clamp>;
}

/// The paper's method, and its equations alone, of free bodies.
pub fn free() -> [Method; 2] {
    [seed(), bare()]
}

/// Corrected gradients, clamped, without and with weight.
pub fn clamped() -> [Method; 2] {
    [clamped_seed(), clamped_bare()]
}

/// Walls of an elastic body: fixed particles of [`touchstone_solver::Role::Wall`] that continue the body and
/// hold it. Their density and stress follow the motion of the free particles by (3) and (11), so that they
/// pull as well as push.
///
/// Terms of walls read no derived data, so the rotation of S in (11) is omitted for these particles: it is of
/// second order in the strain, and a clamped end hardly rotates.
#[derive(Clone, Copy, Debug)]
pub struct Clamp {
    /// μ \[Pa\].
    pub shear_modulus: f64,
}

impl Walls<Symmetric> for Clamp {
    type Terms = (Continuity, JaumannRate);
    type Extrapolation = ();
    fn terms(&self) -> Self::Terms {
        (Continuity, JaumannRate { shear_modulus: self.shear_modulus })
    }
    fn extrapolation(&self) {}
}

impl Boundary for Clamp {
    const NAME: &str = "clamp";
    const FIRST_ROW: FirstRow = FirstRow::Behind;
    fn new(medium: &Medium, _: Vec<PlaneWall>) -> Self {
        Self { shear_modulus: medium.shear_modulus }
    }
}
