//! `stability`: the largest stable time steps that cases declare, measured and by theory.

use serde_json::{Value, json};
use touchstone_harness::{
    case::Case,
    limits::{ADVISED_SHARE, Mechanism},
    make::Job,
    runs::{Planned, Runs},
    studies::{StepLimit, StepLimits, limit::of_theory as limit_of_theory},
};

use touchstone_cases::stiffness::StiffnessRow;

use super::{Exit, Failure, Outcome, Session, arguments, output, trouble};

/// A declared limit and the case that it is of.
struct Declared {
    case: &'static dyn Case,
    limit: StepLimit,
}

pub fn stability(arguments: &arguments::Stability, session: &Session) -> Outcome {
    let cases = session.choose(&arguments.cases)?;
    session.check_references(&cases)?;
    if arguments.theory {
        return theory(&cases, arguments.json).map(|()| Exit::Pass);
    }
    let mut declared = Vec::new();
    for case in cases {
        let studies = case.studies(arguments.tier);
        let limits: Vec<StepLimit> =
            studies.of::<StepLimits>().flat_map(|of| of.of.clone()).collect();
        if limits.is_empty() && !arguments.cases.is_empty() {
            let words = format!("{} declares no largest stable time step", case.name());
            return Err(Failure::usage(words));
        }
        declared.extend(limits.into_iter().map(|limit| Declared { case, limit }));
    }
    let job = |Declared { case, limit }: &Declared| Job {
        case: *case,
        planned: Planned::new(limit.spec.clone()),
    };
    let jobs: Vec<Job> = declared.iter().map(job).collect();
    let mut made = session.make(&jobs, session.making(arguments.tier), arguments.threads, None)?;
    if made.interrupted {
        return Err(Failure::interrupted("no limit was determined; the same command begins again"));
    }
    let plan = jobs.into_iter().map(|job| job.planned).collect();
    let runs = Runs::of(plan, &mut made.records);
    let all = || declared.iter().map(|declared| json(declared, &runs)).collect();
    output::answer(arguments.json, all, || table(&declared, &runs))?;
    Ok(trouble(&made).unwrap_or(Exit::Pass))
}

/// Columns of the limits of each variant.
const HEADS: [&str; 7] =
    ["variant", "step [s]", "limit/step", "bound by", "stiffness", "steps", "sweeps"];
/// Explanation of the columns.
const READING: &str = "At default settings. Step: the time step that is taken. Limit/step: the largest \
    stable step of all waves together, by linear theory on the lattice at rest, over the step; at least \
    1.25 is advised for particles that move. Bound by: the mechanism with the smallest limit. Stiffness: \
    the limit of the slowest mechanism of the problem over the smallest one. Sweeps: pair sweeps of the \
    run, with the stages of super-time-stepping. --json and the report also have the limit of each \
    mechanism.";

/// The mechanism that limits the step of each variant, without a run.
fn theory(cases: &[&'static dyn Case], as_json: bool) -> Result<(), Failure> {
    let mut rows = Vec::new();
    for case in cases {
        rows.extend(StiffnessRow::of(*case)?);
    }
    if rows.is_empty() {
        let words = format!("{} has no rule for its time step", cases[0].name());
        return Err(Failure::usage(words));
    }
    let text = || {
        let row = |row: &StiffnessRow| {
            let limits = &row.rules.limits;
            let headroom = touchstone_report::sig(row.rules.dt_limit() / row.rules.dt(), 3);
            let [stiffness, steps, sweeps] =
                [row.stiffness(), row.steps(), row.steps() * row.rules.sweeps()]
                    .map(|value| touchstone_report::sig(value, 3));
            let step = touchstone_report::sci(row.rules.dt(), 3);
            let binding = limits.binding().name().to_string();
            vec![row.variant.to_string(), step, headroom, binding, stiffness, steps, sweeps]
        };
        let mut text = String::new();
        for of_case in rows.chunk_by(|a, b| a.case == b.case) {
            let table = output::table(&HEADS, of_case.iter().map(row));
            text += &format!("{}\n{table}\n", of_case[0].case);
        }
        text + &output::wrap(READING, "")
    };
    output::answer(as_json, || rows.iter().map(row_json).collect(), text)
}

fn row_json(row: &StiffnessRow) -> Value {
    let limits = &row.rules.limits;
    let all = Mechanism::ALL.into_iter().map(|of| (of.name().to_string(), limits.alone(of)));
    let alone =
        all.filter(|(_, limit)| limit.is_finite()).map(|(name, limit)| (name, limit.into()));
    json!({
        "case": row.case, "variant": row.variant, "step_s": row.rules.dt(),
        "set_by": json!([row.rules.step.number, row.rules.step.by]),
        "limits_s": Value::Object(alone.collect()), "together_s": row.rules.dt_limit(),
        "bound_by": limits.binding().name(), "slowest_over_stiffest": row.stiffness(),
        "steps": row.steps(), "steps_over_slowest": row.cost(),
        "sweeps": row.steps() * row.rules.sweeps(),
    })
}

fn json(Declared { case, limit }: &Declared, runs: &Runs) -> Value {
    let mut value = json!({
        "case": case.name(), "variant": limit.spec.variant, "scene": limit.scene,
        "theory_s": limit.theory, "default_of_theory": limit.default_at / limit.theory_at,
    });
    if let Some(ratio) = limit_of_theory(limit, runs) {
        value["stable_s"] = (ratio * limit.theory).into();
    }
    value
}

fn table(declared: &[Declared], runs: &Runs) -> String {
    let row = |Declared { case, limit }: &Declared| {
        let ratio = limit_of_theory(limit, runs);
        let number = |value: Option<f64>, digits| {
            value.map_or("none found".to_string(), |value| touchstone_report::sig(value, digits))
        };
        vec![
            format!("{} {}", case.name(), limit.spec.variant),
            limit.scene.clone(),
            touchstone_report::sig(limit.theory, 4),
            number(ratio.map(|ratio| ratio * limit.theory), 4),
            number(ratio, 3),
            touchstone_report::sig(limit.default_at / limit.theory_at, 3),
        ]
    };
    let heads =
        ["variant", "scene", "theory [s]", "measured [s]", "measured/theory", "default/theory"];
    format!(
        "{}\nTheory: linear stability on a lattice at rest; for particles that move a step of at most \
         {ADVISED_SHARE} of it is advised. Measured: by bisection, with the criterion that the report states \
         for each case.\n",
        output::table(&heads, declared.iter().map(row))
    )
}
