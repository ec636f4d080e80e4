// Light that dies away with optical depth, without the cancellation of 1 - e^-x.

// Mean of e^-s for s from 0 to `x`, 0 or more: (1 - e^-x) / x. Times x it is what is lost on the
// way. Below 0.7 the difference loses digits: a minimax polynomial, within 2e-8.
fn mean_through(x: f32) -> f32 {
    let near = 1.0 - x * (0.49999931 - x * (0.16665294 - x * (0.041576956 - x * (0.0080732534 - x * 0.00103571))));
    return select((1.0 - exp(-x)) / max(x, 0.7), near, x < 0.7);
}

// Mean of e^-s for s between `a` and `b`.
fn mean_transmittance(a: f32, b: f32) -> f32 {
    return exp(-min(a, b)) * mean_through(abs(b - a));
}
