// What the path tracer is given, what it keeps of each path, and its random numbers.
// @use atmosphere camera path_random

// Cells that hold all there is of some clouds.
struct Grid {
    // Least corner relative to the scene's origin, m; the scene's origin is where ellipsoids have theirs.
    low: vec3f,
    // Edge of a cell, m.
    cell: f32,
    size: vec3u,
    // Where its cells begin.
    first: u32,
    // 1 where it repeats itself along x and z, else 0.
    repeats: u32,
    // Grids after it.
    more: u32,
    padding_0: u32,
    padding_1: u32,
}

// Grids that there is room for: one of all that ends, then those of layers.
const MOST_GRIDS: u32 = 5u;

struct Scene {
    grids: array<Grid, MOST_GRIDS>,
    // The camera's position, m from the scene's origin.
    camera: vec3f,
    // Samples that each pixel shall have from here.
    samples: u32,
    to_sun: vec3f,
    // Angular radius of the sun's disc, rad.
    sun_radius: f32,
    // Or of a flash.
    sun_irradiance: vec3f,
    // Altitude of the scene's origin above the ground, m.
    altitude: f32,
    // Samples that each pixel has from elsewhere: the next one has this number.
    first: u32,
    // Steps of one thread in one dispatch.
    rounds: u32,
    seed: u32,
    // Half the earth's curvature, over which the camera sees the clouds, 1/m; 0 where they are small.
    curvature: f32,
    // A ball that shines in place of the sun: its centre, m from the scene's origin, and radius, m.
    flash: vec4f,
}

struct Cell {
    first: u32,
    count: u32,
    // Largest extinction in the cell, 1/m.
    majorant: f32,
    // Where it is empty: how many cells around it are so, too.
    clear: u32,
}

// A path under way.
struct Path {
    position: vec3f,
    direction: vec3f,
    mode: u32,
    // Samples that this thread has finished.
    taken: u32,
    // Light of this sample so far.
    gathered: vec3f,
    collisions: u32,
    // What the path has scattered, all channels' ways to choose it weighed together.
    throughput: vec3f,
    // Densities with which each channel would have chosen it, over their mean.
    choice: vec3f,
    // The channel that chooses the directions.
    channel: u32,
    // The last collision: its species, and whether it is PEAK or WIDE.
    species: u32,
    part: u32,
    // Whether peak collisions of that species that follow take no light from the sun, since the last wide one
    // has it all.
    covered: bool,
    // What that part of the phase function is towards the sun, green, 1/sr.
    toward: f32,
    // One over the chance that its walks to the sun had to be taken.
    taken_weight: f32,
    // Where they begin.
    origin: vec3f,
    // Whether they take peak collisions.
    chained: bool,
    // The seed of their random numbers, and the state of the path's own meanwhile.
    walk: u32,
    kept: u32,
    // Where the walk goes.
    to_light: vec3f,
    // What it brings where nothing is in its way, and what is left of that: the wide collisions' share is
    // taken off.
    light: vec3f,
    shadow: f32,
    // Height of its last collision, m; of a walk to a flash how far that is, m.
    height: f32,
    // Peak collisions of a straight walk so far; of others those that are still to come.
    count: u32,
    // Number of them in the next walk, none where it is 0, and one over the chance to take that.
    other: u32,
    other_weight: f32,
}

// The same between dispatches, with less room.
struct StoredPath {
    position: vec3f,
    random: u32,
    direction: vec3f,
    // Bits: 3 of the mode, 2 of the channel, part, covered, chained; then the species.
    flags: u32,
    to_light: vec3f,
    shadow: f32,
    light: vec3f,
    taken: u32,
    throughput: vec3f,
    collisions: u32,
    choice: vec3f,
    // `count`, then `other`.
    counts: u32,
    gathered: vec3f,
    height: f32,
    origin: vec3f,
    toward: f32,
    walk: u32,
    kept: u32,
    other_weight: f32,
    taken_weight: f32,
}

const START: u32 = 0u;
const TRACK: u32 = 1u;
// A walk straight to the sun.
const STRAIGHT: u32 = 2u;
// A walk along a chain of directions.
const CHAIN: u32 = 3u;
const DONE: u32 = 4u;

const WIDE: u32 = 0u;
const PEAK: u32 = 1u;

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var<uniform> camera: Camera;
@group(0) @binding(2) var<uniform> sky: Sky;
@group(0) @binding(3) var<storage, read> cells: array<Cell>;
@group(0) @binding(4) var<storage, read> candidates: array<u32>;
// By species: see below.
@group(0) @binding(5) var<storage, read> phase_tables: array<f32>;
@group(0) @binding(6) var<storage, read_write> paths: array<StoredPath>;
@group(0) @binding(7) var<storage, read_write> sums: array<Sum>;
@group(0) @binding(8) var<storage, read_write> unfinished: atomic<u32>;
@group(0) @binding(9) var clamped: sampler;
@group(0) @binding(10) var transmittance: texture_2d<f32>;
@group(0) @binding(11) var sky_view: texture_2d<f32>;

// The state of the path's random numbers while this thread works on it.
var<private> random_state: u32;

fn draw() -> f32 {
    var state = random_state;
    let x = uniform_random(&state);
    random_state = state;
    return x;
}

fn next_seed() -> u32 {
    var state = random_state;
    let seed = next_random(&state);
    random_state = state;
    return seed;
}

// Takes up a path where it was left.
fn loaded(index: u32) -> Path {
    let s = paths[index];
    random_state = s.random;
    let bit = vec3u(s.flags >> 5u, s.flags >> 6u, s.flags >> 7u) & vec3u(1u);
    return Path(s.position, s.direction, s.flags & 7u, s.taken, s.gathered, s.collisions, s.throughput, s.choice,
        (s.flags >> 3u) & 3u, s.flags >> 8u, bit.x, bit.y == 1u, s.toward, s.taken_weight, s.origin, bit.z == 1u,
        s.walk, s.kept, s.to_light, s.light, s.shadow, s.height, s.counts & 0xffffu, s.counts >> 16u,
        s.other_weight);
}

// Leaves it there.
fn store(index: u32, path: Path) {
    let bits = path.part << 5u | select(0u, 64u, path.covered) | select(0u, 128u, path.chained);
    let flags = path.mode | path.channel << 3u | bits | path.species << 8u;
    paths[index] = StoredPath(path.position, random_state, path.direction, flags, path.to_light, path.shadow,
        path.light, path.taken, path.throughput, path.collisions, path.choice, path.count | path.other << 16u,
        path.gathered, path.height, path.origin, path.toward, path.walk, path.kept, path.other_weight,
        path.taken_weight);
}
