//! Terms: the pair sums of the equations, one file each.
//!
//! A term is written once, generic over the lane: the type for one pair or for several at a time. A physics
//! contains tuples of terms. The empty tuple `()` costs nothing, and a term in no tuple is not in the
//! program. The pair sweep in `sweep.rs` uses terms only through the trait [`Term`].

mod acoustic_damper;
mod artificial_stress;
mod artificial_viscosity;
mod body_force;
mod cauchy_stress;
mod consistent_fluid;
mod consistent_solid;
mod continuity;
mod density_diffusion;
mod fluid_pairs;
mod jaumann_rate;
pub mod moments;
mod pressure;
mod shift_advection;
mod shifting;
mod slip_at_walls;
mod split;
mod tensile_stress;
mod viscosity;
mod xsph;

pub use acoustic_damper::AcousticDamper;
pub(crate) use acoustic_damper::Divergence;
pub use artificial_stress::{ArtificialStress, Tensile};
pub use artificial_viscosity::ArtificialViscosity;
pub use body_force::BodyForce;
pub use cauchy_stress::CauchyStress;
pub use consistent_fluid::{ConsistentContinuity, ConsistentPressure, ConsistentViscosity};
pub use consistent_solid::{ConjugateStress, ConsistentJaumannRate};
pub use continuity::Continuity;
pub use density_diffusion::{DensityDiffusion, Hydrostatic, Rest};
pub use fluid_pairs::FluidPairs;
pub use jaumann_rate::JaumannRate;
pub use pressure::Pressure;
pub use shift_advection::ShiftAdvection;
pub use shifting::Shifting;
pub use slip_at_walls::SlipAtWalls;
pub use split::Split;
pub use tensile_stress::{
    Axes, ComponentStress, Componentwise, InTension, Principal, PrincipalStress,
};
pub use viscosity::Viscosity;
pub use xsph::Xsph;

use crate::lane::Lane;
use nalgebra::Vector2;

// Each file takes the types with which terms are written from here.
use crate::{
    eos::EquationOfState,
    kernel::{Kernel, Smoothing},
    numbers::{In, Numbers, Symmetric},
    particles::{Common, Rate, SweptParticle},
};

/// Particles i, one a lane, and a neighbour j of each (one neighbour for all lanes in a pair sweep), with the
/// derived data `D` of a term.
pub struct Pair<'k, V: Lane, K, D: Numbers = ()> {
    /// rᵢⱼ = rᵢ − rⱼ \[m\].
    pub r: Vector2<V>,
    /// |rᵢⱼ|² \[m²\].
    pub r2: V,
    /// vᵢⱼ = vᵢ − vⱼ \[m/s\].
    pub v: Vector2<V>,
    /// F(|rᵢⱼ|), so that ∇ᵢWᵢⱼ = −F rᵢⱼ \[1/m⁴\].
    pub f: V,
    /// The particles i.
    pub own: Common<V>,
    /// The neighbours j.
    pub other: Common<V>,
    /// Derived data of the particles i and of the neighbours j.
    pub derived: [In<D, V>; 2],
    /// The kernel, for terms that need W itself.
    pub kernel: &'k Smoothing<K>,
}

impl<'k, V: Lane, K: Kernel, D: Numbers> Pair<'k, V, K, D> {
    /// These particles with the derived data of another term.
    #[inline(always)]
    pub fn with<E: Numbers>(&self, derived: [In<E, V>; 2]) -> Pair<'k, V, K, E> {
        let Self { r, r2, v, f, own, other, kernel, .. } = *self;
        Pair { r, r2, v, f, own, other, derived, kernel }
    }

    /// W(|rᵢⱼ|) \[1/m²\].
    #[inline(always)]
    pub fn w(&self) -> V {
        self.kernel.w(self.r2)
    }

    /// vᵢⱼ·rᵢⱼ \[m²/s\], negative where the two approach each other.
    #[inline(always)]
    pub fn v_dot_r(&self) -> V {
        self.v.x * self.r.x + self.v.y * self.r.y
    }
}

/// One term of the equations. `X` holds the extra fields that a particle integrates in addition to x, v and
/// ρ.
pub trait Term<X>: Clone + Send + Sync + 'static {
    /// The derived data of a particle that its neighbours read for this term.
    type Derived: Numbers;
    /// Sums of a particle over its neighbours.
    type Sum: Numbers;
    /// Whether this is the empty tuple, so that no pair sweep is needed.
    const IS_EMPTY: bool = false;
    /// Whether [`Term::set_inverse`] is read, for which each sweep of forces needs a sweep of moments before.
    const NORMALISES: bool = false;
    /// Whether [`Term::set_divergence`] is read, for which each sweep of forces needs a sweep of divergences
    /// before.
    const DIVERGES: bool = false;
    /// Whether [`Term::set_slip`] is read, for which the walls must be mirror particles.
    const SLIPS: bool = false;

    /// Receives the largest speed of the scene \[m/s\], before each step.
    fn prepare(&mut self, _max_speed: f64) {}
    /// Computes the derived data [`Term::Derived`]. A term without any need not implement this.
    #[inline(always)]
    fn derived(&self, _own: &Common, _extra: &X) -> Self::Derived {
        const { assert!(size_of::<Self::Derived>() == 0, "a term with derived numbers derives them") };
        Self::Derived::default()
    }
    /// Changes the derived data of a boundary particle.
    #[inline(always)]
    fn set_on_boundary(_derived: &mut Self::Derived) {}
    /// Stores the velocity of a mirror particle of [`crate::SlipGhosts`] minus the velocity of this mirror
    /// particle \[m/s\].
    #[inline(always)]
    fn set_slip(_derived: &mut Self::Derived, _difference: Vector2<f64>) {}
    /// Stores the inverse of the [`moments`] of the particle in its derived data.
    #[inline(always)]
    fn set_inverse(_derived: &mut Self::Derived, _inverse: Symmetric) {}
    /// Stores the divergence of the velocity at the particle \[1/s\] in its derived data.
    #[inline(always)]
    fn set_divergence(_derived: &mut Self::Derived, _own: &Common, _divergence: f64) {}
    /// Adds the contributions of the neighbours j of `pair` to the sums.
    fn pair<V: Lane, K: Kernel>(
        &self,
        pair: &Pair<V, K, Self::Derived>,
        sum: &mut In<Self::Sum, V>,
    );
    /// Adds the rates that follow from the sum to `rate`.
    fn finish(&self, own: &Common, derived: Self::Derived, sum: Self::Sum, rate: &mut Rate<X>);
    /// Adds rates that depend on the position of a particle \[m\], such as a force field.
    #[inline(always)]
    fn place(&self, _position: Vector2<f64>, _rate: &mut Rate<X>) {}
}

/// A sum over the neighbours of a particle and its result `O`: rates, the state of a wall particle, or
/// inverse moments. `S` is the derived data of a column.
pub(crate) trait PairSum<S, O>: Sync {
    /// The part of the derived data that the sum reads.
    type Derived: Numbers;
    /// The sums.
    type Sum: Numbers;
    /// Whether there is nothing to sum.
    const IS_EMPTY: bool = false;

    /// The derived data that the sum reads of column `number`.
    fn read(&self, number: usize, derived: &S) -> Self::Derived;
    /// Adds the contributions of the neighbours j of `pair`.
    fn add<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>, sum: &mut In<Self::Sum, V>);
    /// The result for a particle.
    fn result(&self, own: &SweptParticle<S>, sum: Self::Sum) -> O;
}

/// The sum of terms of which each column has the derived data `read(S)`, in rates.
pub(crate) struct Rates<'a, T, R> {
    pub terms: &'a T,
    pub read: R,
    /// Whether dx/dt includes v.
    pub moving: bool,
}

impl<S, X: Numbers, T: Term<X>, R: Fn(&S) -> T::Derived + Sync> PairSum<S, Rate<X>>
    for Rates<'_, T, R>
{
    type Derived = T::Derived;
    type Sum = T::Sum;
    const IS_EMPTY: bool = T::IS_EMPTY;

    #[inline(always)]
    fn read(&self, _: usize, derived: &S) -> T::Derived {
        (self.read)(derived)
    }

    #[inline(always)]
    fn add<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, T::Derived>, sum: &mut In<T::Sum, V>) {
        self.terms.pair(pair, sum);
    }

    #[inline(always)]
    fn result(&self, own: &SweptParticle<S>, sum: T::Sum) -> Rate<X> {
        let mut rate = Rate::default();
        if self.moving {
            rate.position = own.velocity;
        }
        self.terms.finish(&own.common, (self.read)(&own.derived), sum, &mut rate);
        self.terms.place(own.position, &mut rate);
        rate
    }
}

/// Implements [`Term`] for a tuple: each member in turn, in the order of the equation.
macro_rules! tuple_of_terms {
    ($Tuple:ty: $($member:ident $index:tt),*) => {
        #[allow(unused_variables, clippy::unused_unit)] // of the empty tuple
        impl<X, $($member: Term<X>),*> Term<X> for $Tuple {
            type Derived = ($($member::Derived,)*);
            type Sum = ($($member::Sum,)*);
            const IS_EMPTY: bool = true $(&& $member::IS_EMPTY)*;
            const NORMALISES: bool = false $(|| $member::NORMALISES)*;
            const DIVERGES: bool = false $(|| $member::DIVERGES)*;
            const SLIPS: bool = false $(|| $member::SLIPS)*;

            fn prepare(&mut self, max_speed: f64) {
                $(self.$index.prepare(max_speed);)*
            }
            #[inline(always)]
            fn derived(&self, own: &Common, extra: &X) -> Self::Derived {
                ($(self.$index.derived(own, extra),)*)
            }
            #[inline(always)]
            fn set_on_boundary(derived: &mut Self::Derived) {
                $($member::set_on_boundary(&mut derived.$index);)*
            }
            #[inline(always)]
            fn set_slip(derived: &mut Self::Derived, difference: Vector2<f64>) {
                $($member::set_slip(&mut derived.$index, difference);)*
            }
            #[inline(always)]
            fn set_inverse(derived: &mut Self::Derived, inverse: Symmetric) {
                $($member::set_inverse(&mut derived.$index, inverse);)*
            }
            #[inline(always)]
            fn set_divergence(derived: &mut Self::Derived, own: &Common, divergence: f64) {
                $($member::set_divergence(&mut derived.$index, own, divergence);)*
            }
            #[inline(always)]
            fn pair<V: Lane, K: Kernel>(
                &self,
                pair: &Pair<V, K, Self::Derived>,
                sum: &mut In<Self::Sum, V>,
            ) {
                let [own, other] = pair.derived;
                $(self.$index.pair(&pair.with([own.$index, other.$index]), &mut sum.$index);)*
            }
            #[inline(always)]
            fn finish(&self, own: &Common, derived: Self::Derived, sum: Self::Sum, rate: &mut Rate<X>) {
                $(self.$index.finish(own, derived.$index, sum.$index, rate);)*
            }
            #[inline(always)]
            fn place(&self, position: Vector2<f64>, rate: &mut Rate<X>) {
                $(self.$index.place(position, rate);)*
            }
        }
    };
}

tuple_of_terms!(():);
tuple_of_terms!((A,): A 0);
tuple_of_terms!((A, B): A 0, B 1);
tuple_of_terms!((A, B, C): A 0, B 1, C 2);
tuple_of_terms!((A, B, C, D): A 0, B 1, C 2, D 3);
tuple_of_terms!((A, B, C, D, E): A 0, B 1, C 2, D 3, E 4);
tuple_of_terms!((A, B, C, D, E, F): A 0, B 1, C 2, D 3, E 4, F 5);
tuple_of_terms!(Split<A, B>: A 0, B 1);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::{OnLanes, Portable, on_widest};
    use crate::{CubicSpline, QuinticSpline, Tait, WendlandC2, numbers::Buffer};

    /// Field number `field` of neighbour k of up to eight; neighbour 3 is at the place of the particle.
    fn number(field: usize, k: usize) -> f64 {
        let x = ((7 * field + 3 * k + 1) as f64 * 0.618_033_988_749_895).fract();
        match field {
            0 | 1 if k == 3 => 0.0,
            0..4 => x - 0.5,
            _ => 0.7 + 0.6 * x,
        }
    }

    fn pair<V: Lane, K: Kernel>(
        kernel: &Smoothing<K>,
        read: impl Fn(usize) -> V,
    ) -> Pair<'_, V, K> {
        let r = Vector2::new(read(0), read(1));
        let r2 = r.x * r.x + r.y * r.y;
        let common = |first| {
            let (mass, density) = (read(first), read(first + 1));
            Common { mass, density, volume: mass / density }
        };
        let (v, [own, other]) = (Vector2::new(read(2), read(3)), [4, 6].map(common));
        Pair { r, r2, v, f: kernel.f(r2), own, other, derived: [(); 2], kernel }
    }

    /// The sum of one pair, for a term that derives two numbers or fewer.
    fn sum<V: Lane, K: Kernel, T: Term<()>>(
        term: &T,
        pair: &Pair<V, K>,
        derived: impl Fn(&Common<V>) -> In<T::Derived, V>,
    ) -> In<T::Sum, V> {
        let mut sum = T::Sum::default().spread::<V>();
        term.pair(&pair.with([&pair.own, &pair.other].map(derived)), &mut sum);
        sum
    }

    /// Each lane of several neighbours at once has the bits of that neighbour alone.
    fn check<V: Lane, K: Kernel, T: Term<()>, const N: usize>(
        term: T,
        read_wide: impl Fn(In<T::Sum, V>) -> [V; N],
        read: impl Fn(In<T::Sum, f64>) -> [f64; N],
    ) {
        let kernel = Smoothing::<K>::new(0.35);
        let derived = |mass: f64, density: f64| {
            term.derived(&Common { mass, density, volume: mass / density }, &())
        };
        let wide = pair(&kernel, |field| V::gather(|k| number(field, k)));
        let together = read_wide(sum(&term, &wide, |c| {
            let mut all = T::Derived::default().spread::<Buffer>();
            (0..V::LANES).for_each(|k| derived(c.mass.lane(k), c.density.lane(k)).put(&mut all, k));
            T::Derived::load::<V>(&all, 0)
        }));
        let mut nonzero = 0;
        for k in 0..V::LANES {
            let one = pair(&kernel, |field| number(field, k));
            let alone = read(sum(&term, &one, |c| derived(c.mass, c.density).spread::<f64>()));
            for (together, alone) in together.iter().zip(alone) {
                let lane = together.lane(k);
                let term = std::any::type_name::<T>();
                assert!(lane == alone && alone.is_finite(), "{term}: {lane:e} {alone:e}");
                nonzero += u32::from(alone != 0.0);
            }
        }
        assert!(nonzero > 0, "zeros show nothing");
    }

    fn check_vector<V: Lane, K: Kernel>(term: impl Term<(), Sum = Vector2<f64>>) {
        check::<V, K, _, 2>(term, |s| [s.x, s.y], |s| [s.x, s.y]);
    }

    fn check_number<V: Lane, K: Kernel>(term: impl Term<(), Sum = f64>) {
        check::<V, K, _, 1>(term, |s| [s], |s| [s]);
    }

    fn check_every_term<V: Lane, K: Kernel>() {
        let eos = Tait { background: 0.2, ..Tait::new(1.0, 3.0) };
        let (eta2, w) = (1e-4, 2.0);
        check_vector::<V, K>(Pressure::new(eos));
        check_vector::<V, K>(Pressure { eos, tensile: ArtificialStress::new(0.3, 4, w) });
        check_vector::<V, K>(Viscosity { mu: 0.3, eta2 });
        check_vector::<V, K>(ArtificialViscosity::<_, false>::new(0.3, 0.7, 0.35, eos));
        check_vector::<V, K>(ArtificialViscosity::<_, true>::new(0.3, 0.7, 0.35, eos));
        check_vector::<V, K>(Xsph { epsilon: 0.5 });
        check_vector::<V, K>(Shifting::new(0.5, 0.35, w));
        check_number::<V, K>(Continuity);
        check_number::<V, K>(DensityDiffusion::new(0.1));
        let rest = Hydrostatic { eos, gravity: Vector2::new(0.3, -0.2) };
        check_number::<V, K>(DensityDiffusion { diffusivity: 0.1, rest });
    }

    /// A term that reads both W and F.
    fn check_kernel<V: Lane, K: Kernel>() {
        let (eos, tensile) = (Tait::new(1.0, 3.0), ArtificialStress::new(0.3, 4, 2.0));
        check_vector::<V, K>(Pressure { eos, tensile });
    }

    struct Every;

    impl OnLanes for Every {
        fn run<V: Lane>(self) {
            check_every_term::<V, CubicSpline>();
            check_kernel::<V, QuinticSpline>();
            check_kernel::<V, WendlandC2>();
        }
    }

    #[test]
    fn lanes_have_the_bits_of_scalars() {
        Every.run::<Portable>();
        on_widest(Every);
    }
}
