//! Boundary particles to which pressure, and with [`NoSlip`] or [`CurvedNoSlip`] velocity, are extrapolated
//! from the fluid (Adami, Hu & Adams 2012).

use crate::lane::Lane;
use nalgebra::{Matrix3, Vector2};

use super::{Extrapolation, WallState, Walls};
use crate::{
    eos::EquationOfState,
    inverse::of_three,
    kernel::Kernel,
    numbers::{In, Numbers, Symmetric},
    particles::Common,
    terms::Pair,
};

/// Walls represented by layers of boundary particles, [`crate::Role::Wall`], the first half a spacing behind
/// the surface. They do not move and integrate nothing. Before each sweep, these quantities are extrapolated
/// to them from the fluid particles f within their support:
///
/// - p_w = Σ_f \[p_f + ρ_f (g − a_w)·r_wf\] W_wf / Σ_f W_wf, and the density ρ_w = ρ(p_w);
/// - with `U` = [`NoSlip`] u_w = 2 u_wall − Σ_f u_f W_wf / Σ_f W_wf, which all terms read in place of the
///   velocity of the wall, u_wall. With `U` = [`CurvedNoSlip`] u_w is the velocity of a parabola instead.
///   With `U` = `()` u_w = u_wall and no velocity is summed, which is sufficient without viscosity.
///
/// A wall particle without fluid in its support keeps its initial velocity and density. The fluid
/// does not read these, because the particle is not a neighbour of any fluid particle either.
#[derive(Clone, Copy, Debug)]
pub struct ExtrapolatingWall<E, U = ()> {
    /// Equation of state p(ρ), ρ(p) of the pressure term.
    pub eos: E,
    /// g − a_w: body force minus acceleration of the wall \[m/s²\].
    pub acceleration: Vector2<f64>,
    /// p_w is not below this \[Pa\]: 0 where there is a free surface, above which the wall would suck
    /// the fluid up; −∞ by default.
    pub least_pressure: f64,
    /// `()`, [`NoSlip`] or [`CurvedNoSlip`].
    pub velocity: U,
}

impl<E, U: Default> ExtrapolatingWall<E, U> {
    /// A wall under g − a_w \[m/s²\].
    pub fn new(eos: E, acceleration: Vector2<f64>) -> Self {
        Self { eos, acceleration, least_pressure: f64::NEG_INFINITY, velocity: U::default() }
    }
}

/// Extrapolation of the velocity to an [`ExtrapolatingWall`]: none (`()`), [`NoSlip`] or [`CurvedNoSlip`].
pub trait WallVelocity: Copy + Send + Sync + 'static {
    /// From a wall particle to its foot, the nearest point of the surface and centre of its sums \[m\]; `()`
    /// if sums are centred at the particle.
    type Foot: Numbers;
    /// Sums of (u_wall − u_f) W.
    type Sum: Numbers;
    /// Whether there are feet.
    const FEET: bool = false;
    /// The foot of a wall particle; of any other particle `None`.
    fn foot(_: Option<&Vector2<f64>>) -> Self::Foot {
        Self::Foot::default()
    }
    /// From a fluid particle to the wall particle \[m\], and W there.
    #[inline(always)]
    fn reach<V: Lane, K: Kernel>(pair: &Pair<V, K, Self::Foot>) -> (Vector2<V>, V) {
        (pair.r, pair.w())
    }
    /// Adds a fluid particle with `v` = u_wall − u_f, of weight `w` at the wall particle.
    fn add<V: Lane, K: Kernel>(pair: &Pair<V, K, Self::Foot>, w: V, sum: &mut In<Self::Sum, V>);
    /// u_w − u_wall \[m/s\] from the sum and Σ W.
    fn beyond(sum: Self::Sum, weight: f64) -> Vector2<f64>;
}

impl WallVelocity for () {
    type Foot = ();
    type Sum = ();
    #[inline(always)]
    fn add<V: Lane, K: Kernel>(_: &Pair<V, K>, _: V, (): &mut ()) {}
    #[inline(always)]
    fn beyond(_: (), _: f64) -> Vector2<f64> {
        Vector2::zeros()
    }
}

/// u_w = 2 u_wall − Σ_f u_f W_wf / Σ_f W_wf.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSlip;

impl WallVelocity for NoSlip {
    type Foot = ();
    type Sum = Vector2<f64>;
    #[inline(always)]
    fn add<V: Lane, K: Kernel>(pair: &Pair<V, K>, w: V, sum: &mut Vector2<V>) {
        *sum += pair.v * w;
    }
    #[inline(always)]
    fn beyond(sum: Vector2<f64>, weight: f64) -> Vector2<f64> {
        sum / weight
    }
}

/// u_w = u_wall − a + b/2 of the field u_wall + a η + b η²/2 + c ξ η, fitted by least squares with weights V
/// W to the fluid around the foot of the wall particle. η is the distance from the surface and ξ the distance
/// along it, over the depth of the wall particle. Exact for every field of second degree that is u_wall on a
/// plane surface. Each wall particle needs its foot, see [`crate::scene::Setting::feet`]. With too few
/// particles to separate a from b, b and c are 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct CurvedNoSlip;

/// Least determinant of the moments of a fit over the product of their diagonal: 0.003 to 0.02 where three
/// rows of fluid are in reach, 0 where one is.
const LEAST_OF_FIT: f64 = 1e-4;

impl WallVelocity for CurvedNoSlip {
    type Foot = Vector2<f64>;
    /// With p = (η, η²/2, ξη): Σ V W pₖpₗ for kl = 11, 22 and 12; 13 and 23; 33; Σ V W pₖ (u_wall − u_f).
    type Sum = (Symmetric, Vector2<f64>, f64, Vector2<f64>, Vector2<f64>, Vector2<f64>);
    const FEET: bool = true;

    fn foot(foot: Option<&Vector2<f64>>) -> Vector2<f64> {
        foot.copied().unwrap_or_default()
    }
    #[inline(always)]
    fn reach<V: Lane, K: Kernel>(pair: &Pair<V, K, Self::Foot>) -> (Vector2<V>, V) {
        let r = pair.r - pair.derived[0];
        (r, pair.kernel.w(r.x * r.x + r.y * r.y))
    }
    #[inline(always)]
    fn add<V: Lane, K: Kernel>(pair: &Pair<V, K, Self::Foot>, _: V, sum: &mut In<Self::Sum, V>) {
        let (r, foot) = (pair.r, pair.derived[0]);
        let d2 = foot.x * foot.x + foot.y * foot.y;
        let away = V::all(0.0) - (r.x * foot.x + r.y * foot.y) / d2;
        let along = (r.y * foot.x - r.x * foot.y) / d2;
        let (bent, turned) = (away * away * V::all(0.5), along * away);
        let weight = pair.other.volume * pair.w();
        let [a, b, c] = [away * weight, bent * weight, turned * weight];
        let (kk, k3, m33, v_away, v_bent, v_turned) = sum;
        *kk = *kk + Symmetric { xx: a * away, yy: b * bent, xy: a * bent };
        *k3 += Vector2::new(a * turned, b * turned);
        *m33 += c * turned;
        *v_away += pair.v * a;
        *v_bent += pair.v * b;
        *v_turned += pair.v * c;
    }
    #[inline(always)]
    fn beyond((kk, k3, m33, v_away, v_bent, v_turned): Self::Sum, _: f64) -> Vector2<f64> {
        let Symmetric { xx, yy, xy } = kk;
        let moments = Matrix3::new(xx, xy, k3.x, xy, yy, k3.y, k3.x, k3.y, m33);
        // The field at η = −1, ξ = 0; the sums have the opposite sign.
        if let Some(inverse) = of_three(&moments).above(LEAST_OF_FIT * xx * yy * m33) {
            let weight = |k| inverse[(k, 0)] - 0.5 * inverse[(k, 1)];
            return v_away * weight(0) + v_bent * weight(1) + v_turned * weight(2);
        }
        if xx > 0.0 { v_away / xx } else { Vector2::zeros() }
    }
}

impl<X, E: EquationOfState, U: WallVelocity> Walls<X> for ExtrapolatingWall<E, U> {
    type Terms = ();
    type Extrapolation = Self;
    fn terms(&self) {}
    fn extrapolation(&self) -> Self {
        *self
    }
}

impl<E: EquationOfState, U: WallVelocity> Extrapolation for ExtrapolatingWall<E, U> {
    const FEET: bool = U::FEET;
    type Foot = U::Foot;
    /// Σ W \[1/m²\], Σ \[p + ρ (g − a_w)·r\] W \[Pa/m²\], and the sums of the velocity.
    type Sum = (f64, f64, U::Sum);

    fn foot(foot: Option<&Vector2<f64>>) -> U::Foot {
        U::foot(foot)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, U::Foot>, sum: &mut In<Self::Sum, V>) {
        let (weight, pressure, velocity) = sum;
        let ((r, w), density) = (U::reach(pair), pair.other.density);
        let a = self.acceleration;
        let across = V::all(a.x) * r.x + V::all(a.y) * r.y;
        *weight += w;
        *pressure += (self.eos.pressure(density) + density * across) * w;
        U::add(pair, w, velocity);
    }

    #[inline(always)]
    fn finish(&self, own: &Common, (weight, pressure, velocity): Self::Sum) -> WallState {
        if weight > 0.0 {
            let pressure = (pressure / weight).max(self.least_pressure);
            let density = self.eos.density(pressure);
            WallState { density, velocity: U::beyond(velocity, weight) }
        } else {
            WallState { density: own.density, velocity: Vector2::zeros() }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Compose, Continuity, Domain, Leapfrog, Particle, Pressure, QuinticSpline, Role, Scene,
        SceneError, Simulation, Stepper, Tait, Viscosity, random::random,
    };

    const DX: f64 = 0.1;
    const WALL: Vector2<f64> = Vector2::new(0.7, -0.2);

    type Method<U> =
        Compose<QuinticSpline, Pressure<Tait>, Continuity, ExtrapolatingWall<Tait, U>, Leapfrog>;

    /// Rows of fluid off their lattice by up to half of `disorder` spacings with this velocity relative to
    /// the wall, above three rows of a plane wall.
    fn scene<U: WallVelocity + Default>(
        domain: Domain,
        rows: usize,
        disorder: f64,
        velocity: impl Fn(Vector2<f64>) -> Vector2<f64>,
    ) -> Result<Simulation<Method<U>>, SceneError> {
        let mut random = random(1);
        let mut random = || random() * disorder;
        let fluid = crate::lattice(Vector2::repeat(0.5 * DX), DX, 10, rows).map(|x| {
            let place = x + Vector2::new(random(), random()) * DX;
            Particle::fluid(place, WALL + velocity(place), 1.0 + 0.1 * random(), DX * DX)
        });
        let wall = crate::lattice(Vector2::new(0.5, -2.5) * DX, DX, 10, 3)
            .map(|x| Particle::fluid(x, WALL, 1.0, DX * DX).with_role(Role::Wall));
        let particles: Vec<Particle> = fluid.chain(wall).collect();
        let wall = particles.iter().filter(|p| U::FEET && p.role == Role::Wall);
        let feet = wall.map(|p| Vector2::new(0.0, -p.position.y)).collect();
        let eos = Tait::new(1.0, 10.0);
        let (pressure, walls) = (Pressure::new(eos), ExtrapolatingWall::new(eos, Vector2::zeros()));
        let mut scene = Scene::new(DX, domain, particles, pressure, Continuity, walls);
        scene.setting.feet = feet;
        let mut simulation = scene.build()?;
        simulation.advance(0.0, 1.0, &mut ());
        Ok(simulation)
    }

    /// The largest difference between the extrapolated velocity of a wall particle and the field.
    fn off<U: WallVelocity + Default>(
        rows: usize,
        disorder: f64,
        velocity: impl Fn(Vector2<f64>) -> Vector2<f64>,
    ) -> f64 {
        let simulation = scene::<U>(Domain::open(), rows, disorder, &velocity).expect("a scene");
        let walls =
            simulation.columns().iter().filter(|c| (-2.0 * DX..0.0).contains(&c.position.y));
        walls.map(|c| (c.velocity - WALL - velocity(c.position)).norm()).fold(0.0, f64::max)
    }

    #[test]
    fn a_curved_wall_velocity_continues_every_field_of_second_degree_over_any_particles() {
        let linear = |x: Vector2<f64>| Vector2::new(3.0, -0.5) * x.y;
        let bent = |x: Vector2<f64>| {
            linear(x) + (Vector2::new(-9.0, 4.0) * x.y + Vector2::new(5.0, 2.0) * x.x) * x.y
        };
        for disorder in [0.0, 0.8] {
            let found = off::<CurvedNoSlip>(6, disorder, bent);
            assert!(found < 1e-12, "disorder {disorder}: {found:e}");
            assert!(off::<NoSlip>(6, disorder, bent) > 0.1, "minus the mean of what is in reach");
        }
        let found = off::<CurvedNoSlip>(1, 0.0, linear);
        assert!(found < 1e-13, "one row tells no curvature: {found:e}");
    }

    /// For a parabola above a wall on a lattice, the viscous force (6) next to the wall is the force inside.
    #[test]
    fn the_viscous_force_beside_a_curved_wall_velocity_is_that_inside() {
        let parabola = |x: Vector2<f64>| Vector2::new(3.0 * x.y - 9.0 * x.y * x.y, 0.0);
        fn rows<U: WallVelocity + Default>(of: fn(Vector2<f64>) -> Vector2<f64>) -> Vec<[f64; 2]> {
            let simulation = scene::<U>(Domain::channel(1.0), 12, 0.0, of).expect("a scene");
            let rates = simulation.rates(&Viscosity { mu: 1.0, eta2: 1e-9 });
            let places = simulation.data().fluid().map(|(_, p)| p.position.y);
            places.zip(rates).map(|(y, rate)| [y, rate.velocity.x / -18.0]).collect()
        }
        let rows = [rows::<CurvedNoSlip>(parabola), rows::<NoSlip>(parabola)];
        let worst = |rows: &[[f64; 2]]| {
            let inside = rows.iter().find(|row| (row[0] / DX - 5.5).abs() < 0.1).expect("a row")[1];
            assert!((inside - 1.0).abs() < 2e-3, "the factor of the lattice is near 1: {inside}");
            let beside = rows.iter().filter(|row| row[0] < 3.0 * DX);
            beside.map(|row| (row[1] / inside - 1.0).abs()).fold(0.0, f64::max)
        };
        let [curved, mean] = rows.map(|rows| worst(&rows));
        assert!(curved < 1e-11, "{curved:e}");
        assert!(mean > 0.3, "minus the mean of what is in reach: {mean}");
    }

    #[test]
    fn feet_that_are_missing_or_on_the_particle_are_refused() {
        let build = |feet: Vec<Vector2<f64>>| {
            let eos = Tait::new(1.0, 10.0);
            let at = |y| Particle::fluid(Vector2::new(0.0, y), WALL, 1.0, DX * DX);
            let particles = vec![at(0.05), at(-0.05).with_role(Role::Wall)];
            let walls = ExtrapolatingWall::<Tait, CurvedNoSlip>::new(eos, Vector2::zeros());
            let (pressure, domain) = (Pressure::new(eos), Domain::open());
            let mut scene = Scene::<Method<CurvedNoSlip>>::new(
                DX, domain, particles, pressure, Continuity, walls,
            );
            scene.setting.feet = feet;
            scene.build().map(|_| ()).map_err(|error| error.quantity)
        };
        assert_eq!(build(vec![]), Err("number of feet"));
        assert_eq!(build(vec![Vector2::zeros()]), Err("depth of a wall particle in m"));
        assert_eq!(build(vec![Vector2::new(0.0, 0.05)]), Ok(()));
    }
}
