//! The models of the light inside clouds. To add one: a file here with its `MODEL`, its module in
//! `shaders/light`, and a line in the list below. Command line, benchmark and tests read the list.

use super::model::{Model, Transport};
use crate::{Error, Result};

macro_rules! models {
    ($($(#[$meta:meta])* $constant:ident: $file:ident,)+) => {
        $($(#[$meta])* mod $file;)+

        /// All models, the simplest first.
        static MODELS: &[&Model] = &[$($(#[$meta])* &$file::MODEL),+];

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
    POWDER: powder,
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

mod dark;

impl Transport {
    /// That of clouds on which no light falls: nobody chooses it.
    pub(in crate::render) const DARK: Self = Self(&dark::MODEL);

    /// All of them, the simplest first.
    pub fn all() -> impl ExactSizeIterator<Item = Self> {
        MODELS.iter().map(|model| Self(model))
    }

    /// Names and models, in the same order.
    pub fn entries() -> Vec<(&'static str, Self)> {
        Self::all().map(|transport| (transport.name(), transport)).collect()
    }

    /// The one called `name`.
    ///
    /// # Errors
    /// [`Error::Argument`] where there is none: the message lists those that there are.
    pub fn named(name: &str) -> Result<Self> {
        Self::all().find(|transport| transport.name() == name).ok_or_else(|| {
            let names: Vec<_> = Self::all().map(Self::name).collect();
            Error::Argument(format!("there is no model of light `{name}`: take one of {}", names.join(", ")))
        })
    }
}

impl Default for Transport {
    /// `moments`, the most accurate.
    fn default() -> Self {
        Self::MOMENTS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_found_by_name_and_others_are_told_what_there_is() {
        for transport in Transport::all() {
            assert_eq!(Transport::named(transport.name()).unwrap(), transport);
            assert!(!transport.about().is_empty());
        }
        let message = Transport::named("radiosity").unwrap_err().to_string();
        assert!(message.contains("radiosity") && message.contains("moments"), "{message}");
    }
}
