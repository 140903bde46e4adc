//! The table of the runs of a case: variants over values of settings, for each tier, with their groups.
//!
//! A case states its runs here once. Its plan, its ladders and its studies look them up by group, and do
//! not repeat variants, resolutions or tiers.

use touchstone_base::{gate::Gate, mutation::Disorder, settings::Settings, spec::RunSpec};
use touchstone_report::ColourMap;

use std::{ops::RangeInclusive, sync::Arc};

use crate::{
    composed::Composed,
    pictures::{self, Heading, Picture, PicturePanel},
    runs::{Planned, Tier},
    studies::{Ladder, Spacing},
};

/// Difference between the starts of an ensemble \[dx\]: less than any method or experiment knows, and more
/// than round-off.
const DISORDER: f64 = 1e-6;

/// One run of a table.
pub struct Row<T, G> {
    /// Its group.
    pub group: G,
    /// Name of the variant.
    pub variant: &'static str,
    /// Its settings.
    pub settings: T,
    /// The run and its gates.
    pub run: Planned,
}

impl<T, G> Row<T, G> {
    /// A panel of its particles at the end, of this spacing in the unit of their places.
    pub fn panel(&self, title: impl Into<String>, spacing: f64) -> PicturePanel {
        let (spec, profile) = (self.run.spec.clone(), pictures::END.into());
        PicturePanel { title: title.into(), spec, profile, spacing, lines: Vec::new() }
    }
}

/// The runs of a case in one tier; a table of a page is a [`touchstone_report::Table`]. `G` is the group of a
/// run, an enum of the case.
pub struct Table<T: 'static, G> {
    case: &'static Composed<T>,
    tier: Tier,
    /// The runs, in the order in which they are stated.
    pub rows: Vec<Row<T, G>>,
}

impl<T: Settings, G: Copy + PartialEq> Table<T, G> {
    /// No runs yet.
    pub fn new(case: &'static Composed<T>, tier: Tier) -> Self {
        Self { case, tier, rows: Vec::new() }
    }

    /// Adds each of the variants with each of the values of the quick or of the full tier; `set` applies one.
    pub fn over<V: Copy>(
        &mut self,
        group: G,
        variants: &[&'static str],
        [quick, full]: [&[V]; 2],
        set: impl Fn(&mut T, V),
    ) {
        let values = if self.tier == Tier::Quick { quick } else { full };
        for &variant in variants {
            for &value in values {
                let mut settings = self.case.defaults(variant);
                set(&mut settings, value);
                self.row(group, variant, settings);
            }
        }
    }

    /// Adds one run, in both tiers, and gives its row, so that it can be timed, shown or kept.
    pub fn one(
        &mut self,
        group: G,
        variant: &'static str,
        set: impl FnOnce(&mut T),
    ) -> &mut Row<T, G> {
        self.row(group, variant, self.case.chosen(variant, set))
    }

    fn row(&mut self, group: G, variant: &'static str, settings: T) -> &mut Row<T, G> {
        let run = Planned::new(self.case.spec_of(variant, &settings));
        let place = self.rows.len();
        self.rows.push(Row { group, variant, settings, run });
        &mut self.rows[place]
    }

    /// Adds the members of an ensemble, in both tiers: one run for each seed, with equal settings.
    pub fn starts(
        &mut self,
        group: G,
        variant: &'static str,
        seeds: RangeInclusive<u32>,
        set: impl Fn(&mut T),
    ) {
        for seed in seeds {
            let run = &mut self.one(group, variant, &set).run;
            run.spec = run.spec.clone().disordered(Disorder { most: DISORDER, seed });
        }
    }

    /// Keeps the particles of the runs that figures show.
    pub fn keep_particles(&mut self, is_shown: impl Fn(&Row<T, G>) -> bool) {
        for row in &mut self.rows {
            row.run.spec.keep.particles = is_shown(row);
        }
    }

    /// Gives every row the gates that `gates` states of it.
    pub fn judge(&mut self, gates: impl Fn(&Row<T, G>) -> Vec<Gate>) {
        for row in &mut self.rows {
            let gates = gates(row);
            row.run.gates.extend(gates);
        }
    }

    /// The rows of a group.
    pub fn of(&self, group: G) -> impl Iterator<Item = &Row<T, G>> {
        self.rows.iter().filter(move |row| row.group == group)
    }

    /// The runs of a group.
    pub fn specs(&self, group: G) -> impl Iterator<Item = RunSpec> {
        self.of(group).map(|row| row.run.spec.clone())
    }

    /// The runs of a group with their gates.
    pub fn planned(&self, group: G) -> Vec<Planned> {
        self.of(group).map(|row| row.run.clone()).collect()
    }

    /// The ladder of a variant over the runs of some groups, from coarse to fine, whose order is not judged.
    pub fn ladder(&self, groups: &[G], variant: &'static str, spacing: Spacing<T>) -> Ladder {
        let refine = Arc::new(move |run: &RunSpec, factor| spacing.refined(run, factor));
        let mut ladder = Ladder { variant, levels: Vec::new(), order: None, refine };
        for row in &self.rows {
            if row.variant == variant && groups.contains(&row.group) {
                ladder.add(spacing.level(row.run.clone(), &row.settings));
            }
        }
        ladder
    }

    /// The ladders of variants over the runs of some groups; a variant without such runs has none.
    pub fn ladders(
        &self,
        groups: &[G],
        variants: &[&'static str],
        spacing: Spacing<T>,
    ) -> Vec<Ladder> {
        let ladders = variants.iter().map(|variant| self.ladder(groups, variant, spacing));
        ladders.filter(|ladder| !ladder.levels.is_empty()).collect()
    }

    /// A picture of the runs that keep particles; `panels` gives the panels of one run.
    pub fn picture(
        &self,
        heading: Heading,
        colours: (&'static str, ColourMap),
        size: [f64; 2],
        panels: impl Fn(&Row<T, G>) -> Vec<PicturePanel>,
    ) -> Picture {
        let (mut all, columns) = (Vec::new(), 1);
        for row in &self.rows {
            if row.run.spec.keep.particles {
                all.extend(panels(row));
            }
        }
        let shown = |value| value;
        Picture { heading, colours, size, panels: all, columns, shown, range: None, film: None }
    }

    /// The plan: every run with its gates.
    pub fn plan(&self) -> Vec<Planned> {
        self.rows.iter().map(|row| row.run.clone()).collect()
    }
}
