//! Exact symmetries of the equations: the same problem as another observer sees it, and back.

use std::any::Any;
use std::fmt;

use base::{
    functions::{cos, sin},
    random::Random,
};
use nalgebra::{Matrix2, Vector2};
use solver::{Domain, Limits, Numbers, Particle, PlaneWall, Symmetric, Tait};

use crate::medium::Medium;

/// How another observer differs. Every solver of the equations must tell both the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// In nothing.
    Same,
    /// Turned by 37°, an angle of no lattice.
    Turned,
    /// Sees a mirror image: x → −x.
    Mirrored,
    /// Moves with a constant velocity of half the sound speed (Galilei).
    Boosted,
    /// Measures in 1/8 m, 1/32 s and 4 kg/m: no number is rounded.
    BinaryUnits,
    /// Measures in feet, minutes and pounds per foot.
    OtherUnits,
    /// Numbers the particles otherwise.
    Renumbered,
    /// Stands elsewhere; a periodic box stays where it is, so that its border cuts elsewhere.
    Shifted,
}

impl Relation {
    /// All of them, and before them the observer that they are compared with.
    pub const ALL: [Self; 8] = [
        Self::Same,
        Self::Turned,
        Self::Mirrored,
        Self::Boosted,
        Self::BinaryUnits,
        Self::OtherUnits,
        Self::Renumbered,
        Self::Shifted,
    ];

    /// The name in commands and documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Turned => "turned",
            Self::Mirrored => "mirrored",
            Self::Boosted => "boosted",
            Self::BinaryUnits => "binary-units",
            Self::OtherUnits => "other-units",
            Self::Renumbered => "renumbered",
            Self::Shifted => "shifted",
        }
    }

    /// The relation of that name.
    ///
    /// # Errors
    /// All names.
    pub fn named(name: &str) -> Result<Self, String> {
        let known = || Self::ALL.map(Self::name).join(", ");
        let found = Self::ALL.into_iter().find(|relation| relation.name() == name);
        found.ok_or_else(|| format!("{name:?} is no relation; these are {}", known()))
    }

    /// Does it round no number of our solver? This sums over particles in the order of their places, but over
    /// those of walls in the order of their numbers.
    pub fn is_bitwise(self, has_walls: bool) -> bool {
        self == Self::BinaryUnits || self == Self::Renumbered && !has_walls
    }
}

impl fmt::Display for Relation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Why a relation does not hold for a scene.
pub type NoSymmetry = &'static str;

/// What an observer sees: x' = (Q x + s + U t)/\[L\], v' = (Q v + U) \[T\]/\[L\], in units \[L\] m, \[T\] s
/// and \[M\] kg/m.
#[derive(Clone, Copy, Debug)]
pub struct View {
    relation: Relation,
    turn: Matrix2<f64>,
    shift: Vector2<f64>,
    boost: Vector2<f64>,
    /// 1/\[L\], 1/\[T\], 1/\[M\].
    length: f64,
    time: f64,
    mass: f64,
}

/// 1 ft \[m\].
const FOOT: f64 = 0.3048;
/// 1 lb \[kg\].
const POUND: f64 = 0.453_592_37;

impl Default for View {
    /// The same as ours.
    fn default() -> Self {
        let (turn, shift, boost) = (Matrix2::identity(), Vector2::zeros(), Vector2::zeros());
        let relation = Relation::Same;
        Self { relation, turn, shift, boost, length: 1.0, time: 1.0, mass: 1.0 }
    }
}

impl View {
    /// How a scene looks by a relation. `moves` says which of its particles do.
    ///
    /// # Errors
    /// Why the relation is no symmetry of it.
    pub fn of(
        relation: Relation,
        medium: &Medium,
        domain: &Domain,
        mirrors: &[PlaneWall],
        moves: &[bool],
    ) -> Result<Self, NoSymmetry> {
        let has_walls = moves.contains(&false);
        let same = Self { relation, ..Self::default() };
        Ok(match relation {
            Relation::Same | Relation::Renumbered => same,
            Relation::Turned if domain.period != [None, None] => {
                return Err("a periodic box cannot be turned out of its axes");
            }
            Relation::Turned => {
                let (c, s) = (cos(37_f64.to_radians()), sin(37_f64.to_radians()));
                View { turn: Matrix2::new(c, -s, s, c), ..same }
            }
            Relation::Mirrored => View { turn: Matrix2::new(-1.0, 0.0, 0.0, 1.0), ..same },
            Relation::Boosted => {
                let boost = direction(medium, mirrors, has_walls)? * (0.5 * medium.sound_speed);
                View { boost, ..same }
            }
            Relation::BinaryUnits => View { length: 8.0, time: 32.0, mass: 0.25, ..same },
            Relation::OtherUnits => {
                View { length: 1.0 / FOOT, time: 1.0 / 60.0, mass: FOOT / POUND, ..same }
            }
            Relation::Shifted => {
                let along = |axis: usize, lengths: f64| {
                    domain.period[axis].map_or(lengths * medium.h, |period| 0.37 * period)
                };
                View { shift: Vector2::new(along(0, 17.3), along(1, -11.9)), ..same }
            }
        })
    }

    /// The relation.
    pub fn relation(&self) -> Relation {
        self.relation
    }

    fn speed(&self) -> f64 {
        self.length / self.time
    }

    fn density(&self) -> f64 {
        self.mass / (self.length * self.length)
    }

    fn pressure(&self) -> f64 {
        self.density() * self.speed() * self.speed()
    }

    /// A time \[s\].
    pub fn time(&self, time: f64) -> f64 {
        time * self.time
    }

    fn place(&self, place: Vector2<f64>) -> Vector2<f64> {
        (self.turn * place + self.shift) * self.length
    }

    fn velocity(&self, velocity: Vector2<f64>) -> Vector2<f64> {
        (self.turn * velocity + self.boost) * self.speed()
    }

    /// A displacement as the observer sees it, as a function of the place that the observer sees.
    pub fn displacement(
        &self,
        by: impl Fn(Vector2<f64>) -> Vector2<f64>,
        place: Vector2<f64>,
    ) -> Vector2<f64> {
        self.turn * by(self.turn.transpose() * (place / self.length - self.shift)) * self.length
    }

    /// The material and its forces.
    pub fn medium(&self, m: &Medium) -> Medium {
        let acceleration = self.turn * (self.speed() / self.time);
        let eos = Tait {
            density: m.eos.density * self.density(),
            sound_speed: m.eos.sound_speed * self.speed(),
            background: m.eos.background * self.pressure(),
            ..m.eos
        };
        Medium {
            eos,
            density: m.density * self.density(),
            sound_speed: m.sound_speed * self.speed(),
            dx: m.dx * self.length,
            h: m.h * self.length,
            w_at_spacing: m.w_at_spacing / (self.length * self.length),
            nu: m.nu * self.length * self.speed(),
            shear_modulus: m.shear_modulus * self.pressure(),
            acceleration: acceleration * m.acceleration,
            wall_acceleration: acceleration * m.wall_acceleration,
            ..*m
        }
    }

    /// The pressure \[Pa\] of a density \[kg/m³\], both as the observer sees them.
    pub fn pressure_of(&self, pressure: impl Fn(f64) -> f64, density: f64) -> f64 {
        pressure(density / self.density()) * self.pressure()
    }

    /// The periodic box, which is not shifted.
    pub fn domain(&self, domain: Domain) -> Domain {
        let low = |axis: usize| match (self.relation, axis, domain.period[0]) {
            (Relation::Mirrored, 0, Some(period)) => -(domain.low.x + period),
            _ => domain.low[axis],
        };
        let period = domain.period.map(|period| period.map(|period| period * self.length));
        Domain { low: Vector2::new(low(0), low(1)) * self.length, period }
    }

    /// A wall.
    pub fn wall(&self, wall: &PlaneWall) -> PlaneWall {
        let curvature = self.speed() / (self.length * self.length);
        PlaneWall {
            point: self.place(wall.point),
            normal: self.turn * wall.normal,
            velocity: self.velocity(wall.velocity),
            curvature: self.turn * wall.curvature * curvature,
        }
    }

    /// Bounds of a run, which are no narrower.
    pub fn limits(&self, limits: Limits) -> Limits {
        let speed = (limits.speed + self.boost.norm()) * self.speed();
        Limits { density: limits.density.map(|density| density * self.density()), speed }
    }

    /// A length \[m\].
    pub fn length(&self, length: f64) -> f64 {
        length * self.length
    }

    /// A particle at the start.
    pub fn particle<X: Numbers>(&self, p: &Particle<X>) -> Particle<X> {
        let mut extra = X::default().advanced(self.pressure(), p.extra);
        if let Some(stress) = (&mut extra as &mut dyn Any).downcast_mut::<Symmetric>() {
            let Symmetric { xx, yy, xy } = *stress;
            let turned = self.turn * Matrix2::new(xx, xy, xy, yy) * self.turn.transpose();
            *stress = Symmetric { xx: turned.m11, yy: turned.m22, xy: turned.m12 };
        }
        Particle {
            position: self.place(p.position),
            velocity: self.velocity(p.velocity),
            density: p.density * self.density(),
            mass: p.mass * self.mass,
            extra,
            ..*p
        }
    }

    /// Place, velocity and density at a time \[s\] of what the observer sees.
    pub fn back(
        &self,
        time: f64,
        [place, velocity]: [Vector2<f64>; 2],
        density: Option<f64>,
    ) -> ([Vector2<f64>; 2], Option<f64>) {
        let back = self.turn.transpose();
        let place = back * (place / self.length - self.shift - self.boost * time);
        let velocity = back * (velocity / self.speed() - self.boost);
        ([place, velocity], density.map(|density| density / self.density()))
    }

    /// Items by the number that their particles had, in the order of the numbers that they get; none stay
    /// none. `moves` says which particles do.
    pub fn order<T: Clone>(&self, items: &[T], moves: &[bool]) -> Vec<T> {
        self.numbers(moves).into_iter().filter_map(|k| items.get(k).cloned()).collect()
    }

    /// The number that each particle had, by the number that it gets: that of one which moves if it does, so
    /// that it does not depend on the others.
    pub fn numbers(&self, moves: &[bool]) -> Vec<usize> {
        let mut numbers: Vec<usize> = (0..moves.len()).collect();
        let mut random = Random::new(8);
        for kind in [true, false] {
            let places: Vec<usize> = (0..moves.len()).filter(|k| moves[*k] == kind).collect();
            for k in (1..places.len()).rev().filter(|_| self.relation == Relation::Renumbered) {
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
    has_walls: bool,
) -> Result<Vector2<f64>, NoSymmetry> {
    let Some(first) = mirrors.first() else {
        return match has_walls {
            true => Err("its walls are particles, which stay where they are"),
            false => Ok(Vector2::new(cos(0.7), sin(0.7))),
        };
    };
    if medium.shear_modulus > 0.0 {
        return Err("its planes hold a solid where it is");
    }
    let parallel = |wall: &PlaneWall| wall.normal.perp(&first.normal).abs() < 1e-12;
    match mirrors.iter().all(parallel) {
        true if !has_walls => Ok(Vector2::new(-first.normal.y, first.normal.x)),
        true => Err("its walls are particles, which stay where they are"),
        false => Err("its walls meet, so that no direction is along all of them"),
    }
}
