//! The command line: one file a subcommand.

mod info;
mod new;
mod render;
mod schema;
mod tables;
mod terminal;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Clouds from ellipsoids, fractal noise and Mie scattering.
#[derive(Debug, Parser)]
#[command(name = "nephos", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Render(render::Render),
    New(new::New),
    Info(info::Info),
    Schema(schema::Schema),
    Tables(tables::Tables),
}

/// Runs the program: 0 where all went well, 1 where it did not, 2 for words that it does
/// not know.
pub fn main() -> ExitCode {
    terminal::log();
    let result = match Cli::parse().command {
        Command::Render(command) => command.run(),
        Command::New(command) => command.run(),
        Command::Info(command) => command.run(),
        Command::Schema(command) => command.run(),
        Command::Tables(command) => command.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("nephos: {error}");
            ExitCode::FAILURE
        }
    }
}
