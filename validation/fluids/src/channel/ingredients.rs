//! How each type of a scheme is made from the settings, and which settings it reads. A scheme is a
//! composition of types; this is the recipe for its values.

use nalgebra::Vector2;
use solver::terms::{Approaching, Tensile};
use solver::{
    ArtificialStress, ArtificialViscosity, BodyForce, Continuity, DensityDiffusion,
    ExtrapolatingWall, Ghosts, InterfaceWall, Kernel, NoSlip, Particle, PlaneWall, Pressure,
    Shifting, Tait, Term, Viscosity, Xsph,
};

use super::Setup;

/// A term that can be made from the settings of a channel.
pub trait Ingredient: Term<()> {
    /// Settings that only this term reads.
    const USES: &'static [&'static str];
    /// The term.
    fn new(setup: &Setup) -> Self;
    /// Settings of the term, and of the terms inside it.
    fn uses() -> Vec<&'static str> {
        Self::USES.to_vec()
    }
}

/// Settings that some term of some variant reads, and others do not have.
pub const OPTIONAL: &[&str] = &[
    "eta2_over_h2",
    "alpha",
    "beta",
    "xsph",
    "xi",
    "stress_exponent",
    "diffusion",
    "shift",
    "wall_curvature",
];

impl Ingredient for () {
    const USES: &'static [&'static str] = &[];
    fn new(_: &Setup) -> Self {}
}

impl Ingredient for Continuity {
    const USES: &'static [&'static str] = &[];
    fn new(_: &Setup) -> Self {
        Continuity
    }
}

/// An artificial stress, or none.
pub trait TensileIngredient: Tensile {
    /// Settings that it reads.
    const USES: &'static [&'static str];
    /// Its value.
    fn new(setup: &Setup) -> Self;
}

impl TensileIngredient for () {
    const USES: &'static [&'static str] = &[];
    fn new(_: &Setup) -> Self {}
}

impl TensileIngredient for ArtificialStress {
    const USES: &'static [&'static str] = &["xi", "stress_exponent"];
    fn new(setup: &Setup) -> Self {
        let exponent = setup.settings.stress_exponent as u32;
        ArtificialStress::new(setup.settings.xi, exponent, setup.w_at_spacing)
    }
}

impl<R: TensileIngredient> Ingredient for Pressure<Tait, R> {
    const USES: &'static [&'static str] = R::USES;
    fn new(setup: &Setup) -> Self {
        Pressure { eos: setup.eos, tensile: R::new(setup) }
    }
}

impl Ingredient for Viscosity {
    const USES: &'static [&'static str] = &["eta2_over_h2"];
    fn new(setup: &Setup) -> Self {
        let s = &setup.settings;
        Viscosity { mu: s.rho * s.nu, eta2: s.eta2_over_h2 * setup.h * setup.h }
    }
}

impl Ingredient for BodyForce {
    const USES: &'static [&'static str] = &[];
    fn new(setup: &Setup) -> Self {
        BodyForce(Vector2::new(setup.force, 0.0))
    }
}

impl Ingredient for ArtificialViscosity<Tait, Approaching> {
    const USES: &'static [&'static str] = &["alpha", "beta"];
    fn new(setup: &Setup) -> Self {
        Self::new(setup.settings.alpha, setup.settings.beta, setup.h, setup.eos)
    }
}

impl Ingredient for Xsph {
    const USES: &'static [&'static str] = &["xsph"];
    fn new(setup: &Setup) -> Self {
        Xsph { epsilon: setup.settings.xsph }
    }
}

impl Ingredient for DensityDiffusion {
    const USES: &'static [&'static str] = &["diffusion"];
    fn new(setup: &Setup) -> Self {
        DensityDiffusion::new(setup.settings.diffusion * setup.h * setup.eos.sound_speed)
    }
}

impl Ingredient for Shifting {
    const USES: &'static [&'static str] = &["shift"];
    fn new(setup: &Setup) -> Self {
        Shifting::new(setup.settings.shift, setup.h, setup.w_at_spacing)
    }
}

macro_rules! tuple_of_ingredients {
    ($($member:ident),+) => {
        impl<$($member: Ingredient),+> Ingredient for ($($member,)+) {
            const USES: &'static [&'static str] = &[];
            fn new(setup: &Setup) -> Self {
                ($($member::new(setup),)+)
            }
            fn uses() -> Vec<&'static str> {
                [$($member::uses()),+].concat()
            }
        }
    };
}

tuple_of_ingredients!(A, B);
tuple_of_ingredients!(A, B, C);
tuple_of_ingredients!(A, B, C, D);

/// Walls, and where they put particles.
pub trait Arrangement: solver::walls::Walls<()> {
    /// The name in reports.
    const NAME: &'static str;
    /// Settings that it reads.
    const USES: &'static [&'static str];
    /// The walls.
    fn walls(setup: &Setup) -> Self;
    /// Fluid, then wall particles.
    fn particles<K: Kernel>(setup: &Setup) -> Vec<Particle>;
}

impl Arrangement for Ghosts {
    const NAME: &'static str = "ghosts";
    const USES: &'static [&'static str] = &["wall_curvature"];

    fn walls(setup: &Setup) -> Self {
        let s = &setup.settings;
        let along = |speed| Vector2::new(speed, 0.0);
        let mut lower = PlaneWall::new(Vector2::zeros(), Vector2::y(), along(0.0));
        let top = Vector2::new(0.0, s.width);
        let mut upper = PlaneWall::new(top, -Vector2::y(), along(setup.plate_speed()));
        if s.wall_curvature {
            lower.curvature = along(-setup.force / s.nu);
            upper.curvature = lower.curvature;
        }
        Ghosts { walls: vec![lower, upper] }
    }

    /// Rows at (j + 1/2) dx, mirrored by the walls into themselves.
    fn particles<K: Kernel>(setup: &Setup) -> Vec<Particle> {
        setup.rows(0.5 * setup.dx, setup.settings.rows)
    }
}

impl Arrangement for InterfaceWall {
    const NAME: &'static str = "interface-wall";
    const USES: &'static [&'static str] = &[];

    fn walls(_: &Setup) -> Self {
        InterfaceWall
    }

    /// Rows at j dx: interface rows on the plates are rows of the same lattice.
    fn particles<K: Kernel>(setup: &Setup) -> Vec<Particle> {
        let mut particles = setup.rows(setup.dx, setup.settings.rows - 1);
        particles.extend(setup.wall_rows(0.0, K::SUPPORT * setup.h));
        particles
    }
}

impl Arrangement for ExtrapolatingWall<Tait, NoSlip> {
    const NAME: &'static str = "extrapolating-wall";
    const USES: &'static [&'static str] = &[];

    fn walls(setup: &Setup) -> Self {
        Self::no_slip(setup.eos, Vector2::new(setup.force, 0.0))
    }

    /// Rows at (j + 1/2) dx, behind the plates as between them.
    fn particles<K: Kernel>(setup: &Setup) -> Vec<Particle> {
        let mut particles = setup.rows(0.5 * setup.dx, setup.settings.rows);
        particles.extend(setup.wall_rows(0.5, K::SUPPORT * setup.h));
        particles
    }
}
