//! Scenes for measuring speed, used by `touchstone doctor --bench`.
//!
//! The scene is a torus of particles on a square lattice in a slow shear, cubic spline with h/dx = 1.2, so 20
//! neighbours within the support; continuity, pressure and Morris viscosity. Steps are so short that lists
//! are never rebuilt: the measured time is the right-hand side. [`Rebuilding`], an integrator that does
//! nothing else, measures the building of lists.

use std::time::Instant;
use touchstone_base::functions::sin;

use nalgebra::Vector2;
use touchstone_solver::{
    Compose, Continuity, CubicSpline, Domain, Engine, Euler, Integrator, Open, Outcome, Particle,
    Physics, Pressure, Scene, SceneError, Scheme, Simulation, Stepper, Tait, Viscosity,
    integrator::Stepped, lattice, physics::Particles,
};

/// The scheme whose right-hand side is measured.
pub type Fluid<I> = Compose<CubicSpline, (Pressure<Tait>, Viscosity), Continuity, Open, I>;

/// Particles along a side of the square scenes: about 10³, 10⁴, 10⁵ and 10⁶ in all.
pub const SIDES: [usize; 4] = [32, 100, 316, 1000];

/// A step that moves nothing far \[s\].
pub const SHORT: f64 = 1e-9;

/// `side` × `side` particles on a unit torus; serial unless `parallel`, and then from the usual
/// number of particles on.
pub fn scene<I: Integrator<Fluid<()>>>(side: usize, parallel: bool) -> Scene<Fluid<I>> {
    let dx = 1.0 / side as f64;
    let h = 1.2 * dx;
    let wave = |y: f64| 0.01 * sin(std::f64::consts::TAU * y);
    let particles = lattice(Vector2::repeat(0.5 * dx), dx, side, side)
        .map(|x| Particle::fluid(x, Vector2::new(wave(x.y), wave(x.x + 0.25)), 1000.0, dx * dx))
        .collect();
    let forces =
        (Pressure::new(Tait::new(1000.0, 10.0)), Viscosity { mu: 1.0, eta2: 0.01 * h * h });
    let mut scene = Scene::new(h, Domain::torus(1.0, 1.0), particles, forces, Continuity, Open);
    if !parallel {
        scene.setting.parallel_from = usize::MAX;
    }
    scene
}

/// Moves all particles along x and starts a step: sorts them and builds their lists. The "time step" is the
/// distance, which must be more than half a skin.
#[derive(Debug)]
pub struct Rebuilding;

impl<P: Physics> Integrator<P> for Rebuilding {
    const NAME: &'static str = "rebuilding";
    type Memory = ();

    fn step(engine: &mut Engine<P>, (): &mut (), state: &mut Particles<P>, dt: f64) -> Stepped {
        state.iter_mut().for_each(|evolved| evolved.position.x += dt);
        engine.begin(state)
    }
}

/// Seconds a step over the next `steps` steps; NaN if the run diverges.
fn batch<S: Scheme>(simulation: &mut Simulation<S>, dt: f64, steps: u64) -> f64 {
    let until = simulation.time() + steps as f64 * dt;
    let start = Instant::now();
    match simulation.advance(until, dt, &mut ()) {
        Outcome::Reached => start.elapsed().as_secs_f64() / steps as f64,
        _ => f64::NAN,
    }
}

/// Seconds a step, the best of a few batches; a machine that is busy only ever makes it longer.
pub fn seconds_per_step<S: Scheme>(simulation: &mut Simulation<S>, dt: f64, budget: f64) -> f64 {
    let first = batch(simulation, dt, 3); // touches the memory
    let steps = ((budget / 4.0 / first) as u64).clamp(3, 1_000_000);
    (0..4).map(|_| batch(simulation, dt, steps)).fold(first, f64::min)
}

/// Results of one scene.
#[derive(Clone, Copy, Debug)]
pub struct Speed {
    /// Particles.
    pub particles: usize,
    /// Right-hand sides of a particle a second.
    pub rate: f64,
    /// Neighbours inside the support.
    pub neighbours: f64,
    /// Memory a particle \[bytes\].
    pub bytes: usize,
    /// Particles sorted and put into lists a second.
    pub list_rate: f64,
}

/// Measures one scene on the current pool for about `budget` seconds.
pub fn speed(side: usize, parallel: bool, budget: f64) -> Result<Speed, SceneError> {
    let mut simulation = scene::<Euler>(side, parallel).build()?;
    let particles = simulation.data().fluid_count();
    let rate = particles as f64 / seconds_per_step(&mut simulation, SHORT, 0.7 * budget);
    let work = simulation.work();
    let neighbours = work.pair_interactions as f64 / work.right_hand_sides as f64;
    let bytes = simulation.bytes() / particles;
    let mut simulation = scene::<Rebuilding>(side, parallel).build()?;
    let distance = 0.4 / side as f64; // a third of h: lists are stale
    let list_rate = particles as f64 / seconds_per_step(&mut simulation, distance, 0.3 * budget);
    Ok(Speed { particles, rate, neighbours, bytes, list_rate })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_that_are_not_made_have_no_time() {
        let mut simulation = scene::<Euler>(8, false).build().expect("a sound scene");
        assert!(batch(&mut simulation, 1e-9, 3) > 0.0);
        assert!(batch(&mut simulation, 1e3, 3).is_nan(), "it diverges");
    }
}
