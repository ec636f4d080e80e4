//! The tables of slabs that are embedded in this crate, each decoded when it is first asked for.

use std::sync::OnceLock;

use super::{collector::Collector, direct::Direct, functions::Functions, moments};
use crate::{
    Error, Result,
    tables::{Grid, Grids, SlabFile},
};

type Decoded<T> = OnceLock<std::result::Result<T, String>>;

/// The source moments of slabs of cloud droplets: [`moments`] tells what its numbers are.
///
/// # Errors
/// [`Error::Table`] where the embedded file is damaged.
pub fn slab_moments() -> Result<&'static Grid> {
    static DECODED: Decoded<Grid> = OnceLock::new();
    once(&DECODED, SlabFile::Moments, moments::of)
}

/// The direct table of C.
///
/// # Errors
/// [`Error::Table`] where the embedded file is damaged.
pub fn slab_radiance() -> Result<&'static Direct> {
    static DECODED: Decoded<Direct> = OnceLock::new();
    once(&DECODED, SlabFile::Radiance, Direct::of)
}

/// Bouthors' functions of C and of where light entered.
///
/// # Errors
/// [`Error::Table`] where the embedded file is damaged.
pub fn slab_functions() -> Result<&'static (Functions, Collector)> {
    static DECODED: Decoded<(Functions, Collector)> = OnceLock::new();
    once(&DECODED, SlabFile::Functions, |grids| Functions::of(grids).zip(Collector::of(grids)))
}

fn once<T>(
    decoded: &'static Decoded<T>,
    file: SlabFile,
    of: impl FnOnce(&Grids) -> Option<T>,
) -> Result<&'static T> {
    let read =
        || of(&file.read()?).ok_or_else(|| "has other tables or axes than this program reads".to_owned());
    let damaged = |problem: &String| Error::Table { name: file.name(), problem: problem.clone() };
    decoded.get_or_init(read).as_ref().map_err(damaged)
}
