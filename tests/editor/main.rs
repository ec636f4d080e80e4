//! The editor without a window around it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod commands;
mod desk;
mod document;
mod files;
mod hands;
mod inputs;
mod panels;
mod patience;
mod pictures;
mod timeline;
mod viewport;
mod window;
