//! Max (1994): a cloud that glows.

use crate::render::light::model::{Model, Needs, no_tables};

pub(in crate::render) static MODEL: Model = Model {
    name: "emitter",
    about: "A cloud that glows evenly and dims what is behind, as Max (1994): no shadows",
    roles: &[("light", include_str!("../../../../shaders/light/emitter.wgsl"))],
    needs: Needs::NONE,
    tables: no_tables,
    textures: |_| Vec::new(),
};
