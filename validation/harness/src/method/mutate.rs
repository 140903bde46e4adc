//! Deliberate errors and a deliberate disorder of a scene.

use nalgebra::Vector2;
use touchstone_base::{
    mutation::{Constant, Disorder},
    random::Random,
};
use touchstone_solver::{Numbers, Particle, Role, Tait};

use super::{Medium, Parts};
use crate::relation::{DENSITY, LENGTH, NoSymmetry, Relation, View};

/// Disorders the start, then multiplies the constant that is wrong by its factor. The time step is not part
/// of a scene, and neither are the lifetime of neighbour lists and the bodies of a total Lagrangian solid.
pub fn mutate<X: Numbers>(parts: &mut Parts<X>) {
    if let Some(disorder) = parts.disorder {
        disturb(parts, disorder);
    }
    let Some(mutation) = parts.mutation else { return };
    let of = |constant| mutation.factor_of(constant);
    let Parts { medium, particles, mirrors, surface, .. } = parts;
    let m = *medium;
    *medium = Medium {
        eos: Tait {
            density: m.eos.density * of(Constant::Density),
            sound_speed: m.eos.sound_speed * of(Constant::SoundSpeed),
            gamma: m.eos.gamma,
            background: m.eos.background,
        },
        density: m.density * of(Constant::Density),
        sound_speed: m.sound_speed * of(Constant::SoundSpeed),
        dx: m.dx,
        h: m.h * of(Constant::SmoothingLength),
        w_at_spacing: m.w_at_spacing,
        stiffest: m.stiffest,
        nu: m.nu * of(Constant::Viscosity),
        shear_modulus: m.shear_modulus * of(Constant::ShearModulus),
        acceleration: m.acceleration * of(Constant::BodyForce),
        wall_acceleration: m.wall_acceleration * of(Constant::BodyForce),
        eta2_over_h2: m.eta2_over_h2,
        alpha: m.alpha * of(Constant::ArtificialViscosity),
        beta: m.beta * of(Constant::ArtificialViscosity),
        xsph: m.xsph * of(Constant::Xsph),
        xi: m.xi * of(Constant::ArtificialStress),
        exponent: m.exponent,
        diffusion: m.diffusion * of(Constant::DensityDiffusion),
        damper: m.damper * of(Constant::AcousticDamper),
        shift: m.shift * of(Constant::Shifting),
    };
    let stretch = Vector2::new(1.0, of(Constant::Height));
    for particle in particles {
        let own = if particle.role == Role::Fluid { Constant::Speed } else { Constant::WallSpeed };
        particle.velocity *= of(own);
        particle.position.component_mul_assign(&stretch);
        particle.density *= of(Constant::Density);
        particle.mass *= of(Constant::Density) * of(Constant::Height) * of(Constant::Normalisation);
    }
    surface.iter_mut().for_each(|point| point.component_mul_assign(&stretch));
    for mirror in mirrors {
        mirror.velocity *= of(Constant::WallSpeed);
        mirror.point.component_mul_assign(&stretch);
    }
}

/// Displaces the particles that move on their own, in the order of the scene.
fn disturb<X: Numbers>(parts: &mut Parts<X>, Disorder { most, seed }: Disorder) {
    let (mut random, most) = (Random::new(seed.into()), most * parts.medium.dx);
    let mut shake = || most * (2.0 * random.uniform() - 1.0);
    for particle in parts.particles.iter_mut().filter(|p| p.role == Role::Fluid) {
        particle.position += Vector2::new(shake(), shake());
    }
}

/// Transforms the parts to the frame of another observer.
///
/// # Errors
/// Why the relation is not a symmetry of the scene.
pub(crate) fn see<X: Numbers>(parts: &mut Parts<X>, by: Relation) -> Result<View, NoSymmetry> {
    let moves: Vec<bool> = parts.particles.iter().map(|p| p.role == Role::Fluid).collect();
    let Parts { medium, domain, particles, mirrors, surface, bodies, skin, limits, .. } = parts;
    let view = View::of(by, medium, domain, mirrors, &moves)?;
    let numbers = view.numbers(&moves);
    (*medium, *domain) = (view.medium(*medium), view.domain(*domain));
    let at = |x: &Vector2<f64>| view.particle(&Particle { position: *x, ..particles[0] }).position;
    *surface = numbers.iter().filter_map(|k| surface.get(*k)).map(at).collect();
    *particles = numbers.iter().map(|k| view.particle(&particles[*k])).collect();
    *bodies = numbers.iter().filter_map(|k| bodies.get(*k).copied()).collect();
    *mirrors = mirrors.iter().map(|wall| view.wall(wall)).collect();
    *skin = skin.map(|skin| skin * view.scale(LENGTH));
    limits.density = limits.density.map(|density| density * view.scale(DENSITY));
    limits.speed = view.speed(limits.speed);
    Ok(view)
}

#[cfg(test)]
mod tests {
    use touchstone_base::mutation::Mutation;
    use touchstone_solver::{Domain, PlaneWall};

    use super::*;
    use crate::method::Method;

    type Plain = touchstone_solver::Compose<
        touchstone_solver::CubicSpline,
        (touchstone_solver::Pressure<Tait>, touchstone_solver::Viscosity),
        touchstone_solver::Continuity,
        touchstone_solver::Ghosts,
        touchstone_solver::Leapfrog,
    >;

    fn parts(mutation: Option<Mutation>) -> Parts {
        let method = <Method>::with::<Plain>(|_| unreachable!("no scene is built"));
        let medium = Medium {
            nu: 0.1,
            shear_modulus: 3.0,
            acceleration: Vector2::new(0.0, -9.8),
            wall_acceleration: Vector2::new(0.0, -9.8),
            alpha: 0.1,
            beta: 0.2,
            xsph: 0.5,
            xi: 0.3,
            diffusion: 0.4,
            damper: 0.8,
            shift: 0.6,
            ..method.properties.medium(Tait::new(1000.0, 20.0), 0.1, 0.15)
        };
        let fluid = Particle::fluid(Vector2::new(0.2, 0.3), Vector2::new(1.0, 2.0), 1000.0, 0.01);
        let wall = fluid.with_role(Role::Wall);
        let wall_at = PlaneWall::new(Vector2::new(0.0, 1.0), -Vector2::y(), Vector2::x());
        Parts {
            mirrors: vec![wall_at],
            mutation,
            ..Parts::new(medium, Domain::open(), vec![fluid, wall])
        }
    }

    /// Every number that a scene is made from.
    fn numbers(parts: &Parts) -> Vec<f64> {
        let m = parts.medium;
        let mut all = vec![m.nu, m.shear_modulus, m.acceleration.y, m.wall_acceleration.y, m.alpha];
        all.extend([
            m.beta,
            m.xsph,
            m.xi,
            m.diffusion,
            m.damper,
            m.shift,
            m.h,
            m.density,
            m.sound_speed,
        ]);
        all.extend([m.eos.density, m.eos.sound_speed]);
        for p in &parts.particles {
            all.extend([p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density, p.mass]);
        }
        all.extend(parts.mirrors.iter().flat_map(|w| [w.point.y, w.velocity.x]));
        all
    }

    #[test]
    fn an_error_changes_its_own_constant_and_nothing_else() {
        let healthy = numbers(&parts(None));
        let changed = |of: Constant| {
            let mut parts = parts(Some(Mutation { of, factor: 1.5 }));
            mutate(&mut parts);
            let pairs = healthy.iter().zip(numbers(&parts));
            pairs.filter(|(a, b)| (*b / *a - 1.5).abs() < 1e-12).count()
        };
        let expected = [
            (Constant::Viscosity, 1),
            (Constant::BodyForce, 2),
            (Constant::WallSpeed, 3),
            (Constant::Speed, 2),
            (Constant::SoundSpeed, 2),
            (Constant::Density, 6),
            (Constant::ShearModulus, 1),
            (Constant::Height, 5),
            (Constant::Normalisation, 2),
            (Constant::SmoothingLength, 1),
            (Constant::TimeStep, 0),
            (Constant::ArtificialViscosity, 2),
            (Constant::ArtificialStress, 1),
            (Constant::Xsph, 1),
            (Constant::DensityDiffusion, 1),
            (Constant::AcousticDamper, 1),
            (Constant::Shifting, 1),
            (Constant::ListLifetime, 0),
        ];
        for (of, count) in expected {
            assert_eq!(changed(of), count, "{of}");
        }
        let mut same = parts(Some(Mutation { of: Constant::Height, factor: 1.0 }));
        mutate(&mut same);
        assert_eq!(numbers(&same), healthy);
    }

    #[test]
    fn disorder_moves_fluid_alone_by_what_its_seed_says() {
        let healthy = numbers(&parts(None));
        let moved = |seed| {
            let mut parts = parts(None);
            parts.disorder = Some(Disorder { most: 1e-3, seed });
            mutate(&mut parts);
            let pairs = healthy.iter().zip(numbers(&parts)).enumerate();
            let moved = pairs.filter(|(_, (a, b))| **a != *b).map(|(k, (a, b))| (k, b - a));
            moved.collect::<Vec<_>>()
        };
        let [one, other] = [1, 2].map(moved);
        // Position of the first particle, the only one of fluid, by less than 1e-3 dx = 1e-4.
        assert_eq!(one.iter().map(|(k, _)| *k).collect::<Vec<_>>(), [16, 17]);
        assert!(one.iter().all(|(_, by)| by.abs() <= 1e-4) && one != other);
        assert_eq!(one, moved(1), "a seed says it all");
    }
}
