//! The metrics of the quick tier as snapshots, which fail on a change, and bounds on acceptable snapshots:
//! accepting a snapshot cannot hide an error.
//!
//! Each case has two snapshots, tables whose cells are separated by `|`. `case` holds the metrics of each
//! variant, a row a metric and a column a run, which are compared to 1e-6 of themselves and a floor for those
//! that are round-off; the names of numerics; and the mean of each column of a profile. `work.case` holds
//! steps, pair interactions and right-hand sides, which are compared exactly. A change that costs work and
//! moves no metric changes the second alone, and is not accepted together with a change of results. No
//! snapshot holds seconds.
//! `settings.case` holds settings and variants.

use std::{
    collections::{BTreeMap, BTreeSet},
    panic::{AssertUnwindSafe, catch_unwind},
};

use insta::{Comparator, Settings, Snapshot};
use rayon::prelude::*;
use serde_json::Value;
use touchstone_base::{
    gate::{Bound, Evidence, Gate},
    record::{Profile, ProfileColumn, Record, Status},
    settings::Field,
    spec::RunSpec,
};
use touchstone_cases::fluids::channel::{Flow, ladder};
use touchstone_harness::{
    case::{self, Case, Tier, Variant},
    plan,
    runner::Context,
};
use touchstone_tests::{kept_numbers, kept_work};

/// Metrics may differ by this much of themselves.
const RELATIVE: f64 = 1e-6;
/// And by this much: velocities and errors that are exactly 0 but for round-off.
const FLOOR: f64 = 1e-10;
/// The floor for errors of waves, which are round-off over the amplitude of 1e-6.
const WAVE_FLOOR: f64 = 1e-8;

const MOMENTUM: &str = "forces of pairs are equal and opposite";

/// Tables whose numbers may differ a little; whole numbers, texts and names may not.
#[derive(Clone)]
struct Close;

impl Close {
    fn are(a: &str, b: &str) -> bool {
        let rows = |text: &'_ str| -> Vec<Vec<String>> {
            text.lines()
                .map(|line| line.split('|').map(|of| of.trim().to_string()).collect())
                .collect()
        };
        let (a, b) = (rows(a), rows(b));
        let are_close = |(a, b): (&Vec<String>, &Vec<String>)| {
            let key = a[0].split(' ').next().unwrap_or_default();
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| Self::cells(key, a, b))
        };
        a.len() == b.len() && a.iter().zip(&b).all(are_close)
    }

    fn cells(key: &str, a: &str, b: &str) -> bool {
        // A whole number is a count.
        let number = |text: &str| text.parse::<f64>().ok().filter(|_| text.contains(['.', 'e']));
        let Some((x, y)) = number(a).zip(number(b)) else { return a == b };
        let floor = if key.ends_with("_error") { WAVE_FLOOR } else { FLOOR };
        (x - y).abs() <= RELATIVE * x.abs().max(y.abs()) + floor
    }
}

impl Comparator for Close {
    fn matches(&self, reference: &Snapshot, test: &Snapshot) -> bool {
        let text = |snapshot: &Snapshot| Some(snapshot.as_text()?.to_string());
        text(reference).zip(text(test)).is_some_and(|(a, b)| Close::are(&a, &b))
    }

    fn dyn_clone(&self) -> Box<dyn Comparator> {
        Box::new(self.clone())
    }
}

/// Compares with the stored snapshot of this name.
fn assert_kept(name: &str, text: &str, is_close: bool) {
    let mut settings = Settings::clone_current();
    if is_close {
        settings.set_comparator(Box::new(Close));
    }
    settings.set_omit_expression(true);
    settings.set_prepend_module_to_snapshot(false);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// Variants, and settings of theirs.
type Kept = (Vec<&'static str>, Vec<&'static str>);

/// Runs of the plan with snapshots, by variant and settings: the ladders up to 20 rows, `modern` in creeping
/// flow, and every wave on an ordered lattice, for which the theory holds.
fn kept(case: &str) -> Vec<Kept> {
    let kernel = |name: &'static str, sets: &[&'static str]| (vec![name], sets.to_vec());
    match case {
        "couette" => kept_channel(Flow::Couette),
        "poiseuille" => kept_channel(Flow::Poiseuille),
        "acoustic_wave" => vec![
            kernel(
                "cubic-leapfrog",
                &[
                    "h_over_dx=1.2 kx=1 ky=0",
                    "h_over_dx=1.3 kx=1 ky=0",
                    "h_over_dx=1.2 compression=0.05",
                ],
            ),
            kernel("cubic-pc", &["h_over_dx=1.2 kx=1 ky=0", "h_over_dx=1.3 kx=1 ky=0"]),
            kernel("quintic-leapfrog", &["h_over_dx=1 kx=1 ky=0", "h_over_dx=1.3 kx=1 ky=0"]),
            kernel("wendland-leapfrog", &["h_over_dx=1.5 kx=1 ky=0", "h_over_dx=2 kx=1 ky=0"]),
            kernel("cubic-leapfrog-diffusion", &["h_over_dx=1.2 kx=1 ky=0"]),
        ],
        "shear_wave" => {
            let cubic = ["h_over_dx=1.2 kx=1 ky=0 nu=0.01", "h_over_dx=1.3 kx=1 ky=0 nu=0.01"];
            vec![
                kernel("cubic-leapfrog", &cubic),
                kernel("cubic-pc", &cubic),
                kernel(
                    "quintic-leapfrog",
                    &["h_over_dx=1 kx=1 ky=0 nu=0.01", "h_over_dx=1.3 kx=1 ky=0 nu=0.01"],
                ),
                kernel(
                    "wendland-leapfrog",
                    &["h_over_dx=1.5 kx=1 ky=0 nu=0.01", "h_over_dx=2 kx=1 ky=0 nu=0.01"],
                ),
            ]
        }
        "taylor_couette" => vec![(vec!["extrapolating-wall", "interface-wall"], vec!["layers=8"])],
        // `modern` loses the flow to disorder that grows from round-off: its error is a headline.
        "taylor_green" => vec![(vec!["consistent", "modern"], vec!["n=32 perturb=0"])],
        "periodic_hill" => vec![(vec!["carried", "interface-wall"], vec!["n=10 end=30"])],
        "cavity" => vec![(vec!["carried", "consistent", "mirrored"], vec!["n=14", "n=16"])],
        _ => [kept_solid(case), kept_water(case), kept_exact(case)].concat(),
    }
}

/// Of channels: `modern` at Re 0.0125, 0.5 and 1, where disorder has not made much of a rounding.
fn kept_channel(flow: Flow) -> Vec<Kept> {
    let slow = vec!["re=0.0125 end=1.5", "re=0.5 end=1.5", "re=1 end=1.5"];
    let rows = vec!["rows=8", "rows=10", "rows=14", "rows=20"];
    vec![(ladder(flow).to_vec(), rows), (vec!["modern"], slow)]
}

/// Of cases whose solution is exact: the coarsest runs.
fn kept_exact(case: &str) -> Vec<Kept> {
    match case {
        "elastic_wave" => {
            vec![(vec!["cubic"], vec!["h_over_dx=1.2", "h_over_dx=1.5 transverse=true"])]
        }
        "extremes" => vec![(vec!["coincident"], vec!["distance=1e-14"])],
        "manufactured" => {
            vec![(vec!["seed", "modern", "consistent", "consistent-interface"], vec!["n=12"])]
        }
        "operators" => {
            let of = ["quintic-density", "quintic-laplacian-corrected", "quintic-divergence"];
            vec![(of.to_vec(), vec!["n=24 h_over_dx=1.5 disorder=0", "n=24 h_over_dx=1"])]
        }
        "slip_channel" => vec![(vec!["plain", "extrapolating-wall"], vec!["n=14"])],
        _ => Vec::new(),
    }
}

/// The tank of Lobovsky et al.
const LOBOVSKY: &str = "n=30 width=0.6 height=0.3 tank=1.61 rim=2 end=6";

/// Runs of water with snapshots: coarse runs at rest or in smooth flow, and the numbers of a collapse in
/// README.
fn kept_water(case: &str) -> Vec<Kept> {
    match case {
        "hydrostatic" => vec![
            (vec!["modern", "ghosts", "seed"], vec!["compressibility=0.01"]),
            (vec!["modern"], vec!["compressibility=0.1", "compressibility=1e-4"]),
        ],
        "elliptic_drop" => vec![(vec!["seed", "plain", "modern", "consistent"], vec!["n=20"])],
        "still_wedge" => vec![(vec!["modern"], vec!["n=10", "n=14"])],
        "dam_break" => {
            vec![
                (vec!["seed", "modern"], vec!["n=20"]),
                (vec!["modern"], vec!["n=10", "n=14", LOBOVSKY]),
            ]
        }
        _ => Vec::new(),
    }
}

/// Of solid cases: short runs, before a start without stress has made much of a rounding.
fn kept_solid(case: &str) -> Vec<Kept> {
    match case {
        "elastic_bar" => {
            let [pulse, fast, slow] = ["n=40", "collide=true speed=0.1", "collide=true speed=1e-4"];
            let apart = "collide=true gap=2.05 speed=0.1 end=3"; // the contact of two bodies
            vec![
                (vec!["seed"], vec![pulse, slow]),
                (vec!["bare"], vec![pulse, fast, slow]),
                (vec!["lagrangian"], vec![pulse, fast, apart]),
            ]
        }
        "spinning_disk" => {
            let steps =
                ["n=8 end=0.1 courant=0.1", "n=8 end=0.1 courant=0.4", "n=8 end=0.1 courant=0.8"];
            vec![(vec!["bare"], steps.to_vec())]
        }
        "oscillating_plate" => {
            vec![(vec!["bare", "seed"], vec!["n=5"]), (vec!["lagrangian"], vec!["n=5 end=3.1"])]
        }
        "cantilever" => vec![(vec!["lagrangian"], vec!["n=5 end=0.75"])],
        "rubber_rings" => vec![
            (vec!["seed"], vec!["spacing=0.2"]),
            (vec!["lagrangian"], vec!["spacing=0.2", "spacing=0.2 speed=0.03"]),
        ],
        _ => Vec::new(),
    }
}

/// A run that is kept and the name of its numbers in the snapshot of its variant.
struct Run {
    name: &'static str,
    spec: RunSpec,
}

/// The runs of a case that are kept; each is in the plan of the quick tier.
fn runs(case: &dyn Case) -> Vec<Run> {
    let planned = plan::of_case(case, Tier::Quick);
    let is_planned = |spec: &RunSpec| {
        planned.iter().map(|planned| &planned.spec).any(|other| {
            (&other.variant, &other.settings) == (&spec.variant, &spec.settings)
                && other.is_simulation()
        })
    };
    let mut runs = Vec::new();
    for (variants, names) in kept(case.name()) {
        for (variant, name) in
            variants.iter().flat_map(|v| names.iter().map(move |name| (v, *name)))
        {
            let set: Vec<String> = name.split(' ').map(String::from).collect();
            let spec = case::spec(case, variant, &set).expect("sound settings");
            assert!(is_planned(&spec), "{} {variant} {name} is not planned", case.name());
            runs.push(Run { name, spec: spec.measure_all() });
        }
    }
    runs
}

/// Rows of cells, each column as wide as its widest cell.
fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or_default();
    let cells = |k: usize| rows.iter().filter_map(move |row| row.get(k));
    let widths: Vec<usize> = (0..columns)
        .map(|k| cells(k).map(|cell| cell.chars().count()).max().unwrap_or(0))
        .collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join(" | ").trim_end().to_string() + "\n"
    };
    rows.iter().map(line).collect()
}

/// Nine digits, of which the comparison needs seven.
fn number(value: f64) -> String {
    format!("{:?}", format!("{value:.8e}").parse().unwrap_or(value))
}

/// The metrics of the runs of a variant: a row a metric, a column a run; the names of numerics; and of the
/// profiles of the first run each column with its mean over all profiles that have these columns.
fn results(variant: &str, of: &[(&Run, &Record)]) -> String {
    let names: BTreeMap<&String, &String> = of
        .iter()
        .flat_map(|(_, record)| record.metrics.iter().map(|(name, metric)| (name, &metric.unit)))
        .collect();
    let heads = of.iter().map(|(run, _)| run.name.to_string());
    let mut rows = vec![std::iter::once(variant.to_string()).chain(heads).collect::<Vec<_>>()];
    for (name, unit) in names {
        let value = |(_, record): &(&Run, &Record)| {
            record.metrics.get(name).map_or("absent".into(), |metric| number(metric.value))
        };
        let values = of.iter().map(value);
        rows.push(std::iter::once(format!("{name} [{unit}]")).chain(values).collect());
    }
    let record = of[0].1;
    let mut profiles: BTreeMap<Vec<String>, Vec<(&str, &Profile)>> = BTreeMap::new();
    for (name, profile) in &record.profiles {
        profiles.entry(columns(profile)).or_default().push((name, profile));
    }
    let numerics: Vec<&str> = record.numerics.keys().map(String::as_str).collect();
    let mut text = table(&rows) + &format!("numerics: {}\n", numerics.join(", "));
    for (columns, of) in profiles {
        let names: Vec<&str> = of.iter().map(|(name, _)| *name).collect();
        text += &format!("profiles {}", names.join(", "));
        for (k, column) in columns.iter().enumerate() {
            let values = of.iter().flat_map(|(_, profile)| &profile.columns[k].values);
            text += &format!(" | {column} | {}", number(mean(values)));
        }
        text += "\n";
    }
    text
}

/// Names and units.
fn columns(profile: &Profile) -> Vec<String> {
    profile.columns.iter().map(|of: &ProfileColumn| format!("{} [{}]", of.name, of.unit)).collect()
}

/// The mean of the finite ones.
fn mean<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let (count, sum) = values
        .filter(|value| value.is_finite())
        .fold((0.0, 0.0), |(n, sum), value| (n + 1.0, sum + value));
    sum / count
}

/// The work of the runs of a variant: a row a run.
fn work(variant: &str, of: &[(&Run, &Record)]) -> String {
    let heads = [variant, "steps", "pair_interactions", "particle_rhs"].map(String::from).to_vec();
    let row = |(run, record): &(&Run, &Record)| {
        let cost = &record.cost;
        let counts = [cost.steps, cost.pair_interactions, cost.particle_rhs];
        std::iter::once(run.name.to_string()).chain(counts.map(|n| n.to_string())).collect()
    };
    table(&std::iter::once(heads).chain(of.iter().map(row)).collect::<Vec<_>>())
}

/// A metric without its time: `l2@0.1` is of the group `l2`.
fn group(metric: &str) -> &str {
    metric.split('@').next().unwrap_or(metric)
}

/// Bounds on metrics without gates, of solid cases.
fn bounds_of_solids(case: &str) -> Vec<(&'static str, Bound, &'static str)> {
    let little = "energy is lost to viscosity and may not be gained: 1 % for kinetic energy half a step late";
    match case {
        "elastic_bar" => vec![
            ("energy_change", Bound::Within(-0.5, 0.01), little),
            ("pulse_rms", Bound::Below(1.0), "1 is the error of a bar at rest"),
        ],
        "spinning_disk" => vec![
            (
                "largest_stress",
                Bound::Within(0.0, 5.0),
                "of the order of rho U^2 in so short a time",
            ),
            (
                "rim_strain",
                Bound::Within(0.0, 0.5),
                "a gradient that misses half of its neighbours is half of the spin",
            ),
            ("energy_drift", Bound::Within(-0.01, 0.01), "nothing dissipates, half a step late"),
        ],
        "oscillating_plate" => vec![
            ("period", Bound::Within(0.254, 0.4), "not faster than theory"),
            ("energy_change", Bound::Within(-0.5, 0.05), little),
        ],
        "cantilever" => {
            let long = "the end of a bar of 0.35 m that is clamped and hangs down";
            let places = ["amplitude_x", "amplitude_y", "first_least_y", "mean_x", "mean_y"];
            let mut bounds: Vec<_> =
                places.map(|name| (name, Bound::Within(-0.35, 0.35), long)).into();
            bounds.push(("path_rms", Bound::Below(0.1), "five layers bend as finite elements do"));
            bounds
        }
        "rubber_rings" => bounds_of_rings(),
        _ => Vec::new(),
    }
}

/// Bounds on metrics without gates, of rings of five layers.
fn bounds_of_rings() -> Vec<(&'static str, Bound, &'static str)> {
    let round =
        "a ring of outer radius 4 L that is flattened, and stays apart from its mirror image";
    let soft = "five layers bend too softly: the gates allow a seventh of the width";
    let run = "within the run, of 200 L/c0";
    let mut bounds: Vec<_> =
        ["t_impulse_1", "t_impulse_99"].map(|name| (name, Bound::Within(0.0, 200.0), run)).into();
    bounds
        .extend(["width_rms", "height_rms", "x_c_rms"].map(|name| (name, Bound::Below(2.0), soft)));
    bounds.extend([
        ("energy_lost", Bound::Within(0.0, 1.0), "viscosity takes energy and nothing adds any"),
        ("contact_begin_error", Bound::Within(-4.0, 4.0), "rings come nearer by dx in 3.4 L/c0"),
        ("histories", Bound::Below(0.25), soft),
        ("restitution", Bound::Within(0.0, 1.0), "rings do not part faster than they met"),
        ("impulse", Bound::Within(0.0, 2.6), "at most twice the momentum of a ring, 2 m V = 2.6"),
        ("height_max", Bound::Within(8.0, 12.0), round),
        ("width_min", Bound::Within(2.0, 8.0), round),
        ("v_c_rms", Bound::Below(0.059), "less than the speed itself"),
        ("volume_least", Bound::Within(0.5, 1.0), "a body of twice its density has diverged"),
    ]);
    bounds
}

/// Bounds on metrics without gates, of flow over hills at Re 50.
fn bounds_of_hills() -> Vec<(&'static str, Bound, &'static str)> {
    let part = "parts of the body force on a period, 0.9 rho U_b^2 H, and no suction upstream";
    let plane = "plane Poiseuille flow takes 0.0175 in the widest gap and 0.058 in the narrowest";
    vec![
        ("force", Bound::Within(0.0175, 0.058), plane),
        ("hill_pressure_drag", Bound::Within(0.0, 0.9), part),
        ("hill_shear_drag", Bound::Within(0.0, 0.9), part),
        ("lid_shear_drag", Bound::Within(0.0, 0.9), part),
        ("l2_v", Bound::Below(0.04), "as good as the velocity along the channel has to be"),
        ("reattachment", Bound::Within(1.929, 7.071), "on the flat floor between two hills"),
        ("separation", Bound::Within(0.0, 1.929), "on the lee side of a hill"),
    ]
}

/// Bounds on metrics without gates, of Taylor-Green vortices.
fn bounds_of_vortices() -> Vec<(&'static str, Bound, &'static str)> {
    let small = "32 spacings hold two vortices to some percent";
    vec![
        ("l2_worst", Bound::Below(0.1), small),
        ("nu_eff", Bound::Within(0.9, 1.1), small),
        ("momentum", Bound::Below(0.01), "consistent terms do not conserve it: their error of 1 %"),
        ("pressure_l2", Bound::Below(0.5), "pressure is noisier than velocity by 1/Mach"),
        ("volume_drift", Bound::Within(-0.01, 0.01), "volume changes with Mach squared"),
    ]
}

/// Bounds on metrics without gates, of cases of water.
fn bounds_of_water(case: &str) -> Vec<(&'static str, Bound, &'static str)> {
    let damps = "dissipation takes energy, and no more than there is";
    let stress =
        "a repulsion where p < 0 pushes particles apart, with less than half of the energy";
    let smooths = "a mean of velocities moves particles, and hardly changes their energy";
    let mut bounds = vec![
        ("work_viscosity", Bound::Within(-1.0, 0.0), damps),
        ("work_damper", Bound::Within(-1.0, 0.0), damps),
        ("work_diffusion", Bound::Within(-1.0, 0.0), damps),
        ("work_stress", Bound::Within(0.0, 0.5), stress),
        ("work_xsph", Bound::Within(-0.05, 0.05), smooths),
    ];
    let late = "compared on its own clock the experiment is 0.25 late, at a speed of 1.3";
    let inside = "water that has not left the tank";
    bounds.extend(match case {
        "elliptic_drop" => {
            vec![("work_walls", Bound::Within(-1e-12, 1e-12), "there is no wall")]
        }
        _ => vec![
            ("front_rms", Bound::Below(0.4), late),
            ("height_rms", Bound::Below(0.1), "some stations of the height"),
            ("height_shift", Bound::Within(-0.4, 0.4), late),
            ("outside_end", Bound::Equals(0.0), inside),
        ],
    });
    if case == "dam_break" {
        bounds.extend(bounds_of_tank());
    }
    bounds
}

/// Bounds on metrics without gates, of the collapse in the tank of Lobovsky et al.
fn bounds_of_tank() -> Vec<(&'static str, Bound, &'static str)> {
    let level = "the levels of four stations, of which the gates allow 0.03 H in the mean";
    let head =
        "a jet of 1.5 times the speed of a fall from H bears 5 rho g H, a shock several times that";
    let history = "the largest impulse over its window of 2.5 is 3.1 rho g H (H/g)^(1/2)";
    let clock = "the front crosses 3.4 H at 1.5 (g H)^(1/2)";
    vec![
        ("levels_rms", Bound::Below(0.06), level),
        ("levels_shift", Bound::Within(-0.4, 0.4), "as of the front"),
        ("peak_P1", Bound::Within(0.0, 20.0), head),
        ("arrival", Bound::Within(2.0, 3.0), clock),
        ("P1_away", Bound::Below(1.2), history),
        ("P2_away", Bound::Below(1.2), history),
        ("P3_away", Bound::Below(1.2), history),
        ("P4_away", Bound::Below(1.2), history),
        ("spilled", Bound::Within(0.0, 0.05), "by volume of fluid 2 % leave, uncertain by 1 %"),
    ]
}

/// Bounds on metrics without gates, for every run with a snapshot, from νt/L² = 0.1 on.
fn bounds_beside(case: &str) -> Vec<(&'static str, Bound, &'static str)> {
    let walls = "walls are first order in dx where the velocity is not linear: at 8 rows some 5 %";
    match case {
        "couette" | "poiseuille" => {
            vec![("linf", Bound::Below(0.1), walls)]
        }
        "acoustic_wave" => vec![
            ("momentum_error", Bound::Below(1e-9), MOMENTUM),
            (
                "sound_factor",
                Bound::Within(0.9, 1.0),
                "a smoothed gradient is weaker than the gradient: by (k h)^2 of about 0.2, less",
            ),
        ],
        "elastic_bar" | "spinning_disk" | "oscillating_plate" | "cantilever" | "rubber_rings" => {
            bounds_of_solids(case)
        }
        "taylor_couette" => {
            let around =
                "the flow goes around, and nowhere else: within the error of 8 spacings, 1 %";
            vec![("radial_rms", Bound::Below(0.01), around)]
        }
        "extremes" => {
            let apart = "a pair that is pressed together parts at less than the speed of sound";
            vec![("fastest", Bound::Below(1.0), apart)]
        }
        "manufactured" => {
            let smoothed = "smoothing is of order (2 pi h)^2, 0.39 for h = 1.2 dx at 12 spacings";
            let quarter =
                "viscosity leaves the velocity a quarter of what smoothing does to the pressure";
            vec![("pressure_l2", Bound::Below(0.4), smoothed), ("l2", Bound::Below(0.1), quarter)]
        }
        "operators" => {
            let smoothed = "smoothing takes (k h)^2/2, 0.08 for h = 1.5 dx at 24 spacings, or less";
            let random =
                "of displacements of 0.2 dx, which kernels of h = dx average over few neighbours";
            vec![
                ("bias", Bound::Below(0.08), smoothed),
                ("gain", Bound::Within(0.92, 1.08), smoothed),
                ("noise", Bound::Below(0.3), random),
                ("error", Bound::Below(0.3), random),
            ]
        }
        "slip_channel" => {
            let rate = "of second order: 14 spacings decay within 2 % of the rate of the viscosity";
            vec![("decay", Bound::Within(0.98, 1.02), rate)]
        }
        "taylor_green" => bounds_of_vortices(),
        "cavity" => {
            let wall =
                "a wall that is half of a spacing away from its place, at 12 spacings a side";
            ["u_rms", "v_rms", "u_ghia", "v_ghia"]
                .map(|name| (name, Bound::Below(0.5 / 12.0), wall))
                .into()
        }
        "still_wedge" => {
            let row = "the weight of one row of ten";
            vec![
                ("p_l2", Bound::Below(0.1), row),
                ("p_apex", Bound::Within(-0.1, 0.1), row),
                ("kinetic", Bound::Below(1e-4), "raises the surface by a tenth of a spacing"),
            ]
        }
        "periodic_hill" => bounds_of_hills(),
        "elliptic_drop" | "dam_break" => bounds_of_water(case),
        "shear_wave" => vec![
            ("momentum_error", Bound::Below(1e-9), MOMENTUM),
            (
                "viscous_factor",
                Bound::Within(0.9, 1.05),
                "the Laplacian, smoothed, eta^2 = 0.01 h^2",
            ),
        ],
        _ => Vec::new(), // each of their metrics has a gate
    }
}

fn outside_bounds(case: &str, Run { name: set, spec }: &Run, record: &Record) -> Vec<String> {
    let (variant, mut outside) = (&spec.variant, Vec::new());
    if record.status != Status::Completed {
        outside.push(format!("{variant} {set}: {:?}", record.status));
    }
    // The error of a known limitation is bounded by its gate.
    let is_lost = (case, &**variant) == ("taylor_green", "modern");
    // A continuity that is exact for linear fields, and pressure by pairs, do not exchange energy exactly.
    let is_exchanged =
        |name: &str| (case, &**variant, name) != ("elliptic_drop", "consistent", "work_diffusion");
    let bounds =
        bounds_beside(case).into_iter().filter(|(name, ..)| !is_lost && is_exchanged(name));
    for (name, bound, because) in bounds {
        for (metric, found) in &record.metrics {
            let time = metric.split('@').nth(1).and_then(|tau| tau.parse::<f64>().ok());
            let is_judged = group(metric) == name && time.is_none_or(|tau| tau >= 0.1);
            if is_judged && !bound.contains(found.value) {
                let run = format!("{case} {variant} {set}");
                outside.push(format!("{run}: {metric} = {:e}, {bound}: {because}", found.value));
            }
        }
    }
    outside
}

/// Runs with their records, by variant.
type ByVariant<'a> = BTreeMap<&'a str, Vec<(&'a Run, &'a Record)>>;

/// Runs what is kept of every case and compares, two snapshots for each case, metrics and work. All of them
/// are compared before the test fails, so that the message lists all changes.
#[test]
fn results_are_as_they_were() {
    let kept: Vec<(&dyn Case, Run)> = touchstone_cases::CASES
        .iter()
        .flat_map(|case| runs(*case).into_iter().map(|run| (*case, run)))
        .collect();
    let record =
        |(case, run): &(&dyn Case, Run)| case.run(&run.spec, &Context::default()).expect("planned");
    let records: Vec<Record> = kept.par_iter().map(record).collect();
    let mut by_case: BTreeMap<&str, ByVariant> = BTreeMap::new();
    for case in touchstone_cases::CASES.iter().map(|case| case.name()) {
        // Resting boxes are searches for the largest stable step, each with a gate.
        let has_runs = kept.iter().any(|(of, _)| of.name() == case);
        assert!(has_runs || case == "resting_box", "no run of {case} has a snapshot");
    }
    let mut outside = Vec::new();
    for ((case, run), record) in kept.iter().zip(&records) {
        let variants = by_case.entry(case.name()).or_default();
        variants.entry(&run.spec.variant).or_default().push((run, record));
        outside.extend(outside_bounds(case.name(), run, record));
    }
    assert!(outside.is_empty(), "{}", outside.join("\n"));
    let mut changed = Vec::new();
    for (case, variants) in &by_case {
        let of = |part: fn(&str, &[(&Run, &Record)]) -> String| {
            let parts = variants.iter().map(|(variant, runs)| part(variant, runs));
            parts.collect::<Vec<_>>().join("\n")
        };
        for (name, text) in [(case.to_string(), of(results)), (format!("work.{case}"), of(work))] {
            if catch_unwind(AssertUnwindSafe(|| assert_kept(&name, &text, true))).is_err() {
                changed.push(name);
            }
        }
    }
    assert!(changed.is_empty(), "{}", told(&changed));
}

/// The changes of results and of work, apart.
fn told(changed: &[String]) -> String {
    let (work, results): (Vec<&String>, Vec<&String>) =
        changed.iter().partition(|name| name.starts_with("work."));
    let list = |names: &[&String]| match names {
        [] => "of none".to_string(),
        names => format!("of {}", names.iter().map(|n| n.as_str()).collect::<Vec<_>>().join(", ")),
    };
    format!(
        "metrics changed {}; work changed {}: the differences are above",
        list(&results),
        list(&work)
    )
}

/// Settings and variants of `list --json`: a row a setting, then a row a variant with its settings that
/// differ from the defaults, and the settings that it lacks.
#[test]
fn settings_are_as_they_were() {
    for case in touchstone_cases::CASES {
        let fields = case.fields();
        let default = |field: &Field| Value::from(field.default);
        let setting = |field: &Field| {
            let range = format!("{}, {}", field.range, field.kind); // with its unit
            vec![field.name.into(), default(field).to_string(), range, field.doc.into()]
        };
        let variant = |variant: &Variant| {
            let own = case.settings(variant.name, &[]).expect("default settings");
            let (mut differs, mut lacks) = (Vec::new(), Vec::new());
            for field in fields {
                match own.get(field.name) {
                    None => lacks.push(field.name),
                    Some(value) if *value == default(field) => {}
                    Some(value) => differs.push(format!("{}={value}", field.name)),
                }
            }
            let count = own.as_object().map_or(0, |own| own.len());
            assert_eq!(count + lacks.len(), fields.len(), "{} {}", case.name(), variant.name);
            vec![variant.name.into(), differs.join(" "), lacks.join(" ")]
        };
        let heads = |heads: &[&str]| vec![heads.iter().map(ToString::to_string).collect()];
        let mut settings: Vec<Vec<String>> = heads(&["setting", "default", "range", ""]);
        settings.extend(fields.iter().map(setting));
        let mut variants: Vec<Vec<String>> = heads(&["variant", "differs", "lacks"]);
        variants.extend(case.variants().iter().map(variant));
        let text = format!("{}\n{}", table(&settings), table(&variants));
        assert_kept(&format!("settings.{}", case.name()), &text, false);
    }
}

/// Every group of metrics in a snapshot has a gate that is no regression, or a bound above.
#[test]
fn every_snapshot_has_a_physical_bound_beside_it() {
    let plans =
        |case: &dyn Case| [Tier::Quick, Tier::Full].map(|tier| plan::of_case(case, tier)).concat();
    let gated = |gates: &[Gate]| -> BTreeSet<String> {
        let physical = gates.iter().filter(|gate| gate.evidence != Evidence::Regression);
        physical.map(|gate| group(&gate.metric).to_string()).collect()
    };
    let gates_of = |case: &&dyn Case| -> Vec<Gate> {
        plans(*case).into_iter().flat_map(|planned| planned.gates).collect()
    };
    let channels =
        ["couette", "poiseuille"].map(|name| touchstone_cases::find(name).expect("a case"));
    let of_channels = gated(&channels.iter().flat_map(gates_of).collect::<Vec<_>>());
    for case in touchstone_cases::CASES {
        let name = case.name();
        let is_channel = channels.iter().any(|channel| channel.name() == name);
        let mut bounded = if is_channel { of_channels.clone() } else { gated(&gates_of(case)) };
        bounded.extend(bounds_beside(name).into_iter().map(|(group, _, _)| group.to_string()));
        let kept = kept_numbers(name);
        let metrics = kept.values().flat_map(BTreeMap::keys);
        let unbounded: BTreeSet<&str> =
            metrics.map(|m| group(m)).filter(|group| !bounded.contains(*group)).collect();
        assert!(unbounded.is_empty(), "{name} snapshots {unbounded:?}, and nothing bounds them");
        for gate in gates_of(case) {
            let is_bounded = bounded.contains(group(&gate.metric));
            assert!(is_bounded, "{} stands on what was computed before alone", gate.id);
        }
    }
}

#[test]
fn gates_have_names_of_their_own() {
    for tier in [Tier::Quick, Tier::Full] {
        let plans = touchstone_cases::CASES.iter().flat_map(|case| plan::of_case(*case, tier));
        let gates: Vec<Gate> = plans.flat_map(|planned| planned.gates).collect();
        assert!(gates.len() > 80, "{}", gates.len());
        let mut names = BTreeSet::new();
        for gate in &gates {
            gate.check().expect("a sound gate");
            assert!(names.insert(&gate.id), "two gates are called {}", gate.id);
        }
    }
}

/// Metrics and work have a file each: a change of one cannot be accepted within the other.
#[test]
fn results_and_work_are_kept_apart() {
    let mut count = 0;
    for case in touchstone_cases::CASES {
        let (results, work) = (kept_numbers(case.name()), kept_work(case.name()));
        let runs = |(variants, names): Kept| {
            let of = move |variant: &str| -> Vec<_> {
                names.iter().map(|name| (variant.to_string(), name.to_string())).collect()
            };
            variants.into_iter().flat_map(of)
        };
        let runs: BTreeSet<(String, String)> =
            kept(case.name()).into_iter().flat_map(runs).collect();
        for (file, kept) in [("results", &results), ("work", &work)] {
            assert!(runs.iter().eq(kept.keys()), "{file} of {}: {:?}", case.name(), kept.keys());
        }
        const WORK: [&str; 3] = ["pair_interactions", "particle_rhs", "steps"];
        for (run, numbers) in &work {
            assert!(numbers.keys().eq(WORK), "{} {run:?} holds {numbers:?}", case.name());
        }
        let is_work = |name: &String| WORK.contains(&name.as_str());
        assert!(!results.values().flat_map(BTreeMap::keys).any(is_work), "{}", case.name());
        count += runs.len();
    }
    assert!(count > 100, "only {count} runs have snapshots");
    let changed = ["couette", "work.couette", "work.cavity"].map(String::from);
    let [both, none] = [&changed[..], &changed[..0]].map(told);
    let parts = "metrics changed of couette; work changed of work.couette, work.cavity";
    assert!(both.starts_with(parts), "{both}");
    assert!(none.starts_with("metrics changed of none; work changed of none"), "{none}");
}

/// The comparison itself: accepted and refused differences.
#[test]
fn a_change_is_seen_and_round_off_is_not() {
    let are = Close::are;
    assert!(are("l2 [-] | 0.1 | 3\n", "l2 [-]   | 0.10000005 | 3\n"));
    assert!(!are("l2 | 0.1", "l2 | 0.1000002"));
    assert!(are("v | 1e-14", "v | -3e-11") && !are("v | 1e-9", "v | 2e-9"));
    assert!(are("v_error | 1e-9", "v_error | 2e-9"));
    assert!(!are("steps | 100", "steps | 101") && !are("steps | 100", "steps | 100.0"));
    assert!(!are("l2 | 0.1", "l2 | NaN") && !are("l2 | 0.1", "l2 | absent"));
    assert!(are("l2 | NaN", "l2 | NaN") && !are("a | 0.1", "a | 0.1\nb | 0.1"));
    assert!(!are("u [m/s] | 0.1", "u [V] | 0.1") && !are("a | 0.1", "a | 0.1 | 0.1"));
    assert!(!are("profiles a | u [m/s] | 0.1", "profiles a | u [V] | 0.1"));
    assert!(!are("profiles a | u [V] | 0.1", "profiles a | u [V] | 0.11"));
}
