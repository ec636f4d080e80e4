// The light that falls on clouds from sky and ground: three texels, one workgroup each.
// @use atmosphere sphere_grid

@group(0) @binding(0) var<uniform> sky: Sky;
@group(0) @binding(1) var transmittance: texture_2d<f32>;
@group(0) @binding(2) var multiple: texture_2d<f32>;
@group(0) @binding(3) var ground_table: texture_2d<f32>;
@group(0) @binding(4) var linear_sampler: sampler;
@group(0) @binding(5) var result: texture_storage_2d<rgba16float, write>;

const STEPS: u32 = 20u;
// 256 directions: rings of altitude times places on half a circle, the other half being alike.
const RINGS: u32 = 16u;
const PLACES: u32 = 16u;
const THREADS: u32 = 64u;
// Sines of the elevations between which lies the horizon's belt: -10 and 30 degrees.
const BELT_LOW: f32 = -0.17364818;
const BELT_HIGH: f32 = 0.5;

var<workgroup> partial: array<vec3f, THREADS>;

// Radiance from direction `i` of 256, spread over the hemisphere or the belt.
fn radiance_from(i: u32, part: u32) -> vec3f {
    let y = middle_of(i / PLACES, RINGS);
    let mu = select(mix(BELT_LOW, BELT_HIGH, y), weighted_cosine(y), part == LIGHT_ABOVE);
    let sine = half_circle_sine(i % PLACES, PLACES);
    let altitude = max(sky.light_altitude, 0.0);
    let ray = sky_view_ray(altitude, mu, sine, sky.to_sun.y);
    let ground = mu < horizon_mu(sky.atmosphere, altitude);
    return sky_radiance(sky.atmosphere, transmittance, multiple, ground_table, linear_sampler, ray, ground, STEPS);
}

@compute @workgroup_size(THREADS) fn main(
    @builtin(local_invocation_index) thread: u32, @builtin(workgroup_id) group: vec3u,
) {
    let part = group.x;
    var sum = vec3f(0.0);
    if part != LIGHT_GROUND {
        for (var i = thread; i < RINGS * PLACES; i += THREADS) {
            sum += radiance_from(i, part);
        }
    }
    partial[thread] = sum / f32(RINGS * PLACES);
    workgroupBarrier();
    if thread == 0u {
        var mean = vec3f(0.0);
        for (var i = 0u; i < THREADS; i++) {
            mean += partial[i];
        }
        if part == LIGHT_GROUND {
            let irradiance = ground_irradiance(ground_table, linear_sampler, sky.to_sun.y);
            mean = matt_radiance(sky.atmosphere.ground_albedo, irradiance);
        }
        textureStore(result, vec2u(part, 0u), light_texel(sky.irradiance * mean));
    }
}
