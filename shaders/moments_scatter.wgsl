// One round of scattering: the moments of the radiance in a cell, how much they changed, and the
// source that they make towards each direction together with the light that is given. One thread a
// cell and light.
// @use field harmonics

@group(0) @binding(0) var<uniform> field: Field;
// Moments of what is scattered of the light that is given, by light and cell.
@group(0) @binding(1) var<storage, read> given: array<array<vec4f, 4>>;
// Unit vectors of propagation, and their weights, which add up to 4 pi.
@group(0) @binding(2) var<storage, read> directions: array<vec4f>;
@group(0) @binding(3) var<storage, read> radiance: array<f32>;
@group(0) @binding(4) var<storage, read_write> moments: array<array<vec4f, 4>>;
@group(0) @binding(5) var<storage, read_write> source: array<f32>;
@group(0) @binding(6) var<storage, read_write> change: array<array<vec4f, 4>>;
// How far to go from the last moments to those that the sweep gave, and beyond.
@group(0) @binding(7) var<uniform> relaxation: f32;

fn gathered(first: u32, cell: u32) -> array<vec4f, 4> {
    var sum = array<vec4f, 4>();
    for (var i = 0u; i < field.directions; i++) {
        let d = directions[i];
        let light = d.w * radiance[first + i * field_cells(field) + cell];
        sum = harmonics_with(sum, light, d.xyz);
    }
    return sum;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let count = field_cells(field);
    if id.x >= count {
        return;
    }
    let first = id.y * field.directions * count;
    let at = id.y * count + id.x;
    let last = moments[at];
    let found = gathered(first, id.x);
    var all = array<vec4f, 4>();
    for (var i = 0u; i < 4u; i++) {
        let difference = relaxation * (found[i] - last[i]);
        change[at][i] = difference;
        all[i] = last[i] + difference;
    }
    moments[at] = all;
    all = harmonics_scattered(all, field.scattering);
    for (var i = 0u; i < 4u; i++) {
        all[i] += given[at][i];
    }
    for (var i = 0u; i < field.directions; i++) {
        source[first + i * count + id.x] = harmonics_sum(all, directions[i].xyz);
    }
}
