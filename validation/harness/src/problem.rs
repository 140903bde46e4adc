//! A run in verbs. A case states the scene of a run, the measurements at its times, and its metrics; from
//! these the functions here simulate a run, estimate its cost, export it, transform it to another observer's
//! frame, and measure particles of another code.

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value;
use std::ops::ControlFlow;
use touchstone_base::{
    number,
    record::{Profile, Record, Status},
    spec::{Keep, Measure, RunSpec},
};
use touchstone_solver::{Numbers, Outcome, Particle, Role, Stepper};

use crate::{
    checkpoint::as_json,
    context::Context,
    error::RunError,
    frames,
    medium::{Knob, Medium},
    method::{Method, Parts, see},
    outline::Outline,
    playback::Playback,
    relation::{Relation, TIME, View},
    rules::Rules,
    runner::{Drive, check_size},
    size::Size,
};

/// Name of the kernel in the numerics of a record.
pub const KERNEL: &str = "kernel";
/// Name of the integrator.
pub const INTEGRATOR: &str = "integrator";
/// Name of the walls.
pub const WALLS: &str = "walls";

/// Optional output of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked {
    /// Every metric, at any cost.
    pub all: bool,
    /// Particles for pictures.
    pub particles: bool,
}

impl Asked {
    /// Optional output that the spec of a run asks for.
    pub fn of(spec: &RunSpec) -> Self {
        let Keep { particles, .. } = spec.keep;
        Self { all: spec.measure == Measure::All, particles }
    }
}

/// Facts of a run that are known before its particles are made.
#[derive(Debug)]
pub struct Brief {
    /// The parameters of the material.
    pub medium: Medium,
    /// Time step, its limits, sound speed, end.
    pub rules: Rules,
    /// Has the time step a limit in theory? If not, no step is refused.
    pub is_limited: bool,
    /// The integrator of the limit, if it differs from the method's.
    pub limit_of: Option<&'static str>,
    /// Why only a run that may be unstable is made, if so.
    pub unstable: Option<RunError>,
    /// Numbers that its record states, by name.
    pub numbers: Vec<(&'static str, Value)>,
    /// About how many particles there are.
    pub particles: f64,
    /// The settings on which the number of particles and of time steps depends.
    pub decisive: &'static str,
    /// Steps of which the record keeps something.
    pub samples: f64,
    /// Steps to each of the times at least.
    pub least_steps: usize,
    /// Is it run by one thread, however many there are?
    pub is_serial: bool,
}

impl Brief {
    /// A run with these rules and about this number of particles, whose cost depends on the settings
    /// `decisive`.
    pub fn new(medium: Medium, rules: Rules, particles: f64, decisive: &'static str) -> Self {
        Self {
            medium,
            rules,
            is_limited: true,
            limit_of: None,
            unstable: None,
            numbers: Vec::new(),
            particles,
            decisive,
            samples: 0.0,
            least_steps: 1,
            is_serial: false,
        }
    }

    /// Adds numbers that its record states, by name.
    #[must_use]
    pub fn numbers(mut self, numbers: &[(&'static str, f64)]) -> Self {
        self.numbers.extend(numbers.iter().map(|(name, value)| (*name, number::json(*value))));
        self
    }
}

/// A run of a case: scene, measurements, and metrics.
pub trait Problem: Sized {
    /// Fields of a particle in addition to position, velocity and density.
    type Extra: Numbers;
    /// The simulation as input of the case.
    type Simulation: Stepper<Self::Extra> + ?Sized;
    /// All that accumulates over a run.
    type Watch: Serialize + DeserializeOwned;
    /// Does [`Problem::watch`] read the particles of the scene?
    const READS_START: bool = false;

    /// The method.
    fn method(&self) -> &Method<Self::Extra, Self::Simulation>;

    /// Facts that are known before the particles are made.
    fn brief(&self) -> Brief;

    /// Why no file can state the scene for other codes, if so.
    fn not_exported(&self) -> Option<&'static str> {
        None
    }

    /// The times of interest, ascending, the end last \[s\].
    fn times(&self) -> Vec<f64>;

    /// Particles, walls and medium.
    ///
    /// # Errors
    /// If the settings make no scene.
    fn scene(&self) -> Result<Parts<Self::Extra>, RunError>;

    /// Changes a new simulation by data that no scene states, in the frame of an observer.
    fn prepare(&self, _simulation: &mut Self::Simulation, _view: &View) {}

    /// The watch before the first step. `start` are the particles of the scene before any deliberate error,
    /// if [`Problem::READS_START`].
    fn watch(&self, start: &[Particle<Self::Extra>], simulation: &Self::Simulation) -> Self::Watch;

    /// Adds the functions that measure on the way.
    fn calls(&self, calls: Calls<Self>, _asked: Asked) -> Calls<Self> {
        calls
    }

    /// Puts metrics and profiles; the simulation is at its end, the record states how it ended.
    fn measure(&self, watch: Self::Watch, end: &Self::Simulation, record: &mut Record);
}

/// State of an observed run: everything that changes during it.
#[derive(Serialize, Deserialize)]
struct Watched<W> {
    watch: W,
    #[serde(with = "as_json")]
    record: Record,
}

/// Called after every step.
type AfterStep<P> =
    fn(&P, &mut <P as Problem>::Watch, &dyn Stepper<<P as Problem>::Extra>) -> ControlFlow<()>;
/// Called at the k-th of the times of interest.
type At<P> =
    fn(&P, &mut <P as Problem>::Watch, &mut <P as Problem>::Simulation, usize, &mut Record);
/// Called when a run goes on from a checkpoint.
type Resumed<P> = fn(&P, &<P as Problem>::Watch, &mut <P as Problem>::Simulation);

/// The functions of a problem that are called on the way, with the names that a profile of the run shows.
pub struct Calls<P: Problem> {
    after_step: Vec<(&'static str, AfterStep<P>)>,
    at: Vec<(&'static str, Reads, At<P>)>,
    control: Option<(&'static str, At<P>, Resumed<P>)>,
}

/// Data that a function at a time of interest reads.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reads {
    All,
    Positions,
}

impl<P: Problem> Default for Calls<P> {
    fn default() -> Self {
        Self { after_step: Vec::new(), at: Vec::new(), control: None }
    }
}

impl<P: Problem> Calls<P> {
    /// Calls a function after every step, and at every frame of another code.
    #[must_use]
    pub fn after_step(mut self, name: &'static str, call: AfterStep<P>) -> Self {
        self.after_step.push((name, call));
        self
    }

    /// Calls a function at each of the times of interest, with its number.
    #[must_use]
    pub fn at(mut self, name: &'static str, call: At<P>) -> Self {
        self.at.push((name, Reads::All, call));
        self
    }

    /// Calls a function that reads positions and densities, or for which velocities and extra fields of a
    /// leapfrog may be half a step old, which costs no pair sweep.
    #[must_use]
    pub fn at_positions(mut self, name: &'static str, call: At<P>) -> Self {
        self.at.push((name, Reads::Positions, call));
        self
    }

    /// Adds these functions only on a condition.
    #[must_use]
    pub fn when(self, is: bool, add: impl FnOnce(Self) -> Self) -> Self {
        if is { add(self) } else { self }
    }

    /// Calls a function at each of the times of interest that changes a simulation of ours, after all that
    /// measure; of another code's frames it is not called. `resumed` makes the change again when a run goes
    /// on from a checkpoint, which does not hold it.
    #[must_use]
    pub fn control(mut self, name: &'static str, call: At<P>, resumed: Resumed<P>) -> Self {
        self.control = Some((name, call, resumed));
        self
    }
}

/// Steps after which observers are compared: early, before the motion amplifies round-off. Strong shifting in
/// vortices does by 1.8 a step from the twelfth on, and after 28 steps by more than any floor.
const COMPARED: [usize; 3] = [4, 8, 16];

/// How many steps of a run are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// All.
    All,
    /// The first steps, after which observers are compared.
    Early,
    /// None.
    None,
}

impl Steps {
    fn most(self) -> f64 {
        match self {
            Self::All => f64::INFINITY,
            Self::Early => COMPARED[COMPARED.len() - 1] as f64,
            Self::None => 0.0,
        }
    }
}

/// Called with the particles at a time \[s\].
pub type AtTime<'a> = &'a mut dyn FnMut(f64, Profile);

/// A run of a case without its types, with the operations of commands.
pub trait Posed {
    /// Facts that are known before its particles are made.
    fn brief(&self) -> Brief;
    /// The cost of these steps, for a run that is not refused.
    ///
    /// # Errors
    /// If it is refused, or takes more time or memory than a run may, unless that is allowed.
    fn size(&self, spec: &RunSpec, steps: Steps, allow_long: bool) -> Result<Size, RunError>;
    /// Simulates it.
    ///
    /// # Errors
    /// If it is refused, or the folder of its frames cannot be made.
    fn simulate(&self, context: &Context) -> Result<Record, RunError>;
    /// Its scene, at its times, or at a few early times for a relation.
    ///
    /// # Errors
    /// If it is refused, has no scene that a file can state, or the relation is no symmetry of it.
    fn outline(
        &self,
        spec: &RunSpec,
        relation: Option<Relation>,
        allow_long: bool,
    ) -> Result<Outline, RunError>;
    /// Its scene in the frame of an observer, and the particles at a few early times before a divergence.
    ///
    /// # Errors
    /// As [`Posed::outline`].
    fn seen_by(
        &self,
        relation: Relation,
        context: &Context,
        at_time: AtTime,
    ) -> Result<Outline, RunError>;
    /// Measures particles of another code.
    ///
    /// # Errors
    /// If the run is refused, or a frame does not fit its scene.
    fn measure_frames(&self, spec: &RunSpec, playback: &Playback) -> Result<Record, RunError>;
}

impl<P: Problem> Posed for P {
    fn brief(&self) -> Brief {
        Problem::brief(self)
    }

    fn size(&self, spec: &RunSpec, steps: Steps, allow_long: bool) -> Result<Size, RunError> {
        self.checked(spec, steps, allow_long).map(|(_, size)| size)
    }

    fn simulate(&self, context: &Context) -> Result<Record, RunError> {
        self.driven(&context.spec, Steps::All, context, None)
    }

    fn outline(
        &self,
        spec: &RunSpec,
        relation: Option<Relation>,
        allow_long: bool,
    ) -> Result<Outline, RunError> {
        Ok(self.stated(spec, relation, Steps::None, allow_long)?.1)
    }

    fn seen_by(
        &self,
        relation: Relation,
        context: &Context,
        at_time: AtTime,
    ) -> Result<Outline, RunError> {
        let (mut simulation, outline) =
            self.stated(&context.spec, Some(relation), Steps::Early, context.allow_long)?;
        let (simulation, pressure) = (simulation.stepper(), pressure(&Problem::brief(self).medium));
        for until in outline.times.iter().filter(|_| !context.is_interrupted()) {
            if simulation.advance(*until, outline.dt, &mut ()) != Outcome::Reached {
                break; // it diverged
            }
            at_time(*until, frames::columns(&simulation.particles(), &pressure));
        }
        Ok(outline)
    }

    fn measure_frames(&self, spec: &RunSpec, playback: &Playback) -> Result<Record, RunError> {
        let context = Context { spec: spec.clone(), allow_long: true, ..Context::default() };
        self.driven(spec, Steps::None, &context, Some(playback))
    }
}

fn pressure(medium: &Medium) -> impl Fn(f64) -> f64 + use<> {
    let eos = medium.eos;
    move |density| touchstone_solver::EquationOfState::pressure(&eos, density)
}

/// The parts of the verbs.
trait Parted: Problem {
    /// Refuses a run before its particles are made; its size.
    fn checked(
        &self,
        spec: &RunSpec,
        steps: Steps,
        allow_long: bool,
    ) -> Result<(Brief, Size), RunError> {
        let mut brief = Problem::brief(self);
        let (method, rules) = (&self.method().properties, brief.rules);
        if let Some(reason) = brief.unstable.take_if(|_| !spec.allow_unstable) {
            return Err(reason);
        }
        let (dt, limit) = (rules.dt(), rules.dt_limit());
        let integrator = brief.limit_of.unwrap_or(method.integrator);
        if brief.is_limited && dt > limit && !spec.allow_unstable {
            return Err(RunError::TimeStep { dt, limit, integrator });
        }
        let reach = method.support * brief.medium.h / brief.medium.dx;
        let size = Size::new([rules.end / dt, brief.particles], reach);
        let sweeps = if brief.is_limited { rules.sweeps() } else { size.sweeps };
        let size = Size { sweeps, samples: brief.samples, ..size };
        let size = check_size(size, steps.most(), brief.decisive, allow_long)?;
        Ok((brief, size))
    }

    /// The scene with the changes of a spec.
    fn parts(&self, spec: &RunSpec, threads: usize) -> Result<Parts<Self::Extra>, RunError> {
        let RunSpec { mutation, disorder, .. } = *spec;
        Ok(Parts { threads, mutation, disorder, ..self.scene()? })
    }

    /// The simulation of a scene in the frame of an observer.
    fn built(
        &self,
        parts: Parts<Self::Extra>,
        view: &View,
    ) -> Result<Box<Self::Simulation>, RunError> {
        let mut simulation = (self.method().build)(parts)?;
        self.prepare(&mut simulation, view);
        Ok(simulation)
    }

    /// Transforms the parts to the frame of an observer.
    fn view(
        &self,
        parts: &mut Parts<Self::Extra>,
        relation: Relation,
        steps: Steps,
    ) -> Result<View, RunError> {
        let refused = |reason| RunError::NoSymmetry { relation, reason };
        let view = see(parts, relation).map_err(refused)?;
        let shifts = self.method().properties.uses.contains(&Knob::Shift);
        let shifts = shifts && parts.medium.shift > 0.0;
        if relation == Relation::Boosted && steps == Steps::Early && shifts {
            return Err(refused("its shifting takes the largest speed of the scene"));
        }
        Ok(view)
    }

    /// The simulation in the frame of an observer, and its outline.
    fn stated(
        &self,
        spec: &RunSpec,
        relation: Option<Relation>,
        steps: Steps,
        allow_long: bool,
    ) -> Result<(Box<Self::Simulation>, Outline), RunError> {
        let (brief, _) = self.checked(spec, steps, allow_long)?;
        if let Some(reason) = self.not_exported() {
            return Err(RunError::NoScene(reason));
        }
        let mut parts = self.parts(spec, 1)?;
        let view = match relation {
            Some(relation) => self.view(&mut parts, relation, steps)?,
            None => View::default(),
        };
        let Parts { medium, domain, .. } = parts;
        let (mut mirrors, bodies) = (parts.mirrors.clone(), parts.bodies.clone());
        let simulation = self.built(parts, &view)?;
        let dt = brief.rules.dt() * if relation.is_some() { view.scale(TIME) } else { 1.0 };
        let times = match relation {
            Some(_) => COMPARED.map(|steps| steps as f64 * dt).to_vec(),
            None => self.times(),
        };
        let own = pressure(&brief.medium);
        let particles = simulation.particles();
        // Walls of particles need no planes.
        if particles.iter().any(|p| p.role != Role::Fluid) {
            mirrors.clear();
        }
        let particles = frames::columns(&particles, &|density| view.pressure_of(&own, density));
        let method = self.method().properties.clone();
        let outline =
            Outline { medium, domain, mirrors, bodies, particles, times, dt, view, method };
        Ok((simulation, outline))
    }

    /// A record with the numerics of the run.
    fn begun(&self, spec: &RunSpec, threads: usize, brief: &Brief) -> Record {
        let mut record = Record::of(spec, threads.max(1));
        let method = &self.method().properties;
        let words =
            [(KERNEL, method.kernel), (INTEGRATOR, method.integrator), (WALLS, method.walls)];
        let numbers = brief.numbers.iter().map(|(name, value)| (name.to_string(), value.clone()));
        record.numerics.extend(numbers);
        let words = words.map(|(name, word)| (name.to_string(), Value::from(word)));
        record.numerics.extend(words);
        record
    }

    /// Simulates a run, or shows it the frames of another code, and measures it.
    fn driven(
        &self,
        spec: &RunSpec,
        steps: Steps,
        context: &Context,
        playback: Option<&Playback>,
    ) -> Result<Record, RunError> {
        let (brief, size) = self.checked(spec, steps, context.allow_long)?;
        let threads = if brief.is_serial { 1 } else { context.threads };
        let mut parts = self.parts(spec, threads)?;
        if let Some(playback) = playback {
            parts.particles = playback.particles(parts.particles);
        }
        let start = if Self::READS_START { parts.particles.clone() } else { Vec::new() };
        let mut simulation = self.built(parts, &View::default())?;
        let record = self.begun(spec, threads, &brief);
        let (times, asked) = (self.times(), Asked::of(spec));
        let watch = self.watch(&start, &simulation);
        drop(start);
        let Calls { after_step, mut at, control } = self.calls(Calls::default(), asked);
        let mut seen = Watched { watch, record };
        let (dt, eos) = (brief.rules.dt(), brief.medium.eos);
        let mut drive = Drive::new(&mut *simulation, dt, &times, eos, &mut seen)
            .steps(brief.least_steps, size.sweeps);
        if let Some((name, call, resumed)) = control.filter(|_| playback.is_none()) {
            at.push((name, Reads::All, call));
            drive = drive.resumed(move |seen, s| resumed(self, &seen.watch, s));
        }
        for (name, call) in after_step {
            drive = drive.after_step(name, move |seen, s| call(self, &mut seen.watch, s));
        }
        for (name, reads, call) in at {
            let call = move |seen: &mut Watched<Self::Watch>, s: &mut Self::Simulation, k| {
                call(self, &mut seen.watch, s, k, &mut seen.record);
            };
            drive = match reads {
                Reads::All => drive.at(name, call),
                Reads::Positions => drive.at_positions(name, call),
            };
        }
        let ended = match playback {
            Some(playback) => drive.play(playback, context),
            None => drive.run(context),
        }?;
        let Watched { watch, mut record } = seen;
        ended.put(&mut record);
        self.measure(watch, &simulation, &mut record);
        Ok(record)
    }
}

impl<P: Problem> Parted for P {}

/// The scene of a run.
type Scenes<X> = Box<dyn Fn() -> Result<Parts<X>, RunError>>;
/// Measures the particles at the end.
type AtEnd<X> = Box<dyn Fn(&dyn Stepper<X>, &mut Record)>;

/// A run that is measured at its end alone.
pub struct Simple<X: Numbers = ()> {
    method: Method<X>,
    medium: Medium,
    rules: Rules,
    particles: f64,
    decisive: &'static str,
    numbers: Vec<(&'static str, f64)>,
    scene: Scenes<X>,
    measure: AtEnd<X>,
    /// Why no file can state the scene for other codes, if so.
    pub not_exported: Option<&'static str>,
}

impl<X: Numbers> Simple<X> {
    /// A run with these rules and about this number of particles, whose cost depends on the settings
    /// `decisive`. Its record states h/dx and `numbers`. `measure` is called at the end of a run that reaches
    /// it.
    pub fn new(
        method: &Method<X>,
        (medium, rules): (Medium, Rules),
        (particles, decisive): (f64, &'static str),
        numbers: &[(&'static str, f64)],
        scene: impl Fn() -> Result<Parts<X>, RunError> + 'static,
        measure: impl Fn(&dyn Stepper<X>, &mut Record) + 'static,
    ) -> Self {
        let (method, numbers) = (method.clone(), numbers.to_vec());
        let (scene, measure) = (Box::new(scene), Box::new(measure));
        let not_exported = None;
        Self { method, medium, rules, particles, decisive, numbers, scene, measure, not_exported }
    }
}

impl<X: Numbers> Problem for Simple<X> {
    type Extra = X;
    type Simulation = dyn Stepper<X>;
    type Watch = ();

    fn method(&self) -> &Method<X> {
        &self.method
    }

    fn brief(&self) -> Brief {
        Brief::new(self.medium, self.rules, self.particles, self.decisive).numbers(&self.numbers)
    }

    fn not_exported(&self) -> Option<&'static str> {
        self.not_exported
    }

    fn times(&self) -> Vec<f64> {
        vec![self.rules.end]
    }

    fn scene(&self) -> Result<Parts<X>, RunError> {
        (self.scene)()
    }

    fn watch(&self, _: &[Particle<X>], _: &dyn Stepper<X>) {}

    fn measure(&self, (): (), end: &dyn Stepper<X>, record: &mut Record) {
        if record.status == Status::Completed {
            (self.measure)(end, record);
        }
    }
}
