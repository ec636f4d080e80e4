//! Pictures out of the renderer: PNG for eyes, EXR for compositors.

mod exr;
mod picture;
mod png;

pub use exr::{
    StoredEstimate, read_estimate, write_beauty, write_estimate, write_layers, write_noted_estimate,
};
pub use picture::Picture;
pub use png::write_png;
