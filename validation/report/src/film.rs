//! Figures in pixels inside the page: those that would be too large as SVG, and films, which are animated PNG
//! files that browsers and image viewers play.

use base::text::{base64, escaped};
use color_quant::NeuQuant;
use maud::{Markup, PreEscaped};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::io;

use super::{figure::Figure, render};

/// Bytes of an SVG beyond which a page has the figure in pixels: some thousand dots.
const LARGEST_SVG: usize = 100_000;
/// Pixels of a film per CSS pixel: half of what a figure has, for the size of the page.
const DENSITY: u32 = 1;
/// Bits of a colour channel that are kept: edges stay smooth, and the file is a third smaller.
const BITS: u8 = 4;

/// Colours of an image: with 24 of them a film takes two thirds of what it takes with 256.
const COLOURS: usize = 24;
/// One pixel of so many is looked at to choose them.
const SAMPLED: i32 = 10;

/// Frames of one size, shown in order and again from the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// Unique on its page; also the name of its PNG file.
    pub id: String,
    /// What is seen; inline markup as in [`super::Block::Prose`].
    pub caption: String,
    /// The animated PNG; the first frame is the picture where animation is not understood.
    pub(super) png: Vec<u8>,
    /// A PNG of all frames, one below the other.
    pub(super) sheet: Vec<u8>,
    /// Width and height of a frame \[CSS pixels\].
    pub(super) size: (u32, u32),
    /// How many there are.
    pub(super) frames: usize,
    /// How long each is shown \[ms\].
    pub(super) milliseconds: u16,
}

impl Film {
    /// Draws the frames, whose own captions are not shown, for so many milliseconds each.
    ///
    /// An error if there is none, or if one has another size than the first.
    pub fn new(
        id: impl Into<String>,
        caption: impl Into<String>,
        frames: &[Figure],
        milliseconds: u16,
    ) -> io::Result<Self> {
        let drawn: Vec<_> = frames.par_iter().map(|frame| render::pixels(frame, DENSITY)).collect();
        let Some(&(_, width, height)) = drawn.first() else {
            return Err(io::Error::other("a film without a frame"));
        };
        if drawn.iter().any(|frame| (frame.1, frame.2) != (width, height)) {
            return Err(io::Error::other("frames of different sizes"));
        }
        let drawn: Vec<Vec<u8>> = drawn.into_iter().map(|(pixels, ..)| pixels).collect();
        let (frames, size) = (drawn.len(), (width, height));
        let sheet = encode(&[drawn.concat()], (width, height * frames as u32), 1)?;
        let png = encode(&drawn, size, milliseconds)?;
        Ok(Self { id: id.into(), caption: caption.into(), png, sheet, size, frames, milliseconds })
    }
}

/// The figure as SVG, or as pixels where that would be too large.
pub(super) fn drawing(figure: &Figure) -> Markup {
    let svg = render::svg(figure);
    let still = || {
        let (pixels, width, height) = render::pixels(figure, DENSITY);
        encode(&[pixels], (width, height), 1)
    };
    match (svg.len() > LARGEST_SVG).then(still) {
        Some(Ok(png)) => image(&figure.caption, &png),
        _ => PreEscaped(svg),
    }
}

/// An image inside the page. The page is XML too: every element is closed.
pub(super) fn image(caption: &str, png: &[u8]) -> Markup {
    let (caption, data) = (escaped(caption), base64(png));
    PreEscaped(format!("<img alt=\"{caption}\" src=\"data:image/png;base64,{data}\"/>"))
}

/// Red, green and blue.
type Rgb = [u8; 3];

/// A PNG of frames of three bytes a pixel, in the colours of a palette: a few that stand for all of them.
fn encode(
    frames: &[Vec<u8>],
    (width, height): (u32, u32),
    milliseconds: u16,
) -> io::Result<Vec<u8>> {
    let all = || frames.iter().flat_map(|pixels| coarse_colours(pixels));
    let opaque: Vec<u8> = all().flat_map(|[r, g, b]| [r, g, b, u8::MAX]).collect();
    let chosen = NeuQuant::new(SAMPLED, COLOURS, &opaque);
    let place = |[r, g, b]: Rgb| ([r, g, b], chosen.index_of(&[r, g, b, u8::MAX]) as u8);
    let distinct: BTreeSet<Rgb> = all().collect();
    let index: BTreeMap<Rgb, u8> = distinct.into_iter().map(place).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(chosen.color_map_rgb());
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter); // flat colours: every filter makes it larger
    if frames.len() > 1 {
        encoder.set_animated(frames.len() as u32, 0)?;
        encoder.set_frame_delay(milliseconds, 1000)?;
    }
    let mut writer = encoder.write_header()?;
    for pixels in frames {
        let indices: Vec<u8> = coarse_colours(pixels).map(|colour| index[&colour]).collect();
        writer.write_image_data(&indices)?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// The colours of pixels of three bytes, with [`BITS`] bits a channel, black and white as they are.
fn coarse_colours(pixels: &[u8]) -> impl Iterator<Item = Rgb> + '_ {
    pixels.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]].map(coarse))
}

/// The channel value with [`BITS`] bits, black and white as they are.
fn coarse(value: u8) -> u8 {
    let steps = (1_u32 << BITS) - 1;
    ((u32::from(value) * steps + 127) / 255 * 255 / steps) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Plot, Series};

    fn frame(y: f64) -> Figure {
        let line = Series::line("line", vec![(0.0, 0.0), (1.0, y)]);
        let plot = Plot::new("", Axis::linear("x [m]").range(0.0, 1.0), {
            Axis::linear("y [m]").range(0.0, 3.0)
        });
        let plot = plot.layer(line).without_legend();
        Figure::new("frame", "").panel(plot).panel_size(80.0, 60.0)
    }

    #[test]
    fn a_film_is_read_back_frame_by_frame() {
        let film = Film::new("film", "", &[frame(1.0), frame(2.0), frame(3.0)], 80).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&film.png)).read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 3);
        let mut seen = Vec::new();
        for _ in 0..3 {
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            seen.push(pixels);
        }
        assert!(seen[0] != seen[1] && seen[1] != seen[2]);
        assert_eq!((coarse(0), coarse(255)), (0, 255));
    }

    #[test]
    fn frames_of_two_sizes_and_no_frames_are_refused() {
        assert!(Film::new("film", "", &[], 80).is_err());
        let other = frame(1.0).panel_size(90.0, 60.0);
        assert!(Film::new("film", "", &[frame(1.0), other], 80).is_err());
    }
}
