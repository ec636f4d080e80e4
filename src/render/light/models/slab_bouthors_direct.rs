//! Bouthors' slabs with the direct table.

use crate::render::light::{
    model::{Model, Needs},
    slab_tables::{DirectTextures, FunctionTextures},
};

pub(in crate::render) static MODEL: Model = Model {
    name: "slab-bouthors-direct",
    about: "As slab-bouthors, from a table of the light itself: slow",
    roles: &[("light", include_str!("../../../../shaders/light/slab_bouthors.wgsl")), ("slab_lookup", include_str!("../../../../shaders/light/slab_lookup_direct.wgsl"))],
    needs: Needs::SLABS,
    tables: |device, queue| {
        let functions = FunctionTextures::new(device, queue)?;
        Ok([functions.collectors(), DirectTextures::new(device, queue)?.lookup()].concat())
    },
    textures: |parts| parts.tables(parts.maps(), 7),
};
