//! Errors of constants that the gates of the dam break must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
    studies::causes::{NOT_MEASURED, SAFETY_MARGIN, STEP, WIDE_BOUNDS},
};

use super::{DAM_BREAK, NAME};

const DENSITY: &str = "Times and lengths of a collapse do not depend on the density. Water at rest \
                       (`hydrostatic`) detects 0.1 % by its exact pressure.";
const SOUND: &str = "The model holds for any sound speed that is large compared with the speed of the water, \
                     so what is compared with the experiment must not depend on it.";
const FRONT: &str = "An error of 10 % moves the front by less than 0.1 a, to which the experiment fixes it, \
                     a being the width of the column. The ablation shows how much each part of the method \
                     moves it.";
const PRESSURE: &str =
    "Density diffusion smooths the pressure, which is not judged in this experiment.";

/// The coarsest judged column, released freely.
pub fn sensitivity(tier: Tier) -> Sensitivity {
    let watched = [
        Watched::new(Constant::BodyForce),
        Watched::new(Constant::Height).quick(),
        Watched::blind_up_to(Constant::Density, 1.0, DENSITY, &NOT_MEASURED),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, SOUND, &NOT_MEASURED),
        Watched::new(Constant::Normalisation),
        Watched::new(Constant::SmoothingLength),
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP, &SAFETY_MARGIN),
        Watched::blind_up_to(Constant::ArtificialViscosity, 1.0, FRONT, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::DensityDiffusion, 1.0, PRESSURE, &NOT_MEASURED)
            .faults(&[-1.0]),
        Watched::blind_up_to(Constant::ArtificialStress, 1.0, FRONT, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::Xsph, 1.0, FRONT, &WIDE_BOUNDS).faults(&[-1.0]),
    ];
    let runs = ["modern", "seed"].map(|variant| DAM_BREAK.spec(variant, |s| s.n = 20));
    Sensitivity::new(NAME, tier, runs, watched)
}
