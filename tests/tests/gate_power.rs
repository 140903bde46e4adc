//! Mutation testing of the validation: solvers and references with one thing spoiled run through the
//! planned runs, the measuring and the gates of the healthy ones. A spoiled one that passes every
//! gate is a defect of the gates.
//!
//! What each mutant fails stands in `gate_power.csv`, what each gate is worth in
//! `gate_power_gates.csv`; both are compared exactly, and written anew with `INSTA_UPDATE=always`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use base::gate::Gate;
use rayon::prelude::*;
use touchstone_tests::spoil::Fault;

use crate::gate_power_runs::{self, GROUPS, Job, Measured, jobs};

/// What is spoiled: the solver, by a fault; or the reference.
#[derive(Clone, Copy)]
enum Mutant {
    Solver(&'static str, Fault),
    Reference(&'static str, gate_power_runs::Reference),
}

impl Mutant {
    fn name(&self) -> &'static str {
        match self {
            Mutant::Solver(name, _) | Mutant::Reference(name, _) => name,
        }
    }
}

/// Viscosities for the smallest error that is seen.
const LADDER: [(&str, f64); 7] = [
    ("viscosity x 1.000001", 1.000001),
    ("viscosity x 1.00001", 1.00001),
    ("viscosity x 1.001", 1.001),
    ("viscosity x 1.002", 1.002),
    ("viscosity x 1.005", 1.005),
    ("viscosity x 1.01", 1.01),
    ("viscosity x 1.02", 1.02),
];

#[rustfmt::skip] // one line a mutant: a table
fn mutants() -> Vec<Mutant> {
    use Mutant::{Reference as R, Solver as S};
    use gate_power_runs::Reference::*;
    const F: Fault = Fault::NONE;
    let ladder = LADDER.map(|(name, viscosity)| S(name, Fault { viscosity, ..F }));
    let mut all = ladder.to_vec();
    all.extend([
        S("eta^2 x 10", Fault { eta2: 10.0, ..F }),
        S("Tait exponent 6 for 7", Fault { gamma: 6, ..F }),
        S("sound speed x 1.01", Fault { sound: 1.01, ..F }),
        S("pressure of the neighbour alone", Fault { pressures: [0.0, 1.0], ..F }),
        S("pressure of the particle alone", Fault { pressures: [1.0, 0.0], ..F }),
        S("difference of pressures for their sum", Fault { pressures: [-1.0, 1.0], ..F }),
        S("continuity x 1.01", Fault { continuity: 1.01, ..F }),
        S("leapfrog drift at old velocities; whole predictor", Fault { integrator: true, ..F }),
        S("body force x 1.01", Fault { force: 1.01, ..F }),
        S("density diffusion with the wrong sign", Fault { diffusion: -1.0, ..F }),
        S("no density diffusion", Fault { diffusion: 0.0, ..F }),
        S("shifting with the wrong sign", Fault { shifting: -1.0, ..F }),
        S("no shifting", Fault { shifting: 0.0, ..F }),
        S("kernel support cut to 80 %", Fault { support: 0.8, ..F }),
        S("smoothing length x 0.99", Fault { h: 0.99, ..F }),
        S("masses x 1.01", Fault { mass: 1.01, ..F }),
        S("wall moves the wrong way", Fault { wall_velocity: -1.0, ..F }),
        S("ghost velocity U - v for 2U - v", Fault { wall_velocity: 0.5, ..F }),
        S("curvature of ghosts with the wrong sign", Fault { curvature: -1.0, ..F }),
        S("no curvature of ghosts", Fault { curvature: 0.0, ..F }),
        S("mirrors 0.1 h outside the plates", Fault { mirrors: [0.1, 0.1], ..F }),
        S("one mirror 0.01 h outside its plate", Fault { mirrors: [0.01, 0.0], ..F }),
        S("wall particles at half the speed", Fault { wall_particles: 0.5, ..F }),
        S("neighbour lists never rebuilt", Fault { skin_share: 1e9, ..F }),
        S("neighbour lists kept 100 times too long", Fault { skin_share: 50.0, ..F }),
        R("alternating sign of the Couette series dropped", NoAlternation),
        R("Couette series of one term", OneTerm),
        R("sign of the Poiseuille series", SeriesAdded),
        R("reference with viscosity x 1.02", Viscosity),
        R("Poiseuille reference with mean for centre-line velocity", MeanVelocity),
        R("theory of the time step x 1.5", TimeStep),
        R("theory of weak growth: (omega dt)^4/16", WeakGrowth),
    ]);
    all
}

/// Gates that a mutant fails, in the order of the plan; groups that it cannot touch.
struct Outcome {
    name: &'static str,
    is_reference: bool,
    failed: Vec<String>,
    groups: BTreeMap<&'static str, [usize; 2]>,
}

/// What the healthy program measured, and what every mutant did.
struct Matrix {
    gates: Vec<(&'static str, Gate)>,
    healthy_failures: Vec<String>,
    outcomes: Vec<Outcome>,
}

/// Runs every job with every mutant.
fn matrix() -> Matrix {
    let jobs = jobs();
    let healthy: Vec<Measured> = jobs.par_iter().map(|job| job.run(&Fault::NONE)).collect();
    let fails =
        |gate: &Gate, measured: &Measured| gate.judge(measured.value(gate)).verdict.is_failure();
    let all = |job: &Job| job.gates().iter().map(|g| (job.group(), g.clone())).collect::<Vec<_>>();
    let gates: Vec<_> = jobs.iter().flat_map(all).collect();
    let failures = jobs.iter().zip(&healthy).flat_map(|(job, measured)| {
        job.gates().iter().filter(|g| fails(g, measured)).map(|g| g.id.clone()).collect::<Vec<_>>()
    });
    let healthy_failures = failures.collect();
    let mutants = mutants();
    let pairs: Vec<(usize, usize)> =
        (0..mutants.len()).flat_map(|m| (0..jobs.len()).map(move |j| (m, j))).collect();
    // Per mutant and job: gates that are touched, and those of them that fail.
    let results: Vec<Option<(Vec<String>, usize)>> = pairs
        .into_par_iter()
        .map(|(m, j)| {
            let measured = match &mutants[m] {
                Mutant::Solver(_, fault) => {
                    let seen = jobs[j].sees(fault);
                    if seen == Fault::NONE { None } else { Some(jobs[j].run(&seen)) }
                }
                Mutant::Reference(_, reference) => jobs[j].against(&healthy[j], *reference),
            }?;
            let judged = jobs[j].gates().iter().filter(|g| measured.is_about(g));
            let (failed, passed): (Vec<_>, Vec<_>) = judged.partition(|g| fails(g, &measured));
            let count = failed.len() + passed.len();
            Some((failed.into_iter().map(|g| g.id.clone()).collect(), count))
        })
        .collect();
    let outcomes = mutants.iter().zip(results.chunks(jobs.len())).map(|(mutant, results)| {
        let mut groups: BTreeMap<&'static str, [usize; 2]> = BTreeMap::new();
        let mut all_failed = Vec::new();
        for (job, result) in jobs.iter().zip(results) {
            let Some((failed, count)) = result else { continue };
            let of_group = groups.entry(job.group()).or_default();
            *of_group = [of_group[0] + failed.len(), of_group[1] + count];
            all_failed.extend(failed.iter().cloned());
        }
        let is_reference = matches!(mutant, Mutant::Reference(..));
        Outcome { name: mutant.name(), is_reference, failed: all_failed, groups }
    });
    let outcomes = outcomes.collect();
    Matrix { gates, healthy_failures, outcomes }
}

impl Matrix {
    /// Mutant, what it spoils, for each group the gates it fails of those it touches, the first one.
    fn mutants_csv(&self) -> String {
        let mut text = format!("mutant,spoils,{},first gate that it fails\n", GROUPS.join(","));
        for outcome in &self.outcomes {
            let cell = |group: &&str| match outcome.groups.get(group) {
                None | Some([_, 0]) => "-".to_string(),
                Some([failed, all]) => format!("{failed} of {all}"),
            };
            let cells: Vec<String> = GROUPS.iter().map(cell).collect();
            let spoils = if outcome.is_reference { "reference" } else { "solver" };
            let first = outcome.failed.first().map_or("none", String::as_str);
            text += &format!("{},{spoils},{},{first}\n", outcome.name, cells.join(","));
        }
        text
    }

    /// Gate, number of mutants that fail it.
    fn gates_csv(&self) -> String {
        let kills = |id: &String| self.outcomes.iter().filter(|o| o.failed.contains(id)).count();
        let line =
            |(group, gate): &(&str, Gate)| format!("{group},{},{}\n", gate.id, kills(&gate.id));
        let lines: String = self.gates.iter().map(line).collect();
        format!("group,gate,mutants that fail it\n{lines}")
    }
}

/// Compares with a file beside the tests, or writes it.
fn check(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&path, text).expect("a file that can be written");
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    let differ = text.lines().zip(expected.lines()).filter(|(a, b)| a != b);
    let lines: Vec<String> = differ.map(|(a, b)| format!("now  {a}\nthen {b}")).collect();
    let hint = "if the change is understood: INSTA_UPDATE=always cargo test --test gate_power";
    assert!(text == expected, "{name} changed; {hint}\n{}", lines.join("\n"));
}

/// No fault in the wrapped types: the bits of the program itself.
#[test]
fn the_neutral_fault_has_the_bits_of_the_healthy_solver() {
    let jobs = jobs();
    let differ = jobs.par_iter().filter_map(|job| {
        let (wrapped, own) = (job.run(&Fault::NONE), job.run_unwrapped()?);
        (wrapped.state() != own.state() || own.state().is_none()).then(|| job.name())
    });
    let differ: Vec<String> = differ.collect();
    assert!(differ.is_empty(), "{differ:?}");
}

#[test]
fn every_mutant_fails_a_gate() {
    let matrix = matrix();
    let (mutants, gates) = (matrix.mutants_csv(), matrix.gates_csv());
    println!("{mutants}\n{gates}");
    assert!(matrix.healthy_failures.is_empty(), "healthy: {:?}", matrix.healthy_failures);
    let survivors: BTreeSet<&str> =
        matrix.outcomes.iter().filter(|o| o.failed.is_empty()).map(|o| o.name).collect();
    check("gate_power.csv", &mutants);
    check("gate_power_gates.csv", &gates);
    assert!(survivors.is_empty(), "no gate sees these: {survivors:?}");
}
