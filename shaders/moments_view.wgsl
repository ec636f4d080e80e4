// The light that the cells of a field scatter towards the eye, from its moments: of the sun, also how it
// changes with the direction, since rays through one cell have not all the same. One thread a cell.
// @use field field_view harmonics

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<uniform> eye: vec4f;
@group(0) @binding(2) var<storage, read> kept: array<array<vec2u, 4>>;
@group(0) @binding(3) var result: texture_storage_3d<rgba16float, write>;

// Whether it is one light, the sun's, or red, green and blue.
override SUN: bool = true;

fn moments_at(light: u32, cell: u32) -> array<vec4f, 4> {
    let packed = kept[light * field_cells(field) + cell];
    var all = array<vec4f, 4>();
    for (var i = 0u; i < 4u; i++) {
        all[i] = vec4f(unpack2x16float(packed[i].x), unpack2x16float(packed[i].y));
    }
    return all;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= field_cells(field) {
        return;
    }
    let view = field_view(field, eye, id.x);
    var light = vec4f(0.0);
    if SUN {
        light = view_expansion(moments_at(0u, id.x), view);
    } else {
        for (var i = 0u; i < 3u; i++) {
            light[i] = view_light(moments_at(i, id.x), view);
        }
    }
    textureStore(result, field_place(field, id.x), light);
}
