// The solved moments, times what of each degree is scattered, as half floats. One thread a cell and light.
// @use field harmonics

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<storage, read> moments: array<array<vec4f, 4>>;
// What of degree 0 to 3 is scattered.
@group(0) @binding(2) var<uniform> degrees: vec4f;
@group(0) @binding(3) var<storage, read_write> kept: array<array<vec2u, 4>>;

// Half floats end beyond.
const MOST: vec4f = vec4f(60000.0);

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let count = field_cells(field);
    if id.x >= count {
        return;
    }
    let at = id.y * count + id.x;
    let scattered = harmonics_scattered(moments[at], degrees);
    for (var i = 0u; i < 4u; i++) {
        let value = clamp(scattered[i], -MOST, MOST);
        kept[at][i] = vec2u(pack2x16float(value.xy), pack2x16float(value.zw));
    }
}
