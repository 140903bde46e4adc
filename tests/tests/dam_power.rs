//! What the gates of the dam break are worth: the collapse with one thing spoiled, through planned runs
//! at a/dx = 20. Each must fail a gate; which ones stands in `dam_power.csv`, written anew with
//! `INSTA_UPDATE=always`.

use base::{gate::Gate, record::Record};
use harness::{
    case::{Case, Planned, Tier},
    method::{Standard, scene},
    runner::Context,
};
use maths::metrics::budget::Itemised;
use nalgebra::Vector2;
use rayon::prelude::*;
use solver::{
    ArtificialStress, BodyForce, Compose, Continuity, CubicSpline, InterfaceWall, Leapfrog,
    PredictorCorrector, Scene, Scheme, WendlandC2, Xsph, walls::Walls,
};
use std::path::Path;
use waters::{
    dam_break::{self, DAM_BREAK, Dam, DamSettings},
    water::{Diffusion, Modern, Seed, Water, WaterMethod, method},
};

/// Walls whose particles keep the density, and so the pressure 0, that they were given.
#[derive(Clone, Copy, Debug)]
struct Frozen;

impl Walls<()> for Frozen {
    type Terms = ();
    fn terms(&self) {}
}

type ModernFrozen = Compose<WendlandC2, Water, (Continuity, Diffusion), Frozen, Leapfrog>;
type SeedFrozen =
    Compose<CubicSpline, Water<ArtificialStress>, (Continuity, Xsph), Frozen, PredictorCorrector>;

/// The same scene with walls of another type.
fn frozen<A, B>(scene: Scene<A>) -> Scene<B>
where
    A: Scheme<Extra = ()>,
    B: Scheme<Extra = (), Forces = A::Forces, Drift = A::Drift, Walls = Frozen>,
{
    Scene {
        h: scene.h,
        domain: scene.domain,
        particles: scene.particles,
        forces: scene.forces,
        drift: scene.drift,
        walls: Frozen,
        skin: scene.skin,
        skin_share: scene.skin_share,
        limits: scene.limits,
        parallel_from: scene.parallel_from,
    }
}

fn planned(variant: &str) -> Planned {
    let spec = DAM_BREAK.spec(variant, |s| s.n = 20);
    let is_it = |planned: &Planned| planned.spec == spec;
    DAM_BREAK.plan(Tier::Quick).into_iter().find(is_it).expect("a planned run")
}

fn settings(planned: &Planned) -> DamSettings {
    serde_json::from_value(planned.spec.settings.clone()).expect("planned settings")
}

/// A planned run, its setup, and the method that makes its healthy scene, the scheme `S`.
struct Healthy {
    planned: Planned,
    method: WaterMethod,
    dam: Dam,
}

impl Healthy {
    fn of<S>(variant: &str, spoil: fn(&mut DamSettings)) -> Self
    where
        S: Standard<Extra = (), Forces: Itemised<()>, Drift: Itemised<()>>,
    {
        let (planned, method) = (planned(variant), method::<S>());
        let mut settings = settings(&planned);
        spoil(&mut settings);
        let dam = Dam::new(&settings, &method, &Context::default()).expect("sound settings");
        Self { planned, method, dam }
    }

    fn scene<S: Standard<Extra = ()>>(&self) -> Scene<S> {
        scene::<S>(self.dam.parts(&self.method, &Context::default()))
    }

    fn run<S>(self, scene: Scene<S>) -> (Planned, Record)
    where
        S: Scheme<Extra = (), Forces: Itemised<()>, Drift: Itemised<()>>,
    {
        let Self { planned, method, dam } = self;
        let simulation = Box::new(scene.build().expect("a scene"));
        let variant = &planned.spec.variant;
        let record = dam_break::measured(&dam, &method, variant, simulation, &Context::default());
        (planned, record.expect("a run"))
    }
}

fn modern() -> Healthy {
    Healthy::of::<Modern>("modern", |_| {})
}

fn seed(spoil: fn(&mut DamSettings)) -> Healthy {
    Healthy::of::<Seed<InterfaceWall>>("seed", spoil)
}

/// A run with a fault, and the plan whose gates judge it.
type Mutant = (&'static str, fn() -> (Planned, Record));

const MUTANTS: [Mutant; 5] = [
    ("gravity x 1.03", || {
        let healthy = modern();
        let mut scene = healthy.scene::<Modern>();
        scene.forces.2 = BodyForce(scene.forces.2.0 * 1.03);
        healthy.run(scene)
    }),
    ("XSPH with the wrong sign", || {
        let spoiled = seed(|s| s.xsph = -0.5);
        let scene = spoiled.scene::<Seed<InterfaceWall>>();
        spoiled.run(scene)
    }),
    ("one-sided pressure at the wall", || {
        let healthy = modern();
        let scene = frozen::<_, ModernFrozen>(healthy.scene::<Modern>());
        healthy.run(scene)
    }),
    ("wall density not evolved", || {
        let healthy = seed(|_| {});
        let scene = frozen::<_, SeedFrozen>(healthy.scene::<Seed<InterfaceWall>>());
        healthy.run(scene)
    }),
    ("front of the wrong particle", || {
        let mut spoiled = modern();
        spoiled.dam.is_front = |place: Vector2<f64>, height| place.y > 0.5 * height;
        let scene = spoiled.scene::<Modern>();
        spoiled.run(scene)
    }),
];

fn failed(planned: &Planned, record: &Record) -> Vec<String> {
    let fails = |gate: &&Gate| gate.judge_record(record).verdict.is_failure();
    planned.gates.iter().filter(fails).map(|gate| gate.id.clone()).collect()
}

#[test]
fn no_fault_has_the_bits_of_the_case() {
    let healthy = modern();
    let own = DAM_BREAK.run(&healthy.planned.spec, &Context::default()).expect("a run");
    let scene = healthy.scene::<Modern>();
    let (planned, same) = healthy.run(scene);
    assert!(own.state.is_some() && own.state == same.state);
    assert_eq!(failed(&planned, &same), Vec::<String>::new());
}

#[test]
fn every_spoiled_collapse_fails_a_gate() {
    let results: Vec<(Vec<String>, usize)> = MUTANTS
        .par_iter()
        .map(|(_, mutant)| {
            let (planned, record) = mutant();
            (failed(&planned, &record), planned.gates.len())
        })
        .collect();
    let mut text = "mutant,gates that it fails,of,which\n".to_string();
    for ((name, _), (failed, all)) in MUTANTS.iter().zip(&results) {
        text += &format!("{name},{},{all},{}\n", failed.len(), failed.join(" "));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("dam_power.csv");
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&path, &text).expect("a file that can be written");
    }
    let survivors: Vec<&str> = MUTANTS
        .iter()
        .zip(&results)
        .filter(|(_, result)| result.0.is_empty())
        .map(|(mutant, _)| mutant.0)
        .collect();
    assert!(survivors.is_empty(), "no gate sees these: {survivors:?}\n{text}");
    assert_eq!(std::fs::read_to_string(&path).unwrap_or_default(), text);
}
