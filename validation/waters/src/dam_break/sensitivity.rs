//! Errors of constants that the gates of the dam break must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
};

use super::{DAM_BREAK, NAME};

const GRAVITY: &str = "the experiment and other codes fix the front at a given time to about 0.1 a, and \
                       the front comes 1.5 % earlier with 3 % more gravity; water at rest (`hydrostatic`) \
                       detects 3 % by its exact pressure";
const DENSITY: &str = "times and lengths of a collapse do not depend on the density; water at rest \
                       (`hydrostatic`) detects 0.1 % by its exact pressure";
const SOUND: &str = "the model holds for any sound speed that is large against the speed of the water, so \
                     what is compared with the experiment must not depend on it";
const SUMS: &str = "a factor of all sums multiplies the pressure as another sound speed would, on which \
                    the collapse does not depend";
const STEP: &str = "the time step is limited by stability, and its part of the error is far below that of \
                    the spacing: see the error budget";
const FRONT: &str = "an error of 10 % moves the front by less than the 0.1 a to which the experiment fixes \
                     it; the ablation shows how much each part of the method moves it";
const PRESSURE: &str =
    "density diffusion smooths the pressure, which is not judged in this experiment";

/// The coarsest judged column, released freely.
pub fn sensitivity(tier: Tier) -> Sensitivity {
    let watched = [
        Watched::blind_up_to(Constant::BodyForce, 0.2, GRAVITY),
        Watched::new(Constant::Height).quick(),
        Watched::blind_up_to(Constant::Density, 1.0, DENSITY),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, SOUND),
        Watched::blind_up_to(Constant::Normalisation, 0.2, SUMS),
        Watched::new(Constant::SmoothingLength),
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP),
        Watched::blind_up_to(Constant::ArtificialViscosity, 1.0, FRONT),
        Watched::blind_up_to(Constant::DensityDiffusion, 1.0, PRESSURE).faults(&[-1.0]),
        Watched::blind_up_to(Constant::ArtificialStress, 1.0, FRONT),
        Watched::blind_up_to(Constant::Xsph, 1.0, FRONT).faults(&[-1.0]),
    ];
    let runs = ["modern", "seed"].map(|variant| DAM_BREAK.spec(variant, |s| s.n = 20));
    Sensitivity::new(NAME, tier, runs, watched)
}
