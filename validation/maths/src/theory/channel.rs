//! Channel flow of particles on a lattice, reduced to one unknown a row: the exact answer of the
//! semi-discrete equations for each wall rule.
//!
//! The flow u(y, t) does not depend on x, nothing moves across the channel, ρ = ρ₀ and the pressure
//! is uniform. Then Morris viscosity (6) with F = -W'/r couples rows only,
//!
//! uⱼ' = -Σ_m a_m (uⱼ - uⱼ₊ₘ) + F_body,  a_m = 2ν Σ_x V F(r) r²/(r²+η²),  r² = x² + (m dx)²,
//!
//! with x over the particles of a row. The wall rule says what stands for u beyond a wall; it is
//! linear, so u' = A u + b. Rows that the shear has slid past each other have other a_m, see
//! [`Alignment`].

use nalgebra::{DMatrix, DVector};
use solver::kernel::{Kernel, Smoothing};
use thiserror::Error;

/// What the sums see beyond a wall. `u_w` is the wall's velocity, rows behind it are numbered
/// k = 0, 1, …; except for [`WallRule::InterfaceWall`] the wall lies midway between two rows, so
/// row k of either side is (k + 1/2) dx away from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WallRule {
    /// Ghosts of the seed (4.1): u_k → 2 u_w - u_k.
    Ghosts,
    /// Ghosts with the curvature that the momentum equation demands at the wall, u''_w = -F/ν:
    /// u_g(-y) = 2 u_w - u(y) + y² u''_w (after Basa, Quinlan & Lastiwka 2009; the wall itself is
    /// taken not to accelerate).
    CurvedGhosts,
    /// Interface and wall particles of the seed (4.2): a row *on* the wall and rows behind it, all
    /// with u_w and V = dx². The fluid's rows lie at y = j dx, j = 1 … N-1, dx = L/N.
    InterfaceWall,
    /// Every row behind the wall has u_w.
    Constant,
    /// Per pair, u_g = u_w - min(d_g/d_i, cap) (u_i - u_w) with the distances d from the wall
    /// (Takeda et al. 1994; Morris, Fox & Zhu 1997, who, as far as remembered, cap
    /// 1 + d_g/d_i at 1.5, cap = 0.5 here).
    Takeda {
        /// Largest d_g/d_i; infinite for none.
        cap: f64,
    },
    /// u_g = 2 u_w - Σ u W / Σ W over the fluid in reach of the ghost (Adami, Hu & Adams 2012).
    Adami,
    /// The parabola through the wall's velocity and the first two rows. Exact for a parabola, so it
    /// shows the error of the lattice alone.
    Quadratic,
}

/// How the rows lie to each other. In the time L²/ν shear moves them by about Re L.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// In columns, as they start; holds while the displacement is small against dx.
    Aligned,
    /// Slid past each other: a_m is the mean over all offsets of row m. The mean over time of a
    /// run that slides by many dx; the swing about it, periodic in the displacement, is left out.
    Slid,
}

/// A channel of width `width`, cut into `rows` spacings.
#[derive(Clone, Copy, Debug)]
pub struct Channel {
    /// N: dx = L/N.
    pub rows: usize,
    /// L \[m\].
    pub width: f64,
    /// Kinematic viscosity ν \[m²/s\].
    pub nu: f64,
    /// Velocity of the lower and of the upper wall \[m/s\].
    pub wall_velocity: [f64; 2],
    /// Body force per mass \[m/s²\].
    pub force: f64,
    /// What stands for the walls.
    pub wall_rule: WallRule,
    /// How the rows lie to each other.
    pub alignment: Alignment,
}

/// Why a channel cannot be reduced to rows.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum ChannelError {
    /// A ghost would mirror a row that does not exist.
    #[error(
        "the channel has {rows} rows of fluid, but must have at least 3, and as many as the kernel reaches, \
         which is {reach}"
    )]
    TooNarrow {
        /// Rows of fluid.
        rows: usize,
        /// Rows that the kernel reaches to one side.
        reach: usize,
    },
    /// Width or viscosity is not positive and finite.
    #[error("{name} is {value}, but must be positive and finite")]
    NotPositive {
        /// Which.
        name: &'static str,
        /// Its value \[SI\].
        value: f64,
    },
}

/// u' = A u + b for the rows of a channel.
#[derive(Clone, Debug)]
pub struct RowModel {
    /// Distance of the rows from the lower wall \[m\].
    pub y: DVector<f64>,
    /// A \[1/s\].
    pub a: DMatrix<f64>,
    /// b \[m/s²\].
    pub b: DVector<f64>,
}

/// The sums over one row, by its distance m \[rows\] from the particle.
struct RowSums {
    /// a_m \[1/s\].
    viscosity: Vec<f64>,
    /// Σ_x W \[1/dx²\].
    density: Vec<f64>,
}

impl RowSums {
    /// ν/dx² in \[1/s\]; kernel and lattice in units of dx.
    fn new<K: Kernel>(
        kernel: &Smoothing<K>,
        eta2: f64,
        nu_over_dx2: f64,
        alignment: Alignment,
    ) -> Self {
        let offsets = if alignment == Alignment::Slid { 256 } else { 1 };
        let reach = kernel.support().ceil() as i32;
        let (mut viscosity, mut density) = (Vec::new(), Vec::new());
        for m in 0..=reach {
            let (mut a, mut w) = (0.0, 0.0);
            for x in -reach * offsets..=(reach + 1) * offsets {
                let x = f64::from(x) / f64::from(offsets);
                let r2 = x * x + f64::from(m * m);
                w += kernel.w(r2);
                if r2 > 0.0 {
                    a += 2.0 * kernel.f(r2) * r2 / (r2 + eta2);
                }
            }
            if w > 0.0 {
                viscosity.push(nu_over_dx2 * a / f64::from(offsets));
                density.push(w / f64::from(offsets));
            }
        }
        Self { viscosity, density }
    }

    fn reach(&self) -> usize {
        self.viscosity.len() - 1
    }
}

/// A row behind a wall.
struct Behind {
    /// 0 lower, 1 upper.
    wall: usize,
    /// k of the row, counted from the wall.
    depth: usize,
}

impl Channel {
    /// Builds A and b for kernel `K` with h = `h_over_dx` dx and η² = `eta2_over_h2` h².
    ///
    /// # Errors
    /// [`ChannelError`] when the channel has fewer rows than the kernel reaches or a parameter is
    /// not physical.
    pub fn reduce<K: Kernel>(
        &self,
        h_over_dx: f64,
        eta2_over_h2: f64,
    ) -> Result<RowModel, ChannelError> {
        for (name, value) in [("width", self.width), ("nu", self.nu), ("h/dx", h_over_dx)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ChannelError::NotPositive { name, value });
            }
        }
        let dx = self.width / self.rows as f64;
        let kernel = Smoothing::<K>::new(h_over_dx);
        let eta2 = eta2_over_h2 * h_over_dx * h_over_dx;
        let sums = RowSums::new(&kernel, eta2, self.nu / (dx * dx), self.alignment);
        let on_wall = self.wall_rule == WallRule::InterfaceWall;
        let rows = if on_wall { self.rows.saturating_sub(1) } else { self.rows };
        if rows < sums.reach().max(3) {
            return Err(ChannelError::TooNarrow { rows, reach: sums.reach() });
        }
        let first = if on_wall { 1.0 } else { 0.5 };
        let mut model = RowModel {
            y: DVector::from_fn(rows, |j, _| (j as f64 + first) * dx),
            a: DMatrix::zeros(rows, rows),
            b: DVector::from_element(rows, self.force),
        };
        for own in 0..rows {
            for m in 1..=sums.reach() {
                let below =
                    own.checked_sub(m).ok_or_else(|| Behind { wall: 0, depth: m - own - 1 });
                self.couple(&mut model, &sums, own, below, m);
                let up = own + m;
                let above =
                    if up < rows { Ok(up) } else { Err(Behind { wall: 1, depth: up - rows }) };
                self.couple(&mut model, &sums, own, above, m);
            }
        }
        Ok(model)
    }

    /// Adds a_m (u_other - u_own) to row `own`; `other` is a row of fluid or one behind a wall.
    fn couple(
        &self,
        model: &mut RowModel,
        sums: &RowSums,
        own: usize,
        other: Result<usize, Behind>,
        m: usize,
    ) {
        let a = sums.viscosity[m];
        model.a[(own, own)] -= a;
        match other {
            Ok(fluid) => model.a[(own, fluid)] += a,
            Err(Behind { wall, depth }) => {
                let rows = model.y.len();
                let count = |j: usize| if wall == 0 { j } else { rows - 1 - j };
                let velocity = self.wall_velocity[wall];
                let (constant, weights) = self.extrapolate(velocity, depth, count(own), sums);
                model.b[own] += a * constant;
                for (from_wall, weight) in weights {
                    model.a[(own, count(from_wall))] += a * weight;
                }
            }
        }
    }

    /// The velocity in row `depth` behind a wall that moves at `wall` \[m/s\], as seen from row
    /// `own`: a constant \[m/s\] and weights of rows of fluid, all counted from that wall.
    fn extrapolate(
        &self,
        wall: f64,
        depth: usize,
        own: usize,
        sums: &RowSums,
    ) -> (f64, Vec<(usize, f64)>) {
        let dx = self.width / self.rows as f64;
        let distance = |k: usize| (k as f64 + 0.5) * dx;
        match self.wall_rule {
            WallRule::InterfaceWall | WallRule::Constant => (wall, vec![]),
            WallRule::Ghosts => (2.0 * wall, vec![(depth, -1.0)]),
            WallRule::CurvedGhosts => {
                let bend = -self.force / self.nu * distance(depth) * distance(depth);
                (2.0 * wall + bend, vec![(depth, -1.0)])
            }
            WallRule::Takeda { cap } => {
                let ratio = (distance(depth) / distance(own)).min(cap);
                ((1.0 + ratio) * wall, vec![(own, -ratio)])
            }
            WallRule::Adami => {
                let seen = |j: usize| sums.density.get(depth + 1 + j).copied();
                let weights = || (0..self.rows).map_while(|j| seen(j).map(|w| (j, w)));
                let total: f64 = weights().map(|(_, w)| w).sum();
                (2.0 * wall, weights().map(|(j, w)| (j, -w / total)).collect())
            }
            WallRule::Quadratic => {
                // Lagrange weights of the rows at 1/2 and 3/2 spacings, at -z, with the wall at 0.
                let z = depth as f64 + 0.5;
                let (near, far) = (-2.0 * z * (z + 1.5), z * (z + 0.5) / 1.5);
                ((1.0 - near - far) * wall, vec![(0, near), (1, far)])
            }
        }
    }
}

impl RowModel {
    /// The steady state, -A⁻¹ b \[m/s\]; `None` when A is singular.
    pub fn steady(&self) -> Option<DVector<f64>> {
        self.a.clone().lu().solve(&-&self.b)
    }

    /// u(t) \[m/s\] from rest, exact in time: u = (1 - exp(A t)) u_steady. `None` when A is
    /// singular.
    pub fn at(&self, t: f64) -> Option<DVector<f64>> {
        let steady = self.steady()?;
        Some(-exp_m1_of(&self.a * t) * steady)
    }

    /// u' = A u + b \[m/s²\].
    pub fn rate(&self, u: &DVector<f64>) -> DVector<f64> {
        &self.a * u + &self.b
    }

    /// u after `steps` steps of forward Euler from rest \[m/s\]; so does the viscous part of the
    /// staggered leapfrog advance.
    pub fn euler(&self, dt: f64, steps: usize) -> DVector<f64> {
        let mut u = DVector::zeros(self.y.len());
        for _ in 0..steps {
            u += self.rate(&u) * dt;
        }
        u
    }

    /// u after `steps` steps of the explicit midpoint rule (predictor-corrector) from rest \[m/s\].
    pub fn midpoint(&self, dt: f64, steps: usize) -> DVector<f64> {
        let mut u = DVector::zeros(self.y.len());
        for _ in 0..steps {
            let half = &u + self.rate(&u) * (0.5 * dt);
            u += self.rate(&half) * dt;
        }
        u
    }

    /// ‖u - u_exact‖₂ / ‖u_exact‖₂ over the rows, NaN when u_exact is 0 everywhere.
    pub fn relative_error(&self, u: &DVector<f64>, exact: impl Fn(f64) -> f64) -> f64 {
        let exact = self.y.map(exact);
        (u - &exact).norm() / exact.norm()
    }
}

/// exp(A) - 1 by Taylor's series of A/2ⁿ, of norm below 1/2, and n doublings of e = exp - 1 as e (e + 2),
/// which do not cancel. The exponential of nalgebra comes with a product of matrices that has other bits on
/// other processors.
fn exp_m1_of(mut a: DMatrix<f64>) -> DMatrix<f64> {
    let size =
        a.column_iter().map(|column| column.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max);
    let mut doublings = 0;
    while size * 0.5_f64.powi(doublings) > 0.5 && doublings < 1000 {
        doublings += 1;
    }
    a *= 0.5_f64.powi(doublings);
    let (mut term, mut sum) = (a.clone(), a.clone()); // its next term would be below 1e-19
    for k in 2..=16 {
        term = &term * &a / f64::from(k);
        sum += &term;
    }
    for _ in 0..doublings {
        let mut more = sum.clone();
        for k in 0..more.nrows() {
            more[(k, k)] += 2.0;
        }
        sum *= more;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{Couette, Poiseuille};
    use crate::theory::lattice::SquareLattice;
    use crate::theory::printed::assert_rounds_to;
    use base::functions::log2;
    use solver::kernel::{CubicSpline, QuinticSpline, WendlandC2};

    const POISEUILLE: Poiseuille = Poiseuille { v: 1.0, l: 1.0, nu: 1.0 };
    const COUETTE: Couette = Couette { v0: 1.0, l: 1.0, nu: 1.0 };

    fn reduced<K: Kernel>(
        wall_rule: WallRule,
        (h, eta2): (f64, f64),
        rows: usize,
        wall_velocity: [f64; 2],
        force: f64,
    ) -> RowModel {
        let alignment = Alignment::Aligned;
        let channel =
            Channel { rows, width: 1.0, nu: 1.0, wall_velocity, force, wall_rule, alignment };
        channel.reduce::<K>(h, eta2).expect("a wide channel")
    }

    fn poiseuille_error<K: Kernel>(rule: WallRule, kernel: (f64, f64), rows: usize) -> f64 {
        let model = reduced::<K>(rule, kernel, rows, [0.0; 2], POISEUILLE.force());
        model.relative_error(&model.steady().expect("regular"), |y| POISEUILLE.steady(y))
    }

    fn couette_error<K: Kernel>(rule: WallRule, kernel: (f64, f64), rows: usize) -> f64 {
        let model = reduced::<K>(rule, kernel, rows, [0.0, 1.0], 0.0);
        model.relative_error(&model.at(0.1).expect("regular"), |y| COUETTE.velocity(y, 0.1))
    }

    /// Steady Poiseuille at N = 10, 20, 40, 80, then start-up Couette at νt/L² = 0.1, N = 20, 40.
    fn check<K: Kernel>(rule: WallRule, kernel: (f64, f64), printed: [&str; 6]) {
        let steady = [10, 20, 40, 80].map(|n| poiseuille_error::<K>(rule, kernel, n));
        let start = [20, 40].map(|n| couette_error::<K>(rule, kernel, n));
        let row = format!("{} {kernel:?} {rule:?}", K::NAME);
        assert_rounds_to(&row, &printed, &[steady.as_slice(), &start].concat());
    }

    const UNCAPPED: WallRule = WallRule::Takeda { cap: f64::INFINITY };

    /// Table 1.1 of the design notes, quintic h/dx = 1, η = 0, to its two digits, except the row
    /// "quad": printed 8.0e-4, computed 1 - 1/L₁ = 7.948e-4 with the printed L₁ - 1 = 8.0e-4
    /// (7.954e-4), so the printed number is the lattice factor rounded up.
    #[test]
    fn quintic_errors_match_the_design_table() {
        let check = check::<QuinticSpline>;
        let k = (1.0, 0.0);
        check(WallRule::Ghosts, k, ["1.7e-2", "3.7e-3", "5.1e-4", "5.5e-4", "1.3e-3", "1.2e-4"]);
        check(UNCAPPED, k, ["1.7e-2", "3.7e-3", "5.0e-4", "5.5e-4", "1.3e-3", "1.2e-4"]);
        check(WallRule::Adami, k, ["1.9e-2", "4.6e-3", "8.9e-4", "4.0e-4", "1.6e-3", "3.1e-4"]);
        check(
            WallRule::InterfaceWall,
            k,
            ["2.2e-2", "1.0e-2", "4.7e-3", "2.0e-3", "5.0e-3", "2.2e-3"],
        );
        check(
            WallRule::Takeda { cap: 0.5 },
            k,
            ["1.2e-1", "5.3e-2", "2.5e-2", "1.2e-2", "2.3e-2", "1.1e-2"],
        );
        check(WallRule::Constant, k, ["3.1e-1", "1.5e-1", "7.4e-2", "3.6e-2", "6.4e-2", "3.2e-2"]);
        check(WallRule::Quadratic, k, ["7.9e-4", "7.9e-4", "7.9e-4", "7.9e-4", "4.3e-4", "3.0e-4"]);
    }

    /// The rest of table 1.1, the seed's kernel first.
    #[test]
    fn cubic_and_wendland_errors_match_the_design_table() {
        let seed = (1.2, 0.01);
        let cubic = check::<CubicSpline>;
        cubic(WallRule::Ghosts, seed, ["3.6e-2", "2.4e-2", "2.1e-2", "2.0e-2", "8.6e-3", "7.5e-3"]);
        cubic(
            WallRule::Constant,
            seed,
            ["3.3e-1", "1.7e-1", "9.3e-2", "5.6e-2", "7.0e-2", "3.8e-2"],
        );
        cubic(
            WallRule::InterfaceWall,
            seed,
            ["3.7e-2", "2.8e-2", "2.4e-2", "2.2e-2", "1.1e-2", "8.9e-3"],
        );
        cubic(
            WallRule::Ghosts,
            (1.2, 0.0),
            ["2.6e-2", "1.3e-2", "1.0e-2", "9.5e-3", "4.8e-3", "3.7e-3"],
        );
        cubic(
            WallRule::Ghosts,
            (1.3, 0.01),
            ["2.0e-2", "5.1e-3", "1.4e-3", "4.6e-4", "1.8e-3", "4.8e-4"],
        );
        check::<WendlandC2>(
            WallRule::Ghosts,
            (2.0, 0.0),
            ["3.8e-2", "9.7e-3", "3.0e-3", "1.3e-3", "3.4e-3", "1.1e-3"],
        );
    }

    /// Wall curvature leaves the lattice factor 1 - 1/L₁ and nothing else, at every resolution.
    #[test]
    fn curved_ghosts_reach_the_lattice_floor() {
        fn check<K: Kernel>(kernel: (f64, f64), printed: [&str; 3]) {
            let floor =
                (1.0 - 1.0 / SquareLattice::of::<K>(kernel.0, kernel.1).laplacian_factor()).abs();
            let errors =
                [10, 20, 40].map(|n| poiseuille_error::<K>(WallRule::CurvedGhosts, kernel, n));
            assert_rounds_to(&format!("{} {kernel:?}", K::NAME), &printed, &errors);
            for error in errors {
                assert!((error / floor - 1.0).abs() < 0.035, "{error} against a floor of {floor}");
            }
        }
        check::<QuinticSpline>((1.0, 0.0), ["8.08e-4", "7.98e-4", "7.96e-4"]);
        check::<CubicSpline>((1.2, 0.01), ["2.00e-2", "1.98e-2", "1.97e-2"]);
        check::<CubicSpline>((1.2, 0.0), ["9.44e-3", "9.33e-3", "9.30e-3"]);
        check::<WendlandC2>((2.0, 0.0), ["8.28e-4", "8.08e-4", "8.03e-4"]);
    }

    /// Linear extrapolation is exact for steady Couette flow, a constant wall velocity is not.
    #[test]
    fn steady_couette_is_exact_for_linear_rules() {
        let error = |rule| {
            let model = reduced::<QuinticSpline>(rule, (1.0, 0.0), 20, [0.0, 1.0], 0.0);
            model.relative_error(&model.steady().expect("regular"), |y| y)
        };
        for rule in [WallRule::Ghosts, WallRule::CurvedGhosts, UNCAPPED, WallRule::Quadratic] {
            assert!(error(rule) < 1e-13, "{rule:?}: {:.1e}", error(rule));
        }
        let others = [WallRule::Adami, WallRule::InterfaceWall, WallRule::Constant].map(error);
        assert_rounds_to("steady Couette", &["1.9e-4", "1.9e-3", "2.6e-2"], &others);
    }

    /// Once the rows have slid, the floor is the factor of sheared rows.
    #[test]
    fn slid_rows_have_the_sheared_floor() {
        for (h, eta2) in [(1.3, 0.01), (1.2, 0.0)] {
            let channel = Channel {
                rows: 20,
                width: 1.0,
                nu: 1.0,
                wall_velocity: [0.0; 2],
                force: POISEUILLE.force(),
                wall_rule: WallRule::Quadratic,
                alignment: Alignment::Slid,
            };
            let model = channel.reduce::<CubicSpline>(h, eta2).expect("a wide channel");
            let steady = model.steady().expect("regular");
            let factor = SquareLattice::of::<CubicSpline>(h, eta2).sheared_laplacian_factor();
            let error = model.relative_error(&steady, |y| POISEUILLE.steady(y) / factor);
            assert!(error < 1e-7, "h/dx {h}: {error:.1e}");
        }
    }

    /// Forward Euler is of first, midpoint of second order towards the exponential.
    #[test]
    fn time_stepping_converges_with_its_order() {
        let model = reduced::<CubicSpline>(WallRule::Ghosts, (1.2, 0.01), 10, [0.0; 2], 8.0);
        let exact = model.at(0.1).expect("regular");
        let order = |step: &dyn Fn(f64, usize) -> DVector<f64>| {
            let error = |n: usize| (step(0.1 / n as f64, n) - &exact).norm();
            log2(error(200) / error(400))
        };
        assert!((order(&|dt, n| model.euler(dt, n)) - 1.0).abs() < 0.02);
        assert!((order(&|dt, n| model.midpoint(dt, n)) - 2.0).abs() < 0.02);
    }

    /// Start-up Poiseuille at 20 rows: errors of plain ghosts, of curved ones and of the parabola
    /// through the wall, which bounds what a wall rule can gain.
    #[test]
    fn curved_ghosts_help_during_start_up() {
        for (t, printed) in [
            (0.02, ["8.8e-3", "3.3e-3", "2.4e-3"]),
            (0.1, ["3.6e-3", "2.1e-3", "1.8e-3"]),
            (0.5, ["3.7e-3", "8.8e-4", "8.6e-4"]),
        ] {
            let error = |rule| {
                let model = reduced::<QuinticSpline>(rule, (1.0, 0.0), 20, [0.0; 2], 8.0);
                model.relative_error(&model.at(t).expect("regular"), |y| POISEUILLE.velocity(y, t))
            };
            let rules = [WallRule::Ghosts, WallRule::CurvedGhosts, WallRule::Quadratic];
            assert_rounds_to(&format!("t = {t}"), &printed, &rules.map(error));
        }
    }

    #[test]
    fn bad_channels_are_refused() {
        let channel = Channel {
            rows: 2,
            width: 1.0,
            nu: 1.0,
            wall_velocity: [0.0; 2],
            force: 0.0,
            wall_rule: WallRule::Ghosts,
            alignment: Alignment::Aligned,
        };
        let narrow = channel.reduce::<QuinticSpline>(1.3, 0.0);
        assert_eq!(narrow.unwrap_err(), ChannelError::TooNarrow { rows: 2, reach: 3 });
        let frozen = Channel { nu: 0.0, rows: 20, ..channel }.reduce::<CubicSpline>(1.2, 0.0);
        assert_eq!(frozen.unwrap_err(), ChannelError::NotPositive { name: "nu", value: 0.0 });
    }
}
