//! A scene: the complete initial state and method of a simulation, checked before the first step.

use nalgebra::Vector2;
use thiserror::Error;

use crate::{
    domain::Domain,
    engine::Engine,
    integrator::Scheme,
    kernel::Kernel,
    neighbours::{Neighbours, Reach},
    numbers::Numbers,
    particle_data::{DivergenceBounds, ParticleData},
    particles::{Particle, Role},
    simulation::Simulation,
    walls::{Extrapolation, PlaneWall, RIGHT_ANGLE, Walls},
};

/// An invalid scene: a number outside its allowed values.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{of}: the {quantity} is {value}, but must be {allowed}")]
pub struct SceneError {
    /// The owner of the number.
    pub of: Component,
    /// The quantity.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// The values that are allowed.
    pub allowed: String,
}

/// The owner of a number of a scene.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Component {
    /// The scene itself.
    #[error("scene")]
    Scene,
    /// The particle with this number.
    #[error("particle {0}")]
    Particle(usize),
    /// The mirroring wall with this number.
    #[error("wall {0}")]
    Wall(usize),
}

/// A scene whose method is the scheme `S`.
pub struct Scene<S: Scheme> {
    /// The data that do not depend on the scheme.
    pub setting: Setting<S::Extra>,
    /// Terms of dv/dt.
    pub forces: S::Forces,
    /// Terms of dx/dt, dρ/dt and the extra fields.
    pub drift: S::Drift,
    /// The walls.
    pub walls: S::Walls,
}

/// The data of a scene that do not depend on its scheme; `X` holds the extra fields of its particles.
pub struct Setting<X = ()> {
    /// Smoothing length h \[m\].
    pub h: f64,
    /// The domain, periodic or open in each direction.
    pub domain: Domain,
    /// The particles. Results list them in the same order.
    pub particles: Vec<Particle<X>>,
    /// From each wall particle, in the order of the particles, to its foot, the nearest point of the surface
    /// \[m\]; only for walls with [`Extrapolation::FEET`], else empty.
    pub feet: Vec<Vector2<f64>>,
    /// Verlet skin: reach of neighbour lists beyond the support radius \[m\]. With a larger skin the lists
    /// are longer and are rebuilt less often.
    pub skin: f64,
    /// Neighbour lists are rebuilt before two particles, having moved against each other, have each moved by
    /// more than this share of the skin. Up to 0.5 no neighbour is missed; larger values are wrong and exist
    /// so that tests can detect the error.
    pub skin_share: f64,
    /// Bounds beyond which the run counts as diverged.
    pub limits: DivergenceBounds,
    /// Number of particles from which pair sweeps are distributed over threads.
    pub parallel_from: usize,
}

/// The usual [`Setting::parallel_from`]. For fewer particles, distributing the work is assumed to cost more
/// than it saves; not measured.
pub const PARALLEL_FROM: usize = 10_000;

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
        Self { setting: Setting::new(h, domain, particles), forces, drift, walls }
    }

    /// Checks the scene, and builds a simulation that is ready to step.
    pub fn build(self) -> Result<Simulation<S>, SceneError> {
        let (h, mirrors) = (self.setting.h, self.walls.mirrors());
        let reads = <S::Walls as Walls<S::Extra>>::Extrapolation::FEET;
        let data = self.setting.ready(S::Kernel::SUPPORT, mirrors, reads)?;
        let engine = Engine::new(h, (self.forces, self.drift), &self.walls, data);
        Ok(Simulation { engine, memory: Default::default() })
    }
}

impl<X: Numbers> Setting<X> {
    /// A setting with the usual skin, limits and threading.
    pub fn new(h: f64, domain: Domain, particles: Vec<Particle<X>>) -> Self {
        Self {
            h,
            domain,
            particles,
            feet: Vec::new(),
            skin: 0.4 * h,
            skin_share: 0.5,
            limits: DivergenceBounds::default(),
            parallel_from: PARALLEL_FROM,
        }
    }

    /// The particles of a valid scene, sorted, without lists, for a kernel with this support \[h\]. `reads`:
    /// the walls use feet.
    fn ready(
        self,
        support: f64,
        mirrors: &[PlaneWall],
        reads: bool,
    ) -> Result<Box<ParticleData<X>>, SceneError> {
        let Self { h, domain, particles, feet, skin, skin_share, limits, parallel_from } = self;
        let lengths = [
            (h > 0.0 && h.is_finite(), "smoothing length in m", h, "finite and above 0"),
            (skin >= 0.0 && skin.is_finite(), "skin in m", skin, "finite and at least 0"),
        ];
        require(Component::Scene, lengths)?;
        check_particles(&particles)?;
        check_walls(mirrors)?;
        check_domain(&domain, support * h, skin)?;
        let fluid = particles.iter().filter(|p| p.role == Role::Fluid);
        let area: f64 = fluid.clone().map(|p| p.mass / p.density).sum();
        let spacing = (area / fluid.count() as f64).sqrt();
        // The root of the largest number: its square is finite.
        let half_period =
            0.5 * domain.period.iter().flatten().fold(f64::MAX.sqrt(), |a, b| a.min(*b));
        let parallel = particles.len() >= parallel_from;
        let mut stored: Vec<_> = (0..).zip(particles).collect();
        stored.sort_by_key(|(_, particle)| particle.role);
        let mut neighbours =
            Neighbours::new(Reach { support: support * h, skin, spacing }, domain, mirrors);
        (neighbours.feet, neighbours.parallel) = (feet, parallel);
        let data = ParticleData { neighbours, limits, ..Default::default() };
        let mut data = Box::new(data);
        data.put(&stored);
        check_feet(reads, &data.neighbours.feet, data.counts.walls)?;
        data.slack = skin_share * skin;
        data.reach2 = half_period * half_period;
        let mut state = std::mem::take(&mut data.state);
        data.sort(&mut state, &mut []);
        data.state = state;
        Ok(data)
    }
}

type Checked = Result<(), SceneError>;

/// A condition on a quantity: whether it is met, the quantity, its value, and what is allowed.
pub type Condition<'a> = (bool, &'static str, f64, &'a str);

/// Refuses the first quantity that does not meet its condition.
///
/// # Errors
/// The owner of the quantity, its value, and the allowed values.
pub fn require<const N: usize>(of: Component, all: [Condition; N]) -> Result<(), SceneError> {
    let Some((_, quantity, value, allowed)) = all.into_iter().find(|(is_met, ..)| !is_met) else {
        return Ok(());
    };
    Err(SceneError { of, quantity, value, allowed: allowed.into() })
}

/// A period must be long enough that no two particles are neighbours twice, once directly and once as an
/// image: one periodic copy on either side must suffice.
fn check_domain(domain: &Domain, support: f64, skin: f64) -> Checked {
    // Neighbour lists reach farther than the support by the skin.
    let least = (2.0 * support).max(support + skin);
    let allowed = format!(
        "finite and at least {least}, the larger of two support radii and one support radius plus the skin"
    );
    for (axis, name) in [(0, "period along x in m"), (1, "period along y in m")] {
        let Some(period) = domain.period[axis] else { continue };
        let (low, long) = (domain.low[axis], period >= least && period.is_finite());
        let low = (low.is_finite(), "lower corner in m", low, "finite");
        require(Component::Scene, [(long, name, period, &*allowed), low])?;
    }
    Ok(())
}

/// A normal must have length 1, else images are stretched. A wall with a velocity along its normal would move
/// its plane, which is not implemented. Two walls must be parallel or at a right angle (a corner, with images
/// across both).
fn check_walls(mirrors: &[PlaneWall]) -> Checked {
    for (wall, mirror) in mirrors.iter().enumerate() {
        let PlaneWall { point, normal, velocity, curvature } = mirror;
        let (length, across) = (normal.norm(), velocity.dot(normal));
        let sum = point.sum() + velocity.sum() + curvature.sum();
        let mut cosines = mirrors[..wall].iter().map(|other| other.normal.dot(normal).abs());
        let skew = cosines.find(|c| *c > RIGHT_ANGLE && (c - 1.0).abs() > 1e-12);
        let (is_square, cosine) = (skew.is_none(), skew.unwrap_or_default());
        let slides = across.abs() <= 1e-12 * velocity.norm();
        let all = [
            ((length - 1.0).abs() < 1e-12, "length of its normal", length, "1"),
            (slides, "velocity along its normal", across, "0"),
            (sum.is_finite(), "sum of its components", sum, "finite"),
            (is_square, "cosine between its normal and another", cosine, "0 (corner) or 1"),
        ];
        require(Component::Wall(wall), all)?;
    }
    Ok(())
}

/// Walls that use feet need one for each wall particle, off the surface; other walls need none.
fn check_feet(reads: bool, feet: &[Vector2<f64>], walls: usize) -> Checked {
    let (count, expected) = (feet.len(), if reads { walls } else { 0 });
    let on_surface =
        feet.iter().map(Vector2::norm).find(|depth| !(*depth > 0.0 && depth.is_finite()));
    let (is_off, depth) = (on_surface.is_none(), on_surface.unwrap_or_default());
    let allowed = format!("{expected}, the number of wall particles if walls read feet, else 0");
    let all = [
        (count == expected, "number of feet", count as f64, &*allowed),
        (is_off, "depth of a wall particle in m", depth, "finite and above 0"),
    ];
    require(Component::Scene, all)
}

fn check_particles<X: Numbers>(particles: &[Particle<X>]) -> Checked {
    // Images and the sentinel have indices too; there are at most eight images per particle.
    let (count, most) = (particles.len(), (u32::MAX / 16) as usize);
    let fluid = particles.iter().filter(|p| p.role == Role::Fluid).count();
    let numbers = [
        (count <= most, "number of particles", count as f64, &*format!("at most {most}")),
        (fluid > 0, "number of fluid particles", fluid as f64, "above 0"),
    ];
    require(Component::Scene, numbers)?;
    for (particle, p) in particles.iter().enumerate() {
        let Particle { position: x, velocity: v, density, mass, extra, .. } = p;
        let is_positive = |value: f64| value > 0.0 && value.is_finite();
        let all = [
            (x.is_finite(), "position", x.sum(), "finite"),
            (v.is_finite(), "velocity", v.sum(), "finite"),
            (is_positive(*density), "density", *density, "finite and above 0"),
            (is_positive(*mass), "mass", *mass, "finite and above 0"),
            (extra.is_finite(), "extra field", f64::NAN, "finite"),
        ];
        require(Component::Particle(particle), all)?;
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
    let place = move |(i, j)| first + Vector2::new(i as f64, j as f64) * dx;
    (0..rows).flat_map(move |j| (0..columns).map(move |i| (i, j))).map(place)
}
