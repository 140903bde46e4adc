//! Studies of the channel flows: profiles against exact ones, ladders of resolutions, an error budget,
//! the largest stable steps, maps and the errors of constants that gates must detect; and studies of channels
//! only: the gain of a step that viscosity does not limit, and the paper's hypotheses on waves and
//! instability. Its claims on profiles (H1, H2) and walls (M4) are gates.

use nalgebra::Vector2;
use touchstone_base::{
    mutation::Constant,
    record::{MetricName, Status},
    spec::{Bisect, EndAfter},
};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Case, Drawn, Draws, Statement, SubmittedCurve},
    studies::{
        Accuracy, Breaks, Budgets, Card, Change, Comparison, Comparisons, CurveOf, CurvePanel,
        Curves, Ladder, OF_THEORY, ORDER, Sensitivity, Spacing, Stated, StepLimit, StepLimits,
        Watched,
        causes::{ENOUGH_OR_IDLE, NOT_MEASURED, SAFETY_MARGIN, STEP, STRESS, WIDE_BOUNDS},
    },
};
use touchstone_maths::exact::StartUp;
use touchstone_report::Axis;

use super::{
    ChannelSettings, ChannelTable, Flow, Group, ladder, maps,
    measure::{
        ALL, L2, L2_WORST, LINF, SHEAR_LOWER, SHEAR_UPPER, U, U_EXACT, V_RMS, Y, profile_at,
    },
    plan, stiff, waves,
};

/// The studies of a flow.
pub fn studies(flow: Flow, tier: Tier) -> Studies {
    let table = plan::table(flow, tier);
    let at_half = at_half(flow, tier, &table);
    let is_poiseuille = flow == Flow::Poiseuille;
    let (card, comparisons) = (card(flow, &at_half), comparisons(flow, &at_half));
    let budgets = budgets(flow, tier, &at_half);
    Studies::judging(table.plan())
        .with(stiff::study(flow, &table))
        .with_all(is_poiseuille.then(|| waves::study(&table)))
        .with_all(is_poiseuille.then(|| maps::study(&table)))
        .with(curves(flow))
        .with(at_half)
        .with(comparisons)
        .with(budgets)
        .with(limits(flow, tier))
        .with(sensitivity(flow, tier))
        .with_all(maps::all(&table))
        .with(card)
}

/// The facts of a flow.
pub fn facts() -> Facts {
    let boundary = "No slip: at both plates the velocity is that of the plate, which is 0 unless the plate \
                    has a velocity. Nothing passes a plate. The velocity at the start is that of the \
                    particles. x is periodic.";
    Facts {
        statement: Statement::new(boundary, &[ALL]),
        is_stable: Some(is_stable),
        curve: Some(profile()),
        sealed: Some(SEALED),
        late_variant: Some("curved"),
        ..Facts::default()
    }
}

/// The series is exact at any Reynolds number; the judged run has 20 rows, and from there to drawn
/// resolutions errors change with the second order of walls and kernel.
const SEALED: Draws = Draws {
    others: &[("re", Drawn::Between(0.05, 20.0))],
    free: &["end"],
    ..Draws::new(&["modern", "curved"], ("rows", [14.0, 32.0]), 2.0, &["l2_worst", "l2@1"])
};

/// The velocities of rows across the channel: each row of particles represents one.
fn profile() -> SubmittedCurve {
    SubmittedCurve {
        columns: &[("y", "m"), ("u", "m/s")],
        about: "y is the distance from the lower plate, u the velocity along the plates; a line for each row \
                of the problem, y ascending",
        least: 0,
        rows: |run| run.settings_as::<ChannelSettings>().rows,
        place: |run, at, starts| {
            let ChannelSettings { width, .. } = run.settings_as();
            let place = |start: &Vector2<f64>| {
                let row = &at[((start.y / width * at.len() as f64) as usize).min(at.len() - 1)];
                [Vector2::new(start.x, row[0]), Vector2::new(row[1], 0.0)]
            };
            starts.iter().map(place).collect()
        },
        metrics: vec![L2, LINF, SHEAR_LOWER, SHEAR_UPPER, L2_WORST],
        coarsen: None,
        shown: &[Y, U, U_EXACT],
    }
}

/// The recommended variant and the paper's over their ladders.
fn comparisons(flow: Flow, accuracy: &Accuracy) -> Comparisons {
    let exact = (0.0, "exact: the series has the same inputs, and is summed to round-off");
    let compared =
        |ladder: &&Ladder| [flow.case().recommended.variant, "seed"].contains(&ladder.variant);
    let of = |ladder| {
        let what = "velocity from νt/L² = 0.1 on, rms";
        Comparison::new(what, "the exact series", L2_WORST, ladder, exact)
    };
    Comparisons(accuracy.ladders.iter().filter(compared).map(of).collect())
}

/// Summary of the flow in the report.
fn card(flow: Flow, accuracy: &Accuracy) -> Card {
    let (title, picture) = match flow {
        Flow::Couette => ("Couette flow", "couette-profiles"),
        Flow::Poiseuille => ("Poiseuille flow", "poiseuille-profiles"),
    };
    Card {
        title,
        picture,
        pictured_scene: "",
        metric: L2_WORST.into(),
        stated: |run| {
            let name =
                "velocity at Re {re}, {rows} rows, largest relative rms from νt/L² = 0.1 to {end}";
            Stated::new(run, name, "the exact series")
        },
        beside: None,
        runs: accuracy.finest(&[flow.case().recommended.variant, "seed"]),
        breaks: Breaks {
            value: |run| run.settings_as::<ChannelSettings>().re,
            words: ["Re ", ""],
            has_broken: maps::has_broken,
            sign: "velocity error above 5 %",
        },
    }
}

/// The ladders at Re 0.5.
fn at_half(flow: Flow, tier: Tier, table: &ChannelTable) -> Accuracy {
    let because = "Mirrored walls and the kernel are of second order. Levels whose error is near the \
                   lattice error, which no spacing reduces, are not in the fit.";
    // Couette flow is judged at νt/L² = 0.1, where the quick tier has too few rows in the moving layer.
    let is_judged = |variant: &str| match flow {
        Flow::Couette => (variant, tier) == ("consistent", Tier::Full),
        Flow::Poiseuille => variant == "plain",
    };
    let order = |variant: &str| {
        let id = format!("{}.{variant}.order", flow.case().name);
        Gate::new(id, ORDER, Bound::Within(1.8, 2.2), Evidence::Theory, because)
    };
    let spacing = Spacing::count(|s: &mut ChannelSettings| &mut s.rows, "{} rows");
    let of = |variant| Ladder {
        order: is_judged(variant).then(|| order(variant)),
        ..table.ladder(&[Group::Ladder], variant, spacing)
    };
    Accuracy {
        about: "Runs at Re 0.5 to νt/L² = 1; the error is the largest relative L2 error of the velocity from \
                νt/L² = 0.1 on."
            .into(),
        judged: Some(L2.at(flow.compared_at())),
        spacing: "Δx/L [-]",
        ladders: ladder(flow).map(of).into(),
        ..Accuracy::new(flow.case().name, L2_WORST, "error of the velocity [-]")
    }
}

/// Times that fit into a figure.
const SHOWN: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 1.0];

/// u/V across the channel, and how far it is from the series.
fn curves(flow: Flow) -> Curves {
    let recommended = flow.case().recommended.variant;
    let plates = StartUp { v: 1.0, l: 1.0, nu: 1.0 };
    let exact = |tau: f64| {
        let heights = (0..=100).map(|k| f64::from(k) / 100.0);
        let points = heights.map(|y| (flow.exact(&plates, y, tau), y));
        ("exact series".to_string(), points.collect())
    };
    // The velocity of each row, or its difference from the series in % of V.
    let line = |variant: &str, tau: f64, is_difference: bool| {
        CurveOf::new(
            format!("νt/L² = {tau}"),
            flow.case().spec(variant, |s| s.rows = 20),
            move |record: &Record| {
                let settings: ChannelSettings = record.run.settings_as();
                let Some(profile) = profile_at(record, tau) else { return Vec::new() };
                let [u, exact, y] = [U, U_EXACT, Y].map(|key| profile.column(key.name));
                let shown = |k: usize| match is_difference {
                    true => 100.0 * (u[k] - exact[k]) / settings.speed(),
                    false => u[k] / settings.speed(),
                };
                // Columns of a damaged record may be of different lengths.
                let rows = [u, exact, y].map(<[f64]>::len).into_iter().min().unwrap_or_default();
                (0..rows).map(|k| (shown(k), y[k] / settings.width)).collect()
            },
        )
        .cycled()
    };
    let panel = |title: String, x: &str, lines: Vec<CurveOf>, references| {
        let (x, y) = (Axis::linear(x), Axis::linear("y/L [-]").range(0.0, 1.0));
        CurvePanel { title, x, y, lines, references, symbols: true }
    };
    let of_difference = |variant: &str| {
        let lines = SHOWN.map(|tau| line(variant, tau, true)).into();
        let zero = vec![(String::new(), vec![(0.0, 0.0), (0.0, 1.0)])];
        panel(format!("{variant}: computed minus exact"), "(u − u_exact)/V [%]", lines, zero)
    };
    let lines = SHOWN.map(|tau| line(recommended, tau, false)).into();
    let velocity =
        panel(format!("{recommended}: velocity"), "u/V [-]", lines, SHOWN.map(exact).into());
    let caption = "Where in the channel is the velocity wrong? Means over rows at Re 0.5, 20 rows, minus the \
                   exact series; mind the scales.";
    let panels = vec![velocity, of_difference(recommended), of_difference("seed")];
    let id = format!("{}-profiles", flow.case().name);
    Curves::new(id, "Velocity across the channel", caption, panels)
}

fn budgets(flow: Flow, tier: Tier, accuracy: &Accuracy) -> Budgets {
    let variants: &[&str] = match (tier, flow) {
        (Tier::Quick, _) => &["seed"],
        (_, Flow::Couette) => &["seed", "plain"],
        (_, Flow::Poiseuille) => &["seed", "plain", "curved"],
    };
    let of = variants.iter().map(|variant| changes(flow, variant, tier)).collect();
    Budgets::new(accuracy, "Runs have 20 rows and Re 0.5.", of)
}

fn changes(flow: Flow, variant: &str, tier: Tier) -> Vec<Change> {
    let case = flow.case();
    let spec = |set: &dyn Fn(&mut ChannelSettings)| case.spec(variant, set);
    // Without rules of its step every run of a variant is refused, and its record states why.
    let rules = case.rules(&spec(&|_| ())).unwrap_or(Rules::REFUSED);
    let (dt, stiffer) = (rules.dt(), 2.0 * rules.sound_speed);
    let (wall, other, ratio, eta2) = match variant {
        "seed" => ("interface and wall particles", "interface-wall", 1.5, 1e-5),
        _ => ("wall particles that extrapolate", "extrapolating-wall", 1.3, 1e-9),
    };
    let stiffer = spec(&|s| (s.c0, s.dt) = (Some(stiffer), Some(0.25 * dt)));
    let mut changes = vec![
        Change::new("none", "–", spec(&|_| ())),
        Change::new("dt/4", "time", spec(&|s| s.dt = Some(0.25 * dt))),
        Change {
            against: 1,
            ..Change::new("c0 × 2 and dt/4, against dt/4", "compressibility (Ma²)", stiffer)
        },
        Change::new("dt/2", "time", spec(&|s| s.dt = Some(0.5 * dt))),
        Change::new("h/dx + 0.3", "kernel sums on the lattice", spec(&|s| s.h_over_dx = ratio)),
        Change::new("eta² × 1e-3", "guard in the viscous term", spec(&|s| s.eta2_over_h2 = eta2)),
        Change::new(wall, "wall", case.spec(other, |_| ())),
    ];
    if tier == Tier::Full {
        changes.push(Change::new("40 rows", "spacing: wall and kernel", spec(&|s| s.rows = 40)));
    }
    if flow == Flow::Poiseuille {
        let curved = spec(&|s| s.wall_curvature = variant != "curved");
        changes.push(Change::new("curvature in the ghosts on/off", "wall", curved));
    }
    changes
}

/// Steps of a run; growth of 1 % a step fills the eight decades from the disturbance to V.
const STEPS: f64 = 1500.0;
/// Disorder of the lattice at the start \[dx\].
const DISORDER: f64 = 1e-6;

/// Completed, and neither cross-flow nor error is as large as the flow itself.
pub fn is_stable(record: &Record) -> bool {
    let is_small = |metric: MetricName| record.value(metric).is_some_and(|value| value < 1.0);
    let settings: ChannelSettings = record.run.settings_as();
    let mut compared = settings.compared().into_iter();
    record.status == Status::Completed
        && is_small(V_RMS.into())
        && compared.all(|tau| is_small(L2.at(tau)))
}

/// The step limits of a flow: all of Couette flow in the full tier; for Poiseuille flow the paper's variant,
/// and the variants that Couette flow lacks.
fn limits(flow: Flow, tier: Tier) -> StepLimits {
    let variants = match (flow, tier) {
        (Flow::Couette, Tier::Quick) => vec!["seed", "modern"],
        (Flow::Couette, _) => ladder(Flow::Couette).into(),
        (Flow::Poiseuille, Tier::Quick) => vec!["seed"],
        (Flow::Poiseuille, _) => vec!["seed", "curved", "consistent"],
    };
    let about = format!(
        "The default step of each variant, and how many times longer it could be, for 20 rows between walls \
         on a lattice disturbed by {DISORDER:e} dx, over {STEPS} steps. A run is unstable if it diverges, \
         or if its cross-flow or error exceeds V. Theory is that of the periodic lattice with sound, \
         viscosity and other damping, without walls, motion and stabilisers."
    );
    let of = variants.into_iter().map(|variant| limit(flow, variant));
    StepLimits { about, of: of.collect() }
}

fn limit(flow: Flow, variant: &'static str) -> StepLimit {
    let spec = flow.case().spec(variant, |s| s.jitter = DISORDER).allow_unstable();
    let rules = flow.case().rules(&spec).unwrap_or(Rules::REFUSED);
    // Not `dt_limit`, in the last bit: bisections begin where they always have.
    let theory = rules.dt() / (rules.dt() / rules.dt_limit());
    let unit = ChannelSettings::default().unit_of_time();
    let bisect = Bisect {
        setting: "dt".into(),
        guess: theory,
        unit: 1.0,
        resolution: 0.01,
        end: Some(EndAfter { steps: STEPS, unit }),
    };
    let name = match flow {
        Flow::Couette => format!("stability.default.{variant}"),
        Flow::Poiseuille => format!("poiseuille.time-step.{variant}"),
    };
    let because = "The default step must be below the measured limit; the bound is the default step over \
                   the limit of theory.";
    let (id, bound) = (format!("{name}.stable"), Bound::Above(rules.dt() / theory));
    let gate = Gate::new(id, OF_THEORY, bound, Evidence::Theory, because);
    StepLimit {
        scene: "20 rows".into(),
        spec: spec.bisect(bisect),
        theory,
        theory_at: theory,
        default_at: rules.dt(),
        gate: Some(gate),
    }
}

const SOUND: &str =
    "At Mach 0.1 compressibility changes the velocity by less than the spacing does.";
const STRAIGHT_ROWS: &str =
    "At Re 0.5 particles stay in straight rows, and this term acts on disorder alone.";
const REACH: &str = "The error that a longer reach adds to a parabolic profile at 20 rows is inside the \
                     bounds until the reach is wrong by 20 %.";
const LISTS: &str = "A list that is kept 30 % too long still has every neighbour, because it is rebuilt \
                     before a particle crosses half of the skin.";

/// The runs with the most gates, one without and one with density diffusion and shifting.
fn sensitivity(flow: Flow, tier: Tier) -> Sensitivity {
    let (case, reach) = (flow.case(), Constant::SmoothingLength);
    let (drive, reach) = match flow {
        Flow::Couette => (Constant::WallSpeed, Watched::new(reach)),
        Flow::Poiseuille => {
            (Constant::BodyForce, Watched::blind_up_to(reach, 0.2, REACH, &WIDE_BOUNDS))
        }
    };
    let watched = [
        Watched::new(drive).quick().faults(&[-1.0, 0.5]),
        Watched::new(Constant::Viscosity).quick(),
        Watched::new(Constant::Height).quick(),
        Watched::blind_up_to(Constant::Density, 0.3, STRESS, &NOT_MEASURED),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, SOUND, &NOT_MEASURED),
        Watched::new(Constant::Normalisation),
        reach,
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP, &SAFETY_MARGIN),
        Watched::blind_up_to(Constant::DensityDiffusion, 1.0, STRAIGHT_ROWS, &ENOUGH_OR_IDLE)
            .faults(&[-1.0]),
        Watched::blind_up_to(Constant::Shifting, 1.0, STRAIGHT_ROWS, &ENOUGH_OR_IDLE)
            .faults(&[-1.0]),
        Watched::blind_up_to(Constant::ListLifetime, 1.0, LISTS, &SAFETY_MARGIN).faults(&[100.0]),
    ];
    let runs = [case.spec("plain", |_| {}), case.spec("modern", |s| s.end = 1.5)];
    Sensitivity::new(tier, runs, watched)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gates of a variant with refused default settings must exist.
    #[test]
    fn a_variant_that_is_refused_keeps_its_gates() {
        let gate = limit(Flow::Couette, "no such variant").gate.expect("a gate");
        assert_eq!(gate.id, "stability.default.no such variant.stable");
        assert!(gate.judge(None).verdict.is_failure());
    }
}
