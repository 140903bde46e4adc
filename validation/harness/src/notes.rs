//! Numbered notes below a table: equal texts are one note.

/// The texts, in the order in which they were first referred to.
#[derive(Debug, Default)]
pub struct Notes<'a>(Vec<&'a str>);

impl<'a> Notes<'a> {
    /// The number of a text, from 1.
    pub fn number(&mut self, text: &'a str) -> usize {
        let known = self.0.iter().position(|known| *known == text);
        1 + known.unwrap_or_else(|| {
            self.0.push(text);
            self.0.len() - 1
        })
    }

    /// The numbers and the texts.
    pub fn all(&self) -> impl Iterator<Item = (usize, &'a str)> {
        (1..).zip(self.0.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_has_one_number() {
        let mut notes = Notes::default();
        assert_eq!(["one", "two", "one"].map(|text| notes.number(text)), [1, 2, 1]);
        assert_eq!(notes.all().collect::<Vec<_>>(), [(1, "one"), (2, "two")]);
    }
}
