//! A cantilever that swings in its first mode, against the theory of thin plates.

use nalgebra::Vector2;
use solver::{
    Domain, Flow, Observer, Particle, Role, Scene, Scheme as SolverScheme, Simulation, Symmetric,
};

use super::solid::{Clamp, Energy, Method, Problem, Ran, Scheme, Solid, describe, digest, run_to};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Metric, Profile, Record},
};
use harness::{
    case::{Planned, RunError, Tier},
    runner::Context,
    suite::{JudgedRun, Study},
};
use report::{Cell, Column, Table, percent, sig};

crate::solid_settings! {
    /// Settings of a plate that is held at x = 0.
    pub struct PlateSettings {
        /// particles through the thickness
        n: usize ["-"] in 2..=1000 = 10,
        /// length outside of the clamp
        length: f64 ["m"] in 1e-9..=1e6 = 0.2,
        /// thickness
        thickness: f64 ["m"] in 1e-9..=1e6 = 0.02,
        /// largest velocity at the start, that of the tip
        speed: f64 ["c0"] in 1e-9..=0.1 = 0.01,
        /// end of the run: periods of thin-plate theory
        end: f64 ["periods"] in 0.01..=1e3 = 0.75,
    }
}

/// The problem.
pub struct OscillatingPlate;

/// k L of the first mode of a cantilever: cos kL cosh kL = −1.
const FIRST_MODE: f64 = 1.875_104_068_711_961;

/// Steps between samples.
const EVERY: u64 = 8;

/// 2π/ω of a thin plate with ω² = E H² k⁴/(12 ρ (1 − ν²)) (Landau & Lifshitz) \[s\].
fn thin_plate_period(s: &PlateSettings) -> f64 {
    let k = FIRST_MODE / s.length;
    let stiffness = s.young * s.thickness * s.thickness / (12.0 * (1.0 - s.poisson * s.poisson));
    std::f64::consts::TAU / (k * k * (stiffness / s.rho).sqrt())
}

/// The first mode at x/L, 1 at the tip.
fn mode(x: f64) -> f64 {
    let q = FIRST_MODE;
    let f = |x: f64| {
        let z = q * x;
        (q.cos() + q.cosh()) * (z.cosh() - z.cos()) + (q.sin() - q.sinh()) * (z.sinh() - z.sin())
    };
    f(x) / f(1.0)
}

/// Free particles, column by column from the clamp, then those of the clamp.
fn particles(s: &PlateSettings, solid: &Solid) -> Vec<Particle<Symmetric>> {
    let dx = s.thickness / s.n as f64;
    let columns = (s.length / dx).round() as usize;
    let held = (2.0 * s.h_over_dx).ceil() as usize;
    let speed = s.speed * solid.material.sound_speed();
    let first =
        |columns: usize| Vector2::new((0.5 - columns as f64) * dx, 0.5 * (dx - s.thickness));
    let at = |x, v| Particle::fluid(x, Vector2::new(0.0, v), s.rho, dx * dx);
    let free = solver::lattice(first(0), dx, columns, s.n);
    let held = solver::lattice(first(held), dx, held, s.n);
    let free = free.map(|x| at(x, speed * mode(x.x / s.length)));
    free.chain(held.map(|x| at(x, 0.0).with_role(Role::Wall))).collect()
}

/// What is seen through time.
struct Seen {
    columns: usize,
    rows: usize,
    until: u64,
    /// t \[s\], height of the tip \[m\].
    series: Vec<[f64; 2]>,
}

impl<S: SolverScheme<Extra = Symmetric>> Observer<S> for Seen {
    fn after_step(&mut self, simulation: &Simulation<S>) -> Flow {
        if self.until > 0 {
            self.until -= 1;
            return Flow::Continue;
        }
        self.until = EVERY - 1;
        let all = simulation.particles();
        let tip = (1..=self.rows).map(|row| all[row * self.columns - 1].position.y);
        let mean = tip.fold(0.0, |sum, y| sum + y) / self.rows as f64;
        self.series.push([simulation.time(), mean]);
        Flow::Continue
    }
}

impl Seen {
    /// Times at which the tip passes its height of rest \[s\].
    fn passes(&self) -> Vec<f64> {
        let passes = |w: &[[f64; 2]]| {
            let [[t, a], [u, b]] = [w[0], w[1]];
            (a * b < 0.0).then(|| t + (u - t) * a / (a - b))
        };
        self.series.windows(2).filter_map(passes).collect()
    }

    fn metrics(&self, s: &PlateSettings, solid: &Solid, record: &mut Record) {
        let passes = self.passes();
        let period = match passes[..] {
            [half] => 2.0 * half,
            [_, whole, ..] => whole,
            [] => f64::NAN,
        };
        let theory = thin_plate_period(s);
        let highest = self.series.iter().map(|row| row[1]).fold(f64::NEG_INFINITY, f64::max);
        let speed = s.speed * solid.material.sound_speed();
        let mut put = |name: &str, value: f64, unit: &str, formula: &str| {
            record.metrics.insert(name.into(), Metric::new(value, unit, formula));
        };
        put(
            "period",
            period,
            "s",
            "time to the second passage of the tip through its height of rest, twice that to the first \
             if there is one only",
        );
        put(
            "period_excess",
            period / theory - 1.0,
            "-",
            "period over 2 pi (12 rho (1 - nu^2)/(E H^2))^(1/2) (L/1.875)^2, less 1",
        );
        put(
            "amplitude_ratio",
            highest * std::f64::consts::TAU / (theory * speed),
            "-",
            "largest height of the tip over its first speed/omega of thin-plate theory",
        );
    }
}

impl Problem for OscillatingPlate {
    const NAME: &'static str = "oscillating_plate";
    const ABOUT: &'static str = "An elastic plate, held at one end by particles that continue it and stand \
        still, starts flat with the velocity of its first mode (Landau & Lifshitz; Gray, Monaghan & \
        Swift 2001). Its period against that of a thin plate, 0.254 s.";
    type Settings = PlateSettings;

    fn run<M: Method>(
        variant: &str,
        settings: &PlateSettings,
        context: &Context,
    ) -> Result<Record, RunError> {
        let (s, solid) = (settings, settings.solid());
        let material = solid.material;
        let (dx, speed) = (s.thickness / s.n as f64, s.speed * material.sound_speed());
        let (value, most) = (s.length / dx * s.n as f64, 1e6);
        if value > most {
            let setting = "n, length or thickness";
            return Err(RunError::TooMuch { what: "the particles", value, most, setting });
        }
        let dt = solid.time_step(dx, speed, M::COURANT, context)?;
        let mut record = describe::<Self, M>(variant, settings, &solid, [dx, dt], context);
        let walls = Clamp { shear_modulus: material.shear };
        let (forces, drift) = (M::forces(&solid, dx), M::drift(&solid));
        let scene = Scene::<Scheme<M, Clamp>>::new(
            solid.h(dx),
            Domain::open(),
            particles(s, &solid),
            forces,
            drift,
            walls,
        );
        let kinetic = |p: &Particle<Symmetric>| 0.5 * p.mass * p.velocity.norm_squared();
        let before = scene.particles.iter().map(kinetic).fold(0.0, |sum, one| sum + one);
        let free = scene.particles.iter().filter(|p| p.role == Role::Fluid).count();
        let mut seen = Seen { columns: free / s.n, rows: s.n, until: 0, series: vec![[0.0; 2]] };
        let end = s.end * thin_plate_period(s);
        let Ran { simulation, status, cost } =
            run_to(scene, [dt, end], material.eos(), context, &mut seen)?;
        seen.metrics(s, &solid, &mut record);
        let after = Energy::of(&simulation, &material).total();
        let formula = "kinetic and strain energy of the free particles, end over start less 1";
        let change = Metric::new(after / before - 1.0, "-", formula);
        record.metrics.insert("energy_change".into(), change);
        let column = |k: usize| seen.series.iter().map(|row| row[k]).collect();
        let profile = Profile::default().with("t", "s", column(0)).with("tip", "m", column(1));
        record.profiles.insert("tip".into(), profile);
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

/// Why the coarse plates swing too slowly.
const FACES: &str = "velocity gradients are not corrected, so that (11) sees less strain than there is in \
    particles within 2 h = 3 dx of a face, where bending strains most; with 5 or 10 particles through the \
    thickness these are all or more than half of them. The error falls as h/H does: the same gate holds \
    with 20";

/// Why the plate without stabilisation does.
const BARE: &str = "the same at faces, and more the finer the plate is, 35 % and 42 % with 5 and 10 \
    particles: without viscosity and artificial stress, motion at the scale of the spacing takes up the \
    energy. Why it grows with n is not known";

/// Why the finest plate ends with more energy than it began with.
const GAINS: &str = "artificial stress gives energy to particles in tension, in proportion to the stress, \
    and viscosity takes it in proportion to the spacing: at 20 particles through the thickness the former \
    wins. It cannot be left out: with xi = 0 this plate loses 58 % of its energy and has no period";

fn swing(variant: &'static str, n: usize) -> Planned {
    let id = format!("oscillating_plate.{variant}.{n}");
    let period = Gate::new(
        format!("{id}.period_excess"),
        "period_excess",
        Bound::Within(0.0, 0.15),
        Evidence::Reference,
        "published SPH of this plate swings 7 to 12 % too slowly, thin-plate theory leaves out shear and \
         rotary inertia, which at H/L = 0.1 make it some per cent slower; faster than theory is wrong",
    );
    let period = match (variant, n) {
        (_, 20..) => period,
        ("bare", _) => period.with_limitation(BARE),
        _ => period.with_limitation(FACES),
    };
    let amplitude = Gate::new(
        format!("{id}.amplitude_ratio"),
        "amplitude_ratio",
        Bound::Within(0.85, 1.5),
        Evidence::Theory,
        "a plate that starts at v swings to v/omega: as much larger than 1 as its period is longer, 1.0 to \
         1.5 here, and smaller by what viscosity takes in a quarter of a period",
    );
    let amplitude = if variant == "bare" { amplitude.reported() } else { amplitude };
    let energy = Gate::new(
        format!("{id}.energy_change"),
        "energy_change",
        Bound::Below(0.01),
        Evidence::Invariant,
        "nothing drives the plate: its energy does not rise",
    );
    let energy = if n >= 20 { energy.with_limitation(GAINS) } else { energy };
    Planned::new(variant, &[format!("n={n}")]).judged(vec![period, amplitude, energy])
}

fn plan(tier: Tier) -> Vec<Planned> {
    let mut plan = vec![swing("bare", 5), swing("plain", 5), swing("seed", 5)];
    if tier == Tier::Full {
        plan.extend([swing("bare", 10), swing("plain", 10)]);
        plan.push(swing("plain", 20).taking(50.0));
    }
    if tier == Tier::Quick {
        return plan;
    }
    // What stabilisation does to the energy, and what a nearly incompressible plate costs and loses.
    plan.push(Planned::new("plain", &["n=5".into(), "xi=0".into()]));
    for ratio in RATIOS {
        let set = ["n=5".to_string(), format!("poisson={ratio}")];
        let seconds = 1.0 / (1.0 - 2.0 * ratio).sqrt();
        plan.push(Planned::new("plain", &set).taking(seconds));
    }
    plan
}

/// Poisson's ratios beside that of the rubber.
const RATIOS: [f64; 5] = [0.49, 0.3, 0.45, 0.499, 0.4999];

fn study(runs: &[JudgedRun]) -> Study {
    let columns = vec![
        Column::text("variant"),
        Column::text("settings"),
        Column::num("period", "s"),
        Column::num("longer than theory", ""),
        Column::num("amplitude over that of theory", ""),
        Column::num("energy, change", ""),
        Column::num("time", "s"),
    ];
    let theory = thin_plate_period(&PlateSettings::default());
    let caption = format!("Period of the cantilever; {theory:.4} s in the theory of thin plates.");
    let mut table = Table::new(caption, columns);
    for run in runs {
        let metric = |name: &str| run.record.measured(name);
        table = table.row(vec![
            Cell::text(run.planned.variant),
            Cell::text(run.planned.set.join(", ")),
            Cell::num(metric("period"), 4),
            Cell::percent(metric("period_excess"), 3),
            Cell::num(metric("amplitude_ratio"), 3),
            Cell::percent(metric("energy_change"), 2),
            Cell::seconds(run.record.cost.cpu_s),
        ]);
    }
    let stress = "Energy: viscosity takes it, and artificial stress gives some back. It weakens the pull of \
                  particles in tension without a store of its own, so that (kinetic + strain) energy rises \
                  with the deflection; the run with xi = 0 in the full tier shows the difference.";
    Study::new("oscillating-plate-period", "Period against resolution")
        .prose(format!("Why it is too long: {FACES}."))
        .prose(stress)
        .prose(incompressible(runs))
        .block(table)
}

/// What becomes of the period towards Poisson's ratio 1/2, from the numbers.
fn incompressible(runs: &[JudgedRun]) -> String {
    let excess = |run: &&JudgedRun| run.record.measured("period_excess");
    let has = |run: &&JudgedRun, text: &str| run.planned.set.iter().any(|set| set == text);
    let five = |run: &&JudgedRun| run.planned.variant == "plain" && has(run, "n=5");
    let Some(rubber) = runs.iter().find(|run| five(run) && run.planned.set.len() == 1) else {
        return String::new();
    };
    let others = runs.iter().filter(|run| five(run)).filter_map(|run| {
        let ratio = run.planned.set.iter().find_map(|set| set.strip_prefix("poisson="))?;
        let (steps, base) = (run.record.cost.steps as f64, rubber.record.cost.steps as f64);
        let lost =
            if excess(&run).is_nan() { "no period".into() } else { percent(excess(&run), 3) };
        let swing = sig(run.record.measured("amplitude_ratio"), 3);
        let steps = sig(steps / base, 2);
        Some(format!("{ratio}: {lost}, swings {swing} of theory, {steps} times the steps"))
    });
    let list = others.collect::<Vec<String>>().join("; ");
    if list.is_empty() {
        return "The full tier has other ratios of Poisson, and a plate without artificial stress."
            .into();
    }
    let base = percent(excess(&rubber), 3);
    format!(
        "Poisson's ratio towards 1/2 at 5 particles through the thickness: at 0.3975 the period is {base} \
         too long; {list}. The step shrinks as sqrt(1 - 2 nu) does. Artificial viscosity is in proportion to \
         c0 = sqrt(K/rho), which grows as 1/sqrt(1 - 2 nu): accuracy is lost to damping, and a period that \
         comes closer to theory on the way is no gain."
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use harness::case::Case;
    use harness::case::find_in;

    #[test]
    fn thin_plate_theory_is_that_of_the_literature() {
        let s = PlateSettings::default();
        assert_relative_eq!(thin_plate_period(&s), 0.2541, max_relative = 1e-3);
        assert_relative_eq!(FIRST_MODE.cos() * FIRST_MODE.cosh(), -1.0, max_relative = 1e-12);
    }

    /// Held and level at the clamp, no moment and no shear at the tip.
    #[test]
    fn the_mode_is_that_of_a_cantilever() {
        let d = 1e-4;
        assert_eq!((mode(0.0), mode(1.0)), (0.0, 1.0));
        assert!(mode(d).abs() < 1e-7);
        let second = |x: f64| (mode(x + d) - 2.0 * mode(x) + mode(x - d)) / (d * d);
        assert!(second(1.0).abs() < 1e-5 * second(0.0));
        assert!((second(1.0 + d) - second(1.0 - d)).abs() / (2.0 * d) < 1e-2 * second(0.0));
    }

    #[test]
    fn the_clamp_stands_still_and_goes_on_as_the_plate_does() {
        let s = PlateSettings::default();
        let all = particles(&s, &s.solid());
        let held: Vec<_> = all.iter().filter(|p| p.role == Role::Wall).collect();
        assert_eq!((all.len() - held.len(), held.len()), (100 * 10, 3 * 10));
        assert!(held.iter().all(|p| p.position.x < 0.0 && p.velocity.norm() == 0.0));
        let dx = s.thickness / s.n as f64;
        let nearest = held.iter().map(|p| p.position.x).fold(f64::NEG_INFINITY, f64::max);
        assert_relative_eq!(nearest, -0.5 * dx, max_relative = 1e-12);
    }

    #[test]
    fn a_plate_that_makes_no_sense_is_refused() {
        let case: &dyn Case = find_in(crate::CASES, "oscillating_plate").expect("a case");
        let refused = |set: &str| case.run("plain", &[set.into()], &Context::default()).err();
        assert!(matches!(refused("n=1"), Some(RunError::Setting(_))));
        assert!(matches!(refused("dt=1"), Some(RunError::TimeStep { .. })));
        assert!(matches!(refused("thickness=1e-9"), Some(RunError::TooMuch { .. })));
    }
}
