//! Conservation laws for arbitrary particles, to round-off, term by term.

use nalgebra::Vector2;
use touchstone_solver::{
    ArtificialStress, ArtificialViscosity, Continuity, CubicSpline, DensityDiffusion, Particle,
    Pressure, QuinticSpline, Rate, Smoothing, Tait, Term, Viscosity, Xsph,
};
use touchstone_tests::{Random, assert_small, open_rates, relative_sum};

const H: f64 = 0.12;
const ROUND_OFF: f64 = 1e-12;

/// Random positions, velocities, densities below and above ⁰ρ, and masses within a factor of 4.
fn cloud(seed: u64) -> Vec<Particle> {
    let mut random = Random::new(seed);
    let particle = |_| {
        let (position, velocity) = (random.vector(0.0, 1.0), random.vector(-1.0, 1.0));
        let (density, volume) = (random.between(900.0, 1100.0), random.between(1e-3, 4e-3));
        Particle::fluid(position, velocity, density, volume)
    };
    (0..300).map(particle).collect()
}

fn water() -> Tait {
    Tait { background: 50.0, ..Tait::new(1000.0, 12.0) }
}

fn stressed() -> Pressure<Tait, ArtificialStress> {
    let w = Smoothing::<CubicSpline>::new(H).w(0.01);
    Pressure { eos: water(), tensile: ArtificialStress::new(0.3, 4, w) }
}

/// Both components of Σ m a vanish, and Σ m x × a if the term is central.
fn check_momentum(name: &str, central: bool, forces: impl Term<()>) {
    for seed in 0..5 {
        let cloud = cloud(seed);
        let rates = open_rates::<CubicSpline, _, _, _>(H, &cloud, forces.clone(), ());
        for axis in 0..2 {
            let forces = cloud.iter().zip(&rates).map(|(p, r)| p.mass * r.velocity[axis]);
            let sum = relative_sum(forces);
            assert!(sum.abs() < ROUND_OFF, "{name}: sum m a = {sum:e}");
        }
        let torques = cloud.iter().zip(&rates).map(|(p, r)| p.mass * p.position.perp(&r.velocity));
        let torque = relative_sum(torques);
        if central {
            assert!(torque.abs() < ROUND_OFF, "{name}: torque {torque:e}");
        } else {
            assert!(torque.abs() > 1e-6, "{name} is central after all: torque {torque:e}");
        }
    }
}

/// For any kernel: it enters a force only by F and W, which are equal for both particles of a pair.
#[test]
fn forces_add_up_to_nothing_and_central_ones_have_no_torque() {
    let damping = ArtificialViscosity::<_, false>::new(0.3, 0.6, H, water());
    let always = ArtificialViscosity::<_, true>::new(0.3, 0.6, H, water());
    check_momentum("pressure", true, Pressure::new(water()));
    check_momentum("artificial stress", true, stressed());
    check_momentum("artificial viscosity", true, damping);
    check_momentum("artificial viscosity, always", true, always);
    check_momentum("viscosity", false, Viscosity { mu: 0.7, eta2: 0.01 * H * H });
}

#[test]
fn the_artificial_stress_is_not_idle_in_these_clouds() {
    let (with, without) = (stressed(), Pressure::new(water()));
    let a = open_rates::<CubicSpline, _, _, _>(H, &cloud(0), with, ());
    let b = open_rates::<CubicSpline, _, _, _>(H, &cloud(0), without, ());
    let differ = a.iter().zip(&b).filter(|(a, b)| a.velocity != b.velocity).count();
    assert!(differ > 250, "{differ} of 300 particles feel it");
}

/// Σ m v·a, the power of a force.
fn power(cloud: &[Particle], rates: &[Rate<()>]) -> impl Iterator<Item = f64> {
    cloud.iter().zip(rates).map(|(p, r)| p.mass * p.velocity.dot(&r.velocity))
}

#[test]
fn work_of_the_pressure_is_what_compression_stores() {
    for seed in 0..5 {
        let cloud = cloud(seed);
        let rates =
            open_rates::<QuinticSpline, _, _, _>(H, &cloud, Pressure::new(water()), Continuity);
        let stored = cloud.iter().zip(&rates).map(|(p, r)| {
            let pressure = touchstone_solver::EquationOfState::pressure(&water(), p.density);
            p.mass * pressure / (p.density * p.density) * r.density
        });
        let sum = relative_sum(power(&cloud, &rates).chain(stored));
        assert!(sum.abs() < ROUND_OFF, "power + storage = {sum:e}");
    }
}

/// Dissipation of a force in clouds, and for each of two particles alone, where no other pair can
/// hide a wrong one.
fn check_dissipation(name: &str, forces: impl Term<()>) {
    let mut dissipating_pairs = 0;
    for seed in 0..40 {
        let cloud = cloud(seed);
        let rates = open_rates::<CubicSpline, _, _, _>(H, &cloud, forces.clone(), ());
        let total: f64 = power(&cloud, &rates).sum();
        assert!(total < 0.0, "{name} feeds {total:e} W/m into cloud {seed}");
        let mut two = [cloud[0], cloud[1]];
        two[1].position = two[0].position + Random::new(seed).vector(-H, H);
        let rates = open_rates::<CubicSpline, _, _, _>(H, &two, forces.clone(), ());
        let pair: f64 = power(&two, &rates).sum();
        let size: f64 = power(&two, &rates).map(f64::abs).sum();
        assert!(pair <= 1e-13 * size, "{name} feeds {pair:e} W/m into pair {seed}");
        dissipating_pairs += u32::from(pair < 0.0);
    }
    assert!(dissipating_pairs > 8, "{name} acted on {dissipating_pairs} of 40 pairs");
}

#[test]
fn viscous_terms_only_dissipate() {
    check_dissipation("viscosity", Viscosity { mu: 0.7, eta2: 0.01 * H * H });
    for beta in [0.0, 40.0] {
        let approaching = ArtificialViscosity::<_, false>::new(0.3, beta, H, water());
        check_dissipation("artificial viscosity", approaching);
        let always = ArtificialViscosity::<_, true>::new(0.3, beta, H, water());
        check_dissipation("artificial viscosity, always", always);
    }
}

#[test]
fn the_drift_of_xsph_carries_no_mass() {
    for seed in 0..5 {
        let cloud = cloud(seed);
        let rates = open_rates::<CubicSpline, _, _, _>(H, &cloud, (), Xsph { epsilon: 0.5 });
        for axis in 0..2 {
            let moved = cloud.iter().zip(&rates);
            let moved = moved.map(|(p, r)| p.mass * (r.position - p.velocity)[axis]);
            let sum = relative_sum(moved);
            assert!(sum.abs() < ROUND_OFF, "sum m dx = {sum:e}");
        }
    }
}

/// The pair weight is VᵢVⱼ F, so Σ Vᵢ dρᵢ/dt = 0 with V = m/ρ: the mass in fixed volumes is conserved, and Σ
/// m dρ/dt need not vanish.
#[test]
fn density_diffusion_conserves_the_volume_weighted_sum_and_only_that() {
    for seed in 0..5 {
        let cloud = cloud(seed);
        let diffusion = DensityDiffusion::new(0.1 * H * 12.0);
        let rates = open_rates::<CubicSpline, _, _, _>(H, &cloud, (), diffusion);
        let by_volume = cloud.iter().zip(&rates).map(|(p, r)| p.mass / p.density * r.density);
        let sum = relative_sum(by_volume);
        assert_small("Σ V dρ/dt over its size", sum, ROUND_OFF);
        let by_mass = cloud.iter().zip(&rates).map(|(p, r)| p.mass * r.density);
        let sum = relative_sum(by_mass);
        assert!(
            sum.abs() > 1e-6,
            "Σ m dρ/dt over its size: expected above 1e-6, and it is {sum:e}"
        );
        assert!(rates.iter().all(|r| r.velocity == Vector2::zeros()));
    }
}

/// (3) is d/dt Σⱼ mⱼ Wᵢⱼ exactly: compared with a central difference of the density sum.
#[test]
fn continuity_is_the_time_derivative_of_the_density_sum() {
    let cloud = cloud(1);
    let rates = open_rates::<QuinticSpline, _, _, _>(H, &cloud, Pressure::new(water()), Continuity);
    let kernel = Smoothing::<QuinticSpline>::new(H);
    let sum = |i: usize, t: f64| -> f64 {
        let place = |p: &Particle| p.position + p.velocity * t;
        let own = place(&cloud[i]);
        cloud.iter().map(|p| p.mass * kernel.w((own - place(p)).norm_squared())).sum()
    };
    for (i, rate) in rates.iter().enumerate() {
        let t = 1e-5 * H;
        let slope = (sum(i, t) - sum(i, -t)) / (2.0 * t);
        assert!((rate.density - slope).abs() < 1e-6 * sum(i, 0.0) / H, "particle {i}");
    }
}
