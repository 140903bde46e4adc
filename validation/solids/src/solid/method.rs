//! The methods that solid cases compare: a line of types each.

use solver::{
    ArtificialViscosity, CauchyStress, Compose, Continuity, CubicSpline, Integrator, JaumannRate,
    Leapfrog, Linear, PredictorCorrector, PrincipalStress, Symmetric, Term, Xsph, walls::Walls,
};

use super::Solid;

/// The scheme of a method with these walls.
pub type Scheme<M, W> = Compose<
    CubicSpline,
    <M as Method>::Forces,
    <M as Method>::Drift,
    W,
    <M as Method>::Integrator,
    Symmetric,
>;

/// A composition of terms and integrator for the elastic solid.
pub trait Method: 'static {
    /// Terms of dv/dt.
    type Forces: Term<Symmetric>;
    /// Terms of dx/dt, dρ/dt and dS/dt.
    type Drift: Term<Symmetric>;
    /// Time integration.
    type Integrator: Integrator<Symmetric>;
    /// Settings that only other methods read.
    const UNUSED: &'static [&'static str];
    /// Courant number dt (c_p + V)/h unless given. Theory allows 1.87 to the undamped leapfrog, and
    /// 1.03 with α = 1.
    const COURANT: f64;

    /// The forces for this spacing \[m\].
    fn forces(solid: &Solid, dx: f64) -> Self::Forces;
    /// The drift.
    fn drift(solid: &Solid) -> Self::Drift;
}

/// The seed paper's method: predictor-corrector, (15) with (16)–(18), (20) in principal axes, (22).
pub struct Seed;

/// The same terms without XSPH, stepped by the leapfrog.
pub struct Plain;

/// (3), (9)–(12) alone, stepped by the leapfrog: nothing stabilises, and nothing dissipates.
pub struct Bare;

type Stabilised = (CauchyStress<Linear, PrincipalStress>, ArtificialViscosity<Linear>);

fn stabilised(solid: &Solid, dx: f64) -> Stabilised {
    let (eos, [alpha, beta]) = (solid.material.eos(), solid.viscosity);
    let tensile = PrincipalStress::new(solid.xi, solid.exponent, solid.w_at_spacing(dx));
    (CauchyStress { eos, tensile }, ArtificialViscosity::new(alpha, beta, solid.h(dx), eos))
}

fn jaumann(solid: &Solid) -> JaumannRate {
    JaumannRate { shear_modulus: solid.material.shear }
}

impl Method for Seed {
    type Forces = Stabilised;
    type Drift = (Continuity, JaumannRate, Xsph);
    type Integrator = PredictorCorrector<Symmetric>;
    const UNUSED: &'static [&'static str] = &[];
    const COURANT: f64 = 0.25;

    fn forces(solid: &Solid, dx: f64) -> Stabilised {
        stabilised(solid, dx)
    }
    fn drift(solid: &Solid) -> Self::Drift {
        (Continuity, jaumann(solid), Xsph { epsilon: solid.xsph })
    }
}

impl Method for Plain {
    type Forces = Stabilised;
    type Drift = (Continuity, JaumannRate);
    type Integrator = Leapfrog;
    const UNUSED: &'static [&'static str] = &["xsph"];
    const COURANT: f64 = 0.4;

    fn forces(solid: &Solid, dx: f64) -> Stabilised {
        stabilised(solid, dx)
    }
    fn drift(solid: &Solid) -> Self::Drift {
        (Continuity, jaumann(solid))
    }
}

impl Method for Bare {
    type Forces = CauchyStress<Linear>;
    type Drift = (Continuity, JaumannRate);
    type Integrator = Leapfrog;
    const UNUSED: &'static [&'static str] = &["alpha", "beta", "xi", "exponent", "xsph"];
    const COURANT: f64 = 0.4;

    fn forces(solid: &Solid, _: f64) -> Self::Forces {
        CauchyStress { eos: solid.material.eos(), tensile: () }
    }
    fn drift(solid: &Solid) -> Self::Drift {
        (Continuity, jaumann(solid))
    }
}

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
