// What the models of slabs share: maps of the cloud as the sun sees it.
// @use openness slab_fit

@group(2) @binding(5) var sun_depths: texture_2d<f32>;
@group(2) @binding(6) var sun_normals: texture_2d<f32>;

// Sunlight scattered once, and more often, and the weights of the lights of the sky.
struct SlabSum {
    sun: SunSum,
    multiple: vec3f,
    diffuse: vec3f,
}

fn slab_ray(sum: SlabSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    let multiple = lights.sun * (sum.multiple * seen.share) + diffuse_light(sum.diffuse, seen, lights);
    return RayLight(sun_single(sum.sun, ray, seen, lights.sun), ray.species.albedo * multiple);
}

// Our slab around `uv`, over `length` metres; it holds the point at hand.
fn fitted_slab(uv: vec2f, length: f32, facing: vec3f, depth: f32) -> SlabFit {
    count(MAP_READS, 2u);
    var fit = slab_fit(light.sun, sun_depths, sun_normals, linear, uv, length, facing);
    fit.thickness = max(fit.thickness, depth);
    return fit;
}

// Where the lump at a point faces, turned to the sun where it faces away.
fn lit_facing(ray: LightRay, p: vec3f) -> vec3f {
    let around = medium_facing(ray.region, p);
    let away = min(dot(around, ray.to_sun), 0.0);
    return (1.0 + away) * (around - away * ray.to_sun);
}

// What the sides leave of light that has wandered as deep as `depth`. Of the six ways out of
// a cloud those along the slab's normal are its faces.
fn kept_by_sides(g: f32, fit: SlabFit, depth: f32, open: vec3f) -> f32 {
    let faces = diffuse_conductance(g, fit.mu0 * depth) + diffuse_conductance(g, fit.mu0 * (fit.thickness - depth));
    let upright = fit.normal.y * fit.normal.y;
    return side_loss(faces, (open.x + open.z) * (1.0 - upright) + 0.5 * open.y * (1.0 + upright));
}

// Of a `source` of sunlight scattered more than once, what the shadow of other clouds leaves: it dims
// the beam and lets through what it scatters straight on.
fn shadowed_source(species: Species, source: f32, shadow: f32) -> f32 {
    let g = species.asymmetry;
    return source * exp(-(1.0 - max(g, 0.0) * g) * shadow);
}

// What absorption leaves of a source at this optical depth.
fn absorbed_source(species: Species, source: vec3f, depth: f32) -> vec3f {
    if ABSORBING {
        return max(source * absorbed(species.albedo, species.asymmetry, depth), vec3f(0.0));
    }
    return max(source, vec3f(0.0));
}
