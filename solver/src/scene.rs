//! A scene: everything that a simulation starts from, checked before the first step.

use std::marker::PhantomData;

use nalgebra::Vector2;
use thiserror::Error;

use crate::{
    domain::Domain,
    engine::{Engine, Limits},
    integrator::Integrator,
    kernel::{Kernel, Smoothing},
    neighbours::Neighbours,
    numbers::Numbers,
    particles::{Evolved, Fixed, Particle, Role},
    simulation::{Checkpoint, Simulation, Work},
    terms::Term,
    walls::{PlaneWall, RIGHT_ANGLE, Walls},
};

/// A composition of types: the whole method. What is not named here is not in the program.
pub trait Scheme: Sized + 'static {
    /// What a particle integrates beyond x, v and ρ; `()` for a fluid.
    type Extra: Numbers;
    /// Smoothing kernel.
    type Kernel: Kernel;
    /// Terms of dv/dt.
    type Forces: Term<Self::Extra>;
    /// Terms of dx/dt (beyond v), dρ/dt and the extra fields.
    type Drift: Term<Self::Extra>;
    /// Wall representation.
    type Walls: Walls<Self::Extra>;
    /// Time integration.
    type Integrator: Integrator<Self::Extra>;
}

/// A [`Scheme`] written as one line: `Compose<Kernel, Forces, Drift, Walls, Integrator>`.
#[derive(Debug)]
pub struct Compose<K, F, D, W, I, X = ()>(PhantomData<(K, F, D, W, I, X)>);

impl<K, F, D, W, I, X> Scheme for Compose<K, F, D, W, I, X>
where
    X: Numbers,
    K: Kernel,
    F: Term<X>,
    D: Term<X>,
    W: Walls<X>,
    I: Integrator<X>,
{
    type Extra = X;
    type Kernel = K;
    type Forces = F;
    type Drift = D;
    type Walls = W;
    type Integrator = I;
}

/// Why a scene cannot be simulated.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneError {
    /// No particle that moves.
    #[error("the scene has no fluid particle")]
    Empty,
    /// More particles than a row can number.
    #[error("{count} particles are more than the {most} that fit")]
    TooMany {
        /// Particles given.
        count: usize,
        /// Particles allowed.
        most: usize,
    },
    /// A length that must be positive and finite.
    #[error("{name} is {value} m, but must be a finite length {range}")]
    Length {
        /// Which length.
        name: &'static str,
        /// Its value \[m\].
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A particle that no simulation may start from.
    #[error("particle {particle} has {field} {value}, but must have {range}")]
    Particle {
        /// Its number.
        particle: usize,
        /// The quantity.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A mirror that is not one.
    #[error("wall {wall} has {field} {value}, but must have {range}")]
    Wall {
        /// Its number.
        wall: usize,
        /// The quantity.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A checkpoint that no simulation of the scene can have made.
    #[error("the checkpoint has {reason}")]
    Checkpoint {
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A period in which particles would see each other twice.
    #[error(
        "the period along {axis} is {period} m, but must be at least {least} m, \
         two supports or a support and the skin"
    )]
    PeriodTooShort {
        /// `x` or `y`.
        axis: char,
        /// The period given \[m\].
        period: f64,
        /// The least one \[m\].
        least: f64,
    },
}

/// A scene of the scheme `S`.
pub struct Scene<S: Scheme> {
    /// Smoothing length h \[m\].
    pub h: f64,
    /// Periodic or open.
    pub domain: Domain,
    /// The particles; results keep their order.
    pub particles: Vec<Particle<S::Extra>>,
    /// Terms of dv/dt.
    pub forces: S::Forces,
    /// Terms of dx/dt, dρ/dt and the extra fields.
    pub drift: S::Drift,
    /// Walls.
    pub walls: S::Walls,
    /// Reach of neighbour rows beyond the support \[m\]: longer rows, built less often.
    pub skin: f64,
    /// A particle may move by this share of the skin before rows are rebuilt. 0.5 is exact; more is
    /// wrong, and there to show that tests notice.
    pub skin_share: f64,
    /// Bounds beyond which the run counts as diverged.
    pub limits: Limits,
    /// Particles from which sums are worth spreading over threads.
    pub parallel_from: usize,
}

impl<S: Scheme> Scene<S> {
    /// A scene with the usual skin, limits and threading.
    pub fn new(
        h: f64,
        domain: Domain,
        particles: Vec<Particle<S::Extra>>,
        forces: S::Forces,
        drift: S::Drift,
        walls: S::Walls,
    ) -> Self {
        let (skin, skin_share, limits) = (0.12 * h, 0.5, Limits::default());
        // Below this a fork-join is taken to cost more than it saves; a default, to be measured.
        let parallel_from = 10_000;
        Self { h, domain, particles, forces, drift, walls, skin, skin_share, limits, parallel_from }
    }

    /// Checks the scene and makes it ready to step.
    pub fn build(mut self) -> Result<Simulation<S>, SceneError> {
        self.check()?;
        let all = std::mem::take(&mut self.particles);
        let mut particles = Vec::with_capacity(all.len());
        for role in [Role::Fluid, Role::Wall, Role::Interface] {
            particles.extend((0..).zip(all.iter().copied()).filter(|(_, p)| p.role == role));
        }
        let (mut engine, mut state) = self.engine(&particles);
        engine.sort(&mut state);
        engine.build(&state);
        Ok(Simulation::new(engine, state))
    }

    /// Goes on from a checkpoint of a simulation of this scene: its particles take the place of
    /// those of the scene, everything else has to be as it was.
    pub fn resume(mut self, from: &Checkpoint<S::Extra>) -> Result<Simulation<S>, SceneError> {
        self.particles = from.particles.iter().map(|(_, p)| *p).collect();
        self.check()?;
        self.check_order(from)?;
        let (mut engine, state) = self.engine(&from.particles);
        let mut built = state.clone();
        for (evolved, at) in built.iter_mut().zip(&from.built_at) {
            evolved.position = *at;
        }
        engine.build(&built);
        Ok(Simulation::new(engine, state).at(from))
    }

    /// Whether particles of a checkpoint are stored as a simulation stores them.
    fn check_order(&self, checkpoint: &Checkpoint<S::Extra>) -> Result<(), SceneError> {
        let Checkpoint { particles, built_at, .. } = checkpoint;
        let mut ids: Vec<u32> = particles.iter().map(|(id, _)| *id).collect();
        ids.sort_unstable();
        let reason = if !(checkpoint.time.is_finite() && checkpoint.lag.is_finite()) {
            "a time or a lag that is not finite"
        } else if built_at.len() != particles.len() {
            "another number of places than of particles"
        } else if !built_at.iter().all(|p| p.x.is_finite() && p.y.is_finite()) {
            "a place that is not finite"
        } else if !self.particles.is_sorted_by_key(|p| p.role) {
            "roles out of order"
        } else if !ids.into_iter().eq(0..particles.len() as u32) {
            "numbers that are not those of a scene"
        } else {
            return Ok(());
        };
        Err(SceneError::Checkpoint { reason })
    }

    /// The engine for particles in this order, without rows, and their state.
    fn engine(
        self,
        particles: &[(u32, Particle<S::Extra>)],
    ) -> (Engine<S>, Vec<Evolved<S::Extra>>) {
        let kernel = Smoothing::new(self.h);
        let count = |role| particles.iter().filter(|(_, p)| p.role == role).count();
        let evolved = |(_, p): &(u32, Particle<S::Extra>)| {
            let Particle { position, velocity, density, extra, .. } = *p;
            Evolved { position, velocity, density, extra }
        };
        let radius = kernel.support() + self.skin;
        let slack = self.skin_share * self.skin;
        let periods = self.domain.period.iter().flatten();
        // The root of the largest number: its square is finite.
        let half_period = 0.5 * periods.fold(f64::MAX.sqrt(), |a, b| a.min(*b));
        let engine = Engine {
            kernel,
            domain: self.domain,
            neighbours: Neighbours::new(radius, &self.domain, self.walls.mirrors()),
            forces: self.forces,
            drift: self.drift,
            walls: self.walls,
            limits: self.limits,
            counts: [count(Role::Fluid), count(Role::Wall)],
            parallel: particles.len() >= self.parallel_from,
            fixed: particles.iter().map(|(id, p)| Fixed { mass: p.mass, id: *id }).collect(),
            columns: Vec::new(),
            last_displacement: 0.0,
            built_inside_a_step: false,
            slack2: slack * slack,
            reach2: half_period * half_period,
            work: Work::default(),
            order: Vec::new(),
            extents: Vec::new(),
            extrapolated: Vec::new(),
        };
        (engine, particles.iter().map(evolved).collect())
    }

    fn check(&self) -> Result<(), SceneError> {
        let length = |name, value: f64, valid: bool, range| {
            let error = SceneError::Length { name, value, range };
            if valid && value.is_finite() { Ok(()) } else { Err(error) }
        };
        length("smoothing length", self.h, self.h > 0.0, "above 0")?;
        length("skin", self.skin, self.skin >= 0.0, "of at least 0")?;
        self.check_particles()?;
        self.check_walls()?;
        let support = S::Kernel::SUPPORT * self.h;
        for (axis, name) in [(0, 'x'), (1, 'y')] {
            let Some(period) = self.domain.period[axis] else { continue };
            // Rows reach a skin farther, and one copy on either side must be enough.
            let least = (2.0 * support).max(support + self.skin);
            if !(period >= least && period.is_finite()) {
                return Err(SceneError::PeriodTooShort { axis: name, period, least });
            }
            length("lower corner of the period", self.domain.low[axis], true, "anywhere")?;
        }
        Ok(())
    }

    /// |cos| of the angle between this mirror and one before it, if it is neither 0, for which there are
    /// images across the corner, nor 1.
    fn askew(&self, wall: usize) -> Option<f64> {
        let mirrors = self.walls.mirrors();
        let cosines = mirrors[..wall].iter().map(|m| m.normal.dot(&mirrors[wall].normal).abs());
        cosines.into_iter().find(|c| *c > RIGHT_ANGLE && (c - 1.0).abs() > 1e-12)
    }

    /// A mirror with another normal would stretch its image, and one that moves along its normal
    /// would have to take its plane with it.
    fn check_walls(&self) -> Result<(), SceneError> {
        for (wall, mirror) in self.walls.mirrors().iter().enumerate() {
            let PlaneWall { point, normal, velocity, curvature } = mirror;
            let (length, across) = (normal.norm(), velocity.dot(normal));
            let sum = point.sum() + velocity.sum() + curvature.sum();
            let (field, value, range) = if !((length - 1.0).abs() < 1e-12) {
                ("a normal of length", length, "1")
            } else if !(across.abs() <= 1e-12 * velocity.norm()) {
                ("a velocity along its normal of", across, "0")
            } else if !sum.is_finite() {
                ("a sum of its numbers of", sum, "a finite one")
            } else if let Some(cosine) = self.askew(wall) {
                ("a cosine with another wall of", cosine, "0, a corner, or 1, beside it")
            } else {
                continue;
            };
            return Err(SceneError::Wall { wall, field, value, range });
        }
        Ok(())
    }

    fn check_particles(&self) -> Result<(), SceneError> {
        // Images and the sentinel are numbered too: at most eight a particle.
        let (count, most) = (self.particles.len(), (u32::MAX / 16) as usize);
        if count > most {
            return Err(SceneError::TooMany { count, most });
        }
        if !self.particles.iter().any(|p| p.role == Role::Fluid) {
            return Err(SceneError::Empty);
        }
        for (particle, p) in self.particles.iter().enumerate() {
            let finite = |v: &Vector2<f64>| v.x.is_finite() && v.y.is_finite();
            let (field, value, range) = if !finite(&p.position) {
                ("position", p.position.x + p.position.y, "a finite one")
            } else if !finite(&p.velocity) {
                ("velocity", p.velocity.x + p.velocity.y, "a finite one")
            } else if !(p.density > 0.0 && p.density.is_finite()) {
                ("density", p.density, "a finite one above 0")
            } else if !(p.mass > 0.0 && p.mass.is_finite()) {
                ("mass", p.mass, "a finite one above 0")
            } else if !p.extra.is_finite() {
                ("extra field", f64::NAN, "a finite one")
            } else {
                continue;
            };
            return Err(SceneError::Particle { particle, field, value, range });
        }
        Ok(())
    }
}

/// A square lattice of `columns` × `rows` points with spacing `dx`, the first at `first`.
pub fn lattice(
    first: Vector2<f64>,
    dx: f64,
    columns: usize,
    rows: usize,
) -> impl Iterator<Item = Vector2<f64>> {
    (0..rows).flat_map(move |j| {
        (0..columns).map(move |i| first + Vector2::new(i as f64 * dx, j as f64 * dx))
    })
}
