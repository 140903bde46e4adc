//! Walls: the two representations of section 4 of the paper (mirror particles; interface and wall
//! particles), boundary particles that extrapolate from the fluid, and images, which implement both mirror
//! particles and periodic copies.

mod extrapolating;
mod ghosts;
mod image;

pub use extrapolating::{CurvedNoSlip, ExtrapolatingWall, NoSlip, WallVelocity};
pub use ghosts::{Ghosts, Mirrors, PlaneWall, SlipGhosts};
pub(crate) use ghosts::{RIGHT_ANGLE, corners};
pub use image::Map;

use crate::lane::Lane;
use nalgebra::Vector2;

use crate::{
    kernel::Kernel,
    numbers::{In, Numbers},
    particles::{Common, SweptParticle},
    terms::{Continuity, Pair, PairSum, Term},
};

/// How a scene treats its walls.
pub trait Walls<X>: Clone + Send + Sync + 'static {
    /// The terms by which wall particles evolve, without derived data; with `()` no pair sweep over wall
    /// particles is compiled.
    type Terms: Term<X>;
    /// Extrapolation of velocity and density from the fluid to wall particles; `()` for none.
    type Extrapolation: Extrapolation;
    /// The values of [`Walls::Terms`].
    fn terms(&self) -> Self::Terms;
    /// The values of [`Walls::Extrapolation`].
    fn extrapolation(&self) -> Self::Extrapolation;
    /// Whether mirror particles behind [`Walls::mirrors`] keep the tangential velocity (free slip).
    const SLIPS: bool = false;
    /// The straight walls that mirror the fluid.
    fn mirrors(&self) -> &[PlaneWall] {
        &[]
    }
}

/// Velocity and density of wall particles, extrapolated from the fluid before each pair sweep by sums over
/// fluid particles alone; `()` extrapolates nothing.
pub trait Extrapolation: Copy + Send + Sync + 'static {
    /// Whether nothing is extrapolated.
    const IS_EMPTY: bool = false;
    /// Whether the sums are formed at the foot of each wall particle, the nearest point of the surface:
    /// [`crate::scene::Setting::feet`].
    const FEET: bool = false;
    /// From a wall particle to its foot \[m\]; `()` where the sums do not need it.
    type Foot: Numbers;
    /// Sums of a wall particle over the fluid.
    type Sum: Numbers;
    /// The foot of a wall particle; of any other particle `None`.
    fn foot(foot: Option<&Vector2<f64>>) -> Self::Foot;
    /// Adds the contributions of the fluid particles j of `pair`.
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Foot>, sum: &mut In<Self::Sum, V>);
    /// The state of a wall particle, whose density so far is among `own`.
    fn finish(&self, own: &Common, sum: Self::Sum) -> WallState;
}

/// The extrapolated state of a wall particle.
#[derive(Clone, Copy, Debug, Default)]
pub struct WallState {
    /// Density \[kg/m³\].
    pub density: f64,
    /// Velocity minus the velocity of the wall \[m/s\].
    pub velocity: Vector2<f64>,
}

impl Extrapolation for () {
    const IS_EMPTY: bool = true;
    type Foot = ();
    type Sum = ();
    fn foot(_: Option<&Vector2<f64>>) {}
    fn pair<V: Lane, K: Kernel>(&self, _: &Pair<V, K>, (): &mut ()) {}
    fn finish(&self, own: &Common, (): ()) -> WallState {
        WallState { density: own.density, velocity: Vector2::zeros() }
    }
}

/// The sum of an extrapolation over the fluid.
pub(crate) struct Extrapolated<'a, E> {
    pub by: &'a E,
    /// From each wall particle to its foot \[m\]; empty if the sums do not need it.
    pub feet: &'a [Vector2<f64>],
    /// Number of the first wall particle.
    pub first: usize,
}

impl<S, E: Extrapolation> PairSum<S, WallState> for Extrapolated<'_, E> {
    type Derived = E::Foot;
    type Sum = E::Sum;
    const IS_EMPTY: bool = E::IS_EMPTY;

    #[inline(always)]
    fn read(&self, number: usize, _: &S) -> E::Foot {
        // Numbers of fluid are below the numbers of walls, and numbers of images above: neither has feet.
        E::foot(self.feet.get(number.wrapping_sub(self.first)))
    }

    #[inline(always)]
    fn add<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, E::Foot>, sum: &mut In<E::Sum, V>) {
        self.by.pair(pair, sum);
    }

    #[inline(always)]
    fn result(&self, own: &SweptParticle<S>, sum: E::Sum) -> WallState {
        self.by.finish(&own.common, sum)
    }
}

/// No walls.
#[derive(Clone, Copy, Debug, Default)]
pub struct Open;

impl<X> Walls<X> for Open {
    type Terms = ();
    type Extrapolation = ();
    fn terms(&self) {}
    fn extrapolation(&self) {}
}

/// Walls represented by boundary particles (section 4.2 of the paper), which do not move: a layer of
/// [`crate::Role::Interface`] on the surface, with constant density and pressure, and layers of
/// [`crate::Role::Wall`] behind it, whose density and pressure evolve by (3) and (7). All carry the velocity
/// of the wall.
#[derive(Clone, Copy, Debug, Default)]
pub struct InterfaceWall;

impl<X> Walls<X> for InterfaceWall {
    type Terms = Continuity;
    type Extrapolation = ();
    fn terms(&self) -> Continuity {
        Continuity
    }
    fn extrapolation(&self) {}
}
