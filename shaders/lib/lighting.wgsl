// What the march tells a model of light about a ray, and what the model answers.
// @use constants region species

// The ray at hand.
struct LightRay {
    // In the cloud's frame, m, and unit vectors.
    origin: vec3f,
    direction: vec3f,
    to_sun: vec3f,
    // What of the medium it can meet, and what the cloud is made of.
    region: Region,
    species: Species,
    // Half the earth's curvature along the ray, 1/m: heights are above it. 0 where the cloud is small.
    bend: f32,
}

// A piece of a ray that is lit at once. It may be optically thick, and `before` and `after` far apart:
// models take means over it, not values in its middle. Optical depths are transport's, without the peak.
struct LitPiece {
    // Distance of its middle, weighted by what is seen, m.
    t: f32,
    // Optical depth to the sun where it begins and where it ends, and the part of each that is
    // other clouds' shadow.
    before: vec2f,
    after: vec2f,
    // Its own optical depth.
    optical_depth: f32,
    // What is seen of it, and of all that was before it, past other clouds that pass through this one.
    seen: f32,
    gathered: f32,
}

// A point of a ray at which diffuse light is found, for all that is seen around it.
struct Node {
    t: f32,
    // Optical depth to the sun, and the part of it in the shadow of other clouds.
    depth: vec2f,
    seen: f32,
}

// What is seen of a ray.
struct RaySeen {
    // Opacity, without the peak.
    opacity: f32,
    // Full optical depth, peak included.
    optical_depth: f32,
    // Factor on all that was gathered, where the ray ended early.
    share: f32,
    // What of it other clouds that pass through this one let through, and the opacity ratio of all together; 0 where it
    // is alone.
    visible: f32,
    together: f32,
}

// The lights outside: irradiance of the sun across its beam at the height of what is seen,
// radiance of sky, horizon and ground.
struct Lights {
    sun: vec3f,
    sky: vec3f,
    horizon: vec3f,
    ground: vec3f,
}

// Light of a ray, premultiplied by opacity: of the sun, scattered once and more often, and of sky and ground.
struct RayLight {
    single: vec3f,
    multiple: vec3f,
    ambient: vec3f,
}

fn light_ray_at(ray: LightRay, t: f32) -> vec3f {
    return ray.origin + t * ray.direction + vec3f(0.0, ray.bend * t * t, 0.0);
}

// The light of a cloud that glows by itself, of which this much is opaque, where the light outside has this mean over
// all directions.
fn emitted(species: Species, opacity: f32, mean: vec3f) -> vec3f {
    return whole_albedo(species) * opacity * mean;
}

// The mean over all directions of the sun's light, and of that of sky and ground, of which horizon and sky are taken
// as one.
fn mean_of_sun(lights: Lights) -> vec3f {
    return lights.sun / (4.0 * PI);
}

fn mean_of_sky(lights: Lights) -> vec3f {
    return 0.5 * (lights.sky + lights.ground);
}

// Light of sky, horizon and ground by their weights.
fn weighted_lights(weights: vec3f, lights: Lights) -> vec3f {
    return weights.x * lights.sky + weights.y * lights.horizon + weights.z * lights.ground;
}

// Sunlight scattered once more: `source` is per unit of irradiance.
fn scattered_again(species: Species, irradiance: vec3f, source: vec3f) -> vec3f {
    return species.albedo * irradiance * source;
}
