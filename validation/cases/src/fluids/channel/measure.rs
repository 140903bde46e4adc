//! Metrics of a channel flow, each norm with its formula.

use touchstone_base::{
    absent::Absent,
    functions::cos,
    record::{self, ColumnKey, Profile, Record},
    settings,
};
use touchstone_harness::snapshot::{Point, Snapshot};
use touchstone_maths::metrics::{
    curve::slope_at_zero,
    norms::{l2, linf},
};
use touchstone_solver::EquationOfState;

use super::{ChannelSettings, ChannelSetup};

/// Times from which the "worst" norm counts, νt/L²: before, a start-up boundary layer is thinner
/// than a few spacings.
const WORST_FROM: f64 = 0.1;

touchstone_base::metrics! {
    all ALL;
    // Relative error of the velocity; at a νt/L².
    L2 = "l2" ["-"] "rms(u - u_exact)/rms(u_exact) over particles";
    LINF = "linf" ["-"] "max|u - u_exact|/V over particles";
    // Error of the slope at the lower and at the upper wall; at a νt/L².
    SHEAR_LOWER = "shear_lower" ["-"] "(wall slope - exact)/(V/L), parabola fitted within 3 dx of the wall";
    SHEAR_UPPER = "shear_upper" ["-"] "(wall slope - exact)/(V/L), parabola fitted within 3 dx of the wall";
    // The largest [`L2`] once the boundary layer of the start is resolved.
    L2_WORST = "l2_worst" ["-"] "largest l2 over the times of comparison with nu t/L^2 >= 0.1";
    // Cross-flow.
    V_RMS = "v_rms" ["-"] "rms(v)/V at the end, exactly 0 in the flow";
    // Pressure.
    P_RMS = "p_rms" ["-"] "rms(p - mean)/(rho V^2) at the end, exactly 0 in the flow";
    // Change of volume.
    VOLUME_DRIFT = "volume_drift" ["-"] "sum(m/rho)/sum(m/rho0) - 1 at the end";
    // Momentum across the channel.
    MOMENTUM_Y = "momentum_y" ["-"] "sum(m v)/(sum(m) V) at the end";
    // Particles beyond a plate.
    OUTSIDE = "outside" ["-"] "particles beyond the plates at the end";
}

/// Compares the particles of the fluid with the exact flow at νt/L² = `tau` and adds metrics `name@tau` and a
/// profile.
pub fn compare(setup: &ChannelSetup, fluid: &[Point], tau: f64, record: &mut Record) {
    let t = setup.time(tau);
    let u: Vec<f64> = fluid.iter().map(|p| p.velocity.x).collect();
    let exact: Vec<f64> = fluid.iter().map(|p| setup.exact(p.position.y, t)).collect();
    let particle_l2 = l2(&u, &exact);
    record.put(L2.at(tau), particle_l2);
    record.put(LINF.at(tau), linf(&u, &exact, setup.v));
    record.put(SHEAR_LOWER.at(tau), shear_error(setup, fluid, 0, t));
    record.put(SHEAR_UPPER.at(tau), shear_error(setup, fluid, 1, t));
    record.profiles.insert(record::marked(PROFILE, tau), row_profile(setup, fluid, t));
    if tau >= WORST_FROM {
        let so_far = record.value(L2_WORST).unwrap_or(0.0);
        // NaN must stay: max() would drop it.
        let worst = if particle_l2 > so_far || particle_l2.is_nan() { particle_l2 } else { so_far };
        record.put(L2_WORST, worst);
    }
}

/// Name of the profiles without their times.
const PROFILE: &str = "u";
/// Distance of a row from the lower plate.
pub const Y: ColumnKey = ColumnKey::new(PROFILE, "y", "m");
/// Mean velocity of a row.
pub const U: ColumnKey = ColumnKey::new(PROFILE, "u", "m/s");
/// Exact velocity at this distance.
pub const U_EXACT: ColumnKey = ColumnKey::new(PROFILE, "u_exact", "m/s");

/// The profile at νt/L² = `tau`.
pub fn profile_at(record: &Record, tau: f64) -> Option<&Profile> {
    record.profiles.get(&record::marked(PROFILE, tau))
}

/// The velocity across a channel at all times of a record; `None` without a channel.
pub fn velocities(record: &Record) -> Option<Profile> {
    let settings: ChannelSettings = settings::of_json(&record.run.settings).ok()?;
    let at = |tau: f64| Some((tau * settings.unit_of_time(), profile_at(record, tau)?));
    let profiles: Vec<(f64, &Profile)> = settings.compared().into_iter().filter_map(at).collect();
    let column = |name: &str| -> Vec<f64> {
        profiles.iter().flat_map(|(_, of)| of.column(name)).copied().collect()
    };
    let times = profiles.iter().flat_map(|(time, of)| of.column(Y.name).iter().map(|_| *time));
    let all = Profile::default().with("t", "s", times.collect());
    let columns = [Y, U, U_EXACT].into_iter();
    let all = columns.fold(all, |all, key| all.with(key.name, key.unit, column(key.name)));
    (!profiles.is_empty()).then_some(all)
}

/// Measures that need the end of the run only.
pub fn at_the_end(setup: &ChannelSetup, end: &Snapshot, record: &mut Record) {
    let fluid = end.moving();
    let count = fluid.len() as f64;
    let mean = |f: &dyn Fn(&Point) -> f64| fluid.iter().map(f).sum::<f64>() / count;
    let rms = |f: &dyn Fn(&Point) -> f64| mean(&|p| f(p) * f(p)).sqrt();
    let (s, v, eos) = (&setup.settings, setup.v, setup.medium.eos);
    record.put(V_RMS, rms(&|p| p.velocity.y) / v);
    let pressure_rms = end.density().map(|density| {
        let pressure = |p: &Point| eos.pressure(density.of(p)) - eos.background;
        let mean_pressure = mean(&pressure);
        rms(&|p| pressure(p) - mean_pressure) / (s.rho * v * v)
    });
    record.put_or_absent(P_RMS, pressure_rms);
    let initial: f64 = fluid.iter().map(|p| p.mass / s.rho).sum();
    let drift = end.density().map(|density| {
        let volume: f64 = fluid.iter().map(|p| p.mass / density.of(p)).sum();
        volume / initial - 1.0
    });
    record.put_or_absent(VOLUME_DRIFT, drift);
    let momentum: f64 = fluid.iter().map(|p| p.mass * p.velocity.y).sum();
    record.put(MOMENTUM_Y, momentum / (initial * s.rho * v));
    let outside = fluid.iter().filter(|p| !(0.0..=s.width).contains(&p.position.y)).count();
    record.put(OUTSIDE, outside as f64);
}

/// Means over the rows of the initial lattice: y, u and the exact u there.
fn row_profile(setup: &ChannelSetup, fluid: &[Point], t: f64) -> Profile {
    let mean = |row: &[Point], of: &dyn Fn(&Point) -> f64| {
        row.iter().map(of).sum::<f64>() / row.len() as f64
    };
    let rows: Vec<&[Point]> = fluid.chunks(setup.columns).collect();
    Profile::default()
        .put(&rows, Y.name, Y.unit, |row| mean(row, &|p| p.position.y))
        .put(&rows, U.name, U.unit, |row| mean(row, &|p| p.velocity.x))
        .put(&rows, U_EXACT.name, U_EXACT.unit, |row| mean(row, &|p| setup.exact(p.position.y, t)))
}

/// Error of the slope of u at a wall \[V/L\]: u = u_w + a d + b d² is fitted to the particles within 3 dx of
/// the wall, and to the exact flow at the same points, so that the error of the fit cancels.
fn shear_error(setup: &ChannelSetup, fluid: &[Point], wall: usize, t: f64) -> f64 {
    let s = &setup.settings;
    let speed = if wall == 1 { setup.plate_speed() } else { 0.0 };
    let depth = |p: &Point| if wall == 1 { s.width - p.position.y } else { p.position.y };
    let near: Vec<&Point> = fluid.iter().filter(|p| depth(p) < 3.0 * setup.medium.dx).collect();
    let slope = |velocity: &dyn Fn(&Point) -> f64| {
        slope_at_zero(near.iter().map(|p| (depth(p), velocity(p) - speed)))
    };
    let error = slope(&|p| p.velocity.x) - slope(&|p| setup.exact(p.position.y, t));
    error * s.width / setup.v
}

/// How much of the end the pressure mode is kept of \[L/c0\].
pub const WINDOW: f64 = 60.0;
/// Time since the end; the pressure mode is missing if the run was over before the window was full.
pub const MODE_TIME: ColumnKey = ColumnKey::new("mode", "t", "L/c0");
/// Amplitude of the pressure mode.
pub const MODE: ColumnKey = ColumnKey::new("mode", "amplitude", "rho V^2");

/// Amplitude \[ρV²\] of the lowest pressure mode cos(πy/L), which is 0 in the exact flow: the waves of
/// hypothesis H3.
///
/// # Errors
/// Without densities.
pub fn pressure_mode(setup: &ChannelSetup, now: &Snapshot) -> Result<f64, Absent> {
    let ChannelSetup { settings: s, medium, v, .. } = setup;
    let (mut mode, mut count) = (0.0, 0.0);
    let density = now.density()?;
    for p in now.stored() {
        let phase = std::f64::consts::PI * p.position.y / s.width;
        mode += 2.0 * medium.eos.pressure(density.of(&p)) / (s.rho * v * v) * cos(phase);
        count += 1.0;
    }
    Ok(mode / count)
}

/// Puts the last [`WINDOW`] of the times \[s\] and amplitudes after every step, of a run that ended at
/// `end` \[s\].
pub fn last_of_mode(setup: &ChannelSetup, series: &[[f64; 2]], end: f64, record: &mut Record) {
    let crossing = setup.settings.width / setup.medium.eos.sound_speed;
    let since_end = |t: f64| (t - end) / crossing;
    if since_end(0.0) > -WINDOW {
        return;
    }
    let all = series.iter().map(|[t, amplitude]| [since_end(*t), *amplitude]);
    let rows: Vec<[f64; 2]> = all.filter(|[t, _]| *t >= -WINDOW).collect();
    record.put_column(MODE_TIME, &rows, |[t, _]| *t);
    record.put_column(MODE, &rows, |[_, amplitude]| *amplitude);
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use touchstone_harness::{method::Method, problem::Problem};
    use touchstone_solver::{Particle, Role};

    use touchstone_base::record::{MetricName, Record};

    use super::*;
    use crate::fluids::channel::{ChannelSettings, Flow};

    fn method() -> Method {
        touchstone_schemes::flow::couette().seed
    }

    fn setup(flow: Flow) -> ChannelSetup {
        let settings = ChannelSettings { watch_mode: true, ..ChannelSettings::default() };
        ChannelSetup::new(flow, &settings, &method()).expect("the defaults are valid")
    }

    /// The record of 20 rows whose velocity is this function of y \[m\] and t \[s\], compared at `tau`.
    fn compared(setup: &ChannelSetup, tau: f64, velocity: &dyn Fn(f64, f64) -> f64) -> Record {
        let mut fluid = setup.rows(0.5 * setup.medium.dx, 20);
        let t = setup.time(tau);
        fluid.iter_mut().for_each(|p| p.velocity.x = velocity(p.position.y, t));
        let mut record = Record::new(setup.flow.case().name, "seed", serde_json::Value::Null, 1);
        compare(setup, &Snapshot::of(t, &fluid).all(), tau, &mut record);
        record
    }

    fn assert_near(record: &Record, metric: MetricName, exact: f64, tolerance: f64) {
        let (name, found) = (metric.name.clone(), record.value(metric).expect("measured"));
        assert!((found - exact).abs() < tolerance, "{name}: {found} is not {exact}");
    }

    #[test]
    fn errors_that_are_put_in_are_measured() {
        for flow in [Flow::Couette, Flow::Poiseuille] {
            let setup = setup(flow);
            let (width, v) = (setup.settings.width, setup.v);
            let exact = |y: f64, t: f64| setup.exact(y, t);
            let none = compared(&setup, 0.1, &exact);
            for metric in [L2, LINF, SHEAR_LOWER, SHEAR_UPPER] {
                assert_near(&none, metric.at(0.1), 0.0, 1e-12);
            }
            let [u, exact_u] =
                [U, U_EXACT].map(|key| profile_at(&none, 0.1).expect("put").column(key.name));
            assert!(u.len() == 20 && u.iter().zip(exact_u).all(|(u, e)| (u - e).abs() < 1e-9 * v));
            let faster = compared(&setup, 0.1, &|y, t| 1.02 * exact(y, t));
            assert_near(&faster, L2.at(0.1), 0.02, 1e-9);
            assert_near(&faster, L2_WORST.into(), 0.02, 1e-9);
            // Before 0.1 the layer of the start is too thin to count.
            assert_eq!(compared(&setup, 0.05, &exact).value(L2_WORST), None);
            let shifted = compared(&setup, 0.1, &|y, t| exact(y, t) + 0.01 * v);
            assert_near(&shifted, LINF.at(0.1), 0.01, 1e-9);
            // 0.02 V y (L - y)/L^2 has the slope 0.02 V/L at either wall, in the direction away from it.
            let bent = |y: f64, t: f64| exact(y, t) + 0.02 * v * y * (width - y) / width.powi(2);
            let bent = compared(&setup, 0.1, &bent);
            assert_near(&bent, SHEAR_LOWER.at(0.1), 0.02, 1e-9);
            assert_near(&bent, SHEAR_UPPER.at(0.1), 0.02, 1e-9);
        }
    }

    #[test]
    fn what_should_be_zero_at_the_end_is_measured() {
        let setup = setup(Flow::Poiseuille);
        let (rho, v, eos) = (setup.settings.rho, setup.v, setup.medium.eos);
        let mut fluid = setup.rows(0.5 * setup.medium.dx, 20);
        let count = fluid.len() as f64;
        let set = |(k, p): (usize, &mut Particle)| {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            p.velocity.y = 0.02 * v + 0.03 * v * sign;
            p.density = eos.density(0.04 * sign * rho * v * v + eos.background);
        };
        fluid.iter_mut().enumerate().for_each(set);
        fluid[0].position.y = -1e-9;
        let volume: f64 = fluid.iter().map(|p| p.mass / p.density).sum();
        let mut record = Record::new("poiseuille", "seed", serde_json::Value::Null, 1);
        at_the_end(&setup, &Snapshot::of(1.0, &fluid), &mut record);
        assert_near(&record, V_RMS.into(), (0.02_f64.powi(2) + 0.03_f64.powi(2)).sqrt(), 1e-9);
        assert_near(&record, P_RMS.into(), 0.04, 1e-5);
        assert_near(&record, MOMENTUM_Y.into(), 0.02, 1e-5);
        assert_near(&record, OUTSIDE.into(), 1.0, 1e-9);
        let exact = volume / (count * setup.medium.dx.powi(2)) - 1.0;
        assert_near(&record, VOLUME_DRIFT.into(), exact, 1e-9);
    }

    #[test]
    fn the_pressure_mode_is_that_of_the_particles_and_its_end_is_kept() {
        let setup = setup(Flow::Poiseuille);
        let (s, v, eos) = (&setup.settings, setup.v, setup.medium.eos);
        let mut parts = setup.scene().expect("a scene");
        for p in parts.particles.iter_mut().filter(|p| p.role == Role::Fluid) {
            p.velocity = Vector2::new(0.7 * v, 0.02 * v);
            let mode = cos(std::f64::consts::PI * p.position.y / s.width);
            p.density = eos.density(0.05 * s.rho * v * v * mode + eos.background);
        }
        let now = Snapshot::of(0.0, &parts.particles);
        let amplitude = pressure_mode(&setup, &now).expect("densities");
        assert!((amplitude - 0.05).abs() < 1e-4, "{amplitude}");
        // A sample in every crossing of the channel by sound: the last 60 and the end are kept.
        let crossing = s.width / eos.sound_speed;
        let series: Vec<_> = (0..=100).map(|k| [f64::from(k) * crossing, f64::from(k)]).collect();
        let until = |end: f64| {
            let mut record = Record::default();
            last_of_mode(&setup, &series, end * crossing, &mut record);
            record
        };
        let last = until(100.001);
        assert_eq!(last.column(MODE).first(), Some(&41.0));
        assert!((last.column(MODE_TIME)[0] + 59.001).abs() < 1e-9);
        assert!(until(59.0).profiles.is_empty());
    }
}
