// Tables of slabs: each set of orders of scattering has the slab that fits the cloud over the spread of
// its light, and light that keeps its direction but for small angles is told apart.
// @use phase slab slab_nodes

@group(2) @binding(7) var slab_table: texture_3d<f32>;
// Light turned by small angles, by scattering angle and optical depth.
@group(2) @binding(8) var remainder: texture_2d<f32>;

// Source of sunlight scattered more than once, per unit of irradiance, less what leaves by the sides
// that a slab has not. `depth` is the cloud's own optical depth to the sun, `shadow` that of others.
fn multiple_source(ray: LightRay, p: vec3f, depth: f32, shadow: f32) -> vec3f {
    let uv = light_box_coordinate(light.sun, p).xy;
    let facing = lit_facing(ray, p);
    count(MAP_READS, 2u);
    let conductances = conductances_at(ray.species.asymmetry, p);
    let sets = slab_sets(ray, uv, facing, depth, conductances);
    let at = vec2f(phase_coordinate(-ray.to_sun, -ray.direction), slab_path_coordinate(depth + shadow));
    let source = vec3f(shadowed_source(ray.species, sets, shadow)) + textureSampleLevel(remainder, linear, at, 0.0).rgb;
    return absorbed_source(ray.species, source, depth);
}

// The sets of orders of scattering, each from the slab that fits the cloud over its spread.
fn slab_sets(ray: LightRay, uv: vec2f, facing: vec3f, depth: f32, conductances: vec3f) -> f32 {
    let similarity = ray.species.similarity;
    var source = 0.0;
    var thickness = depth;
    for (var orders = 0u; orders < SLAB_SETS; orders++) {
        let spread = slab_set_spread(orders, similarity, thickness, depth);
        let fit = fitted_slab(uv, spread * light.mean_free_path, facing, depth);
        thickness = fit.thickness;
        let view = slab_products(fit, ray.direction, ray.to_sun);
        let scale = similarity * fit.mu0;
        count(MAP_READS, 2u);
        let light_of_set = slab_source(slab_table, linear, orders, scale * fit.thickness, scale * depth,
            fit.mu0, view.x, view.y, ray.species.degrees);
        let wandered = slab_wandered(depth, spread, fit.thickness);
        source += light_of_set * non_leakage(ray.species.asymmetry, fit, wandered, conductances);
    }
    return source;
}
