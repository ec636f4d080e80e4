// Ground that is the same everywhere and from all sides.
// @use ground

// Radiance beyond that of even ground.
fn ground_more(a: Atmosphere, at: GroundPoint) -> vec3f {
    return vec3f(0.0);
}
