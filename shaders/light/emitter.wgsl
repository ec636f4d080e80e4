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
    var outside = vec3f(0.0);
    if SKY_LIGHT {
        outside = mean_of_sky(lights);
    }
    return RayLight(vec3f(0.0), emitted(ray.species, seen.opacity * seen.visible, mean_of_sun(lights)),
        emitted(ray.species, seen.opacity * seen.visible, outside));
}
