// A picture of the ground from above: what it reflects. Around it the ground is even.
// @use ground

@group(1) @binding(0) var<uniform> ground: Ground;
// In layers as the pattern of land.
@group(1) @binding(1) var colors: texture_3d<f32>;
@group(1) @binding(2) var clamped: sampler;

// Radiance beyond that of even ground.
fn ground_more(a: Atmosphere, at: GroundPoint) -> vec3f {
    let place = ground.offset + at.pixel.place;
    let size = vec3f(textureDimensions(colors));
    let view = pattern_view(at.pixel.right / ground.edge, at.pixel.down / ground.edge, size);
    let whole = vec2f(ground.edge, ground.height);
    var more = vec3f(0.0);
    let taps = ground_samples(at, PATTERN_TAPS);
    for (var tap = 0u; tap < taps; tap++) {
        let along = (f32(tap) + 0.5) / f32(PATTERN_TAPS) - 0.5;
        let uv = (place + along * ground.edge * view.along) / whole;
        let color = textureSampleLevel(colors, clamped, vec3f(uv, view.layer), 0.0).rgb;
        more += select(vec3f(0.0), color - a.ground_albedo, all(uv > vec2f(0.0)) && all(uv < vec2f(1.0)));
    }
    return ground_diffuse(more / f32(PATTERN_TAPS), at) * at.transmittance;
}
