//! The runs of the bar, their gates, and its part of the report.

use Group::{First, Light, Paper, Whole};
use nalgebra::Vector2;
use touchstone_base::{mutation::Constant, settings, spec::RunSpec};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Draws, Statement, SubmittedCurve},
    studies::{Accuracy, Sensitivity, Spacing, Watched},
    table::{Row, Table},
};

use super::{
    ALL, AVERAGE_X_ERROR, AVERAGE_Y_ERROR, BENDING_FREQUENCY_ERROR, BENDING_SAG_ERROR, CANTILEVER,
    COMPARED, CantileverSettings, ENERGY_CHANGE, FIRST_LEAST_Y_ERROR, FIRST_SWING, FREQUENCY_ERROR,
    HARMONIC_X_ERROR, HARMONIC_Y_ERROR, OF_METHODS, PATH_RMS, SAINT_VENANT, STEPWISE, end,
};
use crate::solids::{
    causes::VISCOSITY,
    solid::{LAGRANGIAN, faces},
};

/// Purpose of a run.
#[derive(Clone, Copy, PartialEq)]
pub enum Group {
    /// Frequency, mean and amplitude of the end.
    Whole,
    /// A tenth of the weight.
    Light,
    /// The first swing.
    First,
    /// The equations of the paper.
    Paper,
}

/// Every run.
pub fn table(tier: Tier) -> Table<CantileverSettings, Group> {
    let short =
        |s: &mut CantileverSettings, gravity| (s.n, s.gravity, s.end) = (5, gravity, FIRST_SWING);
    let layers = |s: &mut CantileverSettings, n| s.n = n;
    let mut table = Table::new(&CANTILEVER, tier);
    table.over(Whole, &[LAGRANGIAN], [&[], &[5, 10, 20]], layers);
    table.over(Light, &[LAGRANGIAN], [&[], &[0.2]], |s, gravity| s.gravity = gravity);
    table.over(Whole, &[SAINT_VENANT], [&[], &[10]], layers);
    table.over(First, &[LAGRANGIAN, SAINT_VENANT], [&[2.0]; 2], short);
    table.over(Paper, &["seed"], [&[], &[2.0]], short);
    table.judge(gates);
    table
}

fn gates(row: &Row<CantileverSettings, Group>) -> Vec<Gate> {
    let CantileverSettings { n, gravity, end, .. } = row.settings;
    let usual = CantileverSettings::default();
    let load = if gravity == usual.gravity { String::new() } else { format!(".g{gravity}") };
    let time = if end == usual.end { String::new() } else { format!(".end{end}") };
    let gates = CANTILEVER.gates(format!("{}.{n}{load}{time}", row.variant));
    let reach = "The bounds are the goal of the project with 10 layers, wider with fewer layers as for an \
                 error of second order. Finite elements are uncertain by 0.5 % along, by 0.24 % across the \
                 bar and by 0.13 % of the frequency.";
    let wider = if n < 10 { (10.0 / n as f64).powi(2) } else { 1.0 };
    let near = |metric, most: f64| gates.reference(metric, Bound::magnitude(most * wider), reach);
    // One uncertainty is the finite elements', and one is for the clamp and for large rotations.
    let theory = "A bar that bends as finite elements do, with the stiffness of its layers by theory. The \
                  bound is the uncertainty of finite elements, doubled for the clamp and for large \
                  rotations.";
    let bending = |metric, doubt: f64| gates.theory(metric, Bound::magnitude(2.0 * doubt), theory);
    let stored = "The forces derive from the stored energy and from that of the weight. The leapfrog keeps \
                  the sum within (omega dt)^2/8 of the energy of each mode, 8e-7 in the second, which has \
                  some per cent.";
    let energy = || gates.theory(ENERGY_CHANGE, Bound::magnitude(1e-6), stored);
    let fall = || near(FIRST_LEAST_Y_ERROR, 0.01);
    match row.group {
        Whole | Light => vec![
            near(FREQUENCY_ERROR, 0.005),
            near(AVERAGE_Y_ERROR, 0.01),
            near(HARMONIC_Y_ERROR, 0.01),
            near(AVERAGE_X_ERROR, 0.01),
            near(HARMONIC_X_ERROR, 0.01),
            bending(BENDING_FREQUENCY_ERROR, 0.0013),
            bending(BENDING_SAG_ERROR, 0.0024),
            energy(),
        ],
        First => vec![fall(), energy()],
        Paper => {
            let longer = 1.0 + faces::known_excess(n, row.settings.solid.h_over_dx);
            let nothing =
                "Nothing elastic dissipates, and the weight has a potential, so all energy stays.";
            let loses = "Artificial viscosity damps the swing. The bound: a bar at rest, at half of the \
                         largest deflection, has lost the largest kinetic energy of an undamped swing.";
            let energy = gates.invariant(ENERGY_CHANGE, Bound::magnitude(0.01), nothing);
            vec![
                faces::soft(fall(), Bound::Within(-0.01, longer * longer - 1.0)),
                energy.with_limitation(Bound::Within(-1.0, 0.01), loses, &VISCOSITY),
            ]
        }
    }
}

/// The finite elements are of the bar of any number of layers.
const SEALED: Draws = Draws::new(
    &["lagrangian", "lagrangian-saint-venant"],
    ("n", [5.0, 10.0]),
    2.0,
    &["frequency_error"],
);

/// The accuracy of the path, and in the full tier the errors of constants that the gates detect.
pub fn studies(tier: Tier) -> Studies {
    let table = table(tier);
    let constants =
        [Constant::BodyForce, Constant::SoundSpeed, Constant::Density, Constant::ShearModulus];
    let run = CANTILEVER.spec(LAGRANGIAN, |s| s.n = 5);
    let sensitivity = Sensitivity::new(tier, [run], constants.map(Watched::new));
    let spacing =
        Spacing::count(|s: &mut CantileverSettings| &mut s.n, "{} layers").over(|s| s.thickness);
    let accuracy = Accuracy {
        about: "A bar under its own weight in its first swing, until 0.75 s, against finite elements. The \
                runs go on until 4 s."
            .into(),
        spacing: "dx [m]",
        ladders: vec![table.ladder(&[Whole], LAGRANGIAN, spacing)],
        ..Accuracy::new("cantilever", PATH_RMS, "rms distance of the end over its amplitude [-]")
    };
    Studies::judging(table.plan())
        .with(accuracy)
        .with_all((tier == Tier::Full).then_some(sensitivity))
}

/// The facts of the case.
pub fn facts() -> Facts {
    let held = "Clamped at x = 0: there the displacement is 0 at all times, along x and y. No force acts on \
                the other faces. Weight acts from t = 0 on, on a bar without stress.";
    Facts {
        statement: Statement::new(held, &[ALL, end::OF_PATH, &COMPARED.map(|(_, error)| error)]),
        stepwise: STEPWISE,
        of_methods: OF_METHODS,
        curve: Some(path_of_end()),
        sealed: Some(SEALED),
        ..Facts::default()
    }
}

/// The path of the end, represented by a bar of uniform strain with this end.
fn path_of_end() -> SubmittedCurve {
    let compared = COMPARED.into_iter().flat_map(|(metric, error)| [metric, error]);
    SubmittedCurve {
        columns: &[("x", "m"), ("y", "m")],
        about: "x and y are the displacement of the middle of the free end since the start",
        least: end::LEAST_POINTS,
        rows: |_| 1,
        place: |run, at, starts| {
            let CantileverSettings { length, .. } = run.settings_as();
            let end = Vector2::new(at[0][0], at[0][1]);
            starts.iter().map(|from| [from + end * (from.x / length), Vector2::zeros()]).collect()
        },
        metrics: compared.chain([PATH_RMS]).collect(),
        coarsen: Some(|run| {
            let coarse = CantileverSettings { n: 2, ..run.settings_as() };
            RunSpec { settings: settings::to_json(&coarse), ..run.clone() }
        }),
        shown: &end::COLUMNS,
    }
}
