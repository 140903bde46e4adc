//! Texts that other formats hold: in XML, and bytes as letters; and texts of files as messages repeat them.

/// Characters of a text of a file that a message repeats.
const MOST_CHARACTERS: usize = 100;

/// A text of a file as a message repeats it: its first 100 characters, and how long it is if it has more.
pub fn short(text: &str) -> String {
    first(text, MOST_CHARACTERS)
}

/// The first characters of a text, and how long it is if it has more.
pub fn first(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}... ({} bytes)", &text[..end], text.len()),
        None => text.into(),
    }
}

/// The first names of a list as a message repeats them, and how many others there are.
pub fn few<T: AsRef<str>>(names: impl IntoIterator<Item = T>, most: usize) -> String {
    let mut names = names.into_iter();
    let shown: Vec<String> = names.by_ref().take(most).map(|name| short(name.as_ref())).collect();
    match names.count() {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// A number of a file as a message repeats it: with an exponent where it would have many digits.
pub fn number(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-4..1e15).contains(&size) => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// Text that is safe inside an element of XML, or in a quoted attribute.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The first invisible or non-XML character, with its number: a control character, a direction of writing, or
/// a character without width. Such characters make two names look alike, or hide parts of a line.
pub fn unseen(text: &str) -> Option<String> {
    let is_unseen = |char: char| match char {
        ' '..='~' => false,
        '\u{2028}' | '\u{2029}' => true,
        _ if char.is_whitespace() => char.is_control(),
        '\u{34f}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}' => {
            true
        }
        '\u{2800}' | '\u{3164}' | '\u{fe00}'..='\u{fe0f}' | '\u{ffa0}' => true,
        '\u{e0000}'..='\u{e0fff}' => true,
        // After a letter, marks such as accents are not escaped, and unprintable characters are.
        _ => ['a', char].iter().collect::<String>().escape_debug().count() > 2,
    };
    let found = text.chars().find(|char| is_unseen(*char))?;
    Some(format!("the character U+{:04X}, which nobody sees", u32::from(found)))
}

/// Base64 with padding (RFC 4648, section 4).
pub fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let letter = ALPHABET[(bits >> (18 - 6 * i)) as usize & 63];
            text.push(if i <= chunk.len() { letter as char } else { '=' });
        }
    }
    text
}

/// Reads base64, with or without padding and with blanks between letters; `None` if it has other letters.
pub fn from_base64(text: &str) -> Option<Vec<u8>> {
    let value = |letter: u8| match letter {
        b'A'..=b'Z' => Some(letter - b'A'),
        b'a'..=b'z' => Some(letter - b'a' + 26),
        b'0'..=b'9' => Some(letter - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let letters = text.trim_end_matches('=').bytes().filter(|byte| !byte.is_ascii_whitespace());
    let (mut bytes, mut bits, mut held) = (Vec::with_capacity(text.len() / 4 * 3), 0_u32, 0);
    for letter in letters {
        bits = bits << 6 | u32::from(value(letter)?);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// U+FFFE made every later report of a store end with 4, and U+202E turned a line of the terminal.
    #[test]
    fn characters_that_nobody_sees_are_found() {
        let unseen_ones = "\u{0}\u{1b}\n\t\u{7f}\u{85}\u{ad}\u{61c}\u{115f}\u{180e}\u{200b}\u{200d}\u{200e}\
             \u{2028}\u{202e}\u{2060}\u{2066}\u{2800}\u{3164}\u{fe0f}\u{feff}\u{fff9}\u{fdd0}\u{fffe}\u{ffff}\
             \u{1fffe}\u{e0041}\u{e0100}\u{10ffff}\u{e000}";
        for char in unseen_ones.chars() {
            let found = unseen(&format!("SPH{char}flow")).unwrap_or_default();
            let number = format!("U+{:04X},", u32::from(char));
            assert!(found.contains(&number), "{number} {found}");
        }
        let names = "PySPH [1.0] \"δ-SPH\" \\ it's Müller, Mu\u{308}ller, 光滑粒子, 4\u{a0}GB, 3·10⁻⁴ ² |a|";
        assert_eq!(unseen(names), None);
    }

    #[test]
    fn a_message_repeats_the_beginning_of_a_text_and_the_first_names() {
        let long = "ä".repeat(1000);
        assert_eq!(short(&long), format!("{}... (2000 bytes)", "ä".repeat(100)));
        assert_eq!([short(""), short(&long[..200])], ["", &*"ä".repeat(100)]);
        assert_eq!(few(["a", "b", "c"], 3), "a, b, c");
        assert_eq!(few(["a", "b", "c", &long], 3), "a, b, c and 1 more");
        let numbers = [0.0, 1.5, -999.0, 1e308, -2.5e-320].map(number);
        assert_eq!(numbers, ["0", "1.5", "-999", "1e308", "-2.5e-320"]);
        assert_eq!([f64::NAN, f64::INFINITY].map(number), ["NaN", "inf"]);
    }

    #[test]
    fn base64_agrees_with_the_vectors_of_rfc_4648() {
        let encoded = ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"];
        for (count, text) in encoded.into_iter().enumerate() {
            assert_eq!(base64(&b"foobar"[..count]), text);
            assert_eq!(from_base64(text).as_deref(), Some(&b"foobar"[..count]));
        }
        assert_eq!(from_base64("Zm9v\n YmFy").as_deref(), Some(&b"foobar"[..]));
        assert_eq!(from_base64("Zm9*"), None);
    }
}
