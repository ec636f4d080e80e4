//! The command line: one file a subcommand.

pub mod new;
pub mod schema;
