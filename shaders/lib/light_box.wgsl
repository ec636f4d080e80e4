// A box of voxels around a cloud whose columns run along a direction of light.

struct LightBox {
    // Corner where the light enters, in the cloud's frame, m.
    corner: vec3f,
    // Optical properties that the pass needs: removed share of extinction, see clouds.wgsl.
    chop: f32,
    // Edges of the box, m: across, across, and along the light.
    across_x: vec3f,
    size_x: f32,
    across_y: vec3f,
    size_y: f32,
    along: vec3f,
    size_z: f32,
    // Number of ellipsoids of the cloud itself; those after it only cast shadows.
    ellipsoids: u32,
    occluders: u32,
    // Distance before the box at which occluders begin, m.
    before: f32,
    padding: f32,
}

// Texture coordinates of a point; the axes are unit vectors.
fn light_box_coordinate(box: LightBox, p: vec3f) -> vec3f {
    let q = p - box.corner;
    let metres = vec3f(dot(q, box.across_x), dot(q, box.across_y), dot(q, box.along));
    return metres / vec3f(box.size_x, box.size_y, box.size_z);
}

// The point at texture coordinates.
fn light_box_point(box: LightBox, uvw: vec3f) -> vec3f {
    let metres = uvw * vec3f(box.size_x, box.size_y, box.size_z);
    return box.corner + metres.x * box.across_x + metres.y * box.across_y + metres.z * box.along;
}
