//! From settings to the water and its tank, and how each type of a variant is made from them.

use nalgebra::Vector2;
use solver::{
    ArtificialStress, ArtificialViscosity, BodyForce, Compose, Continuity, DensityDiffusion,
    Domain, ExtrapolatingWall, Ghosts, Hydrostatic, InterfaceWall, Kernel, Particle, Pressure,
    Role, Scene, Smoothing, Tait, Term, Xsph, lattice, terms::Tensile, walls::Walls,
};

use super::{HydrostaticSettings, run};
use base::random::Random;
use harness::{
    case::{RunError, Variant},
    composed::{Composition, lacking},
};
use maths::{
    exact, geometry,
    theory::{
        Stepping,
        lattice::SquareLattice,
        time_step::{self, Medium},
    },
};

/// Spacings from the surface of the water to the rim of the tank.
const FREEBOARD: usize = 4;
/// Particles of the box whose waves give the limit of dt.
const LIMIT_BOX: usize = 32;
const MOST_STEPS: f64 = 1e8;
const MOST_PARTICLES: f64 = 1e7;

/// The numbers of one run, SI units.
pub struct Column {
    /// The settings.
    pub settings: HydrostaticSettings,
    /// The exact solution.
    pub exact: exact::Hydrostatic,
    /// The equation of state.
    pub eos: Tait,
    /// Spacing \[m\].
    pub dx: f64,
    /// Smoothing length \[m\].
    pub h: f64,
    /// Time step \[s\].
    pub dt: f64,
    /// What theory allows \[s\].
    pub dt_limit: f64,
    /// W at the spacing \[1/m²\].
    w_at_spacing: f64,
}

impl Column {
    /// The numbers for kernel `K`, stabiliser `D` and integrator `I`, or why they are refused.
    pub fn new<K: Kernel, D: Part, I: Stepping>(
        s: &HydrostaticSettings,
        allow_unstable: bool,
    ) -> Result<Self, RunError> {
        let c0 = (s.g * s.depth / s.compressibility).sqrt();
        let gamma = s.gamma as i32;
        let exact = exact::Hydrostatic {
            density: s.rho,
            sound_speed: c0,
            gamma: f64::from(gamma),
            gravity: s.g,
        };
        let dx = s.depth / s.rows as f64;
        let h = s.h_over_dx * dx;
        let fastest = exact.sound_speed(s.depth);
        let delta = if D::USES.contains(&"diffusion") { s.diffusion } else { 0.0 };
        let medium = Medium { c0: fastest, h, nu: 0.0, alpha: s.alpha, delta };
        let lattice = SquareLattice::<K>::new(s.h_over_dx, 0.01);
        let modes = time_step::modes(&lattice, LIMIT_BOX, &medium);
        let column = Self {
            settings: s.clone(),
            exact,
            eos: Tait { gamma, ..Tait::new(s.rho, c0) },
            dx,
            h,
            dt: s.courant * h / fastest,
            dt_limit: time_step::time_step_limit(&modes, I::THEORY),
            w_at_spacing: Smoothing::<K>::new(h).w(dx * dx),
        };
        column.check::<I>(allow_unstable)?;
        Ok(column)
    }

    fn check<I: Stepping>(&self, allow_unstable: bool) -> Result<(), RunError> {
        let Self { settings: s, dt, dt_limit: limit, .. } = self;
        let too_much = |what, value, most, setting| {
            if value > most {
                Err(RunError::TooMuch { what, value, most, setting })
            } else {
                Ok(())
            }
        };
        let particles = s.rows as f64 * s.columns as f64;
        too_much("the number of time steps", self.end() / dt, MOST_STEPS, "end, courant or rows")?;
        too_much("the number of particles", particles, MOST_PARTICLES, "rows or columns")?;
        if dt > limit && !allow_unstable {
            return Err(RunError::TimeStep { dt: *dt, limit: *limit, integrator: I::NAME });
        }
        Ok(())
    }

    /// The acoustic period 4 H/c₀ \[s\].
    pub fn period(&self) -> f64 {
        4.0 * self.settings.depth / self.eos.sound_speed
    }

    /// End of the run \[s\].
    pub fn end(&self) -> f64 {
        self.settings.end * self.period()
    }

    /// g \[m/s²\].
    fn gravity(&self) -> Vector2<f64> {
        Vector2::new(0.0, -self.settings.g)
    }

    /// δ h ⁰c \[m²/s\].
    fn diffusivity(&self) -> f64 {
        self.settings.diffusion * self.h * self.eos.sound_speed
    }

    /// The tank.
    pub fn tank(&self) -> geometry::Tank {
        let s = &self.settings;
        geometry::Tank { columns: s.columns, rows: s.rows + FREEBOARD, dx: self.dx }
    }

    /// Height of the surface \[m\], half a spacing above the highest row.
    pub fn level<W: TankWall>(&self) -> f64 {
        (self.settings.rows as f64 + 0.5 - W::FIRST_ROW) * self.dx
    }

    /// A particle that does not move, with the density that is exact at its place, or that of the
    /// surface.
    fn at_rest(&self, place: Vector2<f64>, level: f64, uniform: bool) -> Particle {
        let depth = if uniform { 0.0 } else { level - place.y };
        let density = self.exact.density(depth);
        Particle::fluid(place, Vector2::zeros(), density, self.dx * self.dx)
    }

    /// The water.
    fn water<W: TankWall>(&self) -> Vec<Particle> {
        let (s, level) = (&self.settings, self.level::<W>());
        // Rows between rows on the walls are one less than spacings.
        let fewer = usize::from(W::FIRST_ROW == 1.0);
        let first = Vector2::repeat(W::FIRST_ROW * self.dx);
        let mut random = Random::new(1);
        let mut jitter = || (2.0 * random.uniform() - 1.0) * s.jitter * self.dx;
        lattice(first, self.dx, s.columns - fewer, s.rows - fewer)
            .map(|x| self.at_rest(x + Vector2::new(jitter(), jitter()), level, s.uniform))
            .collect()
    }

    /// The scene of a composition.
    pub fn scene<K, R, D, W, I>(&self) -> Scene<Method<K, R, D, W, I>>
    where
        K: Kernel,
        R: TensilePart,
        D: Part,
        W: TankWall,
        I: Stepping,
    {
        let s = &self.settings;
        let forces = (
            Pressure { eos: self.eos, tensile: R::new(self) },
            ArtificialViscosity::new(s.alpha, s.beta, self.h, self.eos),
            BodyForce(self.gravity()),
        );
        let mut particles = self.water::<W>();
        particles.extend(W::particles(self, K::SUPPORT * self.h));
        let drift = (Continuity, D::new(self));
        Scene::new(self.h, Domain::open(), particles, forces, drift, W::walls(self))
    }
}

/// Kernel, artificial stress, what is added to the drift, walls, integrator.
pub type Method<K, R, D, W, I> =
    Compose<K, (Pressure<Tait, R>, ArtificialViscosity<Tait>, BodyForce), (Continuity, D), W, I>;

/// A term that stabilises, and the settings that only it reads.
pub trait Part: Term<()> {
    /// Those settings.
    const USES: &'static [&'static str];
    /// The term.
    fn new(column: &Column) -> Self;
}

impl Part for () {
    const USES: &'static [&'static str] = &[];
    fn new(_: &Column) {}
}

impl Part for Xsph {
    const USES: &'static [&'static str] = &["xsph"];
    fn new(column: &Column) -> Self {
        Self { epsilon: column.settings.xsph }
    }
}

impl Part for DensityDiffusion {
    const USES: &'static [&'static str] = &["diffusion"];
    fn new(column: &Column) -> Self {
        Self::new(column.diffusivity())
    }
}

impl Part for DensityDiffusion<Hydrostatic> {
    const USES: &'static [&'static str] = &["diffusion"];
    fn new(column: &Column) -> Self {
        Self::hydrostatic(column.diffusivity(), column.eos, column.gravity())
    }
}

/// An artificial stress, or none.
pub trait TensilePart: Tensile {
    /// Settings that it reads.
    const USES: &'static [&'static str];
    /// Its value.
    fn new(column: &Column) -> Self;
}

impl TensilePart for () {
    const USES: &'static [&'static str] = &[];
    fn new(_: &Column) {}
}

impl TensilePart for ArtificialStress {
    const USES: &'static [&'static str] = &["xi", "stress_exponent"];
    fn new(column: &Column) -> Self {
        let s = &column.settings;
        Self::new(s.xi, s.stress_exponent as u32, column.w_at_spacing)
    }
}

/// Walls of the tank.
pub trait TankWall: Walls<()> {
    /// The name in reports.
    const NAME: &'static str;
    /// Settings that they read.
    const USES: &'static [&'static str] = &[];
    /// Where the first row of water is \[dx\].
    const FIRST_ROW: f64;
    /// The walls.
    fn walls(column: &Column) -> Self;
    /// Their particles.
    fn particles(column: &Column, support: f64) -> Vec<Particle>;
}

impl TankWall for InterfaceWall {
    const NAME: &'static str = "interface-wall";
    const FIRST_ROW: f64 = 1.0;

    fn walls(_: &Column) -> Self {
        Self
    }

    /// All with the exact density, as if the water went on: that of the interface is frozen.
    fn particles(column: &Column, support: f64) -> Vec<Particle> {
        let walls = column.tank().interface_walls(support);
        let level = column.level::<Self>();
        let with = |role: Role| {
            move |x: Vector2<f64>| column.at_rest(x, level, column.settings.uniform).with_role(role)
        };
        let interface = walls.interface.into_iter().map(with(Role::Interface));
        interface.chain(walls.wall.into_iter().map(with(Role::Wall))).collect()
    }
}

impl TankWall for Ghosts {
    const NAME: &'static str = "ghosts";
    const FIRST_ROW: f64 = 0.5;

    fn walls(column: &Column) -> Self {
        Self { walls: column.tank().mirrors() }
    }

    fn particles(_: &Column, _: f64) -> Vec<Particle> {
        Vec::new()
    }
}

impl TankWall for ExtrapolatingWall<Tait> {
    const NAME: &'static str = "extrapolating-wall";
    const USES: &'static [&'static str] = &["wall_gravity"];
    const FIRST_ROW: f64 = 0.5;

    /// Not below 0: the wall beside the surface must not suck it up.
    fn walls(column: &Column) -> Self {
        Self::new(column.eos, column.gravity() * column.settings.wall_gravity).not_below(0.0)
    }

    /// With the mass of the water that would be in their place: what they push with is their mass by
    /// p/ρ², and with that of the surface a compressed column would sink into the bottom.
    fn particles(column: &Column, support: f64) -> Vec<Particle> {
        let (points, level) = (column.tank().rows_behind(support), column.level::<Self>());
        let at_rest = |x| column.at_rest(x, level, column.settings.uniform).with_role(Role::Wall);
        points.into_iter().map(at_rest).collect()
    }
}

/// Settings that some types do not read.
const OPTIONAL: &[&str] = &["xsph", "xi", "stress_exponent", "diffusion", "wall_gravity"];

/// A variant: its types, and how it changes the default settings.
pub fn variant<K, R, D, W, I>(
    name: &'static str,
    about: &'static str,
    adjust: fn(&mut HydrostaticSettings),
) -> Composition<HydrostaticSettings>
where
    K: Kernel,
    R: TensilePart,
    D: Part,
    W: TankWall,
    I: Stepping,
{
    let lacks = lacking(OPTIONAL, &[R::USES, D::USES, W::USES].concat());
    let (run, rules) = (run::run::<K, R, D, W, I>, run::rules::<K, D, I>);
    Composition { variant: Variant { name, about }, adjust, run, rules, lacks }
}
