// As Bouthors (2008): a slab for each set of orders, under the area where its light entered, found by
// iteration. Slow.
// @use slab_surface

@group(2) @binding(7) var slab_entries: texture_2d<f32>;
@group(2) @binding(8) var slab_offsets: texture_2d<f32>;

fn slab_radiance(p: vec3f, ray: LightRay) -> f32 {
    let mean_free_path = light.mean_free_path / ray.species.similarity;
    var radiance = 0.0;
    for (var orders = 0u; orders < SLAB_SETS; orders++) {
        let fit = slab_fit_bouthors(light.sun, sun_depths, sun_normals, slab_entries, slab_offsets, linear, orders, p,
            -ray.direction, mean_free_path);
        count(MAP_READS, fit.reads);
        radiance += set_radiance(orders, slab_fit_view(fit, p, -ray.direction, ray.to_sun, mean_free_path));
    }
    return radiance;
}
