//! Pictures of particles, from stored particles of records.

use nalgebra::Vector2;
use touchstone_base::record::{Profile, Record};
use touchstone_report::{Axis, Colour, Dots, Figure, Plot, Series};

use crate::{
    declare::{Picture, PicturePanel},
    runs::Runs,
    study::Study,
};

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

/// The runs that are there.
pub(crate) fn study(of: &Picture, runs: &Runs) -> Study {
    let panel = |PicturePanel { title, spec, profile, spacing, lines }: &PicturePanel| {
        let record = runs.record(spec)?;
        let [x, y, value] = &record.profiles.get(profile)?.columns[..] else { return None };
        let points = x.values.iter().zip(&y.values).zip(&value.values);
        let points = points.map(|((x, y), value)| (*x, *y, (of.shown)(*value))).collect();
        let [x, y] = ["x", "y"].map(|name| Axis::linear(format!("{name} [{}]", x.unit)));
        let (label, colours) = of.colours;
        let dots = Dots::new(label, colours, *spacing, points);
        let dots = of.range.into_iter().fold(dots, |dots, [low, high]| dots.values(low, high));
        let plot = Plot::new(title, x, y).layer(dots);
        let line = |line: &Vec<_>| Series::line("", line.clone()).colour(Colour::BLACK).width(1.2);
        Some(lines.iter().map(line).fold(plot, Plot::layer))
    };
    let [id, title, caption] = of.texts;
    let figure = Figure::new(id, caption).panel_size(of.size[0], of.size[1]).columns(of.columns);
    Study::new(id, title).block(of.panels.iter().filter_map(panel).fold(figure, Figure::panel))
}
