//! Where clouds pass through one another in the picture, so that none of them is before the other: their tiles there are
//! drawn past the visibility of all others (`shaders/march/crossings.wgsl`). Elsewhere far clouds are drawn first.

use std::collections::{HashMap, HashSet};

use glam::{DVec3, Vec3};

use super::tiles::{Cover, Tile};
use crate::{
    frame::{CloudFrame, Frame, medium::EllipsoidUniform},
    gpu::Made,
};

/// Pixels along the edge of a cell of the picture: `CROSSING_CELL` of the shader.
pub(crate) const CELL: u32 = 16;
/// Bytes of what is kept of a cloud in a cell: twelve half floats a pixel.
const BLOCK_BYTES: u64 = 24 * (CELL * CELL) as u64;
/// Most bytes that are kept: what is beyond is drawn far clouds first.
const MOST_BYTES: u64 = 400 << 20;

/// The crossings in a picture.
#[derive(Debug, Default)]
pub(in crate::render) struct Crossings {
    clouds: HashMap<usize, Crossed>,
    blocks: u32,
}

/// The tiles of a cloud that crosses others.
#[derive(Debug)]
pub(in crate::render) struct Crossed {
    /// Those where it is alone come first.
    pub cover: Cover,
    pub alone: u32,
}

/// Which clouds touch which.
#[derive(Debug, Default)]
pub(in crate::render) struct Touching {
    /// Of each those with greater numbers.
    after: Vec<Vec<u32>>,
    any: Vec<bool>,
}

impl Touching {
    /// Those of `clouds` whose lumps reach into one another.
    pub fn find(clouds: &[CloudFrame]) -> Self {
        let boxes: Vec<_> = clouds.iter().map(bounds).collect();
        let mut order: Vec<usize> = (0..clouds.len()).collect();
        order.sort_by(|&a, &b| boxes[a].0.x.total_cmp(&boxes[b].0.x));
        let mut found = Self { after: vec![Vec::new(); clouds.len()], any: vec![false; clouds.len()] };
        for (place, &a) in order.iter().enumerate() {
            let near = order[place + 1..].iter().take_while(|&&b| boxes[b].0.x < boxes[a].1.x);
            for &b in near {
                let meet = boxes[a].0.cmplt(boxes[b].1).all() && boxes[b].0.cmplt(boxes[a].1).all();
                if meet && touch(&clouds[a], &clouds[b]) {
                    found.after[a.min(b)].push(a.max(b) as u32);
                    (found.any[a], found.any[b]) = (true, true);
                }
            }
        }
        found
    }

    /// Whether a cloud touches any other.
    pub fn any(&self, cloud: usize) -> bool {
        self.any[cloud]
    }

    fn are(&self, a: usize, b: usize) -> bool {
        self.after[a.min(b)].contains(&(a.max(b) as u32))
    }
}

/// Whether two clouds whose boxes meet have lumps that reach into one another.
fn touch(a: &CloudFrame, b: &CloudFrame) -> bool {
    if a.medium.layer.is_some() || b.medium.layer.is_some() {
        return true;
    }
    let offset = (b.origin - a.origin).as_vec3();
    let (half_a, half_b) = (a.half.as_vec3(), b.half.as_vec3());
    // Those of each in the box of the other, in the frame of the first.
    let near = |e: &&EllipsoidUniform, shift: Vec3, middle: Vec3, half: Vec3| {
        ((e.center + shift - middle).abs() - half).max_element() < e.largest_radius()
    };
    let of_a: Vec<_> = a.medium.ellipsoids.iter().filter(|e| near(e, Vec3::ZERO, offset, half_b)).collect();
    let of_b: Vec<_> = b.medium.ellipsoids.iter().filter(|e| near(e, offset, Vec3::ZERO, half_a)).collect();
    of_a.iter().any(|one| of_b.iter().any(|other| reach(one, other, other.center + offset - one.center)))
}

/// Whether two ellipsoids reach into one another along the line between their middles.
fn reach(one: &EllipsoidUniform, other: &EllipsoidUniform, between: Vec3) -> bool {
    let distance = between.length();
    if distance > one.largest_radius() + other.largest_radius() {
        return false;
    }
    let way = between.normalize_or(Vec3::Y);
    distance < one.support(way) + other.support(way)
}

/// Corners of a cloud's box; a layer has no end.
fn bounds(cloud: &CloudFrame) -> (DVec3, DVec3) {
    let ends = |v: DVec3, far: f64| if cloud.medium.layer.is_some() { DVec3::new(far, v.y, far) } else { v };
    (ends(cloud.origin - cloud.half, f64::NEG_INFINITY), ends(cloud.origin + cloud.half, f64::INFINITY))
}

/// What a cloud has in a cell of the picture.
struct Span {
    cloud: usize,
    /// Nearest and farthest distance of what its rays may meet there, m.
    near: f32,
    far: f32,
    /// Its tiles there, and what of the picture they take up.
    tiles: Vec<usize>,
    area: [u32; 4],
    /// The first in the cell of those that it crosses, itself where it crosses none before it.
    first: usize,
}

/// A picture in cells.
struct Cells {
    wide: u32,
    spans: Vec<Vec<Span>>,
}

impl Crossings {
    /// Those of clouds in this order of drawing, far ones first, of whose tiles distances are known.
    pub fn find(
        device: &wgpu::Device,
        frame: &Frame,
        touching: &Touching,
        order: &[usize],
        covers: &[Cover],
    ) -> Self {
        let mut found = Self::default();
        let order: Vec<_> = order.iter().copied().filter(|&cloud| !covers[cloud].depths.is_empty()).collect();
        if order.len() < 2 {
            return found;
        }
        let most = Self::most(device);
        let mut crossed: HashMap<usize, HashSet<u32>> = HashMap::new();
        let mut cells = Cells::new(frame, &order, covers);
        for (cell, spans) in cells.spans.iter_mut().enumerate() {
            join(spans, touching);
            for first in 0..spans.len() {
                let members: Vec<_> = spans.iter().filter(|span| span.first == first).collect();
                if members.len() < 2 {
                    continue;
                }
                if found.blocks + members.len() as u32 > most {
                    tracing::warn!(
                        "more clouds cross than there is room for: some are drawn one over the other"
                    );
                    found.add_alone(covers, &crossed, cells.wide);
                    return found;
                }
                found.add(&members, covers);
                for span in members {
                    crossed.entry(span.cloud).or_default().insert(cell as u32);
                }
            }
        }
        found.add_alone(covers, &crossed, cells.wide);
        found
    }

    /// The tiles of a cloud, where it crosses any other.
    pub fn of(&self, cloud: usize) -> Option<&Crossed> {
        self.clouds.get(&cloud)
    }

    pub fn is_empty(&self) -> bool {
        self.blocks == 0
    }

    /// Most blocks that a device holds.
    fn most(device: &wgpu::Device) -> u32 {
        let limits = device.limits();
        let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        (bytes.min(MOST_BYTES) / BLOCK_BYTES) as u32
    }

    /// Adds the tiles of `members` in a cell where they cross.
    fn add(&mut self, members: &[&Span], covers: &[Cover]) {
        let blocks = self.blocks..self.blocks + members.len() as u32;
        self.blocks = blocks.end;
        let all = members.iter().map(|span| span.area).reduce(around).unwrap_or_default();
        for (span, block) in members.iter().zip(blocks.clone()) {
            let own =
                &mut self.clouds.entry(span.cloud).or_insert_with(|| Crossed::of(&covers[span.cloud])).cover;
            // The farthest puts the opacity of all over what is behind, wherever any of them is.
            let leads = block == blocks.start;
            let area = if leads { all } else { span.area };
            let near = candidates(&covers[span.cloud], &span.tiles);
            let first = own.candidates.len() as u32;
            own.candidates.extend_from_slice(&near);
            let others = own.candidates.len() as u32;
            own.candidates.push(2 * (members.len() as u32 - 1) + u32::from(leads));
            own.candidates.extend(blocks.clone().filter(|&other| other != block));
            own.tiles.push(Tile { area, first, count: near.len() as u32, block, others });
        }
    }

    /// Puts the tiles where a cloud is alone before those where it crosses others, in the cells of `crossed`.
    fn add_alone(&mut self, covers: &[Cover], crossed: &HashMap<usize, HashSet<u32>>, wide: u32) {
        for (cloud, own) in &mut self.clouds {
            let is_alone = |&[x, y]: &[u32; 2]| !crossed[cloud].contains(&(y * wide + x));
            let alone = |tile: &Tile| -> Vec<Tile> {
                if cells_of(tile.area).all(|cell| is_alone(&cell)) {
                    return vec![*tile];
                }
                let part = |cell| Tile { area: within(tile.area, cell), ..*tile };
                cells_of(tile.area).filter(is_alone).map(part).collect()
            };
            let mut tiles: Vec<_> = covers[*cloud].tiles.iter().flat_map(alone).collect();
            own.alone = tiles.len() as u32;
            tiles.append(&mut own.cover.tiles);
            own.cover.tiles = tiles;
        }
    }
}

impl Crossed {
    /// Of a cloud with this cover, before any tiles.
    fn of(cover: &Cover) -> Self {
        Self { cover: Cover { candidates: cover.candidates.clone(), ..Cover::default() }, alone: 0 }
    }
}

impl Cells {
    fn new(frame: &Frame, order: &[usize], covers: &[Cover]) -> Self {
        let [wide, high] = frame.camera.size.map(|n| (n as u32).div_ceil(CELL));
        let mut spans: Vec<Vec<Span>> = Vec::new();
        spans.resize_with((wide * high) as usize, Vec::new);
        for &cloud in order {
            let cover = &covers[cloud];
            for (number, (tile, &depths)) in cover.tiles.iter().zip(&cover.depths).enumerate() {
                for cell in cells_of(tile.area) {
                    let area = within(tile.area, cell);
                    add_tile(&mut spans[(cell[1] * wide + cell[0]) as usize], cloud, number, area, depths);
                }
            }
        }
        Self { wide, spans }
    }
}

/// Adds a tile of a cloud, one cloud after another.
fn add_tile(spans: &mut Vec<Span>, cloud: usize, tile: usize, area: [u32; 4], [near, far]: [f32; 2]) {
    if let Some(span) = spans.last_mut().filter(|span| span.cloud == cloud) {
        (span.near, span.far) = (span.near.min(near), span.far.max(far));
        span.area = around(span.area, area);
        span.tiles.push(tile);
    } else {
        let first = spans.len();
        spans.push(Span { cloud, near, far, tiles: vec![tile], area, first });
    }
}

/// Joins those of a cell, far ones first, that touch and of which one is not wholly beyond the one that is drawn after it.
fn join(spans: &mut [Span], touching: &Touching) {
    for b in 1..spans.len() {
        for a in 0..b {
            let (one, other) = (spans[a].first, spans[b].first);
            if spans[a].near < spans[b].far && one != other && touching.are(spans[a].cloud, spans[b].cloud) {
                let (low, high) = (one.min(other), one.max(other));
                spans.iter_mut().filter(|span| span.first == high).for_each(|span| span.first = low);
            }
        }
    }
}

/// Columns and rows of the cells that an area reaches into.
fn cells_of([left, top, right, bottom]: [u32; 4]) -> impl Iterator<Item = [u32; 2]> {
    let columns = left / CELL..right.div_ceil(CELL);
    (top / CELL..bottom.div_ceil(CELL)).flat_map(move |y| columns.clone().map(move |x| [x, y]))
}

/// What of an area lies in a cell.
fn within([left, top, right, bottom]: [u32; 4], [x, y]: [u32; 2]) -> [u32; 4] {
    let [x, y] = [CELL * x, CELL * y];
    [left.max(x), top.max(y), right.min(x + CELL), bottom.min(y + CELL)]
}

/// The least rectangle around both.
fn around(a: [u32; 4], b: [u32; 4]) -> [u32; 4] {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}

/// The ellipsoids of all these tiles; none where tiles have none.
fn candidates(cover: &Cover, tiles: &[usize]) -> Vec<u32> {
    if cover.candidates.is_empty() {
        return Vec::new();
    }
    let of = |&tile: &usize| {
        let Tile { first, count, .. } = cover.tiles[tile];
        &cover.candidates[first as usize..][..count as usize]
    };
    let mut all: Vec<u32> = tiles.iter().flat_map(of).copied().collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Where the visibilities of the clouds that cross are kept, from picture to picture.
pub(in crate::render) struct Visibilities {
    buffer: wgpu::Buffer,
}

impl Visibilities {
    /// Room for those of so many blocks.
    pub fn new(device: &wgpu::Device, blocks: u32) -> Self {
        Made::one(|made| &mut made.buffers);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("visibilities"),
            size: u64::from(blocks.max(1)) * BLOCK_BYTES,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer }
    }

    /// Makes room for those of these crossings.
    pub fn make_room(&mut self, device: &wgpu::Device, crossings: &Crossings) {
        if self.buffer.size() < u64::from(crossings.blocks) * BLOCK_BYTES {
            let room = crossings.blocks.next_power_of_two().min(Crossings::most(device));
            *self = Self::new(device, room);
        }
    }

    /// Records that there are none yet.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder, crossings: &Crossings) {
        encoder.clear_buffer(&self.buffer, 0, Some(u64::from(crossings.blocks) * BLOCK_BYTES));
    }

    pub fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }
}
