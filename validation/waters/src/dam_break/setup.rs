//! From settings to a scene: spacing, time step, tank, column.

use nalgebra::Vector2;
use solver::{
    Domain, EquationOfState, ExtrapolatingWall, Ghosts, InterfaceWall, Kernel, Limits, Particle,
    Role, Scene, SlipGhosts, Tait, walls::Walls,
};

use super::DamSettings;
use crate::water::{Ingredient, Medium, WaterScheme};
use harness::case::RunError;
use maths::geometry::Tank;

/// More steps or particles than anyone waits for.
const MOST_STEPS: f64 = 1e7;
const MOST_PARTICLES: f64 = 2e6;

/// Steps of the fastest water that the Verlet skin reaches ahead, there and back.
const SKIN_STEPS: f64 = 4.0;

/// The numbers of one run.
#[derive(Clone, Debug)]
pub struct Dam {
    /// As given.
    pub settings: DamSettings,
    /// Water, gravity, smoothing length.
    pub medium: Medium,
    /// The tank.
    pub tank: Tank,
    /// Particles of the column along x and y.
    pub counts: [usize; 2],
    /// Time step \[s\].
    pub dt: f64,
    /// Its theoretical limit \[s\], see [`Medium::time_step`].
    pub dt_limit: f64,
    /// Whether water at this place counts when the foremost particle is looked for, in a column of this
    /// height \[m\]: below a quarter of it, so that spray does not.
    pub is_front: fn(Vector2<f64>, f64) -> bool,
}

/// Below a quarter of the height of the column.
pub fn near_the_floor(place: Vector2<f64>, height: f64) -> bool {
    place.y < 0.25 * height
}

/// A tank that settings can make.
pub trait Vessel: Walls<()> {
    /// The name in reports.
    const NAME: &'static str;
    /// Whether particles stand on the surface, so that water begins a whole spacing from it.
    const ON_SURFACE: bool;
    /// The walls.
    fn new(medium: &Medium, tank: &Tank) -> Self;
    /// Their particles, out to the support \[m\].
    fn particles(medium: &Medium, tank: &Tank, support: f64) -> Vec<Particle>;
}

fn at_rest(medium: &Medium, points: Vec<Vector2<f64>>, role: Role) -> Vec<Particle> {
    let (dx, rho) = (medium.dx, medium.numerics.rho);
    let particle = |x| Particle::fluid(x, Vector2::zeros(), rho, dx * dx).with_role(role);
    points.into_iter().map(particle).collect()
}

impl Vessel for InterfaceWall {
    const NAME: &'static str = "interface and wall particles";
    const ON_SURFACE: bool = true;

    fn new(_: &Medium, _: &Tank) -> Self {
        InterfaceWall
    }

    fn particles(medium: &Medium, tank: &Tank, support: f64) -> Vec<Particle> {
        let walls = tank.interface_walls(support);
        let mut all = at_rest(medium, walls.interface, Role::Interface);
        all.extend(at_rest(medium, walls.wall, Role::Wall));
        all
    }
}

macro_rules! mirrored_vessel {
    ($($walls:ident = $name:literal),+) => {$(
        impl Vessel for $walls {
            const NAME: &'static str = $name;
            const ON_SURFACE: bool = false;

            fn new(_: &Medium, tank: &Tank) -> Self {
                Self { walls: tank.mirrors() }
            }

            fn particles(_: &Medium, _: &Tank, _: f64) -> Vec<Particle> {
                Vec::new()
            }
        }
    )+};
}

mirrored_vessel!(Ghosts = "ghosts", SlipGhosts = "ghosts along which water slips");

impl Vessel for ExtrapolatingWall<Tait> {
    const NAME: &'static str = "extrapolating wall";
    const ON_SURFACE: bool = false;

    /// Not below 0: above a free surface a wall must not suck the water up.
    fn new(medium: &Medium, _: &Tank) -> Self {
        ExtrapolatingWall::new(medium.eos, medium.gravity).not_below(0.0)
    }

    fn particles(medium: &Medium, tank: &Tank, support: f64) -> Vec<Particle> {
        at_rest(medium, tank.rows_behind(support), Role::Wall)
    }
}

impl Dam {
    /// Checks the settings and derives the rest, for schemes with the terms and walls of `S`.
    pub fn new<S: WaterScheme>(s: &DamSettings, allow_unstable: bool) -> Result<Self, RunError> {
        let too_much =
            |what, value, most, setting| RunError::TooMuch { what, value, most, setting };
        let dx = s.width.min(s.height) / s.n as f64;
        if s.width > s.tank {
            return Err(too_much("the width of the column", s.width, s.tank, "width or tank"));
        }
        let counts = [s.width, s.height].map(|side| (side / dx).round().max(1.0) as usize);
        let spacings = |length: f64| (length / dx).round() as usize;
        let tank = Tank { columns: spacings(s.tank), rows: spacings(s.rim * s.height), dx };
        let all = (counts[0] * counts[1] + 8 * (tank.columns + 2 * tank.rows)) as f64;
        if all > MOST_PARTICLES {
            return Err(too_much("the number of particles", all, MOST_PARTICLES, "n or tank"));
        }
        let fall = (s.gravity * s.height).sqrt();
        let gravity = Vector2::new(0.0, -s.gravity);
        // The front of a dam break in shallow water runs at 2 (g H)^(1/2).
        let medium = Medium::new(s.numerics(), dx, s.c0 * fall, gravity, 2.0 * fall);
        let [dt, dt_limit] = medium.time_step::<S>(allow_unstable)?;
        let steps = s.end * s.height / fall / dt;
        if steps > MOST_STEPS {
            let setting = "end, dt, courant, c0 or n";
            return Err(too_much("the number of time steps", steps, MOST_STEPS, setting));
        }
        let is_front = near_the_floor;
        Ok(Self { settings: s.clone(), medium, tank, counts, dt, dt_limit, is_front })
    }

    /// (H/g)^(1/2) \[s\], the unit of time.
    pub fn unit_time(&self) -> f64 {
        (self.settings.height / self.settings.gravity).sqrt()
    }

    /// ρ g H \[Pa\], the unit of pressure.
    pub fn unit_pressure(&self) -> f64 {
        self.settings.rho * self.settings.gravity * self.settings.height
    }

    /// Whether the scene is that of Martin & Moyce: a column twice as high as wide, on a floor whose end
    /// not even a front of shallow water, at twice (g H)^(1/2), would reach.
    pub fn is_martin_moyce(&self) -> bool {
        let s = &self.settings;
        (s.height / s.width - 2.0).abs() < 1e-9 && s.tank >= s.width + 2.0 * s.end * s.height
    }

    /// Whether the scene is that of Lobovsky et al., at any scale.
    pub fn is_lobovsky(&self) -> bool {
        let s = &self.settings;
        let is = |ratio: f64, expected: f64| (ratio / expected - 1.0).abs() < 1e-9;
        is(s.width / s.height, 2.0) && is(s.tank / s.height, 1.61 / 0.3)
    }

    /// Water in hydrostatic equilibrium with the gate that is about to vanish.
    pub fn water<W: Vessel>(&self) -> Vec<Particle> {
        let s = &self.settings;
        let [columns, rows] = self.counts;
        let first = if W::ON_SURFACE { 1.0 } else { 0.5 };
        // Between two surfaces with particles on them there is one column less.
        let columns = columns - usize::from(W::ON_SURFACE && columns == self.tank.columns);
        let dx = self.medium.dx;
        let surface = (first - 0.5 + rows as f64) * dx;
        let shift = Vector2::repeat(s.shift * dx);
        solver::lattice(Vector2::repeat(first * dx), dx, columns, rows)
            .map(|x| {
                let density = self.medium.eos.density(s.rho * s.gravity * (surface - x.y));
                Particle::fluid(x - shift, Vector2::zeros(), density, dx * dx)
            })
            .collect()
    }

    /// The scene.
    pub fn scene<S: WaterScheme<Walls: Vessel>>(&self) -> Scene<S> {
        let (medium, tank) = (&self.medium, &self.tank);
        let mut particles = self.water::<S::Walls>();
        particles.extend(S::Walls::particles(medium, tank, S::Kernel::SUPPORT * medium.h));
        let forces = S::Forces::new::<S::Kernel>(medium);
        let drift = S::Drift::new::<S::Kernel>(medium);
        let walls = S::Walls::new(medium, tank);
        let mut scene = Scene::new(medium.h, Domain::open(), particles, forces, drift, walls);
        // The fastest water crosses the usual skin in a step or two; lists that last longer are worth
        // their length.
        scene.skin = scene.skin.max(SKIN_STEPS * self.dt * medium.speed);
        // Water that is twice as dense, or as fast as sound, is no water any more.
        let (rho, c0) = (medium.numerics.rho, medium.eos.sound_speed);
        scene.limits =
            Limits { density: [0.5 * rho, 2.0 * rho], speed: c0.max(2.0 * medium.speed) };
        scene
    }
}

#[cfg(test)]
mod tests {
    use harness::{case::Case, context::Context};
    use solver::InterfaceWall;

    use super::*;
    use crate::dam_break::{DAM_BREAK, Modern, Seed, lobovsky};

    fn dam(set: impl FnOnce(&mut DamSettings)) -> Result<Dam, RunError> {
        let spec = DAM_BREAK.spec("modern", set);
        let settings = serde_json::from_value(spec.settings).expect("settings of the case");
        Dam::new::<Modern>(&settings, false)
    }

    #[test]
    fn the_column_fills_its_corner_and_bears_its_weight() {
        let dam = dam(|_| {}).unwrap();
        assert!(dam.is_martin_moyce() && !dam.is_lobovsky());
        for (water, on_surface) in
            [(dam.water::<ExtrapolatingWall<Tait>>(), 0.0), (dam.water::<InterfaceWall>(), 0.5)]
        {
            assert_eq!(water.len(), 800);
            let most = |f: fn(&Particle) -> f64| water.iter().map(f).fold(0.0, f64::max);
            let right = most(|p| p.position.x) + (0.5 - on_surface) * dam.medium.dx;
            assert!((right / 0.05715 - 1.0).abs() < 1e-12);
            let bottom = dam.medium.eos.pressure(most(|p| p.density));
            assert!((bottom / dam.unit_pressure() - 1.0 + 0.5 / 40.0).abs() < 1e-9, "{bottom}");
        }
    }

    #[test]
    fn the_experiments_are_told_apart_at_any_scale() {
        let tank = dam(lobovsky).unwrap();
        assert!(tank.is_lobovsky() && !tank.is_martin_moyce());
        assert!(!dam(|s| s.tank = 0.2).unwrap().is_martin_moyce(), "its end would be reached");
        assert!(dam(|s| (s.width, s.height, s.tank) = (1.0, 2.0, 10.0)).unwrap().is_martin_moyce());
    }

    #[test]
    fn scenes_that_make_no_sense_are_refused_with_their_setting() {
        let is_too_much =
            |set: fn(&mut DamSettings)| matches!(dam(set), Err(RunError::TooMuch { .. }));
        assert!(is_too_much(|s| s.tank = 0.05));
        assert!(is_too_much(|s| (s.n, s.tank) = (2000, 100.0)));
        assert!(is_too_much(|s| s.courant = 1e-6));
        assert!(matches!(dam(|s| s.courant = 2.0), Err(RunError::TimeStep { .. })));
        let unused = DAM_BREAK.spec("modern", |s| s.xsph = 0.25);
        assert!(matches!(
            DAM_BREAK.run(&unused, &Context::default()),
            Err(RunError::Unused { .. })
        ));
        // Without viscosity the predictor-corrector has no stable step.
        let inviscid = DamSettings { alpha: 0.0, ..DamSettings::default() };
        let refused = Dam::new::<Seed<InterfaceWall>>(&inviscid, false);
        assert!(matches!(refused, Err(RunError::TimeStep { .. })));
    }
}
