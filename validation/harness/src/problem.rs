//! A run in verbs. A case states the scene of a run, the measurements at its times, and its metrics; from
//! these the functions here simulate a run, estimate its cost, export it, transform it to another observer's
//! frame, and measure particles of another code.

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value;
use std::{cell::RefCell, ops::ControlFlow};
use touchstone_base::{
    absent::Absent,
    number,
    record::{Profile, Record, Status},
    spec::{Keep, Measure, RunSpec},
};
use touchstone_solver::{Divergence, Numbers, Outcome, Role, Stepper};

use crate::{
    checkpoint::{self, as_json},
    context::Context,
    error::RunError,
    foreign::{self, Foreign, OurSums},
    frames,
    medium::{Medium, MediumSetting},
    method::{Method, Parts, see},
    outline::Outline,
    relation::{Relation, TIME, View},
    rules::Rules,
    runner::{self, Observations, ObservedRun, Schedule, check_size},
    size::Size,
    snapshot::{DENSITY, ParticleArrays, Snapshot},
};

/// Name of the kernel in the numerics of a record.
pub const KERNEL: &str = "kernel";
/// Name of the integrator.
pub const INTEGRATOR: &str = "integrator";
/// Name of the walls.
pub const WALLS: &str = "walls";

/// Optional output of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct OptionalOutput {
    /// Every metric, at any cost.
    pub all: bool,
    /// Particles for pictures.
    pub particles: bool,
}

impl OptionalOutput {
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
    /// Steps that leave data in the record.
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
    /// Does [`Problem::watch`] read the scene?
    const READS_START: bool = false;

    /// The method.
    fn method(&self) -> &Method<Self::Extra, Self::Simulation>;

    /// Facts that are known before the particles are made.
    fn brief(&self) -> Brief;

    /// Why no file can state the scene for other codes, if so.
    fn not_exported(&self) -> Option<&'static str> {
        None
    }

    /// The times of interest, ascending, the end last \[s\]; the end alone unless a case has others.
    fn times(&self) -> Vec<f64> {
        vec![Problem::brief(self).rules.end]
    }

    /// Particles, walls and medium.
    ///
    /// # Errors
    /// If the settings make no scene.
    fn scene(&self) -> Result<Parts<Self::Extra>, RunError>;

    /// Changes a new simulation by data that no scene states, in the frame of an observer.
    fn prepare(&self, _simulation: &mut Self::Simulation, _view: &View) {}

    /// The watch before the first step: `scene` has the particles before any deliberate error, none unless
    /// [`Problem::READS_START`], and `start` the particles with it.
    fn watch(&self, scene: &Snapshot<Self::Extra>, start: &Snapshot<Self::Extra>) -> Self::Watch;

    /// Adds the functions that measure on the way.
    fn calls(&self, calls: Calls<Self>, _output: OptionalOutput) -> Calls<Self> {
        calls
    }

    /// Puts metrics and profiles at the end; the record states how the run ended.
    fn measure(&self, watch: Self::Watch, end: &Snapshot<Self::Extra>, record: &mut Record);
}

/// State of an observed run: everything that changes during it.
#[derive(Serialize, Deserialize)]
struct ObservedState<W> {
    watch: W,
    #[serde(with = "as_json")]
    record: Record,
}

/// Called after every step.
type AfterStep<P> =
    fn(&P, &mut <P as Problem>::Watch, &Snapshot<<P as Problem>::Extra>) -> ControlFlow<()>;
/// Called after every step of our own runs.
type EveryStep<P> = fn(&P, &mut <P as Problem>::Watch, &dyn Stepper<<P as Problem>::Extra>);
/// Called at the k-th of the times of interest.
type At<P> =
    fn(&P, &mut <P as Problem>::Watch, &Snapshot<<P as Problem>::Extra>, usize, &mut Record);
/// Called at each of the times of interest of our own runs.
type OfOurs<P> = fn(&P, &mut <P as Problem>::Watch, &mut <P as Problem>::Simulation);
/// Called when a run continues from a checkpoint.
type Resumed<P> = fn(&P, &<P as Problem>::Watch, &mut <P as Problem>::Simulation);

/// The functions of a problem that are called on the way, with the names that a profile of the run shows.
pub struct Calls<P: Problem> {
    after_step: Vec<(&'static str, AfterStep<P>)>,
    every_step: Vec<(&'static str, EveryStep<P>)>,
    at: Vec<TimedCall<P>>,
    of_ours: Vec<(&'static str, OfOurs<P>)>,
    resumed: Option<Resumed<P>>,
}

/// A function that is called at each of the times of interest.
struct TimedCall<P: Problem> {
    name: &'static str,
    /// Does it need velocities and extra fields of the very time?
    synchronised: bool,
    call: At<P>,
}

impl<P: Problem> Default for Calls<P> {
    fn default() -> Self {
        Self {
            after_step: Vec::new(),
            every_step: Vec::new(),
            at: Vec::new(),
            of_ours: Vec::new(),
            resumed: None,
        }
    }
}

impl<P: Problem> Calls<P> {
    /// Calls a function after every step, and at every frame of another code. In a leapfrog, velocities and
    /// extra fields are half a step old there.
    #[must_use]
    pub fn after_step(mut self, name: &'static str, call: AfterStep<P>) -> Self {
        self.after_step.push((name, call));
        self
    }

    /// Calls a function after every step of our own runs, which files of another code do not have.
    #[must_use]
    pub fn every_step_of_ours(mut self, name: &'static str, call: EveryStep<P>) -> Self {
        self.every_step.push((name, call));
        self
    }

    /// Calls a function at each of the times of interest, with its number.
    #[must_use]
    pub fn at(mut self, name: &'static str, call: At<P>) -> Self {
        self.at.push(TimedCall { name, synchronised: true, call });
        self
    }

    /// Calls a function that reads positions and densities, or for which velocities and extra fields of a
    /// leapfrog may be half a step old, which costs no pair sweep.
    #[must_use]
    pub fn at_positions(mut self, name: &'static str, call: At<P>) -> Self {
        self.at.push(TimedCall { name, synchronised: false, call });
        self
    }

    /// Adds these functions only on a condition.
    #[must_use]
    pub fn when(self, is: bool, add: impl FnOnce(Self) -> Self) -> Self {
        if is { add(self) } else { self }
    }

    /// Calls a function at each of the times of interest of our own runs, after all others: it may take the
    /// sums of our terms.
    #[must_use]
    pub fn of_ours(mut self, name: &'static str, call: OfOurs<P>) -> Self {
        self.of_ours.push((name, call));
        self
    }

    /// Adds such a function that changes our simulation. `resumed` makes the change again when a run goes on
    /// from a checkpoint, which does not hold it.
    #[must_use]
    pub fn control(mut self, name: &'static str, call: OfOurs<P>, resumed: Resumed<P>) -> Self {
        self.resumed = Some(resumed);
        self.of_ours(name, call)
    }
}

/// A problem with its functions, and the state of its run.
struct Observed<'a, P: Problem> {
    problem: &'a P,
    calls: Calls<P>,
    state: ObservedState<P::Watch>,
}

impl<P: Problem> Observations<P::Extra> for Observed<'_, P> {
    fn after_step(&mut self, k: usize, simulation: &dyn Stepper<P::Extra>) -> ControlFlow<()> {
        let Self { problem, calls, state: ObservedState { watch, .. } } = self;
        if let Some((_, call)) = calls.after_step.get(k) {
            return call(problem, watch, &Snapshot::ours(simulation));
        }
        (calls.every_step[k - calls.after_step.len()].1)(problem, watch, simulation);
        ControlFlow::Continue(())
    }

    fn save(&self) -> Result<Vec<u8>, RunError> {
        Ok(postcard::to_allocvec(&self.state)?)
    }

    fn restore(&mut self, bytes: &[u8]) -> Result<(), RunError> {
        self.state = checkpoint::read(bytes)?;
        Ok(())
    }
}

/// The simulation of a problem, and its observations.
struct Run<'a, P: Problem> {
    simulation: Box<P::Simulation>,
    seen: Observed<'a, P>,
}

impl<P: Problem> ObservedRun<P::Extra> for Run<'_, P> {
    fn parts(&mut self) -> (&mut dyn Stepper<P::Extra>, &mut dyn Observations<P::Extra>) {
        (self.simulation.stepper(), &mut self.seen)
    }

    fn at(&mut self, k: usize, reached: usize) {
        let Observed { problem, calls, state: ObservedState { watch, record } } = &mut self.seen;
        match calls.at.get(k) {
            Some(of) => {
                let now = Snapshot::ours(self.simulation.stepper());
                (of.call)(problem, watch, &now, reached, record);
            }
            None => (calls.of_ours[k - calls.at.len()].1)(problem, watch, &mut self.simulation),
        }
    }

    fn resumed(&mut self) {
        let Observed { problem, calls, state } = &self.seen;
        calls.resumed.iter().for_each(|call| call(problem, &state.watch, &mut self.simulation));
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
pub trait AnyProblem {
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
    /// If it is refused, has no scene that a file can state, or the relation is not a symmetry of it.
    fn outline(
        &self,
        spec: &RunSpec,
        relation: Option<Relation>,
        allow_long: bool,
    ) -> Result<Outline, RunError>;
    /// Its scene in the frame of an observer, and the particles at a few early times before a divergence.
    ///
    /// # Errors
    /// As [`AnyProblem::outline`].
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
    fn measure_frames(&self, spec: &RunSpec, foreign: &Foreign) -> Result<Record, RunError>;
}

impl<P: Problem> AnyProblem for P {
    fn brief(&self) -> Brief {
        Problem::brief(self)
    }

    fn size(&self, spec: &RunSpec, steps: Steps, allow_long: bool) -> Result<Size, RunError> {
        self.checked(spec, steps, allow_long).map(|(_, size)| size)
    }

    fn simulate(&self, context: &Context) -> Result<Record, RunError> {
        let spec = &context.spec;
        let (brief, size) = self.checked(spec, Steps::All, context.allow_long)?;
        let threads = if brief.is_serial { 1 } else { context.threads };
        let parts = self.parts(spec, threads)?;
        let scene = if Self::READS_START { &parts.particles[..] } else { &[] };
        let scene = Snapshot::of(0.0, scene);
        let mut simulation = self.built(parts, &View::default())?;
        let record = self.new_record(spec, threads, &brief);
        let times = self.times();
        let watch = self.watch(&scene, &Snapshot::ours(simulation.stepper()));
        drop(scene);
        let calls = self.calls(Calls::default(), OptionalOutput::of(spec));
        let every_step = calls.every_step.iter().map(|(name, _)| *name);
        let of_ours = calls.of_ours.iter().map(|(name, _)| (*name, true));
        let schedule = Schedule {
            dt: brief.rules.dt(),
            least: brief.least_steps,
            sweeps: size.sweeps,
            storage: size.storage,
            times: &times,
            pressure: &pressure(&brief.medium),
            after_step: calls.after_step.iter().map(|(name, _)| *name).chain(every_step).collect(),
            at: calls.at.iter().map(|of| (of.name, of.synchronised)).chain(of_ours).collect(),
        };
        let seen = Observed { problem: self, calls, state: ObservedState { watch, record } };
        let mut run = Run { simulation, seen };
        let ended = schedule.run(&mut run, context)?;
        let Run { mut simulation, seen: Observed { state, .. } } = run;
        let ObservedState { watch, mut record } = state;
        ended.put(&mut record);
        self.measure(watch, &Snapshot::ours(simulation.stepper()), &mut record);
        Ok(record)
    }

    fn outline(
        &self,
        spec: &RunSpec,
        relation: Option<Relation>,
        allow_long: bool,
    ) -> Result<Outline, RunError> {
        Ok(self.outlined(spec, relation, Steps::None, allow_long)?.1)
    }

    fn seen_by(
        &self,
        relation: Relation,
        context: &Context,
        at_time: AtTime,
    ) -> Result<Outline, RunError> {
        let (mut simulation, outline) =
            self.outlined(&context.spec, Some(relation), Steps::Early, context.allow_long)?;
        let (simulation, pressure) = (simulation.stepper(), pressure(&Problem::brief(self).medium));
        for until in outline.times.iter().filter(|_| !context.is_interrupted()) {
            if simulation.advance(*until, outline.dt, &mut ()) != Outcome::Reached {
                break; // it diverged
            }
            at_time(*until, frames::columns(&simulation.particles(), &pressure));
        }
        Ok(outline)
    }

    fn measure_frames(&self, spec: &RunSpec, foreign: &Foreign) -> Result<Record, RunError> {
        let (brief, _) = self.checked(spec, Steps::None, true)?;
        let (parts, times) = (self.parts(spec, 1)?, self.times());
        let end = times.last().copied().unwrap_or_default();
        if let Some(time) = foreign::missing(foreign.frames, &times).first() {
            return Err(RunError::Foreign(format!("there is no frame at t = {time} s")));
        }
        let (own, limits) = (foreign.own_start(), parts.limits);
        let scene = own.clone().unwrap_or_else(|| ParticleArrays::all(&parts.particles));
        let sums = self.sums(parts, foreign)?;
        let of_problem =
            || ParticleArrays::all(&sums.simulation.borrow_mut().stepper().particles());
        let mut start = own.unwrap_or_else(of_problem);
        let mut record = self.new_record(spec, 1, &brief);
        record.cost.particles = start.points.iter().filter(|point| point.is_fluid()).count();
        let mut last = Snapshot::given(0.0, start.clone(), &sums);
        let mut watch = self.watch(&Snapshot::given(0.0, scene, &sums), &last);
        start.densities = start.densities.filter(|_| foreign.has_densities());
        let Calls { after_step, at, .. } = self.calls(Calls::default(), OptionalOutput::of(spec));
        let mut reached = 0;
        for frame in foreign.frames {
            let next = |reached: usize| times.get(reached).filter(|time| frame.is_at(**time, end));
            let time = next(reached).copied().unwrap_or(frame.time);
            let diverged = |fault| runner::diverged(Divergence { step: 0, time, fault });
            if let Some(fault) = foreign.lost(frame, &limits) {
                record.status = diverged(fault);
                break;
            }
            let columns = foreign.columns(frame, &start)?;
            if let Some(fault) = foreign.crowded(frame, &columns) {
                record.status = diverged(fault);
                break;
            }
            if let Some(divergence) = sums.divergence(time, &columns) {
                record.status = runner::diverged(divergence);
                break;
            }
            last = Snapshot::given(time, columns, &sums);
            for (_, call) in &after_step {
                let _goes_on = call(self, &mut watch, &last);
            }
            // A time may be stated twice, for example for a sample and for a picture.
            while next(reached).is_some() {
                at.iter().for_each(|of| (of.call)(self, &mut watch, &last, reached, &mut record));
                reached += 1;
            }
        }
        record.state = last.sums(runner::state).ok();
        self.measure(watch, &last, &mut record);
        Ok(record)
    }
}

fn pressure(medium: &Medium) -> impl Fn(f64) -> f64 + use<> {
    let eos = medium.eos;
    move |density| touchstone_solver::EquationOfState::pressure(&eos, density)
}

/// Private methods of every problem.
trait PrivateMethods: Problem {
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
        let size = Size::new(rules.end / dt, brief.particles, reach);
        let sweeps = if brief.is_limited { rules.sweeps() } else { size.sweeps };
        let size = Size { sweeps, samples: brief.samples, storage: method.storage, ..size };
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
        let shifts = self.method().properties.uses.contains(&MediumSetting::Shift);
        let shifts = shifts && parts.medium.shift > 0.0;
        if relation == Relation::Boosted && steps == Steps::Early && shifts {
            return Err(refused("its shifting takes the largest speed of the scene"));
        }
        Ok(view)
    }

    /// The simulation in the frame of an observer, and its outline.
    fn outlined(
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
    fn new_record(&self, spec: &RunSpec, threads: usize, brief: &Brief) -> Record {
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

    /// Sums of our method over particles of another code that start like this.
    fn sums(
        &self,
        parts: Parts<Self::Extra>,
        foreign: &Foreign,
    ) -> Result<OurSums<Self::Simulation>, RunError> {
        let own = foreign.own_particles();
        let lacks = own.is_none().then(|| Absent::NotGiven(DENSITY.into()));
        // Without densities only the kernel is required.
        let own = own.filter(|own| !own.is_empty());
        let parts = Parts { particles: own.unwrap_or(parts.particles), ..parts };
        let simulation = RefCell::new(self.built(parts, &View::default())?);
        let is_lagrangian = self.method().properties.law.is_some();
        Ok(OurSums { simulation, is_lagrangian, lacks })
    }
}

impl<P: Problem> PrivateMethods for P {}

/// The scene of a run.
type Scenes<X> = Box<dyn Fn() -> Result<Parts<X>, RunError>>;
/// Measures the particles at the end.
type AtEnd<X> = Box<dyn Fn(&Snapshot<X>, &mut Record)>;

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
        measure: impl Fn(&Snapshot<X>, &mut Record) + 'static,
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

    fn scene(&self) -> Result<Parts<X>, RunError> {
        (self.scene)()
    }

    fn watch(&self, _: &Snapshot<X>, _: &Snapshot<X>) {}

    fn measure(&self, (): (), end: &Snapshot<X>, record: &mut Record) {
        if record.status == Status::Completed {
            (self.measure)(end, record);
        }
    }
}
