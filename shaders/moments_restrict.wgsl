// From a fine field to a coarse one: the change of the fine one's moments becomes the light that is given
// in the coarse one, where it is weighted by the extinction that scatters it, and nothing else is there yet.
// One thread a cell and light of the coarse one.
// @use field harmonics

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<storage, read_write> given: array<array<vec4f, 4>>;
// Unit vectors of propagation, and their weights, which add up to 4 pi.
@group(0) @binding(2) var<storage, read> directions: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> moments: array<array<vec4f, 4>>;
@group(0) @binding(4) var<storage, read_write> source: array<f32>;
@group(0) @binding(5) var<uniform> fine: Field;
@group(0) @binding(6) var<storage, read> fine_change: array<array<vec4f, 4>>;
@group(0) @binding(7) var<storage, read> fine_cells: array<f32>;

// The mean over eight points of a cell.
fn averaged(light: u32, cell: u32) -> array<vec4f, 4> {
    var sum = array<vec4f, 4>();
    var weight = 0.0;
    for (var i = 0u; i < 8u; i++) {
        let inside = (field_sample(field, cell, i) - field.low) / field.cell / vec3f(field.size);
        let at = field_index(fine, min(vec3u(inside * vec3f(fine.size)), fine.size - 1u));
        let value = fine_change[light * field_cells(fine) + at];
        // Where nothing scatters, all count alike.
        let share = max(fine_cells[at], 1e-9);
        for (var j = 0u; j < 4u; j++) {
            sum[j] += share * value[j];
        }
        weight += share;
    }
    for (var j = 0u; j < 4u; j++) {
        sum[j] /= weight;
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
    let all = harmonics_scattered(averaged(id.y, id.x), field.scattering);
    given[at] = all;
    moments[at] = array<vec4f, 4>();
    for (var i = 0u; i < field.directions; i++) {
        source[first + i * count + id.x] = harmonics_sum(all, directions[i].xyz);
    }
}
