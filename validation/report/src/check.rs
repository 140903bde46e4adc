//! Reads a page back: whether it is well-formed, complete and self-contained.

use std::collections::BTreeSet;

/// What a page contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Summary {
    /// Figures, each with a drawing and a caption.
    pub figures: usize,
    /// Tables.
    pub tables: usize,
    /// Sections.
    pub sections: usize,
    /// Links inside the page, all of which resolve.
    pub anchors: usize,
    /// Size.
    pub bytes: usize,
}

/// Largest page.
const LIMIT: usize = 5_000_000;

/// Shapes of a drawing that shows something: an empty panel still has a background and a frame.
const LEAST_SHAPES: usize = 3;

/// A start tag with its attributes.
struct Tag<'a> {
    name: &'a str,
    attributes: Vec<(&'a str, &'a str)>,
    empty: bool,
}

/// What a figure was seen to have.
#[derive(Default)]
struct FigureContent {
    shapes: usize,
    caption: usize,
}

/// State of the walk through a page.
#[derive(Default)]
struct Walk<'a> {
    open: Vec<&'a str>,
    ids: BTreeSet<&'a str>,
    targets: BTreeSet<&'a str>,
    figure: Option<FigureContent>,
    summary: Summary,
}

/// Checks that a page is well-formed XML with unique ids, that its inner links resolve, that every
/// figure has a drawing and a caption, that it loads nothing from a network, and that it is below
/// 5 MB.
pub fn check_page(html: &str) -> Result<Summary, String> {
    if html.len() > LIMIT {
        return Err(format!("{} bytes are more than {LIMIT}", html.len()));
    }
    let mut walk = Walk::default();
    let mut rest = html.trim_start().strip_prefix("<!DOCTYPE html>").ok_or("no doctype")?;
    while let Some(at) = rest.find('<') {
        walk.text(&rest[..at])?;
        let end = tag_end(&rest[at..]).ok_or_else(|| excerpt("a tag without end", &rest[at..]))?;
        let inner = &rest[at + 1..at + end];
        rest = &rest[at + end + 1..];
        match inner.strip_prefix('/') {
            Some(name) => walk.close(name.trim_end())?,
            None => walk.start(&parse_tag(inner)?)?,
        }
    }
    walk.text(rest)?;
    walk.finish(html.len())
}

fn excerpt(what: &str, at: &str) -> String {
    format!("{what}: {}", at.chars().take(60).collect::<String>())
}

/// Index of the `>` that ends the tag at the start of the text; `None` inside quotes or at the end.
fn tag_end(text: &str) -> Option<usize> {
    let mut quote = None;
    for (i, c) in text.char_indices() {
        match (quote, c) {
            (None, '>') => return Some(i),
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), c) if q == c => quote = None,
            _ => {}
        }
    }
    None
}

/// Splits `name a="b" c='d' /`.
fn parse_tag(inner: &str) -> Result<Tag<'_>, String> {
    let (inner, empty) = match inner.strip_suffix('/') {
        Some(inner) => (inner, true),
        None => (inner, false),
    };
    let split = inner.find(char::is_whitespace).unwrap_or(inner.len());
    let (name, mut rest) = inner.split_at(split);
    if !name.starts_with(char::is_alphabetic) {
        return Err(excerpt("not a tag", inner));
    }
    let mut attributes = Vec::new();
    while !rest.trim_start().is_empty() {
        let wrong = || excerpt("an attribute without a quoted value", inner);
        let (key, after) = rest.trim_start().split_once('=').ok_or_else(wrong)?;
        let quote = after.chars().next().filter(|c| matches!(c, '"' | '\'')).ok_or_else(wrong)?;
        let (value, after) = after[1..].split_once(quote).ok_or_else(wrong)?;
        if key.contains(char::is_whitespace) {
            return Err(wrong());
        }
        if value.contains('<') || attributes.iter().any(|(k, _)| *k == key) {
            return Err(excerpt("a stray < or a repeated attribute", inner));
        }
        check_entities(value)?;
        attributes.push((key, value));
        rest = after;
    }
    Ok(Tag { name, attributes, empty })
}

/// Only the entities of XML, and numbers.
fn check_entities(text: &str) -> Result<(), String> {
    for after in text.split('&').skip(1) {
        let name = after.split_once(';').map_or("", |(name, _)| name);
        if !(matches!(name, "amp" | "lt" | "gt" | "quot" | "apos") || name.starts_with('#')) {
            return Err(excerpt("a stray &", after));
        }
    }
    Ok(())
}

impl<'a> Walk<'a> {
    fn text(&mut self, text: &str) -> Result<(), String> {
        check_entities(text)?;
        let within = self.open.last().copied().unwrap_or("");
        if within.is_empty() && !text.trim().is_empty() {
            return Err(excerpt("text outside the page", text));
        }
        if within == "style" && (text.contains("@import") || loads(text, "url(")) {
            return Err("the style sheet loads a file".into());
        }
        if let Some(figure) = &mut self.figure
            && self.open.contains(&"figcaption")
        {
            figure.caption += text.trim().len();
        }
        Ok(())
    }

    fn start(&mut self, tag: &Tag<'a>) -> Result<(), String> {
        if self.open.is_empty() && self.summary.bytes > 0 {
            return Err(format!("<{}> after the end of the page", tag.name));
        }
        self.summary.bytes = 1; // something was seen
        for &(key, value) in &tag.attributes {
            self.attribute(tag.name, key, value)?;
        }
        match tag.name {
            "figure" if self.figure.is_some() => return Err("a figure inside a figure".into()),
            "figure" => self.figure = Some(FigureContent::default()),
            "img" => {
                if let Some(figure) = &mut self.figure {
                    figure.shapes += LEAST_SHAPES;
                }
            }
            "table" => self.summary.tables += 1,
            "section" => self.summary.sections += 1,
            "polyline" | "polygon" | "circle" | "line" | "rect" | "text" | "path" => {
                if let Some(figure) = &mut self.figure {
                    figure.shapes += 1;
                }
            }
            _ => {}
        }
        if !tag.empty {
            self.open.push(tag.name);
        }
        Ok(())
    }

    fn attribute(&mut self, tag: &str, key: &str, value: &'a str) -> Result<(), String> {
        let remote = value.contains("://") || value.starts_with("//");
        match key {
            "id" if value.is_empty() || !self.ids.insert(value) => {
                return Err(format!("the id \"{value}\" is empty or used twice"));
            }
            "href" if tag == "a" => {
                if let Some(target) = value.strip_prefix('#') {
                    // What follows a question mark is read by the page's script.
                    self.targets.insert(target.split('?').next().unwrap_or_default());
                    self.summary.anchors += 1;
                } else if remote && !value.starts_with("https://doi.org/") {
                    return Err(format!("a link to {value}"));
                }
            }
            "src" | "href" | "srcset" | "data" | "xlink:href" | "action" | "poster"
                if !value.starts_with("data:") =>
            {
                return Err(format!("<{tag}> loads {value}"));
            }
            "style" if loads(value, "url(") => return Err(format!("<{tag}> loads {value}")),
            _ => {}
        }
        Ok(())
    }

    fn close(&mut self, name: &str) -> Result<(), String> {
        match self.open.pop() {
            Some(open) if open == name => {}
            other => return Err(format!("</{name}> closes <{}>", other.unwrap_or("nothing"))),
        }
        if name == "figure" {
            let figure = self.figure.take().unwrap_or_default();
            self.summary.figures += 1;
            if figure.shapes < LEAST_SHAPES {
                return Err(format!("figure {} shows nothing", self.summary.figures));
            }
            if figure.caption < 12 {
                return Err(format!("figure {} has no caption", self.summary.figures));
            }
        }
        Ok(())
    }

    fn finish(mut self, bytes: usize) -> Result<Summary, String> {
        if let Some(open) = self.open.pop() {
            return Err(format!("<{open}> is not closed"));
        }
        if let Some(lost) = self.targets.difference(&self.ids).next() {
            return Err(format!("#{lost} leads nowhere"));
        }
        if self.summary.bytes == 0 {
            return Err("an empty page".into());
        }
        Ok(Summary { bytes, ..self.summary })
    }
}

/// Whether anything but a data URL follows one of the openings.
fn loads(text: &str, opening: &str) -> bool {
    let opened = text.split(opening).skip(1);
    opened.into_iter().any(|after| !after.trim_start_matches(['"', '\'']).starts_with("data:"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Axis, Block, Card, Cell, Column, Counts, Explorer, Figure, GateRow, Page, Plot, Section,
        Series, Status, Table, VERDICTS,
    };

    fn x() -> Axis {
        Axis::linear("x [m]")
    }

    fn real_page() -> Page {
        let plot = Plot::new("p < q & r", Axis::linear("x [m]"), Axis::log("y [\"1\"]"))
            .layer(Series::line_markers("<&>", vec![(0.0, 1.0), (1.0, 2.0)]));
        let table = Table::new("Errors", vec![Column::text("a"), Column::num("b", "m/s")])
            .row(vec![Cell::text("`<code>`"), Cell::sci(f64::NAN, 2).with(Status::Fail)]);
        let data = serde_json::json!({"text": "</script>&"});
        let details = vec![table.clone().into(), Block::DataJson { id: "data".into(), data }];
        let section = Section::new("one", "One & *two*")
            .prose("See [the figure](#fig) & <math><mi>x</mi><mo>&lt;</mo><mn>1</mn></math>.")
            .block(Figure::new("fig", "A caption with `code`.").title("\"T\"").panel(plot))
            .block(Block::Details { summary: "more".into(), blocks: details })
            .child(Section::new("two", "Two").status(Status::Pass).block(table));
        let card = Card {
            id: "one".into(),
            title: "One & *two*".into(),
            picture: Some(Figure::new("small", "").panel(Plot::new("", x(), x()))),
            facts: vec![("error".into(), "**1 %**".into())],
            counts: Counts::of([Status::Limitation]),
            limitations: vec!["It is < 2.".into()],
        };
        let gate = GateRow {
            id: "one.a&b".into(),
            status: Status::Limitation,
            of: "`seed`".into(),
            value: Cell::num(0.5, 2),
            bound: "at most 0.4".into(),
            margin: Cell::text("–"),
            evidence: "theory".into(),
            reasons: vec![1],
        };
        let explorer = Explorer { gates: vec![gate], reasons: vec!["because".into()] };
        let outcome = Block::Outcome { counts: card.counts, words: "one.a".into() };
        let verdicts = Section::new(VERDICTS, "Verdicts").block(Block::Explorer(explorer));
        Page {
            title: "A & B".into(),
            lead: vec!["Lead.".into()],
            counts: Some(Counts::of([Status::Pass])),
            cards: vec![card],
            notes: vec!["Note.".into()],
            sections: vec![section, Section::new("three", "Three").block(outcome), verdicts],
            footer: "Foot.".into(),
            png_folder: "figures".into(),
        }
    }

    #[test]
    fn a_real_page_passes_here_and_in_an_xml_parser() {
        let html = real_page().html();
        let summary = check_page(&html).unwrap();
        assert_eq!((summary.figures, summary.tables, summary.sections), (1, 3, 4));
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
        roxmltree::Document::parse_with_options(&html, options).unwrap();
    }

    #[test]
    fn a_page_with_a_lost_anchor_or_a_repeated_id_fails() {
        let mut page = real_page();
        page.sections[1].id = "fig".into();
        assert!(check_page(&page.html()).unwrap_err().contains("twice"));
        let mut page = real_page();
        page.footer = "[lost](#lost)".into();
        assert!(check_page(&page.html()).unwrap_err().contains("leads nowhere"));
    }

    #[test]
    fn a_written_page_has_its_images_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        real_page().write(&folder.path().join("index.html")).unwrap();
        assert!(folder.path().join("figures/fig.png").is_file());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    /// A report that was killed left a part of a figure, and no later one removed it.
    #[test]
    fn what_a_killed_report_left_among_the_figures_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let figures = folder.path().join("figures");
        std::fs::create_dir(&figures).unwrap();
        let left = std::fs::File::create(figures.join(".unfinished-a8Zk29xYb01q-map.png")).unwrap();
        let hours_ago = std::time::SystemTime::now() - std::time::Duration::from_secs(7200);
        left.set_modified(hours_ago).unwrap();
        real_page().write(&folder.path().join("index.html")).unwrap();
        let names = std::fs::read_dir(&figures).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<_> = names.collect();
        names.sort();
        assert_eq!(names, ["fig.png"]);
    }

    fn page(body: &str) -> String {
        format!("<!DOCTYPE html><html><head><title>t</title></head><body>{body}</body></html>")
    }

    #[test]
    fn good_pages_pass() {
        let figure = "<figure id=\"f\"><svg><rect/><line/><text>a</text></svg>\
                      <figcaption><b>Figure 1. </b>What is seen.</figcaption></figure>\
                      <a href=\"#f\">f</a> <a href=\"https://doi.org/10.1006/x\">x</a>";
        let summary = check_page(&page(figure)).unwrap();
        assert_eq!((summary.figures, summary.anchors), (1, 1));
    }

    #[test]
    fn broken_pages_fail_with_the_reason() {
        let broken = [
            ("<p><b></p></b>", "closes"),
            ("<br>", "closes"),
            ("<p id=\"a\"></p><p id=\"a\"></p>", "twice"),
            ("<a href=\"#nowhere\">x</a>", "leads nowhere"),
            ("<img src=\"http://example.org/x.png\"/>", "loads"),
            ("<script src=\"x.js\"></script>", "loads"),
            ("<a href=\"https://example.org\">x</a>", "link"),
            ("<style>a { background: url(x.png) }</style>", "loads"),
            ("<figure><figcaption>A caption of length</figcaption></figure>", "shows nothing"),
            ("<figure><svg><rect/><rect/><line/></svg></figure>", "no caption"),
            ("a &nbsp; b", "stray &"),
            ("<p hidden></p>", "attribute"),
            ("<p a=\"1\" a=\"2\"></p>", "repeated"),
            ("1 < 2", "not a tag"),
        ];
        for (body, reason) in broken {
            let error = check_page(&page(body)).expect_err(body);
            assert!(error.contains(reason), "{body}: {error}");
        }
        assert!(check_page("").is_err());
        assert!(check_page(&page(&"x".repeat(LIMIT))).is_err());
    }
}
