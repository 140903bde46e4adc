//! The momentum of the water against what walls and gravity give it.

use nalgebra::Vector2;
use solver::Stepper;

use super::{Dam, metrics::MOMENTUM_GAP};
use base::record::Record;
use harness::method::Medium;

/// Momentum against the impulse of walls and gravity, by the trapezoidal rule.
pub struct Momentum {
    gravity: Vector2<f64>,
    balance: Option<Balance>,
}

/// Time, force, and the momentum of the start; the impulse so far, and the largest gap.
#[derive(Clone, Copy, Debug)]
struct Balance {
    time: f64,
    start: Vector2<f64>,
    force: Vector2<f64>,
    impulse: Vector2<f64>,
    gap: f64,
}

base::bits! { Balance { time, start, force, impulse, gap } }
harness::observed! { Momentum: changes(balance), parts(), stays(gravity) }

impl Momentum {
    /// No sample yet, of water of this medium.
    pub fn new(medium: &Medium) -> Self {
        Self { gravity: medium.acceleration, balance: None }
    }

    /// Takes a sample of a simulation that has been brought to a time, and in which pairs exert this force
    /// on the water \[N/m\].
    pub fn sample(&mut self, simulation: &dyn Stepper<()>, pairs: Vector2<f64>) {
        let (mut momentum, mut force) = (Vector2::zeros(), pairs);
        for (mass, p) in simulation.fluid() {
            momentum += p.velocity * mass;
            force += self.gravity * mass;
        }
        let time = simulation.time();
        let now = match self.balance {
            None => Balance { time, start: momentum, force, impulse: Vector2::zeros(), gap: 0.0 },
            Some(b) => {
                let impulse = b.impulse + (b.force + force) * (0.5 * (time - b.time));
                let gap = (momentum - b.start - impulse).norm().max(b.gap);
                Balance { time, force, impulse, gap, ..b }
            }
        };
        self.balance = Some(now);
    }

    /// The gap of water of this mass \[kg/m\].
    pub fn measure(&self, dam: &Dam, mass: f64, record: &mut Record) {
        let scale = mass * (dam.settings.gravity * dam.settings.height).sqrt();
        let gap = self.balance.map_or(f64::NAN, |balance| balance.gap);
        record.put(MOMENTUM_GAP, gap / scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        dam_break::DAM_BREAK,
        water::{Modern, method},
    };
    use harness::{context::Context, method::Parts};
    use maths::metrics::budget::Metered;
    use solver::Particle;

    #[test]
    fn momentum_that_no_force_explains_is_the_gap() {
        let settings = DAM_BREAK.settings_of("modern", &["n=10".into()]).expect("settings");
        let (method, context) = (method::<Modern>(), Context::default());
        let free = Dam::new(&settings, &method, &context).expect("sound settings");
        let apart = |v: Vector2<f64>| -> Box<dyn Metered<()>> {
            let place = |k: usize| Vector2::new(0.1 * k as f64, 0.05 * k as f64);
            let particle = |k| Particle::fluid(place(k), v, 1e3, 1e-5 * (k + 1) as f64);
            let particles = (1..4).map(particle).collect();
            let parts = Parts { particles, ..free.parts(&method, &context) };
            let mut simulation = (method.build)(parts).expect("a scene");
            simulation.advance(0.0, 1.0, &mut ());
            simulation
        };
        let unit = (free.settings.gravity * free.settings.height).sqrt();
        let gap = |momentum: &Momentum| {
            let mut record = Record::new("dam_break", "modern", serde_json::json!({}), 1);
            momentum.measure(&free, 0.09, &mut record);
            record.value(MOMENTUM_GAP).expect("a gap")
        };
        // A free fall: gravity gives what the water has.
        let (mut falling, mut momentum) = (apart(Vector2::zeros()), Momentum::new(&free.medium));
        for k in 0..4 {
            falling.advance(0.01 * f64::from(k), 1e-3, &mut ());
            momentum.sample(&*falling, Vector2::zeros());
        }
        assert!(gap(&momentum) < 1e-13, "{:e}", gap(&momentum));
        // A kick of all masses, of 0.09 kg/m, and then a smaller one: the largest counts.
        let mut momentum = Momentum::new(&free.medium);
        for v in [Vector2::zeros(), Vector2::new(0.3, 0.4) * unit, Vector2::new(0.1, 0.0)] {
            momentum.sample(&*apart(v), Vector2::zeros());
        }
        assert!((gap(&momentum) - 0.5).abs() < 1e-9, "{}", gap(&momentum));
    }
}
