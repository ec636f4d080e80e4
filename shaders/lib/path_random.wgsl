// Random numbers for paths: PCG (O'Neill 2014) with 32 bits of state, whose output
// Jarzynski and Olano (2020) found fit for rendering.

fn next_random(state: ptr<function, u32>) -> u32 {
    *state = *state * 747796405u + 2891336453u;
    let word = ((*state >> ((*state >> 28u) + 4u)) ^ *state) * 277803737u;
    return (word >> 22u) ^ word;
}

// In [0, 1), 24 bits.
fn uniform_random(state: ptr<function, u32>) -> f32 {
    return f32(next_random(state) >> 8u) * (1.0 / 16777216.0);
}

// The state at the start of a sample of a pixel: every pair has its own stream.
fn hash_random(pixel: u32, sample: u32, seed: u32) -> u32 {
    var state = pixel * 1597334677u + seed;
    state = next_random(&state) ^ (sample * 3812015801u);
    return next_random(&state);
}
