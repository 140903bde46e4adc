//! Errors of constants that the gates of the channel flows must detect.

use base::mutation::Constant;
use harness::{
    case::Tier,
    declare::{Sensitivity, Watched},
};

use super::{Channel, Flow};

/// The runs with the most gates, one without and one with density diffusion and shifting.
pub fn sensitivity(channel: Channel, tier: Tier) -> Sensitivity {
    let Channel { flow, case } = channel;
    let drive = match flow {
        Flow::Couette => Constant::WallSpeed,
        Flow::Poiseuille => Constant::BodyForce,
    };
    let watched = [
        Watched::new(drive).faults(&[-1.0, 0.5]),
        Watched::new(Constant::Viscosity),
        Watched::new(Constant::Height),
        Watched::new(Constant::Density),
        Watched::new(Constant::SoundSpeed),
        Watched::new(Constant::Normalisation),
        Watched::new(Constant::SmoothingLength),
        Watched::new(Constant::TimeStep),
        Watched::new(Constant::DensityDiffusion).faults(&[-1.0, 0.0]),
        Watched::new(Constant::Shifting).faults(&[-1.0, 0.0]),
        Watched::new(Constant::Eta2).faults(&[1000.0]),
        Watched::new(Constant::ListLifetime).faults(&[100.0]),
    ];
    let runs = [case.spec("plain", |_| {}), case.spec("modern", |s| s.end = 1.5)];
    Sensitivity::new(case.name, tier, runs, watched)
}
