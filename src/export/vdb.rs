//! OpenVDB, the film industry's sparse volumes: one float grid, zip compressed.
//!
//! The format is that of version 224, as OpenVDB 7 and later write it. Each array of values says by a byte
//! which of them are there: here always those of active voxels, the others being the background, 0.

use std::{
    collections::BTreeMap,
    io::{self, Write},
    path::Path,
};

use flate2::{Compression, write::ZlibEncoder};
use glam::IVec3;

use crate::{
    Result,
    files::write_whole,
    render::Voxels,
    scene::{BLOCK_VOXELS, Block},
    vdb::{ACTIVE_MASK, LOWER, Level, MAGIC, ONLY_ACTIVE, UPPER, UPPER_EDGE, ZIP},
};

const FORMAT: u32 = 224;
const LIBRARY: [u32; 2] = [10, 0];
/// Zip, and only active values are written.
const COMPRESSION: u32 = ZIP | ACTIVE_MASK;

/// Blocks of the lower nodes of upper nodes, each by its place, upper ones by their origin.
type Tree<'a> = BTreeMap<[i32; 3], BTreeMap<usize, BTreeMap<usize, &'a Block>>>;

/// Writes the float grid `density`, extinction in 1/m, as OpenVDB's fog volume. Voxel (i, j, k)
/// has its middle at `voxel * (i, j, k)` metres; voxels without density are not active.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_vdb(path: &Path, volume: &Voxels) -> Result<()> {
    write_whole(path, |file| {
        let head = head();
        let grid = descriptor();
        let offsets = head.len() + grid.len() + 24;
        let (topology, leaves) = tree(&volume.blocks)?;
        let mut body = metadata(volume);
        body.extend(transform(volume.grid.voxel));
        body.extend(topology);
        let values = offsets + body.len();
        let end = values + leaves.len();
        file.write_all(&head)?;
        file.write_all(&grid)?;
        for offset in [offsets, values, end] {
            file.write_all(&(offset as u64).to_le_bytes())?;
        }
        file.write_all(&body)?;
        file.write_all(&leaves)
    })
}

/// What the file begins with.
fn head() -> Vec<u8> {
    let mut out = MAGIC.to_le_bytes().to_vec();
    [FORMAT, LIBRARY[0], LIBRARY[1]].iter().for_each(|n| out.extend(n.to_le_bytes()));
    out.push(1); // Grids have offsets.
    // Programs tell files apart by this; what is written twice is the same file twice.
    out.extend(b"6e657068-6f73-4000-8000-636c6f756473");
    out.extend(1u32.to_le_bytes());
    entry(&mut out, "creator", "string", concat!("nephos ", env!("CARGO_PKG_VERSION")).as_bytes());
    out.extend(1u32.to_le_bytes()); // Grids.
    out
}

fn descriptor() -> Vec<u8> {
    let mut out = Vec::new();
    text(&mut out, "density");
    text(&mut out, "Tree_float_5_4_3");
    text(&mut out, ""); // Shares the tree of no other grid.
    out
}

fn text(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

/// An entry of metadata.
fn entry(out: &mut Vec<u8>, name: &str, kind: &str, value: &[u8]) {
    text(out, name);
    text(out, kind);
    out.extend((value.len() as u32).to_le_bytes());
    out.extend(value);
}

fn metadata(volume: &Voxels) -> Vec<u8> {
    let corner = |corner: IVec3| corner.to_array().map(i32::to_le_bytes).concat();
    let (first, last) = volume.bounds().unwrap_or_default();
    let count = volume.filled().count() as i64;
    let mut out = COMPRESSION.to_le_bytes().to_vec();
    let entries: [(&str, &str, &[u8]); 9] = [
        ("class", "string", b"fog volume"),
        ("file_bbox_max", "vec3i", &corner(last)),
        ("file_bbox_min", "vec3i", &corner(first)),
        ("file_compression", "string", b"zip + active values"),
        ("file_voxel_count", "int64", &count.to_le_bytes()),
        ("is_saved_as_half_float", "bool", &[0]),
        ("name", "string", b"density"),
        ("quantity", "string", b"extinction coefficient, 1/m"),
        ("value_type", "string", b"float"),
    ];
    out.extend((entries.len() as u32).to_le_bytes());
    entries.iter().for_each(|(name, kind, value)| entry(&mut out, name, kind, value));
    out
}

/// From voxels to metres: scale, edge of a voxel, and what OpenVDB derives from it.
fn transform(voxel: f64) -> Vec<u8> {
    let mut out = Vec::new();
    text(&mut out, "UniformScaleMap");
    let derived = [voxel, voxel, 1.0 / voxel, 1.0 / (voxel * voxel), 0.5 / voxel];
    derived.iter().for_each(|value| out.extend([value.to_le_bytes(); 3].concat()));
    out
}

/// Topology and values.
fn tree(blocks: &[Block]) -> io::Result<(Vec<u8>, Vec<u8>)> {
    let mut tree = Tree::new();
    for block in blocks {
        let voxel = 8 * block.index;
        let origin = voxel.to_array().map(|i| i.div_euclid(UPPER_EDGE) * UPPER_EDGE);
        let lower = tree.entry(origin).or_default().entry(UPPER.place(voxel)).or_default();
        lower.insert(LOWER.place(voxel), block);
    }
    let mut topology = 1u32.to_le_bytes().to_vec(); // Buffers.
    topology.extend(0f32.to_le_bytes()); // Background.
    topology.extend(0u32.to_le_bytes()); // Tiles.
    topology.extend((tree.len() as u32).to_le_bytes());
    let mut leaves = Vec::new();
    for (origin, upper) in &tree {
        origin.iter().for_each(|i| topology.extend(i.to_le_bytes()));
        inner(&mut topology, UPPER, upper.keys());
        for lower in upper.values() {
            inner(&mut topology, LOWER, lower.keys());
            for block in lower.values() {
                let active = active(block);
                topology.extend(&active);
                leaves.extend(&active);
                leaf(&mut leaves, block)?;
            }
        }
    }
    Ok((topology, leaves))
}

/// An inner node: which children it has; no tile of it is active.
fn inner<'a>(out: &mut Vec<u8>, level: Level, children: impl Iterator<Item = &'a usize>) {
    let mut mask = vec![0u8; level.count() / 8];
    children.for_each(|place| mask[place / 8] |= 1 << (place % 8));
    out.extend(&mask);
    out.extend(vec![0u8; mask.len()]);
    out.push(ONLY_ACTIVE);
    out.extend(0u64.to_le_bytes()); // Bytes of values.
}

/// Which voxels hold anything, a bit each.
fn active(block: &Block) -> [u8; BLOCK_VOXELS / 8] {
    let mut mask = [0; BLOCK_VOXELS / 8];
    for (i, value) in block.values.iter().enumerate() {
        mask[i / 8] |= u8::from(*value > 0.0) << (i % 8);
    }
    mask
}

fn leaf(out: &mut Vec<u8>, block: &Block) -> io::Result<()> {
    let active = block.values.iter().filter(|value| **value > 0.0);
    let bytes: Vec<u8> = active.flat_map(|value| value.to_le_bytes()).collect();
    let mut zip = ZlibEncoder::new(Vec::new(), Compression::default());
    zip.write_all(&bytes)?;
    let zipped = zip.finish()?;
    out.push(ONLY_ACTIVE);
    // What does not get smaller is left as it is, which a negative size tells.
    if zipped.len() < bytes.len() {
        out.extend((zipped.len() as i64).to_le_bytes());
        out.extend(zipped);
    } else {
        out.extend((-(bytes.len() as i64)).to_le_bytes());
        out.extend(bytes);
    }
    Ok(())
}
