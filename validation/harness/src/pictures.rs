//! Pictures of particles, from stored particles of records.

use nalgebra::Vector2;
use touchstone_base::{
    record::{Profile, Record},
    spec::RunSpec,
};
use touchstone_report::{Axis, Colour, ColourMap, Dots, Figure, Plot, Series};

use crate::{
    runs::{Planned, Runs},
    section::Section,
    study::Study,
};

/// Particles of some runs, coloured by a stored value.
pub struct Picture {
    /// Anchor of the study and of its figure, title of the section, caption.
    pub texts: [&'static str; 3],
    /// Name of the colour bar with its unit, and its colours.
    pub colours: (&'static str, ColourMap),
    /// Width and height of a panel \[px\].
    pub size: [f64; 2],
    /// The panels.
    pub panels: Vec<PicturePanel>,
    /// Number of panels in a row.
    pub columns: usize,
    /// The shown function of the value of a particle, such as its logarithm.
    pub shown: fn(f64) -> f64,
    /// Ends of the colour range for all panels; `None`: each panel has the range of its values.
    pub range: Option<[f64; 2]>,
}

/// One panel of a picture.
pub struct PicturePanel {
    /// Title of the panel.
    pub title: String,
    /// A run that keeps particles.
    pub spec: RunSpec,
    /// The profile of its record that has them.
    pub profile: String,
    /// Their spacing, in the unit of their places.
    pub spacing: f64,
    /// Lines over the particles, in the same unit.
    pub lines: Vec<Vec<(f64, f64)>>,
}

/// The profile of the particles at the end of a run.
pub const END: &str = "particles";

/// Keeps places in a unit, and a number of each particle, as this profile.
pub fn keep(
    record: &mut Record,
    profile: &str,
    unit: &str,
    value: (&str, &str),
    particles: impl Iterator<Item = (Vector2<f64>, f64)>,
) {
    let rows: Vec<[f64; 3]> = particles.map(|(x, value)| [x.x, x.y, value]).collect();
    let kept = Profile::of_rows(&[("x", unit), ("y", unit), value], &rows);
    record.profiles.insert(profile.into(), kept);
}

impl Study for Picture {
    fn runs(&self) -> Vec<Planned> {
        self.panels.iter().map(|panel| Planned::new(panel.spec.clone())).collect()
    }

    /// The runs that kept their particles.
    fn evaluate(&self, _: &str, runs: &Runs) -> Option<Section> {
        let panel = |PicturePanel { title, spec, profile, spacing, lines }: &PicturePanel| {
            let record = runs.record(spec)?;
            let [x, y, value] = &record.profiles.get(profile)?.columns[..] else { return None };
            let points = x.values.iter().zip(&y.values).zip(&value.values);
            let points = points.map(|((x, y), value)| (*x, *y, (self.shown)(*value))).collect();
            let [x, y] = ["x", "y"].map(|name| Axis::linear(format!("{name} [{}]", x.unit)));
            let (label, colours) = self.colours;
            let dots = Dots::new(label, colours, *spacing, points);
            let dots =
                self.range.into_iter().fold(dots, |dots, [low, high]| dots.values(low, high));
            let plot = Plot::new(title, x, y).layer(dots);
            let line =
                |line: &Vec<_>| Series::line("", line.clone()).colour(Colour::BLACK).width(1.2);
            Some(lines.iter().map(line).fold(plot, Plot::layer))
        };
        let [id, title, caption] = self.texts;
        let [width, height] = self.size;
        let figure = Figure::new(id, caption).panel_size(width, height).columns(self.columns);
        let panels = self.panels.iter().filter_map(panel);
        Some(Section::new(id, title).block(panels.fold(figure, Figure::panel)))
    }
}
