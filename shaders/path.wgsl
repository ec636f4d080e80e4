// Truth: unbiased light transport by Monte Carlo over the very density that the clouds
// are drawn with. Null-collision (delta) tracking with a majorant for each cell of a
// grid, next-event estimation to the sun's disc through ratio tracking, Mie scattering
// sampled from its table, Russian roulette on paths that carry little. Some threads a pixel,
// each with samples of its own; their paths are kept between dispatches, so that each does a
// bounded amount of work.
//
// Mie scattering has a peak some thousand times as high as its flank. What scatters is therefore
// split: each collision is one in the peak of the phase function, or a wide one. At a wide one, all light is
// estimated that comes from the sun through any number of peak collisions (`walk`): these are drawn
// backwards, from the sun, so that only the smooth part of the phase function is left in the estimate. Peak
// collisions after a wide one then take no light from the sun themselves; before the first wide one
// they do, and a share of their directions is drawn around the sun (one-sample balance heuristic).
// Paths carry red, green and blue: one of them chooses the directions, and the choices that
// the others would have made weigh in the same way (Wilkie et al. 2014).
// @use path_flash path_medium path_state path_walk ray_box

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

// Whether the ground hides what is behind it.
override GROUND: bool = false;

// The sample that a thread is at, of those that its pixel shall have.
fn sample_of(path: ptr<function, Path>, index: u32) -> u32 {
    return index % LANES + LANES * (*path).taken;
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
    let grid = scene.grids[0];
    let high = grid.low + grid.cell * vec3f(grid.size);
    let span = box_span(grid.low, high, origin, ray.direction);
    (*path).direction = ray.direction;
    (*path).origin = origin;
    (*path).position = origin;
    // From far away the place is rounded by more than a hair of a cell, and must not be outside.
    let hair = vec3f(1e-4 * grid.cell);
    if !MANY_GRIDS && grid.repeats == 1u {
        enter_repeating(path, origin, ray.direction);
    } else if !MANY_GRIDS {
        // A ray that misses the only grid is outside at once.
        let entry = clamp(origin + span.x * ray.direction, grid.low + hair, high - hair);
        (*path).position = select(entry, grid.low - vec3f(grid.cell), span.x >= span.y);
    }
    (*path).throughput = vec3f(1.0);
    (*path).choice = vec3f(1.0);
    (*path).gathered = vec3f(0.0);
    (*path).collisions = 0u;
    (*path).covered = false;
    (*path).mode = TRACK;
}

// Where a ray comes into a grid that repeats itself, over the curved earth: there heights are above that, and so is
// the direction. A ray that meets the ground before or nothing at all is outside.
fn enter_repeating(path: ptr<function, Path>, origin: vec3f, direction: vec3f) {
    let bend = max(scene.curvature * (1.0 - direction.y * direction.y), RAY_LEAST_BEND);
    let grid = scene.grids[0];
    let low = grid.low.y;
    let high = low + grid.cell * f32(grid.size.y);
    let over = ray_below(origin.y - high, direction.y, bend);
    let under = ray_below(origin.y - low, direction.y, bend);
    let ground = ray_below(origin.y + scene.altitude, direction.y, bend);
    var t = max(over.x, 0.0);
    if t >= under.x && t < under.y {
        t = under.y;
    }
    let hidden = ground.x < ground.y && ground.x > 0.0 && ground.x < t;
    t += 1e-4 * grid.cell;
    (*path).position = origin + t * direction + vec3f(0.0, bend * t * t, 0.0);
    (*path).direction = normalize(direction + vec3f(0.0, 2.0 * bend * t, 0.0));
    if over.x >= over.y || over.y < 0.0 || hidden {
        (*path).position = grid.low - vec3f(grid.cell);
    }
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

// A real collision: of which part of the phase function it is, and whether it takes light from the sun.
// Where that would be little, it does so now and then.
fn collide(path: ptr<function, Path>, p: vec3f, species: u32) -> u32 {
    let part = select(WIDE, PEAK, draw() < peak_share(species));
    let is_covered = !FLASH && part == PEAK && (*path).covered && species == (*path).species;
    (*path).position = p;
    (*path).origin = p;
    (*path).species = species;
    (*path).part = part;
    (*path).covered = is_covered || part == WIDE;
    (*path).collisions += 1u;
    (*path).throughput *= albedo(species);
    (*path).toward = phase_green(species, part, (*path).direction, scene.to_sun);
    let most = max((*path).throughput.x, max((*path).throughput.y, (*path).throughput.z));
    let chance = select(walk_chance((*path).toward * most, DIM), 1.0, FLASH);
    if draw() >= chance || is_covered {
        return SCATTER;
    }
    (*path).taken_weight = 1.0 / chance;
    (*path).chained = !FLASH && part == WIDE && peak_share(species) > 0.0;
    (*path).walk = next_seed();
    (*path).kept = random_state;
    (*path).other = 0u;
    (*path).mode = STRAIGHT;
    (*path).count = 0u;
    return WALK;
}

// Chooses a direction: of a walk, the first of a chain of `count` directions that ends at a point of
// the sun's disc, found backwards from there; of a path, one around it or around the sun.
fn choose_direction(path: ptr<function, Path>, next: u32) {
    let scatters = next == SCATTER;
    let state = random_state;
    let guided = scatters && !FLASH && (!(*path).covered || peak_share((*path).species) == 0.0);
    let share = select(0.0, share_around_sun(TO_SUN, MOST_TO_SUN, (*path).toward, (*path).collisions), guided);
    // All walks of a collision have the same random numbers: where one has met matter, others may.
    random_state = select(hash_random((*path).walk, 1u, scene.seed), state, scatters);
    let chance = draw();
    let azimuth = 6.2831853 * draw();
    let before = (*path).direction;
    let around_sun = scatters && chance < share;
    var to = turned(scene.to_sun, disc_angle(scene.sun_radius, select(chance, 0.0, scatters)), azimuth);
    to = select(to, before, scatters && !around_sun);
    let species = (*path).species;
    let part = select(PEAK, (*path).part, scatters);
    let turns = select((*path).count, 1u, scatters);
    var density = vec3f(1.0);
    var last = vec3f(1.0);
    for (var i = 0u; i < turns; i++) {
        let old = to;
        to = scattered(species, part, (*path).channel, old);
        last = phase(species, part, old, to);
        density = balanced(density * last);
    }
    // What a walk's light is scattered by, or the density that the other way to choose has.
    let source = select(before, scene.to_sun, scatters && !around_sun);
    let own = phase(species, (*path).part, source, to);
    if scatters {
        let scattering = select(last, own, around_sun);
        let chances = (*path).choice * mixed_density(share, scattering, select(own, last, around_sun));
        (*path).direction = to;
        (*path).throughput = spectral_weight((*path).throughput * scattering, chances);
        (*path).choice = balanced(chances);
        roulette(path);
        return;
    }
    if FLASH {
        aim_at_flash(path);
        return;
    }
    (*path).to_light = to;
    random_state = state;
    if next == WALK {
        (*path).light = (*path).taken_weight * own
            * spectral_weight((*path).throughput * density, (*path).choice * density);
        (*path).shadow = 1.0;
        (*path).position = (*path).origin;
        (*path).height = (*path).origin.y;
        random_state = hash_random((*path).walk, 0u, scene.seed);
    }
}

// Begins a walk to a point of the flash.
fn aim_at_flash(path: ptr<function, Path>) {
    random_state = hash_random((*path).walk, 2u, scene.seed);
    var point = vec4f(0.0);
    if (*path).part == PEAK {
        let d = scattered((*path).species, PEAK, (*path).channel, (*path).direction);
        point = vec4f(d, flash_distance((*path).origin, d));
        (*path).light = flash_through_peak(path, d);
    } else {
        point = flash_point((*path).origin);
        (*path).light = flash_light(path, point);
    }
    (*path).to_light = point.xyz;
    (*path).height = max(point.w, 0.0);
    (*path).shadow = select(0.0, 1.0, point.w >= 0.0);
    (*path).position = (*path).origin;
}

// Whether a walk has come as far as the flash.
fn at_flash(path: ptr<function, Path>) -> bool {
    return FLASH && distance((*path).position, (*path).origin) >= (*path).height;
}

// Russian roulette on paths that carry little. Long ones that have lost nothing go on: ending
// them with a chance above that of leaving the cloud would put all of their light, percents of
// a thick cloud's, on paths too rare to be seen.
fn roulette(path: ptr<function, Path>) {
    let survival = roulette_survival((*path).throughput, FAINT, near_sun(path));
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

// Whether the path is seen from the camera through the ground.
fn is_hidden(path: ptr<function, Path>) -> bool {
    let altitude = camera.altitude + (*path).origin.y - scene.camera.y;
    let ground = ground_ahead(sky.atmosphere, altitude, (*path).direction.y);
    return (*path).collisions == 0u && distance((*path).origin, (*path).position) > ground;
}

fn advance(path: ptr<function, Path>, index: u32) {
    let is_walk = (*path).mode != TRACK;
    let step = track((*path).position, select((*path).direction, (*path).to_light, is_walk));
    (*path).position = step.position;
    let share = select(0.0, real_share(step.matter.extinction, step.majorant), step.tentative);
    var next = select(ON, LEFT, step.outside);
    if is_walk {
        let arrived = at_flash(path);
        if step.tentative && !arrived {
            next = walk(path, step, share);
        }
        if arrived || step.outside || (*path).shadow <= 0.0 {
            next = end_walk(path);
        }
    } else if GROUND && is_hidden(path) {
        next = LEFT;
    } else if step.tentative && draw() < share {
        next = collide(path, step.position, bodies[step.matter.body].table);
    }
    if next == WALK || next == TURN || next == SCATTER {
        choose_direction(path, next);
    }
    if next == LEFT && (*path).collisions > 0u {
        (*path).gathered += (*path).throughput * sky_from((*path).direction);
    }
    if next == LEFT || all((*path).throughput <= vec3f(0.0)) {
        finish(path, index);
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
    var path = loaded(index);
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
    store(index, path);
    if path.mode != DONE {
        atomicAdd(&unfinished, 1u);
    }
}
