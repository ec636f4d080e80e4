// Rays through boxes, through the cells of a grid, and over the curved earth.

// A direction none of whose parts is 0, to divide by.
fn steady_direction(direction: vec3f) -> vec3f {
    return select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
}

// Distances at which a ray enters and leaves a box; entry beyond exit where it misses.
fn box_span(low: vec3f, high: vec3f, origin: vec3f, direction: vec3f) -> vec2f {
    let inverse = 1.0 / steady_direction(direction);
    let a = (low - origin) * inverse;
    let b = (high - origin) * inverse;
    let near = min(a, b);
    let far = max(a, b);
    return vec2f(max(max(near.x, near.y), max(near.z, 0.0)), min(far.x, min(far.y, far.z)));
}

// Distance to the walls of a cell of a grid and `around` so many cells on all sides of it, and a little
// beyond so that the next cell is another; `place` is in cells, `edge` in metres.
fn cell_exit(place: vec3f, edge: f32, around: f32, direction: vec3f) -> f32 {
    let wall = (floor(place) + select(vec3f(-around), vec3f(1.0 + around), direction > vec3f(0.0)) - place) * edge;
    let ways = abs(wall / steady_direction(direction));
    return min(ways.x, min(ways.y, ways.z)) + 1e-4 * edge;
}

// Distances along a ray between which it is below a height: o + d t + b t^2 < 0, where o is the start's height above
// that, d its slope and b half the curvature of the earth along it, no less
// than the least below. The first is beyond the second where
// it never is.
fn ray_below(o: f32, d: f32, b: f32) -> vec2f {
    let square = d * d - 4.0 * b * o;
    if square <= 0.0 {
        return vec2f(1e30, -1e30);
    }
    // No difference of numbers that are nearly the same.
    let q = -0.5 * (d + select(-1.0, 1.0, d >= 0.0) * sqrt(square));
    let roots = vec2f(q / b, o / select(q, 1e-30, q == 0.0));
    return vec2f(min(roots.x, roots.y), max(roots.x, roots.y));
}

const RAY_LEAST_BEND: f32 = 1e-13;
