//! What the runs of the rings say together, beside what their declaration says: a table of all collisions
//! with claim M2, and pictures.

use report::{Axis, Cell, ColourMap, Figure, Film, ParticleMap, Series, exact, sig};

use super::*;

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let rows = &table(tier).rows;
    vec![collisions(rows, runs), pictures(rows, runs)]
}

/// The rows of some groups.
fn of<'a>(rows: &'a [Row], groups: &'a [Group]) -> impl Iterator<Item = &'a Row> {
    rows.iter().filter(|row| groups.contains(&row.group))
}

/// Every collision: claim M2, restitution and energy. Gates have the distances from the reference.
fn collisions(rows: &[Row], runs: &Runs) -> Study {
    let whole = |groups: &[Group]| {
        let seeds = of(rows, groups).filter(|row| row.variant == "seed");
        let fates: Vec<Fate> =
            seeds.filter_map(|row| runs.record(&row.run.spec)).map(Fate::of).collect();
        let whole = fates.iter().filter(|fate| **fate == Fate::Whole).count();
        format!("{whole} of {} runs", fates.len())
    };
    let verdict = format!(
        "**M2** (artificial stress prevents fracture): with it, variant `seed` keeps both rings whole in {}; \
         without it (ξ = 0) in {}.",
        whole(&[Group::Paper, Group::Speed]),
        whole(&[Group::Unstressed])
    );
    let exact = |r: &Record| {
        let exact =
            Reference::of(&r.variant, &r.settings_as()).and_then(|of| of.number(RESTITUTION));
        let exact = exact.map(|[value, spread]| format!("{} ± {}", sig(value, 4), sig(spread, 1)));
        exact.unwrap_or("–".into())
    };
    let caption = "Every collision; unless changed the spacing is 0.1 L and the speed 0.059 c0. A particle \
                   stands for a disc of 0.75 spacings: rings are whole as long as a closed chain of discs \
                   goes around the hole of each, torn where there is none, and in pieces where discs are no \
                   longer connected. Restitution is the speed of the centre of mass at t = 200 L/c0 over the \
                   initial one. Energy lost is what stabilisation took.";
    let table = Columns::of_variants()
        .changed("changed", &RUBBER_RINGS)
        .text("rings are", |r| Fate::of(r).name())
        .number("first seen at", "L/c0", TORN_AT)
        .metric(["restitution", "-"], RESTITUTION, |x| Cell::num(x, 4))
        .text("finite elements", exact)
        .percent("energy lost", "-", ENERGY_LOST, 1.0)
        .ended();
    let all = of(rows, &[Group::Paper, Group::Speed, Group::Unstressed]);
    let records = runs.records(all.map(|row| row.run.spec.clone()));
    let study = Study::new("rubber-rings-collisions", "Collisions: fracture").prose(verdict);
    study.block(table.table(caption, records))
}

/// The rings at five times, coloured by the largest principal stress, with those of finite elements; a film;
/// rings that are torn.
fn pictures(rows: &[Row], runs: &Runs) -> Study {
    let kept = |group| of(rows, group).filter(|row| row.run.spec.keep.particles);
    let shown = |group| kept(group).find_map(|row| runs.completed(&row.run.spec));
    let caption = "The right one of two rubber rings that collide at 0.059 c0 each and meet at x = 0. \
                   Particles of variant `seed`, spacing 0.2 L, are coloured by the largest principal \
                   stress σ₁ over the bulk modulus K; tension is positive. Black lines are the faces of \
                   the ring in finite elements.";
    let mut figure = Figure::new("rubber-rings-pictures", caption).columns(5);
    if let Some(record) = shown(&[Group::Paper]) {
        let axes =
            (Axis::linear("x [L]").range(-0.4, 11.9), Axis::linear("y [L]").range(-5.6, 5.6));
        for (share, mut map) in picture(record, &PICTURES, Some(axes)) {
            map.points.retain(|(x, ..)| *x > 0.0);
            let outlines = reference::outlines(SPEED, 200.0 * share);
            let black = |map: ParticleMap, line| map.curve(Series::line("", line).width(0.9));
            figure = figure.panel(outlines.unwrap_or_default().into_iter().fold(map, black));
        }
    }
    let mut study =
        Study::new("rubber-rings-pictures", "Pictures").block(figure.panel_size(185.0, 170.0));
    if let Some(record) = shown(&[Group::Paper]) {
        let shares: Vec<f64> = (1..=FRAMES).map(|k| k as f64 / FRAMES as f64).collect();
        let frame = |(_, map)| Figure::new("frame", "").panel(map).panel_size(350.0, 175.0);
        let frames: Vec<Figure> = picture(record, &shares, None).map(frame).collect();
        let caption = "Film of the same rings, both of which are shown, coloured in the same way.";
        study = match Film::new("rubber-rings-film", caption, &frames, 200) {
            Ok(film) => study.block(film),
            Err(why) => study.prose(format!("There is no film: {why}.")),
        };
    }
    let Some(record) = shown(&[Group::Unstressed]) else { return study };
    let caption = "Two rubber rings after a collision at 0.12 c0 each without artificial stress, spacing 0.2 \
                   L. Colour is the largest principal stress σ₁ over the bulk modulus K. Rubber of this law \
                   does not break; the method does.";
    let figure = Figure::new("rubber-rings-fracture", caption).panel_size(420.0, 320.0);
    study.block(picture(record, &[1.0], None).fold(figure, |figure, (_, map)| figure.panel(map)))
}

/// Pictures at some shares of a run, with one range of colours and of axes, which hold all particles unless
/// others are given.
fn picture<'a>(
    record: &'a Record,
    shares: &'a [f64],
    axes: Option<(Axis, Axis)>,
) -> impl Iterator<Item = (f64, ParticleMap)> + 'a {
    let most = |name: &str| {
        let values = shares.iter().flat_map(|at| record.column(&format!("particles@{at}"), name));
        largest(values.map(|value| value.abs()))
    };
    let axis = |name: &str| {
        let reach = most(name) + 0.5;
        Axis::linear(format!("{name} [L]")).range(-reach, reach)
    };
    let axes = axes.unwrap_or_else(|| (axis("x"), axis("y")));
    let (most, spacing) = (most("stress"), record.settings_as::<RingSettings>().spacing);
    shares.iter().map(move |share| {
        let points = pictures::points(record, &format!("particles@{share}"), "stress");
        let title = format!("t = {} L/c0", exact((2000.0 * share).round() / 10.0));
        let map = ParticleMap::new(title, axes.clone(), "σ₁ [K]", ColourMap::Diverging, points);
        (*share, map.diameter(spacing).values(-most, most))
    })
}
