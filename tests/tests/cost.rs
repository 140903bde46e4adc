//! A scene pays only for what it uses: memory by type, rows by motion.

use nalgebra::Vector2;
use touchstone_solver::{
    AcousticDamper, ArtificialStress, ArtificialViscosity, BodyForce, Compose,
    ConsistentContinuity, ConsistentPressure, ConsistentViscosity, Continuity, CubicSpline,
    DensityDiffusion, Domain, ExtrapolatingWall, Extrapolation, FluidPairs, Hydrostatic,
    Integrator, Leapfrog, Linear, NoSlip, Open, Outcome, Particle, PredictorCorrector, Pressure,
    Scene, ShiftAdvection, Shifting, Simulation, SlipAtWalls, State, Stepper, Tait, Term,
    Viscosity, Xsph, particles::SweptParticle, physics::Derived,
};
use touchstone_tests::{assert_small, difference, patch};

type Moving<I> = Compose<CubicSpline, (Pressure<Tait>, Viscosity), Continuity, Open, I>;
type Fluid = Moving<Leapfrog>;

/// Memory of a term's derived data and of its sums for one particle.
fn sizes<T: Term<()>>() -> [usize; 2] {
    [size_of::<T::Derived>(), size_of::<T::Sum>()]
}

/// Memory of the sums of a wall particle.
fn wall_sum<E: Extrapolation>() -> usize {
    size_of::<E::Sum>()
}

#[test]
fn a_fluid_evolves_40_bytes_and_shows_64() {
    assert_eq!(size_of::<State<()>>(), 40);
    assert_eq!(size_of::<SweptParticle<Derived<Fluid>>>(), 64);
}

#[test]
fn terms_take_the_memory_of_what_they_need_and_absent_ones_none() {
    assert_eq!(sizes::<()>(), [0, 0]);
    assert_eq!(sizes::<BodyForce>(), [0, 0]);
    assert_eq!(sizes::<Continuity>(), [0, 8]);
    assert_eq!(sizes::<DensityDiffusion>(), [0, 8]);
    assert_eq!(sizes::<DensityDiffusion<Hydrostatic>>(), [8, 8]);
    // A wall sums a velocity only where the fluid sticks to it.
    let sums =
        [wall_sum::<ExtrapolatingWall<Tait>>(), wall_sum::<ExtrapolatingWall<Tait, NoSlip>>()];
    assert_eq!(sums, [16, 32]);
    assert_eq!(sizes::<Viscosity>(), [0, 16]);
    // The sound speed where it depends on the density.
    assert_eq!(sizes::<ArtificialViscosity<Tait>>(), [8, 16]);
    assert_eq!(sizes::<ArtificialViscosity<Linear>>(), [0, 16]);
    assert_eq!(sizes::<FluidPairs<ArtificialViscosity<Tait>>>(), [16, 16]);
    // The velocity of a mirror particle where the fluid slips, minus its velocity where it sticks.
    assert_eq!(sizes::<SlipAtWalls<ConsistentContinuity>>(), [16, 32 + 24]);
    // The divergence of each neighbour.
    assert_eq!(sizes::<AcousticDamper>(), [8, 16]);
    assert_eq!(sizes::<Xsph>(), [0, 16]);
    assert_eq!(sizes::<Shifting>(), [0, 16]);
    // In addition to the shift: the gradient of both components of velocity, and a symmetric matrix.
    assert_eq!(sizes::<ShiftAdvection>(), [0, 16 + 32 + 24]);
    assert_eq!(sizes::<Pressure<Tait>>(), [8, 16]);
    // Consistent terms sum this matrix each, and the viscosity also the velocity gradient.
    assert_eq!(sizes::<ConsistentPressure<Tait>>(), [8, 16 + 24]);
    assert_eq!(sizes::<ConsistentContinuity>(), [0, 32 + 24]);
    assert_eq!(sizes::<ConsistentViscosity>(), [0, 16 + 16 + 32 + 24]);
    assert_eq!(sizes::<Pressure<Tait, ArtificialStress>>(), [16, 16]);
    assert_eq!(sizes::<(BodyForce, (), Pressure<Tait>, BodyForce)>(), [8, 16]);
}

#[test]
fn a_simulation_holds_no_more_than_its_buffers() {
    let fluid = |n| {
        let (h, forces) = (1.2 / n as f64, forces());
        let scene =
            Scene::<Fluid>::new(h, Domain::open(), patch(n, 0.1, 1), forces, Continuity, Open);
        scene.build().unwrap().bytes() as f64 / (n * n) as f64
    };
    // State, columns, lists of about 25 neighbours and buffers of the sort: see `Simulation::bytes`.
    let [small, large] = [fluid(40), fluid(80)];
    assert!((200.0..350.0).contains(&large), "{large} bytes a particle");
    assert!((large / small - 1.0).abs() < 0.4, "in proportion: {small}, {large}");
}

fn forces() -> (Pressure<Tait>, Viscosity) {
    (Pressure::new(Tait::new(1.0, 1.0)), Viscosity { mu: 0.01, eta2: 1e-8 })
}

/// Particles that fly straight on, whose densities follow: the trajectories are exact, so that two
/// runs differ in their rows only. Sound is so slow that the pressure changes no bit of a velocity.
fn flight<I: Integrator<Moving<()>>>(skin: f64, share: f64) -> (Vec<Particle>, u64) {
    let h = 0.07;
    let particles = patch(16, 0.2, 3);
    let forces = (Pressure::new(Tait::new(1.0, 1e-30)), Viscosity { mu: 0.0, eta2: 1e-8 });
    let domain = Domain::torus(1.0, 1.0);
    let mut scene = Scene::<Moving<I>>::new(h, domain, particles, forces, Continuity, Open);
    (scene.setting.skin, scene.setting.skin_share) = (skin * h, share);
    let mut simulation: Simulation<_> = scene.build().unwrap();
    assert_eq!(simulation.advance(1.0, 1.0 / 64.0, &mut ()), Outcome::Reached);
    (simulation.particles(), simulation.work().list_builds)
}

fn check_skin<I: Integrator<Moving<()>>>() {
    let torus = [Some(1.0), Some(1.0)];
    let (exact, every_time) = flight::<I>(0.0, 0.5);
    assert!(
        every_time >= 64,
        "expected 64 builds of lists without a skin, and there were {every_time}"
    );
    for skin in [0.05, 0.12, 0.5] {
        let (kept, builds) = flight::<I>(skin, 0.5);
        assert!(builds > 1 && builds < every_time, "{builds} builds with a skin of {skin} h");
        let apart = difference(&kept, &exact, torus);
        assert!(apart < 1e-12, "{}: {apart:e} with a skin of {skin} h", I::NAME);
    }
    let (wrong, builds) = flight::<I>(0.12, 5.0);
    let apart = difference(&wrong, &exact, torus);
    assert!(apart > 1e-6, "{}: ten times too long was not seen, {apart:e}", I::NAME);
    assert!(builds < flight::<I>(0.12, 0.5).1);
}

#[test]
fn rows_kept_within_the_skin_sum_what_rows_built_every_step_do() {
    check_skin::<Leapfrog>();
    check_skin::<PredictorCorrector>();
}

#[test]
fn particles_at_rest_build_their_rows_once() {
    let start: Vec<_> = patch(12, 0.0, 1)
        .into_iter()
        .map(|p| Particle { velocity: Vector2::zeros(), ..p })
        .collect();
    let scene = Scene::<Fluid>::new(
        0.1,
        Domain::torus(1.0, 1.0),
        start.clone(),
        forces(),
        Continuity,
        Open,
    );
    let mut simulation = scene.build().unwrap();
    assert_eq!(simulation.advance(1.0, 0.01, &mut ()), Outcome::Reached);
    let work = simulation.work();
    assert_eq!((work.steps, work.list_builds, work.right_hand_sides), (100, 1, 100 * 144));
    let apart = difference(&simulation.particles(), &start, [None, None]);
    assert_small("what is left of the start after the way back", apart, 1e-13);
}
