//! Settings far outside of the usual, each with its own criterion.
//!
//! Common to all: no run hangs or panics, and a run that leaves its bounds ends as
//! [`touchstone_solver::Outcome::Diverged`] with step, time, particle and quantity. An invalid scene is
//! refused with the reason; `tests/tests/extremes.rs` tests this, and particles without neighbours.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{random::Random, record::MetricKey, settings::Settings};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{PLANNED_DT, Step},
    snapshot::{Point, Snapshot, momentum},
    table::{Row, Table},
};
use touchstone_maths::metrics::norms::largest;
use touchstone_solver::Tait;

use crate::lattice::torus;

touchstone_base::settings! {
    /// Settings of the experiments; each uses some of them.
    pub struct ExtremeSettings {
        /// particles along each side of the periodic box
        n: usize ["-"] in 4..=400 = 10,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.2,
        /// number of time steps
        steps: usize ["-"] in 10..=100000000 = 400,
        /// time step
        dt: f64 ["dx/c0"] in 1e-9..=100.0 = 0.6,
        /// pressure at rest
        background: f64 ["rho0 c0^2"] in 0.0..=1.0 = 0.0,
        /// distance of the two particles that are too close
        distance: f64 ["dx"] in 0.0..=1.0 = 0.0,
        /// speed of the moving block
        speed: f64 ["c0"] in 0.0..=1e6 = 1000.0,
    }
}

/// Settings far outside of the usual.
pub static EXTREMES: Composed<ExtremeSettings> = Composed {
    name: "extremes",
    problem: "Extreme settings and scenes: does the program stay sound?",
    recommended: Recommended {
        variant: "rest",
        because: "each variant is one experiment, and this one is the simplest",
        papers: None,
    },
    about: "Extreme scenes and settings, each variant one experiment: a lattice at rest for a very long \
            time, particles on top of each other, and a block at a thousand times the speed of sound. The \
            program must stay sound.",
    variants,
    facts: Facts::default,
    studies,
};

touchstone_base::metrics! {
    HEAT = "heat" ["c0^2"] "largest v^2/2 of a particle at the end";
    CLOCK_ERROR = "clock_error" ["dx/c0"]
        "largest |t - n dt| at ten times, infinite if the steps are not n";
    MOMENTUM_ERROR = "momentum_error" ["-"] "|change of sum m v|/sum m |v| of the moving particles";
    FASTEST = "fastest" ["c0"] "largest speed at the end";
}

/// The scene of a variant.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ExtremeScene {
    AtRest,
    Stirred,
    Blocks,
}

const REST: &str = "rest";
const PRESSED: &str = "pressed";
const COINCIDENT: &str = "coincident";
const BULLET: &str = "bullet";

fn variants() -> Compositions<ExtremeSettings> {
    const AT_REST: &[&str] = &["n", "h_over_dx", "steps", "dt", "background"];
    const SHORT: &[&str] = &["distance", "steps", "dt"];
    const FAST: &[&str] = &["speed", "steps", "dt"];
    let cubic = touchstone_schemes::lattice::cubic;
    let rest = "does round-off heat a lattice at rest? cubic spline";
    // Positive pressure pairs particles of a cubic spline, not of a Wendland function.
    let pressed = "does round-off heat a lattice under pressure? Wendland kernel";
    let coincident = "are two particles at one place harmless, in a lattice stirred at 0.05 c0?";
    let bullet = "does a block that hits another keep the momentum?";
    let all_but = |uses: &[&str]| {
        let names = ExtremeSettings::all().iter().map(|field| field.name);
        names.filter(|name| !uses.contains(name)).collect()
    };
    let wendland = touchstone_schemes::lattice::wendland();
    Variants::<_, (Method, ExtremeScene)>::of(|(method, scene), s: &ExtremeSettings| {
        Ok(Extreme { method: method.clone(), scene: *scene, settings: s.clone() })
    })
    .lacking([REST, rest], (cubic(), ExtremeScene::AtRest), all_but(AT_REST), |s| {
        (s.n, s.h_over_dx, s.steps, s.dt) = (5, 1.2, 100_000, 0.7);
    })
    .lacking([PRESSED, pressed], (wendland, ExtremeScene::AtRest), all_but(AT_REST), |s| {
        (s.n, s.h_over_dx, s.steps, s.dt, s.background) = (7, 1.5, 10_000, 0.7, 0.05);
    })
    .lacking([COINCIDENT, coincident], (cubic(), ExtremeScene::Stirred), all_but(SHORT), |_| ())
    .lacking([BULLET, bullet], (cubic(), ExtremeScene::Blocks), all_but(FAST), |s| {
        (s.steps, s.dt) = (200, 0.3);
    })
    .all
}

/// A run of any variant.
struct Extreme {
    method: Method,
    scene: ExtremeScene,
    settings: ExtremeSettings,
}

/// Momentum at the start and the sum of its sizes \[kg/s\], and how far the clock was off.
#[derive(Serialize, Deserialize)]
struct Watch {
    momentum: Vector2<f64>,
    scale: f64,
    late: f64,
}

impl Extreme {
    fn is_resting(&self) -> bool {
        self.scene == ExtremeScene::AtRest
    }

    /// How often its state is sampled.
    fn looks(&self) -> usize {
        if self.is_resting() { 10 } else { 1 }
    }

    /// Steps before a look.
    fn done(&self, look: usize) -> usize {
        (look + 1) * self.settings.steps / self.looks()
    }
}

impl Problem for Extreme {
    type Extra = ();
    type Simulation = dyn Stepper<()>;
    type Watch = Watch;
    const READS_START: bool = true;

    fn method(&self) -> &Method {
        &self.method
    }

    /// No theory has limits for these.
    fn brief(&self) -> Brief {
        let ExtremeSettings { n, steps, dt, .. } = self.settings;
        let rules = Rules { step: Step::given(dt), end: steps as f64 * dt, ..Rules::REFUSED };
        let (medium, particles) = (medium(&self.method, &self.settings), (n * n) as f64);
        let brief = Brief::new(medium, rules, particles, "steps or n").numbers(&[(PLANNED_DT, dt)]);
        Brief { is_limited: false, is_serial: true, ..brief }
    }

    fn not_exported(&self) -> Option<&'static str> {
        Some("its experiments are about this program")
    }

    fn times(&self) -> Vec<f64> {
        (0..self.looks()).map(|look| self.done(look) as f64 * self.settings.dt).collect()
    }

    fn scene(&self) -> Result<Parts, RunError> {
        let scene = match self.scene {
            ExtremeScene::AtRest => at_rest,
            ExtremeScene::Stirred => stirred,
            ExtremeScene::Blocks => blocks,
        };
        Ok(scene(&self.method, &self.settings))
    }

    fn watch(&self, scene: &Snapshot, _: &Snapshot) -> Watch {
        let start = scene.all();
        let scale = start.iter().map(|p| p.mass * p.velocity.norm()).sum();
        Watch { momentum: momentum(&start), scale, late: 0.0 }
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls.at("samples", |extreme, Watch { late, .. }, now, look, _| {
            let Ok(simulation) = now.simulation() else { return };
            let done = extreme.done(look);
            let is_on_time = simulation.work().steps == done as u64;
            let off = (simulation.time() - done as f64 * extreme.settings.dt).abs();
            *late = late.max(if is_on_time { off } else { f64::INFINITY });
        })
    }

    fn measure(&self, watch: Watch, end: &Snapshot, record: &mut Record) {
        let (Watch { momentum: start, scale, late }, end) = (watch, end.all());
        if self.is_resting() {
            record.put(HEAT, fastest(&end));
            record.put(CLOCK_ERROR, late);
        } else {
            let change = (momentum(&end) - start).norm();
            record.put(MOMENTUM_ERROR, if scale > 0.0 { change / scale } else { change });
            record.put(FASTEST, (2.0 * fastest(&end)).sqrt());
        }
    }
}

/// Kinetic energy per mass of the fastest particle \[c₀²\]; NaN stays.
fn fastest(particles: &[Point]) -> f64 {
    largest(particles.iter().map(|p| 0.5 * p.velocity.norm_squared()))
}

/// ρ₀ = c₀ = dx = 1, ν = 0.1.
fn medium(method: &Method, s: &ExtremeSettings) -> Medium {
    let eos = Tait { background: s.background, ..Tait::new(1.0, 1.0) };
    Medium { nu: 0.1, eta2_over_h2: 1e-6, ..method.properties.medium(eos, 1.0, s.h_over_dx) }
}

/// A lattice at rest, for very many steps.
fn at_rest(method: &Method, s: &ExtremeSettings) -> Parts {
    let resting = |_, place| (place, Vector2::zeros());
    torus((s.n as f64, s.n), medium(method, s), resting)
}

/// Two particles at one place, or all but, in a lattice stirred at 0.05 c₀.
fn stirred(method: &Method, s: &ExtremeSettings) -> Parts {
    let mut random = Random::new(5);
    let start = |_, place| (place, Vector2::new(random.normal(), random.normal()) * 0.05);
    let mut parts = torus((10.0, 10), medium(method, s), start);
    let Particle { position, velocity, .. } = parts.particles[33];
    parts.particles[34].position = position + Vector2::new(s.distance, 0.0);
    parts.particles[34].velocity = velocity;
    parts
}

/// A block that hits another.
fn blocks(method: &Method, s: &ExtremeSettings) -> Parts {
    let block = |first, velocity| {
        let places = touchstone_solver::lattice(Vector2::new(first, 0.0), 1.0, 10, 10);
        places.map(move |place| Particle::fluid(place, velocity, 1.0, 1.0))
    };
    let moving = block(-12.0, Vector2::new(s.speed, 0.0));
    let particles = block(0.0, Vector2::zeros()).chain(moving).collect();
    Parts::new(medium(method, s), Domain::open(), particles)
}

/// The runs of a tier.
fn studies(tier: Tier) -> Studies {
    let mut table = Table::new(&EXTREMES, tier);
    table.one((), REST, |_| ());
    table.over((), &[PRESSED], [&[10_000], &[1_000_000]], |s, steps| s.steps = steps);
    table.over((), &[COINCIDENT], [&[0.0, 1e-14]; 2], |s, distance| s.distance = distance);
    // Steps for sound, and steps for the speed of the block.
    table.over((), &[BULLET], [&[(0.3, 200), (1e-4, 2000)]; 2], |s, of| (s.dt, s.steps) = of);
    table.judge(gates);
    Studies::judging(table.plan())
}

/// Gates of a run, with reasons.
fn gates(Row { variant, settings: s, .. }: &Row<ExtremeSettings, ()>) -> Vec<Gate> {
    let gate = |id: &str, metric: MetricKey, bound, evidence, because: &str| {
        Gate::new(format!("extremes.{id}"), String::from(metric), bound, evidence, because)
    };
    let momentum = |id: &str, because| {
        gate(id, MOMENTUM_ERROR, Bound::Below(1e-12), Evidence::Invariant, because)
    };
    match *variant {
        REST | PRESSED => {
            let [energy, time] = ["energy", "time"].map(|what| format!("{variant}.{what}"));
            let cold = "Round-off of forces that cancel must not heat the lattice.";
            let exact = "Time is counted in whole steps, so it does not drift.";
            vec![
                gate(&energy, HEAT, Bound::Below(1e-20), Evidence::Invariant, cold),
                gate(&time, CLOCK_ERROR, Bound::Equals(0.0), Evidence::Invariant, exact),
            ]
        }
        COINCIDENT => vec![momentum(
            &format!("coincident.{:e}", s.distance),
            "No division by the distance 0. The run stays finite for 400 steps, and every pair force has an \
             opposite.",
        )],
        _ => vec![momentum(
            if s.dt < 0.3 { "bullet.its speed" } else { "bullet.sound" },
            "The run stays finite with exact momentum. With time steps for sound the blocks pass through \
             each other without a force, so there only finiteness is judged.",
        )],
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::lattice::tests::judged;

    #[test]
    fn the_quick_tier_survives_its_extremes() {
        let judged = judged(&[&EXTREMES]);
        let names: BTreeSet<&str> = judged.iter().map(|judged| &*judged.gate.id).collect();
        assert_eq!(names.len(), judged.len(), "gates have names of their own");
        for judged in &judged {
            let (id, value) = (&judged.gate.id, judged.judgement.value);
            assert!(!judged.judgement.verdict.is_failure(), "{id}: {value:?}");
        }
    }
}
