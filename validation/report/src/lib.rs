//! Rendering: figures, tables and one self-contained page, from plain data.
//!
//! This crate does not depend on particles, solvers or cases. Build a [`Figure`], [`Table`] or [`Page`] from
//! numbers and text, then call [`svg`], [`png()`], [`Page::html`] or [`Page::write_html`]. [`check_page`]
//! reads a page back and checks that it opens from disk.

#![allow(clippy::disallowed_methods, reason = "drawings are judged by eye, not by bits")]

mod axis;
mod bar;
mod canvas;
mod check;
mod colour;
mod counts;
mod data;
mod dots;
mod explorer;
mod figure;
mod font;
mod frame;
mod geometry;
mod inline;
mod legend;
mod movie;
mod number;
mod overview;
mod page;
mod plot;
mod raster;
mod render;
mod svg;
mod table;
mod ticks;

pub use axis::Axis;
pub use check::check_page;
pub use colour::{Colour, ColourMap};
pub use counts::Counts;
pub use explorer::{Explorer, VERDICTS, verdicts_where};
pub use figure::{BandPoint, Dash, Dot, Dots, Figure, GridCell, Layer, Look, Plot, Series, Shape};
pub use inline::{code, plain};
pub use movie::Movie;
pub use number::{counted, exact, percent, sci, seconds, sig};
pub use overview::{Overview, Subject};
pub use page::{Block, DataFile, Page, Section, made_from};
pub use render::{png, svg};
pub use table::{Cell, Table, TableColumn, first_sentence};
pub use ticks::Scale;
