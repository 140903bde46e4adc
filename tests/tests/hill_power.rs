//! What the gates of the flow over hills are worth: the planned run at Re 50, ten spacings a hill, with one
//! thing spoiled. Each must fail a gate; which ones stands in `hill_power.csv`, written anew with
//! `INSTA_UPDATE=always`.

use base::record::Record;
use fluids::periodic_hill::{self, Driving, HillSettings, PERIODIC_HILL, Setup};
use harness::{
    case::{Planned, Tier},
    context::Context,
    method,
};
use nalgebra::Vector2;
use rayon::prelude::*;
use solver::{
    BodyForce, Compose, Continuity, DensityDiffusion, ExtrapolatingWall, Leapfrog, NoSlip,
    Pressure, QuinticSpline, Scene, ShiftAdvection, Shifting, Tait, Viscosity,
    lane::Lane,
    numbers::Numbers,
    walls::{WallVelocity, Walls},
};
use std::path::Path;

type Forces = (Pressure<Tait>, Viscosity, BodyForce, ShiftAdvection);
type Drift = (Continuity, DensityDiffusion, Shifting);
type Hill<W> = Compose<QuinticSpline, Forces, Drift, W, Leapfrog>;
type Sticking = ExtrapolatingWall<Tait, NoSlip>;

/// Wall particles move with the fluid before them.
#[derive(Clone, Copy, Debug)]
struct Slip;

impl WallVelocity for Slip {
    type Sum = Vector2<f64>;
    fn add<V: Lane>(v: Vector2<V>, w: V, sum: &mut <Self::Sum as Numbers>::In<V>) {
        NoSlip::add(v, w, sum);
    }
    fn beyond(sum: Vector2<f64>, weight: f64) -> Vector2<f64> {
        -NoSlip::beyond(sum, weight)
    }
}

/// What is wrong.
struct Fault {
    name: &'static str,
    /// Settings of the scene alone: the record is judged by those of the plan.
    scene: fn(&mut HillSettings),
    /// Settings of the run.
    run: fn(&mut HillSettings),
    viscosity: f64,
    shifting: f64,
    slips: bool,
}

const NONE: Fault = Fault {
    name: "nothing",
    scene: |_| {},
    run: |_| {},
    viscosity: 1.0,
    shifting: 1.0,
    slips: false,
};

const FAULTS: [Fault; 5] = [
    Fault { name: "hill 2 % higher", scene: |s| s.crest = 1.02, ..NONE },
    Fault { name: "walls slip", slips: true, ..NONE },
    Fault {
        name: "controller off and force 10 % low",
        run: |s| (s.response, s.force) = (0.0, 0.0322),
        ..NONE
    },
    Fault { name: "viscosity x 1.05", viscosity: 1.05, ..NONE },
    Fault { name: "no shifting", shifting: 0.0, ..NONE },
];

fn planned() -> Planned {
    PERIODIC_HILL.plan(Tier::Quick).into_iter().next().expect("a planned run")
}

/// The scene of the settings with its walls replaced.
fn with_walls<W: Walls<()>>(healthy: Scene<Hill<Sticking>>, walls: W) -> Scene<Hill<W>> {
    Scene {
        h: healthy.h,
        domain: healthy.domain,
        particles: healthy.particles,
        forces: healthy.forces,
        drift: healthy.drift,
        walls,
        skin: healthy.skin,
        skin_share: healthy.skin_share,
        limits: healthy.limits,
        parallel_from: healthy.parallel_from,
    }
}

fn run(fault: &Fault) -> Record {
    let (planned, context) = (planned(), Context::default());
    let method = periodic_hill::method::<Hill<Sticking>>();
    let setup = |spoil: fn(&mut HillSettings)| {
        let settings = planned.spec.settings.clone();
        let mut settings = serde_json::from_value(settings).expect("planned settings");
        spoil(&mut settings);
        Setup::new(&settings, &method, &context).expect("sound settings")
    };
    let mut scene = method::scene::<Hill<Sticking>>(setup(fault.scene).parts(&context));
    let setup = setup(fault.run);
    let medium = &setup.flow.medium;
    scene.forces.1.mu *= fault.viscosity;
    if fault.shifting == 0.0 {
        let none = Shifting::new(0.0, medium.h, medium.w_at_spacing);
        (scene.forces.3, scene.drift.2) = (ShiftAdvection(none), none);
    }
    let simulation: Box<dyn Driving> = if fault.slips {
        let Sticking { eos, acceleration, least_pressure, .. } = scene.walls;
        let walls = ExtrapolatingWall { eos, acceleration, least_pressure, velocity: Slip };
        Box::new(with_walls(scene, walls).build().expect("a scene"))
    } else {
        Box::new(scene.build().expect("a scene"))
    };
    let variant = planned.spec.variant.as_str();
    periodic_hill::measured(&setup, &method, variant, simulation, &context).expect("a run")
}

/// Gates that this record fails.
fn failed(planned: &Planned, record: &Record) -> Vec<String> {
    let fails = |gate: &&base::gate::Gate| gate.judge_record(record).verdict.is_failure();
    planned.gates.iter().filter(fails).map(|gate| gate.id.clone()).collect()
}

#[test]
#[ignore = "two runs of 15 s each on an idle core; cargo test --test hill_power -- --ignored"]
fn no_fault_has_the_bits_of_the_case() {
    let planned = planned();
    let own = PERIODIC_HILL.run(&planned.spec, &Context::default()).expect("a run");
    let same = run(&NONE);
    assert!(own.state.is_some() && own.state == same.state);
    assert_eq!(failed(&planned, &same), Vec::<String>::new());
}

#[test]
#[ignore = "five runs of 15 s each on an idle core; cargo test --test hill_power -- --ignored"]
fn every_spoiled_hill_fails_a_gate() {
    let planned = planned();
    let results: Vec<Vec<String>> =
        FAULTS.par_iter().map(|fault| failed(&planned, &run(fault))).collect();
    let mut text = "mutant,gates that it fails,of,which\n".to_string();
    for (fault, failed) in FAULTS.iter().zip(&results) {
        let all = planned.gates.len();
        text += &format!("{},{},{all},{}\n", fault.name, failed.len(), failed.join(" "));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("hill_power.csv");
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&path, &text).expect("a file that can be written");
    }
    let survivors: Vec<&str> =
        FAULTS.iter().zip(&results).filter(|(_, r)| r.is_empty()).map(|(f, _)| f.name).collect();
    assert!(survivors.is_empty(), "no gate sees these: {survivors:?}\n{text}");
    assert_eq!(std::fs::read_to_string(&path).unwrap_or_default(), text);
}
