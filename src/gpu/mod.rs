//! The graphics device and the small tools around it. No physics here.

mod device;
mod group;
mod link;
mod made;
mod pack;
mod readback;
mod shader;
mod texture;
mod timing;

pub use device::{AdapterSummary, Gpu, adapters};
#[cfg(feature = "editor")]
pub(crate) use device::{choose, wanted};
pub(crate) use group::bind_group;
#[cfg(not(target_arch = "wasm32"))]
pub use link::validate;
pub use link::{ENTRY_POINTS, LIBRARY, PARTS, Role, in_place_of, link};
pub use made::Made;
pub(crate) use pack::{Pack, Shelf, one_of};
pub use readback::{read_buffer, read_texture};
pub use shader::ComputeProgram;
pub(crate) use shader::{ADDS, Shader, Strips, draw_screen, screen_pipeline, strip_pipeline};
pub use texture::{
    TextureDesc, half_texture, linear_clamp, linear_repeat, storage_buffer, texture, uniform_buffer,
};
pub(crate) use texture::{UNIFORM, linear_clamp_flat, linear_repeat_layers, mip, view};
pub use timing::{PassTime, Timing};
#[cfg(test)]
pub(crate) use {group::declared_bindings, link::entry_point, shader::workgroup_size};
