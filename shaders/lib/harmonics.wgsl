// Real spherical harmonics of degree 0 to 3, orthonormal over the sphere: the sum over a
// degree of products at two directions is (2l + 1) / (4 pi) P_l of their cosine.
// @use constants

// Degree 0 and 1; all of degree 2 but one; that one and three of degree 3; the rest.
fn harmonics_low(d: vec3f) -> vec4f {
    return vec4f(0.28209479, 0.48860251 * d);
}

fn harmonics_square(d: vec3f) -> vec4f {
    return vec4f(1.0925484 * d.xyx * d.yzz, 0.31539157 * (3.0 * d.z * d.z - 1.0));
}

fn harmonics_mixed(d: vec3f) -> vec4f {
    let x = d.x * d.x;
    let y = d.y * d.y;
    return vec4f(0.54627422 * (x - y), 0.59004359 * d.y * (3.0 * x - y), 2.8906114 * d.x * d.y * d.z,
        0.45704580 * d.y * (5.0 * d.z * d.z - 1.0));
}

fn harmonics_cubic(d: vec3f) -> vec4f {
    let x = d.x * d.x;
    let y = d.y * d.y;
    let z = d.z * d.z;
    return vec4f(0.37317633 * d.z * (5.0 * z - 3.0), 0.45704580 * d.x * (5.0 * z - 1.0),
        1.4453057 * d.z * (x - y), 0.59004359 * d.x * (x - 3.0 * y));
}
