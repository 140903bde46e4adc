//! From settings to numbers and particles.

use nalgebra::Vector2;
use touchstone_harness::prelude::*;
use touchstone_maths::geometry::{Curve, Hill};
use touchstone_schemes::hill::HillMethod;

use super::{
    HillSettings,
    reference::{HillReference, KNOWN_SETTINGS},
};
use crate::fluids::unit_flow::{FlowScales, UnitFlow};

/// Gap over the crest of the reference \[H\]: with U_b = 1 the flux per depth.
pub const FLUX: f64 = 2.035;

/// The numbers of one run, H = U_b = ρ = 1.
pub struct HillSetup {
    /// The settings they follow from.
    pub settings: HillSettings,
    /// The method that they are for.
    pub method: HillMethod,
    /// The channel.
    pub hill: Hill,
    /// Medium, time step, sound speed.
    pub flow: UnitFlow,
    /// Depth of the first row of wall particles \[dx\].
    pub first: f64,
    /// The reference, if there is one.
    pub reference: Option<&'static HillReference>,
}

impl HillSetup {
    /// Follows the rules for a method.
    ///
    /// # Errors
    /// If the settings make no run, or the reference cannot be read.
    pub fn new(method: &HillMethod, s: &HillSettings) -> Result<Self, RunError> {
        // The largest speed, over the crest, is below 1.6 U_b.
        let HillSettings { re, n, h_over_dx, c0, end, force, .. } = *s;
        let scales =
            FlowScales { re, n, h_over_dx, c0, end, speed: 1.6, force, area: 27.0, dt: None };
        let flow = UnitFlow::new(&method.properties, &s.numerics, scales);
        let hill = Hill::new(1.0).map_err(|e| RunError::Reference(e.to_string()))?;
        let reference = HillReference::of(s).map_err(|e| RunError::Reference(e.to_string()))?;
        if s.from_reference && reference.is_none() {
            return Err(RunError::Combination {
                key: "from_reference",
                value: "true".into(),
                allowed: format!("{KNOWN_SETTINGS}, the flows that have a reference"),
            });
        }
        let (settings, method) = (s.clone(), method.clone());
        let first = method.properties.first_row.depth();
        Ok(Self { settings, method, hill, flow, first, reference })
    }

    /// Height of the floor at x \[m\].
    pub fn floor(&self, x: f64) -> f64 {
        self.settings.crest * self.hill.wall(x)
    }

    /// Slope of the floor at x, by a difference over 2e-5 H.
    pub fn slope(&self, x: f64) -> f64 {
        (self.floor(x + 1e-5) - self.floor(x - 1e-5)) / 2e-5
    }

    /// The flux wanted \[m²/s\].
    pub fn flux(&self) -> f64 {
        self.settings.flux * FLUX
    }

    /// Area of the fluid \[m²\], midpoint rule.
    pub fn area(&self) -> f64 {
        let (count, lid, period) = (9000, self.hill.lid(), self.hill.period());
        let cell = period / f64::from(count);
        (0..count).map(|k| (lid - self.floor((f64::from(k) + 0.5) * cell)) * cell).sum()
    }

    /// Fluid in columns dx apart, each with the number of particles nearest to a spacing of dx between floor
    /// and lid, and with volumes that fill the column; behind floor and lid rows along them.
    pub fn particles(&self) -> Vec<Particle> {
        let (dx, lid) = (self.flow.medium.dx, self.hill.lid());
        let columns = (self.hill.period() / dx).round() as usize;
        let width = self.hill.period() / columns as f64;
        let mut particles = Vec::new();
        for i in 0..columns {
            let x = (i as f64 + 0.5) * width;
            let (floor, gap) = (self.floor(x), lid - self.floor(x));
            let count = (gap / dx).round().max(2.0);
            let spacing = gap / count;
            let lowest = usize::from(self.first == 0.0);
            for k in lowest..count as usize {
                let y = floor + (k as f64 + self.first) * spacing;
                let place = Vector2::new(x, y);
                let velocity = match self.reference {
                    Some(reference) if self.settings.from_reference => {
                        reference.velocity(x, (y - floor) / gap, gap)
                    }
                    _ => Vector2::zeros(),
                };
                particles.push(Particle::fluid(place, velocity, 1.0, width * spacing));
            }
        }
        for curve in self.curves() {
            let first = particles.len();
            for row in curve.rows_behind(dx, self.first, self.flow.support) {
                particles.extend(row.particles(dx, 1.0, |_| Vector2::zeros()));
            }
            // Eight in sequence share a list, which is shorter if they are behind the same fluid.
            particles[first..].sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
        }
        particles
    }

    /// Floor and lid, the fluid on their left.
    pub fn curves(&self) -> [Curve; 2] {
        let (dx, period, lid) = (self.flow.medium.dx, self.hill.period(), self.hill.lid());
        let floor = Curve::new(|x| Vector2::new(x, self.floor(x)), [0.0, period], dx);
        [floor, Curve::new(|x| Vector2::new(x, lid), [period, 0.0], dx)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluids::periodic_hill::CASE;
    use touchstone_harness::case::Case;

    /// Runs that have no reference started from rest without a word.
    #[test]
    fn a_start_from_a_reference_that_does_not_exist_is_refused() {
        let rules = |set: fn(&mut HillSettings)| {
            let spec = CASE.spec("carried", |s| {
                s.from_reference = true;
                set(s);
            });
            CASE.rules(&spec).map(|_| ()).map_err(|error| error.to_string())
        };
        assert_eq!(rules(|_| {}), Ok(()));
        let others: [fn(&mut HillSettings); 3] =
            [|s| s.re = 30.0, |s| s.crest = 0.5, |s| s.flux = 0.5];
        for refused in others.map(rules) {
            let words = refused.expect_err("refused");
            assert!(
                words.contains("from_reference is true") && words.contains("re = 10"),
                "{words}"
            );
        }
    }
}
