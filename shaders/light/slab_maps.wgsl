// What the models of slabs share: maps of the cloud as the sun sees it.
// @use openness slab_fit slab_light

@group(2) @binding(5) var sun_depths: texture_2d<f32>;
@group(2) @binding(6) var sun_normals: texture_2d<f32>;

// Sunlight scattered once, and more often, and the weights of the lights of the sky.
struct SlabSum {
    sun: SunSum,
    multiple: vec3f,
    diffuse: vec3f,
}

fn slab_ray(sum: SlabSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    return RayLight(sun_single(sum.sun, ray, seen, lights.sun),
        scattered_again(ray.species, lights.sun, sum.multiple * seen.share),
        ray.species.albedo * diffuse_light(sum.diffuse, seen, lights));
}

// Our slab around `uv`, over `length` metres; it holds the point at hand.
fn fitted_slab(uv: vec2f, length: f32, facing: vec3f, depth: f32) -> SlabFit {
    count(MAP_READS, 2u);
    return slab_fit_holding(slab_fit(light.sun, sun_depths, sun_normals, linear, uv, length, facing), depth);
}

// Where the lump at a point faces, turned to the sun where it faces away.
fn lit_facing(ray: LightRay, p: vec3f) -> vec3f {
    return facing_sunward(medium_facing(ray.region, p), ray.to_sun);
}

// What absorption leaves of a source at this optical depth.
fn absorbed_source(species: Species, source: vec3f, depth: f32) -> vec3f {
    if ABSORBING {
        return max(source * absorbed(species.albedo, species.asymmetry, depth), vec3f(0.0));
    }
    return max(source, vec3f(0.0));
}
