// Short characteristics (Kunasz and Auer 1988): light from plane to plane of a field, along one
// direction, with a source that is linear between planes.
// @use attenuation

// The axis along which a direction crosses cells the fastest, given how many it crosses per metre.
fn sweep_axis(rates: vec3f) -> u32 {
    let a = select(0u, 1u, abs(rates.y) > abs(rates.x));
    return select(a, 2u, abs(rates.z) > abs(rates[a]));
}

// Weights of the corners of a square or cube, of which bit 0 of `corner` tells the side along x, and so
// on, at a place in it, from 0 to 1.
fn bilinear_weight(part: vec2f, corner: u32) -> f32 {
    let weights = mix(1.0 - part, part, vec2f(vec2u(corner, corner >> 1u) & vec2u(1u)));
    return weights.x * weights.y;
}

fn trilinear_weight(part: vec3f, corner: u32) -> f32 {
    let weights = mix(1.0 - part, part, vec3f(vec3u(corner, corner >> 1u, corner >> 2u) & vec3u(1u)));
    return weights.x * weights.y * weights.z;
}

// What lies upwind of a point: radiance, extinction, 1/m, and source per unit of extinction.
struct Upwind {
    radiance: f32,
    extinction: f32,
    source: f32,
}

// Radiance at a point with this extinction and source, `length` metres downwind.
fn short_characteristic(up: Upwind, extinction: f32, source: f32, length: f32) -> f32 {
    let depth = length * (0.5 * (extinction + up.extinction));
    let through = exp(-depth);
    let mean = mean_through(depth);
    return up.radiance * through + source * (1.0 - mean) + up.source * (mean - through);
}
