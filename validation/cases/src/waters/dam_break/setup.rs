//! From settings to a scene: spacing, time step, tank, column.

use nalgebra::Vector2;
use touchstone_harness::method::FirstRow;
use touchstone_harness::prelude::*;
use touchstone_maths::geometry::Tank;
use touchstone_schemes::water::WaterMethod;
use touchstone_solver::EquationOfState;

use super::{DamSettings, Experiment};
use crate::waters::water;

/// The numbers of one run.
pub struct Dam {
    /// As given.
    pub settings: DamSettings,
    /// The method that they are for.
    pub method: WaterMethod,
    /// Water, gravity, smoothing length.
    pub medium: Medium,
    /// The tank.
    pub tank: Tank,
    /// Height of the walls, over which water may leave the tank \[m\]; infinite for mirrors.
    pub rim: f64,
    /// Particles of the column along x and y.
    pub counts: [usize; 2],
    /// The largest speed expected \[m/s\].
    pub speed: f64,
    /// Time step and its theoretical limit.
    pub rules: Rules,
}

impl Dam {
    /// Checks the settings and derives the rest for a method.
    pub fn new(method: &WaterMethod, s: &DamSettings) -> Result<Self, RunError> {
        let dx = s.width.min(s.height) / s.n as f64;
        if s.width > s.tank {
            let (what, setting) = ("the width of the column", "width or tank");
            return Err(RunError::TooMuch { what, value: s.width, most: s.tank, setting });
        }
        let counts = [s.width, s.height].map(|side| (side / dx).round().max(1.0) as usize);
        let spacings = |length: f64| (length / dx).round() as usize;
        let tank = Tank { columns: spacings(s.tank), rows: spacings(s.rim * s.height), dx };
        let is_endless = method.properties.first_row == FirstRow::Nowhere;
        let rim = if is_endless { f64::INFINITY } else { tank.rows as f64 * dx };
        let fall = (s.gravity * s.height).sqrt();
        // The front of a dam break in shallow water runs at 2 (g H)^(1/2).
        let speed = 2.0 * fall;
        let end = s.end * s.height / fall;
        let scales = water::WaterScales { dx, c0: s.c0 * fall, gravity: s.gravity, speed, end };
        let (medium, rules) = s.water.medium(method, scales);
        let (settings, method) = (s.clone(), method.clone());
        Ok(Self { settings, method, medium, tank, rim, counts, speed, rules })
    }

    /// ρ g H \[Pa\], the unit of pressure.
    pub fn unit_pressure(&self) -> f64 {
        self.settings.water.rho * self.settings.gravity * self.settings.height
    }

    /// Whether the scene is the experiment of Martin & Moyce.
    pub fn is_martin_moyce(&self) -> bool {
        self.settings.scene() == Some(Experiment::MartinMoyce)
    }

    /// Whether the scene is the experiment of Lobovsky et al.
    pub fn is_lobovsky(&self) -> bool {
        self.settings.scene() == Some(Experiment::Lobovsky)
    }

    /// Water in hydrostatic equilibrium with the gate that is about to vanish.
    pub fn water(&self, walls: FirstRow) -> Vec<Particle> {
        let s = &self.settings;
        let [columns, rows] = self.counts;
        // Between two surfaces with particles on them there is one column less.
        let is_full = walls == FirstRow::OnSurface && columns == self.tank.columns;
        let columns = columns - usize::from(is_full);
        let (first, dx) = (walls.fluid(), self.medium.dx);
        let surface = (first - 0.5 + rows as f64) * dx;
        let offset = Vector2::repeat(s.offset * dx);
        touchstone_solver::lattice(Vector2::repeat(first * dx), dx, columns, rows)
            .map(|x| {
                let density = self.medium.eos.density(s.water.rho * s.gravity * (surface - x.y));
                Particle::fluid(x - offset, Vector2::zeros(), density, dx * dx)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use touchstone_base::spec::RunSpec;
    use touchstone_harness::{case::Case, context::Context, problem::Steps};

    use super::*;
    use crate::waters::dam_break::{DAM_BREAK, lobovsky};
    use crate::waters::water::WaterSettings;
    use touchstone_schemes::water;

    impl Dam {
        /// The numbers of a run of `modern` with settings changed.
        pub fn changed(set: impl FnOnce(&mut DamSettings)) -> Result<Self, RunError> {
            let settings = DAM_BREAK.chosen("modern", set);
            Self::new(&water::modern(), &settings)
        }
    }

    /// Particles that sink through the floor are lost, which only the metric `outside` shows.
    #[test]
    fn mirrors_to_which_water_sticks_are_refused_unless_asked_for() {
        let refused = |variant, spec: RunSpec| {
            let settings = DAM_BREAK.chosen(variant, |_| {});
            let spec = RunSpec { variant: variant.into(), ..spec };
            let spec = RunSpec { settings: touchstone_base::settings::to_json(&settings), ..spec };
            let posed = DAM_BREAK.pose(&spec).expect("a run");
            posed.size(&spec, Steps::All, true).err().map(|error| error.to_string())
        };
        let words = refused("ghosts", RunSpec::default()).expect("refused");
        assert!(words.contains("variant is ghosts") && words.contains("ghosts-slip"), "{words}");
        assert_eq!(refused("ghosts", RunSpec::default().allow_unstable()), None);
        assert_eq!(refused("ghosts-slip", RunSpec::default()), None);
    }

    #[test]
    fn the_column_fills_its_corner_and_bears_its_weight() {
        let dam = Dam::changed(|_| {}).unwrap();
        assert!(dam.is_martin_moyce() && !dam.is_lobovsky());
        assert!((dam.settings.unit_time() - (0.1143_f64 / 9.81).sqrt()).abs() < 1e-12);
        assert!((dam.unit_pressure() - 1121.283).abs() < 1e-3);
        for (water, on_surface) in
            [(dam.water(FirstRow::Behind), 0.0), (dam.water(FirstRow::OnSurface), 0.5)]
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
        let tank = Dam::changed(lobovsky).unwrap();
        assert!(tank.is_lobovsky() && !tank.is_martin_moyce());
        assert!(
            !Dam::changed(|s| s.tank = 0.2).unwrap().is_martin_moyce(),
            "its end would be reached"
        );
        assert!(
            Dam::changed(|s| (s.width, s.height, s.tank) = (1.0, 2.0, 10.0))
                .unwrap()
                .is_martin_moyce()
        );
    }

    /// A step of 167 s, allowed by --allow-unstable, made lists of a million neighbours for a million
    /// particles.
    #[test]
    fn a_step_far_beyond_the_limit_does_not_widen_the_lists_without_end() {
        let water = WaterSettings { dt: Some(167.0), ..WaterSettings::default() };
        let settings = DamSettings { water, ..DamSettings::default() };
        let dam = Dam::new(&water::modern(), &settings).unwrap();
        assert_eq!(dam.scene().expect("a scene").skin, Some(dam.medium.h));
    }

    /// A front of shallow water runs at 2 (g H)^(1/2), and water that has left the tank falls by g t.
    #[test]
    fn a_speed_is_a_divergence_beyond_that_of_sound_and_of_a_fall() {
        let most = |end: f64| {
            let dam = Dam::changed(|s| (s.c0, s.end) = (10.0, end)).unwrap();
            let fall = (9.81 * 0.1143_f64).sqrt();
            dam.scene().expect("a scene").limits.speed / fall
        };
        for (end, expected) in [(1.8, 10.0), (7.9, 10.0), (20.0, 22.0)] {
            assert!((most(end) / expected - 1.0).abs() < 1e-12, "{end}: {}", most(end));
        }
    }

    #[test]
    fn scenes_that_make_no_sense_are_refused_with_their_setting() {
        let refused = |variant, set: fn(&mut DamSettings)| {
            let spec = DAM_BREAK.spec(variant, set);
            DAM_BREAK.pose(&spec).expect("a run").size(&spec, Steps::All, false)
        };
        let is_too_much = |set| matches!(refused("modern", set), Err(RunError::TooLong { .. }));
        assert!(matches!(Dam::changed(|s| s.tank = 0.05), Err(RunError::TooMuch { .. })));
        assert!(is_too_much(|s| (s.n, s.tank) = (2000, 100.0)));
        assert!(is_too_much(|s| s.water.courant = 1e-6));
        let unstable = refused("modern", |s| s.water.courant = 2.0);
        assert!(matches!(unstable, Err(RunError::TimeStep { .. })));
        let unused = DAM_BREAK.spec("modern", |s| s.water.xsph = 0.25);
        assert!(matches!(
            DAM_BREAK.run(&unused, &Context::default()),
            Err(RunError::Unused { .. })
        ));
        // Without viscosity the predictor-corrector has no stable step.
        let inviscid = refused("seed", |s| s.water.alpha = 0.0);
        assert!(matches!(inviscid, Err(RunError::TimeStep { .. })));
    }
}
