//! The schemes of the elastic solid, a line of types each.

use harness::method::{Boundary, FirstRow, Medium};
use solver::{
    ArtificialViscosity, BodyForce, CauchyStress, Compose, Continuity, CubicSpline, JaumannRate,
    Leapfrog, Linear, Open, PlaneWall, Symmetric, Xsph, walls::Walls,
};

/// (9), (10) and (12) with the artificial stress `R`, and (15) with (16) and (17).
type Stabilised<R> = (CauchyStress<Linear, R>, ArtificialViscosity<Linear>);

/// The paper's terms: artificial viscosity, the artificial stress `R`, XSPH (22).
pub type Rubber<R, I, W = Open> =
    Compose<CubicSpline, Stabilised<R>, (Continuity, JaumannRate, Xsph), W, I, Symmetric>;

/// The same terms without XSPH, stepped by the leapfrog.
pub type Plain<R, W = Open> =
    Compose<CubicSpline, Stabilised<R>, (Continuity, JaumannRate), W, Leapfrog, Symmetric>;

/// The forces of [`Rubber`] on a body that has weight.
type Heavy<R> = (CauchyStress<Linear, R>, ArtificialViscosity<Linear>, BodyForce);

/// [`Rubber`] that has weight.
pub type HeavyRubber<R, I, W = Open> =
    Compose<CubicSpline, Heavy<R>, (Continuity, JaumannRate, Xsph), W, I, Symmetric>;

/// (3), (9)–(12) alone, stepped by the leapfrog: nothing stabilises, and nothing dissipates.
pub type Bare<W = Open> =
    Compose<CubicSpline, CauchyStress<Linear>, (Continuity, JaumannRate), W, Leapfrog, Symmetric>;

/// Walls of an elastic body: particles of [`solver::Role::Wall`] that stand still and continue the
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
    fn terms(&self) -> Self::Terms {
        (Continuity, JaumannRate { shear_modulus: self.shear_modulus })
    }
}

impl Boundary for Clamp {
    const NAME: &'static str = "clamp";
    const FIRST_ROW: FirstRow = FirstRow::Behind;
    fn new(medium: &Medium, _: Vec<PlaneWall>) -> Self {
        Self { shear_modulus: medium.shear_modulus }
    }
}
