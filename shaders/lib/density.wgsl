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

// Depth below the displaced boundary, m, given billows and wisps.
fn displaced_depth(e: Ellipsoid, depth: f32, noise: vec2f) -> f32 {
    let n = mix(noise.x, noise.y, e.wispiness);
    return depth - 0.5 * e.displacement * (1.0 - n);
}

// What the union of ellipsoids holds at a point.
struct Matter {
    // Extinction coefficient, 1/m: that of the densest ellipsoid, so that overlaps count once.
    extinction: f32,
    // Largest depth below a displaced boundary, m; negative in clear air.
    depth: f32,
    // Distance from the deepest such boundary, or from the end of the rise behind it, m: so far
    // would the extinction stay the same, were there no noise. 0 or less where it changes.
    steady: f32,
    // Species of the densest ellipsoid.
    species: u32,
}

const CLEAR: Matter = Matter(0.0, -1e30, 0.0, 0u);

// The union grown by one more ellipsoid; `blur` is the width of a pixel, m: edges that
// it could not show are widened to it, about their middle, so that no matter is lost.
fn matter_with(matter: Matter, e: Ellipsoid, u: vec3f, noise: vec2f, blur: f32) -> Matter {
    if dot(u, u) >= 1.0 {
        return matter;
    }
    let width = max(e.rise, blur);
    let depth = displaced_depth(e, ellipsoid_depth(e, u), noise) + 0.5 * (width - e.rise);
    let extinction = e.extinction * smooth_rise(depth / width);
    let deepest = depth > matter.depth;
    let steady = select(matter.steady, max(-depth, depth - width), deepest);
    // Something else than the deepest ellipsoid decides.
    let other = select(extinction > matter.extinction, extinction < matter.extinction, deepest);
    return Matter(max(matter.extinction, extinction), max(matter.depth, depth), select(steady, 0.0, other),
        select(matter.species, e.species, extinction > matter.extinction));
}
