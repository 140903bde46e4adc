//! Exact symmetries of the equations: transformations of a problem to the frame of another observer, and
//! back.

use nalgebra::{Matrix2, Vector2};
use touchstone_base::{
    functions::{cos, sin},
    random::Random,
    text::short,
};
use touchstone_solver::{Domain, Numbers, Particle, PlaneWall, Symmetric, Tait};

use crate::medium::Medium;

/// The frame of another observer. A solver of the equations must give equal results in both frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// In nothing.
    Same,
    /// Turned by 37°, an angle of no lattice.
    Turned,
    /// A mirror image: x → −x.
    Mirrored,
    /// Moves with a constant velocity of half the sound speed (Galilei).
    Boosted,
    /// Measures in 1/8 m, 1/32 s and 4 kg/m, which rounds no number.
    BinaryUnits,
    /// Measures in feet, minutes and pounds per foot.
    OtherUnits,
    /// Numbers the particles otherwise.
    Renumbered,
    /// A shifted origin; a periodic box stays in place, so that its border cuts the fluid elsewhere.
    Shifted,
}

use Relation::{BinaryUnits, Boosted, Mirrored, OtherUnits, Renumbered, Same, Shifted, Turned};

impl Relation {
    /// All relations; the first is the reference of the others.
    pub const ALL: [Self; 8] =
        [Same, Turned, Mirrored, Boosted, BinaryUnits, OtherUnits, Renumbered, Shifted];

    /// The name in commands and documents.
    pub fn name(self) -> &'static str {
        match self {
            Same => "same",
            Turned => "turned",
            Mirrored => "mirrored",
            Boosted => "boosted",
            BinaryUnits => "binary-units",
            OtherUnits => "other-units",
            Renumbered => "renumbered",
            Shifted => "shifted",
        }
    }

    /// The relation of that name.
    ///
    /// # Errors
    /// All names.
    pub fn named(name: &str) -> Result<Self, String> {
        let known = || Self::ALL.map(Self::name).join(", ");
        let found = Self::ALL.into_iter().find(|of| of.name() == name);
        found.ok_or_else(|| format!("{:?} is none of {}", short(name), known()))
    }

    /// Whether the relation rounds no number of our solver, which sums over particles in the order of their
    /// places, but over wall particles in the order of their numbers.
    pub fn is_bitwise(self, has_walls: bool) -> bool {
        self == BinaryUnits || self == Renumbered && !has_walls
    }
}

/// Why a relation does not hold for a scene.
pub type NoSymmetry = &'static str;

/// Numbers of length, time and mass per length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units<T> {
    /// Length \[m\].
    pub length: T,
    /// Time \[s\].
    pub time: T,
    /// Mass per length \[kg/m\].
    pub mass: T,
}

/// SI units.
pub const SI: Units<f64> = Units { length: 1.0, time: 1.0, mass: 1.0 };

/// Inverses of 1/8 m, 1/32 s and 4 kg/m.
const BINARY: Units<f64> = Units { length: 8.0, time: 32.0, mass: 0.25 };

/// Inverses of a foot (0.3048 m), a minute and a pound (0.45359237 kg) per foot.
const OTHER: Units<f64> =
    Units { length: 1.0 / 0.3048, time: 1.0 / 60.0, mass: 0.3048 / 0.453_592_37 };

/// The unit of a quantity, by exponents.
pub type Unit = Units<i32>;
/// \[m\].
pub const LENGTH: Unit = Unit { length: 1, time: 0, mass: 0 };
/// \[s\].
pub const TIME: Unit = Unit { length: 0, time: 1, mass: 0 };
/// \[kg/m³\].
pub const DENSITY: Unit = Unit { length: -2, time: 0, mass: 1 };
const SPEED: Unit = Unit { length: 1, time: -1, mass: 0 };
const PRESSURE: Unit = Unit { length: 0, time: -2, mass: 1 };

/// The frame of an observer: x' = (Q x + s + U t)/\[L\], v' = (Q v + U) \[T\]/\[L\], in units \[L\] m, \[T\]
/// s and \[M\] kg/m.
#[derive(Clone, Copy, Debug)]
pub struct View {
    relation: Relation,
    turn: Matrix2<f64>,
    shift: Vector2<f64>,
    boost: Vector2<f64>,
    /// 1/\[L\], 1/\[T\], 1/\[M\].
    units: Units<f64>,
}

impl Default for View {
    /// Our own frame.
    fn default() -> Self {
        let (turn, shift, boost) = (Matrix2::identity(), Vector2::zeros(), Vector2::zeros());
        Self { relation: Same, turn, shift, boost, units: SI }
    }
}

impl View {
    /// The transformation of a scene by a relation. `moves` marks its moving particles.
    ///
    /// # Errors
    /// Why the relation is not a symmetry of it.
    pub fn of(
        relation: Relation,
        medium: &Medium,
        domain: &Domain,
        mirrors: &[PlaneWall],
        moves: &[bool],
    ) -> Result<Self, NoSymmetry> {
        let same = Self { relation, ..Self::default() };
        let along = |axis: usize, lengths: f64| {
            domain.period[axis].map_or(lengths * medium.h, |period| 0.37 * period)
        };
        let (c, s) = (cos(37_f64.to_radians()), sin(37_f64.to_radians()));
        Ok(match relation {
            Same | Renumbered => same,
            Turned if domain.period != [None, None] => {
                return Err("a periodic box cannot be turned out of its axes");
            }
            Turned => View { turn: Matrix2::new(c, -s, s, c), ..same },
            Mirrored => View { turn: Matrix2::new(-1.0, 0.0, 0.0, 1.0), ..same },
            Boosted => {
                let boost = direction(medium, mirrors, moves)? * (0.5 * medium.sound_speed);
                View { boost, ..same }
            }
            BinaryUnits => View { units: BINARY, ..same },
            OtherUnits => View { units: OTHER, ..same },
            Shifted => View { shift: Vector2::new(along(0, 17.3), along(1, -11.9)), ..same },
        })
    }

    /// The units of length \[m\], of time \[s\] and of mass a depth \[kg/m\].
    pub fn units(&self) -> Units<f64> {
        let Units { length, time, mass } = self.units;
        Units { length: 1.0 / length, time: 1.0 / time, mass: 1.0 / mass }
    }

    /// The factor of a quantity with this unit.
    pub fn scale(&self, unit: Unit) -> f64 {
        let Units { length, time, mass } = self.units;
        length.powi(unit.length) * time.powi(unit.time) * mass.powi(unit.mass)
    }

    /// The most of a speed \[m/s\].
    pub fn speed(&self, speed: f64) -> f64 {
        (speed + self.boost.norm()) * self.scale(SPEED)
    }

    fn place(&self, place: Vector2<f64>) -> Vector2<f64> {
        (self.turn * place + self.shift) * self.scale(LENGTH)
    }

    fn velocity(&self, velocity: Vector2<f64>) -> Vector2<f64> {
        (self.turn * velocity + self.boost) * self.scale(SPEED)
    }

    /// A displacement as a function of the place, both in the observer's frame.
    pub fn displacement(
        &self,
        by: impl Fn(Vector2<f64>) -> Vector2<f64>,
        place: Vector2<f64>,
    ) -> Vector2<f64> {
        let length = self.scale(LENGTH);
        self.turn * by(self.turn.transpose() * (place / length - self.shift)) * length
    }

    /// The pressure \[Pa\] of a density \[kg/m³\], both in the observer's units.
    pub fn pressure_of(&self, pressure: impl Fn(f64) -> f64, density: f64) -> f64 {
        pressure(density / self.scale(DENSITY)) * self.scale(PRESSURE)
    }

    /// The material and its forces.
    pub fn medium(&self, m: Medium) -> Medium {
        let in_unit = |number: f64, unit| number * self.scale(unit);
        let turned = |acceleration| {
            self.turn * acceleration * self.scale(Unit { length: 1, time: -2, mass: 0 })
        };
        Medium {
            eos: Tait {
                density: in_unit(m.eos.density, DENSITY),
                sound_speed: in_unit(m.eos.sound_speed, SPEED),
                background: in_unit(m.eos.background, PRESSURE),
                gamma: m.eos.gamma,
            },
            density: in_unit(m.density, DENSITY),
            sound_speed: in_unit(m.sound_speed, SPEED),
            dx: in_unit(m.dx, LENGTH),
            h: in_unit(m.h, LENGTH),
            w_at_spacing: in_unit(m.w_at_spacing, Unit { length: -2, time: 0, mass: 0 }),
            nu: in_unit(m.nu, Unit { length: 2, time: -1, mass: 0 }),
            shear_modulus: in_unit(m.shear_modulus, PRESSURE),
            acceleration: turned(m.acceleration),
            wall_acceleration: turned(m.wall_acceleration),
            stiffest: m.stiffest,
            eta2_over_h2: m.eta2_over_h2,
            alpha: m.alpha,
            beta: m.beta,
            xsph: m.xsph,
            xi: m.xi,
            exponent: m.exponent,
            diffusion: m.diffusion,
            damper: m.damper,
            shift: m.shift,
        }
    }

    /// The periodic box, which is not shifted.
    pub fn domain(&self, mut domain: Domain) -> Domain {
        if let (Mirrored, Some(period)) = (self.relation, domain.period[0]) {
            domain.low.x = -(domain.low.x + period);
        }
        let period = domain.period.map(|period| period.map(|period| period * self.scale(LENGTH)));
        Domain { low: domain.low * self.scale(LENGTH), period }
    }

    /// A wall.
    pub fn wall(&self, wall: &PlaneWall) -> PlaneWall {
        PlaneWall {
            point: self.place(wall.point),
            normal: self.turn * wall.normal,
            velocity: self.velocity(wall.velocity),
            curvature: self.turn
                * wall.curvature
                * self.scale(Unit { length: -1, time: -1, mass: 0 }),
        }
    }

    /// A particle at the start.
    pub fn particle<X: Numbers>(&self, p: &Particle<X>) -> Particle<X> {
        let scaled = X::default().advanced(self.scale(PRESSURE), p.extra);
        let extra = scaled.stress().map_or(scaled, |Symmetric { xx, yy, xy }| {
            let turned = self.turn * Matrix2::new(xx, xy, xy, yy) * self.turn.transpose();
            X::of_stress(Symmetric::new(turned.m11, turned.m22, turned.m12))
        });
        let (position, velocity) = (self.place(p.position), self.velocity(p.velocity));
        let (density, mass) = (p.density * self.scale(DENSITY), p.mass * self.units.mass);
        Particle { position, velocity, density, mass, extra, ..*p }
    }

    /// Transforms a place and a velocity at a time \[s\] from the observer's frame back.
    pub fn back(&self, time: f64, [place, velocity]: [Vector2<f64>; 2]) -> [Vector2<f64>; 2] {
        let place = place / self.scale(LENGTH) - self.shift - self.boost * time;
        let velocity = velocity / self.scale(SPEED) - self.boost;
        [place, velocity].map(|vector| self.turn.transpose() * vector)
    }

    /// The original number of each particle by its new number; moving particles exchange numbers only among
    /// themselves, so that their numbers do not depend on the others.
    pub fn numbers(&self, moves: &[bool]) -> Vec<usize> {
        let mut numbers: Vec<usize> = (0..moves.len()).collect();
        let mut random = Random::new(8);
        for kind in [true, false].into_iter().filter(|_| self.relation == Renumbered) {
            let places: Vec<usize> = (0..moves.len()).filter(|k| moves[*k] == kind).collect();
            for k in (1..places.len()).rev() {
                numbers.swap(places[k], places[((k + 1) as f64 * random.uniform()) as usize]);
            }
        }
        numbers
    }
}

/// A direction along which everything in a scene can move together.
fn direction(
    medium: &Medium,
    mirrors: &[PlaneWall],
    moves: &[bool],
) -> Result<Vector2<f64>, NoSymmetry> {
    let normal = mirrors.first().map_or(Vector2::new(-sin(0.7), cos(0.7)), |wall| wall.normal);
    let is_along = |wall: &PlaneWall| wall.normal.perp(&normal).abs() < 1e-12;
    match mirrors.is_empty() {
        _ if moves.contains(&false) => Err("its walls are particles at rest"),
        false if medium.shear_modulus > 0.0 => Err("its planes hold a solid at rest"),
        false if !mirrors.iter().all(is_along) => {
            Err("its walls meet, so no velocity is along all of them")
        }
        _ => Ok(Vector2::new(normal.y, -normal.x)),
    }
}

#[cfg(test)]
mod tests {
    use touchstone_solver::Symmetric;

    use super::*;

    /// 1 m/s is at most 6 m/s for an observer who moves with 5 m/s, in his units.
    #[test]
    fn the_largest_speed_is_that_against_the_observer() {
        let (boost, units) = (Vector2::new(3.0, -4.0), BINARY);
        let view = View { boost, units, ..View::default() };
        assert_eq!(view.speed(1.0), 6.0 * 8.0 / 32.0);
    }

    /// The force on a cut of a stressed body turns with the body and the cut: S' Q n = Q S n, with the unit
    /// of a pressure, and stays as large as it was. No scene starts with a stress.
    #[test]
    fn the_stress_of_a_particle_is_turned_with_it() {
        let (c, s) = (0.8, 0.6);
        for (turn, units) in [
            (Matrix2::new(c, -s, s, c), SI),
            (Matrix2::new(-1.0, 0.0, 0.0, 1.0), SI),
            (Matrix2::identity(), BINARY),
            (Matrix2::new(c, s, -s, c), Units { length: 2.0, time: 0.5, mass: 3.0 }),
        ] {
            let view = View { turn, units, ..View::default() };
            let [xx, yy, xy] = [1.0, -2.0, 0.5];
            let at_rest: Particle = Particle::fluid(Vector2::zeros(), Vector2::zeros(), 1.0, 1.0);
            let Particle { role, position, velocity, density, mass, .. } = at_rest;
            let extra = Symmetric { xx, yy, xy };
            let seen = view.particle(&Particle { role, position, velocity, density, mass, extra });
            let matrix = |s: Symmetric| Matrix2::new(s.xx, s.xy, s.xy, s.yy);
            // N/m² is kg/m in a plane by m and s².
            let unit = units.mass / (units.time * units.time);
            for normal in [Vector2::x(), Vector2::y(), Vector2::new(0.28, 0.96)] {
                let force = matrix(seen.extra) * (turn * normal);
                let expected = turn * matrix(extra) * normal * unit;
                assert!((force - expected).norm() < 1e-12 * unit, "{force} instead of {expected}");
            }
        }
    }
}
