// Light of sky and ground that enters a cloud along each direction of the quadrature: the mean
// over the part of the sphere that the direction stands for. One workgroup a direction.
// @use atmosphere sphere_grid

// Sines of elevation, and azimuths, rad, between which the light comes from.
struct Patch {
    low: f32,
    high: f32,
    azimuth_low: f32,
    azimuth_high: f32,
}

@group(0) @binding(0) var<uniform> sky: Sky;
@group(0) @binding(1) var transmittance: texture_2d<f32>;
@group(0) @binding(2) var multiple: texture_2d<f32>;
@group(0) @binding(3) var ground_table: texture_2d<f32>;
@group(0) @binding(4) var linear_sampler: sampler;
@group(0) @binding(5) var<storage, read> patches: array<Patch>;
// Radiance by channel and direction; then, of the same, what is the sun's on the ground.
@group(0) @binding(6) var<storage, read_write> entering: array<f32>;

override ATMOSPHERE: bool = true;

const STEPS: u32 = 20u;
// Samples along each side of a patch.
const SIDE: u32 = 8u;
const THREADS: u32 = SIDE * SIDE;

var<workgroup> partial: array<vec3f, THREADS>;
var<workgroup> grounds: array<vec3f, THREADS>;

fn radiance_from(mu: f32, azimuth: f32) -> vec3f {
    if !ATMOSPHERE {
        return sky.radiance;
    }
    let altitude = max(sky.light_altitude, 0.0);
    let sine = half_azimuth_sine(direction_at(mu, azimuth), sky.to_sun);
    let ray = sky_view_ray(altitude, mu, sine, sky.to_sun.y);
    let ground = mu < horizon_mu(sky.atmosphere, altitude);
    return sky.irradiance * sky_radiance(sky.atmosphere, transmittance, multiple, ground_table, linear_sampler, ray, ground, STEPS);
}

// The part of that which is the sun's light on the ground.
fn sunlit_ground(mu: f32) -> vec3f {
    let altitude = max(sky.light_altitude, 0.0);
    if !ATMOSPHERE || mu >= horizon_mu(sky.atmosphere, altitude) {
        return vec3f(0.0);
    }
    let ray = sky_view_ray(altitude, mu, 0.0, sky.to_sun.y);
    let to_ground = distance_to_ground(sky.atmosphere, altitude, mu);
    return sky.irradiance * ground_shadow(sky.atmosphere, transmittance, linear_sampler, ray, to_ground, 0.0);
}

@compute @workgroup_size(THREADS) fn main(
    @builtin(local_invocation_index) thread: u32, @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
) {
    let part = patches[group.x];
    let place = (vec2f(vec2u(thread % SIDE, thread / SIDE)) + 0.5) / f32(SIDE);
    let mu = mix(part.low, part.high, place.x);
    partial[thread] = radiance_from(mu, mix(part.azimuth_low, part.azimuth_high, place.y));
    grounds[thread] = sunlit_ground(mu);
    workgroupBarrier();
    if thread == 0u {
        var sum = vec3f(0.0);
        var lit = vec3f(0.0);
        for (var i = 0u; i < THREADS; i++) {
            sum += partial[i];
            lit += grounds[i];
        }
        for (var channel = 0u; channel < 3u; channel++) {
            entering[channel * groups.x + group.x] = sum[channel] / f32(THREADS);
            entering[(3u + channel) * groups.x + group.x] = lit[channel] / f32(THREADS);
        }
    }
}
