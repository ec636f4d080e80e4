// One round of scattering: the moments of the radiance in a cell, and the source that they
// make towards each direction. The first round takes the moments of a coarser field instead.
// One thread a cell and light.
// @use characteristic field harmonics

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<storage, read> cells: array<FieldCell>;
// Unit vectors of propagation, and their weights, which add up to 4 pi.
@group(0) @binding(2) var<storage, read> directions: array<vec4f>;
@group(0) @binding(3) var<storage, read> radiance: array<f32>;
// Moments of the radiance, four times four by light and cell.
@group(0) @binding(4) var<storage, read_write> moments: array<array<vec4f, 4>>;
@group(0) @binding(5) var<storage, read_write> source: array<f32>;
@group(0) @binding(6) var<uniform> coarse: Field;
@group(0) @binding(7) var<storage, read> coarse_moments: array<array<vec4f, 4>>;
// How far to go from the last moments to those that the sweep gave, and beyond.
@group(0) @binding(8) var<uniform> relaxation: f32;

override FIRST: bool = false;

fn gathered(first: u32, cell: u32) -> array<vec4f, 4> {
    var sum = array<vec4f, 4>();
    for (var i = 0u; i < field.directions; i++) {
        let d = directions[i];
        let light = d.w * radiance[first + i * field_cells(field) + cell];
        sum = harmonics_with(sum, light, d.xyz);
    }
    return sum;
}

// Between the cells of the coarser field.
fn interpolated(light: u32, cell: u32) -> array<vec4f, 4> {
    let place = field_within(field, coarse, cell);
    let low = floor(place);
    let part = place - low;
    var sum = array<vec4f, 4>();
    for (var i = 0u; i < 8u; i++) {
        let side = vec3f(vec3u(i, i >> 1u, i >> 2u) & vec3u(1u));
        let at = vec3u(clamp(low + side, vec3f(0.0), vec3f(coarse.size) - 1.0));
        let value = coarse_moments[light * field_cells(coarse) + field_index(coarse, at)];
        for (var j = 0u; j < 4u; j++) {
            sum[j] += trilinear_weight(part, i) * value[j];
        }
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
    var all: array<vec4f, 4>;
    if FIRST {
        all = interpolated(id.y, id.x);
    } else {
        let last = moments[id.y * count + id.x];
        all = gathered(first, id.x);
        for (var i = 0u; i < 4u; i++) {
            all[i] = last[i] + relaxation * (all[i] - last[i]);
        }
    }
    moments[id.y * count + id.x] = all;
    let beam = field.beam.w * cells[id.x].beam;
    all = harmonics_scattered(harmonics_with(all, beam, field.beam.xyz), field.scattering);
    for (var i = 0u; i < field.directions; i++) {
        source[first + i * count + id.x] = harmonics_sum(all, directions[i].xyz);
    }
}
