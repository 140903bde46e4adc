//! Particles at one time, as the measures of a case read them: particles of our simulation, or particles that
//! another code submitted, which may lack columns.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::absent::Absent;
use touchstone_solver::{
    Numbers, Particle, ParticleData, Role, State, Stepper, Symmetric, parallel,
};

use crate::checkpoint::RoleNames;

/// Name of the column of densities.
pub const DENSITY: &str = "density";
/// Name of the column of stresses.
pub const STRESS: &str = "stress";

/// A particle of a snapshot: the quantities that no snapshot lacks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Index of its values in the optional columns of its snapshot.
    index: usize,
    /// Role in the scene.
    #[serde(with = "RoleNames")]
    pub role: Role,
    /// Mass per unit depth \[kg/m\].
    pub mass: f64,
    /// Position \[m\].
    pub position: Vector2<f64>,
    /// Velocity \[m/s\]; of a wall particle, the velocity of the wall.
    pub velocity: Vector2<f64>,
}

impl Point {
    /// Is it a particle that moves by the equations of the scene?
    pub fn is_fluid(&self) -> bool {
        self.role == Role::Fluid
    }
}

/// The particle at a place of storage.
fn point<X: Numbers>(data: &ParticleData<X>, index: usize) -> Point {
    let Particle { role, mass, position, velocity, .. } = data.at(index);
    Point { index, role, mass, position, velocity }
}

/// Total momentum of the moving particles per unit depth \[kg/s\], summed in the order given.
pub fn momentum(points: &[Point]) -> Vector2<f64> {
    let moving = points.iter().filter(|point| point.is_fluid());
    moving.fold(Vector2::zeros(), |sum, point| sum + point.velocity * point.mass)
}

/// Kinetic energy per unit depth \[J/m\], summed in the order given.
pub fn kinetic(points: impl Iterator<Item = Point>) -> f64 {
    points.fold(0.0, |sum, p| sum + 0.5 * p.mass * p.velocity.norm_squared())
}

/// Mass \[kg/m\] of particles, centre of mass \[m\] and its velocity \[m/s\].
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    /// Mass.
    pub mass: f64,
    /// Centre of mass.
    pub centre: Vector2<f64>,
    /// Velocity of the centre of mass.
    pub velocity: Vector2<f64>,
}

impl Moments {
    /// The sums over these particles, in the order given.
    pub fn of(points: impl Iterator<Item = Point>) -> Self {
        let (mut mass, mut first, mut momentum) = (0.0, Vector2::zeros(), Vector2::zeros());
        for p in points {
            mass += p.mass;
            first += p.position * p.mass;
            momentum += p.velocity * p.mass;
        }
        Self { mass, centre: first / mass, velocity: momentum / mass }
    }
}

/// An optional column of a snapshot.
#[derive(Clone, Copy)]
pub enum SnapshotColumn<'a, X, T> {
    /// A quantity of the particles of our simulation, as they are stored.
    Ours(&'a [State<X>], fn(&State<X>) -> T),
    /// A column that was submitted.
    Given(&'a [T]),
}

impl<X, T: Copy> SnapshotColumn<'_, X, T> {
    /// The value of a point of the same snapshot.
    pub fn of(&self, point: &Point) -> T {
        match self {
            Self::Ours(particles, value) => value(&particles[point.index]),
            Self::Given(values) => values[point.index],
        }
    }
}

/// Particles as arrays in the order of the scene. Optional columns are absent if they were not submitted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParticleArrays<X = ()> {
    /// The particles.
    pub points: Vec<Point>,
    /// Densities \[kg/m³\].
    pub densities: Option<Vec<f64>>,
    /// Further fields that a method integrates, such as stress.
    pub extras: Option<Vec<X>>,
}

impl<X: Numbers> ParticleArrays<X> {
    /// Particles with masses \[kg/m\], positions \[m\] and velocities \[m/s\], without optional columns.
    pub fn of(particles: impl Iterator<Item = (Role, f64, [Vector2<f64>; 2])>) -> Self {
        let mut points = Vec::new();
        for (index, (role, mass, [position, velocity])) in particles.enumerate() {
            points.push(Point { index, role, mass, position, velocity });
        }
        Self { points, densities: None, extras: None }
    }

    /// Particles with every column.
    pub fn all(particles: &[Particle<X>]) -> Self {
        let of = particles.iter().map(|p| (p.role, p.mass, [p.position, p.velocity]));
        let densities = Some(particles.iter().map(|p| p.density).collect());
        let extras = Some(particles.iter().map(|p| p.extra).collect());
        Self { densities, extras, ..Self::of(of) }
    }

    /// The density of each particle.
    ///
    /// # Errors
    /// [`Absent::NotGiven`] without the column.
    pub fn densities(&self) -> Result<&[f64], Absent> {
        self.densities.as_deref().ok_or_else(|| Absent::NotGiven(DENSITY.into()))
    }

    /// The further fields of each particle.
    ///
    /// # Errors
    /// [`Absent::NotGiven`] without the column.
    pub fn extras(&self) -> Result<&[X], Absent> {
        self.extras.as_deref().ok_or_else(|| Absent::NotGiven(STRESS.into()))
    }
}

/// Our method, which sums over the neighbours of particles that were submitted.
pub trait Sums<X: Numbers> {
    /// The kernel W \[1/m²\] of r² \[m²\].
    fn weight(&self, r2: f64) -> f64;

    /// Calls `read` with the simulation at a time \[s\].
    ///
    /// # Errors
    /// The column that the method needs and the particles lack, or why the method refuses the particles.
    fn read(
        &self,
        time: f64,
        particles: &ParticleArrays<X>,
        read: &mut dyn FnMut(&dyn Stepper<X>),
    ) -> Result<(), Absent>;
}

/// Particles at one time.
pub struct Snapshot<'a, X: Numbers = ()> {
    time: f64,
    source: Source<'a, X>,
}

enum Source<'a, X: Numbers> {
    Ours(&'a dyn Stepper<X>),
    Given(ParticleArrays<X>, Option<&'a dyn Sums<X>>),
}

impl<'a, X: Numbers> Snapshot<'a, X> {
    /// The particles of our simulation.
    pub fn ours(simulation: &'a dyn Stepper<X>) -> Self {
        Self { time: simulation.time(), source: Source::Ours(simulation) }
    }

    /// Particles with every column at a time \[s\], without a method: the kernel is not a number.
    pub fn of(time: f64, particles: &[Particle<X>]) -> Self {
        Self { time, source: Source::Given(ParticleArrays::all(particles), None) }
    }

    /// Particles that were submitted for a time \[s\], and our method, which sums over their neighbours.
    pub fn given(time: f64, columns: ParticleArrays<X>, sums: &'a dyn Sums<X>) -> Self {
        Self { time, source: Source::Given(columns, Some(sums)) }
    }

    /// \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// All particles in the order of the scene.
    pub fn all(&self) -> Vec<Point> {
        match &self.source {
            Source::Given(columns, _) => columns.points.clone(),
            Source::Ours(simulation) => {
                let data = simulation.data();
                let (places, parallel) = (data.places(), data.is_parallel());
                let mut all = vec![point(data, 0); places.len()];
                parallel::for_each_pair(&mut all, &places, parallel, &|this, place| {
                    *this = point(data, *place as usize);
                });
                all
            }
        }
    }

    /// Values of all moving particles in the order of the scene, for sums: the order of storage changes, and
    /// with it the last bits of a sum. A value takes less memory than a particle.
    pub fn of_moving<R: Send>(&self, value: impl Fn(Point) -> R + Sync) -> impl Iterator<Item = R> {
        let parts = match &self.source {
            Source::Given(..) => vec![self.stored().map(value).collect()],
            Source::Ours(simulation) => {
                let (data, fluid) = (simulation.data(), simulation.data().fluid_count());
                let places = data.places();
                parallel::map_parts(places.len(), data.is_parallel(), &|part| {
                    let mut values = Vec::with_capacity(part.len());
                    let places = places[part].iter().map(|place| *place as usize);
                    let moving = places.filter(|place| *place < fluid);
                    values.extend(moving.map(|place| value(point(data, place))));
                    values
                })
            }
        };
        parts.into_iter().flatten()
    }

    /// Results of `find` for chunks of some hundred moving particles, in storage order.
    pub fn in_parts<R: Send>(&self, find: impl Fn(&[Point]) -> R + Sync) -> Vec<R> {
        match &self.source {
            Source::Given(..) => vec![find(&self.stored().collect::<Vec<_>>())],
            Source::Ours(simulation) => {
                let data = simulation.data();
                parallel::map_parts(data.fluid_count(), data.is_parallel(), &|part| {
                    find(&part.map(|place| point(data, place)).collect::<Vec<_>>())
                })
            }
        }
    }

    /// The moving particles in the order of the scene.
    pub fn moving(&self) -> Vec<Point> {
        let mut all = self.all();
        all.retain(Point::is_fluid);
        all
    }

    /// The moving particles as they are stored, without order; for sums.
    pub fn stored(&self) -> impl Iterator<Item = Point> + Clone {
        let (ours, given) = match &self.source {
            Source::Ours(simulation) => (Some(simulation.data().fluid()), None),
            Source::Given(columns, _) => (None, Some(&columns.points)),
        };
        let point = |(index, (mass, p)): (usize, (f64, &State<X>))| {
            let State { position, velocity, .. } = *p;
            Point { index, role: Role::Fluid, mass, position, velocity }
        };
        let ours = ours.into_iter().flatten().enumerate().map(point);
        let given = given.into_iter().flatten().copied().filter(Point::is_fluid);
        ours.chain(given)
    }

    /// Density \[kg/m³\].
    ///
    /// # Errors
    /// [`Absent::NotGiven`] without the column.
    pub fn density(&self) -> Result<SnapshotColumn<'_, X, f64>, Absent> {
        Ok(match &self.source {
            Source::Ours(simulation) => {
                SnapshotColumn::Ours(simulation.data().state(), |p| p.density)
            }
            Source::Given(columns, _) => SnapshotColumn::Given(columns.densities()?),
        })
    }

    /// The arrays of particles from outside our simulation.
    pub fn columns(&self) -> Option<&ParticleArrays<X>> {
        match &self.source {
            Source::Ours(_) => None,
            Source::Given(columns, _) => Some(columns),
        }
    }

    /// Our simulation.
    ///
    /// # Errors
    /// [`Absent::OwnTerms`] of particles that were submitted.
    pub fn simulation(&self) -> Result<&'a dyn Stepper<X>, Absent> {
        match &self.source {
            Source::Ours(simulation) => Ok(*simulation),
            Source::Given(..) => Err(Absent::OwnTerms),
        }
    }

    /// The kernel W \[1/m²\] of r² \[m²\] of our method.
    pub fn weight(&self, r2: f64) -> f64 {
        match &self.source {
            Source::Ours(simulation) => simulation.weight(r2),
            Source::Given(_, sums) => sums.map_or(f64::NAN, |sums| sums.weight(r2)),
        }
    }

    /// Reads sums over neighbours, with the kernel and the walls of our method.
    ///
    /// # Errors
    /// The column that these sums need and the snapshot lacks, or why our method refuses the particles.
    pub fn sums<R>(&self, read: impl FnOnce(&dyn Stepper<X>) -> R) -> Result<R, Absent> {
        let (columns, sums) = match &self.source {
            Source::Ours(simulation) => return Ok(read(*simulation)),
            Source::Given(columns, sums) => (columns, sums.ok_or(Absent::OwnTerms)?),
        };
        let (mut read, mut found) = (Some(read), None);
        sums.read(self.time, columns, &mut |simulation| {
            found = read.take().map(|read| read(simulation));
        })?;
        found.ok_or(Absent::OwnTerms)
    }
}

impl Snapshot<'_, Symmetric> {
    /// Deviatoric stress \[Pa\].
    ///
    /// # Errors
    /// [`Absent::NotGiven`] without the column.
    pub fn stress(&self) -> Result<SnapshotColumn<'_, Symmetric, Symmetric>, Absent> {
        Ok(match &self.source {
            Source::Ours(simulation) => {
                SnapshotColumn::Ours(simulation.data().state(), |p| p.extra)
            }
            Source::Given(columns, _) => SnapshotColumn::Given(columns.extras()?),
        })
    }
}
