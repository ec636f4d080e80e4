// Volume of the air between the camera and what it sees: one thread walks away from the
// camera through all slices of one place of the picture.
// @use atmosphere camera

@group(0) @binding(0) var<uniform> sky: Sky;
@group(0) @binding(1) var<uniform> camera: Camera;
@group(0) @binding(2) var transmittance: texture_2d<f32>;
@group(0) @binding(3) var multiple: texture_2d<f32>;
@group(0) @binding(4) var linear_sampler: sampler;
@group(0) @binding(5) var result: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = vec3f(textureDimensions(result));
    // The outermost texels are on the rim of the picture: both ends of a panorama agree.
    let uv = vec2f(id.xy) / (size.xy - 1.0);
    let view = camera_ray(camera, vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y));
    let ray = air_ray(max(camera.altitude + view.origin.y, 0.0), view.direction, sky.to_sun);
    var light = Scattering(vec3f(0.0), vec3f(1.0));
    var start = 0.0;
    for (var slice = 0u; slice < u32(size.z); slice++) {
        let end = aerial_distance(f32(slice), size.z, sky.aerial_reach);
        let here = air_ray_at(sky.atmosphere, ray, 0.5 * (start + end));
        let medium = atmosphere_medium(sky.atmosphere, here.altitude);
        let source = air_source(sky.atmosphere, transmittance, multiple, linear_sampler, medium, here);
        light = scattering_step(light, source, medium.extinction, end - start);
        let through = dot(light.transmittance, vec3f(1.0 / 3.0));
        textureStore(result, vec3u(id.xy, slice), vec4f(TABLE_SCALE * light.radiance, through));
        start = end;
    }
}
