//! Loads of a solid in its present configuration: weight, and contact between bodies. Each
//! derives from an energy.

use crate::{Smoothing, State, Symmetric, WendlandC2, parallel};
use nalgebra::Vector2;

use super::{law::Moduli, reference::ReferenceConfiguration};

/// Particles as input of loads.
#[derive(Clone, Copy, Debug)]
pub struct Loaded<'a> {
    /// Present state.
    pub state: &'a [State<Symmetric>],
    /// Reference configuration.
    pub reference: &'a ReferenceConfiguration,
    /// Whether the work is distributed over threads.
    pub parallel: bool,
}

impl Loaded<'_> {
    /// The vector from particle j, or its nearest periodic copy, to i.
    fn between(&self, i: usize, j: usize, place: impl Fn(usize) -> Vector2<f64>) -> Vector2<f64> {
        let mut r = place(i) - place(j);
        for axis in 0..2 {
            if let Some(period) = self.reference.domain.period[axis] {
                r[axis] -= period * (r[axis] / period).round();
            }
        }
        r
    }

    /// Whether two particles are of different bodies, or farther apart than this in the reference \[m\].
    fn are_apart(&self, i: usize, j: usize, distance: f64) -> bool {
        let ReferenceConfiguration { bodies, places, .. } = self.reference;
        bodies[i] != bodies[j]
            || self.between(i, j, |k| places[k]).norm_squared() >= distance * distance
    }
}

/// A load, `()` if there is none.
pub trait Load: Clone + Send + Sync + 'static {
    /// Adds the accelerations \[m/s²\] that follow; the number of neighbours in all its pair sweeps.
    fn push(&self, on: &Loaded, accelerations: &mut [Vector2<f64>]) -> u64;
    /// The energy that the forces derive from \[J/m\].
    fn energy(&self, on: &Loaded) -> f64;
}

impl Load for () {
    fn push(&self, _: &Loaded, _: &mut [Vector2<f64>]) -> u64 {
        0
    }
    fn energy(&self, _: &Loaded) -> f64 {
        0.0
    }
}

/// A uniform acceleration \[m/s²\].
#[derive(Clone, Copy, Debug)]
pub struct Weight(pub Vector2<f64>);

impl Load for Weight {
    fn push(&self, on: &Loaded, accelerations: &mut [Vector2<f64>]) -> u64 {
        parallel::for_each_part(accelerations, on.parallel, &|_, part| {
            part.iter_mut().for_each(|a| *a += self.0);
        });
        0
    }
    fn energy(&self, on: &Loaded) -> f64 {
        let of = |(evolved, mass): (&State<Symmetric>, &f64)| -mass * self.0.dot(&evolved.position);
        on.state.iter().zip(&on.reference.masses).map(of).fold(0.0, |sum, one| sum + one)
    }
}

/// The stiffness of contact, k = (K + 4μ/3)/4 \[Pa\]: two faces with a small overlap o repel each other with
/// the force k o for each length s of a face.
///
/// Two bodies that meet send fronts that rise at the rate 2 k/(ρ c_p dx), and a lattice carries waves of up
/// to half its largest frequency, about c_p/dx, with little dispersion. A harder contact leaves energy in
/// waves that are hardly longer than two spacings, a softer one lets bodies overlap more.
pub fn contact_stiffness(moduli: &Moduli) -> f64 {
    0.25 * moduli.longitudinal()
}

/// Contact between the faces of bodies, also of a body with itself: without friction and attraction.
///
/// The density of other faces at a face particle a is ψ_a = Σ_b (s_b/s) W(|x_a − x_b|/s), with sizes s_a and
/// s_b, their mean s, and the kernel W with support 2 s. At the distance d from a straight row of particles
/// its mean is Ψ(d). Along the row it varies little: the pressure of faces that overlap by 5, 20 and 40 % of
/// s varies by 0.7, 2 and 4 %, so particles do not catch on each other. Where ψ exceeds Ψ(s), faces overlap
/// by about o = e Ψ/|Ψ'| with e = ψ/Ψ(s) − 1, and the energy
///
/// U = ½ k Σ_a s_a² (Ψ/Ψ')² (e_a²/2 + e_a³/6)
///
/// is stored, half in each of two faces: k o²/2 at first, and steeper later, so that faces do not pass
/// through each other. The forces are central, so momenta are conserved. Particles of one body that are
/// nearer than twice the reach in the reference have no contact: the stress acts between them.
#[derive(Clone, Copy, Debug)]
pub struct BetweenFaces {
    /// k \[Pa\].
    stiffness: f64,
    kernel: Smoothing<WendlandC2>,
    /// A row at the distance of one size.
    row: StraightRow,
}

/// A straight row of particles, in units of their size.
#[derive(Clone, Copy, Debug)]
struct StraightRow {
    /// Ψ(d).
    density: f64,
    /// −Ψ'(d).
    slope: f64,
}

/// Reach of contact over the size of the particles.
const REACH: f64 = 2.0;

/// Two particles in contact reach.
struct Contact {
    particles: [usize; 2],
    /// From the second to the first \[m\].
    apart: Vector2<f64>,
    /// The mean of their sizes \[m\].
    size: f64,
}

impl StraightRow {
    /// The row at the distance d.
    fn at(d: f64, kernel: &Smoothing<WendlandC2>) -> Self {
        // The mean over positions along the row, by a sum that is exact to 1e-6: the kernel has two
        // derivatives.
        let mut row = Self { density: 0.0, slope: 0.0 };
        for x in (-200..200).map(|k| (f64::from(k) + 0.5) * 0.01) {
            let r2 = d * d + x * x;
            row.density += 0.01 * kernel.w(r2);
            row.slope += 0.01 * d * kernel.f(r2);
        }
        row
    }
}

impl BetweenFaces {
    /// Contact of this stiffness \[Pa\], see [`contact_stiffness`].
    pub fn new(stiffness: f64) -> Self {
        let kernel = Smoothing::<WendlandC2>::new(1.0);
        Self { stiffness, kernel, row: StraightRow::at(1.0, &kernel) }
    }

    /// The pressure of two straight faces whose outermost particles are this many sizes apart \[Pa\]:
    /// −dU/dd over the size.
    pub fn pressure(&self, distance: f64) -> f64 {
        let StraightRow { density, slope } = StraightRow::at(distance, &self.kernel);
        let e = (density / self.row.density - 1.0).max(0.0);
        2.0 * self.scale(1.0) * (e + 0.5 * e * e) * slope / self.row.density
    }

    /// The longest stable step while bodies press against each other with this pressure \[Pa\] \[s\], from
    /// the limit of the compressed lattice; an estimate, which a test confirms within 3 %. The largest
    /// eigenvalue of a sum is at most the sum of the largest ones, ω² = ω_l² + λ/(ρ s²). For the second
    /// derivatives of U at two straight rows it is at most
    ///
    /// λ = ½ k (Ψ/Ψ')² ((1 + e)(|Σ ∇W| + Σ |∇W|)² + 4 (e + e²/2) Σ |∇∇W|)/Ψ²
    ///
    /// by the norms of their rows (Gershgorin), with sums over the particles in reach of one particle.
    pub fn step_limit(&self, of_lattice: f64, density: f64, size: f64, pressure: f64) -> f64 {
        // Nearer than 0.4 sizes the pressure hardly rises any more.
        let halve = |[near, far]: [f64; 2], _| {
            let middle = 0.5 * (near + far);
            if self.pressure(middle) > pressure { [middle, far] } else { [near, middle] }
        };
        let [near, far] = (0..40).fold([0.4, 1.0], halve);
        let d = 0.5 * (near + far);
        let e = (StraightRow::at(d, &self.kernel).density / self.row.density - 1.0).max(0.0);
        let of = |aside: f64| {
            let seen = (-3..=3).map(|k| Vector2::new(f64::from(k) + aside, d));
            let [mut sum, mut sizes, mut curved] = [0.0; 3];
            for r in seen {
                let (r2, by) = (r.norm_squared(), 1e-4);
                let steep = |r2: f64| r2.sqrt() * self.kernel.f(r2);
                let [more, less] = [1.0 + by, 1.0 - by].map(|factor| steep(r2 * factor * factor));
                let second = (more - less) / (2.0 * by * r2.sqrt());
                sum += self.kernel.f(r2) * d;
                sizes += steep(r2);
                curved += self.kernel.f(r2).max(second.abs());
            }
            let norm = (1.0 + e) * (sum + sizes) * (sum + sizes);
            norm + 4.0 * (e + 0.5 * e * e) * curved * self.row.density
        };
        let stiffness =
            self.scale(1.0) / (self.row.density * self.row.density) * of(0.0).max(of(0.5));
        2.0 / (4.0 / (of_lattice * of_lattice) + stiffness / (density * size * size)).sqrt()
    }

    /// All pairs in contact reach, in an order that depends on the state alone.
    fn contacts(&self, on: &Loaded) -> Vec<Contact> {
        let ReferenceConfiguration { domain, sizes, faces, .. } = on.reference;
        let axis = usize::from(domain.period[0].is_some());
        let reach = REACH * sizes.iter().fold(0.0_f64, |a, b| a.max(*b));
        // Where the other axis is periodic, a copy may be near even if the particle is not.
        let aside = if domain.period[1 - axis].is_some() { f64::INFINITY } else { reach };
        let place = |i: &u32| (on.state[*i as usize].position, *i as usize);
        let mut sorted: Vec<(Vector2<f64>, usize)> = faces.iter().map(place).collect();
        sorted.sort_unstable_by(|a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
        let mut contacts = Vec::new();
        for (k, &(x, i)) in sorted.iter().enumerate() {
            let near =
                sorted[k + 1..].iter().take_while(|(other, _)| other[axis] - x[axis] < reach);
            for &(other, j) in near {
                if (other[1 - axis] - x[1 - axis]).abs() >= aside {
                    continue;
                }
                let apart = on.between(i, j, |k| on.state[k].position);
                let size = 0.5 * (sizes[i] + sizes[j]);
                let most = REACH * size;
                if apart.norm_squared() < most * most && on.are_apart(i, j, 2.0 * most) {
                    contacts.push(Contact { particles: [i, j], apart, size });
                }
            }
        }
        contacts
    }

    /// e of every particle.
    fn excess(&self, sizes: &[f64], contacts: &[Contact]) -> Vec<f64> {
        let mut excess = vec![-1.0; sizes.len()];
        for Contact { particles: [i, j], apart, size } in contacts {
            let weight =
                self.kernel.w(apart.norm_squared() / (size * size)) / (self.row.density * size);
            excess[*i] += sizes[*j] * weight;
            excess[*j] += sizes[*i] * weight;
        }
        excess
    }

    /// ½ k s² (Ψ/Ψ')² \[J/m\].
    fn scale(&self, size: f64) -> f64 {
        let gap = size * self.row.density / self.row.slope;
        0.5 * self.stiffness * gap * gap
    }
}

impl Load for BetweenFaces {
    fn push(&self, on: &Loaded, accelerations: &mut [Vector2<f64>]) -> u64 {
        let ReferenceConfiguration { sizes, masses, .. } = on.reference;
        let contacts = self.contacts(on);
        // Each of two is a neighbour of the other, in the sweep over ψ and in that over the forces.
        let neighbours = 4 * contacts.len() as u64;
        let excess = self.excess(sizes, &contacts);
        let slope = |k: usize| {
            let e = excess[k].max(0.0);
            self.scale(sizes[k]) * (e + 0.5 * e * e)
        };
        for Contact { particles: [i, j], apart, size } in contacts {
            let both = slope(i) * sizes[j] + slope(j) * sizes[i];
            if both > 0.0 {
                let steep = self.kernel.f(apart.norm_squared() / (size * size)) / self.row.density;
                let force = apart * (both * steep / (size * size * size));
                accelerations[i] += force / masses[i];
                accelerations[j] -= force / masses[j];
            }
        }
        neighbours
    }
    fn energy(&self, on: &Loaded) -> f64 {
        let sizes = &on.reference.sizes;
        let excess = self.excess(sizes, &self.contacts(on));
        let of = |(e, size): (&f64, &f64)| {
            let e = e.max(0.0);
            self.scale(*size) * e * e * (0.5 + e / 6.0)
        };
        excess.iter().zip(sizes).map(of).fold(0.0, |sum, one| sum + one)
    }
}
