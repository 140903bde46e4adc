//! Errors of constants that the gates of the colliding rings must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
};

use super::{RUBBER_RINGS, plan::FIVE_LAYERS};

/// The coarsest judged collision.
pub fn sensitivity(tier: Tier) -> Sensitivity {
    let watched = [
        Watched::new(Constant::Speed),
        Watched::new(Constant::SoundSpeed),
        Watched::new(Constant::ShearModulus),
        Watched::new(Constant::Density),
        Watched::new(Constant::Height),
        Watched::new(Constant::Normalisation),
        Watched::new(Constant::SmoothingLength),
        Watched::new(Constant::TimeStep),
        Watched::new(Constant::ArtificialViscosity),
        Watched::new(Constant::ArtificialStress).faults(&[-1.0, 0.0]),
        Watched::new(Constant::Xsph).faults(&[-1.0]),
    ];
    let run = RUBBER_RINGS.spec("leapfrog", |s| s.spacing = FIVE_LAYERS);
    Sensitivity::new(RUBBER_RINGS.name, tier, [run], watched)
}
