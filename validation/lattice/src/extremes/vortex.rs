//! Taylor-Green vortices: too slow a sound, too fast a sound, disturbed lattices.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use solver::{
    Compose, Continuity, DensityDiffusion, Domain, Leapfrog, Limits, Open, Outcome, Particle,
    Pressure, QuinticSpline, Scene, Shifting, Simulation, Smoothing, Tait, Viscosity,
};

use super::{Entry, sci};
use base::{
    gate::{Bound, Evidence},
    random::Random,
};
use harness::case::Tier;
use report::percent;

/// The modern composition of the channels, in a periodic box.
type Modern = Compose<
    QuinticSpline,
    (Pressure<Tait>, Viscosity),
    (Continuity, DensityDiffusion, Shifting),
    Open,
    Leapfrog,
>;

/// Particles along each side.
const SIDE: usize = 32;
/// Reynolds number U L/ν.
const RE: f64 = 100.0;

/// U = L = ρ = 1.
struct Vortex {
    mach: f64,
    /// Standard deviation of the places \[dx\].
    jitter: f64,
    end: f64,
}

/// What became of it.
struct Fate {
    outcome: Outcome,
    /// Relative L2 error of the velocity at the end.
    error: f64,
    /// Largest kinetic energy over the initial one.
    peak: f64,
    /// Kinetic energy at the end over the exact one.
    energy: f64,
}

impl Vortex {
    fn exact(place: Vector2<f64>, t: f64) -> Vector2<f64> {
        let decay = (-2.0 * TAU * TAU / RE * t).exp();
        let (x, y) = (TAU * place.x, TAU * place.y);
        Vector2::new(-x.cos() * y.sin(), x.sin() * y.cos()) * decay
    }

    fn scene(&self) -> Scene<Modern> {
        let dx = 1.0 / SIDE as f64;
        let (h, c0) = (dx, 1.0 / self.mach);
        let mut random = Random::new(3);
        let mut shake = || Vector2::new(random.normal(), random.normal()) * (self.jitter * dx);
        let particles = solver::lattice(Vector2::repeat(0.5 * dx), dx, SIDE, SIDE)
            .map(|x| x + shake())
            .map(|x| Particle::fluid(x, Self::exact(x, 0.0), 1.0, dx * dx))
            .collect();
        let eos = Tait::new(1.0, c0);
        let forces = (Pressure::new(eos), Viscosity { mu: 1.0 / RE, eta2: 1e-6 * h * h });
        let w = Smoothing::<QuinticSpline>::new(h).w(dx * dx);
        let drift = (Continuity, DensityDiffusion::new(0.1 * h * c0), Shifting::new(0.5, h, w));
        let mut scene = Scene::new(h, Domain::torus(1.0, 1.0), particles, forces, drift, Open);
        scene.parallel_from = usize::MAX;
        scene.limits = Limits { density: [0.1, 10.0], speed: 10.0 * (1.0 + c0) };
        scene
    }

    fn run(&self) -> Option<Fate> {
        let mut simulation = self.scene().build().ok()?;
        let h = 1.0 / SIDE as f64;
        let dt = (h / (1.0 + 1.0 / self.mach)).min(0.25 * h * h * RE);
        let start = kinetic(&simulation);
        let (mut peak, mut outcome) = (1.0f64, Outcome::Reached);
        for k in 1..=20 {
            outcome = simulation.advance(self.end * f64::from(k) / 20.0, dt, &mut ());
            peak = peak.max(kinetic(&simulation) / start);
            if outcome != Outcome::Reached {
                break;
            }
        }
        let (mut difference, mut scale) = (0.0, 0.0);
        for particle in simulation.particles() {
            let exact = Self::exact(particle.position, simulation.time());
            difference += (particle.velocity - exact).norm_squared();
            scale += exact.norm_squared();
        }
        let decay = (-4.0 * TAU * TAU / RE * simulation.time()).exp();
        let energy = kinetic(&simulation) / (start * decay);
        Some(Fate { outcome, error: (difference / scale).sqrt(), peak, energy })
    }
}

fn kinetic(simulation: &Simulation<Modern>) -> f64 {
    simulation.fluid().map(|(mass, e)| 0.5 * mass * e.velocity.norm_squared()).sum()
}

/// Mach number 0.5: not weakly compressible any more.
pub fn fast(_tier: Tier) -> Vec<Entry> {
    let what = [
        "Taylor-Green vortex, sound too slow".into(),
        "Mach 0.5, Re 100, lattice disturbed by 10 %".to_string(),
    ];
    let metric = "error more than at Mach 0.1, 0 if it says so";
    let entry = Entry::new("mach", what, metric, Bound::Below(0.25)).because(
        Evidence::Theory,
        "compressibility costs the square of the Mach number, or a typed divergence",
    );
    let run = |mach: f64| Vortex { mach, jitter: 0.1, end: 0.5 }.run();
    let Some(fate) = run(0.5) else { return vec![entry] };
    let usual = run(0.1).map_or(f64::NAN, |fate| fate.error);
    vec![match fate.outcome {
        Outcome::Diverged(divergence) => entry.found(0.0, divergence.to_string()),
        _ => {
            let error = percent(fate.error, 2);
            let found = format!("velocity error {error}, at Mach 0.1 {}", percent(usual, 2));
            entry.found(fate.error - usual, found)
        }
    }]
}

/// Sound a thousand times faster than needed.
pub fn stiff_sound(tier: Tier) -> Vec<Entry> {
    let end = if tier == Tier::Full { 0.02 } else { 0.002 };
    let error = |mach: f64| {
        let fate = Vortex { mach, jitter: 0.0, end }.run();
        fate.filter(|fate| fate.outcome == Outcome::Reached).map_or(f64::NAN, |fate| fate.error)
    };
    let [usual, stiff] = [0.1, 1e-4].map(error);
    let what =
        ["c₀ a thousand times too fast".to_string(), format!("Taylor-Green, Mach 10⁻⁴, t = {end}")];
    let entry = Entry::new("sound.vortex", what, "error of the velocity", Bound::Below(0.01));
    let because = "the flow does not know c₀: 1 % after a few steps is noise; at Mach 0.1 the sound of the \
                   start is more";
    let found = format!("error {} becomes {}", sci(usual), sci(stiff));
    vec![entry.because(Evidence::Theory, because).found(stiff, found)]
}

/// Lattices disturbed by 1, 10 and 30 % of the spacing.
pub fn jittered(_tier: Tier) -> Vec<Entry> {
    let run = |jitter: f64| {
        let what =
            ["disturbed lattice".to_string(), format!("Taylor-Green, {} dx", percent(jitter, 0))];
        let name = format!("jitter.{jitter}");
        let entry = Entry::new(&name, what, "largest kinetic energy/initial", Bound::Below(1.01))
            .because(Evidence::Invariant, "viscosity only takes energy, and pressure starts at 0");
        let fate = Vortex { mach: 0.1, jitter, end: 0.5 }.run();
        match fate {
            Some(Fate { outcome: Outcome::Reached, error, peak, energy }) => {
                let (error, energy) = (percent(error, 1), percent(energy - 1.0, 1));
                let found =
                    format!("{peak:.4}; at t = 0.5 energy off by {energy}, velocity by {error}");
                entry.found(peak, found)
            }
            Some(Fate { outcome, .. }) => entry.found(f64::NAN, format!("{outcome:?}")),
            None => entry,
        }
    };
    [0.01, 0.1, 0.3].map(run).into()
}
