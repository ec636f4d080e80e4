// Delta-Eddington: light scattered many times inside a plane-parallel slab, in closed
// form. Depths are optical, along the normal, in the medium without its forward peak,
// and scaled here by 1 - f, f = g^2 (Joseph, Wiscombe and Weinman 1976).
// @use constants

// A conservative slab lit by a beam of irradiance 1 across it, at cosine `mu0` to the
// normal: the source function of light that was scattered at least once before, 1/sr,
// towards downward cosine `nu`, at optical depth `depth` of `thickness`. Measured from the far
// face, as the little light that comes through a thick slab would else be a difference of large
// numbers; in a thin slab, which scatters little more than once, 1e-7 of the beam is lost.
fn eddington_beam(g: f32, mu0: f32, depth: f32, thickness: f32, nu: f32) -> f32 {
    // The peak of a phase function that scatters backwards is not forward: none is cut.
    let forward = max(g, 0.0);
    let scale = (1.0 - forward) * (1.0 + forward);
    // 1 less (g - f) / (1 - f), the asymmetry that is left.
    let turned = 1.0 - g / (1.0 + forward);
    let t = scale * depth;
    let total = scale * thickness;
    let beam = mu0 * exp(-t / mu0);
    let through = mu0 * (mu0 - 2.0 / 3.0) * exp(-total / mu0);
    let flux = (mu0 * (2.0 / 3.0 + mu0) - through) / (4.0 / 3.0 + turned * total);
    let c = 3.0 * INV_4PI;
    let i1 = c * (flux - beam);
    let i0 = c * (flux * (2.0 / 3.0 + turned * (total - t)) - mu0 * beam + through);
    // The source of the unscaled medium, whose path the view ray is: g1 of what is scattered
    // and f of what goes straight on make g.
    return max(i0 + g * nu * i1, 0.0);
}

// How well diffuse light comes through an optical depth, relative: the Eddington
// solution of a slab between two diffuse skies is their mean weighted by this.
fn diffuse_conductance(g: f32, optical_depth: f32) -> f32 {
    return 1.0 / (2.0 / 3.0 + (1.0 - g) * optical_depth);
}

// The optical depth that conducts diffuse light so well; the inverse of the above.
fn diffuse_depth(g: f32, conductance: f32) -> f32 {
    return max(1.0 / conductance - 2.0 / 3.0, 0.0) / max(1.0 - g, 1e-3);
}

// The same up, to the four sides together, and down, where the optical depths are up, down and aside.
fn diffuse_conductances(g: f32, depths: vec3f) -> vec3f {
    return vec3f(diffuse_conductance(g, depths.x), 4.0 * diffuse_conductance(g, depths.z), diffuse_conductance(g, depths.y));
}

// Weights of sky, horizon and ground in the source of their diffuse light; they sum to 1.
fn diffuse_shares(conductances: vec3f) -> vec3f {
    return conductances / (conductances.x + conductances.y + conductances.z);
}

// What absorption leaves of diffuse light, by the smaller of the optical depths up and down.
fn diffuse_absorbed(albedo: f32, g: f32, conductances: vec3f) -> f32 {
    return absorbed(albedo, g, diffuse_depth(g, max(conductances.x, conductances.z)));
}

// Transport mean free path: over it light forgets its direction.
fn transport_length(g: f32, mean_free_path: f32) -> f32 {
    return mean_free_path / (1.0 - g);
}

// What leaves a slab by its two faces, of all that leaves a cloud with six: the slab has
// no sides, the cloud has. `faces` and `sides` are conductances from a point. The share of
// the sides that counts is fitted to path traced pictures of humilis, mediocris, congestus
// and the homogeneous sphere, each under three suns: the table in the README.
fn side_loss(faces: f32, sides: f32) -> f32 {
    return faces / (faces + 0.3 * max(sides, 0.0));
}

// What absorption leaves of multiply scattered light at an optical depth below the lit
// surface: the decay of diffusion, with the medium's albedo and asymmetry. 1 where the
// medium is conservative; near the surface it keeps too much.
fn absorbed(albedo: f32, g: f32, optical_depth: f32) -> f32 {
    return exp(-sqrt(max(3.0 * (1.0 - albedo) * (1.0 - albedo * g), 0.0)) * optical_depth);
}
