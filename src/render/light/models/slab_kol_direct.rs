//! Kol's slabs with the direct table.

use crate::render::light::{
    model::{Model, Needs},
    slab_tables::DirectTextures,
};

pub(in crate::render) static MODEL: Model = Model {
    name: "slab-kol-direct",
    about: "As slab-kol, from a table of the light itself",
    roles: &[("light", include_str!("../../../../shaders/light/slab_kol.wgsl")), ("slab_lookup", include_str!("../../../../shaders/light/slab_lookup_direct.wgsl"))],
    needs: Needs::SLABS,
    tables: |device, queue| Ok(DirectTextures::new(device, queue)?.lookup()),
    textures: |parts| parts.tables(parts.maps(), 9),
};
