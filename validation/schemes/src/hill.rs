//! The flow over hills, whose body force is set while it runs.

use nalgebra::Vector2;
use touchstone_harness::method::{self, Standard};
use touchstone_solver::{
    BodyForce, ConsistentPressure, ConsistentViscosity, Continuity, CurvedNoSlip,
    ExtrapolatingWall, InterfaceWall, Pressure, Scheme, ShiftAdvection, Simulation, Stepper, Tait,
    Viscosity,
};

use crate::flow::{ConsistentDrift, Fluid, Mean, Modern, Stabilised};
use crate::{Method, methods};

/// A simulation with a body force that can be set.
pub trait Driving: Stepper<()> {
    /// Sets the body force \[m/s²\] along x.
    fn drive(&mut self, force: f64);
}

/// Forces of which one drives.
pub trait Driven {
    /// The one that does.
    fn driving(&mut self) -> &mut BodyForce;
}

impl<A, B> Driven for (A, B, BodyForce) {
    fn driving(&mut self) -> &mut BodyForce {
        &mut self.2
    }
}

impl<A, B, C> Driven for (A, B, BodyForce, C) {
    fn driving(&mut self) -> &mut BodyForce {
        &mut self.2
    }
}

impl<S: Scheme<Extra = (), Forces: Driven>> Driving for Simulation<S> {
    fn drive(&mut self, force: f64) {
        *self.terms_mut().0.driving() = BodyForce(Vector2::new(force, 0.0));
    }
}

/// A method whose force can be set.
pub type HillMethod = Method<(), dyn Driving>;

fn driven<S: Standard<Extra = (), Forces: Driven>>() -> HillMethod {
    Method::with::<S>(|parts| Ok(Box::new(method::scene::<S>(parts).build()?)))
}

type Pairs = Fluid<BodyForce>;
type Carried = (Pressure<Tait>, Viscosity, BodyForce, ShiftAdvection);
type Consistent = (ConsistentPressure<Tait>, ConsistentViscosity, BodyForce, ShiftAdvection);
/// Wall particles include the curvature of the velocity across the wall.
type Curved = ExtrapolatingWall<Tait, CurvedNoSlip>;

methods! { driven => HillMethod:
    /// Without a stabiliser.
    plain: Modern<Pairs, Continuity, Mean>;
    /// `modern` with interface and wall particles.
    interface_wall: Modern<Pairs, Stabilised, InterfaceWall>;
    /// With [`Stabilised`].
    modern: Modern<Pairs, Stabilised, Mean>;
    /// Where shifting carries the velocity of the new place, and walls include the curvature of the velocity.
    carried: Modern<Carried, Stabilised, Curved>;
    /// `carried` with sums that are exact for linear fields.
    consistent: Modern<Consistent, ConsistentDrift, Curved>;
}
