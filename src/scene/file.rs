//! Scene files: JSON in, JSON out, and the schema that describes it.

use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};

use schemars::schema_for;
use serde_json::Value;

use super::{FORMAT, Scene, validate, wrong_format};
use crate::{Error, Result};

/// Largest scene file, bytes: many times what the greatest scene needs.
const MAX_BYTES: u64 = 64 << 20;

/// How alike two names must be (Jaro-Winkler, 0 to 1) before one is offered for the other.
const ALIKE: f64 = 0.78;

/// What is wrong with a value that is none of the forms a choice has in JSON.
const CHOICE: &str =
    "expected exactly one choice: \"name\" or {\"name\": ...}; `nephos schema` lists the names";

impl Scene {
    /// Reads a scene from JSON, makes its quaternions unit length and validates it.
    ///
    /// # Errors
    /// [`Error::Scene`] with the JSON path of the first problem, what was found and
    /// what was expected; with line and column where the text is no JSON.
    pub fn from_json(text: &str) -> Result<Self> {
        // Editors on Windows put a byte order mark before the text.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = serde_json::Deserializer::from_str(text);
        let mut scene: Self = serde_path_to_error::deserialize(&mut reader)
            .map_err(|error| explain(text, error.path(), error.inner()))?;
        reader.end().map_err(|error| not_json(&error))?;
        refuse_positional(text, &scene)?;
        scene.normalise();
        scene.validate()?;
        Ok(scene)
    }

    /// Reads a scene file; `-` reads the standard input.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be read, [`Error::Format`] where it is
    /// too large, otherwise as [`Scene::from_json`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text =
            read(path).map_err(|source| Error::File { action: "read", path: path.to_owned(), source })?;
        if text.len() as u64 > MAX_BYTES {
            return Err(Error::Format {
                path: path.to_owned(),
                problem: format!("is larger than {} MiB: no scene file", MAX_BYTES >> 20),
            });
        }
        Self::from_json(&text)
    }

    /// The scene as JSON: indented, fields in the order of the types, a newline at the end.
    ///
    /// [`Scene::from_json`] gives back the same scene, to the last bit of each number,
    /// where the scene is valid.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self)
            .expect("a scene holds only numbers, text and lists, with text as keys");
        text.push('\n');
        text
    }

    /// Validates the scene and writes it as JSON.
    ///
    /// Other programs see the old file or the new one, never a half: the text goes to
    /// a file beside it, which then takes its name. After an error the old file is as it was.
    ///
    /// # Errors
    /// As [`Scene::validate`]; [`Error::File`] where the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.validate()?;
        write_whole(path.as_ref(), &self.to_json())
    }

    /// Makes quaternions unit length; those without a direction are left to validation.
    fn normalise(&mut self) {
        self.noise.rotation = validate::unit(self.noise.rotation);
        for ellipsoid in self.clouds.iter_mut().flat_map(|cloud| &mut cloud.ellipsoids) {
            ellipsoid.orientation = validate::unit(ellipsoid.orientation);
        }
    }
}

/// The JSON Schema (draft 2020-12) of scene files.
///
/// It knows fields, types and ranges. What only [`Scene::validate`] knows: vectors
/// that must have a direction, the readable time, the number of ellipsoids overall.
pub fn schema() -> Value {
    let mut schema = schema_for!(Scene);
    schema.insert("title".to_owned(), format!("nephos scene, format {FORMAT}").into());
    schema.to_value()
}

/// Writes `text` to a new file beside `path`, then gives it that name.
pub(crate) fn write_whole(path: &Path, text: &str) -> Result<()> {
    let file_error = |source| Error::File { action: "write", path: path.to_owned(), source };
    // The file behind a link is replaced, not the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let beside = name_beside(&target);
    let written = write_new(&beside, text).and_then(|()| fs::rename(&beside, &target));
    written.map_err(|source| {
        // The first error is the one to tell; a leftover is no more than untidy.
        let _ = fs::remove_file(&beside);
        file_error(source)
    })
}

fn write_new(path: &Path, text: &str) -> io::Result<()> {
    let mut file = fs::File::create_new(path)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()
}

/// A hidden name in the folder of `target` that no other writer uses.
fn name_beside(target: &Path) -> PathBuf {
    static WRITES: AtomicU32 = AtomicU32::new(0);
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let write = WRITES.fetch_add(1, Ordering::Relaxed);
    target.with_file_name(format!(".{name}.{}-{write}.tmp", process::id()))
}

fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    if path == Path::new("-") {
        io::stdin().take(MAX_BYTES + 1).read_to_string(&mut text)?;
    } else {
        fs::File::open(path)?.take(MAX_BYTES + 1).read_to_string(&mut text)?;
    }
    Ok(text)
}

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
fn explain(text: &str, path: &serde_path_to_error::Path, error: &serde_json::Error) -> Error {
    let value: Option<Value> = serde_json::from_str(text).ok();
    // A file of another format has other fields: that explains everything else.
    if let Some(format) = value.as_ref().and_then(|value| value.get("format"))
        && format.is_number()
        && *format != FORMAT
    {
        return Error::Scene { path: "format".to_owned(), problem: wrong_format(format) };
    }
    let message = bare_message(error);
    let found = match message.as_str() {
        _ if error.is_data() => in_our_words(&message, path),
        "number out of range" => "the number is too large for any field".to_owned(),
        _ if value.is_none() => return not_json(error),
        // Sound JSON of another shape: the reader's own words would mislead.
        "trailing characters" => "the list is longer than expected".to_owned(),
        _ => CHOICE.to_owned(),
    };
    Error::Scene { path: told(path), problem: format!("{found} (line {})", error.line()) }
}

fn not_json(error: &serde_json::Error) -> Error {
    Error::Scene {
        path: format!("line {}, column {}", error.line(), error.column()),
        problem: format!("the text is no JSON: {}", bare_message(error)),
    }
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

/// Refuses lists where the schema wants objects: the reader would take the fields by
/// position, and no file should depend on their order.
fn refuse_positional(text: &str, scene: &Scene) -> Result<()> {
    let (Ok(found), Ok(own)) = (serde_json::from_str(text), serde_json::to_value(scene)) else {
        return Ok(());
    };
    refuse_lists_for_objects(&found, &own, validate::At::Root)
}

fn refuse_lists_for_objects(found: &Value, own: &Value, at: validate::At) -> Result<()> {
    match (found, own) {
        (Value::Array(_), Value::Object(_)) => Err(at.problem("found a list, expected an object {...}")),
        (Value::Array(found), Value::Array(own)) => found
            .iter()
            .zip(own)
            .enumerate()
            .try_for_each(|(i, (found, own))| refuse_lists_for_objects(found, own, at.index(i))),
        (Value::Object(found), Value::Object(own)) => found.iter().try_for_each(|(name, found)| {
            let own = own.get(name).unwrap_or(&Value::Null);
            refuse_lists_for_objects(found, own, at.field(name))
        }),
        _ => Ok(()),
    }
}
