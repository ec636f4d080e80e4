// Volume of the light that the air before the camera lacks because clouds stand before the sun: one thread walks
// away from the camera through all slices of one place of the picture, as `aerial` does.
// @use atmosphere camera sun_map

@group(0) @binding(0) var<uniform> sky: Sky;
@group(0) @binding(1) var<uniform> camera: Camera;
@group(0) @binding(2) var<uniform> map: SunMap;
@group(0) @binding(3) var transmittance: texture_2d<f32>;
@group(0) @binding(4) var lit: texture_2d_array<f32>;
@group(0) @binding(5) var linear_sampler: sampler;
@group(0) @binding(6) var result: texture_storage_3d<rgba16float, write>;

// Samples of a slice.
const SAMPLES: u32 = 2u;

@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = vec3f(textureDimensions(result));
    let uv = vec2f(id.xy) / (size.xy - 1.0);
    let view = camera_ray(camera, vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y));
    let ray = air_ray(max(camera.altitude + view.origin.y, 0.0), view.direction, sky.to_sun);
    var missing = Scattering(vec3f(0.0), vec3f(1.0));
    var start = 0.0;
    for (var slice = 0u; slice < u32(size.z); slice++) {
        let end = aerial_distance(f32(slice), size.z, map.reach);
        let step = (end - start) / f32(SAMPLES);
        for (var i = 0u; i < SAMPLES; i++) {
            let t = start + (f32(i) + 0.5) * step;
            let here = air_ray_at(sky.atmosphere, ray, t);
            let medium = atmosphere_medium(sky.atmosphere, here.altitude);
            let p = view.origin + t * view.direction;
            // Layers go round the earth.
            let height = select(p.y, here.altitude - camera.altitude, map.endless > 0.0);
            let shadow = 1.0 - sun_map_light(map, lit, linear_sampler, vec3f(p.x, height, p.z));
            let source = shadow * air_source_of_sun(sky.atmosphere, transmittance, linear_sampler, medium, here);
            missing = scattering_step(missing, source, medium.extinction, step);
        }
        textureStore(result, vec3u(id.xy, slice), vec4f(TABLE_SCALE * missing.radiance, 1.0));
        start = end;
    }
}
