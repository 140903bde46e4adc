//! Pictures one after another, as a PNG file of several frames (APNG) that browsers play.

use color_quant::NeuQuant;
use maud::{Markup, PreEscaped};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::io;
use touchstone_base::text::{base64, escaped};

use super::{
    figure::{Figure, Plot},
    inline::aloud,
    render,
};

/// Bits of a colour channel that are kept: edges stay smooth, and the file is a third smaller.
const BITS: u8 = 4;
/// Colours of a film: with 24 of them a frame takes two thirds of the bytes that it takes with 256.
const COLOURS: usize = 24;
/// One pixel of this many is sampled to choose the colours, in one frame of ten.
const SAMPLED: i32 = 10;
/// Frames a second.
const RATE: u16 = 12;

/// Plots of one size and the same axes, one after another.
#[derive(Debug, Clone, PartialEq)]
pub struct Movie {
    /// Unique on its page; also the name of its file.
    pub id: String,
    /// Caption; inline markup.
    pub caption: String,
    /// The frames.
    pub frames: Vec<Plot>,
    /// The frame that is shown where nothing may move.
    pub still: usize,
    /// Size of the area inside the axes, in CSS pixels.
    pub size: (f64, f64),
}

impl Movie {
    /// The file, which begins anew after the last frame.
    pub(super) fn apng(&self) -> io::Result<Vec<u8>> {
        encode(&self.pixels(&self.frames))
    }

    /// Pixels of frames, three bytes each, with width and height.
    fn pixels(&self, frames: &[Plot]) -> Vec<(Vec<u8>, u32, u32)> {
        let figure = |plot: &Plot| {
            let figure = Figure::new(&self.id, "").panel(plot.clone());
            figure.panel_size(self.size.0, self.size.1)
        };
        frames.par_iter().map(|plot| render::pixels(&figure(plot), 1)).collect()
    }

    /// The film inside of a page; a still where readers want no motion.
    pub(super) fn markup(&self) -> Markup {
        let still = self.frames.get(self.still..=self.still).unwrap_or_default();
        let data = |bytes: io::Result<Vec<u8>>| base64(&bytes.unwrap_or_default());
        // The page is XML too: every element is closed.
        PreEscaped(format!(
            "<picture class=\"movie\"><source media=\"(prefers-reduced-motion: reduce)\" \
             srcset=\"data:image/png;base64,{}\"/>\
             <img alt=\"{}\" src=\"data:image/png;base64,{}\"/></picture>",
            data(encode(&self.pixels(still))),
            escaped(&aloud(&self.caption)),
            data(self.apng())
        ))
    }
}

/// Red, green and blue.
type Rgb = [u8; 3];

/// A PNG of frames of three bytes a pixel, in the colours of a palette: a few that stand for all of them.
fn encode(frames: &[(Vec<u8>, u32, u32)]) -> io::Result<Vec<u8>> {
    let Some((_, width, height)) = frames.first() else { return Ok(Vec::new()) };
    let sampled = frames.iter().step_by(10).flat_map(|(pixels, ..)| coarse_colours(pixels));
    let opaque: Vec<u8> = sampled.flat_map(|[r, g, b]| [r, g, b, u8::MAX]).collect();
    let chosen = NeuQuant::new(SAMPLED, COLOURS, &opaque);
    let mut known: BTreeMap<Rgb, u8> = BTreeMap::new();
    let mut index = |[r, g, b]: Rgb| {
        let place = || chosen.index_of(&[r, g, b, u8::MAX]) as u8;
        *known.entry([r, g, b]).or_insert_with(place)
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, *width, *height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(chosen.color_map_rgb());
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter); // flat colours: every filter makes it larger
    if frames.len() > 1 {
        encoder.set_animated(frames.len() as u32, 0)?;
        encoder.set_frame_delay(1, RATE)?;
    }
    let mut writer = encoder.write_header()?;
    for (pixels, ..) in frames {
        let indices: Vec<u8> = coarse_colours(pixels).map(&mut index).collect();
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

    #[test]
    fn a_film_is_read_back_with_its_frames_and_colours() {
        let frame = |k: i32| {
            let line = Series::line("line", vec![(0.0, 0.0), (1.0, 0.1 * f64::from(k))]);
            let axis = |name| Axis::linear(name).range(0.0, 1.0);
            Plot::new("", axis("x [m]"), axis("y [m]")).layer(line)
        };
        let frames: Vec<Plot> = (0..3).map(frame).collect();
        let (id, caption) = ("film".into(), "A line *turns*.".into());
        let film = Movie { id, caption, frames, still: 1, size: (120.0, 80.0) };
        let png = film.apng().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
        let (width, height) = (reader.info().width, reader.info().height);
        assert_eq!(reader.info().animation_control.map(|all| all.num_frames), Some(3));
        let mut read = || {
            let mut read = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut read).unwrap();
            read
        };
        let frames = [read(), read(), read()];
        assert!(frames[0].len() == (width * height) as usize && frames[0] != frames[1]);
        assert!(frames[1] != frames[2]);
        let html = film.markup().into_string();
        assert!(html.contains("alt=\"A line turns.\" src=\"data:image/png;base64,"), "{html}");
        assert!(html.contains("media=\"(prefers-reduced-motion: reduce)\" srcset=\"data:"));
        assert_eq!((coarse(0), coarse(255)), (0, 255));
    }
}
