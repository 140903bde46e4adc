//! The values that a figure shows, for the script of the page: it shows the value at a point and writes all
//! of them into a file.

use serde_json::{Value, json};

use super::axis::Ruler;
use super::canvas::Rect;
use super::figure::{Dots, Layer};
use super::plot::Prepared;
use super::ticks::Scale;

/// Axes, place of the axes on the drawing and values of a panel: series as name, x, y and the names of
/// points, and cells and particles as further series.
pub(super) fn panel(panel: &Prepared, area: Rect) -> Value {
    let (plot, [x, y]) = panel.parts();
    let axis = |ruler: &Ruler| {
        let mapping = ruler.mapping;
        json!([mapping.scale == Scale::Log, mapping.lo, mapping.hi])
    };
    let series = plot.layers.iter().filter_map(|layer| match layer {
        Layer::Series(series) => {
            let [x, y] = columns(&series.points);
            Some(json!({ "name": series.name, "x": x, "y": y, "names": series.names }))
        }
        Layer::Dots(Dots { points, label, .. }) => {
            let of = |f: fn(&(f64, f64, f64)) -> f64| points.iter().map(f).map(short).collect();
            let [x, y, value]: [Vec<Value>; 3] = [of(|p| p.0), of(|p| p.1), of(|p| p.2)];
            Some(json!({ "name": label, "x": x, "y": y, "values": value }))
        }
        Layer::Cells { name, cells, .. } => {
            let of = |names: &[String], k: usize| names.get(k).cloned().unwrap_or_default();
            let x: Vec<_> = cells.iter().map(|cell| of(&plot.x.names, cell.0)).collect();
            let y: Vec<_> = cells.iter().map(|cell| of(&plot.y.names, cell.1)).collect();
            let texts: Vec<_> = cells.iter().map(|cell| &cell.2).collect();
            Some(json!({ "name": name, "x": x, "y": y, "names": texts }))
        }
        Layer::Band { .. } => None,
    });
    let series: Vec<Value> = series.collect();
    let place = [area.left, area.top, area.width, area.height].map(short);
    json!({
        "title": plot.title,
        "labels": [plot.x.label, plot.y.label],
        "axes": [axis(x), axis(y)],
        "area": place,
        "series": series,
    })
}

/// All panels as a text that may stand in an element of a page.
pub(super) fn json(panels: Vec<Value>) -> String {
    let text = Value::from(panels).to_string();
    text.replace('&', "\\u0026").replace('<', "\\u003c").replace('>', "\\u003e")
}

fn columns(points: &[(f64, f64)]) -> [Vec<Value>; 2] {
    [points.iter().map(|p| short(p.0)).collect(), points.iter().map(|p| short(p.1)).collect()]
}

/// A number with five digits; none where it is not finite.
fn short(value: f64) -> Value {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    let is_whole = rounded == rounded.trunc() && rounded.abs() < 1e9;
    if is_whole { json!(rounded as i64) } else { json!(rounded) }
}

#[cfg(test)]
mod tests {
    use super::super::render::parts;
    use crate::{Axis, ColourMap, Dots, Figure, Layer, Plot, Series};
    use serde_json::Value;

    /// The data that the script reads: values with five digits, gaps, and names of points.
    #[test]
    fn the_data_of_a_figure_are_its_values() {
        let names = vec!["first".into(), "a < b".into()];
        let line = Series::line("line", vec![(0.1, 1.0 / 3.0), (1.0, f64::NAN)]);
        let plot = Plot::new("Panel", Axis::log("x [m]"), Axis::linear("y [1]"));
        let plot = plot.layer(Series { names, ..line });
        let dots = Dots::new("p [Pa]", ColourMap::Sequential, 0.1, vec![(0.0, 0.0, 2.0)]);
        let dots = Plot::new("", Axis::linear("x"), Axis::linear("y")).layer(dots);
        let named =
            |names: &[&str]| -> Vec<String> { names.iter().map(|n| n.to_string()).collect() };
        let (x, y) = (Axis::names("x", &named(&["1", "2"])), Axis::names("y", &named(&["3"])));
        let cells = vec![(1, 0, "ok".into())];
        let cells = Layer::Cells { name: "pass".into(), colour: crate::Colour::GREEN, cells };
        let figure = Figure::new("f", "").panel(plot).panel(dots);
        let data = parts(&figure.panel(Plot::new("", x, y).layer(cells)), "aloud").data;
        assert!(!data.contains(['<', '>', '&']), "{data}");
        let data: Value = serde_json::from_str(&data).expect("JSON");
        let line = &data[0]["series"][0];
        assert_eq!((&data[0]["axes"][0][0], &line["x"][0]), (&true.into(), &0.1.into()));
        assert_eq!((&line["y"][0], &line["y"][1]), (&0.33333.into(), &Value::Null));
        assert_eq!(line["names"][1], "a < b");
        assert_eq!(data[1]["series"][0]["values"][0], 2);
        let cell = &data[2]["series"][0];
        assert_eq!(
            (&cell["x"][0], &cell["y"][0], &cell["names"][0]),
            (&"2".into(), &"3".into(), &"ok".into())
        );
    }
}
