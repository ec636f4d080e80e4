//! Delta-Eddington slabs.

use crate::render::light::model::{Model, Needs, no_tables};

pub(in crate::render) static MODEL: Model = Model {
    name: "delta-eddington",
    about: "Single scattering, and light scattered more often as in a slab fitted to the cloud, in closed form",
    roles: &[("light", include_str!("../../../../shaders/light/delta_eddington.wgsl"))],
    needs: Needs::SLABS,
    tables: no_tables,
    textures: |parts| parts.maps(),
};
