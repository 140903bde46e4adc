//! Elastic solids.

pub mod cantilever;
mod causes;
pub mod elastic_bar;
pub mod elastic_wave;
pub mod oscillating_plate;
pub mod rings;
pub mod solid;
pub mod spinning_disk;
