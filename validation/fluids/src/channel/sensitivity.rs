//! Errors of constants that the gates of the channel flows must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
};

use super::{Channel, Flow};

const STRESS: &str = "the velocity of a channel flow does not depend on the density, and no gate judges a \
                      stress in Pa; a density that is wrong by 30 % is outside the bounds beyond which a \
                      run ends";
const SOUND: &str = "the exact flow is incompressible, and at a tenth of the sound speed compressibility \
                     changes its velocity by less than the spacing does";
const STEP: &str = "the time step is limited by stability, and its part of the error is far below that of \
                    the spacing: see the error budget";
const ORDER: &str = "it acts on disorder, and at Re 0.5 particles stay in straight rows";
const REACH: &str = "sums over neighbours hold for any reach of the kernel, and at 20 rows the error of a \
                     parabola that a longer reach adds is inside the bounds";
const LISTS: &str = "lists are built again before a particle has crossed half of the skin, and a list that \
                     is kept 30 % too long still holds every neighbour";

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
        Flow::Poiseuille => Watched::blind_up_to(reach, 0.2, REACH),
    };
    let watched = [
        Watched::new(drive).quick().faults(&[-1.0, 0.5]),
        Watched::new(Constant::Viscosity).quick(),
        Watched::new(Constant::Height).quick(),
        Watched::blind_up_to(Constant::Density, 0.3, STRESS),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, SOUND),
        Watched::new(Constant::Normalisation),
        reach,
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP),
        Watched::blind_up_to(Constant::DensityDiffusion, 1.0, ORDER).faults(&[-1.0]),
        Watched::blind_up_to(Constant::Shifting, 1.0, ORDER).faults(&[-1.0]),
        Watched::blind_up_to(Constant::ListLifetime, 1.0, LISTS).faults(&[100.0]),
    ];
    let runs = [case.spec("plain", |_| {}), case.spec("modern", |s| s.end = 1.5)];
    Sensitivity::new(case.name, tier, runs, watched)
}
