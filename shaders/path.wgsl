// Truth: unbiased light transport by Monte Carlo over the very density that the clouds
// are drawn with. Null-collision (delta) tracking with a majorant for each cell of a
// grid, next-event estimation to the sun's disc through ratio tracking, Mie scattering
// sampled from its table, Russian roulette on paths that carry little. Some threads a pixel,
// each with samples of its own; their paths are kept between dispatches, so that each does a
// bounded amount of work.
//
// Mie scattering has a peak some thousand times as high as its flank, so that a path which
// happens to turn towards the sun sees a thousand times the light of its neighbours. A share
// of directions is therefore drawn around the sun instead of around the path, and the two
// ways are weighted by what both together would have chosen (one-sample balance heuristic).
// Paths carry red, green and blue: one of them chooses the directions, and the choices that
// the others would have made weigh in the same way (Wilkie et al. 2014).
// @use atmosphere camera medium path_choice path_random phase ray_box

struct Scene {
    // Least corner of the grid relative to the scene's origin, m; the scene's origin is
    // where ellipsoids and noise have theirs.
    low: vec3f,
    // Edge of a cell, m.
    cell: f32,
    size: vec3u,
    // Samples that each pixel shall have from here.
    samples: u32,
    // The camera's position, m from the scene's origin.
    camera: vec3f,
    seed: u32,
    to_sun: vec3f,
    // Angular radius of the sun's disc, rad.
    sun_radius: f32,
    sun_irradiance: vec3f,
    // Altitude of the scene's origin above the ground, m.
    altitude: f32,
    // Samples that each pixel has from elsewhere: the next one has this number.
    first: u32,
    // Steps of one thread in one dispatch.
    rounds: u32,
    padding: vec2u,
}

struct Cell {
    first: u32,
    count: u32,
    // Largest extinction in the cell, 1/m.
    majorant: f32,
    padding: u32,
}

// A path under way.
struct Path {
    position: vec3f,
    random: u32,
    direction: vec3f,
    mode: u32,
    // Towards a point of the sun's disc.
    to_light: vec3f,
    // Transmittance towards the sun so far.
    shadow: f32,
    // Phase function times irradiance, for when the sun is reached.
    light: vec3f,
    // Samples that this thread has finished.
    taken: u32,
    // What the path has scattered, over the density with which its channel chose it.
    throughput: vec3f,
    collisions: u32,
    // Densities with which each channel would have chosen it, over that of its channel.
    choice: vec3f,
    species: u32,
    // Light of this sample so far.
    gathered: vec3f,
    // The channel that chooses the directions.
    channel: u32,
    // Where the shadow ray began.
    origin: vec3f,
    padding: u32,
}

const START: u32 = 0u;
const TRACK: u32 = 1u;
const SHADOW: u32 = 2u;
const DONE: u32 = 3u;

override ATMOSPHERE: bool = true;
// Threads of one pixel: thread i has samples i, i + LANES, ... of `Scene::samples`.
override LANES: u32 = 1u;
// Least share of directions that are drawn around the sun, at the first collisions; later ones
// have less of it, so that what all of them take from a path stays bounded. 0 leaves all
// directions to the phase function.
override TO_SUN: f32 = 0.03;
// Largest share of them. A path at some degrees from the sun must be free to go on as it was: the
// rarer it does, the more it weighs when it does, and it does so at every collision.
override MOST_TO_SUN: f32 = 0.3;
// Paths that carry less than this are ended by chance.
override FAINT: f32 = 0.05;

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var<uniform> camera: Camera;
@group(0) @binding(2) var<uniform> sky: Sky;
@group(0) @binding(3) var<storage, read> cells: array<Cell>;
@group(0) @binding(4) var<storage, read> candidates: array<u32>;
// By species: see below.
@group(0) @binding(5) var<storage, read> phase_tables: array<f32>;
@group(0) @binding(6) var<storage, read_write> paths: array<Path>;
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

// The sample that a thread is at, of those that its pixel shall have.
fn sample_of(path: ptr<function, Path>, index: u32) -> u32 {
    return index % LANES + LANES * (*path).taken;
}

// A species in `phase_tables`: its albedo, then for each channel the phase function over
// the coordinate of its angle, then the angle below which a share of light is scattered,
// over the coordinate of that share.
const ANGLES: u32 = 4096u;
const TABLE: u32 = 1u + 6u * ANGLES;

fn table_at(base: u32, x: f32) -> f32 {
    let place = clamp(x, 0.0, 1.0) * f32(ANGLES - 1u);
    let i = min(u32(place), ANGLES - 2u);
    return mix(phase_tables[base + i], phase_tables[base + i + 1u], place - f32(i));
}

// Phase function between two directions of propagation, three channels, 1/sr.
fn phase(species: u32, before: vec3f, after: vec3f) -> vec3f {
    let x = phase_coordinate(before, after);
    let base = TABLE * species + 1u;
    return vec3f(table_at(base, x), table_at(base + ANGLES, x), table_at(base + 2u * ANGLES, x));
}

// A direction after scattering, chosen by one channel.
fn scattered(species: u32, channel: u32, before: vec3f) -> vec3f {
    let x = share_coordinate(draw());
    let angle = table_at(TABLE * species + 1u + (3u + channel) * ANGLES, x);
    return turned(before, angle, 6.2831853 * draw());
}

// Tracking as far as the next tentative collision.
struct Step {
    position: vec3f,
    // Whether the grid was left.
    outside: bool,
    // Whether this is a tentative collision, and what is there.
    tentative: bool,
    matter: Matter,
    majorant: f32,
}

// Cells that one step crosses at the most; the next one goes on from there.
const CELLS: u32 = 24u;

// Crosses cells until an optical depth of the majorant, drawn once, is used up; only there
// the density is asked. (Stopping between cells and drawing anew changes nothing: what is
// left of an exponential is distributed like a fresh one.)
fn track(position: vec3f, direction: vec3f) -> Step {
    var p = position;
    var left = free_flight(draw());
    var outside = false;
    var tentative = false;
    var cell = Cell(0u, 0u, 0.0, 0u);
    for (var i = 0u; i < CELLS; i++) {
        let place = (p - scene.low) / scene.cell;
        let index = vec3i(floor(place));
        outside = any(index < vec3i(0)) || any(index >= vec3i(scene.size));
        if outside {
            break;
        }
        let c = vec3u(index);
        cell = cells[(c.z * scene.size.y + c.y) * scene.size.x + c.x];
        let exit = cell_exit(place, scene.cell, direction);
        tentative = cell.majorant * exit > left;
        if tentative {
            p += left / cell.majorant * direction;
            break;
        }
        p += exit * direction;
        left -= cell.majorant * exit;
    }
    if !tentative {
        return Step(p, outside, false, CLEAR, 0.0);
    }
    return Step(p, false, true, medium_at(Region(cell.first, cell.count), p, 0.0, 0.0), cell.majorant);
}

// Irradiance of the sun at a point.
fn sun_at(p: vec3f) -> vec3f {
    if !ATMOSPHERE {
        return scene.sun_irradiance;
    }
    return scene.sun_irradiance * sun_irradiance_at(sky.atmosphere, transmittance, clamped, scene.altitude + p.y, scene.to_sun.y);
}

// Light of sky and ground from a direction, as clouds see it; the camera may be far below.
fn sky_from(direction: vec3f) -> vec3f {
    if !ATMOSPHERE {
        return sky.radiance;
    }
    let a = sky.atmosphere;
    let altitude = max(sky.light_altitude, 0.0);
    let ground = direction.y < horizon_mu(a, altitude);
    let sine = half_azimuth_sine(direction, scene.to_sun);
    let uv = sky_view_uv(a, vec2f(textureDimensions(sky_view)), altitude, direction.y, sine, ground);
    return sky.irradiance * textureSampleLevel(sky_view, clamped, uv, 0.0).rgb / TABLE_SCALE;
}

fn start(path: ptr<function, Path>, pixel: vec2u, index: u32) {
    let number = scene.first + sample_of(path, index);
    // Channels take turns from one that the pixel draws, so that none is preferred.
    (*path).channel = (number + hash_random(index / LANES, 0xffffffffu, scene.seed)) % 3u;
    random_state = hash_random(index / LANES, number, scene.seed);
    let offset = vec2f(draw(), draw());
    let ray = camera_ray(camera, pixel_ndc(camera, vec2f(pixel) + offset));
    let origin = scene.camera + ray.origin;
    let high = scene.low + scene.cell * vec3f(scene.size);
    let span = box_span(scene.low, high, origin, ray.direction);
    (*path).direction = ray.direction;
    (*path).position = origin + (span.x + 1e-4 * scene.cell) * ray.direction;
    // A ray that misses the grid is outside at once.
    if span.x >= span.y {
        (*path).position = scene.low - vec3f(scene.cell);
    }
    (*path).throughput = vec3f(1.0);
    (*path).choice = vec3f(1.0);
    (*path).gathered = vec3f(0.0);
    (*path).collisions = 0u;
    (*path).mode = TRACK;
}

fn finish(path: ptr<function, Path>, index: u32) {
    let hit = select(0.0, 1.0, (*path).collisions > 0u);
    sums[index] = sum_with(sums[index], (*path).gathered, hit, (*path).taken + 1u);
    (*path).taken += 1u;
    (*path).mode = start_or_done(path, index);
}

fn start_or_done(path: ptr<function, Path>, index: u32) -> u32 {
    return select(DONE, START, sample_of(path, index) < scene.samples);
}

// What a path carries, its three ways to be chosen weighed together.
fn carried(path: ptr<function, Path>) -> vec3f {
    return spectral_weight((*path).throughput, (*path).choice);
}

// A real collision: aim at the sun.
fn collide(path: ptr<function, Path>, p: vec3f, species: u32) {
    (*path).position = p;
    (*path).origin = p;
    (*path).species = species;
    (*path).collisions += 1u;
    (*path).throughput *= phase_tables[TABLE * species];
    let angle = disc_angle(scene.sun_radius, draw());
    (*path).to_light = turned(scene.to_sun, angle, 6.2831853 * draw());
    (*path).light = phase(species, (*path).direction, (*path).to_light) * sun_at(p);
    (*path).shadow = 1.0;
    (*path).mode = SHADOW;
}

// Share of directions drawn around the sun at a collision.
fn share_to_sun(path: ptr<function, Path>) -> f32 {
    let toward = phase((*path).species, (*path).direction, scene.to_sun).y;
    return share_around_sun(TO_SUN, MOST_TO_SUN, toward, (*path).collisions);
}

// Chooses where to go on from a collision: around the path or around the sun.
fn choose_direction(path: ptr<function, Path>) {
    let channel = (*path).channel;
    let species = (*path).species;
    let before = (*path).direction;
    let share = share_to_sun(path);
    let around = select(before, scene.to_sun, draw() < share);
    let after = scattered(species, channel, around);
    let scattering = phase(species, before, after);
    let chances = mixed_density(share, scattering, phase(species, scene.to_sun, after));
    let chance = chances[channel];
    (*path).direction = after;
    (*path).throughput *= scattering / chance;
    (*path).choice *= chances / chance;
}

// Russian roulette on paths that carry little. Long ones that have lost nothing go on: ending
// them with a chance above that of leaving the cloud would put all of their light, percents of
// a thick cloud's, on paths too rare to be seen.
fn roulette(path: ptr<function, Path>) {
    let survival = roulette_survival(carried(path), FAINT, near_sun(path));
    if draw() >= survival {
        (*path).throughput = vec3f(0.0);
    }
    (*path).throughput /= survival;
}

// Whether the path goes to where droplets scatter it into the sun's disc by their peak.
fn near_sun(path: ptr<function, Path>) -> bool {
    return dot((*path).direction, scene.to_sun) > NEAR_SUN;
}
// Cosine of 8 degrees.
const NEAR_SUN: f32 = 0.99;

// The sun was reached, or is hidden or dark: go on where the collision was.
fn scatter(path: ptr<function, Path>, index: u32) {
    (*path).position = (*path).origin;
    (*path).mode = TRACK;
    choose_direction(path);
    roulette(path);
    if all((*path).throughput <= vec3f(0.0)) {
        finish(path, index);
    }
}

fn advance(path: ptr<function, Path>, index: u32) {
    let is_shadow = (*path).mode == SHADOW;
    let direction = select((*path).direction, (*path).to_light, is_shadow);
    let step = track((*path).position, direction);
    (*path).position = step.position;
    let share = select(0.0, real_share(step.matter.extinction, step.majorant), step.tentative);
    var seen = false;
    if is_shadow {
        (*path).shadow *= 1.0 - share;
        // Roulette on what hardly counts keeps its mean.
        var hidden = (*path).shadow <= 0.0;
        if (*path).shadow < 0.05 && step.tentative {
            hidden = hidden || draw() < 0.5;
            (*path).shadow *= 2.0;
        }
        seen = step.outside || hidden;
        (*path).gathered += select(vec3f(0.0), carried(path) * (*path).light * (*path).shadow, seen && !hidden);
    } else if step.outside {
        if (*path).collisions > 0u {
            (*path).gathered += carried(path) * sky_from((*path).direction);
        }
        finish(path, index);
    } else if step.tentative && draw() < share {
        collide(path, step.position, bodies[step.matter.body].table);
        seen = all((*path).light <= vec3f(0.0));
    }
    if seen {
        scatter(path, index);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let width = u32(camera.size.x);
    // Threads in rows of workgroups, since one row has a limit.
    let index = id.x + id.y * 64u * groups.x;
    let pixel = index / LANES;
    if pixel >= width * u32(camera.size.y) {
        return;
    }
    var path = paths[index];
    random_state = path.random;
    if path.mode == START || path.mode == DONE {
        path.mode = start_or_done(&path, index);
    }
    for (var i = 0u; i < scene.rounds; i++) {
        if path.mode == START {
            start(&path, vec2u(pixel % width, pixel / width), index);
        } else if path.mode == DONE {
            break;
        } else {
            advance(&path, index);
        }
    }
    path.random = random_state;
    paths[index] = path;
    if path.mode != DONE {
        atomicAdd(&unfinished, 1u);
    }
}
