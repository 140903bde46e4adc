//! How a code behaves: settings, restart, divergence.

use super::{
    Answer, Criterion, Finding, Pose, Question, Ran, Reads, Solved, fit, flows, named, vortices,
};

pub fn settings() -> Question {
    Question {
        id: "settings",
        text: "Change viscosity, sound speed or force: do the bits change?",
        poses: || {
            let channel = |more| {
                let set = ["rows=20", "end=0.02", more];
                Pose::of("poiseuille", "plain", &set).or("extrapolating-wall")
            };
            let [first, viscous, fast] =
                [&["re=100"][..], &["re=200"], &["re=100", "c0=12"]].map(vortices);
            vec![first, viscous, fast, channel("re=0.5"), channel("re=1")]
        },
        answer: Reads::Results(|of| {
            let [first, viscous, fast, weak, strong] = named(of)?;
            let all = [
                ("viscosity", first, viscous),
                ("sound speed", first, fast),
                ("body force", weak, strong),
            ];
            let dead = all.iter().filter(|(_, a, b)| a.end().states == b.end().states);
            let dead: Vec<&str> = dead.map(|(name, ..)| *name).collect();
            let words = match dead.is_empty() {
                true => "each of them changes the results".into(),
                false => format!("nothing changes with the {}", dead.join(", the ")),
            };
            let because = "a setting that changes no bit is not read";
            let count = dead.len() as f64;
            Ok(Finding::new(words, [Criterion::at_most("dead settings", count, 0.0, because)]))
        }),
        finds: &["dead-setting"],
    }
}

pub fn restart() -> Question {
    Question {
        id: "restart",
        text: "Interrupted and continued: the same state?",
        poses: || {
            let whole = vortices(&["re=100"]);
            vec![whole.clone(), Pose { interrupt: Some(0.5), ..whole }]
        },
        answer: Reads::Results(|of| {
            let [whole, interrupted] = named(of)?;
            let (h, domain) = (whole.problem.outline.medium.h, &whole.problem.outline.domain);
            let pairs = whole.end().states.iter().zip(&interrupted.end().states);
            let apart =
                fit::rms(pairs.map(|(a, b)| domain.nearest(b.position - a.position).norm())) / h;
            let is_equal = whole.end().states == interrupted.end().states;
            let words = match is_equal {
                true => "the state has equal bits".into(),
                false => format!("places differ by {apart:.1e} h rms"),
            };
            let because =
                "a complete state is continued with the same bits, or at worst with round-off";
            Ok(Finding::new(words, [Criterion::at_most("distance over h", apart, 1e-10, because)]))
        }),
        finds: &["approximate-restart"],
    }
}

/// Largest change of density of a sound run, over the density.
const MOST_CHANGE: f64 = 0.3;
/// Largest speed of a sound run, over c0.
const MOST_SPEED: f64 = 2.0;

pub fn breaks() -> Question {
    Question {
        id: "breaks",
        text: "Does it stop and say so when it must break?",
        // A mild flow first: a crash says nothing about this flow if that one crashes too. Then twenty times
        // the largest stable step.
        poses: || {
            let set = ["n=16", "perturb=0.2", "re=100", "end=4"];
            vec![flows::mild(), Pose::of("taylor_green", "plain", &set).step(0.2)]
        },
        answer: Reads::Ends(|ran| match ran {
            Ran::Declined(why) => Answer::NotApplicable(why.clone()),
            Ran::Ended { code: Some(code), words } => {
                let words = format!("it stopped with exit code {code}: {words}");
                let because = "a code that cannot go on says so by its exit code";
                let code = Criterion::at_least("exit code", f64::from(*code), 1.0, because);
                Answer::Found(Finding::new(words, [code]))
            }
            Ran::Solved(of) => Answer::Found(remained_sound(of)),
            other => Answer::Failed(other.failure()),
        }),
        finds: &["stuck", "nan"],
    }
}

/// Whether a code that takes a stable step of its own has the results of a flow.
fn remained_sound(of: &Solved) -> Finding {
    let eos = &of.problem.outline.medium.eos;
    let states = || of.moments.iter().flat_map(|at| &at.states);
    let most = |all: &mut dyn Iterator<Item = f64>| all.fold(0.0, f64::max);
    let density =
        most(&mut states().map(|at| at.density.map_or(0.0, |of| (of / eos.density - 1.0).abs())));
    let speed = most(&mut states().map(|at| at.velocity.norm() / eos.sound_speed));
    let words = format!(
        "it completed; its speed reached {speed:.2} c0, its density changed by {density:.2}"
    );
    let because = "a run that ends with exit code 0 is a weakly compressible flow";
    let criteria = [
        Criterion::at_most("change of density", density, MOST_CHANGE, because),
        Criterion::at_most("speed over c0", speed, MOST_SPEED, because),
    ];
    Finding::new(words, criteria)
}
