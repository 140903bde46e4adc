//! Hypothesis H3 of the paper: pressure waves leave the walls. The lowest pressure mode between them
//! oscillates with the period 2L/c0 of a wave that bounces between them, at any c0.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use touchstone_base::spec::RunSpec;
use touchstone_harness::prelude::*;
use touchstone_harness::{
    runs::{Judged, Runs},
    section::Section,
    studies::{CustomStudy, Study},
};
use touchstone_maths::metrics::spectrum::dominant_period;

use super::{
    ChannelTable, Group, Row,
    measure::{MODE, MODE_TIME},
};

/// Adds the runs at Re 20, to νt/L² = 1.5, for waves are judged by the end of a run: two sound speeds \[V\].
/// The instability grows from the disorder of the start, 1e-4 dx, or from round-off if there is none.
pub fn runs(table: &mut ChannelTable) {
    table.over(Group::Waves, &["seed"], [&[10.0, 20.0]; 2], |s, sound| {
        (s.re, s.end, s.jitter, s.watch_mode) = (20.0, 1.5, 1e-4, true);
        s.c0 = Some(sound * s.speed());
    });
}

/// The dominant period \[2L/c0\] of the mode; NaN, which fails a gate, if the run ended too early to
/// determine it.
fn period(record: Option<&Record>) -> f64 {
    let mode = record.map(|record| record.curve([MODE_TIME, MODE])).filter(|mode| !mode.is_empty());
    mode.map_or(f64::NAN, |mode| 0.5 * dominant_period(&mode))
}

/// Periods \[2L/c0\] that count as a bouncing wave: the next modes have 0.5 and, between a wall and a free
/// surface, 2, and the ends are the geometric means. Theory does not predict the effect of disorder on the
/// period.
const PERIOD: Bound = Bound::Within(FRAC_1_SQRT_2, SQRT_2);
/// Earlier results of this program, from the same starts, by the sound speed \[V\]; a deviation of 3 %
/// indicates a change of the program.
const BEFORE: [(f64, f64); 2] = [(10.0, 1.0535), (20.0, 1.0608)];

/// The study.
pub fn study(table: &ChannelTable) -> impl Study + use<> {
    let of = |row: &Row| {
        ((row.settings.c0.unwrap_or(f64::NAN) / row.settings.speed()).round(), row.run.spec.clone())
    };
    let all: Vec<(f64, RunSpec)> = table.of(Group::Waves).map(of).collect();
    CustomStudy {
        runs: table.planned(Group::Waves),
        section: move |runs: &Runs| section(&all, runs),
    }
}

/// The section of the runs, each with its sound speed \[V\].
fn section(all: &[(f64, RunSpec)], runs: &Runs) -> Section {
    let because = "H3 says that waves bounce between the ghost walls, so the lowest mode has about the \
                   period 2L/c0. No theory says by how much disorder lengthens it. The same start gives the \
                   same bits, 1.0535 at c0/V = 10 and 1.0608 at 20, so that 3 % more or less is a change of \
                   the program. Over five starts the median was 1.16 and 1.09.";
    let judged = all.iter().map(|(sound, spec)| {
        let id = format!("poiseuille.h3.period.c{sound}");
        let before = BEFORE.iter().find(|(of, _)| of == sound).map_or(0.0, |(_, period)| *period);
        let bound = Bound::Within(0.97 * before, 1.03 * before);
        let gate = Gate::new(id, "period [2L/c0]", bound, Evidence::Regression, because);
        (gate, period(runs.record(spec)))
    });
    let judged: Vec<(Gate, f64)> = judged.collect();
    let is_supported = judged.iter().all(|(_, period)| PERIOD.contains(*period));
    let words = format!(
        "**H3** (pressure waves leave the ghost-particle walls and keep bouncing between them) is **{}**. \
         The gates hold the period of the lowest pressure mode, cos(πy/L), against 2L/c0, that of a wave \
         between the walls; in the exact flow the mode is 0. Measured are the last 60 L/c0 of Poiseuille \
         flow of `seed` at Re 20, whose start is disordered by 1e-4 dx, before it diverges or ends at \
         νt/L² = 1.5.",
        if is_supported { "supported" } else { "open" }
    );
    let title = "Pressure waves between the walls";
    let mut section = Section::new("poiseuille-h3", title).prose(words);
    let judged = judged.into_iter();
    let judged = judged.map(|(gate, period)| Judged::in_unit("2L/c0", gate, Some(period)));
    section.judged.extend(judged);
    section
}
