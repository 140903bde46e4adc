//! A controller of the force that drives a flow.

use serde::{Deserialize, Serialize};
use touchstone_base::functions::exp;

/// The force that holds the flux: f' = \[(u* − u)/T − u'\]/t, u the mean velocity along x over the fluid, u*
/// the one wanted.
///
/// As u' = f − d with the drag d of the walls, f follows d within t, and u reaches u* within T. In a steady
/// state f = d for any d.
///
/// With t = T/4 both roots are −2/T: the fastest without overshoot.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Controller {
    /// u* \[m/s\].
    wanted: f64,
    /// T \[s\]; 0 keeps the force.
    response: f64,
    /// The force now \[m/s²\].
    pub force: f64,
    /// u at the last look \[m/s\].
    last: f64,
}

impl Controller {
    /// A controller for this mean velocity and response, with the force and the mean velocity at the start.
    pub fn new(wanted: f64, response: f64, force: f64, mean: f64) -> Self {
        Self { wanted, response, force, last: mean }
    }

    /// Looks at the mean velocity after `dt` \[s\].
    pub fn look(&mut self, mean: f64, dt: f64) {
        if self.response > 0.0 {
            let settle = 0.25 * self.response;
            // Exact for a constant right-hand side: never more than the whole way.
            let share = 1.0 - exp(-dt / settle);
            self.force += share * ((self.wanted - mean) / self.response - (mean - self.last) / dt);
        }
        self.last = mean;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body with a drag that grows with its speed.
    #[test]
    fn the_flux_is_met_and_the_force_is_the_drag() {
        let (mut speed, dt, rate) = (0.0, 0.02, 0.3);
        let mut controller = Controller { wanted: 0.8, response: 1.0, force: 0.0, last: 0.0 };
        let mut largest = 0.0_f64;
        for _ in 0..2000 {
            speed += dt * (controller.force - rate * speed);
            controller.look(speed, dt);
            largest = largest.max(speed);
        }
        assert!((speed - 0.8).abs() < 1e-9 && (controller.force - 0.24).abs() < 1e-9);
        assert!(largest < 0.82, "{largest}");
    }

    #[test]
    fn without_response_the_force_stays() {
        let mut controller = Controller { wanted: 1.0, response: 0.0, force: 0.3, last: 0.0 };
        controller.look(0.1, 0.1);
        assert_eq!(controller.force, 0.3);
    }
}
