//! One operator at a time: sums over neighbours on a lattice and on disordered particles.

use nalgebra::Vector2;
use touchstone_maths::exact::plane_wave::{K, PRESSURE, SPEED, slope, vector};

use super::{Criterion, Factor, Finding, NotApplicable, Pose, Question, Reads, Solved, fit, named};

/// Particles with the fields; h is not the spacing, so that one in place of the other shows.
fn particles(variant: &'static str, n: &str, disorder: &str) -> Pose {
    Pose::of("operators", variant, &[n, disorder, "h_over_dx=1.2"])
}

fn lattices(variant: &'static str) -> [Pose; 2] {
    ["n=24", "n=44"].map(|n| particles(variant, n, "disorder=0"))
}

/// Rates of change of velocity or density, and their exact values, as fields on the start.
type Field = fn(&Solved) -> Result<Vec<[Vector2<f64>; 2]>, NotApplicable>;

/// The factor of an operator in the limit of fine lattices.
fn limit(coarse: &Solved, fine: &Solved, field: Field) -> Result<Factor, NotApplicable> {
    let gain = |of: &Solved| {
        if let Some(few) = of.entry.few_digits(&of.problem) {
            return Err(format!("rates over a short time need all digits of a double: {few}"));
        }
        Ok(fit::factor(fit::components(field(of)?.into_iter())))
    };
    let spacings = [coarse, fine].map(|of| of.problem.outline.medium.dx);
    Ok(fit::limit([gain(coarse)?, gain(fine)?], spacings))
}

fn accelerations(
    of: &Solved,
    exact: impl Fn(usize, Vector2<f64>) -> Vector2<f64>,
) -> Vec<[Vector2<f64>; 2]> {
    let time = of.end().time;
    let pairs = of.start.states.iter().zip(&of.end().states).enumerate();
    pairs.map(|(k, (a, b))| [(b.velocity - a.velocity) / time, exact(k, a.position)]).collect()
}

/// −∇p/ρ of the pressure of the start.
fn pressure_force(of: &Solved) -> Result<Vec<[Vector2<f64>; 2]>, NotApplicable> {
    let eos = &of.problem.outline.medium.eos;
    let amplitude = PRESSURE * eos.density * eos.sound_speed.powi(2) * K;
    Ok(accelerations(of, |k, x| {
        slope(x) * (-amplitude / of.start.states[k].density.unwrap_or(eos.density))
    }))
}

/// ν ∇²v of the velocity of the start.
fn viscous_force(of: &Solved) -> Result<Vec<[Vector2<f64>; 2]>, NotApplicable> {
    let medium = &of.problem.outline.medium;
    let rate = -2.0 * K * K * medium.nu * SPEED * medium.eos.sound_speed;
    Ok(accelerations(of, |_, x| vector(x) * rate))
}

/// Largest change of a density, over the density.
fn change_of_density(of: &Solved) -> Result<f64, NotApplicable> {
    let [start, end] = [of.start.densities()?, of.end().densities()?];
    Ok(start.iter().zip(&end).fold(0.0, |most: f64, (a, b)| most.max((b / a - 1.0).abs())))
}

/// Mean of the density over the mean at the start: the sum of the kernel over the particles.
fn normalisation(of: &Solved) -> Result<f64, NotApplicable> {
    let [start, end] = [of.start.densities()?, of.end().densities()?];
    let sum = |all: &[f64]| all.iter().fold(0.0, |sum, one| sum + one);
    Ok(sum(&end) / sum(&start))
}

pub fn density() -> Question {
    Question {
        id: "density",
        text: "Does the sum of the kernel give the density of a lattice, and of disordered particles?",
        poses: || {
            let [_, fine] = lattices("quintic-density");
            vec![fine, particles("quintic-density", "n=44", "disorder=0.2")]
        },
        answer: Reads::Results(|of| {
            let [regular, irregular] = named(of)?;
            let [lattice, disordered] = [normalisation(regular)?, normalisation(irregular)?];
            if change_of_density(regular)? < 1e-9 {
                return Err("the code integrates the density and does not sum it: the density of particles \
                            at rest has not changed"
                    .into());
            }
            let own = own_part(regular);
            let lacks_self = (lattice - (1.0 - own)).abs() < 0.02;
            let mut words = format!(
                "the kernel sums to {lattice:.4} on a lattice, to {disordered:.3} on disorder"
            );
            if lacks_self {
                words += ": the particle itself is missing in its sum";
            }
            let factor = Factor { value: lattice, uncertainty: 5e-3 };
            let lattice = Criterion::new(
                "sum on a lattice",
                lattice,
                [0.99, 1.01],
                "a support of 2 to 4 spacings: the sum differs from the integral by up to 0.5 %",
            );
            let disordered = Criterion::new(
                "sum on disordered particles",
                disordered,
                [0.95, 1.05],
                "displacements of up to 0.2 spacings change the mean by up to 2 %",
            );
            Ok(Finding::new(words, [lattice, disordered]).with(factor))
        }),
        finds: &["normalisation", "no-self"],
    }
}

/// Share of a particle in its own sum, m W(0)/ρ, of the kernel of the problem, the quintic spline: W(0) =
/// 66 · 7/(478 π h²).
fn own_part(of: &Solved) -> f64 {
    let medium = &of.problem.outline.medium;
    66.0 * 7.0 / (478.0 * std::f64::consts::PI) * (medium.dx / medium.h).powi(2)
}

/// Why factors of lattices are near 1.
const LATTICE: &str = "on a fine lattice the sums of usual kernels are exact to 1.1 % (a cubic spline with \
                       h/dx = 1.3 is the worst)";

/// Allowed factors.
const PRESSURE_BOUNDS: [f64; 2] = [0.985, 1.015];
const VISCOUS_BOUNDS: [f64; 2] = [0.98, 1.02];
/// A code that changes densities by more than this share within the short time, in which continuity changes
/// them by less than the amplitude of the pressure, computes them anew.
const OWN_DENSITY: f64 = 100.0 * PRESSURE;

pub fn gradient() -> Question {
    Question {
        id: "gradient",
        text: "Is the gradient of a linear and of a quadratic pressure right?",
        poses: || {
            let [coarse, fine] = lattices("quintic-gradient");
            vec![coarse, fine, particles("quintic-gradient", "n=24", "disorder=0.2")]
        },
        answer: Reads::Results(|of| {
            let [coarse, fine, irregular] = named(of)?;
            let factor = limit(coarse, fine, pressure_force)?;
            let on_lattice = Criterion::new(
                "factor of the pressure force",
                factor.value,
                PRESSURE_BOUNDS,
                LATTICE,
            );
            let words = factor.of("the pressure force");
            let changed = irregular.end().densities();
            let changed = changed.map_or(Ok(0.0), |_| change_of_density(irregular))?;
            if changed > OWN_DENSITY {
                let words = format!(
                    "{words}; disordered particles are not judged: the code replaces their density, \
                     by up to {changed:.2} of it, and with it the stated pressure"
                );
                return Ok(Finding::new(words, [on_lattice]).with(factor));
            }
            let pairs = pressure_force(irregular)?;
            let disordered = fit::factor(fit::components(pairs.iter().copied()));
            let off = pairs.iter().map(|[a, b]| (a - b * disordered.value).norm());
            let noise = fit::rms(off) / fit::rms(pairs.iter().map(|[_, b]| b.norm()));
            let mut criteria = vec![
                on_lattice,
                Criterion::new(
                    "factor on disordered particles",
                    disordered.value,
                    [0.85, 1.15],
                    "disorder of 0.2 spacings and 24 spacings a wave take up to 5 %",
                ),
            ];
            if irregular.entry.method.settings.get("gradient_correction") == Some(&true.into()) {
                criteria.push(Criterion::at_most(
                    "scatter on disordered particles",
                    noise,
                    0.1,
                    "by its stated gradient_correction it is exact for linear fields",
                ));
            }
            let words =
                format!("{words}; on disordered particles it scatters by {noise:.2} of its size");
            Ok(Finding::new(words, criteria).with(factor))
        }),
        finds: &[
            "pressure-factor",
            "normalisation",
            "smoothing-length",
            "spacing-for-h",
            "no-correction",
        ],
    }
}

pub fn viscous() -> Question {
    Question {
        id: "viscous-force",
        text: "Is the viscous force of a shear ν ∇²u?",
        poses: || {
            let [coarse, fine] = lattices("quintic-laplacian");
            let [other, last] = lattices("quintic-gradient");
            vec![coarse, fine, other, last]
        },
        answer: Reads::Results(|of| {
            let [coarse, fine, coarse_pressure, fine_pressure] = named(of)?;
            let factor = limit(coarse, fine, viscous_force)?;
            let gradient = limit(coarse_pressure, fine_pressure, pressure_force)?;
            let guard = "both are the lattice sum −½ Σ V r W': a guard η² = 0.01 h² against 0/0 lowers the \
                         viscosity alone, by 0.7 %";
            let mut words = factor.of("the viscous force");
            let mut criteria = vec![Criterion::new(
                "factor of the viscous force",
                factor.value,
                VISCOUS_BOUNDS,
                LATTICE,
            )];
            // A pressure force that is wrong itself has an answer of its own.
            if (PRESSURE_BOUNDS[0]..=PRESSURE_BOUNDS[1]).contains(&gradient.value) {
                let ratio = factor.value / gradient.value;
                let guard =
                    Criterion::new("viscous over pressure force", ratio, [0.997, 1.003], guard);
                if criteria[0].passes() && !guard.passes() {
                    words += &format!(
                        ", {ratio:.4} times the factor of the pressure force: a guard η² is too large"
                    );
                }
                criteria.push(guard);
            }
            Ok(Finding::new(words, criteria).with(factor))
        }),
        finds: &["viscosity", "eta"],
    }
}
