//! What the studies that every case has are made of: error through time, pictures, order, error against run
//! time, error budget.

use super::{BEST, CASE, NAME, VortexSettings, plan::*, run::*};
use base::{gate::*, record::Record};
use harness::{case::Tier, declare::*};
use report::{Axis, ColourMap};

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
        curves: vec![histories(tier, &table)],
        pictures: vec![picture(&table)],
        budgets: (tier == Tier::Full).then(budgets).unwrap_or_default(),
        accuracy: vec![accuracy],
        ..Declaration::default()
    }
}

/// One thing changed at a time, over the best variant at 50 x 50 from the disturbed lattice.
fn budgets() -> Budgets {
    let changed = |what: &str, part, set: fn(&mut VortexSettings)| {
        let spec = CASE.spec(BEST, |s| {
            s.perturb = DISTURBED;
            set(s);
        });
        Change::new(what, part, spec)
    };
    let pictured = CASE.spec(BEST, |s| s.perturb = DISTURBED).keep_particles();
    let changes = vec![
        Change::new("none", "none", pictured),
        changed("dx/2", "spacing", |s| s.n = 100),
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
    Budgets { about: about.into(), of: vec![Budget { variant: BEST, changes }] }
}

/// Error through time, of each variant that keeps particles apart with the same number of particles, and of
/// `plain`.
fn histories(tier: Tier, table: &Table) -> Curves {
    let caption = "Taylor-Green vortices at Re 100 from the disturbed lattice: relative L2 error of the \
                   velocity over time, of stabilised variants with the same number of particles and of \
                   `plain` with at least as many. Black marks the bound of the best variant, which applies \
                   at t = 2 L/U.";
    let side = if tier == Tier::Quick { 24 } else { 50 };
    let stabilised = table.of(For::Ladder).filter(|row| row.settings.n == side);
    let shown = stabilised.chain(table.of(For::Control));
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
    Curves { id, title, caption: caption.into(), columns: 1, panels: vec![panel] }
}

/// The error over time, without the start, at which there is none.
fn error(record: &Record) -> Vec<(f64, f64)> {
    let [t, error] = ["t", "error"].map(|name| record.column("series", name).iter().copied());
    t.zip(error).skip(1).collect()
}

/// Particles at the end, by their error.
fn picture(table: &Table) -> Picture {
    let caption = "Particles of Taylor-Green vortices at t = 2 L/U, Re 100, from the disturbed lattice, for \
                   variant `plain`, without stabilisers, and the best one, by the error of the velocity.";
    let texts = ["taylor-green-pictures", "Pictures", caption];
    let colours = ("error/exact speed [-]", ColourMap::Sequential);
    table.picture(texts, colours, [300.0, 270.0], |row| {
        let n = row.settings.n;
        (format!("{}, {n} x {n}", row.variant), 1.0 / n as f64)
    })
}
