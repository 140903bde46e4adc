//! SVG text in few bytes: whole numbers, relative coordinates, and one element for successive shapes of one
//! style.

use super::canvas::{Point, Sheet};
use super::colour::Colour;
use super::figure::Dash;
use super::font::{self, Align, Type};
use touchstone_base::text::escaped;

/// Units of the drawing per CSS pixel: coordinates are quarters of a pixel.
const FINE: f64 = 4.0;

/// Elements drawn so far, without the tag around them.
#[derive(Default)]
pub(super) struct Svg {
    text: String,
    /// Opening and closing text of the element that is not closed yet.
    open: (String, &'static str),
    /// Where the last shape of this element began or ended.
    at: (i64, i64),
    /// The series to which shapes belong.
    series: String,
}

impl Svg {
    /// All elements.
    pub fn finish(mut self) -> String {
        self.series("");
        self.close();
        self.text
    }

    /// Closes the element that is open.
    fn close(&mut self) {
        let (_, closing) = std::mem::take(&mut self.open);
        self.text.push_str(closing);
    }

    /// Goes on in the last element if it has the same opening, else begins one.
    fn within(&mut self, opening: String, closing: &'static str) {
        if self.open.0 != opening {
            self.close();
            self.text.push_str(&opening);
            (self.open, self.at) = ((opening, closing), (0, 0));
        }
    }

    fn shape(&mut self, style: &str, points: &[Point], is_closed: bool) {
        let place = |(x, y): &Point| ((x * FINE).round() as i64, (y * FINE).round() as i64);
        let mut places: Vec<(i64, i64)> = points.iter().map(place).collect();
        places.dedup();
        let Some(&first) = places.first() else { return };
        self.within(format!("<path {style} d=\""), "\"/>\n");
        self.text.push('m');
        self.number(first.0 - self.at.0);
        self.number(first.1 - self.at.1);
        self.at = first;
        let mut last = 'l';
        for to in &places[1..] {
            let (dx, dy) = (to.0 - self.at.0, to.1 - self.at.1);
            let letter = match (dx, dy) {
                (_, 0) => 'h',
                (0, _) => 'v',
                _ => 'l',
            };
            if letter != last {
                self.text.push(letter);
                last = letter;
            }
            if letter != 'v' {
                self.number(dx);
            }
            if letter != 'h' {
                self.number(dy);
            }
            self.at = *to;
        }
        if is_closed {
            self.text.push('z');
            self.at = first;
        } else if places.len() == 1 {
            self.text.push_str("h0");
        }
    }

    /// A coordinate, apart from the one before it.
    fn number(&mut self, value: i64) {
        if value >= 0 && self.text.ends_with(|c: char| c.is_ascii_digit()) {
            self.text.push(' ');
        }
        self.text.push_str(&value.to_string());
    }
}

impl Sheet for Svg {
    fn area(&mut self, corners: &[Point], colour: Colour) {
        self.shape(&format!("fill=\"{}\"", hex(colour)), corners, true);
    }

    fn line(&mut self, points: &[Point], colour: Colour, width: f64, dash: Dash) {
        let pattern: Vec<String> = dash.pattern().iter().map(|length| units(*length)).collect();
        let dashes = match dash {
            Dash::Solid => String::new(),
            _ => format!(" stroke-dasharray=\"{}\"", pattern.join(" ")),
        };
        let style = format!("{}{dashes}", stroke(colour, width));
        match points {
            [corners @ .., last] if corners.first() == Some(last) => {
                self.shape(&style, corners, true)
            }
            _ => self.shape(&style, points, false),
        }
    }

    /// The round end of a wide line of no length.
    fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        let style = format!("{} stroke-linecap=\"round\"", stroke(colour, 2.0 * radius));
        self.shape(&style, &[centre], false);
    }

    fn text(&mut self, text: &str, (x, y): Point, how: Type) {
        let anchor = match how.align {
            Align::Start => "",
            Align::Middle => " text-anchor=\"middle\"",
            Align::End => " text-anchor=\"end\"",
        };
        let (fill, size) = (hex(how.colour), units(how.em));
        self.within(format!("<g fill=\"{fill}\" font-size=\"{size}\"{anchor}>\n"), "</g>\n");
        let (x, y) = ((x * FINE).round() as i64, (y * FINE).round() as i64);
        let place = match how.upright {
            false => format!("x=\"{x}\" y=\"{y}\""),
            true => format!("transform=\"translate({x} {y})rotate(-90)\""),
        };
        self.text.push_str(&format!("<text {place}>{}</text>\n", escaped(text)));
    }

    fn series(&mut self, name: &str) {
        if self.series != name {
            self.close();
            if !self.series.is_empty() {
                self.text.push_str("</g>\n");
            }
            if !name.is_empty() {
                self.text.push_str(&format!("<g data-series=\"{}\">\n", escaped(name)));
            }
            self.series = name.into();
        }
    }
}

/// The opening tag of a drawing of a size in CSS pixels, which shrinks with its container. `label` is read
/// aloud; without one the drawing is an ornament.
pub(super) fn opening(label: &str, (width, height): (f64, f64)) -> String {
    let role = match label {
        "" => "aria-hidden=\"true\"".to_string(),
        label => format!("role=\"img\" aria-label=\"{}\"", escaped(label)),
    };
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" {role} width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {} {}\" font-family=\"{}\" fill=\"none\" stroke-linejoin=\"round\">\n",
        units(width),
        units(height),
        font::FAMILY
    )
}

fn stroke(colour: Colour, width: f64) -> String {
    format!("stroke=\"{}\" stroke-width=\"{}\"", hex(colour), units(width))
}

/// CSS pixels in units of the drawing, with one decimal.
fn units(pixels: f64) -> String {
    ((pixels * FINE * 10.0).round() / 10.0).to_string()
}

/// `#0072b2`, or `#000`.
fn hex(Colour(red, green, blue): Colour) -> String {
    match [red, green, blue] {
        all if all.iter().all(|c| c % 17 == 0) => {
            format!("#{:x}{:x}{:x}", red / 17, green / 17, blue / 17)
        }
        _ => format!("#{red:02x}{green:02x}{blue:02x}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_of_one_style_are_one_element() {
        let mut svg = Svg::default();
        svg.line(&[(0.0, 1.0), (2.0, 1.0), (3.0, 0.5)], Colour::BLACK, 1.0, Dash::Solid);
        svg.line(&[(1.0, 1.0), (1.0, 2.0)], Colour::BLACK, 1.0, Dash::Solid);
        svg.area(&[(1.0, 1.0), (2.0, 1.0), (2.0, 2.0)], Colour::BLUE);
        svg.area(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], Colour::BLUE);
        svg.disc((5.0, 5.0), 2.0, Colour::BLUE);
        svg.text("a < b", (1.0, 2.0), Type::new(11.0, Align::End));
        svg.text("c", (3.0, 2.0), Type::new(11.0, Align::End));
        svg.series("x");
        svg.disc((5.0, 5.0), 2.0, Colour::BLUE);
        let expected = "<path stroke=\"#000\" stroke-width=\"4\" d=\"m0 4h8l4-2m-8 2v4\"/>\n\
                        <path fill=\"#0072b2\" d=\"m4 4h4v4zm-4-4h4v4z\"/>\n\
                        <path stroke=\"#0072b2\" stroke-width=\"16\" stroke-linecap=\"round\" \
                        d=\"m20 20h0\"/>\n\
                        <g fill=\"#000\" font-size=\"44\" text-anchor=\"end\">\n\
                        <text x=\"4\" y=\"8\">a &lt; b</text>\n<text x=\"12\" y=\"8\">c</text>\n</g>\n\
                        <g data-series=\"x\">\n<path stroke=\"#0072b2\" stroke-width=\"16\" \
                        stroke-linecap=\"round\" d=\"m20 20h0\"/>\n</g>\n";
        assert_eq!(svg.finish(), expected);
    }
}
