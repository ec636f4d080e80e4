// From scene-referred light to the screen: exposure, a filmic curve, sRGB.

// Hable's film curve ("Uncharted 2", GDC 2010), before scaling to its white.
fn film(x: vec3f) -> vec3f {
    return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.0666667;
}

// Linear display light in [0, 1]; scene light of `white` and above becomes 1.
fn filmic(light: vec3f, white: f32) -> vec3f {
    return saturate(film(max(light, vec3f(0.0))) / film(vec3f(white)));
}

// IEC 61966-2-1.
fn srgb_encode(linear: vec3f) -> vec3f {
    let low = 12.92 * linear;
    let high = 1.055 * pow(max(linear, vec3f(1e-8)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}
