// Mean extinction of voxels, from samples at the middles of equal parts of each: blocks of
// 8 by 8 by 8 voxels that ellipsoids reach into, z fastest. One thread a voxel.
// @use medium

struct Voxels {
    // Edges of a voxel, m.
    edge_x: vec3f,
    // Samples along each edge.
    samples: u32,
    edge_y: vec3f,
    // Blocks of this dispatch.
    blocks: u32,
    edge_z: vec3f,
    padding: f32,
}

struct Block {
    // Corner of its first voxel, m.
    corner: vec3f,
    // Where its ellipsoids are in `candidates`.
    first: u32,
    count: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(0) @binding(0) var<uniform> voxels: Voxels;
@group(0) @binding(1) var<storage, read> blocks: array<Block>;
@group(0) @binding(2) var<storage, read> candidates: array<u32>;
@group(0) @binding(3) var<storage, read_write> extinctions: array<f32>;

const EDGE: u32 = 8u;
const VOXELS: u32 = EDGE * EDGE * EDGE;

fn extinction_at(p: vec3f, block: Block) -> f32 {
    return medium_at(Region(block.first, block.count), p, 0.0, 0.0).extinction;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= VOXELS * voxels.blocks {
        return;
    }
    let block = blocks[id.x / VOXELS];
    let voxel = vec3u(id.x / (EDGE * EDGE), id.x / EDGE, id.x) % EDGE;
    let n = voxels.samples;
    var sum = 0.0;
    for (var i = 0u; i < n * n * n; i++) {
        let part = (vec3f(vec3u(i / (n * n), i / n, i) % n) + 0.5) / f32(n);
        let q = vec3f(voxel) + part;
        sum += extinction_at(block.corner + q.x * voxels.edge_x + q.y * voxels.edge_y + q.z * voxels.edge_z, block);
    }
    extinctions[id.x] = sum / f32(n * n * n);
}
