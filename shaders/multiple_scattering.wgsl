// Table of the light scattered twice and more, per scattering coefficient (Hillaire
// 2020, section 5.5): from the second order on, light is taken to scatter evenly in all
// directions, and the air around a point to be lit as the point is. Then each order is
// the one before times the share `again` that scatters once more: a geometric series.
// @use atmosphere sphere_grid

@group(0) @binding(0) var<uniform> sky: Sky;
@group(0) @binding(1) var transmittance: texture_2d<f32>;
@group(0) @binding(2) var linear_sampler: sampler;
@group(0) @binding(3) var result: texture_storage_2d<rgba16float, write>;

const STEPS: u32 = 20u;
// Directions: circles of latitude times places on half a circle, the other half being alike.
const RINGS: u32 = 8u;
const PLACES: u32 = 6u;

// Both means over a sphere of directions, of one ray: the light scattered once, and the
// share of a field of radiance 1 that is scattered.
struct Orders {
    second: vec3f,
    again: vec3f,
}

fn orders_along(a: Atmosphere, ray: AirRay) -> Orders {
    let ground = ray.mu < horizon_mu(a, ray.altitude);
    let length = select(distance_to_top(a, ray.altitude, ray.mu),
        distance_to_ground(a, ray.altitude, ray.mu), ground);
    let lowest = lowest_distance(a, ray.altitude, ray.mu, length);
    var once = Scattering(vec3f(0.0), vec3f(1.0));
    var again = once;
    var start = 0.0;
    for (var i = 0u; i < STEPS; i++) {
        let end = step_distance(f32(i + 1u) / f32(STEPS), lowest, length);
        let here = air_ray_at(a, ray, 0.5 * (start + end));
        let medium = atmosphere_medium(a, here.altitude);
        let scattering = medium.rayleigh + medium.mie;
        let sun = sun_irradiance_at(a, transmittance, linear_sampler, here.altitude, here.mu_sun);
        once = scattering_step(once, even_source(sun, scattering), medium.extinction, end - start);
        again = scattering_step(again, scattering, medium.extinction, end - start);
        start = end;
    }
    let foot = max(air_ray_at(a, ray, length).mu_sun, 0.0);
    let lit = matt_radiance(a.ground_albedo, vec3f(foot)) * sun_irradiance_at(a, transmittance, linear_sampler, 0.0, foot);
    return Orders(once.radiance + select(vec3f(0.0), lit * once.transmittance, ground), again.radiance);
}

@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2f(textureDimensions(result));
    let point = multiple_point(sky.atmosphere, size, (vec2f(id.xy) + 0.5) / size);
    var sum = Orders(vec3f(0.0), vec3f(0.0));
    for (var i = 0u; i < RINGS * PLACES; i++) {
        let mu = 2.0 * middle_of(i / PLACES, RINGS) - 1.0;
        let sine = half_circle_sine(i % PLACES, PLACES);
        let orders = orders_along(sky.atmosphere, sky_view_ray(point.x, mu, sine, point.y));
        sum = Orders(sum.second + orders.second, sum.again + orders.again);
    }
    let mean = 1.0 / f32(RINGS * PLACES);
    let value = mean * sum.second / (1.0 - mean * sum.again);
    textureStore(result, id.xy, vec4f(TABLE_SCALE * value, 1.0));
}
