//! A ring of rubber holds no fluid: the symbols of the example, read from the program of this test.

#[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
mod symbols;

#[test]
fn the_example_reaches_the_end_without_images() {
    super::main().expect("two rings that part");
}

#[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
#[test]
fn rings_have_no_symbol_of_a_wall_an_exponent_or_a_fluid_term() {
    use symbols::held;
    for named in ["CubicSpline", "CauchyStress", "Principal", "JaumannRate", "Xsph", "Leapfrog"] {
        assert!(held(named) > 0, "{named} is not seen, so nothing would be");
    }
    for absent in [
        "Tait",
        "Pressure",
        "Viscosity",
        "BodyForce",
        "DensityDiffusion",
        "AcousticDamper",
        "Shifting",
        "ArtificialStress",
        "Componentwise",
        "Ghosts",
        "InterfaceWall",
        "PredictorCorrector",
        "SuperSteps",
        "QuinticSpline",
        "WendlandC2",
    ] {
        assert_eq!(held(absent), 0, "symbols with {absent}");
    }
}
