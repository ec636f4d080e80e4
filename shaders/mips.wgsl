// One mip level of a map from the level before: the mean of four texels.

@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var destination: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(destination)) {
        return;
    }
    let corner = 2u * id.xy;
    let last = textureDimensions(source) - 1u;
    var sum = vec4f(0.0);
    for (var i = 0u; i < 4u; i++) {
        sum += textureLoad(source, min(corner + vec2u(i & 1u, i >> 1u), last), 0);
    }
    textureStore(destination, id.xy, 0.25 * sum);
}
