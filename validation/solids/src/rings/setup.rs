//! From settings to a scene: spacing, moduli, time step, particles.

use nalgebra::{Rotation2, Vector2};
use solver::{
    ArtificialViscosity, CauchyStress, Continuity, CubicSpline, Domain, Integrator, JaumannRate,
    Limits, Linear, Open, Particle, Scene, Smoothing, Symmetric, Xsph,
    terms::{Axes, InTension, TensileStress},
};
use std::f64::consts::TAU;

use super::{RingSettings, run::Rubber};
use crate::solid::Material;
use harness::case::RunError;
use maths::theory::{
    Stepping,
    lattice::SquareLattice,
    time_step::{self, Medium},
};

/// More steps or particles than anyone waits for.
const MOST_STEPS: f64 = 1e7;
const MOST_PARTICLES: f64 = 2e6;
/// Side of the periodic box whose waves give the limit of the time step.
const LIMIT_BOX: usize = 24;

/// The numbers of one run.
#[derive(Clone, Debug)]
pub struct Rings {
    /// As given.
    pub settings: RingSettings,
    /// Bulk sound speed c₀ \[m/s\].
    pub c0: f64,
    /// Speed of longitudinal waves c_p \[m/s\].
    pub cp: f64,
    /// Shear modulus μ \[Pa\].
    pub mu: f64,
    /// Speed of each ring V \[m/s\].
    pub v: f64,
    /// Distance of the layers of particles \[m\].
    pub dx: f64,
    /// Smoothing length \[m\].
    pub h: f64,
    /// Equation of state.
    pub eos: Linear,
    /// Time step \[s\].
    pub dt: f64,
    /// Its theoretical limit in a stress-free lattice with artificial viscosity always on \[s\].
    pub dt_limit: f64,
}

/// An artificial stress that settings can make.
pub trait Tensile: TensileStress {
    /// Settings that it reads.
    const USES: &'static [&'static str];
    /// The artificial stress of a setup.
    fn of(rings: &Rings) -> Self;
}

impl Tensile for () {
    const USES: &'static [&'static str] = &[];
    fn of(_: &Rings) -> Self {}
}

impl<A: Axes> Tensile for InTension<A> {
    const USES: &'static [&'static str] = super::OPTIONAL;
    fn of(rings: &Rings) -> Self {
        Self::new(rings.settings.xi, rings.settings.stress_exponent as u32, rings.w_at_spacing())
    }
}

impl Rings {
    /// Checks the settings and derives the rest; `I` steps the run.
    pub fn new<I: Stepping<Symmetric>>(
        s: &RingSettings,
        allow_unstable: bool,
    ) -> Result<Self, RunError> {
        let too_much =
            |what, value, most, setting| RunError::TooMuch { what, value, most, setting };
        let layers = ((s.outer - s.inner) / s.spacing).round().max(1.0);
        let dx = (s.outer - s.inner) / layers;
        if s.inner > s.outer - 2.0 * s.spacing {
            let most = s.outer - 2.0 * s.spacing;
            return Err(too_much("the inner radius", s.inner, most, "inner, outer or spacing"));
        }
        if s.outer > s.centre {
            // The rings would overlap before the first step.
            return Err(too_much("the outer radius", s.outer, s.centre, "outer or centre"));
        }
        let c0 = (s.bulk_modulus / s.rho).sqrt();
        let mu = s.shear_modulus * s.bulk_modulus;
        let cp = Material { density: s.rho, bulk: s.bulk_modulus, shear: mu }.p_wave_speed();
        let (v, h) = (s.speed * c0, s.h_over_dx * dx);
        let lattice = SquareLattice::<CubicSpline>::new(s.h_over_dx, 0.01);
        let medium = Medium { c0: cp, h, nu: 0.0, alpha: s.alpha * c0 / cp, delta: 0.0 };
        let modes = time_step::modes(&lattice, LIMIT_BOX, &medium);
        let dt_limit = time_step::time_step_limit(&modes, I::THEORY);
        let dt = s.dt.unwrap_or(s.courant * h / (cp + v));
        if dt > dt_limit && !allow_unstable {
            return Err(RunError::TimeStep { dt, limit: dt_limit, integrator: I::NAME });
        }
        let steps = s.end / c0 / dt;
        if steps > MOST_STEPS {
            let setting = "end, dt, courant or spacing";
            return Err(too_much("the number of time steps", steps, MOST_STEPS, setting));
        }
        let area = TAU * (s.outer * s.outer - s.inner * s.inner);
        let particles = area / (dx * dx);
        if particles > MOST_PARTICLES {
            let setting = "spacing or outer";
            return Err(too_much("the number of particles", particles, MOST_PARTICLES, setting));
        }
        let eos = Linear { density: s.rho, sound_speed: c0 };
        Ok(Self { settings: s.clone(), c0, cp, mu, v, dx, h, eos, dt, dt_limit })
    }

    /// What the rings are made of.
    pub fn material(&self) -> Material {
        let RingSettings { rho: density, bulk_modulus: bulk, .. } = self.settings;
        Material { density, bulk, shear: self.mu }
    }

    fn w_at_spacing(&self) -> f64 {
        Smoothing::<CubicSpline>::new(self.h).w(self.dx * self.dx)
    }

    /// Rotates the line of flight to the x axis.
    pub fn to_flight(&self) -> Rotation2<f64> {
        Rotation2::new(-self.settings.angle.to_radians())
    }

    /// The particles: concentric layers, their numbers multiples of four, so that mass is exact, the
    /// edge is smooth, and each ring is its own mirror image. The ring on the right is the mirror
    /// image of the one on the left, in the same order.
    pub fn particles(&self) -> Vec<Particle<Symmetric>> {
        let s = &self.settings;
        let rotation = self.to_flight().inverse();
        let (mut left, mut right) = (Vec::new(), Vec::new());
        let layers = ((s.outer - s.inner) / self.dx).round() as usize;
        for k in 0..layers {
            let r = s.inner + (k as f64 + 0.5) * self.dx;
            let quarter = (TAU * r / (4.0 * self.dx)).round().max(1.0) as usize;
            let count = 4 * quarter;
            let volume = TAU * r * self.dx / count as f64;
            for j in 0..count {
                let place = r * quadrant_point(j, quarter);
                let put = |side: f64, ring: &mut Vec<_>| {
                    // On the right: the mirror image, to the last bit.
                    let place = Vector2::new(side * (s.centre + place.x), place.y);
                    let velocity = Vector2::new(-side * self.v, 0.0);
                    ring.push(Particle::fluid(
                        rotation * place,
                        rotation * velocity,
                        s.rho,
                        volume,
                    ));
                };
                put(-1.0, &mut left);
                put(1.0, &mut right);
            }
        }
        left.extend(right);
        left
    }

    /// The scene.
    pub fn scene<R: Tensile, I: Integrator<Symmetric>>(&self) -> Scene<Rubber<R, I>> {
        let s = &self.settings;
        let stress = CauchyStress { eos: self.eos, tensile: R::of(self) };
        let forces = (stress, ArtificialViscosity::new(s.alpha, s.beta, self.h, self.eos));
        let drift = (Continuity, JaumannRate { shear_modulus: self.mu }, Xsph { epsilon: s.xsph });
        let domain = Domain::open();
        let mut scene = Scene::new(self.h, domain, self.particles(), forces, drift, Open);
        // Twice the density or twice the speed of sound is no rubber any more.
        let speed = 2.0 * (self.cp + self.v);
        scene.limits = Limits { density: [0.5 * s.rho, 2.0 * s.rho], speed };
        scene
    }
}

/// The unit vector number j of 4 `quarter`, which begin half a step above the x axis; the four
/// quadrants are mirror images of the first to the last bit.
fn quadrant_point(j: usize, quarter: usize) -> Vector2<f64> {
    let (quadrant, k) = (j / quarter, j % quarter);
    let k = if quadrant % 2 == 0 { k } else { quarter - 1 - k };
    let (sin, cos) = (TAU * (k as f64 + 0.5) / (4 * quarter) as f64).sin_cos();
    let x = if quadrant == 0 || quadrant == 3 { cos } else { -cos };
    Vector2::new(x, if quadrant < 2 { sin } else { -sin })
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::Leapfrog;

    fn rings(settings: &RingSettings) -> Result<Rings, RunError> {
        Rings::new::<Leapfrog>(settings, false)
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
        assert_eq!(rings.dx, 0.1);
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
        assert!(refused(|s| s.end = 1e6).contains("time steps"));
    }
}
