//! A clamped elastic bar that begins to swing under its own weight, against finite elements.

mod end;
mod plan;

use std::f64::consts::TAU;

use nalgebra::Vector2;
use touchstone_base::record::MetricKey;
use touchstone_harness::prelude::*;
use touchstone_harness::snapshot::Snapshot;
use touchstone_maths::exact::thin_plate::ThinPlate;
use touchstone_schemes::total;
use touchstone_solver::lagrangian::{Hencky, Law, SaintVenantKirchhoff};
use touchstone_solver::{Role, Symmetric};

use crate::solids::solid::{
    self, ElasticBody, Elements, LAGRANGIAN, Path, SolidParameters, SolidScales, SolidSettings,
    TOTAL, Watch, lagrangian,
};
use end::{
    AMPLITUDE_X, AMPLITUDE_Y, AVERAGE_X, AVERAGE_Y, End, EnergySample, FIRST_LEAST_Y, FREQUENCY,
    HARMONIC_X, HARMONIC_Y, MEAN_X, MEAN_Y,
};

touchstone_base::settings! {
    /// Settings of a bar that is held at x = 0 and has weight from t = 0 on.
    pub struct CantileverSettings {
        /// particles through the thickness
        n: usize ["-"] in 2..=1000 = 10,
        /// free length, without the clamp
        length: f64 ["m"] in 1e-9..=1e6 = 0.35,
        /// thickness
        thickness: f64 ["m"] in 1e-9..=1e6 = 0.02,
        /// acceleration of gravity, across the bar
        gravity: f64 ["m/s^2"] in 1e-9..=1e9 = 2.0,
        /// end of the run
        end: f64 ["s"] in 1e-9..=1e9 = 4.0,
        /// settings of solids
        solid: SolidSettings
            = SolidSettings { young: 1.4e6, poisson: 0.4, ..SolidSettings::default() },
    }
}

/// A bar under its own weight.
pub static CANTILEVER: Composed<CantileverSettings> = Composed {
    name: "cantilever",
    problem: "A clamped elastic bar swings under its own weight",
    recommended: Recommended {
        variant: LAGRANGIAN,
        because: "with 5 layers its end falls like finite elements up to -0.4 \
                  %<!-- cantilever.lagrangian; n=5 end=0.75; first_least_y_error -->, and bodies of the \
                  paper's variant bend too far with few layers",
        papers: Some("seed"),
    },
    about: "An elastic bar, held at one end and at rest without stress, begins to swing when its weight \
            begins to act: shape, material and load are those of the test CSM3 of Turek & Hron (2006). The \
            path of its end is compared with finite elements of the same bar and law.",
    variants,
    facts: plan::facts,
    studies: plan::studies,
};

touchstone_base::metrics! {
    all ALL;
    ENERGY_CHANGE = "energy_change" ["-"]
        "kinetic and strain energy and that of the weight: the greatest change from the start, over the \
         greatest kinetic energy";
    BENDING_FREQUENCY_ERROR = "bending_frequency_error" ["-"]
        "frequency over that of finite elements, over the root of the theory's stiffness of so many layers \
         over E H^3/(12 (1 - nu^2)), minus 1";
    BENDING_SAG_ERROR = "bending_sag_error" ["-"]
        "average_y over that of finite elements, times this stiffness, minus 1";
    PATH_RMS = "path_rms" ["-"]
        "root of the mean square of the distance of the end from finite elements until 0.75 s, in the first \
         swing, over their amplitude harmonic_y";
}

/// Quantities with their differences from finite elements.
const COMPARED: [(MetricKey, MetricKey); 10] = [
    (MEAN_X, error("mean_x_error")),
    (MEAN_Y, error("mean_y_error")),
    (AMPLITUDE_X, error("amplitude_x_error")),
    (AMPLITUDE_Y, error("amplitude_y_error")),
    (FREQUENCY, FREQUENCY_ERROR),
    (AVERAGE_X, AVERAGE_X_ERROR),
    (AVERAGE_Y, AVERAGE_Y_ERROR),
    (HARMONIC_X, HARMONIC_X_ERROR),
    (HARMONIC_Y, HARMONIC_Y_ERROR),
    (FIRST_LEAST_Y, FIRST_LEAST_Y_ERROR),
];
/// The end of short runs, after the first swing \[s\].
const FIRST_SWING: f64 = 0.75;
/// Metrics that need the energies of every step.
const STEPWISE: &[MetricKey] = &[ENERGY_CHANGE];
/// Metrics that compare with the theory of our own method.
const OF_METHODS: &[MetricKey] = &[BENDING_FREQUENCY_ERROR, BENDING_SAG_ERROR];
const FREQUENCY_ERROR: MetricKey = error("frequency_error");
const AVERAGE_X_ERROR: MetricKey = error("average_x_error");
const AVERAGE_Y_ERROR: MetricKey = error("average_y_error");
const HARMONIC_X_ERROR: MetricKey = error("harmonic_x_error");
const HARMONIC_Y_ERROR: MetricKey = error("harmonic_y_error");
const FIRST_LEAST_Y_ERROR: MetricKey = error("first_least_y_error");

/// A difference from finite elements.
const fn error(name: &'static str) -> MetricKey {
    MetricKey::new(name, "-", "the same over that of finite elements of this law, minus 1")
}

/// The total Lagrangian variant of another law.
const SAINT_VENANT: &str = "lagrangian-saint-venant";

fn variants() -> Compositions<CantileverSettings> {
    let papers = "the paper's, with weight: predictor-corrector, artificial viscosity, artificial stress in \
                  principal axes, XSPH";
    let law = "the same with the stored energy of St. Venant and Kirchhoff, the law of the test CSM3: does \
               the law matter?";
    solid::no_variants()
        .with("seed", papers, touchstone_schemes::solid::heavy_seed(), |_| {})
        .with(LAGRANGIAN, TOTAL, total::hencky(), |s| lagrangian::choose(s))
        .with(SAINT_VENANT, law, total::saint_venant_kirchhoff(), |s| lagrangian::choose(s))
        .all
}

/// Finite elements of the middle of the end, for the law of a variant; `None` where nothing was computed. The
/// paper's variants solve (10) to (12), for which there is no table: the nearest law is Hencky's, which has
/// the same pressure. The path is empty under the small load.
fn elements(variant: &str, s: &CantileverSettings) -> Option<Elements> {
    let bar = |s: &CantileverSettings| {
        (s.length, s.thickness, s.solid.young, s.solid.poisson, s.solid.rho)
    };
    if bar(s) != bar(&CantileverSettings::default()) {
        return None;
    }
    let law = if variant == SAINT_VENANT { SaintVenantKirchhoff::NAME } else { Hencky::NAME };
    let gravity = format!("{:?}", s.gravity);
    let of @ [law, gravity] = [("law", law), ("gravity", &*gravity)];
    let middle = [law, gravity, ("layers", "")];
    let mut found = Elements::of("cantilever", [&middle, &of], ["x", "y"])?;
    // Later, bars of another period are wherever they are.
    found.path.0.retain(|at| at.time <= FIRST_SWING);
    found.number("harmonic_y").is_some().then_some(found)
}

impl ElasticBody for CantileverSettings {
    type Watch = End;

    fn common(&self) -> SolidParameters {
        self.solid.common()
    }

    /// The speed of the end of a thin bar, which swings by its sag 3 ρ g L⁴ (1 − ν²)/(2 E H²) to either side;
    /// at most the speed of a rigid bar that falls to the vertical.
    fn scales(&self) -> SolidScales {
        let Self { length, thickness, gravity, .. } = *self;
        let SolidSettings { young, poisson, rho, .. } = self.solid;
        let modulus = young / (1.0 - poisson * poisson);
        let slenderness = length * length / thickness;
        let period = ThinPlate { length, thickness, young, poisson, density: rho }.period();
        let sag = 1.5 * rho * gravity / modulus * slenderness * slenderness;
        SolidScales {
            speed: (sag * (TAU / period)).min((3.0 * gravity * length).sqrt()),
            end: self.end,
            gravity: Vector2::new(0.0, -gravity),
            ..SolidScales::of_layers(self.n, [length, thickness])
        }
    }

    /// Free particles, row by row from the clamp, then the particles of the clamp. The width of columns
    /// follows from the length: of 5 layers, 88 columns are 0.6 % narrower than the layers are thick.
    fn particles(&self) -> Vec<Particle<Symmetric>> {
        let (columns, dy) = (self.columns(), self.dx());
        let dx = self.length / columns as f64;
        let held = (2.0 * self.solid.h_over_dx).ceil() as usize;
        let row = |first: f64, columns: usize| {
            let place = move |row: usize, column: usize| {
                let x = (first + column as f64 + 0.5) * dx;
                Vector2::new(x, (row as f64 + 0.5) * dy - 0.5 * self.thickness)
            };
            let at = move |x| Particle::fluid(x, Vector2::zeros(), self.solid.rho, dx * dy);
            (0..self.n).flat_map(move |row| (0..columns).map(move |column| at(place(row, column))))
        };
        let held = row(-(held as f64), held).map(|p| p.with_role(Role::Wall));
        row(0.0, columns).chain(held).collect()
    }

    fn watch(&self, _: &Snapshot<Symmetric>, _: &Snapshot<Symmetric>) -> End {
        End { until: 0.0, path: Path::start(), energies: vec![EnergySample::start()] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// With 5 layers 87.5 spacings would make the length; the columns fill it, and the clamp goes on.
    #[test]
    fn the_bar_has_its_length_and_its_mass_with_any_number_of_layers() {
        for n in [4, 5, 10] {
            let s = CantileverSettings { n, ..CantileverSettings::default() };
            let all = s.particles();
            let free: Vec<_> = all.iter().filter(|p| p.role == Role::Fluid).collect();
            let mass = free.iter().fold(0.0, |sum, p| sum + p.mass);
            assert_relative_eq!(mass, 1000.0 * 0.35 * 0.02, max_relative = 1e-12);
            let last = free[s.columns() - 1].position.x;
            let first = free[0].position.x;
            assert_relative_eq!(first + last, 0.35, max_relative = 1e-12);
            let held = all.iter().filter(|p| p.role == Role::Wall);
            let nearest = held.map(|p| p.position.x).fold(f64::NEG_INFINITY, f64::max);
            assert_relative_eq!(nearest, -first, max_relative = 1e-12);
            let middle = free.iter().fold(0.0, |sum, p| sum + p.mass * p.position.y);
            assert!(middle.abs() < 1e-15);
        }
    }

    /// The load of the test is large: its bar reaches 0.46 m/s; a soft one does not fall faster than freely.
    #[test]
    fn the_speed_is_that_of_a_thin_bar_or_of_one_that_falls() {
        let s = CantileverSettings::default();
        assert_relative_eq!(s.speed(), 0.46, max_relative = 0.02);
        let solid = SolidSettings { young: 1.0, ..s.solid };
        let soft = CantileverSettings { solid, ..s };
        assert_relative_eq!(soft.speed(), (3.0_f64 * 2.0 * 0.35).sqrt(), max_relative = 1e-12);
    }

    /// No column of particles was left, and the run panicked.
    #[test]
    fn a_bar_that_is_shorter_than_two_spacings_is_refused() {
        let refused = |set| solid::tests::refused(&CANTILEVER, LAGRANGIAN, set);
        assert!(matches!(refused("length=1e-3"), Some(RunError::TooMuch { .. })));
        assert!(matches!(refused("n=1"), Some(RunError::Setting(_))));
        assert!(matches!(refused("dt=1"), Some(RunError::TimeStep { .. })));
        assert!(matches!(refused("thickness=1e-9"), Some(RunError::TooLong { .. })));
    }
}
