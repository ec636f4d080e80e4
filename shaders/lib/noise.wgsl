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
    // Noise that renews itself has two phases: how far each has been carried, m, and what each weighs. All 0
    // where it stands still.
    flow: vec4f,
    // Where each phase begins to read, in periods of the volume.
    first: vec4f,
    second: vec4f,
}

const FINE: f32 = 16.0;

fn noise_coordinate(x: vec4f, y: vec4f, z: vec4f, p: vec3f) -> vec3f {
    let q = vec4f(p, 1.0);
    return vec3f(dot(x, q), dot(y, q), dot(z, q));
}

// How fast what carries the noise rises, and how fast it rolls: both over the speed that the way is told for.
const LIFT: f32 = 0.7;
const ROLL: f32 = 0.6;

// Velocity of a steady flow of eddies that holds no sources, of mean square 1, at a place of the volume: that of
// Arnold, Beltrami and Childress with equal coefficients (Dombre et al. 1986). It repeats as the volume does.
fn noise_eddies(q: vec3f) -> vec3f {
    let turn = 6.283185307 * q;
    let s = sin(turn);
    let c = cos(turn);
    return 0.57735027 * vec3f(s.z + c.y, s.x + c.z, s.y + c.x);
}

// The place that was carried to `p` over a `way`, m: up, and round in eddies of four of the largest billows.
fn noise_carried(frame: NoiseFrame, p: vec3f, way: f32) -> vec3f {
    let eddies = noise_eddies(noise_coordinate(frame.coarse_x, frame.coarse_y, frame.coarse_z, p));
    let turned = eddies.x * frame.coarse_x.xyz + eddies.y * frame.coarse_y.xyz + eddies.z * frame.coarse_z.xyz;
    // Rows are as long as a period is short, m.
    let rolled = turned / max(length(frame.coarse_x.xyz), 1e-12);
    return p - way * (vec3f(0.0, LIFT, 0.0) + ROLL * rolled);
}

// Whether the noise stands still.
fn noise_is_still(frame: NoiseFrame) -> bool {
    return all(frame.flow == vec4f(0.0));
}

// How often the volume is read for the noise at a point.
fn noise_reads(frame: NoiseFrame) -> u32 {
    return select(4u, 2u, noise_is_still(frame));
}

// Billows and wisps at `p`, smoothed to what a pixel of `footprint` metres can see.
fn noise_at(volume: texture_3d<f32>, repeat: sampler, frame: NoiseFrame, p: vec3f, footprint: f32) -> vec2f {
    if noise_is_still(frame) {
        return noise_of_phase(volume, repeat, frame, p, vec3f(0.0), footprint);
    }
    let first = noise_carried(frame, p, frame.flow.x);
    let second = noise_carried(frame, p, frame.flow.y);
    return noise_mixed(noise_of_phase(volume, repeat, frame, first, frame.first.xyz, footprint),
        noise_of_phase(volume, repeat, frame, second, frame.second.xyz, footprint), frame.flow.zw);
}

// Two phases, whose weights have squares that add up to 1: so does the deviation stay what it is.
fn noise_mixed(first: vec2f, second: vec2f, weights: vec2f) -> vec2f {
    return clamp(weights.x * first + weights.y * second, vec2f(-1.0), vec2f(1.0));
}

// Billows and wisps of a phase that begins to read at a `place`.
fn noise_of_phase(volume: texture_3d<f32>, repeat: sampler, frame: NoiseFrame, p: vec3f, place: vec3f,
    footprint: f32) -> vec2f {
    let level = log2(max(footprint * frame.texels_per_metre, 1e-6));
    let coarse = place + noise_coordinate(frame.coarse_x, frame.coarse_y, frame.coarse_z, p);
    let fine = place + noise_coordinate(frame.fine_x, frame.fine_y, frame.fine_z, p);
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
