//! A periodic lattice with velocity noise of 1e-8 c₀: every wave of the box at once, too small to be
//! anything but linear.

use std::marker::PhantomData;

use nalgebra::{Complex, Vector2};
use solver::terms::Always;
use solver::{
    ArtificialViscosity, Compose, Continuity, DensityDiffusion, Domain, Flow, Kernel, Limits,
    Observer, Open, Outcome, Particle, Pressure, Scene, Scheme, Simulation, Tait, Viscosity,
};

use base::random::Random;
use harness::bisect::{Bracket, Growth, largest_stable};
use maths::theory::{
    Stepping,
    lattice::{SquareLattice, wave_vectors},
    time_step::{self, Medium, Mode},
};

/// The guard of the viscous and the artificial term, as the seed has it.
pub const ETA2: f64 = 0.01;
/// Initial velocity noise, standard deviation of each component \[c₀\].
pub const NOISE: f64 = 1e-8;
/// Resolution of the bisection, relative to the theoretical limit.
const RESOLUTION: f64 = 0.004;
/// A growth that theory gives at this much beyond the limit must be seen, so it sets the number of
/// steps; the number has no other influence on the limit that is found.
const SEEN_FROM: f64 = 1.005;
/// Fewest and most steps of a run.
const STEPS: [f64; 2] = [300.0, 12_000.0];

type Plain<K, I> = Compose<K, (Pressure<Tait>, Viscosity), Continuity, Open, I>;
type Damping = ArtificialViscosity<Tait, Always>;
type Damped<K, I> =
    Compose<K, (Pressure<Tait>, Viscosity, Damping), (Continuity, DensityDiffusion), Open, I>;

/// A box of `n` × `n` particles, side 1 m, ρ₀ = 1 kg/m³, c₀ = 1 m/s.
#[derive(Clone, Copy, Debug)]
pub struct NoisyBox<K> {
    /// Particles along each side.
    pub n: usize,
    /// h/dx.
    pub h_over_dx: f64,
    /// c₀h/ν, infinite without viscosity.
    pub stiffness: f64,
    /// α of the artificial viscosity, on every pair.
    pub alpha: f64,
    /// δ of the density diffusion.
    pub delta: f64,
    /// The kernel.
    pub kernel: PhantomData<K>,
}

/// A measured limit and its theory, both as c₀ dt/h.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    /// By bisection; `None` if there is none near the theory.
    pub measured: Option<Bracket>,
    /// [`time_step::time_step_limit`] of the same box.
    pub theory: f64,
    /// Steps of each run.
    pub steps: u64,
}

impl Limit {
    /// Measured over theoretical; NaN if nothing was measured.
    pub fn ratio(&self) -> f64 {
        self.middle() / self.theory
    }

    /// The measured limit; NaN if nothing was measured.
    pub fn middle(&self) -> f64 {
        self.measured.map_or(f64::NAN, |bracket| bracket.middle())
    }
}

struct Watch {
    growth: Growth,
}

/// Kinetic and acoustic energy, ½ m v² + ½ m (ρ/ρ₀ - 1)² with c₀ = 1.
fn energy<S: Scheme>(simulation: &Simulation<S>) -> f64 {
    let of = |(mass, e): (f64, &solver::Evolved<S::Extra>)| {
        0.5 * mass * (e.velocity.norm_squared() + (e.density - 1.0) * (e.density - 1.0))
    };
    simulation.fluid().map(of).sum()
}

impl<S: Scheme> Observer<S> for Watch {
    fn after_step(&mut self, simulation: &Simulation<S>) -> Flow {
        if self.growth.see(energy(simulation)) { Flow::Stop } else { Flow::Continue }
    }
}

impl<K: Kernel> NoisyBox<K> {
    fn h(&self) -> f64 {
        self.h_over_dx / self.n as f64
    }

    /// The lattice of the theory.
    pub fn lattice(&self) -> SquareLattice<K> {
        SquareLattice::new(self.h_over_dx, ETA2)
    }

    /// The fluid of the theory, in units of c₀ and h.
    pub fn medium(&self) -> Medium {
        let Self { alpha, delta, stiffness, .. } = *self;
        Medium { c0: 1.0, h: 1.0, nu: 1.0 / stiffness, alpha, delta }
    }

    fn scene<S: Scheme<Kernel = K>>(
        &self,
        forces: S::Forces,
        drift: S::Drift,
        walls: S::Walls,
    ) -> Scene<S> {
        let dx = 1.0 / self.n as f64;
        let mut random = Random::new(7);
        let mut noise = || NOISE * random.normal();
        let particles = solver::lattice(Vector2::repeat(0.5 * dx), dx, self.n, self.n)
            .map(|x| Particle::fluid(x, Vector2::new(noise(), noise()), 1.0, dx * dx))
            .collect();
        let mut scene =
            Scene::new(self.h(), Domain::torus(1.0, 1.0), particles, forces, drift, walls);
        scene.parallel_from = usize::MAX;
        scene.limits = Limits { density: [0.7, 1.3], speed: 2.0 };
        scene
    }

    fn viscosity(&self) -> Viscosity {
        let h = self.h();
        Viscosity { mu: h / self.stiffness, eta2: ETA2 * h * h }
    }

    /// The scene with viscosity alone; [`NoisyBox::alpha`] and [`NoisyBox::delta`] are ignored.
    pub fn plain<I: Stepping>(&self) -> Scene<Plain<K, I>> {
        let forces = (Pressure::new(Tait::new(1.0, 1.0)), self.viscosity());
        self.scene(forces, Continuity, Open)
    }

    /// The scene with artificial viscosity and density diffusion too.
    pub fn damped<I: Stepping>(&self) -> Scene<Damped<K, I>> {
        let (eos, h) = (Tait::new(1.0, 1.0), self.h());
        let damping = Damping::new(self.alpha, 0.0, h, eos);
        let diffusion = DensityDiffusion::new(self.delta * h);
        let forces = (Pressure::new(eos), self.viscosity(), damping);
        self.scene(forces, (Continuity, diffusion), Open)
    }

    /// Whether the energy grows within `steps` steps of `courant` h/c₀.
    fn grows<S: Scheme>(&self, scene: Scene<S>, courant: f64, steps: u64) -> bool {
        let Ok(mut simulation) = scene.build() else { return true };
        let dt = courant * self.h();
        let mut watch = Watch { growth: Growth::new(energy(&simulation), steps) };
        match simulation.advance(dt * steps as f64, dt, &mut watch) {
            Outcome::Diverged(_) => true,
            Outcome::Reached | Outcome::Stopped => watch.growth.grew(),
        }
    }

    /// Bisects the largest c₀ dt/h without growth.
    pub fn limit<I: Stepping>(&self) -> Limit {
        if self.alpha == 0.0 && self.delta == 0.0 {
            self.limit_of(|| self.plain::<I>())
        } else {
            self.limit_of(|| self.damped::<I>())
        }
    }

    /// The limit of any scene, beside the theory of this box.
    pub fn limit_of<S: Scheme>(&self, scene: impl Fn() -> Scene<S>) -> Limit
    where
        S::Integrator: Stepping,
    {
        let integrator = S::Integrator::THEORY;
        let modes = time_step::modes(&self.lattice(), self.n, &self.medium());
        let theory = time_step::time_step_limit(&modes, integrator);
        let growth = time_step::growth_per_step(&modes, integrator, SEEN_FROM * theory);
        let steps = (0.5 / growth).clamp(STEPS[0], STEPS[1]) as u64;
        let is_stable = |courant| !self.grows(scene(), courant, steps);
        let measured = largest_stable(theory, RESOLUTION, is_stable);
        Limit { measured, theory, steps }
    }

    /// Growth per step of the stiffest wave's amplitude at `courant`, measured and ω dt of theory.
    /// Its energy is the same at every phase of the wave, so two looks are enough.
    pub fn stiffest_wave<I: Stepping>(&self, courant: f64, steps: u64) -> [f64; 2] {
        self.stiffest_wave_of(self.plain::<I>(), courant, steps)
    }

    /// The same of any scene of this box.
    pub fn stiffest_wave_of<S: Scheme<Extra = ()>>(
        &self,
        scene: Scene<S>,
        courant: f64,
        steps: u64,
    ) -> [f64; 2] {
        let lattice = self.lattice();
        let omega = |theta: &Vector2<f64>| Mode::new(&lattice, *theta, &self.medium()).omega;
        let stiffest = wave_vectors(self.n).max_by(|a, b| omega(a).total_cmp(&omega(b)));
        let theta = stiffest.unwrap_or_else(Vector2::zeros);
        let along = lattice.gradient(theta).normalize();
        let energy = |particles: &[Particle]| -> f64 {
            let labels = solver::lattice(Vector2::zeros(), 1.0, self.n, self.n);
            let (mut p, mut v) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
            for (particle, label) in particles.iter().zip(labels) {
                let wave = Complex::<f64>::cis(-theta.dot(&label));
                p += wave * (particle.density - 1.0);
                v += wave * particle.velocity.dot(&along);
            }
            p.norm_sqr() + v.norm_sqr()
        };
        let Ok(mut simulation) = scene.build() else { return [f64::NAN; 2] };
        let start = energy(&simulation.particles());
        let dt = courant * self.h();
        let outcome = simulation.advance(dt * steps as f64, dt, &mut ());
        let growth = match outcome {
            Outcome::Reached => 0.5 * (energy(&simulation.particles()) / start).ln() / steps as f64,
            _ => f64::NAN,
        };
        [growth, omega(&theta) * courant]
    }
}
