//! `verify`: the plans of cases, judged.

use std::time::Instant;

use validation::case::{Case, Tier};
use validation::record::Status;
use validation::report;
use validation::studies;
use validation::suite::{self, Study, Suite, Watch};

use super::{
    Exit, Failure, Outcome, World, arguments,
    judged::{self, Verdicts},
    on_threads, output,
    progress::Bar,
};

pub fn verify(arguments: &arguments::Verify, world: &World) -> Outcome {
    let cases = world.choose(&arguments.cases)?;
    let start = Instant::now();
    let with_method = arguments.cases.is_empty();
    let suite = run(&cases, arguments.tier.into(), with_method, arguments.threads, world)?;
    if arguments.json {
        output::print(&(serde_json::to_string_pretty(&Verdicts::of(&suite))? + "\n"))?;
    } else {
        output::say(&judged::table(suite.judged()));
    }
    let took = report::seconds(start.elapsed().as_secs_f64());
    output::say(&format!("{}, in {took}", judged::in_words(&suite)));
    output::say(&reasons(&suite));
    Ok(exit(&suite))
}

/// 1 if a gate failed.
pub fn exit(suite: &Suite) -> Exit {
    if suite.failures() > 0 { Exit::GateFailed } else { Exit::Pass }
}

/// Runs a suite on a pool, with a bar, and refuses to judge what was interrupted.
pub fn run(
    cases: &[&'static dyn Case],
    tier: Tier,
    with_method: bool,
    threads: Option<u16>,
    world: &World,
) -> Result<Suite, Failure> {
    let of_the_method = with_method.then_some(studies::of_the_method as fn(Tier) -> Vec<Study>);
    let bar = Bar::new(1);
    let show = |done: usize, all: usize, name: &str| bar.show_runs(done, all, name);
    let watch = Watch { progress: Some(&show), interrupt: Some(world.interrupt) };
    let suite = on_threads(threads, || Ok(suite::run(cases, tier, of_the_method, &watch)?));
    bar.clear();
    let suite = suite?;
    if world.is_interrupted() {
        return Err(Failure::interrupted("nothing is judged and nothing is written"));
    }
    Ok(suite)
}

/// Why each failed gate has its bound, and which runs diverged.
fn reasons(suite: &Suite) -> String {
    let mut text = String::new();
    for judged in suite.judged().filter(|j| j.judgement.verdict.is_failure()) {
        text += &format!("{} fails; its bound: {}\n", judged.gate.id, judged.gate.because);
    }
    for run in suite.cases.iter().flat_map(|results| &results.runs) {
        if let Status::Diverged { step, time, .. } = run.record.status {
            let (variant, set) = (run.planned.variant, run.planned.set.join(" "));
            text += &format!(
                "{} {variant} {set}: diverged after {step} steps, at t = {time:.3e} s\n",
                run.case
            );
        }
    }
    text
}
