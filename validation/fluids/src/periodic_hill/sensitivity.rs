//! Errors of constants that the gates of the flow over hills must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
    studies::causes::{ENOUGH_OR_IDLE, NOT_MEASURED, SAFETY_MARGIN, STEP, WIDE_BOUNDS},
};

use super::{NAME, plan::best};

const BOUNDS: &str = "At ten spacings a hill, the error of the method takes up most of the bounds on \
                      reattachment and force. A viscosity that is wrong by 10 % moves the force beyond its \
                      bound.";
const CONTROLLED: &str =
    "A controller sets the force that keeps the flux, whatever force it begins with.";
const STRESS: &str = "Velocity and force per mass do not depend on the density, and no gate judges a stress \
                      in Pa. A density that is wrong by 30 % is detected, because it is outside the bounds \
                      beyond which a run ends.";
const SOUND: &str = "The reference is incompressible, and compressibility changes the velocity by less than \
                     the spacing does.";
const REACH: &str = "Sums over neighbours hold for any reach of the kernel, and the error that a longer \
                     reach adds is inside the bounds at ten spacings a hill.";
const DISORDER: &str = "The term keeps particles evenly spread, and does so with 30 % less or more of it as \
                        well. Without shifting the run fails.";

/// The cheapest judged run: the coarsest one at Re 10.
pub fn sensitivity(tier: Tier) -> Sensitivity {
    let watched = [
        Watched::blind_up_to(Constant::Viscosity, 0.1, BOUNDS, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::BodyForce, 1.0, CONTROLLED, &NOT_MEASURED),
        Watched::new(Constant::Height),
        Watched::blind_up_to(Constant::Density, 0.3, STRESS, &NOT_MEASURED),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, SOUND, &NOT_MEASURED),
        Watched::new(Constant::Normalisation),
        Watched::blind_up_to(Constant::SmoothingLength, 1.0, REACH, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP, &SAFETY_MARGIN),
        Watched::blind_up_to(Constant::DensityDiffusion, 1.0, DISORDER, &ENOUGH_OR_IDLE),
        Watched::blind_up_to(Constant::Shifting, 1.0, DISORDER, &ENOUGH_OR_IDLE).faults(&[0.0]),
    ];
    let run = best(Tier::Full, 10.0).into_iter().take(1).map(|run| run.spec());
    Sensitivity::new(NAME, tier, run, watched)
}
