//! Where the energy of the rings goes: kinetic and elastic energy through time, and the work of each
//! term that is not elastic.

use harness::method::FromMedium;
use lagrangian::{Law, Load, Solid};
use solver::{
    ArtificialViscosity, CauchyStress, ConjugateStress, ConsistentContinuity,
    ConsistentJaumannRate, Continuity, JaumannRate, Kernel, Linear, Scheme, Simulation, Stepper,
    Symmetric, Term, terms::TensileStress,
};

use super::{
    Rings,
    metrics::{ENERGY_GAP, WORK_ELASTIC, WORK_STRESS, WORK_VISCOSITY},
};
use crate::solid::{Energy, solid_slope};
use base::record::{MetricKey, Profile, Record};
use maths::metrics::budget::{Account, Items, Meter, STRESS, VISCOSITY};

/// (9) to (12) with (3), which only exchange energy up to the third order in the strain: the stored
/// energy S:S/(4μρ) is that of small strains.
const ELASTIC: &str = "elastic law";

/// The items and the metrics of their works.
const ITEMS: [(&str, MetricKey); 3] =
    [(VISCOSITY, WORK_VISCOSITY), (STRESS, WORK_STRESS), (ELASTIC, WORK_ELASTIC)];

const COLUMNS: [(&str, &str); 7] = [
    ("t", "L/c0"),
    ("kinetic", "E(0)"),
    ("compression", "E(0)"),
    ("shear", "E(0)"),
    ("work_viscosity", "E(0)"),
    ("work_stress", "E(0)"),
    ("work_elastic", "E(0)"),
];

/// What a budget measures: it takes pair sweeps of its own.
pub const METRICS: [MetricKey; 4] = [ENERGY_GAP, WORK_VISCOSITY, WORK_STRESS, WORK_ELASTIC];

/// Forces with an artificial stress, or with none, `()`.
pub trait Stressed {
    /// The elastic law: forces and rates that only exchange energy.
    type Elastic: Term<Symmetric> + FromMedium;
    /// The same with the artificial stress.
    type Tensile: Term<Symmetric> + FromMedium;
}

impl<R: TensileStress + FromMedium> Stressed for CauchyStress<Linear, R> {
    type Elastic = (CauchyStress<Linear>, Continuity, JaumannRate);
    type Tensile = (Self, Continuity, JaumannRate);
}

impl<R: TensileStress + FromMedium> Stressed for ConjugateStress<Linear, R> {
    type Elastic = (ConjugateStress<Linear>, ConsistentContinuity, ConsistentJaumannRate);
    type Tensile = (Self, ConsistentContinuity, ConsistentJaumannRate);
}

impl<A: Stressed, B> Stressed for (A, B) {
    type Elastic = A::Elastic;
    type Tensile = A::Tensile;
}

/// A simulation of rubber that can say what its terms do to the energy.
pub trait Metered: Stepper<Symmetric> {
    /// The powers of the terms \[W/m\]. XSPH moves particles and changes neither velocity, density nor
    /// stress: it has no power of its own.
    fn powers(&self, rings: &Rings) -> Items;
}

impl<S: Scheme<Extra = Symmetric, Forces: Stressed>> Metered for Simulation<S> {
    fn powers(&self, rings: &Rings) -> Items {
        let (slope, medium) = (solid_slope(&rings.material), &rings.medium);
        let meter = Meter::new(self, &slope);
        let elastic = meter.power(&<S::Forces as Stressed>::Elastic::new(medium));
        let stressed = meter.power(&<S::Forces as Stressed>::Tensile::new(medium));
        let viscosity = meter.power(&<ArtificialViscosity<Linear> as FromMedium>::new(medium));
        vec![(ELASTIC, elastic), (STRESS, stressed - elastic), (VISCOSITY, viscosity)]
    }
}

/// Its forces derive from an energy, so that no term adds any.
impl<K: Kernel, L: Law, C: Load> Metered for Solid<K, L, C> {
    fn powers(&self, _: &Rings) -> Items {
        Items::new()
    }
}

/// The budget of a run.
#[derive(Default)]
pub struct Budget {
    account: Account,
    /// t \[s\], kinetic, compression and shear energy, then the works of [`ITEMS`] \[J/m\].
    rows: Vec<[f64; 7]>,
}

harness::observed! { Budget: changes(account, rows), parts(), stays() }

impl Budget {
    /// Takes a sample of a simulation that has been brought to a time.
    pub fn sample(&mut self, rings: &Rings, simulation: &dyn Metered) {
        self.account.add(simulation.time(), &simulation.powers(rings));
        let Energy { kinetic, compression, shear, .. } = Energy::of(simulation, &rings.material);
        let [a, b, c] = ITEMS.map(|(name, _)| self.account.work(name));
        self.rows.push([simulation.time(), kinetic, compression, shear, a, b, c]);
    }

    /// Works and the gap of the budget over the energy at the start, and the series.
    pub fn measure(&self, rings: &Rings, record: &mut Record) {
        let total = |row: &[f64; 7]| row[1] + row[2] + row[3];
        let Some(start) = self.rows.first().map(total).filter(|energy| *energy > 0.0) else {
            return;
        };
        let gap = |row: &[f64; 7]| (total(row) - start - row[4] - row[5] - row[6]).abs();
        let gap = self.rows.iter().map(gap).fold(0.0, f64::max) / start;
        record.put(ENERGY_GAP, gap);
        for (name, work) in ITEMS {
            record.put(work, self.account.work(name) / start);
        }
        let scaled = |row: &[f64; 7]| {
            let mut scaled = row.map(|energy| energy / start);
            scaled[0] = row[0] / (1.0 / rings.c0);
            scaled
        };
        let rows: Vec<[f64; 7]> = self.rows.iter().map(scaled).collect();
        record.profiles.insert("budget".into(), Profile::of_rows(&COLUMNS, &rows));
    }
}
