//! What the runs say together: fronts, heights, levels and pressures over the experiments, pictures,
//! energies, and error against run time.

use std::f64::consts::FRAC_1_SQRT_2;

use super::{
    DAM_BREAK, DamSettings, ablation, front,
    measure::{PROBES, SENSORS},
    metrics::{self, FRONT, HEIGHT, LEVELS},
    reference::{self, Curve, FRONT_SPREAD, Lobovsky, PEERS, scaled},
    run::{self, PICTURES},
    specs::{self, FILM_ROWS, FRAMES},
    stability,
    volume_of_fluid::{self, VolumeOfFluid, until},
};
use crate::water::{curve, ledger};
use base::{
    record::{MetricName, Record},
    reference::ReferenceError,
    spec::RunSpec,
};
use harness::{case::Tier, columns::Columns, pictures, runs::Runs, study::Study};
use report::{
    Axis, Cell, Colour, ColourMap, Dash, Figure, Film, Layer, Legend, ParticleMap, Plot, Series,
    Shape, Table, percent, sig,
};

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let mut studies = Vec::new();
    for study in [free(tier, runs), tank(tier, runs), volume_of_fluid::study(tier, runs)] {
        // Packages are embedded and checked by a test.
        studies.push(study.unwrap_or_else(|error| {
            Study::new("dam-break-reference", "Reference").prose(error.to_string())
        }));
    }
    studies.push(energies(tier, runs));
    studies.push(match tier {
        Tier::Quick => ablation::elsewhere(),
        Tier::Full => ablation::study(runs),
    });
    studies.push(stability::extreme_settings(tier, runs));
    if tier == Tier::Full {
        studies.push(front::orders(tier, runs));
        studies.push(stability::sound(runs));
    }
    studies
}

fn settings(record: &Record) -> DamSettings {
    record.settings_as()
}

/// Spacings along the shorter side.
fn n(record: &Record) -> usize {
    settings(record).n
}

/// Columns of a table of runs: the variant, and its resolution.
fn columns<'a>(side: &str) -> Columns<'a, Record> {
    let n = |record: &Record| n(record) as f64;
    Columns::of_variants().of([side, "1"], n, |n| Cell::num(n, 3))
}

/// Is it a run of the column of Martin & Moyce?
fn is_free(record: &Record) -> bool {
    let s = settings(record);
    s.height > s.width
}

fn name_of(record: &Record, side: &str) -> String {
    format!("{}, {side}/dx = {}", record.variant, n(record))
}

/// A plot with a line a run: its variant has a colour, its finest resolution is solid. A run without points
/// has none.
fn with_runs(
    plot: Plot,
    records: &[&Record],
    side: &str,
    points: impl Fn(&Record) -> Curve,
) -> Plot {
    records.iter().fold(plot, |plot, record| {
        let points = points(record);
        if points.is_empty() {
            return plot;
        }
        let colour = specs::JUDGED.iter().position(|variant| *variant == record.variant);
        let is_finer = |r: &&&Record| r.variant == record.variant && n(r) > n(record);
        let dash = match records.iter().filter(is_finer).count() {
            0 => Dash::Solid,
            1 => Dash::Dashed,
            _ => Dash::Dotted,
        };
        let series = Series::line(name_of(record, side), points).dash(dash);
        plot.layer(series.colour(Colour::cycle(colour.unwrap_or_default())))
    })
}

/// Martin & Moyce.
fn free(tier: Tier, runs: &Runs) -> Result<Study, ReferenceError> {
    let records = runs.records(specs::all_free(tier));
    let shown = [DAM_BREAK.best.variant, "seed"];
    let is_shown = |record: &&Record| n(record) >= 20 && shown.contains(&&*record.variant);
    let shown: Vec<&Record> = records.iter().copied().filter(is_shown).collect();
    let [front, height] = reference::martin_moyce()?;
    let [model_front, model_height] = VolumeOfFluid::load()?.free;
    // Its clock is in √(H/g), and H is 2a.
    let model_height = scaled(&model_height, FRAC_1_SQRT_2, 1.0, 0.0);
    let band = |curve: &Curve, by: f64| curve.iter().map(|(t, y)| (*t, y - by, y + by)).collect();
    let legend = [Legend::TopLeft, Legend::Hidden];
    let labels = [
        ["time T = t √(2g/a) [-]", "front Z [a]"],
        ["time τ = t √(g/a) [-]", "residual height [2a]"],
    ];
    let spreads = [FRONT_SPREAD, 0.5 / 18.0];
    let caption = "Front from the back wall (left) and height near it, at 0.2 a (right), of a water column \
                   of width a = 57.15 mm and height 2a. Circles are the experiment of Martin & Moyce 1952 \
                   with its spread (grey), the black line is volume of fluid, which solves the same model, \
                   and diamonds are three other SPH codes. Coloured: the best variant, `modern`, and the \
                   paper's, `seed`. No clock is shifted.";
    let mut figure = Figure::new("dam-break-martin-moyce", caption).columns(2);
    for (k, (measured, model)) in [(front, model_front), (height, model_height)].iter().enumerate()
    {
        let end = if k == 0 { 3.6 } else { 2.6 };
        let x = Axis::linear(labels[k][0]).range(0.0, end);
        let mut plot = Plot::new("", x, Axis::linear(labels[k][1])).legend(legend[k]);
        let [until, model] = [measured, model].map(|curve| until(curve, end));
        plot = plot.layer(Layer::band("", band(&until, spreads[k]), Colour::GREY));
        plot = plot.layer(Series::line("volume of fluid", model).colour(Colour::BLACK));
        plot = with_runs(plot, &shown, "a", |record| {
            let DamSettings { width: a, gravity: g, .. } = settings(record);
            match k {
                0 => front::front(record),
                _ => curve(record, "series", ["t", "height"], [(a / g).sqrt(), 2.0 * a]),
            }
        });
        if k == 0 {
            let peers = PEERS.map(|(t, low, high)| (t, 0.5 * (low + high)));
            let peers = Series::markers("three other codes", peers.to_vec());
            plot = plot.layer(peers.shape(Shape::Diamond).colour(Colour::BROWN));
        }
        let experiment = Series::markers("experiment", until).colour(Colour::BLACK);
        figure = figure.panel(plot.layer(experiment));
    }
    let study = Study::new("dam-break-martin-moyce", "Martin & Moyce 1952: front and height")
        .block(figure.panel_size(430.0, 320.0))
        .block(free_table(&records));
    let modern = records.iter().rev().find(|r| r.variant == "modern");
    Ok(match modern {
        Some(record) => {
            study.block(pictures(record, "dam-break-martin-moyce-pictures", (2.6, 1.1)))
        }
        None => study,
    })
}

fn free_table(records: &[&Record]) -> Table {
    let caption = "Distance from Martin & Moyce, as released and after the shift of the computed clock that \
                   makes it least. A late diaphragm explains positive shifts that agree (1 τ is √2 T), and \
                   no others. The experiment has Z = 2.36 and 3.70 at T = 2 and 3, three other codes 2.62 \
                   to 2.66 and 3.97 to 4.00.";
    columns("a/dx")
        .number("Z at T = 2", "a", metrics::Z.at(2))
        .number("Z at T = 3", "a", metrics::Z.at(3))
        .number("rms of front", "a", FRONT.rms)
        .number("after shift", "a", FRONT.rms_shifted)
        .number("front shift", "T", FRONT.shift)
        .number("rms of height", "2a", HEIGHT.rms)
        .number("after shift", "2a", HEIGHT.rms_shifted)
        .number("height shift", "τ", HEIGHT.shift)
        .steps()
        .table(caption, records.iter().copied())
}

/// Lobovsky et al.
fn tank(tier: Tier, runs: &Runs) -> Result<Study, ReferenceError> {
    let (records, lobovsky) = (runs.records(specs::all_in_tank(tier)), Lobovsky::load()?);
    let mut study =
        Study::new("dam-break-lobovsky", "Lobovsky et al. 2014: front, levels, pressures")
            .block(levels(&records, &lobovsky));
    let finest = records.iter().rev().find(|r| r.variant == "modern");
    if let Some(record) = finest {
        study = study.block(pressures(record, &lobovsky));
    }
    study = study
        .block(impulses(&records, &lobovsky))
        .block(tank_table(&records))
        .block(impact_table(&records));
    if let Some(away) = away(&records) {
        study = study.prose(away);
    }
    if let Some(record) = finest {
        study = study.block(pictures(record, "dam-break-lobovsky-pictures", (1.61 / 0.3, 2.0)));
    }
    Ok(match film(tier, runs) {
        Ok(film) => study.block(film),
        Err(error) => study.prose(error),
    })
}

fn levels(records: &[&Record], lobovsky: &Lobovsky) -> Figure {
    let caption = "Front of the water, and depth at four stations, of a column 600 mm long and 300 mm high \
                   in a tank of 1610 mm. Black is the experiment of Lobovsky et al., with the band between \
                   its two series at H2 to H4. No clock is shifted.";
    let mut figure = Figure::new("dam-break-levels", caption).columns(3);
    let end = 6.0;
    let axis = |label: String| (Axis::linear("time [√(H/g)]"), Axis::linear(label));
    let (x, y) = axis("front from the gate [H]".into());
    let plot = Plot::new("front", x.range(0.0, 2.8), y).legend(Legend::Auto);
    let plot = with_runs(plot, records, "H", |record| {
        let s = settings(record);
        let points = curve(record, "series", ["t", "front"], [s.unit_time(), s.height]);
        points.into_iter().map(|(t, x)| (t, x - s.width / s.height)).collect()
    });
    let measured = Series::line("experiment", lobovsky.front.clone()).colour(Colour::BLACK);
    figure = figure.panel(plot.layer(measured));
    for (k, place) in PROBES.iter().enumerate() {
        let (x, y) = axis("depth [H]".into());
        let title = format!("H{}, x = {} m", k + 1, place);
        let mut plot = Plot::new(title, x.range(0.0, end), y).legend(Legend::Hidden);
        let series: Vec<Curve> = lobovsky.levels[k].iter().map(|level| until(level, end)).collect();
        if let [a, b] = &series[..] {
            let between = a.iter().zip(b).map(|((t, a), (_, b))| (*t, a.min(*b), a.max(*b)));
            plot = plot.layer(Layer::band("", between.collect(), Colour::GREY));
        }
        for one in series {
            plot = plot.layer(Series::line("", one).colour(Colour::BLACK).width(1.0));
        }
        figure = figure.panel(with_runs(plot, records, "H", |record| {
            let s = settings(record);
            let level = format!("H{}", k + 1);
            curve(record, "series", ["t", &level], [s.unit_time(), s.height])
        }));
    }
    figure.panel_size(300.0, 220.0)
}

/// Pressures of the finest run.
fn pressures(finest: &Record, lobovsky: &Lobovsky) -> Figure {
    let caption = format!(
        "Pressure on four sensors in the far wall, {} (blue), after arrival at P1. Black is the experiment \
         of Lobovsky et al., grey its second sensor at the height of P2. Peaks scatter in both and are cut \
         at 3.5 ρ g H; impulses are judged instead.",
        name_of(finest, "H")
    );
    let mut figure = Figure::new("dam-break-pressures", caption).columns(2);
    let at = reference::arrival(&lobovsky.pressure[0]);
    for (k, height) in SENSORS.iter().enumerate() {
        let title = format!("P{}, {} mm above the floor", k + 1, sig(1e3 * height, 2));
        let x = Axis::linear("time since arrival [√(H/g)]");
        let y = Axis::linear("pressure [ρ g H]").range(-0.2, 3.5);
        let mut plot = Plot::new(title, x, y).legend(Legend::Hidden);
        let points = since(&pressure(finest, k), arrival(finest));
        plot = plot.layer(Series::line("", points).colour(Colour::SKY).width(1.0));
        if k == 1 {
            let aside = since(&lobovsky.aside, at);
            plot = plot.layer(Series::line("", aside).colour(Colour::GREY).width(1.0));
        }
        let measured = Series::line("", since(&lobovsky.pressure[k], at));
        figure = figure.panel(plot.layer(measured.colour(Colour::BLACK)));
    }
    figure.panel_size(420.0, 220.0)
}

/// Pressure at sensor k \[ρ g H\] over t \[(H/g)^(1/2)\].
fn pressure(record: &Record, k: usize) -> Curve {
    curve(record, "pressure", ["t", &format!("P{}", k + 1)], [1.0, 1.0])
}

/// When the wave arrives at P1; NaN, so that no curve is drawn, if it did not.
fn arrival(record: &Record) -> f64 {
    record.value(metrics::ARRIVAL).unwrap_or(f64::NAN)
}

/// The part of a curve about the arrival of the wave, from which its time counts.
fn since(curve: &Curve, arrival: f64) -> Curve {
    let from = curve.iter().map(|(t, p)| (t - arrival, *p));
    from.filter(|(t, _)| (-0.3..=3.4).contains(t)).collect()
}

/// Impulses since the arrival of all runs.
fn impulses(records: &[&Record], lobovsky: &Lobovsky) -> Figure {
    let caption = "Impulse (pressure integrated over time) on four sensors in the far wall after arrival \
                   at P1. Black is the experiment of Lobovsky et al., and the band is as wide as its two \
                   sensors at the height of P2 differ. Impulses at 1 √(H/g) are judged.";
    let mut figure = Figure::new("dam-break-impulses", caption).columns(2);
    let so_far = |curve: &Curve, arrival: f64| -> Curve {
        let later = since(curve, arrival).into_iter().filter(|(t, _)| *t >= 0.0);
        let mut last = (0.0, 0.0, 0.0);
        let add = |(t, p): (f64, f64)| {
            last = (t, p, last.2 + 0.5 * (t - last.0) * (p + last.1));
            (t, last.2)
        };
        later.map(add).collect()
    };
    let at = reference::arrival(&lobovsky.pressure[0]);
    let [two, aside] = [&lobovsky.pressure[1], &lobovsky.aside].map(|curve| so_far(curve, at));
    for (k, height) in SENSORS.iter().enumerate() {
        let title = format!("P{}, {} mm above the floor", k + 1, sig(1e3 * height, 2));
        let x = Axis::linear("time since arrival [√(H/g)]");
        let y = Axis::linear("impulse [ρ g H √(H/g)]");
        let legend = if k == 3 { Legend::Auto } else { Legend::Hidden };
        let measured = so_far(&lobovsky.pressure[k], at);
        let spread = two.iter().zip(&aside).map(|((_, a), (_, b))| (a - b).abs());
        let band = measured.iter().zip(spread).map(|((t, y), by)| (*t, y - by, y + by)).collect();
        let plot = Plot::new(title, x, y).legend(legend);
        let plot = plot.layer(Layer::band("", band, Colour::GREY));
        let plot =
            with_runs(plot, records, "H", |record| so_far(&pressure(record, k), arrival(record)));
        let measured = Series::line("experiment", measured).colour(Colour::BLACK);
        figure = figure.panel(plot.layer(measured));
    }
    figure.panel_size(420.0, 220.0)
}

fn tank_table(records: &[&Record]) -> Table {
    let caption = "Distance from Lobovsky et al., as released and after the shift of the computed clock \
                   that makes it least. The speed of the front is its slope from t = 1 to 2.3 √(H/g). \
                   Tongue is the relative error of the mean level at H4 during one √(H/g) after the water \
                   arrives there.";
    columns("H/dx")
        .number("rms of front", "H", FRONT.rms)
        .number("after shift", "H", FRONT.rms_shifted)
        .number("front shift", "√(H/g)", FRONT.shift)
        .number("front speed", "√(g H)", metrics::FRONT_SPEED)
        .number("measured", "√(g H)", metrics::FRONT_SPEED_MEASURED)
        .number("rms of levels", "H", LEVELS.rms)
        .number("after shift", "H", LEVELS.rms_shifted)
        .number("levels shift", "√(H/g)", LEVELS.shift)
        .percent("tongue at H4", "-", metrics::TONGUE, 1.0)
        .table(caption, records.iter().copied())
}

/// That finer runs are farther from the experiment, if they are.
fn away(records: &[&Record]) -> Option<String> {
    let ladder: Vec<&Record> = records.iter().copied().filter(|r| r.variant == "modern").collect();
    let each = |of: &dyn Fn(&Record) -> String| -> String {
        ladder.iter().map(|record| of(record)).collect::<Vec<_>>().join(", ")
    };
    let value = |r: &Record, metric: MetricName| r.value(metric).unwrap_or(f64::NAN);
    let number = |metric: MetricName| each(&|r| sig(value(r, metric.clone()), 3));
    let error = |r: Option<&&Record>| r.and_then(|r| r.value(FRONT.rms_shifted));
    let is_away = error(ladder.last()) > error(ladder.first());
    is_away.then(|| {
        format!(
            "Finer runs of `modern` are not nearer to the experiment. At H/dx = {} the front is {} H away \
             after the shift, its speed is {} √(g H), and the impulse on P2 is {} in error. These runs \
             approach two-dimensional water without friction, released at once, so a coarse run that \
             agrees has errors that cancel.",
            each(&|r| n(r).to_string()),
            number(FRONT.rms_shifted.into()),
            number(metrics::FRONT_SPEED.into()),
            each(&|r| percent(value(r, metrics::IMPULSE[1].at(1)), 2)),
        )
    })
}

/// What strikes the far wall.
fn impact_table(records: &[&Record]) -> Table {
    let caption = "Relative errors of impulses on the far wall during 1 (judged) and 2.5 √(H/g) after the \
                   arrival at P1. Two sensors of Lobovsky et al. at the height of P2 differ by 6.0 and 13.5 \
                   %. The experiment arrives at 2.44 √(H/g) with a noise of 0.020 at P2; an error below \
                   −100 % is tension.";
    let mut table = columns("H/dx").number("arrival at P1", "√(H/g)", metrics::ARRIVAL);
    for window in reference::WINDOWS {
        for (k, impulse) in metrics::IMPULSE.into_iter().enumerate() {
            let head = format!("impulse P{} to {}", k + 1, sig(window, 2));
            table = table.percent(&head, "-", impulse.at(window), 1.0);
        }
    }
    table
        .number("noise of P2", "ρ g H", metrics::NOISE)
        .number("largest P1", "ρ g H", metrics::PEAK[0])
        .table(caption, records.iter().copied())
}

/// Six times of a run, on the same axes.
fn pictures(record: &Record, id: &str, (width, height): (f64, f64)) -> Figure {
    let (scene, side, spike) = match is_free(record) {
        true => {
            let spike = " Particles that lag at the back wall make the spike at x = 0.";
            ("The column of Martin & Moyce", "a", spike)
        }
        false => ("The tank of Lobovsky et al.", "H", ""),
    };
    let caption = format!(
        "{scene} at six times, {}, coloured by pressure, cut at 0 and 1 ρ g H.{spike}",
        name_of(record, side)
    );
    let mut figure = Figure::new(id, caption).columns(2);
    for share in PICTURES {
        figure = figure.panel(picture(record, share, (width, height)));
    }
    figure.panel_size(430.0, 430.0 * height / width)
}

/// One of them.
fn picture(record: &Record, share: f64, (width, height): (f64, f64)) -> ParticleMap {
    let points = pictures::points(record, &format!("particles@{share}"), "p");
    let s = settings(record);
    let axes = (Axis::linear("x [H]").range(0.0, width), Axis::linear("y [H]").range(0.0, height));
    let title = format!("time {} √(H/g)", sig(s.end * share, 3));
    let dx = s.width.min(s.height) / s.n as f64 / s.height;
    ParticleMap::new(&title, axes, "p [ρ g H]", ColourMap::Sequential, points)
        .diameter(dx)
        .values(0.0, 1.0)
}

/// The tank as a film.
fn film(tier: Tier, runs: &Runs) -> Result<Film, String> {
    let record = runs.record(&specs::film(tier)).ok_or("The film was not run.")?;
    let frame = |k: usize| {
        let map = picture(record, run::share(k, FRAMES), (1.61 / 0.3, 2.0));
        Figure::new("frame", "").panel(map).panel_size(380.0, 145.0)
    };
    let frames: Vec<Figure> = (0..FRAMES).map(frame).collect();
    let caption = format!(
        "Film of the water in the tank of Lobovsky et al., variant `modern`, H/dx = {FILM_ROWS}, coloured \
         by pressure, cut at 0 and 1 ρ g H."
    );
    Film::new("dam-break-film", caption, &frames, 160)
}

/// Where the energy goes.
fn energies(tier: Tier, runs: &Runs) -> Study {
    let caption = "Energy of the column of Martin & Moyce at a/dx = 20, over its potential energy on the \
                   floor, M g H/2. Solid lines are what the water has, and dashed lines what each term has \
                   taken so far. Black is the sum, which must keep its first value.";
    let mut figure = Figure::new("dam-break-energy", caption).columns(2);
    for variant in ["seed", "modern"] {
        if let Some(record) = runs.record(&specs::free(tier, variant, 20).measure_all()) {
            figure = figure.panel(energy_plot(record));
        }
    }
    Study::new("dam-break-energy", "Energy, term by term")
        .block(figure.panel_size(430.0, 280.0))
        .block(energy_table(tier, runs))
}

fn energy_plot(record: &Record) -> Plot {
    let s = settings(record);
    let mass = s.rho * s.width * s.height;
    let [time, energy] = [s.unit_time(), 0.5 * mass * s.gravity * s.height];
    let of = |name: &str, sign: f64| curve(record, "energy", ["t", name], [time, sign * energy]);
    let mut plot = Plot::new(
        record.variant.as_str(),
        Axis::linear("time [√(H/g)]"),
        Axis::linear("energy [M g H/2]"),
    )
    .legend(Legend::Outside);
    let mut sum = of("potential", 1.0);
    for (k, name) in ["potential", "kinetic", "compression"].into_iter().enumerate() {
        let points = of(name, 1.0);
        if k > 0 {
            sum.iter_mut().zip(&points).for_each(|(s, p)| s.1 += p.1);
        }
        plot = plot.layer(Series::line(name, points).colour(Colour::cycle(k)));
    }
    for (k, (name, work)) in ledger::ITEMS.into_iter().enumerate() {
        let points = of(&String::from(work), -1.0);
        sum.iter_mut().zip(&points).for_each(|(s, p)| s.1 += p.1);
        if points.iter().any(|(_, y)| y.abs() > 1e-4) {
            // Black is the sum.
            const COLOURS: [Colour; 5] =
                [Colour::PURPLE, Colour::ORANGE, Colour::SKY, Colour::GREY, Colour::BROWN];
            let dashed = Series::line(name, points).colour(COLOURS[k]).dash(Dash::Dashed);
            plot = plot.layer(dashed);
        }
    }
    plot.layer(Series::line("sum", sum).colour(Colour::BLACK))
}

fn energy_table(tier: Tier, runs: &Runs) -> Table {
    let caption = "Energy that each term has added until the end, over M g H/2 at the start. Below 0 it \
                   took energy. The work of the walls is that of their pressure beyond what they store. \
                   Momentum is over M √(g H).";
    let all = specs::all_free(tier).chain(specs::all_in_tank(tier));
    let scene = |record: &Record| if is_free(record) { "Martin & Moyce" } else { "Lobovsky" };
    let sci = |value| Cell::sci(value, 2);
    let mut columns = Columns::of_variants().text("case", move |record| scene(record)).of(
        ["n", "1"],
        |record| n(record) as f64,
        |n| Cell::num(n, 3),
    );
    for (name, work) in ledger::ITEMS {
        columns = columns.metric([name, "-"], work, |value| Cell::percent(value, 3));
    }
    columns
        .metric(["not accounted for", "-"], ledger::ENERGY_GAP, sci)
        .metric(["momentum not accounted for", "-"], metrics::MOMENTUM_GAP, sci)
        .table(caption, runs.records(all.map(RunSpec::measure_all)))
}
