//! A page with every kind of block, from made-up data, is whole. `.ci/browser` uses it as a reader does: it
//! sets `TOUCHSTONE_PAGE` to the folder that the page is to be written to.

#![allow(clippy::disallowed_methods, reason = "drawings are judged by eye, not by bits")]

use std::io;
use std::path::PathBuf;
use touchstone_base::gate::Verdict;
use touchstone_report::{
    Axis, Block, Cell, ColourMap, Counts, Dot, Dots, Explorer, Figure, Overview, Page, Plot,
    Section, Series, Subject, Table, TableColumn, VERDICTS, check_page,
};

#[test]
fn a_page_of_made_up_data_is_whole() {
    let temporary = tempfile::tempdir().unwrap();
    let named = std::env::var_os("TOUCHSTONE_PAGE").map(PathBuf::from);
    let folder = named.as_deref().unwrap_or(temporary.path());
    let page = page().unwrap();
    let html = page.html();
    page.write_html(&folder.join("index.html"), &html).unwrap();
    check_page(&html).unwrap();
    assert_eq!(std::fs::read_to_string(folder.join("index.html")).unwrap(), html);
    assert!(folder.join("figures").join("figure.png").is_file());
}

/// A plot over logarithmic axes, with all that runs add to it, and a map of particles.
fn figure() -> Figure {
    let error = |c: f64| [0.1, 0.05, 0.025].map(|h: f64| (h, c * h.powf(1.5))).to_vec();
    let plot = Plot::new("Error", Axis::log("Δx [1]"), Axis::log("relative error [1]"))
        .layer(Series::line("cubic spline", error(0.3)).cycle(0))
        .layer(Series::line("quintic spline", error(0.5)).cycle(1).labels(["10".into()]));
    let at = |k: i32| 0.05 * f64::from(k);
    let dot = |k| Dot { x: at(k % 20), y: at(k / 20), value: at(k % 7) };
    let points = (0..400).map(dot).collect();
    let dots = Dots::new("|u| [m/s]", ColourMap::Sequential, 0.05, points);
    let map = Plot::new("Speed", Axis::linear("x [m]"), Axis::linear("y [m]")).layer(dots);
    Figure::new("figure", "An order with *made-up* errors.").panel(plot).panel(map).columns(2)
}

fn table() -> Table {
    let columns = vec![
        TableColumn::text("gate"),
        TableColumn::num("measured", "1"),
        TableColumn::text("verdict"),
    ];
    let row = |k: usize, status| {
        vec![
            Cell::marked(format!("`gate{k}`")),
            Cell::sci(0.01, 2).with(status),
            Cell::status(status),
        ]
    };
    let rows = Verdict::ALL.into_iter().enumerate();
    rows.fold(Table::new("Gates of this *demo*.", columns), |table, (k, status)| {
        table.row(row(k, status))
    })
}

/// Forty verdicts, each fifth outside of its bound.
fn explorer() -> Explorer {
    let heads =
        ["verdict", "gate", "value", "bound", "margin", "run or study", "evidence", "reasons"];
    let numbers = ["value", "margin"];
    let column = |head| match numbers.contains(&head) {
        true => TableColumn::num(head, ""),
        false => TableColumn::text(head),
    };
    let gate = |k: usize| {
        let case = ["curves", "maps"][k % 2];
        let status = if k.is_multiple_of(5) { Verdict::Limitation } else { Verdict::Pass };
        vec![
            Cell::status(status),
            Cell::text(format!("{case}.gate{k}")),
            Cell::num(k as f64, 2),
            Cell::text("at most 30"),
            Cell::percent(1.0 - k as f64 / 40.0, 2),
            Cell::marked(format!("`seed` n={k}")),
            Cell::text(if k.is_multiple_of(3) { "theory" } else { "analytic" }),
            Cell::text((1 + k % 2).to_string()),
        ]
    };
    let gates = (0..40).map(gate).fold(Table::new("", heads.map(column).into()), Table::row);
    let reasons = ["An even number.", "An odd number of *some* size."].map(String::from);
    Explorer { gates, reasons: reasons.into() }
}

fn page() -> io::Result<Page> {
    let row = Subject {
        id: "curves".into(),
        title: "Curves".into(),
        about: "of a made-up case".into(),
        picture: Some(Figure { id: "small".into(), ..figure() }),
        cells: vec![
            Cell::marked("**[1.2 %](#curves.gate0)**"),
            Cell::text("–").because("no order"),
        ],
    };
    let columns = vec![TableColumn::num("error", ""), TableColumn::num("order", "")];
    let overview = Overview { caption: "Results".into(), columns, rows: vec![row] };
    let curves = Section::new("curves", "Curves")
        .counts(Counts::of([Verdict::Pass]))
        .prose(
            "See [the figure](#figure) and [Morris et al.](https://doi.org/10.1006/jcph.1997.5776). \
             Run `touchstone report`.",
        )
        .block(figure())
        .child(Section::new("below", "A section below").prose("With little in it."));
    let details = Block::Details { summary: "All settings".into(), blocks: vec![table().into()] };
    Ok(Page {
        title: "Demo of the report".into(),
        lead: vec!["Every block once, from made-up data. **Not a result.**".into()],
        counts: Counts::of(Verdict::ALL),
        overview,
        opening: vec![Block::Prose(vec!["A note below the table.".into()])],
        sections: vec![
            Section::new(VERDICTS, "Verdicts").block(Block::Explorer(explorer())),
            Section::new("maps", "A table")
                .block(table())
                .block(Block::List(vec!["one".into(), "two".into()]))
                .block(details),
            curves,
        ],
        figure_folder: "figures".into(),
        ..Page::default()
    })
}
