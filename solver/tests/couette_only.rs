//! A program holds what its scheme names and nothing else: the example's symbols, read from the
//! program of this test, which runs it and links nothing more.

#[path = "../examples/couette_only.rs"]
mod couette_only;

#[test]
fn the_example_reaches_the_end() {
    couette_only::main().expect("a steady flow");
}

/// Every mangling keeps the names of types as they are; schemes stand in the symbols of what is
/// dropped and of what is not inlined.
#[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
#[test]
fn a_program_has_no_symbol_of_what_its_scheme_does_not_name() {
    let program = std::env::current_exe().expect("a path");
    let symbols = symbols(&std::fs::read(program).expect("a program"));
    let held = |name: &str| symbols.iter().filter(|symbol| symbol.contains(name)).count();
    for named in ["QuinticSpline", "Viscosity", "Continuity", "Ghosts", "Leapfrog"] {
        assert!(held(named) > 0, "{named} is not seen, so nothing would be");
    }
    for absent in [
        "Shifting",
        "Xsph",
        "ArtificialViscosity",
        "ArtificialStress",
        "DensityDiffusion",
        "BodyForce",
        "InterfaceWall",
        "PredictorCorrector",
        "CubicSpline",
        "WendlandC2",
    ] {
        assert_eq!(held(absent), 0, "symbols with {absent}");
    }
}

/// The names in the symbol table of an ELF file: of each section of type 2 the entries of 24 bytes,
/// whose first four are an offset into the section that it links to.
#[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
fn symbols(elf: &[u8]) -> Vec<String> {
    let number = |at: usize, bytes: usize| {
        elf[at..at + bytes].iter().rev().fold(0, |n, byte| n << 8 | usize::from(*byte))
    };
    let (sections, size, count) = (number(40, 8), number(58, 2), number(60, 2));
    let content = |section: usize| {
        let header = sections + section * size;
        number(header + 24, 8)..number(header + 24, 8) + number(header + 32, 8)
    };
    let mut names = Vec::new();
    for section in (0..count).filter(|section| number(sections + section * size + 4, 4) == 2) {
        let texts = &elf[content(number(sections + section * size + 40, 4))];
        for entry in content(section).step_by(24) {
            let name = texts[number(entry, 4)..].split(|byte| *byte == 0).next();
            names.push(String::from_utf8_lossy(name.unwrap_or_default()).into_owned());
        }
    }
    names
}
