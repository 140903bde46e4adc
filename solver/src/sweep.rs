//! The row loop, the only hot code: each row sums its neighbours in a fixed order and hands the
//! rates of its particle to the integrator. Gather only: no locks, no atomics, and the same bits
//! for any number of threads.

use nalgebra::Vector2;
use simba::simd::WideF64x4;

use crate::{
    kernel::{Kernel, Smoothing},
    lane::{Lane, OnLanes, gather_vector, on_widest},
    neighbours::{BLOCK, Block, LANES},
    numbers::Numbers,
    parallel,
    particles::{Column, Common, Evolved, Rate},
    terms::{Pair, Term},
};

/// What becomes of a row: the index of its particle, the particle, and its rates.
pub trait Update<X>: Fn(usize, &mut Evolved<X>, &Rate<X>) + Sync {}
impl<X, F: Fn(usize, &mut Evolved<X>, &Rate<X>) + Sync> Update<X> for F {}

/// What a sweep reads: the columns, the terms, and where in a column the terms' numbers are.
pub(crate) struct Sweep<'a, K, T, S, P> {
    pub kernel: &'a Smoothing<K>,
    pub terms: &'a T,
    pub columns: &'a [Column<S>],
    /// From what a column shows to what these terms read.
    pub project: P,
    /// Whether the particles move: dx/dt = v, to which terms may add.
    pub moving: bool,
}

impl<K: Kernel, T, S: Numbers, P> Sweep<'_, K, T, S, P> {
    /// Updates `targets`, the particles from column `first` on, row by row.
    pub fn run<X: Numbers>(
        &self,
        blocks: &[Block],
        first: usize,
        targets: &mut [Evolved<X>],
        parallel: bool,
        update: impl Update<X>,
    ) where
        T: Term<X>,
        P: Fn(&S) -> T::Shows + Sync,
    {
        parallel::for_each_block(targets, parallel, &|b, targets| {
            let (block, first, update) = (&blocks[b], first + b * BLOCK, &update);
            on_widest(Rows { sweep: self, block, first, targets, update });
        });
    }

    /// The rates of the particles from column `first` on, one after another.
    pub fn rates<X: Numbers>(&self, blocks: &[Block], first: usize, count: usize) -> Vec<Rate<X>>
    where
        T: Term<X>,
        P: Fn(&S) -> T::Shows,
    {
        let row = |k: usize| {
            self.row::<WideF64x4, X>(&self.columns[first + k], blocks[k / BLOCK].row(k % BLOCK))
        };
        (0..count).map(row).collect()
    }

    /// The rates of one particle.
    #[inline(always)]
    fn row<V: Lane, X: Numbers>(&self, own: &Column<S>, neighbours: &[[u32; LANES]]) -> Rate<X>
    where
        T: Term<X>,
        P: Fn(&S) -> T::Shows,
    {
        let position = own.position.spread::<V>();
        let velocity = own.velocity.spread::<V>();
        let common = own.common.spread::<V>();
        let shown = (self.project)(&own.shows);
        let own_shows = shown.spread::<V>();
        let mut sum = T::Sum::default().spread::<V>();
        for chunk in neighbours {
            let others = chunk.map(|c| &self.columns[c as usize]);
            let [mass, density] =
                V::gather_pair(|k| [others[k].common.mass, others[k].common.density]);
            let other = Common { mass, density, volume: V::gather(|k| others[k].common.volume) };
            let r = position - gather_vector::<V>(|k| others[k].position);
            let v = velocity - gather_vector::<V>(|k| others[k].velocity);
            let shows = T::Shows::gather::<V>(|k| (self.project)(&others[k].shows));
            let r2 = r.x * r.x + r.y * r.y;
            let f = self.kernel.f(r2);
            let pair = Pair { r, r2, v, f, own: common, other, kernel: self.kernel };
            self.terms.pair(&pair, own_shows, shows, &mut sum);
        }
        let position = if self.moving { own.velocity } else { Vector2::zeros() };
        let mut rate = Rate { position, ..Rate::default() };
        self.terms.finish(&own.common, shown, T::Sum::total::<V>(sum), &mut rate);
        rate
    }
}

/// One block of rows. In a profile it is `with_registers_for_four`; the portable form is inlined into its
/// caller.
struct Rows<'a, W, X, U> {
    sweep: &'a W,
    block: &'a Block,
    first: usize,
    targets: &'a mut [Evolved<X>],
    update: &'a U,
}

impl<K: Kernel, T, S: Numbers, P, X: Numbers, U: Update<X>> OnLanes
    for Rows<'_, Sweep<'_, K, T, S, P>, X, U>
where
    T: Term<X>,
    P: Fn(&S) -> T::Shows,
{
    #[inline(always)]
    fn run<V: Lane>(self) {
        let Self { sweep, block, first, targets, update } = self;
        for (k, target) in targets.iter_mut().enumerate() {
            let rate = sweep.row::<V, X>(&sweep.columns[first + k], block.row(k));
            update(first + k, target, &rate);
        }
    }
}
