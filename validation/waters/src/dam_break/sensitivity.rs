//! Errors of constants that the gates of the dam break must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
};

use super::{DAM_BREAK, NAME};

/// The coarsest judged column, released freely.
pub fn sensitivity(tier: Tier) -> Sensitivity {
    let watched = [
        Watched::new(Constant::BodyForce),
        Watched::new(Constant::Height),
        Watched::new(Constant::Density),
        Watched::new(Constant::SoundSpeed),
        Watched::new(Constant::Normalisation),
        Watched::new(Constant::SmoothingLength),
        Watched::new(Constant::TimeStep),
        Watched::new(Constant::ArtificialViscosity),
        Watched::new(Constant::DensityDiffusion).faults(&[-1.0]),
        Watched::new(Constant::ArtificialStress).faults(&[-1.0]),
        Watched::new(Constant::Xsph).faults(&[-1.0]),
    ];
    let runs = ["modern", "seed"].map(|variant| DAM_BREAK.spec(variant, |s| s.n = 20));
    Sensitivity::new(NAME, tier, runs, watched)
}
