//! What the JSON reader says, in words for the person who wrote the file.

use serde_json::Value;

use super::{FORMAT, validate, wrong_format};
use crate::Error;

/// How alike two names must be (Jaro-Winkler, 0 to 1) before one is offered for the other.
const ALIKE: f64 = 0.78;

/// What is wrong with a value that is none of the forms a choice has in JSON.
const CHOICE: &str =
    "expected exactly one choice: \"name\" or {\"name\": ...}; `nephos schema` lists the names";

/// The nearest of `known` to `name`, if any is near.
pub(super) fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
    let likeness = |other: &str| strsim::jaro_winkler(&name, other);
    known
        .iter()
        .map(|&other| (likeness(other), other))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, other)| other)
}

/// The error of the JSON reader in words for the person who wrote the file.
pub(super) fn explain(text: &str, path: &serde_path_to_error::Path, error: &serde_json::Error) -> Error {
    let value: Option<Value> = serde_json::from_str(text).ok();
    // A file of another format has other fields: that explains everything else.
    if let Some(format) = value.as_ref().and_then(|value| value.get("format"))
        && format.is_number()
        && format.as_f64() != Some(f64::from(FORMAT))
    {
        return Error::Scene { path: "format".to_owned(), problem: wrong_format(format) };
    }
    let message = bare_message(error);
    let found = match message.as_str() {
        _ if error.is_data() => in_our_words(&message, path),
        "number out of range" => "the number is too large for any field".to_owned(),
        _ if value.is_none() => return not_json(text, error),
        // Sound JSON of another shape: the reader's own words would mislead.
        "trailing characters" => "the list is longer than expected".to_owned(),
        _ => CHOICE.to_owned(),
    };
    Error::Scene { path: told(path), problem: format!("{found} (line {})", error.line()) }
}

pub(super) fn not_json(text: &str, error: &serde_json::Error) -> Error {
    let said = bare_message(error);
    Error::Scene {
        path: format!("line {}, column {}", error.line(), error.column()),
        problem: format!("the text is no JSON: {}", other_language(text, error).unwrap_or(&said)),
    }
}

/// What stands where the reader stopped, if other languages have it.
fn other_language(text: &str, error: &serde_json::Error) -> Option<&'static str> {
    let line = text.split('\n').nth(error.line().checked_sub(1)?)?;
    // The reader stops at the word that it does not know, or in it.
    let stop = line.char_indices().map(|(at, _)| at).take_while(|at| *at < error.column()).last()?;
    let before = line[..stop].trim_end_matches(|c: char| c.is_alphanumeric() || "+-/".contains(c));
    let word = line[before.len()..].to_lowercase();
    let number = word.trim_start_matches(['+', '-']);
    if ["nan", "inf"].iter().any(|start| number.starts_with(start)) {
        return Some("it has no NaN and no Infinity; write a number, or leave the field out for its default");
    }
    if ["//", "/*", "#"].iter().any(|start| word.starts_with(start)) {
        return Some("it has no comments; remove them, or write what they say as a `name`");
    }
    let python = ["none", "true", "false"].iter().any(|start| word.starts_with(start));
    python.then_some("its words are `null`, `true` and `false`, in small letters")
}

/// The message of `error` without its place.
fn bare_message(error: &serde_json::Error) -> String {
    let message = error.to_string();
    match message.rsplit_once(" at line ") {
        Some((message, _)) => message.to_owned(),
        None => message,
    }
}

/// `path` in words; the root has none of its own.
fn told(path: &serde_path_to_error::Path) -> String {
    match path.iter().len() {
        0 => validate::At::Root.to_string(),
        _ => path.to_string(),
    }
}

/// serde's message about the value at `path` in the words of the scene.
fn in_our_words(message: &str, path: &serde_path_to_error::Path) -> String {
    if let Some(rest) = message.strip_prefix("unknown field ") {
        return unknown("field", rest);
    }
    if let Some(rest) = message.strip_prefix("unknown variant ") {
        return unknown("choice", rest);
    }
    if let Some(rest) = message.strip_prefix("invalid length ") {
        let (found, expected) = rest.split_once(", expected ").unwrap_or((rest, "another"));
        return format!("found {found} values, expected {}", plain(expected));
    }
    let found = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "));
    match found.and_then(|rest| rest.split_once(", expected ")) {
        Some((found, "newtype variant" | "struct variant")) => {
            let choice = path.iter().next_back().map(ToString::to_string).unwrap_or_default();
            format!("found {}, expected {{\"{choice}\": ...}} with its values", plain(found))
        }
        Some((found, expected)) => format!("found {}, expected {}", plain(found), plain(expected)),
        None => message.to_owned(),
    }
}

/// `rest` is serde's list of quoted names, the unknown one first.
fn unknown(what: &str, rest: &str) -> String {
    let mut names = rest.split('`').skip(1).step_by(2);
    let name = names.next().unwrap_or_default();
    let known: Vec<&str> = names.collect();
    let hint = match nearest(name, &known) {
        Some(near) => format!("; did you mean `{near}`?"),
        None => ".".to_owned(),
    };
    format!("unknown {what} `{name}`{hint} Known: {}", known.join(", "))
}

/// A type of Rust or serde in the words of JSON.
fn plain(kind: &str) -> &str {
    match kind {
        "f64" => "a number",
        "u32" => "a whole number from 0 to 4294967295",
        "map" => "an object",
        "sequence" => "a list",
        "a sequence" => "a list [...]",
        "unit variant" => "only a name",
        "unit" => "only the name",
        "a sequence of 3 f64 values" | "an array of length 3" => "a list of 3 numbers",
        "a sequence of 4 f64 values" => "a list of 4 numbers",
        _ if kind.starts_with("struct ") => "an object {...}",
        _ => kind,
    }
}
