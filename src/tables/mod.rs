//! The tables embedded in this crate: decoded once, checked, with units.
//!
//! `tables/README.md` tells how they were made and how accurate they are.

mod bytes;
mod grid;
mod mie;
#[cfg(feature = "slabs")]
mod slab;

pub(crate) use bytes::checksum;
pub use grid::{Axis, Grid, Grids};
pub use mie::{MieEntry, MieTable, MieTables, mie};
#[cfg(feature = "slabs")]
pub(crate) use slab::SlabFile;
