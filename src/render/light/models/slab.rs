//! Tables of slabs, set of orders by set.

use crate::render::light::{
    model::{Model, Needs},
    slab_tables,
};

pub(in crate::render) static MODEL: Model = Model {
    name: "slab",
    about: "Multiple scattering from tables of slabs: each set of orders has the slab that fits the cloud over the spread of its light",
    roles: &[("light", include_str!("../../../../shaders/light/slab.wgsl"))],
    needs: Needs::SLABS,
    tables: |device, queue| Ok(vec![slab_tables::moments(device, queue)?]),
    textures: |parts| {
        let mut list = parts.tables(parts.maps(), 7);
        list.push((8, &parts.species.remainder));
        list
    },
};
