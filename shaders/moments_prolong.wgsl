// From a coarse field to a fine one: the moments of the coarse one, times a share, are added to those of the fine one,
// which then scatter, together with the light that is given. One thread a cell and light of the fine one.
// @use characteristic field harmonics

// How much of the coarse field counts.
override SHARE: f32 = 1.0;

@group(0) @binding(0) var<uniform> field: Field;
// Moments of what is scattered of the light that is given, by light and cell.
@group(0) @binding(1) var<storage, read> given: array<array<vec4f, 4>>;
// Unit vectors of propagation, and their weights, which add up to 4 pi.
@group(0) @binding(2) var<storage, read> directions: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> moments: array<array<vec4f, 4>>;
@group(0) @binding(4) var<storage, read_write> source: array<f32>;
@group(0) @binding(5) var<uniform> coarse: Field;
@group(0) @binding(6) var<storage, read> coarse_moments: array<array<vec4f, 4>>;

// Between the cells of the coarse field.
fn interpolated(light: u32, cell: u32) -> array<vec4f, 4> {
    let place = field_within(field, coarse, cell);
    let low = floor(place);
    let part = place - low;
    var sum = array<vec4f, 4>();
    for (var i = 0u; i < 8u; i++) {
        let side = vec3f(vec3u(i, i >> 1u, i >> 2u) & vec3u(1u));
        let at = field_held(coarse, low + side);
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
    let at = id.y * count + id.x;
    var all = interpolated(id.y, id.x);
    for (var i = 0u; i < 4u; i++) {
        all[i] = moments[at][i] + SHARE * all[i];
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
