// The grid on which light is solved for: a box around a cloud along the axes of its frame.

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
    // Share of the extinction (without the forward peak) that is taken as not scattered.
    ahead: f32,
    // What of each degree 0 to 3 is scattered, per unit of the extinction that is left.
    scattering: vec4f,
    // The sun's beam: the direction of its light, and 1 where this light is the sun's.
    beam: vec4f,
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

// Where a texture that stacks `blocks` fields along z has block `block` of a point, whose
// coordinates in the box are from 0 to 1.
fn field_coordinate(inside: vec3f, depth: f32, block: u32, blocks: u32) -> vec3f {
    let layers = depth / f32(blocks);
    let layer = clamp(inside.z * layers, 0.5, layers - 0.5);
    return vec3f(inside.xy, (f32(block) * layers + layer) / depth);
}
