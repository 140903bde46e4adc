//! The stage polynomial of super-time-stepping, RKL2 (Meyer, Balsara & Aslam 2014), in closed form.

/// The factor by which a kick of s = `stages` stages over dt multiplies a velocity that decays at the rate γ,
/// with z = γ dt: R(z) = 1 − b + b P(1 − 4 z/(s² + s − 2)) with the Legendre polynomial P of degree s and b =
/// (s² + s − 2)/(2 s (s + 1)).
///
/// R(z) = 1 − z + z²/2 + O(z³), and 0 < R(z) ≤ 1 as long as s stages are stable, z ≤ (s² + s − 2)/2.
pub fn factor(stages: u32, z: f64) -> f64 {
    let s = f64::from(stages);
    let scale = s * s + s - 2.0;
    let b = 0.5 * scale / (s * s + s);
    // 1 - P in terms of 1 - x, so that long waves do not lose their digits.
    let x = 4.0 * z / scale;
    let (mut before, mut last) = (0.0, x);
    for j in 2..=stages {
        let j = f64::from(j);
        // j P_j = (2j - 1) (1 - x) P_{j-1} - (j - 1) P_{j-2}, with 1 - P in place of P.
        let next = ((2.0 * j - 1.0) * (last + x - x * last) - (j - 1.0) * before) / j;
        (before, last) = (last, next);
    }
    1.0 - b * last
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_solver::integrator::stages;

    /// The polynomial at many z up to the limit of s stages.
    fn sampled(s: u32) -> Vec<f64> {
        let limit = 0.5 * f64::from(s * s + s - 2);
        (0..=10_000).map(|k| factor(s, limit * f64::from(k) / 10_000.0)).collect()
    }

    #[test]
    fn no_wave_grows_or_changes_its_sign_up_to_the_limit_of_the_stages() {
        for s in (3..=51).step_by(2) {
            let all = sampled(s);
            assert!(all.iter().all(|r| (0.0..=1.0).contains(r)), "{s} stages");
            let at_the_limit = 2.0 / f64::from(s * s + s);
            assert!((all[10_000] - at_the_limit).abs() < 1e-12, "{s} stages: {}", all[10_000]);
            let beyond = factor(s, 1.1 * 0.5 * f64::from(s * s + s - 2));
            assert!(beyond < 0.0, "{s} stages: {beyond}");
        }
        // With an even number the stiffest wave stays as it is.
        assert!((sampled(4)[10_000] - 1.0).abs() < 1e-12);
    }

    /// The polynomial is positive, but it does not fall with z everywhere. That no velocity overshoots its
    /// neighbours is a property of the whole kick, which a test of the solver shows.
    #[test]
    fn the_factor_swings_about_a_half_for_stiff_waves() {
        let all = sampled(25);
        assert!(all.windows(2).any(|pair| pair[1] > pair[0] + 1e-4));
        assert!(all[2000..].iter().all(|r| (r - 0.5).abs() < 0.5));
        assert!(all[500..9000].iter().all(|r| (r - 0.5).abs() < 0.2));
    }

    #[test]
    fn the_factor_is_an_exponential_up_to_second_order() {
        for s in [3, 5, 11] {
            let error = |z: f64| (factor(s, z) - touchstone_base::functions::exp(-z)).abs();
            let ratio = error(2e-2) / error(1e-2);
            assert!((7.5..8.5).contains(&ratio), "{s} stages: {ratio}");
        }
    }

    /// Relative error of start-up Couette flow at νt/L² = 0.1 by the time steps alone, with `steps` steps to
    /// each of 0.02, 0.05 and 0.1: waves decay by the factors of the kicks in place of exponentials. At each
    /// of these times half a kick synchronises the velocities, and the next step begins with half a kick.
    fn error_of_start_up(rows: usize, steps: i32) -> f64 {
        use std::f64::consts::PI;
        use touchstone_base::functions::{exp, sin};
        let stiffest = 3.84 * (rows * rows) as f64;
        let explicit = 2.0 / (1.1 * stiffest);
        let kick = |dt: f64, rate: f64| factor(stages(dt / explicit), rate * dt);
        let mut modes = Vec::new();
        for k in 1..=rows {
            let wave = k as f64 * PI;
            let rate = (wave * wave).min(stiffest);
            let mut left = 1.0;
            for (start, end) in [(0.0, 0.02), (0.02, 0.05), (0.05, 0.1)] {
                let dt = (end - start) / f64::from(steps);
                left *= kick(0.5 * dt, rate).powi(2) * kick(dt, rate).powi(steps - 1);
            }
            let amplitude = if k % 2 == 0 { 2.0 / wave } else { -2.0 / wave };
            modes.push((wave, amplitude, exp(-0.1 * rate), left));
        }
        let [mut error, mut scale] = [0.0; 2];
        for row in 0..rows {
            let y = (row as f64 + 0.5) / rows as f64;
            let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
                let each = modes
                    .iter()
                    .map(|(wave, a, exact, left)| a * sin(wave * y) * of(*exact, *left));
                each.sum()
            };
            error += sum(&|exact, left| left - exact).powi(2);
            scale += (y + sum(&|exact, _| exact)).powi(2);
        }
        (error / scale).sqrt()
    }

    /// Why the channels make eight steps to each time of comparison: an error of time of a tenth of 0.1 %.
    #[test]
    fn eight_steps_to_each_time_make_a_hundredth_of_a_percent() {
        for rows in [20, 40, 80] {
            let error = error_of_start_up(rows, 8);
            assert!((8e-5..1.3e-4).contains(&error), "{rows} rows: {error:e}");
            let coarse = error_of_start_up(rows, 4);
            assert!(coarse > 3.0 * error, "{rows} rows: {coarse:e} with half of the steps");
        }
    }

    #[test]
    fn the_stages_of_the_solver_are_the_fewest_odd_ones_that_allow_the_step() {
        let longest = |s: u32| 0.25 * f64::from(s * s + s - 2);
        assert_eq!([0.0, 1e-9, 1.0, 2.5].map(stages), [3; 4]);
        for s in (3..100).step_by(2) {
            assert_eq!([longest(s), 1.0001 * longest(s)].map(stages), [s, s + 2]);
        }
    }
}
