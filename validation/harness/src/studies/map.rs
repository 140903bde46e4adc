//! Maps: the outcomes of runs as a function of two settings.

use base::record::Record;
use report::{CategoryMap, Figure};

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

fn panel(map: &Map, panel: &MapPanel, runs: &Runs) -> CategoryMap {
    let cell = |specs: &Vec<_>| {
        let records: Vec<&Record> = specs.iter().filter_map(|spec| runs.record(spec)).collect();
        (!records.is_empty()).then(|| (map.outcome)(&records))
    };
    CategoryMap {
        title: panel.title.clone(),
        x_label: map.x.clone(),
        y_label: map.y.clone(),
        x: panel.x.clone(),
        y: panel.y.clone(),
        categories: map.outcomes.clone(),
        cells: panel.cells.iter().map(|row| row.iter().map(cell).collect()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use base::spec::RunSpec;
    use report::{Block, Colour, Panel};

    use super::*;
    use crate::studies::tests::{ERROR, runs, spec};

    /// Cells of x = 1, 2, 3 and y = 10, 20: the run of x + y, whose error is that; the cell of 2 and 10 was
    /// not run, that of 3 and 20 has two runs.
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
        let [Panel::Categories(drawn)] = figure.panels.as_slice() else { panic!("one map") };
        assert_eq!((drawn.x.join(" "), drawn.y.join(" ")), ("1 2 3".into(), "10 20".into()));
        let some = |outcome: usize, text: &str| Some((outcome, text.to_string()));
        let rows = [
            vec![some(0, "11"), None, some(0, "13")],
            vec![some(1, "21"), some(1, "22"), some(1, "122")],
        ];
        assert_eq!(drawn.cells, rows, "from bottom to top, each row from left to right");
    }
}
