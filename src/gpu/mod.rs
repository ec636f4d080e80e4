//! The graphics device and the small tools around it. No physics here.

mod device;
mod pack;
mod readback;
mod shader;
mod texture;
mod timing;

pub use device::{AdapterSummary, Gpu, adapters, stop_flag};
#[cfg(feature = "editor")]
pub(crate) use device::{choose, wanted};
pub(crate) use pack::{Pack, Place};
pub use readback::{read_buffer, read_texture};
#[cfg(test)]
pub(crate) use shader::entry_point;
#[cfg(not(target_arch = "wasm32"))]
pub use shader::validate;
pub use shader::{ComputeProgram, ENTRY_POINTS, LIBRARY, link};
pub(crate) use shader::{bind_group, draw_screen, screen_pipeline, shader_module};
pub(crate) use texture::UNIFORM;
pub use texture::{
    TextureDesc, half_texture, linear_clamp, linear_repeat, storage_buffer, texture, uniform_buffer,
};
pub use timing::{PassTime, Timing};
