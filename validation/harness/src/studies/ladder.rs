//! Ladders of resolutions: runs of one variant, coarse to fine.

use std::{fmt, sync::Arc};

use touchstone_base::{
    functions::powf,
    gate::Gate,
    settings::{self, Settings},
    spec::{Keep, RunSpec},
};

use crate::runs::Planned;

/// Levels by which a ladder of the deep tier is longer.
pub const FINER: i32 = 2;

/// The setting that decides the spacing of the runs of a ladder, with its resolution in words.
pub struct Spacing<T> {
    setting: RefinedSetting<T>,
    beside: Option<Count<T>>,
    length: fn(&T) -> f64,
    words: &'static str,
}

/// A number of spacings among settings.
type Count<T> = fn(&mut T) -> &mut usize;

enum RefinedSetting<T> {
    Count(Count<T>),
    Length(fn(&mut T) -> &mut f64),
}

impl<T> Clone for RefinedSetting<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for RefinedSetting<T> {}

impl<T> Clone for Spacing<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Spacing<T> {}

impl<T: Settings> Spacing<T> {
    /// A setting that is the number of spacings in the unit of length; in the words of its resolution `{}` is
    /// replaced by the number.
    pub fn count(setting: fn(&mut T) -> &mut usize, words: &'static str) -> Self {
        Self { setting: RefinedSetting::Count(setting), beside: None, length: |_| 1.0, words }
    }

    /// A setting that is the spacing; in the words of its resolution `{}` is replaced by the number of
    /// spacings in the unit of length.
    pub fn length(setting: fn(&mut T) -> &mut f64, words: &'static str) -> Self {
        Self { setting: RefinedSetting::Length(setting), beside: None, length: |_| 1.0, words }
    }

    /// Counts the spacings in another length, in the unit of [`Accuracy::spacing`](super::Accuracy::spacing).
    #[must_use]
    pub fn over(self, length: fn(&T) -> f64) -> Self {
        Self { length, ..self }
    }

    /// Adds another number of spacings that changes in proportion.
    #[must_use]
    pub fn beside(self, other: fn(&mut T) -> &mut usize) -> Self {
        Self { beside: Some(other), ..self }
    }

    /// The level of a run.
    pub(crate) fn level(self, run: Planned, settings: &T) -> Level {
        let (words, length, mut settings) = (self.words, (self.length)(settings), settings.clone());
        let (spacing, count) = match self.setting {
            RefinedSetting::Count(setting) => {
                let count = *setting(&mut settings);
                (length / count as f64, count)
            }
            RefinedSetting::Length(setting) => {
                let spacing = *setting(&mut settings);
                (spacing, (length / spacing).round() as usize)
            }
        };
        Level { run, spacing, resolution: Resolution { count, words } }
    }

    /// The level of this run with its spacing multiplied by a factor, whole numbers rounded; none if a
    /// setting is then out of range.
    pub(crate) fn refined(self, run: &RunSpec, factor: f64) -> Option<Level> {
        let mut finer: T = settings::of_json(&run.settings).ok()?;
        let refine = |count: &mut usize| *count = (*count as f64 / factor).round() as usize;
        match self.setting {
            RefinedSetting::Count(setting) => refine(setting(&mut finer)),
            RefinedSetting::Length(setting) => *setting(&mut finer) *= factor,
        }
        self.beside.iter().for_each(|other| refine(other(&mut finer)));
        settings::validate(&finer).ok()?;
        let settings = settings::to_json(&finer);
        let run = RunSpec { keep: Keep::default(), settings, ..run.clone() };
        Some(self.level(Planned::new(run), &finer))
    }
}

/// Metric of a gate on the order of a ladder.
pub const ORDER: &str = "order";

/// A run with its spacing multiplied by a factor, as a level of a ladder; none if the case has no such run.
pub type Refine = Arc<dyn Fn(&RunSpec, f64) -> Option<Level> + Send + Sync>;

/// Runs of one variant over resolutions.
pub struct Ladder {
    /// Name of the variant.
    pub variant: &'static str,
    /// The runs, coarse to fine.
    pub levels: Vec<Level>,
    /// Gate on the order, if it is judged.
    pub order: Option<Gate>,
    /// How a run of it is refined.
    pub refine: Refine,
}

impl Ladder {
    /// Adds a run before the finer ones.
    pub(crate) fn add(&mut self, level: Level) {
        let place = self.levels.partition_point(|other| other.spacing >= level.spacing);
        self.levels.insert(place, level);
    }

    /// Goes on by the ratio of the last two spacings.
    pub(crate) fn deepen(&mut self) {
        let [.., coarse, fine] = self.levels.as_slice() else { return };
        let ratio = fine.spacing / coarse.spacing;
        let next = |steps| (self.refine)(&fine.run.spec, powf(ratio, f64::from(steps)));
        let finer: Vec<Level> =
            (1..=FINER).filter_map(next).filter(|of| of.spacing < fine.spacing).collect();
        self.levels.extend(finer);
    }
}

/// A run at a resolution, such as one of a ladder.
#[derive(Clone)]
pub struct Level {
    /// The run and its gates.
    pub run: Planned,
    /// Spacing, in the unit of [`Accuracy::spacing`](super::Accuracy::spacing).
    pub spacing: f64,
    /// The resolution in words.
    pub resolution: Resolution,
}

/// A resolution: a number of spacings, such as 20 of `{} rows`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Resolution {
    /// The number.
    pub count: usize,
    /// Words in which `{}` is replaced by the number.
    pub words: &'static str,
}

impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words.replace("{}", &self.count.to_string()))
    }
}
