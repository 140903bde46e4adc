//! What is measured in a channel flow, each norm with its formula.

use nalgebra::Vector2;
use solver::{EquationOfState, Flow as Going, Observer, Particle, Role, Stepper};

use super::Setup;
use base::functions::cos;
use base::record::{MetricKey, Profile, Record};
use maths::metrics::{
    norms::{Scale, l2, linf},
    profile::{Field, interpolate},
};

/// Stations of the interpolated profile across the channel.
const STATIONS: usize = 41;

/// Times from which the "worst" norm counts, νt/L²: before, a start-up boundary layer is thinner
/// than a few spacings.
const WORST_FROM: f64 = 0.1;

base::metrics! {
    // Relative error of the velocity; at a νt/L².
    L2 = "l2" ["-"] "rms(u - u_exact)/rms(u_exact) over particles";
    LINF = "linf" ["-"] "max|u - u_exact|/V over particles";
    FIELD_L2 = "field_l2" ["-"] "rms(<u> - u_exact)/rms(u_exact), SPH field (1) at 41 stations";
}
const SHEAR: &str = "(wall slope - exact)/(V/L), parabola fitted within 3 dx of the wall";
/// Error of the slope at the lower wall; at a νt/L².
pub const SHEAR_LOWER: MetricKey = MetricKey::new("shear_lower", "-", SHEAR);
/// Error of the slope at the upper wall; at a νt/L².
pub const SHEAR_UPPER: MetricKey = MetricKey::new("shear_upper", "-", SHEAR);
base::metrics! {
    // The viscosity that the flow shows; at a νt/L².
    NU_EFF = "nu_eff" ["-"] "nu_eff/nu of the exact flow nearest in l2";
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

/// What is measured of a simulation: nothing here knows its scheme, so that it is compiled once.
pub struct Sample {
    /// The particles of the fluid in the order of the scene.
    fluid: Vec<Particle>,
    /// The interpolated velocity along the channel at the stations, if it can be had \[m/s\].
    field: Option<Vec<f64>>,
}

impl Sample {
    /// Reads a simulation.
    pub fn of(setup: &Setup, simulation: &dyn Stepper<()>) -> Self {
        let mut fluid = simulation.particles();
        fluid.retain(|p| p.role == Role::Fluid);
        let columns = simulation.plain_columns();
        let positions: Vec<_> = columns.iter().map(|c| c.position).collect();
        let volumes: Vec<_> = columns.iter().map(|c| c.common.volume).collect();
        let values: Vec<_> = columns.iter().map(|c| c.velocity.x).collect();
        let field = Field { positions: &positions, volumes: &volumes, values: &values };
        let field = interpolate(|r2| simulation.weight(r2), field, &stations(setup)).ok();
        Self { fluid, field }
    }
}

/// Compares with the exact flow at νt/L² = `tau` and adds metrics `name@tau` and a profile.
pub fn compare(setup: &Setup, sample: &Sample, tau: f64, record: &mut Record) {
    let t = setup.time(tau);
    let fluid = &sample.fluid;
    let u: Vec<f64> = fluid.iter().map(|p| p.velocity.x).collect();
    let exact: Vec<f64> = fluid.iter().map(|p| setup.exact(p.position.y, t)).collect();
    let rms = Scale::rms(&exact);
    let particle_l2 = rms.and_then(|rms| l2(&u, &exact, rms)).unwrap_or(f64::NAN);
    record.put(L2.at(tau), particle_l2);
    let max = Scale::new(setup.v).and_then(|v| linf(&u, &exact, v)).unwrap_or(f64::NAN);
    record.put(LINF.at(tau), max);
    record.put(FIELD_L2.at(tau), interpolated_l2(setup, sample, t));
    record.put(SHEAR_LOWER.at(tau), shear_error(setup, fluid, 0, t));
    record.put(SHEAR_UPPER.at(tau), shear_error(setup, fluid, 1, t));
    if depends_on_viscosity(setup, fluid, t) {
        record.put(NU_EFF.at(tau), fitted_viscosity(setup, fluid, t));
    }
    record.profiles.insert(profile_at(tau), row_profile(setup, fluid, t));
    if tau >= WORST_FROM {
        let so_far = record.value(L2_WORST).unwrap_or(0.0);
        // NaN must stay: max() would drop it.
        let worst = if particle_l2 > so_far || particle_l2.is_nan() { particle_l2 } else { so_far };
        record.put(L2_WORST, worst);
    }
}

/// Name of the profile at νt/L² = `tau`.
pub fn profile_at(tau: f64) -> String {
    format!("u@{tau}")
}

/// Measures that need the end of the run only.
pub fn at_the_end(setup: &Setup, sample: &Sample, record: &mut Record) {
    let fluid = &sample.fluid;
    let count = fluid.len() as f64;
    let mean = |f: &dyn Fn(&Particle) -> f64| fluid.iter().map(f).sum::<f64>() / count;
    let rms = |f: &dyn Fn(&Particle) -> f64| mean(&|p| f(p) * f(p)).sqrt();
    let (s, v) = (&setup.settings, setup.v);
    record.put(V_RMS, rms(&|p| p.velocity.y) / v);
    let pressure =
        |p: &Particle| setup.medium.eos.pressure(p.density) - setup.medium.eos.background;
    let mean_pressure = mean(&pressure);
    record.put(P_RMS, rms(&|p| pressure(p) - mean_pressure) / (s.rho * v * v));
    let volume: f64 = fluid.iter().map(|p| p.mass / p.density).sum();
    let initial: f64 = fluid.iter().map(|p| p.mass / s.rho).sum();
    record.put(VOLUME_DRIFT, volume / initial - 1.0);
    let momentum: f64 = fluid.iter().map(|p| p.mass * p.velocity.y).sum();
    record.put(MOMENTUM_Y, momentum / (initial * s.rho * v));
    let outside = fluid.iter().filter(|p| !(0.0..=s.width).contains(&p.position.y)).count();
    record.put(OUTSIDE, outside as f64);
}

/// Means over the rows of the initial lattice: y, u, the exact u there, v, p.
fn row_profile(setup: &Setup, fluid: &[Particle], t: f64) -> Profile {
    let rows = fluid.chunks(setup.columns);
    let mean = |f: &dyn Fn(&Particle) -> f64| -> Vec<f64> {
        rows.clone().map(|row| row.iter().map(f).sum::<f64>() / row.len() as f64).collect()
    };
    Profile::default()
        .with("y", "m", mean(&|p| p.position.y))
        .with("u", "m/s", mean(&|p| p.velocity.x))
        .with("u_exact", "m/s", mean(&|p| setup.exact(p.position.y, t)))
        .with("v", "m/s", mean(&|p| p.velocity.y))
        .with("p", "Pa", mean(&|p| setup.medium.eos.pressure(p.density)))
}

/// Stations across the middle of the section.
fn stations(setup: &Setup) -> Vec<Vector2<f64>> {
    let y = |k: usize| setup.settings.width * (k as f64 + 0.5) / STATIONS as f64;
    (0..STATIONS).map(|k| Vector2::new(0.5 * setup.length(), y(k))).collect()
}

/// Relative L2 error of the SPH interpolation (1) at the stations.
fn interpolated_l2(setup: &Setup, sample: &Sample, t: f64) -> f64 {
    let Some(u) = &sample.field else { return f64::NAN };
    let exact: Vec<f64> = stations(setup).iter().map(|s| setup.exact(s.y, t)).collect();
    Scale::rms(&exact).and_then(|rms| l2(u, &exact, rms)).unwrap_or(f64::NAN)
}

/// Error of the slope of u at a wall \[V/L\]: u = u_w + a d + b d² is fitted to the particles within
/// 3 dx of the wall, and to the exact flow at the same places, so that the fit itself cancels.
fn shear_error(setup: &Setup, fluid: &[Particle], wall: usize, t: f64) -> f64 {
    let s = &setup.settings;
    let speed = if wall == 1 { setup.plate_speed() } else { 0.0 };
    let depth = |p: &Particle| if wall == 1 { s.width - p.position.y } else { p.position.y };
    let near: Vec<&Particle> = fluid.iter().filter(|p| depth(p) < 3.0 * setup.medium.dx).collect();
    let slope = |velocity: &dyn Fn(&Particle) -> f64| {
        let (mut d2, mut d3, mut d4, mut du, mut d2u) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for p in &near {
            let (d, u) = (depth(p), velocity(p) - speed);
            d2 += d * d;
            d3 += d * d * d;
            d4 += d * d * d * d;
            du += d * u;
            d2u += d * d * u;
        }
        (du * d4 - d2u * d3) / (d2 * d4 - d3 * d3)
    };
    let error = slope(&|p| p.velocity.x) - slope(&|p| setup.exact(p.position.y, t));
    error * s.width / setup.v
}

/// Does the exact flow still show its viscosity? A change of ν by 2 % must move it by 0.1 %
/// (relative L2): steady Couette flow has the same profile whatever ν, and a fit to it would only
/// amplify other errors.
fn depends_on_viscosity(setup: &Setup, fluid: &[Particle], t: f64) -> bool {
    let nu = setup.settings.nu;
    let (mut moved, mut all) = (0.0, 0.0);
    for p in fluid {
        let u = [0.99, 1.0, 1.01]
            .map(|ratio| setup.exact_with_viscosity(p.position.y, t, ratio * nu) / setup.v);
        moved += (u[2] - u[0]).powi(2);
        all += u[1].powi(2);
    }
    moved >= 1e-6 * all
}

/// ν_eff/ν within a factor of 2 by golden section on the squared distance to the exact flow.
fn fitted_viscosity(setup: &Setup, fluid: &[Particle], t: f64) -> f64 {
    let distance = |ratio: f64| -> f64 {
        let nu = ratio * setup.settings.nu;
        let error = |p: &Particle| p.velocity.x - setup.exact_with_viscosity(p.position.y, t, nu);
        fluid.iter().map(|p| error(p).powi(2)).sum()
    };
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let at = |ratio: f64| (ratio, distance(ratio));
    let (mut low, mut high) = (0.5, 2.0);
    // The inner point that is kept is an inner point of the next interval.
    let (mut a, mut b) = (at(high - golden * (high - low)), at(low + golden * (high - low)));
    for _ in 0..40 {
        if a.1 < b.1 {
            (high, b) = (b.0, a);
            a = at(high - golden * (high - low));
        } else {
            (low, a) = (a.0, b);
            b = at(low + golden * (high - low));
        }
    }
    0.5 * (low + high)
}

/// Points of a time series, at most.
const POINTS: f64 = 300.0;

/// How much of the end the pressure mode is kept of \[L/c0\].
pub const WINDOW: f64 = 60.0;
/// Name of the curve of the pressure mode; it is missing if the run was over before the window was full.
pub const MODE: &str = "mode";
/// Its column of the time before the end \[L/c0\].
pub const MODE_TIME: &str = "t";
/// Its column of the amplitude \[ρV²\].
pub const MODE_AMPLITUDE: &str = "amplitude";

/// Watches what should be exactly 0: cross-flow and pressure, the waves of hypothesis H3.
pub struct Series {
    every: f64,
    next: f64,
    speed: f64,
    pressure: f64,
    eos: solver::Tait,
    rows: Vec<[f64; 4]>,
    count: f64,
    width: f64,
    /// Time \[s\] and amplitude of the lowest pressure mode cos(πy/L) \[ρV²\] after every step, if it is
    /// watched.
    mode: Option<Vec<(f64, f64)>>,
}

impl Series {
    /// A series over the whole run.
    pub fn new(setup: &Setup, start: &dyn Stepper<()>) -> Self {
        let every = setup.time(setup.settings.end) / POINTS;
        let pressure = setup.settings.rho * setup.v * setup.v;
        let mut series = Self {
            every,
            next: every,
            speed: setup.v,
            pressure,
            eos: setup.medium.eos,
            rows: Vec::new(),
            count: start.fluid_count() as f64,
            width: setup.settings.width,
            mode: setup.settings.watch_mode.then(Vec::new),
        };
        series.sample(start);
        series
    }

    /// Takes a row.
    fn sample(&mut self, simulation: &dyn Stepper<()>) {
        let (mut u, mut v2, mut p1, mut p2) = (0.0, 0.0, 0.0, 0.0);
        for (_, e) in simulation.fluid() {
            let p = self.eos.pressure(e.density);
            u += e.velocity.x;
            v2 += e.velocity.y * e.velocity.y;
            p1 += p;
            p2 += p * p;
        }
        let n = self.count;
        let p = (p2 / n - (p1 / n).powi(2)).max(0.0).sqrt();
        let v = (v2 / n).sqrt();
        let row = [simulation.time(), u / n / self.speed, v / self.speed, p / self.pressure];
        self.rows.push(row);
    }

    /// The lowest pressure mode over the last [`WINDOW`] of a run that ended at `end` \[s\].
    pub fn mode_until(&self, end: f64) -> Option<Profile> {
        let crossing = self.width / self.eos.sound_speed;
        let since_end = |t: f64| (t - end) / crossing;
        if since_end(0.0) > -WINDOW {
            return None;
        }
        let all = self.mode.as_ref()?.iter().map(|(t, p)| (since_end(*t), *p));
        let (times, amplitudes) = all.filter(|(t, _)| *t >= -WINDOW).unzip();
        let profile = Profile::default().with(MODE_TIME, "L/c0", times);
        Some(profile.with(MODE_AMPLITUDE, "rho V^2", amplitudes))
    }

    /// The series as columns.
    pub fn into_profile(self) -> Profile {
        let column = |k: usize| self.rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
        Profile::default()
            .with("t", "s", column(0))
            .with("u_mean", "V", column(1))
            .with("v_rms", "V", column(2))
            .with("p_rms", "rho V^2", column(3))
    }
}

harness::observed! {
    Series: changes(next, rows, mode), parts(), stays(every, speed, pressure, eos, count, width)
}

impl Observer<()> for Series {
    #[inline]
    fn after_step(&mut self, simulation: &dyn Stepper<()>) -> Going {
        if let Some(series) = &mut self.mode {
            let (mut mode, mut count) = (0.0, 0.0);
            for (_, e) in simulation.fluid() {
                let phase = std::f64::consts::PI * e.position.y / self.width;
                mode += 2.0 * self.eos.pressure(e.density) / self.pressure * cos(phase);
                count += 1.0;
            }
            series.push((simulation.time(), mode / count));
        }
        if simulation.time() >= self.next {
            self.next += self.every;
            self.sample(simulation);
        }
        Going::Continue
    }
}

#[cfg(test)]
mod tests {
    use harness::{context::Context, method::Method};
    use solver::Continuity;

    use base::record::{MetricName, Record};

    use super::*;
    use crate::channel::{
        ChannelSettings, Flow,
        variants::{Fluid, Seed},
    };

    fn setup(flow: Flow) -> Setup {
        let method = Method::of::<Seed<Fluid<()>, Continuity>>();
        let settings = ChannelSettings::default();
        Setup::new(flow, &settings, &method, &Context::default()).expect("the defaults are valid")
    }

    /// The record of 20 rows whose velocity is this function of y \[m\] and t \[s\], compared at `tau`.
    fn compared(setup: &Setup, tau: f64, velocity: &dyn Fn(f64, f64) -> f64) -> Record {
        let mut fluid = setup.rows(0.5 * setup.medium.dx, 20);
        let t = setup.time(tau);
        fluid.iter_mut().for_each(|p| p.velocity.x = velocity(p.position.y, t));
        let field = stations(setup).iter().map(|s| velocity(s.y, t)).collect();
        let sample = Sample { fluid, field: Some(field) };
        let mut record = Record::new(setup.flow.name(), "seed", serde_json::Value::Null, 1);
        compare(setup, &sample, tau, &mut record);
        record
    }

    fn assert_near(record: &Record, metric: MetricName, exact: f64, tolerance: f64) {
        let (name, found) = (metric.name().to_string(), record.value(metric).expect("measured"));
        assert!((found - exact).abs() < tolerance, "{name}: {found} is not {exact}");
    }

    #[test]
    fn errors_that_are_put_in_are_measured() {
        for flow in [Flow::Couette, Flow::Poiseuille] {
            let setup = setup(flow);
            let (width, v) = (setup.settings.width, setup.v);
            let exact = |y: f64, t: f64| setup.exact(y, t);
            let none = compared(&setup, 0.1, &exact);
            for metric in [L2, LINF, FIELD_L2, SHEAR_LOWER, SHEAR_UPPER] {
                assert_near(&none, metric.at(0.1), 0.0, 1e-12);
            }
            let [u, exact_u] = ["u", "u_exact"].map(|name| none.column(&profile_at(0.1), name));
            assert!(u.len() == 20 && u.iter().zip(exact_u).all(|(u, e)| (u - e).abs() < 1e-9 * v));
            let faster = compared(&setup, 0.1, &|y, t| 1.02 * exact(y, t));
            assert_near(&faster, L2.at(0.1), 0.02, 1e-9);
            assert_near(&faster, FIELD_L2.at(0.1), 0.02, 1e-9);
            assert_near(&faster, L2_WORST.into(), 0.02, 1e-9);
            // Before 0.1 the layer of the start is too thin to count.
            assert_eq!(compared(&setup, 0.05, &exact).value(L2_WORST), None);
            let shifted = compared(&setup, 0.1, &|y, t| exact(y, t) + 0.01 * v);
            assert_near(&shifted, LINF.at(0.1), 0.01, 1e-9);
            // 0.02 V y (L - y)/L^2 has the slope 0.02 V/L at either wall, seen from it.
            let bent = |y: f64, t: f64| exact(y, t) + 0.02 * v * y * (width - y) / width.powi(2);
            let bent = compared(&setup, 0.1, &bent);
            assert_near(&bent, SHEAR_LOWER.at(0.1), 0.02, 1e-9);
            assert_near(&bent, SHEAR_UPPER.at(0.1), 0.02, 1e-9);
            for ratio in [0.97, 1.03] {
                let nu = ratio * setup.settings.nu;
                let other = compared(&setup, 0.1, &|y, t| setup.exact_with_viscosity(y, t, nu));
                assert_near(&other, NU_EFF.at(0.1), ratio, 1e-6);
            }
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
        let sample = Sample { fluid, field: None };
        let mut record = Record::new("poiseuille", "seed", serde_json::Value::Null, 1);
        at_the_end(&setup, &sample, &mut record);
        assert_near(&record, V_RMS.into(), (0.02_f64.powi(2) + 0.03_f64.powi(2)).sqrt(), 1e-9);
        assert_near(&record, P_RMS.into(), 0.04, 1e-5);
        assert_near(&record, MOMENTUM_Y.into(), 0.02, 1e-5);
        assert_near(&record, OUTSIDE.into(), 1.0, 1e-9);
        let exact = volume / (count * setup.medium.dx.powi(2)) - 1.0;
        assert_near(&record, VOLUME_DRIFT.into(), exact, 1e-9);
    }

    #[test]
    fn the_series_has_means_and_the_pressure_mode() {
        let method = Method::of::<Seed<Fluid<()>, Continuity>>();
        let settings = ChannelSettings { watch_mode: true, ..ChannelSettings::default() };
        let setup = Setup::new(Flow::Poiseuille, &settings, &method, &Context::default());
        let setup = setup.expect("the defaults are valid");
        let (v, eos) = (setup.v, setup.medium.eos);
        let scale = settings.rho * v * v;
        let mut parts = setup.parts(&method, &Context::default());
        for p in parts.particles.iter_mut().filter(|p| p.role == Role::Fluid) {
            p.velocity = Vector2::new(0.7 * v, 0.02 * v);
            let mode = cos(std::f64::consts::PI * p.position.y / settings.width);
            p.density = eos.density(0.05 * scale * mode + eos.background);
        }
        let simulation = (method.build)(parts).expect("a scene");
        let mut series = Series::new(&setup, &*simulation);
        let every = setup.time(settings.end) / POINTS;
        assert!((series.every / every - 1.0).abs() < 1e-12 && series.next == series.every);
        series.next = 0.0;
        let _ = series.after_step(&*simulation);
        assert_eq!(series.next, series.every);
        let [_, u, v_rms, p_rms] = series.rows[0];
        assert!((u - 0.7).abs() < 1e-9 && (v_rms - 0.02).abs() < 1e-9, "{u} {v_rms}");
        assert!((p_rms - 0.05 / 2.0_f64.sqrt()).abs() < 1e-4, "{p_rms}");
        let amplitude = series.mode.as_ref().expect("watched")[0].1;
        assert!((amplitude - 0.05).abs() < 1e-4, "{amplitude}");
        // A sample in every crossing of the channel by sound: the last 60 and the end are kept.
        let crossing = settings.width / eos.sound_speed;
        series.mode = Some((0..=100).map(|k| (f64::from(k) * crossing, f64::from(k))).collect());
        let end = 100.001 * crossing;
        let mode = series.mode_until(end).expect("long enough");
        assert_eq!(mode.column(MODE_AMPLITUDE).first(), Some(&41.0));
        assert!((mode.column(MODE_TIME)[0] + 59.001).abs() < 1e-9);
        assert!(series.mode_until(59.0 * crossing).is_none());
    }

    #[test]
    fn steady_couette_flow_does_not_show_its_viscosity() {
        let shows = |flow, tau| {
            let settings = ChannelSettings::default();
            let method = Method::of::<Seed<Fluid<()>, Continuity>>();
            let setup = Setup::new(flow, &settings, &method, &Context::default());
            let setup = setup.expect("the defaults are valid");
            let fluid = setup.rows(0.5 * setup.medium.dx, 20);
            depends_on_viscosity(&setup, &fluid, setup.time(tau))
        };
        assert_eq!(
            [0.02, 0.2, 0.5, 1.0].map(|tau| shows(Flow::Couette, tau)),
            [true, true, false, false]
        );
        assert!([0.02, 0.2, 1.0].into_iter().all(|tau| shows(Flow::Poiseuille, tau)));
    }
}
