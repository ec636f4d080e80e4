// Light of sky and ground that enters a cloud among others, from that which enters one alone. Layers scatter it, the same to
// all azimuths of a level of the directions; other clouds stand before some of it, return the mean of all, and shade the
// ground. One thread a direction and channel.

const LEVELS: u32 = 6u;
const DIRECTIONS: u32 = 48u;
const PLACES: u32 = DIRECTIONS / LEVELS;

struct Around {
    // By level of the direction that light goes to, what of the mean over the azimuth of each level is scattered to it.
    rows: array<vec4f, 2u * LEVELS>,
    // What comes straight through, by level, and the share of all directions that each of a level stands for.
    through: array<vec4f, 2>,
    weights: array<vec4f, 2>,
    // By direction: what is seen between other clouds, what of the mean they return, and what of the sun's light on the
    // ground they take.
    open: array<vec4f, DIRECTIONS / 4u>,
    returned: array<vec4f, DIRECTIONS / 4u>,
    shaded: array<vec4f, DIRECTIONS / 4u>,
}

@group(0) @binding(0) var<uniform> around: Around;
// Radiance by channel and direction, levels one after another; then, of the same, what is the sun's on the ground.
@group(0) @binding(1) var<storage, read> outside: array<f32>;
@group(0) @binding(2) var<storage, read_write> entering: array<f32>;

// What comes along a direction with the ground shaded.
fn outside_along(i: u32, first: u32, channels: u32) -> f32 {
    return outside[first + i] - around.shaded[i / 4u][i % 4u] * outside[DIRECTIONS * channels + first + i];
}

@compute @workgroup_size(16)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let direction = id.x;
    let first = id.y * DIRECTIONS;
    let level = direction / PLACES;
    var light = around.through[level / 4u][level % 4u] * outside_along(direction, first, groups.y);
    var mean = 0.0;
    for (var i = 0u; i < DIRECTIONS; i++) {
        let other = i / PLACES;
        let along = outside_along(i, first, groups.y);
        light += around.rows[2u * level + other / 4u][other % 4u] * along / f32(PLACES);
        mean += around.weights[other / 4u][other % 4u] * along;
    }
    let open = around.open[direction / 4u][direction % 4u];
    entering[first + direction] = open * light + around.returned[direction / 4u][direction % 4u] * mean;
}
