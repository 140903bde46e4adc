//! Histories of both experiments over what was measured and over the same model by volume of fluid.

use std::f64::consts::FRAC_1_SQRT_2;

use super::{
    DamSettings,
    measure::{PROBES, SENSORS},
    metrics,
    plan::{self, Group},
    reference::{self, Curve, Lobovsky, VolumeOfFluid, front, scaled, until},
};
use crate::water::curve;
use base::record::Record;
use harness::{
    case::Tier,
    declare::{CurveOf, CurvePanel, Curves},
};
use report::{Axis, sig};

/// A panel over time until an end: title, axes, curves of runs, and those measured and (without a name) by
/// volume of fluid.
fn panel(
    title: String,
    ([x, y], end): ([&str; 2], f64),
    lines: Vec<CurveOf>,
    curves: [&Curve; 2],
) -> CurvePanel {
    let [measured, other] = curves.map(|curve| until(curve, end));
    let (x, y) = (Axis::linear(x).range(0.0, end), Axis::linear(y));
    let references = vec![("experiment".into(), measured), (String::new(), other)];
    CurvePanel { title, x, y, lines, references, symbols: false }
}

/// Both figures.
pub fn curves(tier: Tier) -> Vec<Curves> {
    // Packages are embedded and checked by a test.
    let model = VolumeOfFluid::load().unwrap_or_default();
    vec![column(tier, &model), tank(tier, &model)]
}

/// Curves of the judged runs of the best variant and of the paper's.
fn lines(
    tier: Tier,
    group: Group,
    points: impl Fn(&Record) -> Curve + Clone + Send + Sync + 'static,
) -> Vec<CurveOf> {
    let table = plan::table(tier);
    let shown = table.of(group).filter(|row| ["modern", "seed"].contains(&row.variant));
    let line = |row: &plan::Row| CurveOf {
        name: format!("{}, {} spacings", row.variant, row.settings.n),
        spec: row.run.spec.clone(),
        points: Box::new(points.clone()),
    };
    shown.map(line).collect()
}

fn column(tier: Tier, model: &VolumeOfFluid) -> Curves {
    let [measured_front, measured_height] = reference::martin_moyce().unwrap_or_default();
    let height = |record: &Record| {
        let DamSettings { width: a, gravity: g, .. } = record.settings_as();
        curve(record, "series", ["t", "height"], [(a / g).sqrt(), 2.0 * a])
    };
    // Its clock is in √(H/g), and H is 2a.
    let model_height = scaled(&model.free[1], FRAC_1_SQRT_2, 1.0, 0.0);
    let fronts = panel(
        "front".into(),
        (["time T = t √(2g/a) [-]", "front Z [a]"], 3.6),
        lines(tier, Group::Free, front),
        [&measured_front, &model.free[0]],
    );
    let heights = panel(
        "residual height".into(),
        (["time τ = t √(g/a) [-]", "height [2a]"], 2.6),
        lines(tier, Group::Free, height),
        [&measured_height, &model_height],
    );
    let caption = "Front from the back wall (left) and height near it, at 0.2 a (right), of a water column \
                   of width a = 57.15 mm and height 2a. Black is the experiment of Martin & Moyce 1952, \
                   whose fronts are digitised within 0.1 a, and grey volume of fluid, which solves the same \
                   model. No clock is shifted.";
    Curves {
        id: "dam-break-martin-moyce".into(),
        title: "Martin & Moyce 1952: front and height".into(),
        caption: caption.into(),
        columns: 2,
        panels: vec![fronts, heights],
    }
}

/// A length of the tank \[H\] over time \[(H/g)^(1/2)\].
fn length(record: &Record, name: &str) -> Curve {
    let s: DamSettings = record.settings_as();
    curve(record, "series", ["t", name], [s.unit_time(), s.height])
}

/// The level at a probe, likewise.
pub fn depth(record: &Record, probe: usize) -> Curve {
    length(record, &format!("H{}", probe + 1))
}

/// The pressure on a sensor \[ρ g H\] over time.
pub fn pressure(record: &Record, sensor: usize) -> Curve {
    curve(record, "pressure", ["t", &format!("P{}", sensor + 1)], [1.0, 1.0])
}

fn tank(tier: Tier, model: &VolumeOfFluid) -> Curves {
    let lobovsky = Lobovsky::load().unwrap_or_default();
    let time = "time [√(H/g)]";
    let mut panels = vec![panel(
        "front".into(),
        ([time, "front from the gate [H]"], 2.8),
        lines(tier, Group::Tank, |record| scaled(&length(record, "front"), 1.0, 1.0, 2.0)),
        [&lobovsky.front, &scaled(&model.front, 1.0, 1.0, 2.0)],
    )];
    for (k, place) in PROBES.iter().enumerate() {
        let name = format!("H{}", k + 1);
        let lines = lines(tier, Group::Tank, move |record| depth(record, k));
        let curves = [&lobovsky.level(k, 6.0), &model.levels[k]];
        let title = format!("{name}, x = {place} m");
        panels.push(panel(title, ([time, "depth [H]"], 6.0), lines, curves));
    }
    let since = |curve: &Curve, arrival: f64| -> Curve {
        let from = curve.iter().map(|(t, p)| (t - arrival, *p));
        from.filter(|(t, _)| *t >= 0.0).collect()
    };
    let [measured, computed] = [&lobovsky.pressure, &model.pressure]
        .map(|p| p.each_ref().map(|of| since(of, reference::arrival(&p[0]))));
    let aside = since(&lobovsky.aside, reference::arrival(&lobovsky.pressure[0]));
    for (k, height) in SENSORS.iter().enumerate() {
        let name = format!("P{}", k + 1);
        let title = format!("{name}, {} mm above the floor", sig(1e3 * height, 2));
        let arrived = move |record: &Record| {
            // NaN, so that no curve is drawn, if the wave did not arrive.
            let arrival = record.value(metrics::ARRIVAL).unwrap_or(f64::NAN);
            since(&pressure(record, k), arrival)
        };
        let axes = (["time since arrival [√(H/g)]", "pressure [ρ g H]"], 3.4);
        let lines = lines(tier, Group::Tank, arrived);
        let of = panel(title, axes, lines, [&measured[k], &computed[k]]);
        let mut of = CurvePanel { y: of.y.range(-0.2, 3.5), ..of };
        if k == 1 {
            of.references.push((String::new(), aside.clone()));
        }
        panels.push(of);
    }
    let caption = "Front, depth at four stations, and pressure on four sensors in the far wall, of a column \
                   600 mm long and 300 mm high in a tank of 1610 mm. Black is the experiment of Lobovsky et \
                   al. 2014 (levels: the mean of two series), and grey volume of fluid and a second sensor \
                   at the height of P2. Peaks of the pressure scatter and are cut at 3.5 ρ g H; impulses are \
                   judged instead. The clock of pressures begins when the wave arrives at P1.";
    Curves {
        id: "dam-break-lobovsky".into(),
        title: "Lobovsky et al. 2014: front, levels, pressures".into(),
        caption: caption.into(),
        columns: 3,
        panels,
    }
}
