//! What the figure must know of its panels.

use super::bar::Bar;
use super::canvas::Canvas;
use super::frame::Room;
use super::legend::Entry;

/// A panel with everything decided but its place.
pub(super) trait Drawn {
    fn room(&self) -> Room;
    /// Draws the panel; the upper left corner of its axes is the canvas's.
    fn draw(&self, canvas: &mut Canvas);
    /// The entries of its legend, if that is drawn.
    fn legend(&self) -> &[Entry] {
        &[]
    }
    /// Leaves the legend to the figure.
    fn hide_legend(&mut self) {}
    /// Its colour bar, if it has one.
    fn bar(&mut self) -> Option<&mut Bar> {
        None
    }
}
