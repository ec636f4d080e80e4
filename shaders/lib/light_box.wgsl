// A box of voxels around a cloud whose columns run along a direction of light. Its
// slices lie in a plane of the cloud's frame, so that the box of a flat cloud is flat
// from wherever the light comes: edges across are at right angles, columns may lean.

struct LightBox {
    // Corner where the light enters, in the cloud's frame, m.
    corner: vec3f,
    // Width of a texel across, m.
    texel: f32,
    // Rows of the map from metres to texture coordinates.
    row_u: vec3f,
    // Length of the columns, m.
    length: f32,
    row_v: vec3f,
    // Share of the box across that repeats itself, in the middle of it; 0 where none does.
    repeat: f32,
    row_w: vec3f,
    padding_w: f32,
    // Edges across, m.
    edge_u: vec3f,
    padding_edge_u: f32,
    edge_v: vec3f,
    padding_edge_v: f32,
    // Unit vector along the light.
    along: vec3f,
    padding_along: f32,
}

// Texture coordinates of a point, or of the one like it where the box repeats itself.
fn light_box_coordinate(box: LightBox, p: vec3f) -> vec3f {
    let q = p - box.corner;
    let across = vec2f(dot(q, box.row_u), dot(q, box.row_v));
    if box.repeat <= 0.0 {
        return vec3f(across, dot(q, box.row_w));
    }
    let margin = 0.5 * (1.0 - box.repeat);
    return vec3f(margin + box.repeat * fract((across - margin) / box.repeat), dot(q, box.row_w));
}

// Share of what a volume of `count` slices tells at texture coordinates that holds there: all of it in the box and in its
// shadow, none beside or before it, rising to the middle of the first slice.
fn light_box_entered(uvw: vec3f, count: u32) -> f32 {
    let beside = any(uvw.xy < vec2f(0.0)) || any(uvw.xy > vec2f(1.0));
    return select(saturate(2.0 * f32(count) * uvw.z), 0.0, beside);
}

// Largest optical depth that a volume tells: half floats hold it, no light survives it.
const LIGHT_BOX_MOST: f32 = 30000.0;

// Edge of a brick, voxels: each brick has a list of the ellipsoids that reach into it.
const BRICK: u32 = 8u;

// Bricks along each axis of a box of `size` voxels.
fn light_box_bricks(size: vec3u) -> vec3u {
    return (size + BRICK - 1u) / BRICK;
}

// Number of the brick that holds texture coordinates, or of the nearest one.
fn light_box_brick(size: vec3u, uvw: vec3f) -> u32 {
    let brick = min(vec3u(saturate(uvw) * vec3f(size)), size - 1u) / BRICK;
    let bricks = light_box_bricks(size);
    return (brick.z * bricks.y + brick.y) * bricks.x + brick.x;
}

// The point at texture coordinates.
fn light_box_point(box: LightBox, uvw: vec3f) -> vec3f {
    return box.corner + uvw.x * box.edge_u + uvw.y * box.edge_v + uvw.z * box.length * box.along;
}

// Steeper slopes are cut: light that grazes a rough surface does not care for its every
// bump, and each would draw a streak along the light.
const STEEPEST: f32 = 1.5;

// The lit surface in a column.
struct Surface {
    depth: f32,
    coverage: f32,
}

// Rise of the depth per metre across, from the sides that are covered; where none is,
// this is a rim, which falls away on both sides.
fn covered_slope(before: Surface, here: Surface, after: Surface, texel: f32) -> f32 {
    let backward = min(before.coverage, here.coverage) * (here.depth - before.depth);
    let forward = min(here.coverage, after.coverage) * (after.depth - here.depth);
    let weight = min(before.coverage, here.coverage) + min(here.coverage, after.coverage);
    let rise = (backward + forward) / (max(weight, 1e-4) * texel);
    return clamp(rise, -STEEPEST, STEEPEST);
}

// Normal, against the light, of a surface whose depth along the columns grows by `slope_u`
// and `slope_v` metres per metre across.
fn light_box_normal(box: LightBox, slope_u: f32, slope_v: f32) -> vec3f {
    let u = normalize(box.edge_u);
    let v = normalize(box.edge_v);
    // cross(u + slope_u along, v + slope_v along) without the product of the slopes, which is 0.
    let normal = normalize(cross(u, v) + slope_v * cross(u, box.along) + slope_u * cross(box.along, v));
    return select(normal, -normal, dot(normal, box.along) > 0.0);
}
