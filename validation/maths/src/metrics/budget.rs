//! The energy budget by term: the power of each term of a scene, at one time and integrated over a run.
//!
//! With the derivative ∂E/∂y of the energy of a particle, the power of a term is Σ ∂E/∂y · ẏ over the rates ẏ
//! by this term alone ([`Simulation::rates`]). Terms that exchange energy with each other share an item:
//! pressure (5) and continuity (3) cancel in every pair of particles that both include, so their sum is the
//! work of the walls. A body force is part of the potential energy and has no item.
//!
//! Two pair sweeps are sufficient for water, one over all terms and one over pressure and continuity, because
//! the power of a sweep has three parts: by dv/dt, by dρ/dt and by dx/dt without v. Only XSPH contributes to
//! the last one. The differences between the sweeps are artificial viscosity in dv/dt and density diffusion
//! in dρ/dt. An artificial stress and an acoustic damper, which also act in dv/dt, need a sweep each.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_solver::{
    AcousticDamper, ArtificialViscosity, BodyForce, ConsistentContinuity, Continuity,
    DensityDiffusion, EquationOfState, FluidPairs, Numbers, Pressure, Rate, Scheme, Simulation,
    State, Stepper, Term, Xsph,
    terms::{Rest, Tensile},
};

/// ∂E/∂y · ẏ of a particle with this mass \[kg/m\], state and rate \[W/m\]; dx/dt is without v.
pub type Slope<'a, X> = &'a dyn Fn(f64, &State<X>, &Rate<X>) -> f64;

/// The items of the energy budget of water: powers of terms \[W/m\], or their works \[J/m\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyItems {
    /// Artificial viscosity (16), (17).
    pub viscosity: f64,
    /// Artificial stress (18), (19).
    pub stress: f64,
    /// Acoustic damper.
    pub damper: f64,
    /// Density diffusion.
    pub diffusion: f64,
    /// XSPH (22).
    pub xsph: f64,
    /// Pressure against walls whose particles are outside of the energy budget.
    pub walls: f64,
}

impl EnergyItems {
    /// Combines each item with the same item of another budget.
    pub fn with(self, other: Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            viscosity: combine(self.viscosity, other.viscosity),
            stress: combine(self.stress, other.stress),
            damper: combine(self.damper, other.damper),
            diffusion: combine(self.diffusion, other.diffusion),
            xsph: combine(self.xsph, other.xsph),
            walls: combine(self.walls, other.walls),
        }
    }

    /// The sum of all items.
    pub fn sum(&self) -> f64 {
        let Self { viscosity, stress, damper, diffusion, xsph, walls } = self;
        viscosity + stress + damper + diffusion + xsph + walls
    }
}

/// Powers by the rates of one sweep.
struct PowerSums {
    /// Power of dv/dt \[W/m\].
    velocity: f64,
    /// Power of dρ/dt and of the rates of extra fields \[W/m\].
    density: f64,
    /// Power of dx/dt \[W/m\].
    position: f64,
    /// Σ m dv/dt \[N/m\].
    force: Vector2<f64>,
}

/// Masses and states of particles.
type Masses<'a, X> = dyn Iterator<Item = (f64, &'a State<X>)> + 'a;

// Compiled once for all schemes.

fn power<X>(particles: &mut Masses<X>, rates: &[Rate<X>], slope: Slope<X>) -> f64 {
    particles
        .zip(rates)
        .fold(0.0, |sum, ((mass, particle), rate)| sum + slope(mass, particle, rate))
}

fn sums<X: Numbers>(particles: &mut Masses<X>, rates: &[Rate<X>], slope: Slope<X>) -> PowerSums {
    let mut sums =
        PowerSums { velocity: 0.0, density: 0.0, position: 0.0, force: Vector2::zeros() };
    for ((mass, particle), rate) in particles.zip(rates) {
        let (none, no_extra) = (Vector2::zeros(), X::default());
        let power = |part: Rate<X>| slope(mass, particle, &part);
        sums.velocity += power(Rate { density: 0.0, position: none, extra: no_extra, ..*rate });
        sums.density += power(Rate { velocity: none, position: none, ..*rate });
        sums.position += power(Rate { velocity: none, density: 0.0, extra: no_extra, ..*rate });
        sums.force += rate.velocity * mass;
    }
    sums
}

/// Forces of water: pressure, with an artificial stress or without (`R = ()`), artificial viscosity if there
/// is any, and a body force.
pub trait WaterForces<X>: Term<X> {
    /// The terms that are sums over pairs.
    fn pairs(&self) -> impl Term<X>;
    /// The pressure with its artificial stress.
    fn pressure(&self) -> Pressure<impl EquationOfState, impl Tensile<f64>>;
    /// The acoustic damper, if there is one.
    fn damper(&self) -> Option<AcousticDamper> {
        None
    }
}

/// Artificial viscosity, with an acoustic damper or without.
pub trait Viscous<X>: Term<X> {
    /// The damper, if there is one.
    fn damper(&self) -> Option<AcousticDamper> {
        None
    }
}

impl<X, E: EquationOfState, const ALL: bool> Viscous<X> for ArtificialViscosity<E, ALL> {}
impl<X, T: Viscous<X>> Viscous<X> for FluidPairs<T> where Self: Term<X> {}
impl<X, T: Viscous<X>> Viscous<X> for (T, AcousticDamper) {
    fn damper(&self) -> Option<AcousticDamper> {
        Some(self.1)
    }
}

impl<X, E: EquationOfState, R: Tensile<f64>> WaterForces<X> for (Pressure<E, R>, BodyForce) {
    fn pairs(&self) -> impl Term<X> {
        self.0
    }
    fn pressure(&self) -> Pressure<impl EquationOfState, impl Tensile<f64>> {
        self.0
    }
}

impl<X, E: EquationOfState, R: Tensile<f64>, V: Viscous<X>> WaterForces<X>
    for (Pressure<E, R>, V, BodyForce)
{
    fn pairs(&self) -> impl Term<X> {
        (self.0, self.1.clone())
    }
    fn pressure(&self) -> Pressure<impl EquationOfState, impl Tensile<f64>> {
        self.0
    }
    fn damper(&self) -> Option<AcousticDamper> {
        self.1.damper()
    }
}

/// Rates of density and position of water: continuity, and density diffusion and XSPH if there are any.
pub trait WaterDrift<X>: Term<X> {}

impl<X> WaterDrift<X> for Continuity {}
impl<X> WaterDrift<X> for (Continuity, Xsph) {}
impl<X, R: Rest> WaterDrift<X> for (Continuity, DensityDiffusion<R>) {}
/// The power of this continuity minus that of (3) counts as density diffusion.
impl<X, R: Rest> WaterDrift<X> for (ConsistentContinuity, DensityDiffusion<R>) {}
impl<X, R: Rest> WaterDrift<X> for (Continuity, Xsph, DensityDiffusion<R>) {}

/// A simulation of water with an energy budget by term.
pub trait Metered<X: Numbers>: Stepper<X> {
    /// The powers of its forces, of its drift and of the terms of its walls, after [`Stepper::advance`]
    /// reached a time; and the force of all pairs on the fluid \[N/m\].
    fn powers(&mut self, slope: Slope<X>) -> (EnergyItems, Vector2<f64>);
}

impl<S: Scheme> Metered<S::Extra> for Simulation<S>
where
    S::Forces: WaterForces<S::Extra>,
    S::Drift: WaterDrift<S::Extra>,
{
    fn powers(&mut self, slope: Slope<S::Extra>) -> (EnergyItems, Vector2<f64>) {
        let (forces, drift) = self.terms_mut().clone();
        let all = self.rates(&(forces.pairs(), drift));
        let all = sums(&mut self.data().fluid(), &all, slope);
        let pressure = forces.pressure();
        let bare = self.rates(&(Pressure::new(pressure.eos), Continuity));
        let bare = sums(&mut self.data().fluid(), &bare, slope);
        let walls = power(&mut self.data().walls(), &self.wall_rates(), slope);
        let stress = match size_of_val(&pressure.tensile) {
            0 => 0.0,
            _ => power(&mut self.data().fluid(), &self.rates(&pressure), slope) - bare.velocity,
        };
        let damper = forces
            .damper()
            .map_or(0.0, |damper| power(&mut self.data().fluid(), &self.rates(&damper), slope));
        let powers = EnergyItems {
            viscosity: all.velocity - bare.velocity - stress - damper,
            stress,
            damper,
            diffusion: all.density - bare.density,
            xsph: all.position,
            walls: bare.velocity + bare.density + walls,
        };
        (powers, all.force)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use touchstone_solver::{
        ArtificialStress, Compose, CubicSpline, Domain, InterfaceWall, Particle,
        PredictorCorrector, Role, Scene, Smoothing, Tait,
    };

    use super::*;
    use crate::metrics::energy::{Water, water_slope};
    use touchstone_base::random::Random;

    type Forces =
        (Pressure<Tait, ArtificialStress>, (ArtificialViscosity<Tait>, AcousticDamper), BodyForce);
    type Drift = (Continuity, Xsph, DensityDiffusion);
    type Method = Compose<CubicSpline, Forces, Drift, InterfaceWall, PredictorCorrector>;

    const DX: f64 = 0.1;
    const WATER: Water = Water {
        eos: Tait { density: 2.0, sound_speed: 9.0, gamma: 7, background: 0.0 },
        gravity: Vector2::new(0.7, -3.0),
    };

    /// Water in disorder over wall particles, some of it under tension.
    fn scene() -> Scene<Method> {
        let (mut random, eos, h) = (Random::new(7), WATER.eos, 1.3 * DX);
        let mut number = move || random.uniform() - 0.5;
        let mut particles: Vec<Particle> = touchstone_solver::lattice(Vector2::zeros(), DX, 12, 9)
            .map(|x| {
                let x = x + Vector2::new(number(), number()) * (0.3 * DX);
                let v = Vector2::new(number(), number());
                Particle::fluid(x, v, 2.0 * (1.0 + 0.02 * number()), DX * DX)
            })
            .collect();
        particles.extend(touchstone_solver::lattice(Vector2::new(-0.3, -3.0 * DX), DX, 18, 3).map(
            |x| {
                let wall =
                    Particle::fluid(x, Vector2::zeros(), 2.0 * (1.0 + 0.02 * number()), DX * DX);
                wall.with_role(Role::Wall)
            },
        ));
        let stress = ArtificialStress::new(0.3, 4, Smoothing::<CubicSpline>::new(h).w(DX * DX));
        let forces = (
            Pressure { eos, tensile: stress },
            (ArtificialViscosity::new(0.4, 0.8, h, eos), AcousticDamper { bulk: 0.7 }),
            BodyForce(WATER.gravity),
        );
        let diffusion = DensityDiffusion::new(0.1 * h * eos.sound_speed);
        let drift = (Continuity, Xsph { epsilon: 0.4 }, diffusion);
        Scene::new(h, Domain::open(), particles, forces, drift, InterfaceWall)
    }

    /// The power of these terms together \[W/m\].
    fn power_of(simulation: &Simulation<Method>, terms: &impl Term<()>) -> f64 {
        power(&mut simulation.data().fluid(), &simulation.rates(terms), &water_slope(&WATER))
    }

    /// Total energy a time dt after the start \[J/m\].
    fn energy(dt: f64) -> f64 {
        let mut simulation = scene().build().expect("a scene");
        simulation.advance(dt, 1.0, &mut ());
        WATER.energy(&simulation).sum()
    }

    #[test]
    fn pressure_and_continuity_only_exchange_energy() {
        let scene = scene();
        let (forces, drift) = (scene.forces, scene.drift);
        let mut simulation = scene.build().expect("a scene");
        simulation.advance(0.0, 1.0, &mut ());
        let slope = water_slope(&WATER);
        let of_walls = power(&mut simulation.data().walls(), &simulation.wall_rates(), &slope);
        let parts = [power_of(&simulation, &forces.0), power_of(&simulation, &drift.0), of_walls];
        let stress = parts[0] - power_of(&simulation, &Pressure::new(forces.0.eos));
        let sum = parts.iter().sum::<f64>() - stress;
        let scale: f64 = parts.iter().map(|p| p.abs()).sum();
        assert!(parts.iter().all(|p| p.abs() > 1e-3 * scale), "{parts:?} show something");
        assert!(sum.abs() < 1e-13 * scale, "{sum:e} of {scale:e}");
    }

    /// Five sweeps of a term each gave the powers before two sweeps of several terms did.
    #[test]
    fn the_powers_are_those_of_each_term_by_itself() {
        let scene = scene();
        let (forces, drift) = (scene.forces, scene.drift);
        let mut simulation = scene.build().expect("a scene");
        simulation.advance(0.0, 1.0, &mut ());
        let slope = water_slope(&WATER);
        let (powers, force) = simulation.powers(&slope);
        let bare = power_of(&simulation, &Pressure::new(forces.0.eos));
        let of_walls = power(&mut simulation.data().walls(), &simulation.wall_rates(), &slope);
        let EnergyItems { viscosity, stress, damper, diffusion, xsph, walls } = powers;
        let alone = [
            (viscosity, power_of(&simulation, &forces.1.0)),
            (stress, power_of(&simulation, &forces.0) - bare),
            (damper, power_of(&simulation, &forces.1.1)),
            (diffusion, power_of(&simulation, &drift.2)),
            (xsph, power_of(&simulation, &drift.1)),
            (walls, bare + power_of(&simulation, &drift.0) + of_walls),
        ];
        for (k, (found, power)) in alone.into_iter().enumerate() {
            let error = found - power;
            assert!(error.abs() < 1e-13 * bare.abs(), "{k}: {error:e} of {power:e}");
            assert!(k == 5 || power.abs() > 1e-6 * bare.abs(), "{k} shows something");
        }
        let total = simulation.total_rates();
        let each = simulation.data().fluid().zip(&total);
        let mass: f64 = simulation.data().fluid().map(|(mass, _)| mass).sum();
        let all = each.fold(Vector2::zeros(), |sum, ((mass, _), rate)| sum + rate.velocity * mass);
        assert!((force + WATER.gravity * mass - all).norm() < 1e-12 * all.norm());
    }

    /// dE/dt of the discrete equations by differences of the energy, against the powers.
    #[test]
    fn the_powers_are_the_slope_of_the_energy_in_time() {
        let scene = scene();
        let mut simulation = scene.build().expect("a scene");
        simulation.advance(0.0, 1.0, &mut ());
        let (powers, _) = simulation.powers(&water_slope(&WATER));
        assert!(powers.viscosity < 0.0 && powers.damper < 0.0, "viscosity and damper heat");
        let total = powers.sum();
        let (dt, start) = (1e-6, energy(0.0));
        let (whole, half) = (energy(dt) - start, energy(0.5 * dt) - start);
        let slope = (4.0 * half - whole) / dt;
        // Differences over 1 µs leave some 1e-8 of truncation, and of round-off in E.
        assert!((slope / total - 1.0).abs() < 1e-5, "{slope:e} {total:e} {powers:?}");
    }
}
