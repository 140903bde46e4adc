//! Profiles or histories, plotted together with their reference.

use report::{Colour, Figure, Legend, Plot, Series, Shape};

use crate::{
    declare::{CurvePanel, Curves},
    runs::Runs,
    study::Study,
};

pub fn study(curves: &Curves, runs: &Runs) -> Study {
    let figure = Figure::new(&curves.id, &curves.caption).columns(curves.columns);
    let figure = curves.panels.iter().fold(figure, |figure, of| figure.panel(panel(of, runs)));
    Study::new(&curves.id, &curves.title).block(figure.panel_size(360.0, 270.0))
}

fn panel(of: &CurvePanel, runs: &Runs) -> Plot {
    let mut plot = Plot::new(&of.title, of.x.clone(), of.y.clone());
    for (k, (name, points)) in of.references.iter().enumerate() {
        let colour = if of.symbols { Colour::cycle(k) } else { Colour::BLACK };
        let name = if of.symbols { "" } else { name };
        plot = plot.layer(Series::line(name, points.clone()).colour(colour));
    }
    for (k, line) in of.lines.iter().enumerate() {
        let Some(record) = runs.record(&line.spec) else { continue };
        let points = (line.points)(record);
        let (colour, shape) = (Colour::cycle(k), Shape::cycle(k));
        plot = plot.layer(match of.symbols {
            true => Series::markers(&line.name, points).colour(colour).shape(shape).open(),
            false => Series::line(&line.name, points).colour(colour),
        });
    }
    plot.legend(Legend::Auto)
}
