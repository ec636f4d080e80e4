//! Scene files: JSON in, JSON out, and the schema that describes it.

use std::borrow::Cow;
use std::fs;
use std::io::{self, Read, Write};
use std::path::Path;
use std::string::FromUtf8Error;

use schemars::schema_for;
use serde_json::Value;

use super::explain::{explain, not_json};
use super::{Cloud, FORMAT, MAX_ELLIPSOIDS, Mesh, Scene, validate};
use crate::files::write_whole;
use crate::{Error, Result};

/// Largest scene file, bytes: many times what the greatest scene needs.
const MAX_BYTES: u64 = 64 << 20;

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
        reader.end().map_err(|error| not_json(text, &error))?;
        refuse_positional(text, &scene)?;
        scene.normalise();
        scene.grow_clouds()?;
        scene.validate()?;
        Ok(scene)
    }

    /// Reads a scene file; `-` reads the standard input.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be read, [`Error::Format`] where it is
    /// too large, otherwise as [`Scene::from_json`] and [`Scene::read_volumes`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let bytes =
            read(path).map_err(|source| Error::File { action: "read", path: path.to_owned(), source })?;
        let refused = |problem: String| Error::Format { path: path.to_owned(), problem };
        if bytes.len() as u64 > MAX_BYTES {
            return Err(refused(format!("is larger than {} MiB: no scene file", MAX_BYTES >> 20)));
        }
        let text = String::from_utf8(bytes).map_err(|error| refused(encoding(&error)))?;
        let mut scene = Self::from_json(&text)?;
        scene.read_volumes(folder_of(path))?;
        Ok(scene)
    }

    /// Reads the files of its meshes and volumes, of the maps of its layers and of the picture of its ground, whose paths start from `folder`.
    ///
    /// # Errors
    /// [`Error::Scene`] with the JSON path of the first that can't be read, and why.
    pub fn read_volumes(&mut self, folder: &Path) -> Result<()> {
        let root = validate::At::Root;
        if let Some(picture) = self.ground.kind.picture_mut() {
            let ground = root.field("ground");
            let kind = ground.field("kind");
            let at = kind.field("picture");
            picture.read(folder).map_err(|error| at.problem(error.to_string()))?;
        }
        let list = root.field("clouds");
        let mut meshes: Vec<Mesh> = Vec::new();
        for (i, cloud) in self.clouds.iter_mut().enumerate() {
            let at = list.index(i);
            if let Some(map) = cloud.layer.as_mut().and_then(|layer| layer.map.as_mut()) {
                let layer = at.field("layer");
                let at = layer.field("map");
                map.read(folder).map_err(|error| at.problem(error.to_string()))?;
            }
            if let Some(mesh) = &mut cloud.mesh {
                let at = at.field("mesh");
                match meshes.iter().find(|known| known.file == mesh.file) {
                    Some(known) => mesh.take_surface_of(known),
                    None => mesh.read(folder).map_err(|error| at.problem(error.to_string()))?,
                }
                meshes.push(mesh.clone());
                mesh.check(at)?;
            }
            let Some(volume) = &mut cloud.volume else { continue };
            let at = at.field("volume");
            volume.read(folder).map_err(|error| at.problem(error.to_string()))?;
            volume.check(at)?;
        }
        Ok(())
    }

    /// The scene as JSON: indented, vectors on one line, fields in the order of the
    /// types, a newline at the end.
    ///
    /// [`Scene::from_json`] gives back the same scene, to the last bit of each number,
    /// where the scene is valid.
    pub fn to_json(&self) -> String {
        let text = serde_json::to_string_pretty(&self.as_written())
            .expect("a scene holds only numbers, text and lists, with text as keys");
        vectors_on_one_line(&text)
    }

    /// Validates the scene and writes it as JSON.
    ///
    /// Other programs see the old file or the new one, never a half: the text goes to
    /// a file beside it, which then takes its name. After an error the old file is as it was. Paths of meshes, volumes,
    /// maps and pictures that were read are told from the folder of the file.
    ///
    /// # Errors
    /// As [`Scene::validate`]; [`Error::File`] where the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.validate()?;
        let path = path.as_ref();
        let names = |cloud: &Cloud| cloud.is_of_file() || cloud.map().is_some();
        let text = match self.clouds.iter().any(names) || self.ground.kind.picture().is_some() {
            true => self.written_from(folder_of(path)).to_json(),
            false => self.to_json(),
        };
        write_whole(path, |file| file.write_all(text.as_bytes()))
    }

    /// The same scene in a file in `folder`: paths of meshes, volumes and maps that were read are told from there.
    pub(crate) fn written_from(&self, folder: &Path) -> Self {
        let mut written = self.clone();
        written.volumes_mut().for_each(|volume| *volume = volume.written_from(folder));
        written.meshes_mut().for_each(|mesh| *mesh = mesh.written_from(folder));
        let maps = written.clouds.iter_mut().filter_map(|cloud| cloud.layer.as_mut()?.map.as_mut());
        maps.for_each(|map| *map = map.written_from(folder));
        if let Some(picture) = written.ground.kind.picture_mut() {
            *picture = picture.written_from(folder);
        }
        written
    }

    /// Grows the clouds of a file that say how. Their numbers are looked at first: nothing grows from bad ones.
    fn grow_clouds(&mut self) -> Result<()> {
        let root = validate::At::Root;
        let list = root.field("clouds");
        let mut count = 0;
        for (i, cloud) in self.clouds.iter_mut().enumerate() {
            let at = list.index(i);
            let Some(growth) = &cloud.growth else { continue };
            if !cloud.ellipsoids.is_empty() {
                return Err(at.problem(format!(
                    "it has both `growth` and {} `ellipsoids`: leave out `ellipsoids` to let it grow, or `growth` \
                     to keep them",
                    cloud.ellipsoids.len()
                )));
            }
            growth.check(at.field("growth"))?;
            if count <= MAX_ELLIPSOIDS {
                cloud.grow();
            }
            count += cloud.ellipsoids.len();
        }
        Ok(())
    }

    /// The scene as files have it: clouds that are as grown without their ellipsoids, others without a growth.
    fn as_written(&self) -> Cow<'_, Self> {
        if self.clouds.iter().all(|cloud| cloud.growth.is_none()) {
            return Cow::Borrowed(self);
        }
        let mut written = self.clone();
        for cloud in &mut written.clouds {
            match cloud.is_as_grown() {
                true => cloud.ellipsoids.clear(),
                false if cloud.ellipsoids.is_empty() => {}
                false => cloud.growth = None,
            }
        }
        Cow::Owned(written)
    }

    /// Makes quaternions unit length; those without a direction are left to validation.
    fn normalise(&mut self) {
        for noise in self.noises_mut() {
            noise.rotation = validate::unit(noise.rotation);
        }
        for ellipsoid in self.clouds.iter_mut().flat_map(|cloud| &mut cloud.ellipsoids) {
            ellipsoid.orientation = validate::unit(ellipsoid.orientation);
        }
        for volume in self.volumes_mut() {
            volume.orientation = validate::unit(volume.orientation);
        }
        for mesh in self.meshes_mut() {
            mesh.orientation = validate::unit(mesh.orientation);
        }
    }
}

/// The folder of a file: that of the program where the file is the standard input.
fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
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

/// Indented JSON with every list of numbers on one line, as people write vectors.
fn vectors_on_one_line(text: &str) -> String {
    let is_number = |line: &str| line.trim_end_matches(',').parse::<f64>().is_ok();
    let mut joined = String::with_capacity(text.len());
    let mut in_vector = false;
    let mut lines = text.lines().peekable();
    // No string breaks a line or ends one with a bracket: those are of lists.
    while let Some(line) = lines.next() {
        joined.push_str(if in_vector { line.trim_start() } else { line });
        let next = lines.peek().map_or("", |next| next.trim_start());
        let opens = line.ends_with('[') && is_number(next);
        in_vector = opens || (in_vector && is_number(line.trim_start()));
        match in_vector {
            false => joined.push('\n'),
            true if line.ends_with(',') => joined.push(' '),
            true => {}
        }
    }
    joined
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        io::stdin().take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    } else {
        fs::File::open(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}

/// What bytes are that are no UTF-8, and the way out.
fn encoding(error: &FromUtf8Error) -> String {
    let bytes = error.as_bytes();
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return "is written in UTF-16: save it as UTF-8 (`-Encoding utf8` in PowerShell)".to_owned();
    }
    let right = error.utf8_error().valid_up_to();
    let line = bytes[..right].iter().filter(|byte| **byte == b'\n').count() + 1;
    format!("has a byte in line {line} that is no UTF-8 ({:#04x}): save it as UTF-8", bytes[right])
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
