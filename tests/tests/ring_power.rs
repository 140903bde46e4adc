//! What the gates of the elastic solid are worth: rubber with one thing spoiled, through the planned
//! run of the rings at spacing 0.2 L and through elastic waves. Each must fail a gate; which ones
//! stands in `ring_power.csv`, written anew with `INSTA_UPDATE=always`.

use base::{gate::Gate, record::Record};
use harness::{
    case::{Case, Planned, Tier},
    context::Context,
    method::{self, Method},
};
use nalgebra::Vector2;
use rayon::prelude::*;
use solids::{
    elastic_wave::{self, WaveSettings},
    rings::{self, RUBBER_RINGS, RingSettings, Rings, Stressed},
    solid::{Bare, Rubber},
};
use solver::{
    ArtificialViscosity, CauchyStress, Compose, Continuity, CubicSpline, JaumannRate, Kernel,
    Leapfrog, Linear, Open, PrincipalStress, Rate, Scene, Scheme, Symmetric, Term, Xsph,
    lane::Lane, numbers::Numbers, particles::Common, terms::Pair,
};
use std::path::Path;

/// What is wrong; all neutral by default.
#[derive(Clone, Copy, Debug)]
struct Fault {
    name: &'static str,
    shear_modulus: f64,
    rotates: bool,
    tensile: f64,
    own_side: f64,
    time_step: fn(&Rings) -> f64,
}

const NONE: Fault = Fault {
    name: "nothing",
    shear_modulus: 1.0,
    rotates: true,
    tensile: 1.0,
    own_side: 1.0,
    time_step: |_| 1.0,
};

const FAULTS: [Fault; 5] = [
    Fault { name: "shear modulus x 1.05", shear_modulus: 1.05, ..NONE },
    Fault { name: "stress not rotated", rotates: false, ..NONE },
    Fault { name: "artificial stress with the wrong sign", tensile: -1.0, ..NONE },
    Fault {
        name: "c0 for c_p in the time step",
        time_step: |r| (r.cp + r.v) / (r.c0 + r.v),
        ..NONE
    },
    Fault { name: "own stress x 0.99", own_side: 0.99, ..NONE },
];

/// (9) with a weight for the particle's own stress.
#[derive(Clone, Debug)]
struct SidedStress<R>(CauchyStress<Linear, R>, f64);

impl<R> Term<Symmetric> for SidedStress<R>
where
    CauchyStress<Linear, R>:
        Term<Symmetric, Sum = Vector2<f64>, Derived = (Symmetric, <Self as Shown>::Tensile)>,
    Self: Shown,
    R: Clone + Send + Sync + 'static,
{
    type Derived = (Symmetric, <Self as Shown>::Tensile);
    type Sum = Vector2<f64>;

    fn derived(&self, own: &Common<f64>, extra: &Symmetric) -> Self::Derived {
        self.0.derived(own, extra)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(
        &self,
        pair: &Pair<V, K>,
        own: <Self::Derived as Numbers>::In<V>,
        other: <Self::Derived as Numbers>::In<V>,
        sum: &mut Vector2<V>,
    ) {
        self.0.pair(pair, (own.0 * V::all(self.1), own.1), other, sum);
    }

    fn finish(
        &self,
        own: &Common<f64>,
        derived: Self::Derived,
        sum: Vector2<f64>,
        rate: &mut Rate<Symmetric>,
    ) {
        self.0.finish(own, derived, sum, rate);
    }
}

/// What an artificial stress shows.
trait Shown {
    type Tensile: Numbers;
}

impl Shown for SidedStress<PrincipalStress> {
    type Tensile = Symmetric;
}

impl Shown for SidedStress<()> {
    type Tensile = ();
}

/// The energy budget is that of the healthy terms.
impl Stressed for SidedStress<PrincipalStress> {
    type Tensile = PrincipalStress;
}

/// (11) with or without the rotation of the stress.
#[derive(Clone, Debug)]
struct PerhapsRotating(JaumannRate, bool);

impl Term<Symmetric> for PerhapsRotating {
    type Derived = Symmetric;
    type Sum = <JaumannRate as Term<Symmetric>>::Sum;

    fn derived(&self, own: &Common<f64>, extra: &Symmetric) -> Symmetric {
        self.0.derived(own, extra)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(
        &self,
        pair: &Pair<V, K>,
        own: Symmetric<V>,
        other: Symmetric<V>,
        sum: &mut <Self::Sum as Numbers>::In<V>,
    ) {
        self.0.pair(pair, own, other, sum);
    }

    fn finish(&self, own: &Common<f64>, s: Symmetric, sum: Self::Sum, rate: &mut Rate<Symmetric>) {
        self.0.finish(own, if self.1 { s } else { Symmetric::default() }, sum, rate);
    }
}

type Spoiled = Compose<
    CubicSpline,
    (SidedStress<PrincipalStress>, ArtificialViscosity<Linear>),
    (Continuity, PerhapsRotating, Xsph),
    Open,
    Leapfrog,
    Symmetric,
>;

fn rate(healthy: JaumannRate, fault: &Fault) -> PerhapsRotating {
    let shear_modulus = healthy.shear_modulus * fault.shear_modulus;
    PerhapsRotating(JaumannRate { shear_modulus }, fault.rotates)
}

fn planned() -> Planned {
    let spec = RUBBER_RINGS.spec("leapfrog", |s| s.spacing = 0.2);
    let is_it = |planned: &Planned| planned.spec == spec;
    RUBBER_RINGS.plan(Tier::Quick).into_iter().find(is_it).expect("a planned run")
}

/// A scene with other terms.
fn with_terms<H, S>(healthy: Scene<H>, forces: S::Forces, drift: S::Drift) -> Scene<S>
where
    H: Scheme<Extra = Symmetric, Walls = Open>,
    S: Scheme<Extra = Symmetric, Walls = Open>,
{
    Scene {
        h: healthy.h,
        domain: healthy.domain,
        particles: healthy.particles,
        forces,
        drift,
        walls: Open,
        skin: healthy.skin,
        skin_share: healthy.skin_share,
        limits: healthy.limits,
        parallel_from: healthy.parallel_from,
    }
}

fn collide(planned: &Planned, fault: &Fault) -> Record {
    type Healthy = Rubber<PrincipalStress, Leapfrog>;
    let (context, method) = (Context::default(), rings::method::<PrincipalStress, Leapfrog>());
    let settings = planned.spec.settings.clone();
    let settings: RingSettings = serde_json::from_value(settings).expect("planned settings");
    let mut rings = Rings::new(&settings, &method, &context).expect("sound settings");
    rings.dt *= (fault.time_step)(&rings);
    let healthy = method::scene::<Healthy>(rings.parts(&context));
    let (stress, viscosity) = healthy.forces;
    let (xi, w) = (fault.tensile * settings.xi, rings.medium.w_at_spacing);
    let tensile = PrincipalStress::new(xi, settings.exponent as u32, w);
    let stress = SidedStress(CauchyStress { tensile, ..stress }, fault.own_side);
    let (continuity, jaumann, xsph) = healthy.drift;
    let drift = (continuity, rate(jaumann, fault), xsph);
    let scene = with_terms::<Healthy, Spoiled>(healthy, (stress, viscosity), drift);
    let simulation = Box::new(scene.build().expect("a scene"));
    rings::measured(&rings, &method, &planned.spec.variant, simulation, &context).expect("a run")
}

type Rippled =
    Compose<CubicSpline, SidedStress<()>, (Continuity, PerhapsRotating), Open, Leapfrog, Symmetric>;

/// A wave, or a rotating block.
fn ripple(settings: &WaveSettings, fault: &Fault) -> Record {
    let (context, method) = (Context::default(), Method::of::<Bare>());
    let healthy = method::scene::<Bare>(settings.parts(&method, &context));
    let (continuity, jaumann) = healthy.drift;
    let forces = SidedStress(healthy.forces, fault.own_side);
    let drift = (continuity, rate(jaumann, fault));
    let scene = with_terms::<Bare, Rippled>(healthy, forces, drift);
    let simulation = Box::new(scene.build().expect("a scene"));
    elastic_wave::measured(settings, &method, CubicSpline::NAME, simulation, &context)
        .expect("a run")
}

/// Gates that this fault fails, and how many there are.
fn failed(fault: &Fault) -> (Vec<String>, usize) {
    let planned = planned();
    let record = collide(&planned, fault);
    let fails = |gate: &Gate, record: &Record| gate.judge_record(record).verdict.is_failure();
    let mut failed: Vec<String> = planned
        .gates
        .iter()
        .filter(|gate| fails(gate, &record))
        .map(|gate| gate.id.clone())
        .collect();
    let ripples = [(false, false), (true, false), (false, true)];
    for (transverse, rotation) in ripples {
        let settings = WaveSettings { h_over_dx: 1.5, transverse, rotation };
        let gate = settings.gate(CubicSpline::NAME);
        if fails(&gate, &ripple(&settings, fault)) {
            failed.push(gate.id);
        }
    }
    (failed, planned.gates.len() + ripples.len())
}

#[test]
fn no_fault_has_the_bits_of_the_case() {
    let planned = planned();
    let own = RUBBER_RINGS.run(&planned.spec, &Context::default()).expect("a run");
    let wrapped = collide(&planned, &NONE);
    assert!(own.state.is_some() && own.state == wrapped.state);
    assert_eq!(failed(&NONE).0, Vec::<String>::new());
}

#[test]
fn every_spoiled_rubber_fails_a_gate() {
    let results: Vec<(Vec<String>, usize)> = FAULTS.par_iter().map(failed).collect();
    let mut text = "mutant,gates that it fails,of,which\n".to_string();
    for (fault, (failed, all)) in FAULTS.iter().zip(&results) {
        text += &format!("{},{},{all},{}\n", fault.name, failed.len(), failed.join(" "));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("ring_power.csv");
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&path, &text).expect("a file that can be written");
    }
    let survivors: Vec<&str> =
        FAULTS.iter().zip(&results).filter(|(_, r)| r.0.is_empty()).map(|(f, _)| f.name).collect();
    assert!(survivors.is_empty(), "no gate sees these: {survivors:?}\n{text}");
    assert_eq!(std::fs::read_to_string(&path).unwrap_or_default(), text);
}
