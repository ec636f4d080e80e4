// Fractal noise from a periodic volume: the red channel holds billows (rounded
// heaps with sharp valleys), the green one wisps (gradient noise). Each holds
// three normalised octaves in [-1, 1]; a second, eight times finer look-up adds
// three more [K 3.74].

struct NoiseFrame {
    // Rows of the affine map from the cloud's frame to the volume, coarse and fine.
    coarse_x: vec4f,
    coarse_y: vec4f,
    coarse_z: vec4f,
    fine_x: vec4f,
    fine_y: vec4f,
    fine_z: vec4f,
    // Weight of the fine octaves; the sum of both is scaled back to [-1, 1].
    fine_weight: f32,
    // Texels of the volume per metre, coarse look-up.
    texels_per_metre: f32,
    // 1 over the size of the largest features, 1/m.
    frequency: f32,
    padding: f32,
}

const FINE: f32 = 8.0;

fn noise_coordinate(x: vec4f, y: vec4f, z: vec4f, p: vec3f) -> vec3f {
    let q = vec4f(p, 1.0);
    return vec3f(dot(x, q), dot(y, q), dot(z, q));
}

// Billows and wisps at `p`, smoothed to what a pixel of `footprint` metres can see.
fn noise_at(volume: texture_3d<f32>, repeat: sampler, frame: NoiseFrame, p: vec3f, footprint: f32) -> vec2f {
    let level = log2(max(footprint * frame.texels_per_metre, 1e-6));
    let coarse = noise_coordinate(frame.coarse_x, frame.coarse_y, frame.coarse_z, p);
    let fine = noise_coordinate(frame.fine_x, frame.fine_y, frame.fine_z, p);
    let a = textureSampleLevel(volume, repeat, coarse, level).rg;
    let b = textureSampleLevel(volume, repeat, fine, level + log2(FINE)).rg;
    return noise_sum(a, b, frame.fine_weight);
}

// Coarse and fine octaves together, in [-1, 1].
fn noise_sum(coarse: vec2f, fine: vec2f, fine_weight: f32) -> vec2f {
    return (coarse + fine_weight * fine) / (1.0 + fine_weight);
}
