//! What the studies that every case has are made of: error through time, order, error against run time,
//! error budget; and what only the vortices have to say: pictures, all runs.

use super::{BEST, CASE, NAME, VortexSettings, plan::*, run::*};
use base::{functions::log10, gate::*, record::Record};
use harness::{case::Tier, columns::Columns, declare::*, pictures, runs::Runs, study::Study};
use report::{Axis, Cell, ColourMap, Dots, Figure, Plot};

/// The declaration of a tier.
pub fn declaration(tier: Tier) -> Declaration {
    let table = table(tier);
    let level = |s: &VortexSettings| (1.0 / s.n as f64, format!("{0} x {0}", s.n));
    let mut ladders = LADDER.map(|variant| table.ladder(&[For::Ladder], variant, level));
    for ladder in ladders.iter_mut().filter(|of| of.variant == BEST && tier == Tier::Full) {
        let because = "The bound is what this program computed before, 1.95, with 0.3 either way. Errors of \
                       the sums fall as h^2, but those of the sound speed and the time step fall otherwise \
                       and partly cancel them, so theory gives no order at these spacings.";
        let (id, bound) = (format!("{NAME}.{BEST}.{DISTURBED}.order"), Bound::Within(1.6, 2.3));
        ladder.order = Some(Gate::new(id, "order", bound, Evidence::Regression, because));
    }
    let accuracy = Accuracy {
        about: "Taylor-Green vortices at Re 100 from the disturbed lattice, at t = 2 L/U.".into(),
        spacing: "dx/L [-]",
        ladders: ladders.into(),
        ..Accuracy::new("taylor-green", L2, "relative L2 error of the velocity [-]")
    };
    Declaration {
        curves: vec![histories(&table)],
        budgets: budgets(&table).filter(|_| tier == Tier::Full).unwrap_or_default(),
        accuracy: vec![accuracy],
        ..Declaration::default()
    }
}

/// One thing changed at a time, over the best variant at 50 x 50 from the disturbed lattice.
fn budgets(table: &Table) -> Option<Budgets> {
    let [base, finer] = [50, 100].map(|n| usual(table, BEST, n).map(|row| row.run.spec.clone()));
    let changed = |what: &str, part, set: fn(&mut VortexSettings)| {
        let spec = CASE.spec(BEST, |s| {
            s.perturb = DISTURBED;
            set(s);
        });
        Change::new(what, part, spec)
    };
    let changes = vec![
        Change::new("none", "none", base?),
        Change::new("dx/2", "spacing", finer?),
        changed("dt/3 (courant=0.5)", "time", |s| s.courant = 0.5),
        changed("c0=20", "sound speed", |s| s.c0 = 20.0),
        changed("h_over_dx=1.2", "h/dx", |s| s.h_over_dx = 1.2),
        changed("diffusion=0.05", "density diffusion", |s| s.diffusion = 0.05),
        changed("shift=2", "shifting", |s| s.shift = 2.0),
        changed("seed=2", "disorder", |s| s.seed = 2),
    ];
    let about = "Runs have 50 x 50 particles from the disturbed lattice at Re 100, to t = 2 L/U. The last \
                 row, with another disturbance, shows what is chance. A shorter step, faster sound and less \
                 diffusion all raise the error, because their parts have the sign opposite to that of the \
                 spacing and cancel some of it.";
    Some(Budgets { about: about.into(), of: vec![Budget { variant: BEST, changes }] })
}

/// Error through time, of each variant in its finest run of at most 50 x 50 particles.
fn histories(table: &Table) -> Curves {
    let caption = "Taylor-Green vortices at Re 100 from the disturbed lattice: relative L2 error of the \
                   velocity over time, of stabilised variants with the same number of particles and of \
                   `plain` with at least as many. Black marks the bound of the best variant, which applies \
                   at t = 2 L/U.";
    let has_all = |n: &usize| LADDER.iter().all(|of| usual(table, of, *n).is_some());
    let side = (1..=50).rev().find(has_all).unwrap_or(50);
    let plain = (side..=50).find_map(|n| usual(table, "plain", n));
    let shown = plain.into_iter().chain(LADDER.iter().filter_map(|of| usual(table, of, side)));
    let line = |row: &Row| CurveOf {
        name: format!("{}, {1} x {1}", row.variant, row.settings.n),
        spec: row.run.spec.clone(),
        points: Box::new(error),
    };
    let most = most_error(side);
    let (axes, name) = (["t [L/U]", "error of the velocity [-]"], format!("bound for {BEST}"));
    let bound = (name.as_str(), vec![(1.8, most), (2.0, most)]);
    let panel = CurvePanel::linear("", axes, shown.map(line).collect(), bound);
    let panel = CurvePanel { y: Axis::log(axes[1]), ..panel };
    let (id, title) = ("taylor-green-histories".into(), "Error through time".into());
    Curves { id, title, caption: caption.into(), panels: vec![panel] }
}

/// The error over time, without the start, at which there is none.
fn error(record: &Record) -> Vec<(f64, f64)> {
    let [t, error] = ["t", "error"].map(|name| record.column("series", name).iter().copied());
    t.zip(error).skip(1).collect()
}

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    vec![pictures(&table(tier), runs), all(runs)]
}

/// Every run.
fn all(runs: &Runs) -> Study {
    let caption = "All runs at their end, by default t = 2 L/U. The largest error is that over time. \
                   Momentum added is the change of the total momentum over the total mass, exactly 0 in \
                   theory.";
    let table = Columns::of_variants()
        .changed("settings", &CASE)
        .ended()
        .percent("error of the velocity", "-", L2, 1.0)
        .percent("largest error", "-", L2_WORST, 1.0)
        .percent("energy less exact", "-", ENERGY, 1.0)
        .percent("error of the pressure", "-", PRESSURE_L2, 1.0)
        .metric(["momentum added", "U"], MOMENTUM_ADDED, |v| Cell::sci(v, 2))
        .number("nearest pair", "dx", NEAREST)
        .table(caption, runs.simulations());
    Study::new("taylor-green-runs", "All runs").block(table)
}

/// Particles at the end, by their error.
fn pictures(table: &Table, runs: &Runs) -> Study {
    let caption = "Particles in half of the periodic box of Taylor-Green vortices at t = 2 L/U, Re 100, \
                   from the disturbed lattice, for variant `plain`, without stabilisers, and the best one, \
                   by the logarithm of the error of the velocity, where −2 is 1 %.";
    let mut figure = Figure::new("taylor-green-pictures", caption).columns(2);
    for row in table.rows.iter().filter(|row| is_pictured(row)) {
        let Some(record) = runs.completed(&row.run.spec) else { continue };
        let n = row.settings.n;
        let axis = |name: &str, end| Axis::linear(format!("{name} [L]")).range(0.0, end);
        let points = pictures::points(record, "particles", "error").into_iter();
        let lower = points.filter(|(_, y, _)| *y < 0.5);
        let points = lower.map(|(x, y, error)| (x, y, log10(error.max(1e-12)))).collect();
        let (title, label) = (format!("{}, {n} x {n}", row.variant), "log₁₀(error/exact speed)");
        let dots = Dots::new(label, ColourMap::Sequential, 1.0 / n as f64, points);
        let plot = Plot::new(title, axis("x", 1.0), axis("y", 0.5));
        figure = figure.panel(plot.layer(dots.values(-4.0, 0.0)));
    }
    Study::new("taylor-green-pictures", "Pictures").block(figure.panel_size(300.0, 170.0))
}
