//! A grid over a scene that tells, for each cell, which ellipsoids reach into it and the
//! largest extinction there: empty air costs a step a cell, and a collision asks only the
//! ellipsoids at hand.

use glam::{IVec3, UVec3, Vec3};

use crate::frame::medium::{EllipsoidUniform, LayerShape, MeshShape, Part, VolumeShape, World};

/// `Grid` of `shaders/path.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GridUniform {
    pub(crate) low: Vec3,
    pub(crate) cell: f32,
    pub(crate) size: UVec3,
    pub(crate) first: u32,
    pub(crate) repeats: u32,
    pub(crate) more: u32,
    padding: [u32; 2],
}

/// `Cell` of `shaders/path.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Cell {
    pub(super) first: u32,
    pub(super) count: u32,
    pub(super) majorant: f32,
    pub(super) clear: u32,
}

/// Grids that there is room for.
pub const MOST_GRIDS: usize = 5;
/// Most cells along an axis, and one more for rounding.
const LONGEST: u32 = 256;

/// Squares along a period of a layer: powers of two, about a quarter of its height, as far as there is room.
fn layer_squares(half: Vec3) -> u32 {
    let wanted = (4.0 * half.x / half.y).clamp(1.0, LONGEST as f32) as u32;
    wanted.next_power_of_two().min(LONGEST)
}

/// The cells of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Least corner, m.
    pub low: Vec3,
    /// Edge of a cell, m.
    pub cell: f32,
    /// Cells along each axis.
    pub size: UVec3,
    /// Cells, x fastest.
    pub cells: Vec<Cell>,
    /// Lists of ellipsoids that the cells point into.
    pub candidates: Vec<u32>,
    /// Whether it repeats itself along x and z.
    pub repeats: bool,
}

/// Grids in one list of cells.
pub fn together(grids: &[Grid]) -> ([GridUniform; MOST_GRIDS], Vec<Cell>) {
    let mut uniforms = [bytemuck::Zeroable::zeroed(); MOST_GRIDS];
    let mut cells = Vec::new();
    for (i, (to, grid)) in uniforms.iter_mut().zip(grids).enumerate() {
        *to = GridUniform {
            low: grid.low,
            cell: grid.cell,
            size: grid.size,
            first: cells.len() as u32,
            repeats: u32::from(grid.repeats),
            more: (grids.len() - 1 - i) as u32,
            padding: [0; 2],
        };
        cells.extend(&grid.cells);
    }
    (uniforms, cells)
}

impl Grid {
    /// The grids of what a world has: one of all that ends, then one of each layer.
    pub fn of(world: &World, cells: u32) -> Vec<Self> {
        let ends =
            world.ellipsoids.len() + world.volumes.len() + world.meshes.len() > 0 || world.layers.is_empty();
        let first = ends.then(|| Self::new(world, cells));
        first.into_iter().chain(world.layers.iter().map(|layer| Self::of_layer(layer, world))).collect()
    }

    /// A grid of about `cells` cubes around the ellipsoids, meshes and volumes: as fine in a flat layer as in a heap,
    /// but for at most [`LONGEST`] along an axis; one empty cell where there are none.
    fn new(world: &World, cells: u32) -> Self {
        let volumes = world.volumes.iter().map(|part| (part.origin, part.shape.bounds()));
        let meshes = world.meshes.iter().map(|part| (part.origin, part.shape.bounds()));
        let boxes = volumes.chain(meshes).map(|(origin, (low, high))| (low + origin, high + origin));
        let lumps = (!world.ellipsoids.is_empty()).then(|| EllipsoidUniform::bounds(&world.ellipsoids));
        let all = lumps.into_iter().chain(boxes).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let (low, high) = all.unwrap_or_default();
        let extent = high - low;
        let even = (extent.x * extent.y * extent.z / cells as f32).cbrt();
        let cell = even.max(extent.max_element() / LONGEST as f32).max(1e-6);
        let size = (extent / cell).ceil().as_uvec3().clamp(UVec3::ONE, UVec3::splat(LONGEST + 1));
        let mut grid = Self { low, cell, size, cells: Vec::new(), candidates: Vec::new(), repeats: false };
        for z in 0..size.z {
            for y in 0..size.y {
                for x in 0..size.x {
                    grid.push(world, UVec3::new(x, y, z));
                }
            }
        }
        grid.clear();
        grid
    }

    /// A grid over a period of a layer, which repeats along x and z as the layer does: as many cells as squares of the
    /// field whose greatest values are known.
    fn of_layer(Part { shape: layer, origin, body }: &Part<LayerShape>, world: &World) -> Self {
        let body = &world.bodies[*body as usize];
        let half = layer.half().as_vec3();
        let squares = layer_squares(half);
        let cell = 2.0 * half.x / squares as f32;
        let high = ((2.0 * half.y / cell).ceil() as u32).max(1);
        let size = UVec3::new(squares, high, squares);
        let mut cells = Vec::new();
        for z in 0..size.z {
            for y in 0..size.y {
                let (low, high) = (-half.y + y as f32 * cell, -half.y + (y + 1) as f32 * cell);
                let most = layer.uniform.extinction * body.most_profile(high);
                for x in 0..size.x {
                    let square = [x, z].map(|i| f64::from(i) - 0.5 * f64::from(squares));
                    let there = layer.reaches(square, f64::from(squares), [low, high]);
                    let majorant = if there { most } else { 0.0 };
                    cells.push(Cell { first: 0, count: 0, majorant, clear: 0 });
                }
            }
        }
        Self { low: origin - half, cell, size, cells, candidates: Vec::new(), repeats: true }
    }

    fn push(&mut self, world: &World, index: UVec3) {
        let World { ellipsoids, bodies, .. } = world;
        let middle = self.low + (index.as_vec3() + 0.5) * self.cell;
        // Half the diagonal, and the little that a step goes beyond its cell.
        let radius = 0.8662 * self.cell;
        let near = (0..ellipsoids.len() as u32).filter(|&i| ellipsoids[i as usize].reaches(middle, radius));
        let first = self.candidates.len();
        self.candidates.extend(near);
        let list = &self.candidates[first..];
        let top = middle.y + radius;
        let most = |&i: &u32| {
            let e = &ellipsoids[i as usize];
            e.extinction * bodies[e.body as usize].most_profile(top)
        };
        let lumps = list.iter().map(most).fold(0.0, f32::max);
        let mesh = |part: &Part<MeshShape>| {
            let body = &bodies[part.body as usize];
            part.shape.most_within(middle - part.origin, radius) * body.most_profile(top - part.origin.y)
        };
        let volume = |part: &Part<VolumeShape>| part.shape.most_within(middle - part.origin, radius);
        let held = world.volumes.iter().map(volume).chain(world.meshes.iter().map(mesh));
        let majorant = held.fold(lumps, f32::max);
        let count = if majorant > 0.0 { list.len() as u32 } else { 0 };
        self.cells.push(Cell { first: first as u32, count, majorant, clear: 0 });
    }

    /// Tells each empty cell how many cells around it are empty, too, in the chessboard's metric; beyond the
    /// grid there is nothing.
    fn clear(&mut self) {
        const FAR: u32 = 1 << 12;
        for cell in &mut self.cells {
            cell.clear = if cell.majorant > 0.0 { 0 } else { FAR };
        }
        let size = self.size.as_ivec3();
        let at = |p: IVec3| ((p.z * size.y + p.y) * size.x + p.x) as usize;
        // Forth and back: half of the neighbours each time.
        for sign in [-1, 1] {
            for i in 0..self.cells.len() {
                let i = if sign < 0 { i } else { self.cells.len() - 1 - i } as i32;
                let p = IVec3::new(i % size.x, i / size.x % size.y, i / (size.x * size.y));
                let before = |d: &IVec3| (d.z, d.y, d.x).cmp(&(0, 0, 0)) == (0.cmp(&-sign));
                let near = (0..27).map(|k| IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)).filter(before);
                let inside = |q: &IVec3| q.cmpge(IVec3::ZERO).all() && q.cmplt(size).all();
                let least = near.map(|d| p + d).filter(inside).map(|q| self.cells[at(q)].clear).min();
                let own = self.cells[at(p)].clear;
                self.cells[at(p)].clear = own.min(least.map_or(FAR, |least| least + 1));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::medium::{BodyUniform, NoiseFrame, Species};
    use crate::scene::{Cloud, Ellipsoid, Noise};
    use glam::{DQuat, DVec3};

    fn world(ellipsoids: Vec<EllipsoidUniform>, bodies: Vec<BodyUniform>) -> World {
        World {
            origin: DVec3::ZERO,
            ellipsoids,
            holders: Vec::new(),
            species: Vec::new(),
            bodies,
            layers: Vec::new(),
            meshes: Vec::new(),
            volumes: Vec::new(),
            fields: None,
        }
    }

    #[test]
    fn every_point_of_an_ellipsoid_is_in_a_cell_that_lists_it() {
        let cloud = Cloud::default();
        let turned = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8);
        let ellipsoids: Vec<_> = [[0.0, 0.0, 0.0], [150.0, 30.0, -40.0]]
            .map(|center| {
                let e = Ellipsoid {
                    orientation: turned,
                    ..Ellipsoid::new(center.into(), DVec3::new(90.0, 3.0, 40.0))
                };
                EllipsoidUniform::new(&cloud, &e, DVec3::ZERO, 10.0)
            })
            .to_vec();
        let bounds = (DVec3::splat(-100.0), DVec3::splat(100.0));
        let noise = NoiseFrame::new(&Noise::default(), 100.0, DVec3::ZERO);
        let species = Species::of(&cloud.droplets).unwrap().uniform();
        let body = BodyUniform::new(&cloud, bounds, 0.0, noise, species, true);
        let grid = &Grid::of(&world(ellipsoids.clone(), vec![body]), 4000)[0];
        for i in 0..2000u32 {
            // A spiral through each ellipsoid's inside.
            let t = (f64::from(i) + 0.5) / 2000.0;
            let (z, a) = (1.0 - 2.0 * t, 2.399963 * f64::from(i));
            let u = 0.999 * DVec3::new((1.0 - z * z).sqrt() * a.cos(), (1.0 - z * z).sqrt() * a.sin(), z);
            for (which, e) in ellipsoids.iter().enumerate() {
                let p = e.center + (turned * (u * DVec3::new(90.0, 3.0, 40.0))).as_vec3();
                let index = ((p - grid.low) / grid.cell).floor().as_uvec3();
                let cell = grid.cells[((index.z * grid.size.y + index.y) * grid.size.x + index.x) as usize];
                let list = &grid.candidates[cell.first as usize..][..cell.count as usize];
                assert!(list.contains(&(which as u32)), "{p} of {which}");
                assert_eq!(cell.majorant, e.extinction);
            }
        }
    }

    #[test]
    fn a_scene_without_ellipsoids_has_one_empty_cell() {
        let grid = &Grid::of(&world(Vec::new(), Vec::new()), 4000)[0];
        assert!(grid.cells.iter().all(|cell| cell.count == 0 && cell.majorant == 0.0));
    }
}
