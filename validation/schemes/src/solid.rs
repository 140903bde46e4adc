//! The elastic solid of the paper, and with gradients that are exact for linear fields and forces that are
//! conjugate to them.
//!
//! What stabilises the latter is that of `plain`, for a reason. A wave without a gradient symbol, such as
//! opposite velocities side by side, changes no stress. In tension σ it grows at the rate s,
//! s² = 0.33 σ/(ρ dx²) at h = 1.5 dx, however gradients are corrected, since on a lattice correction is a
//! factor. Artificial stress in principal axes (ξ = 0.3, n = 4) lowers the largest s² to 0.18, and artificial
//! viscosity makes what is left slow. So tearing is delayed and not removed, as without correction.

use touchstone_harness::method::{Boundary, FirstRow, Medium};
use touchstone_solver::{walls::Walls, *};

use crate::{methods, stepped};

type Method = crate::Method<Symmetric>;

/// (9), (10) and (12) with the artificial stress `R`, and (15) with (16) and (17).
type Stabilised<R> = (CauchyStress<Linear, R>, ArtificialViscosity<Linear>);
/// The same of a body that has weight.
type Heavy<R> = (CauchyStress<Linear, R>, ArtificialViscosity<Linear>, BodyForce);
/// The paper's terms: the forces `F` and XSPH (22).
type Rubber<F, I = PredictorCorrector, W = Open> =
    Compose<CubicSpline, F, (Continuity, JaumannRate, Xsph), W, I, Symmetric>;
/// The leapfrog without XSPH.
type Leaping<F, W = Open> =
    Compose<CubicSpline, F, (Continuity, JaumannRate), W, Leapfrog, Symmetric>;
/// The same with corrected gradients.
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
    /// The same of a body that has weight.
    heavy_seed: Rubber<Heavy<PrincipalStress>, PredictorCorrector, Clamp>;
    /// The terms of [`leapfrog`] without XSPH, clamped.
    clamped_plain: Leaping<Stabilised<PrincipalStress>, Clamp>;
    /// The same with corrected gradients, not clamped.
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

/// The same of clamped bodies.
pub fn clamped() -> [Method; 2] {
    [clamped_seed(), clamped_bare()]
}

/// Walls of an elastic body: particles of [`touchstone_solver::Role::Wall`] that stand still and continue the
/// body, so that it is held where they begin. Their density and their stress follow the motion of the
/// free particles by (3) and (11), so that they pull as well as push.
///
/// A wall row reads no shown numbers, so the rotation of S in (11) is left out for them: it is of
/// second order in the strain, and what is held hardly rotates.
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
    const NAME: &'static str = "clamp";
    const FIRST_ROW: FirstRow = FirstRow::Behind;
    fn new(medium: &Medium, _: Vec<PlaneWall>) -> Self {
        Self { shear_modulus: medium.shear_modulus }
    }
}
