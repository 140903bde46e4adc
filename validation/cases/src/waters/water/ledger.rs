//! The balances of a run of water: its energy through time against the work of each term, and its momentum
//! against the impulse of walls and gravity.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{absent::Absent, record::MetricKey};
use touchstone_harness::prelude::*;
use touchstone_harness::snapshot::Snapshot;
use touchstone_maths::metrics::{
    budget::{EnergyItems, Metered},
    energy::{FluidEnergy, Water, water_slope},
};

touchstone_base::metrics! {
    ENERGY_GAP = "energy_gap" ["-"] "max over samples of |E(t) - E(0) - work of all terms|/{}";
    WORK_VISCOSITY = "work_viscosity" ["-"]
        "energy that artificial viscosity has added until the end/{}";
    WORK_STRESS = "work_stress" ["-"] "energy that artificial stress has added until the end/{}";
    WORK_DAMPER = "work_damper" ["-"] "energy that the acoustic damper has added until the end/{}";
    WORK_DIFFUSION = "work_diffusion" ["-"]
        "energy that density diffusion has added until the end/{}";
    WORK_XSPH = "work_xsph" ["-"] "energy that XSPH has added until the end/{}";
    WORK_WALLS = "work_walls" ["-"] "energy that walls has added until the end/{}";
}

/// The profile of the energies.
const PROFILE: &str = "energy";
const TIME: ColumnKey = ColumnKey::new(PROFILE, "t", "s");
/// Kinetic energy.
pub const KINETIC: ColumnKey = ColumnKey::new(PROFILE, "kinetic", "J/m");
const POTENTIAL: ColumnKey = ColumnKey::new(PROFILE, "potential", "J/m");
const COMPRESSION: ColumnKey = ColumnKey::new(PROFILE, "compression", "J/m");

/// The energy that a term has added, over time, as its metric is named.
pub const fn column(work: MetricKey) -> ColumnKey {
    work.column(PROFILE, "J/m")
}

/// The energy of a term.
type WorkOf = fn(&EnergyItems) -> f64;

/// The works of terms, which are columns of the series too.
const WORKS: [(MetricKey, WorkOf); 6] = [
    (WORK_VISCOSITY, |of| of.viscosity),
    (WORK_STRESS, |of| of.stress),
    (WORK_DAMPER, |of| of.damper),
    (WORK_DIFFUSION, |of| of.diffusion),
    (WORK_XSPH, |of| of.xsph),
    (WORK_WALLS, |of| of.walls),
];

/// Metrics of a ledger, which needs pair sweeps of its own.
pub const METRICS: [MetricKey; 7] =
    [ENERGY_GAP, WORK_VISCOSITY, WORK_STRESS, WORK_DAMPER, WORK_DIFFUSION, WORK_XSPH, WORK_WALLS];

/// Keeps the balances of a run.
#[derive(Default, Serialize, Deserialize)]
pub struct Ledger {
    /// At the last sample.
    powers: EnergyItems,
    /// Momentum at the start \[kg/s\], force at the last sample \[N/m\], impulse since the start by the
    /// trapezoidal rule, and the largest difference of momentum that it does not explain \[kg/s\].
    start: Vector2<f64>,
    force: Vector2<f64>,
    impulse: Vector2<f64>,
    unexplained: f64,
    samples: Vec<Sample>,
}

/// The energy of the water at one time.
#[derive(Serialize, Deserialize)]
struct Sample {
    /// \[s\].
    time: f64,
    /// \[J/m\].
    energy: FluidEnergy,
    /// Works of terms since the first sample \[J/m\].
    works: EnergyItems,
}

impl Sample {
    /// The energy that no work explains \[J/m\].
    fn balance(&self) -> f64 {
        self.energy.sum() - self.works.sum()
    }
}

impl Ledger {
    /// Takes a sample of a simulation that has been brought to a time.
    pub fn sample(&mut self, medium: &Medium, simulation: &mut dyn Metered<()>) {
        let water = Water { eos: medium.eos, gravity: medium.acceleration };
        let (powers, pairs) = simulation.powers(&water_slope(&water));
        let time = simulation.time();
        self.balance_momentum(&*simulation, water.gravity, pairs);
        let (energy, works) = (water.energy(&*simulation), self.works(time, powers));
        self.samples.push(Sample { time, energy, works });
        self.powers = powers;
    }

    /// Works from the first sample to a time, by the trapezoidal rule over the powers of each sample;
    /// negative for a term that takes energy from the particles.
    fn works(&self, time: f64, powers: EnergyItems) -> EnergyItems {
        let Some(last) = self.samples.last() else { return EnergyItems::default() };
        let half = 0.5 * (time - last.time);
        let added = powers.with(self.powers, |now, before| half * (now + before));
        last.works.with(added, |work, more| work + more)
    }

    /// Adds the impulse since the last sample; `pairs` is the force of all pairs on the water \[N/m\].
    fn balance_momentum(
        &mut self,
        simulation: &dyn Stepper<()>,
        gravity: Vector2<f64>,
        pairs: Vector2<f64>,
    ) {
        let (mut momentum, mut force) = (Vector2::zeros(), pairs);
        for (mass, p) in simulation.data().fluid() {
            momentum += p.velocity * mass;
            force += gravity * mass;
        }
        match self.samples.last() {
            None => self.start = momentum,
            Some(last) => {
                self.impulse += (self.force + force) * (0.5 * (simulation.time() - last.time));
                let gap = (momentum - self.start - self.impulse).norm();
                self.unexplained = self.unexplained.max(gap);
            }
        }
        self.force = force;
    }

    /// The largest change of momentum that walls and gravity do not explain \[kg/s\]; NaN without a sample.
    pub fn unexplained_momentum(&self) -> f64 {
        if self.samples.is_empty() { f64::NAN } else { self.unexplained }
    }

    /// Were samples taken until this end?
    ///
    /// # Errors
    /// An error is the reason: the run belongs to another code, or the balances were not requested.
    pub fn sampled(&self, end: &Snapshot) -> Result<(), Absent> {
        end.simulation()?;
        if self.samples.is_empty() { Err(Absent::NotAsked) } else { Ok(()) }
    }

    /// The largest |E(t) − E(0) − work(t)| so far \[J/m\].
    fn gap(&self) -> f64 {
        let start = self.samples.first().map_or(0.0, Sample::balance);
        self.samples.iter().map(|of| (of.balance() - start).abs()).fold(0.0, f64::max)
    }

    /// Metrics relative to a scale \[J/m\], and the series, if samples were taken of our run.
    pub fn measure(&self, end: &Snapshot, scale: f64, of_what: &str, record: &mut Record) {
        if let Err(absent) = self.sampled(end) {
            return record.leave_all_out(&METRICS, &absent);
        }
        record.put(ENERGY_GAP.of(of_what), self.gap() / scale);
        let works = self.samples.last().map(|of| of.works).unwrap_or_default();
        record.put_column(TIME, &self.samples, |of| of.time);
        record.put_column(KINETIC, &self.samples, |of| of.energy.kinetic);
        record.put_column(POTENTIAL, &self.samples, |of| of.energy.potential);
        record.put_column(COMPRESSION, &self.samples, |of| of.energy.compression);
        for (metric, work) in WORKS {
            record.put(metric.of(of_what), work(&works) / scale);
            record.put_column(column(metric), &self.samples, |of| work(&of.works));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_harness::method::Parts;
    use touchstone_schemes::water::modern;
    use touchstone_solver::{Domain, Particle, Tait};

    /// Water of three particles without neighbours, raised and moving.
    fn particles(medium: &Medium, height: f64, v: Vector2<f64>) -> Box<dyn Metered<()>> {
        let place = |k: usize| Vector2::new(k as f64, height);
        let particle = |k| Particle::fluid(place(k), v, 1000.0, 0.001 * (k + 1) as f64);
        let particles = (0..3).map(particle).collect();
        let parts = Parts::new(*medium, Domain::open(), particles);
        let mut simulation = (modern().build)(parts).expect("a scene");
        simulation.advance(0.0, 1.0, &mut ());
        simulation
    }

    #[test]
    fn momentum_that_no_force_explains_is_the_gap() {
        let medium = modern().properties.medium(Tait::new(1000.0, 20.0), 0.01, 0.015);
        let medium = Medium { acceleration: Vector2::new(0.0, -10.0), ..medium };
        // A free fall: gravity supplies the momentum of the water.
        let mut falling = particles(&medium, 0.0, Vector2::zeros());
        let mut ledger = Ledger::default();
        for k in 0..4 {
            falling.advance(0.01 * f64::from(k), 1e-3, &mut ());
            ledger.sample(&medium, &mut *falling);
        }
        assert!(ledger.unexplained_momentum() < 1e-12, "{:e}", ledger.unexplained_momentum());
        // A kick of all masses, of 6 kg/m, and then a smaller one: the largest counts.
        let mut ledger = Ledger::default();
        let medium = Medium { acceleration: Vector2::zeros(), ..medium };
        for v in [Vector2::zeros(), Vector2::new(0.3, 0.4), Vector2::new(0.1, 0.0)] {
            ledger.sample(&medium, &mut *particles(&medium, 0.0, v));
        }
        assert!((ledger.unexplained_momentum() - 6.0 * 0.5).abs() < 1e-9);
    }

    fn items([viscosity, stress, damper, diffusion, xsph, walls]: [f64; 6]) -> EnergyItems {
        EnergyItems { viscosity, stress, damper, diffusion, xsph, walls }
    }

    #[test]
    fn energy_that_no_term_gave_is_the_gap_and_works_are_integrals_over_the_scale() {
        let medium = modern().properties.medium(Tait::new(1000.0, 20.0), 0.01, 0.015);
        let medium = Medium { acceleration: Vector2::new(0.0, -10.0), ..medium };
        let mut ledger = Ledger::default();
        // 6 kg/m: at rest; 0.2 m higher, 12 J/m; at 3 m/s, 27 J/m.
        for (height, v) in [(0.0, 0.0), (0.2, 0.0), (0.0, 3.0)] {
            ledger.sample(&medium, &mut *particles(&medium, height, Vector2::new(v, 0.0)));
        }
        let [raised, moving] = [&ledger.samples[1].energy, &ledger.samples[2].energy];
        assert!((raised.potential - 12.0).abs() < 1e-9 && (moving.kinetic - 27.0).abs() < 1e-9);
        assert!((ledger.gap() - 27.0).abs() < 1e-9, "{}", ledger.gap());
        let mut record = Record::new("dam_break", "modern", serde_json::json!({}), 1);
        let end = particles(&medium, 0.0, Vector2::zeros());
        let end = Snapshot::ours(&*end);
        ledger.measure(&end, 50.0, "it", &mut record);
        let gap = record.value(ENERGY_GAP).expect("a metric");
        assert!((gap - 27.0 / 50.0).abs() < 1e-12);
        // Each term with a power that rises at its own rate for 3 s.
        ledger.samples.clear();
        for time in [0.0, 1.0, 3.0] {
            let powers = items([1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|k| k * time));
            let (energy, works) = (FluidEnergy::default(), ledger.works(time, powers));
            ledger.samples.push(Sample { time, energy, works });
            ledger.powers = powers;
        }
        ledger.measure(&end, 50.0, "it", &mut record);
        for (k, (metric, _)) in WORKS.into_iter().enumerate() {
            let work = record.value(metric).expect("a metric");
            assert!((work - 4.5 * (k + 1) as f64 / 50.0).abs() < 1e-12, "{metric:?}");
        }
        // Work of terms leaves no gap, unless it is missing in the energy.
        let sample = |time, kinetic, compression, works| {
            let energy = FluidEnergy { kinetic, compression, ..FluidEnergy::default() };
            Sample { time, energy, works: items(works) }
        };
        ledger.samples = vec![
            sample(0.0, 0.0, 0.0, [0.0; 6]),
            sample(1.0, 3.0, 2.0, [3.0, 0.0, 0.0, 0.0, 1.5, 0.5]),
        ];
        assert!(ledger.gap() < 1e-12, "{}", ledger.gap());
        ledger.samples.push(sample(3.0, 0.0, 0.0, [1.0, 2.0, 0.0, 5.0, 0.0, -4.0]));
        assert!((ledger.gap() - 4.0).abs() < 1e-12, "{}", ledger.gap());
    }
}
