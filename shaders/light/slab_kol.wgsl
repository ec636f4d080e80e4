// As Kol (2013): one slab at one point of a ray, for all orders, from the sun maps at one level of detail
// everywhere.
// @use slab_surface

fn slab_radiance(p: vec3f, ray: LightRay) -> f32 {
    let mean_free_path = light.mean_free_path / ray.species.similarity;
    let uv = light_box_coordinate(light.sun, p).xy;
    let fit = slab_fit_kol(light.sun, sun_depths, sun_normals, linear, uv);
    count(MAP_READS, fit.reads);
    var radiance = 0.0;
    for (var orders = 0u; orders < SLAB_SETS; orders++) {
        radiance += set_radiance(orders, slab_fit_view(fit, p, -ray.direction, ray.to_sun, mean_free_path));
    }
    return radiance;
}
