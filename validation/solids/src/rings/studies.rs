//! What the runs of the rings say together, beside what their declaration says: distances from finite
//! elements, energies, pictures, claim M2, cost of a particle, symmetry, the constitutive law.

use super::{
    RUBBER_RINGS, RingSettings, declaration, extremes,
    metrics::{self, *},
    plan::{self, FIVE_LAYERS, PICTURED, SPEED, TORN, collision},
    reference::{self, Reference},
    run::PICTURES,
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Profile, Record},
    reference::Reference as Package,
    spec::RunSpec,
};
use harness::{case::Tier, columns::Columns, pictures, runs::Runs, study::Study};
use report::{
    Axis, Cell, Colour, ColourMap, Column, Figure, Film, ParticleMap, Plot, Series, Table, exact,
    percent, sig,
};

/// What runs by hand say of speeds that are not of the plan.
const BETWEEN: &str = "In runs by hand between the speeds of the plan, rings of ten layers hold at 0.06 \
                       and 0.08 c0, and at 0.09 and 0.10 c0 they tear open at the rear pole, like a C; \
                       rings of five hold at 0.08 and are torn at 0.09, though they hold at 0.12. A tear \
                       begins at the inner face, 20 to 80 L/c0 before it is through: from 0.08 c0 on some \
                       neighbours are more than two spacings apart; up to 0.06 c0 none are more than 1.5 \
                       in rings of five and ten layers, but 2.7 in rings of twenty at 0.059.";

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let mut studies = vec![
        distances(tier, runs),
        pictures(runs),
        fracture(tier, runs),
        rates(tier, runs),
        constitutive_law(),
        extremes::study(tier, runs),
    ];
    if tier == Tier::Full {
        studies.push(rotated(runs));
    }
    studies
}

fn settings(record: &Record) -> RingSettings {
    record.settings_as()
}

/// The collisions of the plan.
fn collisions(tier: Tier, runs: &Runs) -> Vec<&Record> {
    runs.records(plan::collisions(tier).into_iter().map(|planned| planned.spec))
}

/// Strength of the artificial stress and h/dx are as they are meant.
fn is_usual(record: &Record) -> bool {
    let (found, usual) = (settings(record), RingSettings::default());
    found.xi == usual.xi && found.h_over_dx == usual.h_over_dx
}

/// Usual collisions at a speed that has a reference.
fn with_reference(tier: Tier, runs: &Runs) -> impl Iterator<Item = (&Record, Reference)> {
    let usual = collisions(tier, runs).into_iter().filter(|record| is_usual(record));
    usual.filter_map(|record| Some((record, Reference::of(&record.variant, &settings(record))?)))
}

/// The finest run of the paper's form that every tier has; of equals the cheapest.
fn finest(tier: Tier) -> RunSpec {
    let variant = match tier {
        Tier::Quick => "leapfrog",
        Tier::Full => "seed",
    };
    let spacing = plan::spacings(variant, tier).iter().copied().fold(f64::INFINITY, f64::min);
    collision(variant, spacing, SPEED)
}

fn distances(tier: Tier, runs: &Runs) -> Study {
    let study = Study::new("rubber-rings-distances", "Distances from finite elements")
        .block(collisions_table(tier, runs))
        .block(phases_table(tier, runs));
    match runs.record(&finest(tier).measure_all()) {
        Some(record) => study.block(energies(record)),
        None => study,
    }
}

/// Energies of a run, and what each term has added.
fn energies(record: &Record) -> Figure {
    let caption = format!(
        "Energies of two colliding rubber rings over the initial energy, variant `{}`, spacing {} L. Left: \
         kinetic, compression and shear energy and their sum; right: what each term has added, which \
         agrees with that sum up to {}. The elastic law adds a little, because its rate has no exact \
         energy at finite strain.",
        record.variant,
        exact(settings(record).spacing),
        percent(record.value(ENERGY_GAP).unwrap_or(f64::NAN), 2)
    );
    let empty = Profile::default();
    let budget = record.profiles.get("budget").unwrap_or(&empty);
    let t = budget.column("t");
    let points = |values: &[f64]| t.iter().copied().zip(values.iter().copied()).collect::<Vec<_>>();
    let sum = |names: &[&str]| -> Vec<f64> {
        let at = |k: usize, name: &&str| budget.column(name).get(k).copied().unwrap_or(f64::NAN);
        (0..t.len()).map(|k| names.iter().map(|name| at(k, name)).sum()).collect()
    };
    let plot = |label: &str, lines: &[(&str, Vec<f64>)]| {
        let plot = Plot::new("", Axis::linear("t [L/c0]"), Axis::linear(label));
        lines.iter().enumerate().fold(plot, |plot, (k, (title, values))| {
            plot.layer(Series::line(*title, points(values)).colour(Colour::cycle(k)))
        })
    };
    let kept = [
        ("kinetic", sum(&["kinetic"])),
        ("compression", sum(&["compression"])),
        ("shear", sum(&["shear"])),
        ("sum", sum(&["kinetic", "compression", "shear"])),
    ];
    let work = |metric| sum(&[&String::from(metric)]);
    let added = [
        ("artificial viscosity", work(WORK_VISCOSITY)),
        ("artificial stress", work(WORK_STRESS)),
        ("elastic law", work(WORK_ELASTIC)),
    ];
    Figure::new("rubber-rings-energy", caption)
        .columns(2)
        .panel(plot("energy/E(0) [-]", &kept))
        .panel(plot("added/E(0) [-]", &added))
}

/// Phases of contact of every run that has a reference, beside those of finite elements.
fn phases_table(tier: Tier, runs: &Runs) -> Table {
    let columns = vec![
        Column::text("run"),
        Column::num("speed", "c0"),
        Column::num("spacing", "L"),
        Column::num("phases", "1"),
        Column::num("impulse of the first", "ρ c0 L²"),
        Column::text("1, 50, 99 % of it passed at [L/c0]"),
        Column::num("impulse of the second", "ρ c0 L²"),
        Column::text("1, 50, 99 % of it passed at [L/c0]"),
    ];
    let caption = "The two phases of contact. The poles touch first and swing back while the flanks fly \
                   on, and the rings touch once more on the way out. At 5 layers, spacing 0.2 L, kernels \
                   reach across the gap that opens in between, so that the rings never let go. A phase \
                   ends where the force stays below 1 % of its largest for 5 L/c0. Values of finite \
                   elements have their uncertainty.";
    let mut table = Table::new(caption, columns);
    let mut speeds = Vec::new();
    for (record, reference) in with_reference(tier, runs) {
        let speed = settings(record).speed;
        if !speeds.contains(&speed) {
            speeds.push(speed);
            table = table.row(reference_phases(speed, &reference));
        }
        table = table.row(found_phases(record));
    }
    table
}

fn reference_phases(speed: f64, reference: &Reference) -> Vec<Cell> {
    let mut row = vec![
        Cell::text("**finite elements**"),
        Cell::num(speed, 3),
        Cell::text(""),
        Cell::num(reference.phases.len() as f64, 1),
    ];
    for [(impulse, spread), times @ ..] in &reference.phases {
        row.push(Cell::text(format!("{} ± {}", sig(*impulse, 4), sig(*spread, 1))));
        row.push(Cell::text(times.map(|(t, _)| sig(t, 4)).join(", ")));
    }
    row
}

fn found_phases(record: &Record) -> Vec<Cell> {
    let RingSettings { speed, spacing, .. } = settings(record);
    let mut row = vec![
        Cell::text(format!("`{}`", record.variant)),
        Cell::num(speed, 3),
        Cell::num(spacing, 3),
        record.value(PHASES).map_or(Cell::text("–"), |n| Cell::num(n, 1)),
    ];
    for phase in [0, 1].map(metrics::phase) {
        let Some(impulse) = record.value(IMPULSE.at(&phase)) else {
            row.extend([Cell::text("none"), Cell::text("")]);
            continue;
        };
        let times = T_IMPULSE.map(|time| record.value(time.at(&phase)));
        let times = times.map(|time| time.map_or("–".into(), |time| sig(time, 4)));
        row.extend([Cell::num(impulse, 4), Cell::text(times.join(", "))]);
    }
    row
}

/// The rings at five times, coloured by the largest principal stress, with those of finite elements.
fn pictures(runs: &Runs) -> Study {
    let caption = "The right one of two rubber rings that collide at 0.059 c0 each and meet at x = 0. \
                   Particles of variant `seed`, spacing 0.2 L, are coloured by the largest principal \
                   stress σ₁ over the bulk modulus K; tension is positive. Black lines are the faces of \
                   the ring in finite elements.";
    let mut figure = Figure::new("rubber-rings-pictures", caption).columns(5);
    let (variant, spacing, speed) = PICTURED;
    if let Some(record) = runs.record(&collision(variant, spacing, speed)) {
        // At the start there is neither stress nor deformation.
        let shown = &PICTURES[1..];
        let most = largest_stress(record, shown);
        let axes =
            (Axis::linear("x [L]").range(-0.4, 11.9), Axis::linear("y [L]").range(-5.6, 5.6));
        for share in shown {
            let title = format!("{}, {}", time(*share), state(record, *share));
            let mut map = picture(record, *share, &title, axes.clone(), most);
            map.points.retain(|(x, ..)| *x > 0.0);
            let outlines = reference::outlines(speed, 200.0 * share).unwrap_or_default();
            let black = |map: ParticleMap, line| map.curve(Series::line("", line).width(0.9));
            figure = figure.panel(outlines.into_iter().fold(map, black));
        }
    }
    let study =
        Study::new("rubber-rings-pictures", "Pictures").block(figure.panel_size(185.0, 170.0));
    let study = match film(runs) {
        Ok(film) => study.block(film),
        Err(why) => study.prose(format!("There is no film: {why}.")),
    };
    let (variant, spacing, speed) = TORN;
    let Some(record) = runs.completed(&collision(variant, spacing, speed)) else { return study };
    let caption = format!(
        "Two rubber rings after a collision at {} c0 each without artificial stress (variant `{variant}`), \
         spacing {} L, in {} pieces. Colour is the largest principal stress σ₁ over the bulk modulus K. \
         Rubber of this law does not break; the method does.",
        exact(speed),
        exact(spacing),
        record.value(PIECES).unwrap_or(f64::NAN)
    );
    let title = format!("{}, {}", time(1.0), state(record, 1.0));
    let most = largest_stress(record, &[1.0]);
    let map = picture(record, 1.0, &title, axes(record, &[1.0]), most);
    let figure = Figure::new("rubber-rings-fracture", caption).panel(map);
    study.block(figure.panel_size(420.0, 320.0))
}

/// The collision as a film, with a picture every few L/c0.
fn film(runs: &Runs) -> Result<Film, String> {
    const LAST: usize = plan::FRAMES - 1;
    let record = runs.completed(&plan::film()).ok_or("its run did not reach its end")?;
    let shares: Vec<f64> = (0..=LAST).map(|k| k as f64 / LAST as f64).collect();
    let (axes, most) = (axes(record, &shares), largest_stress(record, &shares));
    let frame = |share: &f64| {
        let map = picture(record, *share, &time(*share), axes.clone(), most);
        Figure::new("frame", "").panel(map).panel_size(350.0, 175.0)
    };
    let frames: Vec<Figure> = shares.iter().map(frame).collect();
    let caption = "Film of two rubber rings that collide at 0.059 c0 each, variant `leapfrog`, spacing 0.2 \
                   L, coloured by the largest principal stress σ₁ over the bulk modulus K.";
    Film::new("rubber-rings-film", caption, &frames, 200)
}

fn time(share: f64) -> String {
    format!("t = {} L/c0", exact((10.0 * 200.0 * share).round() / 10.0))
}

/// Whether the rings are whole at a share of the run.
fn state(record: &Record, share: f64) -> &'static str {
    let has_torn = record.value(TORN_AT).is_some_and(|time| time <= 200.0 * share);
    match Fate::of(record) {
        Some(fate) if has_torn => fate.name(),
        _ => Fate::Whole.name(),
    }
}

/// Largest magnitude of the stress in these pictures \[K\].
fn largest_stress(record: &Record, shares: &[f64]) -> f64 {
    let pictures = shares.iter().filter_map(|s| record.profiles.get(&format!("particles@{s}")));
    let values = pictures.flat_map(|profile| profile.column("stress"));
    values.fold(0.0, |most: f64, stress| most.max(stress.abs()))
}

/// Axes that hold the particles of all of these pictures.
fn axes(record: &Record, shares: &[f64]) -> (Axis, Axis) {
    let range = |name: &str| {
        let pictures = shares.iter().filter_map(|s| record.profiles.get(&format!("particles@{s}")));
        let values = pictures.flat_map(|profile| profile.column(name));
        let reach = values.fold(0.0, |most: f64, x| most.max(x.abs())) + 0.5;
        Axis::linear(format!("{name} [L]")).range(-reach, reach)
    };
    (range("x"), range("y"))
}

/// Colours end at ±`most`.
fn picture(record: &Record, share: f64, title: &str, axes: (Axis, Axis), most: f64) -> ParticleMap {
    let points = pictures::points(record, &format!("particles@{share}"), "stress");
    ParticleMap::new(title, axes, "σ₁ [K]", ColourMap::Diverging, points)
        .diameter(settings(record).spacing)
        .values(-most, most)
}

/// Claim M2: at which speed and spacing does each variant tear or break?
fn fracture(tier: Tier, runs: &Runs) -> Study {
    let (mut whole, mut others, mut without) = (0, Vec::new(), 0);
    for record in collisions(tier, runs) {
        let fate = Fate::of(record);
        match record.variant.as_str() {
            "seed" if !is_usual(record) => {}
            "seed" if fate == Some(Fate::Whole) => whole += 1,
            "seed" => {
                let RingSettings { speed, spacing, courant, .. } = settings(record);
                let [speed, spacing, courant] = [speed, spacing, courant].map(|x| sig(x, 2));
                others.push(format!(
                    "{} at {speed} c0, spacing {spacing} L and Courant number {courant}",
                    fate.map_or("diverged", Fate::name)
                ));
            }
            "no-artificial-stress" => without += usize::from(fate != Some(Fate::Whole)),
            _ => {}
        }
    }
    let seeds = whole + others.len();
    let said = match (others.is_empty(), without > 0) {
        (true, true) => "holds in these runs",
        (false, true) => "holds in part",
        _ => "is refuted here",
    };
    let but = if others.is_empty() {
        String::new()
    } else {
        format!("; the other runs are {}", others.join("; "))
    };
    let more = match tier {
        Tier::Quick => "The full tier has more speeds and spacing 0.05.",
        Tier::Full => {
            "Rings that stay whole are not right for that reason: see the energy lost in the rows with ξ = \
             0.1, and with h/dx = 1.2, where kernels reach less far."
        }
    };
    let verdict = format!(
        "**M2 {said}** for the solid: with artificial stress, {whole} of {seeds} runs keep both rings \
         whole. The artificial stress has ξ 0.3, n 4 and principal axes{but}. Without it {without} runs \
         tear or break, at spacings and speeds in the table. {BETWEEN} With artificial stress component by \
         component the outcome depends on the axes. The distance from the mirror image is round-off where \
         the method is its own mirror image. {more}"
    );
    Study::new("rubber-rings-fracture-claim", "M2: artificial stress and fracture")
        .prose(verdict)
        .block(fates_table(tier, runs))
}

/// What becomes of the rings in every collision of the plan.
fn fates_table(tier: Tier, runs: &Runs) -> Table {
    let caption = "What becomes of the rings; unless changed the spacing is 0.1 L and the speed 0.059 c0. \
                   A particle stands for a disc of 0.75 spacings: rings are whole as long as a closed \
                   chain of discs goes around the hole of each, torn where there is none, and in pieces \
                   where discs are no longer connected. This is counted 100 times in a run. The largest \
                   stretch is the largest distance of two particles that were within 1.2 spacings at the \
                   start.";
    Columns::of_variants()
        .changed("changed", &RUBBER_RINGS)
        .text("rings are", |r| Fate::of(r).map_or("diverged", Fate::name))
        .number("first seen at", "L/c0", TORN_AT)
        .number("least holes of a ring", "1", HOLES_LEAST)
        .number("most pieces", "1", PIECES_MOST)
        .number("largest stretch", "dx", STRETCH_MOST)
        .number("at", "L/c0", T_STRETCH_MOST)
        .table(caption, collisions(tier, runs))
}

/// Every collision of the plan, with its distances from the reference where there is one.
fn collisions_table(tier: Tier, runs: &Runs) -> Table {
    let exact = |r: &Record| {
        let exact = Reference::of(&r.variant, &settings(r)).and_then(|of| of.number(RESTITUTION));
        let exact = exact.map(|(value, spread)| format!("{} ± {}", sig(value, 4), sig(spread, 1)));
        exact.unwrap_or("–".into())
    };
    let caption = "Every collision; unless changed the spacing is 0.1 L and the speed 0.059 c0. Particles \
                   within 1.5 spacings of each other count as one piece, so two rings are 2, each whole or \
                   cut through once (see the table of M2). Restitution is the speed of the centre of mass \
                   at t = 200 L/c0 over the initial one, with the uncertainty of finite elements. A ring \
                   keeps part of its energy as vibration, which no dissipation has taken; energy lost is \
                   what stabilisation took.";
    Columns::of_variants()
        .changed("changed", &RUBBER_RINGS)
        .number("most pieces", "1", PIECES_MOST)
        .number("pieces at the end", "1", PIECES)
        .metric(["restitution", "-"], RESTITUTION, |x| Cell::num(x, 4))
        .text("finite elements", exact)
        .percent("error of restitution", "-", RESTITUTION_ERROR, 1.0)
        .percent("of least width", "-", WIDTH_MIN_ERROR, 1.0)
        .percent("of largest height", "-", HEIGHT_MAX_ERROR, 1.0)
        .number(
            "end of contact less finite elements",
            "L/c0",
            CONTACT_END_ERROR.at(metrics::phase(1)),
        )
        .number("centre less finite elements", "L", X_C_WORST)
        .number("at the end", "L", X_C_END_ERROR)
        .percent("energy lost", "-", ENERGY_LOST, 1.0)
        .metric(["distance from mirror image", "dx"], MIRROR, |x| Cell::sci(x, 2))
        .ended()
        .table(caption, collisions(tier, runs))
}

/// What a particle of rubber costs.
fn rates(tier: Tier, runs: &Runs) -> Study {
    let neighbours = |r: &Record| {
        let sweeps = if r.variant == "leapfrog" { 2.0 } else { 1.0 };
        r.cost.pair_interactions as f64 / r.cost.particle_rhs as f64 / sweeps
    };
    let rhs = |r: &Record| 1e9 * r.cost.cpu_s / r.cost.particle_rhs as f64;
    let memory = |r: &Record| r.cost.solver_bytes as f64 / r.cost.particles as f64;
    let three = |value| Cell::num(value, 3);
    let caption = "Cost of one right-hand side of a particle of rubber. It has stress, artificial \
                   viscosity, density, stress rate and XSPH, and is timed with nothing else at work.";
    let table = Columns::of_variants()
        .num(["spacing", "L"], |r| three(settings(r).spacing))
        .num(["particles", "1"], |r| Cell::count(r.cost.particles as u64))
        .steps()
        .num(["neighbours", "1"], |r| three(neighbours(r)))
        .num(["right-hand side of a particle", "ns"], |r| three(rhs(r)))
        .num(["solver memory of a particle", "B"], |r| three(memory(r)))
        .table(caption, runs.records(declaration::specs_of_ladders(tier)));
    Study::new("rubber-rings-rates", "What a particle of rubber costs").block(table)
}

/// A rotated scene must give the rotated answer.
fn rotated(runs: &Runs) -> Study {
    let mut study = Study::new("rubber-rings-rotated", "The same collision rotated by 30 degrees");
    let caption = "Restitution at spacing 0.2 L, as it is and with the whole scene rotated by 30 \
                   degrees. Principal axes rotate with the scene; components do not.";
    let restitution = |variant: &str| {
        let specs = [collision(variant, FIVE_LAYERS, SPEED), plan::rotated(variant)];
        let value = |spec| runs.record(spec).and_then(|record| record.value(RESTITUTION));
        specs.each_ref().map(|spec| value(spec).unwrap_or(f64::NAN))
    };
    let found = plan::ROTATED.map(|variant| (variant, restitution(variant)));
    type Row = (&'static str, [f64; 2]);
    let table = Columns::<Row>::default()
        .code("variant", |(variant, _)| *variant)
        .num(["restitution", "-"], |(_, [a, _])| Cell::num(*a, 8))
        .num(["rotated", "-"], |(_, [_, b])| Cell::num(*b, 8))
        .num(["difference", "-"], |(_, [a, b])| Cell::sci((a - b).abs(), 2))
        .table(caption, found);
    for (variant, [a, b]) in found {
        let because = "No direction is special. Artificial stress in principal axes rotates with the \
                       scene, and the round-off of rotated positions grows while rings bend.";
        let id = format!("rubber_rings.{variant}.turned");
        let bound = Bound::Below(1e-6);
        let gate = Gate::new(id, "change of restitution", bound, Evidence::Invariant, because);
        let gate = if variant == "seed" { gate } else { gate.expected_to_fail() };
        study = study.judge(gate, (a - b).abs());
    }
    study.block(table)
}

/// What another constitutive law would change, by finite elements.
fn constitutive_law() -> Study {
    let study = Study::new("rubber-rings-constitutive-law", "What the constitutive law changes");
    let text = "The reference is finite elements with the same elastic law, equations (10) to (12), which \
                is `jaumann` in the table. The last column is the difference from `hencky`, a law with \
                logarithmic strain and a strain energy, on the same mesh with the same small-strain \
                moduli. Between any two of the first three laws the restitution differs by 0.005 at most.";
    match law_table() {
        Ok(table) => study.prose(text).block(table),
        Err(error) => study.prose(error.to_string()),
    }
}

fn law_table() -> Result<Table, base::reference::ReferenceError> {
    let package = Package::load("rubber_rings")?;
    let laws = package.table("laws")?;
    let mut columns = Columns::<usize>::default();
    for field in laws.fields() {
        let texts = laws.texts(&field.name)?;
        columns = columns.text(&field.name, move |k| texts[*k]);
    }
    let caption = "Finite elements with several elastic laws.";
    Ok(columns.table(caption, 0..laws.len()))
}
