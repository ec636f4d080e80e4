//! Light in plane-parallel slabs, order of scattering by order: our own of the study
//! that Bouthors (2008) made by Monte Carlo \[K 3.1.3\], deterministic and without noise.
//!
//! [`medium`] holds a phase function as Legendre moments, [`angles`] the directions, [`axes`] the points of tables,
//! [`depths`] the levels, [`solve`] finds the light of each set of orders.
//!
//! A slab lies between two planes, infinitely wide. Depths are optical, in the medium
//! without its forward peak, 0 where the sun shines on it. `mu` is the cosine of a
//! direction of propagation to the inward normal: positive downward, away from the lit
//! plane. Azimuths count from the sun's: 0 is straight on. The sun's irradiance is 1
//! across its beam, and its direction has cosine `mu0` > 0. The medium is conservative.

pub mod angles;
pub mod axes;
#[cfg(feature = "slabs")]
pub mod check;
pub mod collector;
pub mod compare;
pub mod depths;
pub mod direct;
#[cfg(feature = "slabs")]
mod embedded;
pub mod functions;
mod least_squares;
pub mod medium;
pub mod moments;
mod partial;
pub mod samples;
pub mod solve;
pub mod spread;
pub mod study;
pub mod walks;

#[cfg(feature = "slabs")]
pub use embedded::{slab_functions, slab_moments, slab_radiance};
pub use medium::Medium;
pub use solve::{Beam, Field, Solver};

/// Number of sets of orders.
pub const SETS: usize = 7;

/// First order of scattering of each set: 2, 3, 4, 5-6, 7-9, 10-15, 16 and more, as
/// Bouthors divides them. Order 1 is single scattering, which needs no table.
pub const FIRST_ORDERS: [usize; SETS] = [2, 3, 4, 5, 7, 10, 16];

/// The set that an order of scattering below that of the last set belongs to; 2 and more.
fn set_of(order: usize) -> usize {
    FIRST_ORDERS.iter().rposition(|first| *first <= order).unwrap_or(0)
}
