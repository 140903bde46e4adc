//! Inline markup of prose, captions and cells: `*emphasis*`, `**strong**`, `` `code` ``,
//! `[label](target)`. A backslash before a mark makes it plain text. Texts from outside, such as the name of
//! another code, pass [`plain`] or [`code`] before they become part of such a text.

use maud::{Markup, PreEscaped};
use touchstone_base::text::escaped;

/// Characters that mean something.
const MARKS: [char; 5] = ['*', '`', '[', ']', '\\'];

/// A text without any markup, whatever characters it has.
pub fn plain(text: &str) -> String {
    text.chars().flat_map(|c| MARKS.contains(&c).then_some('\\').into_iter().chain([c])).collect()
}

/// A text as a name in a command, without any markup.
pub fn code(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("`{}`", text.replace('`', "'")) }
}

/// The text as HTML. Marks without a partner are plain text.
pub(super) fn inline(text: &str) -> Markup {
    let mut out = String::with_capacity(text.len() + 16);
    let mut rest = text;
    while let Some(at) = rest.find(MARKS) {
        out.push_str(&escaped(&rest[..at]));
        rest = &rest[at..];
        let used = element(rest, &mut out);
        if used == 0 {
            out.push_str(&escaped(&rest[..1]));
        }
        rest = &rest[used.max(1)..];
    }
    out.push_str(&escaped(rest));
    PreEscaped(out)
}

/// The text without its marks, for readers who hear it.
pub(super) fn aloud(text: &str) -> String {
    let html = inline(text).into_string();
    let shown = html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text));
    let shown: String = shown.collect();
    [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&amp;", "&")]
        .into_iter()
        .fold(shown, |text, (mark, character)| text.replace(mark, character))
}

/// Writes the element at the start of the text; the bytes that it took, 0 for none.
fn element(text: &str, out: &mut String) -> usize {
    if let Some(mark) = text.strip_prefix('\\').and_then(|after| after.chars().next()) {
        let shown = if MARKS.contains(&mark) { mark } else { '\\' };
        out.push(shown);
        return if shown == mark { 2 } else { 1 };
    }
    for (mark, tag) in [("`", "code"), ("**", "strong"), ("*", "em")] {
        let Some(after) = text.strip_prefix(mark) else { continue };
        let Some(end) = end_of(after, mark).filter(|&e| e > 0) else { continue };
        let inner = &after[..end];
        let content = match tag {
            "code" => escaped(inner),
            _ if inner.starts_with(' ') || inner.ends_with(' ') => continue,
            _ => inline(inner).into_string(),
        };
        out.push_str(&format!("<{tag}>{content}</{tag}>"));
        return end + 2 * mark.len();
    }
    link(text, out).unwrap_or(0)
}

/// The end of the span of a mark: not after a backslash, except in code, which has no escapes.
fn end_of(text: &str, mark: &str) -> Option<usize> {
    let backslashes = |at| text[..at].bytes().rev().take_while(|byte| *byte == b'\\').count();
    let is_mark = |at: &usize| mark == "`" || backslashes(*at).is_multiple_of(2);
    text.match_indices(mark).map(|(at, _)| at).find(is_mark)
}

fn link(text: &str, out: &mut String) -> Option<usize> {
    let label_end = end_of(text.strip_prefix('[')?, "](")? + 1;
    let target_end = label_end + text[label_end..].find(')')?;
    let (label, target) = (&text[1..label_end], &text[label_end + 2..target_end]);
    if end_of(label, "[").is_some() || target.contains(char::is_whitespace) {
        return None;
    }
    let label = inline(label).into_string();
    out.push_str(&format!("<a href=\"{}\">{label}</a>", escaped(target)));
    Some(target_end + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> String {
        inline(text).into_string()
    }

    #[test]
    fn marks_become_elements() {
        assert_eq!(of("a *b* **c** `d<e`"), "a <em>b</em> <strong>c</strong> <code>d&lt;e</code>");
        assert_eq!(of("see [Fig *x*](#fig-x)."), "see <a href=\"#fig-x\">Fig <em>x</em></a>.");
        assert_eq!(of("ρ & co"), "ρ &amp; co");
        assert_eq!(of(&code("")), "", "no name, no marks");
    }

    /// A code called `[our paper](javascript:…)` was a live link on the page.
    #[test]
    fn a_text_from_outside_stays_as_it_is() {
        for name in
            ["[a](javascript:alert)", "*a* **b** `c`", "\\[a](b)", "a\\", "\\\\*a*", "]( [x", "`"]
        {
            assert_eq!(of(&plain(name)), escaped(name));
            assert_eq!(of(&format!("*{}*", plain(name))), format!("<em>{}</em>", escaped(name)));
            let linked = format!("<a href=\"#b\">{}</a>", escaped(name));
            assert_eq!(of(&format!("[{}](#b)", plain(name))), linked);
            let shown = of(&code(name));
            assert!(shown.starts_with("<code>") && shown.ends_with("</code>"), "{shown}");
            assert_eq!(shown.matches('<').count(), 2, "{shown}");
        }
        assert_eq!(of("a\\b"), "a\\b");
    }

    #[test]
    fn what_is_read_aloud_has_no_marks() {
        assert_eq!(aloud("See [*a*](#b) & `c<d`, \"x\" > 1."), "See a & c<d, \"x\" > 1.");
    }

    #[test]
    fn lonely_marks_stay() {
        assert_eq!(of("2 * 3 * 4, u [m/s], 1 < 2, `"), "2 * 3 * 4, u [m/s], 1 &lt; 2, `");
        assert_eq!(of("<script>"), "&lt;script&gt;");
    }
}
