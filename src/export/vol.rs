//! Mitsuba's grid volumes: every voxel of a box, as floats.
//!
//! The format is version 3 of `.vol` files as the documentation of Mitsuba 3's `gridvolume` has it:
//! `VOL`, 3, the encoding 1 (floats), voxels along x, y and z, channels, the bounding box, then
//! the values, x fastest.

use std::{collections::BTreeMap, io::Write, path::Path};

use glam::{DVec3, IVec3};

use crate::{
    Error, Result,
    files::write_whole,
    render::Voxels,
    scene::{BLOCK_EDGE, Block},
};

/// Most voxels of the box: 4 GiB.
const MOST_VOXELS: i64 = 1 << 30;

/// Writes the extinction in 1/m in the box around all that is filled, with a voxel of clear air on
/// each side: `bounding box` are the outer faces of the outermost voxels, metres in the volume's axes.
///
/// # Errors
/// [`Error::Argument`] where the box has too many voxels, [`Error::File`] when the file can't be
/// written.
pub fn write_vol(path: &Path, volume: &Voxels) -> Result<()> {
    let (first, last) = volume.bounds().unwrap_or_default();
    let (first, last) = (first - 1, last + 1);
    let size = last - first + 1;
    if size.as_i64vec3().element_product() > MOST_VOXELS {
        return Err(Error::Argument(format!(
            "a .vol file holds the clear air between clouds too, here {size} voxels, more than {MOST_VOXELS}: \
             make them larger, or write a .vdb file, which holds what is filled"
        )));
    }
    write_whole(path, |file| {
        file.write_all(b"VOL\x03")?;
        let head = [1, size.x, size.y, size.z, 1];
        head.iter().try_for_each(|n| file.write_all(&n.to_le_bytes()))?;
        let corners =
            [first.as_dvec3() - 0.5, last.as_dvec3() + 0.5].map(|corner| volume.grid.voxel * corner);
        let faces = corners.iter().flat_map(DVec3::to_array);
        faces.map(|x| x as f32).try_for_each(|x| file.write_all(&x.to_le_bytes()))?;
        let layers = layers(volume);
        for z in first.z..=last.z {
            let blocks = layers.get(&z.div_euclid(BLOCK_EDGE)).map_or(&[][..], Vec::as_slice);
            file.write_all(bytemuck::cast_slice(&slice(blocks, z, first, size)))?;
        }
        Ok(())
    })
}

/// Blocks by their number along z.
fn layers(volume: &Voxels) -> BTreeMap<i32, Vec<&Block>> {
    let mut layers = BTreeMap::<_, Vec<_>>::new();
    volume.blocks.iter().for_each(|block| layers.entry(block.index.z).or_default().push(block));
    layers
}

/// The voxels of one z, x fastest.
fn slice(blocks: &[&Block], z: i32, first: IVec3, size: IVec3) -> Vec<f32> {
    let mut slice = vec![0f32; (size.x * size.y) as usize];
    for block in blocks {
        for x in 0..BLOCK_EDGE {
            for y in 0..BLOCK_EDGE {
                let value = block.values[(64 * x + 8 * y + z.rem_euclid(BLOCK_EDGE)) as usize];
                if value > 0.0 {
                    let at = BLOCK_EDGE * block.index + IVec3::new(x, y, 0) - first;
                    slice[(at.y * size.x + at.x) as usize] = value;
                }
            }
        }
    }
    slice
}
