//! Pictures of the rings.

use report::{Axis, Colour, ColourMap, Dots, Figure, Film, Plot, Series, exact};

use super::*;

/// Rings that stay whole, beside those of finite elements and in a film, and rings that are torn.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let table = table(tier);
    let shown = |group| {
        let mut kept = table.of(group).filter(|row| row.run.spec.keep.particles);
        kept.find_map(|row| runs.completed(&row.run.spec))
    };
    let mut study = Study::new("rubber-rings-pictures", "Pictures");
    if let Some(record) = shown(Group::Paper) {
        study = study.block(beside_elements(record));
        study = match film(record) {
            Ok(film) => study.block(film),
            Err(why) => study.prose(format!("There is no film: {why}.")),
        };
    }
    if let Some(record) = shown(Group::Unstressed) {
        let caption = "Two rubber rings after a collision at 0.12 c0 each without artificial stress, spacing \
                       0.2 L. Colour is the largest principal stress σ₁ over the bulk modulus K. Rubber of \
                       this law does not break; the method does.";
        let figure = Figure::new("rubber-rings-fracture", caption).panel_size(420.0, 320.0);
        let end = picture(record, &[1.0], None);
        study = study.block(end.fold(figure, |figure, (_, plot)| figure.panel(plot)));
    }
    vec![study]
}

/// The right ring at five times, coloured by the largest principal stress, with that of finite elements.
fn beside_elements(record: &Record) -> Figure {
    let caption = "The right one of two rubber rings that collide at 0.059 c0 each and meet at x = 0. \
                   Particles of variant `seed`, spacing 0.2 L, are coloured by the largest principal \
                   stress σ₁ over the bulk modulus K; tension is positive. Black lines are the faces of \
                   the ring in finite elements.";
    let axes = (Axis::linear("x [L]").range(-0.4, 11.9), Axis::linear("y [L]").range(-5.6, 5.6));
    let figure = Figure::new("rubber-rings-pictures", caption).columns(5);
    let panels = picture(record, &PICTURES, Some(axes)).map(|(share, plot)| {
        let outlines = reference::outlines(SPEED, 200.0 * share);
        let black = |line| Series::line("", line).colour(Colour::BLACK).width(0.9);
        outlines.into_iter().map(black).fold(plot, Plot::layer)
    });
    panels.fold(figure.panel_size(185.0, 170.0), Figure::panel)
}

/// Both rings of the same run through time.
fn film(record: &Record) -> std::io::Result<Film> {
    let shares: Vec<f64> = (1..=FRAMES).map(|k| k as f64 / FRAMES as f64).collect();
    let frame = |(_, plot)| Figure::new("frame", "").panel(plot).panel_size(350.0, 175.0);
    let frames: Vec<Figure> = picture(record, &shares, None).map(frame).collect();
    let caption = "Film of the same rings, both of which are shown, coloured in the same way.";
    Film::new("rubber-rings-film", caption, &frames, 200)
}

/// Pictures at some shares of a run, with one range of colours and of axes. These hold all particles unless
/// others are given, which show the right ring alone.
fn picture<'a>(
    record: &'a Record,
    shares: &'a [f64],
    axes: Option<(Axis, Axis)>,
) -> impl Iterator<Item = (f64, Plot)> + 'a {
    let most = |name: &str| {
        let values = shares.iter().flat_map(|at| record.column(&format!("particles@{at}"), name));
        largest(values.map(|value| value.abs()))
    };
    let axis = |name: &str| {
        let reach = most(name) + 0.5;
        Axis::linear(format!("{name} [L]")).range(-reach, reach)
    };
    let shows_both = axes.is_none();
    let axes = axes.unwrap_or_else(|| (axis("x"), axis("y")));
    let (most, spacing) = (most("stress"), record.settings_as::<RingSettings>().spacing);
    shares.iter().map(move |share| {
        let mut points = pictures::points(record, &format!("particles@{share}"), "stress");
        points.retain(|(x, ..)| shows_both || *x > 0.0);
        let title = format!("t = {} L/c0", exact((2000.0 * share).round() / 10.0));
        let dots = Dots::new("σ₁ [K]", ColourMap::Diverging, spacing, points);
        let (x, y) = axes.clone();
        (*share, Plot::new(title, x, y).layer(dots.values(-most, most)))
    })
}
