//! Breakdown of the time of a run, as text.

use touchstone_base::{
    breakdown::{Breakdown, Part},
    record::Cost,
};
use touchstone_report::{percent, seconds, sig};

use super::output;

/// The parts of the time in percent, and the work of pair sweeps.
pub fn tables(cost: &Cost, breakdown: &Breakdown) -> String {
    let (stepping, observing) = (breakdown.stepping_seconds(), breakdown.observing_seconds());
    let (steps, all) = (breakdown.steps as f64, stepping + observing);
    let row = |name: &str, spent: f64, times: String| {
        let nanoseconds = 1e9 * spent / (steps * cost.particles as f64);
        vec![name.into(), seconds(spent), percent(spent / all, 3), sig(nanoseconds, 3), times]
    };
    let mut rows = Vec::new();
    for (name, total, parts) in [
        ("stepping", stepping, &breakdown.stepping),
        ("observing", observing, &breakdown.observing),
    ] {
        let part =
            |part: &Part| row(&format!("  {}", part.name), part.seconds, part.times.to_string());
        rows.push(row(name, total, String::new()));
        rows.extend(parts.iter().map(part));
    }
    let moved = breakdown.bytes_a_step;
    let counts = [
        ("processor time of the stepping, all threads", seconds(cost.cpu_s)),
        ("neighbours visited, per fluid particle and pair sweep", sig(breakdown.neighbours, 3)),
        ("share of them inside the support", percent(breakdown.inside, 3)),
        ("builds of neighbour lists", breakdown.list_builds.to_string()),
        ("time steps a build", sig(steps / breakdown.list_builds as f64, 3)),
        ("data moved in a step, caches included [kB]", sig(1e-3 * moved, 3)),
        ("data moved in a second of stepping [GB]", sig(1e-9 * moved * steps / stepping, 3)),
    ];
    let counts = counts.map(|(what, number)| vec![what.to_string(), number]);
    let threads = match cost.threads {
        1 => String::from("1 thread"),
        count => format!("{count} threads: shared work counts once, until the last thread ends"),
    };
    format!(
        "\nProfile in wall seconds ({threads}); ns: nanoseconds per fluid particle and time step\n\n{}\n{}",
        output::table(&["part", "time", "share", "ns", "times"], rows),
        output::table(&["work and data", ""], counts)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_names_each_part_with_its_share_and_its_nanoseconds() {
        let part = |name: &str, seconds: f64| Part { name: name.into(), seconds, times: 100 };
        let breakdown = Breakdown {
            stepping: vec![part("force sweep", 0.5), part("sorting", 0.3)],
            observing: vec![part("frames", 0.2)],
            steps: 100,
            list_builds: 5,
            neighbours: 24.0,
            inside: 0.85,
            bytes_a_step: 4e6,
        };
        let cost = Cost { particles: 1000, threads: 1, ..Cost::default() };
        let text = tables(&cost, &breakdown).replace('\u{a0}', " ");
        let lines: Vec<String> = text
            .lines()
            .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
            .collect();
        for line in [
            "stepping 800 ms 80.0 % 8000",
            "force sweep 500 ms 50.0 % 5000 100",
            "observing 200 ms 20.0 % 2000",
            "frames 200 ms 20.0 % 2000 100",
            "share of them inside the support 85.0 %",
            "time steps a build 20.0",
            "data moved in a second of stepping [GB] 0.500",
        ] {
            assert!(lines.iter().any(|found| found == line), "{line} in {lines:#?}");
        }
        assert!(lines.iter().any(|line| line.contains("wall seconds (1 thread)")), "{text}");
    }
}
