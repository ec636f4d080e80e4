// Max's emitter (1994, after Sabella 1988): a cloud glows by itself and dims what is behind. An
// opaque one has the radiance that is the mean over all directions of the light of sun, sky and
// ground that falls on it. No shadows, no phase function.
// @use unshadowed

fn light_transported(species: Species) -> f32 {
    return 1.0;
}

fn light_ahead(species: Species) -> f32 {
    return 0.0;
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    var outside = lights;
    if !SKY_LIGHT {
        outside = Lights(lights.sun, vec3f(0.0), vec3f(0.0), vec3f(0.0));
    }
    return RayLight(vec3f(0.0), emitted(ray.species, seen.opacity, outside));
}
