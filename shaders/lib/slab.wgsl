// Multiple scattering in a plane-parallel slab from a table of source moments, made by
// `nephos tables slab`; src/optics/slab/moments.rs tells what its numbers are. Depths are
// optical, along the inward normal, in the medium without its forward peak.
// @use constants

// Sets of orders of scattering: 2, 3, 4, 5-6, 7-9, 10-15, 16 and more.
const SLAB_SETS: u32 = 7u;
// Least and greatest thickness of the table, its lowest sun, and the depth from a face over
// which light changes.
const SLAB_THINNEST: f32 = 0.05;
const SLAB_THICKEST: f32 = 400.0;
const SLAB_LOWEST_SUN: f32 = 0.017452406;
const SLAB_FACE: f32 = 0.25;

// Coordinates of the table, from 0 to 1: even in the logarithm of the thickness, dense at
// both faces, dense where the sun is low.
fn slab_thickness_coordinate(thickness: f32) -> f32 {
    return saturate(log(thickness / SLAB_THINNEST) / log(SLAB_THICKEST / SLAB_THINNEST));
}

// 0.5 + 0.5 (ln(1 + x/F) - ln(1 + (t - x)/F)) / ln(1 + t/F), its differences taken together.
fn slab_depth_coordinate(depth: f32, thickness: f32) -> f32 {
    let x = clamp(depth, 0.0, thickness);
    let near = slab_ln_1p(x / SLAB_FACE) + slab_ln_1p(x / (SLAB_FACE + thickness - x));
    return 0.5 * near / slab_ln_1p(thickness / SLAB_FACE);
}

// ln(1 + x), x >= 0: 2 artanh(x / (2 + x)) by its series where the sum 1 + x loses digits.
fn slab_ln_1p(x: f32) -> f32 {
    let s = x / (2.0 + x);
    let z = s * s;
    return select(log(1.0 + x), 2.0 * s * (1.0 + z * (1.0 / 3.0 + z * (1.0 / 5.0 + z / 7.0))), x < 0.25);
}

fn slab_sun_coordinate(mu0: f32) -> f32 {
    return sqrt(saturate((mu0 - SLAB_LOWEST_SUN) / (1.0 - SLAB_LOWEST_SUN)));
}

// Source of a set of orders, 1/sr per unit of irradiance across the beam, without the
// remainder of small angles: towards cosine `mu` to the inward normal, `x` being the product
// of the parts of view and sun across it. `degrees` weighs the moments of degree 0 to 3, for
// phase functions other than the table's.
fn slab_source(table: texture_3d<f32>, linear: sampler, orders: u32, thickness: f32, depth: f32,
    mu0: f32, mu: f32, x: f32, degrees: vec4f) -> f32 {
    let size = vec3f(textureDimensions(table));
    let layers = size.z / f32(2u * SLAB_SETS);
    let held = clamp(thickness, SLAB_THINNEST, SLAB_THICKEST);
    let inside = depth * held / max(thickness, 1e-6);
    let at = vec3f(slab_sun_coordinate(mu0), slab_depth_coordinate(inside, held), slab_thickness_coordinate(held));
    let texel = 0.5 + at * (vec3f(size.xy, layers) - 1.0);
    let low = textureSampleLevel(table, linear, vec3f(texel.xy, texel.z + f32(2u * orders) * layers) / size, 0.0);
    let high = textureSampleLevel(table, linear, vec3f(texel.xy, texel.z + f32(2u * orders + 1u) * layers) / size, 0.0);
    let across = (1.0 - mu * mu) * (1.0 - mu0 * mu0);
    let even = degrees.xyyz * vec4f(1.0, mu, x, 1.5 * mu * mu - 0.5);
    let odd = degrees.zzww * vec4f(mu * x, 2.0 * x * x - across, mu * (2.5 * mu * mu - 1.5), x * (5.0 * mu * mu - 1.0));
    return mu0 * (dot(low, even) + dot(high, odd));
}

// Coordinate of an optical depth along the sun's direction in the table of the remainder.
fn slab_path_coordinate(path: f32) -> f32 {
    return path / (path + 4.0);
}

// Spread of the places where the light of a set entered, about their mean, as an optical
// depth: [K 3.54] fitted to random walks, src/optics/slab/spread.rs.
fn slab_spread(orders: u32, thickness: f32, depth: f32) -> f32 {
    if orders == SLAB_SETS - 1u {
        let near = log(1.0 + 0.4364 * depth);
        let far = log(1.0 + 0.3342 * thickness);
        return 4.8646 + 0.020916 * thickness * near * near + 1.5883 * far * far;
    }
    var low = array<vec3f, 6>(vec3f(0.5691, 0.005954, 73.60), vec3f(0.7382, 0.009261, 131.7),
        vec3f(0.8636, 0.015145, 136.5), vec3f(1.2356, 0.02197, 76.46), vec3f(2.2691, 0.03467, 7.664),
        vec3f(3.6535, 0.04602, 3.016));
    let s = low[orders];
    let deep = log(1.0 + s.z * depth);
    return s.x + s.y * deep * deep;
}
