// From scene-referred light to the screen: exposure, a filmic curve, sRGB.

// Film-like curve: Narkowicz's fit (2015) of the ACES reference transform, per channel.
// 0.18 stays near 0.27, 1 becomes 0.80, and light rolls off to 1 at about 8.
fn filmic(light: vec3f) -> vec3f {
    let x = max(light, vec3f(0.0));
    return saturate(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
}

// IEC 61966-2-1.
fn srgb_encode(linear: vec3f) -> vec3f {
    let low = 12.92 * linear;
    let high = 1.055 * pow(max(linear, vec3f(1e-8)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}
