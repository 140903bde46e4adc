//! The figure of all margins.

use harness::{case::Tier, make::Made, suite};
use report::{Layer, Panel};
use validation::{cases::CASES, margins};

/// A gate that is lost from the figure, or hidden below another one, would not be missed by eye.
#[test]
fn every_gate_has_a_dot_and_a_place_of_its_own() {
    let suite = suite::judge(suite::plans(CASES, Tier::Quick), Tier::Quick, Made::default());
    let judged = suite.judged().count();
    let figure = margins::figure(&suite);
    let [Panel::Plot(plot)] = figure.panels.as_slice() else { panic!("one plot") };
    let series = plot.layers.iter().filter_map(|layer| match layer {
        Layer::Series(series) => Some(series),
        _ => None,
    });
    let mut dots: Vec<(f64, f64)> = series.flat_map(|series| series.points.clone()).collect();
    assert_eq!(dots.len(), judged);
    let rows = CASES.len() as f64;
    assert!(dots.iter().all(|(_, y)| (-0.5..rows - 0.5).contains(y)));
    dots.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    assert!(dots.windows(2).all(|pair| pair[0] != pair[1]));
}
