//! Particles at times that another code submitted, as snapshots.

use std::cell::RefCell;
use std::collections::BTreeMap;

use nalgebra::Vector2;
use touchstone_base::absent::Absent;
use touchstone_solver::{
    Checkpoint, Divergence, DivergenceBounds, Domain, InvalidState, Numbers, Outcome, Particle,
    Progress, Role, Stepper,
};

use crate::{
    error::RunError,
    snapshot::{ParticleArrays, Sums},
};

/// A particle of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForeignParticle {
    /// Number of the particle in the problem.
    pub id: u32,
    /// \[m\].
    pub position: Vector2<f64>,
    /// \[m/s\].
    pub velocity: Vector2<f64>,
    /// \[kg/m³\], if it was submitted.
    pub density: Option<f64>,
}

/// The particles at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// \[s\].
    pub time: f64,
    /// The particles that moved; the others are where they were.
    pub particles: Vec<ForeignParticle>,
}

impl Frame {
    /// Does it count for this time of a run to this end?
    pub(crate) fn is_at(&self, time: f64, end: f64) -> bool {
        (self.time - time).abs() <= SAME_TIME * end
    }
}

/// A particle that another code chose itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnParticle {
    /// Its role in the scene.
    pub role: Role,
    /// Mass per unit depth \[kg/m\].
    pub mass: f64,
    /// Where it starts.
    pub start: ForeignParticle,
}

/// Frames of another code, ascending in time.
#[derive(Clone, Debug, Default)]
pub struct Foreign<'a> {
    /// The frames.
    pub frames: &'a [Frame],
    /// The code's own particles, by id; empty if it uses those of the problem.
    pub own: Vec<OwnParticle>,
    /// Where particles are put inside the period before anything is measured.
    pub domain: Domain,
    /// A coordinate beyond this is of a particle that the code has lost \[m\].
    pub reach: f64,
    /// Densities and speeds beyond these are of a run that diverged.
    pub limits: DivergenceBounds,
    /// Density at rest \[kg/m³\].
    pub density: f64,
}

/// A frame counts for a time that differs from its own by at most this share of the end of the run.
const SAME_TIME: f64 = 1e-6;

/// Side of the squares in which particles are counted, in spacings, and the most of the density that may be
/// in the square of the median particle: a lattice has 1.4 at most, particles at random 1.2.
const SQUARE: f64 = 2.5;
const MOST_CROWDED: f64 = 2.0;

impl Foreign<'_> {
    /// The particles at the start that the code chose itself; `None` of a code that took the particles of the
    /// problem.
    pub(crate) fn own_start<X: Numbers>(&self) -> Option<ParticleArrays<X>> {
        let of =
            |own: &OwnParticle| (own.role, own.mass, [self.inside(&own.start), own.start.velocity]);
        let densities = self.own.iter().map(|own| own.start.density).collect();
        let extras = extras(self.own.len());
        let start =
            ParticleArrays { densities, extras, ..ParticleArrays::of(self.own.iter().map(of)) };
        (!self.own.is_empty()).then_some(start)
    }

    /// The particles that the code chose itself, without stress; `None` if one has no density.
    pub(crate) fn own_particles<X: Numbers>(&self) -> Option<Vec<Particle<X>>> {
        let particle = |own: &OwnParticle| {
            let OwnParticle { role, mass, start: ForeignParticle { velocity, density, .. } } = *own;
            let (position, extra) = (self.inside(&own.start), X::default());
            Some(Particle { role, position, velocity, density: density?, mass, extra })
        };
        self.own.iter().map(particle).collect()
    }

    /// The place of a particle, inside the period.
    fn inside(&self, placed: &ForeignParticle) -> Vector2<f64> {
        self.domain.wrap(placed.position)
    }

    /// Does every particle of every frame have a density?
    pub(crate) fn has_densities(&self) -> bool {
        self.frames.iter().flat_map(|frame| &frame.particles).all(|placed| placed.density.is_some())
    }

    /// The particles of a frame, and the particles at the start that it does not name; without densities if
    /// `start` has none.
    ///
    /// # Errors
    /// If an id is not among the ids at the start.
    pub(crate) fn columns<X: Numbers>(
        &self,
        frame: &Frame,
        start: &ParticleArrays<X>,
    ) -> Result<ParticleArrays<X>, RunError> {
        let mut points = start.points.clone();
        let mut densities = start.densities.clone();
        let most = points.len();
        for placed in &frame.particles {
            let ForeignParticle { id, velocity, density, .. } = placed;
            let Some(point) = points.get_mut(*id as usize) else {
                let what = format!("id is {id}; the problem has ids below {most}");
                return Err(RunError::Foreign(format!("frame at t = {} s: {what}", frame.time)));
            };
            (point.position, point.velocity) = (self.inside(placed), *velocity);
            if let (Some(densities), Some(density)) = (&mut densities, density) {
                densities[*id as usize] = *density;
            }
        }
        Ok(ParticleArrays { points, densities, extras: extras(most) })
    }

    /// The first particle of a frame that is beyond the limits of the run and of its scene.
    pub(crate) fn lost(&self, frame: &Frame, of_scene: &DivergenceBounds) -> Option<InvalidState> {
        let least = self.limits.density[0].max(of_scene.density[0]);
        let most = self.limits.density[1].min(of_scene.density[1]);
        let fastest = self.limits.speed.min(of_scene.speed);
        frame.particles.iter().find_map(|placed| {
            let fault = |field, value| Some(InvalidState { particle: placed.id, field, value });
            let (far, speed) = (placed.position.amax(), placed.velocity.norm());
            match placed.density {
                _ if far > self.reach => fault("position", far),
                Some(density) if !(least..=most).contains(&density) => fault("density", density),
                _ if speed > fastest => fault("velocity", speed),
                _ => None,
            }
        })
    }

    /// The median particle of a frame by the mass in its square, if the density there exceeds any allowed
    /// one: particles crowded on a line or in a corner, for any stated densities.
    pub(crate) fn crowded<X>(
        &self,
        frame: &Frame,
        all: &ParticleArrays<X>,
    ) -> Option<InvalidState> {
        let moving: Vec<_> =
            frame.particles.iter().map(|of| (of.id, all.points[of.id as usize])).collect();
        let mass = moving.iter().fold(0.0, |sum, (_, p)| sum + p.mass) / moving.len() as f64;
        let side = SQUARE * (mass / self.density).sqrt();
        let square = |x: Vector2<f64>| [x.x, x.y].map(|x| (x / side).floor() as i64);
        let mut masses: BTreeMap<[i64; 2], f64> = BTreeMap::new();
        moving.iter().for_each(|(_, p)| *masses.entry(square(p.position)).or_default() += p.mass);
        let density = |x: Vector2<f64>| masses[&square(x)] / (side * side);
        let mut found: Vec<_> = moving.iter().map(|(id, p)| (density(p.position), *id)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (value, particle) = *found.get(found.len() / 2)?;
        let is_crowded = value > MOST_CROWDED * self.density;
        is_crowded.then_some(InvalidState { particle, field: "density of the places", value })
    }
}

/// The extra fields of `count` particles: `Some` for a method without such fields.
fn extras<X: Numbers>(count: usize) -> Option<Vec<X>> {
    X::default().stress().is_none().then(|| vec![X::default(); count])
}

/// The times that have no frame \[s\], of a run that ends with the last of them.
pub fn missing(frames: &[Frame], times: &[f64]) -> Vec<f64> {
    let end = times.last().copied().unwrap_or_default();
    let has = |time: &&f64| frames.iter().any(|frame| frame.is_at(**time, end));
    times.iter().filter(|time| !has(time)).copied().collect()
}

/// The first frame that is before the start, after the end, or at the time of the one before it, and why.
pub fn misplaced(frames: &[Frame], times: &[f64]) -> Option<(usize, &'static str)> {
    let end = times.last().copied().unwrap_or_default();
    let why = |k: usize| match &frames[k] {
        frame if frame.time < 0.0 => Some("it is before the start; expected times from 0 on"),
        frame if frame.time > end && !frame.is_at(end, end) => {
            Some("it is after the end; expected no later times than those of the problem")
        }
        frame if k > 0 && frame.is_at(frames[k - 1].time, 2.0 * end) => Some(
            "it equals the time of the frame before up to round-off; expected one frame per time",
        ),
        _ => None,
    };
    (0..frames.len()).find_map(|k| Some(k).zip(why(k)))
}

/// A simulation of our method, into which particles of another code are put when a measure asks for sums.
pub(crate) struct OurSums<D: ?Sized> {
    pub simulation: RefCell<Box<D>>,
    /// Do places and velocities determine all else, by the deformation from a reference?
    pub is_lagrangian: bool,
    /// The missing column, if any; without it no sums can be taken.
    pub lacks: Option<Absent>,
}

impl<D: ?Sized> OurSums<D> {
    /// Puts particles into the simulation, and derives everything that pair sweeps read.
    fn put<X: Numbers>(&self, time: f64, particles: &ParticleArrays<X>) -> Result<Outcome, Absent>
    where
        D: Stepper<X>,
    {
        self.lacks.clone().map_or(Ok(()), Err)?;
        let mut simulation = self.simulation.borrow_mut();
        let simulation = simulation.stepper();
        let mut state = simulation.checkpoint();
        for (id, particle) in &mut state.particles {
            let (id, point) = (*id as usize, particles.points[*id as usize]);
            (particle.position, particle.velocity) = (point.position, point.velocity);
            if !self.is_lagrangian {
                particle.density = particles.densities()?[id];
                particle.extra = particles.extras()?[id];
            }
        }
        if !self.is_lagrangian {
            state.built_at = state.particles.iter().map(|(_, p)| p.position).collect();
        }
        let progress = Progress { time, ..Progress::default() };
        simulation
            .restore(&Checkpoint { progress, lag: 0.0, past: Vec::new(), ..state })
            .map_err(Absent::because)?;
        Ok(simulation.advance(time, 1.0, &mut ()))
    }

    /// How particles of a body that derives density and stress from its deformation diverge, if so.
    pub fn divergence<X: Numbers>(
        &self,
        time: f64,
        particles: &ParticleArrays<X>,
    ) -> Option<Divergence>
    where
        D: Stepper<X>,
    {
        match self.is_lagrangian.then(|| self.put(time, particles)) {
            Some(Ok(Outcome::Diverged(divergence))) => Some(Divergence { step: 0, ..divergence }),
            _ => None,
        }
    }
}

impl<X: Numbers, D: Stepper<X> + ?Sized> Sums<X> for OurSums<D> {
    fn weight(&self, r2: f64) -> f64 {
        self.simulation.borrow_mut().stepper().weight(r2)
    }
    fn read(
        &self,
        time: f64,
        particles: &ParticleArrays<X>,
        read: &mut dyn FnMut(&dyn Stepper<X>),
    ) -> Result<(), Absent> {
        match self.put(time, particles)? {
            Outcome::Diverged(divergence) => Err(Absent::because(divergence.to_string())),
            Outcome::Reached | Outcome::Stopped => {
                read(self.simulation.borrow_mut().stepper());
                Ok(())
            }
        }
    }
}
