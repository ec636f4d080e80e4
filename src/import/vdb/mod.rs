//! OpenVDB, the film industry's sparse volumes: float grids of versions 220 to 225, and velocities beside them.

mod codec;
mod tree;

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::{
    bytes::{Bytes, Problem},
    volume::Found,
};
use crate::scene::{BLOCK_VOXELS, Block, Grid, Velocity};
use crate::vdb::{ACTIVE_MASK, MAGIC, ZIP};
use codec::{Kind, NODE_MASKS, Number, Packing};
use tree::Tree;

/// Versions of the format that are read.
const VERSIONS: [u32; 2] = [220, 225];
/// What the type of a grid ends in where its floats are written as halves.
const AS_HALVES: &str = "_HalfFloat";
/// Between the name of a grid and its number, where others have the same.
const NUMBERED: char = '\u{1e}';
/// Most grids of a file.
const MOST_GRIDS: u32 = 1 << 16;

/// Whether bytes begin as a volume does.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC.to_le_bytes())
}

/// A grid of a file, as its list has it.
struct Descriptor {
    /// Its name; that of the grid whose tree it shares, or nothing.
    name: String,
    shares: String,
    kind: String,
    as_halves: bool,
    begin: u64,
    end: u64,
}

/// Numbers of the values of a type of grid, where those are read.
fn number(kind: &str) -> Option<Number> {
    match kind {
        "Tree_float_5_4_3" => Some(Number::of(Kind::Float)),
        "Tree_double_5_4_3" => Some(Number::of(Kind::Double)),
        "Tree_half_5_4_3" => Some(Number::of(Kind::Half)),
        _ => None,
    }
}

/// Names of grids of velocities: Houdini's, and what simulations and Blender call them.
const VELOCITIES: [&str; 3] = ["vel", "v", "velocity"];

/// How fast what is in a file goes, where a grid of vectors of one of [`VELOCITIES`]' names tells that.
///
/// # Errors
/// Where that is damaged, as the rest of a sentence.
pub(super) fn velocity(all: &[u8]) -> Result<Option<Velocity>, Problem> {
    let mut bytes = Bytes::new(all);
    let mut head = head(&mut bytes)?;
    // Without places of grids nobody knows where the next one is.
    for _ in 0..if head.has_offsets { count(&mut bytes)? } else { 0 } {
        let grid = descriptor(&mut bytes)?;
        let kind = match grid.kind.as_str() {
            "Tree_vec3s_5_4_3" => Some(Kind::Float),
            "Tree_vec3d_5_4_3" => Some(Kind::Double),
            _ => None,
        };
        if let Some(kind) =
            kind.filter(|_| VELOCITIES.contains(&grid.name.as_str()) && grid.shares.is_empty())
        {
            bytes.seek(grid.begin)?;
            return vectors(&mut head, &grid, kind, bytes).map(Some);
        }
        bytes.seek(grid.end)?;
    }
    Ok(None)
}

/// A grid of vectors: their numbers one after the other.
fn vectors(head: &mut Head, grid: &Descriptor, kind: Kind, bytes: Bytes<'_>) -> Result<Velocity, Problem> {
    let mut velocity = Velocity { place: DAffine3::IDENTITY, blocks: HashMap::new() };
    for lane in 0..3 {
        let mut bytes = bytes;
        let number = Number { kind, lanes: 3, lane };
        let (_, place, blocks) = tree(head, grid, number, &mut bytes)?;
        velocity.place = place;
        for block in blocks {
            let vectors = velocity
                .blocks
                .entry(block.index.to_array())
                .or_insert_with(|| Box::new([Vec3::ZERO; BLOCK_VOXELS]));
            vectors.iter_mut().zip(block.values.iter()).for_each(|(vector, value)| vector[lane] = *value);
        }
    }
    let known = |vectors: &[Vec3; BLOCK_VOXELS]| vectors.iter().all(|vector| vector.is_finite());
    if !velocity.place.inverse().is_finite() || !velocity.blocks.values().all(|vectors| known(vectors)) {
        return Err(format!(
            "has velocities in `{}` that are no numbers, or that lie nowhere: export it without them",
            grid.name
        ));
    }
    Ok(velocity)
}

/// What is in a file: each of its grids, read where it can be.
///
/// # Errors
/// Where it is no such file, as the rest of a sentence.
pub(super) fn read(all: &[u8], wanted: Option<&str>) -> Result<Vec<Found>, Problem> {
    let mut bytes = Bytes::new(all);
    let mut head = head(&mut bytes)?;
    let mut found = Vec::new();
    for _ in 0..count(&mut bytes)? {
        let grid = descriptor(&mut bytes)?;
        if head.has_offsets {
            bytes.seek(grid.begin)?;
        }
        let is_wanted = wanted.is_none_or(|wanted| wanted == grid.name);
        if is_wanted || !head.has_offsets {
            let read = match (grid.shares.is_empty(), number(&grid.kind)) {
                (true, Some(number)) => read_grid(&mut head, &grid, number, &mut bytes),
                (false, _) => {
                    Err(format!("has `{}` as a copy of `{}`: choose that one", grid.name, grid.shares))
                }
                (true, None) => Err(format!(
                    "has `{}` as a {}, and what is read are Tree_float_5_4_3, _double_ and _half_: choose another grid, or \
                     convert it",
                    grid.name, grid.kind
                )),
            };
            if let (Err(problem), false) = (&read, head.has_offsets) {
                return Err(problem.clone());
            }
            found.push(Found { name: grid.name, kind: grid.kind, grid: read });
        } else {
            found.push(Found { name: grid.name, kind: grid.kind, grid: Err("was not asked for".to_owned()) });
        }
        if head.has_offsets {
            bytes.seek(grid.end)?;
        }
    }
    Ok(found)
}

/// What a file begins with.
struct Head {
    version: u32,
    compression: u32,
    has_offsets: bool,
}

fn head(bytes: &mut Bytes<'_>) -> Result<Head, Problem> {
    if bytes.u64()? != MAGIC {
        return Err("is no OpenVDB file: it does not begin as one".to_owned());
    }
    let version = bytes.u32()?;
    let [oldest, newest] = VERSIONS;
    if !(oldest..=newest).contains(&version) {
        return Err(format!(
            "has version {version} of OpenVDB's format, and versions {oldest} to {newest} are read: save it by a program \
             of today"
        ));
    }
    bytes.take(8)?; // The library's version.
    let has_offsets = bytes.byte()? != 0;
    let mut compression = ZIP | ACTIVE_MASK;
    if version < NODE_MASKS {
        compression = if bytes.byte()? != 0 { ZIP } else { 0 };
    }
    bytes.take(36)?; // An identifier.
    metadata(bytes)?;
    Ok(Head { version, compression, has_offsets })
}

/// How many grids there are.
fn count(bytes: &mut Bytes<'_>) -> Result<u32, Problem> {
    let count = bytes.u32()?;
    if count > MOST_GRIDS {
        return Err(format!("would have {count} grids: it is damaged; export it again"));
    }
    Ok(count)
}

fn descriptor(bytes: &mut Bytes<'_>) -> Result<Descriptor, Problem> {
    let (name, kind, shares) = (bytes.text()?, bytes.text()?, bytes.text()?);
    let (kind, as_halves) = match kind.strip_suffix(AS_HALVES) {
        Some(kind) => (kind.to_owned(), true),
        None => (kind, false),
    };
    let name = name.split(NUMBERED).next().unwrap_or_default().to_owned();
    let (begin, _, end) = (bytes.u64()?, bytes.u64()?, bytes.u64()?);
    Ok(Descriptor { name, shares, kind, as_halves, begin, end })
}

/// Texts of metadata, by name.
fn metadata(bytes: &mut Bytes<'_>) -> Result<HashMap<String, String>, Problem> {
    let mut found = HashMap::new();
    for _ in 0..bytes.u32()? {
        let (name, kind, length) = (bytes.text()?, bytes.text()?, bytes.u32()?);
        let value = bytes.take(length as usize)?;
        if kind == "string" {
            found.insert(name, String::from_utf8_lossy(value).into_owned());
        }
    }
    Ok(found)
}

fn read_grid(
    head: &mut Head,
    grid: &Descriptor,
    number: Number,
    bytes: &mut Bytes<'_>,
) -> Result<Grid, Problem> {
    let (quantity, place, blocks) = tree(head, grid, number, bytes)?;
    Grid::new(grid.name.clone(), quantity, place, blocks)
}

/// What a grid says of its values' unit, where it lies, and one number of each of its values.
fn tree(
    head: &mut Head,
    grid: &Descriptor,
    number: Number,
    bytes: &mut Bytes<'_>,
) -> Result<(String, DAffine3, Vec<Block>), Problem> {
    if head.version >= NODE_MASKS {
        head.compression = bytes.u32()?;
    }
    let told = metadata(bytes)?;
    let told = |key: &str| told.get(key).map_or("", String::as_str);
    if told("class") == "level set" {
        return Err(format!(
            "has in `{}` distances to a surface (a level set), no density: convert it to a fog volume (in Houdini: Convert \
             VDB), or choose another grid",
            grid.name
        ));
    }
    let place = transform(bytes)?;
    let packing = Packing {
        version: head.version,
        compression: head.compression,
        number,
        packed: if grid.as_halves { Number { kind: Kind::Half, ..number } } else { number },
        background: 0.0,
    };
    let (blocks, rest) = Tree::read(*bytes, packing)?;
    *bytes = rest;
    Ok((told("quantity").to_owned(), place, blocks))
}

/// From numbers of voxels to the file's lengths.
fn transform(bytes: &mut Bytes<'_>) -> Result<DAffine3, Problem> {
    let kind = bytes.text()?;
    let mut vector = || Ok::<_, Problem>(DVec3::new(bytes.f64()?, bytes.f64()?, bytes.f64()?));
    // Behind its scale come the edges of a voxel, and numbers that follow from it.
    const FOLLOWING: usize = 4;
    match kind.as_str() {
        "UniformScaleMap" | "ScaleMap" => {
            let scale = vector()?;
            (0..FOLLOWING).try_for_each(|_| vector().map(drop))?;
            Ok(DAffine3::from_scale(scale))
        }
        "TranslationMap" => Ok(DAffine3::from_translation(vector()?)),
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let (translation, scale) = (vector()?, vector()?);
            (0..FOLLOWING).try_for_each(|_| vector().map(drop))?;
            Ok(DAffine3::from_mat3_translation(DMat3::from_diagonal(scale), translation))
        }
        "AffineMap" | "UnitaryMap" => {
            let mut rows = [[0.0; 4]; 4];
            for value in rows.as_flattened_mut() {
                *value = bytes.f64()?;
            }
            // Points are rows: theirs are our columns.
            let [x, y, z, translation] = rows.map(|[x, y, z, _]| DVec3::new(x, y, z));
            Ok(DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation })
        }
        _ => Err(format!("lies in its space by a {kind}, which is not read: resample it to even voxels")),
    }
}
