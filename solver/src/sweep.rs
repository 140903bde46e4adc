//! The row loop, the only hot code: each row sums its neighbours in a fixed order and hands the
//! rates of its particle to the integrator. Gather only: no locks, no atomics, and the same bits
//! for any number of threads.

use nalgebra::Vector2;
use simba::simd::WideF64x4 as Wide;

use crate::{
    kernel::{Kernel, Smoothing},
    lane::{Lane, gather_vector},
    neighbours::{BLOCK, Block, LANES},
    numbers::Numbers,
    parallel,
    particles::{Column, Common, Evolved, Rate},
    terms::{Pair, Term},
};

#[cfg(target_arch = "x86_64")]
use crate::ymm::Ymm;

/// A block of rows in lanes of one type.
macro_rules! block {
    ($(#[$attribute:meta])+ $block:ident, $V:ty) => {
        $(#[$attribute])+
        #[inline(never)]
        fn $block<X: Numbers>(
            &self,
            block: &Block,
            first: usize,
            targets: &mut [Evolved<X>],
            update: &impl Update<X>,
        ) where
            T: Term<X>,
            P: Fn(&S) -> T::Shows,
        {
            for (k, target) in targets.iter_mut().enumerate() {
                let rate = self.row::<$V, X>(&self.columns[first + k], block.row(k));
                update(first + k, target, &rate);
            }
        }
    };
}

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
            let (block, first) = (&blocks[b], first + b * BLOCK);
            #[cfg(target_arch = "x86_64")]
            if Ymm::is_there() {
                // SAFETY: the processor has AVX2.
                #[allow(unsafe_code)]
                return unsafe { self.block_of_fours(block, first, targets, &update) };
            }
            self.block(block, first, targets, &update);
        });
    }

    block! {
        /// One block of rows. Not inlined: its share of a profile is the share of the row loop.
        block, Wide
    }
    #[cfg(target_arch = "x86_64")]
    block! {
        /// The same, compiled for processors with registers for four numbers.
        #[target_feature(enable = "avx2")]
        block_of_fours, Ymm
    }

    /// The rates of the particles from column `first` on, one after another.
    pub fn rates<X: Numbers>(&self, blocks: &[Block], first: usize, count: usize) -> Vec<Rate<X>>
    where
        T: Term<X>,
        P: Fn(&S) -> T::Shows,
    {
        let row = |k: usize| {
            self.row::<Wide, X>(&self.columns[first + k], blocks[k / BLOCK].row(k % BLOCK))
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
            let other = Common {
                mass: V::gather(|k| others[k].common.mass),
                density: V::gather(|k| others[k].common.density),
                volume: V::gather(|k| others[k].common.volume),
            };
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
