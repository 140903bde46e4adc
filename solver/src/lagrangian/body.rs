//! Deformations and forces: two sweeps over the pairs of the reference, one for the displacement gradients
//! and one for the forces. Each particle gathers in a fixed order, so the bits do not depend on threads.

use std::marker::PhantomData;

use crate::lane::{LANES, Lane, OnLanes, gather_vector, on_four, total};
use crate::{Potential, State, Symmetric, parallel};
use nalgebra::{Matrix2, Vector2};

use super::{
    law::{Energies, Law, Moduli, Strain},
    reference::{Four, ReferenceConfiguration},
};

/// Particles that are worth a unit of parallel work.
const BLOCK: usize = 512;

/// A body with the stored energy `L`, or several that do not touch each other.
#[derive(Clone, Debug)]
pub struct Body<L> {
    /// The reference configuration.
    pub reference: ReferenceConfiguration,
    moduli: Moduli,
    /// c \[Pa\].
    hourglass: f64,
    /// u of particles and images \[m\].
    displacements: Vec<Vector2<f64>>,
    /// B of particles and images \[Pa\].
    tensors: Vec<Matrix2<f64>>,
    parallel: bool,
    law: PhantomData<L>,
}

impl<L: Law> Body<L> {
    /// A body without displacement. `strength` is χ, see [`hourglass`].
    pub fn new(
        reference: ReferenceConfiguration,
        moduli: Moduli,
        strength: f64,
        parallel: bool,
    ) -> Self {
        let displacements = vec![Vector2::zeros(); reference.places.len()];
        let hourglass = hourglass(moduli.shear, strength, reference.gradient_factor());
        let tensors = vec![Matrix2::zeros(); displacements.len()];
        Self { reference, moduli, hourglass, displacements, tensors, parallel, law: PhantomData }
    }

    /// Gives the particles the density and the deviator of the Cauchy stress that their places imply, and
    /// writes their accelerations \[m/s²\].
    pub fn deform(&mut self, state: &mut [State<Symmetric>], accelerations: &mut [Vector2<f64>]) {
        self.displace(state);
        let count = self.reference.count();
        let (mut tensors, body) = (std::mem::take(&mut self.tensors), &*self);
        let blocks = state.chunks_mut(BLOCK).zip(tensors[..count].chunks_mut(BLOCK)).enumerate();
        parallel::for_each(blocks, self.parallel, &|(b, (evolved, tensors))| {
            on_four(Stresses { body, first: b * BLOCK, evolved, tensors });
        });
        for (k, image) in self.reference.images.iter().enumerate() {
            tensors[count + k] = image.tensor(&tensors[image.source]);
        }
        self.tensors = tensors;
        let body = &*self;
        let blocks = accelerations.chunks_mut(BLOCK).enumerate();
        parallel::for_each(blocks, self.parallel, &|(b, accelerations)| {
            on_four(Forces { body, first: b * BLOCK, accelerations });
        });
    }

    /// Sets the displacements of particles and images from the state.
    fn displace(&mut self, state: &[State<Symmetric>]) {
        let (displacements, places) = (&mut self.displacements, &self.reference.places);
        parallel::for_each_part(
            &mut displacements[..state.len()],
            self.parallel,
            &|first, part| {
                let of = places[first..].iter().zip(&state[first..]);
                for (displacement, (place, evolved)) in part.iter_mut().zip(of) {
                    *displacement = evolved.position - place;
                }
            },
        );
        for (k, image) in self.reference.images.iter().enumerate() {
            self.displacements[state.len() + k] =
                image.displaced * self.displacements[image.source];
        }
    }

    /// Positions of particles and images \[m\].
    pub fn positions(&self) -> impl Iterator<Item = Vector2<f64>> {
        self.reference.places.iter().zip(&self.displacements).map(|(place, u)| place + u)
    }

    /// The displacement gradient of a particle, by its sum over one neighbour after another.
    pub fn gradient(&self, k: usize) -> Matrix2<f64> {
        let mut sum = Matrix2::zeros();
        self.each_pair(k, |u, x, g| sum += u * x.transpose() * g);
        sum * self.reference.inverse[k]
    }

    /// The energies that the forces derive from, where the particles were displaced to last.
    pub fn potential(&self) -> Potential {
        let mut sum = Potential::default();
        for k in 0..self.reference.count() {
            let (gradient, volume) = (self.gradient(k), self.reference.volumes[k]);
            let Energies { compression, shear } = L::energy(&self.moduli, &Strain::new(gradient));
            sum.compression += volume * compression;
            sum.shear += volume * shear;
            let quarter = 0.25 * self.hourglass;
            self.each_pair(k, |u, x, g| {
                sum.hourglass += quarter * g * (u - gradient * x).norm_squared();
            });
        }
        sum
    }

    /// uₐᵦ, Xₐᵦ and g of each neighbour.
    fn each_pair(&self, k: usize, mut each: impl FnMut(Vector2<f64>, Vector2<f64>, f64)) {
        let places = &self.reference.places;
        for Four { who, weights, .. } in self.reference.neighbours(k) {
            for (&other, weight) in who.iter().zip(weights) {
                let [u, x] = [&self.displacements, places].map(|of| of[other as usize] - of[k]);
                each(u, x, *weight);
            }
        }
    }

    /// Memory held \[bytes\].
    pub fn bytes(&self) -> usize {
        let moving = size_of_val(&self.displacements[..]) + size_of_val(&self.tensors[..]);
        self.reference.bytes() + moving
    }
}

/// c = 8/3 χ μ/G₁, the modulus against modes that deform no particle \[Pa\], from μ \[Pa\], χ and G₁.
pub fn hourglass(shear: f64, strength: f64, gradient_factor: f64) -> f64 {
    8.0 / 3.0 * strength * shear / gradient_factor
}

/// uₐᵦ of four neighbours.
#[inline(always)]
fn gather<V: Lane>(displacements: &[Vector2<f64>], k: usize, who: &[u32; LANES]) -> Vector2<V> {
    let at = |lane: usize| displacements[who[lane] as usize];
    let others = [at(0), at(1), at(2), at(3)];
    gather_vector::<V>(|lane| others[lane]) - displacements[k].map(V::all)
}

/// g Xₐᵦ of four neighbours.
#[inline(always)]
fn arms<V: Lane>(four: &Four) -> Vector2<V> {
    let [x, y] = &four.arms;
    Vector2::new(V::gather(|lane| x[lane]), V::gather(|lane| y[lane]))
}

/// The first sweep over some particles: H, the stress, B.
struct Stresses<'a, L> {
    body: &'a Body<L>,
    first: usize,
    evolved: &'a mut [State<Symmetric>],
    tensors: &'a mut [Matrix2<f64>],
}

impl<L: Law> OnLanes for Stresses<'_, L> {
    #[inline(always)]
    fn run<V: Lane>(self) {
        let Self { body, first, evolved, tensors } = self;
        let Body { reference, moduli, displacements, .. } = body;
        for (k, (evolved, tensor)) in (first..).zip(evolved.iter_mut().zip(tensors)) {
            let mut sums = [V::all(0.0); 4];
            for four in reference.neighbours(k) {
                let (u, x) = (gather::<V>(displacements, k, &four.who), arms::<V>(four));
                sums[0] += u.x * x.x;
                sums[1] += u.x * x.y;
                sums[2] += u.y * x.x;
                sums[3] += u.y * x.y;
            }
            let [xx, xy, yx, yy] = [0, 1, 2, 3].map(|part| total(sums[part]));
            let inverse = &reference.inverse[k];
            let gradient = Matrix2::new(xx, xy, yx, yy) * inverse;
            let (strain, volume) = (Strain::new(gradient), reference.volumes[k]);
            let (stress, ratio) = (L::stress(moduli, &strain), 1.0 + strain.dilation);
            *tensor =
                stress.first_piola(&strain) * inverse * volume - gradient * (0.5 * body.hourglass);
            evolved.density = reference.masses[k] / (volume * ratio);
            evolved.extra = stress.deviator * (1.0 / ratio);
        }
    }
}

/// The second sweep over some particles: f/m.
struct Forces<'a, L> {
    body: &'a Body<L>,
    first: usize,
    accelerations: &'a mut [Vector2<f64>],
}

impl<L: Law> OnLanes for Forces<'_, L> {
    #[inline(always)]
    fn run<V: Lane>(self) {
        let Self { body, first, accelerations } = self;
        let Body { reference, displacements, tensors, .. } = body;
        let c = V::all(body.hourglass);
        for (k, acceleration) in (first..).zip(accelerations) {
            let own: [V; 4] = [0, 2, 1, 3].map(|part| V::all(tensors[k].as_slice()[part]));
            let mut sum = [V::all(0.0); 2];
            for four in reference.neighbours(k) {
                let (u, x) = (gather::<V>(displacements, k, &four.who), arms::<V>(four));
                let u = u * (c * V::gather(|lane| four.weights[lane]));
                let at = |lane: usize| tensors[four.who[lane] as usize].as_slice();
                let others = [at(0), at(1), at(2), at(3)];
                let [xx, yx] = V::gather_pair(|lane| [others[lane][0], others[lane][1]]);
                let [xy, yy] = V::gather_pair(|lane| [others[lane][2], others[lane][3]]);
                sum[0] += (own[0] + xx) * x.x + (own[1] + xy) * x.y + u.x;
                sum[1] += (own[2] + yx) * x.x + (own[3] + yy) * x.y + u.y;
            }
            *acceleration = Vector2::from(sum.map(total)) / reference.masses[k];
        }
    }
}
