//! Profiles or histories, plotted together with their reference.

use touchstone_report::{Colour, Figure, Plot, Series, Shape};

use crate::{
    declare::{CurvePanel, Curves},
    runs::Runs,
    study::Study,
};

pub fn study(curves: &Curves, runs: &Runs) -> Study {
    let columns = (curves.panels.len() as f64).sqrt().ceil() as usize;
    let figure = Figure::new(&curves.id, &curves.caption).columns(columns.max(1));
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

/// A name has one colour in all panels, by its position among `names`.
fn panel(of: &CurvePanel, names: &[&str], runs: &Runs) -> Plot {
    let mut plot = Plot::new(&of.title, of.x.clone(), of.y.clone());
    for (name, points) in &of.references {
        let line = Series::line(name, points.clone());
        plot = plot.layer(match name.is_empty() {
            true => line.colour(Colour::GREY).width(0.8),
            false => line.colour(Colour::BLACK),
        });
    }
    for (k, line) in of.lines.iter().enumerate() {
        let Some(record) = runs.record(&line.spec) else { continue };
        let points = (line.points)(record);
        let named = names.iter().position(|name| !name.is_empty() && *name == line.name);
        let k = named.unwrap_or(k);
        let line = Series::line(&line.name, points).colour(Colour::cycle(k));
        plot = plot.layer(if of.symbols { line.open_markers(Shape::cycle(k)) } else { line });
    }
    plot
}

#[cfg(test)]
mod tests {
    use touchstone_report::{Axis, Block, Layer};

    use super::*;
    use crate::{
        declare::CurveOf,
        studies::tests::{ERROR, runs, spec},
    };

    fn line(name: &str, variant: &str, n: usize) -> CurveOf {
        let points = |record: &touchstone_base::record::Record| {
            vec![(1.0, record.value(ERROR).unwrap_or(f64::NAN))]
        };
        CurveOf { name: name.into(), spec: spec(variant, n), points: Box::new(points) }
    }

    fn panel_of(lines: Vec<CurveOf>, references: &[&str], symbols: bool) -> CurvePanel {
        let references =
            references.iter().map(|name| (name.to_string(), vec![(0.0, 7.0)])).collect();
        let axis = || Axis::linear("x");
        CurvePanel { title: "panel".into(), x: axis(), y: axis(), lines, references, symbols }
    }

    /// Name, first point, colour, and whether symbols are drawn in place of a line.
    type Drawn = (String, (f64, f64), Colour, bool);

    fn drawn(panels: Vec<CurvePanel>) -> Vec<Vec<Drawn>> {
        let curves = Curves {
            id: "case-curves".into(),
            title: "Curves".into(),
            caption: "Made up.".into(),
            panels,
        };
        let runs = runs([(spec("seed", 1), 1.5), (spec("best", 1), 2.5)]);
        let study = study(&curves, &runs);
        let [Block::Figure(figure)] = study.blocks.as_slice() else { panic!("one figure") };
        let of = |plot: &Plot| -> Vec<Drawn> {
            let series = plot.layers.iter().map(|layer| match layer {
                Layer::Series(s) => {
                    (s.name.clone(), s.points[0], s.look.colour, s.look.line.is_none())
                }
                _ => panic!("series alone"),
            });
            series.collect()
        };
        figure.panels.iter().map(of).collect()
    }

    #[test]
    fn a_name_keeps_its_colour_from_panel_to_panel() {
        let panels = drawn(vec![
            panel_of(vec![line("a", "seed", 1), line("b", "best", 1)], &["exact", ""], false),
            // The run of `c` was not made.
            panel_of(vec![line("b", "best", 1), line("c", "seed", 2)], &[], false),
        ]);
        let reference = |name: &str, colour| (name.to_string(), (0.0, 7.0), colour, false);
        let run = |name: &str, y: f64, k| (name.to_string(), (1.0, y), Colour::cycle(k), false);
        assert_eq!(
            panels[0],
            [
                reference("exact", Colour::BLACK),
                reference("", Colour::GREY),
                run("a", 1.5, 0),
                run("b", 2.5, 1)
            ]
        );
        assert_eq!(panels[1], [run("b", 2.5, 1)]);
    }

    #[test]
    fn symbols_stand_on_grey_lines_that_have_no_name() {
        let both = vec![line("", "seed", 1), line("", "best", 1)];
        let panels = drawn(vec![panel_of(both, &["", "exact"], true)]);
        let shown = panels[0].iter().map(|(_, _, colour, is_marks)| (*colour, *is_marks));
        let expected = [
            (Colour::GREY, false),
            (Colour::BLACK, false),
            (Colour::cycle(0), true),
            (Colour::cycle(1), true),
        ];
        assert!(shown.eq(expected));
    }
}
