//! Particle data in three kinds: fixed, evolved, and derived (the column that a pair sweep reads).
//!
//! The integrator advances [`State`] only. A [`SweptParticle`] is derived from it before each sweep,
//! laid out for the pair sweep.

use crate::lane::Lane;
use nalgebra::Vector2;

use crate::numbers::Numbers;

/// The role of a particle in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Moves by the equations of the scene.
    Fluid,
    /// Behind a wall: does not move; its density evolves by the terms of the walls.
    Wall,
    /// On a wall: does not move; constant density and pressure.
    Interface,
}

/// One particle, as input of a scene and as output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle<X = ()> {
    /// Role in the scene.
    pub role: Role,
    /// Position \[m\].
    pub position: Vector2<f64>,
    /// Velocity \[m/s\]; of a wall particle, the wall's.
    pub velocity: Vector2<f64>,
    /// Density \[kg/m³\].
    pub density: f64,
    /// Mass per unit depth \[kg/m\].
    pub mass: f64,
    /// Further fields that the terms integrate.
    pub extra: X,
}

impl<X: Numbers> Particle<X> {
    /// A fluid particle.
    pub fn fluid(
        position: Vector2<f64>,
        velocity: Vector2<f64>,
        density: f64,
        volume: f64,
    ) -> Self {
        let (mass, extra) = (density * volume, X::default());
        Self { role: Role::Fluid, position, velocity, density, mass, extra }
    }

    /// This particle in another role.
    pub fn with_role(self, role: Role) -> Self {
        Self { role, ..self }
    }
}

/// Numbers of a particle that never change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constants {
    pub mass: f64,
    pub id: u32,
    pub role: Role,
}

/// Numbers of a particle that the integrator advances; `X` holds the extra fields of terms, `()` for a fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<X> {
    /// Position \[m\].
    pub position: Vector2<f64>,
    /// Velocity \[m/s\].
    pub velocity: Vector2<f64>,
    /// Density \[kg/m³\].
    pub density: f64,
    /// Extra fields of the terms.
    pub extra: X,
}

const _: () = assert!(size_of::<State<()>>() == 40, "a fluid evolves x, v and rho only");

/// d/dt of [`State`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Rate<X> {
    /// dx/dt \[m/s\].
    pub position: Vector2<f64>,
    /// dv/dt \[m/s²\].
    pub velocity: Vector2<f64>,
    /// dρ/dt \[kg/m³/s\].
    pub density: f64,
    /// d/dt of the extra fields.
    pub extra: X,
}

impl<X: Numbers> State<X> {
    /// The velocity alone advanced by dt.
    #[inline(always)]
    pub fn kick(&mut self, dt: f64, rate: &Rate<X>) {
        self.velocity += rate.velocity * dt;
    }

    /// Everything but the velocity advanced by dt.
    #[inline(always)]
    pub fn drift(&mut self, dt: f64, rate: &Rate<X>) {
        self.position += rate.position * dt;
        self.density += dt * rate.density;
        self.extra = self.extra.advanced(dt, rate.extra);
    }

    /// All numbers advanced by dt.
    #[inline(always)]
    pub fn advanced(mut self, dt: f64, rate: &Rate<X>) -> Self {
        self.drift(dt, rate);
        self.kick(dt, rate);
        self
    }

    /// The first field that no simulation may reach, and its value or length: not finite, or a density not
    /// above 0.
    pub(crate) fn fault(&self) -> Option<(&'static str, f64)> {
        let Self { position, velocity, density, extra } = self;
        match *density {
            _ if !position.is_finite() => Some(("position", position.norm())),
            _ if !velocity.is_finite() => Some(("velocity", velocity.norm())),
            density if !(density.is_finite() && density > 0.0) => Some(("density", density)),
            _ if !extra.is_finite() => Some(("extra", f64::NAN)),
            _ => None,
        }
    }
}

/// Numbers of a particle, or of one a lane, that every term may read.
#[derive(Clone, Copy, Debug)]
pub struct Common<V = f64> {
    /// Mass per unit depth \[kg/m\].
    pub mass: V,
    /// Density \[kg/m³\].
    pub density: V,
    /// Volume m/ρ per unit depth \[m²\].
    pub volume: V,
}

impl Common {
    /// This particle in every lane.
    #[inline(always)]
    pub fn spread<V: Lane>(self) -> Common<V> {
        Common {
            mass: V::all(self.mass),
            density: V::all(self.density),
            volume: V::all(self.volume),
        }
    }
}

/// A particle as read by pair sweeps; `S` holds the derived data of the terms. Columns are packed: they take
/// no more memory than their numbers.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SweptParticle<S = ()> {
    /// Position \[m\].
    pub position: Vector2<f64>,
    /// Velocity \[m/s\].
    pub velocity: Vector2<f64>,
    /// Mass, density, volume.
    pub common: Common,
    /// Derived data of the terms.
    pub derived: S,
}

const _: () = assert!(size_of::<SweptParticle<f64>>() == 64, "a fluid shows 64 bytes");

impl<S: Numbers> SweptParticle<S> {
    /// Fills the empty lanes of a group: so far away that every kernel is 0, without mass or volume.
    pub(crate) fn sentinel() -> Self {
        let common = Common { mass: 0.0, density: 1.0, volume: 0.0 };
        let far = Vector2::new(1e100, 1e100);
        Self { position: far, velocity: Vector2::zeros(), common, derived: S::default() }
    }

    /// Columns without derived numbers.
    pub(crate) fn plain(columns: &[Self]) -> Vec<SweptParticle> {
        let mut plain = Vec::with_capacity(columns.len());
        for &Self { position, velocity, common, .. } in columns {
            plain.push(SweptParticle { position, velocity, common, derived: () });
        }
        plain
    }
}
