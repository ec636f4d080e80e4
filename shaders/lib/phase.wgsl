// Phase functions come as tables over the angle between the propagation before and after
// scattering; here is where in the table an angle is, and what the forward peak adds.
// @use constants attenuation

// Coordinate of a scattering angle in a phase table whose texels are even in
// sqrt(theta / pi) up to the middle and mirrored beyond: dense at the forward peak
// and at the glory. Written with half angles from the chord, because acos is poor
// near its ends: |a - b| = 2 sin(theta / 2).
fn phase_coordinate(before: vec3f, after: vec3f) -> f32 {
    let forward = 2.0 * asin_small(0.5 * length(after - before));
    let backward = 2.0 * asin_small(0.5 * length(after + before));
    let is_forward = forward < backward;
    let share = select(backward, forward, is_forward) / PI;
    let half = sqrt(0.5 * share);
    return select(1.0 - half, half, is_forward);
}

// Rows of a phase table: the function without its peak, then the peak by the optical depth that light has come through in it
// alone, which widens it.
const PEAKS: u32 = 6u;

// Coordinate of the row of the function without its peak.
fn phase_row() -> f32 {
    return 0.5 / f32(PEAKS + 1u);
}

// Coordinate of the row of the peak after an optical depth of it: rows are even in m / (m + 2).
fn peak_row(depth: f32) -> f32 {
    return (1.5 + f32(PEAKS - 1u) * depth / (depth + 2.0)) / f32(PEAKS + 1u);
}

// asin on [0, 0.7072]: a minimax polynomial, within 2e-7 of the value.
fn asin_small(x: f32) -> f32 {
    let y = min(x, 0.7072);
    let z = y * y;
    let tail = z * (0.03899976 + z * (0.06057287 + z * (-0.05480595 + z * 0.10097281)));
    return y * (1.0 + z * (0.16665371 + z * (0.07547188 + tail)));
}

// Sunlight that reaches a stretch of a ray, as a mean over what is seen of it through its own
// optical depth, where the optical depth to the sun goes evenly from `before` to `after`.
fn sunlight_share(optical_depth: f32, before: f32, after: f32) -> f32 {
    return mean_transmittance(before, optical_depth + after) / mean_through(optical_depth);
}

// Share of the light that was scattered only within the truncated forward peak, which has the share
// f = `truncated` of the extinction, over an optical depth: e^{-(1 - f) tau} - e^{-tau}, the corrected [K 3.66], as a product; to
// be multiplied by the peak's shape P_peak / f.
fn recovered_peak(optical_depth: f32, truncated: f32) -> f32 {
    let peak = truncated * optical_depth;
    return exp(peak - optical_depth) * peak * mean_through(peak);
}
