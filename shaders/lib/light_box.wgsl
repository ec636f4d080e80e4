// A box of voxels around a cloud whose columns run along a direction of light.

struct LightBox {
    // Corner where the light enters, in the cloud's frame, m; unit vectors across and along.
    corner: vec3f,
    size_x: f32,
    across_x: vec3f,
    size_y: f32,
    across_y: vec3f,
    size_z: f32,
    along: vec3f,
    // Distance before the box at which other clouds begin, m; 0 where none casts a shadow here.
    before: f32,
    // Number of ellipsoids of the cloud itself, and with those of others that cast shadows on it.
    own: u32,
    all: u32,
    // Share of extinction in the removed forward peak.
    chop: f32,
    // Asymmetry of the phase function without its peak.
    asymmetry: f32,
}

// Texture coordinates of a point.
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
