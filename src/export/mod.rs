//! Pictures out of the renderer: PNG for eyes, EXR for compositors.

mod estimate;
mod exr;
mod notes;
mod picture;
mod png;

pub use estimate::{Earlier, read_estimate, write_estimate, write_estimate_noted};
pub use exr::{write_beauty, write_beauty_noted, write_layers, write_layers_noted};
pub use notes::Notes;
pub use picture::Picture;
pub use png::{opaque_of, read_rgb, write_png, write_png_noted};
