//! A free elastic disk that spins: is a rotation a rotation to the method?

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::absent::Absent;
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::Statement,
    snapshot::{Snapshot, momentum},
    studies::{Accuracy, Budgets, Change, Spacing},
    table::{Row, Table},
};
use touchstone_maths::metrics::history;
use touchstone_solver::Symmetric;

use super::{
    causes::FREE_FACES,
    solid::{
        self, ElasticBody, ElasticEnergy, LAGRANGIAN, SolidParameters, SolidScales, SolidSettings,
        Watch, angular_momentum, norm_squared,
    },
};

touchstone_base::settings! {
    /// Settings of a disk cut from a square lattice.
    pub struct DiskSettings {
        /// spacings along the radius
        n: usize ["-"] in 3..=1000 = 8,
        /// radius
        radius: f64 ["m"] in 1e-9..=1e6 = 0.04,
        /// speed of the rim
        speed: f64 ["c0"] in 1e-6..=0.5 = 0.05,
        /// end of the run, in revolutions of a rigid disk
        end: f64 ["revolutions"] in 1e-4..=1e4 = 1.0,
        /// settings of solids
        solid: SolidSettings = SolidSettings::default(),
    }
}

/// A spinning disk.
pub static SPINNING_DISK: Composed<DiskSettings> = Composed {
    name: "spinning_disk",
    problem: "A free elastic disk spins",
    recommended: Recommended {
        variant: LAGRANGIAN,
        because: "it conserves angular momentum to round-off; the paper's disk loses all of its spin",
        papers: Some("seed"),
    },
    about: "A free elastic disk begins to spin without stress. Angular momentum must be conserved, and \
            stress must stay of the order rho U^2, with U the speed of the rim; more stress means that the \
            method mistakes rotation for strain.",
    variants: || solid::variants(touchstone_schemes::solid::free()).all,
    facts,
    studies,
};

touchstone_base::metrics! {
    all ALL;
    INTERIOR_STRAIN = "interior_strain" ["-"]
        "largest ((S_xx - S_yy)^2/2 + 2 S_xy^2)^(1/2)/(2 mu dt) over the spin after one step, of particles \
         farther than 4 h + dx from the rim";
    RIM_STRAIN = "rim_strain" ["-"] "root mean square of the same for the other particles";
    ANGULAR_MOMENTUM_DRIFT = "angular_momentum_drift" ["-"]
        "|angular momentum at the end over that at the start - 1|, a revolution";
    ANGULAR_MOMENTUM_TENTH = "angular_momentum_tenth" ["-"]
        "angular momentum after a tenth of a revolution over that at the start, minus 1";
    LARGEST_STRESS = "largest_stress" ["-"] "largest (mean S:S)^(1/2) over rho U^2";
    ENERGY_DRIFT = "energy_drift" ["-"] "change of energy, a revolution";
    MOMENTUM_ERROR = "momentum_error" ["-"] "|sum m v|/(sum m times the speed of the rim)";
}

/// Samples of the series.
const SAMPLES: f64 = 200.0;
/// When the angular momentum is first sampled, of a revolution.
const TENTH: f64 = 0.1;

impl ElasticBody for DiskSettings {
    type Watch = DiskHistory;

    fn common(&self) -> SolidParameters {
        self.solid.common()
    }

    fn scales(&self) -> SolidScales {
        let speed = self.speed * self.material().sound_speed();
        SolidScales {
            dx: self.radius / self.n as f64,
            length: 2.0 * self.radius,
            speed,
            end: self.end * TAU * self.radius / speed,
            count: PI * (self.n as f64).powi(2),
            decisive: "end, dt or n",
            ..SolidScales::default()
        }
    }

    /// Around the origin, without stress.
    fn particles(&self) -> Vec<Particle<Symmetric>> {
        let (dx, side) = (self.dx(), 2 * self.n + 1);
        let (spin, density) = (self.speed() / self.radius, self.material().density);
        touchstone_solver::lattice(Vector2::repeat(-self.radius), dx, side, side)
            .filter(|x| x.norm() <= self.radius * (1.0 + 1e-9))
            .map(|x| Particle::fluid(x, Vector2::new(-x.y, x.x) * spin, density, dx * dx))
            .collect()
    }

    fn watch(&self, scene: &Snapshot<Symmetric>, _: &Snapshot<Symmetric>) -> DiskHistory {
        DiskHistory::new(self, scene)
    }
}

/// History of the disk.
#[derive(Serialize, Deserialize)]
pub struct DiskHistory {
    /// \[kg/m\].
    mass: f64,
    until: f64,
    series: Vec<SpinSample>,
    /// The shear after the first step, and the step \[s\].
    first: Option<(MistakenShear, f64)>,
}

/// The disk at a time.
#[derive(Clone, Serialize, Deserialize)]
struct SpinSample {
    /// \[s\].
    time: f64,
    /// Angular momentum \[kg m/s\].
    spin: f64,
    /// Total energy \[J/m\].
    energy: Result<f64, Absent>,
    /// Mean square of the deviatoric stress \[Pa²\].
    stress: Result<f64, Absent>,
}

impl DiskHistory {
    fn new(s: &DiskSettings, scene: &Snapshot<Symmetric>) -> Self {
        let start = scene.all();
        let spin = start.iter().map(|p| p.mass * p.position.perp(&p.velocity)).sum();
        let (mass, until) = (start.iter().map(|p| p.mass).sum(), s.end() / SAMPLES);
        let energy = ElasticEnergy::of_points(start.into_iter(), scene, &s.material());
        let energy = energy.map(|energy| energy.total());
        let start = SpinSample { time: 0.0, spin, energy, stress: Ok(0.0) };
        Self { mass, until, series: vec![start], first: None }
    }

    fn sample(&mut self, s: &DiskSettings, now: &Snapshot<Symmetric>) {
        let mean = now.stress().map(|stress| {
            let (mut mass, mut sum) = (0.0, 0.0);
            for p in now.stored() {
                mass += p.mass;
                sum += p.mass * norm_squared(&stress.of(&p));
            }
            sum / mass
        });
        let energy = ElasticEnergy::of(now, &s.material()).map(|energy| energy.total());
        let spin = angular_momentum(now);
        // A sample after the last step, when the velocities of a leapfrog lag, is replaced by the
        // synchronised one.
        self.series.pop_if(|last| last.time == now.time());
        self.series.push(SpinSample { time: now.time(), spin, energy, stress: mean });
    }
}

/// The square of the shear in the plane of a disk that rotates \[Pa²\].
#[derive(Clone, Copy, Serialize, Deserialize)]
struct MistakenShear {
    /// The largest inside.
    inside: f64,
    /// The mean in the rim.
    rim: f64,
}

/// The shear inside of this radius and outside. A step along tangents dilates a rotation by (W dt)²/2,
/// without shear.
///
/// # Errors
/// Without stresses.
fn mistaken(now: &Snapshot<Symmetric>, radius: f64) -> Result<MistakenShear, Absent> {
    let (mut inside, mut rim, mut count) = (0.0_f64, 0.0, 0.0);
    let stress = now.stress()?;
    for p in now.stored() {
        let Symmetric { xx, yy, xy } = stress.of(&p);
        let square = 0.5 * (xx - yy) * (xx - yy) + 2.0 * xy * xy;
        if p.position.norm() < radius {
            inside = inside.max(square);
        } else {
            (rim, count) = (rim + square, count + 1.0);
        }
    }
    Ok(MistakenShear { inside, rim: rim / count })
}

impl Watch<DiskSettings> for DiskHistory {
    fn after_step(&mut self, s: &DiskSettings, now: &Snapshot<Symmetric>) {
        if let (None, Ok(simulation)) = (self.first, now.simulation()) {
            // One support for the gradient, one for the neighbours that XSPH has moved before it.
            let interior = s.radius - 4.0 * (s.solid.h_over_dx * s.dx()) - s.dx();
            let mistaken = mistaken(now, interior).ok();
            self.first = mistaken.map(|strain| (strain, simulation.dt()));
        }
        if now.time() >= self.until {
            self.until += s.end() / SAMPLES;
            self.sample(s, now);
        }
    }

    fn measure(mut self, s: &DiskSettings, end: &Snapshot<Symmetric>, record: &mut Record) {
        self.sample(s, end);
        let (material, speed) = (s.material(), s.speed());
        let scale = material.density * speed * speed;
        metrics(&self.series, s.end, scale, record);
        let tenth = s.end > TENTH;
        let tenth = tenth.then(|| momentum_at(&self.series, TENTH / s.end * s.end()));
        let short = "the run is not longer than a tenth of a revolution";
        record.put_or(ANGULAR_MOMENTUM_TENTH, tenth, short);
        let unknown = MistakenShear { inside: f64::NAN, rim: f64::NAN };
        let (MistakenShear { inside, rim }, dt) = self.first.unwrap_or((unknown, 1.0));
        let scale = 2.0 * material.shear * speed / s.radius;
        record.put(INTERIOR_STRAIN, inside.sqrt() / (scale * dt));
        record.put(RIM_STRAIN, rim.sqrt() / (scale * dt));
        let momentum = momentum(&end.all()).norm();
        record.put(MOMENTUM_ERROR, momentum / (self.mass * speed));
    }
}

/// Angular momentum at a time \[s\], between two samples of the series, over that at the start, minus 1; NaN
/// outside of the series.
fn momentum_at(series: &[SpinSample], time: f64) -> f64 {
    let spins: Vec<(f64, f64)> = series.iter().map(|at| (at.time, at.spin)).collect();
    let found = history::differences(&spins, &[(time, 0.0)]).map_or(f64::NAN, |found| found[0]);
    found / series[0].spin - 1.0
}

fn metrics(series: &[SpinSample], revolutions: f64, scale: f64, record: &mut Record) {
    let (first, last) = (&series[0], &series[series.len() - 1]);
    let drift = (last.spin / first.spin - 1.0).abs() / revolutions;
    record.put(ANGULAR_MOMENTUM_DRIFT, drift);
    let squares = series.iter().map(|at| at.stress.clone()).collect::<Result<Vec<f64>, Absent>>();
    let largest = squares.map(|all| all.into_iter().fold(0.0, f64::max).sqrt() / scale);
    record.put_or_absent(LARGEST_STRESS, largest);
    let energies = series.iter().map(|at| at.energy.clone()).collect::<Result<Vec<f64>, Absent>>();
    let change = energies.map(|all| all[all.len() - 1] / all[0] - 1.0);
    record.put_or_absent(ENERGY_DRIFT, change.map(|change| change / revolutions));
    let column = |name, unit| ColumnKey::new("spin", name, unit);
    let spin = column("angular momentum", "of the start");
    record.put_column(column("t", "s"), series, |at| at.time);
    record.put_column(spin, series, |at| at.spin / first.spin);
    record.put_known_column(column("energy", "of the start"), series, |at| {
        Ok(at.energy.clone()? / first.energy.clone()?)
    });
    record.put_known_column(column("stress", "rho U^2"), series, |at| {
        Ok(at.stress.clone()?.sqrt() / scale)
    });
}

/// Purpose of a run.
#[derive(Clone, Copy, PartialEq)]
enum Group {
    /// How fast the stress in the rim brakes the disk.
    Braked,
    /// Gradients that are exact for linear fields, and forces that derive from an energy, keep it spinning.
    Kept,
    /// The order alone.
    Order,
    /// Whether the time step matters: a tenth of a revolution at Courant numbers.
    Steps,
}

/// Every run.
fn table(tier: Tier) -> Table<DiskSettings, Group> {
    let spacings = |s: &mut DiskSettings, n| s.n = n;
    let mut table = Table::new(&SPINNING_DISK, tier);
    table.over(Group::Braked, &["seed", "bare"], [&[8], &[8]], spacings);
    table.over(Group::Order, &["seed"], [&[4], &[4, 16]], spacings);
    table.over(Group::Order, &["bare"], [&[4, 16], &[4, 16]], spacings);
    table.over(Group::Order, &[LAGRANGIAN], [&[4, 8, 16]; 2], spacings);
    table.over(Group::Kept, &[LAGRANGIAN], [&[8], &[8]], |s, n| (s.n, s.end) = (n, 10.0));
    table.over(Group::Steps, &["bare"], [&[0.4, 0.1, 0.8], &[0.4, 0.1, 0.8]], |s, courant| {
        (s.n, s.end, s.solid.courant) = (8, 0.1, Some(courant));
    });
    table.judge(gates);
    table
}

/// How fast a disk is braked at first.
const BRAKED: &str = "The bound: disks of 4 spacings lose 1.9 % of their angular momentum in a tenth of a \
    revolution without viscosity and 13 % with it, and the loss falls at least as fast as the width of the \
    rim.";

/// Largest change of the angular momentum.
const REVERSED: &str = "The disk can spring back. The bound: the square of the angular momentum is at most \
    twice the moment of inertia times the energy, which grows by at most 5 %.";

/// How large the stress can become.
const ALL_SHEAR: &str = "The stress grows at the expense of kinetic energy. The bound: all of it, rho U^2/4 \
    per area, and 5 % more, stored as energy of shear, S:S/(4 mu).";

/// Gates of all disks, and of disks that keep spinning or do not.
fn gates(row: &Row<DiskSettings, Group>) -> Vec<Gate> {
    if matches!(row.group, Group::Order | Group::Steps) {
        return Vec::new();
    }
    let (s, variant) = (&row.settings, row.variant);
    let gates = SPINNING_DISK.gates(format!("{variant}.{}", s.n));
    let opposite =
        "Forces of pairs are equal and opposite, central or not, so only round-off is left.";
    let no_strain = "Where gradients are exact for linear fields, a rotation has no strain. Round-off \
                     remains, divided by the angle of one step, 1e-3 to 1e-2 rad.";
    let noticed = "A free body keeps its angular momentum. A change of 1 % per revolution, or of 0.1 % in a \
                   tenth of it, would not be noticed in colliding rings. Forces that derive from an energy \
                   have no torque but round-off.";
    let stressed = "A disk that spins steadily in plane strain has a root-mean-square deviatoric stress of \
                    about 0.1 rho U^2. After a start without stress it oscillates up to twice that; the \
                    bound is twice this maximum.";
    let is_braked = row.group == Group::Braked;
    let [tenth, drift] = if is_braked { [1e-3, 1e-2] } else { [1e-11; 2] };
    let tenth = gates.invariant(ANGULAR_MOMENTUM_TENTH, Bound::magnitude(tenth), noticed);
    let drift = gates.invariant(ANGULAR_MOMENTUM_DRIFT, Bound::Below(drift), noticed);
    let stress = gates.theory(LARGEST_STRESS, Bound::Below(0.4), stressed);
    let mut all = vec![
        gates.invariant(MOMENTUM_ERROR, Bound::Below(1e-12), opposite),
        gates.invariant(INTERIOR_STRAIN, Bound::Below(1e-10), no_strain),
    ];
    if is_braked {
        let first = -if variant == "bare" { 0.08 } else { 0.53 } / s.n as f64;
        all.extend([
            tenth.with_limitation(Bound::Within(first, 0.001), BRAKED, &FREE_FACES).fitted(),
            drift.with_limitation(Bound::Below(2.1), REVERSED, &FREE_FACES),
            stress.with_limitation(Bound::Below(9.6), ALL_SHEAR, &FREE_FACES),
        ]);
        return all;
    }
    let energy = "The forces derive from the stored energy; the leapfrog keeps it within (omega dt)^2/8 of \
                  the share of the energy that is in waves, about 1e-3.";
    let rim = gates.invariant(RIM_STRAIN, Bound::Below(1e-10), no_strain);
    let energy = gates.theory(ENERGY_DRIFT, Bound::magnitude(1e-4), energy);
    all.extend([tenth, drift, rim, stress, energy]);
    all
}

fn studies(tier: Tier) -> Studies {
    let table = table(tier);
    let error = ANGULAR_MOMENTUM_DRIFT;
    let spacing = Spacing::count(|s: &mut DiskSettings| &mut s.n, "n = {}");
    let accuracy = Accuracy {
        about:
            "A free disk, rim at 0.05 c0, makes one revolution; exactly, angular momentum stays."
                .into(),
        spacing: "dx/R [-]",
        slope: None,
        ladders: table.ladders(
            &[Group::Braked, Group::Order],
            &["seed", "bare", LAGRANGIAN],
            spacing,
        ),
        ..Accuracy::new("spinning-disk", error, "change of angular momentum a revolution [-]")
    };
    let changes = ["none", "dt/4", "2 dt"].into_iter().zip(table.specs(Group::Steps));
    let changes = changes.map(|(what, spec)| Change::new(what, "time", spec)).collect();
    let about = "A free disk, rim at 0.05 c0, makes a tenth of a revolution.";
    let budgets = Budgets::new(&accuracy, about, vec![changes]);
    Studies::judging(table.plan()).with(accuracy).with(budgets)
}

fn facts() -> Facts {
    Facts {
        statement: Statement::new("No force acts on the rim.", &[ALL]),
        stepwise: &[INTERIOR_STRAIN, RIM_STRAIN, ANGULAR_MOMENTUM_TENTH, LARGEST_STRESS],
        ..Facts::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_harness::{
        case::{Case, RunError},
        context::Context,
    };

    /// c0 is 57.02 m/s, so 0.05 c0 is 2.851 m/s.
    #[test]
    fn the_disk_spins_with_the_speed_of_its_rim() {
        let s = DiskSettings::default();
        let particles = s.particles();
        let rim =
            particles.iter().find(|p| p.position.x == s.radius).expect("a particle at the rim");
        let [x, y] = [rim.velocity.x, rim.velocity.y];
        assert!(x == 0.0 && (y / 2.851 - 1.0).abs() < 1e-3, "{x} {y} m/s");
        let DiskHistory { mass, series, .. } = DiskHistory::new(&s, &Snapshot::of(0.0, &particles));
        let SpinSample { spin: found, ref energy, .. } = series[0];
        let energy = energy.clone().expect("densities and stresses");
        let spin = 2.851 / 0.04;
        let inertia = mass * 0.5 * 0.04 * 0.04;
        assert!((found / (inertia * spin) - 1.0).abs() < 0.05, "R^2/2 in the mean");
        assert!((energy / (0.5 * found * spin) - 1.0).abs() < 2e-3);
        assert!((s.end() / (TAU * 0.04 / 2.851) - 1.0).abs() < 1e-3);
    }

    /// Shear 2 inside, where one particle has 5, and 3 in the rim.
    #[test]
    fn the_strain_of_the_rim_is_that_of_its_particles() {
        let s = DiskSettings { n: 4, ..DiskSettings::default() };
        let mut particles = s.particles();
        for p in &mut particles {
            let shear = if p.position.norm() < 0.03 { 2.0 } else { 3.0 };
            p.extra.xy = shear * 0.5_f64.sqrt();
        }
        let centre = particles
            .iter_mut()
            .min_by(|a, b| a.position.norm_squared().total_cmp(&b.position.norm_squared()));
        centre.expect("particles").extra = Symmetric { xx: 5.0, yy: -5.0, xy: 0.0 };
        let found = mistaken(&Snapshot::of(0.0, &particles), 0.03).expect("stresses");
        let MistakenShear { inside, rim } = found;
        assert!((inside - 50.0).abs() < 1e-12 && (rim - 9.0).abs() < 1e-12, "{inside} {rim}");
    }

    /// A disk that stopped passed: its angular momentum changed by less than 2.2 a revolution.
    #[test]
    fn a_disk_that_stops_fails() {
        let sample = |time: f64, spin: f64, stress: f64| SpinSample {
            time,
            spin,
            energy: Ok(5.0),
            stress: Ok(stress),
        };
        let rows = |left: f64| -> Vec<SpinSample> {
            let row = |k: i32| {
                let share = 0.01 * f64::from(k);
                sample(2.0 * share, 3.0 * (1.0 - (1.0 - left) * share), 4.0 * share)
            };
            (0..=100).map(row).collect()
        };
        let mut record = Record::new("spinning_disk", "made-up", serde_json::Value::Null, 1);
        metrics(&rows(0.2), 0.5, 10.0, &mut record);
        let metric = |name| record.value(name).expect("measured");
        assert!((metric(ANGULAR_MOMENTUM_DRIFT) - 1.6).abs() < 1e-12, "0.8 in half a revolution");
        assert!((metric(LARGEST_STRESS) - 0.2).abs() < 1e-12);
        let found = momentum_at(&rows(0.2), 0.405);
        assert!((found + 0.8 * 0.2025).abs() < 1e-12);
        let stopped = [sample(0.0, 3.0, 0.0), sample(0.01, 0.0, 0.0), sample(2.0, 0.0, 0.0)];
        let change = momentum_at(&stopped, 0.2);
        let fails = |gate: &Gate| gate.judge(Some(change)).verdict.is_failure();
        for planned in table(Tier::Full).plan().iter().filter(|planned| !planned.gates.is_empty()) {
            let name = String::from(ANGULAR_MOMENTUM_TENTH);
            let gates = planned.gates.iter().filter(|gate| gate.metric == name);
            assert_eq!(gates.filter(|gate| fails(gate)).count(), 1);
        }
    }

    #[test]
    fn a_rotation_is_no_strain_where_no_neighbour_is_missing() {
        for variant in ["bare", "seed"] {
            let spec = SPINNING_DISK.spec(variant, |s| (s.end, s.n) = (0.002, 10));
            let record = SPINNING_DISK.run(&spec, &Context::default()).expect("a run");
            let metric = |name| record.value(name).expect("measured");
            assert!(metric(INTERIOR_STRAIN) < 1e-10, "{}", metric(INTERIOR_STRAIN));
            assert!(metric(RIM_STRAIN) > 1e-3, "{}", metric(RIM_STRAIN));
            assert!(metric(MOMENTUM_ERROR) < 1e-13);
        }
    }

    #[test]
    fn a_disk_that_makes_no_sense_is_refused() {
        let refused = |set| solid::tests::refused(&SPINNING_DISK, "seed", set);
        assert!(matches!(refused("n=2"), Some(RunError::Setting(_))));
        assert!(matches!(refused("speed=0.9"), Some(RunError::Setting(_))));
        assert!(matches!(refused("dt=1"), Some(RunError::TimeStep { .. })));
        assert!(matches!(refused("dt=1e-15"), Some(RunError::TooLong { .. })));
    }
}
