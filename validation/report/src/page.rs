//! One self-contained page: opens from disk, loads nothing, prints.

use super::counts::Counts;
use super::explorer::{Explorer, verdicts_where};
use super::figure::Figure;
use super::font;
use super::inline::{aloud, inline};
use super::movie::Movie;
use super::overview::Overview;
use super::render::{self, Parts};
use super::table::{Table, class, first_sentence, mark};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use rayon::prelude::*;
use serde::Serialize;
use std::io;
use std::path::Path;
use touchstone_base::{files::OutputFolder, text::base64};

const STYLE: &str = include_str!("page.css");
const SCRIPTS: [&str; 3] =
    [include_str!("dom.js"), include_str!("page.js"), include_str!("figures.js")];

/// A report: a first screen, then sections.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Title of the document.
    pub title: String,
    /// Paragraphs under the title; inline markup.
    pub lead: Vec<String>,
    /// The results side by side.
    pub overview: Overview,
    /// How all gates ended: a line below the table.
    pub counts: Counts,
    /// Figures and paragraphs before the table of contents.
    pub opening: Vec<Block>,
    /// Sections in order.
    pub sections: Vec<Section>,
    /// Folder of the files of figures beside the page; empty writes none.
    pub figure_folder: String,
    /// Names the records that the page shows, as [`made_from`] reads it.
    pub made_from: String,
}

/// A heading with blocks, and sections below it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Unique on the page: the anchor.
    pub id: String,
    /// Heading; inline markup.
    pub title: String,
    /// Counts of the verdicts of its gates: shown below the heading, with links to the rows of the table of
    /// all verdicts with its title; the worst verdict is shown in the table of contents.
    pub counts: Counts,
    /// Content in order.
    pub blocks: Vec<Block>,
    /// Sections one level down.
    pub children: Vec<Section>,
}

impl Section {
    /// An empty section.
    pub fn new(id: impl Into<String>, title: impl Into<String>) -> Self {
        Self { id: id.into(), title: title.into(), ..Self::default() }
    }

    /// Sets how its gates ended.
    pub fn counts(self, counts: Counts) -> Self {
        Self { counts, ..self }
    }

    /// Adds a block.
    pub fn block(mut self, block: impl Into<Block>) -> Self {
        self.blocks.push(block.into());
        self
    }

    /// Adds a paragraph.
    pub fn prose(self, paragraph: impl Into<String>) -> Self {
        self.block(Block::Prose(vec![paragraph.into()]))
    }

    /// Adds a section one level down.
    pub fn child(mut self, section: Section) -> Self {
        self.children.push(section);
        self
    }

    /// Adds its drawings.
    fn images<'a>(&'a self, to: &mut Vec<Image<'a>>) {
        add_images(&self.blocks, to);
        self.children.iter().for_each(|child| child.images(to));
    }
}

/// One piece of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// Paragraphs. Inline: `*emphasis*`, `**strong**`, `` `code` ``, `[label](#anchor)`.
    Prose(Vec<String>),
    /// Bullets; inline markup.
    List(Vec<String>),
    /// A drawing with its caption and number; its id is its anchor.
    Figure(Figure),
    /// Pictures one after another, with caption and number.
    Movie(Movie),
    /// A table with its number.
    Table(Table),
    /// Results side by side.
    Overview(Overview),
    /// The table of all verdicts, once a page.
    Explorer(Explorer),
    /// A link that saves a table which the page contains and does not show.
    File(DataFile),
    /// Blocks behind a click.
    Details {
        /// The summary of folded content; inline markup.
        summary: String,
        /// The blocks.
        blocks: Vec<Block>,
    },
}

/// A table as text, for other programs.
#[derive(Debug, Clone, PartialEq)]
pub struct DataFile {
    /// Text of the link.
    pub title: String,
    /// Name of the file that a reader saves.
    pub name: String,
    /// Comma-separated values with a head.
    pub csv: String,
}

impl DataFile {
    /// A line for each row below the names of its fields. If a row has a field that is neither a number nor a
    /// text, the title states the error.
    pub fn of_rows(title: String, name: String, rows: impl Iterator<Item: Serialize>) -> Self {
        let mut csv = csv::Writer::from_writer(Vec::new());
        let title = match { rows }.try_for_each(|row| csv.serialize(row)) {
            Ok(()) => title,
            Err(error) => format!("No file: {error}"),
        };
        let csv = csv.into_inner().unwrap_or_default();
        Self { title, name, csv: String::from_utf8(csv).unwrap_or_default() }
    }

    fn markup(&self) -> Markup {
        let address = format!("data:text/csv;base64,{}", base64(self.csv.as_bytes()));
        html! { p { a href=(address) download=(self.name) { (self.title) } } }
    }
}

impl From<Figure> for Block {
    fn from(figure: Figure) -> Self {
        Self::Figure(figure)
    }
}

impl From<Movie> for Block {
    fn from(movie: Movie) -> Self {
        Self::Movie(movie)
    }
}

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

/// Numbers given out while a page is written.
#[derive(Default)]
struct Writer {
    figures: usize,
    tables: usize,
}

impl Page {
    /// The page as HTML that is well-formed XML too.
    pub fn html(&self) -> String {
        let mut writer = Writer::default();
        let face = format!(
            "@font-face{{font-family:\"DejaVu Sans\";src:url(data:font/ttf;base64,{})}}\n",
            base64(font::BYTES)
        );
        let page = html! {
            (DOCTYPE)
            html lang="en" xmlns="http://www.w3.org/1999/xhtml" {
                head {
                    (PreEscaped("<meta charset=\"utf-8\"/>"))
                    (PreEscaped(VIEWPORT))
                    (PreEscaped(MADE_FROM)) (self.made_from) (PreEscaped("\"/>"))
                    title { (self.title) }
                    style { (PreEscaped(face)) (PreEscaped(STYLE)) }
                }
                body {
                    header {
                        h1 { (self.title) }
                        @for paragraph in &self.lead { p.lead { (inline(paragraph)) } }
                    }
                    main {
                        @if !self.overview.rows.is_empty() { (self.overview.markup()) }
                        @if self.counts.worst().is_some() { (self.counts.line()) }
                        div.opening { @for block in &self.opening { (writer.block(block)) } }
                        @if self.sections.len() > 1 {
                            nav aria-label="Contents" { (contents(&self.sections)) }
                        }
                        @for section in &self.sections { (writer.section(section, 2)) }
                    }
                    @for script in SCRIPTS { script { (PreEscaped(script)) } }
                }
            }
        };
        page.into_string()
    }

    /// Its figures and films as files: names, and functions that make their bytes.
    fn images(&self) -> Vec<Image<'_>> {
        let mut all = Vec::new();
        add_images(&self.opening, &mut all);
        self.sections.iter().for_each(|section| section.images(&mut all));
        all
    }

    /// Writes the output of [`Page::html`], and the figures' PNG files into their folder. Every file appears
    /// complete or not at all.
    pub fn write_html(&self, path: &Path, html: &str) -> io::Result<()> {
        let folder = path.parent().unwrap_or(Path::new("."));
        if !self.figure_folder.is_empty() {
            // Also removes files of a report that was killed.
            let images = OutputFolder::create_inside(&folder.join(&self.figure_folder));
            write_images(&self.images(), &images.map_err(io::Error::other)?)?;
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let written = OutputFolder::unchecked(folder).write(&name, html.as_bytes());
        written.map(drop).map_err(io::Error::other)
    }
}

const VIEWPORT: &str = "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>";

/// Before the name of the records that a page shows.
const MADE_FROM: &str = "<meta name=\"touchstone-records\" content=\"";

/// The name of the records that a page shows; `None` if the text is not a page of ours.
pub fn made_from(html: &str) -> Option<&str> {
    let (_, after) = html.split_once(MADE_FROM)?;
    Some(after.split_once('"')?.0)
}

/// A file that is written beside a page.
enum Image<'a> {
    Figure(&'a Figure),
    Movie(&'a Movie),
}

/// Writes figures as SVG and PNG files, and films as PNG files of several frames.
fn write_images(all: &[Image], folder: &OutputFolder) -> io::Result<()> {
    let write =
        |name: String, bytes: &[u8]| folder.write(&name, bytes).map(drop).map_err(io::Error::other);
    all.par_iter().try_for_each(|image| match image {
        Image::Figure(figure) => {
            write(format!("{}.svg", figure.id), render::svg(figure).as_bytes())?;
            write(format!("{}.png", figure.id), &render::png_bytes(figure)?)
        }
        Image::Movie(movie) => write(format!("{}.png", movie.id), &movie.apng()?),
    })
}

/// Adds the drawings of blocks, those behind a click with them.
fn add_images<'a>(blocks: &'a [Block], to: &mut Vec<Image<'a>>) {
    for block in blocks {
        match block {
            Block::Figure(figure) if !figure.panels.is_empty() => to.push(Image::Figure(figure)),
            Block::Movie(movie) => to.push(Image::Movie(movie)),
            Block::Details { blocks, .. } => add_images(blocks, to),
            _ => {}
        }
    }
}

fn contents(sections: &[Section]) -> Markup {
    html! {
        ul {
            @for section in sections {
                li {
                    @if let Some(s) = section.counts.worst() {
                        span class=(format!("mark {}", class(s))) title=(s) { (mark(s)) }
                        " "
                    }
                    a href=(format!("#{}", section.id)) { (inline(&section.title)) }
                }
            }
        }
    }
}

impl Writer {
    /// A section of the page, or a study of one, which opens by a click.
    fn section(&mut self, section: &Section, level: usize) -> Markup {
        let title = inline(&section.title);
        let of = match level {
            2 => format!("case={}", section.id),
            _ => format!("q={}", section.title),
        };
        let gates = |status: &str| verdicts_where(&format!("{of}&status={status}"));
        let counts = html! {
            @if section.counts.worst().is_some() { (section.counts.chips(gates)) }
        };
        let content = html! {
            @for block in &section.blocks { (self.block(block)) }
            @for child in &section.children { (self.section(child, level + 1)) }
        };
        match level {
            2 => html! {
                section id=(section.id) { div.head { h2 { (title) } (counts) } (content) }
            },
            _ => html! {
                details.study id=(section.id) {
                    summary {
                        @if level == 3 { h3 { (title) } } @else { h4 { (title) } }
                        @if section.counts.worst().is_some() { span.mark { (section.counts.short()) } }
                    }
                    (counts)
                    (content)
                }
            },
        }
    }

    fn block(&mut self, block: &Block) -> Markup {
        match block {
            Block::Prose(paragraphs) => html! { @for p in paragraphs { (prose(p)) } },
            Block::List(items) => html! { ul { @for item in items { li { (inline(item)) } } } },
            // The target of a link must exist.
            Block::Figure(figure) if figure.panels.is_empty() => {
                html! { p id=(figure.id) { "No figure: none of the runs that it shows was completed." } }
            }
            Block::Figure(figure) => self.figure(&figure.id, &figure.caption, &arranged(figure)),
            Block::Movie(movie) => self.figure(&movie.id, &movie.caption, &movie.markup()),
            Block::Table(table) => {
                self.tables += 1;
                table.markup(&format!("Table {}", self.tables))
            }
            Block::Overview(overview) => overview.markup(),
            Block::Explorer(explorer) => explorer.markup(),
            Block::File(file) => file.markup(),
            Block::Details { summary, blocks } => html! {
                details {
                    summary { (inline(summary)) }
                    @for block in blocks { (self.block(block)) }
                }
            },
        }
    }

    fn figure(&mut self, id: &str, caption: &str, drawing: &Markup) -> Markup {
        self.figures += 1;
        // A caption begins with the question that the figure answers.
        let end = caption.find("? ").or_else(|| caption.strip_suffix('?').map(str::len));
        let (question, rest) = caption.split_at(end.map_or(0, |at| at + 1));
        html! {
            figure id=(id) aria-label=(aloud(caption)) {
                (drawing)
                figcaption { b { "Figure " (self.figures) ". " (inline(question)) } (inline(rest)) }
            }
        }
    }
}

/// The panels of a figure, its legend and its data. Series can be switched by the script.
fn arranged(figure: &Figure) -> Markup {
    let Parts { panels, legend, data } = render::parts(figure, &aloud(&figure.caption));
    html! {
        div.panels { @for panel in &panels { (PreEscaped(panel)) } }
        @if !legend.is_empty() {
            div.legend role="group" aria-label="Series" {
                @for (name, sample) in &legend {
                    button type="button" data-series=(name) aria-pressed="true" {
                        (PreEscaped(sample)) (name)
                    }
                }
            }
        }
        script type="application/json" { (PreEscaped(data)) }
    }
}

/// Words of a paragraph that is shown at once; of a longer one the first sentence is.
const LONG: usize = 45;

/// A paragraph; the part after the first sentence of a long one is folded.
fn prose(text: &str) -> Markup {
    let (first, rest) = first_sentence(text);
    if rest.is_empty() || text.split_whitespace().count() <= LONG {
        return html! { p { (inline(text)) } };
    }
    html! { details.prose { summary { (inline(first)) } p { (inline(rest)) } } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_is_plain_xml_text() {
        for text in SCRIPTS.into_iter().chain([STYLE]) {
            assert!(!text.contains(['<', '&']) && text.lines().count() < 200);
        }
    }

    /// `report` of a store that lacks the runs of a figure ended with 4, as by a bug.
    #[test]
    fn a_figure_without_panels_is_a_line_of_text_with_its_anchor() {
        let section = Section::new("s", "S").prose("See [it](#empty).");
        let section = section.block(Figure::new("empty", "What is shown where there are runs"));
        let folder = tempfile::tempdir().unwrap();
        let images = OutputFolder::unchecked(folder.path());
        let page = Page { sections: vec![section], ..Page::default() };
        write_images(&page.images(), &images).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        let html = page.html();
        crate::check_page(&html).expect("a page that opens");
        assert!(!html.contains("<figure"), "{html}");
        assert!(html.contains("<p id=\"empty\">No figure: "), "{html}");
    }

    #[test]
    fn the_question_of_a_figure_stands_out() {
        let shown = |caption: &str| Writer::default().figure("f", caption, &html! {}).into_string();
        assert!(shown("Why? So.").contains("<b>Figure 1. Why?</b> So.</figcaption>"));
        assert!(
            shown("Why, *then*?").contains("<b>Figure 1. Why, <em>then</em>?</b></figcaption>")
        );
        assert!(shown("So.").contains("<b>Figure 1. </b>So.</figcaption>"));
    }

    #[test]
    fn a_file_is_part_of_the_page() {
        #[derive(Serialize)]
        struct Row {
            a: u8,
            b: &'static str,
        }
        let [title, name] = ["2 runs (CSV)", "a-runs.csv"].map(String::from);
        let file =
            |b| DataFile::of_rows(title.clone(), name.clone(), [Row { a: 1, b }].into_iter());
        assert_eq!(file("x, \"y\"").csv, "a,b\n1,\"x, \"\"y\"\"\"\n");
        let html = file("2").markup().into_string();
        let link = "<a href=\"data:text/csv;base64,YSxiCjEsMgo=\" download=\"a-runs.csv\">";
        assert!(html.contains(link), "{html}");
    }

    #[test]
    fn a_long_paragraph_opens_by_a_click() {
        let long = format!("It moves. {}.", "Word ".repeat(LONG));
        assert!(
            prose(&long).into_string().starts_with("<details class=\"prose\"><summary>It moves.")
        );
        assert_eq!(prose("It moves. So it is.").into_string(), "<p>It moves. So it is.</p>");
    }
}
