// The grid on which light is solved for: a box around a cloud along the axes of its frame.
// @use attenuation

struct Field {
    // Least corner in the cloud's frame, m.
    low: vec3f,
    // Directions of the quadrature.
    directions: u32,
    // Edges of a cell, m.
    cell: vec3f,
    // Lights that are solved for side by side.
    lights: u32,
    // Cells along each axis.
    size: vec3u,
    // Share of the extinction (without the forward peak) that is truncated once more: taken as not
    // scattered, for the field's few degrees hold nothing narrower.
    truncated: f32,
    // What of each degree 0 to 3 is scattered, per unit of the extinction that is left.
    scattering: vec4f,
    // The sun's beam: the direction of its light, and 1 where this light is the sun's.
    beam: vec4f,
    // A ball that shines in the cloud: its centre and radius, m; a radius of 0 for none.
    flash: vec4f,
    // 1 where the box repeats itself along x and z, else 0.
    repeats: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

// A cell: extinction per metre without what goes straight on, and the share of the beam
// that reaches its droplets.
struct FieldCell {
    extinction: f32,
    beam: f32,
}

fn field_cells(field: Field) -> u32 {
    return field.size.x * field.size.y * field.size.z;
}

fn field_index(field: Field, at: vec3u) -> u32 {
    return (at.z * field.size.y + at.y) * field.size.x + at.x;
}

fn field_place(field: Field, index: u32) -> vec3u {
    let row = index / field.size.x;
    return vec3u(index % field.size.x, row % field.size.y, row / field.size.y);
}

// Coordinates in the box, from 0 to 1, of a point; `scale` is 1 over the box's extent.
fn field_inside(low: vec3f, scale: vec3f, p: vec3f) -> vec3f {
    return (p - low) * scale;
}

// A cell, or the one like it where the box repeats itself; else the nearest.
fn field_held(field: Field, at: vec3f) -> vec3u {
    let size = vec3f(field.size);
    let nearest = clamp(at, vec3f(0.0), size - 1.0);
    let like = at - size * floor(at / size);
    return vec3u(select(nearest, vec3f(like.x, nearest.y, like.z), field.repeats == 1u));
}

// Texture coordinates in a stack of `count` pictures of a field that repeats itself, of the place `inside` its box in
// picture `number`: pictures lie one above the other, and have a cell of the opposite side around x and z.
fn field_tile_place(texels: vec3f, inside: vec3f, number: u32, count: u32) -> vec3f {
    let cells = texels - vec3f(2.0, 0.0, 2.0);
    let high = cells.y / f32(count);
    let y = f32(number) * high + clamp(inside.y * high, 0.5, high - 0.5);
    let around = 1.0 + cells * fract(inside);
    return vec3f(around.x, y, around.z) / texels;
}

// Where the middle of a cell is among the middles of the cells of another field of the same box.
fn field_within(field: Field, other: Field, index: u32) -> vec3f {
    return (vec3f(field_place(field, index)) + 0.5) * vec3f(other.size) / vec3f(field.size) - 0.5;
}

// The `i`th of eight points of a cell.
fn field_sample(field: Field, index: u32, i: u32) -> vec3f {
    let corner = field.low + vec3f(field_place(field, index)) * field.cell;
    return corner + (0.25 + 0.5 * vec3f(vec3u(i, i >> 1u, i >> 2u) & vec3u(1u))) * field.cell;
}

// What an optical depth to the sun, without the forward peak, leaves of the beam.
fn field_beam(field: Field, depth: f32) -> f32 {
    return exp(-(1.0 - field.truncated) * depth);
}

// Mean length along the beam through a cell: its volume over its face across the light.
fn field_length(field: Field) -> f32 {
    let d = abs(field.beam.xyz);
    return 1.0 / max(d.x / field.cell.x + d.y / field.cell.y + d.z / field.cell.z, 1e-12);
}

// Optical thickness of a cell, the cube of its volume, beyond which it is no darker: light gets into neither.
const THICKEST: f32 = 3.0;

// A cell from sums over eight points: of the extinction without the forward peak, of that times what
// reaches it of the beam, and of the latter alone. No more light is scattered in a cell than comes in by
// its face. Eight points of a thick cell may see too much of it.
fn field_cell(field: Field, extinction: f32, lit: f32, open: f32) -> FieldCell {
    let edge = pow(field.cell.x * field.cell.y * field.cell.z, 1.0 / 3.0);
    let mean = min(0.125 * (1.0 - field.truncated) * extinction, THICKEST / edge);
    let most = mean_through(field_length(field) * mean);
    return FieldCell(mean, select(0.125 * open, min(lit / extinction, most), extinction > 0.0));
}

// Most of the mean light of a cell that a coarser field adds or takes off.
const MOST_BEYOND: f32 = 0.5;

// How much of the difference between a cell's light and that of a coarser field comes on top: `share` of it, where that is
// not too much of the mean light `here`, which is `before` on the coarser one.
fn field_beyond(here: f32, before: f32, share: f32) -> f32 {
    return min(share, MOST_BEYOND * abs(here) / max(abs(here - before), 1e-30));
}

// Where a texture that stacks `blocks` fields along z has block `block` of a point, whose
// coordinates in the box are from 0 to 1.
fn field_coordinate(inside: vec3f, depth: f32, block: u32, blocks: u32) -> vec3f {
    let layers = depth / f32(blocks);
    let layer = clamp(inside.z * layers, 0.5, layers - 0.5);
    return vec3f(inside.xy, (f32(block) * layers + layer) / depth);
}
