//! Acoustic damper: pressure (5) with −ζ ∇·v in place of the pressure (Sun et al. 2023).

use super::{Common, In, Kernel, Lane, Pair, PairSum, Rate, Term, Vector2};
use crate::particles::SweptParticle;

/// dvᵢ/dt += ζ Σⱼ mⱼ (Dᵢ/ρᵢ² + Dⱼ/ρⱼ²) ∇ᵢWᵢⱼ \[m/s²\] with the divergence Dᵢ = −Σⱼ mⱼ vᵢⱼ·∇ᵢWᵢⱼ/ρᵢ \[1/s\] of
/// the continuity equation (3): a bulk viscosity ζ = α₂ ρ₀ c₀ h (Sun, Pilloton, Antuono & Colagrossi
/// 2023; the
/// weights of pairs *inferred*).
///
/// A wave of sound with wave number k decays as exp(−½ α₂ c₀ h k² t). A motion without divergence is left
/// alone: a rotation on any particles, a shear on a lattice, and a flow that keeps the density of every
/// particle. Both sums are adjoint, as pressure and continuity are: the term takes the power
/// ζ Σ Vᵢ Dᵢ² from the particles, also beside boundary particles at rest, which have D = 0, and it conserves
/// linear and angular momentum. The sum of D needs a sweep before each sweep of forces.
#[derive(Clone, Copy, Debug)]
pub struct AcousticDamper {
    /// Bulk viscosity ζ \[Pa s\].
    pub bulk: f64,
}

impl<X> Term<X> for AcousticDamper {
    /// D/ρ² \[m⁶/kg²/s\]; 0 of boundary particles.
    type Derived = f64;
    type Sum = Vector2<f64>;
    const DIVERGES: bool = true;

    #[inline(always)]
    fn derived(&self, _: &Common, _: &X) -> f64 {
        0.0
    }
    #[inline(always)]
    fn set_divergence(derived: &mut f64, own: &Common, divergence: f64) {
        *derived = divergence / (own.density * own.density);
    }
    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, f64>, sum: &mut In<Vector2<f64>, V>) {
        *sum += pair.r * (pair.other.mass * pair.f * (pair.derived[0] + pair.derived[1]));
    }
    #[inline(always)]
    fn finish(&self, _: &Common, _: f64, sum: Vector2<f64>, rate: &mut Rate<X>) {
        rate.velocity -= sum * self.bulk;
    }
}

/// Sums D of each particle, for [`Term::set_divergence`].
pub(crate) struct Divergence;

impl<S> PairSum<S, f64> for Divergence {
    type Derived = ();
    type Sum = f64;

    #[inline(always)]
    fn read(&self, _: usize, _: &S) {}
    #[inline(always)]
    fn add<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut V) {
        *sum += pair.other.mass * pair.f * pair.v_dot_r();
    }
    #[inline(always)]
    fn result(&self, own: &SweptParticle<S>, sum: f64) -> f64 {
        sum / own.common.density
    }
}

#[expect(clippy::disallowed_methods, reason = "tests compare within a tolerance, not bits")]
#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Compose, Continuity, Domain, InterfaceWall, Leapfrog, Open, Particle, PlaneWall, Pressure,
        Role, Scene, Simulation, SlipGhosts, Smoothing, Stepper, Tait, WendlandC2, random::random,
        walls::Walls,
    };

    type Method<W> = Compose<WendlandC2, (Pressure<Tait>, AcousticDamper), Continuity, W, Leapfrog>;

    const EOS: Tait = Tait { density: 2.0, sound_speed: 9.0, gamma: 7, background: 0.0 };
    const DX: f64 = 0.1;
    const H: f64 = 1.5 * DX;
    const DAMPER: AcousticDamper = AcousticDamper { bulk: 0.7 };

    fn build<W: Walls<()>>(
        domain: Domain,
        walls: W,
        particles: Vec<Particle>,
    ) -> Simulation<Method<W>> {
        let forces = (Pressure::new(EOS), DAMPER);
        let scene = Scene::<Method<W>>::new(H, domain, particles, forces, Continuity, walls);
        let mut simulation = scene.build().expect("a scene");
        simulation.advance(0.0, 1.0, &mut ());
        simulation
    }

    /// Particles with their accelerations by the damper alone, in any order.
    fn found<W: Walls<()>>(
        simulation: &Simulation<Method<W>>,
    ) -> Vec<(f64, Particle, Vector2<f64>)> {
        let rates = simulation.rates(&DAMPER).into_iter().map(|rate| rate.velocity);
        let particle = |(mass, p): (f64, &crate::State<()>)| {
            (mass, Particle::fluid(p.position, p.velocity, p.density, mass / p.density))
        };
        let of = simulation.data().fluid().map(particle);
        of.zip(rates).map(|((mass, p), rate)| (mass, p, rate)).collect()
    }

    /// `rows` rows of ten particles, displaced from a lattice by up to half of `disorder` spacings, with
    /// densities that differ by as much.
    fn fluid(
        rows: usize,
        disorder: f64,
        velocity: impl Fn(Vector2<f64>) -> Vector2<f64>,
    ) -> Vec<Particle> {
        let mut random = random(1);
        let mut random = || random() * disorder;
        let at = |x: Vector2<f64>| {
            let place = x + Vector2::new(random(), random()) * DX;
            Particle::fluid(place, velocity(place), 2.0 + random(), DX * DX)
        };
        crate::lattice(Vector2::repeat(0.5 * DX), DX, 10, rows).map(at).collect()
    }

    fn torus() -> Domain {
        Domain::torus(1.0, 1.0)
    }

    /// A wave e sin(k·x) on a lattice has the acceleration −(ζ/ρ) g (g·e) sin(k·x), with the symbol g of the
    /// gradient, Σ V F r sin(k·r).
    #[test]
    fn a_wave_on_a_lattice_is_damped_by_the_square_of_the_symbol_of_the_gradient() {
        let kernel = Smoothing::<WendlandC2>::new(H);
        for (wave, e) in [([1, 0], [1.0, 0.0]), ([2, 1], [0.3, -0.8]), ([1, 3], [0.6, 0.2])] {
            let k = Vector2::new(f64::from(wave[0]), f64::from(wave[1])) * std::f64::consts::TAU;
            let e = Vector2::from(e);
            let sites = crate::lattice(Vector2::repeat(-4.0 * DX), DX, 9, 9);
            let near = sites.filter(|r| r.norm() > 0.5 * DX);
            let add = |sum: Vector2<f64>, r: Vector2<f64>| {
                sum + r * (DX * DX * kernel.f(r.norm_squared()) * k.dot(&r).sin())
            };
            let g = near.fold(Vector2::zeros(), add);
            let particles = fluid(10, 0.0, |x| e * k.dot(&x).sin());
            let expected = |x: Vector2<f64>| -g * (DAMPER.bulk / 2.0 * g.dot(&e) * k.dot(&x).sin());
            for (_, p, rate) in found(&build(torus(), Open, particles)) {
                let off = (rate - expected(p.position)).norm();
                assert!(off < 1e-11 * g.norm_squared(), "{wave:?}: {rate} at {}", p.position);
            }
        }
    }

    #[test]
    fn a_rotation_of_any_particles_and_a_shear_of_a_lattice_are_left_alone() {
        let largest = |of: &[(f64, Particle, Vector2<f64>)]| {
            of.iter().map(|(_, _, rate)| rate.norm()).fold(0.0, f64::max)
        };
        let of = |disorder, velocity: fn(Vector2<f64>) -> Vector2<f64>| {
            largest(&found(&build(Domain::open(), Open, fluid(10, disorder, velocity))))
        };
        let turning = of(0.8, |x| Vector2::new(-x.y, x.x) * 3.0);
        let spreading = of(0.8, |x| x * 3.0);
        assert!(turning < 1e-12 * spreading, "{turning:e} of {spreading:e}");
        let simulation = build(Domain::channel(1.0), Open, fluid(20, 0.0, |x| Vector2::x() * x.y));
        let inside = |(_, p, _): &(f64, Particle, Vector2<f64>)| (0.7..1.3).contains(&p.position.y);
        let shear: Vec<_> = found(&simulation).into_iter().filter(inside).collect();
        assert!(shear.len() >= 50 && largest(&shear) < 1e-12 * spreading, "{:e}", largest(&shear));
    }

    /// Σ m v·dv/dt, −ζ Σ V D² with D by the definition over all particles of a scene without images, Σ m
    /// dv/dt, Σ m |dv/dt| and Σ m x × dv/dt.
    struct Sums {
        power: f64,
        loss: f64,
        force: Vector2<f64>,
        size: f64,
        torque: f64,
    }

    fn sums<W: Walls<()>>(simulation: &Simulation<Method<W>>) -> Sums {
        let kernel = Smoothing::<WendlandC2>::new(H);
        let of = found(simulation);
        let walls: Vec<_> =
            simulation.particles().into_iter().filter(|p| p.role == Role::Wall).collect();
        let divergence = |p: &Particle| {
            let each = |q: &Particle| {
                let r = p.position - q.position;
                q.mass * kernel.f(r.norm_squared()) * (p.velocity - q.velocity).dot(&r)
            };
            of.iter().map(|(_, q, _)| q).chain(&walls).map(each).sum::<f64>() / p.density
        };
        let mut sums =
            Sums { power: 0.0, loss: 0.0, force: Vector2::zeros(), size: 0.0, torque: 0.0 };
        for (mass, p, rate) in &of {
            sums.power += mass * p.velocity.dot(rate);
            sums.loss -= DAMPER.bulk * mass / p.density * divergence(p).powi(2);
            sums.force += rate * *mass;
            sums.size += rate.norm() * mass;
            sums.torque += p.position.perp(rate) * mass;
        }
        sums
    }

    fn mixed(x: Vector2<f64>) -> Vector2<f64> {
        Vector2::new((7.0 * x.y).sin() + x.x, (9.0 * x.x).cos() - 2.0 * x.y)
    }

    #[test]
    fn the_power_taken_is_the_bulk_viscosity_times_the_square_of_the_divergence() {
        let of = sums(&build(Domain::open(), Open, fluid(10, 0.8, mixed)));
        let off = (of.power / of.loss - 1.0).abs();
        assert!(of.power < -0.1 && off < 1e-12, "{} of {}", of.power, of.loss);
        assert!(of.force.norm() < 1e-13 * of.size && of.torque.abs() < 1e-13 * of.size);
        let wall = crate::lattice(Vector2::new(0.5, -2.5) * DX, DX, 10, 3)
            .map(|x| Particle::fluid(x, Vector2::zeros(), 2.1, DX * DX).with_role(Role::Wall));
        let particles = fluid(6, 0.8, mixed).into_iter().chain(wall).collect();
        let of = sums(&build(Domain::open(), InterfaceWall, particles));
        let off = (of.power / of.loss - 1.0).abs();
        assert!(of.power < -0.1 && off < 1e-12, "beside a wall {} of {}", of.power, of.loss);
        assert!(of.force.y.abs() > 1e-3 * of.size, "the wall pushes");
    }

    /// Above the floor the accelerations equal those with the mirror image as particles.
    #[test]
    fn mirror_particles_have_the_divergence_of_their_source() {
        let floor = PlaneWall::new(Vector2::zeros(), Vector2::y(), Vector2::zeros());
        let above = fluid(6, 0.8, mixed);
        let mirrored = |p: &Particle| Particle {
            position: Vector2::new(p.position.x, -p.position.y),
            velocity: Vector2::new(p.velocity.x, -p.velocity.y),
            ..*p
        };
        let both = above.iter().copied().chain(above.iter().map(mirrored)).collect();
        let mirrors = build(Domain::open(), SlipGhosts { walls: vec![floor] }, above);
        let whole = found(&build(Domain::open(), Open, both));
        let size = whole.iter().map(|(_, _, rate)| rate.norm()).fold(0.0, f64::max);
        for (_, p, rate) in found(&mirrors) {
            let near = whole.iter().min_by(|a, b| {
                let away = |q: &Particle| (q.position - p.position).norm();
                away(&a.1).total_cmp(&away(&b.1))
            });
            let expected = near.expect("the particle itself").2;
            assert!((rate - expected).norm() < 1e-12 * size, "{rate} {expected}");
        }
    }

    /// The forces of a step read the divergences that are summed before it.
    #[test]
    fn the_rates_of_a_step_include_the_damper() {
        let simulation = build(torus(), Open, fluid(10, 0.8, mixed));
        let [all, pressure, damper] = [
            simulation.total_rates(),
            simulation.rates(&Pressure::new(EOS)),
            simulation.rates(&DAMPER),
        ];
        for ((all, pressure), damper) in all.iter().zip(&pressure).zip(&damper) {
            let off = all.velocity - pressure.velocity - damper.velocity;
            assert!(off.norm() < 1e-12 * all.velocity.norm() && damper.velocity.norm() > 0.0);
        }
    }
}
