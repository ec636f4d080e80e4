// A sparse volume of extinction that another program made: bricks of voxels in an atlas that an index points into,
// and coarser copies of the whole for what is far away or wanted on average. Empty bricks are not stored.
// @use density ray_box

// Levels of a volume, each half as fine as the one before.
const VOLUME_LEVELS: u32 = 8u;

struct Volume {
    // Rows of the map from the cloud's frame, m, to bricks of the finest level.
    row_x: vec4f,
    row_y: vec4f,
    row_z: vec4f,
    // 1 over the texels of the atlas along each axis.
    texel: vec3f,
    // Extinction coefficient of the greatest value, 1/m.
    extinction: f32,
    // Bricks of the atlas along x and y.
    slots: vec2u,
    // Shortest edge of a voxel, m.
    voxel: f32,
    // Levels that there are.
    count: u32,
    // Longest edge of a voxel, m.
    widest: f32,
    // 1 where a texel of the atlas holds several fields, else 0.
    mixed: u32,
    padding_1: f32,
    padding_2: f32,
    // By level: bricks along each axis, and where those begin in the index.
    levels: array<vec4u, VOLUME_LEVELS>,
}

// Cells along the edge of a brick; its corners, which it stores, are one more.
const VOLUME_CELLS: u32 = 8u;
const VOLUME_CORNERS: u32 = VOLUME_CELLS + 1u;

// A point among bricks of the finest level.
fn volume_place(volume: Volume, p: vec3f) -> vec3f {
    let at = vec4f(p, 1.0);
    return vec3f(dot(volume.row_x, at), dot(volume.row_y, at), dot(volume.row_z, at));
}

// A direction likewise: bricks each metre.
fn volume_way(volume: Volume, direction: vec3f) -> vec3f {
    let way = vec4f(direction, 0.0);
    return vec3f(dot(volume.row_x, way), dot(volume.row_y, way), dot(volume.row_z, way));
}

// The coarsest level whose voxels are no wider than a footprint, m.
fn volume_level(volume: Volume, footprint: f32) -> u32 {
    let coarser = floor(log2(max(footprint / volume.widest, 1.0)));
    return u32(min(coarser, f32(volume.count - 1u)));
}

// How many bricks of a level one of the finest is.
fn volume_scale(level: u32) -> f32 {
    return 1.0 / f32(1u << level);
}

// Whether a brick is one of a level's.
fn volume_holds(volume: Volume, level: u32, brick: vec3f) -> bool {
    return all(brick >= vec3f(0.0)) && all(brick < vec3f(volume.levels[level].xyz));
}

// Where the index tells of a brick that is one of a level's.
fn volume_entry(volume: Volume, level: u32, brick: vec3f) -> u32 {
    let own = volume.levels[level];
    let at = vec3u(brick);
    return own.w + (at.z * own.y + at.y) * own.x + at.x;
}

// What the index tells of a brick: nothing, or its number in the atlas and how dense it is at the most.
const VOLUME_EMPTY: u32 = 0u;

fn volume_number(entry: u32) -> u32 {
    return entry & 0xffffffu;
}

// The greatest extinction in a brick, 1/m: no less than that.
fn volume_most(volume: Volume, entry: u32) -> f32 {
    return volume.extinction * f32(entry >> 24u) / 255.0;
}

// Texture coordinates in the atlas of a point in brick `number`; `inside` is from 0 to 1 in the brick.
fn volume_coordinate(volume: Volume, number: u32, inside: vec3f) -> vec3f {
    let row = number / volume.slots.x;
    let slot = VOLUME_CORNERS * vec3u(number % volume.slots.x, row % volume.slots.y, row / volume.slots.y);
    return (vec3f(slot) + 0.5 + f32(VOLUME_CELLS) * inside) * volume.texel;
}

// What a place is beyond a wall, in bricks, to be behind it.
const VOLUME_NUDGE: f32 = 1e-4;

// The brick that a ray goes on in from a place among bricks: behind the walls that it is at. Walls belong to the
// bricks on both of their sides.
fn volume_ahead(place: vec3f, way: vec3f) -> vec3f {
    return floor(place + select(vec3f(-VOLUME_NUDGE), vec3f(VOLUME_NUDGE), way > vec3f(0.0)));
}

// Distance along a ray, m, from a place to where it leaves the brick that it goes on in, by a way in bricks each metre.
fn volume_exit(place: vec3f, brick: vec3f, way: vec3f) -> f32 {
    let walls = brick + select(vec3f(0.0), vec3f(1.0), way > vec3f(0.0)) - place;
    let ways = abs(walls / steady_direction(way));
    return min(ways.x, min(ways.y, ways.z));
}

// Optical depth of a voxel that is not thin, and the voxels that steps go by where it is thick and where it is clear.
const VOLUME_THIN: f32 = 0.05;
const VOLUME_STEPS: vec2f = vec2f(3.0, 6.0);

// The thickness of a boundary that steps in a brick go by, m: of so many voxels of this level, more where a voxel of
// the greatest extinction in the brick, 1/m, is thin.
fn volume_boundary(volume: Volume, level: u32, most: f32) -> f32 {
    let voxel = volume.voxel / volume_scale(level);
    return voxel * mix(VOLUME_STEPS.y, VOLUME_STEPS.x, saturate(most * voxel / VOLUME_THIN));
}

// Extinction of each field at a point, 1/m, from a sample of the atlas.
fn volume_fields(volume: Volume, texel: vec4f) -> vec4f {
    return volume.extinction * select(vec4f(texel.x, 0.0, 0.0, 0.0), texel, volume.mixed == 1u);
}

// One of the fields, as likely as its share, by a number from 0 to 1.
fn volume_field(fields: vec4f, chance: f32) -> u32 {
    let below = vec3f(fields.x, fields.x + fields.y, fields.x + fields.y + fields.z);
    let whole = below.z + fields.w;
    let place = min(chance, 0.999999) * whole;
    let passed = select(vec3u(0u), vec3u(1u), vec3f(place) >= below);
    return select(0u, passed.x + passed.y + passed.z, whole > 0.0);
}

// A number from 0 to 1 for a place, unlike that of any other: where a place is drawn by chance, so is this (the
// finalizer of Wellons 2018 over the bits of the place).
fn volume_chance(p: vec3f) -> f32 {
    let bits = bitcast<vec3u>(p);
    var hash = bits.x * 747796405u + bits.y * 2891336453u + bits.z * 277803737u;
    hash = (hash ^ (hash >> 16u)) * 2146121005u;
    hash = (hash ^ (hash >> 15u)) * 2221713035u;
    hash ^= hash >> 16u;
    return f32(hash >> 8u) * (1.0 / 16777216.0);
}

// What is at a point of this extinction, 1/m, in a body.
fn volume_matter(volume: Volume, extinction: f32, body: u32) -> Matter {
    return Matter(extinction, select(-volume.voxel, volume.voxel, extinction > 0.0), 0.0, 0.0, body);
}

// Share of the greatest extinction beside which a change is none.
const VOLUME_FLAT: f32 = 1e-3;

// Which way a cloud faces against the `slope` of its extinction: a unit vector but where that hardly changes.
fn volume_facing(volume: Volume, slope: vec3f) -> vec3f {
    return -slope / max(length(slope), VOLUME_FLAT * volume.extinction);
}
