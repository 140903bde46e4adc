//! The pair sweep, which takes most of the time of a run: each particle, in a lane of its own, sums over the
//! neighbour list of its group in the order of this list, and its rates are passed to the integrator. A
//! neighbour outside of its support adds an exact zero. Only its own data are written: there are no locks and
//! no atomics, and results are bitwise equal for any number of threads and of lanes.
//!
//! A sweep writes the rates of a few particles into a buffer, from which the integrator then updates them.
//! So the loop over pairs depends only on the kernel, the terms and the columns (derived data), and is
//! compiled once for each combination of these. Code that is compiled only once calls it through
//! [`PairSweep`].

use lanes::{Lane, OnLanes, gather_vector, on_widest};
use nalgebra::Vector2;

use crate::{
    kernel::{Kernel, Smoothing},
    neighbours::{BLOCK, Block, GROUP, Lists},
    numbers::Numbers,
    parallel,
    particles::{Column, Common, Evolved, Rate},
    terms::{Pair, Term},
};

/// Particles whose rates are buffered: few enough to stay in the nearest cache.
const BUFFER: usize = 64;

/// Where cache lines begin. Elsewhere, which depends on who calls, a sweep takes up to half as long again.
#[repr(align(64))]
struct Aligned<T>(T);

/// The square of a distance beyond every support \[m²\].
const APART: f64 = 1e200;

/// What becomes of some particles: the number of the first, the particles, and their rates.
pub(crate) type BlockUpdate<'a, X, T = Evolved<X>> =
    dyn Fn(usize, &mut [T], &[Rate<X>]) + Sync + 'a;

/// Gives the rates of particles.
pub(crate) trait PairSweep<X>: Sync {
    /// Writes the rates of particles from column `first` on, whose neighbour lists are those of a block
    /// from number `list` on.
    fn rates(&self, block: &Block, list: usize, first: usize, rates: &mut [Rate<X>]);
}

/// Updates `targets`, which begin with the particles that the lists are of.
pub(crate) fn run<X: Numbers, T: Send>(
    sweep: &dyn PairSweep<X>,
    lists: &Lists,
    targets: &mut [T],
    update: &BlockUpdate<X, T>,
) {
    let targets = targets[..lists.of.len()].chunks_mut(BLOCK);
    let blocks = targets.zip(&lists.blocks).enumerate();
    parallel::for_each(blocks, lists.parallel, &|(b, (targets, block))| {
        let mut buffer = Aligned([Rate::default(); BUFFER]);
        for (list, targets) in (0..).step_by(BUFFER).zip(targets.chunks_mut(BUFFER)) {
            let first = lists.of.start + b * BLOCK + list;
            let rates = &mut buffer.0[..targets.len()];
            sweep.rates(block, list, first, rates);
            update(first, targets, rates);
        }
    });
}

/// The rates of the particles that the lists are of.
pub(crate) fn rates<X: Numbers>(sweep: &dyn PairSweep<X>, lists: &Lists) -> Vec<Rate<X>> {
    let mut rates = vec![Rate::default(); lists.of.len()];
    fill(sweep, lists, &mut rates);
    rates
}

/// Writes the rates of the particles that the lists are of.
pub(crate) fn fill<X: Numbers>(sweep: &dyn PairSweep<X>, lists: &Lists, rates: &mut [Rate<X>]) {
    run(sweep, lists, rates, &|_, rates, found| rates.copy_from_slice(found));
}

/// Which of the derived numbers of a column terms read: from its number and these to theirs. Each closure is
/// a type of its own, which depends on no scheme.
pub trait Select<S, D>: Fn(usize, &S) -> D + Sync {}
impl<S, D, F: Fn(usize, &S) -> D + Sync> Select<S, D> for F {}

/// Those of the forces.
pub(crate) fn first<A: Copy, B>() -> impl Select<(A, B), A> {
    |_, derived| derived.0
}

/// Those of the drift.
pub(crate) fn second<A, B: Copy>() -> impl Select<(A, B), B> {
    |_, derived| derived.1
}

/// All.
pub(crate) fn whole<S: Copy>() -> impl Select<S, S> {
    |_, derived| *derived
}

/// None: zeros.
pub(crate) fn nothing<S, D: Default>() -> impl Select<S, D> {
    |_, _| D::default()
}

/// A sum of terms over the columns.
pub(crate) struct Sweep<'a, K, T, S, C> {
    pub kernel: &'a Smoothing<K>,
    pub terms: &'a T,
    pub columns: &'a [Column<S>],
    pub select: C,
    /// Whether the particles move: dx/dt = v, to which terms may add.
    pub moving: bool,
}

impl<K: Kernel, T: Term<X>, S: Numbers, C: Select<S, T::Derived>, X: Numbers> PairSweep<X>
    for Sweep<'_, K, T, S, C>
{
    fn rates(&self, block: &Block, list: usize, first: usize, rates: &mut [Rate<X>]) {
        for (rate, own) in rates.iter_mut().zip(&self.columns[first..]) {
            let position = if self.moving { own.velocity } else { Vector2::zeros() };
            *rate = Rate { position, ..Rate::default() };
        }
        if !T::IS_EMPTY {
            on_widest(Particles { sweep: self, block, list, first, rates });
        }
    }
}

/// Some particles of a block. In a profile it is `with_registers_for_eight` or `with_registers_for_four`
/// with this type (the search for neighbours is the same with its own); the portable form is inlined into
/// its caller.
struct Particles<'a, W, X> {
    sweep: &'a W,
    block: &'a Block,
    list: usize,
    first: usize,
    rates: &'a mut [Rate<X>],
}

impl<K: Kernel, T: Term<X>, S: Numbers, C: Select<S, T::Derived>, X: Numbers> OnLanes
    for Particles<'_, Sweep<'_, K, T, S, C>, X>
{
    #[inline(always)]
    fn run<V: Lane>(self) {
        const { assert!(BUFFER.is_multiple_of(GROUP) && GROUP.is_multiple_of(V::LANES)) };
        let &Sweep { kernel, terms, columns, ref select, .. } = self.sweep;
        let support2 = kernel.support() * kernel.support() * (1.0 + 1e-12);
        let (end, sentinel) = (self.first + self.rates.len(), columns.len() - 1);
        for (group, rates) in self.rates.chunks_mut(V::LANES).enumerate() {
            let start = group * V::LANES;
            let first = self.first + start;
            let number = |lane: usize| if first + lane < end { first + lane } else { sentinel };
            let own = |lane: usize| &columns[number(lane)];
            let position = gather_vector::<V>(|lane| own(lane).position);
            let velocity = gather_vector::<V>(|lane| own(lane).velocity);
            let common = Common {
                mass: V::gather(|lane| own(lane).common.mass),
                density: V::gather(|lane| own(lane).common.density),
                volume: V::gather(|lane| own(lane).common.volume),
            };
            let derived = T::Derived::gather::<V>(|lane| select(number(lane), &own(lane).derived));
            let mut sum = T::Sum::default().spread::<V>();
            for &column in self.block.list((self.list + start) / GROUP) {
                let other = &columns[column as usize];
                let r = position - other.position.spread::<V>();
                let mut r2 = r.x * r.x + r.y * r.y;
                // A particle is out of its own reach. Members stand first in a list: this is predicted.
                let member = (column as usize).wrapping_sub(first);
                if member < GROUP {
                    r2 += V::gather(|lane| if lane == member { APART } else { 0.0 });
                }
                if r2.bits_below(support2) == 0 {
                    continue;
                }
                let v = velocity - other.velocity.spread::<V>();
                let (f, others) = (kernel.f(r2), other.common.spread::<V>());
                let derived = [derived, select(column as usize, &other.derived).spread::<V>()];
                let pair = Pair { r, r2, v, f, own: common, other: others, derived, kernel };
                terms.pair(&pair, &mut sum);
            }
            // Each lane is taken out of its register by a number that the compiler knows: otherwise all
            // registers are stored again for every lane, and a sweep of colliding rings takes up to 1.5 of
            // the time.
            let mut sums = [T::Sum::default(); GROUP];
            for (lane, sum_of_lane) in sums.iter_mut().enumerate().take(V::LANES) {
                *sum_of_lane = T::Sum::lane::<V>(sum, lane);
            }
            for (lane, (rate, sum)) in rates.iter_mut().zip(sums).enumerate() {
                let own = &columns[first + lane];
                terms.finish(&own.common, select(first + lane, &own.derived), sum, rate);
                terms.place(own.position, rate);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use lanes::Portable;

    use super::*;
    use crate::{
        Continuity, Domain, Pressure, QuinticSpline, Tait, Viscosity, neighbours::Neighbours,
    };

    const DX: f64 = 0.1;

    /// Particles of a lattice that is out of order, with velocities and densities to match: all different.
    fn columns<T: Term<()>>(term: &T, side: usize) -> Vec<Column<T::Derived>> {
        let number = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let column = |k: usize| {
            let place = Vector2::new((k % side) as f64, (k / side) as f64);
            let position = (place + Vector2::new(number(3 * k), number(7 * k)) * 0.4) * DX;
            let (density, mass) = (1.0 + 0.1 * number(k), DX * DX);
            let common = Common { mass, density, volume: mass / density };
            let velocity = Vector2::new(number(2 * k), number(5 * k));
            Column { position, velocity, common, derived: term.derived(&common, &()) }
        };
        (0..side * side).map(column).chain([Column::sentinel()]).collect()
    }

    /// Lists of all columns but the last, the sentinel, as far as the quintic spline reaches.
    fn listed<S: Numbers>(columns: &[Column<S>]) -> Neighbours {
        let count = columns.len() - 1;
        let mut neighbours = Neighbours::new([3.0 * DX, 0.0, DX], Domain::open(), &[]);
        neighbours.place(&mut columns[..count].iter().map(|column| column.position));
        neighbours.build([count, 0], false, false);
        neighbours
    }

    /// Σ W in the place of the rate of the density: most terms have nothing of a particle with itself.
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

    /// Nor is a particle that a group lacks a neighbour.
    #[test]
    fn no_particle_is_a_neighbour_of_itself() {
        let columns = columns(&Weights, 23);
        let (neighbours, kernel) = (listed(&columns), Smoothing::<QuinticSpline>::new(DX));
        let (terms, columns) = (&Weights, &columns[..]);
        let sweep = Sweep { kernel: &kernel, terms, columns, select: whole(), moving: false };
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
        let (terms, columns) = (&terms, &columns[..]);
        let sweep = Sweep { kernel: &kernel, terms, columns, select: whole(), moving: true };
        let start = |column: &Column<_>| Rate { position: column.velocity, ..Rate::default() };
        let mut portable: Vec<Rate<()>> = columns[..count].iter().map(start).collect();
        let [mut one, mut widest] = [portable.clone(), portable.clone()];
        for (b, rates) in portable.chunks_mut(BLOCK).enumerate() {
            let (sweep, block, first) = (&sweep, &neighbours.lists.blocks[b], b * BLOCK);
            Particles { sweep, block, list: 0, first, rates }.run::<Portable>();
            let rates = &mut one[first..first + rates.len()];
            Particles { sweep, block, list: 0, first, rates }.run::<f64>();
        }
        for (b, rates) in widest.chunks_mut(BLOCK).enumerate() {
            let (sweep, block, first) = (&sweep, &neighbours.lists.blocks[b], b * BLOCK);
            on_widest(Particles { sweep, block, list: 0, first, rates });
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
