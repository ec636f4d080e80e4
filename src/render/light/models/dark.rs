//! No light: for clouds on which none falls, whose opacity is wanted all the same.

use crate::render::light::model::{Model, Needs, no_tables};

pub(super) static MODEL: Model = Model {
    name: "dark",
    about: "No light: black and opaque",
    roles: &[("light", include_str!("../../../../shaders/light/dark.wgsl"))],
    needs: Needs::NONE,
    tables: no_tables,
    textures: |_| Vec::new(),
};
