//! Words for captions.

/// The label of an axis without the mark of a number without unit, as the beginning of a sentence.
pub fn name_of_error(label: &str) -> String {
    let name = label.trim_end_matches(" [-]");
    let mut letters = name.chars();
    // An abbreviation or a symbol stays as it is.
    let is_word = name.split(' ').next().is_some_and(|word| word.len() > 3);
    match letters.next().filter(|_| is_word) {
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => format!("The {name}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use report::first_sentence;

    #[test]
    fn captions_begin_with_a_whole_sentence() {
        assert_eq!(first_sentence("A run to 0.5 s. More of it.").0, "A run to 0.5 s.");
        assert_eq!(first_sentence("A run.").0, "A run.");
        assert_eq!(name_of_error("relative error of u [-]"), "Relative error of u");
        assert_eq!(name_of_error("rms error of u [U_b]"), "The rms error of u [U_b]");
    }
}
