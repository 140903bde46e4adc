//! A scene: the complete initial state and method of a simulation, checked before the first step.

use nalgebra::Vector2;
use thiserror::Error;

use crate::{
    domain::Domain,
    engine::Engine,
    integrator::{PhysicsOf, Scheme},
    kernel::{Kernel, Smoothing},
    neighbours::Neighbours,
    numbers::Numbers,
    particle_data::{Limits, ParticleData},
    particles::{Particle, Role},
    simulation::Simulation,
    walls::{PlaneWall, RIGHT_ANGLE, Walls},
};

/// Why a scene cannot be simulated.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneError {
    /// The scene has no particle that moves.
    #[error("the scene has no fluid particle")]
    Empty,
    /// There are more particles than the indices of neighbour lists allow.
    #[error("the scene has {count} particles, but at most {most} are allowed")]
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
    #[error("the {field} of particle {particle} is {value}, but must be {range}")]
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
    /// A mirroring wall whose normal, velocity or numbers are not valid.
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
    /// A period so short that two particles would be neighbours twice, once directly and once as an image.
    #[error(
        "the period along {axis} is {period} m, but must be at least {least} m, \
         the larger of two support radii and one support radius plus the Verlet skin"
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

/// A scene whose method is the scheme `S`.
pub struct Scene<S: Scheme> {
    /// Smoothing length h \[m\].
    pub h: f64,
    /// The domain, periodic or open in each direction.
    pub domain: Domain,
    /// The particles. Results list them in the same order.
    pub particles: Vec<Particle<S::Extra>>,
    /// Terms of dv/dt.
    pub forces: S::Forces,
    /// Terms of dx/dt, dρ/dt and the extra fields.
    pub drift: S::Drift,
    /// The walls.
    pub walls: S::Walls,
    /// Verlet skin: how far neighbour lists reach beyond the support radius \[m\]. With a larger skin the
    /// lists are longer and are rebuilt less often.
    pub skin: f64,
    /// Neighbour lists are rebuilt before a particle has moved by more than this share of the skin. Up to
    /// 0.5 no neighbour is missed; larger values are wrong and exist so that tests can detect the error.
    pub skin_share: f64,
    /// Bounds beyond which the run counts as diverged.
    pub limits: Limits,
    /// Number of particles from which pair sweeps are distributed over threads.
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
        // For fewer particles, distributing the work is assumed to cost more than it saves; not measured.
        let parallel_from = 10_000;
        Self { h, domain, particles, forces, drift, walls, skin, skin_share, limits, parallel_from }
    }

    /// Checks the scene, and builds a simulation that is ready to step.
    pub fn build(self) -> Result<Simulation<S>, SceneError> {
        self.check()?;
        let particles = by_role(&self.particles);
        let mut engine = self.engine(&particles);
        let mut state = std::mem::take(&mut engine.data.state);
        engine.data.sort(&mut state);
        engine.build_lists(state.iter().map(|e| e.position));
        engine.data.state = state;
        Ok(Simulation { engine, integrator: S::Integrator::default() })
    }

    /// The engine for the particles in the given order, without neighbour lists.
    fn engine(self, particles: &[(u32, Particle<S::Extra>)]) -> Engine<PhysicsOf<S>> {
        let kernel = Smoothing::new(self.h);
        let radius = kernel.support() + self.skin;
        let slack = self.skin_share * self.skin;
        let periods = self.domain.period.iter().flatten();
        // The root of the largest number: its square is finite.
        let half_period = 0.5 * periods.fold(f64::MAX.sqrt(), |a, b| a.min(*b));
        let neighbours = Neighbours::new(radius, self.domain, self.walls.mirrors());
        let mut data = ParticleData { neighbours, limits: self.limits, ..Default::default() };
        data.put(particles);
        [data.slack2, data.reach2] = [slack * slack, half_period * half_period];
        data.parallel = particles.len() >= self.parallel_from;
        Engine::new(kernel, (self.forces, self.drift), &self.walls, data)
    }

    fn check(&self) -> Result<(), SceneError> {
        check_length("smoothing length", self.h, self.h > 0.0, "above 0")?;
        check_length("skin", self.skin, self.skin >= 0.0, "of at least 0")?;
        check_particles(&self.particles)?;
        check_walls(self.walls.mirrors())?;
        check_domain(&self.domain, S::Kernel::SUPPORT * self.h, self.skin)
    }
}

/// The particles in the order of their storage at the start (by role), with their numbers in the scene.
fn by_role<X: Copy>(all: &[Particle<X>]) -> Vec<(u32, Particle<X>)> {
    let of = |role| (0..).zip(all.iter().copied()).filter(move |(_, p)| p.role == role);
    [Role::Fluid, Role::Wall, Role::Interface].into_iter().flat_map(of).collect()
}

type Checked = Result<(), SceneError>;

fn check_length(name: &'static str, value: f64, valid: bool, range: &'static str) -> Checked {
    let error = SceneError::Length { name, value, range };
    if valid && value.is_finite() { Ok(()) } else { Err(error) }
}

/// A period must be long enough that one periodic copy on either side suffices.
fn check_domain(domain: &Domain, support: f64, skin: f64) -> Checked {
    for (axis, name) in [(0, 'x'), (1, 'y')] {
        let Some(period) = domain.period[axis] else { continue };
        // Neighbour lists reach farther than the support by the skin; one copy on either side must suffice.
        let least = (2.0 * support).max(support + skin);
        if !(period >= least && period.is_finite()) {
            return Err(SceneError::PeriodTooShort { axis: name, period, least });
        }
        check_length("lower corner of the period", domain.low[axis], true, "anywhere")?;
    }
    Ok(())
}

/// A normal that is not of length 1 would stretch the images, and a wall with a velocity along its normal
/// would have to move its plane, which is not implemented. Two walls are parallel or make a right angle, a
/// corner, for which there are images across both.
fn check_walls(mirrors: &[PlaneWall]) -> Checked {
    for (wall, mirror) in mirrors.iter().enumerate() {
        let PlaneWall { point, normal, velocity, curvature } = mirror;
        let (length, across) = (normal.norm(), velocity.dot(normal));
        let sum = point.sum() + velocity.sum() + curvature.sum();
        let mut cosines = mirrors[..wall].iter().map(|other| other.normal.dot(normal).abs());
        let (field, value, range) = if !((length - 1.0).abs() < 1e-12) {
            ("a normal of length", length, "1")
        } else if !(across.abs() <= 1e-12 * velocity.norm()) {
            ("a velocity along its normal of", across, "0")
        } else if !sum.is_finite() {
            ("components whose sum is", sum, "finite ones")
        } else if let Some(cosine) = cosines.find(|c| *c > RIGHT_ANGLE && (c - 1.0).abs() > 1e-12) {
            ("a cosine between its normal and another one of", cosine, "0 (corner) or 1")
        } else {
            continue;
        };
        return Err(SceneError::Wall { wall, field, value, range });
    }
    Ok(())
}

fn check_particles<X: Numbers>(particles: &[Particle<X>]) -> Checked {
    // Images and the sentinel have indices too; there are at most eight images per particle.
    let (count, most) = (particles.len(), (u32::MAX / 16) as usize);
    if count > most {
        return Err(SceneError::TooMany { count, most });
    }
    if !particles.iter().any(|p| p.role == Role::Fluid) {
        return Err(SceneError::Empty);
    }
    for (particle, p) in particles.iter().enumerate() {
        let finite = |v: &Vector2<f64>| v.x.is_finite() && v.y.is_finite();
        let (field, value, range) = if !finite(&p.position) {
            ("position", p.position.x + p.position.y, "finite")
        } else if !finite(&p.velocity) {
            ("velocity", p.velocity.x + p.velocity.y, "finite")
        } else if !(p.density > 0.0 && p.density.is_finite()) {
            ("density", p.density, "finite and above 0")
        } else if !(p.mass > 0.0 && p.mass.is_finite()) {
            ("mass", p.mass, "finite and above 0")
        } else if !p.extra.is_finite() {
            ("extra field", f64::NAN, "finite")
        } else {
            continue;
        };
        return Err(SceneError::Particle { particle, field, value, range });
    }
    Ok(())
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
