//! Pictures out of the renderer: PNG for eyes, EXR for compositors.

mod exr;
mod picture;
mod png;

pub use exr::{write_beauty, write_estimate, write_layers};
pub use picture::Picture;
pub use png::write_png;
