// Table of the transmittance to the top of the atmosphere.
// @use atmosphere

@group(0) @binding(0) var<uniform> sky: Sky;
@group(0) @binding(1) var result: texture_storage_2d<rgba16float, write>;

const STEPS: u32 = 48u;

@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2f(textureDimensions(result));
    let point = transmittance_point(sky.atmosphere, size, (vec2f(id.xy) + 0.5) / size);
    let value = transmittance_to_top(sky.atmosphere, point.x, point.y, STEPS);
    textureStore(result, id.xy, vec4f(value, 1.0));
}
