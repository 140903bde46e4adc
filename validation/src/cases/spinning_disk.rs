//! A free elastic disk that spins: is a rotation a rotation to the method?

use nalgebra::Vector2;
use solver::Symmetric;
use solver::{Domain, Flow, Observer, Open, Particle, Scene, Scheme as SolverScheme, Simulation};

use super::solid::{
    Energy, Material, Method, Problem, Ran, Scheme, angular_momentum, describe, digest,
    norm_squared, run_to,
};
use crate::{
    case::{Planned, RunError, Tier},
    gate::{Bound, Evidence, Gate},
    record::{Metric, Profile, Record},
    report::{Cell, Column, Table},
    runner::Context,
    suite::{JudgedRun, Study},
};

crate::solid_settings! {
    /// Settings of a disk cut from a square lattice.
    pub struct DiskSettings {
        /// spacings along the radius
        n: usize ["-"] in 3..=1000 = 8,
        /// radius
        radius: f64 ["m"] in 1e-9..=1e6 = 0.04,
        /// speed of the rim
        speed: f64 ["c0"] in 1e-6..=0.5 = 0.05,
        /// end of the run, of a rigid disk
        end: f64 ["revolutions"] in 1e-4..=1e4 = 1.0,
    }
}

/// The problem.
pub struct SpinningDisk;

/// Samples of the series.
const SAMPLES: f64 = 200.0;

/// Particles around the origin that spin without stress.
fn particles(s: &DiskSettings, material: &Material) -> Vec<Particle<Symmetric>> {
    let (dx, side) = (s.radius / s.n as f64, 2 * s.n + 1);
    let spin = s.speed * material.sound_speed() / s.radius;
    solver::lattice(Vector2::repeat(-s.radius), dx, side, side)
        .filter(|x| x.norm() <= s.radius * (1.0 + 1e-9))
        .map(|x| Particle::fluid(x, Vector2::new(-x.y, x.x) * spin, material.density, dx * dx))
        .collect()
}

/// What is seen through time.
struct Seen {
    material: Material,
    until: f64,
    every: f64,
    /// t \[s\], angular momentum, energy, mean square of the deviator, mean square radius.
    series: Vec<[f64; 5]>,
}

impl Seen {
    fn look<S: SolverScheme<Extra = Symmetric>>(&mut self, simulation: &Simulation<S>) {
        let (mut mass, mut stress, mut radius) = (0.0, 0.0, 0.0);
        for (m, p) in simulation.fluid() {
            mass += m;
            stress += m * norm_squared(&p.extra);
            radius += m * p.position.norm_squared();
        }
        let energy = Energy::of(simulation, &self.material).total();
        let spin = angular_momentum(simulation);
        self.series.push([simulation.time(), spin, energy, stress / mass, radius / mass]);
    }
}

impl<S: SolverScheme<Extra = Symmetric>> Observer<S> for Seen {
    fn after_step(&mut self, simulation: &Simulation<S>) -> Flow {
        if simulation.time() >= self.until {
            self.until += self.every;
            self.look(simulation);
        }
        Flow::Continue
    }
}

impl Problem for SpinningDisk {
    const NAME: &'static str = "spinning_disk";
    const ABOUT: &'static str = "A free elastic disk spins, at the start without stress. Angular momentum \
        stays, and the stress stays of the order rho U^2 of the speed U of the rim: what else appears is \
        rotation that the method mistook for strain.";
    type Settings = DiskSettings;

    fn run<M: Method>(
        variant: &str,
        settings: &DiskSettings,
        context: &Context,
    ) -> Result<Record, RunError> {
        let (s, solid) = (settings, settings.solid());
        let material = solid.material;
        let (dx, speed) = (s.radius / s.n as f64, s.speed * material.sound_speed());
        let dt = solid.time_step(dx, speed, M::COURANT, context)?;
        let mut record = describe::<Self, M>(variant, settings, &solid, [dx, dt], context);
        let (forces, drift) = (M::forces(&solid, dx), M::drift(&solid));
        let particles = particles(s, &material);
        let scene = Scene::<Scheme<M, Open>>::new(
            solid.h(dx),
            Domain::open(),
            particles,
            forces,
            drift,
            Open,
        );
        let end = s.end * std::f64::consts::TAU * s.radius / speed;
        let every = end / SAMPLES;
        let mut seen = Seen { material, until: every, every, series: Vec::new() };
        let start = scene.particles.iter().fold([0.0; 4], |[spin, energy, mass, radius], p| {
            let m = p.mass;
            [
                spin + m * p.position.perp(&p.velocity),
                energy + 0.5 * m * p.velocity.norm_squared(),
                mass + m,
                radius + m * p.position.norm_squared(),
            ]
        });
        seen.series.push([0.0, start[0], start[1], 0.0, start[3] / start[2]]);
        let Ran { simulation, status, cost } =
            run_to(scene, [dt, end], material.eos(), context, &mut seen)?;
        seen.look(&simulation);
        let scale = material.density * speed * speed;
        metrics(&seen.series, s.end, scale, &mut record);
        let total = start[2] * speed;
        let change = simulation.momentum().norm() / total;
        let formula = "|sum m v|/(sum m times the speed of the rim)";
        record.metrics.insert("momentum_error".into(), Metric::new(change, "-", formula));
        record.state = Some(digest(&simulation));
        (record.status, record.cost) = (status, cost);
        Ok(record)
    }

    fn plan(tier: Tier) -> Vec<Planned> {
        plan(tier)
    }

    fn studies(_: Tier, runs: &[JudgedRun]) -> Vec<Study> {
        vec![study(runs)]
    }
}

fn metrics(series: &[[f64; 5]], revolutions: f64, scale: f64, record: &mut Record) {
    let [first, last] = [series[0], series[series.len() - 1]];
    let mut put = |name: &str, value: f64, formula: &str| {
        record.metrics.insert(name.into(), Metric::new(value, "-", formula));
    };
    put(
        "angular_momentum_drift",
        (last[1] / first[1] - 1.0).abs() / revolutions,
        "|angular momentum at the end over that at the start less 1|, a revolution",
    );
    put(
        "stress_drift",
        last[3].sqrt() / scale / revolutions,
        "(mean S:S)^(1/2) at the end over rho U^2, a revolution",
    );
    let largest = series.iter().map(|row| row[3]).fold(0.0, f64::max).sqrt();
    put("largest_stress", largest / scale, "largest (mean S:S)^(1/2) over rho U^2");
    put("energy_drift", (last[2] / first[2] - 1.0) / revolutions, "change of energy, a revolution");
    put(
        "radius",
        (last[4] / first[4]).sqrt(),
        "(mean r^2)^(1/2) at the end over that at the start",
    );
    let column = |k: usize, of: f64| -> Vec<f64> { series.iter().map(|row| row[k] / of).collect() };
    let stress = series.iter().map(|row| row[3].sqrt() / scale).collect();
    let profile = Profile::default()
        .with("t", "s", column(0, 1.0))
        .with("angular momentum", "of the start", column(1, first[1]))
        .with("energy", "of the start", column(2, first[2]))
        .with("stress", "rho U^2", stress)
        .with("mean square radius", "m^2", column(4, 1.0));
    record.profiles.insert("spin".into(), profile);
}

fn plan(_: Tier) -> Vec<Planned> {
    vec![Planned::new("bare", &[])]
}

fn study(_: &[JudgedRun]) -> Study {
    let _ = (Cell::count(1), Column::text("a"), Table::new("", vec![]));
    let _ = |id: &str| Gate::new(id, "m", Bound::Below(1.0), Evidence::Theory, "b");
    Study::new("spinning-disk-drift", "Drift against spacing and time step")
}
