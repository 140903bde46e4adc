//! A scene of elastic solids and its simulation: the leapfrog (velocity Verlet), one evaluation of the
//! forces a step, after which every quantity has the same time.

use crate::{
    Checkpoint, DivergenceBounds, Domain, Kernel, Leapfrog, Particle, ParticleData, Phase,
    Potential, Rate, Role, Scene, SceneError, Smoothing, Stepper, Symmetric,
    integrator::Stepped,
    parallel,
    particles::{Common, SweptParticle},
    scene::{Component, require},
    walls::Walls,
};
use nalgebra::Vector2;

use super::{
    body::Body,
    law::{Law, Moduli},
    load::{Load, Loaded},
    reference::ReferenceConfiguration,
};

/// The scheme for the neighbour search in the reference: without terms, so that nothing else is compiled.
type Frame<K, W> = crate::Compose<K, (), (), W, Leapfrog, Symmetric>;

/// A scene of elastic solids.
pub struct SolidScene<W, C> {
    /// Smoothing length h \[m\].
    pub h: f64,
    /// The domain, periodic or open in each direction.
    pub domain: Domain,
    /// The particles in their reference, without stress. Results list them in the same order.
    pub particles: Vec<Particle<Symmetric>>,
    /// The number of the body of each particle, from 0; empty if there is one body.
    pub bodies: Vec<u32>,
    /// Planes: [`crate::Ghosts`] hold the body; along [`crate::SlipGhosts`] it
    /// slides.
    pub walls: W,
    /// The moduli.
    pub moduli: Moduli,
    /// χ, the strength of the resistance to hourglass modes, see the documentation of the module.
    pub hourglass: f64,
    /// Weight and contact.
    pub loads: C,
    /// Bounds beyond which the run counts as diverged.
    pub limits: DivergenceBounds,
    /// Number of particles from which work is distributed over threads.
    pub parallel_from: usize,
}

impl<W: Walls<Symmetric>, C: Load> SolidScene<W, C> {
    /// Checks the scene, and builds a simulation with the kernel `K` and the stored energy `L`.
    pub fn build<K: Kernel, L: Law>(self) -> Result<Solid<K, L, C>, SceneError> {
        let Self { h, domain, particles, bodies, walls, moduli, loads, limits, .. } = self;
        check(&particles, &bodies, &moduli, self.hourglass)?;
        let mut frame = Scene::<Frame<K, W>>::new(h, domain, particles, (), (), walls);
        // Rounding must not leave out a neighbour; a little more is found, and left out by its weight.
        (frame.setting.skin, frame.setting.limits) = (1e-9 * h, limits);
        frame.setting.parallel_from = self.parallel_from;
        let data = frame.build()?.into_particles();
        let of = |(id, _): &(u32, _)| bodies.get(*id as usize).copied().unwrap_or(0);
        let bodies: Vec<u32> = data.without_memory().particles.iter().map(of).collect();
        let kernel = Smoothing::<K>::new(h);
        let accelerations = vec![Vector2::zeros(); bodies.len()];
        let reference = ReferenceConfiguration::new(&data, &kernel, bodies, domain, W::SLIPS)?;
        let body = Body::new(reference, moduli, self.hourglass, data.is_parallel());
        let mut solid = Solid { data, body, kernel, loads, accelerations };
        solid.evaluate();
        Ok(solid)
    }
}

fn check(
    particles: &[Particle<Symmetric>],
    bodies: &[u32],
    &Moduli { bulk, shear }: &Moduli,
    hourglass: f64,
) -> Result<(), SceneError> {
    for (k, particle) in particles.iter().enumerate() {
        let moves = particle.role == Role::Fluid;
        require(Component::Particle(k), [(moves, "number of its role", 1.0, "0: it moves")])?;
    }
    let (count, has_all) = (bodies.len(), bodies.len() == particles.len());
    let is_sound = |value: f64| value >= 0.0 && value.is_finite();
    let allowed = "finite and at least 0";
    let all = [
        (count == 0 || has_all, "number of body numbers", count as f64, "0, or one a particle"),
        (is_sound(bulk), "bulk modulus in Pa", bulk, allowed),
        (is_sound(shear), "shear modulus in Pa", shear, allowed),
        (is_sound(hourglass), "hourglass strength", hourglass, allowed),
    ];
    require(Component::Scene, all)
}

/// Elastic solids that move: kernel `K`, stored energy `L`, loads `C`. The densities and the extra fields
/// (the deviator of the Cauchy stress) follow from the positions.
pub struct Solid<K, L, C> {
    data: ParticleData<Symmetric>,
    /// The body: its reference, and its deformation.
    pub body: Body<L>,
    kernel: Smoothing<K>,
    loads: C,
    accelerations: Vec<Vector2<f64>>,
}

/// The particles as input of loads.
fn loaded<'a>(
    data: &'a ParticleData<Symmetric>,
    reference: &'a ReferenceConfiguration,
) -> Loaded<'a> {
    Loaded { state: data.fluid_state(), reference, parallel: data.is_parallel() }
}

impl<K: Kernel, L: Law, C: Load> Solid<K, L, C> {
    /// Derives everything from the positions; the number of neighbours in all pair sweeps, of which a body
    /// has two, over gradients and over forces.
    fn evaluate(&mut self) -> u64 {
        self.data.enter(Phase::Forces);
        self.body.deform(self.data.fluid_mut(), &mut self.accelerations);
        self.data.enter(Phase::Walls);
        let on = loaded(&self.data, &self.body.reference);
        let of_loads = self.loads.push(&on, &mut self.accelerations);
        self.data.enter(Phase::Rest);
        2 * self.body.reference.pairs() + of_loads
    }
}

impl<K: Kernel, L: Law, C: Load> Stepper<Symmetric> for Solid<K, L, C> {
    fn data(&self) -> &ParticleData<Symmetric> {
        &self.data
    }
    fn data_mut(&mut self) -> &mut ParticleData<Symmetric> {
        &mut self.data
    }
    fn step(&mut self, dt: f64) -> Stepped {
        let (half, parallel) = (0.5 * dt, self.data.is_parallel());
        let (moving, accelerations) = (self.data.fluid_mut(), &self.accelerations);
        parallel::for_each_pair(moving, accelerations, parallel, &|evolved, acceleration| {
            evolved.velocity += acceleration * half;
            evolved.position += evolved.velocity * dt;
        });
        let neighbours = self.evaluate();
        self.data.count_pairs(Phase::Rest, neighbours);
        let (moving, accelerations) = (self.data.fluid_mut(), &self.accelerations);
        parallel::for_each_pair(moving, accelerations, parallel, &|evolved, acceleration| {
            evolved.velocity += acceleration * half;
        });
        self.data.check_bounds()
    }
    fn synchronise(&mut self) -> Stepped {
        self.data.check_bounds()
    }
    fn stepper(&mut self) -> &mut dyn Stepper<Symmetric> {
        self
    }
    fn checkpoint(&self) -> Checkpoint<Symmetric> {
        self.data.without_memory()
    }
    fn restore(&mut self, from: &Checkpoint<Symmetric>) -> Result<(), &'static str> {
        self.data.resume(from)?;
        self.evaluate();
        Ok(())
    }
    fn weight(&self, r2: f64) -> f64 {
        self.kernel.w(r2)
    }
    fn plain_columns(&self) -> Vec<SweptParticle> {
        let mut columns: Vec<SweptParticle> = Vec::new();
        for ((mass, evolved), position) in self.data.fluid().zip(self.body.positions()) {
            let (velocity, density) = (evolved.velocity, evolved.density);
            let common = Common { mass, density, volume: mass / density };
            columns.push(SweptParticle { position, velocity, common, derived: () });
        }
        let images = self.body.positions().skip(columns.len());
        for (image, position) in self.body.reference.images.iter().zip(images) {
            let source = columns[image.source];
            let velocity = image.displaced * source.velocity;
            columns.push(SweptParticle { position, velocity, ..source });
        }
        columns
    }
    fn total_rates(&self) -> Vec<Rate<Symmetric>> {
        let rate = |a: &Vector2<f64>| Rate { velocity: *a, ..Rate::default() };
        self.accelerations.iter().map(rate).collect()
    }
    fn bytes(&self) -> usize {
        self.data.bytes() + self.body.bytes() + size_of_val(&self.accelerations[..])
    }
    fn potential(&self) -> Option<Potential> {
        let on = loaded(&self.data, &self.body.reference);
        Some(Potential { loads: self.loads.energy(&on), ..self.body.potential() })
    }
}
