// The solved moments, times what of each degree is scattered, as half floats. What cells smooth falls with the square of
// their width: a third of the difference to the field of twice the width comes on top (Richardson 1911). One thread a
// cell and light.
// @use characteristic field harmonics

// Share of the difference to the coarser field; 0 where there is none.
override BEYOND: f32 = 0.0;

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<storage, read> moments: array<array<vec4f, 4>>;
// What of degree 0 to 3 is scattered.
@group(0) @binding(2) var<uniform> degrees: vec4f;
@group(0) @binding(3) var<storage, read_write> kept: array<array<vec2u, 4>>;
@group(0) @binding(4) var<uniform> coarse: Field;
@group(0) @binding(5) var<storage, read> coarse_kept: array<array<vec2u, 4>>;

// Half floats end beyond.
const MOST: vec4f = vec4f(60000.0);

// What the coarser field has in the middle of a cell.
fn coarse_at(light: u32, cell: u32) -> array<vec4f, 4> {
    let place = field_within(field, coarse, cell);
    let low = floor(place);
    var sum = array<vec4f, 4>();
    for (var i = 0u; i < 8u; i++) {
        let at = field_held(coarse, low + vec3f(vec3u(i, i >> 1u, i >> 2u) & vec3u(1u)));
        let value = coarse_kept[light * field_cells(coarse) + field_index(coarse, at)];
        for (var j = 0u; j < 4u; j++) {
            let moments = vec4f(unpack2x16float(value[j].x), unpack2x16float(value[j].y));
            sum[j] += trilinear_weight(place - low, i) * moments;
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
    let at = id.y * count + id.x;
    let scattered = harmonics_scattered(moments[at], degrees);
    let before = coarse_at(id.y, id.x);
    let share = field_beyond(scattered[0].x, before[0].x, BEYOND);
    for (var i = 0u; i < 4u; i++) {
        let value = clamp(scattered[i] + share * (scattered[i] - before[i]), -MOST, MOST);
        kept[at][i] = vec2u(pack2x16float(value.xy), pack2x16float(value.zw));
    }
}
