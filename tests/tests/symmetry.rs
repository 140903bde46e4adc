//! Every variant of every case gives equal results for all observers, and an error that breaks a symmetry is
//! found by its relation.

use crate::decay::Decay;
use nalgebra::Vector2;
use rayon::prelude::*;
use touchstone_base::spec::RunSpec;
use touchstone_harness::{
    case::{self, Case, Facts, Rules, RunError, Step},
    composed::*,
    method::{FromMedium, Medium, Method, Parts, scene},
    problem::Simple,
    relation::Relation::{self, *},
    studies::Studies,
    symmetry,
};
use touchstone_solver::{
    Compose, Continuity, Domain, Kernel, Leapfrog, Open, Pressure, QuinticSpline, Rate, Tait, Term,
    Viscosity, lane::Lane, particles::Common, terms::Pair,
};
use touchstone_tests::patch;

/// The relations violated by a run, and the relations that do not apply to it.
fn found(case: &dyn Case, spec: &RunSpec) -> Result<[Vec<Relation>; 2], RunError> {
    let [mut broken, mut none] = [Vec::new(), Vec::new()];
    for (relation, difference) in symmetry::battery(case, spec)? {
        match difference {
            Err(RunError::NoSymmetry { .. }) => none.push(relation),
            Err(error) => return Err(error),
            Ok(difference) if difference.is_round_off() => {}
            Ok(_) => broken.push(relation),
        }
    }
    Ok([broken, none])
}

/// Settings with few particles, in disorder or in contact from the start on.
const SMALL: [(&str, &[&str]); 9] = [
    ("acoustic_wave", &["jitter=0.2"]),
    ("couette", &["jitter=0.2"]),
    ("dam_break", &["n=10"]),
    ("hydrostatic", &["jitter=0.2"]),
    ("poiseuille", &["jitter=0.2"]),
    ("rubber_rings", &["centre=4.05", "spacing=0.25"]),
    ("shear_wave", &["jitter=0.2"]),
    ("spinning_disk", &["n=8"]),
    ("taylor_green", &["n=16", "perturb=0.2"]),
];

/// The relations that do not apply to a scene are the expected ones.
#[test]
fn every_variant_tells_all_observers_the_same() {
    let of_case = |case: &&'static dyn Case| -> Vec<(&'static dyn Case, RunSpec)> {
        let set = SMALL.iter().find(|(name, _)| *name == case.name()).map_or(&[][..], |of| of.1);
        let set: Vec<String> = set.iter().map(ToString::to_string).collect();
        let specs = case.variants().into_iter().map(|v| case::spec(*case, v.name, &set).unwrap());
        specs.map(|spec| (*case, spec)).collect()
    };
    let all: Vec<_> = touchstone_cases::CASES.iter().flat_map(of_case).collect();
    let found: Vec<_> = all.par_iter().map(|(case, spec)| found(*case, spec)).collect();
    let (mut untold, mut holds) = (Vec::new(), 0);
    for ((case, spec), found) in all.iter().zip(found) {
        let name = format!("{} {}", case.name(), spec.variant);
        let [broken, none] = match found {
            Err(RunError::NoScene(_)) => {
                untold.push(case.name());
                continue;
            }
            found => found.unwrap_or_else(|error| panic!("{name}: {error}")),
        };
        let known: &[Relation] = match &*name {
            // Artificial stress component by component, as the paper writes it, depends on the axes, and
            // takes shear of one sign alone.
            "rubber_rings componentwise" => &[Turned, Mirrored],
            // The plane is at rest.
            "rubber_rings plane" => &[Boosted],
            _ => &[],
        };
        assert_eq!(broken, known, "{name}");
        assert!(none.iter().all(|none| [Turned, Boosted].contains(none)), "{name}: {none:?}");
        holds += Relation::ALL.len() - 1 - none.len();
    }
    untold.dedup();
    let without = ["manufactured", "resting_box", "extremes"];
    assert_eq!(
        untold, without,
        "experiments that build scenes of their own, and a force of places"
    );
    assert!(holds > 450, "only {holds} relations hold");
}

/// A force that is wrong by a millionth of the pressure, or none.
#[derive(Clone, Copy)]
struct Wrong {
    kind: char,
    size: f64,
}

/// No error.
const SOUND: char = '0';
/// Stronger along x.
const ANISOTROPIC: char = 'x';
/// Turns to the left.
const CHIRAL: char = 'l';
/// Has an absolute length.
const ABSOLUTE: char = 'm';
/// Takes from velocities.
const DRAG: char = 'v';
/// Adds to the density of one particle.
const FIRST: char = '1';
/// Adds to the density of one particle, by less than round-off.
const BIT: char = '2';
/// Adds to densities far from the origin.
const ORIGIN: char = 'o';
/// A periodic box that is too long.
const BORDER: char = 'b';
/// Diverges if particles are far from the origin.
const FAR: char = 'f';
/// Diverges.
const GONE: char = 'g';

impl FromMedium for Wrong {
    fn new(m: &Medium) -> Self {
        Self { kind: SOUND, size: 1e-6 * m.sound_speed * m.sound_speed }
    }
    fn state(_: &mut Vec<&'static str>) {}
}

impl<X> Term<X> for Wrong {
    type Derived = ();
    type Sum = Vector2<f64>;

    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut Vector2<V>) {
        let (x, y, none) = (pair.r.x, pair.r.y, V::all(0.0));
        let force = match self.kind {
            ANISOTROPIC => Vector2::new(x, none),
            CHIRAL => Vector2::new(none - y, x),
            ABSOLUTE => Vector2::new(x, y) / (pair.r2 + V::all(0.01)),
            _ => return,
        };
        *sum += force * (pair.other.volume * pair.f);
    }

    fn finish(&self, _: &Common, _: (), sum: Vector2<f64>, rate: &mut Rate<X>) {
        rate.velocity += sum * self.size;
    }
}

type Flow = Compose<QuinticSpline, (Pressure<Tait>, Viscosity, Wrong), Continuity, Open, Leapfrog>;

/// A solver with a wrong force, or one that misreads its scene.
fn flawed<const KIND: char>() -> Method {
    Method::with::<Flow>(|parts| {
        let mut scene = scene::<Flow>(parts);
        let (h, wrong) = (scene.setting.h, &mut scene.forces.2);
        wrong.kind = KIND;
        wrong.size *= if KIND == ABSOLUTE { h * h } else { 1.0 };
        let farthest =
            scene.setting.particles.iter().map(|p| p.position.norm()).fold(0.0, f64::max);
        if KIND == GONE || KIND == FAR && farthest > 16.0 * h {
            wrong.size = f64::NAN;
        }
        for (k, p) in scene.setting.particles.iter_mut().enumerate() {
            match KIND {
                DRAG => p.velocity *= 0.999_999,
                ORIGIN => p.density *= 1.0 + 1e-7 * p.position.norm() / h,
                FIRST if k == 0 => p.density *= 1.000_001,
                BIT if k == 0 => p.density *= 1.0 + 2.0 * f64::EPSILON,
                _ => {}
            }
        }
        let factor = if KIND == BORDER { 1.000_001 } else { 1.0 };
        scene.setting.domain.period =
            scene.setting.domain.period.map(|period| Some(period? * factor));
        Ok(Box::new(scene.build()?))
    })
}

fn pose((domain, m): &(Domain, Method), _: &Decay) -> Result<Simple, RunError> {
    let eos = Tait { background: 0.3, ..Tait::new(1.0, 1.0) };
    let medium =
        Medium { nu: 0.01, eta2_over_h2: 1e-6, ..m.properties.medium(eos, 1.0 / 12.0, 0.1) };
    let rules = Rules { step: Step::given(1.0 / 32.0), ..Rules::REFUSED };
    let (domain, size) = (*domain, (144.0, "nothing"));
    let scene = move || Ok(Parts::new(medium, domain, patch(12, 0.15, 11)));
    Ok(Simple::new(m, (medium, rules), size, &[], scene, |_, _| ()))
}

/// Disordered particles in an open domain, moved by solvers with one error each.
const FLAWED: Composed<Decay> = Composed {
    name: "flawed",
    problem: "a patch of fluid",
    recommended: Recommended { variant: "sound", because: "the others are wrong", papers: None },
    about: "A patch of fluid in disorder.",
    variants: || {
        let all: [(&str, Method); 11] = [
            ("sound", flawed::<SOUND>()),
            ("anisotropic", flawed::<ANISOTROPIC>()),
            ("chiral", flawed::<CHIRAL>()),
            ("absolute", flawed::<ABSOLUTE>()),
            ("drag", flawed::<DRAG>()),
            ("first", flawed::<FIRST>()),
            ("bit", flawed::<BIT>()),
            ("origin", flawed::<ORIGIN>()),
            ("border", flawed::<BORDER>()),
            ("far", flawed::<FAR>()),
            ("gone", flawed::<GONE>()),
        ];
        let add = |variants: Variants<_, _>, (name, method): (&'static str, Method)| {
            let domain = if name == "border" { Domain::torus(1.0, 1.0) } else { Domain::open() };
            variants.lacking([name, ""], (domain, method), Vec::new(), |_| {})
        };
        all.into_iter().fold(Variants::of(pose), add).all
    },
    facts: Facts::default,
    studies: |_| Studies::default(),
};

/// Each run is tested for all relations, one run after the other, and the particles of all runs are kept.
#[test]
fn a_battery_takes_what_all_relations_of_all_runs_take() {
    let of = |count: usize| {
        let one = (&FLAWED as &dyn Case, FLAWED.spec("sound", |_| {}));
        symmetry::size(&vec![one; count])
    };
    let (one, three) = (of(1), of(3));
    assert_eq!([one.steps, one.particles, one.samples], [8.0 * 16.0, 144.0, 3.0 * 144.0]);
    assert_eq!([three.steps, three.particles], [one.steps, 3.0 * one.particles]);
    assert_eq!(three.samples, 3.0 * one.samples);
}

#[test]
fn each_relation_finds_the_error_that_it_is_about_and_no_other() {
    for (variant, expected) in [
        ("sound", &[][..]),
        ("anisotropic", &[Turned]),
        ("chiral", &[Mirrored]),
        ("drag", &[Boosted]),
        ("absolute", &[BinaryUnits, OtherUnits]),
        ("first", &[Renumbered]),
        // Where nothing may be rounded every bit counts.
        ("bit", &[Renumbered]),
        ("origin", &[Shifted]),
        // Particles that move all together cross the border too.
        ("border", &[Boosted, Shifted]),
        // One observer has no particles, or both have none: nothing shows agreement.
        ("far", &[Shifted]),
        ("gone", &[Turned, Mirrored, Boosted, BinaryUnits, OtherUnits, Renumbered, Shifted]),
    ] {
        let [broken, none] = found(&FLAWED, &FLAWED.spec(variant, |_| {})).unwrap();
        assert_eq!(broken, expected, "{variant}");
        assert_eq!(none.is_empty(), variant != "border", "{variant}: {none:?}");
    }
}
