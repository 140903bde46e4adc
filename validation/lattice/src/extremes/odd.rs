//! Odd sets of particles: at rest for long, on top of each other, alone, as fast as bullets, or not
//! particles at all.

use nalgebra::Vector2;
use solver::{
    Compose, Continuity, CubicSpline, Domain, Kernel, Leapfrog, Open, Outcome, Particle, Pressure,
    Scene, SceneError, Simulation, Tait, Viscosity, WendlandC2,
};

use super::{Entry, sci};
use base::{
    gate::{Bound, Evidence},
    random::Random,
};
use harness::case::Tier;

type Plain<K> = Compose<K, (Pressure<Tait>, Viscosity), Continuity, Open, Leapfrog>;

/// ρ₀ = c₀ = dx = 1; ν = 0.1.
fn scene<K: Kernel>(
    h: f64,
    domain: Domain,
    background: f64,
    particles: Vec<Particle>,
) -> Scene<Plain<K>> {
    let eos = Tait { background, ..Tait::new(1.0, 1.0) };
    let forces = (Pressure::new(eos), Viscosity { mu: 0.1, eta2: 1e-6 * h * h });
    let mut scene = Scene::new(h, domain, particles, forces, Continuity, Open);
    scene.parallel_from = usize::MAX;
    scene
}

fn resting(place: Vector2<f64>) -> Particle {
    Particle::fluid(place, Vector2::zeros(), 1.0, 1.0)
}

fn torus(n: usize) -> (Domain, Vec<Particle>) {
    let places = solver::lattice(Vector2::repeat(0.5), 1.0, n, n);
    (Domain::torus(n as f64, n as f64), places.map(resting).collect())
}

/// Kinetic energy per mass of the fastest particle \[c₀²\]; NaN stays.
fn fastest(particles: &[Particle]) -> f64 {
    let all = particles.iter().map(|p| 0.5 * p.velocity.norm_squared());
    all.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
}

/// Σ m v over Σ m |v|, or 0 if nothing moves.
fn momentum(particles: &[Particle], initial: Vector2<f64>) -> f64 {
    let total = particles.iter().fold(-initial, |sum, p| sum + p.velocity * p.mass);
    let scale: f64 = particles.iter().map(|p| p.mass * p.velocity.norm()).sum();
    if scale > 0.0 { total.norm() / scale } else { total.norm() }
}

/// A lattice at rest for very many steps, without and with background pressure.
pub fn rest(tier: Tier) -> Vec<Entry> {
    let pressed = if tier == Tier::Full { 1_000_000 } else { 10_000 };
    let mut entries = rest_of::<CubicSpline>("rest", 1.2, [5, 100_000], 0.0);
    // Positive pressure pairs particles of a cubic spline, not those of a Wendland function.
    entries.extend(rest_of::<WendlandC2>("pressed", 1.5, [7, pressed], 0.05));
    entries
}

fn rest_of<K: Kernel>(name: &str, h: f64, [n, steps]: [usize; 2], background: f64) -> Vec<Entry> {
    let setting = format!("{steps} steps, p = {background} ρc₀², {}, h/dx = {h}", K::NAME);
    let what = |what: &str| [what.to_string(), setting.clone()];
    let energy = Entry::new(&format!("{name}.energy"), what("lattice at rest"), "½v²/c₀²", {
        Bound::Below(1e-20)
    })
    .because(Evidence::Invariant, "round-off of forces that cancel must not heat the lattice");
    let time = Entry::new(&format!("{name}.time"), what("clock of a long run"), "|t - n dt|", {
        Bound::Equals(0.0)
    })
    .because(Evidence::Invariant, "the time is counted in whole steps, so it does not drift");
    let (domain, particles) = torus(n);
    let Ok(mut simulation) = scene::<K>(h, domain, background, particles).build() else {
        return vec![energy, time];
    };
    let dt = 0.7;
    let mut late = 0.0f64;
    for k in 1..=10 {
        let until = (k * steps / 10) as f64 * dt;
        let outcome = simulation.advance(until, dt, &mut ());
        let on_time = outcome == Outcome::Reached
            && simulation.work().steps == (k * steps / 10) as u64
            && simulation.time() == until;
        late = late.max(if on_time { 0.0 } else { f64::INFINITY });
    }
    let heat = fastest(&simulation.particles());
    let clock = format!("t = {} after {} steps", simulation.time(), simulation.work().steps);
    vec![energy.found(heat, sci(heat)), time.found(late, clock)]
}

/// Runs `steps` steps of 0.5 h/c₀.
fn advance<K: Kernel>(simulation: &mut Simulation<Plain<K>>, steps: u32) -> Outcome {
    let dt = 0.5 * simulation.kernel().h();
    simulation.advance(dt * f64::from(steps), dt, &mut ())
}

/// Two particles at one place, or all but, in a lattice stirred at 0.05 c₀.
pub fn coincident(_tier: Tier) -> Vec<Entry> {
    let run = |distance: f64| {
        let what = ["two particles at one place".into(), format!("distance {} dx", sci(distance))];
        let name = format!("coincident.{distance:e}");
        let entry = Entry::new(&name, what, "momentum error/Σm|v|", Bound::Below(1e-12)).because(
            Evidence::Invariant,
            "no 0/0: finite for 400 steps, and every pair force has its opposite",
        );
        let (domain, mut particles) = torus(10);
        let mut random = Random::new(5);
        for particle in &mut particles {
            particle.velocity = Vector2::new(random.normal(), random.normal()) * 0.05;
        }
        particles[34].position = particles[33].position + Vector2::new(distance, 0.0);
        particles[34].velocity = particles[33].velocity;
        let initial = particles.iter().fold(Vector2::zeros(), |sum, p| sum + p.velocity * p.mass);
        let scale: f64 = particles.iter().map(|p| p.mass * p.velocity.norm()).sum();
        let Ok(mut simulation) = scene::<CubicSpline>(1.2, domain, 0.0, particles).build() else {
            return entry;
        };
        let outcome = advance(&mut simulation, 400);
        let particles = simulation.particles();
        let apart = (particles[33].position - particles[34].position).norm();
        let error = (simulation.momentum() - initial).norm() / scale;
        let speed = (2.0 * fastest(&particles)).sqrt();
        match outcome {
            Outcome::Reached if speed.is_finite() => {
                let found =
                    format!("{}; fastest {} c₀, {} dx apart", sci(error), sci(speed), sci(apart));
                entry.found(error, found)
            }
            other => entry.found(f64::NAN, format!("{other:?}")),
        }
    };
    [0.0, 1e-14].map(run).into()
}

/// One particle, and several out of each other's reach.
pub fn alone(_tier: Tier) -> Vec<Entry> {
    let run = |count: usize| {
        let what =
            ["particles without neighbours".to_string(), format!("{count} in an open domain")];
        let name = format!("alone.{count}");
        let entry =
            Entry::new(&name, what, "distance from x₀ + v t over |v t|", Bound::Below(1e-12))
                .because(Evidence::Analytic, "free flight; density stays, for nothing changes it");
        let velocity = Vector2::new(0.3, -0.7);
        let places: Vec<_> = (0..count).map(|k| Vector2::new(50.0 * k as f64, k as f64)).collect();
        let particles = places.iter().map(|&x| Particle::fluid(x, velocity, 1.0, 1.0)).collect();
        let Ok(mut simulation) = scene::<CubicSpline>(1.2, Domain::open(), 0.0, particles).build()
        else {
            return entry;
        };
        let outcome = advance(&mut simulation, 1000);
        let flown = velocity * simulation.time();
        let off = |(p, x): (&Particle, &Vector2<f64>)| {
            (p.position - x - flown).norm() / flown.norm() + (p.density - 1.0).abs()
        };
        let particles = simulation.particles();
        let worst = particles.iter().zip(&places).map(off).fold(0.0, f64::max);
        let value = if outcome == Outcome::Reached { worst } else { f64::NAN };
        entry.found(value, format!("{} after 1000 steps", sci(worst)))
    };
    [1, 4].map(run).into()
}

/// A block that hits another at 1000 c₀, with steps for sound and with steps for its speed.
pub fn fast_blocks(_tier: Tier) -> Vec<Entry> {
    let run = |(name, step, steps): (&str, f64, u32)| {
        let what = ["block at 1000 c₀".to_string(), format!("open domain, dt for {name}")];
        let metric = "momentum error/Σm|v|, 0 if it says so";
        let entry = Entry::new(&format!("bullet.{name}"), what, metric, Bound::Below(1e-12))
            .because(
                Evidence::Invariant,
                "finite with exact momentum, or a typed divergence: never NaN, never a hang. With steps for \
                 sound the blocks pass through each other unseen, so there it is finiteness alone",
            );
        let at_rest = solver::lattice(Vector2::zeros(), 1.0, 10, 10).map(resting);
        let moving = solver::lattice(Vector2::new(-12.0, 0.0), 1.0, 10, 10)
            .map(|place| Particle { velocity: Vector2::new(1000.0, 0.0), ..resting(place) });
        let particles: Vec<Particle> = at_rest.chain(moving).collect();
        let initial = particles.iter().fold(Vector2::zeros(), |sum, p| sum + p.velocity * p.mass);
        let Ok(mut simulation) = scene::<CubicSpline>(1.2, Domain::open(), 0.0, particles).build()
        else {
            return entry;
        };
        let outcome = simulation.advance(step * f64::from(steps), step, &mut ());
        let particles = simulation.particles();
        let fastest = fastest(&particles);
        match outcome {
            Outcome::Diverged(divergence) => entry.found(0.0, divergence.to_string()),
            _ if !fastest.is_finite() => entry.found(f64::NAN, "not finite".into()),
            _ => {
                let value = momentum(&particles, initial);
                let found =
                    format!("momentum to {}, fastest {:.0} c₀", sci(value), (2.0 * fastest).sqrt());
                entry.found(value, found)
            }
        }
    };
    vec![run(("sound", 0.3, 200)), run(("its speed", 1e-4, 2000))]
}

/// What is not a particle is refused before the first step.
pub fn refused(_tier: Tier) -> Vec<Entry> {
    let build = |particles: Vec<Particle>, domain| {
        scene::<CubicSpline>(1.2, domain, 0.0, particles).build().err()
    };
    let odd = |change: fn(&mut Particle)| {
        let (domain, mut particles) = torus(10);
        change(&mut particles[7]);
        build(particles, domain)
    };
    let is_seventh = |error: &Option<SceneError>| {
        matches!(error, Some(SceneError::Particle { particle: 7, .. }))
    };
    let [narrow, few] = [torus(10).1, Vec::new()];
    let refusals = [
        is_seventh(&odd(|p| p.position.x = f64::NAN)),
        is_seventh(&odd(|p| p.velocity.y = f64::INFINITY)),
        is_seventh(&odd(|p| p.mass = -1.0)),
        is_seventh(&odd(|p| p.density = 0.0)),
        matches!(
            build(narrow, Domain::torus(4.0, 10.0)),
            Some(SceneError::PeriodTooShort { axis: 'x', .. })
        ),
        matches!(build(few, Domain::open()), Some(SceneError::Empty)),
    ];
    let count = refusals.iter().filter(|refused| **refused).count() as f64;
    let setting =
        "NaN place, infinite speed, negative mass, no density, period of 4 dx, no particle";
    let what = ["what is not a scene".to_string(), setting.into()];
    let because = "each with its reason, by type, before the first step";
    let entry = Entry::new("refused", what, "refusals", Bound::Equals(6.0));
    vec![entry.because(Evidence::Invariant, because).found(count, format!("{count} of 6 refused"))]
}
