//! glTF 2.0 files: their documents, their bytes, and where their nodes are in the world.

mod accessor;
mod document;
mod motion;
mod shape;

use std::{
    cell::OnceCell,
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use glam::DMat4;
use gltf::{
    binary::Glb,
    buffer::{Data, Source},
};

use self::document::{Document, Node};
pub(super) use self::{document::Lens, motion::Motion, shape::read_mesh};
use crate::{Error, Result};

/// A .gltf or .glb file; its buffers are read once somebody asks for them.
pub(super) struct Gltf {
    path: PathBuf,
    document: Document,
    /// The bytes of a .glb file that follow its document.
    blob: Option<Vec<u8>>,
    buffers: Vec<OnceCell<Vec<u8>>>,
}

impl Gltf {
    pub fn open(path: &Path) -> Result<Self> {
        let bytes =
            fs::read(path).map_err(|source| Error::File { action: "read", path: path.to_owned(), source })?;
        let (text, blob) = if bytes.starts_with(b"glTF") { unpacked(path, &bytes)? } else { (bytes, None) };
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
        let document: Document = serde_json::from_slice(text).map_err(|error| foreign(path, &error))?;
        let version = &document.asset.version;
        if !version.starts_with("2.") {
            return Err(foreign(path, &format!("its version is `{version}`")));
        }
        let buffers = document.buffers.iter().map(|_| OnceCell::new()).collect();
        let file = Self { path: path.to_owned(), document, blob, buffers };
        match file.document.unknown_extension() {
            Some(name) => Err(file.needs(name)),
            None => Ok(file),
        }
    }

    /// What can't be made use of, and why.
    fn foreign(&self, reason: &impl std::fmt::Display) -> Error {
        foreign(&self.path, reason)
    }

    /// The file can't be read without an extension.
    fn needs(&self, extension: &str) -> Error {
        let way_out = if ["draco", "meshopt"].iter().any(|name| extension.contains(name)) {
            "switch compression off in the export"
        } else {
            "export it without"
        };
        let problem = format!("needs {extension}, which is not read here: {way_out}");
        Error::Format { path: self.path.clone(), problem }
    }

    /// The shown nodes, parents first, each with the map from the node to the world.
    pub fn nodes(&self) -> Vec<(&Node, DMat4)> {
        self.walk().into_iter().map(|(i, world)| (&self.document.nodes[i], world)).collect()
    }

    /// The shown nodes that have cameras, by their numbers.
    pub fn with_cameras(&self) -> Vec<(usize, &Node, &Lens)> {
        let found = self.walk().into_iter().filter_map(|(i, _)| {
            let node = &self.document.nodes[i];
            Some((i, node, self.document.cameras.get(node.camera?)?))
        });
        found.collect()
    }

    fn walk(&self) -> Vec<(usize, DMat4)> {
        self.walk_by(|_, node| node.transform())
    }

    /// The shown nodes of the file's scene (of all its scenes, where it names none; of all nodes where there
    /// is no scene), parents first, each with the map from the node to the world; `pose` is that to the parent.
    fn walk_by(&self, pose: impl Fn(usize, &Node) -> DMat4) -> Vec<(usize, DMat4)> {
        let nodes = &self.document.nodes;
        let mut open: Vec<_> = self.roots().into_iter().rev().map(|root| (root, DMat4::IDENTITY)).collect();
        // Files are trees by the standard, but not by force: what comes again is part of a ring.
        let mut seen = vec![false; nodes.len()];
        let mut found = Vec::new();
        while let Some((i, world_from_parent)) = open.pop() {
            let Some(node) = nodes.get(i).filter(|node| !node.is_hidden()) else { continue };
            if std::mem::replace(&mut seen[i], true) {
                continue;
            }
            let world_from_node = world_from_parent * pose(i, node);
            found.push((i, world_from_node));
            open.extend(node.children.iter().map(|&child| (child, world_from_node)));
        }
        found
    }

    fn roots(&self) -> Vec<usize> {
        let Document { scene, scenes, nodes, .. } = &self.document;
        let shown = |i: &usize| scene.is_none_or(|scene| scene == *i);
        if scenes.is_empty() {
            let children: BTreeSet<_> = nodes.iter().flat_map(|node| &node.children).collect();
            return (0..nodes.len()).filter(|i| !children.contains(&i)).collect();
        }
        (0..scenes.len()).filter(shown).flat_map(|i| scenes[i].nodes.clone()).collect()
    }

    /// The bytes of a buffer.
    fn buffer(&self, index: usize) -> Result<&[u8]> {
        let (Some(told), Some(cell)) = (self.document.buffers.get(index), self.buffers.get(index)) else {
            return Err(self.foreign(&format!("it names buffer {index}, which is not there")));
        };
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let bytes = match (&told.uri, &self.blob) {
            (Some(uri), _) => self.linked(uri)?,
            (None, Some(blob)) if index == 0 => blob.clone(),
            _ => return Err(self.foreign(&format!("buffer {index} has no bytes"))),
        };
        if bytes.len() < told.byte_length {
            let name = told.uri.as_deref().filter(|uri| !uri.starts_with("data:")).unwrap_or("inside");
            return Err(self.foreign(&format!(
                "buffer {index} ({name}) has {} bytes where {} are told",
                bytes.len(),
                told.byte_length
            )));
        }
        Ok(cell.get_or_init(|| bytes))
    }

    /// The bytes behind a URI: data, or a file named from the folder of this one.
    fn linked(&self, uri: &str) -> Result<Vec<u8>> {
        if uri.starts_with("data:") {
            let data = Data::from_source(Source::Uri(uri), None);
            return Ok(data.map_err(|error| self.foreign(&error))?.0);
        }
        let plain = uri.strip_prefix("file://").unwrap_or(uri);
        let name = String::from_utf8_lossy(&urlencoding::decode_binary(plain.as_bytes())).into_owned();
        let path = self.path.parent().unwrap_or(Path::new("")).join(name);
        fs::read(&path).map_err(|error| Error::Format {
            path: self.path.clone(),
            problem: format!(
                "keeps its mesh in `{}`, which cannot be read ({error}): put that file there, or export as .glb",
                path.display()
            ),
        })
    }
}

/// Document and bytes of a binary file.
fn unpacked(path: &Path, bytes: &[u8]) -> Result<(Vec<u8>, Option<Vec<u8>>)> {
    // Their reader trusts that they tell a length of at least their own header.
    const HEADER: u32 = 12;
    let told = bytes.get(8..12).and_then(|length| length.try_into().ok()).map(u32::from_le_bytes);
    if told.is_none_or(|length| length < HEADER) {
        return Err(foreign(path, &"its header is cut or damaged"));
    }
    let parts = Glb::from_slice(bytes).map_err(|error| foreign(path, &error))?;
    Ok((parts.json.into_owned(), parts.bin.map(std::borrow::Cow::into_owned)))
}

fn foreign(path: &Path, reason: &impl std::fmt::Display) -> Error {
    let problem = format!("is no glTF 2.0 file that can be read ({reason}): export it anew");
    Error::Format { path: path.to_owned(), problem }
}
