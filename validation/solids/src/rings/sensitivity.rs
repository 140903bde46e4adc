//! Errors of constants that the gates of the colliding rings must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
    studies::causes::{ENOUGH_OR_IDLE, SAFETY_MARGIN, STEP, WIDE_BOUNDS},
};

use super::{RUBBER_RINGS, plan::FIVE_LAYERS};

const SPEED: &str = "Rings of five layers miss the reference by 9 % in restitution and by 14 % in width, and \
                     the bounds that allow this leave room for an error of this size.";
const STIFF: &str = "Rings of five layers bend too softly, so a ring that is stiffer for its mass comes \
                     nearer to the reference, and one sign of the error passes. A shear modulus that is 11 % \
                     too low fails the path of the centre, and with ten layers one that is 2 % too low fails \
                     the end of contact.";
const LOSS: &str = "Artificial viscosity takes a small part of the energy of the rings, and 30 % of that \
                    part is inside the bounds on the restitution.";
const STRESS: &str = "Artificial stress that is 30 % weaker still keeps the rings whole at this speed. Its \
                      wrong sign and its absence are detected.";
const XSPH: &str = "XSPH moves particles by a share of their relative velocities, which are small in a ring. \
                    Not even its wrong sign fails a gate.";

/// The coarsest judged collision.
pub fn sensitivity(tier: Tier) -> Sensitivity {
    let watched = [
        Watched::blind_up_to(Constant::Speed, 0.2, SPEED, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, STIFF, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::ShearModulus, 1.0, STIFF, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::Density, 1.0, STIFF, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::Height, 0.1, SPEED, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::Normalisation, 1.0, STIFF, &WIDE_BOUNDS),
        Watched::new(Constant::SmoothingLength).quick(),
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP, &SAFETY_MARGIN),
        Watched::blind_up_to(Constant::ArtificialViscosity, 1.0, LOSS, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::ArtificialStress, 1.0, STRESS, &ENOUGH_OR_IDLE)
            .faults(&[-1.0, 0.0]),
        Watched::blind_up_to(Constant::Xsph, 1.0, XSPH, &ENOUGH_OR_IDLE),
    ];
    let run = RUBBER_RINGS.spec("leapfrog", |s| s.spacing = FIVE_LAYERS);
    Sensitivity::new(RUBBER_RINGS.name, tier, [run], watched)
}
