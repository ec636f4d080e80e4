//! The models of the light inside clouds. To add one: a file here with its `MODEL`, its module in
//! `shaders/light`, and a line in the list below. Command line, benchmark, docs and tests read the list.

use super::model::{Model, Transport};

macro_rules! models {
    ($($constant:ident: $file:ident,)+) => {
        $(mod $file;)+

        /// All models, the simplest first.
        pub(super) static MODELS: &[&Model] = &[$(&$file::MODEL),+];

        impl Transport {
            $(
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
    SLAB: slab,
    SLAB_KOL: slab_kol,
    SLAB_KOL_DIRECT: slab_kol_direct,
    SLAB_BOUTHORS: slab_bouthors,
    SLAB_BOUTHORS_DIRECT: slab_bouthors_direct,
    MOMENTS: moments,
}
