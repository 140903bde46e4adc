//! Inline markup of prose, captions and cells: `*emphasis*`, `**strong**`, `` `code` ``,
//! `[label](target)`.

use base::text::escaped;
use maud::{Markup, PreEscaped};

/// The text as HTML. Marks without a partner are plain text.
pub(super) fn inline(text: &str) -> Markup {
    let mut out = String::with_capacity(text.len() + 16);
    let mut rest = text;
    while let Some(at) = rest.find(['*', '`', '[']) {
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

/// Writes the element at the start of the text; the bytes that it took, 0 for none.
fn element(text: &str, out: &mut String) -> usize {
    for (mark, tag) in [("`", "code"), ("**", "strong"), ("*", "em")] {
        let Some(after) = text.strip_prefix(mark) else { continue };
        let Some(end) = after.find(mark).filter(|&e| e > 0) else { continue };
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

fn link(text: &str, out: &mut String) -> Option<usize> {
    let label_end = text.find("](").filter(|_| text.starts_with('['))?;
    let target_end = label_end + text[label_end..].find(')')?;
    let (label, target) = (&text[1..label_end], &text[label_end + 2..target_end]);
    if label.contains('[') || target.contains(char::is_whitespace) {
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
    }

    #[test]
    fn lonely_marks_stay() {
        assert_eq!(of("2 * 3 * 4, u [m/s], 1 < 2, `"), "2 * 3 * 4, u [m/s], 1 &lt; 2, `");
        assert_eq!(of("<script>"), "&lt;script&gt;");
    }
}
