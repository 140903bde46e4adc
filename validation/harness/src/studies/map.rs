//! Maps: the outcomes of runs as a function of two settings.

use touchstone_base::{functions::powf, mutation::Disorder, record::Record, spec::RunSpec};
use touchstone_report::{Axis, Colour, Figure, GridCell, Layer, Plot};

use crate::{
    runs::{Planned, Runs},
    section::Section,
    study::Study,
};

/// Starts of each cell in the deep tier.
pub const STARTS: usize = 20;
/// The disorder by which starts of a cell differ that has one start in the full tier \[spacings\]: more than
/// round-off, and far below the resolution of a map.
const DISORDER: f64 = 0.01;

/// A start of a run with a value of the setting in which starts differ; none if the case has no such run.
pub type Start = fn(&RunSpec, f64) -> Option<RunSpec>;

/// An outcome of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapOutcome {
    /// Name in the legend.
    pub name: &'static str,
    /// Colour of the cell.
    pub colour: Colour,
}

/// Outcomes over two settings.
pub struct Map {
    /// Anchor of the study and of its figure.
    pub id: String,
    /// Title of the section.
    pub title: String,
    /// Caption of the figure.
    pub caption: String,
    /// Name of the horizontal setting, with its unit.
    pub x: String,
    /// Name of the vertical setting, with its unit.
    pub y: String,
    /// The possible outcomes of a cell, in the order of the legend.
    pub outcomes: Vec<MapOutcome>,
    /// Panels side by side.
    pub panels: Vec<MapPanel>,
    /// The outcome of a cell from its records, and a short text. A run that was refused has a record too.
    pub outcome: fn(&[&Record]) -> (MapOutcome, String),
    /// The setting in which the starts of a cell differ, and the ends of its values; without one a cell has
    /// one start, and further starts are disordered.
    pub starts: Option<(Start, [f64; 2])>,
}

/// One panel of a map.
pub struct MapPanel {
    /// Title of the panel.
    pub title: String,
    /// Values of the horizontal setting, left to right.
    pub x: Vec<String>,
    /// Values of the vertical setting, bottom to top.
    pub y: Vec<String>,
    /// `cells[row][column]`: the runs of a cell; none if it is not run.
    pub cells: Vec<Vec<Vec<RunSpec>>>,
}

impl MapPanel {
    /// A panel over values of two settings; `cell(x, y)` are the runs of a cell.
    pub fn over<A: Copy + ToString, B: Copy + ToString>(
        title: &str,
        x: &[A],
        y: &[B],
        cell: impl Fn(A, B) -> Vec<RunSpec>,
    ) -> Self {
        let row = |y: &B| x.iter().map(|x| cell(*x, *y)).collect();
        let cells = y.iter().map(row).collect();
        let (x, y) = (x.iter().map(A::to_string).collect(), y.iter().map(B::to_string).collect());
        Self { title: title.into(), x, y, cells }
    }
}

impl Map {
    fn cells(&self) -> impl Iterator<Item = &Vec<RunSpec>> {
        self.panels.iter().flat_map(|panel| &panel.cells).flatten()
    }

    /// The start that is added to a cell as number `k` of `more`: values are spread by equal ratios.
    fn start(&self, first: &RunSpec, k: usize, more: usize) -> Option<RunSpec> {
        let Some((start, [least, most])) = self.starts else {
            let disorder = Disorder { most: DISORDER, seed: 1 + k as u32 };
            return Some(first.clone().disordered(disorder));
        };
        // A quarter off the middle of each part, so that none falls on a start that is there.
        start(first, powf(most / least, (k as f64 + 0.25) / more as f64) * least)
    }
}

impl Study for Map {
    fn runs(&self) -> Vec<Planned> {
        self.cells().flatten().map(|spec| Planned::new(spec.clone())).collect()
    }

    fn evaluate(&self, _: &str, runs: &Runs) -> Option<Section> {
        let figure = Figure::new(&self.id, &self.caption).columns(self.panels.len().max(1));
        let panels = self.panels.iter().map(|of| panel(self, of, runs));
        Some(Section::new(&self.id, &self.title).block(panels.fold(figure, Figure::panel)))
    }

    /// Adds starts to the cells.
    fn deepen(&mut self, _: &[Planned]) {
        let more = |cell: &Vec<RunSpec>| -> Vec<RunSpec> {
            let Some(first) = cell.first() else { return Vec::new() };
            let more = STARTS.saturating_sub(cell.len());
            (0..more).filter_map(|k| self.start(first, k, more)).collect()
        };
        let added: Vec<Vec<RunSpec>> = self.cells().map(more).collect();
        let cells = self.panels.iter_mut().flat_map(|panel| &mut panel.cells).flatten();
        cells.zip(added).for_each(|(cell, added)| cell.extend(added));
    }
}

fn panel(map: &Map, panel: &MapPanel, runs: &Runs) -> Plot {
    let mut all = Vec::new();
    for (y, row) in panel.cells.iter().enumerate() {
        for (x, specs) in row.iter().enumerate() {
            let records: Vec<&Record> = specs.iter().filter_map(|spec| runs.record(spec)).collect();
            if !records.is_empty() {
                let (outcome, text) = (map.outcome)(&records);
                all.push((outcome, GridCell { column: x, row: y, text }));
            }
        }
    }
    let plot =
        Plot::new(&panel.title, Axis::names(&map.x, &panel.x), Axis::names(&map.y, &panel.y));
    map.outcomes.iter().fold(plot, |plot, of| {
        let cells = all.iter().filter(|(outcome, _)| outcome == of).map(|(_, cell)| cell.clone());
        plot.layer(Layer::Cells { name: of.name.into(), colour: of.colour, cells: cells.collect() })
    })
}

#[cfg(test)]
mod tests {
    use touchstone_report::Block;

    use super::*;
    use crate::studies::tests::{ERROR, evaluate, runs, spec};

    const SMALL: MapOutcome = MapOutcome { name: "small", colour: Colour::BLACK };
    const LARGE: MapOutcome = MapOutcome { name: "large", colour: Colour::GREY };

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
            outcomes: vec![SMALL, LARGE],
            panels: vec![MapPanel::over("panel", &[1, 2, 3], &[10, 20], cell)],
            outcome: |records| {
                let sum: f64 = records.iter().map(|r| r.value(ERROR).unwrap_or(f64::NAN)).sum();
                (if sum > 20.0 { LARGE } else { SMALL }, sum.to_string())
            },
            starts: None,
        };
        let made = [11, 13, 21, 22, 23, 99].map(|n| (spec("seed", n), n as f64));
        let section = evaluate(&map, runs(made));
        let [Block::Figure(figure)] = section.blocks.as_slice() else { panic!("one figure") };
        let [drawn] = figure.panels.as_slice() else { panic!("one map") };
        let names = [&drawn.x, &drawn.y].map(|axis| axis.names.join(" "));
        assert_eq!(names, ["1 2 3", "10 20"]);
        let cells = |cells: &[(usize, usize, &str)]| {
            let cell = |&(column, row, text): &(usize, usize, &str)| GridCell {
                column,
                row,
                text: text.into(),
            };
            cells.iter().map(cell).collect::<Vec<_>>()
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
