//! One operator: scene, steps, record.

use nalgebra::Vector2;
use touchstone_base::{absent::Absent, functions::cos, random::Random, record::Status};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Parameter, Step},
    snapshot::{ParticleArrays, Point, Snapshot},
};
use touchstone_maths::{
    exact::plane_wave::{K, PRESSURE, SPEED, scalar, slope, vector},
    theory::time_step::{Mode, WaveMedium},
};
use touchstone_schemes::lattice::summing_step;
use touchstone_solver::{EquationOfState, Tait, lattice};

use super::{Operator, OperatorSettings, OperatorVariant};

touchstone_base::metrics! {
    all ALL;
    ERROR = "error" ["-"] "(sum |o - o_exact|^2/sum |o_exact|^2)^(1/2) over particles, o the operator";
    GAIN = "gain" ["-"] "sum o o_exact/sum o_exact^2";
    BIAS = "bias" ["-"] "|gain - 1|";
    NOISE = "noise" ["-"] "(sum |o - gain o_exact|^2/sum |o_exact|^2)^(1/2)";
    SYMBOL_ERROR = "symbol_error" ["-"] "|gain/(gain of theory) - 1| on a lattice";
    SUM_ERROR = "sum_error" ["-"]
        "(sum |o - s|^2/sum |s|^2)^(1/2), s the sum over pairs of the particles at the start: m_j W - 1 \
         (density), -m_j (p_i/rho_i^2 + p_j/rho_j^2) grad W (gradient), 2 nu (m_j/rho_j) (v_i - v_j) r.grad \
         W/(r^2 + eta^2) (laplacian), -(m_j/rho_i) (v_i - v_j).grad W (divergence)";
}

/// Amplitude of the density that is summed \[ρ₀\].
const DENSITY: f64 = 0.5;
/// η² of (6) \[h²\]: a guard against 0/0 and no more.
const ETA2: f64 = 1e-6;

/// The fields and the operators, for other codes.
pub(super) fn field() -> Parameter {
    let about = "wave number K of the fields; φ = sin Kx cos Ky, ψ = cos Kx sin Ky. The operator o and its \
                 exact value: density: ρ/ρ0 - 1 after the step, φ/2; gradient: (v - v_start)/t, -∇p/ρ of p \
                 = 1e-6 ρ0 c0² φ; laplacian: (v - v_start)/t, ν ∇²v of v = 0.1 c0 (φ, ψ); divergence: \
                 (ρ_start - ρ)/t, ∇·v of the same v";
    Parameter { name: "K", value: K, unit: "1/m", about }
}

/// The guard of the Laplacian, for other codes.
pub(super) fn guard() -> Parameter {
    let about = "η² over h² of the viscous sum, a guard against 0/0";
    Parameter { name: "eta2_over_h2", value: ETA2, unit: "-", about }
}

fn medium(method: &Method, s: &OperatorSettings) -> Medium {
    let dx = 1.0 / s.n as f64;
    let medium = method.properties.medium(Tait::new(1.0, 1.0), dx, s.h_over_dx * dx);
    // Viscosity as fast as sound.
    Medium { nu: medium.h * medium.eos.sound_speed, eta2_over_h2: ETA2, ..medium }
}

impl Operator {
    /// The particle at a place that has the field.
    fn particle(self, x: Vector2<f64>, Medium { eos, dx, .. }: &Medium) -> Particle {
        let (velocity, density) = match self {
            Self::Density => (Vector2::zeros(), 1.0 + DENSITY * scalar(x)),
            Self::Gradient => (Vector2::zeros(), eos.density(PRESSURE * scalar(x))),
            Self::Laplacian | Self::Divergence => (vector(x) * SPEED, 1.0),
        };
        Particle::fluid(x, velocity, density, dx * dx)
    }

    /// The operator applied to the field of each particle since the start, and the exact value.
    ///
    /// # Errors
    /// Without densities that the operator reads.
    fn values(self, start: &ParticleArrays, end: &Snapshot, m: &Medium) -> Result<Values, Absent> {
        let (all, time) = (end.all(), end.time());
        let before = |k: usize| Ok::<f64, Absent>(start.densities()?[k]);
        let after = |p: &Point| Ok::<f64, Absent>(end.density()?.of(p));
        let along = |value| Vector2::new(value, 0.0);
        let value = |(k, (start, end)): (usize, (&Point, &Point))| {
            let (x, accelerated) = (start.position, (end.velocity - start.velocity) / time);
            Ok(match self {
                Self::Density => [along(after(end)? - 1.0), along(DENSITY * scalar(x))],
                Self::Gradient => [accelerated, -slope(x) * (PRESSURE * K / before(k)?)],
                Self::Laplacian => [accelerated, vector(x) * (-2.0 * K * K * m.nu * SPEED)],
                Self::Divergence => {
                    let exact = 2.0 * SPEED * K * cos(K * x.x) * cos(K * x.y);
                    [along((before(k)? - after(end)?) / time), along(exact)]
                }
            })
        };
        start.points.iter().zip(&all).enumerate().map(value).collect()
    }
}

/// Computed and exact value at each particle.
type Values = Vec<[Vector2<f64>; 2]>;

impl OperatorVariant {
    /// The gain on a lattice: the symbol of the sum over the symbol of the continuum, for a diagonal wave.
    fn symbol(&self, method: &Method, s: &OperatorSettings, weight: &dyn Fn(f64) -> f64) -> f64 {
        let (ratio, dx) = (s.h_over_dx, 1.0 / s.n as f64);
        let phase = K * dx;
        let plain = method.properties.square(ratio, 0.0);
        let corrected = if self.is_corrected { plain.gradient_factor() } else { 1.0 };
        match self.operator {
            Operator::Density => {
                let reach = (method.properties.support * ratio).ceil() as i32;
                let all = (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |j| [i, j]));
                all.map(|k| k.map(f64::from))
                    .map(|[i, j]| weight((i * i + j * j) * dx * dx) * cos(phase * (i + j)))
                    .fold(0.0, |sum, w| sum + dx * dx * w)
            }
            Operator::Laplacian => {
                let eta2 = if self.is_corrected { 0.0 } else { ETA2 };
                let unit = WaveMedium { nu: 1.0, ..WaveMedium::of_sound(1.0, 1.0) };
                let lattice = method.properties.square(ratio, eta2);
                let mode = Mode::new(&lattice, Vector2::repeat(phase), &unit);
                mode.viscous / (2.0 * (phase * ratio).powi(2)) / corrected
            }
            Operator::Gradient | Operator::Divergence => {
                plain.gradient(Vector2::repeat(phase)).x / (phase * ratio) / corrected
            }
        }
    }
}

/// The operator summed pair by pair; only the values of the kernel come from the solver.
struct PairwiseSums<'a> {
    operator: Operator,
    medium: &'a Medium,
    /// Where the kernel ends \[m\].
    reach: f64,
    /// W \[1/m²\] of r² \[m²\].
    weight: &'a dyn Fn(f64) -> f64,
}

impl PairwiseSums<'_> {
    /// The distance of the operator of a run from its sum, over the sum, rms over particles.
    ///
    /// # Errors
    /// Without densities at the start, or if the nearest image is not the only one in reach.
    fn error(&self, start: &ParticleArrays, values: &Values) -> Result<f64, Absent> {
        if self.reach >= 0.5 {
            return Err(Absent::because("the support reaches half of the period"));
        }
        let start: Vec<(Point, f64)> =
            start.points.iter().copied().zip(start.densities()?.iter().copied()).collect();
        let strips = (1.0 / self.reach) as usize;
        let strip = |x: f64| ((x - x.floor()) * strips as f64) as usize % strips;
        let mut near = vec![Vec::new(); strips];
        start.iter().for_each(|p| near[strip(p.0.position.x)].push(p));
        let (mut off, mut scale) = (0.0, 0.0);
        for (own, [found, _]) in start.iter().zip(values) {
            let middle = strip(own.0.position.x);
            let mut around = [middle + strips - 1, middle, middle + 1].map(|k| k % strips).to_vec();
            around.sort_unstable();
            around.dedup();
            let others = around.into_iter().flat_map(|k| &near[k]);
            let sum = others.fold(Vector2::zeros(), |sum, other| sum + self.pair(own, other));
            let sum = if self.operator == Operator::Density { sum - Vector2::x() } else { sum };
            off += (found - sum).norm_squared();
            scale += sum.norm_squared();
        }
        Ok((off / scale).sqrt())
    }

    /// The contribution of one particle, which may be an image of the particle itself.
    fn pair(&self, own: &(Point, f64), other: &(Point, f64)) -> Vector2<f64> {
        let ((own, own_density), (other, other_density)) = (own, other);
        let Medium { eos, density, nu, h, .. } = self.medium;
        let r = (own.position - other.position).map(|x| x - x.round());
        let (r2, v, mass) = (r.norm_squared(), own.velocity - other.velocity, other.mass);
        if r2 >= self.reach * self.reach {
            return Vector2::zeros();
        }
        if self.operator == Operator::Density {
            return Vector2::new(mass * (self.weight)(r2), 0.0);
        }
        // ∇W is r times twice the slope of W over r².
        const SHARE: f64 = 1e-5;
        let rise = (self.weight)(r2 * (1.0 + SHARE)) - (self.weight)(r2 * (1.0 - SHARE));
        let slope = if r2 > 0.0 { rise / (SHARE * r2) } else { 0.0 };
        let share = |density: &f64| eos.pressure(*density) / (density * density);
        match self.operator {
            Operator::Gradient => r * (-mass * slope * (share(own_density) + share(other_density))),
            Operator::Laplacian => {
                let viscous = 2.0 * nu * density / (own_density * other_density);
                v * (viscous * mass * slope * r2 / (r2 + ETA2 * h * h))
            }
            _ => Vector2::new(-mass / own_density * slope * v.dot(&r), 0.0),
        }
    }
}

/// A run of an operator.
pub(super) struct Sampled {
    of: &'static OperatorVariant,
    method: Method,
    settings: OperatorSettings,
    medium: Medium,
    rules: Rules,
}

impl Sampled {
    pub fn new(of: &'static OperatorVariant, method: &Method, s: &OperatorSettings) -> Self {
        let medium = medium(method, s);
        let limits = method.properties.limits_in(&medium, s.h_over_dx, 32);
        let step = Step::given(summing_step(&medium));
        let rules = Rules { step, limits, sound_speed: 1.0, end: step.dt * s.steps as f64 };
        Self { of, method: method.clone(), settings: s.clone(), medium, rules }
    }
}

impl Problem for Sampled {
    type Extra = ();
    type Simulation = dyn Stepper<()>;
    /// The particles at the start.
    type Watch = ParticleArrays;
    const READS_START: bool = true;

    fn method(&self) -> &Method {
        &self.method
    }

    fn brief(&self) -> Brief {
        let OperatorSettings { n, h_over_dx, .. } = self.settings;
        Brief::new(self.medium, self.rules, (n * n) as f64, "n or steps")
            .numbers(&self.rules.numbers(h_over_dx, self.medium.dx))
    }

    fn scene(&self) -> Result<Parts, RunError> {
        let (s, medium) = (&self.settings, self.medium);
        let mut random = Random::new(s.seed as u64);
        let mut shake = || s.disorder * medium.dx * (2.0 * random.uniform() - 1.0);
        let all = lattice(Vector2::repeat(0.5 * medium.dx), medium.dx, s.n, s.n)
            .map(|x| self.of.operator.particle(x + Vector2::new(shake(), shake()), &medium));
        Ok(Parts::new(medium, Domain::torus(1.0, 1.0), all.collect()))
    }

    fn watch(&self, scene: &Snapshot, _: &Snapshot) -> ParticleArrays {
        scene.columns().cloned().unwrap_or_default()
    }

    fn measure(&self, start: ParticleArrays, end: &Snapshot, record: &mut Record) {
        if record.status != Status::Completed {
            return;
        }
        let Self { of, method, settings, medium, .. } = self;
        let values = match of.operator.values(&start, end, medium) {
            Ok(values) => values,
            Err(absent) => return record.leave_all_out(ALL, &absent),
        };
        measure(&values, record);
        let weight: &dyn Fn(f64) -> f64 = &|r2| end.weight(r2);
        if !of.is_corrected {
            let reach = method.properties.support * medium.h;
            let sums = PairwiseSums { operator: of.operator, medium, reach, weight };
            record.put_or_absent(SUM_ERROR, sums.error(&start, &values));
        }
        if settings.disorder == 0.0 {
            let symbol = of.symbol(method, settings, weight);
            let gain = record.value(GAIN).unwrap_or(f64::NAN);
            record.put(SYMBOL_ERROR, (gain / symbol - 1.0).abs());
        }
    }
}

/// The operator on all particles against its exact values.
fn measure(values: &Values, record: &mut Record) {
    let sum = |f: &dyn Fn(&[Vector2<f64>; 2]) -> f64| values.iter().fold(0.0, |sum, v| sum + f(v));
    let scale = sum(&|[_, exact]| exact.norm_squared());
    let gain = sum(&|[found, exact]| found.dot(exact)) / scale;
    let off =
        |gain: f64| (sum(&|[found, exact]| (found - exact * gain).norm_squared()) / scale).sqrt();
    record.put(ERROR, off(1.0));
    record.put(GAIN, gain);
    record.put(BIAS, (gain - 1.0).abs());
    record.put(NOISE, off(gain));
}
