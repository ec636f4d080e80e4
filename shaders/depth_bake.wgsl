// Bakes the depth below a cloud's hull at the corners of the cells of its bricks, with the edge there. One
// thread a corner.
// @use depth_volume

struct Brick {
    // Place among the bricks.
    place: vec3u,
    // Where the ellipsoids near it begin in `candidates`, and how many there are.
    first: u32,
    count: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(0) @binding(0) var<uniform> volume_frame: DepthVolume;
@group(0) @binding(1) var<storage, read> bricks: array<Brick>;
@group(0) @binding(2) var<storage, read> candidates: array<u32>;
@group(0) @binding(3) var<storage, read> ellipsoids: array<Ellipsoid>;
@group(0) @binding(4) var atlas: texture_storage_3d<rgba16float, write>;

// Half floats end beyond, m.
const DEEPEST: f32 = 6e4;

const CORNERS: u32 = DEPTH_CORNERS * DEPTH_CORNERS * DEPTH_CORNERS;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * 64u * groups.x;
    let number = index / CORNERS;
    if number >= arrayLength(&bricks) {
        return;
    }
    let brick = bricks[number];
    let corner = vec3u(index, index / DEPTH_CORNERS, index / (DEPTH_CORNERS * DEPTH_CORNERS)) % DEPTH_CORNERS;
    let place = vec3f(brick.place) + vec3f(corner) / f32(DEPTH_CELLS);
    let p = volume_frame.low + volume_frame.brick * place;
    var lumps = NO_LUMPS;
    var nearest = vec4f(-volume_frame.brick, 0.0, 0.0, 0.0);
    for (var i = 0u; i < brick.count; i++) {
        let e = ellipsoids[candidates[brick.first + i]];
        let depth = clamp(ellipsoid_depth(e, ellipsoid_unit(e, p, 1.0)), -DEEPEST, DEEPEST);
        nearest = select(nearest, vec4f(depth, e.extinction, e.boundary, e.wispiness), depth >= lumps.deepest);
        lumps = lumps_with(lumps, e, depth, volume_frame.power, volume_frame.reach);
    }
    // Outside of all, the edge is that of the nearest.
    let edge = lumps_edge(lumps, volume_frame.power, volume_frame.reach);
    let inside = vec4f(min(edge.depth, DEEPEST), edge.extinction, edge.boundary, edge.wispiness);
    // Lumps that are not listed are a cell beyond the walls of the brick or farther.
    let walls = vec3f(min(corner, DEPTH_CELLS - corner)) / f32(DEPTH_CELLS);
    let unlisted = volume_frame.brick * (min(walls.x, min(walls.y, walls.z)) + 1.0 / f32(DEPTH_CELLS));
    nearest.x = max(nearest.x, -unlisted);
    let told = select(nearest, inside, lumps.weight > 0.0);
    let texel = vec4f(told.x, told.y / volume_frame.core, told.z, told.w);
    textureStore(atlas, depth_slot(volume_frame, number) + corner, texel);
}
