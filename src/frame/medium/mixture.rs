//! Volumes that lie on one grid, such as kinds of water of a weather model, as one of several fields: what is at a point
//! is their sum, and each keeps what it is made of.

use std::{collections::HashMap, sync::Arc};

use glam::{DAffine3, DVec3, IVec3, Vec3};
use half::f16;

use super::{
    atlas::VolumeTextures,
    bricks::{Blocks, Bricks, CELLS, texels},
    volume::VolumeShape,
};
use crate::{
    frame::{CloudFrame, Shared},
    scene::{Block, Grid},
};

/// Most fields, as many as a texel has channels.
pub(crate) const MOST_FIELDS: usize = 4;

/// How far grids may be apart to be one, voxels.
const APART: f64 = 0.02;

/// The extinctions of several volumes, 1/m, by block from the first brick on.
#[derive(Debug)]
pub(crate) struct Fields(Vec<Blocks>);

impl VolumeShape {
    /// The volumes of `clouds` together, in the frame of the first one; `None` where one of them is no volume, there are
    /// too many, or they do not lie on one grid.
    pub fn mixed(clouds: &[CloudFrame]) -> Option<(Self, Fields)> {
        let shapes = clouds.iter().map(|cloud| cloud.medium.volume.as_ref()).collect::<Option<Vec<_>>>()?;
        let first = *shapes.first()?;
        let origin = clouds[0].origin;
        let offsets: Vec<DVec3> = clouds.iter().map(|cloud| cloud.origin - origin).collect();
        let known = offsets.iter().zip(&shapes).all(|(offset, shape)| shape.is_on_grid_of(first, *offset));
        if shapes.len() > MOST_FIELDS || !known {
            return None;
        }
        let fields: Vec<Blocks> = shapes.iter().map(|shape| shape.extinctions()).collect();
        let grid = Arc::new(sum(&fields)?);
        let bricks = Bricks::new(&grid).ok()?;
        let shift = ((first.bricks.base() - bricks.base()) / CELLS as i32).as_vec3();
        let mut uniform = first.uniform_of(&bricks);
        uniform.extinction = grid.most;
        uniform.mixed = 1;
        uniform.row_x.w += shift.x;
        uniform.row_y.w += shift.y;
        uniform.row_z.w += shift.z;
        let reach = shapes.iter().zip(&offsets).map(|(shape, offset)| shape.reach_at(offset.as_vec3()));
        let bounds = reach.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        let base = bricks.base() / CELLS as i32;
        let fields = fields.into_iter().map(|blocks| moved(blocks, -base)).collect();
        Some((Self::new_of(Shared::new(bricks), uniform, bounds), Fields(fields)))
    }

    /// Whether the voxels of another volume, seen at `offset` from here, m, are its own.
    fn is_on_grid_of(&self, other: &Self, offset: DVec3) -> bool {
        let (own, theirs) = (self.voxels_from_frame(), other.voxels_from_frame());
        [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].iter().all(|p| {
            let p = 100.0 * f64::from(self.uniform.voxel) * *p;
            (own.transform_point3(p - offset) - theirs.transform_point3(p)).length() < APART
        })
    }

    /// From places in its frame, m, to numbers of voxels.
    fn voxels_from_frame(&self) -> DAffine3 {
        let rows = [self.uniform.row_x, self.uniform.row_y, self.uniform.row_z].map(glam::Vec4::as_dvec4);
        let matrix = glam::DMat3::from_cols(rows[0].truncate(), rows[1].truncate(), rows[2].truncate());
        let bricks =
            DAffine3::from_mat3_translation(matrix.transpose(), DVec3::new(rows[0].w, rows[1].w, rows[2].w));
        DAffine3::from_translation(self.bricks.base().as_dvec3())
            * DAffine3::from_scale(DVec3::splat(CELLS.into()))
            * bricks
    }

    /// Its values as extinctions, 1/m, by the number of their block.
    fn extinctions(&self) -> Blocks {
        let factor = self.uniform.extinction / self.bricks.most;
        let mut blocks = self.bricks.finest();
        blocks.values_mut().flat_map(|block| block.iter_mut()).for_each(|value| *value *= factor);
        moved(blocks, self.bricks.base() / CELLS as i32)
    }

    fn reach_at(&self, offset: Vec3) -> (Vec3, Vec3) {
        let (low, high) = self.clip(Vec3::MIN, Vec3::MAX);
        (low + offset, high + offset)
    }
}

fn moved(blocks: Blocks, by: IVec3) -> Blocks {
    blocks.into_iter().map(|(at, block)| ((IVec3::from(at) + by).to_array(), block)).collect()
}

/// All fields together.
fn sum(fields: &[Blocks]) -> Option<Grid> {
    let mut sums: Blocks = HashMap::new();
    for (at, block) in fields.iter().flatten() {
        let sum = sums.entry(*at).or_insert_with(|| Box::new([0.0; 512]));
        sum.iter_mut().zip(block.iter()).for_each(|(sum, value)| *sum += value);
    }
    let blocks = sums.into_iter().map(|(at, values)| Block { index: at.into(), values });
    Grid::new("mixture".to_owned(), String::new(), DAffine3::IDENTITY, blocks.collect()).ok()
}

impl Fields {
    /// Uploads the bricks of a mixture: of the finest level all fields, of others their sum in the first channel, as
    /// shares of the greatest sum.
    pub fn upload(&self, bricks: &Bricks, device: &wgpu::Device, queue: &wgpu::Queue) -> VolumeTextures {
        let scale = 1.0 / bricks.most;
        let format = wgpu::TextureFormat::Rgba16Float;
        bricks.upload_as(device, queue, format, |level, at| {
            if level > 0 {
                return bricks
                    .halves(level, at)
                    .into_iter()
                    .flat_map(|sum| [sum, f16::ZERO, f16::ZERO, f16::ZERO])
                    .collect();
            }
            let fields: Vec<_> = self.0.iter().map(|blocks| texels(blocks, at)).collect();
            let value = |i: usize, field: usize| fields.get(field).map_or(0.0, |values| values[i]);
            let texel = |i: usize| (0..MOST_FIELDS).map(move |field| (i, field));
            (0..fields[0].len())
                .flat_map(texel)
                .map(|(i, field)| f16::from_f32(scale * value(i, field)))
                .collect()
        })
    }
}
