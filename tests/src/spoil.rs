//! Solvers with one thing spoiled, for testing what the gates are worth.
//!
//! A [`Fault`] is a set of factors, all neutral by default. [`spoil`] makes of a healthy scene one with
//! that fault: the same particles and numbers, its types wrapped. With the neutral fault the wrapped
//! scene has the bits of the healthy one, which is checked.

use maths::theory::{Stepping, time_step};
use nalgebra::Vector2;
use solver::{
    BodyForce, Compose, Continuity, DensityDiffusion, Engine, EquationOfState, Evolved,
    Fault as Lost, Ghosts, Integrator, InterfaceWall, Kernel, Leapfrog, Numbers, Open, Physics,
    PredictorCorrector, Pressure, Rate, Scene, Shifting, Tait, Term, Viscosity, lane::Lane,
    particles::Common, physics::State, terms::Pair, walls::Walls,
};

/// What is wrong, and by how much: factors, where not said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Of the viscous force.
    pub viscosity: f64,
    /// Of η² in the viscous force.
    pub eta2: f64,
    /// The exponent of the Tait equation.
    pub gamma: i32,
    /// Of the sound speed.
    pub sound: f64,
    /// Of pᵢ/ρᵢ² and pⱼ/ρⱼ².
    pub pressures: [f64; 2],
    /// Of the continuity equation.
    pub continuity: f64,
    /// Of the body force.
    pub force: f64,
    /// Of the density diffusion.
    pub diffusion: f64,
    /// Of the shifting.
    pub shifting: f64,
    /// Of the radius of the support, beyond which nothing is summed.
    pub support: f64,
    /// Of the smoothing length of the whole scene.
    pub h: f64,
    /// Of every mass.
    pub mass: f64,
    /// Of the velocity U of ghost walls, which counts twice.
    pub wall_velocity: f64,
    /// Of the curvature of the velocity at ghost walls.
    pub curvature: f64,
    /// How far the mirrors stand outside of the plates \[h\], the lower and the upper one.
    pub mirrors: [f64; 2],
    /// Of the velocity of interface and wall particles.
    pub wall_particles: f64,
    /// Of the continuity equation of wall particles.
    pub wall_rows: f64,
    /// Share of the skin that a particle may move before lists are rebuilt; not a factor.
    pub skin_share: f64,
    /// The integrator takes its other form, see [`Spoilable::Spoiled`] of integrators.
    pub integrator: bool,
}

impl Fault {
    /// None.
    pub const NONE: Self = Self {
        viscosity: 1.0,
        eta2: 1.0,
        gamma: 7,
        sound: 1.0,
        pressures: [1.0; 2],
        continuity: 1.0,
        force: 1.0,
        diffusion: 1.0,
        shifting: 1.0,
        support: 1.0,
        h: 1.0,
        mass: 1.0,
        wall_velocity: 1.0,
        curvature: 1.0,
        mirrors: [0.0; 2],
        wall_particles: 1.0,
        wall_rows: 1.0,
        skin_share: 0.5,
        integrator: false,
    };
}

/// A term that is wrong by a factor, and blind beyond a radius.
#[derive(Clone, Debug)]
pub struct Spoiled<T> {
    term: T,
    factor: f64,
    /// (the radius of sight)² \[m²\].
    sight2: f64,
}

impl<X: Numbers, T: Term<X>> Term<X> for Spoiled<T> {
    type Derived = T::Derived;
    type Sum = T::Sum;

    fn prepare(&mut self, max_speed: f64) {
        self.term.prepare(max_speed);
    }

    #[inline(always)]
    fn derived(&self, own: &Common<f64>, extra: &X) -> Self::Derived {
        self.term.derived(own, extra)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(
        &self,
        pair: &Pair<V, K>,
        own: <Self::Derived as Numbers>::In<V>,
        other: <Self::Derived as Numbers>::In<V>,
        sum: &mut <Self::Sum as Numbers>::In<V>,
    ) {
        let &Pair { r, r2, v, f, own: common, other: others, kernel } = pair;
        // 1 up to there and 0 beyond, where the quotient is 1 exactly.
        let beyond = (r2 - V::all(self.sight2)).positive();
        let f = f * (V::all(1.0) - beyond / (beyond + V::all(f64::MIN_POSITIVE)));
        let seen = Pair { r, r2, v, f, own: common, other: others, kernel };
        self.term.pair(&seen, own, other, sum);
    }

    #[inline(always)]
    fn finish(
        &self,
        own: &Common<f64>,
        derived: Self::Derived,
        sum: Self::Sum,
        rate: &mut Rate<X>,
    ) {
        let mut part = Rate::default();
        self.term.finish(own, derived, sum, &mut part);
        rate.position += part.position * self.factor;
        rate.velocity += part.velocity * self.factor;
        rate.density += part.density * self.factor;
    }
}

/// The pressure term with a weight for either side of a pair.
#[derive(Clone, Debug)]
pub struct Sided {
    eos: Tait,
    weights: [f64; 2],
}

impl<X> Term<X> for Sided {
    type Derived = f64;
    type Sum = Vector2<f64>;

    #[inline(always)]
    fn derived(&self, own: &Common<f64>, _: &X) -> f64 {
        self.eos.pressure(own.density) / (own.density * own.density)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, own: V, other: V, sum: &mut Vector2<V>) {
        let (i, j) = (V::all(self.weights[0]), V::all(self.weights[1]));
        *sum += pair.r * (pair.other.mass * pair.f * (own * i + other * j));
    }

    #[inline(always)]
    fn finish(&self, _: &Common<f64>, _: Self::Derived, sum: Self::Sum, rate: &mut Rate<X>) {
        rate.velocity += sum;
    }
}

/// Wall particles of an [`InterfaceWall`] whose density follows something else.
#[derive(Clone, Debug)]
pub struct SpoiledRows(Spoiled<Continuity>);

impl Walls<()> for SpoiledRows {
    type Terms = Spoiled<Continuity>;
    fn terms(&self) -> Self::Terms {
        self.0.clone()
    }
}

/// What has a spoiled form.
pub trait Spoilable {
    /// That form's type.
    type Spoiled;
    /// That form; all that is beyond `sight` \[m\] is not seen.
    fn spoiled(self, fault: &Fault, sight: f64) -> Self::Spoiled;
}

fn scaled<T>(term: T, factor: f64, sight: f64) -> Spoiled<T> {
    Spoiled { term, factor, sight2: sight * sight }
}

impl Spoilable for () {
    type Spoiled = ();
    fn spoiled(self, _: &Fault, _: f64) {}
}

macro_rules! spoilable {
    ($($term:ty: $factor:ident),+) => {$(
        impl Spoilable for $term {
            type Spoiled = Spoiled<$term>;
            fn spoiled(self, fault: &Fault, sight: f64) -> Self::Spoiled {
                scaled(self, fault.$factor, sight)
            }
        }
    )+};
}

spoilable!(Continuity: continuity, BodyForce: force, DensityDiffusion: diffusion, Shifting: shifting);

impl Spoilable for Viscosity {
    type Spoiled = Spoiled<Viscosity>;
    fn spoiled(self, fault: &Fault, sight: f64) -> Self::Spoiled {
        scaled(Viscosity { eta2: self.eta2 * fault.eta2, ..self }, fault.viscosity, sight)
    }
}

impl Spoilable for Pressure<Tait> {
    type Spoiled = Spoiled<Sided>;
    fn spoiled(self, fault: &Fault, sight: f64) -> Self::Spoiled {
        let sound_speed = self.eos.sound_speed * fault.sound;
        let eos = Tait { gamma: fault.gamma, sound_speed, ..self.eos };
        scaled(Sided { eos, weights: fault.pressures }, 1.0, sight)
    }
}

macro_rules! tuple_of_spoilables {
    ($($member:ident $index:tt),+) => {
        impl<$($member: Spoilable),+> Spoilable for ($($member,)+) {
            type Spoiled = ($($member::Spoiled,)+);
            fn spoiled(self, fault: &Fault, sight: f64) -> Self::Spoiled {
                ($(self.$index.spoiled(fault, sight),)+)
            }
        }
    };
}

tuple_of_spoilables!(A 0, B 1);
tuple_of_spoilables!(A 0, B 1, C 2);

impl Spoilable for Open {
    type Spoiled = Open;
    fn spoiled(self, _: &Fault, _: f64) -> Open {
        self
    }
}

impl Spoilable for Ghosts {
    type Spoiled = Ghosts;
    fn spoiled(mut self, fault: &Fault, _: f64) -> Ghosts {
        for (wall, outside) in self.walls.iter_mut().zip(fault.mirrors) {
            wall.velocity *= fault.wall_velocity;
            wall.curvature *= fault.curvature;
            wall.point -= wall.normal * outside;
        }
        self
    }
}

impl Spoilable for InterfaceWall {
    type Spoiled = SpoiledRows;
    fn spoiled(self, fault: &Fault, sight: f64) -> SpoiledRows {
        SpoiledRows(scaled(Continuity, fault.continuity * fault.wall_rows, sight))
    }
}

/// The scheme with everything in it that can be spoiled.
type SpoiledScheme<K, F, D, W, J> =
    Compose<K, <F as Spoilable>::Spoiled, <D as Spoilable>::Spoiled, <W as Spoilable>::Spoiled, J>;

/// A healthy scene with a fault. The integrator is left as it is.
pub fn spoil<K, F, D, W, I, J>(
    scene: Scene<Compose<K, F, D, W, I>>,
    fault: &Fault,
) -> Scene<SpoiledScheme<K, F, D, W, J>>
where
    K: Kernel,
    F: Term<()> + Spoilable<Spoiled: Term<()>>,
    D: Term<()> + Spoilable<Spoiled: Term<()>>,
    W: Walls<()> + Spoilable<Spoiled: Walls<()>>,
    I: Integrator<()>,
    J: Integrator<()>,
{
    let mut particles = scene.particles;
    for p in &mut particles {
        p.mass *= fault.mass;
        if p.role != solver::Role::Fluid {
            p.velocity *= fault.wall_particles;
        }
    }
    // Whole, the support is left to the kernel, whose own end is not to be rounded.
    let is_whole = fault.support == 1.0;
    let sight = if is_whole { f64::MAX.sqrt() } else { fault.support * K::SUPPORT * scene.h };
    let fault = &Fault { mirrors: fault.mirrors.map(|x| x * scene.h), ..*fault };
    let forces = scene.forces.spoiled(fault, sight);
    let drift = scene.drift.spoiled(fault, sight);
    let walls = scene.walls.spoiled(fault, sight);
    Scene {
        h: scene.h * fault.h,
        domain: scene.domain,
        particles,
        forces,
        drift,
        walls,
        skin: scene.skin,
        skin_share: fault.skin_share,
        limits: scene.limits,
        parallel_from: scene.parallel_from,
    }
}

/// An integrator with a wrong form of it.
pub trait Mistaken: Stepping {
    /// That form.
    type As: Stepping;
}

impl Mistaken for Leapfrog {
    type As = OldVelocities;
}

impl Mistaken for PredictorCorrector {
    type As = LatePredictor;
}

/// The leapfrog, its drift summed at the old velocities.
#[derive(Debug, Default)]
pub struct OldVelocities {
    lag: f64,
}

impl Integrator<()> for OldVelocities {
    const NAME: &'static str = "leapfrog, drift at old velocities";
    const ORDER: [u32; 2] = [1, 1];

    fn step<P: Physics<Extra = ()>>(
        &mut self,
        engine: &mut Engine<P>,
        state: &mut State<P>,
        dt: f64,
    ) -> Result<(), Lost> {
        engine.begin(state)?;
        let mut drifted = state.to_vec();
        engine.sweep_drift(&mut drifted, |_, evolved, rate| evolved.drift(dt, rate));
        let kick = self.lag + 0.5 * dt;
        engine.sweep_forces(state, |_, evolved, rate| evolved.kick(kick, rate));
        for (evolved, drifted) in state.iter_mut().zip(drifted) {
            *evolved = Evolved { velocity: evolved.velocity, ..drifted };
        }
        self.lag = 0.5 * dt;
        Ok(())
    }

    fn synchronise<P: Physics<Extra = ()>>(
        &mut self,
        engine: &mut Engine<P>,
        state: &mut State<P>,
    ) -> Result<(), Lost> {
        let kick = std::mem::take(&mut self.lag);
        if kick != 0.0 {
            engine.begin(state)?;
            engine.sweep_forces(state, |_, evolved, rate| evolved.kick(kick, rate));
        }
        Ok(())
    }
}

impl Stepping for OldVelocities {
    const THEORY: time_step::Integrator = time_step::Integrator::Leapfrog;
}

/// The predictor-corrector, its predictor a whole step long for half a one.
#[derive(Debug, Default)]
pub struct LatePredictor;

impl Integrator<()> for LatePredictor {
    const NAME: &'static str = "predictor-corrector, whole predictor";
    const ORDER: [u32; 2] = [1, 1];

    fn step<P: Physics<Extra = ()>>(
        &mut self,
        engine: &mut Engine<P>,
        state: &mut State<P>,
        dt: f64,
    ) -> Result<(), Lost> {
        engine.begin(state)?;
        let mut end = state.to_vec();
        engine.sweep_all(&mut end, |_, late, rate| *late = late.advanced(dt, rate));
        engine.refresh(&end)?;
        engine.sweep_all(state, |_, evolved, rate| *evolved = evolved.advanced(dt, rate));
        Ok(())
    }
}

impl Stepping for LatePredictor {
    const THEORY: time_step::Integrator = time_step::Integrator::PredictorCorrector;
}
