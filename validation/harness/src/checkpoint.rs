//! Checkpoints: the complete state of a run, as bytes from which it continues with equal bits.
//!
//! To continue, a run starts as always: it makes its scene and its observers. Then it restores the states of
//! simulation and observers from the checkpoint, so that no case knows whether its run continues.

use std::time::Duration;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use touchstone_base::{files::FileError, record::Cost};
use touchstone_solver::{
    Checkpoint, Interval, Numbers, Particle, PreviousStep, Progress, Role, Stepper, Symmetric, Work,
};

use crate::error::RunError;

/// A simulation and everything observed of it. Only the build that wrote the bytes can read them, because
/// they name no fields.
#[derive(Serialize, Deserialize)]
struct Stored {
    state: StoredState,
    stage: Stage,
    /// The watch of the case with its record, as bytes.
    seen: Vec<u8>,
}

/// The progress of a simulation, without particles and observations.
#[derive(Default, Serialize, Deserialize)]
pub(crate) struct Stage {
    /// How many of its times were reached.
    pub reached: usize,
    /// Cost so far.
    #[serde(with = "as_json")]
    pub cost: Cost,
    /// The frames of it by time \[s\], and how many were tried.
    pub frames: Option<(Vec<(f64, String)>, usize)>,
}

/// The state of a simulation: a [`Checkpoint`] whose extra fields are reduced to deviatoric stresses.
#[derive(Serialize, Deserialize)]
struct StoredState {
    #[serde(with = "ProgressFields")]
    progress: Progress,
    lag: f64,
    /// Number in the scene, the particle, where it was when the neighbour lists were built \[m\].
    particles: Vec<(u32, StoredParticle, Vector2<f64>)>,
    past: Vec<StoredStep>,
}

/// The components xx, yy and xy of a deviatoric stress, absent for a fluid \[Pa\].
type Stress = Option<[f64; 3]>;

#[derive(Serialize, Deserialize)]
struct StoredParticle {
    #[serde(with = "RoleNames")]
    role: Role,
    position: Vector2<f64>,
    velocity: Vector2<f64>,
    density: f64,
    mass: f64,
    stress: Stress,
}

#[derive(Serialize, Deserialize)]
struct StoredStep {
    drifted: (f64, Stress),
    rate: (f64, Stress),
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Progress")]
struct ProgressFields {
    time: f64,
    dt: f64,
    #[serde(with = "WorkFields")]
    work: Work,
    last_approach: f64,
    built_inside_a_step: bool,
    #[serde(with = "IntervalFields")]
    call: Interval,
    made: u64,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Work")]
struct WorkFields {
    steps: u64,
    pair_interactions: u64,
    right_hand_sides: u64,
    list_builds: u64,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Interval")]
struct IntervalFields {
    start: f64,
    until: f64,
    dt_max: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Role")]
pub(crate) enum RoleNames {
    Fluid,
    Wall,
    Interface,
}

fn stress<X: Numbers>(extra: &X) -> Stress {
    extra.stress().map(Symmetric::components)
}

fn extra<X: Numbers>(stress: Stress) -> X {
    stress.map_or_else(X::default, |[xx, yy, xy]| X::of_stress(Symmetric { xx, yy, xy }))
}

impl StoredParticle {
    fn of<X: Numbers>(particle: &Particle<X>) -> Self {
        let &Particle { role, position, velocity, density, mass, extra } = particle;
        Self { role, position, velocity, density, mass, stress: stress(&extra) }
    }

    fn particle<X: Numbers>(self) -> Particle<X> {
        let Self { role, position, velocity, density, mass, stress } = self;
        Particle { role, position, velocity, density, mass, extra: extra(stress) }
    }
}

impl StoredState {
    fn of<X: Numbers>(checkpoint: &Checkpoint<X>) -> Self {
        let Checkpoint { progress, lag, particles, built_at, past } = checkpoint;
        let particles = particles.iter().zip(built_at);
        let particles = particles.map(|((id, p), at)| (*id, StoredParticle::of(p), *at)).collect();
        let earlier = |(density, extra): &(f64, X)| (*density, stress(extra));
        let past = past.iter().map(|PreviousStep { drifted, rate }| StoredStep {
            drifted: earlier(drifted),
            rate: earlier(rate),
        });
        Self { progress: *progress, lag: *lag, particles, past: past.collect() }
    }

    fn checkpoint<X: Numbers>(self) -> Checkpoint<X> {
        let Self { progress, lag, particles: stored, past } = self;
        let (mut particles, mut built_at) = (Vec::new(), Vec::new());
        for (id, particle, at) in stored {
            particles.push((id, particle.particle()));
            built_at.push(at);
        }
        let earlier = |(density, stress): (f64, Stress)| (density, extra(stress));
        let past = past.into_iter().map(|StoredStep { drifted, rate }| PreviousStep {
            drifted: earlier(drifted),
            rate: earlier(rate),
        });
        Checkpoint { progress, lag, particles, built_at, past: past.collect() }
    }
}

/// A document in a checkpoint, as its JSON: the binary format has no values of any type and no fields that
/// are left out.
pub(crate) mod as_json {
    use serde::{
        Deserialize, Deserializer, Serialize, Serializer,
        de::{DeserializeOwned, Error as _},
        ser::Error as _,
    };

    pub fn serialize<T: Serialize, S: Serializer>(document: &T, to: S) -> Result<S::Ok, S::Error> {
        serde_json::to_string(document).map_err(S::Error::custom)?.serialize(to)
    }

    pub fn deserialize<'a, T: DeserializeOwned, D: Deserializer<'a>>(
        from: D,
    ) -> Result<T, D::Error> {
        serde_json::from_str(&String::deserialize(from)?).map_err(D::Error::custom)
    }
}

/// Reads a value from all of the bytes. A stated length allocates no more memory than the bytes have.
///
/// # Errors
/// If they hold something else, less or more.
pub(crate) fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, RunError> {
    let (value, rest) = postcard::take_from_bytes(bytes)?;
    if rest.is_empty() { Ok(value) } else { Err(RunError::Checkpoint("more bytes than it needs")) }
}

/// A simulation and its observations, as bytes.
pub(crate) fn save<X: Numbers>(
    simulation: &dyn Stepper<X>,
    stage: Stage,
    seen: Vec<u8>,
) -> Result<Vec<u8>, RunError> {
    if size_of::<X>() > 0 && X::default().stress().is_none() {
        return Err(RunError::Checkpoint(
            "particles with other extra fields than a deviatoric stress",
        ));
    }
    let state = StoredState::of(&simulation.checkpoint());
    Ok(postcard::to_allocvec(&Stored { state, stage, seen })?)
}

/// Restores a simulation; returns its stage and the serialised observations.
pub(crate) fn restore<X: Numbers>(
    bytes: &[u8],
    simulation: &mut dyn Stepper<X>,
) -> Result<(Stage, Vec<u8>), RunError> {
    let Stored { state, stage, seen } = read(bytes)?;
    simulation.restore(&state.checkpoint()).map_err(RunError::Checkpoint)?;
    Ok((stage, seen))
}

/// Writes the bytes of a checkpoint.
pub type Write<'a> = &'a (dyn Fn(&[u8]) -> Result<(), FileError> + Sync);

/// The checkpoints of one run.
pub struct Checkpoints<'a> {
    /// Wall time from one to the next.
    pub every: Duration,
    /// The checkpoint from which the run continues; none if it begins.
    pub earlier: Option<Vec<u8>>,
    /// Writes a checkpoint in place of the one before.
    pub write: Write<'a>,
}

#[cfg(test)]
mod tests {
    use touchstone_base::{
        number,
        record::{MetricKey, Record},
    };

    use super::*;

    #[derive(Debug, Default, Serialize, Deserialize)]
    struct Odd {
        numbers: Vec<f64>,
        text: Option<String>,
        counts: [(usize, bool); 2],
        #[serde(with = "as_json")]
        record: Record,
    }

    fn odd() -> Odd {
        let numbers = [0.1, -0.0, f64::MIN_POSITIVE / 8.0, f64::NAN, -f64::NAN, f64::NEG_INFINITY];
        let mut record = Record::new("case", "variant", serde_json::json!({"n": 8, "x": 1.0}), 1);
        record.numerics.insert("odd".into(), number::json(f64::INFINITY));
        record.put(MetricKey::new("m", "-", "1/3"), 1.0 / 3.0);
        let (text, counts) = (Some("µ".into()), [(usize::MAX, true), (0, false)]);
        Odd { numbers: numbers.to_vec(), text, counts, record }
    }

    #[test]
    fn a_value_keeps_its_bits_and_less_or_more_than_it_is_refused() {
        let (before, mut bytes) = (odd(), postcard::to_allocvec(&odd()).unwrap());
        let after: Odd = read(&bytes).expect("all bytes are there");
        let bits = |odd: &Odd| odd.numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&after), bits(&before), "numbers");
        assert_eq!((&after.text, after.counts), (&before.text, before.counts));
        assert_eq!(after.record, before.record);
        for length in 0..bytes.len() {
            let part = read::<Odd>(&bytes[..length]);
            assert!(part.is_err(), "{length} of {} bytes give {part:?}", bytes.len());
        }
        bytes.push(0);
        assert!(read::<Odd>(&bytes).is_err(), "a byte more");
    }

    #[test]
    fn bytes_of_no_value_are_refused_before_memory_is_taken() {
        let endless = postcard::to_allocvec(&u64::MAX).unwrap();
        assert!(read::<Vec<f64>>(&endless).is_err(), "a list longer than its bytes");
        assert!(read::<Vec<(u32, StoredParticle, Vector2<f64>)>>(&endless).is_err(), "particles");
        assert!(read::<bool>(&[2]).is_err(), "neither true nor false");
        assert!(read::<String>(&[1, 0xFF]).is_err(), "no UTF-8");
        #[derive(Deserialize)]
        struct OfRole(#[serde(with = "RoleNames")] Role);
        assert!(matches!(read(&[1]), Ok(OfRole(Role::Wall))));
        assert!(read::<OfRole>(&[3]).is_err(), "no role");
    }
}
