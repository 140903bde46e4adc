//! A battery of exact symmetries: the particles of another observer after a few steps equal ours up to
//! round-off. It needs no reference, and judges our own runs and other codes alike.

use nalgebra::Vector2;
use touchstone_base::{record::Profile, spec::RunSpec};

use crate::{
    case::{Case, RunError},
    context::Context,
    foreign::{ForeignParticle, Frame},
    outline::Outline,
    problem::Steps,
    relation::{DENSITY, Relation, TIME},
    size::Size,
};

/// The largest difference between the particles of two observers, relative to round-off.
#[derive(Clone, Debug)]
pub struct Difference {
    /// The time as the first of them has it \[s\].
    pub time: f64,
    /// The difference, of a place \[h\], a velocity \[c0\] or a density \[ρ0\]; NaN if particles are missing.
    pub value: f64,
    /// The bound by round-off.
    pub floor: f64,
    /// The quantity with the difference.
    pub quantity: &'static str,
    /// The number of the particle, as the first observer has it.
    pub particle: u32,
}

impl Difference {
    /// Is it no more than round-off?
    pub fn is_round_off(&self) -> bool {
        self.value <= self.floor
    }

    /// The larger one against its floor, if one of them is not a number that one.
    fn or(self, other: Self) -> Self {
        let over = |of: &Self| of.value / of.floor;
        if over(&self) >= over(&other) || self.value.is_nan() { self } else { other }
    }
}

/// The problem in the frame of an observer, and the particles at its times, or at more.
pub type ObservedRun<'a> = (&'a Outline, &'a [Frame]);

fn moves(outline: &Outline) -> Vec<bool> {
    outline.particles.column("role").iter().map(|role| *role == 0.0).collect()
}

/// Moving particles at the k-th of the times of the problem, transformed back to the first frame and sorted
/// by their ids there.
fn in_own_frame((outline, frames): ObservedRun, k: usize) -> Vec<ForeignParticle> {
    let (view, moves) = (&outline.view, moves(outline));
    let (numbers, time) = (view.numbers(&moves), outline.times[k]);
    let apart = |frame: &&Frame| (frame.time - time).abs();
    let nearest = frames.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
    let back = |placed: &ForeignParticle| {
        let of = [placed.position, placed.velocity];
        let [position, velocity] = view.back(time / view.scale(TIME), of);
        let density = placed.density.map(|density| density / view.scale(DENSITY));
        ForeignParticle { id: numbers[placed.id as usize] as u32, position, velocity, density }
    };
    let all = nearest.into_iter().flat_map(|frame| &frame.particles);
    let moving = all.filter(|placed| moves.get(placed.id as usize) == Some(&true));
    let mut all: Vec<_> = moving.map(back).collect();
    all.sort_by_key(|placed| placed.id);
    all
}

/// The bound of round-off over consecutive steps: a step rounds place, velocity and density, in the units h,
/// c0 and ρ0 by ε times their size; with a step of at most h/c0, an error of a force becomes no larger error
/// of a velocity. Errors of velocities add up, so after n steps places differ by at most n² times this, as
/// long as the motion itself does not amplify it.
fn rounding(outline: &Outline) -> f64 {
    let (h, c0) = (outline.medium.h, outline.medium.sound_speed);
    let all = [("x", h), ("y", h), ("u", c0), ("v", c0)].into_iter();
    let sizes = all.flat_map(|(name, unit)| {
        outline.particles.column(name).iter().map(move |value| (value / unit).abs())
    });
    f64::EPSILON * sizes.fold(1.0, f64::max)
}

/// The bound of round-off after this number of steps.
pub fn floor(base: &Outline, other: &Outline, steps: f64) -> f64 {
    rounding(base).max(rounding(other)) * steps * steps
}

/// A difference below which a relation must find errors: with a larger floor it tests nothing.
const TELLING: f64 = 1e-6;

/// The most steps after which round-off explains no difference that a relation must find.
pub fn most_steps(base: &Outline, other: &Outline) -> f64 {
    (TELLING / floor(base, other, 1.0)).sqrt().floor()
}

/// Periods beyond which a place has too few digits left within its period to be compared.
const MOST_PERIODS: f64 = (1_u64 << 20) as f64;

/// A place that is too far from its period to be compared.
pub struct FarPlace {
    /// Number of its frame.
    pub frame: usize,
    /// Number of its particle in the frame.
    pub row: usize,
    /// The place in words.
    pub words: String,
}

/// The first place that is too far away.
pub fn far_away((outline, frames): ObservedRun) -> Option<FarPlace> {
    let places = frames.iter().enumerate().flat_map(|(k, frame)| {
        frame.particles.iter().enumerate().map(move |(row, placed)| (k, row, frame.time, placed))
    });
    places.into_iter().find_map(|(k, row, time, placed)| {
        let is_far = |axis: &usize| {
            outline.domain.period[*axis].is_some_and(|period| {
                let apart = placed.position[*axis] - outline.domain.low[*axis];
                !apart.is_finite() || apart.abs() > MOST_PERIODS * period
            })
        };
        let axis = [0, 1].into_iter().find(is_far)?;
        let words = format!(
            "particle {} is at {} = {:e} m at t = {time} s; at most {MOST_PERIODS} periods from its box, a \
             place has the digits to be compared",
            placed.id,
            ["x", "y"][axis],
            placed.position[axis]
        );
        Some(FarPlace { frame: k, row, words })
    })
}

/// Compares two observers of one problem, the first in the original frame. `steps` is the number of steps to
/// the last time.
pub fn difference(base: ObservedRun, other: ObservedRun, steps: f64) -> Difference {
    let Outline { medium, times, domain, .. } = base.0;
    let near = |apart: Vector2<f64>| domain.nearest(apart).amax() / medium.h;
    let size = floor(base.0, other.0, 1.0);
    let (quantity, particle) = ("place", 0);
    let mut worst = Difference { time: 0.0, value: 0.0, floor: size, quantity, particle };
    for (k, &time) in times.iter().enumerate() {
        let floor = size * (steps * time / times[times.len() - 1]).powi(2);
        let (ours, theirs) = (in_own_frame(base, k), in_own_frame(other, k));
        let ids = |all: &[ForeignParticle]| all.iter().map(|placed| placed.id).collect::<Vec<_>>();
        if ours.is_empty() || ids(&ours) != ids(&theirs) {
            // One run diverged.
            worst = Difference { time, value: f64::NAN, floor, ..worst }.or(worst);
        }
        for (a, b) in ours.iter().zip(&theirs) {
            let density = a.density.zip(b.density).map_or(0.0, |(a, b)| (a - b).abs());
            let velocity = (a.velocity - b.velocity).amax() / medium.sound_speed;
            for (quantity, value) in [
                ("place", near(a.position - b.position)),
                ("velocity", velocity),
                ("density", density / medium.density),
            ] {
                worst = worst.or(Difference { time, value, floor, quantity, particle: a.id });
            }
        }
    }
    worst
}

/// The problem and the particles of our own run of a spec in the frame of an observer; no particles if it
/// diverged.
fn seen(case: &dyn Case, spec: &RunSpec, by: Relation) -> Result<(Outline, Vec<Frame>), RunError> {
    let mut frames = Vec::new();
    let mut at_time = |time: f64, particles: Profile| {
        let of = |name, k: usize| particles.column(name)[k];
        let placed = |k| ForeignParticle {
            id: k as u32,
            position: Vector2::new(of("x", k), of("y", k)),
            velocity: Vector2::new(of("u", k), of("v", k)),
            density: Some(of("density", k)),
        };
        let particles = (0..particles.column("id").len()).map(placed).collect();
        frames.push(Frame { time, particles });
    };
    let context = Context { spec: spec.clone(), allow_long: true, ..Context::default() };
    let outline = case.pose(spec)?.seen_by(by, &context, &mut at_time)?;
    Ok((outline, frames))
}

/// Memory of the particles of two observers at three times, over the stored data of a particle in one step.
const KEPT: f64 = 3.0;

/// The total cost of the batteries of runs without refused ones: all relations in sequence, and the particles
/// of all specs at once.
pub fn size(specs: &[(&dyn Case, RunSpec)]) -> Size {
    let (mut all, relations) = (Size::new(0.0, 0.0, 0.0), Relation::ALL.len() as f64);
    for (case, spec) in specs {
        let spec = spec.clone().allow_unstable();
        let posed = case.pose(&spec);
        let size = posed.and_then(|posed| posed.size(&spec, Steps::Early, true));
        let Ok(size) = size else { continue };
        all.steps = all.steps.max(relations * size.steps);
        all.particles += size.particles;
        all.neighbours = all.neighbours.max(size.neighbours);
        all.sweeps = all.sweeps.max(size.sweeps);
        all.samples += KEPT * size.particles;
    }
    all
}

/// Parts of a state with a square below this \[-\] underflow, in one unit and not in another.
const UNDERFLOW: f64 = 1e-150;

/// Result of a relation: the largest difference, or why it does not apply.
pub type RelationResult = (Relation, Result<Difference, RunError>);

/// Results of all relations for our own run of a spec. Relations that round nothing must give equal bits, up
/// to underflow.
///
/// # Errors
/// If the run is refused or has no scene.
pub fn battery(case: &dyn Case, spec: &RunSpec) -> Result<Vec<RelationResult>, RunError> {
    // A relation is tested at a few early times, which a scene passes even if it fails later.
    let spec = &spec.clone().allow_unstable();
    let (base, frames) = seen(case, spec, Relation::Same)?;
    let steps = base.times.last().map_or(0.0, |end| (end / base.dt).round());
    let has_walls = moves(&base).contains(&false);
    let of = |relation: Relation| {
        let (outline, theirs) = seen(case, spec, relation)?;
        let found = difference((&base, &frames), (&outline, &theirs), steps);
        let is_bitwise = relation.is_bitwise(has_walls);
        Ok(Difference { floor: if is_bitwise { UNDERFLOW } else { found.floor }, ..found })
    };
    Ok(Relation::ALL[1..].iter().map(|relation| (*relation, of(*relation))).collect())
}
