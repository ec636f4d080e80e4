// A soft ball that shines alike to all sides: its power falls off with the distance from its centre as a Gaussian,
// whose deviation is half the ball's radius. Exact on any grid: what shines from a box is an integral.
// @use constants

// Share of a Gaussian of deviation 1 below x, with an error of 1e-7 (Abramowitz and Stegun 7.1.26).
fn normal_below(x: f32) -> f32 {
    let u = abs(x) * 0.70710678;
    let t = 1.0 / (1.0 + 0.3275911 * u);
    let tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * exp(-u * u);
    return select(0.5 * tail, 1.0 - 0.5 * tail, x >= 0.0);
}

// Share of the power of a ball (its centre and radius) that shines from a box.
fn flash_share(ball: vec4f, low: vec3f, high: vec3f) -> f32 {
    let near = 2.0 * (low - ball.xyz) / ball.w;
    let far = 2.0 * (high - ball.xyz) / ball.w;
    return (normal_below(far.x) - normal_below(near.x)) * (normal_below(far.y) - normal_below(near.y))
        * (normal_below(far.z) - normal_below(near.z));
}

// What shines from a box, 1/(m sr), per unit of the irradiance that the ball has at its radius in clear air: the power
// per solid angle over the box's volume.
fn flash_emission(radius: f32, share: f32, volume: f32) -> f32 {
    return radius * radius * share / volume;
}

// What the ball gives off along a line through `p`, per unit of the irradiance at its radius: the radiance of one
// that nothing is before.
fn flash_along(ball: vec4f, p: vec3f, d: vec3f) -> f32 {
    let deviation = 0.5 * ball.w;
    let past = length(cross(ball.xyz - p, d)) / deviation;
    return ball.w * ball.w * exp(-0.5 * past * past) / (2.0 * PI * deviation * deviation);
}

// Share of light along a line that was scattered, but by the forward peak alone: of which `through` is left where the
// share `kept` of the extinction counts, less what was not scattered at all.
fn flash_forward(through: f32, kept: f32) -> f32 {
    return max(through - pow(max(through, 0.0), 1.0 / kept), 0.0);
}

// Irradiance that comes from a point of the ball that is chosen from `p` as the path tracer does it, over the
// density of that choice and the irradiance at the ball's radius. `d` and `away` lead to the point.
fn flash_weight(ball: vec4f, p: vec3f, d: vec3f, away: f32) -> f32 {
    let along = flash_along(ball, p, d);
    return 4.0 * PI * along / (1.0 + 2.0 * PI * away * away * along / (ball.w * ball.w));
}
