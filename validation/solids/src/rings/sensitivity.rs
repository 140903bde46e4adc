//! Errors of constants that the gates of the colliding rings must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
};

use super::{RUBBER_RINGS, plan::FIVE_LAYERS};

const SPEED: &str = "rings of five layers miss the reference by 9 % in restitution and 14 % in width, and \
                     the bounds of these limitations leave room for an error of this size";
const STIFF: &str = "five layers bend too softly, so a ring that is stiffer for its mass comes nearer to \
                     the reference, and one sign of the error passes; a shear modulus that is 11 % too low \
                     fails the path of the centre, and with ten layers one of 2 % fails the end of contact";
const STEP: &str = "the time step is limited by stability, and its part of the error is far below that of \
                    the spacing: see the error budget";
const LOSS: &str = "artificial viscosity takes a small part of the energy of rings, and 30 % of that is \
                    inside the bounds on the restitution";
const STRESS: &str = "artificial stress keeps rings whole, and 30 % less still does at this speed; its \
                      wrong sign and its absence are detected";
const XSPH: &str = "XSPH moves particles by a share of their relative velocities, which are small in a \
                    ring: not even its wrong sign fails a gate";

/// The coarsest judged collision.
pub fn sensitivity(tier: Tier) -> Sensitivity {
    let watched = [
        Watched::blind_up_to(Constant::Speed, 0.2, SPEED),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, STIFF),
        Watched::blind_up_to(Constant::ShearModulus, 1.0, STIFF),
        Watched::blind_up_to(Constant::Density, 1.0, STIFF),
        Watched::blind_up_to(Constant::Height, 0.1, SPEED),
        Watched::blind_up_to(Constant::Normalisation, 1.0, STIFF),
        Watched::new(Constant::SmoothingLength).quick(),
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP),
        Watched::blind_up_to(Constant::ArtificialViscosity, 1.0, LOSS),
        Watched::blind_up_to(Constant::ArtificialStress, 1.0, STRESS).faults(&[-1.0, 0.0]),
        Watched::blind_up_to(Constant::Xsph, 1.0, XSPH),
    ];
    let run = RUBBER_RINGS.spec("leapfrog", |s| s.spacing = FIVE_LAYERS);
    Sensitivity::new(RUBBER_RINGS.name, tier, [run], watched)
}
