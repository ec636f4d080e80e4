//! The command line: one file a subcommand.

mod bench;
#[cfg(feature = "editor")]
mod edit;
mod export;
mod fill;
mod info;
mod new;
mod picture;
mod render;
mod schema;
mod sequence;
mod tables;
mod terminal;
mod trace;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand, error::ErrorKind};

/// Clouds from ellipsoids, fractal noise and Mie scattering.
#[derive(Debug, Parser)]
#[command(name = "nephos", version)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    #[cfg(feature = "editor")]
    Edit(edit::Edit),
    Render(render::Render),
    Export(export::Export),
    Fill(fill::Fill),
    Sequence(Box<sequence::Sequence>),
    Bench(bench::Bench),
    New(new::New),
    Info(info::Info),
    Schema(schema::Schema),
    Tables(tables::Tables),
}

/// What was asked for. Nothing at all is the editor on a desktop, and help elsewhere.
fn command() -> Command {
    #[cfg(feature = "editor")]
    if std::env::args_os().len() == 1 && crate::editor::has_desktop() {
        return Command::Edit(edit::Edit::default());
    }
    let mut line = Cli::command().arg_required_else_help(true);
    let asked = Cli::from_arg_matches(&line.get_matches_mut()).unwrap_or_else(|error| error.exit());
    let nothing =
        || line.error(ErrorKind::MissingSubcommand, "say what to do: `nephos help` lists it").exit();
    asked.command.unwrap_or_else(nothing)
}

/// Runs the program: 0 where all went well, 1 where it did not, 2 for words that it does
/// not know.
pub fn main() -> ExitCode {
    terminal::log();
    let result = match command() {
        #[cfg(feature = "editor")]
        Command::Edit(command) => command.run(),
        Command::Render(command) => command.run(),
        Command::Export(command) => command.run(),
        Command::Fill(command) => command.run(),
        Command::Sequence(command) => command.run(),
        Command::Bench(command) => command.run(),
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

/// `N` numbers between commas.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let parsed: Vec<f64> = text.split(',').filter_map(|number| number.trim().parse().ok()).collect();
    let finite = parsed.iter().all(|number| number.is_finite());
    let right = text.split(',').count() == N && finite;
    parsed
        .try_into()
        .ok()
        .filter(|_| right)
        .ok_or_else(|| format!("give {N} numbers with commas between them"))
}
