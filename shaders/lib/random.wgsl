// A fixed pattern for jitter: neighbouring pixels differ most.

// Interleaved gradient noise (Jimenez 2014), in [0, 1).
fn interleaved_gradient(pixel: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))));
}
