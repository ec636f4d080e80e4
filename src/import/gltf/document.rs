//! The parts of a glTF 2.0 document that meshes and cameras need: all else may be as it likes.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;
use serde_json::Value;

/// Extensions by name, with what each says.
pub(super) type Extensions = BTreeMap<String, Value>;

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    pub asset: Asset,
    #[serde(default)]
    pub extensions_used: Vec<String>,
    #[serde(default)]
    pub extensions_required: Vec<String>,
    pub scene: Option<usize>,
    #[serde(default)]
    pub scenes: Vec<Tree>,
    #[serde(default)]
    pub nodes: Vec<Node>,
    #[serde(default)]
    pub meshes: Vec<Shape>,
    #[serde(default)]
    pub skins: Vec<Skin>,
    #[serde(default)]
    pub cameras: Vec<Lens>,
    #[serde(default)]
    pub animations: Vec<Animation>,
    #[serde(default)]
    pub accessors: Vec<Accessor>,
    #[serde(default)]
    pub buffer_views: Vec<View>,
    #[serde(default)]
    pub buffers: Vec<Buffer>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Asset {
    pub version: String,
}

#[derive(Debug, Deserialize)]
pub(super) struct Tree {
    #[serde(default)]
    pub nodes: Vec<usize>,
}

#[derive(Debug, Deserialize)]
pub(in crate::import) struct Node {
    pub name: Option<String>,
    #[serde(default)]
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    pub camera: Option<usize>,
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<DVec3>,
    pub rotation: Option<DQuat>,
    pub scale: Option<DVec3>,
    /// Of the mesh's morph targets, in place of the mesh's own.
    pub weights: Option<Vec<f64>>,
    #[serde(default)]
    pub extensions: Extensions,
}

#[derive(Debug, Deserialize)]
pub(super) struct Shape {
    pub primitives: Vec<Primitive>,
    #[serde(default)]
    pub weights: Vec<f64>,
    #[serde(default)]
    pub extensions: Extensions,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub mode: Option<u32>,
    #[serde(default)]
    pub targets: Vec<BTreeMap<String, usize>>,
    #[serde(default)]
    pub extensions: Extensions,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub inverse_bind_matrices: Option<usize>,
    pub joints: Vec<usize>,
}

#[derive(Debug, Deserialize)]
pub(in crate::import) struct Lens {
    pub name: Option<String>,
    pub perspective: Option<Perspective>,
    pub orthographic: Option<Orthographic>,
    /// What the file's program says beyond glTF.
    #[serde(default)]
    pub extras: Value,
}

#[derive(Debug, Deserialize)]
pub(in crate::import) struct Perspective {
    pub yfov: f64,
}

#[derive(Debug, Deserialize)]
pub(in crate::import) struct Orthographic {
    pub ymag: f64,
}

#[derive(Debug, Deserialize)]
pub(super) struct Animation {
    #[serde(default)]
    pub channels: Vec<Channel>,
    #[serde(default)]
    pub samplers: Vec<Sampler>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Channel {
    pub sampler: usize,
    pub target: Target,
}

#[derive(Debug, Deserialize)]
pub(super) struct Target {
    pub node: Option<usize>,
    pub path: String,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sampler {
    pub input: usize,
    pub output: usize,
    pub interpolation: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: usize,
    pub component_type: u32,
    #[serde(default)]
    pub normalized: bool,
    pub count: usize,
    #[serde(rename = "type")]
    pub kind: String,
    pub sparse: Option<Sparse>,
    #[serde(default)]
    pub extensions: Extensions,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub count: usize,
    pub indices: SparsePart,
    pub values: SparsePart,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: usize,
    /// Of indices; values are of the accessor's.
    pub component_type: Option<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: Option<usize>,
    #[serde(default)]
    pub extensions: Extensions,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    pub byte_length: usize,
}

impl Node {
    /// From the node to its parent.
    pub fn transform(&self) -> DMat4 {
        match &self.matrix {
            Some(matrix) => DMat4::from_cols_array(matrix),
            None => placed(self.translation, self.rotation, self.scale),
        }
    }

    pub fn is_hidden(&self) -> bool {
        let told = self.extensions.get("KHR_node_visibility").and_then(|told| told.get("visible"));
        told == Some(&Value::Bool(false))
    }
}

/// Scaled, then turned, then moved.
pub(super) fn placed(move_by: Option<DVec3>, turn: Option<DQuat>, scale: Option<DVec3>) -> DMat4 {
    let turn = turn.filter(|turn| turn.length_squared() > 0.0).unwrap_or_default().normalize();
    DMat4::from_scale_rotation_translation(scale.unwrap_or(DVec3::ONE), turn, move_by.unwrap_or_default())
}

impl Document {
    /// The name of an extension that the file requires for its meshes or transforms and that is not known here.
    pub fn unknown_extension(&self) -> Option<&str> {
        let geometry = (self.nodes.iter().map(|node| &node.extensions))
            .chain(self.meshes.iter().map(|mesh| &mesh.extensions))
            .chain(self.meshes.iter().flat_map(|mesh| &mesh.primitives).map(|part| &part.extensions))
            .chain(self.accessors.iter().map(|accessor| &accessor.extensions))
            .chain(self.buffer_views.iter().map(|view| &view.extensions));
        let used: BTreeSet<_> = geometry.flat_map(Extensions::keys).collect();
        let required = self.extensions_required.iter();
        required.filter(|name| used.contains(name)).find(|name| !is_known(name)).map(String::as_str)
    }
}

/// Whether an extension is read here, or says nothing about where a mesh is.
fn is_known(extension: &str) -> bool {
    const READ: [&str; 3] = ["EXT_mesh_gpu_instancing", "KHR_mesh_quantization", "KHR_node_visibility"];
    const ELSEWHERE: [&str; 7] = [
        "KHR_materials_",
        "KHR_texture_",
        "KHR_lights_",
        "KHR_audio",
        "KHR_xmp",
        "KHR_node_hoverability",
        "KHR_node_selectability",
    ];
    READ.contains(&extension) || ELSEWHERE.iter().any(|start| extension.starts_with(start))
}
