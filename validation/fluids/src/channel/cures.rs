//! What cures the instability of the seed's Poiseuille flow.

use super::{
    ChannelCase,
    starts::{self, END, Outcome, Starts},
};
use base::spec::RunSpec;
use harness::{case::Tier, columns::Columns, runs::Runs, study::Study};
use report::{Cell, Column, Status};

const CURES_ID: &str = "poiseuille-cures";
const CURES_TITLE: &str = "What cures the instability";

/// What was tried against the instability.
const CURES: [(&str, &str); 10] = [
    ("seed", "nothing"),
    ("cure-leapfrog", "staggered leapfrog"),
    ("cure-stress", "artificial stress, ξ 0.3, n 4"),
    ("cure-viscosity", "artificial viscosity, α 0.1"),
    ("cure-xsph", "XSPH, ε 0.5"),
    ("cure-diffusion", "density diffusion 0.1"),
    ("cure-background", "background pressure 0.05 ρc0²"),
    ("cure-shifting", "particle shifting 0.5"),
    ("cure-both", "shifting and density diffusion"),
    ("modern", "`modern`: quintic, leapfrog, both"),
];

/// Reynolds numbers of the table.
const REYNOLDS: [f64; 3] = [5.0, 20.0, 50.0];

fn cell(case: &ChannelCase, variant: &str, re: f64) -> Vec<RunSpec> {
    starts::specs(case, (variant, re), Tier::Full, |_| ())
}

/// The runs of the study: none in the quick tier.
pub fn specs(case: &ChannelCase, tier: Tier) -> Vec<RunSpec> {
    let variants = CURES.iter().filter(|_| tier == Tier::Full);
    variants.flat_map(|(variant, _)| REYNOLDS.map(|re| cell(case, variant, re))).flatten().collect()
}

/// Where they are not run.
fn cures_elsewhere() -> Study {
    let text = format!(
        "What cures the instability, {} changes of the seed at three Reynolds numbers, is run in the full \
         tier only.",
        CURES.len() - 1
    );
    Study::new(CURES_ID, CURES_TITLE).prose(text)
}

/// The study.
pub fn study(case: &ChannelCase, tier: Tier, runs: &Runs) -> Study {
    if tier == Tier::Quick {
        return cures_elsewhere();
    }
    let row = |(variant, what): (&'static str, &'static str)| {
        (variant, what, REYNOLDS.map(|re| Starts::among(runs, &cell(case, variant, re))))
    };
    let found = CURES.map(row);
    type Row = (&'static str, &'static str, [Starts; REYNOLDS.len()]);
    let first = |(_, _, row): &Row| {
        let first = row.iter().zip(REYNOLDS).find(|(s, _)| s.mostly_fails()).map(|(_, re)| re);
        first.map_or(Cell::text("none"), Cell::exact)
    };
    let mut columns = Columns::<Row>::default()
        .text("seed with", |(_, what, _)| *what)
        .num(["first Re at which most fail", "-"], first);
    for (k, re) in REYNOLDS.into_iter().enumerate() {
        let head = Column::text(format!("Re {re}"));
        columns = columns.with(head, move |(_, _, row)| outcome(&row[k]));
    }
    let caption = format!(
        "Cures of the instability at 20 rows, c0 by Morris' rule, to νt/L² = {END}. {} A cell shows how \
         many failed, and the median outcome: the largest relative L2 error from νt/L² = 0.1 on, or after \
         t the νt/L² of the divergence. A run fails if it diverges or if its error exceeds 5 %.",
        starts::in_words(tier),
    );
    let table = columns.table(caption, &found);
    let fails = |name: &str| {
        let mut of_variant = found.iter().filter(|(variant, ..)| *variant == name);
        of_variant.any(|(_, _, row)| row.iter().any(Starts::mostly_fails))
    };
    Study::new(CURES_ID, CURES_TITLE).prose(cures_in_words(fails)).block(table)
}

/// What the table of cures shows, from the numbers.
fn cures_in_words(fails: impl Fn(&str) -> bool) -> String {
    let names = |wanted: bool| {
        let tried = CURES.iter().skip(1);
        let of_this_kind = tried.filter(|(variant, _)| fails(variant) == wanted);
        let names: Vec<&str> = of_this_kind.map(|(_, what)| *what).collect();
        if names.is_empty() { "none".to_string() } else { names.join("; ") }
    };
    let mut words = vec![
        format!(
            "From most starts, these changes hold at every Reynolds number of the table: {}.",
            names(false)
        ),
        format!("These fail from most starts at some Reynolds number: {}.", names(true)),
    ];
    if fails("seed") {
        words.insert(0, "The unchanged `seed` fails from most starts.".into());
    }
    if fails("seed") && fails("cure-leapfrog") {
        let text = "Time integration alone is not the cause: the leapfrog, which neither damps nor \
                    amplifies sound, fails as well.";
        words.push(text.into());
    }
    if fails("seed") && !fails("cure-shifting") && !fails("cure-background") {
        let text = "Shifting, which keeps particles apart, cures the instability, and so does background \
                    pressure, which keeps the pressure positive. This points to the tensile instability \
                    where p < 0. A background pressure in proportion to ρc0² pushes where the particles \
                    are not in order, which causes its error in the table.";
        words.push(text.into());
    }
    if !fails("cure-shifting") && fails("cure-background") {
        let text = "Shifting, which keeps particles apart, cures the instability. A background pressure of \
                    0.05 ρc0² does not from most starts, so the tensile instability where p < 0 is not \
                    shown to be the cause.";
        words.push(text.into());
    }
    words.join(" ")
}

fn outcome(starts: &Starts) -> Cell {
    let cell = Cell::text(starts.text());
    match (starts.failed(), starts.median()) {
        (0, Some(Outcome::Reached(error))) if error <= 0.01 => cell.with(Status::Pass),
        (0, Some(_)) => cell,
        _ => cell.with(Status::Limitation),
    }
}
