//! Physics: kernel, terms and walls of a scene as one type, without the time integration.

use std::marker::PhantomData;

use crate::{kernel::Kernel, numbers::Numbers, particles::State, terms::Term, walls::Walls};

/// The right-hand side of d(x, v, ρ, …)/dt as types. Schemes that differ only in their integrator have one
/// physics and share its compiled code.
pub trait Physics: Sized + 'static {
    /// Fields that a particle integrates beyond x, v and ρ; `()` for a fluid.
    type Extra: Numbers;
    /// Smoothing kernel.
    type Kernel: Kernel;
    /// Terms of dv/dt.
    type Forces: Term<Self::Extra>;
    /// Terms of dx/dt (beyond v), dρ/dt and the extra fields.
    type Drift: Term<Self::Extra>;
    /// Wall representation.
    type Walls: Walls<Self::Extra>;
}

/// The whole method as one line of types, `Compose<Kernel, Forces, Drift, Walls, Integrator>`. A term that is
/// not named here is not in the program. The physics does not depend on the integrator `I`; with `I` = `()`
/// the type is a physics and not a scheme.
#[derive(Debug)]
pub struct Compose<K, F, D, W, I = (), X = ()>(PhantomData<(K, F, D, W, I, X)>);

impl<K: Kernel, F: Term<X>, D: Term<X>, W: Walls<X>, I: 'static, X: Numbers> Physics
    for Compose<K, F, D, W, I, X>
{
    type Extra = X;
    type Kernel = K;
    type Forces = F;
    type Drift = D;
    type Walls = W;
}

/// The particles of the physics `P` as the integrator advances them.
pub type Particles<P> = [State<<P as Physics>::Extra>];

/// The derived data of a particle in the physics `P`: of the forces and of the drift.
pub type Derived<P> =
    <(<P as Physics>::Forces, <P as Physics>::Drift) as Term<<P as Physics>::Extra>>::Derived;
