//! Finite elements of the bar, and the distance from them.

use ::lagrangian::{Hencky, Law as _, NeoHookean, SaintVenantKirchhoff};
use base::{
    record::Record,
    reference::{Reference as Package, ReferenceError},
};

use super::{
    COMPARED, CantileverSettings, FIRST_LEAST_Y, NEO_HOOKEAN, PATH_RMS, SAINT_VENANT,
    path::HARMONIC_Y,
};
use crate::solid::{Path, Quantities};

/// The law that a variant is compared with, as the tables name it. Those of the paper solve (10) to (12), of
/// which there is no table: of the three it is nearest to that of Hencky, which has the same pressure.
fn law(variant: &str) -> &'static str {
    match variant {
        NEO_HOOKEAN => NeoHookean::NAME,
        SAINT_VENANT => SaintVenantKirchhoff::NAME,
        _ => Hencky::NAME,
    }
}

/// Finite elements under one load.
pub struct Reference {
    quantities: Quantities,
    /// Of the middle of the end; empty under the small load.
    pub path: Path,
}

/// Why a run has no distance from finite elements.
const NOT_COMPUTED: &str = "finite elements have bars of 0.35 m and 0.02 m, 1.4 MPa, Poisson's ratio 0.4, \
                            1000 kg/m^3, under 2 and 0.2 m/s^2";

/// Why it has none of what is measured over the whole time.
const SHORTER: &str = "finite elements were measured over 4 s";

impl Reference {
    /// That of a variant with these settings; `None` where nothing was computed for them.
    pub fn of(variant: &str, settings: &CantileverSettings) -> Option<Self> {
        let (s, default) = (settings, CantileverSettings::default());
        let bar = |s: &CantileverSettings| (s.length, s.thickness, s.young, s.poisson, s.rho);
        let is_same = bar(s) == bar(&default);
        is_same.then(|| Self::at(law(variant), s.gravity).ok().flatten()).flatten()
    }

    fn at(law: &str, gravity: f64) -> Result<Option<Self>, ReferenceError> {
        let package = Package::load("cantilever")?;
        let gravity = format!("{gravity:?}");
        let of = [("law", law), ("gravity", &*gravity)];
        let path = Path::of(package.table("series")?, ["x", "y"], &of)?;
        let middle = [of[0], of[1], ("layers", "")];
        let quantities = Quantities::of(package.table("summary")?, &middle)?;
        let reference = Self { quantities, path };
        Ok(reference.number(HARMONIC_Y).is_some().then_some(reference))
    }

    /// A quantity and its uncertainty.
    pub fn number(&self, quantity: base::record::MetricKey) -> Option<[f64; 2]> {
        self.quantities.get(&String::from(quantity))
    }
}

/// Puts the distances of a run that has been measured.
pub fn compare(settings: &CantileverSettings, path: &Path, record: &mut Record) {
    let Some(exact) = Reference::of(&record.variant, settings) else {
        for metric in COMPARED.map(|(_, error)| error).into_iter().chain([PATH_RMS]) {
            record.leave_out(metric, NOT_COMPUTED);
        }
        return;
    };
    let is_whole = settings.end == CantileverSettings::default().end;
    for (quantity, error) in COMPARED {
        let is_over = is_whole || String::from(quantity) == String::from(FIRST_LEAST_Y);
        match record.value(quantity).zip(exact.number(quantity)) {
            Some((found, [value, _])) if is_over => record.put(error, found / value - 1.0),
            Some(_) => record.leave_out(error, SHORTER),
            None => record.leave_out(error, "the run is too short for it"),
        }
    }
    match exact.number(HARMONIC_Y) {
        Some([amplitude, _]) if !exact.path.0.is_empty() => {
            record.put(PATH_RMS, path.distance(&exact.path) / amplitude);
        }
        _ => record.leave_out(PATH_RMS, "finite elements have no path under this load"),
    }
}
