// Droplet density, as extinction. The depths of a cloud's lumps are joined into one, noise displaces the
// boundary that they make inwards, and the density rises over a width of its own behind it. Continuous by
// construction: zero on the cloud's hull, whatever the noise; save for edges that are widened to
// the width of a pixel, which are cut off there.
// @use body ellipsoid

// s(x) = 6x^5 - 15x^4 + 10x^3 on [0, 1] [K 3.2].
fn smooth_rise(x: f32) -> f32 {
    let y = saturate(x);
    return y * y * y * (y * (6.0 * y - 15.0) + 10.0);
}

// The lumps of a cloud that hold a point, each of which weighs by a power of its depth: none where it
// ends, so that nothing jumps there.
struct Lumps {
    weight: f32,
    // Weighted sums of extinction, 1/m, thickness of the boundary, m, and wispiness.
    extinction: f32,
    boundary: f32,
    wispiness: f32,
    // Depth in the deepest lump, m.
    deepest: f32,
}

const NO_LUMPS: Lumps = Lumps(0.0, 0.0, 0.0, 0.0, -1e30);

// What a lump weighs at a `depth` in it, told in `reach`.
fn lump_weight(depth: f32, power: f32, reach: f32) -> f32 {
    return select(0.0, pow(max(depth / reach, 1e-4), power), depth > 0.0);
}

// The lumps and one more, which is `depth` deep at the point.
fn lumps_with(lumps: Lumps, e: Ellipsoid, depth: f32, power: f32, reach: f32) -> Lumps {
    let w = lump_weight(depth, power, reach);
    return Lumps(lumps.weight + w, lumps.extinction + w * e.extinction, lumps.boundary + w * e.boundary,
        lumps.wispiness + w * e.wispiness, max(lumps.deepest, depth));
}

// The edge of a cloud at a place, and what is behind it.
struct Edge {
    // Depth below the hull, m.
    depth: f32,
    // Extinction coefficient behind the boundary at the cloud's top, 1/m.
    extinction: f32,
    // Thickness of the boundary that noise shapes, m.
    boundary: f32,
    // 0 where the noise is all billows, 1 where it is all wisps.
    wispiness: f32,
}

// What the lumps make together: the norm of their depths by this power, which is that of one
// where there is one, and their means.
fn lumps_edge(lumps: Lumps, power: f32, reach: f32) -> Edge {
    if lumps.weight <= 0.0 {
        return Edge(lumps.deepest, 0.0, 0.0, 0.0);
    }
    let share = 1.0 / lumps.weight;
    return Edge(reach * pow(lumps.weight, 1.0 / power), share * lumps.extinction, share * lumps.boundary,
        share * lumps.wispiness);
}

// Share of the boundary over which the density rises, where it is all billows and all wisps. The rest is
// displacement by noise.
const RISE: vec2f = vec2f(0.06, 0.4);
const LEAST_RISE: f32 = 1e-3;

// Depth behind the displaced boundary over which the density rises, m.
fn edge_rise(edge: Edge) -> f32 {
    return max(edge.boundary * mix(RISE.x, RISE.y, edge.wispiness), LEAST_RISE);
}

// Depth below the displaced boundary, m, given billows and wisps.
fn displaced_depth(edge: Edge, rise: f32, noise: vec2f) -> f32 {
    let n = mix(noise.x, noise.y, edge.wispiness);
    return edge.depth - 0.5 * max(edge.boundary - rise, 0.0) * (1.0 - n);
}

// What is at a point.
struct Matter {
    // Extinction coefficient, 1/m: that of the densest cloud, so that overlaps count once.
    extinction: f32,
    // Largest depth below a displaced boundary, m; negative in clear air.
    depth: f32,
    // Distance from the boundary, or from the end of the rise behind it, m: so far would the extinction
    // stay the same, were there no noise. 0 or less where it changes.
    steady: f32,
    // Distance along the ray at hand in which there is certainly nothing, m; 0 where that is not known.
    clear: f32,
    // Place of the densest cloud in the table of bodies.
    body: u32,
}

const CLEAR: Matter = Matter(0.0, -1e30, 0.0, 0.0, 0u);

// Depth below the hull, in boundaries, down to which a rim has lost droplets.
const DILUTED: f32 = 3.0;
// Share of the depth, or of the height above the base, over which an uneven extinction is as good as even.
const EVEN: f32 = 0.3;

// How much deeper below the hull each metre above the level of a cloud counts: noise moves its base by so much less
// than its flanks.
const LEVELLING: f32 = 2.5;

// Depth below the hull that the level of a cloud makes, at a height `y`, m.
fn level_depth(body: Body, y: f32) -> f32 {
    return LEVELLING * (y - body.level);
}

// Share of the droplets that are left at a `depth` below the displaced boundary.
fn undiluted(dilution: f32, depth: f32, boundary: f32) -> f32 {
    return 1.0 - dilution * (1.0 - smooth_rise(depth / ((DILUTED - 1.0) * max(boundary, LEAST_RISE))));
}

// What is at a height `y` at an edge that noise has yet to displace; `blur` is the width of a
// pixel, m: edges that it could not show are widened to it, about their middle, so that no matter is lost.
fn matter_below(body: Body, index: u32, hull: Edge, y: f32, noise: vec2f, blur: f32) -> Matter {
    let low = level_depth(body, y);
    // Metres of depth by metre of way.
    let steepness = select(1.0, LEVELLING, low < hull.depth);
    let edge = Edge(min(hull.depth, low), hull.extinction, hull.boundary, hull.wispiness);
    let rise = edge_rise(edge);
    let width = max(rise, steepness * blur);
    let d = displaced_depth(edge, rise, noise) + 0.5 * (width - rise);
    let height = y - body.base;
    let profile = height_profile(height * body.inverse_height, body.stratification);
    let kept = undiluted(body.dilution, d, edge.boundary);
    let extinction = edge.extinction * profile * kept * smooth_rise(d / width);
    let inside = d - select(width, max(width, (DILUTED - 1.0) * edge.boundary), body.dilution > 0.0);
    let even = select(inside, min(inside, EVEN * min(edge.depth, max(height, 0.0))), body.uneven > 0.0);
    return Matter(extinction, d, max(-d, even) / steepness, 0.0, index);
}

// What is deep in a cloud, at a height `y`.
fn matter_at_height(body: Body, matter: Matter, y: f32) -> Matter {
    let height = y - body.base;
    let profile = height_profile(height * body.inverse_height, body.stratification);
    let even = min(matter.steady, EVEN * max(height, 0.0));
    return Matter(profile * matter.extinction, matter.depth, select(matter.steady, even, body.uneven > 0.0),
        matter.clear, matter.body);
}

// Two clouds: the denser one counts.
fn matter_union(a: Matter, b: Matter) -> Matter {
    var both = a;
    if b.extinction > a.extinction || (a.extinction <= 0.0 && b.depth > a.depth) {
        both = b;
    }
    let alone = min(a.extinction, b.extinction) <= 0.0;
    both.steady = select(0.0, both.steady, alone);
    both.depth = max(a.depth, b.depth);
    return both;
}
