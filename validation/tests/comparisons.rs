//! Comparisons with references in `judge --json`, from runs that the program made: against an exact reference
//! error and order, against others E, u_num, u_input, u_D, u_val.

use serde_json::Value;

use crate::common::touchstone;

/// Whether a planned run belongs to the ladders of `seed` and `consistent` in Couette flow, or to those of
/// `modern` in the dam break without the tank.
fn is_of_a_ladder(line: &str) -> bool {
    let run: Value = serde_json::from_str(line).unwrap();
    let set = &run["settings"];
    let is_plain = run["task"].is_null() && run["allow_unstable"].is_null();
    let is_compared = match (run["case"].as_str(), run["variant"].as_str()) {
        (Some("couette"), Some("seed" | "consistent")) => set["re"] == 0.5 && set["end"] == 1.0,
        (Some("dam_break"), Some("modern")) => {
            set["height"].as_f64() > Some(0.1) && set["width"] != 0.6
        }
        _ => false,
    };
    is_plain && is_compared && set["rows"].as_u64() <= Some(20) && set["n"].as_u64() <= Some(20)
}

#[test]
fn comparisons_are_among_the_verdicts_with_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let plan = touchstone(at, "plan couette dam_break").stdout;
    let plan = String::from_utf8(plan).unwrap();
    let lines: Vec<&str> = plan.lines().filter(|line| is_of_a_ladder(line)).collect();
    assert!((11..30).contains(&lines.len()), "{} runs", lines.len());
    std::fs::write(at.join("ladders.jsonl"), lines.join("\n") + "\n").unwrap();
    assert!(touchstone(at, "run --specs ladders.jsonl --store store").status.success());
    let verdicts = touchstone(at, "verify --no-runs couette dam_break --store store --json").stdout;
    let verdicts: Value = serde_json::from_slice(&verdicts).unwrap();
    let all = verdicts["comparisons"].as_array().unwrap();
    let of = |metric: &str, what: &str| {
        let is_it =
            |of: &&Value| of["metric"] == metric && of["what"].as_str().unwrap().contains(what);
        all.iter().find(is_it).unwrap_or_else(|| panic!("no {metric} of {what} in {all:#?}"))
    };
    let number = |of: &Value| of.as_f64().unwrap_or_else(|| panic!("{of} is no number"));
    let near = |of: &Value, expected: f64| {
        assert!((number(of) / expected - 1.0).abs() < 0.02, "{of} instead of {expected}");
    };
    // Exact: an order, and none of the uncertainties of V&V 20.
    let [exact, seed] = ["consistent", "seed"].map(|variant| of("l2_worst", variant));
    near(&exact["E"], 4.10e-4);
    for (found, expected) in exact["order"].as_array().unwrap().iter().zip([1.65, 1.59, 1.71]) {
        near(found, expected);
    }
    assert_eq!(exact["verdict"], "converges");
    near(&seed["E"], 7.81e-3);
    assert_eq!(seed["verdict"], "stops");
    assert_eq!(seed["words"].as_str().unwrap().replace('\u{a0}', " "), "stops at 0.62 %");
    for key in ["u_num", "u_input", "u_D", "u_val"] {
        assert!(exact[key].is_null() && seed[key].is_null(), "{key}");
    }
    // −0.158, −0.108, −0.058 have no order: u_num is three halves of their range.
    let front = of("front_away@2", "front");
    near(&front["E"], -0.0576);
    near(&front["u_num"], 1.5 * (0.1581 - 0.0576));
    near(&front["u_D"], 0.042);
    assert_eq!((number(&front["u_input"]), &front["order"]), (0.0, &Value::Null));
    assert_eq!(front["verdict"], "ladder-does-not-tell");
    near(&front["interval"][0], -0.0576 - 3.0 * (0.1581 - 0.0576));
    // Against the experiment: the height of the column is uncertain, by the coarsest run.
    let measured = of("front_rms_shifted", "front");
    near(&measured["u_D"], 0.1);
    let parts = ["u_num", "u_input", "u_D"].map(|key| number(&measured[key]));
    assert!(parts[1] > 1e-5 && parts[1] < 0.01, "u_input is {}", parts[1]);
    near(&measured["u_val"], parts.iter().map(|part| part * part).sum::<f64>().sqrt());
}
