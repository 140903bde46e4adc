//! Errors of constants that the gates of the flow over hills must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
};

use super::{NAME, plan::best};

const BOUNDS: &str = "at ten spacings a hill the error of the method takes most of the bounds on \
                      reattachment and force; 10 % of the viscosity moves the force beyond";
const CONTROLLED: &str =
    "a controller sets the force that keeps the flux, whatever force it begins with";
const STRESS: &str = "velocity and force per mass do not depend on the density, and no gate judges a \
                      stress in Pa; a density that is wrong by 30 % is outside the bounds beyond which a \
                      run ends";
const SOUND: &str = "the reference is incompressible, and compressibility changes the velocity by less \
                     than the spacing does";
const REACH: &str = "sums over neighbours hold for any reach of the kernel, and the error that a longer \
                     one adds is inside the bounds of ten spacings a hill";
const STEP: &str = "the time step is limited by stability, and its part of the error is far below that of \
                    the spacing: see the error budget";
const DISORDER: &str = "it keeps particles evenly spread, which 30 % less or more of it does as well; \
                        without shifting the run fails";

/// The cheapest judged run: the coarsest one at Re 10.
pub fn sensitivity(tier: Tier) -> Sensitivity {
    let watched = [
        Watched::blind_up_to(Constant::Viscosity, 0.1, BOUNDS),
        Watched::blind_up_to(Constant::BodyForce, 1.0, CONTROLLED),
        Watched::new(Constant::Height),
        Watched::blind_up_to(Constant::Density, 0.3, STRESS),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, SOUND),
        Watched::new(Constant::Normalisation),
        Watched::blind_up_to(Constant::SmoothingLength, 1.0, REACH),
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP),
        Watched::blind_up_to(Constant::DensityDiffusion, 1.0, DISORDER),
        Watched::blind_up_to(Constant::Shifting, 1.0, DISORDER).faults(&[0.0]),
    ];
    let run = best(Tier::Full, 10.0).into_iter().take(1).map(|run| run.spec());
    Sensitivity::new(NAME, tier, run, watched)
}
