//! Boundary particles to which pressure, and with [`NoSlip`] velocity, are extrapolated from the fluid
//! (Adami, Hu & Adams 2012).

use lanes::Lane;
use nalgebra::Vector2;

use super::Walls;
use crate::{
    eos::EquationOfState,
    kernel::Kernel,
    numbers::{In, Numbers},
    particles::{Common, Rate},
    terms::{Pair, Term},
};

/// Walls represented by layers of boundary particles, [`crate::Role::Wall`], behind the surface, the first
/// half a spacing behind it. They do not move, and no quantity of theirs is integrated. Before each sweep,
/// these quantities are extrapolated to them, only from the fluid particles f within their support:
///
/// - p_w = Σ_f \[p_f + ρ_f (g − a_w)·r_wf\] W_wf / Σ_f W_wf, and from it the density, ρ_w = ρ(p_w);
/// - with `U` = [`NoSlip`] u_w = 2 u_wall − Σ_f u_f W_wf / Σ_f W_wf, which all terms read in place of the
///   velocity of the wall particle, u_wall. With `U` = `()` the particle keeps that velocity and nothing
///   is summed, which suffices without viscosity.
///
/// A wall particle without fluid in its support keeps its initial velocity and density. The fluid
/// does not read these, because the particle is not a neighbour of any fluid particle either.
#[derive(Clone, Copy, Debug)]
pub struct ExtrapolatingWall<E, U = ()> {
    /// Gives p(ρ) and ρ(p): that of the pressure term.
    pub eos: E,
    /// g − a_w: the body force less the acceleration of the wall \[m/s²\].
    pub acceleration: Vector2<f64>,
    /// p_w is not below this \[Pa\]: 0 where there is a free surface, above which the wall would suck
    /// the fluid up; −∞ by default.
    pub least_pressure: f64,
    /// `()` or [`NoSlip`].
    pub velocity: U,
}

impl<E, U: Default> ExtrapolatingWall<E, U> {
    /// A wall under g − a_w \[m/s²\].
    pub fn new(eos: E, acceleration: Vector2<f64>) -> Self {
        Self { eos, acceleration, least_pressure: f64::NEG_INFINITY, velocity: U::default() }
    }

    /// The same wall with pressures not below this \[Pa\].
    pub fn not_below(self, least_pressure: f64) -> Self {
        Self { least_pressure, ..self }
    }
}

/// What an [`ExtrapolatingWall`] does about the velocity: `()`, nothing, or [`NoSlip`].
pub trait WallVelocity: Copy + Send + Sync + 'static {
    /// Σ (u_wall − u_f) W.
    type Sum: Numbers;
    /// Adds a fluid particle of weight `w`, with `v` = u_wall − u_f.
    fn add<V: Lane>(v: Vector2<V>, w: V, sum: &mut In<Self::Sum, V>);
    /// u_w − u_wall \[m/s\] from the sum and Σ W.
    fn beyond(sum: Self::Sum, weight: f64) -> Vector2<f64>;
}

impl WallVelocity for () {
    type Sum = ();
    #[inline(always)]
    fn add<V: Lane>(_: Vector2<V>, _: V, _: &mut ()) {}
    #[inline(always)]
    fn beyond(_: (), _: f64) -> Vector2<f64> {
        Vector2::zeros()
    }
}

/// u_w = 2 u_wall − Σ_f u_f W_wf / Σ_f W_wf.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSlip;

impl WallVelocity for NoSlip {
    type Sum = Vector2<f64>;
    #[inline(always)]
    fn add<V: Lane>(v: Vector2<V>, w: V, sum: &mut Vector2<V>) {
        *sum += v * w;
    }
    #[inline(always)]
    fn beyond(sum: Vector2<f64>, weight: f64) -> Vector2<f64> {
        sum / weight
    }
}

impl<X, E: EquationOfState, U: WallVelocity> Walls<X> for ExtrapolatingWall<E, U> {
    type Terms = Self;
    const EXTRAPOLATES: bool = true;

    fn terms(&self) -> Self {
        *self
    }
}

/// The sums over the fluid f, and from them ρ_w and u_w − u_wall in the places of their rates.
impl<X, E: EquationOfState, U: WallVelocity> Term<X> for ExtrapolatingWall<E, U> {
    type Derived = ();
    /// Σ W \[1/m²\], Σ \[p + ρ (g − a_w)·r\] W \[Pa/m²\], and what is summed of the velocity.
    type Sum = (f64, f64, U::Sum);

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(
        &self,
        pair: &Pair<V, K>,
        _: [(); 2],
        (weight, pressure, velocity): &mut In<Self::Sum, V>,
    ) {
        let (w, density) = (pair.w(), pair.other.density);
        let a = self.acceleration;
        let across = V::all(a.x) * pair.r.x + V::all(a.y) * pair.r.y;
        *weight += w;
        *pressure += (self.eos.pressure(density) + density * across) * w;
        U::add(pair.v, w, velocity);
    }

    #[inline(always)]
    fn finish(
        &self,
        own: &Common<f64>,
        _: (),
        (weight, pressure, velocity): Self::Sum,
        rate: &mut Rate<X>,
    ) {
        if weight > 0.0 {
            let pressure = (pressure / weight).max(self.least_pressure);
            rate.density = self.eos.density(pressure);
            rate.velocity = U::beyond(velocity, weight);
        } else {
            rate.density = own.density;
        }
    }
}
