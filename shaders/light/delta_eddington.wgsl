// Single scattering, and sunlight scattered more often as in a slab fitted to the cloud, in the closed
// form of delta-Eddington (`lib/eddington`).
// @use slab_nodes

// Source of sunlight scattered more than once, per unit of irradiance, less what leaves by the sides
// that a slab has not. `depth` is the cloud's own optical depth to the sun, `shadow` that of others.
fn multiple_source(ray: LightRay, p: vec3f, depth: f32, shadow: f32) -> vec3f {
    let g = ray.species.asymmetry;
    let uv = light_box_coordinate(light.sun, p).xy;
    let facing = lit_facing(ray, p);
    count(MAP_READS, 1u);
    let conductances = conductances_at(g, p);
    let fit = fitted_slab(uv, transport_length(g, light.mean_free_path), facing, depth);
    let slab = non_leakage(g, fit, depth, conductances) * slab_eddington(g, fit, depth, ray.direction);
    return absorbed_source(ray.species, vec3f(shadowed_source(ray.species, slab, shadow)), depth);
}
