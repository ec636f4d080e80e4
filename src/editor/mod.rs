//! The editor: a window in which clouds are made of ellipsoids. Drives the public API only;
//! one panel is one struct in one file.

mod document;
mod operations;
mod selection;
pub mod viewport;

pub use document::Document;
pub use selection::{EllipsoidId, Selection};
