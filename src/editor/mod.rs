//! The editor: a window in which clouds are made of ellipsoids. Drives the public API only;
//! one panel is one struct in one file.

mod document;

pub use document::{Document, EllipsoidId, Selection};
