// Table of the radiance of sky and ground as the camera sees them, by direction.
// @use atmosphere camera

@group(0) @binding(0) var<uniform> sky: Sky;
@group(0) @binding(1) var<uniform> camera: Camera;
@group(0) @binding(2) var transmittance: texture_2d<f32>;
@group(0) @binding(3) var multiple: texture_2d<f32>;
@group(0) @binding(4) var ground_table: texture_2d<f32>;
@group(0) @binding(5) var linear_sampler: sampler;
@group(0) @binding(6) var result: texture_storage_2d<rgba16float, write>;

const STEPS: u32 = 32u;

@compute @workgroup_size(8, 4) fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2f(textureDimensions(result));
    let altitude = max(camera.altitude, 0.0);
    let point = sky_view_point(sky.atmosphere, size, altitude, (vec2f(id.xy) + 0.5) / size);
    let ray = sky_view_ray(altitude, point.x, point.y, sky.to_sun.y);
    let value = sky_radiance(sky.atmosphere, transmittance, multiple, ground_table, linear_sampler,
        ray, point.z > 0.5, STEPS);
    textureStore(result, id.xy, vec4f(min(TABLE_SCALE * value, vec3f(65504.0)), 1.0));
}
