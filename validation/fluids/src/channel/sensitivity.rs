//! Errors of constants that the gates of the channel flows must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
    studies::causes::{ENOUGH_OR_IDLE, NOT_MEASURED, SAFETY_MARGIN, STEP, WIDE_BOUNDS},
};

use super::{Channel, Flow};

const STRESS: &str = "The velocity of a channel flow does not depend on the density, and no gate judges a \
                      stress in Pa. A density that is wrong by 30 % is detected, because it is outside the \
                      bounds beyond which a run ends.";
const SOUND: &str = "The exact flow is incompressible. At a tenth of the sound speed, compressibility \
                     changes its velocity by less than the spacing does.";
const ORDER: &str =
    "At Re 0.5 particles stay in straight rows, and this term acts on disorder alone.";
const REACH: &str = "Sums over neighbours hold for any reach of the kernel. At 20 rows, the error that a \
                     longer reach adds to a parabolic profile is inside the bounds until the reach is wrong \
                     by 20 %.";
const LISTS: &str = "Lists are built again before a particle has crossed half of the skin, and a list that \
                     is kept 30 % too long still holds every neighbour.";

/// The runs with the most gates, one without and one with density diffusion and shifting.
pub fn sensitivity(channel: Channel, tier: Tier) -> Sensitivity {
    let Channel { flow, case } = channel;
    let drive = match flow {
        Flow::Couette => Constant::WallSpeed,
        Flow::Poiseuille => Constant::BodyForce,
    };
    let reach = Constant::SmoothingLength;
    let reach = match flow {
        Flow::Couette => Watched::new(reach),
        Flow::Poiseuille => Watched::blind_up_to(reach, 0.2, REACH, &WIDE_BOUNDS),
    };
    let watched = [
        Watched::new(drive).quick().faults(&[-1.0, 0.5]),
        Watched::new(Constant::Viscosity).quick(),
        Watched::new(Constant::Height).quick(),
        Watched::blind_up_to(Constant::Density, 0.3, STRESS, &NOT_MEASURED),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, SOUND, &NOT_MEASURED),
        Watched::new(Constant::Normalisation),
        reach,
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP, &SAFETY_MARGIN),
        Watched::blind_up_to(Constant::DensityDiffusion, 1.0, ORDER, &ENOUGH_OR_IDLE)
            .faults(&[-1.0]),
        Watched::blind_up_to(Constant::Shifting, 1.0, ORDER, &ENOUGH_OR_IDLE).faults(&[-1.0]),
        Watched::blind_up_to(Constant::ListLifetime, 1.0, LISTS, &SAFETY_MARGIN).faults(&[100.0]),
    ];
    let runs = [case.spec("plain", |_| {}), case.spec("modern", |s| s.end = 1.5)];
    Sensitivity::new(case.name, tier, runs, watched)
}
