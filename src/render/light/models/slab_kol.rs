//! Kol (2013): one slab for all orders.

use crate::render::light::{
    model::{Model, Needs},
    slab_tables::FunctionTextures,
};

pub(in crate::render) static MODEL: Model = Model {
    name: "slab-kol",
    about: "One slab for all orders, at one level of the sun maps, as Kol (2013), with Bouthors' functions",
    roles: &[("light", include_str!("../../../../shaders/light/slab_kol.wgsl")), ("slab_lookup", include_str!("../../../../shaders/light/slab_lookup_functions.wgsl"))],
    needs: Needs::SLABS,
    tables: |device, queue| Ok(FunctionTextures::new(device, queue)?.lookup()),
    textures: |parts| parts.tables(parts.maps(), 9),
};
