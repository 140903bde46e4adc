//! `doctor`: the build of this program, and a check that it works here.

use std::time::Instant;

use touchstone_base::files::OutputFolder;
use touchstone_base::manifest::Manifest;
use touchstone_base::reference::Reference;
use touchstone_harness::{case, context::Context};
use touchstone_schemes::bench;

use super::{Exit, Failure, Outcome, Session, arguments, on_threads, output};

pub fn doctor(arguments: &arguments::Doctor, session: &Session) -> Outcome {
    let manifest = Manifest::of_this_process(rayon::current_num_threads());
    output::print(&about(&manifest, arguments.verbose))?;
    let (mut is_sound, mut can_write) = (true, true);
    for (what, check) in [
        ("references", references as fn(&arguments::Doctor, &Session) -> Result<String, Failure>),
        ("writing", writing),
        ("self-check", self_check),
    ] {
        let (mark, words) = match check(arguments, session) {
            Ok(words) => ("ok  ", words),
            Err(Failure { reason, .. }) => {
                match what {
                    "writing" => can_write = false, // a folder of the user is not a bug
                    _ => is_sound = false,
                }
                ("FAIL", reason)
            }
        };
        output::print(&format!("{what:<11} {mark} {words}\n"))?;
        session.go_on("the checks are not complete; the same command begins again")?;
    }
    if !is_sound {
        return Err(Failure::bug("a check of doctor failed, see above"));
    }
    if arguments.bench {
        bench(session)?;
    }
    Ok(if can_write { Exit::Pass } else { Exit::Usage })
}

fn about(manifest: &Manifest, is_verbose: bool) -> String {
    let Manifest { touchstone, rustc, profile, opt_level, target, .. } = manifest;
    let advice = if profile == "release" { "" } else { " (cargo build --release is faster)" };
    let compiler = rustc.split(" (").next().unwrap_or_default();
    let [mut build, mut processor] =
        [format!("{profile}{advice}, {compiler}, {target}"), manifest.cpu.clone()];
    if is_verbose {
        build = format!("{build}, opt-level {opt_level}, {}, {rustc}", manifest.features.join(" "));
        processor = format!("{processor}, {}", manifest.cpu_features.join(" "));
    }
    let rows = [
        ("touchstone", format!("{touchstone}, {}", manifest.state())),
        ("build", build),
        ("processor", processor),
        ("threads", format!("{} of {} cores", manifest.threads, manifest.cores)),
    ];
    rows.iter().map(|(head, text)| output::hanging(head, 12, text)).collect()
}

/// Every embedded reference, read and checked against its hash.
fn references(arguments: &arguments::Doctor, _: &Session) -> Result<String, Failure> {
    let (mut count, mut hashes) = (0, String::new());
    for name in Reference::names() {
        for resource in &Reference::load(name)?.package.resources {
            count += 1;
            hashes += &format!("\n                 {name}/{} {}", resource.path, resource.hash);
        }
    }
    let hashes = if arguments.verbose { &hashes } else { " (--verbose lists their hashes)" };
    Ok(format!("{count} tables as described{hashes}"))
}

fn writing(arguments: &arguments::Doctor, _: &Session) -> Result<String, Failure> {
    OutputFolder::check(&arguments.out)?;
    Ok(format!("into {}", arguments.out.display()))
}

/// Largest error of the self-check: twice the present error, so that a change of method raises no alarm.
const BOUND: f64 = 0.02;

/// A small Couette flow against its series, twice: the error is small, and the bits are equal.
fn self_check(_: &arguments::Doctor, session: &Session) -> Result<String, Failure> {
    let start = Instant::now();
    let set = ["rows=10".to_string(), "end=0.1".to_string()];
    let case = touchstone_cases::find("couette")?;
    let spec = case::spec(case, "seed", &set)?;
    let context = Context { interrupt: Some(session.interrupt), ..Context::default() };
    let (first, second) = (case.run(&spec, &context)?, case.run(&spec, &context)?);
    let error = first.metric("l2@0.1").unwrap_or(f64::NAN);
    let took = touchstone_report::seconds(start.elapsed().as_secs_f64());
    let words = format!(
        "Couette flow of 10 rows, l2 error {} at most {} after {} steps, in {took}",
        touchstone_report::percent(error, 3),
        touchstone_report::percent(BOUND, 3),
        first.cost.steps
    );
    match (error <= BOUND, first.state.is_some() && first.state == second.state) {
        (true, true) => Ok(words),
        (true, false) => Err(Failure::bug(format!("two equal runs differ in their bits; {words}"))),
        (false, _) => Err(Failure::bug(words)),
    }
}

/// Seconds that one measurement may take.
const BUDGET: f64 = 2.0;

fn bench(session: &Session) -> Result<(), Failure> {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    output::print(
        "\nSpeed: continuity, pressure and Morris viscosity in one sum, cubic spline, h/dx 1.2, 20 \
         neighbours\nwithin the support; the best of four batches. M rhs/s: million particle \
         right-hand sides\na second. M lists/s: million neighbour lists built a second, sorting of the \
         particles included.\n\n",
    )?;
    let mut rows = Vec::new();
    for side in bench::SIDES {
        let mut row = Vec::new();
        for threads in if all > 1 { vec![1, all] } else { vec![1] } {
            let speed = on_threads(u16::try_from(threads).ok(), || {
                bench::speed(side, threads > 1, BUDGET).map_err(Failure::bug)
            })?;
            if row.is_empty() {
                let (particles, bytes) = (speed.particles.to_string(), speed.bytes.to_string());
                row.extend([particles, touchstone_report::sig(speed.neighbours, 3), bytes]);
            }
            row.extend(
                [speed.rate, speed.list_rate].map(|rate| touchstone_report::sig(rate / 1e6, 3)),
            );
            session.go_on("the measurements are not complete; the same command begins again")?;
        }
        rows.push(row);
    }
    let on_all = format!("{all} threads: M rhs/s");
    let heads =
        ["particles", "in list", "B each", "1 thread: M rhs/s", "M lists/s", &on_all, "M lists/s"];
    output::print(&output::table(&heads[..if all > 1 { 7 } else { 5 }], rows))
}
