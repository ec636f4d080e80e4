// Oriented ellipsoids in the frame of their cloud: depth below the surface, chords of rays.

struct Ellipsoid {
    // Rows of the map onto the unit sphere (1/m); w is the inverse radius of that axis.
    row_x: vec4f,
    row_y: vec4f,
    row_z: vec4f,
    center: vec3f,
    // Extinction coefficient of the homogeneous core, 1/m.
    extinction: f32,
    // Thickness of the boundary that noise shapes, m.
    boundary: f32,
    // 0 where the noise is all billows, 1 where it is all wisps.
    wispiness: f32,
    // Scale of the concentric ellipsoid inside which density changes with nothing but height; 0 for none.
    core: f32,
    // Place of its cloud in the medium's table of bodies.
    body: u32,
}

// A point (w = 1) or direction (w = 0) in the space where the ellipsoid is the unit sphere.
fn ellipsoid_unit(e: Ellipsoid, p: vec3f, w: f32) -> vec3f {
    let q = p - w * e.center;
    return vec3f(dot(e.row_x.xyz, q), dot(e.row_y.xyz, q), dot(e.row_z.xyz, q));
}

// First-order depth below the surface, m: (1 - k) / |grad k| with k = |u|. Positive inside.
// The radial depth of [K 2.8-2.12] overestimates flat ellipsoids by their aspect ratio.
// At the centre, where the gradient has no direction, the smallest radius.
fn ellipsoid_depth(e: Ellipsoid, u: vec3f) -> f32 {
    let inverse_radii = vec3f(e.row_x.w, e.row_y.w, e.row_z.w);
    let k = length(u);
    let slope = length(u * inverse_radii);
    let steepest = max(inverse_radii.x, max(inverse_radii.y, inverse_radii.z));
    return (1.0 - k) * select(k / slope, 1.0 / steepest, k < 1e-5);
}

// Outward normal of the concentric ellipsoid through the point, unit length; up at the centre.
fn ellipsoid_normal(e: Ellipsoid, u: vec3f) -> vec3f {
    let gradient = u.x * e.row_x.xyz + u.y * e.row_y.xyz + u.z * e.row_z.xyz;
    let squared = dot(gradient, gradient);
    return select(gradient * inverseSqrt(max(squared, 1e-36)), vec3f(0.0, 1.0, 0.0), squared < 1e-36);
}

// Distances at which a ray enters and leaves the concentric ellipsoid of this `scale`;
// entry beyond exit where it misses. The chord 2 sqrt(B^2 - DC)/D, written with the
// point of closest approach so that nothing cancels far from the ellipsoid.
fn ellipsoid_chord(e: Ellipsoid, origin: vec3f, direction: vec3f, scale: f32) -> vec2f {
    let a = ellipsoid_unit(e, origin, 1.0);
    let v = ellipsoid_unit(e, direction, 0.0);
    let speed = dot(v, v);
    let middle = -dot(a, v) / speed;
    let closest = a + middle * v;
    let left = scale * scale - dot(closest, closest);
    if left <= 0.0 || scale <= 0.0 {
        return vec2f(1e30, -1e30);
    }
    let half = sqrt(left / speed);
    return vec2f(middle - half, middle + half);
}

// How an ellipsoid turns the facing of a cloud at a point of it: its normal, more so farther out, and a
// weight, less so farther out, so that there is no seam where it ends.
fn ellipsoid_facing(e: Ellipsoid, u: vec3f) -> vec4f {
    let weight = max(1.0 - dot(u, u), 0.0);
    return vec4f(weight * dot(u, u) * ellipsoid_normal(e, u), weight);
}

// Smallest radius, m.
fn ellipsoid_thinnest(e: Ellipsoid) -> f32 {
    return 1.0 / max(e.row_x.w, max(e.row_y.w, e.row_z.w));
}

// Thickness of the boundary that steps go by, m, where the largest features of the noise are
// 1 / `frequency`. No boundary is thicker than its ellipsoid.
fn ellipsoid_boundary(e: Ellipsoid, frequency: f32) -> f32 {
    return min(e.boundary, ellipsoid_thinnest(e)) / max(1.0, e.boundary * frequency);
}
