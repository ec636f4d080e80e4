//! Multiple scattering in slabs: `tables/slab_*.bin`.

use super::Grids;

/// A file of numbers about slabs; [`crate::optics::slab`] knows what they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SlabFile {
    /// Moments of the source.
    Moments,
    /// The direct table of the radiance.
    Radiance,
    /// Fitted functions of the radiance and of where light entered.
    Functions,
}

impl SlabFile {
    /// Its name in `tables/`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Moments => "slab_moments.bin",
            Self::Radiance => "slab_radiance.bin",
            Self::Functions => "slab_functions.bin",
        }
    }

    /// The grids in it.
    ///
    /// # Errors
    /// What is wrong with it, without its name.
    pub fn read(self) -> Result<Grids, String> {
        Grids::read(match self {
            Self::Moments => include_bytes!("../../tables/slab_moments.bin"),
            Self::Radiance => include_bytes!("../../tables/slab_radiance.bin"),
            Self::Functions => include_bytes!("../../tables/slab_functions.bin"),
        })
    }
}
