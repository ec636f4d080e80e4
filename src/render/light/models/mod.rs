//! The models of the light inside clouds. To add one: a file here with its `MODEL`, its module in
//! `shaders/light`, and a line in the list below. Command line, benchmark, docs and tests read the list.

use super::model::{Model, Transport};

macro_rules! models {
    ($($(#[$meta:meta])* $constant:ident: $file:ident,)+) => {
        $($(#[$meta])* mod $file;)+

        /// All models, the simplest first.
        pub(super) static MODELS: &[&Model] = &[$($(#[$meta])* &$file::MODEL),+];

        impl Transport {
            $(
                $(#[$meta])*
                #[doc = concat!("`", stringify!($file), "`: [`Transport::about`] tells what it does.")]
                pub const $constant: Self = Self(&$file::MODEL);
            )+
        }
    };
}

models! {
    EMITTER: emitter,
    SINGLE: single,
    FORWARD: forward,
    OCTAVES: octaves,
    DELTA_EDDINGTON: delta_eddington,
    #[cfg(feature = "slabs")]
    SLAB: slab,
    #[cfg(feature = "slabs")]
    SLAB_KOL: slab_kol,
    #[cfg(feature = "slabs")]
    SLAB_KOL_DIRECT: slab_kol_direct,
    #[cfg(feature = "slabs")]
    SLAB_BOUTHORS: slab_bouthors,
    #[cfg(feature = "slabs")]
    SLAB_BOUTHORS_DIRECT: slab_bouthors_direct,
    MOMENTS: moments,
}
