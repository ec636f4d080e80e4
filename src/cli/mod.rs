//! The command line: one file a subcommand.

mod bench;
mod camera;
mod color;
mod desk;
#[cfg(feature = "editor")]
mod edit;
mod export;
mod fill;
mod import;
mod info;
#[cfg(feature = "editor")]
mod jobs;
mod new;
mod numbers;
mod picture;
mod render;
mod schema;
mod sequence;
mod tables;
mod terminal;
mod tone;
mod trace;

use std::{
    process::ExitCode,
    sync::{
        Arc, LazyLock,
        atomic::{AtomicBool, Ordering},
    },
};

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand, error::ErrorKind};

use crate::{Error, gpu::Gpu};

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
    Import(import::Import),
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
    let mut line = taking_negative_numbers(Cli::command()).arg_required_else_help(true);
    let asked = Cli::from_arg_matches(&line.get_matches_mut()).unwrap_or_else(|error| error.exit());
    let nothing =
        || line.error(ErrorKind::MissingSubcommand, "say what to do: `nephos help` lists it").exit();
    asked.command.unwrap_or_else(nothing)
}

/// Has all options read `-3` as a number, so that each says itself which ones it takes.
fn taking_negative_numbers(command: clap::Command) -> clap::Command {
    let reading = |arg: clap::Arg| {
        let reads = arg.get_action().takes_values() && !arg.is_allow_hyphen_values_set();
        if reads { arg.allow_negative_numbers(true) } else { arg }
    };
    command.mut_args(reading).mut_subcommands(taking_negative_numbers)
}

#[cfg(feature = "editor")]
pub use jobs::program;

/// Exit code of what Ctrl-C has stopped, as shells have it.
const STOPPED: u8 = 130;

/// Set by Ctrl-C: one for the program, as the signal is.
static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Opens the adapter, or the one whose name contains `name`; Ctrl-C stops waits for its device.
///
/// # Errors
/// [`Error::Adapter`] where there is none of that name.
fn open(name: Option<&str>) -> crate::Result<Gpu> {
    Ok(pollster::block_on(Gpu::open(name))?.stopped_by(STOP.clone()))
}

/// Has Ctrl-C stop work on the device where files are whole, and a second one stop all at once.
fn listen_to_ctrl_c() {
    use signal_hook::{consts::SIGINT, flag};
    let listening = flag::register_conditional_shutdown(SIGINT, STOPPED.into(), STOP.clone())
        .and_then(|_| flag::register(SIGINT, STOP.clone()));
    if let Err(error) = listening {
        tracing::warn!(%error, "Ctrl-C will stop the program wherever it is");
    }
}

impl Command {
    /// Whether it waits for the device, and can stop there.
    fn draws(&self) -> bool {
        matches!(self, Self::Render(_) | Self::Export(_) | Self::Sequence(_) | Self::Bench(_))
    }
}

/// The error of work that was stopped, if it was, with what is kept of it.
fn stopped(error: Error, kept: impl FnOnce() -> String) -> Error {
    // Programs that work for this one may have been stopped, too: then theirs is the error.
    let asked = STOP.load(Ordering::Relaxed);
    if asked || matches!(error, Error::Stopped { .. }) { Error::Stopped { kept: kept() } } else { error }
}

/// Runs the program: 0 where all went well, 1 where it did not, 2 for words that it does
/// not know, 130 where Ctrl-C stopped it.
pub fn main() -> ExitCode {
    terminal::log();
    let command = command();
    if command.draws() {
        listen_to_ctrl_c();
        desk::listen();
    }
    let result = match command {
        #[cfg(feature = "editor")]
        Command::Edit(command) => command.run(),
        Command::Render(command) => command.run(),
        Command::Export(command) => command.run(),
        Command::Fill(command) => command.run(),
        Command::Import(command) => command.run(),
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
            if matches!(error, Error::Stopped { .. }) { STOPPED.into() } else { ExitCode::FAILURE }
        }
    }
}
