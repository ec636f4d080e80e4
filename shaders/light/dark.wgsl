// No light at all: what is opaque is black.
// @use unshadowed

fn light_transported(species: Species) -> f32 {
    return transported(species);
}

fn light_ahead(species: Species) -> f32 {
    return species.ahead;
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    return RayLight(vec3f(0.0), vec3f(0.0), vec3f(0.0));
}
