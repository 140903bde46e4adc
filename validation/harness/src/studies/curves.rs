//! Profiles or histories, plotted together with their reference.

use touchstone_base::{
    record::{ColumnKey, Record},
    spec::RunSpec,
};
use touchstone_maths::metrics::history::differences;
use touchstone_report::{Axis, Colour, Dash, Figure, Look, Plot, Series, Shape};

use crate::{
    looks,
    runs::{Planned, Runs},
    section::Section,
    study::Study,
};

/// Curves over their reference.
pub struct Curves {
    /// Anchor of the study and of its figure.
    pub id: String,
    /// Title of the section.
    pub title: String,
    /// Caption of the figure.
    pub caption: String,
    /// The panels, row by row.
    pub panels: Vec<CurvePanel>,
}

impl Curves {
    /// Curves with their anchor and title.
    pub fn new(
        id: impl Into<String>,
        title: &str,
        caption: impl Into<String>,
        panels: Vec<CurvePanel>,
    ) -> Self {
        Self { id: id.into(), title: title.into(), caption: caption.into(), panels }
    }
}

/// One panel of curves.
pub struct CurvePanel {
    /// Title of the panel.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves of runs.
    pub lines: Vec<CurveOf>,
    /// Curves of references: name and points. The first name is black, the second grey, a further one dotted;
    /// a curve without name is a guide.
    pub references: Vec<(String, Vec<(f64, f64)>)>,
    /// Are curves of runs drawn as symbols?
    pub symbols: bool,
}

/// A curve of a run.
pub struct CurveOf {
    /// Name in the legend.
    pub name: String,
    /// The run.
    pub spec: RunSpec,
    /// Points of a record.
    pub points: PointsOf,
    /// Whether it is drawn thin and pale, behind others.
    pub is_pale: bool,
    /// Whether the colour follows from the place of the name among all names, not from the variant.
    pub is_cycled: bool,
}

/// Points of a curve from a record.
pub type PointsOf = Box<dyn Fn(&Record) -> Vec<(f64, f64)> + Send + Sync>;

impl CurveOf {
    /// A curve of a run.
    pub fn new(
        name: impl Into<String>,
        spec: RunSpec,
        points: impl Fn(&Record) -> Vec<(f64, f64)> + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), spec, points: Box::new(points), is_pale: false, is_cycled: false }
    }

    /// The curve drawn thin and pale.
    #[must_use]
    pub fn pale(self) -> Self {
        Self { is_pale: true, ..self }
    }

    /// The curve in the colour of the place of its name among all names.
    #[must_use]
    pub fn cycled(self) -> Self {
        Self { is_cycled: true, ..self }
    }

    /// Curves of one subject have one colour.
    fn subject(&self) -> &str {
        if self.is_cycled { &self.name } else { &self.spec.variant }
    }

    /// Two columns of a run.
    pub fn columns(name: impl Into<String>, spec: RunSpec, columns: [ColumnKey; 2]) -> Self {
        Self::new(name, spec, move |record: &Record| record.curve(columns))
    }

    /// The differences of this curve from a reference, which is sampled at the drawn places x, times
    /// `factor`; no points if the curve does not reach all of them.
    #[must_use]
    pub fn minus(self, reference: Vec<(f64, f64)>, factor: f64) -> Self {
        let points = move |record: &Record| {
            let found = differences(&(self.points)(record), &reference).unwrap_or_default();
            reference.iter().zip(found).map(|((x, _), y)| (*x, factor * y)).collect()
        };
        Self { points: Box::new(points), ..self }
    }
}

impl CurvePanel {
    /// Lines over one reference, on linear axes.
    pub fn linear(
        title: &str,
        [x, y]: [&str; 2],
        lines: Vec<CurveOf>,
        (name, points): (&str, Vec<(f64, f64)>),
    ) -> Self {
        let (title, references) = (title.into(), vec![(name.into(), points)]);
        let (x, y) = (Axis::linear(x), Axis::linear(y));
        Self { title, x, y, lines, references, symbols: false }
    }

    /// Differences from a reference on linear axes, with a guide at 0.
    pub fn of_differences(title: &str, axes: [&str; 2], lines: Vec<CurveOf>, x: [f64; 2]) -> Self {
        Self::linear(title, axes, lines, ("", x.map(|x| (x, 0.0)).into()))
    }
}

impl Study for Curves {
    fn runs(&self) -> Vec<Planned> {
        let lines = self.panels.iter().flat_map(|panel| &panel.lines);
        lines.map(|line| Planned::new(line.spec.clone())).collect()
    }

    fn evaluate(&self, _: &str, runs: &Runs) -> Option<Section> {
        let columns = (self.panels.len() as f64).sqrt().ceil() as usize;
        let figure = Figure::new(&self.id, &self.caption).columns(columns.max(1));
        let mut named: Vec<&CurveOf> = Vec::new();
        let lines = self.panels.iter().flat_map(|panel| &panel.lines);
        for line in lines.filter(|line| !line.is_pale) {
            if !named.iter().any(|of| of.name == line.name) {
                named.push(line);
            }
        }
        let panels = self.panels.iter().map(|of| panel(of, &named, runs));
        let figure = panels.fold(figure, Figure::panel);
        Some(Section::new(&self.id, &self.title).block(figure.panel_size(300.0, 230.0)))
    }
}

/// The look of a reference among the references of a panel.
fn reference(name: &str, all: &[(String, Vec<(f64, f64)>)], points: Vec<(f64, f64)>) -> Series {
    let line = Series::line(name, points);
    let mut names: Vec<&str> = all.iter().map(|of| &*of.0).filter(|of| !of.is_empty()).collect();
    names.dedup();
    match names.iter().position(|of| *of == name) {
        None => line.colour(Colour::GREY).width(0.8),
        Some(0) => line.colour(Colour::BLACK),
        Some(1) => line.colour(Colour::GREY),
        Some(_) => line.colour(Colour::BLACK).dash(Dash::Dotted),
    }
}

/// The look of a curve of a run, by its place among the named curves of all panels: the last of several
/// curves of one subject is a solid line.
fn look(line: &CurveOf, named: &[&CurveOf], symbols: bool) -> Look {
    let subject = line.subject();
    let k = named.iter().position(|of| of.name == line.name).unwrap_or_default();
    let after = named[k..].iter().skip(1).filter(|of| of.subject() == subject).count();
    let look = looks::look_of(subject, k);
    match symbols {
        true => Look { line: None, marker: Some(Shape::cycle(k)), open: true, ..look },
        false => {
            let line = Some([Dash::Solid, Dash::Dashed, Dash::Dotted][after.min(2)]);
            Look { line, marker: None, ..look }
        }
    }
}

/// Opacity of pale curves.
const PALE: f64 = 0.35;

/// A name has one look in all panels, by its position among the `named` curves.
fn panel(of: &CurvePanel, named: &[&CurveOf], runs: &Runs) -> Plot {
    let plot = Plot::new(&of.title, of.x.clone(), of.y.clone());
    let references = of.references.iter();
    let references =
        references.map(|(name, points)| reference(name, &of.references, points.clone()));
    let lines = of.lines.iter().filter_map(|line| {
        let points = (line.points)(runs.record(&line.spec)?);
        let look = look(line, named, of.symbols);
        let look = match line.is_pale {
            true => {
                Look { colour: look.colour.tint(PALE), line: Some(Dash::Solid), width: 0.8, ..look }
            }
            false => look,
        };
        Some(Series { look, ..Series::line(&line.name, points) })
    });
    references.chain(lines).fold(plot, Plot::layer)
}

#[cfg(test)]
mod tests {
    use touchstone_report::{Axis, Block, Layer};

    use super::*;
    use crate::studies::tests::{ERROR, evaluate, runs, spec};

    fn line(name: &str, variant: &str, n: usize) -> CurveOf {
        let points = |record: &touchstone_base::record::Record| {
            vec![(1.0, record.value(ERROR).unwrap_or(f64::NAN))]
        };
        CurveOf::new(name, spec(variant, n), points).cycled()
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
        let section = evaluate(&curves, runs([(spec("seed", 1), 1.5), (spec("best", 1), 2.5)]));
        let [Block::Figure(figure)] = section.blocks.as_slice() else { panic!("one figure") };
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
            panel_of(vec![line("b", "best", 1)], &[], false),
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

    /// Curves of one name, none here, have one look; a reference is black, and a guide is grey.
    #[test]
    fn symbols_stand_on_lines() {
        let both = vec![line("", "seed", 1), line("", "best", 1)];
        let panels = drawn(vec![panel_of(both, &["", "exact"], true)]);
        let shown = panels[0].iter().map(|(_, _, colour, is_marks)| (*colour, *is_marks));
        let expected = [
            (Colour::GREY, false),
            (Colour::BLACK, false),
            (Colour::cycle(0), true),
            (Colour::cycle(0), true),
        ];
        assert!(shown.eq(expected));
    }
}
