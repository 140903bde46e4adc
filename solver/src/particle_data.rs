//! Particle data: the part of a simulation that does not depend on its equations. Sorting, neighbour lists,
//! bounds, counting and checkpoints are therefore compiled only once for each set of extra fields.

use std::mem::take;

use nalgebra::Vector2;

use crate::{
    neighbours::{BLOCK, GROUP, Lists, Neighbours},
    numbers::Numbers,
    parallel,
    particles::{Constants, Particle, Role, State},
    walls::Map,
};

/// Counts of the work done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Time steps.
    pub steps: u64,
    /// Neighbours that were inside the support when the lists were built, each pair sweep counted.
    pub pair_interactions: u64,
    /// Right-hand sides of moving particles.
    pub right_hand_sides: u64,
    /// Times that neighbour lists were built.
    pub list_builds: u64,
}

/// A part of a step. [`ParticleData::watch`] is called when one begins; the solver itself reads no clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The pair sweep over the forces.
    Forces,
    /// The pair sweep over the drift.
    Drift,
    /// One pair sweep over forces and drift together.
    Both,
    /// The pair sweep over the terms of the walls.
    Walls,
    /// Deriving columns of particles and images from a state.
    Refresh,
    /// Making images and neighbour lists.
    Search,
    /// Putting particles in the order of storage, along strips.
    Sorting,
    /// The integrator's own work between calls of the engine.
    Rest,
}

/// Called at the start of each phase, which also ends the previous one.
pub type PhaseWatch = Box<dyn Fn(Phase) + Send + Sync>;

/// A state that no simulation may reach, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidState {
    /// Number of the particle, in the order of the scene.
    pub particle: u32,
    /// The quantity.
    pub field: &'static str,
    /// Its value; of a vector, the length.
    pub value: f64,
}

/// Whether a step stayed within the bounds of its scene.
pub type Stepped = Result<(), InvalidState>;

/// Bounds that a run must not leave; a run that does has diverged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DivergenceBounds {
    /// Least and largest density \[kg/m³\].
    pub density: [f64; 2],
    /// Largest speed \[m/s\].
    pub speed: f64,
}

impl Default for DivergenceBounds {
    /// Any positive density, any finite speed.
    fn default() -> Self {
        Self { density: [0.0, f64::MAX], speed: f64::MAX }
    }
}

/// A call of [`crate::Stepper::advance`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// Its start \[s\].
    pub start: f64,
    /// Its end \[s\].
    pub until: f64,
    /// Largest step \[s\].
    pub dt_max: f64,
}

/// How far a run is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Simulated time \[s\].
    pub time: f64,
    /// Length of the last step \[s\].
    pub dt: f64,
    /// The work done so far.
    pub work: Work,
    /// Half of the largest approach of two particles since the neighbour lists were built, at the start of
    /// the last step \[m\].
    pub last_approach: f64,
    /// Whether the lists were built inside a step, for particles neither sorted nor wrapped.
    pub built_inside_a_step: bool,
    /// The present call of [`crate::Stepper::advance`]; zeros after its end.
    pub call: Interval,
    /// Steps that this call has made.
    pub made: u64,
}

/// Density \[kg/m³\] and extra fields of a particle in earlier steps, as an integrator keeps them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreviousStep<X> {
    /// Their values by the rates of all steps but the present one.
    pub drifted: (f64, X),
    /// Their rates in the step before, in these units per second.
    pub rate: (f64, X),
}

/// The complete state of a run as data: [`crate::Stepper::restore`] continues from it with the bits of an
/// uninterrupted run.
///
/// Sums are added in the order of the neighbour lists, so the checkpoint includes the order of storage and
/// the positions at which the lists were built.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint<X = ()> {
    /// Time, work and the age of the neighbour lists.
    pub progress: Progress,
    /// Lag of the velocities behind the other quantities \[s\]; 0 before the first step, and for integrators
    /// with all quantities at one time.
    pub lag: f64,
    /// Particles in the order of storage, with their numbers in the scene.
    pub particles: Vec<(u32, Particle<X>)>,
    /// Position of each particle when the neighbour lists were built \[m\].
    pub built_at: Vec<Vector2<f64>>,
    /// Earlier steps of the first particles; empty for most integrators.
    pub past: Vec<PreviousStep<X>>,
}

impl<X: Numbers> Checkpoint<X> {
    /// Checks that the checkpoint belongs to an integrator with the memory of `of`; else returns the reason.
    pub(crate) fn check_memory(&self, of: &Self) -> Result<(), &'static str> {
        let is_whole = (self.lag, self.past.len()) == (of.lag, of.past.len());
        if is_whole { Ok(()) } else { Err("memory of another integrator") }
    }

    /// Checks that a simulation can have stored this checkpoint; else returns the reason.
    pub(crate) fn check(&self) -> Result<(), &'static str> {
        let Self { progress, lag, particles, built_at, past } = self;
        let ids: std::collections::BTreeSet<u32> = particles.iter().map(|(id, _)| *id).collect();
        let sum = built_at.iter().fold(progress.time + lag, |sum, p| sum + p.x + p.y);
        let moving = particles.iter().filter(|(_, p)| p.role == Role::Fluid).count();
        let is_past = |past: &PreviousStep<X>| past.drifted.is_finite() && past.rate.is_finite();
        let has_past = past.is_empty() || (moving..=particles.len()).contains(&past.len());
        let Interval { start, until, .. } = progress.call;
        let is_under_way = (0.0..=progress.time).contains(&start) && progress.time <= until;
        let Work { steps, pair_interactions, right_hand_sides, list_builds } = progress.work;
        let counts = [steps, pair_interactions, right_hand_sides, list_builds, progress.made];
        let all = [
            (is_under_way || progress.call == Interval::default(), "a time outside its interval"),
            (counts.into_iter().all(|count| count < 1 << 60), "a count that no run reaches"),
            (has_past && past.iter().all(is_past), "earlier steps of other particles"),
            (sum.is_finite(), "a time, a lag or a place that is not finite"),
            (built_at.len() == particles.len(), "another number of places than of particles"),
            (particles.iter().all(|(_, p)| p.density > 0.0 && p.mass > 0.0), "no density or mass"),
            (particles.is_sorted_by_key(|(_, p)| p.role), "particles not sorted by their roles"),
            (ids.into_iter().eq(0..particles.len() as u32), "numbers of another scene"),
        ];
        all.into_iter().find(|(is_met, _)| !is_met).map_or(Ok(()), |(_, wrong)| Err(wrong))
    }
}

/// Numbers of particles, which are stored in this order; interface particles follow them.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RoleCounts {
    pub fluid: usize,
    pub walls: usize,
}

/// Extremes over the particles of a block: of the displacement since lists were built, and of the speed.
#[derive(Clone, Copy)]
pub(crate) struct BlockExtrema {
    /// Largest square of the displacement \[m²\].
    displacement2: f64,
    /// Largest square of the speed \[m²/s²\].
    speed2: f64,
    /// Corners of the bounding box of all displacements and 0 \[m\].
    low: Vector2<f64>,
    high: Vector2<f64>,
    within_limits: bool,
}

impl BlockExtrema {
    pub const NIL: Self = Self {
        displacement2: 0.0,
        speed2: 0.0,
        low: Vector2::new(0.0, 0.0),
        high: Vector2::new(0.0, 0.0),
        within_limits: true,
    };

    /// The extremes of both. Exact, so the order does not matter. NaN counts as beyond the limits.
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        let larger = |one: f64, two: f64| if two > one { two } else { one };
        let smaller = |one: f64, two: f64| if two < one { two } else { one };
        Self {
            displacement2: larger(self.displacement2, other.displacement2),
            speed2: larger(self.speed2, other.speed2),
            low: self.low.zip_map(&other.low, smaller),
            high: self.high.zip_map(&other.high, larger),
            within_limits: self.within_limits & other.within_limits,
        }
    }

    /// Largest speed \[m/s\].
    pub fn speed(&self) -> f64 {
        self.speed2.sqrt()
    }
}

/// Buffers with which pair sweeps are prepared.
#[derive(Default)]
pub(crate) struct SweepBuffers<X> {
    /// Extremes of each block of particles whose columns were filled, then of the particles whose columns
    /// were kept.
    pub extents: Vec<BlockExtrema>,
    /// Extremes of wall particles that extrapolate and do not move: their columns are filled once after each
    /// build of lists.
    pub still: Option<BlockExtrema>,
    /// Order into which particles are sorted: the former place of each fluid particle.
    pub order: Vec<u32>,
    /// Copies of particles: while these are sorted, and wall particles while their velocities and densities
    /// are extrapolated.
    pub states: Vec<State<X>>,
    /// Copies while particles are sorted.
    pub fixed: Vec<Constants>,
    /// Copies while particles are sorted.
    pub past: Vec<PreviousStep<X>>,
}

/// The particles of a simulation, their neighbour lists, the time, and the work done.
#[derive(Default)]
pub struct ParticleData<X = ()> {
    /// Empty during a step, which owns the state.
    pub(crate) state: Vec<State<X>>,
    pub(crate) fixed: Vec<Constants>,
    pub(crate) counts: RoleCounts,
    /// [`crate::Walls::SLIPS`].
    pub(crate) slips: bool,
    /// Whether [`crate::Walls::Extrapolation`] is not `()`.
    pub(crate) extrapolates: bool,
    pub(crate) neighbours: Neighbours,
    pub(crate) limits: DivergenceBounds,
    /// Half of the largest approach of two particles with exact neighbour lists \[m\].
    pub(crate) slack: f64,
    /// (displacement beyond which the step, not the flow, moved a particle)² \[m²\]: half a period,
    /// since images are one period away, on either side.
    pub(crate) reach2: f64,
    pub(crate) progress: Progress,
    pub(crate) buffers: SweepBuffers<X>,
    /// Memory of the columns that a pair sweep reads \[bytes\].
    pub column_bytes: usize,
    /// Called at the start of each phase.
    pub watch: Option<PhaseWatch>,
}

impl<X: Numbers> ParticleData<X> {
    /// Replaces the particles by these, with their numbers in the scene, in this order of storage.
    pub(crate) fn put(&mut self, particles: &[(u32, Particle<X>)]) {
        let count = |role| particles.iter().filter(|(_, p)| p.role == role).count();
        let evolved = |(_, p): &(u32, Particle<X>)| {
            let Particle { position, velocity, density, extra, .. } = *p;
            State { position, velocity, density, extra }
        };
        let fixed =
            |(id, p): &(u32, Particle<X>)| Constants { mass: p.mass, id: *id, role: p.role };
        self.state = particles.iter().map(evolved).collect();
        self.fixed = particles.iter().map(fixed).collect();
        self.counts = RoleCounts { fluid: count(Role::Fluid), walls: count(Role::Wall) };
    }

    /// Whether the work on particles is distributed over threads.
    pub fn is_parallel(&self) -> bool {
        self.neighbours.parallel
    }

    /// Number of fluid particles.
    pub fn fluid_count(&self) -> usize {
        self.counts.fluid
    }

    /// Mass \[kg/m\] and state of the fluid particles in the order of storage, for observers that sum.
    pub fn fluid(&self) -> impl ExactSizeIterator<Item = (f64, &State<X>)> + Clone {
        let fluid = self.counts.fluid;
        self.fixed[..fluid].iter().map(|f| f.mass).zip(&self.state[..fluid])
    }

    /// The particle at a place of storage.
    pub fn at(&self, place: usize) -> Particle<X> {
        let Constants { mass, role, .. } = self.fixed[place];
        let State { position, velocity, density, extra } = self.state[place];
        Particle { role, position, velocity, density, mass, extra }
    }

    /// The place of storage of each particle, in the order of the scene; places of fluid particles are the
    /// first ones.
    pub fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.fixed.len()];
        for (place, fixed) in (0..).zip(&self.fixed) {
            places[fixed.id as usize] = place;
        }
        places
    }

    /// Mass \[kg/m\] and state of the wall particles with an evolving density, in the order of storage.
    pub fn walls(&self) -> impl ExactSizeIterator<Item = (f64, &State<X>)> {
        let range = self.neighbours.wall_lists.of.clone();
        self.fixed[range.clone()].iter().map(|f| f.mass).zip(&self.state[range])
    }

    /// For each fluid particle, in the order of storage, the possible neighbours without itself, as indices
    /// into [`crate::Stepper::plain_columns`].
    pub fn lists(&self) -> impl Iterator<Item = impl Iterator<Item = usize>> {
        let Lists { of, blocks, .. } = &self.neighbours.lists;
        of.clone().map(|k| {
            let list = blocks[k / BLOCK].list(k % BLOCK / GROUP).iter();
            list.map(|&column| column as usize).filter(move |&column| column != k)
        })
    }

    /// All particles in the order of the scene.
    pub fn particles(&self) -> Vec<Particle<X>> {
        self.places().into_iter().map(|place| self.at(place as usize)).collect()
    }

    /// All particles in the order of storage, with their numbers in the scene.
    pub fn stored(&self) -> impl Iterator<Item = (u32, Particle<X>)> {
        self.fixed.iter().enumerate().map(|(place, fixed)| (fixed.id, self.at(place)))
    }

    /// The states of all particles in the order of storage.
    pub fn state(&self) -> &[State<X>] {
        &self.state
    }

    /// The moving particles in the order of storage.
    pub fn fluid_state(&self) -> &[State<X>] {
        &self.state[..self.counts.fluid]
    }

    /// The moving particles, to be advanced.
    pub fn fluid_mut(&mut self) -> &mut [State<X>] {
        &mut self.state[..self.counts.fluid]
    }

    /// The images in the order of their columns: the earlier column that each copies, and the map.
    pub fn images(&self) -> impl ExactSizeIterator<Item = (usize, &Map)> {
        let Neighbours { images, maps, .. } = &self.neighbours;
        images.iter().map(|image| (image.source as usize, &maps[image.map as usize]))
    }

    /// Takes the particles of a checkpoint. Neighbour lists must be built afterwards. An error is the reason;
    /// nothing has changed then.
    pub(crate) fn replace(&mut self, from: &Checkpoint<X>) -> Result<(), &'static str> {
        from.check()?;
        let mut own = vec![None; self.fixed.len()];
        self.fixed.iter().for_each(|f| own[f.id as usize] = Some((f.mass, f.role)));
        let is_own =
            |(id, p): &(u32, Particle<X>)| own.get(*id as usize) == Some(&Some((p.mass, p.role)));
        if own.len() != from.particles.len() || !from.particles.iter().all(is_own) {
            return Err("particles of another scene");
        }
        self.put(&from.particles);
        Ok(())
    }

    /// Goes to a checkpoint of this scene that has the present neighbour lists. An error is the reason;
    /// nothing has changed then.
    pub fn resume(&mut self, from: &Checkpoint<X>) -> Result<(), &'static str> {
        from.check()?;
        let ids = from.particles.iter().map(|(id, _)| *id);
        if from.built_at != self.neighbours.built_at || !ids.eq(self.fixed.iter().map(|f| f.id)) {
            return Err("particles of another reference");
        }
        from.check_memory(&self.without_memory())?;
        self.put(&from.particles);
        self.progress = from.progress;
        Ok(())
    }

    /// Looks for a particle that is out of bounds.
    pub fn check_bounds(&mut self) -> Result<(), InvalidState> {
        let mut extents = take(&mut self.buffers.extents);
        extents.resize(self.state.len().div_ceil(BLOCK), BlockExtrema::NIL);
        let blocks = self.state.chunks(BLOCK).zip(self.neighbours.built_at.chunks(BLOCK));
        let blocks = blocks.zip(&mut extents);
        parallel::for_each(blocks, self.is_parallel(), &|((state, built_at), extent)| {
            *extent = self.extent(state, built_at);
        });
        let checked = self.check(&self.state, &extents);
        self.buffers.extents = extents;
        checked.map(|_| ())
    }

    /// Everything on which later steps of an integrator without memory depend.
    pub fn without_memory(&self) -> Checkpoint<X> {
        let (progress, built_at) = (self.progress, self.neighbours.built_at.to_vec());
        Checkpoint {
            progress,
            lag: 0.0,
            particles: self.stored().collect(),
            built_at,
            past: vec![],
        }
    }

    /// Memory held \[bytes\].
    pub fn bytes(&self) -> usize {
        self.state.capacity() * size_of::<State<X>>()
            + self.fixed.capacity() * size_of::<Constants>()
            + self.buffers.order.capacity() * size_of::<u32>()
            + self.buffers.extents.capacity() * size_of::<BlockExtrema>()
            + self.buffers.states.capacity() * size_of::<State<X>>()
            + self.buffers.fixed.capacity() * size_of::<Constants>()
            + self.buffers.past.capacity() * size_of::<PreviousStep<X>>()
            + self.neighbours.bytes()
    }

    /// Sorts fluid particles along strips and wraps them into the period, and sorts earlier steps along with
    /// the particles, if there are any.
    pub(crate) fn sort(&mut self, state: &mut [State<X>], past: &mut [PreviousStep<X>]) {
        self.enter(Phase::Sorting);
        let Self { neighbours, fixed, buffers, .. } = self;
        let (parallel, domain) = (neighbours.parallel, neighbours.domain);
        parallel::for_each_part(state, parallel, &|_, part| {
            for evolved in part {
                evolved.position = domain.wrap(evolved.position);
            }
        });
        neighbours.place(self.counts.fluid, &|k| state[k].position);
        let SweepBuffers { order, states, fixed: former, past: earlier, .. } = buffers;
        neighbours.order(order);
        gather(state, order, states, parallel);
        gather(fixed, order, former, parallel);
        gather(past, order, earlier, parallel);
    }

    /// Begins a phase.
    pub fn enter(&self, phase: Phase) {
        if let Some(watch) = &self.watch {
            watch(phase);
        }
    }

    /// Counts a pair sweep that begins, of forces alone or one that completes a right-hand side.
    pub fn count(&mut self, phase: Phase) {
        self.count_pairs(phase, self.neighbours.pairs());
    }

    /// Counts pair sweeps over this total number of neighbours, which need not be the number in the lists.
    pub fn count_pairs(&mut self, phase: Phase, neighbours: u64) {
        self.enter(phase);
        self.progress.work.pair_interactions += neighbours;
        if phase != Phase::Forces {
            self.progress.work.right_hand_sides += self.counts.fluid as u64;
        }
    }

    /// The extremes of a part of a state that was built at these places.
    pub(crate) fn extent(&self, state: &[State<X>], built_at: &[Vector2<f64>]) -> BlockExtrema {
        let mut extent = BlockExtrema::NIL;
        for (evolved, built_at) in state.iter().zip(built_at) {
            let moved = evolved.position - built_at;
            let (low, high, displacement2) = (moved, moved, moved.norm_squared());
            let speed2 = evolved.velocity.norm_squared();
            let excess = self.excess(evolved, displacement2);
            let within_limits = excess.is_none() && evolved.extra.is_finite();
            extent = extent.and(BlockExtrema { displacement2, speed2, low, high, within_limits });
        }
        extent
    }

    /// Combines the extremes of all parts of a state; an error is the first invalid particle.
    pub(crate) fn check(
        &self,
        state: &[State<X>],
        of: &[BlockExtrema],
    ) -> Result<BlockExtrema, InvalidState> {
        let extent = of.iter().copied().fold(BlockExtrema::NIL, BlockExtrema::and);
        if extent.within_limits { Ok(extent) } else { Err(self.find_fault(state)) }
    }

    /// Half of the largest approach of two particles, or of their images, since the lists were built \[m\].
    /// The bound is half the diagonal of the bounding box of all displacements and 0, because a period moves
    /// all images alike, and at most the largest displacement, which a mirror may turn.
    fn approach(&self, extent: BlockExtrema) -> f64 {
        let diagonal = (extent.high - extent.low).norm();
        let has_mirrors = self.neighbours.maps.iter().any(|map| !map.walls().is_empty());
        extent.displacement2.sqrt().min(if has_mirrors { f64::MAX } else { 0.5 * diagonal })
    }

    /// Whether neighbour lists are not exact any more.
    pub(crate) fn is_stale(&self, extent: BlockExtrema) -> bool {
        // Negated, so that a slack of NaN means "always".
        !(self.approach(extent) <= self.slack)
    }

    /// Whether neighbour lists will be stale after another step like the last one: it is cheaper to build
    /// them now than inside the step and again after it.
    pub(crate) fn is_stale_soon(&mut self, extent: BlockExtrema) -> bool {
        let approach = self.approach(extent);
        let ahead = approach + (approach - self.progress.last_approach).max(0.0);
        let stale = !(ahead <= self.slack);
        self.progress.last_approach = if stale { 0.0 } else { approach };
        stale
    }

    /// The first particle, in the order of the scene, that is out of bounds.
    fn find_fault(&self, state: &[State<X>]) -> InvalidState {
        let fault = |((evolved, fixed), built_at): ((&State<X>, &Constants), &Vector2<f64>)| {
            let displacement2 = (evolved.position - built_at).norm_squared();
            let (field, value) = evolved.fault().or_else(|| self.excess(evolved, displacement2))?;
            Some(InvalidState { particle: fixed.id, field, value })
        };
        let particles = state.iter().zip(&self.fixed).zip(&self.neighbours.built_at);
        let first = particles.filter_map(fault).min_by_key(|f| f.particle);
        first.expect("a state that is out of bounds has a particle that is")
    }

    /// The first field beyond its limit. A NaN fails every comparison.
    #[inline(always)]
    fn excess(&self, evolved: &State<X>, displacement2: f64) -> Option<(&'static str, f64)> {
        let ([least, most], speed2) = (self.limits.density, evolved.velocity.norm_squared());
        // The square of the limit may be infinite.
        let limit2 = self.limits.speed * self.limits.speed;
        match evolved.density {
            _ if !(displacement2 <= self.reach2) => Some(("position", evolved.position.norm())),
            _ if !(speed2 <= limit2 && speed2.is_finite()) => Some(("velocity", speed2.sqrt())),
            density if !(density > least && density < most) => Some(("density", density)),
            _ => None,
        }
    }
}

/// Puts the first entries of a list in an order: entry k becomes the former entry `order[k]`. An empty list
/// stays empty.
fn gather<T: Copy + Send + Sync>(of: &mut [T], order: &[u32], former: &mut Vec<T>, parallel: bool) {
    let count = order.len().min(of.len());
    parallel::copy(&of[..count], former, parallel);
    parallel::for_each_pair(of, &order[..count], parallel, &|entry, from| {
        *entry = former[*from as usize];
    });
}
