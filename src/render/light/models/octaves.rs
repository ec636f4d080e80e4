//! Wrenninge (2013), Hillaire (2016): octaves of single scattering.

use crate::render::light::model::{Model, Needs, no_tables};

pub(in crate::render) static MODEL: Model = Model {
    name: "octaves",
    about: "Single scattering and two octaves of it, as games and films do (Wrenninge 2013, Hillaire 2016): each half as bright, half as directed and half as shadowed",
    roles: &[("light", include_str!("../../../../shaders/light/octaves.wgsl"))],
    needs: Needs::SUN,
    tables: no_tables,
    textures: |parts| parts.openness(),
};
