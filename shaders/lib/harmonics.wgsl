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

// Moments of degree 0 to 3 grown by those of light from a direction.
fn harmonics_with(sum: array<vec4f, 4>, light: f32, d: vec3f) -> array<vec4f, 4> {
    return array<vec4f, 4>(sum[0] + light * harmonics_low(d), sum[1] + light * harmonics_square(d),
        sum[2] + light * harmonics_mixed(d), sum[3] + light * harmonics_cubic(d));
}

// Moments of what is scattered of that of each degree this share of `degrees` is.
fn harmonics_scattered(moments: array<vec4f, 4>, degrees: vec4f) -> array<vec4f, 4> {
    return array<vec4f, 4>(degrees.xyyy * moments[0], degrees.zzzz * moments[1],
        degrees.zwww * moments[2], degrees.wwww * moments[3]);
}

// The light towards a direction that has these moments.
fn harmonics_sum(moments: array<vec4f, 4>, d: vec3f) -> f32 {
    return dot(moments[0], harmonics_low(d)) + dot(moments[1], harmonics_square(d))
        + dot(moments[2], harmonics_mixed(d)) + dot(moments[3], harmonics_cubic(d));
}

// How that light changes with the coordinates of the direction, each harmonic taken as the polynomial
// that it is above.
fn harmonics_gradient(moments: array<vec4f, 4>, d: vec3f) -> vec3f {
    let x = d.x;
    let y = d.y;
    let z = d.z;
    let m = moments;
    let squares = 1.0925484 * vec3f(m[1].x * y + m[1].z * z, m[1].x * x + m[1].y * z, m[1].y * y + m[1].z * x)
        + vec3f(0.0, 0.0, 1.8923494 * m[1].w * z) + 1.0925484 * m[2].x * vec3f(x, -y, 0.0);
    let three = x * x - y * y;
    let five = 5.0 * z * z - 1.0;
    let cubes = 1.7701308 * (m[2].y * vec3f(2.0 * x * y, three, 0.0) + m[3].w * vec3f(three, -2.0 * x * y, 0.0))
        + 2.8906114 * m[2].z * vec3f(y * z, x * z, x * y)
        + 0.45704580 * (m[2].w * vec3f(0.0, five, 10.0 * y * z) + m[3].y * vec3f(five, 0.0, 10.0 * x * z))
        + vec3f(0.0, 0.0, 1.1195295 * m[3].x * five)
        + 1.4453057 * m[3].z * vec3f(2.0 * x * z, -2.0 * y * z, three);
    return 0.48860251 * m[0].yzw + squares + cubes;
}
