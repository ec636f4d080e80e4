// Droplet density, as extinction: noise displaces the boundary of each ellipsoid
// inwards, and the density rises over a width of its own behind it. Continuous by
// construction: zero on the ellipsoid, constant in the core, whatever the noise; save for
// edges that are widened to the width of a pixel, which are cut off there.
// @use ellipsoid

// s(x) = 6x^5 - 15x^4 + 10x^3 on [0, 1] [K 3.2].
fn smooth_rise(x: f32) -> f32 {
    let y = saturate(x);
    return y * y * y * (y * (6.0 * y - 15.0) + 10.0);
}

// The edge of a cloud at a place, and what is behind it.
struct Edge {
    // Extinction coefficient of the core, 1/m.
    extinction: f32,
    // Largest distance by which the noise pushes the boundary inwards, m.
    displacement: f32,
    // Depth behind the displaced boundary over which the density rises, m.
    rise: f32,
    // 0 where the noise is all billows, 1 where it is all wisps.
    wispiness: f32,
    species: u32,
}

fn edge_of(e: Ellipsoid) -> Edge {
    return Edge(e.extinction, e.displacement, e.rise, e.wispiness, e.species);
}

// Depth below the displaced boundary, m, given billows and wisps.
fn displaced_depth(edge: Edge, depth: f32, noise: vec2f) -> f32 {
    let n = mix(noise.x, noise.y, edge.wispiness);
    return depth - 0.5 * edge.displacement * (1.0 - n);
}

// What is at a point.
struct Matter {
    // Extinction coefficient, 1/m: that of the densest ellipsoid, so that overlaps count once.
    extinction: f32,
    // Largest depth below a displaced boundary, m; negative in clear air.
    depth: f32,
    // Distance from the deepest such boundary, or from the end of the rise behind it, m: so far
    // would the extinction stay the same, were there no noise. 0 or less where it changes.
    steady: f32,
    // Distance along the ray at hand in which there is certainly nothing, m; 0 where that is not known.
    clear: f32,
    // Species of the densest ellipsoid.
    species: u32,
}

const CLEAR: Matter = Matter(0.0, -1e30, 0.0, 0.0, 0u);

// What is at a `depth` below an edge that noise has yet to displace, m; `blur` is the width of a
// pixel, m: edges that it could not show are widened to it, about their middle, so that no matter is lost.
fn matter_below(edge: Edge, depth: f32, noise: vec2f, blur: f32) -> Matter {
    let width = max(edge.rise, blur);
    let d = displaced_depth(edge, depth, noise) + 0.5 * (width - edge.rise);
    return Matter(edge.extinction * smooth_rise(d / width), d, max(-d, d - width), 0.0, edge.species);
}

// The union grown by one more ellipsoid.
fn matter_with(matter: Matter, e: Ellipsoid, u: vec3f, noise: vec2f, blur: f32) -> Matter {
    if dot(u, u) >= 1.0 {
        return matter;
    }
    let here = matter_below(edge_of(e), ellipsoid_depth(e, u), noise, blur);
    let deepest = here.depth > matter.depth;
    let denser = here.extinction > matter.extinction;
    // Something else than the deepest ellipsoid decides.
    let other = select(denser, here.extinction < matter.extinction, deepest);
    let steady = select(matter.steady, here.steady, deepest);
    return Matter(max(matter.extinction, here.extinction), max(matter.depth, here.depth),
        select(steady, 0.0, other), 0.0, select(matter.species, here.species, denser));
}
