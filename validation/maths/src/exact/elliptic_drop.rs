//! A free drop of an incompressible, inviscid fluid in two dimensions that a uniform strain pulls into
//! an ellipse (Monaghan 1994).
//!
//! With v = (−A x, A y) and semi-axes a along x, b along y, the Euler equations hold with
//! p = (ρ P/2)(1 − x²/a² − y²/b²), P = 2 A² a² b²/(a² + b²), so that the pressure vanishes on the
//! surface, and
//!
//! A' = A² (a² − b²)/(a² + b²), a' = −A a, b' = A b.
//!
//! The area π a b and the kinetic energy, ∝ A² (a² + b²), are constant.

/// The drop at one time.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EllipticDrop {
    /// Rate of strain A \[1/s\].
    pub strain: f64,
    /// Semi-axis along x \[m\]: the one that shrinks.
    pub a: f64,
    /// Semi-axis along y \[m\]: the one that grows.
    pub b: f64,
}

/// Steps of the integration while A t grows by 1: the error is below 1e-12 then.
const STEPS: f64 = 4000.0;

impl EllipticDrop {
    /// A circle of this radius \[m\] with the rate of strain A \[1/s\].
    pub fn circle(radius: f64, strain: f64) -> Self {
        Self { strain, a: radius, b: radius }
    }

    /// The drop after another `time` \[s\], by the classical Runge–Kutta method.
    pub fn after(self, time: f64) -> Self {
        let steps = (STEPS * (self.strain * time).abs()).ceil().max(1.0);
        let dt = time / steps;
        (0..steps as usize).fold(self, |drop, _| {
            let k1 = drop.rate();
            let k2 = drop.moved(0.5 * dt, k1).rate();
            let k3 = drop.moved(0.5 * dt, k2).rate();
            let k4 = drop.moved(dt, k3).rate();
            let mean = |of: fn(Self) -> f64| (of(k1) + 2.0 * (of(k2) + of(k3)) + of(k4)) / 6.0;
            drop.moved(dt, Self { strain: mean(|k| k.strain), a: mean(|k| k.a), b: mean(|k| k.b) })
        })
    }

    /// P/2 = p/ρ at the centre \[m²/s²\].
    pub fn central_pressure(&self) -> f64 {
        let (a2, b2) = (self.a * self.a, self.b * self.b);
        self.strain * self.strain * a2 * b2 / (a2 + b2)
    }

    /// d/dt of each field.
    fn rate(&self) -> Self {
        let Self { strain, a, b } = *self;
        let (a2, b2) = (a * a, b * b);
        Self { strain: strain * strain * (a2 - b2) / (a2 + b2), a: -strain * a, b: strain * b }
    }

    fn moved(self, dt: f64, rate: Self) -> Self {
        let (a, b) = (self.a + dt * rate.a, self.b + dt * rate.b);
        Self { strain: self.strain + dt * rate.strain, a, b }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DROP: EllipticDrop = EllipticDrop { strain: 3.0, a: 0.5, b: 0.5 };

    #[test]
    fn area_and_kinetic_energy_stay() {
        let energy = |d: EllipticDrop| d.strain * d.strain * (d.a * d.a + d.b * d.b);
        for time in [0.01, 0.3, 1.0, 3.0] {
            let later = DROP.after(time);
            assert!((later.a * later.b / 0.25 - 1.0).abs() < 1e-12, "{later:?}");
            assert!((energy(later) / energy(DROP) - 1.0).abs() < 1e-12, "{later:?}");
            let back = later.after(-time);
            assert!((back.a - 0.5).abs() < 1e-11 && (back.strain - 3.0).abs() < 1e-10);
        }
    }

    /// The momentum equations at a point, by differences in time of v along the path.
    #[test]
    fn the_euler_equations_hold() {
        let (t, d) = (0.4, 1e-5);
        let [before, now, after] = [t - d, t, t + d].map(|t| DROP.after(t));
        let slope = (after.strain - before.strain) / (2.0 * d);
        let half_p = now.central_pressure();
        // Along x: −A' + A² = P/a², along y: A' + A² = P/b².
        let square = now.strain * now.strain;
        let along_x = (square - slope) - 2.0 * half_p / (now.a * now.a);
        let along_y = (square + slope) - 2.0 * half_p / (now.b * now.b);
        assert!(along_x.abs() < 1e-7 * square && along_y.abs() < 1e-7 * square);
        assert!(now.b > now.a);
    }
}
