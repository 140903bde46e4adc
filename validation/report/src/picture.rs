//! A figure inside the page.

use super::figure::Figure;
use super::{film, render};
use base::text::{base64, escaped};
use maud::{Markup, PreEscaped};

/// Bytes of an SVG beyond which a page has the figure in pixels: some thousand dots.
const LARGEST_SVG: usize = 100_000;

/// The figure as SVG, or as pixels where that would be too large.
pub(super) fn drawing(figure: &Figure) -> Markup {
    let svg = render::svg(figure);
    match (svg.len() > LARGEST_SVG).then(|| film::still(figure)) {
        Some(Ok(png)) => image(&figure.caption, &png),
        _ => PreEscaped(svg),
    }
}

/// An image inside the page. The page is XML too: every element is closed.
pub(super) fn image(caption: &str, png: &[u8]) -> Markup {
    let (caption, data) = (escaped(caption), base64(png));
    PreEscaped(format!("<img alt=\"{caption}\" src=\"data:image/png;base64,{data}\"/>"))
}
