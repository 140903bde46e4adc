//! Wall particles that extrapolate from the fluid, against the formula in plain numbers, and the
//! density diffusion that keeps a column at rest.

use nalgebra::Vector2;
use touchstone_base::functions::powf;
use touchstone_solver::{
    Compose, Continuity, CubicSpline, DensityDiffusion, Domain, EquationOfState, ExtrapolatingWall,
    Hydrostatic, Leapfrog, Outcome, Particle, Pressure, Role, Scene, Shifting, Smoothing, Stepper,
    Tait, Viscosity,
    walls::{NoSlip, WallVelocity},
};
use touchstone_tests::{Random, V2, assert_near, open_rates, relative_sum};

const H: f64 = 0.1;
const LENGTH: f64 = 1.0;
const GRAVITY: V2 = V2::new(3.0, -9.0);

fn water() -> Tait {
    Tait { background: 30.0, ..Tait::new(1000.0, 20.0) }
}

type Forces = (Pressure<Tait>, Viscosity);
type Drift = (Continuity, Shifting);
type Method<U> = Compose<CubicSpline, Forces, Drift, ExtrapolatingWall<Tait, U>, Leapfrog>;

/// The fields of a particle or an image that neighbours read.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shown {
    place: V2,
    velocity: V2,
    density: f64,
    /// m/V.
    mass_over_volume: f64,
    /// p/ρ².
    stress: f64,
}

/// Fluid, wall particles and images of a scene that is periodic in x, at its start.
fn shown<U: WallVelocity>(particles: &[Particle], walls: ExtrapolatingWall<Tait, U>) -> Vec<Shown> {
    let domain = Domain::channel(LENGTH);
    let forces = (Pressure::new(walls.eos), Viscosity { mu: 0.0, eta2: 1.0 });
    let drift = (Continuity, Shifting::new(0.0, H, 1.0));
    let scene = Scene::<Method<U>>::new(H, domain, particles.to_vec(), forces, drift, walls);
    let mut simulation = scene.build().expect("a sound scene");
    assert_eq!(simulation.advance(0.0, 1.0, &mut ()), Outcome::Reached);
    let columns = simulation.columns().iter();
    let shown = columns.map(|c| Shown {
        place: c.position,
        velocity: c.velocity,
        density: c.common.density,
        mass_over_volume: c.common.mass / c.common.volume,
        stress: ((c.derived.0).0).0,
    });
    shown.collect()
}

/// Fluid above y = 0, wall particles below, moving at (0.7, 0.1), one of them out of reach.
fn scene() -> Vec<Particle> {
    let mut random = Random::new(11);
    let mut particles = Vec::new();
    for _ in 0..60 {
        let place = Vector2::new(random.between(0.0, LENGTH), random.between(0.0, 0.3));
        let density = random.between(970.0, 1030.0);
        particles.push(Particle::fluid(place, random.vector(-1.0, 1.0), density, 4e-3));
    }
    for k in 0..20 {
        let place = Vector2::new(0.05 * f64::from(k), random.between(-0.15, 0.0));
        let place = if k == 7 { Vector2::new(0.4, -0.9) } else { place };
        let wall = Particle::fluid(place, Vector2::new(0.7, 0.1), 1005.0, 4e-3);
        particles.push(wall.with_role(Role::Wall));
    }
    particles
}

/// p_w and u_w of a wall particle by the formula, over all fluid in this period and the next ones.
fn formula(wall: &Particle, fluid: &[Particle]) -> Option<(f64, V2)> {
    let kernel = Smoothing::<CubicSpline>::new(H);
    let (mut weight, mut pressure, mut velocity) = (0.0, 0.0, Vector2::zeros());
    for f in fluid {
        for period in [-LENGTH, 0.0, LENGTH] {
            let r = wall.position - f.position - Vector2::new(period, 0.0);
            let w = kernel.w(r.norm_squared());
            weight += w;
            pressure += (water().pressure(f.density) + f.density * GRAVITY.dot(&r)) * w;
            velocity += f.velocity * w;
        }
    }
    (weight > 0.0).then(|| (pressure / weight, wall.velocity * 2.0 - velocity / weight))
}

/// The kernel enters by the weights W alone.
#[test]
fn extrapolating_walls_are_the_formula_of_adami_hu_and_adams() {
    let all = scene();
    let (fluid, walls): (Vec<Particle>, Vec<Particle>) =
        all.iter().partition(|p| p.role == Role::Fluid);
    let sticky = shown::<NoSlip>(&all, ExtrapolatingWall::new(water(), GRAVITY));
    let smooth = shown::<()>(&all, ExtrapolatingWall::new(water(), GRAVITY));
    let pressures: Vec<f64> = walls.iter().filter_map(|w| Some(formula(w, &fluid)?.0)).collect();
    let floor = pressures.iter().fold(0.0, |sum, p| sum + p) / pressures.len() as f64;
    let wall = ExtrapolatingWall::new(water(), GRAVITY);
    let clipped = shown::<()>(&all, ExtrapolatingWall { least_pressure: floor, ..wall });
    let (mut below, mut alone) = (0, 0);
    for (k, wall) in walls.iter().enumerate() {
        let k = fluid.len() + k;
        let (expected, velocity, least) = match formula(wall, &fluid) {
            Some((pressure, velocity)) => (pressure, velocity, floor),
            None => {
                alone += 1;
                (water().pressure(wall.density), wall.velocity, f64::NEG_INFINITY)
            }
        };
        let near = |seen: &Shown, pressure: f64, velocity: V2| {
            let found = water().pressure(seen.density);
            assert!(
                (found - pressure).abs() < 1e-7 * pressure.abs().max(1e3),
                "the pressure at the wall: expected {pressure} Pa, and it is {found} Pa"
            );
            let off = (seen.velocity - velocity).norm();
            assert!(
                off < 1e-12,
                "velocity at the wall: expected {velocity:?}, it is {:?}",
                seen.velocity
            );
            let ratio = seen.mass_over_volume / seen.density;
            assert_near("mass over volume, over density", ratio, 1.0, 1e-15);
            let stress = found / (seen.density * seen.density);
            assert_near("the stress at the wall", seen.stress, stress, 1e-15 * stress.abs());
            assert_eq!(seen.place, wall.position);
        };
        near(&sticky[k], expected, velocity);
        near(&smooth[k], expected, wall.velocity);
        near(&clipped[k], expected.max(least), wall.velocity);
        below += u32::from(expected < least);
    }
    assert!(below > 3 && alone > 0 && alone < 4, "{below} below {floor} Pa, {alone} alone");
    // Images of wall particles equal their sources, also images filled before the sweep.
    let images = &sticky[all.len()..];
    let of_walls = images.iter().filter(|image| image.place.y < 0.0);
    let same = of_walls.filter(|image| {
        sticky[fluid.len()..all.len()].iter().any(|wall| {
            let apart = image.place - wall.place;
            let by_a_period = (apart.x.abs() - LENGTH).abs() < 1e-12 && apart.y == 0.0;
            by_a_period && (image.velocity, image.density) == (wall.velocity, wall.density)
        })
    });
    let walls_seen_twice = images.iter().filter(|image| image.place.y < 0.0).count();
    assert!(walls_seen_twice > 2 && same.count() == walls_seen_twice);
}

/// A linear p in the fluid with ∇p = ρ g continues behind the wall in any arrangement.
#[test]
fn a_hydrostatic_pressure_goes_on_behind_the_wall() {
    // So stiff that the density is uniform. Periodic along x.
    let (eos, gravity) = (Tait::new(1000.0, 2e4), Vector2::new(0.0, -9.0));
    let pressure = |x: V2| 5e3 + 1000.0 * gravity.dot(&x);
    let mut particles = scene();
    for p in &mut particles {
        p.density = eos.density(pressure(p.position));
    }
    let shown = shown::<()>(&particles, ExtrapolatingWall::new(eos, gravity));
    let walls = particles.iter().zip(&shown).filter(|(p, _)| p.role == Role::Wall);
    for (wall, seen) in walls {
        let (found, expected) = (eos.pressure(seen.density), pressure(wall.position));
        assert!((found - expected).abs() < 1e-2, "{found} Pa, {expected} Pa at {}", wall.position);
    }
}

/// Water anywhere in a column at rest, compressed by a tenth at the bottom.
fn column(eos: &Tait, gravity: V2, seed: u64) -> Vec<Particle> {
    let mut random = Random::new(seed);
    let place = |random: &mut Random| random.vector(0.0, 1.0);
    let at_rest = |x: V2| {
        // ρ of the enthalpy g·(x − corner): 1 + (γ−1) w/c² to the power 1/(γ−1).
        let w = gravity.dot(&(x - Vector2::new(0.5, 1.0)));
        let c2 = eos.sound_speed * eos.sound_speed;
        let n = f64::from(eos.gamma - 1);
        eos.density * powf(1.0 + n * w / c2, 1.0 / n)
    };
    (0..300)
        .map(|_| {
            let x = place(&mut random);
            Particle::fluid(x, Vector2::zeros(), at_rest(x), random.between(1e-3, 4e-3))
        })
        .collect()
}

#[test]
fn hydrostatic_diffusion_leaves_any_column_at_rest_alone() {
    let gravity = Vector2::new(0.5, -9.81);
    for compressibility in [1e-4, 1e-2, 0.1, 1.0] {
        let c = (9.81_f64 / compressibility).sqrt();
        let eos = Tait::new(1000.0, c);
        let water = column(&eos, gravity, 3);
        let plain = DensityDiffusion::new(0.1 * H * c);
        let rest = Hydrostatic { eos, gravity };
        let kept = DensityDiffusion { diffusivity: 0.1 * H * c, rest };
        let rates = |term| open_rates::<CubicSpline, _, _, _>(H, &water, (), term);
        let levelled = rates(plain).iter().map(|r| r.density.abs()).fold(0.0, f64::max);
        let left = open_rates::<CubicSpline, _, _, _>(H, &water, (), kept);
        let left = left.iter().map(|r| r.density.abs()).fold(0.0, f64::max);
        // Differences of densities have lost a factor of 1/compressibility to cancellation.
        let allowed = 1e-13 / compressibility;
        assert!(left < allowed * levelled, "{left:e} of {levelled:e} at {compressibility}");
    }
}

#[test]
fn without_gravity_hydrostatic_diffusion_is_the_plain_one_to_first_order() {
    let mut random = Random::new(5);
    let eos = Tait::new(1000.0, 15.0);
    for strain in [1e-3, 1e-5] {
        let cloud: Vec<Particle> = (0..200)
            .map(|_| {
                let density = 1000.0 * (1.0 + strain * random.between(-1.0, 1.0));
                Particle::fluid(random.vector(0.0, 1.0), Vector2::zeros(), density, 5e-3)
            })
            .collect();
        let plain = DensityDiffusion::new(0.1);
        let rest = Hydrostatic { eos, gravity: Vector2::zeros() };
        let kept = DensityDiffusion { diffusivity: 0.1, rest };
        let plain = open_rates::<CubicSpline, _, _, _>(H, &cloud, (), plain);
        let kept = open_rates::<CubicSpline, _, _, _>(H, &cloud, (), kept);
        let size = plain.iter().map(|r| r.density.abs()).fold(0.0, f64::max);
        for (a, b) in plain.iter().zip(&kept) {
            assert!((a.density - b.density).abs() < 10.0 * strain * size);
        }
        let by_volume = cloud.iter().zip(&kept).map(|(p, r)| p.mass / p.density * r.density);
        assert!(relative_sum(by_volume).abs() < 1e-12, "conserved as in the plain one");
    }
}
