//! Runs of made-up motion, whose measures are known.

use std::f64::consts::TAU;

use approx::assert_abs_diff_eq;
use nalgebra::Vector2;
use touchstone_base::{
    functions::exp,
    record::{ColumnKey, MetricName, Record, Status},
};
use touchstone_harness::{case::Case, context::Context, snapshot::Snapshot};
use touchstone_solver::{Particle, Symmetric};

use super::{
    RUBBER_RINGS, RingSettings,
    columns::{HEIGHT, PLACE, TIME, VELOCITY, WIDTH},
    measure::{self, RingHistory},
    metrics::{
        CONTACT_BEGIN_ERROR, CONTACT_END_ERROR, ENERGY_GAINED, ENERGY_LOST, HEIGHT_MAX,
        HEIGHT_MAX_ERROR, HOLES_LEAST, IMPULSE, IMPULSE_ERROR, MOMENTUM, PHASES, RESTITUTION,
        RESTITUTION_ERROR, RMS, STRETCH_MOST, T_IMPULSE_1, T_IMPULSE_99, WIDTH_MIN,
        WIDTH_MIN_ERROR, X_C_WORST, phase,
    },
    reference::RingReference,
};
use crate::solids::solid::{self, ElasticBody};

/// Coarse rings that fly at 0.06 c0.
fn settings() -> RingSettings {
    RingSettings { spacing: 0.25, speed: 0.06, ..RingSettings::default() }
}

/// The metrics of rings with this centre, its velocity, width and height \[L, c0\] at each time \[L/c0\],
/// four times in a unit of time.
fn measured(settings: &RingSettings, motion: impl Fn(f64) -> [f64; 4]) -> Record {
    let (start, dx) = (settings.particles(), settings.dx());
    let first = Snapshot::of(0.0, &start);
    let [_, _, extent] = measure::side(&first.all()[start.len() / 2..], dx);
    let mut series = RingHistory::new(settings, &first, &first);
    for k in 1..=(4.0 * settings.end) as usize {
        let time = 0.25 * k as f64;
        let [x, v, width, height] = motion(time);
        let stretch = [(width - dx) / (extent.x - dx), (height - dx) / (extent.y - dx)];
        let mut particles = start.clone();
        for p in &mut particles {
            let side = p.position.x.signum();
            p.position.x = side * (x + (p.position.x.abs() - settings.centre) * stretch[0]);
            p.position.y *= stretch[1];
            p.velocity.x = side * v;
        }
        series.sample(settings, &Snapshot::of(time / settings.c0(), &particles));
    }
    let mut record = Record::new("rubber_rings", "made-up", serde_json::Value::Null, 1);
    series.put(settings, &mut record);
    record
}

fn value(record: &Record, metric: impl Into<MetricName>) -> f64 {
    let metric = metric.into();
    let value = record.metric(&metric.name);
    value.unwrap_or_else(|| panic!("{} is absent: {:?}", metric.name, record.absent))
}

/// Two phases of constant force, from 20 to 40 and from 60 to 100 L/c0; flattest at 70 L/c0.
fn two_phases(time: f64) -> [f64; 4] {
    let pushes = [(20.0, 40.0, 0.0015), (60.0, 100.0, 0.001875)];
    let (mut x, mut v) = (5.0 - 0.06 * time, -0.06);
    for (from, to, force) in pushes {
        let (pushed, since) = ((time.min(to) - from).max(0.0), (time - to).max(0.0));
        v += force * pushed;
        x += force * pushed * (0.5 * pushed + since);
    }
    let z = (time - 70.0) / 20.0;
    let flat = exp(-z * z);
    [x, v, 8.0 - 3.0 * flat, 8.0 + 2.0 * flat]
}

#[test]
fn a_known_motion_has_known_measures() {
    let record = measured(&settings(), two_phases);
    let mass = std::f64::consts::PI * 7.0;
    let expected = [
        (RESTITUTION.into(), 0.75),
        (WIDTH_MIN.into(), 5.0),
        (HEIGHT_MAX.into(), 10.0),
        (ENERGY_LOST.into(), 0.4375),
        (ENERGY_GAINED.into(), 0.0),
        (PHASES.into(), 2.0),
        (HOLES_LEAST.into(), 1.0),
        (IMPULSE.at(phase(0)), mass * 0.03),
        (IMPULSE.at(phase(1)), mass * 0.075),
        (T_IMPULSE_1.at(phase(0)), 20.2),
        (T_IMPULSE_99.at(phase(0)), 39.8),
        (T_IMPULSE_1.at(phase(1)), 60.4),
        (T_IMPULSE_99.at(phase(1)), 99.6),
    ];
    let expected: [(MetricName, f64); 13] = expected;
    for (metric, known) in expected {
        assert_abs_diff_eq!(value(&record, metric), known, epsilon = 1e-9);
    }
}

#[test]
fn a_ring_that_grows_by_a_quarter_is_stretched_by_a_quarter() {
    let short = RingSettings { end: 10.0, ..settings() };
    let of = |factor: f64| {
        let record = measured(&short, |t| {
            let size = 8.0 * if t > 5.0 { factor } else { 1.0 };
            let dx = short.spacing;
            [5.0, -0.06, (size - dx) + dx, size]
        });
        value(&record, STRETCH_MOST)
    };
    let (start, grown) = (of(1.0), of(1.25));
    // Extents have half a spacing on either side that does not grow.
    let stretch = (10.0 - 0.25) / (8.0 - 0.25);
    assert!((1.1..=1.2).contains(&start), "{start} dx");
    assert_abs_diff_eq!(grown / start, stretch, epsilon = 1e-3);
}

/// Rings at 0.01 c0 had a restitution, 0.54, though they still pushed each other at the end of the run.
#[test]
fn rings_that_still_touch_at_the_end_have_no_restitution() {
    let record = measured(&RingSettings { end: 90.0, ..settings() }, two_phases);
    assert_eq!(record.value(RESTITUTION), None);
    assert_eq!(record.absent["restitution"].to_string(), "the rings still touch at the end");
    assert!(record.value(IMPULSE.at(phase(0))).is_some());
    for metric in [IMPULSE, T_IMPULSE_1, T_IMPULSE_99] {
        let metric = metric.at(phase(1));
        assert!(record.metric(&metric.name).is_none() && record.absent.contains_key(&metric.name));
    }
    let never = measured(&RingSettings { end: 15.0, ..settings() }, two_phases);
    assert_eq!(never.absent["restitution"].to_string(), "the rings never touch");
    // The force of round-off was the largest, and so a phase of contact.
    let noisy = |time: f64| [5.0 - 0.06 * time, -0.06 + 1e-13 * (time % 1.0), 8.0, 8.0];
    let never = measured(&RingSettings { end: 15.0, ..settings() }, noisy);
    assert_eq!(value(&never, PHASES), 0.0);
    let still = RingSettings { end: 5.0, speed: 0.0, ..settings() };
    let record = measured(&still, |_| [5.0, 0.0, 8.0, 8.0]);
    assert_eq!(record.absent["energy_gained"].to_string(), "the rings are at rest at the start");
}

/// Finite elements at a time, moved by some L/c0.
fn finite_elements(speed: f64, late: f64) -> impl Fn(f64) -> [f64; 4] {
    let exact = RingReference::of("seed", &RingSettings { speed, ..RingSettings::default() });
    let exact = exact.expect("a reference");
    move |time| {
        let place = ((time - late) / 0.5).clamp(0.0, 400.0);
        let (k, part) = (place as usize, place.fract());
        [&exact.place, &exact.velocity, &exact.width, &exact.height].map(|history| {
            let [a, b] = [k, (k + 1).min(400)].map(|k| history[k].1);
            a + part * (b - a)
        })
    }
}

#[test]
fn a_run_that_is_finite_elements_has_no_distance_from_them() {
    for speed in [0.059, 0.03] {
        let settings = RingSettings { speed, ..settings() };
        let record = measured(&settings, finite_elements(speed, 0.0));
        let mut small: Vec<(MetricName, f64)> = vec![
            (RESTITUTION_ERROR.into(), 1e-3),
            (WIDTH_MIN_ERROR.into(), 1e-3),
            (HEIGHT_MAX_ERROR.into(), 1e-3),
            (X_C_WORST.into(), 1e-3),
        ];
        small.extend(RMS.map(|rms| (rms.into(), 1e-3)));
        for k in [0, 1] {
            // Their samples are 0.5 L/c0 apart.
            small.push((CONTACT_BEGIN_ERROR.at(phase(k)), 0.25));
            small.push((CONTACT_END_ERROR.at(phase(k)), 0.25));
            small.push((IMPULSE_ERROR.at(phase(k)), 3e-3));
        }
        for (metric, most) in small {
            let error = value(&record, metric.clone());
            assert!(error.abs() <= most, "{} at {speed}: {error}", metric.name);
        }
    }
}

/// A contact of 10 to 20 L/c0 too long and a centre 0.95 L off must appear in metrics.
#[test]
fn a_run_that_is_late_has_errors_with_their_sign() {
    let settings = RingSettings { speed: 0.059, ..settings() };
    let record = measured(&settings, finite_elements(0.059, 4.0));
    for k in [0, 1] {
        for metric in [CONTACT_BEGIN_ERROR, CONTACT_END_ERROR] {
            let late = value(&record, metric.at(phase(k)));
            assert!((late - 4.0).abs() < 0.25, "phase {k}: {late}");
        }
    }
    // On the way in it is ahead by 4 L/c0 of its speed, which is more than it is behind on the way out.
    let worst = value(&record, X_C_WORST);
    assert!(
        (worst - 4.0 * 0.059).abs() < 4.0 * 5e-4,
        "worst x_c: expected 0.236 L, it is {worst} L"
    );
}

#[test]
fn reach_is_when_finite_elements_leave() {
    let exact = RingReference::of("seed", &RingSettings::default()).expect("a reference");
    let leaves = exact.leaves(0.1);
    assert!((leaves - 126.0).abs() <= 0.5, "near until 126 L/c0, found {leaves}");
    assert!(exact.leaves(0.2) > leaves);
}

/// A run and its record, however it ends.
fn run(variant: &str, set: fn(&mut RingSettings)) -> Record {
    let spec = RUBBER_RINGS.spec(variant, set).allow_unstable();
    RUBBER_RINGS.run(&spec, &Context::default()).expect("a run")
}

/// Largest difference of a column of the series.
fn apart(a: &Record, b: &Record, column: ColumnKey) -> f64 {
    let [a, b] = [a, b].map(|record| record.column(column));
    assert!(a.len() == b.len() && a.len() > 10, "{column:?}: {} and {} samples", a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Neither at rest, where nothing rounds, nor in flight 9000 L away, where every step does.
#[test]
fn rings_that_nothing_acts_on_keep_their_shape() {
    let set = [
        |s: &mut RingSettings| (s.spacing, s.centre, s.speed, s.end) = (0.5, 9000.0, 0.0, 2e3),
        |s: &mut RingSettings| (s.spacing, s.centre, s.speed, s.end) = (0.5, 9000.0, 0.02, 2e3),
    ];
    for set in set {
        let record = run("seed", set);
        for column in [WIDTH, HEIGHT] {
            let found = record.column(column);
            assert!(found.iter().all(|x| (x - found[0]).abs() < 1e-9), "{column:?}: {found:?}");
        }
    }
}

/// Only K has a unit of stress, so motion in units of L and c0 is equal up to round-off.
#[test]
fn rings_that_are_a_hundred_times_as_stiff_move_alike() {
    let soft = run("leapfrog", |s| (s.spacing, s.end) = (0.33, 80.0));
    let stiff = run("leapfrog", |s| (s.spacing, s.end, s.bulk_modulus) = (0.33, 80.0, 100.0));
    for column in [TIME, PLACE, VELOCITY, WIDTH, HEIGHT] {
        let apart = apart(&soft, &stiff, column);
        assert!(apart < 1e-10, "{column:?}: {apart:e}");
    }
}

/// Half the speed of sound is far beyond the range of rubber and (12).
#[test]
fn rings_at_half_the_speed_of_sound_keep_their_momentum_or_diverge() {
    let record = run("seed", |s| (s.spacing, s.speed, s.end) = (0.2, 0.5, 30.0));
    match record.status {
        Status::Completed => assert!(value(&record, MOMENTUM) < 1e-12),
        status => assert!(matches!(status, Status::Diverged { .. }), "{status:?}"),
    }
}

#[test]
fn mass_is_exact_and_rings_are_mirror_images() {
    let rings = RingSettings::default();
    let particles = rings.particles();
    let mass: f64 = particles.iter().map(|p| p.mass).sum();
    assert!((mass / (TAU * 7.0) - 1.0).abs() < 1e-12, "{mass}");
    let (left, right) = particles.split_at(particles.len() / 2);
    for (l, r) in left.iter().zip(right) {
        assert_eq!((l.position.x, l.position.y), (-r.position.x, r.position.y));
        assert_eq!((l.velocity.x, l.mass), (-r.velocity.x, r.mass));
    }
    let mirrored = |p: &Particle<Symmetric>| {
        left.iter().any(|q| q.position == Vector2::new(p.position.x, -p.position.y))
    };
    assert!(left.iter().all(mirrored));
    assert_eq!(rings.dx(), 0.1);
}

#[test]
fn settings_that_make_no_rings_are_refused() {
    let refused = |set| {
        let error = solid::tests::refused(&RUBBER_RINGS, "leapfrog", set);
        error.unwrap_or_else(|| panic!("{set} is not refused")).to_string()
    };
    assert!(refused("centre=3.9").contains("outer radius"));
    assert!(refused("inner=3.9").contains("inner radius"));
    assert!(refused("dt=1").contains("theoretical limit"));
    assert!(refused("dt=1e-12").contains("time steps"));
}
