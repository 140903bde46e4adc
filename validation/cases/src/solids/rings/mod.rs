//! Two rubber rings that collide head-on (Monaghan 2000; Gray, Monaghan & Swift 2001), in units of
//! ring size L, density ρ and bulk sound speed c₀ = √(K/ρ), plane strain.
//!
//! Judged against conservation and an independent finite-element run of one ring
//! against a frictionless plane (`references/rubber_rings`), which is half of this problem.

mod columns;
mod measure;
mod metrics;
mod plan;
mod reference;
mod studies;
#[cfg(test)]
mod tests;

use std::f64::consts::TAU;

use nalgebra::{Rotation2, Vector2};
use touchstone_base::{functions::rotation, record::Status};
use touchstone_harness::prelude::*;
use touchstone_harness::{method::Properties, snapshot::Snapshot};
use touchstone_maths::geometry::layers;
use touchstone_solver::{DivergenceBounds, Symmetric};

use crate::{
    solids::solid::{
        self, ElasticBody, LAGRANGIAN, Material, SolidParameters, SolidScales, TOTAL,
        lagrangian as total,
    },
    stabilisation::Stabilisation,
};
use measure::RingHistory;

touchstone_base::settings! {
    /// Settings of the collision of two rings; L is 1 m.
    pub struct RingSettings {
        /// inner radius
        inner: f64 ["m"] in 0.1..=1e3 = 3.0,
        /// outer radius
        outer: f64 ["m"] in 0.1..=1e3 = 4.0,
        /// distance of the ring centres from the plane in which the rings meet
        centre: f64 ["m"] in 0.1..=1e4 = 5.0,
        /// initial spacing of particles
        spacing: f64 ["m"] in 1e-3..=10.0 = 0.1,
        /// density
        rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1.0,
        /// bulk modulus K, so that c0 = (K/rho)^(1/2)
        bulk_modulus: f64 ["Pa"] in 1e-12..=1e15 = 1.0,
        /// shear modulus
        shear_modulus: f64 ["K"] in 0.0..=1.5 = 0.22,
        /// speed of each ring
        speed: f64 ["c0"] in 0.0..=1.0 = 0.059,
        /// rotation angle of the whole scene
        angle: f64 ["deg"] in -360.0..=360.0 = 0.0,
        /// end of the run
        end: f64 ["L/c0"] in 1e-3..=1e6 = 200.0,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.9..=3.0 = 1.5,
        /// time step; auto: courant h/(c_p + speed), c_p = ((K + 4 mu/3)/rho)^(1/2)
        dt: Option<f64> ["s"] in 1e-15..=1e6 = None,
        /// Courant number of the time step: half the theoretical limit
        courant: f64 ["-"] in 1e-6..=10.0 = 0.6,
        /// stabilising terms
        stabilisation: Stabilisation
            = Stabilisation { alpha: 1.0, beta: 2.0, ..Stabilisation::default() },
        /// samples of energy and shape; no time step is longer than the interval between them
        samples: usize ["-"] in 1..=100000 = 200,
    }
}

/// The variant whose artificial stress depends on the axes.
pub const COMPONENTWISE: &str = "componentwise";

/// The variant with corrected gradients.
pub const CORRECTED: &str = "corrected";

/// The Courant number of `leapfrog`: two thirds of the theoretical limit. At the paper's speed the error is
/// due to the spacing: half of the step changes the restitution by 0.15 % of its value.
const LONG_STEPS: f64 = 0.8;

fn variants() -> Compositions<RingSettings> {
    use touchstone_schemes::solid::{componentwise, corrected, leapfrog, seed};
    let papers = "the paper's: cubic spline, predictor-corrector, artificial viscosity, XSPH, artificial \
                  stress in principal axes";
    let by_components = "the seed with artificial stress component by component, as the paper writes it: \
                         does the answer depend on the axes?";
    let staggered = "the seed with the staggered leapfrog, one right-hand side a step, and longer steps: \
                     does that change anything but the cost?";
    let conjugate = "the terms of `leapfrog` without XSPH, with corrected gradients and conjugate forces: \
                     what is the effect of uncorrected gradients at free faces?";
    solid::no_variants::<RingSettings>()
        .with("seed", papers, seed(), |_| {})
        .with(COMPONENTWISE, by_components, componentwise(), |_| {})
        .with("leapfrog", staggered, leapfrog(), |s| s.courant = LONG_STEPS)
        .with(CORRECTED, conjugate, corrected(), |s| {
            (s.courant, s.stabilisation.xsph) = (LONG_STEPS, 0.0)
        })
        .with(LAGRANGIAN, TOTAL, touchstone_schemes::total::hencky(), |s| {
            total::choose(s);
            s.courant = total::COURANT_OF_FOLDS;
        })
        .all
}

/// Colliding rubber rings.
pub static RUBBER_RINGS: Composed<RingSettings> = Composed {
    name: "rubber_rings",
    problem: "Two rubber rings collide and bounce",
    recommended: Recommended {
        variant: LAGRANGIAN,
        because: "with five layers its centre, width and height over time are \
                  1.0 %<!-- rubber_rings.lagrangian; spacing=0.2; histories --> of the diameter away from \
                  finite elements, those of `seed` 14 %<!-- rubber_rings.seed; spacing=0.2; histories -->",
        papers: Some("seed"),
    },
    about: "Two rubber rings, inner radius 3, outer radius 4, fly at each other at 0.059 of the bulk sound \
            speed each, touch, flatten, and part. Plane strain, shear modulus 0.22 K. By symmetry it is one \
            ring against a frictionless plane, which finite elements have computed independently. Momentum \
            is exact, and a ring must not break: numerical fracture is the tensile instability that \
            artificial stress is there to prevent.",
    variants,
    facts: studies::facts,
    studies: studies::studies,
};

/// The largest energy at any time over the initial one, minus 1: the error of stress rates in time.
const MOST_ENERGY_GAINED: f64 = 0.01;

/// No force drives the rings, so a run is stable if it completes and its energy never rises.
fn is_stable(record: &Record) -> bool {
    let gained = record.value(metrics::ENERGY_GAINED);
    record.status == Status::Completed && gained.is_some_and(|gained| gained <= MOST_ENERGY_GAINED)
}

/// The largest number of layers that stay whole with corrected gradients at the paper's speed. Rings of 20
/// tear at the inner face (docs/limits.md).
const MOST_CORRECTED: f64 = 10.0;

impl RingSettings {
    /// Bulk sound speed c₀ \[m/s\].
    pub fn c0(&self) -> f64 {
        self.material().sound_speed()
    }

    /// Layers of particles.
    fn layers(&self) -> f64 {
        ((self.outer - self.inner) / self.spacing).round().max(1.0)
    }

    /// Rotates the line of flight to the x axis.
    pub fn to_flight(&self) -> Rotation2<f64> {
        rotation(-self.angle.to_radians())
    }
}

impl ElasticBody for RingSettings {
    type Watch = RingHistory;

    fn common(&self) -> SolidParameters {
        let shear = self.shear_modulus * self.bulk_modulus;
        let material = Material { density: self.rho, bulk: self.bulk_modulus, shear };
        SolidParameters {
            material,
            h_over_dx: self.h_over_dx,
            dt: self.dt,
            courant: Some(self.courant),
        }
    }

    /// Twice the density or twice the speed of sound is unphysical for rubber.
    fn scales(&self) -> SolidScales {
        let (dx, c0) = ((self.outer - self.inner) / self.layers(), self.c0());
        let (density, speed) = (self.rho, self.speed * c0);
        let most = 2.0 * (self.material().p_wave_speed() + speed);
        SolidScales {
            dx,
            length: 2.0 * self.outer,
            speed,
            end: self.end / c0,
            count: TAU * (self.outer * self.outer - self.inner * self.inner) / (dx * dx),
            decisive: "end, dt, courant, spacing or outer",
            meet: true,
            stops: self.samples,
            bounds: DivergenceBounds { density: [0.5 * density, 2.0 * density], speed: most },
            ..SolidScales::default()
        }
    }

    fn check(&self) -> Result<(), RunError> {
        let too_much =
            |what, value, most, setting| Err(RunError::TooMuch { what, value, most, setting });
        let widest = self.outer - 2.0 * self.spacing;
        if self.inner > widest {
            return too_much("the inner radius", self.inner, widest, "inner, outer or spacing");
        }
        if self.outer > self.centre {
            // The rings would overlap before the first step.
            return too_much("the outer radius", self.outer, self.centre, "outer or centre");
        }
        Ok(())
    }

    fn unstable(&self, method: &Properties) -> Option<RunError> {
        (method.is_corrected && self.layers() > MOST_CORRECTED).then(|| RunError::TooMuch {
            what: "the number of layers of rings with corrected gradients",
            value: self.layers(),
            most: MOST_CORRECTED,
            setting: "spacing, or use --allow-unstable",
        })
    }

    /// The ring on the right is the mirror image of the one on the left, in the same order.
    fn particles(&self) -> Vec<Particle<Symmetric>> {
        let (dx, v) = (self.dx(), self.speed());
        let rotation = self.to_flight().inverse();
        let places = layers([self.inner, self.outer], dx);
        let ring = |side: f64| {
            // On the right: the mirror image, to the last bit.
            places.iter().map(move |(place, volume)| {
                let place = Vector2::new(side * (self.centre + place.x), place.y);
                let velocity = Vector2::new(-side * v, 0.0);
                Particle::fluid(rotation * place, rotation * velocity, self.rho, *volume)
            })
        };
        ring(-1.0).chain(ring(1.0)).collect()
    }

    fn watch(&self, scene: &Snapshot<Symmetric>, start: &Snapshot<Symmetric>) -> RingHistory {
        RingHistory::new(self, scene, start)
    }
}
