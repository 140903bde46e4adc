//! Mirror (ghost) particles (section 4.1 of the paper): the fluid mirrored across straight walls.

use nalgebra::Vector2;

use super::Walls;
use crate::particles::State;

/// A straight wall of infinite length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWall {
    /// A point of the wall \[m\].
    pub point: Vector2<f64>,
    /// Unit normal into the fluid.
    pub normal: Vector2<f64>,
    /// Velocity U of the wall, along itself \[m/s\].
    pub velocity: Vector2<f64>,
    /// ∂²v/∂n² at the wall \[1/(m s)\], 0 for plain mirroring.
    ///
    /// From the momentum equation at a no-slip wall, 0 = f + ν ∂²v/∂n² for a parallel flow driven
    /// by f (Basa, Quinlan & Lastiwka 2009): −f/ν. Mirroring alone implies 0.
    pub curvature: Vector2<f64>,
}

impl PlaneWall {
    /// A wall through `point` with unit `normal` into the fluid, moving with `velocity`.
    pub fn new(point: Vector2<f64>, normal: Vector2<f64>, velocity: Vector2<f64>) -> Self {
        Self { point, normal, velocity, curvature: Vector2::zeros() }
    }

    /// How deep in the fluid a point is \[m\], negative behind the wall.
    #[inline(always)]
    pub fn depth(&self, point: Vector2<f64>) -> f64 {
        (point - self.point).dot(&self.normal)
    }

    /// Moves a particle that has crossed the wall to the place of its mirror particle, which left the wall
    /// when the particle entered it, and reverses its velocity into the wall.
    #[inline(always)]
    pub(crate) fn put_back<X>(&self, particle: &mut State<X>) {
        let depth = self.depth(particle.position);
        if depth < 0.0 {
            particle.position -= self.normal * (2.0 * depth);
            let inwards = particle.velocity.dot(&self.normal);
            particle.velocity -= self.normal * (2.0 * inwards.min(0.0));
        }
    }
}

/// |cos| of an angle that counts as a right one, at most.
pub(crate) const RIGHT_ANGLE: f64 = 1e-12;

/// The pairs of walls that make a corner.
pub(crate) fn corners(walls: &[PlaneWall]) -> impl Iterator<Item = [&PlaneWall; 2]> {
    let pairs = walls.iter().enumerate().flat_map(|(k, b)| walls[..k].iter().map(move |a| [a, b]));
    pairs.filter(|[a, b]| a.normal.dot(&b.normal).abs() <= RIGHT_ANGLE)
}

/// Walls represented by mirror (ghost) particles: each particle within the list radius of a wall has an image
/// across the wall with the density and pressure of its original (inferred) and a velocity by `SLIPS`, see
/// [`Ghosts`] and [`SlipGhosts`]. In the plane of the wall a particle has equal forces from both sides, so it
/// may cross the wall: it then has no image, which would be in the fluid.
///
/// Where two walls meet at a right angle, the fluid between them, a particle within that radius of both
/// has an image across both as well: the mirror particle of its mirror particle, half a turn about the
/// corner. Other angles are refused, because their images of images never end. Walls are of infinite length:
/// a tank has a bottom and two sides, and is open at the top because there is no wall.
#[derive(Clone, Debug, Default)]
pub struct Mirrors<const SLIPS: bool> {
    /// The walls.
    pub walls: Vec<PlaneWall>,
}

/// Walls to which the fluid sticks: images have the velocity 2U − v + d² ∂²v/∂n², and across a corner v.
/// (One wall after the other gives v ± 2(U₁ − U₂), by the order; v is the mean.)
pub type Ghosts = Mirrors<false>;

/// Walls along which the fluid slips: an image is the mirror of the whole particle, velocity included,
/// v − 2\[(v − U)·n\]n = v − 2(v·n)n, and across a corner −v. The motion U of a wall along itself, and its
/// curvature, have no effect.
///
/// If a particle has crossed the wall, the next step begins with the particle at the place of its mirror
/// particle and its velocity across the wall reversed. (At a no-slip wall it stays lost: images with the
/// opposite velocity make the density of particles in the plane noisy. Of ten dam breaks two diverge, and
/// three with particles put back, six with particles stopped.)
///
/// Pressure (5) and continuity (3) then do no work on these walls in any arrangement of particles: the action
/// of the image of j on i is the mirror of the action of the image of i on j. Images of a no-slip wall do
/// work on the velocity along it (the remainder of −2 Σ m m' (p'/ρ'²) v_t·∇W).
pub type SlipGhosts = Mirrors<true>;

impl<X, const SLIPS: bool> Walls<X> for Mirrors<SLIPS> {
    type Terms = ();
    type Extrapolation = ();
    fn terms(&self) {}
    fn extrapolation(&self) {}
    const SLIPS: bool = SLIPS;
    fn mirrors(&self) -> &[PlaneWall] {
        &self.walls
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Compose, Continuity, Domain, EquationOfState, Leapfrog, Particle, Pressure, Scene,
        SlipAtWalls, Stepper, Tait, Term, Viscosity, WendlandC2, random::random,
    };

    type Method<W> = Compose<WendlandC2, Pressure<Tait>, Continuity, W, Leapfrog>;

    const EOS: Tait = Tait { density: 2.0, sound_speed: 9.0, gamma: 7, background: 0.0 };

    /// A bottom and two sides.
    fn tank() -> Vec<PlaneWall> {
        let wall = |x, y, normal| PlaneWall::new(Vector2::new(x, y), normal, Vector2::zeros());
        let (x, y) = (Vector2::x(), Vector2::y());
        vec![wall(0.0, 0.0, y), wall(0.0, 0.0, x), wall(1.0, 0.0, -x)]
    }

    /// Disordered water in the tank, with velocities from `random`, or one for all.
    fn water(uniform: Option<Vector2<f64>>) -> Vec<Particle> {
        let mut random = random(1);
        crate::lattice(Vector2::repeat(0.05), 0.1, 10, 6)
            .map(|x| {
                let place = x + Vector2::new(random(), random()) * 0.08;
                let velocity = Vector2::new(random(), random());
                let density = 2.0 + 0.2 * random();
                Particle::fluid(place, uniform.unwrap_or(velocity), density, 0.01)
            })
            .collect()
    }

    /// The change of kinetic plus compression energy by pressure and continuity, over the change by each; and
    /// the largest |dρ/dt| of particles beyond the reach of all sides.
    fn work_and_rate<W: Walls<()>>(walls: W, particles: Vec<Particle>) -> [f64; 2] {
        work_and_rate_by(&Continuity, walls, particles)
    }

    fn work_and_rate_by<T: Term<()>, W: Walls<()>>(
        continuity: &T,
        walls: W,
        particles: Vec<Particle>,
    ) -> [f64; 2] {
        let (pressure, domain) = (Pressure::new(EOS), Domain::open());
        let scene = Scene::<Method<W>>::new(0.15, domain, particles, pressure, Continuity, walls);
        let mut simulation = scene.build().expect("a scene");
        simulation.advance(0.0, 1.0, &mut ());
        let [pushed, squeezed] = [simulation.rates(&pressure), simulation.rates(continuity)];
        let (mut sum, mut all, mut fastest) = (0.0f64, 0.0f64, 0.0f64);
        for (k, (mass, p)) in simulation.data().fluid().enumerate() {
            let kinetic = mass * p.velocity.dot(&pushed[k].velocity);
            let stress = EOS.pressure(p.density) / (p.density * p.density);
            let compression = mass * stress * squeezed[k].density;
            sum += kinetic + compression;
            all += kinetic.abs() + compression.abs();
            if (0.35..0.65).contains(&p.position.x) {
                fastest = fastest.max(squeezed[k].density.abs());
            }
        }
        [sum / all, fastest]
    }

    #[test]
    fn walls_along_which_water_slips_do_no_work_in_any_disorder() {
        let [work, _] = work_and_rate(SlipGhosts { walls: tank() }, water(None));
        assert!(work.abs() < 1e-14, "work of the walls over all work: expected none, not {work:e}");
        let [work, _] = work_and_rate(Ghosts { walls: tank() }, water(None));
        assert!(work.abs() > 1e-3, "images with the opposite velocity do: {work:e}");
        let (slips, walls) = (SlipAtWalls(Continuity), Ghosts { walls: tank() });
        let [work, _] = work_and_rate_by(&slips, walls, water(None));
        assert!(work.abs() < 1e-14, "unless continuity does not see them: {work:e}");
    }

    #[test]
    fn a_uniform_flow_along_a_wall_where_it_slips_keeps_its_density() {
        let along = || water(Some(Vector2::new(3.0, 0.0)));
        let [_, rate] = work_and_rate(SlipGhosts { walls: tank() }, along());
        assert!(rate < 1e-13, "the fastest change of density: expected none, not {rate:e}");
        let [_, rate] = work_and_rate(Ghosts { walls: tank() }, along());
        assert!(rate > 0.1, "images with the opposite velocity sum disorder: {rate:e}");
    }

    /// The rates of disordered water by one term, between these walls.
    fn rates<T: Term<()>, const SLIPS: bool>(
        term: &T,
        domain: Domain,
        walls: &[PlaneWall],
        particles: Vec<Particle>,
    ) -> Vec<crate::Rate<()>> {
        let (pressure, walls) = (Pressure::new(EOS), Mirrors::<SLIPS> { walls: walls.to_vec() });
        let scene = Scene::<Method<_>>::new(0.15, domain, particles, pressure, Continuity, walls);
        let mut simulation = scene.build().expect("a scene");
        simulation.advance(0.0, 1.0, &mut ());
        simulation.rates(term)
    }

    /// Continuity and pressure do not notice a layer that slides along the wall.
    #[test]
    fn a_layer_that_slides_along_a_wall_where_it_slips_is_neither_compressed_nor_pushed_along() {
        let layer = || -> Vec<Particle> {
            let place = |x| Particle::fluid(x, Vector2::x() * 3.0, 2.1, 0.01);
            crate::lattice(Vector2::repeat(0.05), 0.1, 10, 2).map(place).collect()
        };
        let floor = &tank()[..1];
        let of = |found: &[crate::Rate<()>], rate: fn(&crate::Rate<()>) -> f64| {
            found.iter().map(|found| rate(found).abs()).fold(0.0, f64::max)
        };
        let torus = || Domain::channel(1.0);
        let density = rates::<_, true>(&Continuity, torus(), floor, layer());
        let fastest = of(&density, |rate| rate.density);
        assert!(fastest < 1e-13, "the fastest change of density: expected none, not {fastest:e}");
        let push = rates::<_, true>(&Pressure::new(EOS), torus(), floor, layer());
        assert!(of(&push, |rate| rate.velocity.x) < 1e-12 * of(&push, |rate| rate.velocity.y));
        let viscosity = Viscosity { mu: 0.3, eta2: 1e-4 };
        let slips = of(&rates::<_, true>(&viscosity, torus(), floor, layer()), |r| r.velocity.x);
        let sticks = of(&rates::<_, false>(&viscosity, torus(), floor, layer()), |r| r.velocity.x);
        assert!(slips < 1e-12 && sticks > 1.0, "a drag of {slips:e} and of {sticks:e}");
    }

    /// A particle behind the bottom must not act twice on the water above it, from its own place and as an
    /// image inside the water.
    #[test]
    fn a_particle_that_has_crossed_acts_from_its_own_place_alone() {
        let floor = tank()[..1].to_vec();
        let particle = |x, y| Particle::fluid(Vector2::new(x, y), Vector2::zeros(), 2.1, 0.01);
        let rates = |crossed: Option<Particle>, walls| {
            let particles = [particle(0.5, 0.05)].into_iter().chain(crossed).collect();
            let (pressure, domain) = (Pressure::new(EOS), Domain::open());
            let scene =
                Scene::<Method<Ghosts>>::new(0.15, domain, particles, pressure, Continuity, walls);
            let mut simulation = scene.build().expect("a scene");
            simulation.advance(0.0, 1.0, &mut ());
            let rates = simulation.rates(&pressure);
            let mut all =
                simulation.data().fluid().zip(rates).filter(|((_, p), _)| p.position.y > 0.0);
            all.next().expect("the particle in the water").1.velocity
        };
        let behind = || Some(particle(0.55, -0.04));
        let all = rates(behind(), Ghosts { walls: floor.clone() });
        let image = rates(None, Ghosts { walls: floor });
        let pair = rates(behind(), Ghosts::default());
        assert!(pair.y > 0.0 && image.y > 0.0, "both push it up: {pair} {image}");
        let off = (all - image - pair).norm() / all.norm();
        assert!(off < 1e-12, "the sum of image and pair is {off:e} off the force of both");
    }

    /// Beyond the plane only other particles act on a particle: without the correction the lowest row of a
    /// stretched layer sinks through the floor of a dam break, 4 spacings deep at a/dx = 69.
    #[test]
    fn a_particle_that_crosses_a_wall_is_put_back_where_its_mirror_particle_comes_out() {
        let (pressure, domain) = (Pressure::new(EOS), Domain::open());
        let walls = || SlipGhosts { walls: tank() };
        for (from, to, v, turned) in [
            ((0.5, -0.04), (0.5, 0.04), (3.0, -2.0), (3.0, 2.0)),
            ((-0.01, 0.3), (0.01, 0.3), (-1.0, 0.5), (1.0, 0.5)),
            ((1.02, -0.01), (0.98, 0.01), (1.0, -0.5), (-1.0, 0.5)),
            ((0.5, -0.04), (0.5, 0.04), (3.0, 2.0), (3.0, 2.0)),
            ((0.5, 0.0), (0.5, 0.0), (3.0, -2.0), (3.0, -2.0)),
        ] {
            let [from, to, v, turned] = [from, to, v, turned].map(|(x, y)| Vector2::new(x, y));
            let water = vec![Particle::fluid(from, v, 2.0, 0.01)];
            let scene = Scene::<Method<SlipGhosts>>::new(
                0.15,
                domain,
                water,
                pressure,
                Continuity,
                walls(),
            );
            let mut simulation = scene.build().expect("a scene");
            simulation.advance(0.0, 1.0, &mut ());
            let found = simulation.particles()[0];
            assert!((found.position - to).norm() < 1e-14, "{from} comes out at {}", found.position);
            assert!((found.velocity - turned).norm() < 1e-14, "with {}", found.velocity);
        }
    }

    /// A layer one row thick that falls on the floor and is stretched along it, as under a dam break.
    #[test]
    fn no_particle_of_a_thin_layer_that_is_pressed_on_a_wall_and_stretched_is_lost() {
        let layer = crate::lattice(Vector2::new(0.025, 0.004), 0.05, 20, 1).map(|place| {
            let velocity = Vector2::new(4.0 * (place.x - 0.5), -3.0);
            Particle::fluid(place, velocity, 2.0, 0.0025)
        });
        let walls = SlipGhosts { walls: tank()[..1].to_vec() };
        let terms = (Pressure::new(EOS), crate::BodyForce(Vector2::new(0.0, -9.81)));
        type Falling = Compose<
            WendlandC2,
            (Pressure<Tait>, crate::BodyForce),
            Continuity,
            SlipGhosts,
            Leapfrog,
        >;
        let scene =
            Scene::<Falling>::new(0.075, Domain::open(), layer.collect(), terms, Continuity, walls);
        let mut simulation = scene.build().expect("a scene");
        for k in 1..=40 {
            simulation.advance(0.01 * f64::from(k), 1e-3, &mut ());
            let lowest =
                simulation.particles().iter().map(|p| p.position.y).fold(f64::MAX, f64::min);
            assert!(lowest > -0.01, "{lowest} at {}", simulation.time());
        }
    }
}
