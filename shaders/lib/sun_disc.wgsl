// The disc of the sun, and the horizon, as pixels show them.
// @use air constants

// Share of a pixel, of angle `pixel`, that is above the horizon, in the direction of zenith cosine `mu`.
fn share_above(a: Atmosphere, altitude: f32, mu: f32, pixel: f32) -> f32 {
    // The zenith angle changes by sin(horizon) = R / r times less than its cosine.
    let angle = (mu - horizon_mu(a, altitude)) * (a.ground_radius + altitude) / a.ground_radius;
    return saturate(0.5 + angle / pixel);
}

// Exponents of the darkening towards the sun's limb, of the cosine of the angle to the
// sun's surface: Hestroffer and Magnan, "Wavelength dependency of the solar limb
// darkening", A&A 333, 1998, in the red, green and blue as Hillaire uses them.
const LIMB: vec3f = vec3f(0.397, 0.503, 0.652);

// Radius of the disc as a chord, of angular radius `radius`, drawn no smaller than a pixel. (Cosines
// are all 1 here.)
fn disc_radius(radius: f32, pixel: f32) -> f32 {
    return max(2.0 * sin(0.5 * radius), 0.5 * pixel);
}

// Share of a pixel that the disc covers, at this chord from its centre.
fn disc_share(radius: f32, pixel: f32, from_center: f32) -> f32 {
    return saturate(0.5 + (radius - from_center) / pixel);
}

// Radiance of the disc, which gives this irradiance across its beam. A disc smaller than a pixel is drawn as large as
// the pixel and dimmer, so that it neither flickers nor gains light.
fn disc_radiance(irradiance: vec3f, radius: f32, pixel: f32, from_center: f32) -> vec3f {
    // Pixels on the edge take the limb of their inner half; one pixel alone has none.
    let sharp = 1.0 - 0.5 * pixel / radius;
    // 1 less the distance from the centre, over the radius: at the rim it is small.
    let inside = max((radius - from_center) / radius, 0.5 * pixel / radius);
    let exponent = 0.5 * sharp * LIMB;
    // Its mean over the disc is 1.
    let limb = (1.0 + exponent) * pow(vec3f(max(inside * (2.0 - inside), 1e-6)), exponent);
    // The integral of `disc_share` is the solid angle, edge included.
    return limb * irradiance / (PI * (radius * radius + pixel * pixel / 12.0));
}
