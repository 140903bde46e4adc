//! What only the channel flows have to say: the paper's claims, and one rule for every Reynolds number.

use super::{
    Channel, ChannelSettings, Flow, cures,
    declaration::at_rows,
    extremes, floor, map,
    measure::{L2_WORST, P_RMS, V_RMS},
    plan, stiff, waves,
};
use base::record::{MetricKey, Record, Status};
use harness::{
    case::{Case, Planned, Rules, Tier},
    columns::Columns,
    pictures,
    runs::Runs,
    study::Study,
};
use report::{Axis, Block, Cell, ColourMap, Figure, ParticleMap, percent};

/// The studies of a flow.
pub fn studies(channel: Channel, tier: Tier, runs: &Runs) -> Vec<Study> {
    let Channel { flow, case } = channel;
    let mut studies = vec![
        claims(channel, runs),
        floor::study(channel, tier, runs),
        reynolds(channel, tier, runs),
        stiff::study(channel, tier, runs),
    ];
    match flow {
        Flow::Couette => studies.push(extremes::study(case, tier, runs)),
        Flow::Poiseuille => studies.extend([
            waves::study(case, tier, runs),
            map::study(case, tier, runs),
            cures::study(case, tier, runs),
        ]),
    }
    studies
}

/// The claims of the paper on this flow, and a picture of the particles.
fn claims(channel: Channel, runs: &Runs) -> Study {
    let id = format!("{}-claims", channel.flow.name());
    let study = Study::new(&id, "Claims of the paper").prose(ASSUMED);
    let study = study.block(Block::List(verdicts(channel, runs)));
    match runs.record(&plan::snapshot(channel)) {
        Some(record) => study.block(snapshot(channel.flow, record)),
        None => study,
    }
}

const ASSUMED: &str = "These assumptions fill gaps of the paper and of its scan. The plates are 1 mm \
    apart, and the fluid is water (ρ = 1000 kg/m³, ν = 10⁻⁶ m²/s). V follows from Re = V L/ν; in \
    Poiseuille flow it is the speed of the centre line. The section is periodic and as short as two \
    supports allow, because the flow does not depend on x. The predictor-corrector is read as the explicit \
    midpoint rule. Particles start at rest on a square lattice, with rows half a spacing from ghost walls, \
    or on the plates where there are interface particles.";

/// H1, H2 and M4 of the paper in words.
fn verdicts(channel: Channel, runs: &Runs) -> Vec<String> {
    let [seed, walls] = ["seed", "interface-wall"].map(|variant| {
        runs.record(&at_rows(channel, variant, 20)).and_then(|record| record.value(L2_WORST))
    });
    let said = |errors: &[Option<f64>]| {
        let holds = errors.iter().all(|error| error.is_some_and(|error| error <= 0.02));
        if holds { "supported" } else { "refuted here" }
    };
    let shown = |error: Option<f64>| error.map_or("not measured".into(), |e| percent(e, 2));
    let (name, what) = match channel.flow {
        Flow::Couette => {
            ("H1", "the transient Couette profiles at Re 0.5 follow the analytic series")
        }
        Flow::Poiseuille => ("H2", "the steady Poiseuille parabola follows the analytic solution"),
    };
    vec![
        format!(
            "**{name}** ({what}) is **{}**: the largest relative L2 error of `seed` from νt/L² = 0.1 on is \
             {}; the lattice and η² can cause 1.9 %.",
            said(&[seed]),
            shown(seed)
        ),
        format!(
            "**M4** (both wall models work) is **{}** for this flow: the largest errors are {} with \
             ghosts, and {} with interface and wall particles.",
            said(&[seed, walls]),
            shown(seed),
            shown(walls)
        ),
    ]
}

/// Particles at the end of a run, coloured by velocity and by pressure.
fn snapshot(flow: Flow, record: &Record) -> Figure {
    let id = format!("{}-particles", flow.name());
    let settings: ChannelSettings = record.settings_as();
    let dx = settings.width / settings.rows as f64;
    let caption = "Particles of variant `seed` at νt/L² = 1, Re 0.5, 20 rows across the channel. Left: \
                   velocity u. Right: pressure p, exactly zero in theory; rows that slide past each other \
                   disturb it.";
    let map = |title: &str, field: &str, label: &str, colours| {
        let points = pictures::points(record, "particles", field);
        let axes = (Axis::linear("x [m]"), Axis::linear("y [m]"));
        ParticleMap::new(title, axes, label, colours, points).diameter(0.9 * dx)
    };
    Figure::new(id, caption)
        .columns(2)
        .panel(map("velocity", "u", "u [m/s]", ColourMap::Sequential))
        .panel(map("pressure", "p", "p [Pa]", ColourMap::Diverging))
}

/// The modern variant over the Reynolds number.
fn reynolds(channel: Channel, tier: Tier, runs: &Runs) -> Study {
    let id = format!("{}-reynolds", channel.flow.name());
    let caption = "Variant `modern` at 20 rows over the Reynolds number, with one rule for all settings. \
                   The rule is the quintic spline, h = dx, density diffusion 0.1, shifting 0.5, no \
                   background pressure, c0 by Morris' rule with 1 % density variation and at least 2.2 \
                   ν/h, Courant number 1 and viscous number 0.4. The quick tier leaves higher Re to the \
                   full tier.";
    type Row<'a> = (&'a Record, Rules, ChannelSettings);
    let row = |planned: Planned| {
        let record = runs.record(&planned.spec)?;
        let rules = channel.case.rules(&planned.spec).ok()?;
        Some((record, rules, record.settings_as::<ChannelSettings>()))
    };
    let reached = |(record, _, settings): &Row| match record.status {
        Status::Completed => settings.end,
        Status::Diverged { time, .. } | Status::Interrupted { time, .. } => time,
        Status::Refused { .. } => 0.0,
    };
    let shown = |metric: MetricKey, cell: fn(f64, usize) -> Cell| {
        move |(record, ..): &Row| {
            record.value(metric).map_or(Cell::text("–"), |value| cell(value, 2))
        }
    };
    let table = Columns::<Row>::default()
        .num(["Re", "-"], |(.., s)| Cell::exact(s.re))
        .num(["c0/V", "-"], |(_, rules, s)| Cell::num(rules.sound_speed / s.speed(), 3))
        .num(["dt/limit", "-"], |(_, rules, _)| Cell::num(rules.dt() / rules.dt_limit(), 2))
        .num(["νt/L² reached", "-"], move |row| Cell::num(reached(row), 3))
        .num(["worst error from νt/L² = 0.1 on", "-"], shown(L2_WORST, Cell::percent))
        .num(["rms p", "ρV²"], shown(P_RMS, Cell::sci))
        .num(["rms v", "V"], shown(V_RMS, Cell::sci))
        .num(["steps", "1"], |(record, ..)| Cell::count(record.cost.steps))
        .table(caption, plan::reynolds(channel, tier).into_iter().filter_map(row));
    Study::new(&id, "One rule for every Reynolds number").block(table)
}
