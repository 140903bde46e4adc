//! Water with a free surface, which needs no treatment: density follows equation (3), and there is neither
//! Morris viscosity nor a search for the surface.

use touchstone_harness::method::{self, Standard};
use touchstone_maths::metrics::budget::{Metered, WaterDrift, WaterForces};
use touchstone_solver::{
    AcousticDamper, ArtificialStress, ArtificialViscosity, BodyForce, Compose,
    ConsistentContinuity, Continuity, CubicSpline, DensityDiffusion, ExtrapolatingWall, FluidPairs,
    Ghosts, InterfaceWall, Leapfrog, Open, PredictorCorrector, Pressure, SlipGhosts, Tait,
    WendlandC2, Xsph, terms::Hydrostatic,
};

use crate::{Method, methods};

/// (14) with (7), (16), (17), and gravity; `R` is the artificial stress (18), (19).
type Water<R = (), V = ArtificialViscosity<Tait>> = (Pressure<Tait, R>, V, BodyForce);
/// The paper's method.
type Seed<W> =
    Compose<CubicSpline, Water<ArtificialStress>, (Continuity, Xsph), W, PredictorCorrector>;
/// Density diffusion that leaves a column at rest alone.
type Diffusion = DensityDiffusion<Hydrostatic>;
/// The viscosity of water that slips along boundary particles: pairs with boundary particles, which do not
/// move, are omitted.
type Slipping = FluidPairs<ArtificialViscosity<Tait>>;
type Walls = ExtrapolatingWall<Tait>;
/// The settings of `modern` and its relatives.
type Modern<D = (Continuity, Diffusion), W = Walls, V = Slipping> =
    Compose<WendlandC2, Water<(), V>, D, W, Leapfrog>;
/// Pressure and gravity, without walls.
type Bare<D> = Compose<WendlandC2, (Pressure<Tait>, BodyForce), D, Open, Leapfrog>;

/// A method with an energy budget by term.
pub type WaterMethod = Method<(), dyn Metered<()>>;

fn metered<S>() -> WaterMethod
where
    S: Standard<Extra = (), Forces: WaterForces<()>, Drift: WaterDrift<()>>,
{
    Method::with::<S>(|parts| Ok(Box::new(method::scene::<S>(parts).build()?)))
}

methods! { metered => WaterMethod:
    /// The paper's, with interface and wall particles.
    seed: Seed<InterfaceWall>;
    /// The paper's, with ghosts.
    ghosts: Seed<Ghosts>;
    /// The paper's, with ghosts that keep the velocity along the wall.
    slip_ghosts: Seed<SlipGhosts>;
    /// The paper's without walls.
    free_seed: Seed<Open>;
    /// Wendland kernel, walls that extrapolate, density diffusion.
    modern: Modern;
    /// `modern` with an acoustic damper.
    damped: Modern<(Continuity, Diffusion), Walls, (Slipping, AcousticDamper)>;
    /// `modern` with artificial viscosity between water and walls.
    sticking: Modern<(Continuity, Diffusion), Walls, ArtificialViscosity<Tait>>;
    /// `modern` with the density diffusion of Molteni and Colagrossi.
    molteni: Modern<(Continuity, DensityDiffusion)>;
    /// `molteni` without walls.
    free: Modern<(Continuity, DensityDiffusion), Open, ArtificialViscosity<Tait>>;
    /// Pressure, a continuity that is exact for linear fields, and density diffusion, without walls.
    free_consistent: Bare<(ConsistentContinuity, DensityDiffusion)>;
    /// (3), (5) and (7) alone, without walls.
    plain: Bare<Continuity>;
}
