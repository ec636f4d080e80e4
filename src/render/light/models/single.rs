//! Single scattering.

use crate::render::light::model::{Model, Needs, no_tables};

pub(in crate::render) static MODEL: Model = Model {
    name: "single",
    about: "Single scattering only, and the light of the sky",
    roles: &[("light", include_str!("../../../../shaders/light/single.wgsl"))],
    needs: Needs::SUN,
    tables: no_tables,
    textures: |parts| parts.openness(),
};
