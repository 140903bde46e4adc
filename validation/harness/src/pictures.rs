//! Pictures of particles, from stored particles of records.

use nalgebra::Vector2;
use touchstone_base::{
    record::{Profile, Record, marked},
    spec::RunSpec,
};
use touchstone_report::{Axis, Colour, ColourMap, Dot, Dots, Figure, Layer, Movie, Plot, Series};

use crate::{
    runs::{Planned, Runs},
    section::Section,
    study::Study,
};

/// Particles of some runs, coloured by a stored value.
pub struct Picture {
    /// Its section.
    pub heading: Heading,
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
    /// The film of the run of the first panel.
    pub film: Option<Film>,
}

/// The section of a picture.
#[derive(Clone, Copy)]
pub struct Heading {
    /// Anchor of the section and of its figure.
    pub id: &'static str,
    /// Title of the section.
    pub title: &'static str,
    /// Caption of the figure.
    pub caption: &'static str,
}

/// A film of the particles of a run.
pub struct Film {
    /// Caption.
    pub caption: &'static str,
    /// The time in words, from a record and a share of its time.
    pub time: fn(&Record, f64) -> String,
    /// The ends of x and of y.
    pub view: [[f64; 2]; 2],
    /// Width \[px\].
    pub width: f64,
    /// Whether particles are shown with their mirror images at x = 0.
    pub is_mirrored: bool,
    /// The share of the run at the frame that is shown where nothing may move.
    pub still: f64,
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
    let (rows, (name, value_unit)): (Vec<_>, _) = (particles.collect(), value);
    let kept = Profile::default()
        .put(&rows, "x", unit, |(x, _)| x.x)
        .put(&rows, "y", unit, |(x, _)| x.y)
        .put(&rows, name, value_unit, |(_, value)| *value);
    record.profiles.insert(profile.into(), kept);
}

/// Frames of a film in a record, evenly over the time of the run.
pub const FRAMES: usize = 50;

/// The name of the profile of the particles at a share of the time of a run.
pub fn at_share(share: f64) -> String {
    marked(END, share)
}

/// Diameter of a particle of a film \[spacings\]: particles of a square lattice leave no gaps, which
/// take half of the bytes of a frame.
const COVERS: f64 = 1.42;

/// Keeps a frame of a film: places to 1/1000 of their unit, values to 1/10000.
pub fn keep_frame(
    record: &mut Record,
    share: f64,
    unit: &str,
    value: (&str, &str),
    particles: impl Iterator<Item = (Vector2<f64>, f64)>,
) {
    let rounded = |number: f64, parts: f64| (number * parts).round() / parts;
    let coarse = particles.map(|(x, v)| (x.map(|x| rounded(x, 1e3)), rounded(v, 1e4)));
    keep(record, &at_share(share), unit, value, coarse);
}

impl Picture {
    /// The particles of a profile, under the title of a panel.
    fn plot(&self, record: &Record, panel: &PicturePanel, profile: &str) -> Option<Plot> {
        let [x, y, value] = &record.profiles.get(profile)?.columns[..] else { return None };
        let points = x.values.iter().zip(&y.values).zip(&value.values);
        let dot = |((x, y), value): ((&f64, &f64), &f64)| Dot {
            x: *x,
            y: *y,
            value: (self.shown)(*value),
        };
        let points = points.map(dot).collect();
        let [x, y] = ["x", "y"].map(|name| Axis::linear(format!("{name} [{}]", x.unit)));
        let (label, colours) = self.colours;
        let dots = Dots::new(label, colours, panel.spacing, points);
        let dots = self.range.into_iter().fold(dots, |dots, [low, high]| dots.values(low, high));
        Some(Plot::new(&panel.title, x, y).layer(dots))
    }

    /// The film of the run of the first panel; none if its record has too few frames.
    pub fn film(&self, runs: &Runs) -> Option<Movie> {
        let (film, first) = (self.film.as_ref()?, self.panels.first()?);
        let record = runs.record(&first.spec)?;
        let [x, y] = film.view;
        let frame = |share: f64| {
            let name = at_share(share);
            let mut plot = self.plot(record, first, &name)?;
            plot.title = (film.time)(record, share);
            (plot.x, plot.y) = (plot.x.range(x[0], x[1]), plot.y.range(y[0], y[1]));
            for layer in &mut plot.layers {
                let Layer::Dots(dots) = layer else { continue };
                dots.diameter *= COVERS;
                if !film.is_mirrored {
                    continue;
                }
                let images: Vec<_> =
                    dots.points.iter().map(|dot| Dot { x: -dot.x, ..*dot }).collect();
                dots.points.extend(images);
            }
            let panel = self.panels.iter().find(|panel| panel.profile == name);
            let lines = panel.map_or(&[][..], |panel| &panel.lines);
            Some((share, outlined(plot, lines, Colour::BLACK)))
        };
        let shares = (0..=FRAMES).map(|k| k as f64 / FRAMES as f64);
        let (shares, frames): (Vec<f64>, Vec<Plot>) = shares.filter_map(frame).unzip();
        let still = shares.iter().position(|share| *share >= film.still)?;
        let (id, caption) = (format!("{}-film", self.heading.id), film.caption.into());
        let size = (film.width, film.width * (y[1] - y[0]) / (x[1] - x[0]));
        (frames.len() > FRAMES / 2).then_some(Movie { id, caption, frames, still, size })
    }
}

/// Adds lines of a reference to a plot.
fn outlined(plot: Plot, lines: &[Vec<(f64, f64)>], colour: Colour) -> Plot {
    let line = |line: &Vec<_>| Series::line("", line.clone()).colour(colour).width(1.3);
    lines.iter().map(line).fold(plot, Plot::layer)
}

impl Study for Picture {
    fn runs(&self) -> Vec<Planned> {
        self.panels.iter().map(|panel| Planned::new(panel.spec.clone())).collect()
    }

    /// The runs that kept their particles.
    fn evaluate(&self, _: &str, runs: &Runs) -> Option<Section> {
        let view = self.film.as_ref().filter(|film| !film.is_mirrored).map(|film| film.view);
        let panel = |panel: &PicturePanel| {
            let mut plot = self.plot(runs.record(&panel.spec)?, panel, &panel.profile)?;
            if let Some([x, y]) = view {
                (plot.x, plot.y) = (plot.x.range(x[0], x[1]), plot.y.range(y[0], y[1]));
            }
            // Green is neither the colour of a particle nor of a light or dark page.
            Some(outlined(plot, &panel.lines, Colour::GREEN))
        };
        let Heading { id, title, caption } = self.heading;
        let [width, height] = self.size;
        let figure = Figure::new(id, caption).panel_size(width, height).columns(self.columns);
        let panels = self.panels.iter().filter_map(panel);
        Some(Section::new(id, title).block(panels.fold(figure, Figure::panel)))
    }
}
