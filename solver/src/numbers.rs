//! [`Numbers`]: a fixed set of numbers that a term needs per particle, and its counterpart in lanes.
//!
//! The derived data that neighbours read, the sums over neighbours, and the extra fields that a term
//! integrates are all such sets: `()`, one number, a vector, a symmetric tensor, or tuples of these.
//! `()` takes no memory and no time, so a scene pays nothing for what it does not need.

use nalgebra::Vector2;

use lanes::{Lane, gather_vector};

/// A fixed set of numbers.
pub trait Numbers: Copy + Default + PartialEq + Send + Sync + std::fmt::Debug + 'static {
    /// The same set with a lane in place of each number.
    type In<V: Lane>: Copy;

    /// One set a lane, side by side.
    fn gather<V: Lane>(read: impl Fn(usize) -> Self) -> Self::In<V>;
    /// The same set in every lane.
    fn spread<V: Lane>(self) -> Self::In<V>;
    /// The set of one lane.
    fn lane<V: Lane>(lanes: Self::In<V>, k: usize) -> Self;
    /// self + dt rate.
    fn advanced(self, dt: f64, rate: Self) -> Self;
    /// Whether every number is finite.
    fn is_finite(&self) -> bool;
}

impl Numbers for f64 {
    type In<V: Lane> = V;

    #[inline(always)]
    fn gather<V: Lane>(read: impl Fn(usize) -> Self) -> V {
        V::gather(read)
    }
    #[inline(always)]
    fn spread<V: Lane>(self) -> V {
        V::all(self)
    }
    #[inline(always)]
    fn lane<V: Lane>(lanes: V, k: usize) -> Self {
        lanes.lane(k)
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

/// Implements [`Numbers`] for a struct of numbers, field by field.
macro_rules! fields_of_numbers {
    ($Struct:ident ($($field:ident),+), gather($read:ident) = $gather:expr) => {
        impl Numbers for $Struct<f64> {
            type In<V: Lane> = $Struct<V>;

            #[inline(always)]
            fn gather<V: Lane>($read: impl Fn(usize) -> Self) -> $Struct<V> {
                $gather
            }
            #[inline(always)]
            fn spread<V: Lane>(self) -> $Struct<V> {
                $Struct::new($(V::all(self.$field)),+)
            }
            #[inline(always)]
            fn lane<V: Lane>(lanes: $Struct<V>, k: usize) -> Self {
                $Struct::new($(lanes.$field.lane(k)),+)
            }
            #[inline(always)]
            fn advanced(self, dt: f64, rate: Self) -> Self {
                self + rate * dt
            }
            #[inline(always)]
            fn is_finite(&self) -> bool {
                true $(&& self.$field.is_finite())+
            }
        }
    };
}

fields_of_numbers! { Vector2 (x, y), gather(read) = gather_vector(read) }

/// A symmetric tensor of the plane: three numbers, not four.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)] // xx and yy side by side
pub struct Symmetric<V = f64> {
    /// Along x.
    pub xx: V,
    /// Along y.
    pub yy: V,
    /// Shear.
    pub xy: V,
}

impl<V: Lane> Symmetric<V> {
    /// The three numbers.
    #[inline(always)]
    pub fn new(xx: V, yy: V, xy: V) -> Self {
        Self { xx, yy, xy }
    }

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

fields_of_numbers! {
    Symmetric (xx, yy, xy), gather(read) = {
        let [xx, yy] = V::gather_pair(|k| [read(k).xx, read(k).yy]);
        Symmetric { xx, yy, xy: V::gather(|k| read(k).xy) }
    }
}

/// Implements [`Numbers`] for a tuple, member by member.
macro_rules! tuple_of_numbers {
    ($($member:ident $index:tt),*) => {
        #[allow(unused_variables, clippy::unused_unit)] // of the empty tuple
        impl<$($member: Numbers),*> Numbers for ($($member,)*) {
            type In<V: Lane> = ($($member::In<V>,)*);

            #[inline(always)]
            fn gather<V: Lane>(read: impl Fn(usize) -> Self) -> Self::In<V> {
                ($($member::gather(|k| read(k).$index),)*)
            }
            #[inline(always)]
            fn spread<V: Lane>(self) -> Self::In<V> {
                ($(self.$index.spread(),)*)
            }
            #[inline(always)]
            fn lane<V: Lane>(lanes: Self::In<V>, k: usize) -> Self {
                ($($member::lane::<V>(lanes.$index, k),)*)
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
