//! Pictures out of the renderer: PNG for eyes, EXR for compositors.

mod atomic;
mod exr;
mod picture;
mod png;

pub use atomic::write_atomically;
pub use exr::{write_beauty, write_layers};
pub use picture::Picture;
pub use png::write_png;
