//! The right-hand side of a scene, as integrators see it: look at a state, then sweep.

use nalgebra::Vector2;

use crate::{
    domain::Domain,
    kernel::Smoothing,
    neighbours::{BLOCK, Neighbours},
    numbers::Numbers,
    parallel,
    particles::{Column, Common, Evolved, Fixed, Rate},
    scene::Scheme,
    simulation::Work,
    sweep::{Sweep, Update},
    terms::Term,
    walls::Walls,
};

/// What a particle shows in the scheme `S`: to the forces, and to the drift.
pub type Shows<S> = (
    <<S as Scheme>::Forces as Term<<S as Scheme>::Extra>>::Shows,
    <<S as Scheme>::Drift as Term<<S as Scheme>::Extra>>::Shows,
);

/// What the integrator advances, particle by particle.
pub type State<S> = [Evolved<<S as Scheme>::Extra>];

/// A sweep over the columns of the scheme `S`.
type Rows<'a, S, T, P> = Sweep<'a, <S as Scheme>::Kernel, T, Shows<S>, P>;

/// A state that no simulation may reach, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Number of the particle, in the order of the scene.
    pub particle: u32,
    /// The quantity.
    pub field: &'static str,
    /// Its value, of a vector the length.
    pub value: f64,
}

/// Bounds that a run must not leave; a run that does has diverged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Least and largest density \[kg/m³\].
    pub density: [f64; 2],
    /// Largest speed \[m/s\].
    pub speed: f64,
}

impl Default for Limits {
    /// Any positive density, any finite speed.
    fn default() -> Self {
        Self { density: [0.0, f64::MAX], speed: f64::MAX }
    }
}

/// Terms, particles and neighbours of a scene.
pub struct Engine<S: Scheme> {
    pub(crate) kernel: Smoothing<S::Kernel>,
    pub(crate) domain: Domain,
    pub(crate) forces: S::Forces,
    pub(crate) drift: S::Drift,
    pub(crate) walls: S::Walls,
    pub(crate) limits: Limits,
    /// Fluid and wall particles; interface particles follow them.
    pub(crate) counts: [usize; 2],
    pub(crate) fixed: Vec<Fixed>,
    pub(crate) columns: Vec<Column<Shows<S>>>,
    pub(crate) neighbours: Neighbours,
    /// Largest displacement at the start of the last step \[m\].
    pub(crate) last_displacement: f64,
    /// Whether rows were built for a state that was neither sorted nor wrapped.
    pub(crate) built_inside_a_step: bool,
    /// (largest displacement that keeps the rows exact)² \[m²\].
    pub(crate) slack2: f64,
    /// (displacement beyond which the step, not the flow, moved a particle)² \[m²\]: half a period,
    /// since images stand one period away, on either side.
    pub(crate) reach2: f64,
    pub(crate) parallel: bool,
    pub(crate) work: Work,
    pub(crate) order: Vec<u32>,
    /// What was found in each block while filling columns.
    pub(crate) extents: Vec<Extent>,
    /// What wall particles extrapolate: empty where they do not.
    pub(crate) extrapolated: Vec<Evolved<S::Extra>>,
}

/// Largest squares found while filling columns.
#[derive(Clone, Copy)]
pub(crate) struct Extent {
    displacement2: f64,
    speed2: f64,
    sound: bool,
}

impl Extent {
    const NIL: Self = Self { displacement2: 0.0, speed2: 0.0, sound: true };

    /// Exact, so it does not matter in which order.
    fn and(self, other: Self) -> Self {
        Self {
            displacement2: self.displacement2.max(other.displacement2),
            speed2: self.speed2.max(other.speed2),
            sound: self.sound && other.sound,
        }
    }
}

/// What turns particles into columns.
struct Fill<'a, S: Scheme> {
    forces: &'a S::Forces,
    drift: &'a S::Drift,
    limits: &'a Limits,
    reach2: f64,
}

impl<S: Scheme> Fill<'_, S> {
    /// The columns of a block, from the states that begin with it.
    fn chunk(
        &self,
        columns: &mut [Column<Shows<S>>],
        state: &State<S>,
        fixed: &[Fixed],
        built_at: &[Vector2<f64>],
    ) -> Extent {
        let [least, most] = self.limits.density;
        let speed_limit2 = self.limits.speed * self.limits.speed;
        let mut extent = Extent::NIL;
        for (((column, evolved), fixed), built_at) in
            columns.iter_mut().zip(state).zip(fixed).zip(built_at)
        {
            let Evolved { position, velocity, density, extra } = evolved;
            let (mass, density) = (fixed.mass, *density);
            let common = Common { mass, density, volume: mass / density };
            let shows = (self.forces.shows(&common, extra), self.drift.shows(&common, extra));
            *column = Column { position: *position, velocity: *velocity, common, shows };
            let moved2 = (position - built_at).norm_squared();
            let speed2 = velocity.norm_squared();
            // A NaN fails every comparison. The limit of the square may be infinite.
            let sound = density > least
                && density < most
                && moved2 <= self.reach2
                && speed2 <= speed_limit2
                && speed2.is_finite()
                && extra.is_finite();
            extent = extent.and(Extent { displacement2: moved2, speed2, sound });
        }
        extent
    }
}

impl<S: Scheme> Engine<S> {
    /// Starts a step at this state: particles may be put in another order, wrapped into the period,
    /// and the terms are told the largest speed.
    pub fn begin(&mut self, state: &mut State<S>) -> Result<(), Fault> {
        let mut extent = self.fill(state)?;
        if self.built_inside_a_step || self.stale_before_long(extent) {
            self.sort(state);
            self.build(state);
            self.built_inside_a_step = false;
            extent = self.fill(state)?;
        }
        if S::Forces::NEEDS_SPEED || S::Drift::NEEDS_SPEED {
            let speed = extent.speed2.sqrt();
            self.forces.prepare(speed);
            self.drift.prepare(speed);
        }
        self.fill_images(0);
        self.extrapolate(state);
        Ok(())
    }

    /// Looks at a state inside a step.
    pub fn look(&mut self, state: &State<S>) -> Result<(), Fault> {
        let extent = self.fill(state)?;
        if self.stale(extent.displacement2) {
            self.build(state);
            // Particles may have left the period by more than images make up for: wrap soon.
            self.built_inside_a_step = true;
            self.fill(state)?;
        }
        self.fill_images(0);
        self.extrapolate(state);
        Ok(())
    }

    /// Sums the forces: `update(i, target, rate)` with dv/dt, for fluid particles.
    pub fn sweep_forces(&mut self, targets: &mut State<S>, update: impl Update<S::Extra>) {
        self.count(false);
        let sweep = self.sweep(&self.forces, |s: &Shows<S>| s.0, true);
        let fluid = &mut targets[..self.counts[0]];
        sweep.run(&self.neighbours.rows, 0, fluid, self.parallel, update);
    }

    /// Sums the drift: `update(i, target, rate)` with dx/dt, dρ/dt and the terms' own rates.
    pub fn sweep_drift(&mut self, targets: &mut State<S>, update: impl Update<S::Extra>) {
        self.count(true);
        let sweep = self.sweep(&self.drift, |s: &Shows<S>| s.1, true);
        let fluid = &mut targets[..self.counts[0]];
        sweep.run(&self.neighbours.rows, 0, fluid, self.parallel, &update);
        self.sweep_walls(targets, update);
    }

    /// Sums forces and drift in one traversal: `update(i, target, rate)` with the whole rate.
    pub fn sweep_all(&mut self, targets: &mut State<S>, update: impl Update<S::Extra>) {
        self.count(true);
        let terms = (self.forces.clone(), self.drift.clone());
        let sweep = self.sweep(&terms, |s: &Shows<S>| *s, true);
        let fluid = &mut targets[..self.counts[0]];
        sweep.run(&self.neighbours.rows, 0, fluid, self.parallel, &update);
        self.sweep_walls(targets, update);
    }

    fn sweep_walls(&self, targets: &mut State<S>, update: impl Update<S::Extra>) {
        let [fluid, wall] = self.counts;
        if wall > 0 && !S::Walls::EXTRAPOLATES {
            let terms = self.walls.rows();
            let unseen = |_: &Shows<S>| Default::default();
            let sweep = self.sweep(&terms, unseen, false);
            let targets = &mut targets[fluid..fluid + wall];
            sweep.run(&self.neighbours.wall_rows, fluid, targets, self.parallel, update);
        }
    }

    /// The rates of fluid particles by these terms alone, which need not be those of the scene, for
    /// the state that was looked at last. dx/dt is without v.
    pub fn rates<T: Term<S::Extra>>(&self, state: &State<S>, terms: &T) -> Vec<Rate<S::Extra>> {
        let column = |(k, c): (usize, &Column<Shows<S>>)| {
            let Column { position, velocity, common, .. } = *c;
            let of =
                state.get(self.neighbours.particle(k)).map_or(S::Extra::default(), |e| e.extra);
            Column { position, velocity, common, shows: terms.shows(&common, &of) }
        };
        let columns: Vec<_> = self.columns.iter().enumerate().map(column).collect();
        let (kernel, columns, project) = (&self.kernel, &columns, |shows: &T::Shows| *shows);
        Sweep { kernel, terms, columns, project, moving: false }.rates(
            &self.neighbours.rows,
            0,
            self.counts[0],
        )
    }

    /// The rates of wall particles by the terms of the walls, for the state that was looked at last;
    /// none where these do not give rates but extrapolate.
    pub fn wall_rates(&self) -> Vec<Rate<S::Extra>> {
        if S::Walls::EXTRAPOLATES {
            return Vec::new();
        }
        let ([fluid, wall], terms) = (self.counts, self.walls.rows());
        let unseen = |_: &Shows<S>| Default::default();
        self.sweep(&terms, unseen, false).rates(&self.neighbours.wall_rows, fluid, wall)
    }

    fn sweep<'a, T, P>(&'a self, terms: &'a T, project: P, moving: bool) -> Rows<'a, S, T, P> {
        Sweep { kernel: &self.kernel, terms, columns: &self.columns, project, moving }
    }

    fn count(&mut self, completes_a_right_hand_side: bool) {
        self.work.pair_interactions += self.neighbours.pairs();
        if completes_a_right_hand_side {
            self.work.right_hand_sides += self.counts[0] as u64;
        }
    }

    #[expect(clippy::neg_cmp_op_on_partial_ord)]
    fn stale(&self, displacement2: f64) -> bool {
        // Negated, so that a slack that is not a number means "always".
        !(displacement2 <= self.slack2)
    }

    /// Whether rows will be stale within a step like the last one: better built now, in order, than
    /// inside the step and again after it.
    fn stale_before_long(&mut self, extent: Extent) -> bool {
        let displacement = extent.displacement2.sqrt();
        let ahead = displacement + (displacement - self.last_displacement).max(0.0);
        let stale = self.stale(ahead * ahead);
        self.last_displacement = if stale { 0.0 } else { displacement };
        stale
    }

    /// Derives the columns of the particles, and finds out how far they moved since the rows were
    /// built.
    fn fill(&mut self, state: &State<S>) -> Result<Extent, Fault> {
        let Self { forces, drift, limits, fixed, columns, neighbours, reach2, extents, .. } = self;
        let fill = Fill::<S> { forces, drift, limits, reach2: *reach2 };
        let (columns, built_at) = (&mut columns[..state.len()], &*neighbours.built_at);
        extents.resize(state.len().div_ceil(BLOCK), Extent::NIL);
        parallel::map_blocks(columns, extents, self.parallel, &|b, columns| {
            let from = b * BLOCK;
            fill.chunk(columns, &state[from..], &fixed[from..], &built_at[from..])
        });
        let extent = extents.iter().copied().fold(Extent::NIL, Extent::and);
        if extent.sound { Ok(extent) } else { Err(self.find_fault(state)) }
    }

    /// Refills the images of the particles from `first` on; an image of an image belongs to both.
    fn fill_images(&mut self, first: usize) {
        let (real, maps) = (self.fixed.len(), &self.neighbours.maps);
        for (k, image) in self.neighbours.images.iter().enumerate() {
            let source = image.source as usize;
            if source >= first {
                let map = &maps[image.map as usize];
                self.columns[real + k] = map.apply(&self.columns[source], S::Walls::SLIPS);
            }
        }
    }

    /// Has wall particles that extrapolate show what the fluid before them implies, and their images
    /// too.
    fn extrapolate(&mut self, state: &State<S>) {
        let [fluid, wall] = self.counts;
        if !S::Walls::EXTRAPOLATES || wall == 0 {
            return;
        }
        let mut set = std::mem::take(&mut self.extrapolated);
        set.clear();
        set.extend_from_slice(&state[fluid..fluid + wall]);
        let terms = self.walls.rows();
        let sweep = self.sweep(&terms, |_: &Shows<S>| Default::default(), false);
        let rows = &self.neighbours.wall_rows;
        sweep.run(rows, fluid, &mut set, self.parallel, |_, target, rate| {
            target.velocity += rate.velocity;
            target.density = rate.density;
        });
        for (column, implied) in self.columns[fluid..].iter_mut().zip(&set) {
            let (mass, density, extra) = (column.common.mass, implied.density, &implied.extra);
            let common = Common { mass, density, volume: mass / density };
            let shows = (self.forces.shows(&common, extra), self.drift.shows(&common, extra));
            *column = Column { velocity: implied.velocity, common, shows, ..*column };
        }
        self.extrapolated = set;
        self.fill_images(fluid);
    }

    /// Puts fluid particles in the order of their cells, and all inside the period.
    pub(crate) fn sort(&mut self, state: &mut State<S>) {
        for evolved in &mut *state {
            evolved.position = self.domain.wrap(evolved.position);
        }
        let fluid = self.counts[0];
        self.neighbours.place(state[..fluid].iter().map(|e| e.position));
        self.neighbours.order(&mut self.order);
        apply_order(&mut self.order, &mut state[..fluid], &mut self.fixed[..fluid]);
    }

    /// Builds rows and images for this state, and makes room for their columns.
    pub(crate) fn build(&mut self, state: &State<S>) {
        self.neighbours.place(state.iter().map(|e| e.position));
        let mirrors = self.walls.mirrors();
        let fluid_only = S::Walls::EXTRAPOLATES;
        self.neighbours.build(&self.domain, mirrors, self.counts, fluid_only, self.parallel);
        let columns = state.len() + self.neighbours.images.len();
        self.columns.resize(columns + 1, Column::sentinel());
        self.columns[columns] = Column::sentinel();
        self.work.list_builds += 1;
    }

    /// The first particle, in the order of the scene, that is out of bounds.
    fn find_fault(&self, state: &State<S>) -> Fault {
        let fault =
            |((evolved, fixed), built_at): ((&Evolved<S::Extra>, &Fixed), &Vector2<f64>)| {
                let moved2 = (evolved.position - built_at).norm_squared();
                let field = evolved.fault().or_else(|| self.excess(evolved, moved2))?;
                let value = match field {
                    "position" => evolved.position.norm(),
                    "velocity" => evolved.velocity.norm(),
                    "density" => evolved.density,
                    _ => f64::NAN,
                };
                Some(Fault { particle: fixed.id, field, value })
            };
        let particles = state.iter().zip(&self.fixed).zip(&self.neighbours.built_at);
        let first = particles.filter_map(fault).min_by_key(|f| f.particle);
        first.expect("a state that is not sound has a particle that is not")
    }

    /// The first field of a finite state that is beyond its limit. The same conditions as in
    /// [`Fill::chunk`].
    fn excess(&self, evolved: &Evolved<S::Extra>, moved2: f64) -> Option<&'static str> {
        let ([least, most], speed2) = (self.limits.density, evolved.velocity.norm_squared());
        let speed = self.limits.speed;
        match evolved.density {
            _ if !(moved2 <= self.reach2) => Some("position"),
            _ if !(speed2 <= speed * speed && speed2.is_finite()) => Some("velocity"),
            density if !(density > least && density < most) => Some("density"),
            _ => None,
        }
    }
}

/// Permutes two arrays in place: entry i becomes what was at `order[i]`.
fn apply_order<A, B>(order: &mut [u32], a: &mut [A], b: &mut [B]) {
    for i in 0..order.len() {
        // Where order[i] is now: entries before i were swapped away along the chain.
        let mut from = order[i] as usize;
        while from < i {
            from = order[from] as usize;
        }
        order[i] = from as u32;
        a.swap(i, from);
        b.swap(i, from);
    }
}

#[cfg(test)]
mod tests {
    use super::apply_order;

    #[test]
    fn permuting_in_place_is_gathering_by_the_order() {
        for seed in 1_u64..50 {
            let n = (seed % 17 + 1) as usize;
            let mut order: Vec<u32> = (0..n as u32).collect();
            order.sort_by_key(|&k| (u64::from(k) + 1).wrapping_mul(0x9E37_79B9 * seed) % 1009);
            let expected = order.clone();
            let (mut a, mut b): (Vec<u32>, Vec<u32>) = ((0..n as u32).collect(), vec![7; n]);
            apply_order(&mut order, &mut a, &mut b);
            assert_eq!(a, expected);
        }
    }
}
