//! The variants of the channel flows: one line of types each, and the settings that go with them.

use solver::{
    ArtificialStress, ArtificialViscosity, Compose, Continuity, CubicSpline, DensityDiffusion,
    ExtrapolatingWall, Ghosts, InterfaceWall, Leapfrog, NoSlip, PredictorCorrector, Pressure,
    QuinticSpline, Scheme, Shifting, Tait, Term, Viscosity, WendlandC2, Xsph,
};

use super::{
    Arrangement, ChannelSettings, Flow, Ingredient, Stepping,
    ingredients::OPTIONAL,
    run::{run, uses},
};
use crate::{
    case::{RunError, Variant},
    record::Record,
    runner::Context,
    settings::{self, Settings},
};

/// A variant: its name, its settings before `--set`, and the program that its types make.
pub struct ChannelVariant {
    /// Name and description.
    pub variant: Variant,
    /// Changes the default settings.
    pub adjust: fn(&mut ChannelSettings),
    /// Runs it: the flow, the name of the variant, settings.
    pub run: fn(Flow, &str, &ChannelSettings, &Context) -> Result<Record, RunError>,
    /// Optional settings that its types read.
    pub uses: fn() -> Vec<&'static str>,
}

impl ChannelVariant {
    /// The settings of this variant with `key=value` texts applied.
    pub fn settings(&self, set: &[String]) -> Result<ChannelSettings, RunError> {
        let mut settings = ChannelSettings::default();
        (self.adjust)(&mut settings);
        settings::apply(&mut settings, set)?;
        settings.validate()?;
        let uses = (self.uses)();
        for assignment in set {
            let key = assignment.split('=').next().unwrap_or_default().trim();
            if OPTIONAL.contains(&key) && !uses.contains(&key) {
                let (key, variant) = (key.to_string(), self.variant.name.to_string());
                return Err(RunError::Unused { key, variant });
            }
        }
        Ok(settings)
    }
}

/// Forces of a channel flow: pressure, viscosity, and the driving force `B`, `()` for Couette flow.
type Fluid<B, R = ()> = (Pressure<Tait, R>, Viscosity, B);
/// The same with artificial viscosity.
type Damped<B> = (Pressure<Tait>, Viscosity, B, ArtificialViscosity<Tait>);
/// What stabilises the modern variants.
type Stabilised = (Continuity, DensityDiffusion, Shifting);

// A channel flow stores x, v and ρ, shows its neighbours one number, p/ρ², and nothing else.
const _: () = assert!(size_of::<<Fluid<()> as Term<()>>::Shows>() == 8);
const _: () = assert!(size_of::<<Stabilised as Term<()>>::Shows>() == 0);

/// A variant of the scheme `S`.
fn variant<S>(
    name: &'static str,
    about: &'static str,
    adjust: fn(&mut ChannelSettings),
) -> ChannelVariant
where
    S: Scheme<Extra = ()>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
    S::Walls: Arrangement,
    S::Integrator: Stepping,
{
    ChannelVariant { variant: Variant { name, about }, adjust, run: run::<S>, uses: uses::<S> }
}

/// Quintic spline, h = dx, η² a mere guard, long steps, c0 up to where sound costs no step.
fn modern(s: &mut ChannelSettings) {
    (s.h_over_dx, s.eta2_over_h2) = (1.0, 1e-6);
    (s.courant, s.viscous, s.c0_viscous) = (1.0, 0.4, 2.2);
}

type Seed<F, D, W = Ghosts> = Compose<CubicSpline, F, D, W, PredictorCorrector>;
type Modern<F, D, W = Ghosts> = Compose<QuinticSpline, F, D, W, Leapfrog>;

/// All variants of a channel flow driven by `B`.
pub fn variants<B: Ingredient>() -> Vec<ChannelVariant> {
    let mut all = methods::<B>();
    all.extend(moderns::<B>());
    all.extend(cures::<B>());
    all
}

/// The seed's method, and what changing its parts one by one leads to.
fn methods<B: Ingredient>() -> Vec<ChannelVariant> {
    vec![
        variant::<Seed<Fluid<B>, Continuity>>(
            "seed",
            "as in the paper: cubic spline, h/dx 1.2, eta^2 = 0.01 h^2, ghosts, predictor-corrector",
            |_| {},
        ),
        variant::<Seed<Fluid<B>, Continuity, InterfaceWall>>(
            "interface-wall",
            "seed with interface and wall particles (4.2) for ghosts",
            |_| {},
        ),
        variant::<Seed<Fluid<B>, Continuity>>(
            "seed-small-eta",
            "seed with eta^2 = 1e-6 h^2",
            |s| s.eta2_over_h2 = 1e-6,
        ),
        variant::<Compose<CubicSpline, Fluid<B>, Continuity, Ghosts, Leapfrog>>(
            "cubic-leapfrog",
            "cubic spline, h/dx 1.5, small eta, leapfrog with long steps",
            |s| {
                modern(s);
                s.h_over_dx = 1.5;
                s.viscous = 0.27;
            },
        ),
        variant::<Compose<WendlandC2, Fluid<B>, Continuity, Ghosts, Leapfrog>>(
            "wendland-leapfrog",
            "Wendland C2, h/dx 2, small eta, leapfrog with long steps",
            |s| {
                modern(s);
                s.h_over_dx = 2.0;
                s.viscous = 0.23;
            },
        ),
        variant::<Compose<QuinticSpline, Fluid<B>, Continuity, Ghosts, PredictorCorrector>>(
            "quintic-pc",
            "quintic spline, h/dx 1, small eta, predictor-corrector, c0 as low as the seed's",
            |s| {
                modern(s);
                s.courant = 0.25;
                s.c0_viscous = 0.0;
            },
        ),
    ]
}

/// Quintic spline and leapfrog, from bare to stabilised.
fn moderns<B: Ingredient>() -> Vec<ChannelVariant> {
    vec![
        variant::<Modern<Fluid<B>, Continuity>>(
            "plain",
            "quintic spline, h/dx 1, small eta, leapfrog: the modern variant without stabilisers",
            modern,
        ),
        variant::<Modern<Fluid<B>, Continuity>>(
            "curved",
            "plain with ghosts that know the curvature of the velocity at the wall",
            |s| {
                modern(s);
                s.wall_curvature = true;
            },
        ),
        variant::<Modern<Fluid<B>, Continuity, ExtrapolatingWall<Tait, NoSlip>>>(
            "extrapolating-wall",
            "plain with wall particles that extrapolate velocity and pressure (Adami, Hu & Adams 2012)",
            modern,
        ),
        variant::<Modern<Fluid<B>, Stabilised>>(
            "modern",
            "curved with density diffusion and shifting: one rule for every Reynolds number",
            |s| {
                modern(s);
                s.wall_curvature = true;
            },
        ),
        variant::<Modern<Fluid<B>, Stabilised>>(
            "modern-mirror",
            "modern with plainly mirroring ghosts",
            modern,
        ),
    ]
}

/// The seed's method with one thing against its instability.
fn cures<B: Ingredient>() -> Vec<ChannelVariant> {
    vec![
        variant::<Seed<Fluid<B>, Continuity>>(
            "cure-background",
            "seed with a background pressure of 0.05 rho c0^2",
            |s| s.background = 0.05,
        ),
        variant::<Seed<Fluid<B, ArtificialStress>, Continuity>>(
            "cure-stress",
            "seed with artificial stress (18)(19)",
            |_| {},
        ),
        variant::<Seed<Damped<B>, Continuity>>(
            "cure-viscosity",
            "seed with artificial viscosity (16)(17), alpha 0.1",
            |_| {},
        ),
        variant::<Seed<Fluid<B>, (Continuity, Xsph)>>(
            "cure-xsph",
            "seed with XSPH (22), epsilon 0.5",
            |_| {},
        ),
        variant::<Seed<Fluid<B>, (Continuity, DensityDiffusion)>>(
            "cure-diffusion",
            "seed with density diffusion 0.1",
            |_| {},
        ),
        variant::<Seed<Fluid<B>, (Continuity, Shifting)>>(
            "cure-shifting",
            "seed with particle shifting 0.5",
            |_| {},
        ),
        variant::<Seed<Fluid<B>, Stabilised>>(
            "cure-both",
            "seed with density diffusion and shifting",
            |_| {},
        ),
        variant::<Compose<CubicSpline, Fluid<B>, Continuity, Ghosts, Leapfrog>>(
            "cure-leapfrog",
            "seed with the staggered leapfrog",
            |_| {},
        ),
    ]
}
