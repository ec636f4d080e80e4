// The solved moments, times those of the phase function, as a texture: fields stacked along
// z, all degrees of the sun's light, or degree 0 and 1 of each light of the sky.
// One thread a cell and block.
// @use field

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<storage, read> moments: array<array<vec4f, 4>>;
// Moments of the phase function, degree 0 to 3.
@group(0) @binding(2) var<uniform> degrees: vec4f;
@group(0) @binding(3) var result: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let count = field_cells(field);
    if id.x >= count {
        return;
    }
    let is_sun = field.lights == 1u;
    let four = select(0u, id.y, is_sun);
    let light = select(id.y, 0u, is_sun);
    let weights = array<vec4f, 4>(degrees.xyyy, degrees.zzzz, degrees.zwww, degrees.wwww);
    let value = weights[four] * moments[light * count + id.x][four];
    let at = field_place(field, id.x) + vec3u(0u, 0u, id.y * field.size.z);
    textureStore(result, at, clamp(value, vec4f(-60000.0), vec4f(60000.0)));
}
