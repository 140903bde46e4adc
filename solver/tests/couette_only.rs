//! A program contains the code of the scheme that it names and no other. The symbols are read from the
//! program of this test, which includes the example as a module and links nothing more.

#[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
mod symbols;

#[test]
fn the_example_reaches_the_end() {
    super::main().expect("a steady flow");
}

#[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
#[test]
fn a_program_has_no_symbol_of_what_its_scheme_does_not_name() {
    use symbols::held;
    for named in ["QuinticSpline", "Viscosity", "Continuity", "Mirrors", "Leapfrog"] {
        assert!(held(named) > 0, "{named} is not seen, so nothing would be");
    }
    // The search of neighbours, the forces and the drift: mirror particles need no wall sweep.
    assert_eq!(held("on_widest"), 3, "hot loops");
    for absent in [
        "Shifting",
        "Xsph",
        "ArtificialViscosity",
        "ArtificialStress",
        "DensityDiffusion",
        "AcousticDamper",
        "BodyForce",
        "InterfaceWall",
        "PredictorCorrector",
        "SuperSteps",
        "CubicSpline",
        "WendlandC2",
    ] {
        assert_eq!(held(absent), 0, "symbols with {absent}");
    }
}
