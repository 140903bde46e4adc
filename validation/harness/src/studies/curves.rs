//! Profiles or histories, plotted together with their reference.

use report::{Colour, Figure, Legend, Plot, Series, Shape};

use crate::{
    declare::{CurvePanel, Curves},
    runs::Runs,
    study::Study,
};

pub fn study(curves: &Curves, runs: &Runs) -> Study {
    let figure = Figure::new(&curves.id, &curves.caption).columns(curves.columns);
    let mut names: Vec<&str> = Vec::new();
    for line in curves.panels.iter().flat_map(|panel| &panel.lines) {
        if !names.contains(&line.name.as_str()) {
            names.push(&line.name);
        }
    }
    let panels = curves.panels.iter().map(|of| panel(of, &names, runs));
    let figure = panels.fold(figure, Figure::panel);
    Study::new(&curves.id, &curves.title).block(figure.panel_size(360.0, 270.0))
}

/// A name has one colour in all panels, which is that of its position among `names`.
fn panel(of: &CurvePanel, names: &[&str], runs: &Runs) -> Plot {
    let mut plot = Plot::new(&of.title, of.x.clone(), of.y.clone());
    let has_partners = of.symbols && of.references.len() >= of.lines.len();
    for (k, (name, points)) in of.references.iter().enumerate() {
        let is_partner = has_partners && k < of.lines.len();
        let line = Series::line(if is_partner { "" } else { name }, points.clone());
        plot = plot.layer(match is_partner {
            true => line.colour(Colour::cycle(k)),
            // A guide.
            false if name.is_empty() => line.colour(Colour::GREY).width(0.8),
            false => line.colour(Colour::BLACK),
        });
    }
    for (k, line) in of.lines.iter().enumerate() {
        let Some(record) = runs.record(&line.spec) else { continue };
        let points = (line.points)(record);
        let named = names.iter().position(|name| !name.is_empty() && *name == line.name);
        let k = named.unwrap_or(k);
        let (colour, shape) = (Colour::cycle(k), Shape::cycle(k));
        plot = plot.layer(match of.symbols {
            true => Series::markers(&line.name, points).colour(colour).shape(shape).open(),
            false => Series::line(&line.name, points).colour(colour),
        });
    }
    plot.legend(Legend::Auto)
}
