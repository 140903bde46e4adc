//! Figures as pixels inside the page, for figures that are too large as SVG.

use color_quant::NeuQuant;
use maud::{Markup, PreEscaped};
use std::collections::BTreeMap;
use std::io;
use touchstone_base::text::{base64, escaped};

use super::{figure::Figure, render};

/// Bytes of an SVG beyond which a page has the figure in pixels: some thousand dots.
const LARGEST_SVG: usize = 100_000;
/// Pixels of an image per CSS pixel: half of the density of a file, to limit the size of the page.
const DENSITY: u32 = 1;
/// Bits of a colour channel that are kept: edges stay smooth, and the file is a third smaller.
const BITS: u8 = 4;

/// Colours of an image: 24 colours take two thirds of the bytes of 256.
const COLOURS: usize = 24;
/// One of this many pixels is sampled to choose them.
const SAMPLED: i32 = 10;

/// The figure as SVG, or as pixels where that would be too large.
pub(super) fn drawing(figure: &Figure) -> Markup {
    let svg = render::svg(figure);
    let still = || {
        let (pixels, width, height) = render::pixels(figure, DENSITY);
        encode(&pixels, (width, height))
    };
    match (svg.len() > LARGEST_SVG).then(still) {
        Some(Ok(png)) => image(&figure.caption, &png),
        _ => PreEscaped(svg),
    }
}

/// An image inside the page. The page is XML too: every element is closed.
fn image(caption: &str, png: &[u8]) -> Markup {
    let (caption, data) = (escaped(caption), base64(png));
    PreEscaped(format!("<img alt=\"{caption}\" src=\"data:image/png;base64,{data}\"/>"))
}

/// Red, green and blue.
type Rgb = [u8; 3];

/// A PNG of three bytes a pixel, reduced to a palette of a few colours.
fn encode(pixels: &[u8], (width, height): (u32, u32)) -> io::Result<Vec<u8>> {
    let all = || coarse_colours(pixels);
    let opaque: Vec<u8> = all().flat_map(|[r, g, b]| [r, g, b, u8::MAX]).collect();
    let chosen = NeuQuant::new(SAMPLED, COLOURS, &opaque);
    let mut known: BTreeMap<Rgb, u8> = BTreeMap::new();
    let index = |[r, g, b]: Rgb| {
        let place = || chosen.index_of(&[r, g, b, u8::MAX]) as u8;
        *known.entry([r, g, b]).or_insert_with(place)
    };
    let indices: Vec<u8> = all().map(index).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(chosen.color_map_rgb());
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter); // flat colours: every filter makes it larger
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&indices)?;
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

    #[test]
    fn an_image_is_read_back_with_its_colours() {
        let line = Series::line("line", vec![(0.0, 0.0), (1.0, 1.0)]);
        let plot = Plot::new("", Axis::linear("x [m]"), Axis::linear("y [m]")).layer(line);
        let (pixels, width, height) =
            render::pixels(&Figure::new("image", "").panel(plot), DENSITY);
        let png = encode(&pixels, (width, height)).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
        assert_eq!((reader.info().width, reader.info().height), (width, height));
        let mut read = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut read).unwrap();
        assert!(read.iter().any(|index| *index != read[0]));
        assert_eq!((coarse(0), coarse(255)), (0, 255));
    }
}
