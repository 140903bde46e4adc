//! Settings of the total Lagrangian solid.

use touchstone_base::settings::{self, Values};
use touchstone_schemes::total::H_OVER_DX;

use super::leave_out;

pub use touchstone_schemes::total::{bending, displace, limit_in_contact};

/// The variant.
pub const LAGRANGIAN: &str = "lagrangian";
/// Its description.
pub const TOTAL: &str = "total Lagrangian: neighbours of the reference configuration, forces from the stored \
    energy of Hencky, contact between bodies, velocity Verlet: which error is left without dissipation?";

/// The usual Courant number dt (c_p + V)/h: about three quarters of the limit.
const COURANT: f64 = 0.8;

/// The Courant number of bodies that are folded: with it the step is 0.4 of the limit without stress, and
/// stable in matter of 2.5 times the density.
pub const COURANT_OF_FOLDS: f64 = 0.4;

/// Sets the support of the method, and the strengths of terms that it lacks to 0.
pub fn choose(settings: &mut dyn Values) {
    leave_out(settings, &["alpha", "beta", "xi", "xsph"]);
    for (name, value) in [("h_over_dx", H_OVER_DX), ("courant", COURANT)] {
        let _is_in_range = settings::set(settings, name, &value.to_string());
    }
}
