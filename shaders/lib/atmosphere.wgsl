// The tables of the sky: where things are in them, how they are filled and read.
// @use air
//
// H and B are cited in `air`. All tables are per unit of the sun's irradiance above the
// atmosphere but that of the light on clouds, which has the scene's units.

// What the sky depends on beside the camera.
struct Sky {
    atmosphere: Atmosphere,
    to_sun: vec3f,
    // Where the light is gathered that falls on the clouds, m above the ground.
    light_altitude: f32,
    // Of the sun above the atmosphere, on a plane across its light.
    irradiance: vec3f,
    // Reach of the aerial volume, m.
    aerial_reach: f32,
    // Of a sky that is the same in all directions.
    radiance: vec3f,
    padding: f32,
}

// Place in a table of `size` texels for x from 0 to 1, so that both ends fall on centres.
fn texel_from_unit(x: f32, size: f32) -> f32 {
    return 0.5 / size + x * (1.0 - 1.0 / size);
}

fn unit_from_texel(u: f32, size: f32) -> f32 {
    return (u - 0.5 / size) / (1.0 - 1.0 / size);
}

// Radiances are stored times this: the sky of a sun 10 degrees below the horizon stays
// above the smallest normal half float, the brightest haze well below the largest.
const TABLE_SCALE: f32 = 1024.0;

// Transmittance to the top of the atmosphere, by the altitude and the zenith angle of
// the ray [B, GetTransmittanceTextureUvFromRMu].
fn transmittance_uv(a: Atmosphere, size: vec2f, altitude: f32, mu: f32) -> vec2f {
    let above = clamp(altitude, 0.0, a.thickness);
    let horizon = sqrt(horizon_square(a, above));
    let longest = horizon + sqrt(horizon_square(a, a.thickness));
    let shortest = a.thickness - above;
    let x = (distance_to_top(a, above, mu) - shortest) / (longest - shortest);
    let y = horizon / sqrt(horizon_square(a, a.thickness));
    return vec2f(texel_from_unit(saturate(x), size.x), texel_from_unit(y, size.y));
}

// The inverse: altitude in m, cosine of the zenith angle.
fn transmittance_point(a: Atmosphere, size: vec2f, uv: vec2f) -> vec2f {
    let whole = sqrt(horizon_square(a, a.thickness));
    let horizon = whole * saturate(unit_from_texel(uv.y, size.y));
    let altitude = horizon * horizon / (a.ground_radius + sqrt(a.ground_radius * a.ground_radius + horizon * horizon));
    let shortest = a.thickness - altitude;
    let distance = shortest + saturate(unit_from_texel(uv.x, size.x)) * (horizon + whole - shortest);
    let r = a.ground_radius + altitude;
    let mu = (square_to_top(a, altitude) - distance * distance) / max(2.0 * r * distance, 1e-20);
    return vec2f(altitude, select(clamp(mu, -1.0, 1.0), 1.0, distance <= 0.0));
}

// Integrates the optical depth to the top of the atmosphere, in `steps` steps.
fn transmittance_to_top(a: Atmosphere, altitude: f32, mu: f32, steps: u32) -> vec3f {
    let length = distance_to_top(a, altitude, mu);
    let lowest = lowest_distance(a, altitude, mu, length);
    let ray = AirRay(altitude, mu, 0.0, 0.0);
    var depth = vec3f(0.0);
    var start = 0.0;
    for (var i = 0u; i < steps; i++) {
        let end = step_distance(f32(i + 1u) / f32(steps), lowest, length);
        let here = air_ray_at(a, ray, 0.5 * (start + end));
        depth += atmosphere_medium(a, here.altitude).extinction * (end - start);
        start = end;
    }
    return exp(-depth);
}

// Share of the sun's disc above the horizon [B, GetTransmittanceToSun]: smooth, within
// 0.04 of the exact area of a disc.
fn sun_visibility(a: Atmosphere, altitude: f32, mu_sun: f32) -> f32 {
    let above = max(altitude, 0.0);
    let width = max(a.sun_radius, 1e-5) * a.ground_radius / (a.ground_radius + above);
    return smoothstep(-width, width, mu_sun - horizon_mu(a, above));
}

// Irradiance on a plane across the sun's light, per unit above the atmosphere: what the
// air lets through, times the share of the disc above the horizon.
fn sun_irradiance_at(
    a: Atmosphere, transmittance: texture_2d<f32>, linear_sampler: sampler, altitude: f32, mu_sun: f32,
) -> vec3f {
    let uv = transmittance_uv(a, vec2f(textureDimensions(transmittance)), altitude, mu_sun);
    return sun_visibility(a, altitude, mu_sun) * textureSampleLevel(transmittance, linear_sampler, uv, 0.0).rgb;
}

// Bends the cosine of the sun's zenith angle so that a table is fine about the horizon,
// where light changes within degrees: from -1 to 1 onto 0 to 1.
const SUN_BEND: f32 = 0.2;

fn unit_from_mu_sun(mu_sun: f32) -> f32 {
    return 0.5 + 0.5 * (1.0 + SUN_BEND) * mu_sun / (abs(mu_sun) + SUN_BEND);
}

fn mu_sun_from_unit(x: f32) -> f32 {
    let y = (2.0 * x - 1.0) / (1.0 + SUN_BEND);
    return clamp(SUN_BEND * y / (1.0 - abs(y)), -1.0, 1.0);
}

// Light scattered twice and more, by the altitude and the sun [H 5.5]; altitudes go by
// their root, as haze ends within the first kilometres.
fn multiple_uv(a: Atmosphere, size: vec2f, altitude: f32, mu_sun: f32) -> vec2f {
    let y = sqrt(saturate(altitude / a.thickness));
    return vec2f(texel_from_unit(unit_from_mu_sun(mu_sun), size.x), texel_from_unit(y, size.y));
}

// The inverse: altitude in m, cosine of the sun's zenith angle.
fn multiple_point(a: Atmosphere, size: vec2f, uv: vec2f) -> vec2f {
    let y = saturate(unit_from_texel(uv.y, size.y));
    return vec2f(y * y * a.thickness, mu_sun_from_unit(saturate(unit_from_texel(uv.x, size.x))));
}

// The same light at a point, 1/sr: times the scattering coefficient it is radiance per metre.
fn multiple_light(
    a: Atmosphere, multiple: texture_2d<f32>, linear_sampler: sampler, altitude: f32, mu_sun: f32,
) -> vec3f {
    let uv = multiple_uv(a, vec2f(textureDimensions(multiple)), altitude, mu_sun);
    return textureSampleLevel(multiple, linear_sampler, uv, 0.0).rgb / TABLE_SCALE;
}

// Irradiance of the ground, by sun and sky together.
fn ground_irradiance(ground: texture_2d<f32>, linear_sampler: sampler, mu_sun: f32) -> vec3f {
    let u = texel_from_unit(unit_from_mu_sun(mu_sun), f32(textureDimensions(ground).x));
    return textureSampleLevel(ground, linear_sampler, vec2f(u, 0.5), 0.0).rgb / TABLE_SCALE;
}

// ---- Light along a ray ------------------------------------------------------------

// Radiance per metre that the air at a point of a ray sends to its start, of sunlight scattered once.
fn air_source_of_sun(
    a: Atmosphere, transmittance: texture_2d<f32>, linear_sampler: sampler, medium: Medium, here: AirRay,
) -> vec3f {
    let sun = sun_irradiance_at(a, transmittance, linear_sampler, here.altitude, here.mu_sun);
    return sun * (medium.rayleigh * rayleigh_phase(here.nu) + medium.mie * haze_phase(a.mie_g, here.nu));
}

// The same of all light.
fn air_source(
    a: Atmosphere, transmittance: texture_2d<f32>, multiple: texture_2d<f32>, linear_sampler: sampler,
    medium: Medium, here: AirRay,
) -> vec3f {
    let again = multiple_light(a, multiple, linear_sampler, here.altitude, here.mu_sun);
    return air_source_of_sun(a, transmittance, linear_sampler, medium, here) + again * (medium.rayleigh + medium.mie);
}

// Light that the first `length` metres of `ray`, inside the atmosphere, send to its
// start, in `steps` steps.
fn air_light(
    a: Atmosphere, transmittance: texture_2d<f32>, multiple: texture_2d<f32>, linear_sampler: sampler,
    ray: AirRay, length: f32, steps: u32,
) -> Scattering {
    let lowest = lowest_distance(a, ray.altitude, ray.mu, length);
    var light = Scattering(vec3f(0.0), vec3f(1.0));
    var start = 0.0;
    for (var i = 0u; i < steps; i++) {
        let end = step_distance(f32(i + 1u) / f32(steps), lowest, length);
        let here = air_ray_at(a, ray, 0.5 * (start + end));
        let medium = atmosphere_medium(a, here.altitude);
        let source = air_source(a, transmittance, multiple, linear_sampler, medium, here);
        light = scattering_step(light, source, medium.extinction, end - start);
        start = end;
    }
    return light;
}

// Radiance of sky and ground at the start of `ray`, wherever that is; `ground` says
// whether the ray is below the horizon.
fn sky_radiance(
    a: Atmosphere, transmittance: texture_2d<f32>, multiple: texture_2d<f32>, ground_table: texture_2d<f32>,
    linear_sampler: sampler, ray: AirRay, ground: bool, steps: u32,
) -> vec3f {
    let entry = distance_to_entry(a, ray.altitude, ray.mu);
    let inside = air_ray_at(a, ray, max(entry, 0.0));
    let to_ground = distance_to_ground(a, inside.altitude, inside.mu);
    let to_end = select(distance_to_top(a, inside.altitude, inside.mu), to_ground, ground);
    let length = select(to_end, 0.0, entry < 0.0);
    let light = air_light(a, transmittance, multiple, linear_sampler, inside, length, steps);
    let foot = air_ray_at(a, inside, length);
    let lit = a.ground_albedo / PI * ground_irradiance(ground_table, linear_sampler, foot.mu_sun);
    return light.radiance + select(vec3f(0.0), lit * light.transmittance, ground);
}

// Transmittance of the air between a point at `altitude` and the foot on the ground of a ray of zenith cosine `mu` that
// meets it there as `foot`: of the way up from the foot, what the point's own way up does not take.
fn transmittance_to_ground(
    a: Atmosphere, transmittance: texture_2d<f32>, linear_sampler: sampler, altitude: f32, mu: f32, foot: AirRay,
) -> vec3f {
    let size = vec2f(textureDimensions(transmittance));
    let whole = textureSampleLevel(transmittance, linear_sampler, transmittance_uv(a, size, 0.0, -foot.mu), 0.0).rgb;
    let above = textureSampleLevel(transmittance, linear_sampler, transmittance_uv(a, size, altitude, -mu), 0.0).rgb;
    return saturate(whole / max(above, vec3f(1e-6)));
}

// What the ground lacks of the radiance that a ray to it sees, where clouds let this share of sunlight through to it;
// `to_ground` is its distance, m.
fn ground_shadow(
    a: Atmosphere, transmittance: texture_2d<f32>, linear_sampler: sampler, ray: AirRay, to_ground: f32, lit: f32,
) -> vec3f {
    let foot = air_ray_at(a, ray, to_ground);
    let sun = max(foot.mu_sun, 0.0) * sun_irradiance_at(a, transmittance, linear_sampler, 0.0, foot.mu_sun);
    let through = transmittance_to_ground(a, transmittance, linear_sampler, ray.altitude, ray.mu, foot);
    return (1.0 - lit) * a.ground_albedo / PI * sun * through;
}

// ---- The view of the sky ------------------------------------------------------------

// Place in the table of the sky seen from `altitude`. The upper half of the table is the
// sky, the lower half the ground, so that nothing blends across the horizon, about
// which both are fine [H 5.3]. `ground` chooses the half; a `mu` of the other side gives
// its horizon. `sine` is the sine of half the azimuth from the sun. Without arc cosines:
// with the angle from the zenith t and half angles, 1 - sin(t/2) / sin(horizon/2) = x^2.
fn sky_view_uv(a: Atmosphere, size: vec2f, altitude: f32, mu: f32, sine: f32, ground: bool) -> vec2f {
    let horizon = horizon_mu(a, altitude);
    let y = saturate(select((mu - horizon) / (1.0 - horizon), (horizon - mu) / (1.0 + horizon), ground));
    let x = texel_from_unit(sqrt(y / (1.0 + sqrt(1.0 - y))), 0.5 * size.y);
    return vec2f(texel_from_unit(saturate(sine), size.x), select(0.5 - 0.5 * x, 0.5 + 0.5 * x, ground));
}

// The inverse: cosine of the zenith angle, sine of half the azimuth, 1 for ground or 0.
fn sky_view_point(a: Atmosphere, size: vec2f, altitude: f32, uv: vec2f) -> vec3f {
    let horizon = horizon_mu(a, altitude);
    let ground = uv.y > 0.5;
    let x = saturate(unit_from_texel(abs(2.0 * uv.y - 1.0), 0.5 * size.y));
    let y = x * x * (2.0 - x * x);
    let mu = horizon + y * select(1.0 - horizon, -1.0 - horizon, ground);
    return vec3f(mu, saturate(unit_from_texel(uv.x, size.x)), f32(ground));
}

// Sine of half the azimuth between two directions: half the chord of their unit vectors
// on the plane. 0 where one is vertical and has no azimuth.
fn half_azimuth_sine(direction: vec3f, to_sun: vec3f) -> f32 {
    let level = length(direction.xz);
    let level_sun = length(to_sun.xz);
    if level < 1e-6 || level_sun < 1e-6 {
        return 0.0;
    }
    return min(0.5 * distance(direction.xz / level, to_sun.xz / level_sun), 1.0);
}

// The ray of a place of that table.
fn sky_view_ray(altitude: f32, mu: f32, sine: f32, mu_sun: f32) -> AirRay {
    let level = sqrt(max((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun), 0.0));
    return AirRay(altitude, mu, mu_sun, clamp(mu * mu_sun + level * (1.0 - 2.0 * sine * sine), -1.0, 1.0));
}

// Texels of the table that `light_of_sky` reads.
const LIGHT_ABOVE: u32 = 0u;
const LIGHT_HORIZON: u32 = 1u;
const LIGHT_GROUND: u32 = 2u;

// Mean radiance, in the scene's units, of the upper hemisphere (weighted with the
// cosine), of a belt along the horizon, or of the ground. The texel's alpha is a common
// exponent, because half floats do not reach from dusk to noon.
fn light_of_sky(light: texture_2d<f32>, part: u32) -> vec3f {
    let texel = textureLoad(light, vec2u(part, 0u), 0);
    return texel.rgb * texel.a;
}

// How `radiance` is stored for `light_of_sky`.
fn light_texel(radiance: vec3f) -> vec4f {
    let most = max(max(radiance.r, radiance.g), radiance.b);
    let exponent = exp2(clamp(floor(log2(max(most, 1e-10))), -14.0, 15.0));
    return vec4f(radiance / exponent, exponent);
}

// Distance, m, to which slice `slice` of the aerial volume (from 0) holds the air [H 5.4].
fn aerial_distance(slice: f32, slices: f32, farthest: f32) -> f32 {
    let x = (slice + 1.0) / slices;
    return x * x * farthest;
}

// Light that the air between the camera and `distance` metres at `uv` of the picture (y
// down) adds, per unit of the sun's irradiance, and the mean share of light from behind
// that it lets through. Beyond `farthest` the air ends.
fn aerial_perspective(
    volume: texture_3d<f32>, linear_sampler: sampler, uv: vec2f, distance: f32, farthest: f32,
) -> vec4f {
    let size = vec3f(textureDimensions(volume));
    let x = sqrt(saturate(distance / farthest)) * size.z;
    let at = vec3f(texel_from_unit(uv.x, size.x), texel_from_unit(uv.y, size.y), (x - 0.5) / size.z);
    let texel = textureSampleLevel(volume, linear_sampler, at, 0.0);
    // Nothing at all at distance 0, which is before the first slice.
    let share = min(x * x, 1.0);
    return vec4f(share * texel.rgb / TABLE_SCALE, mix(1.0, texel.a, share));
}
