//! [`Numbers`]: a fixed set of numbers that a term needs per particle, and its counterpart in lanes.
//!
//! The derived data that neighbours read, the sums over neighbours, and the extra fields that a term
//! integrates are all such sets: `()`, one number, a vector, a symmetric tensor, or tuples of these.
//! `()` takes no memory and no time, so a scene pays nothing for what it does not need.

use nalgebra::Vector2;

use crate::lane::{Lane, PerParticle};

/// Particles whose numbers and rates are buffered: few enough to stay in the nearest cache.
pub const MANY: usize = 64;
/// A number for each of them.
pub type Buffer = [f64; MANY];

/// A fixed set of numbers.
pub trait Numbers: Copy + Default + PartialEq + Send + Sync + std::fmt::Debug + 'static {
    /// This set with a lane, or with the numbers of many particles, in place of each number.
    type In<V: PerParticle>: Copy;

    /// Copies of this set for each lane or particle.
    fn spread<V: PerParticle>(self) -> Self::In<V>;
    /// The sets from number `from` on, one a lane.
    fn load<V: Lane>(many: &Self::In<Buffer>, from: usize) -> Self::In<V>;
    /// Writes the sets of the lanes from number `from` on.
    fn store<V: Lane>(lanes: Self::In<V>, many: &mut Self::In<Buffer>, from: usize);
    /// The set of a single lane.
    fn one(lane: Self::In<f64>) -> Self;
    /// self + dt rate.
    fn advanced(self, dt: f64, rate: Self) -> Self;
    /// Whether every number is finite.
    fn is_finite(&self) -> bool;
    /// The deviatoric stress of a solid particle with these extra fields \[Pa\]; `None` for a fluid.
    fn stress(&self) -> Option<Symmetric> {
        None
    }
    /// Extra fields of a solid particle with this deviatoric stress \[Pa\]; the default for a fluid.
    fn of_stress(_: Symmetric) -> Self {
        Self::default()
    }

    /// Writes set number `k`.
    #[inline(always)]
    fn put(self, many: &mut Self::In<Buffer>, k: usize) {
        Self::store::<f64>(self.spread(), many, k);
    }
    /// Set number `k`.
    #[inline(always)]
    fn take(many: &Self::In<Buffer>, k: usize) -> Self {
        Self::one(Self::load::<f64>(many, k))
    }
}

impl Numbers for f64 {
    type In<V: PerParticle> = V;

    #[inline(always)]
    fn spread<V: PerParticle>(self) -> V {
        V::all(self)
    }
    #[inline(always)]
    fn load<V: Lane>(many: &Buffer, from: usize) -> V {
        V::load(&many[from..])
    }
    #[inline(always)]
    fn store<V: Lane>(lanes: V, many: &mut Buffer, from: usize) {
        lanes.store(&mut many[from..]);
    }
    #[inline(always)]
    fn one(lane: f64) -> Self {
        lane
    }
    #[inline(always)]
    fn advanced(self, dt: f64, rate: Self) -> Self {
        self + dt * rate
    }
    #[inline(always)]
    fn is_finite(&self) -> bool {
        f64::is_finite(*self)
    }
}

/// The numbers of a set with a lane in place of each.
pub type In<N, V> = <N as Numbers>::In<V>;

impl Numbers for Vector2<f64> {
    type In<V: PerParticle> = Vector2<V>;

    #[inline(always)]
    fn spread<V: PerParticle>(self) -> Vector2<V> {
        Vector2::new(V::all(self.x), V::all(self.y))
    }
    #[inline(always)]
    fn load<V: Lane>(many: &Vector2<Buffer>, from: usize) -> Vector2<V> {
        Vector2::new(V::load(&many.x[from..]), V::load(&many.y[from..]))
    }
    #[inline(always)]
    fn store<V: Lane>(lanes: Vector2<V>, many: &mut Vector2<Buffer>, from: usize) {
        lanes.x.store(&mut many.x[from..]);
        lanes.y.store(&mut many.y[from..]);
    }
    #[inline(always)]
    fn one(lane: Self) -> Self {
        lane
    }
    #[inline(always)]
    fn advanced(self, dt: f64, rate: Self) -> Self {
        self + rate * dt
    }
    #[inline(always)]
    fn is_finite(&self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

/// A symmetric tensor of the plane: three numbers, not four.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Symmetric<V = f64> {
    /// Along x.
    pub xx: V,
    /// Along y.
    pub yy: V,
    /// Shear.
    pub xy: V,
}

impl<V> Symmetric<V> {
    /// The three numbers.
    #[inline(always)]
    pub fn new(xx: V, yy: V, xy: V) -> Self {
        Self { xx, yy, xy }
    }

    /// xx, yy and xy.
    pub fn components(self) -> [V; 3] {
        [self.xx, self.yy, self.xy]
    }
}

impl<V: Lane> Symmetric<V> {
    /// The product with a vector.
    #[inline(always)]
    pub fn times(self, r: Vector2<V>) -> Vector2<V> {
        Vector2::new(self.xx * r.x + self.xy * r.y, self.xy * r.x + self.yy * r.y)
    }
}

impl<V: Lane> std::ops::Add for Symmetric<V> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { xx: self.xx + other.xx, yy: self.yy + other.yy, xy: self.xy + other.xy }
    }
}

impl<V: Lane> std::ops::Mul<V> for Symmetric<V> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: V) -> Self {
        Self { xx: self.xx * factor, yy: self.yy * factor, xy: self.xy * factor }
    }
}

impl Numbers for Symmetric<f64> {
    type In<V: PerParticle> = Symmetric<V>;

    #[inline(always)]
    fn spread<V: PerParticle>(self) -> Symmetric<V> {
        Symmetric::new(V::all(self.xx), V::all(self.yy), V::all(self.xy))
    }
    #[inline(always)]
    fn load<V: Lane>(many: &Symmetric<Buffer>, from: usize) -> Symmetric<V> {
        Symmetric::new(
            V::load(&many.xx[from..]),
            V::load(&many.yy[from..]),
            V::load(&many.xy[from..]),
        )
    }
    #[inline(always)]
    fn store<V: Lane>(lanes: Symmetric<V>, many: &mut Symmetric<Buffer>, from: usize) {
        lanes.xx.store(&mut many.xx[from..]);
        lanes.yy.store(&mut many.yy[from..]);
        lanes.xy.store(&mut many.xy[from..]);
    }
    #[inline(always)]
    fn one(lane: Self) -> Self {
        lane
    }
    #[inline(always)]
    fn advanced(self, dt: f64, rate: Self) -> Self {
        self + rate * dt
    }
    #[inline(always)]
    fn is_finite(&self) -> bool {
        self.xx.is_finite() && self.yy.is_finite() && self.xy.is_finite()
    }
    fn stress(&self) -> Option<Symmetric> {
        Some(*self)
    }
    fn of_stress(stress: Symmetric) -> Self {
        stress
    }
}

/// Implements [`Numbers`] for a tuple, member by member.
macro_rules! tuple_of_numbers {
    ($($member:ident $index:tt),*) => {
        #[allow(unused_variables, clippy::unused_unit)] // of the empty tuple
        impl<$($member: Numbers),*> Numbers for ($($member,)*) {
            type In<V: PerParticle> = ($($member::In<V>,)*);

            #[inline(always)]
            fn spread<V: PerParticle>(self) -> Self::In<V> {
                ($(self.$index.spread(),)*)
            }
            #[inline(always)]
            fn load<V: Lane>(many: &Self::In<Buffer>, from: usize) -> Self::In<V> {
                ($($member::load(&many.$index, from),)*)
            }
            #[inline(always)]
            fn store<V: Lane>(lanes: Self::In<V>, many: &mut Self::In<Buffer>, from: usize) {
                $($member::store(lanes.$index, &mut many.$index, from);)*
            }
            #[inline(always)]
            fn one(lane: Self::In<f64>) -> Self {
                ($($member::one(lane.$index),)*)
            }
            #[inline(always)]
            fn advanced(self, dt: f64, rate: Self) -> Self {
                ($(self.$index.advanced(dt, rate.$index),)*)
            }
            #[inline(always)]
            fn is_finite(&self) -> bool {
                true $(&& self.$index.is_finite())*
            }
        }
    };
}

tuple_of_numbers!();
tuple_of_numbers!(A 0);
tuple_of_numbers!(A 0, B 1);
tuple_of_numbers!(A 0, B 1, C 2);
tuple_of_numbers!(A 0, B 1, C 2, D 3);
tuple_of_numbers!(A 0, B 1, C 2, D 3, E 4);
tuple_of_numbers!(A 0, B 1, C 2, D 3, E 4, F 5);
