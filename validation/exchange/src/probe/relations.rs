//! One problem in two reference frames: the results agree to round-off, whatever the method.

use touchstone_harness::{relation::Relation, symmetry};

use super::{Criterion, Finding, NotApplicable, Pose, Question, Reads, Solved, named};

/// The difference of results for two frames, the first of them ours, over what round-off explains, and its
/// place in words.
fn apart(ours: &Solved, other: &Solved) -> Result<(f64, String), NotApplicable> {
    let mut steps: f64 = 1.0;
    for of in [ours, other] {
        let outline = &of.problem.outline;
        if let Some(few) = of.entry.few_digits(&of.problem) {
            return Err(format!("frames are compared to round-off, which needs all digits: {few}"));
        }
        if let Some(far) = symmetry::far_away((outline, &of.entry.results.frames)) {
            return Ok((f64::NAN, far.words));
        }
        steps = steps.max(of.entry.steps(&of.problem));
    }
    let most = symmetry::most_steps(&ours.problem.outline, &other.problem.outline);
    if steps > most {
        return Err(format!(
            "after {steps} steps round-off explains any difference; at most {most} can be compared"
        ));
    }
    let [ours, other] = [ours, other].map(|of| (&of.problem.outline, &*of.entry.results.frames));
    let found = symmetry::difference(ours, other, steps);
    let place =
        format!("{} of particle {} at t = {} s", found.quantity, found.particle, found.time);
    Ok((found.value / found.floor, place))
}

/// The answer for results that are compared with the first ones.
fn agree(of: &[&Solved]) -> Result<Finding, NotApplicable> {
    let (mut worst, mut words) = (0.0_f64, "equal to round-off".to_string());
    let (first, others) = of.split_first().ok_or("the question has no problem")?;
    for other in others {
        let (over, place) = apart(first, other)?;
        if over.is_nan() || over > 1.0 {
            words = format!("differs: {place}");
        }
        worst = if over.is_nan() { f64::NAN } else { worst.max(over) };
    }
    let because =
        "the equations have the symmetry, so only round-off may differ: ε n² after n steps";
    Ok(Finding::new(words, [Criterion::at_most("difference over round-off", worst, 1.0, because)]))
}

/// Vortices on disordered particles.
pub fn vortices(by: Relation) -> Pose {
    Pose::of("taylor_green", "plain", &["n=16", "perturb=0.2"]).seen(by)
}

pub fn units() -> Question {
    Question {
        id: "units",
        text: "Other units, same flow?",
        poses: || {
            // A density of 1 kg/m³ is 0.06 lb/ft³: an absolute floor shows.
            let set = ["n=16", "rho=1", "jitter=0.1", "amplitude=0.05", "nu=0.01"];
            let wave = Pose::of("shear_wave", "cubic-leapfrog", &set);
            vec![wave.seen(Relation::Same), wave.seen(Relation::OtherUnits)]
        },
        answer: Reads::Results(agree),
        finds: &["density-floor"],
    }
}

pub fn mirrored() -> Question {
    Question {
        id: "mirrored",
        text: "Mirrored: the same flow?",
        poses: || vec![vortices(Relation::Same), vortices(Relation::Mirrored)],
        answer: Reads::Results(agree),
        finds: &["mirror"],
    }
}

pub fn boosted() -> Question {
    Question {
        id: "boosted",
        text: "In a moving frame of reference: the same flow?",
        poses: || vec![vortices(Relation::Same), vortices(Relation::Boosted)],
        answer: Reads::Results(agree),
        finds: &["absolute-velocity"],
    }
}

pub fn shifted() -> Question {
    Question {
        id: "shifted",
        text: "The periodic border elsewhere: the same flow?",
        poses: || vec![vortices(Relation::Same), vortices(Relation::Shifted)],
        answer: Reads::Results(agree),
        finds: &["border"],
    }
}

pub fn turned() -> Question {
    Question {
        id: "turned",
        text: "Turned by 37°: the same motion of colliding solids?",
        poses: || {
            let rings = Pose::of("rubber_rings", "lagrangian", &["spacing=0.25", "centre=4.12"]);
            vec![rings.seen(Relation::Same), rings.seen(Relation::Turned)]
        },
        answer: Reads::Results(agree),
        finds: &["componentwise-stress"],
    }
}

pub fn numbers() -> Question {
    Question {
        id: "numbers",
        text: "Numbered otherwise, and again on two threads: the same flow?",
        poses: || {
            let same = vortices(Relation::Same);
            let threads = Pose { threads: Some(2), ..same.clone() };
            vec![same, vortices(Relation::Renumbered), threads]
        },
        answer: Reads::Results(|of| {
            let found = agree(of)?;
            let [once, _, again] = named(of)?;
            let bits = match once.moments == again.moments {
                true => "a second run on two threads has equal bits",
                false => "a second run on two threads has other bits",
            };
            let diagnosis = format!("{}; {bits}", found.diagnosis);
            Ok(Finding { diagnosis, ..found })
        }),
        finds: &["race", "order-of-numbers"],
    }
}
