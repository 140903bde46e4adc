//! The schemes that the cases run: a line of types each, and what has to know these types.
//!
//! A scheme is a type, and all that steps it is compiled for it, which is most of what compiling takes. Here
//! it is compiled once and gets a function that gives it as a [`Method`], without its type. So a change of a
//! case, or a test of one, compiles no scheme again. What a variant is called, what it is for, and its
//! settings are said by its case.

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

/// Functions that give methods, each by this function that is generic over what names the scheme.
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
