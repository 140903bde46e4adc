//! From settings to a scene: spacing, moduli, particles.

use std::f64::consts::TAU;

use nalgebra::{Rotation2, Vector2};
use touchstone_base::functions::rotation;
use touchstone_harness::{case::RunError, method::Properties, snapshot::Snapshot};
use touchstone_maths::geometry::layers;
use touchstone_solver::{DivergenceBounds, Particle, Symmetric};

use super::{RingSettings, measure::RingHistory};
use crate::solids::solid::{ElasticBody, Material, SolidParameters, SolidScales};

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

    /// Twice the density or twice the speed of sound is no rubber any more.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solids::{rings::RUBBER_RINGS, solid};

    #[test]
    fn mass_is_exact_and_rings_are_mirror_images() {
        let rings = RingSettings::default();
        let particles = rings.particles();
        let mass: f64 = particles.iter().map(|p| p.mass).sum();
        assert!((mass / (TAU * 7.0) - 1.0).abs() < 1e-12, "{mass}");
        let (left, right) = particles.split_at(particles.len() / 2);
        for (l, r) in left.iter().zip(right) {
            assert_eq!((l.position.x, l.position.y), (-r.position.x, r.position.y));
            assert_eq!((l.velocity.x, l.mass), (-r.velocity.x, r.mass));
        }
        let mirrored = |p: &Particle<Symmetric>| {
            left.iter().any(|q| q.position == Vector2::new(p.position.x, -p.position.y))
        };
        assert!(left.iter().all(mirrored));
        assert_eq!(rings.dx(), 0.1);
    }

    #[test]
    fn settings_that_make_no_rings_are_refused() {
        let refused = |set| {
            let error = solid::tests::refused(&RUBBER_RINGS, "leapfrog", set);
            error.unwrap_or_else(|| panic!("{set} is not refused")).to_string()
        };
        assert!(refused("centre=3.9").contains("outer radius"));
        assert!(refused("inner=3.9").contains("inner radius"));
        assert!(refused("dt=1").contains("theoretical limit"));
        assert!(refused("dt=1e-12").contains("time steps"));
    }
}
