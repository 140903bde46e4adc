//! Reads a page back: whether it is well-formed, complete and self-contained.

use roxmltree::{Attribute, Document, Node, ParsingOptions};
use std::collections::BTreeSet;

/// Largest page.
const LIMIT: usize = 5_000_000;

/// Shapes of a drawing that shows something: an empty panel still has a background and a frame.
const LEAST_SHAPES: usize = 3;

/// Checks that a page is well-formed XML with unique ids, that its inner links resolve, that every
/// figure has a drawing and a caption, that it loads nothing from a network, and that it is below
/// 5 MB.
pub fn check_page(html: &str) -> Result<(), String> {
    if html.len() > LIMIT {
        return Err(format!("{} bytes are more than {LIMIT}", html.len()));
    }
    if !html.trim_start().starts_with("<!DOCTYPE html>") {
        return Err("no doctype".into());
    }
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let page = Document::parse_with_options(html, options).map_err(|error| error.to_string())?;
    let mut figures = 0;
    let (mut ids, mut targets) = (BTreeSet::new(), BTreeSet::new());
    for element in page.descendants().filter(Node::is_element) {
        for attribute in element.attributes() {
            check_attribute(&element, &attribute)?;
        }
        if let Some(id) = element.attribute("id")
            && (id.is_empty() || !ids.insert(id))
        {
            return Err(format!("the id \"{id}\" is empty or used twice"));
        }
        match name(&element) {
            "a" => {
                if let Some(target) = element.attribute("href").and_then(|to| to.strip_prefix('#'))
                {
                    // The page's script reads the part after a question mark.
                    targets.insert(target.split('?').next().unwrap_or_default());
                }
            }
            "figure" => {
                figures += 1;
                check_figure(&element, figures)?;
            }
            "style" if element.text().is_some_and(|it| it.contains("@import") || loads(it)) => {
                return Err("the style sheet loads a file".into());
            }
            _ => {}
        }
    }
    match targets.difference(&ids).next() {
        Some(lost) => Err(format!("#{lost} leads nowhere")),
        None => Ok(()),
    }
}

fn name<'a>(node: &Node<'a, '_>) -> &'a str {
    node.tag_name().name()
}

/// A page loads nothing, and links only to parts of itself, to files in its folder, and to papers.
fn check_attribute(element: &Node, attribute: &Attribute) -> Result<(), String> {
    let (tag, value) = (name(element), attribute.value());
    match attribute.name() {
        "href" if tag == "a" => {
            // Saved, not opened: see `DataFile`.
            let is_saved = element.has_attribute("download") && value.starts_with("data:text/csv;");
            match is_saved || leads_beside(value) || value.starts_with("https://doi.org/") {
                true => Ok(()),
                false => Err(format!("a link to {value}")),
            }
        }
        name if name.starts_with("on") || name == "http-equiv" => {
            Err(format!("<{tag}> does something by itself: {name}"))
        }
        "src" | "href" | "srcset" | "data" | "action" | "poster" if !value.starts_with("data:") => {
            Err(format!("<{tag}> loads {value}"))
        }
        "style" if loads(value) => Err(format!("<{tag}> loads {value}")),
        _ => Ok(()),
    }
}

/// Whether a link leads to a part of the page, or to a file in its folder or below. Names without a colon
/// have no scheme, such as `javascript:`.
fn leads_beside(target: &str) -> bool {
    let is_odd = |c: char| c == ':' || c == '\\' || c.is_whitespace() || c.is_control();
    let is_file = !target.is_empty() && !target.contains(is_odd) && !target.starts_with('/');
    target.starts_with('#') || is_file && target.split('/').all(|part| part != "..")
}

fn check_figure(figure: &Node, number: usize) -> Result<(), String> {
    let within = || figure.descendants().skip(1);
    let shapes = within().map(|node| match name(&node) {
        "img" => LEAST_SHAPES,
        "polyline" | "polygon" | "circle" | "line" | "rect" | "text" | "path" => 1,
        _ => 0,
    });
    let captions = within().filter(|node| name(node) == "figcaption");
    let texts = captions.flat_map(|caption| caption.descendants()).filter(Node::is_text);
    let length: usize = texts.filter_map(|node| node.text()).map(|text| text.trim().len()).sum();
    if within().any(|node| name(&node) == "figure") {
        Err("a figure inside a figure".into())
    } else if shapes.sum::<usize>() < LEAST_SHAPES {
        Err(format!("figure {number} shows nothing"))
    } else if length < 12 {
        Err(format!("figure {number} has no caption"))
    } else {
        Ok(())
    }
}

/// Whether a style loads anything but a data URL.
fn loads(style: &str) -> bool {
    let mut opened = style.split("url(").skip(1);
    opened.any(|after| !after.trim_start_matches(['"', '\'']).starts_with("data:"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Axis, Block, Cell, Counts, Explorer, Figure, Overview, Page, Plot, Section, Series,
        Subject, Table, TableColumn, VERDICTS,
    };
    use touchstone_base::gate::Verdict;

    fn x() -> Axis {
        Axis::linear("x [m]")
    }

    fn real_page() -> Page {
        let plot = Plot::new("p < q & r", Axis::linear("x [m]"), Axis::log("y [\"1\"]"))
            .layer(Series::line("<&>", vec![(0.0, 1.0), (1.0, 2.0)]).cycle(2));
        let table =
            Table::new("Errors", vec![TableColumn::text("a"), TableColumn::num("b", "m/s")])
                .row(vec![Cell::marked("`<code>`"), Cell::sci(f64::NAN, 2).with(Verdict::Fail)]);
        let details = vec![table.clone().into()];
        let section = Section::new("one", "One & *two*")
            .prose("See [the figure](#fig) & more.")
            .block(Figure::new("fig", "A caption with `code`.").panel(plot))
            .block(Block::Details { summary: "more".into(), blocks: details })
            .child(Section::new("two", "Two").counts(Counts::of([Verdict::Pass])).block(table));
        let row = Subject {
            id: "one".into(),
            title: "One & *two*".into(),
            about: "It is < 2.".into(),
            picture: Some(Figure::new("small", "").panel(Plot::new("", x(), x()))),
            cells: vec![Cell::marked("**1 %**")],
        };
        let error = vec![TableColumn::num("error", "")];
        let overview = Overview { caption: "All".into(), columns: error, rows: vec![row] };
        let columns = ["verdict", "gate", "bound", "reasons"].map(TableColumn::text);
        let cells = ["one.a&b", "at most 0.4", "1"].map(Cell::text);
        let gate = [vec![Cell::status(Verdict::Limitation)], cells.into()].concat();
        let gates = Table::new("", columns.into()).row(gate);
        let explorer = Explorer { gates, reasons: vec!["because".into()] };
        let three = Section::new("three", "Three").counts(Counts::of([Verdict::Limitation]));
        let verdicts = Section::new(VERDICTS, "Verdicts").block(Block::Explorer(explorer));
        Page {
            title: "A & B".into(),
            lead: vec!["Lead.".into()],
            counts: Counts::of([Verdict::Pass]),
            overview,
            opening: vec![Block::Prose(vec!["Note.".into()])],
            sections: vec![section, three, verdicts],
            figure_folder: "figures".into(),
            ..Page::default()
        }
    }

    fn write(folder: &tempfile::TempDir) {
        let (page, path) = (real_page(), folder.path().join("index.html"));
        page.write_html(&path, &page.html()).unwrap();
    }

    #[test]
    fn a_real_page_passes() {
        let html = real_page().html();
        check_page(&html).unwrap();
        let counts = ["<figure", "<table", "<section", "<details class=\"study\""]
            .map(|tag| html.matches(tag).count());
        assert_eq!(counts, [1, 4, 3, 1]);
    }

    #[test]
    fn a_page_with_a_lost_anchor_or_a_repeated_id_fails() {
        let mut page = real_page();
        page.sections[1].id = "fig".into();
        assert!(check_page(&page.html()).unwrap_err().contains("twice"));
        let mut page = real_page();
        page.opening = vec![Block::Prose(vec!["[lost](#lost)".into()])];
        assert!(check_page(&page.html()).unwrap_err().contains("leads nowhere"));
    }

    #[test]
    fn a_written_page_has_its_images_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        write(&folder);
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
        write(&folder);
        let names = std::fs::read_dir(&figures).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<_> = names.collect();
        names.sort();
        assert_eq!(names, ["fig.png", "fig.svg"]);
    }

    fn page(body: &str) -> String {
        format!("<!DOCTYPE html><html><head><title>t</title></head><body>{body}</body></html>")
    }

    #[test]
    fn good_pages_pass() {
        let figure = "<figure id=\"f\"><svg><rect/><line/><text>a</text></svg>\
                      <figcaption><b>Figure 1. </b>What is seen.</figcaption></figure>\
                      <a href=\"#f\">f</a> <a href=\"https://doi.org/10.1006/x\">x</a>\
                      <a href=\"figures/f.png\">x</a> \
                      <a href=\"data:text/csv;base64,YSxi\" download=\"x.csv\">x</a>";
        check_page(&page(figure)).unwrap();
    }

    #[test]
    fn broken_pages_fail_with_the_reason() {
        let broken = [
            ("<p><b></p></b>", "expected 'b' tag"),
            ("<br>", "expected 'br' tag"),
            ("<p id=\"a\"></p><p id=\"a\"></p>", "twice"),
            ("<a href=\"#nowhere\">x</a>", "leads nowhere"),
            ("<img src=\"http://example.org/x.png\"/>", "loads"),
            ("<script src=\"x.js\"></script>", "loads"),
            ("<a href=\"https://example.org\">x</a>", "link"),
            ("<a href=\"https://doi.org.evil.example/\">x</a>", "link"),
            ("<a href=\"javascript:alert(1)\">x</a>", "link"),
            ("<a href=\" javascript:alert(1)\">x</a>", "link"),
            ("<a href=\"JavaScript&#58;alert(1)\">x</a>", "link"),
            ("<a href=\"java&#10;script:alert(1)\">x</a>", "link"),
            ("<a href=\"vbscript:x\">x</a>", "link"),
            ("<a href=\"data:text/html,x\">x</a>", "link"),
            ("<a href=\"data:text/html,x\" download=\"x\">x</a>", "link"),
            ("<a href=\"data:text/csv;base64,YSxi\">x</a>", "link"),
            ("<a href=\"../../evil.html\">x</a>", "link"),
            ("<a href=\"figures/../../evil.html\">x</a>", "link"),
            ("<a href=\"..\\evil.html\">x</a>", "link"),
            ("<a href=\"/etc/passwd\">x</a>", "link"),
            ("<a href=\"//example.org\">x</a>", "link"),
            ("<a href=\"\">x</a>", "link"),
            ("<p onclick=\"x()\">x</p>", "by itself"),
            ("<meta http-equiv=\"refresh\"/>", "by itself"),
            ("<style>a { background: url(x.png) }</style>", "loads"),
            ("<figure><figcaption>A caption of length</figcaption></figure>", "shows nothing"),
            ("<figure><svg><rect/><rect/><line/></svg></figure>", "no caption"),
            ("a &nbsp; b", "entity"),
            ("<p hidden></p>", "expected '='"),
            ("<p a=\"1\" a=\"2\"></p>", "already defined"),
            ("1 < 2", "invalid name"),
        ];
        for (body, reason) in broken {
            let error = check_page(&page(body)).expect_err(body);
            assert!(error.contains(reason), "{body}: {error}");
        }
        assert!(check_page("").is_err());
        assert!(check_page(&page(&"x".repeat(LIMIT))).is_err());
    }
}
