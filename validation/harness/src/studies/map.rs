//! Maps: the outcomes of runs as a function of two settings.

use touchstone_base::record::Record;
use touchstone_report::{Axis, Figure, Layer, Plot};

use crate::{
    declare::{Map, MapPanel},
    runs::Runs,
    study::Study,
};

pub fn study(map: &Map, runs: &Runs) -> Study {
    let figure = Figure::new(&map.id, &map.caption).columns(map.panels.len().max(1));
    let figure = map.panels.iter().fold(figure, |figure, of| figure.panel(panel(map, of, runs)));
    Study::new(&map.id, &map.title).block(figure)
}

fn panel(map: &Map, panel: &MapPanel, runs: &Runs) -> Plot {
    let mut cells = vec![Vec::new(); map.outcomes.len()];
    for (y, row) in panel.cells.iter().enumerate() {
        for (x, specs) in row.iter().enumerate() {
            let records: Vec<&Record> = specs.iter().filter_map(|spec| runs.record(spec)).collect();
            if !records.is_empty() {
                let (outcome, text) = (map.outcome)(&records);
                cells[outcome].push((x, y, text));
            }
        }
    }
    let plot =
        Plot::new(&panel.title, Axis::names(&map.x, &panel.x), Axis::names(&map.y, &panel.y));
    map.outcomes.iter().zip(cells).fold(plot, |plot, ((name, colour), cells)| {
        plot.layer(Layer::Cells { name: name.clone(), colour: *colour, cells })
    })
}

#[cfg(test)]
mod tests {
    use touchstone_base::spec::RunSpec;
    use touchstone_report::{Block, Colour};

    use super::*;
    use crate::studies::tests::{ERROR, runs, spec};

    /// Cells of x = 1, 2, 3 and y = 10, 20: the run of x + y has this sum as its error; the cell of 2 and 10
    /// has no run, the cell of 3 and 20 has two.
    #[test]
    fn a_cell_is_of_the_runs_of_its_column_and_row() {
        let cell = |x: usize, y: usize| -> Vec<RunSpec> {
            match (x, y) {
                (2, 10) => Vec::new(),
                (3, 20) => vec![spec("seed", 23), spec("seed", 99)],
                _ => vec![spec("seed", x + y)],
            }
        };
        let map = Map {
            id: "case-map".into(),
            title: "Map".into(),
            caption: "Made up.".into(),
            x: "x [-]".into(),
            y: "y [-]".into(),
            outcomes: vec![("small".into(), Colour::BLACK), ("large".into(), Colour::GREY)],
            panels: vec![MapPanel::over("panel", &[1, 2, 3], &[10, 20], cell)],
            outcome: |records| {
                let sum: f64 = records.iter().map(|r| r.value(ERROR).unwrap_or(f64::NAN)).sum();
                (usize::from(sum > 20.0), sum.to_string())
            },
        };
        let made = [11, 13, 21, 22, 23, 99].map(|n| (spec("seed", n), n as f64));
        let study = study(&map, &runs(made));
        let [Block::Figure(figure)] = study.blocks.as_slice() else { panic!("one figure") };
        let [drawn] = figure.panels.as_slice() else { panic!("one map") };
        let names = [&drawn.x, &drawn.y].map(|axis| axis.names.join(" "));
        assert_eq!(names, ["1 2 3", "10 20"]);
        let cells = |cells: &[(usize, usize, &str)]| {
            let owned = cells.iter().map(|(x, y, text)| (*x, *y, text.to_string()));
            owned.collect::<Vec<_>>()
        };
        let outcomes = drawn.layers.iter().map(|layer| match layer {
            Layer::Cells { name, cells, .. } => (name.as_str(), cells.clone()),
            _ => panic!("cells alone"),
        });
        let small = cells(&[(0, 0, "11"), (2, 0, "13")]);
        let large = cells(&[(0, 1, "21"), (1, 1, "22"), (2, 1, "122")]);
        let expected = [("small", small), ("large", large)];
        assert_eq!(outcomes.collect::<Vec<_>>(), expected, "rows from bottom to top");
    }
}
