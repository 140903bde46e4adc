//! The energy of a run of water through time, and what each term has done to it.

use solver::{Scheme, Simulation};

use base::record::{Metric, Profile, Record};
use maths::metrics::{
    budget::{Account, DIFFUSION, Itemised, Meter, STRESS, VISCOSITY, WALLS, XSPH},
    energy::{Energy, Water, water_slope},
};

/// The items of a budget, as metrics and figures name them.
pub const ITEMS: [(&str, &str); 5] = [
    (VISCOSITY, "work_viscosity"),
    (STRESS, "work_stress"),
    (DIFFUSION, "work_diffusion"),
    (XSPH, "work_xsph"),
    (WALLS, "work_walls"),
];

/// Keeps the budget of a scene with these terms.
pub struct Ledger<F, D> {
    water: Water,
    forces: F,
    drift: D,
    account: Account,
    /// t \[s\], kinetic, potential and compression energy, then the works of [`ITEMS`] \[J/m\].
    rows: Vec<[f64; 9]>,
}

impl<F: Itemised<()>, D: Itemised<()>> Ledger<F, D> {
    /// A ledger for the terms of a scene.
    pub fn new(water: Water, forces: &F, drift: &D) -> Self {
        let (account, rows) = (Account::default(), Vec::new());
        Self { water, forces: forces.clone(), drift: drift.clone(), account, rows }
    }

    /// Takes a sample of a simulation that has been brought to a time.
    pub fn sample<S: Scheme<Extra = ()>>(&mut self, simulation: &Simulation<S>) {
        let (slope, time) = (water_slope(&self.water), simulation.time());
        let meter = Meter::new(simulation, &slope);
        let mut powers = [self.forces.powers(&meter), self.drift.powers(&meter)].concat();
        powers.push((WALLS, meter.wall_power()));
        self.account.add(time, &powers);
        let Energy { kinetic, potential, compression } = self.water.energy(simulation);
        let [a, b, c, d, e] = ITEMS.map(|(name, _)| self.account.work(name));
        self.rows.push([time, kinetic, potential, compression, a, b, c, d, e]);
    }

    /// The largest |E(t) − E(0) − work(t)| so far \[J/m\].
    fn gap(&self) -> f64 {
        let balance = |row: &[f64; 9]| row[1] + row[2] + row[3] - row[4..].iter().sum::<f64>();
        let start = self.rows.first().map_or(0.0, balance);
        self.rows.iter().map(|row| (balance(row) - start).abs()).fold(0.0, f64::max)
    }

    /// Metrics relative to a scale \[J/m\], and the series.
    pub fn measure(&self, scale: f64, of_what: &str, record: &mut Record) {
        let mut put = |name: &str, value: f64, formula: String| {
            record.metrics.insert(name.into(), Metric::new(value, "-", &formula));
        };
        let formula = format!("max over samples of |E(t) - E(0) - work of all terms|/{of_what}");
        put("energy_gap", self.gap() / scale, formula);
        for (name, key) in ITEMS {
            let formula = format!("energy that {name} has added until the end/{of_what}");
            put(key, self.account.work(name) / scale, formula);
        }
        let names = ["t", "kinetic", "potential", "compression"];
        let names = names.into_iter().chain(ITEMS.map(|(_, key)| key));
        let add = |profile: Profile, (k, name): (usize, &str)| {
            let unit = if k == 0 { "s" } else { "J/m" };
            profile.with(name, unit, self.rows.iter().map(|row| row[k]).collect())
        };
        let series = names.enumerate().fold(Profile::default(), add);
        record.profiles.insert("energy".into(), series);
    }
}
