//! The data model of a figure: content, not layout.

use super::axis::Axis;
use super::colour::{Colour, ColourMap};

/// One or more panels in a grid, with a caption.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Unique on its page; also the name of its PNG file.
    pub id: String,
    /// Description, with commit and settings; inline markup as in [`super::Block::Prose`].
    pub caption: String,
    /// Panels, row by row.
    pub panels: Vec<Plot>,
    /// Panels in a row.
    pub columns: usize,
    /// Size of the area inside the axes of one panel, in CSS pixels.
    pub panel_size: (f64, f64),
}

impl Figure {
    /// A figure without panels, in one column of 420 × 290 pixels.
    pub fn new(id: impl Into<String>, caption: impl Into<String>) -> Self {
        Self {
            id: id.into(),
            caption: caption.into(),
            panels: Vec::new(),
            columns: 1,
            panel_size: (420.0, 290.0),
        }
    }

    /// Adds a panel.
    pub fn panel(mut self, panel: Plot) -> Self {
        self.panels.push(panel);
        self
    }

    /// Sets the number of columns.
    pub fn columns(self, columns: usize) -> Self {
        Self { columns, ..self }
    }

    /// Sets the size inside the axes of one panel.
    pub fn panel_size(self, width: f64, height: f64) -> Self {
        Self { panel_size: (width, height), ..self }
    }
}

/// Layers over two axes; at equal aspect if one of them is of dots.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Drawn above the axes; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Drawn in this order.
    pub layers: Vec<Layer>,
    /// Whether the names of the layers are listed below.
    pub legend: bool,
    /// Whether it has no texts, ticks and colour bar.
    pub is_small: bool,
}

impl Plot {
    /// An empty plot with a legend.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), x, y, layers: Vec::new(), legend: true, is_small: false }
    }

    /// Adds a layer.
    pub fn layer(mut self, layer: impl Into<Layer>) -> Self {
        self.layers.push(layer.into());
        self
    }

    /// Its dots, if any.
    pub(super) fn dots(&self) -> Option<&Dots> {
        self.layers.iter().find_map(|layer| match layer {
            Layer::Dots(dots) => Some(dots),
            _ => None,
        })
    }

    /// Removes the legend.
    pub fn without_legend(self) -> Self {
        Self { legend: false, ..self }
    }

    /// A picture without any text, as small as a row of a table.
    pub fn small(mut self) -> Self {
        self.title.clear();
        [&mut self.x, &mut self.y].into_iter().for_each(|axis| axis.label.clear());
        Self { is_small: true, ..self.without_legend() }
    }
}

/// One thing drawn on a plot.
#[derive(Debug, Clone, PartialEq)]
pub enum Layer {
    /// A line, markers, or both, with or without error bars.
    Series(Series),
    /// The area between two curves.
    Band {
        /// Its ends at each x.
        points: Vec<BandPoint>,
        /// Drawn as a pale tint of this colour.
        colour: Colour,
    },
    /// Particles coloured by a value, with a colour bar; one such layer a plot.
    Dots(Dots),
    /// Cells of one outcome on a grid, whose axes have names.
    Cells {
        /// Name of the outcome in the legend.
        name: String,
        /// Colour of the cells.
        colour: Colour,
        /// The cells.
        cells: Vec<GridCell>,
    },
}

/// The ends of a band at x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandPoint {
    /// Place on the horizontal axis.
    pub x: f64,
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

/// A cell of a grid, counted from the lower left corner.
#[derive(Debug, Clone, PartialEq)]
pub struct GridCell {
    /// Its column.
    pub column: usize,
    /// Its row.
    pub row: usize,
    /// A short text.
    pub text: String,
}

impl From<Series> for Layer {
    fn from(series: Series) -> Self {
        Self::Series(series)
    }
}

impl From<Dots> for Layer {
    fn from(dots: Dots) -> Self {
        Self::Dots(dots)
    }
}

/// Dash pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// ●
    Circle,
    /// ■
    Square,
    /// ▲
    Triangle,
    /// ◆
    Diamond,
    /// ▼
    Down,
    /// ✕
    Cross,
}

impl Shape {
    /// The shape of the `i`th of many series.
    pub fn cycle(i: usize) -> Self {
        const CYCLE: [Shape; 5] =
            [Shape::Circle, Shape::Square, Shape::Triangle, Shape::Diamond, Shape::Down];
        CYCLE[i % CYCLE.len()]
    }
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Colour of line and markers.
    pub colour: Colour,
    /// The line, if any.
    pub line: Option<Dash>,
    /// Width of the line in CSS pixels.
    pub width: f64,
    /// The shape of markers, if points are marked.
    pub marker: Option<Shape>,
    /// Open markers: reference data.
    pub open: bool,
}

/// A line, markers, or both, with or without error bars. Points that are not finite, or not
/// positive on a logarithmic axis, break the line and are counted above the plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; empty leaves it out.
    pub name: String,
    /// (x, y).
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub look: Look,
    /// (lower, upper) end of the bar in x for each point; empty for none.
    pub x_bars: Vec<(f64, f64)>,
    /// A short label next to each point, omitted where there is no room; empty for none.
    pub labels: Vec<String>,
    /// A name of each point, shown with its value on hover in a page; empty for none.
    pub names: Vec<String>,
}

impl Series {
    /// A solid black line.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        let line = Some(Dash::Solid);
        let look = Look { colour: Colour::BLACK, line, width: 1.6, marker: None, open: false };
        let (x_bars, labels, names) = (Vec::new(), Vec::new(), Vec::new());
        Self { name: name.into(), points, look, x_bars, labels, names }
    }

    /// Open markers in place of the line.
    pub fn open_markers(self, shape: Shape) -> Self {
        let look = Look { line: None, marker: Some(shape), open: true, ..self.look };
        Self { look, ..self }
    }

    /// Sets the colour.
    pub fn colour(self, colour: Colour) -> Self {
        Self { look: Look { colour, ..self.look }, ..self }
    }

    /// Sets the dash pattern.
    pub fn dash(self, dash: Dash) -> Self {
        Self { look: Look { line: Some(dash), ..self.look }, ..self }
    }

    /// Sets the width of the line.
    pub fn width(self, width: f64) -> Self {
        Self { look: Look { width, ..self.look }, ..self }
    }

    /// Colour, marker and line of the `i`th of many curves that may coincide: of any three in sequence, one
    /// is solid with full markers, and the next two are drawn over it dashed and dotted with open ones.
    pub fn cycle(self, i: usize) -> Self {
        let dash = [Dash::Solid, Dash::Dashed, Dash::Dotted][(i + 1) % 3];
        let (colour, marker) = (Colour::cycle(i), Some(Shape::cycle(i)));
        let open = dash != Dash::Solid;
        Self { look: Look { colour, line: Some(dash), marker, open, ..self.look }, ..self }
    }

    /// Sets a short label next to each point.
    pub fn labels(self, labels: impl IntoIterator<Item = String>) -> Self {
        Self { labels: labels.into_iter().collect(), ..self }
    }
}

/// A dot; one whose value is not finite becomes a black cross.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dot {
    /// Place on the horizontal axis.
    pub x: f64,
    /// Place on the vertical axis.
    pub y: f64,
    /// Value that gives its colour.
    pub value: f64,
}

/// Dots coloured by a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Dots {
    /// The dots.
    pub points: Vec<Dot>,
    /// Colour map.
    pub map: ColourMap,
    /// Values at the ends of the colour bar; `None` takes the data's.
    pub values: Option<(f64, f64)>,
    /// Quantity and unit of the colour bar.
    pub label: String,
    /// Diameter of a dot in units of x and y (the particle spacing, say), drawn with two pixels at least.
    pub diameter: f64,
}

impl Dots {
    /// Dots of this diameter in units of x and y, with an automatic range of colours.
    pub fn new(label: impl Into<String>, map: ColourMap, diameter: f64, points: Vec<Dot>) -> Self {
        Self { points, map, values: None, label: label.into(), diameter }
    }

    /// Sets the ends of the colour bar.
    pub fn values(self, lo: f64, hi: f64) -> Self {
        Self { values: Some((lo, hi)), ..self }
    }
}
