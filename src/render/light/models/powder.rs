//! Schneider (2015): Beer's law with a powder effect.

use crate::render::light::model::{Model, Needs, no_tables};

pub(in crate::render) static MODEL: Model = Model {
    name: "powder",
    about: "Beer's law times a powder factor that darkens edges, in one lobe of g = 0.2, and the light of the sky, as Horizon Zero Dawn (Schneider 2015)",
    roles: &[("light", include_str!("../../../../shaders/light/powder.wgsl"))],
    needs: Needs::SUN,
    tables: no_tables,
    textures: |parts| parts.openness(),
};
