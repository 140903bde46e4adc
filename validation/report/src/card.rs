//! The first screen of a page: one card a subject, with a picture, numbers and verdicts.

use super::counts::Counts;
use super::explorer::verdicts_where;
use super::figure::Figure;
use super::inline::inline;
use super::pixels::drawing;
use maud::{Markup, html};

/// What is said first of one subject.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// Anchor of its section.
    pub id: String,
    /// Name; inline markup.
    pub title: String,
    /// A small picture without a caption of its own, and what it shows in words.
    pub picture: Option<Figure>,
    /// What was found: a name and its value, each with inline markup.
    pub facts: Vec<(String, String)>,
    /// How its gates ended.
    pub counts: Counts,
    /// What cannot be relied on; inline markup.
    pub limitations: Vec<String>,
}

impl Card {
    pub(super) fn markup(&self) -> Markup {
        html! {
            article.subject {
                h2 { a href=(format!("#{}", self.id)) { (inline(&self.title)) } }
                (self.counts.chips(|status| {
                    verdicts_where(&format!("case={}&status={status}", self.id))
                }))
                @if let Some(picture) = &self.picture { div.picture { (drawing(picture)) } }
                dl {
                    @for (name, value) in &self.facts {
                        div { dt { (inline(name)) } " " dd { (inline(value)) } }
                    }
                }
                @if !self.limitations.is_empty() {
                    p { b { "Main limitations" } }
                    ul { @for limitation in &self.limitations { li { (inline(limitation)) } } }
                }
            }
        }
    }
}
