//! Pictures, sequences and exports beside the work. A job is the program itself with the command line that
//! is shown: what is shown is what runs, and the command line alone says which options there are.

mod form;
mod list;
mod process;
mod queue;

use std::path::PathBuf;

pub use form::{JobForm, JobWish};
pub use queue::{Ended, Jobs, Order};

/// The program that does jobs, and the jobs that it does. The command line describes itself by this.
#[derive(Debug, Clone)]
pub struct Program {
    /// The file of the program.
    pub path: PathBuf,
    /// What it does, in the order of [`KINDS`].
    pub kinds: Vec<Kind>,
    /// What is wrong with the words behind the program's name, in a sentence, where anything is.
    pub check: fn(&[String]) -> Result<(), String>,
}

/// The jobs that there are: the words of the command, the name in menus, what the file is called where the
/// scene is called `scene`.
pub const KINDS: [(&str, &str, &str); 9] = [
    ("render", "Render picture", "scene.png"),
    ("sequence", "Render sequence", "scene/frame.####.png"),
    ("export volume", "Export volume", "scene.vdb"),
    ("export sky", "Export sky map", "scene-sky.exr"),
    ("export shadow", "Export shadow map", "scene-shadow.exr"),
    ("export sixway", "Export six-way sprite", "scene-sixway.png"),
    ("export flipbook", "Export flip-book", "scene-flipbook.png"),
    ("export impostor", "Export impostor", "scene-impostor.png"),
    ("export camera", "Export camera", "scene.glb"),
];

/// A kind of job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kind {
    /// The words of the command, such as "export", "volume".
    pub words: Vec<String>,
    /// Its name in menus.
    pub title: &'static str,
    /// What it does, a sentence.
    pub about: String,
    /// What the file that it writes is called, where a scene is called `scene`.
    pub file: &'static str,
    /// Its options, in order.
    pub options: Vec<Asked>,
}

/// An option of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Asked {
    /// Its long name.
    pub name: String,
    /// What it does.
    pub help: String,
    /// What stands for its value, such as "PIXELS".
    pub value: String,
    /// Its value where it is left out, as far as the command line knows that.
    pub default: String,
    /// The values that it may have, each with what it is; empty where those are too many.
    pub values: Vec<(String, String)>,
    /// Whether it has a value, and is not just there or left out.
    pub takes_value: bool,
}

/// The words of a command for a shell to read.
fn shell_line(words: &[String]) -> String {
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+%@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    if cfg!(windows) { format!("\"{word}\"") } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn shells_read_lines_as_they_are_meant() {
        let words = ["printf", "%s\n", "a b", "it's", "$HOME", "frame.####.exr", "", "-3", "ü"];
        let words = words.map(str::to_owned);
        let out = std::process::Command::new("sh").args(["-c", &shell_line(&words)]).output().unwrap();
        assert_eq!(String::from_utf8(out.stdout).unwrap(), words[2..].join("\n") + "\n");
    }
}
