//! Pictures out of the renderer: PNG for eyes, EXR for compositors.

mod picture;
mod png;
mod atomic;

pub use atomic::write_atomically;
pub use picture::{Picture};
pub use png::write_png;
