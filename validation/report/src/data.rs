//! The values that a figure shows, for the script of the page: it shows the value at a point and writes all
//! of them into a file.

use serde_json::{Value, json};

use super::axis::Ruler;
use super::canvas::Rect;
use super::figure::{Dots, Layer};
use super::plot::Prepared;
use super::ticks::Scale;

/// Columns of values, each once, which series name by their place.
#[derive(Default)]
pub(super) struct Columns(Vec<Vec<Value>>);

impl Columns {
    /// The place of a column.
    fn place(&mut self, column: Vec<Value>) -> usize {
        let known = self.0.iter().position(|of| *of == column);
        known.unwrap_or_else(|| {
            self.0.push(column);
            self.0.len() - 1
        })
    }

    /// The place of a column of numbers over an axis, or of a colour.
    fn numbers(&mut self, values: impl Iterator<Item = f64> + Clone, scale: Scale) -> usize {
        let step = if scale == Scale::Linear { step(values.clone()) } else { 0.0 };
        self.place(values.map(|value| short(value, step)).collect())
    }
}

/// Axes, place of the axes on the drawing and values of a panel: series as name, x, y and the names of
/// points, and cells and particles as further series.
pub(super) fn panel(panel: &Prepared, area: Rect, columns: &mut Columns) -> Value {
    let (plot, [x, y]) = panel.parts();
    let axis = |ruler: &Ruler| {
        let mapping = ruler.mapping;
        json!([mapping.scale == Scale::Log, mapping.lo, mapping.hi])
    };
    let series = plot.layers.iter().filter_map(|layer| match layer {
        Layer::Series(series) => {
            let x = columns.numbers(series.points.iter().map(|p| p.0), plot.x.scale);
            let y = columns.numbers(series.points.iter().map(|p| p.1), plot.y.scale);
            Some(json!({ "name": series.name, "x": x, "y": y, "names": series.names }))
        }
        Layer::Dots(Dots { points, label, .. }) => {
            let each = points.len().div_ceil(MOST_DOTS).max(1);
            let points = points.iter().step_by(each);
            let x = columns.numbers(points.clone().map(|p| p.x), plot.x.scale);
            let y = columns.numbers(points.clone().map(|p| p.y), plot.y.scale);
            let values = columns.numbers(points.map(|p| p.value), Scale::Linear);
            let some = if each > 1 { format!(", 1 of {each} particles") } else { String::new() };
            Some(json!({ "name": format!("{label}{some}"), "x": x, "y": y, "values": values }))
        }
        Layer::Cells { name, cells, .. } => {
            let of = |names: &[String], k: usize| json!(names.get(k).cloned().unwrap_or_default());
            let x =
                columns.place(cells.iter().map(|cell| of(&plot.x.names, cell.column)).collect());
            let y = columns.place(cells.iter().map(|cell| of(&plot.y.names, cell.row)).collect());
            let texts: Vec<_> = cells.iter().map(|cell| &cell.text).collect();
            Some(json!({ "name": name, "x": x, "y": y, "names": texts }))
        }
        Layer::Band { .. } => None,
    });
    let series: Vec<Value> = series.collect();
    let place = [area.left, area.top, area.width, area.height].map(|number| short(number, 0.0));
    json!({
        "title": plot.title,
        "labels": [plot.x.label, plot.y.label],
        "axes": [axis(x), axis(y)],
        "area": place,
        "series": series,
    })
}

/// All panels as a text that may stand in an element of a page.
pub(super) fn json(panels: Vec<Value>, columns: Columns) -> String {
    let text = json!({ "panels": panels, "columns": columns.0 }).to_string();
    text.replace('&', "\\u0026").replace('<', "\\u003c").replace('>', "\\u003e")
}

/// Most particles of a panel with a value at the pointer: more are nearer to each other than its reach, and
/// the records have all.
const MOST_DOTS: usize = 2_000;

/// Points beyond which a column is drawn, not read: its numbers have the digits that the drawing shows.
const MANY: usize = 40;

/// The least difference of many numbers that a drawing shows, a power of ten; 0 of few numbers.
fn step(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let finite = values.filter(|value| value.is_finite());
    let ends = [f64::min, f64::max].map(|of: fn(f64, f64) -> f64| finite.clone().reduce(of));
    let span = ends[1].zip(ends[0]).map_or(0.0, |(most, least)| most - least);
    match finite.count() > MANY && span > 0.0 {
        true => 10f64.powf((span / 300.0).log10().floor()),
        false => 0.0,
    }
}

/// A number with five digits, or fewer where they are below a step; none where it is not finite.
fn short(value: f64, step: f64) -> Value {
    let value = if step > 0.0 { (value / step).round() * step } else { value };
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    let is_whole = rounded == rounded.trunc() && rounded.abs() < 1e9;
    if is_whole { json!(rounded as i64) } else { json!(rounded) }
}

#[cfg(test)]
mod tests {
    use super::super::render::parts;
    use super::*;
    use crate::{Axis, ColourMap, Dot, Figure, GridCell, Plot, Series};

    /// A panel of many particles has some of them, and says how many.
    #[test]
    fn a_panel_of_many_particles_names_its_share() {
        for (count, kept, name) in [(2000, 2000, "u"), (2001, 1001, "u, 1 of 2 particles")] {
            let dot = |k: i32| Dot { x: f64::from(k), y: 0.0, value: 1.0 };
            let dots = Dots::new("u", ColourMap::Sequential, 1.0, (0..count).map(dot).collect());
            let plot = Plot::new("", Axis::linear("x"), Axis::linear("y")).layer(dots);
            let data = parts(&Figure::new("f", "").panel(plot), "aloud").data;
            let data: Value = serde_json::from_str(&data).expect("JSON");
            let series = &data["panels"][0]["series"][0];
            let x = series["x"].as_u64().expect("a column") as usize;
            assert_eq!(data["columns"][x].as_array().map(Vec::len), Some(kept));
            assert_eq!(series["name"], name);
        }
    }

    /// The data that the script reads: values with five digits, gaps, and names of points.
    #[test]
    fn the_data_of_a_figure_are_its_values() {
        let names = vec!["first".into(), "a < b".into()];
        let line = Series::line("line", vec![(0.1, 1.0 / 3.0), (1.0, f64::NAN)]);
        let plot = Plot::new("Panel", Axis::log("x [m]"), Axis::linear("y [1]"));
        let plot = plot.layer(Series { names, ..line });
        let dots = Dots::new(
            "p [Pa]",
            ColourMap::Sequential,
            0.1,
            vec![Dot { x: 0.0, y: 0.0, value: 2.0 }],
        );
        let dots = Plot::new("", Axis::linear("x"), Axis::linear("y")).layer(dots);
        let named =
            |names: &[&str]| -> Vec<String> { names.iter().map(|n| n.to_string()).collect() };
        let (x, y) = (Axis::names("x", &named(&["1", "2"])), Axis::names("y", &named(&["3"])));
        let cells = vec![GridCell { column: 1, row: 0, text: "ok".into() }];
        let cells = Layer::Cells { name: "pass".into(), colour: crate::Colour::GREEN, cells };
        let figure = Figure::new("f", "").panel(plot).panel(dots);
        let data = parts(&figure.panel(Plot::new("", x, y).layer(cells)), "aloud").data;
        assert!(!data.contains(['<', '>', '&']), "{data}");
        let data: Value = serde_json::from_str(&data).expect("JSON");
        let column = |k: usize, name: &str| {
            let place = data["panels"][k]["series"][0][name].as_u64().expect("a place");
            data["columns"][place as usize].clone()
        };
        assert_eq!(
            (&data["panels"][0]["axes"][0][0], &column(0, "x")[0]),
            (&true.into(), &0.1.into())
        );
        assert_eq!(column(0, "y"), json!([0.33333, null]));
        assert_eq!(data["panels"][0]["series"][0]["names"][1], "a < b");
        assert_eq!(column(1, "values"), json!([2]));
        assert_eq!((column(2, "x"), column(2, "y")), (json!(["2"]), json!(["3"])));
        assert_eq!(data["panels"][2]["series"][0]["names"][0], "ok");
    }

    /// A column that many points have in common is written once, with the digits that a drawing shows.
    #[test]
    fn a_column_of_many_values_is_written_once_and_short() {
        let mut columns = Columns::default();
        let times = (0..100).map(|k| f64::from(k) / 3.0);
        let places = [0, 1].map(|_| columns.numbers(times.clone(), Scale::Linear));
        assert_eq!((places, columns.0.len()), ([0, 0], 1));
        assert_eq!(columns.0[0][1], json!(0.3));
        let few = columns.numbers(times.take(5), Scale::Linear);
        assert_eq!(columns.0[few][1], json!(0.33333));
    }
}
