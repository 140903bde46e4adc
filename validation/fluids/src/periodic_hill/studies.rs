//! What only the hills have to say: all runs, pictures, what the drag is made of, starts, the Reynolds
//! number, what the gates are worth.

use super::{
    BEST, CASE, VARIANTS,
    measure::{
        DRAG_BALANCE, DRAGS, FORCE, FORCE_ERROR, FORCE_RIPPLE, L2_U, L2_V, REATTACHMENT,
        SECTION_FLUX, SEPARATION, SHEAR_ERROR, UNSTEADY, rms,
    },
    plan::{self, HillRun, QUICK, REYNOLDS, best},
    reference::{floor, reference},
    stability, streamlines,
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{MetricKey, Record},
};
use harness::{
    case::{self, Tier},
    columns::Columns,
    pictures,
    runs::Runs,
    study::Study,
};
use report::{Axis, Cell, Colour, ColourMap, Figure, ParticleMap, Series, Table, percent, sig};

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let mut studies = vec![pictures(tier, runs), all(tier, runs), drags(tier, runs)];
    if tier == Tier::Full {
        studies.extend([starts(runs), reasons(runs), stability::reynolds(runs)]);
    }
    studies
}

/// A row of finite elements or of a run: what the texts say of it, and its metrics.
type Row<'a> = (Vec<String>, Box<dyn Fn(MetricKey) -> Option<f64> + 'a>);

/// A column: head, unit, metric, and how its value is shown.
type Shown = (&'static str, &'static str, MetricKey, fn(f64) -> Cell);

/// A table of such rows with a column of text for each of these heads, then the metrics.
fn table(caption: &str, texts: &[&str], metrics: &[Shown], rows: Vec<Row>) -> Table {
    let mut columns = Columns::<Row>::default();
    for (k, head) in texts.iter().enumerate() {
        columns = columns.text(head, move |(about, _)| about[k].clone());
    }
    for &(head, unit, metric, show) in metrics {
        let value = move |(_, value): &Row| value(metric).unwrap_or(f64::NAN);
        columns = columns.of([head, unit], value, show);
    }
    columns.table(caption, rows)
}

/// Every run, after what finite elements have.
fn all(tier: Tier, runs: &Runs) -> Study {
    let caption = "All runs, below the values of finite elements. Errors of u and v are rms over the \
                   points of ten stations. Force and ripple (rms) are over the last fifth of the run. The \
                   error of shear is rms over the hill, relative to the largest shear there. Flux of \
                   sections is the largest error of ten. Drag balance is the stress at the walls over the \
                   force, less 1. Unsteady is what is left of the decay, extrapolated, without the change \
                   that disorder explains. A dash stands for a run that diverged, for no bubble, or for no \
                   finite elements to compare with. Runs from the reference start within 0.04 % of U_b of \
                   it: their error says that the flow stays there, and unsteady how far it would still go.";
    let shown = REYNOLDS.into_iter().filter(|&re| !best(tier, re).is_empty());
    let mut rows: Vec<Row> = Vec::new();
    for (re, reference) in shown.filter_map(|re| Some((re, reference(re)?))) {
        let about = vec!["finite elements".into(), format!("re={re}"), "–".into()];
        rows.push((about, Box::new(move |metric| reference.number(metric))));
    }
    for record in runs.simulations() {
        let settings = case::changed(&CASE, &record.spec()).join(", ");
        let about = vec![format!("`{}`", record.variant), settings, record.status.to_string()];
        rows.push((about, Box::new(|metric| record.value(metric))));
    }
    let metrics: &[Shown] = &[
        ("error of u", "U_b", L2_U, |v| Cell::percent(v, 2)),
        ("error of v", "U_b", L2_V, |v| Cell::percent(v, 2)),
        ("force", "U_b^2/H", FORCE, |v| Cell::num(v, 4)),
        ("error of it", "-", FORCE_ERROR, |v| Cell::percent(v, 2)),
        ("ripple", "-", FORCE_RIPPLE, |v| Cell::percent(v, 2)),
        ("separation", "H", SEPARATION, |v| Cell::num(v, 3)),
        ("reattachment", "H", REATTACHMENT, |v| Cell::num(v, 4)),
        ("error of shear", "-", SHEAR_ERROR, |v| Cell::percent(v, 2)),
        ("flux of sections", "-", SECTION_FLUX, |v| Cell::percent(v, 2)),
        ("drag balance", "-", DRAG_BALANCE, |v| Cell::percent(v, 2)),
        ("unsteady", "U_b", UNSTEADY, |v| Cell::sci(v, 1)),
    ];
    let table = table(caption, &["variant", "settings", "ended"], metrics, rows);
    Study::new("periodic-hill-runs", "All runs").block(table)
}

/// Particles by their velocity, with the streamlines of the reference.
fn pictures(tier: Tier, runs: &Runs) -> Study {
    let caption = "Particles of the finest run of variant `carried`, coloured by their velocity u along \
                   the channel over the bulk velocity U_b; H is the height of a hill. Thin lines are \
                   streamlines of finite elements. Thick lines enclose the fluid that circulates, black in \
                   finite elements (none at Re 10) and green for the particles.";
    let mut figure = Figure::new("periodic-hill-pictures", caption);
    let shown = REYNOLDS.into_iter().filter_map(|re| {
        let (run, reference) = best(tier, re).last().copied().zip(reference(re))?;
        Some((run, reference, runs.completed(&run.spec())?))
    });
    let shown: Vec<_> = shown.collect();
    let velocities = shown.iter().flat_map(|(.., record)| record.column("particles", "u"));
    let most = velocities.fold(0.0, |most: f64, u| most.max(u.abs()));
    for (run, reference, record) in shown {
        let title = format!("Re {}, {}", run.re, run.name());
        let axes = (Axis::linear("x [H]").range(-0.1, 9.1), Axis::linear("y [H]").range(-0.1, 3.1));
        let points = pictures::points(record, "particles", "u");
        let separation = streamlines::of_particles(&points, 1.0 / run.n as f64);
        let map = ParticleMap::new(title, axes, "u [U_b]", ColourMap::Diverging, points)
            .values(-most, most)
            .diameter(1.0 / run.n as f64)
            .line(floor())
            .curve(Series::line("", reference.line.clone()).width(2.4));
        let lines = streamlines::of_reference(&reference).into_iter();
        let thin = |map: ParticleMap, line| map.curve(Series::line("", line).width(0.7));
        let green = Series::line("", separation).colour(Colour::GREEN).width(1.2);
        figure = figure.panel(lines.fold(map, thin).curve(green));
    }
    Study::new("periodic-hill-pictures", "Pictures").block(figure.panel_size(640.0, 230.0))
}

/// What the drag of each variant is made of.
fn drags(tier: Tier, runs: &Runs) -> Study {
    let caption = "Parts of the drag at Re 50, H/dx = 10: stresses of the field, integrated over the \
                   walls. Shear agrees with finite elements to some per cent in every variant. In \
                   `interface-wall` and `modern` the drag balance fails by the pressure on the hill. The \
                   force that holds the flux, and so the drag that the particles feel, is within 4 % of \
                   finite elements, but the pressure of the field at the wall is not that of the sums that \
                   move particles.";
    let mut rows: Vec<Row> = Vec::new();
    if let Some(reference) = reference(50.0) {
        let about = vec!["finite elements".into()];
        rows.push((about, Box::new(move |metric| reference.number(metric))));
    }
    let of_tier = match tier {
        Tier::Quick => vec![QUICK],
        Tier::Full => VARIANTS.map(|variant| HillRun::rest(variant, 10)).into(),
    };
    for record in of_tier.iter().filter_map(|run| runs.completed(&run.spec())) {
        let about = vec![format!("`{}`", record.variant)];
        rows.push((about, Box::new(|metric| record.value(metric))));
    }
    let metrics: &[Shown] = &[
        ("shear on the hill", "rho U_b^2 H", DRAGS[0], |v| Cell::num(v, 3)),
        ("shear on the lid", "rho U_b^2 H", DRAGS[1], |v| Cell::num(v, 3)),
        ("pressure on the hill", "rho U_b^2 H", DRAGS[2], |v| Cell::num(v, 3)),
        ("drag balance", "-", DRAG_BALANCE, |v| Cell::percent(v, 2)),
    ];
    let table = table(caption, &["variant"], metrics, rows);
    Study::new("periodic-hill-drag", "What the drag is made of").block(table)
}

/// rms over stations of the difference of u of two runs \[U_b\].
fn difference(a: &Record, b: &Record) -> f64 {
    let [a, b] = [a, b].map(|record| record.column("stations", "u"));
    rms(a.iter().zip(b).map(|(a, b)| a - b))
}

/// From rest and from near the answer.
fn starts(runs: &Runs) -> Study {
    let mut study = Study::new("periodic-hill-starts", "From rest and from the reference");
    for pair in plan::starts() {
        let re = pair[0].re;
        let [rest, other] = pair.map(|run| runs.completed(&run.spec()));
        let gate = Gate::new(
            format!("periodic_hill.{BEST}.{re}.starts"),
            "rms over stations of the difference of u [U_b]",
            Bound::Below(0.005),
            Evidence::Invariant,
            "Both starts must lead to the same steady flow, except for what disorder leaves in averages \
             over a fifth of the run, at least 3 H/U_b.",
        );
        let Some((rest, other)) = rest.zip(other) else {
            study = study.judge(gate, f64::NAN);
            continue;
        };
        let moved = |metric| Some((other.value(metric)?, rest.value(metric)?));
        let difference = difference(rest, other);
        let bubble = moved(REATTACHMENT).map_or(String::new(), |(other, rest)| {
            format!(", reattachment by {} H", sig(other - rest, 2))
        });
        let force = moved(FORCE).map_or(f64::NAN, |(other, rest)| other / rest - 1.0);
        let text = format!(
            "Re {re}, H/dx = 10: a start from the reference changes u by {} of U_b (rms), the force by \
             {}{bubble}.",
            percent(difference, 2),
            percent(force, 2),
        );
        study = study.prose(text).judge(gate, difference);
    }
    study
}

/// Why the best variant is the best, and how near to the goal it comes.
fn reasons(runs: &Runs) -> Study {
    let study = Study::new("periodic-hill-best", "Why this variant is the best").prose(format!(
        "`{BEST}` is chosen for its force and its drag balance, not for the least error of u at every \
         spacing (table of all runs). `modern` misses the goals of both, and `consistent` comes no closer \
         to them, with terms that take more work for each pair."
    ));
    of_finest(runs).into_iter().fold(study, Study::prose)
}

/// What the error of the finest run at Re 50 owes to its start and its length.
fn of_finest(runs: &Runs) -> Option<String> {
    let run = best(Tier::Full, 50.0).last().copied()?;
    let record = runs.completed(&run.spec())?;
    let (error, left) = (record.value(L2_U)?, record.value(UNSTEADY)?);
    Some(format!(
        "The run at {} ended at {} H/U_b, before it was steady. It began near the answer, so its error may \
         be too low by what is left of the way to its own steady flow, and neither the order nor the cost \
         diagram has it. Its error and what is left, which may not add, come to {} + {} = {} of U_b; the \
         goal is 1 %.",
        run.name(),
        sig(run.end, 3),
        percent(error, 2),
        percent(left, 2),
        percent(error + left, 2),
    ))
}
