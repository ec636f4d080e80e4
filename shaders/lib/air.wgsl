// The Earth's clear atmosphere: air (Rayleigh), haze (Mie), ozone, over a sphere.
// @use constants attenuation
//
// Hillaire, "A Scalable and Production Ready Sky and Atmosphere Rendering
// Technique", EGSR 2020 (below: H); Bruneton and Neyret, "Precomputed Atmospheric
// Scattering", EGSR 2008, and Bruneton's annotated implementation of 2017 (below: B).
// All light is per unit of the sun's irradiance above the atmosphere.
//
// A point is given by its altitude over the ground, never by its radius: at
// 6 360 000 m the steps of f32 are half a metre wide.

struct Atmosphere {
    // Scattering by air at the ground, 1/m, and its scale height, m.
    rayleigh: vec3f,
    rayleigh_height: f32,
    // Absorption in the middle of the ozone layer, 1/m, and the middle's altitude, m.
    ozone: vec3f,
    ozone_altitude: f32,
    ground_albedo: vec3f,
    // From the middle of the ozone layer to where it ends, m.
    ozone_half_width: f32,
    // Scattering and extinction by haze at the ground, 1/m, and its scale height, m.
    mie_scattering: f32,
    mie_extinction: f32,
    mie_height: f32,
    // Asymmetry of the haze's phase function.
    mie_g: f32,
    // Radius of the Earth and height of the atmosphere above it, m.
    ground_radius: f32,
    thickness: f32,
    // Half the angle under which the sun's disc is seen, rad.
    sun_radius: f32,
    padding: f32,
}

// ---- The medium -----------------------------------------------------------------

struct Medium {
    // Scattering by air and by haze, 1/m.
    rayleigh: vec3f,
    mie: f32,
    // All that is lost from a ray, 1/m.
    extinction: vec3f,
}

// What the air holds at `altitude`, m; below the ground it is the ground's air [H, B].
fn atmosphere_medium(a: Atmosphere, altitude: f32) -> Medium {
    let above = max(altitude, 0.0);
    let air = exp(-above / a.rayleigh_height);
    let haze = exp(-above / a.mie_height);
    let ozone = max(1.0 - abs(above - a.ozone_altitude) / a.ozone_half_width, 0.0);
    let rayleigh = air * a.rayleigh;
    return Medium(rayleigh, haze * a.mie_scattering,
        rayleigh + vec3f(haze * a.mie_extinction) + ozone * a.ozone);
}

// Rayleigh's phase function, 1/sr; `nu` is the cosine of the angle of deflection.
fn rayleigh_phase(nu: f32) -> f32 {
    return 0.75 * INV_4PI * (1.0 + nu * nu);
}

// Phase function of haze, 1/sr: Cornette and Shanks, "Physically reasonable analytic
// expression for the single-scattering phase function", Applied Optics 31, 1992.
// `g` is their parameter: for 0.8 the mean cosine is 0.84.
fn haze_phase(g: f32, nu: f32) -> f32 {
    let square = 1.0 + g * g - 2.0 * g * nu;
    return 1.5 * INV_4PI * (1.0 - g * g) / (2.0 + g * g) * (1.0 + nu * nu) / (square * sqrt(square));
}

// ---- Spheres ----------------------------------------------------------------------

// Square of the distance to the horizon: r^2 - R^2 without the cancellation.
fn horizon_square(a: Atmosphere, altitude: f32) -> f32 {
    return altitude * (2.0 * a.ground_radius + altitude);
}

// (R + thickness)^2 - r^2, negative above the atmosphere.
fn square_to_top(a: Atmosphere, altitude: f32) -> f32 {
    return (a.thickness - altitude) * (2.0 * a.ground_radius + a.thickness + altitude);
}

// Cosine of the zenith angle of the horizon.
fn horizon_mu(a: Atmosphere, altitude: f32) -> f32 {
    return -sqrt(max(horizon_square(a, altitude), 0.0)) / (a.ground_radius + altitude);
}

// Distance at which a ray from inside leaves the atmosphere (through the ground,
// where that is in the way), m. 0 from outside, upwards.
fn distance_to_top(a: Atmosphere, altitude: f32, mu: f32) -> f32 {
    let across = (a.ground_radius + altitude) * mu;
    let square = square_to_top(a, altitude);
    let root = sqrt(max(across * across + square, 0.0));
    // Both are the same number; each cancels where the other does not.
    return select(root - across, max(square, 0.0) / (root + across), across > 0.0);
}

// Distance to the ground of a ray below the horizon (mu <= horizon_mu), m. Rays that
// miss the ground get the distance of their lowest point.
fn distance_to_ground(a: Atmosphere, altitude: f32, mu: f32) -> f32 {
    let across = (a.ground_radius + altitude) * mu;
    let square = max(horizon_square(a, altitude), 0.0);
    let root = sqrt(max(across * across - square, 0.0));
    return select(-across, square / max(root - across, 1e-20), across * across > square);
}

// Distance at which the ground hides what is behind it, m; 1e29 where a ray does not meet it. From below the
// ground as from on it: all that is below the horizon is hidden.
fn ground_ahead(a: Atmosphere, altitude: f32, mu: f32) -> f32 {
    let above = max(altitude, 0.0);
    return select(1e29, distance_to_ground(a, above, mu), mu < horizon_mu(a, above));
}

// A ray, by what the atmosphere can tell apart: where it starts, how it goes.
struct AirRay {
    altitude: f32,
    // Cosine of the zenith angle of the ray.
    mu: f32,
    // Cosine of the zenith angle of the sun.
    mu_sun: f32,
    // Cosine of the angle between the ray and the direction to the sun.
    nu: f32,
}

// The ray from `altitude` in this direction.
fn air_ray(altitude: f32, direction: vec3f, to_sun: vec3f) -> AirRay {
    return AirRay(altitude, direction.y, to_sun.y, dot(direction, to_sun));
}

// The same ray seen from the point at distance `t` along it.
fn air_ray_at(a: Atmosphere, ray: AirRay, t: f32) -> AirRay {
    let r = a.ground_radius + ray.altitude;
    let square = horizon_square(a, ray.altitude) + t * (2.0 * r * ray.mu + t);
    // sqrt(R^2 + square) - R without the cancellation.
    let radius = sqrt(a.ground_radius * a.ground_radius + square);
    let altitude = square / (a.ground_radius + radius);
    return AirRay(altitude, clamp((r * ray.mu + t) / radius, -1.0, 1.0),
        clamp((r * ray.mu_sun + t * ray.nu) / radius, -1.0, 1.0), ray.nu);
}

// Distance at which a ray from space enters the atmosphere, m: 0 from inside, negative
// where it misses.
fn distance_to_entry(a: Atmosphere, altitude: f32, mu: f32) -> f32 {
    let across = (a.ground_radius + altitude) * mu;
    let square = square_to_top(a, altitude);
    let inside = square >= 0.0;
    let discriminant = across * across + square;
    if !inside && (across >= 0.0 || discriminant < 0.0) {
        return -1.0;
    }
    return select(-square / (sqrt(max(discriminant, 0.0)) - across), 0.0, inside);
}

// ---- Steps along a ray ------------------------------------------------------------

// Where to put sample `x` (0 to 1) on a stretch of `length` metres whose lowest point is
// at `lowest`: densely about that point, where the air is thickest. Rises from 0 to
// `length`; quadratic on both sides of the lowest point.
fn step_distance(x: f32, lowest: f32, length: f32) -> f32 {
    let before = sqrt(lowest);
    let after = sqrt(max(length - lowest, 0.0));
    let share = before / max(before + after, 1e-20);
    let down = 1.0 - x / max(share, 1e-20);
    let up = (x - share) / max(1.0 - share, 1e-20);
    return select(lowest + (length - lowest) * up * up, lowest * (1.0 - down * down), x < share);
}

// Distance to the lowest point of a ray's first `length` metres.
fn lowest_distance(a: Atmosphere, altitude: f32, mu: f32, length: f32) -> f32 {
    return clamp(-(a.ground_radius + altitude) * mu, 0.0, length);
}

// Integral of exp(-extinction s) over s from 0 to `length`, m.
fn attenuated_length(extinction: vec3f, length: f32) -> vec3f {
    let x = extinction * length;
    return length * vec3f(mean_through(x.x), mean_through(x.y), mean_through(x.z));
}

// Light that a stretch of a ray sends back to its start, and what it lets through.
struct Scattering {
    radiance: vec3f,
    transmittance: vec3f,
}

// Adds a stretch of constant `source` (radiance per metre) and extinction: Hillaire,
// "Physically Based and Unified Volumetric Rendering in Frostbite", SIGGRAPH 2015.
fn scattering_step(before: Scattering, source: vec3f, extinction: vec3f, length: f32) -> Scattering {
    return Scattering(
        before.radiance + before.transmittance * source * attenuated_length(extinction, length),
        before.transmittance * exp(-extinction * length));
}
