//! A term restricted to pairs of fluid particles: Σⱼ without boundary particles.

use super::{Common, In, Kernel, Lane, Pair, Rate, Symmetric, Term, Vector2};

/// A term without its pairs with boundary particles, [`crate::Role::Wall`] and [`crate::Role::Interface`].
///
/// Boundary particles do not move while fluid slides past them, so artificial viscosity would make fluid
/// stick to them. Without these pairs artificial viscosity exchanges momentum within the fluid only. Each
/// column carries a factor of its mass and volume: 1 for a fluid particle, 0 for a boundary particle.
#[derive(Clone, Copy, Debug)]
pub struct FluidPairs<T>(pub T);

impl<X, T: Term<X>> Term<X> for FluidPairs<T> {
    type Derived = (T::Derived, f64);
    type Sum = T::Sum;
    const NORMALISES: bool = T::NORMALISES;
    const SLIPS: bool = T::SLIPS;

    fn prepare(&mut self, max_speed: f64) {
        self.0.prepare(max_speed);
    }
    #[inline(always)]
    fn derived(&self, own: &Common, extra: &X) -> Self::Derived {
        (self.0.derived(own, extra), 1.0)
    }
    #[inline(always)]
    fn set_on_boundary(derived: &mut Self::Derived) {
        T::set_on_boundary(&mut derived.0);
        derived.1 = 0.0;
    }
    #[inline(always)]
    fn set_slip(derived: &mut Self::Derived, difference: Vector2<f64>) {
        T::set_slip(&mut derived.0, difference);
    }
    #[inline(always)]
    fn set_inverse(derived: &mut Self::Derived, inverse: Symmetric) {
        T::set_inverse(&mut derived.0, inverse);
    }
    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>, sum: &mut In<T::Sum, V>) {
        let [own, other] = pair.derived;
        let Common { mass, density, volume } = pair.other;
        let seen = Common { mass: mass * other.1, density, volume: volume * other.1 };
        self.0.pair(&Pair { other: seen, ..pair.with([own.0, other.0]) }, sum);
    }
    #[inline(always)]
    fn finish(&self, own: &Common, derived: Self::Derived, sum: T::Sum, rate: &mut Rate<X>) {
        self.0.finish(own, derived.0, sum, rate);
    }
    #[inline(always)]
    fn place(&self, position: Vector2<f64>, rate: &mut Rate<X>) {
        self.0.place(position, rate);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        ArtificialViscosity, Compose, Continuity, Domain, ExtrapolatingWall, InterfaceWall,
        Leapfrog, Particle, Pressure, Role, Scene, Stepper, Tait, WendlandC2, random::random,
        walls::Walls,
    };

    type Method<W> = Compose<WendlandC2, Pressure<Tait>, Continuity, W, Leapfrog>;

    const EOS: Tait = Tait { density: 2.0, sound_speed: 9.0, gamma: 7, background: 0.0 };
    const DX: f64 = 0.1;
    /// Rows of fluid, the lowest half a spacing above the floor.
    const ROWS: usize = 6;

    fn viscosity() -> ArtificialViscosity<Tait> {
        ArtificialViscosity::new(0.3, 0.7, 1.5 * DX, EOS)
    }

    /// Fluid in a periodic channel, displaced from a lattice by up to half of `disorder` spacings, with a
    /// velocity disturbed by up to this number in m/s, above rows of boundary particles in these roles.
    fn particles(disorder: f64, boundary: &[Role]) -> Vec<Particle> {
        let mut random = random(1);
        let mut random = || random() * disorder;
        let fluid = crate::lattice(Vector2::repeat(0.5 * DX), DX, 10, ROWS).map(|x| {
            let place = x + Vector2::new(random(), random()) * DX;
            let velocity = Vector2::new(3.0 + random(), random());
            Particle::fluid(place, velocity, 2.1 + 0.1 * random(), DX * DX)
        });
        let mut particles: Vec<Particle> = fluid.collect();
        for (row, role) in boundary.iter().enumerate() {
            let first = Vector2::new(0.5, -0.5 - row as f64) * DX;
            let at = |x| Particle::fluid(x, Vector2::zeros(), 2.0, DX * DX).with_role(*role);
            particles.extend(crate::lattice(first, DX, 10, 1).map(at));
        }
        particles
    }

    /// The fluid with its rates by one term.
    fn rates<T: Term<()>, W: Walls<()>>(
        term: &T,
        particles: Vec<Particle>,
        walls: W,
    ) -> Vec<(f64, Particle, Rate<()>)> {
        let (pressure, domain) = (Pressure::new(EOS), Domain::channel(1.0));
        let h = 1.5 * DX;
        let scene = Scene::<Method<W>>::new(h, domain, particles, pressure, Continuity, walls);
        let mut simulation = scene.build().expect("a scene");
        simulation.advance(0.0, 1.0, &mut ());
        let fluid: Vec<(f64, Vector2<f64>, Vector2<f64>)> =
            simulation.data().fluid().map(|(mass, p)| (mass, p.position, p.velocity)).collect();
        let rates = simulation.rates(term);
        let all = fluid.into_iter().zip(rates);
        all.map(|((mass, x, v), rate)| (mass, Particle::fluid(x, v, 2.0, mass), rate)).collect()
    }

    fn power(of: &[(f64, Particle, Rate<()>)]) -> f64 {
        of.iter().map(|(mass, p, rate)| mass * p.velocity.dot(&rate.velocity)).sum()
    }

    /// Σ m dv/dt along the wall, and Σ m |dv/dt|.
    fn forces(of: &[(f64, Particle, Rate<()>)]) -> [f64; 2] {
        let sum = |of_rate: fn(&Rate<()>) -> f64, all: &[(f64, Particle, Rate<()>)]| -> f64 {
            all.iter().map(|(mass, _, rate)| mass * of_rate(rate)).sum()
        };
        [sum(|rate| rate.velocity.x, of), sum(|rate| rate.velocity.norm(), of)]
    }

    const WALL: [Role; 3] = [Role::Wall; 3];
    const INTERFACE: [Role; 3] = [Role::Interface, Role::Wall, Role::Wall];

    fn extrapolating() -> ExtrapolatingWall<Tait> {
        ExtrapolatingWall::new(EOS, Vector2::zeros())
    }

    /// Without [`FluidPairs`], water that slides at one speed along boundary particles loses energy.
    #[test]
    fn a_layer_that_slides_at_one_speed_along_boundary_particles_lost_energy() {
        let slides = || particles(0.0, &WALL);
        let on_surface = || particles(0.0, &INTERFACE);
        let (all, fluid) = (viscosity(), FluidPairs(viscosity()));
        for lost in [
            power(&rates(&all, slides(), extrapolating())),
            power(&rates(&all, on_surface(), InterfaceWall)),
        ] {
            assert!(lost < -1.0, "the boundary particles drag: {lost}");
        }
        for found in
            [rates(&fluid, slides(), extrapolating()), rates(&fluid, on_surface(), InterfaceWall)]
        {
            assert_eq!((power(&found), forces(&found)[1]), (0.0, 0.0));
        }
    }

    #[test]
    fn momentum_along_boundary_particles_is_kept_in_any_disorder() {
        let mixed = || particles(0.8, &WALL);
        let [along, all] = forces(&rates(&viscosity(), mixed(), extrapolating()));
        assert!(along < -0.01 * all, "they drag: {along} of {all}");
        let found = rates(&FluidPairs(viscosity()), mixed(), extrapolating());
        let [along, all] = forces(&found);
        assert!(along.abs() < 1e-14 * all && all > 1.0, "{along:e} of {all}");
        assert!(power(&found) < 0.0, "and energy is lost where particles of the fluid approach");
    }

    /// For particles beyond the reach of the wall, and for all particles without a wall.
    #[test]
    fn pairs_of_the_fluid_have_the_same_bits() {
        let bits = |rate: &Rate<()>| [rate.velocity.x, rate.velocity.y].map(f64::to_bits);
        for boundary in [&[][..], &WALL, &INTERFACE] {
            let mixed = || particles(0.8, boundary);
            let all = rates(&viscosity(), mixed(), extrapolating());
            let fluid = rates(&FluidPairs(viscosity()), mixed(), extrapolating());
            let (mut same, mut other) = (0, 0);
            for ((_, p, a), (_, _, b)) in all.iter().zip(&fluid) {
                let is_far = boundary.is_empty() || p.position.y > 3.0 * DX - 0.5 * DX;
                assert!(!is_far || bits(a) == bits(b), "{}: {a:?} {b:?}", p.position);
                (same, other) = match bits(a) == bits(b) {
                    true => (same + 1, other),
                    false => (same, other + 1),
                };
            }
            assert!(same >= 30 && (other >= 10) != boundary.is_empty(), "{same} {other}");
        }
    }
}
