//! Taylor-Green vortices in a periodic box: interior flow without walls, from a lattice that suits it
//! and from one that does not. Length L = 1 m, largest speed at the start U = 1 m/s, ρ = 1 kg/m³.

mod declaration;
mod plan;
mod run;

use harness::{case::Case, composed::*};
use schemes::flow;

use crate::unit_flow::unit_settings;

unit_settings! {
    /// Settings of the vortices. L = U = ρ = 1.
    pub struct VortexSettings {
        /// Reynolds number U L/ν
        re: f64 ["-"] in 1e-3..=1e6 = 100.0,
        /// particles along each side
        n: usize ["-"] in 8..=2000 = 50,
        /// largest displacement of the initial lattice along each axis; uniform
        perturb: f64 ["dx"] in 0.0..=0.5 = 0.0,
        /// seed of the displacements
        seed: usize ["-"] in 0..=1000000 = 1,
        /// end of the run
        end: f64 ["L/U"] in 1e-6..=1e3 = 2.0,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.0,
        /// sound speed
        c0: f64 ["U"] in 2.0..=1e4 = 10.0,
        /// time step; auto: the least of courant h/(c0 + U) and viscous h²/ν
        dt: Option<f64> ["s"] in 1e-15..=1e3 = None,
    }
}

/// Shifting of amplitude A = 3. A lattice that is squeezed to half along one axis and stretched along the
/// other, as at a stagnation point within t = 0.11 L/U, crowds: shifting lets disorder grow there by a
/// factor of exp(14 A n/50), which makes round-off visible in time from A = 2.5 on at 50 particles a
/// side. By the linear theory of its sum an explicit step dt = 1.5 h/(c0 + U) allows 4.7 on a lattice and
/// 1.8 where it is squeezed most: there it overshoots from step to step for as long as the squeeze lasts,
/// and that this crowds no pair is for the gate `nearest` to say. At dt = h/(c0 + U) the bounds are 7 and
/// 2.7.
fn strong(s: &mut VortexSettings) {
    s.shift = 3.0;
}

fn variants() -> Vec<Composition<VortexSettings>> {
    let plain = "quintic spline, h/dx 1, leapfrog, no stabiliser: is one needed?";
    let modern =
        "plain with density diffusion and shifting: does what suits channels suit vortices?";
    let carried =
        "modern with stronger shifting that takes the velocity of the new place: is that enough?";
    let consistent = "carried with sums that are exact for linear fields: the best";
    Variants::of(&run::PROGRAM)
        .with("plain", plain, flow::vortices_plain(), |_| {})
        .with("modern", modern, flow::vortices_modern(), |_| {})
        .with("carried", carried, flow::vortices_carried(), strong)
        .with(BEST, consistent, flow::vortices_consistent(), strong)
        .all
}

const NAME: &str = "taylor_green";

/// The variant that is held to the goals.
const BEST: &str = "consistent";

static CASE: Composed<VortexSettings> = Composed {
    name: NAME,
    problem: "Periodic vortices decay by viscosity",
    best: Best {
        variant: BEST,
        because: "with 50 x 50 particles its velocity is wrong by 0.2 %, that of `modern` by 71 %: its \
                  sums are exact for linear fields",
        papers: None,
    },
    about: "A periodic array of vortices decays by viscosity without changing its shape: an exact solution \
            of the incompressible equations. Particles go round with the flow and are stretched at its \
            stagnation points, so that the order of the start is soon lost. The case therefore shows what \
            a method does with disorder. Runs start from a square lattice or from a disturbed one.",
    variants,
    is_stable: completed,
    declaration: declaration::declaration,
    plan: |tier| plan::table(tier).plan(),
    studies: |_, _| Vec::new(),
};

/// Taylor-Green vortices.
pub const TAYLOR_GREEN: &dyn Case = &CASE;
