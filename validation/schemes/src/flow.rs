//! Viscous flows: channels, cylinders, vortices, the cavity, and the manufactured flow.

use nalgebra::Vector2;
use touchstone_harness::method::{FromMedium, Medium};
use touchstone_maths::exact::manufactured;
use touchstone_solver::{
    ArtificialStress, ArtificialViscosity, BodyForce, Compose, ConsistentContinuity,
    ConsistentPressure, ConsistentViscosity, Continuity, CubicSpline, DensityDiffusion,
    ExtrapolatingWall, FluidPairs, Ghosts, InterfaceWall, Kernel, Leapfrog, NoSlip, Open,
    PredictorCorrector, Pressure, QuinticSpline, Rate, ShiftAdvection, Shifting, SingleSweep,
    SlipAtWalls, SlipGhosts, Split, SuperSteps, Tait, Term, Viscosity, WendlandC2, Xsph,
    lane::Lane, particles::Common, terms::Pair,
};

use crate::{Method, methods, stepped};

/// Forces of a flow that the force `B` drives: pressure, viscosity, and this force.
pub type Fluid<B, R = ()> = (Pressure<Tait, R>, Viscosity, B);
/// Forces of a flow that no force drives.
pub type Pairs = (Pressure<Tait>, Viscosity);
/// Density diffusion and shifting, the stabilisers of the modern variants.
pub type Stabilised = (Continuity, DensityDiffusion, Shifting);
/// [`Stabilised`] with a continuity that is exact for linear fields.
pub type ConsistentDrift = (ConsistentContinuity, DensityDiffusion, Shifting);
/// [`ConsistentDrift`] with fluid that slips along walls of mirror particles.
type SlippingDrift = (SlipAtWalls<ConsistentContinuity>, DensityDiffusion, Shifting);
/// The paper's: cubic spline and predictor-corrector.
pub type Seed<F, D, W = Ghosts> = Compose<CubicSpline, F, D, W, PredictorCorrector>;
/// Quintic spline and, as a rule, leapfrog.
pub type Modern<F, D, W = Ghosts, I = Leapfrog> = Compose<QuinticSpline, F, D, W, I>;
/// Quintic spline, leapfrog, forces `E`, and viscosity by super-time-stepping.
pub type Stiff<E> = Modern<Split<E, Viscosity>, Stabilised, Ghosts, Leapfrog<SuperSteps>>;

type Carried = (Pressure<Tait>, Viscosity, ShiftAdvection);
type Consistent = (ConsistentPressure<Tait>, ConsistentViscosity, ShiftAdvection);
type ConsistentDriven = (ConsistentPressure<Tait>, ConsistentViscosity, BodyForce, ShiftAdvection);
/// Wall particles have minus the mean velocity of the fluid in reach.
pub type Mean = ExtrapolatingWall<Tait, NoSlip>;

// A channel flow stores x, v and ρ, shows its neighbours one number, p/ρ², and nothing else.
const _: () = assert!(size_of::<<Fluid<()> as Term<()>>::Derived>() == 8);
const _: () = assert!(size_of::<<Stabilised as Term<()>>::Derived>() == 0);

/// The methods that Couette flow and Poiseuille flow have in common.
pub struct OfChannels {
    /// The paper's.
    pub seed: Method,
    /// `seed` with interface and wall particles.
    pub interface_wall: Method,
    /// Wendland's kernel and leapfrog.
    pub wendland: Method,
    /// Quintic spline and leapfrog.
    pub plain: Method,
    /// `plain` with extrapolating walls.
    pub extrapolating: Method,
    /// `plain` with [`Stabilised`].
    pub modern: Method,
    /// `modern` with one pair sweep a step.
    pub single_sweep: Method,
    /// `modern` with super-time-stepping.
    pub stiff: Method,
    /// `modern` with sums that are exact for linear fields, and shifting that advects the velocity.
    pub consistent: Method,
}

/// With the forces `F`, which with stiff viscosity are `E` and this, and `C`, exact for linear fields.
fn of_channels<F, E, C>() -> OfChannels
where
    F: FromMedium + Term<()>,
    E: FromMedium + Term<()>,
    C: FromMedium + Term<()>,
{
    OfChannels {
        seed: Method::of::<Seed<F, Continuity>>(),
        interface_wall: Method::of::<Seed<F, Continuity, InterfaceWall>>(),
        wendland: Method::of::<Compose<WendlandC2, F, Continuity, Ghosts, Leapfrog>>(),
        plain: Method::of::<Modern<F, Continuity>>(),
        extrapolating: Method::of::<Modern<F, Continuity, Mean>>(),
        modern: Method::of::<Modern<F, Stabilised>>(),
        single_sweep: Method::of::<Modern<F, Stabilised, Ghosts, SingleSweep>>(),
        stiff: Method::of::<Stiff<E>>(),
        consistent: Method::of::<Modern<C, ConsistentDrift>>(),
    }
}

methods! { of_channels => OfChannels:
    /// Flow driven by a plate.
    couette: Pairs, Pressure<Tait>, Consistent;
    /// Flow driven by a body force.
    poiseuille: Fluid<BodyForce>, (Pressure<Tait>, BodyForce), ConsistentDriven;
}
methods! { stepped => Method:
    /// The seed's with artificial stress.
    cure_stress: Seed<Fluid<BodyForce, ArtificialStress>, Continuity>;
    /// The seed's with artificial viscosity.
    cure_viscosity: Seed<(Pressure<Tait>, Viscosity, BodyForce, ArtificialViscosity<Tait>), Continuity>;
    /// The seed's with XSPH.
    cure_xsph: Seed<Fluid<BodyForce>, (Continuity, Xsph)>;
    /// The seed's with shifting.
    cure_shifting: Seed<Fluid<BodyForce>, (Continuity, Shifting)>;

    /// A channel along whose walls the fluid slips, with ghosts.
    slip: Modern<Pairs, Continuity, SlipGhosts>;
    /// A channel along whose walls the fluid slips, because they have no viscous force, with walls that
    /// extrapolate.
    slip_extrapolating:
        Modern<(Pressure<Tait>, FluidPairs<Viscosity>), Continuity, ExtrapolatingWall<Tait>>;

    /// Cylinders with interface and wall particles.
    cylinders_interface: Modern<Pairs, Continuity, InterfaceWall>;
    /// Cylinders with walls that extrapolate.
    cylinders_extrapolating: Modern<Pairs, Continuity, Mean>;

    /// The cavity by the paper's method.
    cavity_seed: Seed<Pairs, Continuity, InterfaceWall>;
    /// The cavity with extrapolating walls and [`Stabilised`].
    cavity_modern: Modern<Pairs, Stabilised, Mean>;
    /// `cavity_modern` with shifting that advects the velocity.
    cavity_carried: Modern<Carried, Stabilised, Mean>;
    /// `cavity_carried` with sums that are exact for linear fields.
    cavity_consistent: Modern<Consistent, ConsistentDrift, Mean>;

    /// `cavity_consistent` with mirror particles, along which the fluid slips for the continuity equation
    /// alone.
    cavity_mirrored: Modern<Consistent, SlippingDrift>;

    /// Vortices without a stabiliser.
    vortices_plain: Modern<Pairs, Continuity, Open>;
    /// Vortices with [`Stabilised`].
    vortices_modern: Modern<Pairs, Stabilised, Open>;
    /// `vortices_modern` with shifting that advects the velocity.
    vortices_carried: Modern<Carried, Stabilised, Open>;
    /// `vortices_carried` with sums that are exact for linear fields.
    vortices_consistent: Modern<Consistent, ConsistentDrift, Open>;

    /// The manufactured flow by the paper's method, with ghosts.
    manufactured_seed: Seed<Fluid<Source>, Continuity>;
    /// `manufactured_seed` with interface and wall particles.
    manufactured_seed_interface: Seed<Fluid<Source>, Continuity, InterfaceWall>;
    /// The manufactured flow with [`Stabilised`] and ghosts.
    manufactured_modern: Modern<Fluid<Source>, Stabilised>;
    /// `manufactured_modern` with interface and wall particles.
    manufactured_modern_interface: Modern<Fluid<Source>, Stabilised, InterfaceWall>;
    /// The manufactured flow with sums that are exact for linear fields, and ghosts.
    manufactured_consistent: Modern<Exact, ConsistentDrift>;
    /// `manufactured_consistent` with interface and wall particles.
    manufactured_consistent_interface: Modern<Exact, ConsistentDrift, InterfaceWall>;
}

type Exact = (ConsistentPressure<Tait>, ConsistentViscosity, Source, ShiftAdvection);

/// The force of the manufactured flow.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// U²/L and νU/L², the scales of its parts \[m/s²\].
    scales: Vector2<f64>,
}

/// The medium has the scales in place of a uniform body force, so that a deliberate error of the viscosity is
/// none of the force.
impl FromMedium for Source {
    fn new(medium: &Medium) -> Self {
        Self { scales: medium.acceleration }
    }
    fn state(terms: &mut Vec<&'static str>) {
        terms
            .push("dv_i/dt += the force of the manufactured solution at the place of the particle");
    }
}

impl<X> Term<X> for Source {
    type Derived = ();
    type Sum = ();

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, _: &Pair<V, K>, _: &mut ()) {}

    #[inline(always)]
    fn finish(&self, _: &Common, _: (), _: (), _: &mut Rate<X>) {}

    fn place(&self, x: Vector2<f64>, rate: &mut Rate<X>) {
        let (advection, viscous) = (manufactured::advection(x), manufactured::viscous(x));
        rate.velocity += advection * self.scales.x + viscous * self.scales.y;
    }
}
