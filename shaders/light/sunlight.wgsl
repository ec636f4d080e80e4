// Sunlight scattered once, from the volume of optical depth to the sun: what all models share that
// have shadows.
// @use counts flags light_box lighting phase sun_sum

// Where the light of a cloud was prepared.
struct Light {
    // Boxes of the sun's volume and maps, and of openness to sky and ground.
    sun: LightBox,
    sky: LightBox,
    // Least corner of the box of the solved field, m, and 1 over its extent.
    field_low: vec3f,
    // Mean free path of transport in the densest core, m.
    mean_free_path: f32,
    field_scale: vec3f,
    padding: f32,
    // A ball that shines in the cloud in place of the sun: its centre and radius, m.
    flash: vec4f,
}

@group(2) @binding(0) var<uniform> light: Light;
@group(2) @binding(1) var linear: sampler;
@group(2) @binding(2) var phase_table: texture_2d<f32>;
@group(2) @binding(3) var sun_volume: texture_3d<f32>;

// After an optical depth of the peak.
fn sun_phase(ray: LightRay, depth: f32) -> SunPhase {
    let u = phase_coordinate(-ray.to_sun, -ray.direction);
    return SunPhase(textureSampleLevel(phase_table, linear, vec2f(u, phase_row()), 0.0).rgb,
        textureSampleLevel(phase_table, linear, vec2f(u, peak_row(depth)), 0.0).rgb);
}

// What a ray sees of sunlight scattered once, with the peak's recovered. What a model takes as going
// straight on scatters all the same.
fn sun_single(sum: SunSum, ray: LightRay, seen: RaySeen, irradiance: vec3f) -> vec3f {
    let phase = sun_phase(ray, ray.species.truncated * seen.optical_depth);
    var single = sun_scattered(sum, phase, seen) / (1.0 - light_ahead(ray.species));
    if PEAK {
        single += sun_recovered(sum, phase, ray.species.truncated, seen);
    }
    return single * irradiance;
}

// The role's parts that are the same wherever there are shadows.

// Optical depth to the sun that transport sees, and the part of it in the shadow of other clouds.
fn light_sun_depth(p: vec3f) -> vec2f {
    count(MAP_READS, 1u);
    return textureSampleLevel(sun_volume, linear, light_box_coordinate(light.sun, p), 0.0).rg;
}

// How much brighter than usual light is that comes straight from the sun's direction, 1/sr.
fn light_glare(ray: LightRay) -> f32 {
    return sun_phase(ray, 0.0).peak.g;
}

fn light_transported(species: Species) -> f32 {
    return transported(species);
}
