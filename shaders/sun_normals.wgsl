// Normals of the lit surface from the map of its depth, noise and all, in the cloud's
// frame: the slopes towards the neighbours that are covered. Multiplied by coverage.
// @use light_box

@group(0) @binding(0) var<uniform> box: LightBox;
@group(0) @binding(1) var depths: texture_2d<f32>;
@group(0) @binding(2) var normals: texture_storage_2d<rgba16float, write>;

fn surface_at(texel: vec2i) -> Surface {
    let last = vec2i(textureDimensions(depths)) - 1;
    let map = textureLoad(depths, clamp(texel, vec2i(0), last), 0);
    return Surface(box.length * map.x / max(map.w, 1e-4), map.w);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(depths);
    if any(id.xy >= size) {
        return;
    }
    let texel = vec2i(id.xy);
    let here = surface_at(texel);
    let texel_u = length(box.edge_u) / f32(size.x);
    let texel_v = length(box.edge_v) / f32(size.y);
    let slope_u = covered_slope(surface_at(texel - vec2i(1, 0)), here, surface_at(texel + vec2i(1, 0)), texel_u);
    let slope_v = covered_slope(surface_at(texel - vec2i(0, 1)), here, surface_at(texel + vec2i(0, 1)), texel_v);
    let normal = light_box_normal(box, slope_u, slope_v);
    textureStore(normals, id.xy, vec4f(here.coverage * normal, here.coverage));
}
