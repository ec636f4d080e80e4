//! What the particles of clouds do to light, in f64 and without a GPU.
//!
//! [`water`] gives the refractive index, [`mie`] scatters light at one sphere,
//! [`droplets`] averages that over a size distribution, [`phase`] offers the
//! result (and the textbook alternatives) as phase functions, and [`peak`]
//! takes the forward peak off them. What is too large for Mie are rays, waves and diffraction: [`rain`], and
//! [`ice`] with snow and graupel. [`slab`] follows light through plane-parallel
//! clouds, order of scattering by order. [`table`] runs the first three for all
//! droplet sizes and writes what [`crate::tables`] reads, [`slab::study`] does the
//! same for slabs.
//!
//! Conventions: the scattering angle `theta` is in radians between the
//! directions of propagation before and after scattering, 0 straight on. Phase
//! functions are in 1/sr and integrate to 1 over the sphere. Arrays of three
//! are red, green, blue.

pub mod airy;
pub mod band;
pub mod crystal;
pub mod diffraction;
pub mod droplets;
pub mod ice;
pub mod mie;
pub mod peak;
pub mod phase;
pub mod rain;
pub mod rings;
pub mod slab;
pub mod table;
pub mod water;
pub mod widening;

/// Wavelengths of the red, green and blue channels in micrometres.
pub const WAVELENGTHS_UM: [f64; 3] = [0.650, 0.550, 0.450];
