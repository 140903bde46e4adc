//! Which mechanism limits the time step of each variant, and what it costs that the others are slower.

use harness::{
    case::{self, Case, Rules, RunError},
    columns::Columns,
    declare::StepLimits,
    limits::Mechanism,
    runs::Runs,
    studies::limit_of_theory,
    suite::Suite,
};
use report::{Block, Cell, Section, Table};

/// A variant at its default settings.
pub struct Row {
    /// Name of the case.
    pub case: &'static str,
    /// Name of the variant.
    pub variant: &'static str,
    /// What its rules choose.
    pub rules: Rules,
    /// The least and the largest measured limit of the step over that of theory, of the runs of which they
    /// were bisected.
    measured: Option<[f64; 2]>,
}

impl Row {
    /// The variants of a case whose rules state a step before the run, without what was measured.
    ///
    /// # Errors
    /// If the default settings of a variant are refused.
    pub fn of(case: &dyn Case) -> Result<Vec<Self>, RunError> {
        let row = |variant: case::Variant| {
            let rules = case.rules(&case::spec(case, variant.name, &[])?);
            Ok(Self { case: case.name(), variant: variant.name, rules: rules?, measured: None })
        };
        let all = case.variants().into_iter().map(row);
        all.filter(|row| !matches!(row, Err(RunError::NoRules { .. }))).collect()
    }

    fn measured(self, limits: Option<&StepLimits>, runs: &Runs) -> Self {
        let of = limits.iter().flat_map(|limits| &limits.of);
        let of = of.filter(|limit| limit.variant == self.variant);
        let ratios = of.filter_map(|limit| limit_of_theory(limit, runs));
        let both = |all: Option<[f64; 2]>, ratio: f64| {
            let [least, most] = all.unwrap_or([ratio; 2]);
            Some([least.min(ratio), most.max(ratio)])
        };
        Self { measured: ratios.fold(None, both), ..self }
    }

    /// The limit of a mechanism over the step; infinite if the scene lacks it.
    pub fn headroom(&self, mechanism: Mechanism) -> f64 {
        self.rules.limits.alone(mechanism) / self.rules.dt()
    }

    /// Steps of the run.
    pub fn steps(&self) -> f64 {
        self.rules.end / self.rules.dt()
    }

    /// The limit of the slowest mechanism over that of the stiffest.
    pub fn stiffness(&self) -> f64 {
        let Rules { limits, end, .. } = &self.rules;
        limits.slowest(*end) / limits.alone(limits.binding())
    }

    /// Steps of the run over those that the slowest mechanism alone would need.
    pub fn cost(&self) -> f64 {
        self.rules.limits.slowest(self.rules.end) / self.rules.dt()
    }

    fn measured_words(&self) -> String {
        let Some([least, most]) = self.measured.map(|both| both.map(|x| report::sig(x, 3))) else {
            return "–".into();
        };
        if least == most { least } else { format!("{least} to {most}") }
    }
}

/// What the columns of [`table`] mean.
pub const READING: &str = "\
    Limits of the time step at default settings, each over the step that is taken: below 1 the mechanism \
    would forbid the step by itself. Limits of waves, viscosity, artificial viscosity and density \
    diffusion are 2 over the largest rate on the lattice at rest; with the predictor-corrector, sound \
    needs damping as well. Motion is the time h/V, body force (h/F)^(1/2), contact the time in which \
    bodies approach each other by h. *Together* is the limit of all waves, beyond which a step is \
    refused. *Bound by* names the stiffest mechanism; super-time-stepping takes viscosity out of the \
    contest. The slowest mechanism is the slowest of the problem (waves, viscosity, motion, force, \
    contact) that acts within the run, else the run itself. *Slowest/stiffest* is the ratio of their \
    limits, *steps/slowest* the number of steps over that which the slowest alone would need. *Sweeps* \
    are the pair sweeps of the run, which count the stages of super-time-stepping.";

/// The table of these rows.
pub fn table(rows: &[Row]) -> Table {
    let columns = Columns::<Row>::default()
        .code("variant", |row| format!("{} {}", row.case, row.variant))
        .num(["step", "s"], |row| Cell::sci(row.rules.dt(), 3))
        .text("set by", |row| {
            let step = row.rules.step;
            let number =
                if step.number == 1.0 { String::new() } else { report::sig(step.number, 3) };
            format!("{number} {}", step.by).trim_start().to_string()
        });
    let limit = |value: f64| Cell::num(value, 3);
    let mechanisms = Mechanism::ALL.into_iter().fold(columns, |columns, mechanism| {
        columns.of([mechanism.name(), ""], move |row| row.headroom(mechanism), limit)
    });
    mechanisms
        .of(["together", ""], |row| row.rules.dt_limit() / row.rules.dt(), limit)
        .text("measured/theory", Row::measured_words)
        .text("bound by", |row| row.rules.limits.binding().name())
        .num(["slowest/stiffest", ""], |row| Cell::num(row.stiffness(), 3))
        .num(["steps", "1"], |row| Cell::num(row.steps(), 3))
        .num(["steps/slowest", ""], |row| Cell::num(row.cost(), 3))
        .num(["sweeps", "1"], |row| Cell::num(row.steps() * row.rules.sweeps(), 3))
        .table("What limits the time step: each limit over the step that is taken.", rows)
}

/// The table of all cases, with the limits that were measured.
pub fn section(suite: &Suite) -> Section {
    let of_case = |results: &harness::suite::CaseResults| {
        let limits = results.case.declaration(suite.tier).limits;
        let rows = Row::of(results.case).unwrap_or_default();
        let measured = move |row: Row| row.measured(limits.as_ref(), &results.runs);
        rows.into_iter().map(measured).collect::<Vec<Row>>()
    };
    let rows: Vec<Row> = suite.cases.iter().flat_map(of_case).collect();
    let summary = format!("The limits of {} variants", rows.len());
    Section::new("stiffness", "What limits the time step").prose(READING).block(Block::Details {
        summary,
        blocks: vec![
            table(&rows).into(),
            Block::Prose(vec![
                "Measured/theory is the longest stable step by bisection over *together*, of the runs that \
                 each case declares; they need not have the default resolution. On lattices at rest the two \
                 agree within 3 %, as gates of the case `resting_box` demand. \
                 `touchstone stability --theory` prints the table without any run."
                    .into(),
            ]),
        ],
    })
}
