//! Bouthors (2008): a slab for each set of orders.

use crate::render::light::{
    model::{Model, Needs},
    slab_tables::FunctionTextures,
};

pub(in crate::render) static MODEL: Model = Model {
    name: "slab-bouthors",
    about: "A slab for each set of orders, under the area where its light entered, found by iteration, as Bouthors (2008): slow",
    roles: &[("light", include_str!("../../../../shaders/light/slab_bouthors.wgsl")), ("slab_lookup", include_str!("../../../../shaders/light/slab_lookup_functions.wgsl"))],
    needs: Needs::SLABS,
    tables: |device, queue| {
        let functions = FunctionTextures::new(device, queue)?;
        Ok([functions.collectors(), functions.lookup()].concat())
    },
    textures: |parts| parts.tables(parts.maps(), 7),
};
