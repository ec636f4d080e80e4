// Rays through boxes, and through the cells of a grid.

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
