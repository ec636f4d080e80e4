//! The editor: a window in which clouds are made of ellipsoids. One panel is
//! one struct in one file.

mod actions;
mod app;
mod asking;
mod choosing;
mod dialogs;
mod document;
mod files;
mod form;
mod growing;
mod inbox;
pub mod jobs;
mod keying;
mod labels;
mod menu;
mod notices;
mod operations;
mod palette;
mod panels;
mod perform;
mod recovery;
mod selection;
mod session;
mod settings;
mod theme;
mod tracks;
pub mod viewport;
mod window;
mod words;

pub use actions::{Action, Entry, entries};
pub use app::{Editor, Options};
pub use document::Document;
pub use recovery::{Kept, Recovery};
pub use selection::{EllipsoidId, Selection};
pub use session::Session;
pub use settings::{Look, Places, Settings, WindowPlace};
pub use window::{has_desktop, run};
