// Bakes the depth below a cloud's boundary at the corners of the cells of its bricks: of the ellipsoid
// that is the densest on average over the noise, with its edge; of those alike, the deepest. One thread a
// corner.
// @use depth_volume ellipsoid

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
    var densest = -1.0;
    var deepest = -1e30;
    var greatest = -1e30;
    var texel = vec4f(-volume_frame.brick, 0.0, 0.0, 0.0);
    for (var i = 0u; i < brick.count; i++) {
        let e = ellipsoids[candidates[brick.first + i]];
        let depth = clamp(ellipsoid_depth(e, ellipsoid_unit(e, p, 1.0)), -DEEPEST, DEEPEST);
        let mean = matter_below(edge_of(e), depth, vec2f(0.0), 0.0);
        greatest = max(greatest, depth);
        if mean.extinction > densest || (mean.extinction == densest && mean.depth > deepest) {
            densest = mean.extinction;
            deepest = mean.depth;
            texel = vec4f(depth, e.extinction, e.displacement, e.wispiness);
        }
    }
    // Outside of all, nothing is nearer than the nearest.
    texel.x = select(texel.x, greatest, texel.x <= 0.0);
    textureStore(atlas, depth_slot(volume_frame, number) + corner, texel);
}
