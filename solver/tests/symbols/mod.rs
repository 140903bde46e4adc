//! The symbols of the program that a test runs in: Linux, 64 bits, little-endian.

/// The number of symbols of this program with the type `name`. Every mangling keeps the names of types, after
/// a character that is no letter; schemes are in the symbols of drop functions and of functions that are not
/// inlined.
pub fn held(name: &str) -> usize {
    let program = std::env::current_exe().expect("a path");
    let symbols = symbols(&std::fs::read(program).expect("a program"));
    let holds = |symbol: &&String| {
        let mut found = symbol.match_indices(name);
        found.any(|(at, _)| !symbol[..at].ends_with(char::is_alphabetic))
    };
    symbols.iter().filter(holds).count()
}

/// The names in the symbol table of an ELF file: of each section of type 2 the entries of 24 bytes,
/// whose first four are an offset into the section that it links to.
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
