//! Multiple scattering in slabs: `tables/slab_moments.bin`.

use std::sync::OnceLock;

use super::{Grid, Grids};
use crate::{Error, Result};

/// Name of the file in `tables/`.
const MOMENTS: &str = "slab_moments.bin";

/// The source moments of slabs of cloud droplets: [`crate::optics::slab::moments`] tells what
/// its numbers are.
///
/// # Errors
/// [`Error::Table`] where the embedded file is damaged.
pub fn slab_moments() -> Result<&'static Grid> {
    static DECODED: OnceLock<std::result::Result<Grids, String>> = OnceLock::new();
    let bytes = include_bytes!("../../tables/slab_moments.bin");
    let decoded = DECODED.get_or_init(|| Grids::decode(MOMENTS, bytes).map_err(|error| error.to_string()));
    let damaged = |problem: String| Error::Table { name: MOMENTS, problem };
    let grids = decoded.as_ref().map_err(|problem| damaged(problem.clone()))?;
    grids.0.first().ok_or_else(|| damaged("has no table".to_owned()))
}
