//! The runs that several studies ask for: both experiments over resolutions and variants.

use super::{DAM_BREAK, lobovsky};
use base::spec::RunSpec;
use harness::case::{Planned, Tier};

/// The variants that are judged.
pub const JUDGED: [&str; 3] = ["seed", "ghosts", "modern"];

/// Walls that images with other velocities make, judged by what holds whatever the water does. They are not
/// compared with the experiments: along the one the water slips, along the other artificial viscosity drags
/// it, in a layer as thick as the support, and neither is the wall of the experiment.
pub const OTHER_IMAGES: [&str; 2] = ["ghosts-slip", "ghosts-split"];

/// Spacings along the width of the column of Martin & Moyce. At 80 the seed would take as long as half
/// of all other runs of this case; three resolutions of it are 10, 20 and 40.
pub fn martin_moyce(variant: &str, tier: Tier) -> &'static [usize] {
    match (tier, variant) {
        (Tier::Quick, "modern") => &[20, 40],
        (Tier::Quick, _) | (Tier::Full, "ghosts" | "ghosts-slip" | "ghosts-split") => &[20],
        (Tier::Full, "modern") => &[10, 20, 40, 80],
        (Tier::Full, _) => &[10, 20, 40],
    }
}

/// Spacings along the height of the column of Lobovsky et al.
pub fn in_tank(variant: &str, tier: Tier) -> &'static [usize] {
    match (tier, variant) {
        (Tier::Quick, "modern") => &[30],
        (Tier::Quick, _) | (Tier::Full, "ghosts-slip") => &[],
        (Tier::Full, "modern") => &[30, 60, 120],
        (Tier::Full, _) => &[30],
    }
}

/// Roughly what a run takes \[s\], `whole` being what `modern` takes at the spacing of `n`: particles times
/// steps, and two right-hand sides a step where the seed's integrator is.
fn seconds(variant: &str, whole: f64, n: usize, of: usize) -> f64 {
    let dear = if variant.starts_with("modern") { 1.0 } else { 2.5 };
    whole * dear * (n as f64 / of as f64).powi(3)
}

/// The same run with the particles of its pictures, if there are pictures of it: of the finest of `modern`.
fn pictured(spec: RunSpec, n: usize, ladder: &[usize]) -> RunSpec {
    let is_finest = spec.variant == "modern" && ladder.last() == Some(&n);
    if is_finest { spec.keep_particles() } else { spec }
}

/// The column of Martin & Moyce.
pub fn free(tier: Tier, variant: &str, n: usize) -> RunSpec {
    pictured(DAM_BREAK.spec(variant, |s| s.n = n), n, martin_moyce(variant, tier))
}

/// The same as a run of a plan, without gates.
pub fn planned_free(tier: Tier, variant: &str, n: usize) -> Planned {
    Planned::new(free(tier, variant, n)).taking(seconds(variant, 6.0, n, 40))
}

/// The tank of Lobovsky et al.
pub fn tank(tier: Tier, variant: &str, n: usize) -> RunSpec {
    let spec = DAM_BREAK.spec(variant, |s| {
        lobovsky(s);
        s.n = n;
    });
    pictured(spec, n, in_tank(variant, tier))
}

/// The same as a run of a plan, without gates.
pub fn planned_tank(tier: Tier, variant: &str, n: usize) -> Planned {
    Planned::new(tank(tier, variant, n)).taking(seconds(variant, 5.0, n, 30))
}

/// The judged runs of the column of Martin & Moyce.
pub fn all_free(tier: Tier) -> impl Iterator<Item = RunSpec> {
    let of =
        move |variant| martin_moyce(variant, tier).iter().map(move |n| free(tier, variant, *n));
    JUDGED.into_iter().flat_map(of)
}

/// The judged runs of the tank of Lobovsky et al.
pub fn all_in_tank(tier: Tier) -> impl Iterator<Item = RunSpec> {
    let of = move |variant| in_tank(variant, tier).iter().map(move |n| tank(tier, variant, *n));
    JUDGED.into_iter().flat_map(of)
}

/// Pictures of the film, and spacings along the height of its column.
pub const FRAMES: usize = 21;
pub const FILM_ROWS: usize = 15;

/// The tank as a film: `modern` with a picture every quarter of √(H/g).
pub fn film(tier: Tier) -> RunSpec {
    tank(tier, "modern", FILM_ROWS).keep_pictures(FRAMES)
}
