//! The schemes of the cases, a line of types each, and the code that needs these types.
//!
//! A scheme is a type, and everything that steps it is compiled for this type, which takes most of the time
//! of a build. This crate compiles each scheme once and returns it as a [`Method`] without its type. So a
//! change of a case or of its tests compiles no scheme again. Names, descriptions and settings of variants
//! belong to the cases.

pub mod bench;
pub mod flow;
pub mod hill;
pub mod lattice;
pub mod solid;
pub mod total;
pub mod water;

use touchstone_harness::method::{Method, Standard};

/// The method of a scheme of which cases need no more than that it steps.
fn stepped<S: Standard>() -> Method<S::Extra> {
    Method::of::<S>()
}

/// Declares functions that return methods, each by the given generic function of the types of the scheme.
macro_rules! methods {
    ($of:ident => $Method:ty: $($(#[doc = $doc:literal])+ $name:ident: $($Scheme:ty),+;)+) => {$(
        $(#[doc = $doc])+
        #[inline(never)] // it would be compiled anew where it is called
        pub fn $name() -> $Method {
            $of::<$($Scheme),+>()
        }
    )+};
}
use methods;
