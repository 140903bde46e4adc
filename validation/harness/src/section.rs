//! A section of a report: the result of a study, with its prose, figures, tables, and the gates that judge
//! it.

use touchstone_base::gate::Gate;
use touchstone_report::Block;

use crate::runs::Judged;

/// The result of a study: its part of the report, and the gates that judge it.
#[derive(Clone, Debug)]
pub struct Section {
    /// Anchor in the report: letters, digits, hyphens.
    pub id: String,
    /// Title of the section.
    pub title: String,
    /// Prose, figures, tables.
    pub blocks: Vec<Block>,
    /// Judgements on the result.
    pub judged: Vec<Judged>,
}

impl Section {
    /// An empty section.
    pub fn new(id: &str, title: &str) -> Self {
        Self { id: id.into(), title: title.into(), blocks: Vec::new(), judged: Vec::new() }
    }

    /// Adds a block.
    pub fn block(mut self, block: impl Into<Block>) -> Self {
        self.blocks.push(block.into());
        self
    }

    /// Adds a paragraph.
    pub fn prose(self, text: impl Into<String>) -> Self {
        self.block(Block::Prose(vec![text.into()]))
    }

    /// Adds a judged value.
    pub fn judge(mut self, gate: Gate, value: f64) -> Self {
        self.judged.push(Judged::new(gate, Some(value)));
        self
    }
}
