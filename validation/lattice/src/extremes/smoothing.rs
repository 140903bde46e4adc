//! Smoothing lengths from too short to too long: long waves against the symbols of the lattice.

use std::f64::consts::TAU;

use solver::{CubicSpline, Kernel, QuinticSpline, WendlandC2};

use super::{EXTREMES, Experiment, ExtremeSettings, experiment::sci, record_of};
use crate::wave::{Polarisation, Wave, WaveSettings, fit, measure};
use base::{
    gate::{Bound, Evidence},
    record::{MetricKey, Record, Status, digest},
};
use harness::{
    bisect,
    case::{RunError, Tier},
    context::Context,
    extremes::Entry,
    method::Method,
    simulate::KERNEL,
};
use maths::theory::time_step::Integrator;

const SOUND: MetricKey =
    MetricKey::new("sound_factor", "-", "omega/(c0 k), time error divided out");
const VISCOUS: MetricKey =
    MetricKey::new("viscous_factor", "-", "gamma/(nu k^2), time error divided out");
const DISTANCE: MetricKey = MetricKey::new(
    "symbol_distance",
    "-",
    "larger of the distances of both factors from those of the lattice, relative",
);

/// Runs a sound wave and a shear wave.
pub fn run(
    method: &Method,
    variant: &str,
    settings: &ExtremeSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let ExtremeSettings { n, h_over_dx, .. } = *settings;
    let waves = WaveSettings { n, h_over_dx, nu: 0.01, span: 0.5, ..Default::default() };
    let mut record = record_of(variant, settings);
    let [mut found, mut theory] = [[f64::NAN; 2]; 2];
    let mut amplitudes = Vec::new();
    for (k, polarisation) in [Polarisation::Sound, Polarisation::Shear].into_iter().enumerate() {
        let wave = Wave::new(polarisation, &waves, method, context)?;
        // Both would write their frames into one folder.
        let context =
            if k == 0 { context.clone() } else { Context { frames: None, ..context.clone() } };
        let measured = measure(&wave, method, &context)?;
        let (series, unit) = (&measured.series, waves.nu * TAU * TAU);
        if k == 0 {
            let mode = fit::mode_of(series, Integrator::Leapfrog, wave.dt());
            found[k] = mode.map_or(f64::NAN, |mode| mode.omega / TAU);
            theory[k] = wave.sound.omega / TAU;
        } else {
            let gamma = fit::decay_of(series, Integrator::Leapfrog, wave.dt());
            found[k] = gamma.map_or(f64::NAN, |gamma| gamma / unit);
            theory[k] = wave.shear / unit;
        }
        amplitudes.extend_from_slice(series.as_flattened());
        bisect::add(&mut record.cost, &measured.cost);
        if measured.status != Status::Completed {
            record.status = measured.status;
            return Ok(record);
        }
    }
    let [sound, viscous] = [0, 1].map(|k| (found[k] / theory[k] - 1.0).abs());
    record.put(SOUND, found[0]);
    record.put(VISCOUS, found[1]);
    // NaN must stay: max() would drop it.
    record.put(DISTANCE, if sound < viscous || viscous.is_nan() { viscous } else { sound });
    record.numerics.insert(KERNEL.into(), method.kernel.into());
    record.state = Some(digest(&amplitudes));
    Ok(record)
}

/// The ratios of a tier.
pub fn lengths(tier: Tier) -> Vec<Experiment> {
    let all = [0.9, 1.0, 1.1, 1.2, 1.3, 1.5, 2.0, 2.5, 3.0];
    let ratios: &[f64] = if tier == Tier::Full { &all } else { &[0.9, 1.5, 3.0] };
    let kernels = [
        ("smoothing-cubic", CubicSpline::NAME),
        ("smoothing-quintic", QuinticSpline::NAME),
        ("smoothing-wendland", WendlandC2::NAME),
    ];
    let at = |ratio: &f64| kernels.map(|(variant, kernel)| smoothed(variant, kernel, *ratio));
    ratios.iter().flat_map(at).collect()
}

fn smoothed(variant: &str, kernel: &'static str, ratio: f64) -> Experiment {
    let spec = EXTREMES.spec(variant, |s| s.h_over_dx = ratio);
    Experiment::of(spec, 0.2, move |record| {
        let what = ["smoothing length".to_string(), format!("{}, h/dx = {ratio}", kernel)];
        let name = format!("smoothing.{}.{ratio}", kernel);
        let entry = Entry::new(&name, what, "distance from the symbols", Bound::Below(1e-3))
            .because(Evidence::Theory, "The symbols of the lattice are exact.");
        let [sound, viscous, distance] = [SOUND, VISCOUS, DISTANCE].map(|key| record.value(key));
        let found = match (sound, viscous) {
            (Some(sound), Some(viscous)) => format!(
                "sound factor {sound:.4}, viscous factor {viscous:.4}; off theory by {}",
                sci(distance)
            ),
            _ => record.status.to_string(),
        };
        entry.found(distance.unwrap_or(f64::NAN), found)
    })
}
