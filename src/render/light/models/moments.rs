//! Moments of the light, solved for on a grid.

use crate::render::light::model::{Model, Needs, Openness, no_tables};

pub(in crate::render) static MODEL: Model = Model {
    name: "moments",
    about: "Moments of the light in the cloud, solved for on a grid, and light that keeps its direction but for small angles in closed form",
    roles: &[("light", include_str!("../../../../shaders/light/moments.wgsl"))],
    needs: Needs { field: true, openness: Openness::Never, ..Needs::SUN },
    tables: no_tables,
    textures: |parts| {
        let field = parts.light.field.as_ref();
        let mut list = parts.sunlight();
        list.push((4, field.map_or(parts.dark, |field| &field.sun.view)));
        list.push((5, field.and_then(|field| field.sky.as_ref()).map_or(parts.dark, |sky| &sky.view)));
        list.push((6, &parts.species.beyond));
        list
    },
};
