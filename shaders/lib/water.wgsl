// Light that a sea under wind mirrors: facets whose slopes are normally distributed, after Cox and Munk, "Measurement of
// the roughness of the sea surface from photographs of the sun's glitter", J. Opt. Soc. Am. 44, 1954. Directions are unit
// vectors away from the surface, y up; `variance` is that of the slopes along both axes together.
// @use constants

// Refractive index of sea water.
const WATER_INDEX: f32 = 1.34;
// Facets that stand for all slopes: 3 by 3 of Gauss and Hermite.
const FACETS: u32 = 9u;

struct Facet {
    // Its normal, y up.
    normal: vec3f,
    // The share of what is seen from a direction that facets of this slope are, times an unknown that all share.
    seen: f32,
}

// Share of unpolarised light that water reflects where it falls on it at this cosine of the angle from the normal (Fresnel).
fn water_fresnel(cosine: f32) -> f32 {
    let c = saturate(cosine);
    let g = sqrt(WATER_INDEX * WATER_INDEX - 1.0 + c * c);
    let across = (g - c) / (g + c);
    let along = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * across * across * (1.0 + along * along);
}

// Facets that hide a facet from a direction of cosine `mu` from the zenith, for each that does not: Smith's for normal
// slopes, as Walter and others fit it, "Microfacet models for refraction", EGSR 2007.
fn water_hidden(mu: f32, variance: f32) -> f32 {
    let c = clamp(mu, 1e-4, 1.0);
    let a = c / sqrt(max(variance * (1.0 - c * c), 1e-12));
    let fit = (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a);
    return select(0.0, max(fit, 0.0), a < 1.6);
}

// Radiance of the sun's glitter, for an irradiance of 1 across the sunlight.
fn water_glitter(to_eye: vec3f, to_sun: vec3f, variance: f32) -> f32 {
    // The facet's normal is between them, and the angle to it half of that between them.
    let sum = to_eye + to_sun;
    let slope = dot(sum.xz, sum.xz) / max(sum.y * sum.y, 1e-12);
    let slopes = exp(-slope / variance) * (1.0 + slope) * (1.0 + slope) / (PI * variance);
    let seen = 1.0 / (1.0 + water_hidden(to_eye.y, variance) + water_hidden(to_sun.y, variance));
    let light = water_fresnel(0.5 * length(sum)) * slopes * seen / (4.0 * max(to_eye.y, 1e-4));
    return select(0.0, light, to_sun.y > 0.0 && to_eye.y > 0.0);
}

// One of the facets, as seen from `to_eye`.
fn water_facet(number: u32, to_eye: vec3f, variance: f32) -> Facet {
    let place = vec2f(f32(number % 3u), f32(number / 3u)) - 1.0;
    let slope = sqrt(1.5 * variance) * place;
    let weights = select(vec2f(4.0), vec2f(1.0), place != vec2f(0.0)) / 6.0;
    let across = vec3f(-slope.x, 1.0, -slope.y);
    return Facet(normalize(across), weights.x * weights.y * max(dot(across, to_eye), 0.0));
}

// The direction that a facet mirrors to `to_eye`; what would come from below comes from as much above, mirrored again.
fn water_mirrored(normal: vec3f, to_eye: vec3f) -> vec3f {
    let sky = 2.0 * dot(normal, to_eye) * normal - to_eye;
    return vec3f(sky.x, abs(sky.y), sky.z);
}
