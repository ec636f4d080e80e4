//! Pictures out of the renderer: PNG for eyes, EXR for compositors.

mod estimate;
mod exr;
mod picture;
mod png;

pub use estimate::{Earlier, read_estimate, write_estimate};
pub use exr::{write_beauty, write_layers};
pub use picture::Picture;
pub use png::write_png;
