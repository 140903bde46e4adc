//! The pair sweep, which takes most of the time of a run. Each particle, in a lane of its own, sums over the
//! neighbour list of its group in the order of the list, and its result goes to the integrator. A neighbour
//! outside the support adds an exact zero. A thread writes only data of its own particles: there are no locks
//! and no atomics, and results are bitwise equal for any number of threads and lanes.
//!
//! A sweep writes the results of a few particles into a buffer, from which the integrator updates them. So
//! the loop over pairs depends only on the kernel, the sum and the columns, and is compiled once for each
//! combination. Code that is compiled only once calls it through [`PairSweep`].

use std::ops::Range;

use crate::lane::{Lane, OnLanes, on_widest};
use nalgebra::Vector2;

use crate::{
    kernel::{Kernel, Smoothing},
    neighbours::{BLOCK, GROUP, ListBlock, Lists},
    numbers::{Buffer, In, MANY, Numbers},
    parallel,
    particles::{Common, Rate, State, SweptParticle},
    terms::{Pair, PairSum},
};

/// Aligned to a cache line. With other alignments, which depend on the caller, a sweep takes up to 1.5 times
/// as long.
#[repr(align(64))]
struct Aligned<T>(T);

/// The square of a distance beyond every support \[m²\], number `GROUP`, between zeros.
static APART: [f64; 2 * GROUP] = {
    let mut numbers = [0.0; 2 * GROUP];
    numbers[GROUP] = 1e200;
    numbers
};

/// Updates some particles: receives the number of the first, the particles, and their rates.
pub type BlockUpdate<'a, X> = Receive<'a, State<X>, Rate<X>>;

/// Receives the number of the first of some targets, these, and their results.
type Receive<'a, T, O> = dyn Fn(usize, &mut [T], &[O]) + Sync + 'a;

/// Gives an `O` for each particle, such as its rates.
pub(crate) trait PairSweep<O>: Sync {
    /// Passes on the results of the particles in these columns, a few at a time, with the column of the
    /// first. `block` has their neighbour lists.
    fn results(&self, block: &ListBlock, of: Range<usize>, pass: &mut dyn FnMut(usize, &[O]));
}

/// Updates `targets`, which begin with the particles of these lists.
pub(crate) fn run<O, T: Send>(
    sweep: &dyn PairSweep<O>,
    lists: &Lists,
    targets: &mut [T],
    update: &Receive<T, O>,
) {
    let targets = targets[..lists.of.len()].chunks_mut(BLOCK);
    let blocks = targets.zip(&lists.blocks).enumerate();
    parallel::for_each(blocks, lists.parallel, &|(b, (targets, block))| {
        let start = lists.of.start + b * BLOCK;
        sweep.results(block, start..start + targets.len(), &mut |first, results| {
            update(first, &mut targets[first - start..][..results.len()], results);
        });
    });
}

/// Not inlined: its code is long.
#[inline(never)]
fn buffer<O: Copy + Default>() -> Aligned<[O; MANY]> {
    Aligned([O::default(); MANY])
}

/// The rates of the particles of these lists.
pub(crate) fn rates<X: Numbers>(sweep: &dyn PairSweep<Rate<X>>, lists: &Lists) -> Vec<Rate<X>> {
    let mut rates = vec![Rate::default(); lists.of.len()];
    fill(sweep, lists, &mut rates);
    rates
}

/// Writes the results of the particles of these lists.
pub(crate) fn fill<O: Copy + Send>(sweep: &dyn PairSweep<O>, lists: &Lists, results: &mut [O]) {
    run(sweep, lists, results, &|_, results, found| results.copy_from_slice(found));
}

/// A sum over the neighbours of particles, which reads columns.
pub(crate) struct Sweep<'a, K, T, S> {
    pub kernel: &'a Smoothing<K>,
    pub columns: &'a [SweptParticle<S>],
    /// A [`PairSum`].
    pub sum: T,
}

impl<K, T, S> Sweep<'_, K, T, S> {
    /// Passes on the results of these particles, of which `on_lanes` forms the sums over neighbours.
    #[inline(always)]
    fn results_by<O: Copy + Default>(
        &self,
        on_lanes: impl Fn(Particles<K, T, S, O>),
        block: &ListBlock,
        of: Range<usize>,
        pass: &mut dyn FnMut(usize, &[O]),
    ) where
        T: PairSum<S, O>,
    {
        let Self { columns, sum, .. } = self;
        let mut results = buffer();
        let mut own = Aligned(Inputs::<T::Derived>::default().spread::<Buffer>());
        let mut sums = Aligned(T::Sum::default().spread::<Buffer>());
        for first in of.clone().step_by(MANY) {
            let end = (first + MANY).min(of.end);
            if !T::IS_EMPTY {
                // The last group may lack some.
                for k in 0..(end - first).next_multiple_of(GROUP) {
                    let number = if first + k < end { first + k } else { columns.len() - 1 };
                    let &SweptParticle { position, velocity, common, ref derived } =
                        &columns[number];
                    let numbers = (common.mass, common.density, common.volume);
                    (position, velocity, numbers, sum.read(number, derived)).put(&mut own.0, k);
                }
                let (list, own, sums) = (first - of.start, &own.0, &mut sums.0);
                on_lanes(Particles { sweep: self, block, list, of: first..end, own, sums });
            }
            for (k, (result, number)) in results.0.iter_mut().zip(first..end).enumerate() {
                *result = sum.result(&columns[number], T::Sum::take(&sums.0, k));
            }
            pass(first, &results.0[..end - first]);
        }
    }
}

impl<O: Copy + Default, K: Kernel, T: PairSum<S, O>, S: Numbers> PairSweep<O>
    for Sweep<'_, K, T, S>
{
    fn results(&self, block: &ListBlock, of: Range<usize>, pass: &mut dyn FnMut(usize, &[O])) {
        self.results_by(|particles| on_widest(particles), block, of, pass);
    }
}

/// The numbers of a particle that a term reads: position and velocity; mass, density and volume; its derived
/// data `D`.
type Inputs<D> = (Vector2<f64>, Vector2<f64>, (f64, f64, f64), D);

/// The sums of some particles of a block. In a profile this is `with_registers_for_eight` or
/// `with_registers_for_four` with this type (the search for neighbours has its own type); the portable form
/// is inlined into its caller.
struct Particles<'a, K, T: PairSum<S, O>, S, O> {
    sweep: &'a Sweep<'a, K, T, S>,
    block: &'a ListBlock,
    list: usize,
    of: Range<usize>,
    own: &'a In<Inputs<T::Derived>, Buffer>,
    sums: &'a mut In<T::Sum, Buffer>,
}

impl<K: Kernel, T: PairSum<S, O>, S: Numbers, O> OnLanes for Particles<'_, K, T, S, O> {
    #[inline(always)]
    fn run<V: Lane>(self) {
        const { assert!(MANY.is_multiple_of(GROUP) && GROUP.is_multiple_of(V::LANES)) };
        let Sweep { kernel, columns, sum: of } = self.sweep;
        let support2 = kernel.support() * kernel.support() * (1.0 + 1e-12);
        for start in (0..self.of.len()).step_by(V::LANES) {
            let (position, velocity, (mass, density, volume), derived) =
                Inputs::<T::Derived>::load::<V>(self.own, start);
            let common = Common { mass, density, volume };
            let mut sum = T::Sum::default().spread::<V>();
            for &column in self.block.list((self.list + start) / GROUP) {
                let other = &columns[column as usize];
                let r = position - other.position.spread::<V>();
                let mut r2 = r.x * r.x + r.y * r.y;
                // Moves a particle out of its own support. Members are first in a list: the branch is
                // predicted.
                let member = (column as usize).wrapping_sub(self.of.start + start);
                if member < GROUP {
                    r2 += V::load(&APART[GROUP - member..]);
                }
                if r2.bits_below(support2) == 0 {
                    continue;
                }
                let v = velocity - other.velocity.spread::<V>();
                let (f, others) = (kernel.f(r2), other.common.spread::<V>());
                let derived = [derived, of.read(column as usize, &other.derived).spread::<V>()];
                let pair = Pair { r, r2, v, f, own: common, other: others, derived, kernel };
                of.add(&pair, &mut sum);
            }
            T::Sum::store(sum, self.sums, start);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::lane::Portable;

    use super::*;
    use crate::{
        Continuity, Domain, Pressure, QuinticSpline, Tait, Term, Viscosity,
        neighbours::{Neighbours, Reach},
        terms::Rates,
    };

    const DX: f64 = 0.1;

    /// Particles off a lattice, all with different velocities and densities.
    fn columns<T: Term<()>>(term: &T, side: usize) -> Vec<SweptParticle<T::Derived>> {
        let number = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let column = |k: usize| {
            let place = Vector2::new((k % side) as f64, (k / side) as f64);
            let position = (place + Vector2::new(number(3 * k), number(7 * k)) * 0.4) * DX;
            let (density, mass) = (1.0 + 0.1 * number(k), DX * DX);
            let common = Common { mass, density, volume: mass / density };
            let velocity = Vector2::new(number(2 * k), number(5 * k));
            SweptParticle { position, velocity, common, derived: term.derived(&common, &()) }
        };
        (0..side * side).map(column).chain([SweptParticle::sentinel()]).collect()
    }

    /// Lists of all columns but the last, the sentinel, as far as the quintic spline reaches.
    fn listed<S: Numbers>(columns: &[SweptParticle<S>]) -> Neighbours {
        let count = columns.len() - 1;
        let mut neighbours = Neighbours::new(
            Reach { support: 3.0 * DX, skin: 0.0, spacing: DX },
            Domain::open(),
            &[],
        );
        neighbours.place(count, &|k| columns[k].position);
        neighbours.build(count, 0, false);
        neighbours
    }

    /// Σ W in place of dρ/dt: most terms are 0 for a particle with itself.
    #[derive(Clone)]
    struct Weights;

    impl Term<()> for Weights {
        type Derived = ();
        type Sum = f64;
        fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut V) {
            *sum += pair.w();
        }
        fn finish(&self, _: &Common, _: (), sum: f64, rate: &mut Rate<()>) {
            rate.density = sum;
        }
    }

    /// Empty lanes of a group are not neighbours either.
    #[test]
    fn no_particle_is_a_neighbour_of_itself() {
        let columns = columns(&Weights, 23);
        let (neighbours, kernel) = (listed(&columns), Smoothing::<QuinticSpline>::new(DX));
        let columns = &columns[..];
        let sum = Rates { terms: &Weights, read: |(): &()| (), moving: false };
        let sweep = Sweep { kernel: &kernel, columns, sum };
        let particles = &columns[..columns.len() - 1];
        assert_ne!(particles.len() % GROUP, 0, "the last group lacks some");
        for (k, rate) in rates(&sweep, &neighbours.lists).iter().enumerate() {
            let r2 = |j: usize| (particles[j].position - particles[k].position).norm_squared();
            let others = (0..particles.len()).filter(|&j| j != k);
            let sum: f64 = others.map(|j| kernel.w(r2(j))).sum();
            assert!((rate.density / sum - 1.0).abs() < 1e-13, "{k}: {} of {sum}", rate.density);
        }
    }

    /// On one lane, on four, and on the widest registers that the processor has.
    #[test]
    fn rates_have_the_same_bits_on_any_number_of_lanes() {
        type Terms = (Pressure<Tait>, Viscosity, Continuity);
        let viscosity = Viscosity { mu: 0.1, eta2: 1e-6 };
        let terms: Terms = (Pressure::new(Tait::new(1.0, 10.0)), viscosity, Continuity);
        let columns = columns(&terms, 30);
        let count = columns.len() - 1;
        let neighbours = listed(&columns);
        let kernel = Smoothing::<QuinticSpline>::new(DX);
        let sum = Rates { terms: &terms, read: Clone::clone, moving: true };
        let sweep = Sweep { kernel: &kernel, columns: &columns, sum };
        let [mut portable, mut one, mut widest] = [const { Vec::<Rate<()>>::new() }; 3];
        for (b, block) in neighbours.lists.blocks.iter().enumerate() {
            let of = b * BLOCK..((b + 1) * BLOCK).min(count);
            let of = || of.clone();
            sweep.results_by(|p| p.run::<Portable>(), block, of(), &mut |_, r| portable.extend(r));
            sweep.results_by(|p| p.run::<f64>(), block, of(), &mut |_, r| one.extend(r));
            sweep.results(block, of(), &mut |_, r| widest.extend(r));
        }
        assert!(neighbours.lists.blocks.len() > 1);
        let bits =
            |r: &Rate<()>| [r.velocity.x, r.velocity.y, r.density, r.position.x].map(f64::to_bits);
        for (k, b) in portable.iter().enumerate() {
            assert_eq!([bits(&one[k]), bits(&widest[k])], [bits(b); 2], "particle {k}");
        }
        assert!(widest.iter().all(|rate| rate.velocity.norm() > 0.0 && rate.density != 0.0));
    }
}
