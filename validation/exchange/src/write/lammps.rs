//! LAMMPS: a data file of atom style `sph` and an input script for its package SPH, which writes one dump a
//! time. The kernel of the package is Lucy's; its cut-off is the support radius of the problem.

use std::fmt::Write;

use touchstone_harness::outline::Outline;

use super::{WriteError, check_fluid};
use crate::problem::ExportedProblem;

/// Margin of the box in open directions, in spacings.
const MARGIN: f64 = 50.0;

/// Courant number c0 dt/dx. With 0.3 columns of water lose particles, because forces take an extrapolated
/// velocity.
const COURANT: f64 = 0.15;

pub fn files(problem: &ExportedProblem) -> Result<Vec<(&'static str, String)>, WriteError> {
    check_fluid("LAMMPS", problem)?;
    let (data, script) = (data(&problem.outline), script(problem));
    Ok(vec![("data.lmp", data), ("in.lmp", script), ("run_lammps.py", RUN.to_string())])
}

/// Runs the input script and writes method and machine of a submission.
const RUN: &str = include_str!("run_lammps.py");

/// Types of atoms: moving, walls at rest, and walls that slide.
fn kind(outline: &Outline, k: usize) -> usize {
    let of = |name: &str| outline.particles.column(name)[k];
    match (of("role") == 0.0, of("u") == 0.0 && of("v") == 0.0) {
        (true, _) => 1,
        (false, true) => 2,
        (false, false) => 3,
    }
}

/// Lower and upper ends of the box along an axis, and the letter of its borders.
fn ends(outline: &Outline, axis: usize) -> ([f64; 2], char) {
    if let Some(period) = outline.domain.period[axis] {
        let low = outline.domain.low[axis];
        return ([low, low + period], 'p');
    }
    let places = outline.particles.column(["x", "y"][axis]);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for &place in places {
        (low, high) = (low.min(place), high.max(place));
    }
    let margin = MARGIN * outline.medium.dx;
    ([low - margin, high + margin], 's') // the box follows the particles
}

fn data(outline: &Outline) -> String {
    let column = |name: &str| outline.particles.column(name);
    let count = column("id").len();
    let ([x_low, x_high], _) = ends(outline, 0);
    let ([y_low, y_high], _) = ends(outline, 1);
    let dx = outline.medium.dx;
    let mut text = format!(
        "# particles of a problem of touchstone\n\n{count} atoms\n3 atom types\n{x_low} {x_high} xlo xhi\n\
         {y_low} {y_high} ylo yhi\n{} {dx} zlo zhi\n\nMasses\n\n",
        -dx
    );
    let (mass, _) = mass(outline);
    for kind in 1..=3 {
        let _ = writeln!(text, "{kind} {mass}");
    }
    text += "\nAtoms # sph\n\n";
    let (x, y, density) = (column("x"), column("y"), column("density"));
    for k in 0..count {
        let kind = kind(outline, k);
        let _ = writeln!(text, "{} {kind} {} 0 1 {} {} 0", k + 1, density[k], x[k], y[k]);
    }
    text += "\nVelocities\n\n";
    for (k, (u, v)) in column("u").iter().zip(column("v")).enumerate() {
        let _ = writeln!(text, "{} {u} {v} 0", k + 1);
    }
    text
}

/// The mass of the first particle \[kg/m\], used for all, and the largest deviation of the others.
fn mass(outline: &Outline) -> (f64, f64) {
    let masses = outline.particles.column("mass");
    let first = masses.first().copied().unwrap_or_default();
    (first, masses.iter().fold(0.0, |most, mass| (mass / first - 1.0).abs().max(most)))
}

fn script(problem: &ExportedProblem) -> String {
    let Outline { medium: m, times, .. } = &problem.outline;
    let borders = [0, 1].map(|axis| ends(&problem.outline, axis).1);
    let cut = problem.outline.method.support * m.h;
    let (rho, c0) = (m.eos.density, m.eos.sound_speed);
    let pair = match m.nu > 0.0 {
        true => format!(
            "pair_style sph/taitwater/morris\npair_coeff * * {rho} {c0} {} {cut}",
            m.nu * rho
        ),
        false => format!("pair_style sph/taitwater\npair_coeff * * {rho} {c0} {} {cut}", m.alpha),
    };
    let (mass, off) = mass(&problem.outline);
    let force = m.acceleration * mass;
    let force = match force.norm() > 0.0 {
        true => format!("fix force fluid addforce {} {} 0\n", force.x, force.y),
        false => String::new(),
    };
    let note = match off > 1e-12 {
        true => format!(
            "# LAMMPS has one mass a type of atom: here that of the first particle, {mass} kg/m, from which\n\
             # those of others in particles.csv differ by up to {off:.1e} of it\n"
        ),
        false => String::new(),
    };
    let mut text = format!(
        "# {} of touchstone, variant {}\n{note}\
         units si\ndimension 2\natom_style sph\natom_modify map array\nboundary {} {} p\nnewton on\n\
         comm_modify vel yes\nread_data data.lmp\n\
         group fluid type 1\ngroup wall type 2 3\n{pair}\n\
         neighbor {} bin\nneigh_modify every 1 delay 0 check yes\n\
         compute rho all sph/rho/atom\n{force}\
         fix walls wall setforce 0 0 0\nfix move all sph\nfix plane all enforce2d\nthermo 1000\n",
        problem.spec.case,
        problem.spec.variant,
        borders[0],
        borders[1],
        0.3 * m.dx,
    );
    let viscous = if m.nu > 0.0 { 0.1 * m.h * m.h / m.nu } else { f64::INFINITY };
    let longest = (COURANT * m.dx / c0).min(viscous);
    let mut start = 0.0;
    for (k, time) in times.iter().enumerate() {
        let steps = ((time - start) / longest).ceil().max(1.0);
        // `run 0` sets the velocity estimates before periodic copies take them.
        let _ = writeln!(text, "timestep {}\nrun 0\nrun {steps}", (time - start) / steps);
        let _ = writeln!(
            text,
            "write_dump all custom frame_{k:04}.dump id type x y vx vy c_rho modify sort id time yes \
             format float %.17g"
        );
        start = *time;
    }
    text
}
