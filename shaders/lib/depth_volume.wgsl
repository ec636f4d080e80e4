// A sparse volume of depths below a cloud's boundary: bricks of voxels along the boundary, in an atlas
// that an index points into; the rest is empty or homogeneous.
// @use density

struct DepthVolume {
    // Least corner in the cloud's frame, m.
    low: vec3f,
    // Edge of a brick, m.
    brick: f32,
    // Bricks along each axis.
    size: vec3u,
    // Extinction in homogeneous bricks, 1/m.
    core: f32,
    // 1 over the texels of the atlas along each axis.
    texel: vec3f,
    // Thickness of the boundary that steps go by, m.
    boundary: f32,
    // Bricks of the atlas along x and y.
    slots: vec2u,
    // Share of the boundary over which the density rises, where it is all billows and all wisps.
    rise: vec2f,
}

// Cells along the edge of a brick; its corners are one more.
const DEPTH_CELLS: u32 = 8u;
const DEPTH_CORNERS: u32 = DEPTH_CELLS + 1u;

// Kinds of bricks, in the two highest bits of an entry of the index: nothing within so many bricks as
// the other bits tell; homogeneous; the number of a brick in the atlas.
const DEPTH_EMPTY: u32 = 0u;
const DEPTH_CORE: u32 = 1u;
const DEPTH_STORED: u32 = 2u;

fn depth_kind(entry: u32) -> u32 {
    return entry >> 30u;
}

fn depth_number(entry: u32) -> u32 {
    return entry & 0x3fffffffu;
}

// First texel of a brick in the atlas.
fn depth_slot(volume: DepthVolume, number: u32) -> vec3u {
    let row = number / volume.slots.x;
    return DEPTH_CORNERS * vec3u(number % volume.slots.x, row % volume.slots.y, row / volume.slots.y);
}

// Texture coordinates in the atlas of a point in brick `number`; `inside` is from 0 to 1 in the brick.
fn depth_coordinate(volume: DepthVolume, number: u32, inside: vec3f) -> vec3f {
    return (vec3f(depth_slot(volume, number)) + 0.5 + f32(DEPTH_CELLS) * inside) * volume.texel;
}

// The edge that a texel tells: depth, extinction, displacement and wispiness.
fn depth_edge(volume: DepthVolume, texel: vec4f) -> Edge {
    let share = mix(volume.rise.x, volume.rise.y, texel.w);
    let rise = max(texel.z * share / (1.0 - share), 1e-3);
    return Edge(texel.y, texel.z, rise, texel.w, 0u);
}

// Distance along a unit `direction` in which there is nothing, m, from a `place` among the bricks, in a
// `brick` that tells others to be `far` bricks away.
fn depth_clear(volume: DepthVolume, place: vec3f, brick: vec3f, far: u32, direction: vec3f) -> f32 {
    let others = vec3f(max(f32(far), 1.0));
    let steady = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let walls = select(brick + 1.0 - others, brick + others, steady > vec3f(0.0));
    let ways = (walls - place) / steady;
    return volume.brick * max(min(ways.x, min(ways.y, ways.z)), 0.0);
}
