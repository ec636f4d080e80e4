//! Pictures out of the renderer: PNG for eyes, EXR for compositors.

mod picture;
mod png;
mod atomic;
mod exr;

pub use atomic::write_atomically;
pub use exr::{write_beauty, write_layers};
pub use picture::Picture;
pub use png::write_png;
