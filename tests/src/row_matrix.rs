//! Channel flow of particles on a lattice, reduced to one unknown a row: the exact answer of the
//! semi-discrete equations for each wall rule.
//!
//! The flow u(y, t) does not depend on x, nothing moves across the channel, ρ = ρ₀ and the pressure
//! is uniform. Then Morris viscosity (6) with F = -W'/r couples rows only,
//!
//! uⱼ' = -Σ_m a_m (uⱼ - uⱼ₊ₘ) + F_body,  a_m = 2ν Σ_x V F(r) r²/(r²+η²),  r² = x² + (m dx)²,
//!
//! with x over the particles of a row. The wall rule replaces u beyond a wall; it is linear, so u' = A u + b.
//! Rows shifted by the shear have other a_m, see [`Alignment`]. Sums that are exact for linear fields have
//! a_m / (½ tr M) and η = 0, M = Σ V F r ⊗ r, see [`Sums`].

use nalgebra::{DMatrix, DVector};
use touchstone_solver::kernel::{Kernel, Smoothing};

/// The velocity beyond a wall in the sums. `u_w` is the velocity of the wall, rows behind it have numbers k =
/// 0, 1, …; except for [`WallRule::InterfaceWall`] the wall is midway between two rows, so row k of either
/// side is at the distance (k + 1/2) dx.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WallRule {
    /// Ghosts of the seed (4.1): u_k → 2 u_w - u_k.
    Ghosts,
    /// Ghosts with the curvature that the momentum equation demands at the wall, u''_w = -F/ν:
    /// u_g(-y) = 2 u_w - u(y) + y² u''_w (after Basa, Quinlan & Lastiwka 2009; the wall itself is
    /// taken not to accelerate).
    CurvedGhosts,
    /// Interface and wall particles of the paper (4.2): a row *on* the wall and rows behind it, all with u_w
    /// and V = dx². The fluid's rows are at y = j dx, j = 1 … N-1, dx = L/N.
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

/// Relative alignment of the rows. In the time L²/ν shear moves them by about Re L.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// In columns, as they start; holds while the displacement is small against dx.
    Aligned,
    /// Slid past each other: a_m is the mean over all offsets of row m. The mean over time of a
    /// run that slides by many dx; the swing about it, periodic in the displacement, is left out.
    Slid,
}

/// The sums of the viscous force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sums {
    /// Of Morris, over pairs.
    Pairs,
    /// Exact for linear fields (`ConsistentViscosity`). Their linear part is 0 where the rows continue
    /// beyond a wall, as mirror particles do.
    Consistent,
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
    /// The wall rule.
    pub wall_rule: WallRule,
    /// The relative alignment of the rows.
    pub alignment: Alignment,
    /// The sums of the viscous force.
    pub sums: Sums,
}

/// Why a channel cannot be reduced to rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelError {
    /// A ghost would mirror a row that does not exist.
    TooNarrow {
        /// Rows of fluid.
        rows: usize,
        /// Rows that the kernel reaches to one side.
        reach: usize,
    },
    /// Width or viscosity is not positive and finite.
    NotPositive {
        /// Name.
        name: &'static str,
        /// Value \[SI\].
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
        kind: Sums,
    ) -> Self {
        let eta2 = if kind == Sums::Consistent { 0.0 } else { eta2 };
        let offsets = if alignment == Alignment::Slid { 256 } else { 1 };
        let reach = kernel.support().ceil() as i32;
        let (mut viscosity, mut density) = (Vec::new(), Vec::new());
        let mut half_trace = 0.0;
        for m in 0..=reach {
            let (mut a, mut w) = (0.0, 0.0);
            let sides = if m == 0 { 1.0 } else { 2.0 };
            for x in -reach * offsets..=(reach + 1) * offsets {
                let x = f64::from(x) / f64::from(offsets);
                let r2 = x * x + f64::from(m * m);
                w += kernel.w(r2);
                // The own row stays in columns.
                let is_there = m > 0 || x.fract() == 0.0;
                if r2 > 0.0 {
                    a += 2.0 * kernel.f(r2) * r2 / (r2 + eta2);
                    let weight = if m > 0 { 1.0 } else { f64::from(offsets) };
                    half_trace += 0.5 * sides * weight * kernel.f(r2) * r2 * f64::from(is_there);
                }
            }
            if w > 0.0 {
                viscosity.push(nu_over_dx2 * a / f64::from(offsets));
                density.push(w / f64::from(offsets));
            }
        }
        if kind == Sums::Consistent {
            viscosity.iter_mut().for_each(|a| *a *= f64::from(offsets) / half_trace);
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
        let sums = RowSums::new(&kernel, eta2, self.nu / (dx * dx), self.alignment, self.sums);
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

    /// The velocity in row `depth` behind a wall of velocity `wall` \[m/s\] for row `own`: a constant \[m/s\]
    /// and weights of fluid rows, all counted from this wall.
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

/// L₁ = Σ V F y² r²/(r²+η²) of Morris' Laplacian on a lattice, equal to the factor G₁ of gradients at η = 0.
pub fn laplacian_factor<K: Kernel>(h_over_dx: f64, eta2_over_h2: f64) -> f64 {
    factor_of_rows::<K>((h_over_dx, eta2_over_h2), 1)
}

/// L₁ for ∂²u/∂y² once shear has slid the rows past each other: every row at distance y keeps its spacing
/// but takes every offset s in \[0, dx) equally often, Σ_y y² ⟨Σ_x V F r²/(r²+η²)⟩ₛ. Only rows y ≠ 0 count,
/// so correlations between offsets of different rows do not matter. The sum is periodic in s and as smooth as
/// the kernel, so the mean over equal steps converges quickly.
pub fn sheared_laplacian_factor<K: Kernel>(h_over_dx: f64, eta2_over_h2: f64) -> f64 {
    factor_of_rows::<K>((h_over_dx, eta2_over_h2), 512)
}

/// The mean over this number of offsets of the rows; both signs of y are equivalent.
fn factor_of_rows<K: Kernel>((h, eta2_over_h2): (f64, f64), offsets: i32) -> f64 {
    let (kernel, eta2) = (Smoothing::<K>::new(h), eta2_over_h2 * h * h);
    let reach = kernel.support().ceil() as i32;
    let mut sum = 0.0;
    for y in 1..=reach {
        for x in -(reach + 1) * offsets..=(reach + 1) * offsets {
            let (x, y) = (f64::from(x) / f64::from(offsets), f64::from(y));
            let r2 = x * x + y * y;
            sum += 2.0 * y * y * kernel.f(r2) * r2 / (r2 + eta2);
        }
    }
    sum / f64::from(offsets)
}
