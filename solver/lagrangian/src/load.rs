//! What acts on a solid in its present configuration: weight, a rigid plane, and contact between bodies.
//! Each derives from an energy.

use nalgebra::Vector2;
use solver::{Domain, Evolved, Symmetric};

use crate::law::Moduli;

/// Particles as loads see them.
#[derive(Clone, Copy, Debug)]
pub struct Loaded<'a> {
    /// Where they are.
    pub state: &'a [Evolved<Symmetric>],
    /// Their masses \[kg/m\].
    pub masses: &'a [f64],
    /// Their sizes, the roots of their reference volumes \[m\].
    pub sizes: &'a [f64],
    /// Where they are without stress \[m\].
    pub reference: &'a [Vector2<f64>],
    /// The number of the body of each, from 0.
    pub bodies: &'a [u32],
    /// Those at the faces of bodies.
    pub faces: &'a [u32],
    /// Periodic or open.
    pub domain: &'a Domain,
}

impl Loaded<'_> {
    /// The vector from particle j to i, or to the nearest copy of it.
    fn between(&self, i: usize, j: usize, place: impl Fn(usize) -> Vector2<f64>) -> Vector2<f64> {
        let mut r = place(i) - place(j);
        for axis in 0..2 {
            if let Some(period) = self.domain.period[axis] {
                r[axis] -= period * (r[axis] / period).round();
            }
        }
        r
    }

    /// Whether two particles are of different bodies, or farther apart than this in the reference \[m\].
    fn are_apart(&self, i: usize, j: usize, distance: f64) -> bool {
        self.bodies[i] != self.bodies[j]
            || self.between(i, j, |k| self.reference[k]).norm_squared() >= distance * distance
    }
}

/// A load, `()` if there is none. A tuple of two is both.
pub trait Load: Clone + Send + Sync + 'static {
    /// Adds the accelerations \[m/s²\] that follow.
    fn push(&self, on: &Loaded, accelerations: &mut [Vector2<f64>]);
    /// The energy that the forces derive from \[J/m\].
    fn energy(&self, on: &Loaded) -> f64;
}

impl Load for () {
    fn push(&self, _: &Loaded, _: &mut [Vector2<f64>]) {}
    fn energy(&self, _: &Loaded) -> f64 {
        0.0
    }
}

impl<A: Load, B: Load> Load for (A, B) {
    fn push(&self, on: &Loaded, accelerations: &mut [Vector2<f64>]) {
        self.0.push(on, accelerations);
        self.1.push(on, accelerations);
    }
    fn energy(&self, on: &Loaded) -> f64 {
        self.0.energy(on) + self.1.energy(on)
    }
}

/// A uniform acceleration \[m/s²\].
#[derive(Clone, Copy, Debug)]
pub struct Weight(pub Vector2<f64>);

impl Load for Weight {
    fn push(&self, _: &Loaded, accelerations: &mut [Vector2<f64>]) {
        accelerations.iter_mut().for_each(|a| *a += self.0);
    }
    fn energy(&self, on: &Loaded) -> f64 {
        let of =
            |(evolved, mass): (&Evolved<Symmetric>, &f64)| -mass * self.0.dot(&evolved.position);
        on.state.iter().zip(on.masses).map(of).fold(0.0, |sum, one| sum + one)
    }
}

/// Two places that touch at the distance t push each other apart where they are nearer, at d < t, with the
/// force k (t − d) t/d per unit depth: k (t − d) at first, and so large at last that nothing passes.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// k \[Pa\].
    pub stiffness: f64,
}

impl Contact {
    /// The rule k = (K + 4μ/3)/4. Two bodies that meet send fronts that rise at the rate 2 k/(ρ c_p dx), and
    /// a lattice carries waves of up to half its largest frequency, about c_p/dx, with little dispersion. A
    /// harder contact leaves energy in waves that are hardly longer than two spacings, a softer one lets
    /// bodies overlap more. Contact shortens the longest stable step of the lattice; by how much is not
    /// known.
    pub fn of(moduli: &Moduli) -> Self {
        Self { stiffness: 0.25 * moduli.longitudinal() }
    }

    /// The force \[N/m\].
    fn force(&self, touch: f64, distance: f64) -> f64 {
        let inverse = if distance > 0.0 { touch / distance } else { f64::INFINITY };
        self.stiffness * (touch - distance).max(0.0) * inverse
    }

    /// Its energy k t (t ln(t/d) − (t − d)) \[J/m\].
    fn energy(&self, touch: f64, distance: f64) -> f64 {
        let overlap = (touch - distance).max(0.0);
        self.stiffness * touch * (-touch * libm::log1p(-overlap / touch) - overlap)
    }
}

/// A rigid plane without friction, which pushes and never pulls: half of the [`Contact`] of a body with its
/// mirror image. A particle touches it at half of its size.
#[derive(Clone, Copy, Debug)]
pub struct RigidPlane {
    /// A point of it \[m\].
    pub point: Vector2<f64>,
    /// Unit normal to the side of the body.
    pub normal: Vector2<f64>,
    /// How it pushes.
    pub contact: Contact,
}

impl RigidPlane {
    /// The size of each particle, and its distance from its mirror image \[m\].
    fn distances<'a>(&self, on: &Loaded<'a>) -> impl Iterator<Item = (f64, f64)> + use<'a> {
        let Self { point, normal, .. } = *self;
        let depth = move |evolved: &Evolved<Symmetric>| (evolved.position - point).dot(&normal);
        on.state.iter().zip(on.sizes).map(move |(at, size)| (*size, 2.0 * depth(at)))
    }
}

impl Load for RigidPlane {
    fn push(&self, on: &Loaded, accelerations: &mut [Vector2<f64>]) {
        let pushed = accelerations.iter_mut().zip(on.masses).zip(self.distances(on));
        for ((acceleration, mass), (size, distance)) in pushed {
            *acceleration += self.normal * (self.contact.force(size, distance) / mass);
        }
    }
    fn energy(&self, on: &Loaded) -> f64 {
        let half = |sum, (size, distance)| sum + 0.5 * self.contact.energy(size, distance);
        self.distances(on).fold(0.0, half)
    }
}

/// [`Contact`] between the faces of bodies, also of a body with itself: central, without friction and without
/// attraction. Two particles touch at the mean of their sizes. Those of one body that are nearer than twice
/// that in the reference do not: their distance is the business of the stress.
#[derive(Clone, Copy, Debug)]
pub struct BetweenFaces(pub Contact);

impl BetweenFaces {
    /// Calls `each` with every two particles that touch, the vector from the second to the first \[m\], and
    /// the distance at which they touch \[m\], in an order that depends on the state alone.
    fn touching(on: &Loaded, mut each: impl FnMut([usize; 2], Vector2<f64>, f64)) {
        let axis = usize::from(on.domain.period[0].is_some());
        let reach = on.sizes.iter().fold(0.0_f64, |a, b| a.max(*b));
        let place = |i: &u32| (on.state[*i as usize].position[axis], *i as usize);
        let mut sorted: Vec<(f64, usize)> = on.faces.iter().map(place).collect();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (k, &(x, i)) in sorted.iter().enumerate() {
            for &(_, j) in sorted[k + 1..].iter().take_while(|(other, _)| other - x < reach) {
                let r = on.between(i, j, |k| on.state[k].position);
                let touch = 0.5 * (on.sizes[i] + on.sizes[j]);
                if r.norm_squared() < touch * touch && on.are_apart(i, j, 2.0 * touch) {
                    each([i, j], r, touch);
                }
            }
        }
    }
}

impl Load for BetweenFaces {
    fn push(&self, on: &Loaded, accelerations: &mut [Vector2<f64>]) {
        Self::touching(on, |[i, j], r, touch| {
            let distance = r.norm();
            let force = r * (self.0.force(touch, distance) / distance);
            accelerations[i] += force / on.masses[i];
            accelerations[j] -= force / on.masses[j];
        });
    }
    fn energy(&self, on: &Loaded) -> f64 {
        let mut sum = 0.0;
        Self::touching(on, |_, r, touch| sum += self.0.energy(touch, r.norm()));
        sum
    }
}
