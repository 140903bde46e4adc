//! The force that holds the flux: a controller that acts between stretches of a few steps.

use base::functions::exp;

/// f' = \[(u* − u)/T − u'\]/t, u the mean velocity along x over the fluid, u* the one wanted.
///
/// As u' = f − d with the drag d of the walls, f follows d within t, and u goes to u* within T. At rest
/// f = d whatever d is.
///
/// With t = T/4 both roots are −2/T: the fastest without overshoot.
#[derive(Clone, Copy, Debug)]
pub struct Controller {
    /// u* \[m/s\].
    pub wanted: f64,
    /// T \[s\]; 0 keeps the force.
    pub response: f64,
    /// The force now \[m/s²\].
    pub force: f64,
    /// u at the last look \[m/s\].
    pub last: f64,
}

harness::observed! { Controller: changes(wanted, response, force, last), stays() }

impl Controller {
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
