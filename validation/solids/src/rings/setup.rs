//! From settings to a scene: spacing, moduli, time step, particles.

use base::functions::{rotation, sin_cos};
use nalgebra::{Rotation2, Vector2};
use solver::{Domain, Limits, Particle, Symmetric};
use std::f64::consts::TAU;

use super::RingSettings;
use crate::solid::{Material, limits};
use harness::{
    case::{Rules, RunError, Step},
    context::Context,
    method::{Medium, Method, Parts},
    simulate,
};

/// The settings on which time and memory of a run depend.
const DECISIVE: &str = "end, dt, courant, spacing or outer";

/// The numbers of one run.
#[derive(Clone, Debug)]
pub struct Rings {
    /// As given.
    pub settings: RingSettings,
    /// What the rings are made of.
    pub material: Material,
    /// What terms are made from.
    pub medium: Medium,
    /// Bulk sound speed c₀ \[m/s\].
    pub c0: f64,
    /// Speed of longitudinal waves c_p \[m/s\].
    pub cp: f64,
    /// Speed of each ring V \[m/s\].
    pub v: f64,
    /// Time step, its limits in a stress-free lattice with artificial viscosity always on, end.
    pub rules: Rules,
}

/// The most layers that are known to stay whole with corrected gradients at the paper's speed. Those of 20
/// tear at the inner face (docs/limits.md).
const MOST_CORRECTED: f64 = 10.0;

impl Rings {
    /// Checks the settings and derives the rest.
    pub fn new<D: ?Sized>(
        s: &RingSettings,
        method: &Method<Symmetric, D>,
        context: &Context,
    ) -> Result<Self, RunError> {
        let too_much =
            |what, value, most, setting| Err(RunError::TooMuch { what, value, most, setting });
        let layers = ((s.outer - s.inner) / s.spacing).round().max(1.0);
        let dx = (s.outer - s.inner) / layers;
        if s.inner > s.outer - 2.0 * s.spacing {
            let most = s.outer - 2.0 * s.spacing;
            return too_much("the inner radius", s.inner, most, "inner, outer or spacing");
        }
        if method.is_corrected && layers > MOST_CORRECTED && !context.allow_unstable {
            let what = "the number of layers of rings with corrected gradients";
            return too_much(what, layers, MOST_CORRECTED, "spacing, or use --allow-unstable");
        }
        if s.outer > s.centre {
            // The rings would overlap before the first step.
            return too_much("the outer radius", s.outer, s.centre, "outer or centre");
        }
        let shear = s.shear_modulus * s.bulk_modulus;
        let material = Material { density: s.rho, bulk: s.bulk_modulus, shear };
        let (c0, cp) = (material.sound_speed(), material.p_wave_speed());
        let (v, h) = (s.speed * c0, s.h_over_dx * dx);
        let medium = Medium {
            alpha: s.alpha,
            beta: s.beta,
            xsph: s.xsph,
            xi: s.xi,
            exponent: s.exponent as u32,
            ..material.medium(method, [dx, h])
        };
        let limits = limits(method, &material, &medium, s.h_over_dx, 2.0 * v).moving(h, v, 0.0);
        let step = Step::courant(s.courant, h, [cp, v]).or_given(s.dt);
        let rules = Rules { step, limits, sound_speed: c0, end: s.end / c0 };
        let particles = TAU * (s.outer * s.outer - s.inner * s.inner) / (dx * dx);
        simulate::check(method, &medium, &rules, particles, DECISIVE, context)?;
        Ok(Self { settings: s.clone(), material, medium, c0, cp, v, rules })
    }

    /// Rotates the line of flight to the x axis.
    pub fn to_flight(&self) -> Rotation2<f64> {
        rotation(-self.settings.angle.to_radians())
    }

    /// The particles: concentric layers, their numbers multiples of four, so that mass is exact, the
    /// edge is smooth, and each ring is its own mirror image. The ring on the right is the mirror
    /// image of the one on the left, in the same order.
    pub fn particles(&self) -> Vec<Particle<Symmetric>> {
        let (s, dx) = (&self.settings, self.medium.dx);
        let rotation = self.to_flight().inverse();
        let mut places = Vec::new();
        for k in 0..((s.outer - s.inner) / dx).round() as usize {
            let r = s.inner + (k as f64 + 0.5) * dx;
            let quarter = (TAU * r / (4.0 * dx)).round().max(1.0) as usize;
            let volume = TAU * r * dx / (4 * quarter) as f64;
            places.extend((0..4 * quarter).map(|j| (r * quadrant_point(j, quarter), volume)));
        }
        let ring = |side: f64| {
            // On the right: the mirror image, to the last bit.
            places.iter().map(move |(place, volume)| {
                let place = Vector2::new(side * (s.centre + place.x), place.y);
                let velocity = Vector2::new(-side * self.v, 0.0);
                Particle::fluid(rotation * place, rotation * velocity, s.rho, *volume)
            })
        };
        ring(-1.0).chain(ring(1.0)).collect()
    }

    /// The scene.
    pub fn parts(&self, context: &Context) -> Parts<Symmetric> {
        let density = self.material.density;
        // Twice the density or twice the speed of sound is no rubber any more.
        let speed = 2.0 * (self.cp + self.v);
        let limits = Limits { density: [0.5 * density, 2.0 * density], speed };
        let (medium, particles) = (self.medium, self.particles());
        let body = |k: usize| u32::from(k >= particles.len() / 2);
        let bodies = (0..particles.len()).map(body).collect();
        Parts { limits, bodies, ..Parts::new(medium, Domain::open(), particles, context) }
    }
}

/// The unit vector number j of 4 `quarter`, which begin half a step above the x axis; the four
/// quadrants are mirror images of the first to the last bit.
fn quadrant_point(j: usize, quarter: usize) -> Vector2<f64> {
    let (quadrant, k) = (j / quarter, j % quarter);
    let k = if quadrant % 2 == 0 { k } else { quarter - 1 - k };
    let (sin, cos) = sin_cos(TAU * (k as f64 + 0.5) / (4 * quarter) as f64);
    let x = if quadrant == 0 || quadrant == 3 { cos } else { -cos };
    Vector2::new(x, if quadrant < 2 { sin } else { -sin })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::Rubber;
    use solver::Leapfrog;

    fn rings(settings: &RingSettings) -> Result<Rings, RunError> {
        Rings::new(settings, &Method::of::<Rubber<(), Leapfrog>>(), &Context::default())
    }

    #[test]
    fn mass_is_exact_and_rings_are_mirror_images() {
        let rings = rings(&RingSettings::default()).unwrap();
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
        assert_eq!(rings.medium.dx, 0.1);
    }

    #[test]
    fn settings_that_make_no_rings_are_refused() {
        let refused = |change: fn(&mut RingSettings)| {
            let mut settings = RingSettings::default();
            change(&mut settings);
            rings(&settings).unwrap_err().to_string()
        };
        assert!(refused(|s| s.centre = 3.9).contains("outer radius"));
        assert!(refused(|s| s.inner = 3.9).contains("inner radius"));
        assert!(refused(|s| s.dt = Some(1.0)).contains("theoretical limit"));
        assert!(refused(|s| s.dt = Some(1e-12)).contains("time steps"));
    }
}
