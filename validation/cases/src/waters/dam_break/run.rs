//! One run of the collapse: from settings to spacing, time step, tank and column; measurements; record.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::record::{MetricKey, Status};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    method::FirstRow,
    pictures,
    snapshot::{Point, Snapshot},
};
use touchstone_maths::{geometry::Tank, metrics::budget::Metered};
use touchstone_schemes::water::WaterMethod;
use touchstone_solver::{DivergenceBounds, EquationOfState};

use super::{
    DamSettings, Experiment,
    measure::{Gauge, Samples},
    metrics::{MASS_ERROR, MOMENTUM_GAP, REACHED},
    reference,
};
use crate::waters::water::{self, Ledger, ledger};

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
    /// Particles of the column along x.
    pub columns: usize,
    /// Particles of the column along y.
    pub rows: usize,
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
        let [columns, rows] = [s.width, s.height].map(|side| (side / dx).round().max(1.0) as usize);
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
        Ok(Self { settings, method, medium, tank, rim, columns, rows, speed, rules })
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
        let Self { columns, rows, .. } = *self;
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

/// Time between samples \[h/(c0 + v)\], rounded to whole steps: powers and forces are integrated over them,
/// and an impact lasts for the time of sound across a few smoothing lengths. With 0.015 (H/g)^(1/2) at any
/// spacing the impact alone left 1e-3 of the energy unaccounted for, at any step.
///
/// For the column of Martin & Moyce, `modern` at n = 20, these samples leave 3.5e-5 of the energy and 1.1e-3
/// of the momentum unaccounted for; samples after every step, which are four times as many, leave 1.7e-5 and
/// 1.5e-5; half as many samples 1.2e-4 and 4.6e-3, half of the bound of the gate on momentum.
const SAMPLE: f64 = 4.0;
/// Largest number of samples.
const MOST_SAMPLES: f64 = 2e4;

/// The settings on which time and memory of a run depend.
const DECISIVE: &str = "end, dt, courant, c0, n or tank";

/// The least Verlet skin \[h\].
const LEAST_SKIN: f64 = 0.12;
/// Steps of the fastest water that the Verlet skin reaches ahead, there and back.
const SKIN_STEPS: f64 = 4.0;

/// The metrics that take pair sweeps of their own.
pub const COSTLY: &[MetricKey] = &{
    let [a, b, c, d, e, f, g] = ledger::METRICS;
    [a, b, c, d, e, f, g, MOMENTUM_GAP]
};

/// All that accumulates over a run.
#[derive(Serialize, Deserialize)]
pub struct Watch {
    gauge: Gauge,
    samples: Samples,
    ledger: Ledger,
    /// Mass of the water at the start \[kg/m\].
    filled: f64,
    /// Indices of the times of the frames of the film.
    frames: Vec<usize>,
}

/// Keeps the particles with their pressure as a frame of the film.
fn picture(dam: &Dam, now: &Snapshot, frame: usize, record: &mut Record) {
    let Ok(density) = now.density() else { return };
    let (height, unit) = (dam.settings.height, dam.unit_pressure());
    let value = |p: &Point| dam.medium.eos.pressure(density.of(p)) / unit;
    let fluid = now.stored().map(|p| (p.position / height, value(&p)));
    let (share, pressure) = (frame as f64 / pictures::FRAMES as f64, ("p", "rho g H"));
    pictures::keep_frame(record, share, "H", pressure, fluid);
}

impl Problem for Dam {
    type Extra = ();
    type Simulation = dyn Metered<()>;
    type Watch = Watch;

    fn method(&self) -> &WaterMethod {
        &self.method
    }

    fn brief(&self) -> Brief {
        let Self { tank, medium, .. } = self;
        let of = &self.method.properties;
        let reach = (of.support * medium.h / medium.dx).ceil();
        let behind = if of.first_row == FirstRow::Nowhere { 0.0 } else { reach };
        let all = (self.columns * self.rows) as f64
            + behind * (tank.columns as f64 + 2.0 * tank.rows as f64);
        let unstable = of.has_no_slip_mirrors.then(|| {
            let allowed = "--allow-unstable: particles of a stretched layer sink through mirrors to which \
                           water sticks; ghosts-slip puts them back";
            let (value, allowed) = (of.walls.into(), allowed.into());
            RunError::Combination { key: "variant", value, allowed }
        });
        let brief = Brief::new(*medium, self.rules, all, DECISIVE)
            .numbers(&self.rules.numbers(self.settings.water.h_over_dx, medium.dx));
        Brief { unstable, ..brief }
    }

    fn times(&self) -> Vec<f64> {
        stops(self).0
    }

    fn scene(&self) -> Result<Parts, RunError> {
        let Self { method, medium, tank, speed, .. } = self;
        let (rho, c0, dx) = (self.settings.water.rho, medium.eos.sound_speed, medium.dx);
        let mut particles = self.water(method.properties.first_row);
        let walls = water::wall_particles(&method.properties, tank, medium);
        particles.extend(walls.into_iter().map(|(place, role)| {
            Particle::fluid(place, Vector2::zeros(), rho, dx * dx).with_role(role)
        }));
        // The fastest water crosses the least skin in a step or two; lists that last longer are worth their
        // length. A step far beyond the limit must not make everything a neighbour of everything.
        let skin = (SKIN_STEPS * self.rules.dt() * speed).clamp(LEAST_SKIN * medium.h, medium.h);
        // Twice the density or the speed of sound is unphysical for water, except for the speed of water that
        // has left over the rim: nothing stops its fall.
        let falling = speed + self.settings.gravity * self.rules.end;
        let fastest = c0.max(2.0 * speed).max(falling);
        let limits = DivergenceBounds { density: [0.5 * rho, 2.0 * rho], speed: fastest };
        let parts = Parts::new(*medium, Domain::open(), particles);
        Ok(Parts { mirrors: tank.mirrors(), skin: Some(skin), limits, ..parts })
    }

    fn watch(&self, _: &Snapshot, start: &Snapshot) -> Watch {
        let support = self.method.properties.support * self.medium.h;
        Watch {
            gauge: Gauge::new(self, support, &|r2| start.weight(r2)),
            samples: Samples::new(),
            ledger: Ledger::default(),
            filled: water_mass(start),
            frames: stops(self).1,
        }
    }

    fn calls(&self, calls: Calls<Self>, output: OptionalOutput) -> Calls<Self> {
        calls
            .when(self.is_lobovsky(), |calls| {
                calls.after_step("pressure gauges", |dam, watch, now| {
                    watch.gauge.after_step(dam, now)
                })
            })
            .at_positions("front and levels", |dam, watch, now, _, _| {
                watch.samples.sample(dam, now);
            })
            .when(output.all, |calls| {
                let name = "energy ledger and momentum";
                calls.of_ours(name, |dam, watch, s| watch.ledger.sample(&dam.medium, s))
            })
            .when(output.particles, |calls| {
                calls.at_positions("picture", |dam, watch, now, k, record| {
                    if let Some(frame) = watch.frames.iter().position(|at| *at == k) {
                        picture(dam, now, frame, record);
                    }
                })
            })
    }

    fn measure(
        &self,
        Watch { gauge, samples, ledger, filled, .. }: Watch,
        end: &Snapshot,
        record: &mut Record,
    ) {
        let DamSettings { gravity, height, .. } = self.settings;
        record.put(REACHED, end.time() / (self.settings.end * self.settings.unit_time()));
        let mass = water_mass(end);
        samples.measure(self, record);
        record.put(MASS_ERROR, (mass / filled - 1.0).abs());
        let of_what = "M g H/2, the potential energy of the column";
        let column = 0.5 * mass * gravity * height;
        ledger.measure(end, column, of_what, record);
        let gap = ledger.unexplained_momentum() / (mass * (gravity * height).sqrt());
        record.put_or_absent(MOMENTUM_GAP, ledger.sampled(end).map(|()| gap));
        if record.status == Status::Completed {
            if self.is_lobovsky() {
                gauge.measure(self, record);
            }
            reference::compare(self, end, record);
        }
    }
}

/// Mass of the water \[kg/m\], added in the order of the scene: the order of storage changes, and with it the
/// last bits.
fn water_mass(now: &Snapshot) -> f64 {
    now.of_moving(|p| p.mass).sum()
}

/// Times of the samples \[s\], ascending, whole numbers of steps apart, so that no step is shortened; and the
/// index of the sample of each frame of the film.
fn stops(dam: &Dam) -> (Vec<f64>, Vec<usize>) {
    let (end, dt) = (dam.settings.end * dam.settings.unit_time(), dam.rules.dt());
    let (h, eos) = (dam.medium.h, dam.medium.eos);
    let crossing = SAMPLE * h / (eos.sound_speed + dam.speed);
    let every = (crossing.max(end / MOST_SAMPLES) / dt).round().max(1.0) * dt;
    let count = (end / every - 0.5).floor().max(0.0) as usize;
    let mut times: Vec<f64> = (0..=count).map(|k| k as f64 * every).collect();
    times.push(end);
    let share = |frame: usize| frame as f64 / pictures::FRAMES as f64;
    let at = |frame| ((share(frame) * end / every).round() as usize).min(times.len() - 1);
    let frames = (0..=pictures::FRAMES).map(at).collect();
    (times, frames)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::waters::dam_break::{DAM_BREAK, columns, lobovsky, metrics};
    use crate::waters::water::{WaterSettings, ledger::WORK_VISCOSITY};
    use touchstone_base::{
        absent::Absent,
        spec::{Measure, RunSpec},
    };
    use touchstone_harness::{case::Case, context::Context, problem::Steps};
    use touchstone_schemes::water as schemes;

    impl Dam {
        /// The numbers of a run of `modern` with settings changed.
        pub fn changed(set: impl FnOnce(&mut DamSettings)) -> Result<Self, RunError> {
            let settings = DAM_BREAK.chosen("modern", set);
            Self::new(&schemes::modern(), &settings)
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
        let dam = Dam::new(&schemes::modern(), &settings).unwrap();
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

    /// The energy ledger takes two fifths of a run, so it is kept only if requested.
    #[test]
    fn a_plain_run_leaves_the_balances_out_and_has_the_same_bits() {
        let spec = DAM_BREAK.spec("modern", |s| (s.n, s.end) = (6, 0.5));
        let run = |spec: &RunSpec| DAM_BREAK.run(spec, &Context::default()).expect("a run");
        let (plain, all) = (run(&spec), run(&spec.clone().measure_all()));
        assert_eq!(plain.state, all.state);
        assert_eq!([&plain, &all].map(Record::measured), [Measure::Headline, Measure::All]);
        for metric in COSTLY.iter().map(|metric| String::from(*metric)) {
            assert_eq!(plain.absent.get(&metric), Some(&Absent::NotAsked), "{metric}");
            assert!(all.metrics.contains_key(&metric), "{metric}");
        }
        assert!(!plain.profiles.contains_key("energy") && all.profiles.contains_key("energy"));
        // Everything else is equal.
        let others = |record: &Record| -> Vec<_> {
            let is_other = |name: &&String| COSTLY.iter().all(|m| String::from(*m) != **name);
            record.metrics.keys().filter(is_other).cloned().collect()
        };
        assert_eq!(others(&plain), others(&all));
        assert!(others(&plain).iter().all(|name| plain.metrics[name] == all.metrics[name]));
    }

    /// Water in the tank of the experiment, whose sensors read after every step, in parts of 512 particles.
    #[test]
    fn measurements_have_the_same_bits_on_any_number_of_threads() {
        let spec = DAM_BREAK.spec("modern", |s| {
            lobovsky(s);
            (s.n, s.end) = (75, 0.02);
        });
        let run = |threads: usize| {
            let context = Context { threads, ..Context::default() };
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let record = pool.install(|| DAM_BREAK.run(&spec, &context)).expect("a run");
            assert!(record.cost.particles >= touchstone_solver::scene::PARALLEL_FROM);
            (record.state, record.metrics, record.profiles)
        };
        let alone = run(1);
        for threads in [2, 3] {
            assert!(run(threads) == alone, "{threads} threads");
        }
    }

    /// Water that has left over the rim may fall for 1.5 s without a divergence by its speed.
    #[test]
    fn water_that_falls_beside_the_tank_is_no_divergence() {
        let run = |end: f64| {
            let spec = DAM_BREAK.spec("modern", |s| (s.n, s.end) = (6, end));
            DAM_BREAK.run(&spec, &Context::default()).expect("a run")
        };
        let record = run(20.0);
        assert_eq!(record.status, Status::Completed);
        assert!(record.value(metrics::SPILLED).is_some_and(|share| share > 0.0));
        // Only its speed exceeds the limit: the rest of the water is slower.
        assert!(record.value(metrics::MACH).is_some_and(|mach| mach < 0.3));
    }

    /// A run of the case, whose column is 2000 kg/m^3 times the square of its width heavy.
    #[test]
    fn a_run_is_measured_in_the_units_of_its_column() {
        let spec = DAM_BREAK.spec("modern", |s| (s.n, s.end) = (6, 0.5)).measure_all();
        let record = DAM_BREAK.run(&spec, &Context::default()).expect("a run");
        let value =
            |metric: touchstone_base::record::MetricKey| record.value(metric).expect("a metric");
        assert_eq!((value(metrics::REACHED), value(metrics::MASS_ERROR)), (1.0, 0.0));
        let (a, g) = (0.05715_f64, 9.81);
        let fall = 0.5 * (2000.0 * a * a) * g * (2.0 * a);
        let work = record.column(ledger::column(WORK_VISCOSITY)).last().expect("a series") / fall;
        assert!((value(WORK_VISCOSITY) / work - 1.0).abs() < 5e-3, "{work}");
        let front = reference::front(&record);
        let (t, z) = front[front.len() - 1];
        assert!((t / (0.5 * 2.0) - 1.0).abs() < 1e-9, "0.5 (H/g)^(1/2) is T = 1, not {t}");
        let start = record.column(columns::FRONT)[0];
        assert!((start / a - 1.0).abs() < 1e-12 && (front[0].1 - 1.0).abs() < 1e-12 && z > 1.05);
    }
}
