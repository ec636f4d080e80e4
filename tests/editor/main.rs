//! The editor without a window around it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod app;
mod desk;
mod document;
mod inputs;
mod patience;
mod pictures;
mod timeline;
mod viewport;
mod window;
