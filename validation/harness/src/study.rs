//! A study: a question about a case that takes runs to answer, and its answer from their records.
//!
//! The studies of a case are the one source of its plan: the plan of a tier is the union of the runs of its
//! studies.

use std::any::Any;

use crate::{
    runs::{self, Planned, Runs},
    section::Section,
};

/// A question about a case that takes runs to answer.
pub trait Study: Any + Send + Sync {
    /// Every run whose record [`Study::evaluate`] looks up, with the gates on it.
    fn runs(&self) -> Vec<Planned>;

    /// The answer, from the records of a plan that has these runs; none if there is nothing to show.
    fn evaluate(&self, case: &str, runs: &Runs) -> Option<Section>;

    /// Extends a study of the full tier to the deep one: `full` is the plan of the full tier.
    fn deepen(&mut self, full: &[Planned]) {
        let _ = full;
    }
}

/// Runs that are judged one by one: a study without a section of its own.
struct JudgedRuns(Vec<Planned>);

impl Study for JudgedRuns {
    fn runs(&self) -> Vec<Planned> {
        self.0.clone()
    }

    fn evaluate(&self, _: &str, _: &Runs) -> Option<Section> {
        None
    }
}

/// A study of one case alone.
pub struct CustomStudy<F> {
    /// The runs that it reads.
    pub runs: Vec<Planned>,
    /// Its section, from the records of these runs.
    pub section: F,
}

impl<F: Fn(&Runs) -> Section + Send + Sync + 'static> Study for CustomStudy<F> {
    fn runs(&self) -> Vec<Planned> {
        self.runs.clone()
    }

    fn evaluate(&self, _: &str, runs: &Runs) -> Option<Section> {
        Some((self.section)(runs))
    }
}

/// The studies of a case in one tier, in the order of the report.
#[derive(Default)]
pub struct Studies(Vec<Box<dyn Study>>);

impl Studies {
    /// Runs that are judged one by one, and no other study yet.
    pub fn judging(runs: Vec<Planned>) -> Self {
        Self::default().with(JudgedRuns(runs))
    }

    /// Adds a study.
    #[must_use]
    pub fn with(mut self, study: impl Study) -> Self {
        self.0.push(Box::new(study));
        self
    }

    /// Adds studies of one type.
    #[must_use]
    pub fn with_all(self, studies: impl IntoIterator<Item = impl Study>) -> Self {
        studies.into_iter().fold(self, Self::with)
    }

    /// The studies of a type.
    pub fn of<S: Study>(&self) -> impl Iterator<Item = &S> {
        self.0.iter().filter_map(|study| (study.as_ref() as &dyn Any).downcast_ref())
    }

    /// The first study of a type.
    pub fn first<S: Study>(&self) -> Option<&S> {
        self.of().next()
    }

    /// The runs of all studies, each once, with the gates of all studies that plan it.
    pub fn runs(&self) -> Vec<Planned> {
        runs::merged(self.0.iter().flat_map(|study| study.runs()).collect())
    }

    /// The sections of all studies, from the records of their runs.
    pub fn evaluate(&self, case: &str, runs: &Runs) -> Vec<Section> {
        self.0.iter().filter_map(|study| study.evaluate(case, runs)).collect()
    }

    /// The studies of the deep tier, from the studies of the full one.
    #[must_use]
    pub fn deepened(mut self) -> Self {
        let full = self.runs();
        self.0.iter_mut().for_each(|study| study.deepen(&full));
        self
    }
}
