//! Multiple scattering in slabs: `tables/slab_*.bin`.

use std::sync::OnceLock;

use super::{Grid, Grids};
use crate::optics::slab::{collector::Collector, direct::Direct, functions::Functions, moments};
use crate::{Error, Result};

/// Names of the files in `tables/`.
const MOMENTS: &str = "slab_moments.bin";
const RADIANCE: &str = "slab_radiance.bin";
const FUNCTIONS: &str = "slab_functions.bin";

type Decoded<T> = OnceLock<std::result::Result<T, String>>;

/// The source moments of slabs of cloud droplets: [`crate::optics::slab::moments`] tells what
/// its numbers are.
///
/// # Errors
/// [`Error::Table`] where the embedded file is damaged.
pub fn slab_moments() -> Result<&'static Grid> {
    static DECODED: Decoded<Grid> = OnceLock::new();
    let bytes = include_bytes!("../../tables/slab_moments.bin");
    once(&DECODED, MOMENTS, bytes, moments::of)
}

/// The direct table of C.
///
/// # Errors
/// [`Error::Table`] where the embedded file is damaged.
pub fn slab_radiance() -> Result<&'static Direct> {
    static DECODED: Decoded<Direct> = OnceLock::new();
    once(&DECODED, RADIANCE, include_bytes!("../../tables/slab_radiance.bin"), Direct::of)
}

/// Bouthors' functions of C and of where light entered.
///
/// # Errors
/// [`Error::Table`] where the embedded file is damaged.
pub fn slab_functions() -> Result<&'static (Functions, Collector)> {
    static DECODED: Decoded<(Functions, Collector)> = OnceLock::new();
    once(&DECODED, FUNCTIONS, include_bytes!("../../tables/slab_functions.bin"), |grids| {
        Functions::of(grids).zip(Collector::of(grids))
    })
}

/// Decodes a file when it is first asked for.
fn once<T>(
    decoded: &'static Decoded<T>,
    name: &'static str,
    bytes: &[u8],
    of: impl FnOnce(&Grids) -> Option<T>,
) -> Result<&'static T> {
    let read = || {
        let grids = Grids::read(bytes)?;
        of(&grids).ok_or_else(|| "has other tables or axes than this program reads".to_owned())
    };
    let damaged = |problem: &String| Error::Table { name, problem: problem.clone() };
    decoded.get_or_init(read).as_ref().map_err(damaged)
}
