// The shadow of other clouds on one whose own light repeats itself, such as a layer: it is in a map of the sun's light, and
// not in the light that was prepared. Takes the place of `shade`.
// @use counts light sun_map

@group(0) @binding(10) var<uniform> shade_map: SunMap;
@group(0) @binding(11) var shade_lit: texture_2d_array<f32>;

// Optical depth to the sun that transport sees, and the part of it in the shadow of other clouds.
fn sun_depth(p: vec3f) -> vec2f {
    let own = light_sun_depth(p);
    count(MAP_READS, SUN_MAP_LAYERS);
    return own + sun_map_depth(sun_map_light(shade_map, shade_lit, clamped, p - cloud.camera));
}

// Share of the sun's light that feeds what a layer scatters more than once at a point of it, which is `below` its top, m: light
// that came in anywhere about that place, straight or scattered by what shades.
fn shade_diffuse(p: vec3f, thickness: f32, below: f32, deep: f32) -> f32 {
    // Light begins to diffuse where the beam is met.
    let source = min(deep, 0.5 * thickness);
    let at = p - cloud.camera + vec3f(0.0, below - source, 0.0);
    let radius = sun_map_diffused(thickness, max(below, source));
    let light = sun_map_around(shade_map, shade_lit, clamped, at, radius);
    return light + sun_map_scattered(shade_map, shade_lit, clamped, at, light);
}
