// What the cells of a field that repeats itself scatter, for all directions: copies of a cell are seen from
// everywhere. Of the sun all its moments, four pictures of four; of red, green and blue those of degree 0 and 1, a picture
// each, as `field_tile_place` reads them. One thread a cell.
// @use field

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<storage, read> kept: array<array<vec2u, 4>>;
@group(0) @binding(2) var result: texture_storage_3d<rgba16float, write>;

// Whether it is one light, the sun's, or red, green and blue.
override SUN: bool = true;

fn picture(number: u32, cell: u32) -> vec4f {
    let light = select(number, 0u, SUN);
    let four = select(0u, number, SUN);
    let packed = kept[light * field_cells(field) + cell][four];
    return vec4f(unpack2x16float(packed.x), unpack2x16float(packed.y));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= field_cells(field) {
        return;
    }
    let place = vec3i(field_place(field, id.x));
    let size = vec3i(field.size);
    let texels = vec3i(textureDimensions(result));
    for (var number = 0; number < texels.y / size.y; number++) {
        let value = picture(u32(number), id.x);
        // The cell itself and its likes around the box.
        for (var i = 0; i < 9; i++) {
            let away = vec3i(i % 3 - 1, 0, i / 3 - 1);
            let at = place + away * size + vec3i(1, number * size.y, 1);
            if all(at >= vec3i(0)) && all(at < texels) {
                textureStore(result, at, value);
            }
        }
    }
}
