//! The editor: a window in which clouds are made of ellipsoids. Drives the public API only;
//! one panel is one struct in one file.

mod document;
mod form;
mod operations;
mod panels;
mod recovery;
mod selection;
mod session;
mod settings;
mod theme;
pub mod viewport;
mod words;

pub use document::Document;
pub use recovery::{Kept, Recovery};
pub use selection::{EllipsoidId, Selection};
pub use session::Session;
pub use settings::{Look, Places, Settings, WindowPlace};
