//! The step from which super-time-stepping counts its stages, by hand.

use touchstone_solver::{
    Compose, Continuity, Leapfrog, Open, Pressure, Split, SuperSteps, Tait, Viscosity, WendlandC2,
};

use crate::method::{FromMedium, Medium, Method};

type Forces = Split<Pressure<Tait>, Viscosity>;
type Scheme = Compose<WendlandC2, Forces, Continuity, Open, Leapfrog<SuperSteps>>;

/// With Wendland's kernel and h = dx the largest eigenvalue on the lattice is 35/(2π) ν/h², so the step
/// of forward Euler, with 10 % for disorder, is 0.3264 h²/ν. A limit that is 5 % longer passed every
/// test but snapshots: super-time-stepping takes fewer stages then, and at some steps one pair of them
/// too few.
#[test]
fn the_step_from_which_super_time_stepping_counts_its_stages_is_that_of_forward_euler() {
    let method = <Method>::with::<Scheme>(|_| unreachable!("no scene is built"));
    let (h, nu) = (0.05, 2e-3);
    let medium = Medium { nu, ..method.properties.medium(Tait::new(1.0, 1.0), h, h) };
    let by_hand = 2.0 / (1.1 * 35.0 / (2.0 * std::f64::consts::PI)) * h * h / nu;
    let Split(_, _, of_scheme) = Forces::new(&medium);
    for (limit, of) in [(medium.explicit_limit(), "medium"), (of_scheme, "scheme")] {
        let apart = (limit / by_hand - 1.0).abs();
        assert!(apart < 1e-12, "the limit of the {of} is {limit} s, by hand it is {by_hand} s");
    }
    // Three stages allow (3² + 3 - 2)/4 = 2.5 of these steps, five 7, and a sweep more for all forces.
    let limits = method.properties.limits_in(&medium, 1.0, 16);
    for (ratio, sweeps) in [(2.49, 4.0), (2.51, 6.0), (6.99, 6.0), (7.01, 8.0)] {
        assert_eq!(limits.sweeps(ratio * by_hand), sweeps, "sweeps of a step of {ratio} limits");
    }
}
