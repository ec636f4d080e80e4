//! OpenVDB, the film industry's sparse volumes: a float grid and, if wanted, one of velocities, zip compressed.
//!
//! The format is that of version 224, as OpenVDB 7 and later write it. Each array of values says by a byte
//! which of them are there: here always those of active voxels, the others being the background, 0.

use std::{
    collections::BTreeMap,
    io::{self, Write},
    path::Path,
};

use flate2::{Compression, write::ZlibEncoder};
use glam::{DVec3, IVec3, Vec3};
use half::f16;
use rayon::prelude::*;

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

/// Numbers of the blocks of the lower nodes of upper nodes, each by its place, upper ones by their origin.
type Tree = BTreeMap<[i32; 3], BTreeMap<usize, BTreeMap<usize, usize>>>;

/// How a volume is written.
#[derive(Clone, Copy, Default)]
pub struct VdbOptions<'a> {
    /// Whether numbers are kept as half floats, good to 1 in 2000, in half the bytes.
    pub half: bool,
    /// How fast matter goes at a point of the world, m/s by m: the grid `vel`.
    pub velocity: Option<&'a (dyn Fn(DVec3) -> DVec3 + Sync)>,
}

/// Writes the float grid `density`, extinction in 1/m, as OpenVDB's fog volume. Voxel (i, j, k)
/// has its middle at `voxel * (i, j, k)` metres; voxels without density are not active.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_vdb(path: &Path, volume: &Voxels) -> Result<()> {
    write_vdb_with(path, volume, VdbOptions::default())
}

/// The same in another precision, or with the grid `vel` beside it: vectors in the axes of the volume, m/s, in voxels
/// that hold density.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_vdb_with(path: &Path, volume: &Voxels, options: VdbOptions<'_>) -> Result<()> {
    let half = options.half;
    let mut grids = vec![Grid::new(volume, &DENSITY, half, |block| density(block, half))];
    if let Some(velocity) = options.velocity {
        let volume_from_world = volume.grid.world_from_volume.transpose();
        let at = |voxel: IVec3| {
            let p = volume.grid.world_from_volume * (volume.grid.voxel * voxel.as_dvec3());
            (volume_from_world * velocity(p)).as_vec3()
        };
        grids.push(Grid::new(volume, &VELOCITY, half, |block| velocities(block, half, &at)));
    }
    write_whole(path, |file| {
        let mut at = file_head(grids.len()).len();
        file.write_all(&file_head(grids.len()))?;
        for grid in grids {
            let (body, leaves) = grid?;
            let (begin, values) = (at + body.descriptor.len() + 24, body.bytes.len());
            at = begin + values + leaves.len();
            file.write_all(&body.descriptor)?;
            for offset in [begin, begin + values, at] {
                file.write_all(&(offset as u64).to_le_bytes())?;
            }
            file.write_all(&body.bytes)?;
            file.write_all(&leaves)?;
        }
        Ok(())
    })
}

/// What a grid is.
struct About {
    name: &'static str,
    /// The type of its tree and of its values.
    kinds: [&'static str; 2],
    /// What it is taken for, and how vectors turn.
    class: &'static [(&'static str, &'static str)],
    quantity: &'static str,
    /// Floats of a value.
    numbers: usize,
}

const DENSITY: About = About {
    name: "density",
    kinds: ["Tree_float_5_4_3", "float"],
    class: &[("class", "fog volume")],
    quantity: "extinction coefficient, 1/m",
    numbers: 1,
};
const VELOCITY: About = About {
    name: "vel",
    kinds: ["Tree_vec3s_5_4_3", "vec3s"],
    class: &[("class", "unknown"), ("vector_type", "contravariant relative")],
    quantity: "velocity, m/s",
    numbers: 3,
};

/// A grid in the file, but for the values of its leaves.
struct Grid {
    descriptor: Vec<u8>,
    bytes: Vec<u8>,
}

impl Grid {
    /// It and the values of its leaves; `values` are those of the active voxels of a block.
    fn new(
        volume: &Voxels,
        about: &About,
        half: bool,
        values: impl Fn(&Block) -> Vec<u8> + Sync,
    ) -> io::Result<(Self, Vec<u8>)> {
        let zipped: Vec<Vec<u8>> =
            volume.blocks.par_iter().map(|block| leaf(&values(block))).collect::<io::Result<_>>()?;
        let (topology, leaves) = tree(&volume.blocks, &zipped, about.numbers, half);
        let mut bytes = metadata(volume, about, half);
        bytes.extend(transform(volume.grid.voxel));
        bytes.extend(topology);
        Ok((Self { descriptor: descriptor(about, half), bytes }, leaves))
    }
}

/// The extinctions of the active voxels of a block.
fn density(block: &Block, half: bool) -> Vec<u8> {
    block.values.iter().filter(|value| **value > 0.0).flat_map(|&value| number(value, half)).collect()
}

/// What `at` says of them.
fn velocities(block: &Block, half: bool, at: &impl Fn(IVec3) -> Vec3) -> Vec<u8> {
    let vectors = block.filled().map(|(voxel, _)| at(voxel).to_array());
    vectors.flatten().flat_map(|value| number(value, half)).collect()
}

/// A number as the file has it.
fn number(value: f32, half: bool) -> Vec<u8> {
    let most = f16::MAX.to_f32();
    if half {
        f16::from_f32(value.clamp(-most, most)).to_le_bytes().to_vec()
    } else {
        value.to_le_bytes().to_vec()
    }
}

/// What the file begins with.
fn file_head(grids: usize) -> Vec<u8> {
    let mut out = MAGIC.to_le_bytes().to_vec();
    [FORMAT, LIBRARY[0], LIBRARY[1]].iter().for_each(|n| out.extend(n.to_le_bytes()));
    out.push(1); // Grids have offsets.
    // Programs tell files apart by this; what is written twice is the same file twice.
    out.extend(b"6e657068-6f73-4000-8000-636c6f756473");
    out.extend(1u32.to_le_bytes());
    entry(&mut out, "creator", "string", concat!("nephos ", env!("CARGO_PKG_VERSION")).as_bytes());
    out.extend((grids as u32).to_le_bytes());
    out
}

fn descriptor(about: &About, half: bool) -> Vec<u8> {
    let mut out = Vec::new();
    text(&mut out, about.name);
    text(&mut out, &format!("{}{}", about.kinds[0], if half { "_HalfFloat" } else { "" }));
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

fn metadata(volume: &Voxels, about: &About, half: bool) -> Vec<u8> {
    let corner = |corner: IVec3| corner.to_array().map(i32::to_le_bytes).concat();
    let (first, last) = volume.bounds().unwrap_or_default();
    let count = volume.filled().count() as i64;
    let mut out = COMPRESSION.to_le_bytes().to_vec();
    let own: [(&str, &str, &[u8]); 8] = [
        ("file_bbox_max", "vec3i", &corner(last)),
        ("file_bbox_min", "vec3i", &corner(first)),
        ("file_compression", "string", b"zip + active values"),
        ("file_voxel_count", "int64", &count.to_le_bytes()),
        ("is_saved_as_half_float", "bool", &[u8::from(half)]),
        ("name", "string", about.name.as_bytes()),
        ("quantity", "string", about.quantity.as_bytes()),
        ("value_type", "string", about.kinds[1].as_bytes()),
    ];
    out.extend(((about.class.len() + own.len()) as u32).to_le_bytes());
    about.class.iter().for_each(|(name, value)| entry(&mut out, name, "string", value.as_bytes()));
    own.iter().for_each(|(name, kind, value)| entry(&mut out, name, kind, value));
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

/// Topology and values of blocks, whose own values are `zipped`: each is of so many floats.
fn tree(blocks: &[Block], zipped: &[Vec<u8>], numbers: usize, half: bool) -> (Vec<u8>, Vec<u8>) {
    let mut tree = Tree::new();
    for (number, block) in blocks.iter().enumerate() {
        let voxel = 8 * block.index;
        let origin = voxel.to_array().map(|i| i.div_euclid(UPPER_EDGE) * UPPER_EDGE);
        let lower = tree.entry(origin).or_default().entry(UPPER.place(voxel)).or_default();
        lower.insert(LOWER.place(voxel), number);
    }
    let mut topology = 1u32.to_le_bytes().to_vec(); // Buffers.
    topology.extend(vec![0; 4 * numbers]); // Background.
    topology.extend(0u32.to_le_bytes()); // Tiles.
    topology.extend((tree.len() as u32).to_le_bytes());
    let mut leaves = Vec::new();
    for (origin, upper) in &tree {
        origin.iter().for_each(|i| topology.extend(i.to_le_bytes()));
        inner(&mut topology, UPPER, half, upper.keys());
        for lower in upper.values() {
            inner(&mut topology, LOWER, half, lower.keys());
            for &number in lower.values() {
                let active = active(&blocks[number]);
                topology.extend(&active);
                leaves.extend(&active);
                leaves.extend(&zipped[number]);
            }
        }
    }
    (topology, leaves)
}

/// An inner node: which children it has; no tile of it is active.
fn inner<'a>(out: &mut Vec<u8>, level: Level, half: bool, children: impl Iterator<Item = &'a usize>) {
    let mut mask = vec![0u8; level.count() / 8];
    children.for_each(|place| mask[place / 8] |= 1 << (place % 8));
    out.extend(&mask);
    out.extend(vec![0u8; mask.len()]);
    out.push(ONLY_ACTIVE);
    if !half {
        // Bytes of values, which no halves at all do not tell.
        out.extend(0u64.to_le_bytes());
    }
}

/// Which voxels hold anything, a bit each.
fn active(block: &Block) -> [u8; BLOCK_VOXELS / 8] {
    let mut mask = [0; BLOCK_VOXELS / 8];
    for (i, value) in block.values.iter().enumerate() {
        mask[i / 8] |= u8::from(*value > 0.0) << (i % 8);
    }
    mask
}

/// The values of a leaf.
fn leaf(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut zip = ZlibEncoder::new(Vec::new(), Compression::default());
    zip.write_all(bytes)?;
    let zipped = zip.finish()?;
    let mut out = vec![ONLY_ACTIVE];
    // What does not get smaller is left as it is, which a negative size tells.
    if zipped.len() < bytes.len() {
        out.extend((zipped.len() as i64).to_le_bytes());
        out.extend(zipped);
    } else {
        out.extend((-(bytes.len() as i64)).to_le_bytes());
        out.extend(bytes);
    }
    Ok(out)
}
