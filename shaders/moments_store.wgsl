// The solved moments of degree 0 and 1, times those of the phase function, as a texture: the
// fields of the lights stacked along z. One thread a cell and light.
// @use field

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<storage, read> moments: array<array<vec4f, 4>>;
// Moments of the phase function, degree 0 to 3.
@group(0) @binding(2) var<uniform> degrees: vec4f;
@group(0) @binding(3) var result: texture_storage_3d<rgba16float, write>;

// Half floats end beyond.
const MOST: vec4f = vec4f(60000.0);

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let count = field_cells(field);
    if id.x >= count {
        return;
    }
    let value = degrees.xyyy * moments[id.y * count + id.x][0];
    let at = field_place(field, id.x) + vec3u(0u, 0u, id.y * field.size.z);
    textureStore(result, at, clamp(value, -MOST, MOST));
}
