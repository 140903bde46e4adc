//! The reference configuration: neighbours of each particle, their weights, and the inverse of the moments.
//! Computed once, then constant.

use crate::lane::LANES;
use crate::{
    Domain, Kernel, ParticleData, SceneError, Smoothing, Symmetric,
    inverse::{Inverse, LEAST_DETERMINANT, of_two},
    scene::{Component, require},
    walls::Map,
};
use nalgebra::{Matrix2, Vector2};

/// An image of a particle or of an earlier image: mirrored at a wall, or a period away.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceImage {
    /// The particle or earlier image that it copies.
    pub source: usize,
    /// Q, so that its displacement is Q u.
    pub displaced: Matrix2<f64>,
    /// M, so that its reference place is M X + constant. Its tensors are Q T Mᵀ.
    pub mirrored: Matrix2<f64>,
}

impl ReferenceImage {
    /// At a wall that holds the body the displacement is odd, u' = −u, and so 0 on the wall. Along a wall
    /// with slip the displacement is mirrored like the place.
    fn new(source: usize, map: &Map, slips: bool) -> Self {
        let one = Matrix2::identity();
        let (mirrored, held) = match map {
            Map::Mirror(wall) => (one - wall.normal * wall.normal.transpose() * 2.0, -one),
            Map::Corner(..) => (-one, one),
            Map::Shift(_) => (one, one),
        };
        Self { source, displaced: if slips { mirrored } else { held }, mirrored }
    }

    /// Q T Mᵀ.
    pub fn tensor(&self, of_source: &Matrix2<f64>) -> Matrix2<f64> {
        self.displaced * of_source * self.mirrored.transpose()
    }
}

/// Four neighbours of a particle, or fewer and the particle itself in the lanes that are left.
#[derive(Clone, Debug)]
pub struct Four {
    /// Particles or images.
    pub who: [u32; LANES],
    /// g of each, 0 for the particle itself \[1\].
    pub weights: [f64; LANES],
    /// g X, with X from the particle to the neighbour, along x and along y \[m\]; kept so that a sweep reads
    /// only the displacement of a neighbour.
    pub arms: [[f64; LANES]; 2],
}

/// Particles, then their images, in the reference configuration.
#[derive(Clone, Debug, Default)]
pub struct ReferenceConfiguration {
    /// X of particles and images \[m\].
    pub places: Vec<Vector2<f64>>,
    /// V of the particles \[m²\].
    pub volumes: Vec<f64>,
    /// Masses of the particles \[kg/m\].
    pub masses: Vec<f64>,
    /// Sizes of the particles, the roots of their volumes \[m\].
    pub sizes: Vec<f64>,
    /// The number of the body of each particle, from 0.
    pub bodies: Vec<u32>,
    /// The particles at the faces of bodies.
    pub faces: Vec<u32>,
    /// Periodic or open.
    pub domain: Domain,
    /// M⁻¹ of the particles \[1/m²\].
    pub inverse: Vec<Matrix2<f64>>,
    /// The images.
    pub images: Vec<ReferenceImage>,
    /// The neighbours of particle k are `fours[starts[k]..starts[k + 1]]`.
    starts: Vec<u32>,
    fours: Vec<Four>,
    /// Neighbours of all particles.
    pairs: u64,
}

impl ReferenceConfiguration {
    /// The reference of these particles, whose lists reach at least the support of the kernel. Particles of
    /// different bodies are no neighbours.
    pub fn new<K: Kernel>(
        data: &ParticleData<Symmetric>,
        kernel: &Smoothing<K>,
        bodies: Vec<u32>,
        domain: Domain,
        slips: bool,
    ) -> Result<Self, SceneError> {
        let mut this = Self { bodies, domain, starts: vec![0], ..Self::default() };
        let mut particle: Vec<usize> = (0..data.fluid_count()).collect();
        for (mass, evolved) in data.fluid() {
            this.places.push(evolved.position);
            this.masses.push(mass);
            this.volumes.push(mass / evolved.density);
            this.sizes.push((mass / evolved.density).sqrt());
        }
        for (source, map) in data.images() {
            this.places.push(map.place(this.places[source]));
            this.images.push(ReferenceImage::new(source, map, slips));
            particle.push(particle[source]);
        }
        let is_near = |this: &Self, i: usize, j: usize| {
            this.bodies[particle[j]] == this.bodies[i]
                && kernel.f((this.places[j] - this.places[i]).norm_squared()) > 0.0
        };
        // Counted first: a growing vector holds up to three times its content, the most memory of a body.
        let mut count = 0;
        for (i, list) in data.lists().enumerate() {
            count += list.filter(|&j| is_near(&this, i, j)).count().div_ceil(LANES);
        }
        this.fours.reserve_exact(count);
        for (i, list) in data.lists().enumerate() {
            let near: Vec<usize> = list.filter(|&j| is_near(&this, i, j)).collect();
            this.add(kernel, i, &near, &particle)?;
        }
        this.faces = this.find_faces();
        Ok(this)
    }

    /// Adds particle i with these neighbours.
    fn add<K: Kernel>(
        &mut self,
        kernel: &Smoothing<K>,
        i: usize,
        near: &[usize],
        particle: &[usize],
    ) -> Result<(), SceneError> {
        let (place, volume) = (self.places[i], self.volumes[i]);
        let mut moments = Matrix2::zeros();
        for chunk in near.chunks(LANES) {
            let [weights, x, y] = [[0.0; LANES]; 3];
            let mut four = Four { who: [i as u32; LANES], weights, arms: [x, y] };
            for (lane, &j) in chunk.iter().enumerate() {
                let x = self.places[j] - place;
                let weight = volume * self.volumes[particle[j]] * kernel.f(x.norm_squared());
                (four.who[lane], four.weights[lane]) = (j as u32, weight);
                for axis in 0..2 {
                    four.arms[axis][lane] = x[axis] * weight;
                }
                moments += x * x.transpose() * weight;
            }
            self.fours.push(four);
        }
        self.starts.push(self.fours.len() as u32);
        self.pairs += near.len() as u64;
        let Inverse { determinant, matrix } = of_two(&moments);
        let inverse = Inverse { determinant: determinant / (volume * volume), matrix };
        let determinant = inverse.determinant;
        let inverse = inverse.above(LEAST_DETERMINANT);
        self.inverse.extend(inverse);
        let quantity = "determinant of the moments of its neighbourhood";
        let allowed =
            format!("above {LEAST_DETERMINANT}: neighbours on both axes within the support");
        require(Component::Particle(i), [(inverse.is_some(), quantity, determinant, &allowed)])
    }

    /// Σ V F X² of each particle, the mean of both axes.
    fn factors(&self) -> impl Iterator<Item = f64> {
        let of = |(inverse, volume): (&Matrix2<f64>, &f64)| {
            0.5 * inverse.trace() / of_two(inverse).determinant / volume
        };
        self.inverse.iter().zip(&self.volumes).map(of)
    }

    /// G₁ = Σ V F X² of a particle inside: the maximum, because the sum is smaller at faces.
    pub fn gradient_factor(&self) -> f64 {
        self.factors().fold(0.0, f64::max)
    }

    /// The particles at faces, which lack a sixth of that or more. At a straight face about a third is
    /// missing, inside of a disordered body some per cent.
    fn find_faces(&self) -> Vec<u32> {
        let least = 5.0 / 6.0 * self.gradient_factor();
        (0..).zip(self.factors()).filter(|(_, factor)| *factor < least).map(|(k, _)| k).collect()
    }

    /// Number of particles.
    pub fn count(&self) -> usize {
        self.volumes.len()
    }

    /// Neighbours of all particles, images among them.
    pub fn pairs(&self) -> u64 {
        self.pairs
    }

    /// The neighbours of particle k.
    #[inline(always)]
    pub fn neighbours(&self, k: usize) -> &[Four] {
        &self.fours[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// Memory held \[bytes\].
    pub fn bytes(&self) -> usize {
        size_of_val(&self.places[..])
            + size_of_val(&self.volumes[..])
            + size_of_val(&self.masses[..])
            + size_of_val(&self.sizes[..])
            + size_of_val(&self.bodies[..])
            + size_of_val(&self.faces[..])
            + size_of_val(&self.inverse[..])
            + size_of_val(&self.images[..])
            + size_of_val(&self.starts[..])
            + size_of_val(&self.fours[..])
    }
}
