// Light of sky and ground that enters a cloud between layers, from that which enters one without any: by level of the
// directions, of which all azimuths have the same of what is scattered. One thread a direction and channel.

const LEVELS: u32 = 6u;

struct Between {
    // By level of the direction that light goes to, what of the mean over the azimuth of each level is scattered to it.
    rows: array<vec4f, 2u * LEVELS>,
    // What comes straight through, by level.
    through: array<vec4f, 2>,
}

@group(0) @binding(0) var<uniform> between: Between;
// Radiance by channel and direction, levels one after another.
@group(0) @binding(1) var<storage, read> outside: array<f32>;
@group(0) @binding(2) var<storage, read_write> entering: array<f32>;

@compute @workgroup_size(16)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let directions = 16u * groups.x;
    let places = directions / LEVELS;
    let first = id.y * directions;
    let level = id.x / places;
    var light = between.through[level / 4u][level % 4u] * outside[first + id.x];
    for (var i = 0u; i < directions; i++) {
        let other = i / places;
        light += between.rows[2u * level + other / 4u][other % 4u] * outside[first + i] / f32(places);
    }
    entering[first + id.x] = light;
}
