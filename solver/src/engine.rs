//! The engine: the right-hand side of a scene, which integrators evaluate. It refreshes the data derived from
//! a state and then makes the pair sweeps.
//!
//! Between an integrator and a term:
//! - [`Engine`]: particles and equations, with a method for each sweep that an integrator makes;
//! - [`BlockUpdate`]: the integrator's update of some particles by their rates;
//! - `TypedEquations`: the terms of a scene, and the columns that they derive;
//! - `Equations`: the same without types of terms;
//! - `Sweep`: sums over neighbour lists, which read columns;
//! - `PairSweep`: the same without the types of what it reads and sums;
//! - `PairSum`: the summand of a sweep;
//! - `Rates`: the summand of some terms, whose sum is a [`Rate`].
//!
//! Code that uses `dyn Equations` and `dyn PairSweep`, here and in `sweep.rs`, is compiled once, not once for
//! each scheme.

use std::mem::take;

use nalgebra::Vector2;

use crate::{
    kernel::Smoothing,
    neighbours::{BLOCK, Lists, Neighbours},
    numbers::{Numbers, Symmetric},
    parallel,
    particle_data::{
        BlockExtrema, Checkpoint, InvalidState, ParticleData, Phase, PreviousStep, RoleCounts,
        Stepped,
    },
    particles::{Common, Constants, Rate, Role, State, SweptParticle},
    physics::{Derived, Particles, Physics},
    sweep::{self, BlockUpdate, PairSweep, Sweep},
    terms::{Divergence, Rates, Term, moments::InverseMoments},
    walls::{Extrapolated, Extrapolation, WallState, Walls},
};

/// Terms of a scene and their columns, without their types.
pub(crate) trait Equations<X>: Sync {
    /// Gives the terms the largest speed \[m/s\].
    fn prepare(&mut self, speed: f64);
    /// Allocates `count` columns; the last is the sentinel. Returns their memory \[bytes\].
    fn make_room(&mut self, count: usize) -> usize;
    /// Derives the columns of these particles, the first ones, and the extent of each block of them.
    fn derive(&mut self, of: &ParticleData<X>, state: &[State<X>], extents: &mut [BlockExtrema]);
    /// Refills the images of particles from `first` on, with this share of the walls' own motion.
    fn fill_images(&mut self, neighbours: &Neighbours, first: usize, motion: f64);
    /// Derives the columns of wall particles from these.
    fn derive_walls(&mut self, of: &ParticleData<X>, walls: &[State<X>]);
    /// Calls `run` with the pair sweep over wall particles; not at all if walls have no terms.
    fn sweep_walls(&self, run: &mut dyn FnMut(&dyn PairSweep<Rate<X>>));
    /// Calls `run` with the pair sweep that extrapolates to wall particles; not at all if walls do not
    /// extrapolate.
    fn extrapolate(&self, of: &ParticleData<X>, run: &mut dyn FnMut(&dyn PairSweep<WallState>));
}

/// The work of an engine on particles that needs no type of its equations.
impl<X: Numbers> ParticleData<X> {
    fn begin(
        &mut self,
        equations: &mut dyn Equations<X>,
        state: &mut [State<X>],
        past: &mut [PreviousStep<X>],
    ) -> Stepped {
        if self.slips {
            let (fluid, neighbours) = (&mut state[..self.counts.fluid], &self.neighbours);
            parallel::for_each_part(fluid, self.neighbours.parallel, &|_, part| {
                for wall in neighbours.mirrors() {
                    part.iter_mut().for_each(|particle| wall.put_back(particle));
                }
            });
        }
        let mut extent = self.fill(equations, state)?;
        if self.progress.built_inside_a_step || self.is_stale_soon(extent) {
            self.sort(state, past);
            self.build_lists(equations, &|k| state[k].position);
            self.progress.built_inside_a_step = false;
            extent = self.fill(equations, state)?;
        }
        equations.prepare(extent.speed());
        self.refresh_walls(equations, state, 1.0);
        Ok(())
    }

    fn refresh(&mut self, equations: &mut dyn Equations<X>, state: &[State<X>]) -> Stepped {
        let extent = self.fill(equations, state)?;
        if self.is_stale(extent) {
            self.build_lists(equations, &|k| state[k].position);
            // Particles may have left the period by more than images make up for: wrap soon.
            self.progress.built_inside_a_step = true;
            self.fill(equations, state)?;
        }
        self.refresh_walls(equations, state, 1.0);
        Ok(())
    }

    /// Builds neighbour lists and images for particles at these places, and makes room for their columns.
    fn build_lists(
        &mut self,
        equations: &mut dyn Equations<X>,
        at: &(dyn Fn(usize) -> Vector2<f64> + Sync),
    ) {
        self.enter(Phase::Search);
        let RoleCounts { fluid, walls } = self.counts;
        self.neighbours.place(self.fixed.len(), at);
        self.neighbours.build(fluid, walls, self.extrapolates);
        self.progress.work.list_builds += 1;
        self.buffers.still = None;
        let columns = self.fixed.len() + self.neighbours.images.len();
        self.column_bytes = equations.make_room(columns + 1);
    }

    /// Derives the columns of the particles and the distances that they moved since the neighbour lists were
    /// built.
    fn fill(
        &mut self,
        equations: &mut dyn Equations<X>,
        state: &[State<X>],
    ) -> Result<BlockExtrema, InvalidState> {
        self.enter(Phase::Refresh);
        let RoleCounts { fluid, walls } = self.counts;
        let filled = if self.buffers.still.is_some() { fluid } else { state.len() };
        let count = filled.div_ceil(BLOCK);
        let mut extents = take(&mut self.buffers.extents);
        extents.resize(count + 1, BlockExtrema::NIL);
        extents[count] = self.buffers.still.unwrap_or(BlockExtrema::NIL);
        equations.derive(self, &state[..filled], &mut extents);
        // Columns of interface particles are filled here only: with interface particles, no column is left
        // out.
        if self.extrapolates && fluid + walls == state.len() && self.buffers.still.is_none() {
            let still = self.extent(&state[fluid..], &self.neighbours.built_at[fluid..]);
            self.buffers.still = Some(still);
        }
        let checked = self.check(state, &extents);
        self.buffers.extents = extents;
        checked
    }

    /// Refreshes images, and the states that wall particles extrapolate. `motion` is the share of the walls'
    /// own motion that images have.
    fn refresh_walls(&mut self, equations: &mut dyn Equations<X>, state: &[State<X>], motion: f64) {
        equations.fill_images(&self.neighbours, 0, motion);
        if self.extrapolates && self.counts.walls > 0 {
            self.extrapolate(equations, state, motion);
        }
        self.enter(Phase::Rest);
    }

    /// Gives the columns and images of wall particles the state extrapolated from the fluid.
    fn extrapolate(&mut self, equations: &mut dyn Equations<X>, state: &[State<X>], motion: f64) {
        let walls = self.neighbours.wall_lists.of.clone();
        let own = &state[walls.clone()];
        let mut implied = take(&mut self.buffers.states);
        parallel::copy(own, &mut implied, self.neighbours.parallel);
        // Sums are formed at the foot of each wall particle; its column is derived again below.
        let feet = &self.neighbours.feet;
        parallel::for_each_pair(&mut implied, feet, self.neighbours.parallel, &|wall, foot| {
            wall.position += foot;
        });
        // Sums read the wall particles' own state, and columns hold the state that was extrapolated last.
        equations.derive_walls(self, &implied);
        self.enter(Phase::Walls);
        equations.extrapolate(self, &mut |sweep| {
            sweep::run(sweep, &self.neighbours.wall_lists, &mut implied, &|k, implied, states| {
                let own = &own[k - walls.start..];
                for ((wall, state), own) in implied.iter_mut().zip(states).zip(own) {
                    wall.position = own.position;
                    wall.velocity += state.velocity;
                    wall.density = state.density;
                }
            });
        });
        self.enter(Phase::Refresh);
        equations.derive_walls(self, &implied);
        self.buffers.states = implied;
        equations.fill_images(&self.neighbours, self.counts.fluid, motion);
    }

    /// Updates fluid particles by this sweep, and wall particles by the sweep over their own terms, if the
    /// phase is more than a sum of forces.
    fn sweep(
        &mut self,
        phase: Phase,
        sweep: &dyn PairSweep<Rate<X>>,
        equations: &dyn Equations<X>,
        targets: &mut [State<X>],
        update: &BlockUpdate<X>,
    ) {
        self.count(phase);
        sweep::run(sweep, &self.neighbours.lists, targets, update);
        if phase != Phase::Forces && self.counts.walls > 0 {
            let walls = &mut targets[self.counts.fluid..];
            equations.sweep_walls(&mut |sweep| {
                self.enter(Phase::Walls);
                sweep::run(sweep, &self.neighbours.wall_lists, walls, update);
            });
        }
        self.enter(Phase::Rest);
    }

    /// The role and the extra fields of a particle, in the fluid without any of images.
    fn own(&self, k: usize) -> (Role, X) {
        let extra = self.state.get(k).map_or(X::default(), |evolved| evolved.extra);
        (self.fixed.get(k).map_or(Role::Fluid, |fixed| fixed.role), extra)
    }
}

/// Terms and columns of a scene, with their types.
pub(crate) struct TypedEquations<P: Physics> {
    pub kernel: Smoothing<P::Kernel>,
    /// Forces and drift.
    pub terms: (P::Forces, P::Drift),
    wall_terms: <P::Walls as Walls<P::Extra>>::Terms,
    extrapolation: ExtrapolationOf<P>,
    /// Columns of the particles, then of their images, then the sentinel.
    pub columns: Vec<SweptParticle<Derived<P>>>,
    /// Inverses of moments: empty where no force needs them.
    inverses: Vec<Symmetric>,
    /// Divergences of the velocity \[1/s\]: empty where no force needs them.
    divergences: Vec<f64>,
}

type ExtrapolationOf<P> = <<P as Physics>::Walls as Walls<<P as Physics>::Extra>>::Extrapolation;

impl<P: Physics> TypedEquations<P> {
    /// The pair sweep of these terms, whose derived data of a column `read` selects. `moving`: dx/dt includes
    /// v.
    fn sweep<T: Term<P::Extra>>(
        &self,
        terms: &T,
        read: impl Fn(&Derived<P>) -> T::Derived + Sync,
        moving: bool,
    ) -> impl PairSweep<Rate<P::Extra>> {
        let Self { kernel, columns, .. } = self;
        Sweep { kernel, columns, sum: Rates { terms, read, moving } }
    }

    fn forces(&self, moving: bool) -> impl PairSweep<Rate<P::Extra>> {
        self.sweep(&self.terms.0, first, moving)
    }

    fn drift(&self, moving: bool) -> impl PairSweep<Rate<P::Extra>> {
        self.sweep(&self.terms.1, second, moving)
    }

    fn all(&self, moving: bool) -> impl PairSweep<Rate<P::Extra>> {
        self.sweep(&self.terms, whole, moving)
    }
}

// Functions in place of closures, which in generic code have a type for each scheme: the sweep would be
// compiled for each.

fn first<A: Copy, B>(derived: &(A, B)) -> A {
    derived.0
}

fn second<A, B: Copy>(derived: &(A, B)) -> B {
    derived.1
}

fn whole<S: Copy>(derived: &S) -> S {
    *derived
}

fn nothing<S, D: Default>(_: &S) -> D {
    D::default()
}

impl<X: Numbers, P: Physics<Extra = X>> Equations<X> for TypedEquations<P> {
    fn prepare(&mut self, speed: f64) {
        self.terms.prepare(speed);
    }

    fn make_room(&mut self, count: usize) -> usize {
        self.columns.resize(count, SweptParticle::sentinel());
        self.columns[count - 1] = SweptParticle::sentinel();
        size_of_val(&self.columns[..])
    }

    fn derive(&mut self, of: &ParticleData<X>, state: &[State<X>], extents: &mut [BlockExtrema]) {
        let terms = &self.terms;
        derive_blocks(&mut self.columns, of, state, extents, &|columns, state, fixed| {
            derive_all(terms, fixed, state, columns);
        });
    }

    fn fill_images(&mut self, neighbours: &Neighbours, first: usize, motion: f64) {
        fill_images::<P, (P::Forces, P::Drift)>(neighbours, first, motion, &mut self.columns);
    }

    fn derive_walls(&mut self, of: &ParticleData<X>, walls: &[State<X>]) {
        let (at, terms) = (of.neighbours.wall_lists.of.clone(), &self.terms);
        let fixed = &of.fixed[at.clone()];
        let columns = &mut self.columns[at];
        parallel::for_each_part(columns, of.neighbours.parallel, &|first, columns| {
            derive_all(terms, &fixed[first..], &walls[first..], columns);
        });
    }

    fn sweep_walls(&self, run: &mut dyn FnMut(&dyn PairSweep<Rate<X>>)) {
        if !<P::Walls as Walls<X>>::Terms::IS_EMPTY {
            run(&self.sweep(&self.wall_terms, nothing, false));
        }
    }

    fn extrapolate(&self, of: &ParticleData<X>, run: &mut dyn FnMut(&dyn PairSweep<WallState>)) {
        if !ExtrapolationOf::<P>::IS_EMPTY {
            let Self { kernel, columns, extrapolation: by, .. } = self;
            let (first, feet) = (of.counts.fluid, &of.neighbours.feet[..]);
            run(&Sweep { kernel, columns, sum: Extrapolated { by, feet, first } });
        }
    }
}

/// Terms and particles of a scene.
pub struct Engine<P: Physics> {
    pub(crate) equations: TypedEquations<P>,
    /// In a box, because code compiled for each scheme moves it.
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
        const {
            let is_mirror =
                ExtrapolationOf::<P>::IS_EMPTY && <P::Walls as Walls<P::Extra>>::Terms::IS_EMPTY;
            let slips = P::Forces::SLIPS || P::Drift::SLIPS;
            assert!(is_mirror || !slips, "fluid slips along mirror particles alone");
        };
        let mut equations = TypedEquations {
            kernel: Smoothing::new(h),
            terms,
            wall_terms: walls.terms(),
            extrapolation: walls.extrapolation(),
            columns: vec![],
            inverses: vec![],
            divergences: vec![],
        };
        data.slips = P::Walls::SLIPS;
        data.extrapolates = !ExtrapolationOf::<P>::IS_EMPTY;
        let state = take(&mut data.state);
        data.build_lists(&mut equations, &|k| state[k].position);
        data.state = state;
        Self { equations, data }
    }

    /// Goes back or on to a checkpoint.
    pub(crate) fn restore(&mut self, from: &Checkpoint<P::Extra>) -> Result<(), &'static str> {
        let Self { equations, data } = self;
        data.replace(from)?;
        data.build_lists(equations, &|k| from.built_at[k]);
        data.progress = from.progress;
        Ok(())
    }

    /// Starts a step at this state: may sort the particles, wrap them into the period and put them back
    /// before a wall along which they slip; gives the terms the largest speed; refreshes all data derived
    /// from the state.
    pub fn begin(&mut self, state: &mut Particles<P>) -> Stepped {
        self.begin_with(state, &mut [])
    }

    /// Starts a step as [`Engine::begin`] does, and sorts earlier steps along with the first particles; there
    /// may be none.
    pub fn begin_with(
        &mut self,
        state: &mut Particles<P>,
        past: &mut [PreviousStep<P::Extra>],
    ) -> Stepped {
        self.data.begin(&mut self.equations, state, past)
    }

    /// Refreshes all data derived from a state inside a step.
    pub fn refresh(&mut self, state: &Particles<P>) -> Stepped {
        self.data.refresh(&mut self.equations, state)
    }

    /// Refreshes everything for a state inside a step whose velocities are differences of two velocities,
    /// 0 for wall particles: walls are at rest, and images have the differences that follow.
    pub fn refresh_differences(&mut self, state: &Particles<P>) -> Stepped {
        self.data.fill(&mut self.equations, state)?;
        self.data.refresh_walls(&mut self.equations, state, 0.0);
        Ok(())
    }

    /// Sums the forces: `update` with dv/dt, for fluid particles.
    pub fn sweep_forces(&mut self, targets: &mut Particles<P>, update: &BlockUpdate<P::Extra>) {
        self.sum_before_forces();
        let sweep = self.equations.forces(true);
        self.data.sweep(Phase::Forces, &sweep, &self.equations, targets, update);
    }

    /// Sums a part of the forces, whose derived data of a column `read` selects: `update` with dv/dt, for
    /// fluid particles.
    pub fn sweep_part<T: Term<P::Extra>>(
        &mut self,
        targets: &mut Particles<P>,
        part: &T,
        read: impl Fn(&Derived<P>) -> T::Derived + Sync,
        update: &BlockUpdate<P::Extra>,
    ) {
        let sweep = self.equations.sweep(part, read, true);
        self.data.sweep(Phase::Forces, &sweep, &self.equations, targets, update);
    }

    /// Sums the drift: `update` with dx/dt, dρ/dt and the terms' own rates.
    pub fn sweep_drift(&mut self, targets: &mut Particles<P>, update: &BlockUpdate<P::Extra>) {
        let sweep = self.equations.drift(true);
        self.data.sweep(Phase::Drift, &sweep, &self.equations, targets, update);
    }

    /// Sums forces and drift in one pair sweep: `update` with the whole rate.
    pub fn sweep_all(&mut self, targets: &mut Particles<P>, update: &BlockUpdate<P::Extra>) {
        self.sum_before_forces();
        let sweep = self.equations.all(true);
        self.data.sweep(Phase::Both, &sweep, &self.equations, targets, update);
    }

    /// Rates of fluid particles by the given terms alone, which need not belong to the scene, for the state
    /// of the last refresh. dx/dt excludes v.
    pub(crate) fn rates<T: Term<P::Extra>>(&self, terms: &T) -> Vec<Rate<P::Extra>> {
        let (kernel, neighbours) = (&self.equations.kernel, &self.data.neighbours);
        let mut columns = vec![SweptParticle::sentinel(); self.equations.columns.len()];
        for (k, column) in columns.iter_mut().enumerate() {
            let SweptParticle { position, velocity, common, .. } = self.equations.columns[k];
            let (role, extra) = self.data.own(k);
            let derived = derived(terms, role, &common, &extra);
            *column = SweptParticle { position, velocity, common, derived };
        }
        fill_images::<P, T>(neighbours, 0, 1.0, &mut columns);
        if T::NORMALISES {
            normalise::<P, T>(kernel, neighbours, &mut columns, &mut Vec::new());
        }
        if T::DIVERGES {
            diverge::<P, T>(kernel, neighbours, &mut columns, &mut Vec::new());
        }
        let sum = Rates { terms, read: whole, moving: false };
        let sweep = Sweep { kernel, columns: &columns, sum };
        sweep::rates(&sweep, &neighbours.lists)
    }

    /// Rates of fluid particles by all terms from one pair sweep, for the state of the last refresh. dx/dt
    /// excludes v.
    pub fn rates_in_one_sweep(&self) -> Vec<Rate<P::Extra>> {
        sweep::rates(&self.equations.all(false), &self.data.neighbours.lists)
    }

    /// Rates of fluid particles by all terms: dv/dt from a sweep over the forces, the other rates from a
    /// sweep over the drift. dx/dt excludes v.
    pub fn rates_in_two_sweeps(&self) -> Vec<Rate<P::Extra>> {
        let Self { equations, data } = self;
        together(&equations.forces(false), &equations.drift(false), &data.neighbours.lists)
    }

    /// The rates of wall particles by their terms, for the state that the columns were refreshed for last.
    pub(crate) fn wall_rates(&self) -> Vec<Rate<P::Extra>> {
        let (mut rates, lists) = (Vec::new(), &self.data.neighbours.wall_lists);
        self.equations.sweep_walls(&mut |sweep| rates = sweep::rates(sweep, lists));
        rates
    }

    /// Number of particles with rates, which are the first ones of a state: fluid particles, and wall
    /// particles if the walls have terms.
    pub(crate) fn swept(&self) -> usize {
        let RoleCounts { fluid, walls } = self.data.counts;
        let is_empty = <P::Walls as Walls<P::Extra>>::Terms::IS_EMPTY;
        if is_empty { fluid } else { fluid + walls }
    }

    /// Whether the work on particles is distributed over threads.
    pub(crate) fn parallel(&self) -> bool {
        self.data.is_parallel()
    }

    /// Memory held \[bytes\].
    pub(crate) fn bytes(&self) -> usize {
        self.data.bytes()
            + self.equations.columns.capacity() * size_of::<SweptParticle<Derived<P>>>()
            + self.equations.inverses.capacity() * size_of::<Symmetric>()
            + self.equations.divergences.capacity() * size_of::<f64>()
    }

    /// Gives the forces the inverse moments and the divergences, if they use them.
    pub(crate) fn sum_before_forces(&mut self) {
        const {
            let is_sound = !P::Forces::NORMALISES || ExtrapolationOf::<P>::IS_EMPTY;
            assert!(is_sound, "moments of fluid alone");
        };
        const { assert!(!P::Drift::NORMALISES && !P::Drift::DIVERGES, "a drift forms its own sums") };
        let TypedEquations { kernel, columns, inverses, divergences, .. } = &mut self.equations;
        if P::Forces::NORMALISES {
            self.data.count(Phase::Forces);
            let neighbours = &self.data.neighbours;
            normalise::<P, (P::Forces, P::Drift)>(kernel, neighbours, columns, inverses);
        }
        if P::Forces::DIVERGES {
            self.data.count(Phase::Forces);
            let neighbours = &self.data.neighbours;
            diverge::<P, (P::Forces, P::Drift)>(kernel, neighbours, columns, divergences);
        }
    }
}

/// The rates of velocities by the forces, and the others by the drift.
fn together<X: Numbers>(
    forces: &dyn PairSweep<Rate<X>>,
    drift: &dyn PairSweep<Rate<X>>,
    lists: &Lists,
) -> Vec<Rate<X>> {
    let mut drift = sweep::rates(drift, lists);
    for (rate, forces) in drift.iter_mut().zip(sweep::rates(forces, lists)) {
        rate.velocity = forces.velocity;
    }
    drift
}

/// Sums the moments of all particles, and gives the columns and their images the inverses.
fn normalise<P: Physics, T: Term<P::Extra>>(
    kernel: &Smoothing<P::Kernel>,
    neighbours: &Neighbours,
    columns: &mut [SweptParticle<T::Derived>],
    inverses: &mut Vec<Symmetric>,
) {
    let sweep = Sweep { kernel, columns, sum: InverseMoments };
    let Neighbours { lists, wall_lists, .. } = neighbours;
    inverses.resize(lists.of.end.max(wall_lists.of.end), Symmetric::default());
    for lists in [lists, wall_lists] {
        sweep::fill(&sweep, lists, &mut inverses[lists.of.clone()]);
    }
    give::<P, T, _>(neighbours, columns, inverses, &|column, inverse| {
        T::set_inverse(&mut column.derived, *inverse);
    });
}

/// Sums the divergence of the velocity at each fluid particle, and gives it to the columns and their images.
fn diverge<P: Physics, T: Term<P::Extra>>(
    kernel: &Smoothing<P::Kernel>,
    neighbours: &Neighbours,
    columns: &mut [SweptParticle<T::Derived>],
    divergences: &mut Vec<f64>,
) {
    let sweep = Sweep { kernel, columns, sum: Divergence };
    divergences.resize(neighbours.lists.of.end, 0.0);
    sweep::fill(&sweep, &neighbours.lists, divergences);
    give::<P, T, _>(neighbours, columns, divergences, &|column, divergence| {
        T::set_divergence(&mut column.derived, &column.common, *divergence);
    });
}

/// Gives the first columns their sums, and refills all images.
fn give<P: Physics, T: Term<P::Extra>, S: Sync>(
    neighbours: &Neighbours,
    columns: &mut [SweptParticle<T::Derived>],
    sums: &[S],
    set: &(impl Fn(&mut SweptParticle<T::Derived>, &S) + Sync),
) {
    parallel::for_each_pair(columns, sums, neighbours.parallel, set);
    fill_images::<P, T>(neighbours, 0, 1.0, columns);
}

/// Writes the columns of the images whose sources are particle `first` or a later one. `motion` is the factor
/// of the walls' own velocity in images: 1, or 0 for differences of velocities.
fn fill_images<P: Physics, T: Term<P::Extra>>(
    neighbours: &Neighbours,
    first: usize,
    motion: f64,
    columns: &mut [SweptParticle<T::Derived>],
) {
    neighbours.fill_images(first, columns, &|map, source| {
        let mut image = map.apply(source, P::Walls::SLIPS, motion);
        if T::SLIPS && !map.walls().is_empty() {
            let slipping = map.velocity(source, true, motion);
            T::set_slip(&mut image.derived, slipping - image.velocity);
        }
        image
    });
}

/// Derives columns of particles.
type Derives<'a, X, D> = dyn Fn(&mut [SweptParticle<D>], &[State<X>], &[Constants]) + Sync + 'a;

/// [`Equations::derive`], block by block.
fn derive_blocks<X: Numbers, D: Numbers>(
    columns: &mut [SweptParticle<D>],
    of: &ParticleData<X>,
    state: &[State<X>],
    extents: &mut [BlockExtrema],
    derive: &Derives<X, D>,
) {
    let blocks = columns[..state.len()].chunks_mut(BLOCK).zip(extents).enumerate();
    parallel::for_each(blocks, of.neighbours.parallel, &|(b, (columns, extent))| {
        let particles = b * BLOCK..b * BLOCK + columns.len();
        let state = &state[particles.clone()];
        derive(columns, state, &of.fixed[particles.clone()]);
        *extent = of.extent(state, &of.neighbours.built_at[particles]);
    });
}

/// Writes the columns of particles.
fn derive_all<X, T: Term<X>>(
    terms: &T,
    fixed: &[Constants],
    state: &[State<X>],
    columns: &mut [SweptParticle<T::Derived>],
) {
    // A copy, so that no write can alias it: the compiler moves loop-invariant numbers out of the loop.
    let terms = &terms.clone();
    let (fixed, state) = (&fixed[..columns.len()], &state[..columns.len()]);
    for k in 0..columns.len() {
        derive(terms, &fixed[k], &state[k], &mut columns[k]);
    }
}

/// Writes the column of a particle field by field. A column built as a value is assembled on the stack and
/// loaded again directly after it was stored, which takes up to 40 ns a particle.
#[inline(always)]
fn derive<X, T: Term<X>>(
    terms: &T,
    fixed: &Constants,
    evolved: &State<X>,
    column: &mut SweptParticle<T::Derived>,
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
        T::set_on_boundary(&mut derived);
    }
    derived
}

/// Turns an update of one particle into an update of a block, so that a closure is called once a block.
pub fn each<X>(
    update: impl Fn(usize, &mut State<X>, &Rate<X>) + Sync,
) -> impl Fn(usize, &mut [State<X>], &[Rate<X>]) + Sync {
    move |first, targets, rates| {
        for (k, (target, rate)) in (first..).zip(targets.iter_mut().zip(rates)) {
            update(k, target, rate);
        }
    }
}
