//! touchstone: how wrong a particle method is, what being less wrong costs, and how far it can be
//! pushed before it breaks.
//!
//! This crate knows every case ([`cases`]) and assembles the page ([`page`]); what it stands on are crates
//! of their own, each of which knows only those before it: `base`, `report`, `maths`, `harness`, then the
//! families of cases `fluids`, `waters`, `solids` and `lattice`.

pub mod cases;
pub mod limitations;
pub mod page;
pub mod peers;
pub mod stiffness;
mod time;
