//! What the runs of the rings say together, beside what their declaration says: a table of all collisions
//! with claim M2, pictures, and what must be the same in two runs.

use super::{
    COMPONENTWISE, LAGRANGIAN, PLANE, RUBBER_RINGS, RingSettings,
    metrics::{self, *},
    plan::{FRAMES, Group, Row, table},
    reference::{self, Reference},
    run::PICTURES,
};
use crate::solid::largest;
use base::{
    gate::{Bound, Evidence, Gate},
    mutation::{Constant, Mutation},
    record::{MetricKey, Record, Status},
};
use harness::{case::Tier, columns::Columns, pictures, runs::Runs, study::Study};
use report::{
    Axis, Cell, ColourMap, Figure, Film, ParticleMap, Series, Table, exact, percent, sig,
};

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let table = table(tier);
    let rows = &table.rows;
    let contact = contact(rows, runs);
    [Some(collisions(rows, runs)), contact, Some(pictures(rows, runs)), Some(unchanged(rows, runs))]
        .into_iter()
        .flatten()
        .collect()
}

/// The rows of some groups.
fn of<'a>(rows: &'a [Row], groups: &'a [Group]) -> impl Iterator<Item = &'a Row> {
    rows.iter().filter(|row| groups.contains(&row.group))
}

/// Every collision: claim M2, and distances from the reference where there is one.
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
                   longer connected. Stretch is the largest distance of two particles that were within 1.2 \
                   spacings at the start. Restitution is the speed of the centre of mass at t = 200 L/c0 \
                   over the initial one. The distance of histories is the largest of the root-mean-square \
                   distances of centre, width and height, in outer diameters. Energy lost is what \
                   stabilisation took.";
    let end = CONTACT_END_ERROR.at(metrics::phase(1));
    let table = Columns::of_variants()
        .changed("changed", &RUBBER_RINGS)
        .text("rings are", |r| Fate::of(r).name())
        .number("first seen at", "L/c0", TORN_AT)
        .number("most pieces", "1", PIECES_MOST)
        .number("largest stretch", "dx", STRETCH_MOST)
        .metric(["restitution", "-"], RESTITUTION, |x| Cell::num(x, 4))
        .text("finite elements", exact)
        .percent("distance of histories", "-", HISTORIES, 1.0)
        .percent("error of restitution", "-", RESTITUTION_ERROR, 1.0)
        .percent("of least width", "-", WIDTH_MIN_ERROR, 1.0)
        .percent("of largest height", "-", HEIGHT_MAX_ERROR, 1.0)
        .number("end of contact less finite elements", "L/c0", end)
        .number("centre less finite elements", "L", X_C_WORST)
        .percent("energy lost", "-", ENERGY_LOST, 1.0)
        .percent("added by viscosity", "-", WORK_VISCOSITY, 1.0)
        .percent("by artificial stress", "-", WORK_STRESS, 1.0)
        .percent("by the elastic law", "-", WORK_ELASTIC, 1.0)
        .metric(["distance from mirror image", "dx"], MIRROR, |x| Cell::sci(x, 2))
        .ended();
    let all = of(rows, &[Group::Paper, Group::Speed, Group::Unstressed]);
    let records = runs.records(all.map(|row| row.run.spec.clone()));
    let title = "Collisions: fracture and distances from finite elements";
    let study = Study::new("rubber-rings-collisions", title).prose(verdict);
    let because = "The best variant is the one whose histories are nearest to finite elements, at every \
                   spacing at which variants are compared.";
    let what = "distance of histories of the best over the least of the others";
    let best =
        Gate::new("rubber_rings.best", what, Bound::Below(1.0), Evidence::Reference, because);
    study.block(table.table(caption, records)).judge(best, nearest(rows, runs))
}

/// The distance of histories of the best variant over the least of the others, at the spacing at which that
/// is largest.
fn nearest(rows: &[Row], runs: &Runs) -> f64 {
    let distance = |row: &Row| runs.completed(&row.run.spec).and_then(|r| r.value(HISTORIES));
    let (best, others): (Vec<&Row>, Vec<&Row>) =
        of(rows, &[Group::Paper]).partition(|row| row.variant == RUBBER_RINGS.best.variant);
    let ratio = |row: &&Row| {
        let own = distance(row).unwrap_or(f64::NAN);
        let same = others.iter().filter(|other| other.settings.spacing == row.settings.spacing);
        own / same.filter_map(|other| distance(other)).fold(f64::INFINITY, f64::min)
    };
    largest(best.iter().map(ratio))
}

/// Total Lagrangian rings with another contact, beside those with another modulus against modes that deform
/// no particle: whose is the error of the restitution? Of the tier that plans them.
fn contact(rows: &[Row], runs: &Runs) -> Option<Study> {
    const PLANE_SAYS: &str = "By symmetry a ring against a rigid plane is half of two rings. What another \
        law of contact changes has to be less than what finite elements leave uncertain of the restitution.";
    const MODES_SAY: &str = "An error of the folds hangs on what resists modes that deform no particle, one \
        of the contact on its stiffness: a quarter of the first changes more than four times the second.";
    let varied: Vec<&Row> = of(rows, &[Group::Contact]).collect();
    let uncertainty = {
        let exact = Reference::of(LAGRANGIAN, &varied.first()?.settings)?;
        exact.number(RESTITUTION).map_or(f64::NAN, |[value, spread]| spread / value)
    };
    let own = |spacing: f64| {
        of(rows, &[Group::Paper])
            .find(|row| row.variant == LAGRANGIAN && row.settings.spacing == spacing)
    };
    let value = |row: &Row| runs.completed(&row.run.spec).and_then(|r| r.value(RESTITUTION));
    let change = |row: &Row| {
        let pair = value(row).zip(own(row.settings.spacing).and_then(value));
        pair.map_or(f64::NAN, |(changed, own)| changed / own - 1.0)
    };
    let of_constant = |constant| {
        let has = |row: &&&Row| row.run.spec.mutation.is_some_and(|one| one.of == constant);
        varied.iter().find(has).map_or(f64::NAN, |row| change(row))
    };
    let [stiffer, softer] = [Constant::Contact, Constant::Hourglass].map(of_constant);
    let planes: Vec<&&Row> = varied.iter().filter(|row| row.variant == PLANE).collect();
    let changes = planes.iter().map(|row| percent(change(row), 2)).collect::<Vec<_>>().join(", ");
    let prose = format!(
        "Is the error of the restitution of `lagrangian` one of the contact or one of the folds? A rigid \
         plane between the rings changes the restitution by {changes} with 5, 10 and 20 layers; with 10 \
         layers a contact four times as stiff by {}, and three quarters of the modulus against modes that \
         deform no particle by {}. An error of the contact would hang on the first \
         two, one of the folds on the last.",
        percent(stiffer, 2),
        percent(softer, 2)
    );
    let spacings: Vec<f64> = planes.iter().map(|row| row.settings.spacing).collect();
    let all = spacings.iter().filter_map(|spacing| own(*spacing)).chain(varied.iter().copied());
    let shown = all.filter_map(|row| Some((row, runs.completed(&row.run.spec)?)));
    let study = Study::new("rubber-rings-contact", "Contact or folds")
        .prose(prose)
        .block(of_contact(shown.collect()));
    let judged = planes.iter().map(|row| {
        let id = format!("rubber_rings.contact.{}", (1.0 / row.settings.spacing).round());
        let what = "change of the restitution by a rigid plane";
        let bound = Bound::Within(-uncertainty, uncertainty);
        (Gate::new(id, what, bound, Evidence::Invariant, PLANE_SAYS), change(row))
    });
    let folds = Gate::new(
        "rubber_rings.contact.folds",
        "change of the restitution by the modes over that by the contact",
        Bound::Above(1.0),
        Evidence::Theory,
        MODES_SAY,
    );
    let all = judged.chain([(folds, (softer / stiffer).abs())]);
    Some(all.fold(study, |study, (gate, value)| study.judge(gate, value)))
}

/// The table of [`contact`].
fn of_contact(shown: Vec<(&Row, &Record)>) -> Table {
    let caption = "Total Lagrangian rings at 0.059 c0 each, against finite elements. Histories: the largest \
                   of the root-mean-square distances of centre, width and height over time, in outer \
                   diameters. The last columns are the largest energies at any time, of contacts and of \
                   what resists modes that deform no particle, over the energy of the start.";
    let changed = |row: &Row| match row.run.spec.mutation {
        Some(Mutation { of: Constant::Contact, factor }) => {
            format!("stiffness of the contact times {factor}")
        }
        Some(Mutation { factor, .. }) => format!("modulus against modes times {factor}"),
        None if row.variant == PLANE => "rigid plane between the rings".into(),
        None => "nothing".into(),
    };
    let value = |metric: MetricKey| {
        move |(_, record): &(&Row, &Record)| record.value(metric).unwrap_or(f64::NAN)
    };
    let share = |value: f64| Cell::percent(value, 2);
    Columns::default()
        .text("changed", move |(row, _): &(&Row, &Record)| changed(row))
        .text("layers", |(row, _)| (1.0 / row.settings.spacing).round().to_string())
        .of(["restitution", "-"], value(RESTITUTION), |x| Cell::num(x, 4))
        .of(["its error", "-"], value(RESTITUTION_ERROR), share)
        .of(["of the least width", "-"], value(WIDTH_MIN_ERROR), share)
        .of(["histories", "-"], value(HISTORIES), share)
        .of(["energy of contacts", "-"], value(CONTACT_MOST), share)
        .of(["of modes", "-"], value(MODES_MOST), share)
        .table(caption, shown)
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
        // At the start there is neither stress nor deformation.
        for (share, mut map) in picture(record, &PICTURES[1..], Some(axes)) {
            map.points.retain(|(x, ..)| *x > 0.0);
            let outlines = reference::outlines(super::plan::SPEED, 200.0 * share);
            let black = |map: ParticleMap, line| map.curve(Series::line("", line).width(0.9));
            figure = figure.panel(outlines.unwrap_or_default().into_iter().fold(map, black));
        }
    }
    let mut study =
        Study::new("rubber-rings-pictures", "Pictures").block(figure.panel_size(185.0, 170.0));
    if let Some(record) = shown(&[Group::Film]) {
        let shares: Vec<f64> = (0..FRAMES).map(|k| k as f64 / (FRAMES - 1) as f64).collect();
        let frame = |(_, map)| Figure::new("frame", "").panel(map).panel_size(350.0, 175.0);
        let frames: Vec<Figure> = picture(record, &shares, None).map(frame).collect();
        let caption = "Film of two rubber rings that collide at 0.059 c0 each, variant `leapfrog`, spacing \
                       0.2 L, coloured by the largest principal stress σ₁ over the bulk modulus K.";
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

/// What must be the same in two runs, or at any time of one.
fn unchanged(rows: &[Row], runs: &Runs) -> Study {
    let study = Study::new("rubber-rings-unchanged", "What must not change").prose(
        "Rings that nothing acts on keep their shape, and rings at half the speed of sound keep their \
         momentum or end as diverged. Other moduli make the same motion in units of L and c0. A turned scene \
         gives the turned answer; artificial stress component by component does not.",
    );
    let judged = of(rows, &[Group::Still, Group::Stiff, Group::Fast, Group::Turned]).map(|row| {
        let (record, s) = (runs.record(&row.run.spec), &row.settings);
        let done = record.filter(|record| record.status == Status::Completed);
        let partner = |s| {
            let spec = RUBBER_RINGS.spec_of(row.variant, &s);
            let is_it = |other: &&Row| {
                other.variant == row.variant && other.run.spec.settings == spec.settings
            };
            rows.iter().find(is_it).and_then(|other| runs.completed(&other.run.spec))
        };
        let (id, metric, most, because, value) = match row.group {
            Group::Still => {
                let name = if s.speed > 0.0 { "flight" } else { "rest" };
                let id = format!("extremes.rings.{name}");
                (id, "change of extents [L]", 1e-9, STILL, done.map(change_of_extents))
            }
            Group::Stiff => {
                let soft = partner(RingSettings { bulk_modulus: 1.0, ..s.clone() });
                let value = soft.zip(done).map(|(a, b)| distance(a, b));
                ("extremes.rings.stiffer".into(), "distance [L, c0]", 1e-10, STIFF, value)
            }
            Group::Fast => {
                let has_diverged = |r: &Record| matches!(r.status, Status::Diverged { .. });
                let failed = record.filter(|record| has_diverged(record)).map(|_| 0.0);
                let value = failed.or(done.and_then(|record| record.value(MOMENTUM)));
                ("extremes.rings.fast".into(), "|Σ m v|/m V, or 0 if diverged", 1e-12, FAST, value)
            }
            _ => {
                let upright = partner(RingSettings { angle: 0.0, ..s.clone() });
                let [a, b] = [upright, done].map(|record| record?.value(RESTITUTION));
                let id = format!("rubber_rings.{}.turned", row.variant);
                (id, "change of restitution", 1e-6, TURNED, a.zip(b).map(|(a, b)| (a - b).abs()))
            }
        };
        let gate = Gate::new(id, metric, Bound::Below(most), Evidence::Invariant, because);
        let depends_on_axes = (row.group, row.variant) == (Group::Turned, COMPONENTWISE);
        (if depends_on_axes { gate.expected_to_fail() } else { gate }, value)
    });
    judged.fold(study, |study, (gate, value)| study.judge(gate, value.unwrap_or(f64::NAN)))
}

const STILL: &str = "Without strain nothing may start by itself: neither at rest, where nothing rounds, nor \
    in flight 9000 L away, where every step does.";
const STIFF: &str = "Only K has a unit of stress, so motion in units of L and c0 must be the same, except \
    for round-off.";
const FAST: &str = "Half the speed of sound is far beyond what rubber and (12) are for. The run must keep \
    its momentum, or end as diverged with step, time and particle.";
const TURNED: &str = "No direction is special. Artificial stress in principal axes rotates with the scene, \
    and the round-off of rotated positions grows while rings bend.";

/// Largest change of width and height since the first sample \[L\].
fn change_of_extents(record: &Record) -> f64 {
    largest([("width", WIDTH_MIN), ("height", HEIGHT_MAX)].map(|(name, extreme)| {
        let first = record.column("series", name).first();
        first.zip(record.value(extreme)).map_or(f64::NAN, |(first, last)| (last - first).abs())
    }))
}

/// Largest difference of centre, velocity and extents at any sample; infinite if samples differ.
fn distance(a: &Record, b: &Record) -> f64 {
    largest(["t", "x_c", "v_c", "width", "height"].map(|name| {
        let [a, b] = [a, b].map(|record| record.column("series", name));
        let is_same = a.len() == b.len() && a.len() > 10;
        let gaps = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        if is_same { largest(gaps) } else { f64::INFINITY }
    }))
}
