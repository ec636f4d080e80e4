// Directions evenly over a sphere: circles of latitude times places on half a circle, the other half
// being alike.
// @use constants

// The middle of the `i`th of `count` equal parts of the way from 0 to 1.
fn middle_of(i: u32, count: u32) -> f32 {
    return (f32(i) + 0.5) / f32(count);
}

// Sine of half the azimuth of the `i`th of `count` places on half a circle.
fn half_circle_sine(i: u32, count: u32) -> f32 {
    return sin(0.5 * PI * (f32(i) + 0.5) / f32(count));
}

// Cosine to the zenith at a share of the way over a hemisphere whose mean is weighted by that cosine.
fn weighted_cosine(share: f32) -> f32 {
    return sqrt(share);
}

// Irradiance by a hemisphere, from the sum of `count` radiances so weighted.
fn hemisphere_irradiance(sum: vec3f, count: u32) -> vec3f {
    return PI * sum / f32(count);
}

// Radiance of matt ground, per unit of `irradiance` (Lambert).
fn matt_radiance(albedo: vec3f, irradiance: vec3f) -> vec3f {
    return albedo / PI * irradiance;
}

// Source of light of this `irradiance` that is scattered evenly in all directions.
fn even_source(irradiance: vec3f, scattering: vec3f) -> vec3f {
    return INV_4PI * irradiance * scattering;
}

// The direction with this sine of elevation, at this azimuth from the x axis, rad.
fn direction_at(mu: f32, azimuth: f32) -> vec3f {
    let around = sqrt(max(1.0 - mu * mu, 0.0));
    return vec3f(around * cos(azimuth), mu, around * sin(azimuth));
}
