//! Waves, boxes at rest, extremes and operators on a lattice: no more than the equations.

use touchstone_harness::method::{FromMedium, Medium};
use touchstone_solver::terms::Pair;
use touchstone_solver::{
    ArtificialViscosity, Compose, ConsistentContinuity, ConsistentPressure, ConsistentViscosity,
    Continuity, CubicSpline, DensityDiffusion, Kernel, Leapfrog, Open, PredictorCorrector,
    Pressure, QuinticSpline, Rate, SingleSweep, Smoothing, Split, SuperSteps, Tait, Term,
    Viscosity, WendlandC2, lane::Lane, particles::Common,
};

use crate::{Method, methods, stepped};

type Equations = (Pressure<Tait>, Viscosity);
type Plain<K, I = Leapfrog> = Compose<K, Equations, Continuity, Open, I>;
type Damped = (Pressure<Tait>, Viscosity, ArtificialViscosity<Tait, true>);
type Diffusive<F> = Compose<CubicSpline, F, (Continuity, DensityDiffusion), Open, Leapfrog>;
/// Sums that are exact for linear fields.
type Corrected<K> = Compose<
    K,
    (ConsistentPressure<Tait>, ConsistentViscosity),
    ConsistentContinuity,
    Open,
    Leapfrog,
>;
type Summing<K> = Compose<K, (), Summation<K>, Open, Leapfrog>;

methods! { stepped => Method:
    /// The equations with the cubic spline and the leapfrog.
    cubic: Plain<CubicSpline>;
    /// [`cubic`] with the predictor-corrector.
    midpoint: Plain<CubicSpline, PredictorCorrector>;
    /// [`cubic`] with one pair sweep a step.
    single_sweep: Plain<CubicSpline, SingleSweep>;
    /// [`cubic`] with the quintic spline.
    quintic: Plain<QuinticSpline>;
    /// [`cubic`] with Wendland's function.
    wendland: Plain<WendlandC2>;
    /// [`cubic`] with density diffusion.
    diffusive: Diffusive<Equations>;
    /// [`diffusive`] with artificial viscosity on every pair.
    damped: Diffusive<Damped>;
    /// [`cubic`] with super-time-stepping.
    super_stepping:
        Compose<CubicSpline, Split<Pressure<Tait>, Viscosity>, Continuity, Open, Leapfrog<SuperSteps>>;

    /// [`cubic`] with sums that are exact for linear fields.
    cubic_corrected: Corrected<CubicSpline>;
    /// [`quintic`] with them.
    quintic_corrected: Corrected<QuinticSpline>;
    /// [`wendland`] with them.
    wendland_corrected: Corrected<WendlandC2>;
    /// Densities that are sums of masses, with the cubic spline.
    cubic_sum: Summing<CubicSpline>;
    /// [`cubic_sum`] with the quintic spline.
    quintic_sum: Summing<QuinticSpline>;
    /// [`cubic_sum`] with Wendland's function.
    wendland_sum: Summing<WendlandC2>;
}

/// ρ ← Σ m W within a step of [`summing_step`], the density of many other codes; the schemes of the
/// benchmarks integrate (3) instead.
#[derive(Clone, Copy, Debug)]
pub struct Summation<K> {
    kernel: Smoothing<K>,
    /// 1/dt \[1/s\].
    rate: f64,
}

/// The time step for the measurement of operators, 1e-6 h/c₀ \[s\]: short enough that nothing changes by more
/// than 1e-5 of its value, the bound of the gates, and long enough that velocities and densities change by
/// more than their round-off.
pub fn summing_step(medium: &Medium) -> f64 {
    1e-6 * medium.h / medium.eos.sound_speed
}

impl<K: Kernel> FromMedium for Summation<K> {
    fn new(m: &Medium) -> Self {
        Self { kernel: Smoothing::new(m.h), rate: 1.0 / summing_step(m) }
    }
    fn state(terms: &mut Vec<&'static str>) {
        terms.push("ρ_i = Σ m_j W_ij, the particle itself included, after one step");
    }
}

impl<X, K: Kernel> Term<X> for Summation<K> {
    type Derived = ();
    type Sum = f64;

    #[inline(always)]
    fn pair<V: Lane, W: Kernel>(&self, pair: &Pair<V, W>, sum: &mut V) {
        *sum += pair.other.mass * pair.w();
    }

    #[inline(always)]
    fn finish(&self, own: &Common, _: (), sum: f64, rate: &mut Rate<X>) {
        rate.density += (sum + own.mass * self.kernel.w(0.0) - own.density) * self.rate;
    }
}
