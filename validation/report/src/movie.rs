//! Pictures one after another, as a PNG file of several frames (APNG) that browsers play.

use maud::{Markup, PreEscaped};
use rayon::prelude::*;
use std::collections::HashMap;
use std::io;
use touchstone_base::text::{base64, escaped};

use super::{
    colour::Colour,
    figure::{Figure, Plot},
    inline::aloud,
    render,
};

/// Colours of a film, as many as four bits name: frames of more take twice the bytes.
const COLOURS: usize = 16;
/// Shades of axes and texts among them; the others are of the colour map.
const SHADES: usize = 5;
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
        encode(&self.pixels(&self.frames), &self.palette())
    }

    /// Shades from black to white, and colours of the map of the particles.
    fn palette(&self) -> [Rgb; COLOURS] {
        let map = self.frames.iter().find_map(Plot::dots).map(|dots| dots.map);
        let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        std::array::from_fn(|k| {
            let colour = match (map, k.checked_sub(SHADES)) {
                (Some(map), Some(k)) => map.at(share(k, COLOURS - SHADES)),
                (Some(_), None) => Colour::BLACK.tint(1.0 - share(k, SHADES)),
                (None, _) => Colour::BLACK.tint(1.0 - share(k, COLOURS)),
            };
            [colour.0, colour.1, colour.2]
        })
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
            data(encode(&self.pixels(still), &self.palette())),
            escaped(&aloud(&self.caption)),
            data(self.apng())
        ))
    }
}

/// Red, green and blue.
type Rgb = [u8; 3];

/// A PNG of frames of three bytes a pixel, each in the nearest colour of a palette.
fn encode(frames: &[(Vec<u8>, u32, u32)], palette: &[Rgb; COLOURS]) -> io::Result<Vec<u8>> {
    let Some((_, width, height)) = frames.first() else { return Ok(Vec::new()) };
    let mut known: HashMap<Rgb, u8> = HashMap::new();
    let mut index = |pixel: &[u8]| {
        let pixel = [pixel[0], pixel[1], pixel[2]];
        *known.entry(pixel).or_insert_with(|| nearest(pixel, palette))
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, *width, *height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(palette.concat());
    encoder.set_depth(png::BitDepth::Four);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter); // flat colours: every filter makes it larger
    if frames.len() > 1 {
        encoder.set_animated(frames.len() as u32, 0)?;
        encoder.set_frame_delay(1, RATE)?;
    }
    let mut writer = encoder.write_header()?;
    for (pixels, ..) in frames {
        let indices: Vec<u8> = pixels.chunks_exact(3).map(&mut index).collect();
        writer.write_image_data(&packed(&indices, *width as usize))?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// The place of the nearest colour of a palette.
fn nearest(pixel: Rgb, palette: &[Rgb; COLOURS]) -> u8 {
    let distance = |colour: &Rgb| -> u32 {
        let squares = pixel.iter().zip(colour).map(|(a, b)| u32::from(a.abs_diff(*b)).pow(2));
        squares.sum()
    };
    let places = palette.iter().enumerate().min_by_key(|(_, colour)| distance(colour));
    places.map_or(0, |(place, _)| place as u8)
}

/// Rows of indices of four bits, two a byte; the last byte of an odd row is half empty.
fn packed(indices: &[u8], width: usize) -> Vec<u8> {
    let pair = |pair: &[u8]| pair[0] << 4 | pair.get(1).copied().unwrap_or(0);
    indices.chunks(width).flat_map(|row| row.chunks(2).map(pair)).collect()
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
        assert!(frames[0].len() == (width.div_ceil(2) * height) as usize && frames[0] != frames[1]);
        assert!(frames[1] != frames[2]);
        let html = film.markup().into_string();
        assert!(html.contains("alt=\"A line turns.\" src=\"data:image/png;base64,"), "{html}");
        assert!(html.contains("media=\"(prefers-reduced-motion: reduce)\" srcset=\"data:"));
        let palette = film.palette();
        assert_eq!(palette.map(|colour| nearest(colour, &palette)).to_vec(), Vec::from_iter(0..16));
        assert!(palette.contains(&[0; 3]) && palette.contains(&[255; 3]), "{palette:?}");
    }
}
