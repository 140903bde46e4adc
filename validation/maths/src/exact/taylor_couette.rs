//! Steady laminar flow between two concentric cylinders; the inner one turns.

/// Two cylinders about the origin.
#[derive(Clone, Copy, Debug)]
pub struct TaylorCouette {
    /// Radius of the inner cylinder, which turns \[m\].
    pub inner: f64,
    /// Radius of the outer cylinder, at rest \[m\].
    pub outer: f64,
    /// Speed of the inner surface \[m/s\].
    pub speed: f64,
}

impl TaylorCouette {
    /// The velocity around the axis at the radius r, A r + B/r: V at the inner cylinder and 0 at the outer
    /// one \[m/s\].
    pub fn velocity(&self, r: f64) -> f64 {
        let Self { inner, outer, speed } = *self;
        let ratio2 = (inner / outer) * (inner / outer);
        let a = -speed / inner * ratio2 / (1.0 - ratio2);
        let b = speed * inner / (1.0 - ratio2);
        a * r + b / r
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_flow_sticks_to_both_cylinders_and_bears_one_torque_at_every_radius() {
        let flow = TaylorCouette { inner: 0.5, outer: 1.25, speed: 0.3 };
        assert_relative_eq!(flow.velocity(0.5), 0.3, max_relative = 1e-14);
        assert!(flow.velocity(1.25).abs() < 1e-15);
        // r³ d(u/r)/dr, of which the torque on a cylinder of the fluid is 2π μ times.
        let shear = -2.0 * 0.3 * 0.5 / (1.0 - 0.4 * 0.4);
        for r in [0.6_f64, 0.9, 1.2] {
            let d = 1e-4;
            let turn = |r: f64| flow.velocity(r) / r;
            let slope = (turn(r + d) - turn(r - d)) / (2.0 * d);
            assert_relative_eq!(r.powi(3) * slope, shear, max_relative = 1e-6);
        }
    }
}
