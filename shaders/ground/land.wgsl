// Fields and woods: a pattern of what they reflect over its mean, near by and eight times as large across it, so that
// one square does not look like the next.
// @use ground

@group(1) @binding(0) var<uniform> ground: Ground;
// From layer to layer twice as smooth. Layers, not levels of detail: a level is one for four pixels, and on some drivers
// that of a pixel which is not drawn.
@group(1) @binding(1) var pattern: texture_3d<f32>;
@group(1) @binding(2) var repeating: sampler;

const LARGER: f32 = 8.0;
// What 1 in the texture stands for.
const PATTERN_SCALE: f32 = 4.0;

// Radiance beyond that of even ground.
fn ground_more(a: Atmosphere, at: GroundPoint) -> vec3f {
    let place = ground.offset + at.pixel.place;
    let taps = ground_samples(at, PATTERN_TAPS);
    let fine = pattern_mean(place, at.pixel.right, at.pixel.down, ground.edge, taps);
    let coarse = pattern_mean(place.yx, at.pixel.right.yx, at.pixel.down.yx, LARGER * ground.edge, taps);
    // Half of it: woods 60 km wide are rare.
    let more = ground.variation * (fine * mix(vec3f(1.0), coarse, 0.5) - 1.0);
    return ground_diffuse(more * a.ground_albedo, at) * at.transmittance;
}

// Mean of the pattern, `edge` metres wide, over what a pixel sees: `taps` along the longer way, smoothed as the shorter asks.
fn pattern_mean(place: vec2f, right: vec2f, down: vec2f, edge: f32, taps: u32) -> vec3f {
    let view = pattern_view(right / edge, down / edge, vec3f(textureDimensions(pattern)));
    var sum = vec3f(0.0);
    for (var tap = 0u; tap < taps; tap++) {
        let along = (f32(tap) + 0.5) / f32(PATTERN_TAPS) - 0.5;
        let uv = place / edge + along * view.along;
        sum += textureSampleLevel(pattern, repeating, vec3f(uv, view.layer), 0.0).rgb;
    }
    return mix(vec3f(1.0), PATTERN_SCALE / f32(PATTERN_TAPS) * sum, view.known);
}
