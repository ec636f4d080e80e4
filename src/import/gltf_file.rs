//! glTF 2.0 files, and where their nodes are in the world.

use std::{fs, path::Path};

use glam::{DMat4, Mat4};
use gltf::{Accessor, Gltf, Node, buffer::View};

use crate::{Error, Result};

/// Reads a .gltf or .glb file.
pub(super) fn open(path: &Path) -> Result<Gltf> {
    let bytes =
        fs::read(path).map_err(|source| Error::File { action: "read", path: path.to_owned(), source })?;
    // The reader of binary files trusts that they tell a length of at least their own header.
    const HEADER: u32 = 12;
    let told = bytes.get(8..12).and_then(|length| length.try_into().ok()).map(u32::from_le_bytes);
    if bytes.starts_with(b"glTF") && told.is_none_or(|length| length < HEADER) {
        return Err(foreign(path, &"its header is cut or damaged"));
    }
    // Its check of a mesh trusts that the numbers of accessors are those of some.
    let unchecked = Gltf::from_slice_without_validation(&bytes).map_err(|error| foreign(path, &error))?;
    let root = unchecked.document.as_json();
    let mut named = root.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|p| p.attributes.values());
    if let Some(missing) = named.find(|accessor| accessor.value() >= root.accessors.len()) {
        return Err(foreign(path, &format!("a mesh names accessor {}, which is not there", missing.value())));
    }
    Gltf::from_slice(&bytes).map_err(|error| foreign(path, &error))
}

/// What can't be made use of, and why.
pub(super) fn foreign(path: &Path, reason: &impl std::fmt::Display) -> Error {
    let problem = format!("is no glTF 2.0 file that can be read ({reason}): export it anew");
    Error::Format { path: path.to_owned(), problem }
}

/// Calls `visit` for each node of the file's scene (of all its scenes, where it names none) with the map
/// from the node to the world.
pub(super) fn visit_nodes<'a>(file: &'a Gltf, visit: &mut dyn FnMut(&Node<'a>, DMat4)) {
    let scenes =
        || file.scenes().filter(|scene| file.default_scene().is_none_or(|own| own.index() == scene.index()));
    let mut open: Vec<_> =
        scenes().flat_map(|scene| scene.nodes()).map(|node| (node, DMat4::IDENTITY)).collect();
    open.reverse();
    // Files are trees by the standard, but not by force: what comes again is part of a ring.
    let mut seen = vec![false; file.nodes().len()];
    while let Some((node, world_from_parent)) = open.pop() {
        if std::mem::replace(&mut seen[node.index()], true) {
            continue;
        }
        let matrix = Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
        let world_from_node = world_from_parent * matrix;
        visit(&node, world_from_node);
        open.extend(node.children().map(|child| (child, world_from_node)));
    }
}

/// Whether an accessor's numbers lie in its buffers, one after another. Their reader trusts that they do.
pub(super) fn is_whole(accessor: &Accessor<'_>) -> bool {
    let size = accessor.size();
    let sparse = accessor.sparse().is_none_or(|sparse| {
        let (indices, values, count) = (sparse.indices(), sparse.values(), sparse.count());
        holds(&indices.view(), indices.offset(), count, indices.index_type().size())
            && holds(&values.view(), values.offset(), count, size)
    });
    sparse && accessor.view().is_some_and(|view| holds(&view, accessor.offset(), accessor.count(), size))
}

/// Whether a view of a buffer holds `count` numbers of `size` bytes from `offset` on.
fn holds(view: &View<'_>, offset: usize, count: usize, size: usize) -> bool {
    let stride = view.stride().unwrap_or(size);
    let before_last = count.checked_sub(1).and_then(|count| count.checked_mul(stride));
    let end = before_last.and_then(|bytes| bytes.checked_add(size)?.checked_add(offset));
    let view_end = view.offset().checked_add(view.length());
    stride >= size
        && end.is_some_and(|end| end <= view.length())
        && view_end.is_some_and(|end| end <= view.buffer().length())
}
