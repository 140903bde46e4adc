//! Histories of both experiments with measurements and with the same model by volume of fluid.

use std::f64::consts::FRAC_1_SQRT_2;

use touchstone_base::record::Record;
use touchstone_harness::{
    case::Tier,
    studies::{CurveOf, CurvePanel, Curves},
};
use touchstone_maths::metrics::curve::{Points, mean, until};
use touchstone_report::{Axis, sig};

use super::{
    DamSettings,
    columns::{LEVELS, PRESSURES},
    measure::{PROBES, SENSORS},
    metrics::ARRIVAL,
    plan::{self, Group, Row},
    reference::{
        LOBOVSKY, MARTIN_MOYCE, MODEL, MODEL_OF_MARTIN_MOYCE, arrival, aside, depth, front,
        front_from, height, pressure,
    },
};

/// A panel over time until an end, of the judged runs of the recommended variant and of the paper's: names of
/// the axes, curves of runs, of measurements and (without a name) of volume of fluid.
fn panel(
    (tier, group): (Tier, Group),
    title: &str,
    ([x, y], end): ([&str; 2], f64),
    points: impl Fn(&Record) -> Points + Clone + Send + Sync + 'static,
    curves: [&Points; 2],
) -> CurvePanel {
    let table = plan::table(tier);
    let line = |row: &Row| {
        let name = format!("{}, {} spacings", row.variant, row.settings.n);
        CurveOf::new(name, row.run.spec.clone(), points.clone())
    };
    let shown = table.of(group).filter(|row| ["modern", "seed"].contains(&row.variant));
    let [measured, other] = curves.map(|curve| until(curve, end));
    CurvePanel {
        title: title.into(),
        x: Axis::linear(x).range(0.0, end),
        y: Axis::linear(y),
        lines: shown.map(line).collect(),
        references: vec![("experiment".into(), measured), ("volume of fluid".into(), other)],
        symbols: false,
    }
}

/// Both figures.
pub fn curves(tier: Tier) -> Vec<Curves> {
    vec![column(tier), tank(tier)]
}

fn column(tier: Tier) -> Curves {
    let of = (tier, Group::Free);
    let axes = (["time T = t √(2g/a) [-]", "front Z [a]"], 3.6);
    let fronts =
        panel(of, "front", axes, front, [&MARTIN_MOYCE.front, &MODEL_OF_MARTIN_MOYCE.front]);
    let fallen = |record: &Record| {
        let DamSettings { width: a, gravity: g, .. } = record.run.settings_as();
        height(record, (a / g).sqrt())
    };
    // Its clock is in √(H/g), and H is 2a.
    let model = MODEL_OF_MARTIN_MOYCE.height.iter().map(|(t, y)| (t / FRAC_1_SQRT_2, *y)).collect();
    let axes = (["time τ = t √(g/a) [-]", "height [2a]"], 2.6);
    let heights = panel(of, "residual height", axes, fallen, [&MARTIN_MOYCE.height, &model]);
    let caption = "Does the water run as in the experiment and as by volume of fluid? Front from the back \
                   wall, and height at 0.2 a, of a column of width a = 57.15 mm and height 2a. Fronts of \
                   Martin & Moyce 1952 are digitised within 0.1 a; volume of fluid solves the same model. \
                   No clock is shifted.";
    let title = "Martin & Moyce 1952: front and height";
    Curves::new("dam-break-martin-moyce", title, caption, vec![fronts, heights])
}

/// Time of the means of a pressure \[√(H/g)\]: two and a half periods of the sound between floor and surface.
const MEAN: f64 = 0.2;

/// The means of a curve over [`MEAN`], until an end.
fn means(curve: &Points, end: f64) -> Points {
    let count = 4.0 * end / MEAN;
    let times = (0..=count as usize).map(|k| end * k as f64 / count);
    times.map(|t| (t, mean(curve, [t - 0.5 * MEAN, t + 0.5 * MEAN]))).collect()
}

fn tank(tier: Tier) -> Curves {
    let of = (tier, Group::Tank);
    let time = "time [√(H/g)]";
    let from_gate =
        |record: &Record| front_from(record, record.run.settings_as::<DamSettings>().width);
    // The column is 2 H long.
    let model = MODEL.front.iter().map(|(t, x)| (*t, x - 2.0)).collect();
    let axes = ([time, "front from the gate [H]"], 2.8);
    let mut panels = vec![panel(of, "front", axes, from_gate, [&LOBOVSKY.front, &model])];
    for (k, place) in PROBES.iter().enumerate() {
        let title = format!("{}, x = {place} m", LEVELS[k].name);
        let curves = [&LOBOVSKY, &MODEL].map(|known| known.level(k, 6.0));
        let level = move |record: &Record| depth(record, k);
        panels.push(panel(of, &title, ([time, "depth [H]"], 6.0), level, curves.each_ref()));
    }
    let since = |curve: &Points, arrival: f64| -> Points {
        let from = curve.iter().map(|(t, p)| (t - arrival, *p));
        from.filter(|(t, _)| *t >= 0.0).collect()
    };
    let [theirs, models] = [&LOBOVSKY, &MODEL].map(|known| arrival(&known.pressure[0]));
    for (k, height) in SENSORS.iter().enumerate() {
        let title = format!("{}, {} mm above the floor", PRESSURES[k].name, sig(1e3 * height, 2));
        let arrived = move |record: &Record| {
            // NaN, so that no curve is drawn, if the wave did not arrive.
            let arrival = record.value(ARRIVAL).unwrap_or(f64::NAN);
            since(&pressure(record, k), arrival)
        };
        let axes = (["time since arrival [√(H/g)]", "pressure [ρ g H]"], 3.4);
        let curves = [(&LOBOVSKY, theirs), (&MODEL, models)]
            .map(|(known, arrival)| since(&known.pressure[k], arrival));
        let raw = panel(of, &title, axes, arrived, curves.each_ref()).lines.into_iter();
        let raw = raw.map(|line| CurveOf { name: format!("{}, raw", line.name), ..line.pale() });
        let mean = move |record: &Record| means(&arrived(record), axes.1);
        let mut panel = panel(of, &title, axes, mean, curves.each_ref());
        panel.lines.splice(0..0, raw);
        panel.y = panel.y.range(-0.2, 3.5);
        if k == 1 {
            panel.references.push(("experiment, second sensor".into(), since(&aside(), theirs)));
        }
        panels.push(panel);
    }
    let caption = "Do front, levels and pressures in the tank follow the experiment of Lobovsky et al. \
                   2014? A column 600 mm long and 300 mm high in a tank of 1610 mm. Pressures of the run are \
                   means over 0.2 √(H/g), raw ones pale. They are cut at 3.5 ρ g H: peaks scatter, and \
                   impulses are judged instead; their clock begins when the wave arrives at P1.";
    let title = "Lobovsky et al. 2014: front, levels, pressures";
    Curves::new("dam-break-lobovsky", title, caption, panels)
}
