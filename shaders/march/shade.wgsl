// The shadow of other clouds is in the light that was prepared: nothing is to be read. Where it is not, `shade_map` takes
// this one's place.
// @use light

// Optical depth to the sun that transport sees, and the part of it in the shadow of other clouds.
fn sun_depth(p: vec3f) -> vec2f {
    return light_sun_depth(p);
}

// Share of the sun's light that feeds what is scattered more than once, beside what was prepared.
fn shade_diffuse(p: vec3f, thickness: f32, below: f32, deep: f32) -> f32 {
    return 1.0;
}
