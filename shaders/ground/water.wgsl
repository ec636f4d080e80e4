// A sea under wind: it mirrors the sky, glitters before the sun, and gives back a little light from below. Of clouds it
// mirrors the mean light, not their shapes.
// @use ground water

@group(1) @binding(0) var<uniform> ground: Ground;
// The sky as it is seen from the water.
@group(1) @binding(1) var low_sky: texture_2d<f32>;
@group(1) @binding(2) var clamped: sampler;

// Share of daylight that a sea mirrors: 0.068 of an even sky's and 0.02 to 0.06 of a sun's 30 degrees high and more
// (Fresnel). The rest of the albedo is light from below.
const SURFACE_ALBEDO: f32 = 0.05;

// Radiance beyond that of even ground.
fn ground_more(a: Atmosphere, at: GroundPoint) -> vec3f {
    let below = max(a.ground_albedo - SURFACE_ALBEDO, vec3f(0.0));
    var light = ground_diffuse(below - a.ground_albedo, at) + mirrored_sky(a, at);
    light += at.sun * water_glitter(at.to_eye, at.to_sun, ground.slope_variance);
    return light * at.transmittance;
}

fn mirrored_sky(a: Atmosphere, at: GroundPoint) -> vec3f {
    let size = vec2f(textureDimensions(low_sky));
    var light = vec3f(0.0);
    var seen = 0.0;
    let count = ground_samples(at, FACETS);
    for (var i = 0u; i < count; i++) {
        let facet = water_facet(i, at.to_eye, ground.slope_variance);
        let origin = water_mirrored(facet.normal, at.to_eye);
        let uv = sky_view_uv(a, size, 0.0, origin.y, half_azimuth_sine(origin, at.to_sun), false);
        let sky = textureSampleLevel(low_sky, clamped, uv, 0.0).rgb / TABLE_SCALE;
        light += facet.seen * water_fresnel(dot(facet.normal, at.to_eye)) * (at.open * sky + at.clouds);
        seen += facet.seen;
    }
    return light / max(seen, 1e-6);
}
