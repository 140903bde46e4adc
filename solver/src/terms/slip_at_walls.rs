//! A term for which fluid slips along walls to which it sticks for other terms.

use super::{Common, In, Kernel, Lane, Pair, Rate, Symmetric, Term, Vector2};

/// A term that reads of each mirror particle the mirrored velocity of [`crate::SlipGhosts`], v − 2(v·n)n, in
/// place of the velocity of [`crate::Ghosts`], 2U − v. Elsewhere it is the term itself.
///
/// For the continuity equation: a wall lets no fluid through, and its velocity U along itself moves no
/// volume. The mirrored flow has the mirrored divergence, behind a wall and behind a right-angled corner, so
/// that a flow without divergence and without a velocity through the wall has none behind the wall either.
/// The velocity 2U − v has the divergence −2 ∂v_t/∂t there, t along the wall: the fluid beside the wall is
/// compressed wherever its velocity along the wall changes, above all at the corners of a lid. Normal motion
/// compresses the fluid alike by both velocities.
#[derive(Clone, Copy, Debug)]
pub struct SlipAtWalls<T>(pub T);

impl<X, T: Term<X>> Term<X> for SlipAtWalls<T> {
    /// The derived data of the term; of a mirror particle, the mirrored velocity minus its own \[m/s\].
    type Derived = (T::Derived, Vector2<f64>);
    type Sum = T::Sum;
    const NORMALISES: bool = T::NORMALISES;
    const DIVERGES: bool = T::DIVERGES;
    const SLIPS: bool = true;

    fn prepare(&mut self, max_speed: f64) {
        self.0.prepare(max_speed);
    }
    #[inline(always)]
    fn derived(&self, own: &Common, extra: &X) -> Self::Derived {
        (self.0.derived(own, extra), Vector2::zeros())
    }
    #[inline(always)]
    fn set_on_boundary(derived: &mut Self::Derived) {
        T::set_on_boundary(&mut derived.0);
    }
    #[inline(always)]
    fn set_slip(derived: &mut Self::Derived, difference: Vector2<f64>) {
        derived.1 = difference;
    }
    #[inline(always)]
    fn set_inverse(derived: &mut Self::Derived, inverse: Symmetric) {
        T::set_inverse(&mut derived.0, inverse);
    }
    #[inline(always)]
    fn set_divergence(derived: &mut Self::Derived, own: &Common, divergence: f64) {
        T::set_divergence(&mut derived.0, own, divergence);
    }
    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>, sum: &mut In<T::Sum, V>) {
        let [own, other] = pair.derived;
        self.0.pair(&Pair { v: pair.v - other.1, ..pair.with([own.0, other.0]) }, sum);
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
        Compose, ConsistentContinuity, Continuity, DensityDiffusion, Domain, Ghosts, Leapfrog,
        Open, Particle, PlaneWall, Pressure, QuinticSpline, Scene, Stepper, Tait, random::random,
        walls::Walls,
    };

    const DX: f64 = 0.1;
    /// Particles along each axis.
    const SIDE: usize = 10;

    /// A floor and a side that slide along themselves.
    fn corner() -> Ghosts {
        let wall = |normal, velocity| PlaneWall::new(Vector2::zeros(), normal, velocity);
        let (x, y) = (Vector2::x(), Vector2::y());
        Ghosts { walls: vec![wall(y, x * 3.0), wall(x, y * -2.0)] }
    }

    /// Fluid in the corner, off its lattice by up to half of `disorder` spacings, with this velocity.
    fn fluid(disorder: f64, velocity: impl Fn(Vector2<f64>) -> Vector2<f64>) -> Vec<Particle> {
        let mut random = random(1);
        let mut random = || random() * disorder;
        let place = |x: Vector2<f64>| {
            let x = x + Vector2::new(random(), random()) * DX;
            Particle::fluid(x, velocity(x), 1.0 + 0.1 * random(), DX * DX)
        };
        crate::lattice(Vector2::repeat(0.5 * DX), DX, SIDE, SIDE).map(place).collect()
    }

    /// dρ/dt by one term of the fluid whose support is in the corner or behind its walls.
    fn rates<T: Term<()>, W: Walls<()>>(term: &T, particles: Vec<Particle>, walls: W) -> Vec<f64> {
        type Method<W> = Compose<QuinticSpline, Pressure<Tait>, Continuity, W, Leapfrog>;
        let pressure = Pressure::new(Tait::new(1.0, 10.0));
        let scene =
            Scene::<Method<W>>::new(DX, Domain::open(), particles, pressure, Continuity, walls);
        let mut simulation = scene.build().expect("a scene");
        simulation.advance(0.0, 1.0, &mut ());
        let rates = simulation.rates(term);
        let of = |place: u32| {
            let place = place as usize;
            (simulation.data().at(place).position, rates[place].density)
        };
        let inside = |x: Vector2<f64>| x.x.max(x.y) < (SIDE as f64 - 4.0) * DX;
        let of = simulation.data().places().into_iter().take(SIDE * SIDE).map(of);
        of.filter(|(x, _)| inside(*x)).map(|(_, rate)| rate).collect()
    }

    fn largest(of: Vec<f64>) -> f64 {
        of.into_iter().map(f64::abs).fold(0.0, f64::max)
    }

    /// Beside walls, dρ/dt of the fluid equals dρ/dt in a fluid four times as large that is its own mirror.
    #[test]
    fn walls_continue_any_flow_by_its_mirror() {
        fn check<T: Term<()> + Copy>(term: T) {
            let curl = |x: Vector2<f64>| Vector2::new(1.0 + x.x * x.y, x.y - 3.0 * x.x * x.x);
            let all: Vec<Particle> = [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]
                .into_iter()
                .flat_map(|(x, y)| {
                    let mirrored = move |v: Vector2<f64>| Vector2::new(x * v.x, y * v.y);
                    fluid(0.8, curl).into_iter().map(move |p| Particle {
                        position: mirrored(p.position),
                        velocity: mirrored(p.velocity),
                        ..p
                    })
                })
                .collect();
            let expected = rates(&term, all, Open);
            let off = |found: Vec<f64>| {
                largest(found.iter().zip(&expected).map(|(a, b)| a - b).collect())
            };
            let found = off(rates(&SlipAtWalls(term), fluid(0.8, curl), corner()));
            assert!(found < 1e-12, "{found:e}");
            let sticks = off(rates(&term, fluid(0.8, curl), corner()));
            assert!(sticks > 1.0, "2U − v is another flow: {sticks}");
        }
        check(Continuity);
        check(ConsistentContinuity);
    }

    /// With 2U − v, sliding walls pull fluid at rest apart at one end and compress it at the other.
    #[test]
    fn fluid_at_rest_beside_sliding_walls_keeps_its_density() {
        for disorder in [0.0, 0.8] {
            let at_rest = || fluid(disorder, |_| Vector2::zeros());
            assert_eq!(largest(rates(&SlipAtWalls(Continuity), at_rest(), corner())), 0.0);
            let consistent = SlipAtWalls(ConsistentContinuity);
            assert_eq!(largest(rates(&consistent, at_rest(), corner())), 0.0);
            let sticks = largest(rates(&ConsistentContinuity, at_rest(), corner()));
            assert!(sticks > 1.0, "the corner leaks: {sticks}");
        }
    }

    /// Steps of a scene in which the term is one of several.
    #[test]
    fn steps_beside_sliding_walls_keep_the_density_of_fluid_at_rest() {
        fn change<D: Term<()>>(continuity: D) -> f64 {
            type Drift<D> = (D, DensityDiffusion);
            type Method<D> = Compose<QuinticSpline, Pressure<Tait>, Drift<D>, Ghosts, Leapfrog>;
            let (pressure, fluid) =
                (Pressure::new(Tait::new(1.0, 10.0)), fluid(0.0, |_| Vector2::zeros()));
            let (drift, domain) = ((continuity, DensityDiffusion::new(0.1)), Domain::open());
            let scene = Scene::<Method<D>>::new(DX, domain, fluid, pressure, drift, corner());
            let mut simulation = scene.build().expect("a scene");
            simulation.advance(0.01, 0.002, &mut ());
            largest(simulation.particles().iter().map(|p| p.density - 1.0).collect())
        }
        assert_eq!(change(SlipAtWalls(Continuity)), 0.0);
        assert!(change(Continuity) > 1e-3);
    }

    /// Flows without divergence and without a velocity through the walls.
    #[test]
    fn a_flow_along_walls_keeps_its_density() {
        let past_the_corner = |x: Vector2<f64>| Vector2::new(x.x, -x.y);
        for disorder in [0.0, 0.8] {
            let flow = || fluid(disorder, past_the_corner);
            let found = largest(rates(&SlipAtWalls(ConsistentContinuity), flow(), corner()));
            assert!(found < 1e-12, "{found:e}");
            assert!(largest(rates(&ConsistentContinuity, flow(), corner())) > 1.0);
        }
    }

    /// Flows without divergence above a floor, which the mirror bends or kinks: dρ/dt is the lattice sum of
    /// the kink in the first row, and 0 elsewhere.
    #[test]
    fn a_sheared_flow_along_a_floor_keeps_its_density_and_one_that_speeds_up_nearly_does() {
        let floor = || Ghosts { walls: vec![corner().walls[0]] };
        let beside = |flow: fn(Vector2<f64>) -> Vector2<f64>| {
            let slips = rates(&SlipAtWalls(Continuity), fluid(0.0, flow), floor());
            let sticks = rates(&Continuity, fluid(0.0, flow), floor());
            [slips, sticks].map(|rates| largest(rates[3..6].to_vec()))
        };
        let [sheared, _] = beside(|x| Vector2::new(0.7 - 2.0 * x.y, 0.0));
        assert!(sheared < 1e-14, "{sheared:e}");
        // ∂u/∂x is half a spacing in the first row.
        let rates = beside(|x| Vector2::new(x.x * x.y, -0.5 * x.y * x.y));
        let [slips, sticks] = rates.map(|rate| rate / (0.5 * DX));
        assert!(slips < 0.1 && sticks > 0.35, "{slips} and {sticks} of the velocity gradient");
    }

    /// Flow into a wall at rest compresses the fluid by the bits of the term itself, and so does a flow
    /// without walls.
    #[test]
    fn normal_motion_has_the_bits_of_the_term() {
        let onto = |x: Vector2<f64>| Vector2::new(0.0, -1.0 - x.x * x.x);
        let floor = || PlaneWall::new(Vector2::zeros(), Vector2::y(), Vector2::zeros());
        for walls in [vec![floor()], vec![]] {
            let walls = || Ghosts { walls: walls.clone() };
            let found = rates(&SlipAtWalls(Continuity), fluid(0.8, onto), walls());
            assert_eq!(found, rates(&Continuity, fluid(0.8, onto), walls()));
            assert!(largest(found) > 0.1);
        }
    }
}
