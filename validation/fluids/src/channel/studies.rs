//! What only the channel flows have to say: one rule for every Reynolds number, what a step saves that
//! viscosity does not limit, and the paper's hypotheses on waves and instability. Its claims on profiles (H1,
//! H2) and walls (M4) are gates.

use super::{
    Channel, ChannelSettings, Flow, maps,
    measure::{L2_WORST, P_RMS, V_RMS},
    plan,
    runs::{ChannelTable, For},
    stiff, waves,
};
use base::record::Record;
use harness::{case::Tier, columns::Columns, runs::Runs, study::Study};
use report::Cell;

/// The studies of a flow.
pub fn studies(channel: Channel, tier: Tier, runs: &Runs) -> Vec<Study> {
    let (flow, table) = (channel.flow, &plan::table(channel, tier));
    let mut studies = vec![reynolds(flow, table, runs), stiff::study(flow, table, runs)];
    if flow == Flow::Poiseuille {
        studies.extend([waves::study(table, runs), maps::study(table, runs)]);
    }
    studies
}

/// The modern variant over the Reynolds number.
fn reynolds(flow: Flow, table: &ChannelTable, runs: &Runs) -> Study {
    let caption = "Variant `modern` at 20 rows over the Reynolds number, with the same settings. The quick \
                   tier leaves higher Re to the full tier, in which Poiseuille flow at Re 1000 shows where \
                   the rule breaks.";
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
