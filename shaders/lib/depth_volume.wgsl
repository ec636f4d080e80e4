// A sparse volume of depths below a cloud's boundary: bricks of voxels along the boundary, in an atlas
// that an index points into; the rest is empty or homogeneous.
// @use density ray_box

struct DepthVolume {
    // Least corner in the cloud's frame, m.
    low: vec3f,
    // Edge of a brick, m.
    brick: f32,
    // Bricks along each axis.
    size: vec3u,
    // Extinction of the densest lump, 1/m.
    core: f32,
    // 1 over the texels of the atlas along each axis.
    texel: vec3f,
    // Thickness of the boundary that steps go by, m.
    boundary: f32,
    // Bricks of the atlas along x and y.
    slots: vec2u,
    // Exponent with which depths of lumps are joined, and the depth that they are told in, m.
    power: f32,
    reach: f32,
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

// The edge that a texel tells: depth, share of the densest extinction, boundary and wispiness.
fn depth_edge(volume: DepthVolume, texel: vec4f) -> Edge {
    return Edge(texel.x, volume.core * texel.y, texel.z, texel.w);
}

// Distance along a unit `direction` in which there is nothing, m, from a `place` among the bricks, in a
// `brick` that tells others to be `far` bricks away.
fn depth_clear(volume: DepthVolume, place: vec3f, brick: vec3f, far: u32, direction: vec3f) -> f32 {
    let others = vec3f(max(f32(far), 1.0));
    let steady = steady_direction(direction);
    let walls = select(brick + 1.0 - others, brick + others, steady > vec3f(0.0));
    let ways = (walls - place) / steady;
    return volume.brick * max(min(ways.x, min(ways.y, ways.z)), 0.0);
}

// Thickness of the boundary that steps go by, m: less where the noise, whose largest features are
// 1 / `frequency`, moves it by more than their size, for then there is more than one edge in it.
fn depth_boundary(volume: DepthVolume, frequency: f32) -> f32 {
    return volume.boundary / max(1.0, volume.boundary * frequency);
}

// A point among the bricks: its brick, and what the index tells of that.
struct DepthPlace {
    place: vec3f,
    brick: vec3f,
    entry: u32,
}

// What is at a place where the index alone or the depth of a `texel` tells: nothing, or the
// core. Else its extinction is negative. `clear` goes along a direction.
fn depth_certain(volume: DepthVolume, at: DepthPlace, texel: vec4f, direction: vec3f) -> Matter {
    let kind = depth_kind(at.entry);
    if kind == DEPTH_CORE {
        return Matter(volume.core, 1e4, depth_clear(volume, at.place, at.brick, 1u, direction), 0.0, 0u);
    }
    if kind == DEPTH_EMPTY {
        let clear = depth_clear(volume, at.place, at.brick, depth_number(at.entry), direction);
        return Matter(0.0, -volume.brick, 0.0, clear, 0u);
    }
    return Matter(select(-1.0, 0.0, texel.x <= 0.0), texel.x, 0.0, max(-texel.x, 0.0), 0u);
}

// Which way a cloud faces against the `slope` of its depth, at this depth: a unit vector at the
// boundary, and less inside.
fn depth_facing(volume: DepthVolume, slope: vec3f, depth: f32) -> vec3f {
    let deep = 1.0 - saturate(max(depth, 0.0) / (4.0 * volume.brick));
    return -deep * slope / max(length(slope), 1e-6);
}
