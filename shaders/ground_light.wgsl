// Table of the irradiance of the ground, by the zenith angle of the sun: the sun's light
// through the air, and the sky's.
// @use atmosphere sphere_grid

@group(0) @binding(0) var<uniform> sky: Sky;
@group(0) @binding(1) var transmittance: texture_2d<f32>;
@group(0) @binding(2) var multiple: texture_2d<f32>;
@group(0) @binding(3) var linear_sampler: sampler;
@group(0) @binding(4) var result: texture_storage_2d<rgba16float, write>;

const STEPS: u32 = 16u;
const RINGS: u32 = 8u;
const PLACES: u32 = 8u;

@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = f32(textureDimensions(result).x);
    let mu_sun = mu_sun_from_unit(saturate(unit_from_texel((f32(id.x) + 0.5) / size, size)));
    let sun = max(mu_sun, 0.0) * sun_irradiance_at(sky.atmosphere, transmittance, linear_sampler, 0.0, mu_sun);
    var radiance = vec3f(0.0);
    for (var i = 0u; i < RINGS * PLACES; i++) {
        // Evenly in the square of the cosine: the mean is then weighted with the cosine.
        let mu = weighted_cosine(middle_of(i / PLACES, RINGS));
        let sine = half_circle_sine(i % PLACES, PLACES);
        let ray = sky_view_ray(0.0, mu, sine, mu_sun);
        let length = distance_to_top(sky.atmosphere, 0.0, mu);
        radiance += air_light(sky.atmosphere, transmittance, multiple, linear_sampler, ray, length, STEPS).radiance;
    }
    let value = sun + hemisphere_irradiance(radiance, RINGS * PLACES);
    textureStore(result, vec2u(id.x, 0u), vec4f(TABLE_SCALE * value, 1.0));
}
