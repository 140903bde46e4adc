//! Deformations and forces: two sweeps over the pairs of the reference, one for the displacement gradients
//! and one for the forces. Each particle gathers in a fixed order, so the bits do not depend on threads.

use std::marker::PhantomData;

use lanes::{LANES, Lane, OnLanes, gather_vector, on_four, total};
use nalgebra::{Matrix2, Vector2};
use solver::{Evolved, Potential, Symmetric, parallel};

use crate::{
    law::{Law, Moduli, Strain},
    reference::Reference,
};

/// Particles that are worth a unit of parallel work.
const BLOCK: usize = 512;

/// What pairs read of a particle or an image: u and X \[m\].
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct Column {
    displacement: Vector2<f64>,
    place: Vector2<f64>,
}

/// A body with the stored energy `L`, or several that do not touch each other.
#[derive(Clone, Debug)]
pub struct Body<L> {
    /// Its reference.
    pub reference: Reference,
    moduli: Moduli,
    /// c \[Pa\].
    hourglass: f64,
    columns: Vec<Column>,
    /// B of particles and images \[Pa\].
    tensors: Vec<Matrix2<f64>>,
    parallel: bool,
    law: PhantomData<L>,
}

impl<L: Law> Body<L> {
    /// Of this reference. `strength` is χ, see [`hourglass`].
    pub fn new(reference: Reference, moduli: Moduli, strength: f64, parallel: bool) -> Self {
        let at_rest =
            |place: &Vector2<f64>| Column { displacement: Vector2::zeros(), place: *place };
        let columns: Vec<Column> = reference.places.iter().map(at_rest).collect();
        let hourglass = hourglass(moduli.shear, strength, reference.gradient_factor());
        let tensors = vec![Matrix2::zeros(); columns.len()];
        Self { reference, moduli, hourglass, columns, tensors, parallel, law: PhantomData }
    }

    /// Gives the particles the density and the deviator of the Cauchy stress that their places imply, and
    /// writes their accelerations \[m/s²\].
    pub fn deform(&mut self, state: &mut [Evolved<Symmetric>], accelerations: &mut [Vector2<f64>]) {
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

    /// Takes over where particles are, and images with them.
    fn displace(&mut self, state: &[Evolved<Symmetric>]) {
        for (column, evolved) in self.columns.iter_mut().zip(state) {
            column.displacement = evolved.position - column.place;
        }
        for (k, image) in self.reference.images.iter().enumerate() {
            let displacement = image.displaced * self.columns[image.source].displacement;
            self.columns[state.len() + k].displacement = displacement;
        }
    }

    /// Where particles and images are \[m\].
    pub fn positions(&self) -> impl Iterator<Item = Vector2<f64>> {
        self.columns.iter().map(|column| column.place + column.displacement)
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
            let [compression, shear] = L::energy(&self.moduli, &Strain::new(gradient));
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
        let own = self.columns[k];
        for (chunk, weights) in self.reference.pairs(k) {
            for lane in 0..LANES {
                let other = self.columns[chunk[lane] as usize];
                each(other.displacement - own.displacement, other.place - own.place, weights[lane]);
            }
        }
    }

    /// Memory held \[bytes\].
    pub fn bytes(&self) -> usize {
        let columns = size_of_val(&self.columns[..]) + size_of_val(&self.tensors[..]);
        self.reference.bytes() + columns
    }
}

/// c = 8/3 χ μ/G₁, the modulus against modes that deform no particle \[Pa\], from μ \[Pa\], χ and G₁.
pub fn hourglass(shear: f64, strength: f64, gradient_factor: f64) -> f64 {
    8.0 / 3.0 * strength * shear / gradient_factor
}

/// uₐᵦ and Xₐᵦ of four neighbours.
#[inline(always)]
fn gather<V: Lane>(columns: &[Column], own: &Column, chunk: &[u32; LANES]) -> [Vector2<V>; 2] {
    let at = |lane: usize| &columns[chunk[lane] as usize];
    let others = [at(0), at(1), at(2), at(3)];
    let u = gather_vector::<V>(|lane| others[lane].displacement);
    let x = gather_vector::<V>(|lane| others[lane].place);
    let [own_u, own_x] = [own.displacement, own.place].map(|own| own.map(V::all));
    [u - own_u, x - own_x]
}

/// The first sweep over some particles: H, the stress, B.
struct Stresses<'a, L> {
    body: &'a Body<L>,
    first: usize,
    evolved: &'a mut [Evolved<Symmetric>],
    tensors: &'a mut [Matrix2<f64>],
}

impl<L: Law> OnLanes for Stresses<'_, L> {
    #[inline(always)]
    fn run<V: Lane>(self) {
        let Self { body, first, evolved, tensors } = self;
        let Body { reference, moduli, columns, .. } = body;
        for (k, (evolved, tensor)) in (first..).zip(evolved.iter_mut().zip(tensors)) {
            let mut sums = [V::all(0.0); 4];
            for (chunk, weights) in reference.pairs(k) {
                let [u, x] = gather::<V>(columns, &columns[k], chunk);
                let x = x * V::gather(|lane| weights[lane]);
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
        let Body { reference, columns, tensors, .. } = body;
        let c = V::all(body.hourglass);
        for (k, acceleration) in (first..).zip(accelerations) {
            let own: [V; 4] = [0, 2, 1, 3].map(|part| V::all(tensors[k].as_slice()[part]));
            let mut sum = [V::all(0.0); 2];
            for (chunk, weights) in reference.pairs(k) {
                let [u, x] = gather::<V>(columns, &columns[k], chunk);
                let x = x * V::gather(|lane| weights[lane]);
                let u = u * (c * V::gather(|lane| weights[lane]));
                let at = |lane: usize| tensors[chunk[lane] as usize].as_slice();
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
