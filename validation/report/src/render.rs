//! From a figure to an SVG text or a PNG file.

use super::bar::Bar;
use super::canvas::{Canvas, Rect};
use super::colour::Colour;
use super::data;
use super::figure::Figure;
use super::frame::Room;
use super::legend::{self, Entry};
use super::plot::{Prepared, extent};
use super::raster::Raster;
use super::svg::{self, Svg};
use plotters::prelude::BitMapBackend;
use std::{io, path::Path};
use touchstone_base::files;

/// Drawn pixels per pixel of a PNG.
const SUPERSAMPLE: u32 = 3;
/// Pixels of a PNG per CSS pixel.
const DENSITY: u32 = 2;
const EDGE: f64 = 5.0;

/// Panels with their places, and the size of the whole.
struct Layout<'a> {
    panels: Vec<(Prepared<'a>, Rect)>,
    /// The legend below all panels.
    legend: Vec<Entry>,
    /// The common colour bar of all panels, if any, and the rectangle next to it.
    bar: Option<(Bar, Rect)>,
    size: (f64, f64),
}

/// Entries of the panels, each once.
fn legend(panels: &[Prepared]) -> Vec<Entry> {
    let mut all: Vec<Entry> = Vec::new();
    for entry in panels.iter().flat_map(Prepared::legend) {
        if !all.contains(&entry) {
            all.push(entry);
        }
    }
    all
}

/// The common colour bar of several panels, if they are equal; the panels then have none.
fn shared_bar(panels: &mut [Prepared]) -> Option<Bar> {
    let bars: Option<Vec<&mut Bar>> = panels.iter_mut().map(|panel| panel.bar()).collect();
    let is_one = |bars: &Vec<&mut Bar>| bars.iter().all(|bar| *bar == bars[0]);
    let bars = bars.filter(|bars| bars.len() > 1 && is_one(bars))?;
    let bar = bars[0].clone();
    bars.into_iter().for_each(|bar| bar.is_shared = true);
    Some(bar)
}

/// The panels with their scales; pictures of particles have the same axes.
fn prepared(figure: &Figure) -> Vec<Prepared<'_>> {
    let room = (figure.panel_size.0.max(80.0), figure.panel_size.1.max(60.0));
    let mut extents: Vec<[Vec<f64>; 2]> = figure.panels.iter().map(extent).collect();
    if figure.panels.iter().all(|plot| plot.dots().is_some()) {
        let all = [0, 1].map(|axis| extents.iter().flat_map(|of| of[axis].clone()).collect());
        extents.fill(all);
    }
    let panels = figure.panels.iter().zip(&extents);
    panels.map(|(plot, of)| Prepared::new(plot, room, of)).collect()
}

/// Aligns the axes of all panels in a row and in a column.
fn layout(figure: &Figure) -> Layout<'_> {
    let columns = figure.columns.clamp(1, figure.panels.len().max(1));
    let mut panels = prepared(figure);
    let legend = legend(&panels);
    let bar = shared_bar(&mut panels);
    let rooms: Vec<Room> = panels.iter().map(|panel| panel.room()).collect();
    // Left margin, inner width and right margin of each column; top, height and bottom of each row.
    let mut across = vec![[0.0_f64; 3]; columns];
    let mut down = vec![[0.0_f64; 3]; panels.len().div_ceil(columns)];
    for (i, room) in rooms.iter().enumerate() {
        let widths = [room.left, room.width, room.right];
        let heights = [room.top, room.height, room.bottom];
        for k in 0..3 {
            across[i % columns][k] = across[i % columns][k].max(widths[k]);
            down[i / columns][k] = down[i / columns][k].max(heights[k]);
        }
    }
    let (lefts, right) = starts(across);
    let (tops, bottom) = starts(down);
    let place = |(i, Room { width, height, .. }): (usize, Room)| Rect {
        left: lefts[i % columns],
        top: tops[i / columns],
        width,
        height,
    };
    let rects: Vec<Rect> = rooms.into_iter().enumerate().map(place).collect();
    let least = legend::column(&legend);
    let width = (right + bar.as_ref().map_or(0.0, Bar::width)).max(least).ceil();
    let bar = bar.and_then(|bar| {
        let (first, last) = (rects.first()?, rects.last()?);
        let height = last.bottom() - first.top;
        Some((bar, Rect { left: 0.0, top: first.top, width: right - EDGE - 10.0, height }))
    });
    let height = (bottom + legend::height(&legend, width)).max(60.0).ceil();
    Layout { panels: panels.into_iter().zip(rects).collect(), legend, bar, size: (width, height) }
}

/// Where the inner part of each slot starts, and where all end.
fn starts(slots: Vec<[f64; 3]>) -> (Vec<f64>, f64) {
    let mut at = EDGE;
    let starts = slots.into_iter().map(|[before, inner, after]| {
        let start = at + before;
        at = start + inner + after;
        start
    });
    let starts = starts.collect();
    (starts, at + EDGE)
}

fn draw(canvas: &mut Canvas, layout: &Layout) {
    let (width, height) = layout.size;
    canvas.fill(Rect { left: 0.0, top: 0.0, width, height }, Colour::WHITE);
    for (panel, area) in &layout.panels {
        panel.draw(&mut canvas.from(*area));
    }
    let below = height - legend::height(&layout.legend, width) - EDGE;
    legend::draw(canvas, &layout.legend, (EDGE, below), width);
    if let Some((bar, beside)) = &layout.bar {
        bar.draw(canvas, *beside);
    }
}

/// A figure as the parts that a page arranges.
pub(super) struct Parts {
    /// Each panel as an SVG element of its natural size that shrinks with its container.
    pub panels: Vec<String>,
    /// The entries of the legend: name and sample, an SVG element.
    pub legend: Vec<(String, String)>,
    /// Axes and values of all panels, as JSON.
    pub data: String,
}

/// The parts of a figure whose panels are read aloud as this text.
pub(super) fn parts(figure: &Figure, aloud: &str) -> Parts {
    let mut panels = prepared(figure);
    let legend = legend(&panels).into_iter().map(|entry| (entry.sample(), entry.name));
    let legend = legend.map(|(sample, name)| (name, sample)).collect();
    if shared_bar(&mut panels).is_some() {
        // The last one has the bar of all.
        panels.last_mut().and_then(Prepared::bar).into_iter().for_each(|bar| bar.is_shared = false);
    }
    let mut columns = data::Columns::default();
    let drawn = |panel: &Prepared| {
        let Room { left, width, right, top, height, bottom } = panel.room();
        let area = Rect { left: EDGE + left, top: EDGE + top, width, height };
        let size = (2.0 * EDGE + left + width + right, 2.0 * EDGE + top + height + bottom);
        let mut sheet = Svg::default();
        let mut canvas = Canvas::new(&mut sheet);
        canvas.fill(Rect::of((size.0.ceil(), size.1.ceil())), Colour::WHITE);
        panel.draw(&mut canvas.from(area));
        let title = panel.parts().0.title.as_str();
        let label = if title.is_empty() { aloud.into() } else { format!("{title}. {aloud}") };
        let svg =
            svg::opening(&label, (size.0.ceil(), size.1.ceil())) + &sheet.finish() + "</svg>\n";
        (svg, data::panel(panel, area, &mut columns))
    };
    let (panels, data): (Vec<String>, Vec<_>) = panels.iter().map(drawn).unzip();
    Parts { panels, legend, data: data::json(data, columns) }
}

/// The whole figure as an SVG element of its natural size.
pub fn svg(figure: &Figure) -> String {
    let layout = layout(figure);
    let mut sheet = Svg::default();
    draw(&mut Canvas::new(&mut sheet), &layout);
    svg::opening(&figure.id, layout.size) + &sheet.finish() + "</svg>\n"
}

/// Pixels of the figure, three bytes each, with their width and height; `density` of them per CSS
/// pixel.
pub(super) fn pixels(figure: &Figure, density: u32) -> (Vec<u8>, u32, u32) {
    let layout = layout(figure);
    let scale = SUPERSAMPLE * density;
    let (width, height) = (layout.size.0 as u32 * density, layout.size.1 as u32 * density);
    let (fine_width, fine_height) = (width * SUPERSAMPLE, height * SUPERSAMPLE);
    let mut fine = vec![255; (fine_width * fine_height * 3) as usize];
    let backend = BitMapBackend::with_buffer(&mut fine, (fine_width, fine_height));
    let mut sheet = Raster { backend, scale: f64::from(scale) };
    draw(&mut Canvas::new(&mut sheet), &layout);
    drop(sheet);
    (downsample(&fine, width as usize, height as usize), width, height)
}

/// Means of squares of `SUPERSAMPLE` by `SUPERSAMPLE` pixels.
fn downsample(fine: &[u8], width: usize, height: usize) -> Vec<u8> {
    let n = SUPERSAMPLE as usize;
    let mut out = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let mut sum = 0;
                for dy in 0..n {
                    let row = ((y * n + dy) * width * n + x * n) * 3 + channel;
                    sum += (0..n).map(|dx| usize::from(fine[row + 3 * dx])).sum::<usize>();
                }
                out.push((sum / (n * n)) as u8);
            }
        }
    }
    out
}

/// Writes the figure as a PNG file of twice its natural size. The file appears complete or not at all.
pub fn png(figure: &Figure, path: &Path) -> io::Result<()> {
    files::write_atomically(path, &png_bytes(figure)?).map_err(io::Error::other)
}

/// The bytes of that file.
pub(super) fn png_bytes(figure: &Figure) -> io::Result<Vec<u8>> {
    let (pixels, width, height) = pixels(figure, DENSITY);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::{Axis, BandPoint, ColourMap, Dot, Dots, GridCell, Layer, Plot, Series, Shape};

    fn figure(panel: Plot) -> Figure {
        Figure::new("f", "A caption.").panel(panel).panel_size(120.0, 90.0)
    }

    fn dark_pixels(figure: &Figure) -> usize {
        let (pixels, ..) = pixels(figure, DENSITY);
        pixels.chunks(3).filter(|p| p.iter().all(|&c| c < 100)).count()
    }

    #[test]
    fn labels_have_ink() {
        let axis = || Axis::linear("").range(0.0, 1.0);
        let bare = figure(Plot::new("", axis(), axis()));
        let with = figure(Plot::new("", Axis { label: "ρ₀ [10⁻³]".into(), ..axis() }, axis()));
        assert!(dark_pixels(&with) > dark_pixels(&bare) + 100);
        assert!(svg(&with).contains(">ρ₀ [10⁻³]</text>"));
    }

    /// Every kind of layer, from one set of values.
    fn all_layers(values: &[f64], x: Axis, y: Axis) -> Plot {
        let pairs: Vec<_> =
            values.iter().flat_map(|&a| values.iter().map(move |&b| (a, b))).collect();
        let band = |&(x, lower): &(f64, f64)| BandPoint { x, lower, upper: x };
        let band = pairs.iter().map(band).collect();
        let b = Series::line("b", pairs.clone()).open_markers(Shape::Cross);
        Plot::new("Title", x, y)
            .layer(Series::line("a", pairs.clone()).cycle(0))
            .layer(Series { x_bars: pairs, ..b })
            .layer(Layer::Band { points: band, colour: Colour::SKY })
    }

    #[test]
    fn no_data_makes_the_drawing_panic() {
        let awkward = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0, 1e-320, 1e308, 1.0];
        let mut cases: Vec<Vec<f64>> = awkward.iter().map(|&v| vec![v]).collect();
        cases.extend([vec![], awkward.to_vec(), vec![f64::NAN, 1.0, 2.0]]);
        let axes =
            [Axis::linear("x [m]"), Axis::log("x [m]"), Axis::log("x").range(-1.0, f64::NAN)];
        for values in cases {
            for (x, y) in axes.iter().flat_map(|x| axes.iter().map(move |y| (x, y))) {
                let text = svg(&figure(all_layers(&values, x.clone(), y.clone())));
                let stray = text.lines().find(|l| l.contains("inf") || l.contains("NaN,"));
                assert_eq!(stray, None, "{values:?}");
            }
            let points = values.iter().map(|&v| Dot { x: v, y: v, value: v }).collect();
            let dots = Dots::new("p [Pa]", ColourMap::Diverging, 0.0, points);
            let plot = Plot::new("", Axis::linear("x"), Axis::log("y"));
            svg(&figure(plot.clone().layer(dots.clone())));
            let last = values.first().copied().unwrap_or(1.0);
            svg(&figure(plot.layer(dots.values(1.0, last))));
        }
        pixels(&figure(all_layers(&awkward, axes[0].clone(), axes[1].clone())), DENSITY);
    }

    #[test]
    fn cells_and_figures_without_any_are_drawn() {
        let plot = |x: &[&str], y: &[&str]| {
            let [x, y] = [x, y].map(|names| names.iter().map(|name| name.to_string()).collect());
            let (x, y): (Vec<String>, Vec<String>) = (x, y);
            let cell = |column, row, text: &str| GridCell { column, row, text: text.into() };
            let cells = vec![cell(0, 0, "ok"), cell(9, 1, "beyond")];
            let layer = Layer::Cells { name: "pass".into(), colour: Colour::GREEN, cells };
            Plot::new("t", Axis::names("x", &x), Axis::names("y", &y)).layer(layer)
        };
        let text = svg(&figure(plot(&["1", "a rather long name"], &["2", "3"])));
        assert!(text.contains(">ok</text>") && text.contains(">pass</text>"), "{text}");
        svg(&figure(plot(&[], &[])));
        svg(&Figure::new("none", "").columns(0));
    }

    /// A dot whose value is not finite was drawn as a cross and counted as not drawn, too.
    #[test]
    fn a_dot_without_a_place_is_counted_and_one_without_a_value_is_a_cross() {
        let dot = |x, y, value| Dot { x, y, value };
        let with = |last| {
            let points = vec![dot(0.0, 0.0, 1.0), dot(1.0, 1.0, 2.0), last];
            let dots = Dots::new("p [Pa]", ColourMap::Sequential, 0.1, points);
            let plot = Plot::new("", Axis::linear("x [m]"), Axis::linear("y [m]")).layer(dots);
            svg(&figure(plot))
        };
        assert!(!with(dot(0.5, 0.5, f64::NAN)).contains("not drawn"));
        assert!(with(dot(f64::NAN, 0.5, 1.0)).contains("not drawn: 1 not finite"));
    }

    #[test]
    fn two_thousand_dots_stay_small() {
        let dot = |i: i32| Dot { x: (i % 50).into(), y: (i / 50).into(), value: i.into() };
        let points = (0..2000).map(dot);
        let dots = Dots::new("p [Pa]", ColourMap::Sequential, 0.0, points.collect());
        let plot = Plot::new("", Axis::linear("x [m]"), Axis::linear("y [m]")).layer(dots);
        assert!(svg(&figure(plot)).len() < 30_000);
    }

    /// Panels with equal content have one legend, in which a name with two styles has two entries.
    #[test]
    fn a_legend_stands_below_what_it_explains() {
        let plot = |name: &str, colour| {
            let line = Series::line(name, vec![(0.0, 0.0), (1.0, 1.0)]).colour(colour);
            Plot::new("", Axis::linear("x"), Axis::linear("y")).layer(line)
        };
        let first = plot("a name", Colour::BLUE);
        let names = |second| svg(&figure(first.clone()).panel(second)).matches(">a name<").count();
        assert_eq!(
            [Colour::BLUE, Colour::GREEN].map(|colour| names(plot("a name", colour))),
            [1, 2]
        );
        let without = layout(&figure(first.clone().without_legend())).size;
        let with = layout(&figure(first.clone())).size;
        assert!(with.0 == without.0 && with.1 > without.1 + 15.0);
        let wide = layout(&figure(plot(&"a long name ".repeat(30), Colour::BLUE))).size;
        assert!(wide.0 > with.0 + 1000.0);
    }

    #[test]
    fn a_png_appears_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f.png");
        png(&figure(all_layers(&[1.0, 2.0], Axis::log("x"), Axis::log("y"))), &path).unwrap();
        assert!(std::fs::read(&path).unwrap().starts_with(b"\x89PNG"));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(
            png(&figure(all_layers(&[], Axis::log("x"), Axis::log("y"))), Path::new("/no/f.png"))
                .is_err()
        );
    }
}
