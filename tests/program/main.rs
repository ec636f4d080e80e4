//! The program as it is built, from outside.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod cli;
mod cli_export;
mod editor_window;
mod faults;
mod headers;
mod places;
#[path = "../common/readers.rs"]
#[allow(dead_code, reason = "each binary of tests has its own readers")]
mod readers;
mod sequence;
mod stopping;
