//! The row loop, the only hot code: each row sums its neighbours in a fixed order and hands the
//! rates of its particle to the integrator. Gather only: no locks, no atomics, and the same bits
//! for any number of threads.

use std::marker::PhantomData;

use nalgebra::Vector2;

use crate::{
    kernel::{Kernel, Smoothing},
    lane::{LANES, Lane, OnLanes, gather_vector, on_widest},
    neighbours::{BLOCK, Block},
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
            let (first, count) = (first + b * BLOCK, targets.len());
            let take = |k: usize, rate| update(first + k, &mut targets[k], &rate);
            on_widest(Rows::new(self, &blocks[b], [first, count], take));
        });
    }

    /// The rates of the particles from column `first` on, one after another.
    pub fn rates<X: Numbers>(&self, blocks: &[Block], first: usize, count: usize) -> Vec<Rate<X>>
    where
        T: Term<X>,
        P: Fn(&S) -> T::Shows,
    {
        let mut rates = Vec::with_capacity(count);
        for (block, start) in blocks.iter().zip((0..count).step_by(BLOCK)) {
            let count = BLOCK.min(count - start);
            on_widest(Rows::new(self, block, [first + start, count], |_, rate| rates.push(rate)));
        }
        rates
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
            // Not `map`: its code is not inlined, see the profiles in `Cargo.toml`.
            let at = |k: usize| &self.columns[chunk[k] as usize];
            let others = [at(0), at(1), at(2), at(3)];
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

/// One block of rows. In a profile it is `with_many_registers` or `with_registers_for_four` with this type
/// (the search for rows is the same with its own); the portable form is inlined into its caller.
struct Rows<'a, W, X, F> {
    sweep: &'a W,
    block: &'a Block,
    /// Column of the first row, number of rows.
    rows: [usize; 2],
    /// Takes the rates of the k-th row.
    take: F,
    extra: PhantomData<X>,
}

impl<'a, W, X, F: FnMut(usize, Rate<X>)> Rows<'a, W, X, F> {
    fn new(sweep: &'a W, block: &'a Block, rows: [usize; 2], take: F) -> Self {
        Self { sweep, block, rows, take, extra: PhantomData }
    }
}

impl<K: Kernel, T, S: Numbers, P, X: Numbers, F: FnMut(usize, Rate<X>)> OnLanes
    for Rows<'_, Sweep<'_, K, T, S, P>, X, F>
where
    T: Term<X>,
    P: Fn(&S) -> T::Shows,
{
    #[inline(always)]
    fn run<V: Lane>(mut self) {
        let [first, count] = self.rows;
        for k in 0..count {
            let own = &self.sweep.columns[first + k];
            (self.take)(k, self.sweep.row::<V, X>(own, self.block.row(k)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Continuity, Domain, Pressure, QuinticSpline, Tait, Viscosity, neighbours::Neighbours,
    };
    use simba::simd::WideF64x4;

    const DX: f64 = 0.1;

    /// Particles of a lattice that is out of order, with velocities and densities to match: all different.
    fn columns<T: Term<()>>(term: &T, side: usize) -> Vec<Column<T::Shows>> {
        let number = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let column = |k: usize| {
            let place = Vector2::new((k % side) as f64, (k / side) as f64);
            let position = (place + Vector2::new(number(3 * k), number(7 * k)) * 0.4) * DX;
            let (density, mass) = (1.0 + 0.1 * number(k), DX * DX);
            let common = Common { mass, density, volume: mass / density };
            let velocity = Vector2::new(number(2 * k), number(5 * k));
            Column { position, velocity, common, shows: term.shows(&common, &()) }
        };
        (0..side * side).map(column).chain([Column::sentinel()]).collect()
    }

    /// On a processor with registers for four these are not the same program.
    #[test]
    fn rates_have_the_bits_of_the_portable_row_loop() {
        type Terms = (Pressure<Tait>, Viscosity, Continuity);
        let viscosity = Viscosity { mu: 0.1, eta2: 1e-6 };
        let terms: Terms = (Pressure::new(Tait::new(1.0, 10.0)), viscosity, Continuity);
        let columns = columns(&terms, 30);
        let count = columns.len() - 1;
        let mut neighbours = Neighbours::new(3.0 * DX, &Domain::open(), &[]);
        neighbours.place(columns[..count].iter().map(|column| column.position));
        neighbours.build(&Domain::open(), &[], [count, 0], false, false);
        let kernel = Smoothing::<QuinticSpline>::new(DX);
        let project = |shows: &<Terms as Term<()>>::Shows| *shows;
        let (terms, columns) = (&terms, &columns[..]);
        let sweep = Sweep { kernel: &kernel, terms, columns, project, moving: true };
        let widest: Vec<Rate<()>> = sweep.rates(&neighbours.rows, 0, count);
        let mut portable = Vec::new();
        for (b, block) in neighbours.rows.iter().enumerate() {
            let rows = [b * BLOCK, BLOCK.min(count - b * BLOCK)];
            Rows::new(&sweep, block, rows, |_, rate: Rate<()>| portable.push(rate))
                .run::<WideF64x4>();
        }
        assert!(neighbours.rows.len() > 1 && portable.len() == count);
        let bits =
            |r: &Rate<()>| [r.velocity.x, r.velocity.y, r.density, r.position.x].map(f64::to_bits);
        for (k, (a, b)) in widest.iter().zip(&portable).enumerate() {
            assert_eq!(bits(a), bits(b), "row {k}");
        }
        assert!(widest.iter().all(|rate| rate.velocity.norm() > 0.0 && rate.density != 0.0));
    }
}
