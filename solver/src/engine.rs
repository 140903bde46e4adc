//! The engine: the right-hand side of a scene, which integrators evaluate. It refreshes the data derived from
//! a state and then makes the pair sweeps.

use nalgebra::Vector2;

use crate::{
    kernel::Smoothing,
    neighbours::{BLOCK, Neighbours},
    numbers::Symmetric,
    parallel,
    particle_data::{Extent, Fault, ParticleData, Phase},
    particles::{Column, Common, Evolved, Fixed, Rate, Role},
    physics::{Derived, Physics, State},
    sweep::{self, BlockUpdate, PairSweep, Select, Sweep, first, nothing, second, whole},
    terms::{News, Term, moments::InverseMoments},
    walls::Walls,
};

/// What becomes of a particle: its number in the order of storage, the particle, and its rates.
pub trait Update<X>: Fn(usize, &mut Evolved<X>, &Rate<X>) + Sync {}
impl<X, F: Fn(usize, &mut Evolved<X>, &Rate<X>) + Sync> Update<X> for F {}

/// Terms and particles of a scene.
pub struct Engine<P: Physics> {
    pub(crate) kernel: Smoothing<P::Kernel>,
    /// Of the forces, and of the drift.
    pub(crate) terms: (P::Forces, P::Drift),
    pub(crate) wall_terms: <P::Walls as Walls<P::Extra>>::Terms,
    /// Boxed, for it is moved by code that is compiled for each scheme.
    pub(crate) data: Box<ParticleData<P::Extra>>,
    /// Of the particles, of their images, and the sentinel.
    pub(crate) columns: Vec<Column<Derived<P>>>,
    /// What was found in each block while filling columns, and of what was not filled.
    pub(crate) extents: Vec<Extent>,
    /// What was found of particles that need not be filled again until lists are built: those of walls that
    /// extrapolate, which do not move.
    pub(crate) still: Option<Extent>,
    /// What wall particles extrapolate: empty where they do not.
    pub(crate) extrapolated: Vec<Evolved<P::Extra>>,
    /// Inverses of moments: empty where no force needs them.
    pub(crate) inverses: Vec<Rate<Symmetric>>,
}

impl<P: Physics> Engine<P> {
    /// The engine of particles that have no lists yet.
    pub(crate) fn new(
        h: f64,
        terms: (P::Forces, P::Drift),
        wall_terms: <P::Walls as Walls<P::Extra>>::Terms,
        mut data: Box<ParticleData<P::Extra>>,
    ) -> Self {
        let state = std::mem::take(&mut data.state);
        let mut engine = Self {
            kernel: Smoothing::new(h),
            terms,
            wall_terms,
            data,
            columns: vec![],
            extents: vec![],
            still: None,
            extrapolated: vec![],
            inverses: vec![],
        };
        engine.build_lists(&mut places(&state));
        engine.data.state = state;
        engine
    }

    /// Starts a step at this state: particles may be put in another order, wrapped into the period and put
    /// back before a wall along which they slip, and terms take over the largest speed. Refreshes everything
    /// that is derived from the state.
    pub fn begin(&mut self, state: &mut State<P>) -> Result<(), Fault> {
        if P::Walls::SLIPS {
            for wall in self.data.neighbours.mirrors() {
                let fluid = &mut state[..self.data.counts[0]];
                fluid.iter_mut().for_each(|particle| wall.put_back(particle));
            }
        }
        let mut extent = self.fill(state)?;
        if self.data.progress.built_inside_a_step || self.data.is_stale_soon(extent) {
            self.data.sort(state);
            self.build_lists(&mut places(state));
            self.data.progress.built_inside_a_step = false;
            extent = self.fill(state)?;
        }
        self.terms.prepare(extent.speed());
        self.refresh_walls(state, 1.0);
        Ok(())
    }

    /// Refreshes everything that is derived from a state inside a step.
    pub fn refresh(&mut self, state: &State<P>) -> Result<(), Fault> {
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

    /// Refreshes everything for a state inside a step whose velocities are differences of two velocities,
    /// 0 for wall particles: walls are at rest, and images have the differences that follow.
    pub fn refresh_differences(&mut self, state: &State<P>) -> Result<(), Fault> {
        self.fill(state)?;
        self.refresh_walls(state, 0.0);
        Ok(())
    }

    /// Sums the forces: `update(i, target, rate)` with dv/dt, for fluid particles.
    pub fn sweep_forces(&mut self, targets: &mut State<P>, update: impl Update<P::Extra>) {
        self.normalise();
        self.sweep_part(targets, &self.terms.0.clone(), first(), update);
    }

    /// Sums a part of the forces, whose derived numbers `select` reads: `update(i, target, rate)` with dv/dt,
    /// for fluid particles.
    pub fn sweep_part<T: Term<P::Extra>>(
        &mut self,
        targets: &mut State<P>,
        part: &T,
        select: impl Select<Derived<P>, T::Derived>,
        update: impl Update<P::Extra>,
    ) {
        self.data.count(Phase::Forces);
        let sweep = self.sweep(part, select, true);
        sweep::run(&sweep, &self.data.neighbours.lists, targets, &by_blocks(update));
        self.data.enter(Phase::Rest);
    }

    /// Sums the drift: `update(i, target, rate)` with dx/dt, dρ/dt and the terms' own rates.
    pub fn sweep_drift(&mut self, targets: &mut State<P>, update: impl Update<P::Extra>) {
        self.data.count(Phase::Drift);
        self.sweep_both(&self.sweep(&self.terms.1, second(), true), targets, &by_blocks(update));
    }

    /// Sums forces and drift in one pair sweep: `update(i, target, rate)` with the whole rate.
    pub fn sweep_all(&mut self, targets: &mut State<P>, update: impl Update<P::Extra>) {
        self.normalise();
        self.data.count(Phase::Both);
        self.sweep_both(&self.sweep(&self.terms, whole(), true), targets, &by_blocks(update));
    }

    /// The rates of fluid particles by these terms alone, which need not be those of the scene, for
    /// the state that the columns were refreshed for last. dx/dt is without v.
    pub(crate) fn rates<T: Term<P::Extra>>(&self, terms: &T) -> Vec<Rate<P::Extra>> {
        let (data, neighbours) = (&self.data, &self.data.neighbours);
        let own = |(k, c): (usize, &Column<Derived<P>>)| {
            let Column { position, velocity, common, .. } = *c;
            let extra = data.state.get(k).map_or(P::Extra::default(), |e| e.extra);
            let role = data.fixed.get(k).map_or(Role::Fluid, |fixed| fixed.role);
            Column { position, velocity, common, derived: derived(terms, role, &common, &extra) }
        };
        let mut columns: Vec<_> = self.columns.iter().enumerate().map(own).collect();
        fill_images::<P, T>(neighbours, 0, 1.0, &mut columns);
        if T::NORMALISES {
            normalise::<P, T>(&self.kernel, neighbours, &mut columns, &mut Vec::new());
        }
        let (kernel, select) = (&self.kernel, whole());
        let sweep = Sweep { kernel, terms, columns: &columns, select, moving: false };
        sweep::rates(&sweep, &neighbours.lists)
    }

    /// The rates of fluid particles by all terms, likewise, from the sweep of [`Engine::sweep_all`].
    pub fn rates_in_one_sweep(&self) -> Vec<Rate<P::Extra>> {
        sweep::rates(&self.sweep(&self.terms, whole(), false), &self.data.neighbours.lists)
    }

    /// The same with dv/dt from the sweep of [`Engine::sweep_forces`], and the rest from that of
    /// [`Engine::sweep_drift`].
    pub fn rates_in_two_sweeps(&self) -> Vec<Rate<P::Extra>> {
        let lists = &self.data.neighbours.lists;
        let forces = sweep::rates(&self.sweep(&self.terms.0, first(), false), lists);
        let drift = sweep::rates(&self.sweep(&self.terms.1, second(), false), lists);
        together(forces, drift)
    }

    /// The rates of wall particles by the terms of the walls, for the state that the columns were
    /// refreshed for last; none where these do not give rates but extrapolate.
    pub(crate) fn wall_rates(&self) -> Vec<Rate<P::Extra>> {
        if P::Walls::EXTRAPOLATES {
            return Vec::new();
        }
        sweep::rates(&self.wall_sweep(), &self.data.neighbours.wall_lists)
    }

    /// Memory held \[bytes\].
    pub(crate) fn bytes(&self) -> usize {
        self.data.bytes()
            + self.columns.capacity() * size_of::<Column<Derived<P>>>()
            + self.extents.capacity() * size_of::<Extent>()
            + self.extrapolated.capacity() * size_of::<Evolved<P::Extra>>()
            + self.inverses.capacity() * size_of::<Rate<Symmetric>>()
    }

    /// Tells the forces the inverses of the moments, if they need them.
    pub(crate) fn normalise(&mut self) {
        const { assert!(!(P::Forces::NORMALISES && P::Walls::EXTRAPOLATES), "moments of fluid alone") };
        const { assert!(!P::Drift::NORMALISES, "a drift sums its own moments") };
        if P::Forces::NORMALISES {
            self.data.count(Phase::Forces);
            let Self { kernel, data, columns, inverses, .. } = self;
            normalise::<P, (P::Forces, P::Drift)>(kernel, &data.neighbours, columns, inverses);
        }
    }

    fn sweep<'a, T: Term<P::Extra>>(
        &'a self,
        terms: &'a T,
        select: impl Select<Derived<P>, T::Derived>,
        moving: bool,
    ) -> impl PairSweep<P::Extra> {
        Sweep { kernel: &self.kernel, terms, columns: &self.columns, select, moving }
    }

    /// Updates fluid particles by this sweep, and wall particles by that of the walls' own terms, if these
    /// give rates.
    fn sweep_both(
        &self,
        sweep: &dyn PairSweep<P::Extra>,
        targets: &mut State<P>,
        update: &BlockUpdate<P::Extra>,
    ) {
        let fluid = self.data.fluid_count();
        sweep::run(sweep, &self.data.neighbours.lists, targets, update);
        if self.swept() > fluid {
            self.sweep_walls(&mut targets[fluid..], update);
        }
        self.data.enter(Phase::Rest);
    }

    /// Number of particles that have rates, the first of a state: those of the fluid, and of walls that do
    /// not extrapolate.
    pub(crate) fn swept(&self) -> usize {
        let [fluid, walls] = self.data.counts;
        if P::Walls::EXTRAPOLATES { fluid } else { fluid + walls }
    }

    fn sweep_walls(&self, targets: &mut State<P>, update: &BlockUpdate<P::Extra>) {
        self.data.enter(Phase::Walls);
        sweep::run(&self.wall_sweep(), &self.data.neighbours.wall_lists, targets, update);
    }

    fn wall_sweep(&self) -> impl PairSweep<P::Extra> {
        let (fluid, feet) = (self.data.counts[0], &self.data.neighbours.feet);
        // Fluid has numbers below those of walls, and images have numbers above, for which there are no feet.
        let foot = move |k: usize, _: &_| {
            <P::Walls as Walls<P::Extra>>::foot(feet.get(k.wrapping_sub(fluid)))
        };
        self.sweep(&self.wall_terms, foot, false)
    }

    /// Builds neighbour lists and images for particles at these places, and makes room for their columns.
    pub(crate) fn build_lists(&mut self, positions: &mut dyn Iterator<Item = Vector2<f64>>) {
        self.data.enter(Phase::Search);
        self.data.neighbours.place(positions);
        let Self { data, .. } = self;
        data.neighbours.build(data.counts, P::Walls::EXTRAPOLATES, data.parallel);
        data.progress.work.list_builds += 1;
        self.still = None;
        let columns = self.data.fixed.len() + self.data.neighbours.images.len();
        self.columns.resize(columns + 1, Column::sentinel());
        self.columns[columns] = Column::sentinel();
        self.data.column_bytes = size_of_val(&self.columns[..]);
    }

    /// Derives the columns of the particles, and finds out how far they moved since the neighbour lists
    /// were built.
    fn fill(&mut self, state: &State<P>) -> Result<Extent, Fault> {
        self.data.enter(Phase::Refresh);
        let Self { terms, data, columns, extents, still, .. } = self;
        let [fluid, walls] = data.counts;
        let filled = if still.is_some() { fluid } else { state.len() };
        let count = filled.div_ceil(BLOCK);
        extents.resize(count + 1, Extent::NIL);
        extents[count] = still.unwrap_or(Extent::NIL);
        let blocks = columns[..filled].chunks_mut(BLOCK).zip(&mut *extents).enumerate();
        parallel::for_each(blocks, data.parallel, &|(b, (columns, extent))| {
            let particles = b * BLOCK..b * BLOCK + columns.len();
            let (state, fixed) = (&state[particles.clone()], &data.fixed[particles.clone()]);
            // A copy, which no write can change: what does not depend on the particle leaves the loop.
            let terms = &terms.clone();
            for ((column, evolved), fixed) in columns.iter_mut().zip(state).zip(fixed) {
                derive(terms, fixed, evolved, column);
            }
            *extent = data.extent(state, &data.neighbours.built_at[particles]);
        });
        // Columns of interface particles, if there are any, are filled by nobody else.
        if P::Walls::EXTRAPOLATES && fluid + walls == state.len() && still.is_none() {
            *still = Some(data.extent(&state[fluid..], &data.neighbours.built_at[fluid..]));
        }
        data.check(state, extents)
    }

    /// Refreshes images, and what wall particles extrapolate, with this share of the walls' own motion.
    fn refresh_walls(&mut self, state: &State<P>, motion: f64) {
        let neighbours = &self.data.neighbours;
        fill_images::<P, (P::Forces, P::Drift)>(neighbours, 0, motion, &mut self.columns);
        if P::Walls::EXTRAPOLATES && self.data.counts[1] > 0 {
            self.extrapolate(state, motion);
        }
        self.data.enter(Phase::Rest);
    }

    /// Gives the columns of wall particles that extrapolate what the fluid before them implies, and
    /// their images too.
    fn extrapolate(&mut self, state: &State<P>, motion: f64) {
        let (walls, fluid) = (self.data.neighbours.wall_lists.of.clone(), self.data.counts[0]);
        let mut implied = std::mem::take(&mut self.extrapolated);
        implied.clear();
        implied.extend_from_slice(&state[walls]);
        // The sums read what wall particles have, and their columns hold what was extrapolated last.
        for (column, own) in self.columns[fluid..].iter_mut().zip(&implied) {
            (column.velocity, column.common.density) = (own.velocity, own.density);
        }
        // Sums are made at the foot of a wall particle, if it has one; its column is derived again below.
        for (column, foot) in self.columns[fluid..].iter_mut().zip(&self.data.neighbours.feet) {
            column.position += foot;
        }
        let update = |_, target: &mut Evolved<P::Extra>, rate: &Rate<P::Extra>| {
            target.velocity += rate.velocity;
            target.density = rate.density;
        };
        self.sweep_walls(&mut implied, &by_blocks(update));
        self.data.enter(Phase::Refresh);
        let fixed = &self.data.fixed[fluid..];
        for ((column, implied), fixed) in self.columns[fluid..].iter_mut().zip(&implied).zip(fixed)
        {
            derive(&self.terms, fixed, implied, column);
        }
        self.extrapolated = implied;
        let neighbours = &self.data.neighbours;
        fill_images::<P, (P::Forces, P::Drift)>(neighbours, fluid, motion, &mut self.columns);
    }
}

/// The rates of velocities by the forces, and the others by the drift.
fn together<X>(forces: Vec<Rate<X>>, mut drift: Vec<Rate<X>>) -> Vec<Rate<X>> {
    for (rate, forces) in drift.iter_mut().zip(forces) {
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
fn fill_images<P: Physics, T: Term<P::Extra>>(
    neighbours: &Neighbours,
    first: usize,
    motion: f64,
    columns: &mut [Column<T::Derived>],
) {
    let real = columns.len() - 1 - neighbours.images.len();
    for (k, image) in neighbours.images.iter().enumerate() {
        let source = image.source as usize;
        if source >= first {
            let (map, source) = (&neighbours.maps[image.map as usize], &columns[source]);
            columns[real + k] = map.apply(source, P::Walls::SLIPS, motion);
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
    fill_images::<P, T>(neighbours, 0, 1.0, columns);
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
fn by_blocks<X>(update: impl Update<X>) -> impl Fn(usize, &mut [Evolved<X>], &[Rate<X>]) + Sync {
    move |first, targets, rates| {
        for (k, (target, rate)) in (first..).zip(targets.iter_mut().zip(rates)) {
            update(k, target, rate);
        }
    }
}
