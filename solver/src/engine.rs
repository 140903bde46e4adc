//! The engine: the right-hand side of a scene, which integrators evaluate. It refreshes the data derived from
//! a state and then makes the pair sweeps. What does not depend on the equations of the scene knows them as
//! `Equations`, and is compiled once, not for each scheme.

use std::mem::take;

use nalgebra::Vector2;

use crate::{
    kernel::Smoothing,
    neighbours::{BLOCK, Lists, Neighbours},
    numbers::{Numbers, Symmetric},
    parallel,
    particle_data::{Checkpoint, Counts, Extent, Fault, ParticleData, Phase},
    particles::{Column, Common, Evolved, Fixed, Rate, Role},
    physics::{Derived, Physics, State},
    sweep::{self, BlockUpdate, PairSweep, Select, Sweep, first, nothing, second, whole},
    terms::{News, Term, moments::InverseMoments},
    walls::Walls,
};

/// What becomes of a particle: its number in the order of storage, the particle, and its rates.
pub trait Update<X>: Fn(usize, &mut Evolved<X>, &Rate<X>) + Sync {}
impl<X, F: Fn(usize, &mut Evolved<X>, &Rate<X>) + Sync> Update<X> for F {}

/// Terms of a scene, and the columns that they derive, without their types.
pub(crate) trait Equations<X>: Sync {
    /// Tells the terms the largest speed \[m/s\].
    fn prepare(&mut self, speed: f64);
    /// Makes room for so many columns, the last of them the sentinel. Returns their memory \[bytes\].
    fn make_room(&mut self, count: usize) -> usize;
    /// Derives the columns of these particles, the first ones, and what is found in each block of them.
    fn derive(&mut self, of: &ParticleData<X>, state: &[Evolved<X>], extents: &mut [Extent]);
    /// Refills the images of particles from `first` on, with this share of the walls' own motion.
    fn fill_images(&mut self, neighbours: &Neighbours, first: usize, motion: f64);
    /// Derives the columns of wall particles from these.
    fn derive_walls(&mut self, of: &ParticleData<X>, walls: &[Evolved<X>]);
    /// Shows the pair sweep over wall particles, if their terms are any.
    fn wall_sweep(&self, of: &ParticleData<X>, show: &mut dyn FnMut(&dyn PairSweep<X>));
}

/// What an engine does that does not depend on its equations.
pub(crate) struct Core<'a, X> {
    data: &'a mut ParticleData<X>,
    equations: &'a mut dyn Equations<X>,
}

impl<X: Numbers> Core<'_, X> {
    fn begin(
        &mut self,
        state: &mut [Evolved<X>],
        along: &mut dyn FnMut(usize, usize),
    ) -> Result<(), Fault> {
        if self.data.slips {
            for wall in self.data.neighbours.mirrors() {
                let fluid = &mut state[..self.data.counts.fluid];
                fluid.iter_mut().for_each(|particle| wall.put_back(particle));
            }
        }
        let mut extent = self.fill(state)?;
        if self.data.progress.built_inside_a_step || self.data.is_stale_soon(extent) {
            self.data.sort(state, along);
            self.build_lists(&mut places(state));
            self.data.progress.built_inside_a_step = false;
            extent = self.fill(state)?;
        }
        self.equations.prepare(extent.speed());
        self.refresh_walls(state, 1.0);
        Ok(())
    }

    fn refresh(&mut self, state: &[Evolved<X>]) -> Result<(), Fault> {
        let extent = self.fill(state)?;
        if self.data.is_stale(extent) {
            self.build_lists(&mut places(state));
            // Particles may have left the period by more than images make up for: wrap soon.
            self.data.progress.built_inside_a_step = true;
            self.fill(state)?;
        }
        self.refresh_walls(state, 1.0);
        Ok(())
    }

    /// Builds neighbour lists and images for particles at these places, and makes room for their columns.
    fn build_lists(&mut self, positions: &mut dyn Iterator<Item = Vector2<f64>>) {
        let data = &mut *self.data;
        data.enter(Phase::Search);
        data.neighbours.place(positions);
        data.neighbours.build(
            data.counts.fluid,
            data.counts.walls,
            data.extrapolates,
            data.parallel,
        );
        data.progress.work.list_builds += 1;
        data.buffers.still = None;
        let columns = data.fixed.len() + data.neighbours.images.len();
        data.column_bytes = self.equations.make_room(columns + 1);
    }

    /// Goes back or on to a checkpoint.
    pub fn restore(&mut self, from: &Checkpoint<X>) -> Result<(), &'static str> {
        self.data.replace(from)?;
        self.build_lists(&mut from.built_at.iter().copied());
        self.data.progress = from.progress;
        Ok(())
    }

    fn build_first_lists(&mut self) {
        let state = take(&mut self.data.state);
        self.build_lists(&mut places(&state));
        self.data.state = state;
    }

    /// Derives the columns of the particles, and finds out how far they moved since the neighbour lists
    /// were built.
    fn fill(&mut self, state: &[Evolved<X>]) -> Result<Extent, Fault> {
        let data = &mut *self.data;
        data.enter(Phase::Refresh);
        let Counts { fluid, walls } = data.counts;
        let filled = if data.buffers.still.is_some() { fluid } else { state.len() };
        let count = filled.div_ceil(BLOCK);
        let mut extents = take(&mut data.buffers.extents);
        extents.resize(count + 1, Extent::NIL);
        extents[count] = data.buffers.still.unwrap_or(Extent::NIL);
        self.equations.derive(data, &state[..filled], &mut extents);
        // Columns of interface particles, if there are any, are filled by nobody else.
        if data.extrapolates && fluid + walls == state.len() && data.buffers.still.is_none() {
            data.buffers.still =
                Some(data.extent(&state[fluid..], &data.neighbours.built_at[fluid..]));
        }
        let checked = data.check(state, &extents);
        data.buffers.extents = extents;
        checked
    }

    /// Refreshes images, and what wall particles extrapolate, with this share of the walls' own motion.
    fn refresh_walls(&mut self, state: &[Evolved<X>], motion: f64) {
        self.equations.fill_images(&self.data.neighbours, 0, motion);
        if self.data.extrapolates && self.data.counts.walls > 0 {
            self.extrapolate(state, motion);
        }
        self.data.enter(Phase::Rest);
    }

    /// Gives the columns of wall particles that extrapolate what the fluid before them implies, and
    /// their images too.
    fn extrapolate(&mut self, state: &[Evolved<X>], motion: f64) {
        let Self { data, equations } = self;
        let own = &state[data.neighbours.wall_lists.of.clone()];
        let mut implied = take(&mut data.buffers.extrapolated);
        implied.clear();
        implied.extend_from_slice(own);
        // Sums are made at the foot of a wall particle, if it has one; its column is derived again below.
        for (wall, foot) in implied.iter_mut().zip(&data.neighbours.feet) {
            wall.position += foot;
        }
        // They read what wall particles have, and their columns hold what was extrapolated last.
        equations.derive_walls(data, &implied);
        let update = each(|_, target: &mut Evolved<X>, rate: &Rate<X>| {
            target.velocity += rate.velocity;
            target.density = rate.density;
        });
        data.sweep_walls(*equations, &mut implied, &update);
        data.enter(Phase::Refresh);
        for (wall, own) in implied.iter_mut().zip(own) {
            wall.position = own.position;
        }
        equations.derive_walls(data, &implied);
        data.buffers.extrapolated = implied;
        equations.fill_images(&data.neighbours, data.counts.fluid, motion);
    }
}

impl<X: Numbers> ParticleData<X> {
    /// Updates fluid particles by this sweep, and wall particles by that of the walls' own terms, if these
    /// give rates and not only forces are summed.
    fn sweep(
        &mut self,
        phase: Phase,
        sweep: &dyn PairSweep<X>,
        equations: &dyn Equations<X>,
        targets: &mut [Evolved<X>],
        update: &BlockUpdate<X>,
    ) {
        self.count(phase);
        sweep::run(sweep, &self.neighbours.lists, targets, update);
        if phase != Phase::Forces && !self.extrapolates {
            self.sweep_walls(equations, &mut targets[self.counts.fluid..], update);
        }
        self.enter(Phase::Rest);
    }

    fn sweep_walls(
        &self,
        equations: &dyn Equations<X>,
        targets: &mut [Evolved<X>],
        update: &BlockUpdate<X>,
    ) {
        if self.counts.walls > 0 {
            equations.wall_sweep(self, &mut |sweep| {
                self.enter(Phase::Walls);
                sweep::run(sweep, &self.neighbours.wall_lists, targets, update);
            });
        }
    }

    /// The rates of wall particles by the terms of the walls, for the state that the columns were
    /// refreshed for last; none where these do not give rates but extrapolate.
    pub(crate) fn wall_rates(&self, equations: &dyn Equations<X>) -> Vec<Rate<X>> {
        let mut rates = Vec::new();
        if !self.extrapolates {
            let lists = &self.neighbours.wall_lists;
            equations.wall_sweep(self, &mut |sweep| rates = sweep::rates(sweep, lists));
        }
        rates
    }

    /// The role and the extra fields of a particle, in the fluid without any of images.
    fn own(&self, k: usize) -> (Role, X) {
        let extra = self.state.get(k).map_or(X::default(), |evolved| evolved.extra);
        (self.fixed.get(k).map_or(Role::Fluid, |fixed| fixed.role), extra)
    }
}

/// Terms and columns of a scene.
pub(crate) struct Typed<P: Physics> {
    pub kernel: Smoothing<P::Kernel>,
    /// Of the forces, and of the drift.
    pub terms: (P::Forces, P::Drift),
    wall_terms: <P::Walls as Walls<P::Extra>>::Terms,
    /// Of the particles, of their images, and the sentinel.
    pub columns: Vec<Column<Derived<P>>>,
    /// Inverses of moments: empty where no force needs them.
    inverses: Vec<Rate<Symmetric>>,
}

impl<P: Physics> Typed<P> {
    fn sweep<'a, T: Term<P::Extra>>(
        &'a self,
        terms: &'a T,
        select: impl Select<Derived<P>, T::Derived>,
        moving: bool,
    ) -> impl PairSweep<P::Extra> {
        Sweep { kernel: &self.kernel, terms, columns: &self.columns, select, moving }
    }
}

impl<X: Numbers, P: Physics<Extra = X>> Equations<X> for Typed<P> {
    fn prepare(&mut self, speed: f64) {
        self.terms.prepare(speed);
    }

    fn make_room(&mut self, count: usize) -> usize {
        self.columns.resize(count, Column::sentinel());
        self.columns[count - 1] = Column::sentinel();
        size_of_val(&self.columns[..])
    }

    fn derive(&mut self, of: &ParticleData<X>, state: &[Evolved<X>], extents: &mut [Extent]) {
        let terms = &self.terms;
        derive_blocks(&mut self.columns, of, state, extents, &|columns, state, fixed| {
            derive_all(terms, fixed, state, columns);
        });
    }

    fn fill_images(&mut self, neighbours: &Neighbours, first: usize, motion: f64) {
        fill_images(neighbours, first, P::Walls::SLIPS, motion, &mut self.columns);
    }

    fn derive_walls(&mut self, of: &ParticleData<X>, walls: &[Evolved<X>]) {
        let at = of.neighbours.wall_lists.of.clone();
        derive_all(&self.terms, &of.fixed[at.clone()], walls, &mut self.columns[at]);
    }

    fn wall_sweep(&self, of: &ParticleData<X>, show: &mut dyn FnMut(&dyn PairSweep<X>)) {
        if !<P::Walls as Walls<X>>::Terms::IS_EMPTY {
            let select = at_feet::<X, P::Walls, _>(of.counts.fluid, &of.neighbours.feet);
            show(&self.sweep(&self.wall_terms, select, false));
        }
    }
}

/// What terms of walls read of the feet of wall particles, of which this is the number of the first.
fn at_feet<X, W: Walls<X>, S>(
    first: usize,
    feet: &[Vector2<f64>],
) -> impl Select<S, <W::Terms as Term<X>>::Derived> {
    // Fluid has numbers below those of walls, and images have numbers above, for which there are no feet.
    move |k: usize, _: &S| W::foot(feet.get(k.wrapping_sub(first)))
}

/// Terms and particles of a scene.
pub struct Engine<P: Physics> {
    pub(crate) typed: Typed<P>,
    /// Boxed, for it is moved by code that is compiled for each scheme.
    pub(crate) data: Box<ParticleData<P::Extra>>,
}

impl<P: Physics> Engine<P> {
    /// The engine of particles that have no lists yet.
    pub(crate) fn new(
        h: f64,
        terms: (P::Forces, P::Drift),
        walls: &P::Walls,
        mut data: Box<ParticleData<P::Extra>>,
    ) -> Self {
        let (kernel, wall_terms) = (Smoothing::new(h), walls.terms());
        let typed = Typed { kernel, terms, wall_terms, columns: vec![], inverses: vec![] };
        data.slips = P::Walls::SLIPS;
        data.extrapolates = P::Walls::EXTRAPOLATES;
        let mut engine = Self { typed, data };
        engine.core().build_first_lists();
        engine
    }

    pub(crate) fn core(&mut self) -> Core<'_, P::Extra> {
        Core { data: &mut self.data, equations: &mut self.typed }
    }

    /// Starts a step at this state: particles may be put in another order, wrapped into the period and put
    /// back before a wall along which they slip, and terms take over the largest speed. Refreshes everything
    /// that is derived from the state.
    pub fn begin(&mut self, state: &mut State<P>) -> Result<(), Fault> {
        self.core().begin(state, &mut |_, _| ())
    }

    /// Starts a step likewise, with something `kept` of each of the first particles, or of none, which stays
    /// in their order.
    pub fn begin_with<T>(&mut self, state: &mut State<P>, kept: &mut [T]) -> Result<(), Fault> {
        let mut along = |i, j| {
            if !kept.is_empty() {
                kept.swap(i, j);
            }
        };
        self.core().begin(state, &mut along)
    }

    /// Refreshes everything that is derived from a state inside a step.
    pub fn refresh(&mut self, state: &State<P>) -> Result<(), Fault> {
        self.core().refresh(state)
    }

    /// Refreshes everything for a state inside a step whose velocities are differences of two velocities,
    /// 0 for wall particles: walls are at rest, and images have the differences that follow.
    pub fn refresh_differences(&mut self, state: &State<P>) -> Result<(), Fault> {
        self.core().fill(state)?;
        self.core().refresh_walls(state, 0.0);
        Ok(())
    }

    /// Sums the forces: `update` with dv/dt, for fluid particles.
    pub fn sweep_forces(&mut self, targets: &mut State<P>, update: &BlockUpdate<P::Extra>) {
        self.normalise();
        let sweep = self.typed.sweep(&self.typed.terms.0, first(), true);
        self.data.sweep(Phase::Forces, &sweep, &self.typed, targets, update);
    }

    /// Sums a part of the forces, whose derived numbers `select` reads: `update` with dv/dt, for fluid
    /// particles.
    pub fn sweep_part<T: Term<P::Extra>>(
        &mut self,
        targets: &mut State<P>,
        part: &T,
        select: impl Select<Derived<P>, T::Derived>,
        update: &BlockUpdate<P::Extra>,
    ) {
        let sweep = self.typed.sweep(part, select, true);
        self.data.sweep(Phase::Forces, &sweep, &self.typed, targets, update);
    }

    /// Sums the drift: `update` with dx/dt, dρ/dt and the terms' own rates.
    pub fn sweep_drift(&mut self, targets: &mut State<P>, update: &BlockUpdate<P::Extra>) {
        let sweep = self.typed.sweep(&self.typed.terms.1, second(), true);
        self.data.sweep(Phase::Drift, &sweep, &self.typed, targets, update);
    }

    /// Sums forces and drift in one pair sweep: `update` with the whole rate.
    pub fn sweep_all(&mut self, targets: &mut State<P>, update: &BlockUpdate<P::Extra>) {
        self.normalise();
        let sweep = self.typed.sweep(&self.typed.terms, whole(), true);
        self.data.sweep(Phase::Both, &sweep, &self.typed, targets, update);
    }

    /// The rates of fluid particles by these terms alone, which need not be those of the scene, for
    /// the state that the columns were refreshed for last. dx/dt is without v.
    pub(crate) fn rates<T: Term<P::Extra>>(&self, terms: &T) -> Vec<Rate<P::Extra>> {
        let (kernel, neighbours) = (&self.typed.kernel, &self.data.neighbours);
        let mut columns = vec![Column::sentinel(); self.typed.columns.len()];
        for (k, column) in columns.iter_mut().enumerate() {
            let Column { position, velocity, common, .. } = self.typed.columns[k];
            let (role, extra) = self.data.own(k);
            let derived = derived(terms, role, &common, &extra);
            *column = Column { position, velocity, common, derived };
        }
        fill_images(neighbours, 0, P::Walls::SLIPS, 1.0, &mut columns);
        if T::NORMALISES {
            normalise::<P, T>(kernel, neighbours, &mut columns, &mut Vec::new());
        }
        let sweep = Sweep { kernel, terms, columns: &columns, select: whole(), moving: false };
        sweep::rates(&sweep, &neighbours.lists)
    }

    /// The rates of fluid particles by all terms, likewise, from the sweep of [`Engine::sweep_all`].
    pub fn rates_in_one_sweep(&self) -> Vec<Rate<P::Extra>> {
        let sweep = self.typed.sweep(&self.typed.terms, whole(), false);
        sweep::rates(&sweep, &self.data.neighbours.lists)
    }

    /// The same with dv/dt from the sweep of [`Engine::sweep_forces`], and the rest from that of
    /// [`Engine::sweep_drift`].
    pub fn rates_in_two_sweeps(&self) -> Vec<Rate<P::Extra>> {
        let forces = self.typed.sweep(&self.typed.terms.0, first(), false);
        let drift = self.typed.sweep(&self.typed.terms.1, second(), false);
        together(&forces, &drift, &self.data.neighbours.lists)
    }

    /// Number of particles that have rates, the first of a state: those of the fluid, and of walls whose
    /// terms give rates.
    pub(crate) fn swept(&self) -> usize {
        let Counts { fluid, walls } = self.data.counts;
        let only = P::Walls::EXTRAPOLATES || <P::Walls as Walls<P::Extra>>::Terms::IS_EMPTY;
        if only { fluid } else { fluid + walls }
    }

    /// Memory held \[bytes\].
    pub(crate) fn bytes(&self) -> usize {
        self.data.bytes()
            + self.typed.columns.capacity() * size_of::<Column<Derived<P>>>()
            + self.typed.inverses.capacity() * size_of::<Rate<Symmetric>>()
    }

    /// Tells the forces the inverses of the moments, if they need them.
    pub(crate) fn normalise(&mut self) {
        const { assert!(!(P::Forces::NORMALISES && P::Walls::EXTRAPOLATES), "moments of fluid alone") };
        const { assert!(!P::Drift::NORMALISES, "a drift sums its own moments") };
        if P::Forces::NORMALISES {
            self.data.count(Phase::Forces);
            let Typed { kernel, columns, inverses, .. } = &mut self.typed;
            let neighbours = &self.data.neighbours;
            normalise::<P, (P::Forces, P::Drift)>(kernel, neighbours, columns, inverses);
        }
    }
}

/// The rates of velocities by the forces, and the others by the drift.
fn together<X: Numbers>(
    forces: &dyn PairSweep<X>,
    drift: &dyn PairSweep<X>,
    lists: &Lists,
) -> Vec<Rate<X>> {
    let mut drift = sweep::rates(drift, lists);
    for (rate, forces) in drift.iter_mut().zip(sweep::rates(forces, lists)) {
        rate.velocity = forces.velocity;
    }
    drift
}

/// Where particles are: an iterator whose type depends on no scheme.
pub(crate) fn places<X>(state: &[Evolved<X>]) -> impl Iterator<Item = Vector2<f64>> {
    state.iter().map(|evolved| evolved.position)
}

/// Refills the images among these columns of the particles from `first` on; an image of an image belongs to
/// both. `motion` is the share of the walls' own motion that they have.
fn fill_images<D: Numbers>(
    neighbours: &Neighbours,
    first: usize,
    slips: bool,
    motion: f64,
    columns: &mut [Column<D>],
) {
    let real = columns.len() - 1 - neighbours.images.len();
    for (k, image) in neighbours.images.iter().enumerate() {
        let source = image.source as usize;
        if source >= first {
            let (map, source) = (&neighbours.maps[image.map as usize], &columns[source]);
            columns[real + k] = map.apply(source, slips, motion);
        }
    }
}

/// Sums the moments of all particles, and tells the columns and their images the inverses.
fn normalise<P: Physics, T: Term<P::Extra>>(
    kernel: &Smoothing<P::Kernel>,
    neighbours: &Neighbours,
    columns: &mut [Column<T::Derived>],
    inverses: &mut Vec<Rate<Symmetric>>,
) {
    let terms = &InverseMoments;
    let sweep = Sweep { kernel, terms, columns, select: nothing(), moving: false };
    let Neighbours { lists, wall_lists, .. } = neighbours;
    inverses.resize(lists.of.end.max(wall_lists.of.end), Rate::default());
    for lists in [lists, wall_lists] {
        sweep::fill(&sweep, lists, &mut inverses[lists.of.clone()]);
    }
    for (column, inverse) in columns.iter_mut().zip(inverses) {
        T::tell(&mut column.derived, News::Inverse(inverse.extra));
    }
    fill_images(neighbours, 0, P::Walls::SLIPS, 1.0, columns);
}

/// What derives columns of particles.
type Derives<'a, X, D> = dyn Fn(&mut [Column<D>], &[Evolved<X>], &[Fixed]) + Sync + 'a;

/// [`Equations::derive`], block by block.
fn derive_blocks<X: Numbers, D: Numbers>(
    columns: &mut [Column<D>],
    of: &ParticleData<X>,
    state: &[Evolved<X>],
    extents: &mut [Extent],
    derive: &Derives<X, D>,
) {
    let blocks = columns[..state.len()].chunks_mut(BLOCK).zip(extents).enumerate();
    parallel::for_each(blocks, of.parallel, &|(b, (columns, extent))| {
        let particles = b * BLOCK..b * BLOCK + columns.len();
        let state = &state[particles.clone()];
        derive(columns, state, &of.fixed[particles.clone()]);
        *extent = of.extent(state, &of.neighbours.built_at[particles]);
    });
}

/// Writes the columns of particles.
fn derive_all<X, T: Term<X>>(
    terms: &T,
    fixed: &[Fixed],
    state: &[Evolved<X>],
    columns: &mut [Column<T::Derived>],
) {
    // A copy, which no write can change: what does not depend on the particle leaves the loop.
    let terms = &terms.clone();
    let (fixed, state) = (&fixed[..columns.len()], &state[..columns.len()]);
    for k in 0..columns.len() {
        derive(terms, &fixed[k], &state[k], &mut columns[k]);
    }
}

/// Writes the column of a particle, field by field: as a value it is put together on the stack first, from
/// where the processor loads what it has just stored, which takes up to 40 ns a particle.
#[inline(always)]
fn derive<X, T: Term<X>>(
    terms: &T,
    fixed: &Fixed,
    evolved: &Evolved<X>,
    column: &mut Column<T::Derived>,
) {
    let (mass, density) = (fixed.mass, evolved.density);
    column.common = Common { mass, density, volume: mass / density };
    column.position = evolved.position;
    column.velocity = evolved.velocity;
    column.derived = derived(terms, fixed.role, &column.common, &evolved.extra);
}

/// The derived data of a particle in this role.
#[inline(always)]
fn derived<X, T: Term<X>>(terms: &T, role: Role, own: &Common, extra: &X) -> T::Derived {
    let mut derived = terms.derived(own, extra);
    if role != Role::Fluid {
        T::tell(&mut derived, News::OnBoundary);
    }
    derived
}

/// An update of one particle as that of a block: called once for so many, it costs no time to call.
pub fn each<X>(update: impl Update<X>) -> impl Fn(usize, &mut [Evolved<X>], &[Rate<X>]) + Sync {
    move |first, targets, rates| {
        for (k, (target, rate)) in (first..).zip(targets.iter_mut().zip(rates)) {
            update(k, target, rate);
        }
    }
}
