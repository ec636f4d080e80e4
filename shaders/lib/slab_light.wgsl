// Light in a slab that is fitted to a cloud: where it faces, how far light wanders in it, and what the
// cloud's sides and other clouds take.
// @use eddington lighting slab slab_fit species

// Where a lump faces, turned to the sun where it faces away.
fn facing_sunward(around: vec3f, to_sun: vec3f) -> vec3f {
    let away = min(dot(around, to_sun), 0.0);
    return (1.0 + away) * (around - away * to_sun);
}

// The slab that holds a point at this optical depth along the light.
fn slab_fit_holding(fit: SlabFit, depth: f32) -> SlabFit {
    var held = fit;
    held.thickness = max(fit.thickness, depth);
    return held;
}

// Non-leakage probability: what the sides leave of light that has wandered as deep as `depth`. Of the
// six ways out of a cloud those along the slab's normal are its faces. `conductances` are those of
// `diffuse_conductances`.
fn non_leakage(g: f32, fit: SlabFit, depth: f32, conductances: vec3f) -> f32 {
    let faces = diffuse_conductance(g, fit.mu0 * depth) + diffuse_conductance(g, fit.mu0 * (fit.thickness - depth));
    let upright = fit.normal.y * fit.normal.y;
    let sides = (conductances.x + conductances.z) * (1.0 - upright) + 0.5 * conductances.y * (1.0 + upright);
    return side_loss(faces, sides);
}

// Of a `source` of sunlight scattered more than once, what the shadow of other clouds leaves: it dims
// the beam and lets through what it scatters straight on.
fn shadowed_source(species: Species, source: f32, shadow: f32) -> f32 {
    let g = species.asymmetry;
    return source * exp(-(1.0 - max(g, 0.0) * g) * shadow);
}

// Optical depth over which the light of a set of orders has spread, for particles of which one optical
// depth is like `similarity` of the tables'.
fn slab_set_spread(orders: u32, similarity: f32, thickness: f32, depth: f32) -> f32 {
    return slab_spread(orders, similarity * thickness, similarity * depth) / similarity;
}

// Optical depth to which such light has wandered, deeper than where it is now, as far as the slab's middle.
fn slab_wandered(depth: f32, spread: f32, thickness: f32) -> f32 {
    return min(depth + 0.5 * spread, max(depth, 0.5 * thickness));
}

// Cosine of a ray to a slab's normal, and the product of the parts of ray and sun across it.
fn slab_products(fit: SlabFit, direction: vec3f, to_sun: vec3f) -> vec2f {
    let mu = dot(direction, fit.normal);
    return vec2f(mu, dot(direction, to_sun) - mu * fit.mu0);
}

// Delta-Eddington's source in a fitted slab, at an optical depth along the light, along a ray.
fn slab_eddington(g: f32, fit: SlabFit, depth: f32, direction: vec3f) -> f32 {
    return eddington_beam(g, fit.mu0, fit.mu0 * depth, fit.mu0 * fit.thickness, dot(direction, fit.normal));
}

// Light of a slab's surface, of which this much is gathered, through the shadow of other clouds.
fn slab_surface_light(gathered: f32, shadow: f32, radiance: f32) -> f32 {
    return gathered * exp(-shadow) * radiance;
}
