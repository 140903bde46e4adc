//! The energy of a run of water through time, and what each term has done to it.

use base::record::{MetricKey, Profile, Record};
use harness::method::Medium;
use maths::metrics::{
    budget::{Account, DIFFUSION, Metered, STRESS, VISCOSITY, WALLS, XSPH},
    energy::{Energy, Water, water_slope},
};

base::metrics! {
    ENERGY_GAP = "energy_gap" ["-"] "max over samples of |E(t) - E(0) - work of all terms|/{}";
    WORK_VISCOSITY = "work_viscosity" ["-"]
        "energy that artificial viscosity has added until the end/{}";
    WORK_STRESS = "work_stress" ["-"] "energy that artificial stress has added until the end/{}";
    WORK_DIFFUSION = "work_diffusion" ["-"]
        "energy that density diffusion has added until the end/{}";
    WORK_XSPH = "work_xsph" ["-"] "energy that XSPH has added until the end/{}";
    WORK_WALLS = "work_walls" ["-"] "energy that walls has added until the end/{}";
}

/// The items of a budget: as accounts name them, and their metrics, which are columns of the series too.
pub const ITEMS: [(&str, MetricKey); 5] = [
    (VISCOSITY, WORK_VISCOSITY),
    (STRESS, WORK_STRESS),
    (DIFFUSION, WORK_DIFFUSION),
    (XSPH, WORK_XSPH),
    (WALLS, WORK_WALLS),
];

/// Keeps the budget of a run.
pub struct Ledger {
    water: Water,
    account: Account,
    /// t \[s\], kinetic, potential and compression energy, then the works of [`ITEMS`] \[J/m\].
    rows: Vec<[f64; 9]>,
}

impl Ledger {
    /// An empty ledger of water of this medium.
    pub fn new(medium: &Medium) -> Self {
        let water = Water { eos: medium.eos, gravity: medium.acceleration };
        Self { water, account: Account::default(), rows: Vec::new() }
    }

    /// Takes a sample of a simulation that has been brought to a time.
    pub fn sample(&mut self, simulation: &mut dyn Metered<()>) {
        let powers = simulation.powers(&water_slope(&self.water));
        self.account.add(simulation.time(), &powers);
        let Energy { kinetic, potential, compression } = self.water.energy(&*simulation);
        let [a, b, c, d, e] = ITEMS.map(|(name, _)| self.account.work(name));
        let time = simulation.time();
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
        record.put(ENERGY_GAP.of(of_what), self.gap() / scale);
        for (name, work) in ITEMS {
            record.put(work.of(of_what), self.account.work(name) / scale);
        }
        let names = ["t", "kinetic", "potential", "compression"].map(String::from);
        let names = names.into_iter().chain(ITEMS.map(|(_, work)| work.into()));
        let add = |profile: Profile, (k, name): (usize, String)| {
            let unit = if k == 0 { "s" } else { "J/m" };
            profile.with(&name, unit, self.rows.iter().map(|row| row[k]).collect())
        };
        let series = names.enumerate().fold(Profile::default(), add);
        record.profiles.insert("energy".into(), series);
    }
}
