// The background: sky, ground and the sun's disc, into a linear target.
// @use atmosphere camera sun_disc sun_map ground_kind

// Is the sky an atmosphere, or the same everywhere?
override ATMOSPHERE: bool = true;
// Is the sun seen?
override SUN_DISC: bool = true;
// Do clouds cast shadows, on the ground and in the air?
override SHADED: bool = false;
// Is the ground more than even?
override GROUND: bool = false;

@group(0) @binding(0) var<uniform> sky: Sky;
@group(0) @binding(1) var<uniform> camera: Camera;
@group(0) @binding(2) var transmittance: texture_2d<f32>;
@group(0) @binding(3) var sky_view: texture_2d<f32>;
@group(0) @binding(4) var linear_sampler: sampler;
@group(0) @binding(5) var<uniform> map: SunMap;
@group(0) @binding(6) var lit_map: texture_2d_array<f32>;
@group(0) @binding(7) var air_shadow: texture_3d<f32>;
@group(0) @binding(8) var ground_table: texture_2d<f32>;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) ndc: vec2f,
}

// One triangle that covers the picture.
@vertex fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    let ndc = vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    return Corner(vec4f(ndc, 0.0, 1.0), ndc);
}

@fragment fn fragment(@location(0) ndc: vec2f) -> @location(0) vec4f {
    let ray = camera_ray(camera, ndc);
    let direction = ray.direction;
    var radiance = sky.radiance;
    if ATMOSPHERE {
        var light = air_and_ground(direction);
        if SHADED || GROUND {
            light = max(light + of_the_scene(ray, ndc), vec3f(0.0));
        }
        radiance = sky.irradiance * light;
    }
    if SUN_DISC {
        radiance += sun_disc(direction);
    }
    return vec4f(min(radiance, vec3f(MOST)), 1.0);
}

// Largest value of a half float.
const MOST: f32 = 65504.0;

fn air_and_ground(direction: vec3f) -> vec3f {
    let a = sky.atmosphere;
    let altitude = max(camera.altitude, 0.0);
    let size = vec2f(textureDimensions(sky_view));
    let sine = half_azimuth_sine(direction, sky.to_sun);
    let above = sky_view_uv(a, size, altitude, direction.y, sine, false);
    let below = sky_view_uv(a, size, altitude, direction.y, sine, true);
    let light = mix(textureSampleLevel(sky_view, linear_sampler, below, 0.0).rgb,
        textureSampleLevel(sky_view, linear_sampler, above, 0.0).rgb, share_above(a, altitude, direction.y, camera.pixel));
    return light / TABLE_SCALE;
}

// What is more or less than that: shadows of clouds on the ground and in the air before it, and what the ground is like.
fn of_the_scene(ray: Ray, ndc: vec2f) -> vec3f {
    let a = sky.atmosphere;
    let altitude = max(camera.altitude + ray.origin.y, 0.0);
    let mu = ray.direction.y;
    let below = 1.0 - share_above(a, altitude, mu, camera.pixel);
    let down = min(mu, horizon_mu(a, altitude));
    let to_ground = distance_to_ground(a, altitude, down);
    var view = air_ray(altitude, ray.direction, sky.to_sun);
    view.mu = down;
    var lit = vec3f(1.0, 0.0, 1.0);
    var more = vec3f(0.0);
    if SHADED {
        let uv = vec2f(0.5, -0.5) * ndc + 0.5;
        let end = select(to_ground, sky.aerial_reach, below < 0.5);
        let air = aerial_perspective(air_shadow, linear_sampler, uv, end, map.reach).rgb;
        lit = sun_map_ground(map, lit_map, linear_sampler, ray.origin + to_ground * ray.direction);
        more -= air + below * ground_shadow(a, transmittance, linear_sampler, view, to_ground, lit.x + lit.y);
    }
    if GROUND {
        let step = 2.0 / camera.size;
        let place = ground_place(ndc);
        let right = ground_place(ndc + vec2f(step.x, 0.0)) - place;
        let pixel = GroundPixel(below, place, right, ground_place(ndc - vec2f(0.0, step.y)) - place);
        let at = ground_point(a, transmittance, ground_table, linear_sampler, pixel, view, ray.direction, sky.to_sun,
            to_ground, lit);
        more += below * ground_more(a, at);
    }
    return more;
}

// Where the ray of a place on the picture meets the ground, from the camera to the east and to the south, m; beyond the
// horizon, where it is nearest to it.
fn ground_place(ndc: vec2f) -> vec2f {
    let ray = camera_ray(camera, ndc);
    let altitude = max(camera.altitude + ray.origin.y, 0.0);
    let down = min(ray.direction.y, horizon_mu(sky.atmosphere, altitude));
    return ray.origin.xz + distance_to_ground(sky.atmosphere, altitude, down) * ray.direction.xz;
}

// Radiance of the disc of the sun, through the air.
fn sun_disc(direction: vec3f) -> vec3f {
    let pixel = camera.pixel;
    let radius = disc_radius(sky.atmosphere.sun_radius, pixel);
    let from_center = distance(direction, sky.to_sun);
    let share = disc_share(radius, pixel, from_center);
    var radiance = disc_radiance(sky.irradiance, radius, pixel, from_center);
    if ATMOSPHERE {
        let altitude = max(camera.altitude, 0.0);
        let above = max(direction.y, horizon_mu(sky.atmosphere, altitude));
        radiance *= share_above(sky.atmosphere, altitude, direction.y, pixel) * transmittance_from(altitude, above);
    }
    // What a half float cannot hold is scaled down as a whole: the colour stays.
    let most = max(max(radiance.r, radiance.g), radiance.b);
    return share * radiance * min(1.0, 0.9 * MOST / max(most, 1e-20));
}

// Transmittance of the whole air in a direction that does not meet the ground.
fn transmittance_from(altitude: f32, mu: f32) -> vec3f {
    let a = sky.atmosphere;
    let entry = distance_to_entry(a, altitude, mu);
    let inside = air_ray_at(a, AirRay(altitude, mu, 0.0, 0.0), max(entry, 0.0));
    let uv = transmittance_uv(a, vec2f(textureDimensions(transmittance)), inside.altitude, inside.mu);
    return select(textureSampleLevel(transmittance, linear_sampler, uv, 0.0).rgb, vec3f(1.0), entry < 0.0);
}
