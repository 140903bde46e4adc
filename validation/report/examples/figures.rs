//! Draws one figure of each kind and a page that holds them all, from made-up data.
//!
//! `cargo run -p touchstone-report --example figures -- FOLDER`

#![allow(clippy::disallowed_methods, reason = "drawings are judged by eye, not by bits")]

use report::{
    Axis, Block, Card, CategoryMap, Cell, Colour, ColourMap, Column, Counts, Dash, Explorer,
    Figure, Film, GateRow, Layer, Legend, Page, ParticleMap, Plot, Section, Series, Shape, Status,
    Table, VERDICTS, check_page,
};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from).ok_or("which folder?")?;
    std::fs::create_dir_all(&folder)?;
    let page = page()?;
    page.write(&folder.join("index.html"))?;
    for section in &page.sections {
        for block in &section.blocks {
            if let Block::Figure(figure) = block {
                println!("{}: {} bytes of SVG", figure.id, report::svg(figure).len());
            }
        }
    }
    println!("{:?}", check_page(&page.html())?);
    Ok(())
}

/// Points of a function.
fn sampled(n: usize, from: f64, to: f64, f: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let at = |i: usize| from + (to - from) * i as f64 / (n - 1) as f64;
    (0..n).map(|i| (at(i), f(at(i)))).collect()
}

fn convergence() -> Figure {
    let h: [f64; 5] = [0.1, 0.05, 0.025, 0.0125, 0.00625];
    let error = |order: f64, c: f64| -> Vec<(f64, f64)> {
        h.iter().map(|&h| (h, c * h.powf(order) + 2e-5)).collect()
    };
    let plot = Plot::new(
        "Error in u",
        Axis::log("particle spacing Δx/L [1]"),
        Axis::log("relative L₂ error of u [1]"),
    )
    .layer(Series::line_markers("cubic spline", error(1.5, 0.3)))
    .layer(Series::line_markers("quintic spline", error(2.0, 0.5)))
    .layer(Series::markers("Morris et al. 1997", error(1.8, 0.9)).open().colour(Colour::BLACK))
    .layer(Layer::horizontal(3e-5, "rounding floor"))
    .layer(Layer::slope(2.0));
    let across = Axis::log("particles across the channel N [1]");
    let labels = h.map(|h| format!("N = {:.0}", 1.0 / h));
    let count = Plot::new(
        "Same against the number of particles",
        across.ticks([10.0, 20.0, 40.0, 80.0, 160.0]),
        Axis::log("relative L₂ error of u [1]"),
    )
    .layer(Series::line_markers("WCSPH", h.map(|h| (1.0 / h, h * h)).into()).labels(labels))
    .layer(Layer::slope(-2.0));
    Figure::new("convergence", "Order of accuracy with *made-up* errors.")
        .title("Convergence of the Taylor–Green vortex")
        .panel(plot)
        .panel(count)
        .columns(2)
}

fn band_and_bars() -> Figure {
    let mean = |t: f64| (-0.8 * t).exp();
    let band = sampled(80, 0.0, 4.0, mean).iter().map(|p| (p.0, 0.85 * p.1, 1.12 * p.1)).collect();
    let mut data = sampled(9, 0.25, 3.8, |t| mean(t) * (1.0 + 0.06 * (9.0 * t).sin()));
    data[4].1 = f64::NAN;
    let x_bars = data.iter().map(|p| (p.0 - 0.1, p.0 + 0.1)).collect();
    let experiment = Series::markers("experiment", data).open().colour(Colour::VERMILLION);
    let plot =
        Plot::new("Decay", Axis::linear("time t [s]"), Axis::linear("E/E₀ [1]").range(0.0, 1.1))
            .layer(Layer::band("spread of five runs", band, Colour::SKY))
            .layer(Series::line("exact", sampled(80, 0.0, 4.0, mean)).colour(Colour::BLACK))
            .layer(experiment.shape(Shape::Square).x_bars(x_bars));
    let shapes =
        [Shape::Circle, Shape::Square, Shape::Triangle, Shape::Diamond, Shape::Down, Shape::Cross];
    let mut all = Plot::new("Every shape and dash", Axis::linear("x [1]"), Axis::linear("y [1]"))
        .legend(Legend::Outside);
    for (i, shape) in shapes.into_iter().enumerate() {
        let dash = [Dash::Solid, Dash::Dashed, Dash::Dotted][i % 3];
        let line = sampled(9, 0.0, 8.0, |x| i as f64 + 0.3 * x.sin());
        let series = Series::line_markers(format!("{shape:?}, {dash:?}"), line);
        all = all.layer(if i % 2 == 0 { series.open() } else { series }.shape(shape).dash(dash));
    }
    Figure::new("bars", "Error bars, a band, a rule; one value is not finite.")
        .panel(plot)
        .panel(all)
        .columns(2)
        .panel_size(360.0, 280.0)
}

fn stability() -> Figure {
    let done = [0.05, 0.1, 0.2, 0.25, 0.3, 0.35].map(|c| (c, 2e-3 + 1e-3 * c));
    let failed = [
        (0.4, "diverged at t = 0.31 s"),
        (0.45, "diverged at t = 0.08 s"),
        (0.5, "density < 0"),
        (0.6, "NaN"),
    ]
    .map(|(c, why)| (c, why.to_string()));
    let plot = Plot::new(
        "Stability",
        Axis::linear("Courant number [1]"),
        Axis::log("relative L₂ error [1]").range(1e-3, 1e-1),
    )
    .layer(Series::line_markers("predictor–corrector", done.to_vec()))
    .layer(Layer::Failed(failed.to_vec()));
    let noise = (0..100_000).map(|i| {
        let t = f64::from(i) * 1e-4;
        (t, 1e5 * ((1.0 - (-t).exp()) + 0.1 * (517.0 * t).sin() * (3.0 * t).cos()))
    });
    let series = Plot::new(
        "A long series",
        Axis::linear("time t [s]"),
        Axis::linear("pressure at the gauge [Pa]"),
    )
    .layer(Series::line("SPH", noise.collect()).width(1.0))
    .layer(Layer::horizontal(1.0e5, "ρgH"));
    Figure::new(
        "stability",
        "Failed runs stay visible; a series of 100 000 points is thinned without losing peaks.",
    )
    .panel(plot)
    .panel(series)
    .columns(2)
}

fn particles() -> Figure {
    let n = 45;
    let at = |i: usize| (i as f64 + 0.5) / n as f64;
    let tau = std::f64::consts::TAU;
    let mut points: Vec<_> = (0..n * n)
        .map(|k| {
            let (x, y) =
                (at(k % n) + 0.004 * (k as f64).sin(), at(k / n) + 0.004 * (3.0 * k as f64).cos());
            (x, y, (tau * x).sin() * (tau * y).cos())
        })
        .collect();
    let speed = points.iter().map(|p| (p.0, 0.5 * p.1, 3e-4 * p.2.abs())).collect();
    points[700].2 = f64::NAN;
    let axes =
        || (Axis::linear("x/L [1]").range(0.0, 1.0), Axis::linear("y/L [1]").range(0.0, 1.0));
    let wide = (Axis::linear("x [m]"), Axis::linear("y [m]"));
    Figure::new("particles", "Signed and unsigned values; one particle has no value.")
        .panel(ParticleMap::new("Pressure", axes(), "p/(ρU²) [1]", ColourMap::Diverging, points))
        .panel(
            ParticleMap::new("Speed", wide, "|u| [m/s]", ColourMap::Sequential, speed)
                .values(0.0, 3e-4),
        )
        .columns(2)
        .panel_size(330.0, 330.0)
}

fn outcomes() -> Figure {
    let categories = [
        ("pass", Colour::GREEN),
        ("too inaccurate", Colour::YELLOW),
        ("diverged", Colour::VERMILLION),
        ("timed out", Colour::PURPLE),
    ];
    let cell = |r: usize, c: usize| match r + c {
        0..4 => Some((0, format!("{:.1} %", 0.3 * (r + c + 1) as f64))),
        4..6 => Some((1, format!("{:.0} %", 4.0 * (r + c) as f64))),
        6 if r == 1 => Some((3, "1 h".to_string())),
        9 => None,
        _ => Some((2, format!("t = {:.2}", 1.0 / (r + c) as f64))),
    };
    let map = CategoryMap {
        title: "Outcome of each setting".into(),
        x_label: "Courant number [1]".into(),
        y_label: "Reynolds number [1]".into(),
        x: ["0.05", "0.1", "0.2", "0.3", "0.4", "0.5"].map(String::from).to_vec(),
        y: ["1", "10", "100", "1000", "10 000"].map(String::from).to_vec(),
        categories: categories.map(|(n, c)| (n.to_string(), c)).to_vec(),
        cells: (0..5).map(|r| (0..6).map(|c| cell(r, c)).collect()).collect(),
    };
    Figure::new("outcomes", "Where the method works; an empty cell was not run.")
        .panel(map)
        .panel_size(400.0, 220.0)
}

fn small() -> Figure {
    let cost = |c: f64| -> Vec<(f64, f64)> {
        [2.0_f64, 20.0, 300.0, 4000.0].iter().map(|&t| (t, c * t.powf(-0.6))).collect()
    };
    let precision = Plot::new(
        "Work and precision",
        Axis::log("cost [core s]"),
        Axis::log("relative L₂ error [1]"),
    )
    .layer(Series::line_markers("leapfrog", cost(0.3)))
    .layer(Series::line_markers("predictor–corrector", cost(0.2)).dash(Dash::Dashed))
    .layer(Series::line_markers("super-time-stepping", cost(0.05)).dash(Dash::Dotted))
    .layer(Layer::slope(-0.6))
    .layer(Layer::Failed(vec![(7.0, "diverged".into()), (9.0, "diverged".into())]));
    let offset = sampled(30, 0.0, 10.0, |t| 1000.0 + 0.02 * t.sin());
    let density = Plot::new(
        "A small change of a large value",
        Axis::linear("t [s]"),
        Axis::linear("ρ [kg/m³]"),
    )
    .layer(Series::line("", offset));
    let energy = (0..12).map(|k| (10f64.powi(-k), 10f64.powi(-2 * k))).collect();
    let decades = Plot::new("Many decades", Axis::log("Δt [s]"), Axis::log("energy error [1]"))
        .layer(Series::markers("measured", energy).size(5.0))
        .layer(Layer::horizontal(1e-16, "machine precision"));
    Figure::new("small", "Small panels with long names, many decades and an offset.")
        .panel(precision)
        .panel(density)
        .panel(decades)
        .columns(3)
        .panel_size(210.0, 180.0)
}

fn table() -> Table {
    let columns = vec![
        Column::text("gate"),
        Column::num("measured", "1"),
        Column::num("bound", "1"),
        Column::num("cost", ""),
        Column::text("verdict"),
    ];
    let rows = [
        ("`channel.couette` error", 3.2e-4, 1e-3, 12.5, Status::Pass),
        ("`vortex` order", 1.2e-2, 1e-2, 400.0, Status::Fail),
        ("`cavity` Re 3200", f64::NAN, 0.1, 8000.0, Status::ExpectedFailure),
        ("`dam` front", 4.4e-2, 0.1, 0.02, Status::Pass),
        ("`beam` tension", 0.31, 0.1, 61.0, Status::Limitation),
    ];
    rows.into_iter().fold(
        Table::new("Gates of this *demo*.", columns),
        |table, (name, x, bound, cost, status)| {
            table.row(vec![
                Cell::text(name),
                Cell::sci(x, 2).with(status),
                Cell::num(bound, 2),
                Cell::seconds(cost),
                Cell::status(status),
            ])
        },
    )
}

fn card() -> Card {
    Card {
        id: "curves".into(),
        title: "Curves".into(),
        picture: Some(small()),
        facts: vec![("Error:".into(), "**1.2 %** in 3 s".into())],
        counts: Counts::of([Status::Pass, Status::Limitation]),
        limitations: vec!["It is made up.".into()],
    }
}

/// Forty verdicts, each fifth outside of its bound.
fn explorer() -> Explorer {
    let gate = |k: usize| {
        let case = ["curves", "maps"][k % 2];
        GateRow {
            id: format!("{case}.gate{k}"),
            status: if k.is_multiple_of(5) { Status::Limitation } else { Status::Pass },
            of: format!("`seed` n={k}"),
            value: Cell::num(k as f64, 2),
            bound: "at most 30".into(),
            margin: Cell::percent(1.0 - k as f64 / 40.0, 2),
            evidence: if k.is_multiple_of(3) { "theory" } else { "analytic" }.into(),
            reasons: vec![1 + k % 2],
        }
    };
    let reasons = ["An even number.", "An odd number of *some* size."].map(String::from);
    Explorer { gates: (0..40).map(gate).collect(), reasons: reasons.into() }
}

fn film() -> Result<Film, String> {
    let frame = |k: u32| {
        let points = sampled(40, 0.0, 6.0, |x| (x + f64::from(k)).sin());
        let plot = Plot::new("", Axis::linear("x [m]"), Axis::linear("y [m]").range(-1.0, 1.0));
        Figure::new("frame", "")
            .panel(plot.layer(Series::line("", points)))
            .panel_size(200.0, 100.0)
    };
    Film::new("film", "A wave that moves.", &(0..8).map(frame).collect::<Vec<_>>(), 120)
}

fn page() -> Result<Page, String> {
    let formula = "<math><mfrac><mrow><mi>d</mi><mi>ρ</mi></mrow><mrow><mi>d</mi><mi>t</mi></mrow></mfrac>\
                   <mo>=</mo><mo>−</mo><mi>ρ</mi><mo>∇</mo><mo>⋅</mo><mi mathvariant=\"bold\">u</mi></math>";
    let outcomes_seen = [Status::Pass, Status::Fail, Status::ExpectedFailure, Status::Limitation];
    let mut section = Section::new("curves", "Curves").status(Status::Fail).prose(format!(
        "Continuity reads {formula}; see [the convergence](#convergence) and \
         [Morris et al.](https://doi.org/10.1006/jcph.1997.5776). Run `touchstone report`."
    ));
    for figure in [convergence(), band_and_bars(), stability()] {
        section = section.block(figure);
    }
    let maps = [particles(), outcomes(), small()];
    let maps =
        maps.into_iter().fold(Section::new("maps", "Maps").status(Status::Pass), Section::block);
    let details = Block::Details { summary: "All settings".into(), blocks: vec![table().into()] };
    Ok(Page {
        title: "Demo of the report".into(),
        lead: vec!["Every block once, from made-up data. **Not a result.**".into()],
        counts: Some(Counts::of(outcomes_seen)),
        cards: vec![card()],
        notes: vec!["A note below the cards.".into()],
        sections: vec![
            Section::new(VERDICTS, "Verdicts").block(Block::Explorer(explorer())),
            Section::new("table", "A table")
                .block(film()?)
                .block(table())
                .block(Block::List(vec!["one".into(), "two".into()])),
            section.child(Section::new("below", "A section below").prose("With little in it.")),
            maps.block(details),
        ],
        footer: "Commit `0000000`, clean; four threads.".into(),
        png_folder: "figures".into(),
    })
}
