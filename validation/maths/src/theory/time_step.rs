//! Theoretical limits of the time step: linear stability of each integrator on a square lattice.
//!
//! A wave of wave vector k on a fluid at rest with p₀ = 0 obeys, with p the density amplitude and v
//! the velocity,
//!
//! p' = -ω ĝ·v - γ_ρ p,  v' = ω ĝ p - Γ v,
//!
//! ω = c₀|g(k)|, ĝ = g/|g|, Γ = ν λ(k) + α c₀ h P(k) + α₂ c₀ h g gᵀ, γ_ρ = δ h c₀ λ₀(k), symbols from
//! [`super::lattice`].
//! The limit is the largest dt for which no k of the box grows. A periodic box of n × n particles has only
//! the wave vectors 2π(i, j)/(n dx), so its limit is exact; an infinite lattice is the limit of large n.
//! Moving, disordered or strongly compressed particles become unstable at smaller steps: see the notes of
//! each study.

use super::{
    lattice::{SquareLattice, wave_vectors},
    super_steps,
};
use crate::halved;
use nalgebra::{Complex, Matrix3, SMatrix, Vector2};
use touchstone_base::functions::{ln, modulus};
use touchstone_solver::{
    Euler, Leapfrog, PredictorCorrector, SingleSweep, SuperSteps, integrator::stages,
};

/// The fluid that the limits are for. All numbers must be finite and not negative, `h` and `c0`
/// positive.
#[derive(Clone, Copy, Debug)]
pub struct WaveMedium {
    /// Sound speed c₀ \[m/s\].
    pub c0: f64,
    /// Smoothing length \[m\].
    pub h: f64,
    /// Kinematic viscosity ν of Morris' term \[m²/s\].
    pub nu: f64,
    /// α of Monaghan's artificial viscosity, acting on approaching and receding pairs alike. With
    /// the switch (17) about half of it acts.
    pub alpha: f64,
    /// δ of the density diffusion -δ h c₀ λ₀ ρ.
    pub delta: f64,
    /// α₂ of the acoustic damper, α₂ c₀ h g (g·v).
    pub damper: f64,
}

impl WaveMedium {
    /// A fluid of this sound speed \[m/s\] and smoothing length \[m\] without any damping.
    pub const fn of_sound(c0: f64, h: f64) -> Self {
        Self { c0, h, nu: 0.0, alpha: 0.0, delta: 0.0, damper: 0.0 }
    }
}

/// How a step advances (p, v).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Explicit midpoint rule, the predictor-corrector of the seed; order 2.
    PredictorCorrector,
    /// Staggered leapfrog with damping from the old velocity, continuity from the new one.
    Leapfrog,
    /// Leapfrog with Morris' viscosity by super-time-stepping.
    SuperLeapfrog,
    /// The leapfrog with one pair sweep a step, whose density is extrapolated.
    SingleSweep,
    /// Forward Euler; order 1.
    Euler,
}

impl Integrator {
    /// Pair sweeps of a step of `ratio` times [`explicit_limit`].
    pub fn sweeps(self, ratio: f64) -> f64 {
        match self {
            Self::Euler | Self::SingleSweep => 1.0,
            Self::PredictorCorrector | Self::Leapfrog => 2.0,
            Self::SuperLeapfrog => 1.0 + f64::from(stages(ratio)),
        }
    }
}

/// An integrator that has a theory of its time step.
pub trait Stepping {
    /// The theory of its stability.
    const THEORY: Integrator;
}

impl Stepping for PredictorCorrector {
    const THEORY: Integrator = Integrator::PredictorCorrector;
}

impl Stepping for Leapfrog {
    const THEORY: Integrator = Integrator::Leapfrog;
}

impl Stepping for Leapfrog<SuperSteps> {
    const THEORY: Integrator = Integrator::SuperLeapfrog;
}

impl Stepping for SingleSweep {
    const THEORY: Integrator = Integrator::SingleSweep;
}

impl Stepping for Euler {
    const THEORY: Integrator = Integrator::Euler;
}

/// One wave: the coefficients of its equations, resolved along and across ĝ.
#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// ĝ, the unit vector along the gradient symbol.
    pub along: Vector2<f64>,
    /// ω = c₀|g| \[1/s\].
    pub omega: f64,
    /// ĝ·Γĝ \[1/s\].
    pub longitudinal: f64,
    /// t̂·Γĝ with t̂ normal to ĝ, 0 along the axes and diagonals and without artificial viscosity
    /// \[1/s\].
    pub coupling: f64,
    /// t̂·Γt̂ \[1/s\].
    pub transverse: f64,
    /// γ_ρ \[1/s\].
    pub density: f64,
    /// ν λ(k), the part of Γ that is Morris' viscosity \[1/s\].
    pub viscous: f64,
    /// α₂ c₀ h |g|², the part of ĝ·Γĝ that is the acoustic damper \[1/s\].
    pub damped: f64,
    /// [`explicit_limit`], from which super-time-stepping computes its number of stages \[s\].
    pub explicit: f64,
}

/// The limit of a mechanism acting alone \[s\], 2 over the largest of its rates in `modes`; infinite if it is
/// absent. The smallest of these is up to 28 % above the limit of all mechanisms together,
/// [`time_step_limit`].
///
/// The limit of sound, 2/ω_max, holds for the leapfrog only: sound alone grows at any dt under Euler and the
/// predictor-corrector. The limit of viscosity, 2/(ν λ_max), holds for every integrator except
/// super-time-stepping.
pub fn limit_alone(modes: &[Mode], rate: fn(&Mode) -> f64) -> f64 {
    2.0 / modes.iter().map(rate).fold(0.0, f64::max)
}

/// Largest ratio of an eigenvalue of a viscous term to the lattice's: displacements by a tenth of a spacing
/// raise it by 9 %, and rows that slide past each other lower it.
const DISORDER: f64 = 1.1;

/// The longest step of forward Euler for viscosity alone \[s\], from which super-time-stepping computes its
/// number of stages: 2/λ, λ being `stiffest` = [`SquareLattice::stiffest`] ν/h² and 10 % more for disorder.
pub fn explicit_limit(stiffest: f64, h: f64, nu: f64) -> f64 {
    2.0 * h * h / (DISORDER * stiffest * nu)
}

/// The waves of a periodic box of `n` × `n` particles, one of each symmetry class.
pub fn modes(lattice: &SquareLattice, n: usize, medium: &WaveMedium) -> Vec<Mode> {
    wave_vectors(n).map(|theta| Mode::new(lattice, theta, medium)).collect()
}

/// The largest stable dt \[s\] over `modes`: 0 if one of them grows at every dt, infinite for none.
pub fn time_step_limit(modes: &[Mode], integrator: Integrator) -> f64 {
    let shorter = |least: f64, mode: &Mode| least.min(mode.limit_below(integrator, least));
    modes.iter().fold(f64::INFINITY, shorter)
}

/// The growth rate of the fastest of `modes` a step, ln of the spectral radius; about 0 or below
/// when stable.
pub fn growth_per_step(modes: &[Mode], integrator: Integrator, dt: f64) -> f64 {
    modes.iter().map(|mode| mode.growth(integrator, dt)).fold(f64::NEG_INFINITY, f64::max)
}

/// Steps of 1 % in which the limit of super-time-stepping is searched: up to 140 times that without
/// viscosity.
const SEARCHED: i32 = 500;

/// How often the interval between a step that is stable and one that is not is halved.
const HALVED: usize = 40;

/// Steps in which the limit of the single sweep is searched.
const SEARCHED_SINGLY: u16 = 20;

impl Mode {
    /// The wave with phase `theta` = k dx \[rad\].
    pub fn new(lattice: &SquareLattice, theta: Vector2<f64>, medium: &WaveMedium) -> Self {
        let WaveMedium { c0, h, nu, alpha, delta, damper } = *medium;
        let g = lattice.gradient(theta);
        // At the corners of the zone g is round-off; P is diagonal there.
        let along = if g.norm() > 1e-12 { g.normalize() } else { Vector2::x() };
        let across = Vector2::new(-along.y, along.x);
        let p = lattice.artificial(theta) * (alpha * c0 / h);
        let viscous = nu * lattice.laplacian(theta) / (h * h);
        let damped = damper * c0 / h * g.norm_squared();
        Self {
            along,
            omega: c0 * g.norm() / h,
            longitudinal: viscous + along.dot(&(p * along)) + damped,
            coupling: across.dot(&(p * along)),
            transverse: viscous + across.dot(&(p * across)),
            density: delta * c0 / h * lattice.diffusion(theta),
            viscous,
            damped,
            explicit: explicit_limit(lattice.stiffest(), h, nu),
        }
    }

    /// The larger eigenvalue of α c₀ h P(k), the part of Γ that is not Morris' viscosity \[1/s\].
    pub fn artificial(&self) -> f64 {
        let Self { coupling, transverse, viscous, damped, .. } = *self;
        let longitudinal = self.longitudinal - damped;
        let (mean, half) = (0.5 * (longitudinal + transverse), 0.5 * (longitudinal - transverse));
        // Without artificial viscosity a difference of equal numbers, which is 0.
        mean - viscous + (half * half + coupling * coupling).sqrt()
    }

    /// The largest stable dt \[s\].
    ///
    /// - Leapfrog: 2/λ_max of the symmetric \[\[γ_ρ, ω, 0\], \[ω, γ_l, γ_c\], \[0, γ_c, γ_t\]\],
    ///   for which ξ = -1 is reached first. Without coupling this is (2 - γ dt)(2 - γ_ρ dt) ≥ (ω
    ///   dt)².
    /// - Super-time-stepping: the first dt at which a factor of -1 is reached. Viscosity alone reaches none,
    ///   and with sound it delays it, so that the search begins at the limit of the leapfrog without
    ///   viscosity.
    /// - The single sweep: the first dt that grows, searched up to twice the limit of the leapfrog.
    /// - The others: the smallest limit over the eigenvalues s = a + ib of the equations, from
    ///   |1 + s dt|² ≤ 1 for Euler and |1 + s dt + (s dt)²/2|² ≤ 1 for the predictor-corrector. The
    ///   latter reads 2a + 2a² dt + a|s|² dt² + |s|⁴ dt³/4 ≤ 0, free of cancellation, and its left
    ///   side grows with dt for every a < 0, so it has one root.
    pub fn limit(&self, integrator: Integrator) -> f64 {
        self.limit_below(integrator, f64::INFINITY)
    }

    /// The limit \[s\], or any step above `longest` if it is longer than this.
    fn limit_below(&self, integrator: Integrator, longest: f64) -> f64 {
        let limit = |s: Complex<f64>| match modulus(s) {
            0.0 => f64::INFINITY,
            _ if s.re >= 0.0 => 0.0,
            size if integrator == Integrator::Euler => -2.0 * s.re / (size * size),
            size => midpoint_root(-s.re / size) / size,
        };
        match integrator {
            Integrator::Leapfrog => 2.0 / self.stiffness().symmetric_eigenvalues().max(),
            Integrator::SuperLeapfrog => self.limit_of_super_steps(longest),
            Integrator::SingleSweep => self.limit_of_single_sweep(longest),
            Integrator::Euler | Integrator::PredictorCorrector => {
                self.eigenvalues().map(limit).into_iter().fold(f64::INFINITY, f64::min)
            }
        }
    }

    fn limit_of_super_steps(&self, longest: f64) -> f64 {
        let viscous = self.viscous;
        let (longitudinal, transverse) = (self.longitudinal - viscous, self.transverse - viscous);
        let inviscid = Self { longitudinal, transverse, viscous: 0.0, ..*self };
        let shortest = 0.999 * inviscid.limit(Integrator::Leapfrog);
        let is_stable = |dt: f64| {
            let step = self.leapfrog_step(Integrator::SuperLeapfrog, dt);
            (step + Matrix3::identity()).determinant() > 0.0
        };
        let searched = (0..SEARCHED).map(|k| shortest * 1.01_f64.powi(k));
        let mut within = searched.take_while(|dt| *dt < 1.01 * longest);
        let found = within.find(|dt| !is_stable(*dt));
        found.map_or(f64::INFINITY, |dt| halved([dt / 1.01, dt], HALVED, is_stable)[0])
    }

    fn limit_of_single_sweep(&self, longest: f64) -> f64 {
        let is_stable = |dt: f64| growth_of(self.single_sweep_step(dt), -1e-9) < 1e-9;
        // A viscous wave is stable beyond the limit of the leapfrog, which is infinite for a wave at rest.
        let far = longest.min(2.0 * self.limit(Integrator::Leapfrog)).min(f64::MAX.sqrt());
        let mut searched =
            (1..=SEARCHED_SINGLY).map(|k| far * f64::from(k) / f64::from(SEARCHED_SINGLY));
        let found = searched.find(|dt| !is_stable(*dt));
        let before = |dt: f64| dt - far / f64::from(SEARCHED_SINGLY);
        found.map_or(longest, |dt| halved([before(dt), dt], HALVED, is_stable)[0])
    }

    /// ln of the spectral radius of one step.
    pub fn growth(&self, integrator: Integrator, dt: f64) -> f64 {
        let radius = match integrator {
            Integrator::Leapfrog | Integrator::SuperLeapfrog => {
                let spectrum = self.leapfrog_step(integrator, dt).complex_eigenvalues();
                spectrum.iter().map(|s| modulus(*s)).fold(0.0, f64::max)
            }
            Integrator::SingleSweep => {
                return growth_of(self.single_sweep_step(dt), f64::NEG_INFINITY);
            }
            Integrator::Euler => self.largest(|s| Complex::new(1.0, 0.0) + s * dt),
            Integrator::PredictorCorrector => {
                self.largest(|s| Complex::new(1.0, 0.0) + s * dt + s * s * (0.5 * dt * dt))
            }
        };
        ln(radius)
    }

    fn largest(&self, factor: impl Fn(Complex<f64>) -> Complex<f64>) -> f64 {
        self.eigenvalues().map(|s| modulus(factor(s))).into_iter().fold(0.0, f64::max)
    }

    /// The symmetric matrix whose largest eigenvalue limits the leapfrog.
    fn stiffness(&self) -> Matrix3<f64> {
        let Self { omega, longitudinal, coupling, transverse, density, .. } = *self;
        rows_of([
            [density, omega, 0.0],
            [omega, longitudinal, coupling],
            [0.0, coupling, transverse],
        ])
    }

    /// One step of the leapfrog: v with the old v and p, then p with the new v.
    fn leapfrog_step(&self, integrator: Integrator, dt: f64) -> Matrix3<f64> {
        let Self { omega, longitudinal, coupling, transverse, density, viscous, .. } = *self;
        // The time of the kick for the forces other than viscosity, and the remaining factor of the
        // velocities.
        let (kick, left) = match integrator {
            Integrator::SuperLeapfrog if viscous * dt > 1e-9 => {
                let left = super_steps::factor(stages(dt / self.explicit), viscous * dt);
                let kick = (1.0 - left) / viscous;
                let left_by = |damping: f64| left - (damping - viscous) * kick;
                (kick, [longitudinal, transverse].map(left_by))
            }
            _ => (dt, [longitudinal, transverse].map(|damping| 1.0 - damping * dt)),
        };
        let kick = rows_of([
            [1.0, 0.0, 0.0],
            [omega * kick, left[0], -coupling * kick],
            [0.0, -coupling * kick, left[1]],
        ]);
        let drift =
            rows_of([[1.0 - density * dt, -omega * dt, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        drift * kick
    }

    /// One step of the single sweep: of ρ̃, v_l, v_t, the density as rates made it, and its last rate.
    fn single_sweep_step(&self, dt: f64) -> SMatrix<f64, 5, 5> {
        let Self { omega, longitudinal, coupling, transverse, density, .. } = *self;
        let rate = [-density * dt, -omega * dt];
        SMatrix::<f64, 5, 5>::from([
            [3.0 * rate[0], 3.0 * rate[1], 0.0, 1.0, -1.0],
            [omega * dt, 1.0 - longitudinal * dt, -coupling * dt, 0.0, 0.0],
            [0.0, -coupling * dt, 1.0 - transverse * dt, 0.0, 0.0],
            [rate[0], rate[1], 0.0, 1.0, 0.0],
            [rate[0], rate[1], 0.0, 0.0, 0.0],
        ])
        .transpose()
    }

    /// Eigenvalues of (p, v_l, v_t)' \[1/s\]: in closed form without coupling, for then zero and
    /// undamped waves keep an exact real part.
    fn eigenvalues(&self) -> [Complex<f64>; 3] {
        let Self { omega, longitudinal, coupling, transverse, density, .. } = *self;
        if coupling.abs() > 1e-12 * (longitudinal + transverse) {
            let spectrum = rows_of([
                [-density, -omega, 0.0],
                [omega, -longitudinal, -coupling],
                [0.0, -coupling, -transverse],
            ])
            .complex_eigenvalues();
            return [spectrum[0], spectrum[1], spectrum[2]];
        }
        let mean = -0.5 * (longitudinal + density);
        let discriminant = (0.5 * (longitudinal - density)).powi(2) - omega * omega;
        let shear = Complex::new(-transverse, 0.0);
        if discriminant < 0.0 {
            let s = Complex::new(mean, (-discriminant).sqrt());
            return [s, s.conj(), shear];
        }
        let fast = mean - discriminant.sqrt();
        let product = longitudinal * density + omega * omega;
        let slow = if fast == 0.0 { 0.0 } else { product / fast };
        [Complex::new(fast, 0.0), Complex::new(slow, 0.0), shear]
    }
}

/// ln of the spectral radius, from the 2⁴⁰th power; of one below `enough` a bound that is below it as well.
fn growth_of(mut step: SMatrix<f64, 5, 5>, enough: f64) -> f64 {
    let (mut growth, mut share) = (0.0, 1.0);
    for _ in 0..40 {
        let size = step.amax();
        growth += share * ln(size);
        // No entry of the square of a matrix is above five times the square of its largest one.
        let most = growth + share * ln(5.0);
        if most < enough {
            return most;
        }
        step /= size;
        step *= step;
        share *= 0.5;
    }
    growth
}

/// The matrix with these rows.
fn rows_of(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from(rows).transpose()
}

/// The root τ of -2c + 2c²τ - cτ² + τ³/4 in (0, 3) for 0 < c ≤ 1: the limit |s| dt of the midpoint
/// rule in direction c = -Re s/|s|. The cubic rises with τ (its derivative has discriminant
/// 4c² - 6c² < 0), from -2c at 0 to at least 3/4 at 3.
fn midpoint_root(c: f64) -> f64 {
    let is_growing = |tau: f64| ((0.25 * tau - c) * tau + 2.0 * c * c) * tau > 2.0 * c;
    let [low, high] = halved([0.0, 3.0], 60, |tau| !is_growing(tau));
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::tests::assert_rounds_to;
    use approx::assert_relative_eq;
    use touchstone_solver::kernel::{CubicSpline, Kernel, QuinticSpline, WendlandC2};

    const WATER: WaveMedium = WaveMedium::of_sound(1.0, 1.0);
    use Integrator::{Euler, Leapfrog, PredictorCorrector, SingleSweep};

    type Rate = fn(&Mode) -> f64;

    fn oscillator(omega: f64, gamma: f64) -> Mode {
        let along = Vector2::x();
        Mode {
            along,
            omega,
            longitudinal: gamma,
            coupling: 0.0,
            transverse: 0.0,
            density: 0.0,
            viscous: gamma,
            damped: 0.0,
            explicit: 0.0,
        }
    }

    /// With Wendland's kernel and h = dx, the support of 2 h contains the four nearest particles, with F =
    /// 35/(4π h⁴) (1 - 1/2)³, and four on the diagonals. The wave with opposite neighbours along both axes
    /// has the largest eigenvalue: four times 2 · 2 F dx² = 35/(2π h²), without a contribution of the
    /// diagonals. The step of forward Euler is 2 over 1.1 times this: 0.3264 h²/ν.
    #[test]
    fn the_explicit_limit_is_that_of_the_stiffest_wave_and_a_tenth_for_disorder() {
        let lattice = SquareLattice::of::<WendlandC2>(1.0, 0.0);
        let (h, nu) = (0.02, 3e-3);
        let expected = 2.0 / (1.1 * 35.0 / (2.0 * std::f64::consts::PI)) * h * h / nu;
        assert!((expected * nu / (h * h) - 0.3264).abs() < 1e-4, "{expected} s by hand");
        let found = explicit_limit(lattice.stiffest(), h, nu);
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} s, expected {expected} s");
        let medium = WaveMedium { nu, ..WaveMedium::of_sound(1.0, h) };
        for mode in modes(&lattice, 8, &medium) {
            let apart = (mode.explicit / expected - 1.0).abs();
            assert!(apart < 1e-12, "{} s of a wave, expected {expected} s", mode.explicit);
        }
    }

    /// Table 2.1: leapfrog limit of sound c₀ dt/h and limit of viscosity ν dt/h² at η² = 0.01 h².
    #[test]
    fn separate_limits_match_the_design_table() {
        fn check<K: Kernel>(ratio: f64, printed: [&str; 2]) {
            let lattice = SquareLattice::of::<K>(ratio, 0.01);
            let modes = modes(&lattice, 120, &WaveMedium { nu: 1.0, ..WATER });
            let row = format!("{} {ratio}", K::NAME);
            let limits: [Rate; 2] = [|mode| mode.omega, |mode| mode.viscous];
            assert_rounds_to(&row, &printed, &limits.map(|rate| limit_alone(&modes, rate)));
            assert_eq!(limit_alone(&modes, Mode::artificial), f64::INFINITY);
        }
        check::<CubicSpline>(1.2, ["1.867", "0.352"]);
        check::<CubicSpline>(1.3, ["1.868", "0.353"]);
        check::<CubicSpline>(1.5, ["1.861", "0.357"]);
        check::<QuinticSpline>(1.0, ["2.311", "0.526"]);
        check::<WendlandC2>(1.5, ["1.775", "0.313"]);
        check::<WendlandC2>(2.0, ["1.761", "0.303"]);
    }

    /// The theory against the measurements of 2.1: 20 × 20 particles, cubic, h = 1.3 dx, c₀h/ν = ∞, 10 and 1.
    /// The notes print 1.659 for 10, which is the infinite lattice (1.6595); the box of the measurement
    /// (1.666) allows 1.6649. They print 0.3530 for 1; the theory gives 0.3529 (measured 0.3551).
    #[test]
    fn measured_box_matches_the_design_table() {
        let lattice = SquareLattice::of::<CubicSpline>(1.3, 0.01);
        let limit = |n: usize, nu: f64, integrator| {
            time_step_limit(&modes(&lattice, n, &WaveMedium { nu, ..WATER }), integrator)
        };
        let leapfrog = [0.0, 0.1, 1.0].map(|nu| limit(20, nu, Leapfrog));
        assert_rounds_to("leapfrog", &["1.868", "1.6649", "0.3529"], &leapfrog);
        assert_rounds_to("infinite", &["1.6595"], &[limit(80, 0.1, Leapfrog)]);
        assert_rounds_to("midpoint", &["0.3529"], &[limit(20, 1.0, PredictorCorrector)]);
        for (theory, measured) in leapfrog.iter().zip([1.867, 1.666, 0.3551]) {
            assert_relative_eq!(*theory, measured, max_relative = 7e-3);
        }
        assert_eq!(limit(20, 0.0, PredictorCorrector), 0.0);
        assert_eq!(limit(20, 0.0, Euler), 0.0);
    }

    /// R4 and R5 of 2.4: 1.03 h/(α c) and 0.347 h/(δ c).
    #[test]
    fn dissipation_limits_match_the_design_text() {
        let lattice = SquareLattice::of::<CubicSpline>(1.2, 0.01);
        let medium = WaveMedium { alpha: 1.0, delta: 1.0, ..WATER };
        let modes = modes(&lattice, 120, &medium);
        let limits: [Rate; 2] = [Mode::artificial, |mode| mode.density];
        let computed = limits.map(|rate| limit_alone(&modes, rate));
        assert_rounds_to("R4, R5", &["1.03", "0.347"], &computed);
    }

    /// 2.1: at Courant number 0.5 a 20 × 20 box was stable for c₀h/ν = 40 and grew by 2.6e-3 a step for 80.
    /// At 40 the fastest mode is the density checkerboard, for which g is 0: neutral.
    #[test]
    fn measured_threshold_of_the_predictor_corrector() {
        let lattice = SquareLattice::of::<CubicSpline>(1.3, 0.01);
        let growth = [40.0, 80.0].map(|x| {
            let modes = modes(&lattice, 20, &WaveMedium { nu: 1.0 / x, ..WATER });
            growth_per_step(&modes, PredictorCorrector, 0.5)
        });
        assert_eq!(growth[0], 0.0);
        assert_rounds_to("growth", &["2.8e-3"], &[growth[1]]);
    }

    #[test]
    fn mixed_limits_match_the_design_text() {
        let lattice = SquareLattice::of::<CubicSpline>(1.2, 0.01);
        let limit = |medium: WaveMedium| time_step_limit(&modes(&lattice, 80, &medium), Leapfrog);
        let mixed = [10.0, 30.0, 100.0].map(|x: f64| limit(WaveMedium { nu: 1.0 / x, ..WATER }));
        assert_rounds_to("c h/nu = 10, 30, 100", &["1.655", "1.797", "1.846"], &mixed);
        let alphas =
            [0.0, 0.01, 0.1, 0.5, 1.0, 2.0].map(|alpha| limit(WaveMedium { alpha, ..WATER }));
        let printed = ["1.867", "1.860", "1.796", "1.469", "1.028", "0.515"];
        assert_rounds_to("alpha", &printed, &alphas);
    }

    /// The smaller of the separate limits is too long by up to 28 %, where the two meet. The design
    /// notes say 12 % at most, which is their value at c₀h/ν = 10.
    #[test]
    fn separate_limits_are_optimistic() {
        let lattice = SquareLattice::of::<CubicSpline>(1.2, 0.01);
        let excess = [3.0, 5.3, 10.0, 30.0, 100.0].map(|x: f64| {
            let medium = WaveMedium { nu: 1.0 / x, ..WATER };
            let modes = modes(&lattice, 80, &medium);
            let alone = |rate: Rate| limit_alone(&modes, rate);
            let together = time_step_limit(&modes, Leapfrog);
            alone(|mode| mode.omega).min(alone(|mode| mode.viscous)) / together - 1.0
        });
        assert_rounds_to("excess", &["0.00", "0.28", "0.13", "0.04", "0.01"], &excess);
    }

    /// A damping γ = α₂ ω² h/c₀ makes the limit (2 − γ dt) 2 ≥ (ω dt)² of the fastest wave, ω in c₀/h, a step
    /// of (α₂² + 4/ω²)^(1/2) − α₂ in h/c₀. A shear wave is not damped.
    #[test]
    fn the_acoustic_damper_limits_the_step_by_the_square_of_the_symbol_of_the_gradient() {
        let lattice = SquareLattice::of::<WendlandC2>(1.5, 0.01);
        let undamped = modes(&lattice, 80, &WATER);
        let fastest = 2.0 / limit_alone(&undamped, |mode| mode.omega);
        for damper in [0.1, 0.5, 1.0, 2.0] {
            let modes = modes(&lattice, 80, &WaveMedium { damper, ..WATER });
            let expected = (damper * damper + 4.0 / (fastest * fastest)).sqrt() - damper;
            assert_relative_eq!(time_step_limit(&modes, Leapfrog), expected, max_relative = 1e-12);
            let alone = limit_alone(&modes, |mode| mode.damped);
            assert_relative_eq!(alone, 2.0 / (damper * fastest * fastest), max_relative = 1e-12);
            let others = modes.iter().map(|mode| mode.transverse.max(mode.artificial()));
            assert!(others.fold(0.0, f64::max) < 1e-12);
        }
    }

    /// Table 2.2: largest ω dt at γ/ω = 0.1, 1, 10 and largest γ dt.
    #[test]
    fn oscillator_limits_match_the_design_table() {
        for (integrator, printed) in [
            (PredictorCorrector, ["0.80", "2.00", "0.202", "2.0"]),
            (Leapfrog, ["1.90", "1.24", "0.198", "2.0"]),
            (Euler, ["0.10", "1.00", "0.202", "2.0"]),
        ] {
            let coupled = [0.1, 1.0, 10.0].map(|gamma| oscillator(1.0, gamma).limit(integrator));
            let shear = oscillator(0.0, 1.0).limit(integrator);
            let computed = [coupled.as_slice(), &[shear]].concat();
            assert_rounds_to(&format!("{integrator:?}"), &printed, &computed);
        }
        assert_relative_eq!(oscillator(1.0, 0.0).limit(Leapfrog), 2.0, max_relative = 1e-14);
    }

    /// The limits against the spectral radius, which they were not derived from: just below stable,
    /// just above growing, for coupled and uncoupled waves.
    #[test]
    fn spectral_radius_crosses_one_at_the_limit() {
        let lattice = SquareLattice::of::<CubicSpline>(1.2, 0.01);
        for (nu, alpha, delta) in
            [(0.1, 0.0, 0.0), (0.0, 0.5, 0.0), (0.02, 1.0, 0.1), (1.0, 0.1, 0.1)]
        {
            let modes = modes(&lattice, 12, &WaveMedium { nu, alpha, delta, ..WATER });
            for integrator in [PredictorCorrector, Leapfrog, SingleSweep, Euler] {
                for mode in &modes {
                    let limit = mode.limit(integrator);
                    let (below, above) = (0.999 * limit, 1.001 * limit);
                    assert!(mode.growth(integrator, below) < 1e-9, "{integrator:?} {mode:?}");
                    assert!(mode.growth(integrator, above) > 1e-9, "{integrator:?} {mode:?}");
                }
            }
        }
    }

    /// The roots of (z - 1)² z² + (ω dt)² (3z² - 3z + 1) at the limit are exp(±iπ/3) and (1 ± i)/2, and for
    /// small steps |z| = 1 - (ω dt)⁴/2. Viscosity alone has the limit of the leapfrog.
    #[test]
    fn a_single_sweep_damps_sound_up_to_its_limit() {
        let sound = oscillator(1.0, 0.0);
        assert_relative_eq!(sound.limit(SingleSweep), 0.5_f64.sqrt(), max_relative = 1e-6);
        let growth = Mode { transverse: 1.0, ..sound }.growth(SingleSweep, 0.1);
        assert_relative_eq!(growth, -0.5e-4, max_relative = 0.01);
        assert_relative_eq!(oscillator(0.0, 1.0).limit(SingleSweep), 2.0, max_relative = 1e-6);
        // The leapfrog has 1.90, 1.24 and 0.198.
        let coupled = [0.1, 1.0, 10.0].map(|gamma| oscillator(1.0, gamma).limit(SingleSweep));
        assert_rounds_to("single sweep", &["0.70", "0.65", "0.216"], &coupled);
    }

    #[test]
    fn undamped_growth_has_its_closed_form() {
        for omega_dt in [0.2, 0.4, 0.5] {
            let growth = oscillator(1.0, 0.0).growth(PredictorCorrector, omega_dt);
            let closed = 0.5 * ln(1.0 + 0.25 * omega_dt.powi(4));
            assert_relative_eq!(growth, closed, max_relative = 1e-10);
            assert_relative_eq!(growth, omega_dt.powi(4) / 8.0, max_relative = 0.01);
        }
        let lattice = SquareLattice::of::<CubicSpline>(1.3, 0.01);
        let modes = modes(&lattice, 20, &WATER);
        let growth = [0.4, 0.5].map(|cfl| growth_per_step(&modes, PredictorCorrector, cfl));
        assert_rounds_to("growth", &["4.19e-3", "1.02e-2"], &growth);
    }
}
