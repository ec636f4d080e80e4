// A point of the ground that a ray meets, what a pixel sees around it, and the light there.
// @use atmosphere

// What a kind of ground is like.
struct Ground {
    // The camera's place in the pattern or picture, from its north-western corner to the east and south, m.
    offset: vec2f,
    // Edge of a square of the pattern, or width of the picture, m.
    edge: f32,
    // How much of the pattern shows, from 0 to 1.
    variation: f32,
    // Of the slopes of water.
    slope_variance: f32,
    // From the northern to the southern edge of a picture, m.
    height: f32,
}

// What a pixel sees of the ground.
struct GroundPixel {
    // Share of the pixel that it is: where that is 0, loops over samples may end at once.
    seen: f32,
    // Place from the camera, east and south, m.
    place: vec2f,
    // How far from it the pixels to the right and below meet the ground, m.
    right: vec2f,
    down: vec2f,
}

struct GroundPoint {
    pixel: GroundPixel,
    // To the eye and to the sun, y up there.
    to_eye: vec3f,
    to_sun: vec3f,
    // Irradiance of the sun's own light across it, clouds before it included; and by all light, on level ground.
    sun: vec3f,
    irradiance: vec3f,
    // Share of the sky that clouds do not hide, and the mean radiance of those that do, times their share.
    open: f32,
    clouds: vec3f,
    // Through the air to the eye.
    transmittance: vec3f,
}

// A direction with the cosine `mu` from the zenith and the azimuth of `d`.
fn with_cosine(d: vec3f, mu: f32) -> vec3f {
    let level = d.xz / max(length(d.xz), 1e-6);
    let sine = sqrt(max(1.0 - mu * mu, 0.0));
    return vec3f(sine * level.x, mu, sine * level.y);
}

// Where a ray in this direction meets the ground, `to_ground` metres away; `lit` are the shares of the sun's light that
// clouds let through to it, its own and scattered, and that of the sky that they do not hide.
fn ground_point(
    a: Atmosphere, transmittance: texture_2d<f32>, ground_table: texture_2d<f32>, linear_sampler: sampler,
    pixel: GroundPixel, ray: AirRay, direction: vec3f, to_sun: vec3f, to_ground: f32, lit: vec3f,
) -> GroundPoint {
    let foot = air_ray_at(a, ray, to_ground);
    let sun = sun_irradiance_at(a, transmittance, linear_sampler, 0.0, foot.mu_sun);
    let all = ground_irradiance(ground_table, linear_sampler, foot.mu_sun);
    let level = max(foot.mu_sun, 0.0) * sun;
    return GroundPoint(
        pixel,
        with_cosine(-direction, -foot.mu),
        with_cosine(to_sun, foot.mu_sun),
        lit.x * sun,
        max(all - (1.0 - lit.x - lit.y) * level, vec3f(0.0)),
        lit.z,
        lit.y / PI * level,
        transmittance_to_ground(a, transmittance, linear_sampler, ray.altitude, ray.mu, foot),
    );
}

// Radiance there of ground that reflects this share evenly.
fn ground_diffuse(albedo: vec3f, at: GroundPoint) -> vec3f {
    return albedo / PI * at.irradiance;
}

// How a pixel sees a pattern in layers of `size` texels, each layer twice as smooth as the one before.
struct PatternView {
    // The longer way across what it sees, in squares of the pattern.
    along: vec2f,
    // Coordinate of the layer for taps along it.
    layer: f32,
    // Share of the pattern that any layer has: of what is smoother than the last there is the mean.
    known: f32,
}

// Taps along the longer way.
const PATTERN_TAPS: u32 = 4u;

// Of `count` samples those that a point needs.
fn ground_samples(at: GroundPoint, count: u32) -> u32 {
    return select(0u, count, at.pixel.seen > 0.0);
}

// The ways to the pixels to the right and below are in squares of the pattern.
fn pattern_view(right: vec2f, down: vec2f, size: vec3f) -> PatternView {
    let is_down = dot(down, down) > dot(right, right);
    let along = select(right, down, is_down);
    let shorter = length(select(down, right, is_down));
    let layer = log2(size.x * max(max(shorter, length(along) / f32(PATTERN_TAPS)), 1e-6));
    return PatternView(along, (clamp(layer, 0.0, size.z - 1.0) + 0.5) / size.z, saturate(size.z - layer));
}
