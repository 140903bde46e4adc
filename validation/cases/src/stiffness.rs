//! The mechanism that limits the time step of each variant, and the cost of the gap to the slower ones.

use touchstone_harness::{
    case::{self, Case, Rules, RunError},
    columns::TableColumns,
    limits::Mechanism,
    studies::Card,
    suite::{CaseResults, Suite},
};
use touchstone_report::{Cell, Section, Table};

/// A variant at its default settings.
pub struct StiffnessRow {
    /// Name of the case.
    pub case: &'static str,
    /// Name of the variant.
    pub variant: &'static str,
    /// The step by its rules.
    pub rules: Rules,
}

impl StiffnessRow {
    /// The variants of a case whose rules state a step before the run.
    ///
    /// # Errors
    /// If the default settings of a variant are refused.
    pub fn of(case: &dyn Case) -> Result<Vec<Self>, RunError> {
        let row = |variant: case::Variant| {
            let rules = case.rules(&case::spec(case, variant.name, &[])?);
            Ok(Self { case: case.name(), variant: variant.name, rules: rules? })
        };
        let all = case.variants().into_iter().map(row);
        all.filter(|row| !matches!(row, Err(RunError::NoRules(_)))).collect()
    }

    /// Steps of the run.
    pub fn steps(&self) -> f64 {
        self.rules.end / self.rules.dt()
    }

    /// The limit of the slowest mechanism over the limit of the stiffest.
    pub fn stiffness(&self) -> f64 {
        let Rules { limits, end, .. } = &self.rules;
        limits.slowest(*end) / limits.alone(limits.binding())
    }

    /// Steps of the run over the steps that the slowest mechanism alone would need.
    pub fn cost(&self) -> f64 {
        self.rules.limits.slowest(self.rules.end) / self.rules.dt()
    }
}

/// Explanation of the limits of [`table`].
const READING: &str = "Limits of the time step at default settings, each over the step that is taken: \
    below 1 the mechanism would forbid the step by itself. Limits of waves, viscosity, artificial \
    viscosity and density diffusion are 2 over the largest rate on the lattice at rest; with the \
    predictor-corrector, sound needs damping as well. Motion is the time h/V, body force (h/F)^(1/2), \
    contact the time in which bodies approach each other by h. *Together* is the limit of all waves, \
    beyond which a step is refused; for particles that move at most 0.8 of it is advised. \
    Super-time-stepping removes the limit of viscosity. The slowest mechanism is the slowest of the \
    problem (waves, viscosity, motion, force, contact) that acts within the run, else the run itself.";

/// The table of these rows.
pub fn table(rows: &[StiffnessRow]) -> Table {
    let columns = TableColumns::<StiffnessRow>::default()
        .code("variant", |row| format!("{} {}", row.case, row.variant))
        .num(["step", "s"], |row| Cell::sci(row.rules.dt(), 3))
        .text("set by", |row| {
            let step = row.rules.step;
            let number = if step.number == 1.0 {
                String::new()
            } else {
                touchstone_report::sig(step.number, 3)
            };
            format!("{number} {}", step.by).trim_start().to_string()
        });
    let limit = |value: f64| Cell::num(value, 3);
    let mechanisms = Mechanism::ALL.into_iter().fold(columns, |columns, mechanism| {
        let of = move |StiffnessRow { rules, .. }: &StiffnessRow| {
            // Infinite if the scene lacks it.
            let cell = Cell::or_dash(rules.limits.alone(mechanism) / rules.dt(), limit);
            match rules.limits.binding() == mechanism {
                true => Cell { text: format!("**{}**", cell.text), is_marked: true, ..cell },
                false => cell,
            }
        };
        columns.num([mechanism.name(), ""], of)
    });
    mechanisms
        .of(["together", ""], |row| row.rules.dt_limit() / row.rules.dt(), limit)
        .num(["slowest/stiffest", ""], |row| Cell::num(row.stiffness(), 3))
        .num(["steps", "1"], |row| Cell::num(row.steps(), 3))
        .table("What limits the time step: each limit over the step that is taken.", rows)
}

/// The table of the recommended variant and the paper's of the main cases.
pub fn section(suite: &Suite) -> Section {
    let of_case = |results: &CaseResults| {
        let recommended = results.case.recommended();
        let shown = [Some(recommended.variant), recommended.papers];
        let mut rows = StiffnessRow::of(results.case).unwrap_or_default();
        rows.retain(|row| shown.contains(&Some(row.variant)));
        rows
    };
    let main = suite.cases.iter().filter(|results| results.studies.first::<Card>().is_some());
    let rows: Vec<StiffnessRow> = main.flat_map(of_case).collect();
    let note = "`touchstone stability --theory` prints the limits of all cases and variants without any \
                run. Each case compares the longest stable step by bisection with *together*; on lattices at \
                rest the two agree within 3 %, as gates of the case `resting_box` demand.";
    Section::new("stiffness", "What limits the time step")
        .prose(READING)
        .prose("The limit of the stiffest mechanism is bold, and divides the slowest in *slowest/stiffest*.")
        .block(table(&rows))
        .prose(note)
}
