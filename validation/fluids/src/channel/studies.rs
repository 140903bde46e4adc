//! What only the channel flows have to say: the paper's claims, one rule for every Reynolds number, and what
//! a step saves that viscosity does not limit.

use super::{
    Channel, ChannelSettings, Flow, maps,
    measure::{L2_WORST, P_RMS, V_RMS},
    plan::{self, ChannelTable, For},
    stiff, waves,
};
use base::record::Record;
use harness::{case::Tier, columns::Columns, runs::Runs, study::Study};
use report::{Block, Cell, percent};

/// The studies of a flow.
pub fn studies(channel: Channel, tier: Tier, runs: &Runs) -> Vec<Study> {
    let table = &plan::table(channel, tier);
    let mut studies = vec![
        claims(channel, runs),
        reynolds(channel.flow, table, runs),
        stiff::study(channel, table, runs),
    ];
    if channel.flow == Flow::Poiseuille {
        studies.extend([waves::study(table, runs), maps::study(table, runs)]);
    }
    studies
}

const ASSUMED: &str = "These assumptions fill gaps of the paper and of its scan. The plates are 1 mm \
    apart, and the fluid is water (ρ = 1000 kg/m³, ν = 10⁻⁶ m²/s). V follows from Re = V L/ν; in \
    Poiseuille flow it is the speed of the centre line. The section is periodic and as short as two \
    supports allow, because the flow does not depend on x. The predictor-corrector is read as the explicit \
    midpoint rule. Particles start at rest on a square lattice, with rows half a spacing from ghost walls, \
    or on the plates where there are interface particles.";

/// H1, H2 and M4 of the paper in words.
fn claims(Channel { flow, case }: Channel, runs: &Runs) -> Study {
    let [seed, walls] = ["seed", "interface-wall"].map(|variant| {
        let record = runs.record(&case.spec(variant, |s| s.rows = 20));
        record.and_then(|record| record.value(L2_WORST)).unwrap_or(f64::NAN)
    });
    let said = |errors: &[f64]| {
        if errors.iter().all(|error| *error <= 0.02) { "supported" } else { "refuted here" }
    };
    let (name, what) = match flow {
        Flow::Couette => {
            ("H1", "the transient Couette profiles at Re 0.5 follow the analytic series")
        }
        Flow::Poiseuille => ("H2", "the steady Poiseuille parabola follows the analytic solution"),
    };
    let verdicts = vec![
        format!(
            "**{name}** ({what}) is **{}**: the largest relative L2 error of `seed` from νt/L² = 0.1 on is \
             {}; the lattice and η² can cause 1.9 %.",
            said(&[seed]),
            percent(seed, 2)
        ),
        format!(
            "**M4** (both wall models work) is **{}** for this flow: the largest errors are {} with \
             ghosts, and {} with interface and wall particles.",
            said(&[seed, walls]),
            percent(seed, 2),
            percent(walls, 2)
        ),
    ];
    let study = Study::new(&format!("{}-claims", flow.name()), "Claims of the paper");
    study.prose(ASSUMED).block(Block::List(verdicts))
}

/// The modern variant over the Reynolds number.
fn reynolds(flow: Flow, table: &ChannelTable, runs: &Runs) -> Study {
    let caption = "Variant `modern` at 20 rows over the Reynolds number, with one rule for all settings. \
                   The rule is the quintic spline, h = dx, density diffusion 0.1, shifting 0.5, no \
                   background pressure, c0 by Morris' rule with 1 % density variation and at least 2.2 \
                   ν/h, Courant number 1 and viscous number 0.4. The quick tier leaves higher Re to the \
                   full tier, in which Poiseuille flow at Re 1000 shows where the rule breaks.";
    let settings = |record: &Record| record.settings_as::<ChannelSettings>();
    let shown = Columns::<Record>::default()
        .num(["Re", "-"], move |record| Cell::exact(settings(record).re))
        .num(["to νt/L²", "-"], move |record| Cell::exact(settings(record).end))
        .percent("worst error from νt/L² = 0.1 on", "-", L2_WORST, 1.0)
        .metric(["rms p", "ρV²"], P_RMS, |value| Cell::sci(value, 2))
        .metric(["rms v", "V"], V_RMS, |value| Cell::sci(value, 2))
        .ended()
        .steps()
        .table(caption, runs.records(table.specs(For::Reynolds)));
    let id = format!("{}-reynolds", flow.name());
    Study::new(&id, "One rule for every Reynolds number").block(shown)
}
