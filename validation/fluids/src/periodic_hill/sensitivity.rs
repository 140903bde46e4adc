//! Errors of constants that the gates of the flow over hills must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
};

use super::{NAME, plan::QUICK};

/// The judged run of the quick tier.
pub fn sensitivity(tier: Tier) -> Sensitivity {
    let watched = [
        Watched::new(Constant::Viscosity),
        Watched::new(Constant::BodyForce),
        Watched::new(Constant::Height),
        Watched::new(Constant::Density),
        Watched::new(Constant::SoundSpeed),
        Watched::new(Constant::Normalisation),
        Watched::new(Constant::SmoothingLength),
        Watched::new(Constant::TimeStep),
        Watched::new(Constant::DensityDiffusion),
        Watched::new(Constant::Shifting).faults(&[0.0]),
    ];
    Sensitivity::new(NAME, tier, [QUICK.spec()], watched)
}
