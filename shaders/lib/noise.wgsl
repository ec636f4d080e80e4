// Fractal noise by a power law from a periodic volume. Its red channel holds billows (rounded heaps
// with sharp valleys) of octaves 1 and 2, its green one those of octaves 3 and 4, its blue one wisps
// (curled veils) of all four. A second, sixteen times finer look-up adds four more octaves [K 3.74].

struct NoiseFrame {
    // Rows of the affine map from the cloud's frame to the volume, coarse and fine.
    coarse_x: vec4f,
    coarse_y: vec4f,
    coarse_z: vec4f,
    fine_x: vec4f,
    fine_y: vec4f,
    fine_z: vec4f,
    // Amplitudes of octaves 3, 5 and 7 over that of the first.
    amplitudes: vec3f,
    // Makes the deviation of all octaves that of one.
    scale: f32,
    // Texels of the volume per metre, coarse look-up.
    texels_per_metre: f32,
    // 1 over the size of the largest features, 1/m.
    frequency: f32,
    padding: vec2f,
}

const FINE: f32 = 16.0;

fn noise_coordinate(x: vec4f, y: vec4f, z: vec4f, p: vec3f) -> vec3f {
    let q = vec4f(p, 1.0);
    return vec3f(dot(x, q), dot(y, q), dot(z, q));
}

// Billows and wisps at `p`, smoothed to what a pixel of `footprint` metres can see.
fn noise_at(volume: texture_3d<f32>, repeat: sampler, frame: NoiseFrame, p: vec3f, footprint: f32) -> vec2f {
    let level = log2(max(footprint * frame.texels_per_metre, 1e-6));
    let coarse = noise_coordinate(frame.coarse_x, frame.coarse_y, frame.coarse_z, p);
    let fine = noise_coordinate(frame.fine_x, frame.fine_y, frame.fine_z, p);
    let a = textureSampleLevel(volume, repeat, coarse, level);
    let b = textureSampleLevel(volume, repeat, fine, level + log2(FINE));
    return noise_sum(a, b, frame.amplitudes, frame.scale);
}

// How much of the finer octaves there is on what coarser ones have made: they ride on crests, and leave
// valleys sharp.
const RIDE: f32 = 0.9;

fn noise_ride(billows: f32) -> f32 {
    return max(1.0 + RIDE * billows, 0.1);
}

// All octaves together, in [-1, 1].
fn noise_sum(coarse: vec4f, fine: vec4f, amplitudes: vec3f, scale: f32) -> vec2f {
    var billows = coarse.r;
    billows += amplitudes.x * noise_ride(billows) * coarse.g;
    billows += amplitudes.y * noise_ride(billows) * fine.r;
    billows += amplitudes.z * noise_ride(billows) * fine.g;
    let wisps = coarse.b + amplitudes.y * fine.b;
    return clamp(scale * vec2f(billows, wisps), vec2f(-1.0), vec2f(1.0));
}
