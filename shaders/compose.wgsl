// The finished picture for a screen: exposure, tone curve, sRGB. Transparent pixels come
// out unassociated (colour not multiplied by alpha), as PNG wants them.
// @use tonemap random

struct Compose {
    // Factor on scene light, from stops.
    exposure: f32,
    // TONE_FILMIC and so on.
    curve: u32,
    padding_x: f32,
    padding_y: f32,
}

@group(0) @binding(0) var<uniform> settings: Compose;
@group(0) @binding(1) var picture: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let light = textureLoad(picture, vec2u(position.xy), 0);
    let color = light.rgb / max(light.a, 1e-4);
    // One step of an 8-bit channel, triangular, against bands in smooth skies.
    let dither = interleaved_gradient(position.xy) + interleaved_gradient(position.yx + 47.0) - 1.0;
    return vec4f(srgb_encode(tone_curve(settings.curve, settings.exposure * color)) + dither / 255.0, light.a);
}
