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
