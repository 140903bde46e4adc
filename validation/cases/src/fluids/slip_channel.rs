//! A shear between walls along which the fluid slips: exact, half a cosine that decays, at constant momentum.

use std::f64::consts::PI;

use nalgebra::Vector2;
use touchstone_base::functions::{cos, exp, ln};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::Statement,
    problem::Simple,
    snapshot::{Point, Snapshot},
    studies::{Accuracy, Ladder, ORDER, Spacing},
    table::Table,
};
use touchstone_maths::metrics::norms::l2;
use touchstone_schemes::flow;

use crate::fluids::unit_flow::{DECISIVE, FlowScales, Numerics, UnitFlow};

touchstone_base::settings! {
    /// Settings of the shear between walls along which the fluid slips. L = U = ρ = 1.
    pub struct SlipSettings {
        /// Reynolds number U L/ν
        re: f64 ["-"] in 1e-3..=1e4 = 0.01,
        /// rows of particles between the walls, and particles along them
        n: usize ["-"] in 8..=1000 = 20,
        /// end of the run
        end: f64 ["L^2/nu"] in 1e-6..=10.0 = 0.05,
        /// smoothing length over spacing; a lattice of the quintic spline has the exact viscosity to 0.04 %
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.3,
        /// sound speed; auto: 10 U or 2 nu/h, the larger one
        c0: Option<f64> ["U"] in 2.0..=1e6 = None,
        /// numerical settings
        numerics: Numerics = Numerics::default(),
    }
}

const NAME: &str = "slip_channel";
const PLAIN: &str = "plain";
const EXTRAPOLATING: &str = "extrapolating-wall";
const STICKING: &str = "sticking";

touchstone_base::metrics! {
    all ALL;
    L2 = "l2" ["-"] "rms(u - u_exact)/rms(u_exact) over particles at the end";
    THEORY_ERROR = "theory_error" ["-"]
        "|a/a' - 1|, a' after exact steps of the lattice that slip walls mirror";
    MOMENTUM_ERROR = "momentum_error" ["-"] "|mean(u)/U - 1| over particles at the end";
    DECAY = "decay" ["-"]
        "-ln(a)/(pi^2 nu t/L^2), a = 2 mean(u cos(pi y/L))/U over particles at the end";
}

/// A step whose error, of first order in dt and second in dx, is too small to cancel the error of the sums.
fn short_steps(s: &mut SlipSettings) {
    s.numerics.viscous = 0.05;
}

fn variants() -> Compositions<SlipSettings> {
    let plain =
        "quintic spline, leapfrog, ghosts along which the fluid slips: is their decay exact?";
    let extrapolating =
        "plain with wall particles that extrapolate the pressure and have no viscous force";
    let sticking = "plain with ghosts to which the fluid sticks: do the gates see the difference?";
    Variants::of(pose)
        .with(PLAIN, plain, flow::slip(), short_steps)
        .with(EXTRAPOLATING, extrapolating, flow::slip_extrapolating(), short_steps)
        .with(STICKING, sticking, flow::couette().plain, short_steps)
        .all
}

/// The shear.
pub static CASE: Composed<SlipSettings> = Composed {
    name: NAME,
    problem: "A shear decays between walls along which the fluid slips",
    recommended: Recommended {
        variant: PLAIN,
        because: "its walls are exact: mirrored, the rows between them are a periodic lattice",
        papers: None,
    },
    about: "Between walls at y = 0 and y = L along which the fluid slips, the velocity u = U (1 + cos(pi \
            y/L)) becomes u = U (1 + cos(pi y/L) exp(-pi^2 nu t/L^2)): no force acts along the walls, so \
            the momentum stays. Where the fluid sticks, the walls take the momentum.",
    variants,
    facts,
    studies,
};

/// u(y, t) \[m/s\] after `tau` = νt/L².
fn exact(y: f64, tau: f64) -> f64 {
    1.0 + cos(PI * y) * exp(-PI * PI * tau)
}

fn pose(m: &Method, s: &SlipSettings) -> Result<Simple, RunError> {
    let SlipSettings { re, n, h_over_dx, .. } = *s;
    let (end, viscous) = (s.end * re, 2.0 * n as f64 / (re * h_over_dx));
    let c0 = s.c0.unwrap_or(viscous.max(10.0));
    let scales =
        FlowScales { re, n, h_over_dx, c0, end, speed: 2.0, force: 0.0, area: 1.0, dt: None };
    let flow = UnitFlow::new(&m.properties, &s.numerics, scales);
    let (medium, rules, size) = (flow.medium, flow.rules, (flow.particles, DECISIVE));
    let numbers = rules.numbers(h_over_dx, medium.dx);
    let first_row = m.properties.first_row;
    let scene = move || {
        let (rho, volume) = (medium.eos.density, medium.dx * medium.dx);
        Ok(flow.between_walls(first_row, |x| {
            let is_fluid = (0.0..1.0).contains(&x.y);
            let u = if is_fluid { exact(x.y, 0.0) } else { 0.0 };
            Particle::fluid(x, Vector2::new(u, 0.0), rho, rho * volume)
        }))
    };
    let (tau, steps) = (s.end, (end / rules.dt() - 1e-9).ceil());
    let lattice = m.properties.square(h_over_dx, medium.eta2_over_h2);
    let symbol = lattice.laplacian(Vector2::new(0.0, PI * medium.dx));
    let decay = medium.nu * symbol / (medium.h * medium.h) * end;
    let theory = exact_steps(decay / steps, steps);
    let at_end =
        move |end: &Snapshot, record: &mut Record| measure(tau, theory, &end.moving(), record);
    Ok(Simple::new(m, (medium, rules), size, &numbers, scene, at_end))
}

/// The amplitude after these steps of the leapfrog, of which each takes the share z: half a kick first and
/// last.
fn exact_steps(z: f64, steps: f64) -> f64 {
    (1.0 - 0.5 * z).powi(2) * (1.0 - z).powi(steps as i32 - 1)
}

fn measure(tau: f64, theory: f64, fluid: &[Point], record: &mut Record) {
    let velocities: Vec<f64> = fluid.iter().map(|p| p.velocity.x).collect();
    let exact: Vec<f64> = fluid.iter().map(|p| exact(p.position.y, tau)).collect();
    let mean = |of: &dyn Fn(&Point) -> f64| {
        fluid.iter().fold(0.0, |sum, p| sum + of(p)) / fluid.len() as f64
    };
    record.put(L2, l2(&velocities, &exact));
    record.put(MOMENTUM_ERROR, (mean(&|p| p.velocity.x) - 1.0).abs());
    let amplitude = 2.0 * mean(&|p| p.velocity.x * cos(PI * p.position.y));
    record.put(THEORY_ERROR, (amplitude / theory - 1.0).abs());
    record.put(DECAY, -ln(amplitude) / (PI * PI * tau));
}

/// The runs: both walls over the rows, and a control.
fn table(tier: Tier) -> Table<SlipSettings, ()> {
    let mut table = Table::new(&CASE, tier);
    let rows: [&[usize]; 2] = [&[10, 14, 20], &[8, 10, 14, 20, 28]];
    table.over((), &[PLAIN, EXTRAPOLATING], rows, |s, n| s.n = n);
    table.over((), &[STICKING], [&[14]; 2], |s, n| s.n = n);
    table.judge(|row| gates(row.variant, row.settings.n));
    table
}

fn gates(variant: &str, n: usize) -> Vec<Gate> {
    let (gates, count) = (CASE.gates(format!("{variant}.{n}")), n as f64);
    let sums = "The sum has the symbol k^2 (1 - (k h)^2/10 + ...) of the quintic spline. With k = pi/L, \
                h = 1.3 L/n and the decay to exp(-0.49) the velocity is off by 0.33/n^2.";
    let one_sided = "Twice the error of the sums: beside a wall without viscous force half of the sum is \
                     missing.";
    let momentum =
        gates.invariant(MOMENTUM_ERROR, Bound::Below(1e-12), "No force acts along the walls.");
    let l2 = |most: f64, because: &str| {
        let bound = Bound::Below(most / (count * count));
        gates.analytic(L2, bound, because).of_others(bound, because)
    };
    match variant {
        PLAIN => {
            let because = "Mirrored, the rows are a periodic lattice, whose steps are known; what remains \
                           is the square of the slide of the rows, at most 1.6e-3 dx.";
            vec![momentum, l2(0.35, sums), gates.theory(THEORY_ERROR, Bound::Below(1e-7), because)]
        }
        EXTRAPOLATING => vec![l2(0.7, one_sided)],
        _ => vec![momentum.expected_to_fail(), l2(0.7, one_sided).expected_to_fail()],
    }
}

fn studies(tier: Tier) -> Studies {
    let table = table(tier);
    Studies::judging(table.plan()).with(accuracy(&table))
}

fn facts() -> Facts {
    let boundary = "Free slip: the fluid slips along both walls without friction, and nothing passes them. \
                    The velocity at the start is that of the particles. x is periodic.";
    Facts {
        statement: Statement::new(boundary, &[ALL]),
        of_methods: &[THEORY_ERROR],
        ..Facts::default()
    }
}

/// Both walls with the order that they should have.
fn accuracy(table: &Table<SlipSettings, ()>) -> Accuracy {
    let because = "Sums of both walls are of second order. The lattice factor of the quintic spline, 1.0004 \
                   at h/dx = 1.3, is opposite to this error, and adds up to 0.5 to the order at 28 rows.";
    let spacing = Spacing::count(|s: &mut SlipSettings| &mut s.n, "{} rows");
    let ladder = |variant: &'static str| {
        let (bound, id) = (Bound::Within(1.8, 2.5), format!("{NAME}.{variant}.order"));
        let order = Gate::new(id, ORDER, bound, Evidence::Theory, because);
        Ladder { order: Some(order), ..table.ladder(&[()], variant, spacing) }
    };
    Accuracy {
        about: "The velocity at νt/L² = 0.05 between walls along which the fluid slips.".into(),
        spacing: "dx/L [-]",
        ladders: [PLAIN, EXTRAPOLATING].map(ladder).into(),
        ..Accuracy::new("slip-channel", L2, "relative L2 error of the velocity [-]")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Velocities that are 3 % too large everywhere, and then a cosine that has decayed 1.2 times as fast.
    #[test]
    fn momentum_and_decay_are_those_of_made_up_particles() {
        let tau = 0.05;
        let measured = |share: f64, faster: f64| {
            let place = |k: usize| Vector2::new(0.0, (k as f64 + 0.5) / 40.0);
            let particle = |k: usize| {
                let u = exact(place(k).y, tau * faster);
                Particle::fluid(place(k), Vector2::new(share * u, 0.0), 1.0, 1.0)
            };
            let all: Vec<Particle> = (0..40).map(particle).collect();
            let mut record = Record::new(NAME, PLAIN, serde_json::json!({}), 1);
            measure(tau, exp(-PI * PI * tau), &Snapshot::of(1.0, &all).moving(), &mut record);
            [L2, THEORY_ERROR, MOMENTUM_ERROR, DECAY]
                .map(|metric| record.value(metric).expect("a metric"))
        };
        let [l2, theory, momentum, decay] = measured(1.0, 1.0);
        assert!(l2 < 1e-14 && theory < 1e-13 && momentum < 1e-14 && (decay - 1.0).abs() < 1e-13);
        let [l2, theory, momentum, _] = measured(1.03, 1.0);
        assert_relative_eq!(l2, 0.03, max_relative = 1e-10);
        assert_relative_eq!(theory, 0.03, max_relative = 1e-10);
        assert_relative_eq!(momentum, 0.03, max_relative = 1e-10);
        let [_, _, momentum, decay] = measured(1.0, 1.2);
        assert!(momentum < 1e-14);
        assert_relative_eq!(decay, 1.2, max_relative = 1e-10);
    }
}
