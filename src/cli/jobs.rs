//! The command line described to the editor, which shows its options and runs it beside the work.

use clap::{Arg, Command, CommandFactory};

use super::{Cli, taking_negative_numbers};
use crate::editor::jobs::{Asked, KINDS, Kind, Program};

/// Options that are nothing to ask for in a window.
const LEFT_OUT: [&str; 3] = ["help", "json", "stats"];

/// This program, as the editor may run it; nothing where it does not know its own file.
pub fn program() -> Option<Program> {
    let path = std::env::current_exe().ok()?;
    let whole = taking_negative_numbers(Cli::command());
    let kinds = KINDS.iter().filter_map(|(words, title, file)| {
        let words: Vec<String> = words.split(' ').map(str::to_owned).collect();
        let command = words.iter().try_fold(&whole, |command, word| command.find_subcommand(word))?;
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        Some(Kind { words, title, about, file, options: options(command) })
    });
    Some(Program { path, kinds: kinds.collect(), check })
}

/// The options of a command, the file that it writes first.
fn options(command: &Command) -> Vec<Asked> {
    let named = command.get_arguments().filter(|arg| arg.get_long().is_some() && !arg.is_hide_set());
    let mut options: Vec<_> = named.map(asked).filter(|a| !LEFT_OUT.contains(&a.name.as_str())).collect();
    options.sort_by_key(|option| option.name != "output");
    options
}

fn asked(arg: &Arg) -> Asked {
    let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    let takes_value = arg.get_action().takes_values();
    let first = |values: Vec<String>| values.into_iter().next().unwrap_or_default();
    // A list is written, not chosen.
    let is_one = takes_value && arg.get_value_delimiter().is_none();
    let values = arg.get_possible_values().into_iter().filter(|value| is_one && !value.is_hide_set());
    let values = values.map(|value| {
        (value.get_name().to_owned(), value.get_help().map(ToString::to_string).unwrap_or_default())
    });
    Asked {
        name: arg.get_long().unwrap_or_default().to_owned(),
        help: help.split_whitespace().collect::<Vec<_>>().join(" "),
        value: first(arg.get_value_names().unwrap_or_default().iter().map(ToString::to_string).collect()),
        default: first(arg.get_default_values().iter().map(|v| v.to_string_lossy().into_owned()).collect()),
        values: values.collect(),
        takes_value,
    }
}

/// What is wrong with the words of a command, in a sentence.
fn check(words: &[String]) -> Result<(), String> {
    let line = [env!("CARGO_PKG_NAME").to_owned()].into_iter().chain(words.iter().cloned());
    let found = taking_negative_numbers(Cli::command()).try_get_matches_from(line);
    found.map(drop).map_err(|error| {
        let text = error.render().to_string();
        let lines =
            text.lines().take_while(|line| !line.starts_with("Usage") && !line.starts_with("For more"));
        let text = lines.map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
        text.strip_prefix("error: ").unwrap_or(&text).to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_job_is_a_command_with_a_file_to_write() {
        let program = program().unwrap();
        assert_eq!(program.kinds.len(), KINDS.len());
        for kind in &program.kinds {
            assert_eq!(kind.options[0].name, "output", "{}", kind.title);
            assert!(kind.about.len() > 20 && kind.options.iter().all(|option| option.help.len() > 10));
        }
    }

    #[test]
    fn what_the_command_line_would_refuse_is_told_in_a_sentence() {
        let check = |words: &str| check(&words.split(' ').map(str::to_owned).collect::<Vec<_>>());
        assert_eq!(check("render a.json --output=a.png --width=64"), Ok(()));
        let told = check("render a.json --output=a.png --width=0").unwrap_err();
        assert!(told.contains("--width") && told.contains('0') && !told.contains("Usage"), "{told}");
        assert!(check("export volume a.json").unwrap_err().contains("--output"));
    }
}
