//! Harris (2003), Riley (2003), Nes (2008): multiple forward scattering.

use crate::render::light::model::{Model, Needs, no_tables};

pub(in crate::render) static MODEL: Model = Model {
    name: "forward",
    about: "Single scattering in which light turned by less than 20 degrees stays in the sun's beam, as Harris (2003), Riley (2003) and Nes (2008)",
    roles: &[("light", include_str!("../../../../shaders/light/forward.wgsl"))],
    needs: Needs::SUN,
    tables: no_tables,
    textures: |parts| parts.openness(),
};
