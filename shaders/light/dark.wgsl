// No light at all: what is opaque is black.
// @use flags lighting

struct LightSum {
    nothing: f32,
}

fn light_begin(ray: LightRay) -> LightSum {
    return LightSum(0.0);
}

fn light_glare(ray: LightRay) -> f32 {
    return 0.0;
}

fn light_transported(species: Species) -> f32 {
    return transported(species);
}

fn light_ahead(species: Species) -> f32 {
    return species.ahead;
}

fn light_reads_nodes() -> bool {
    return false;
}

fn light_sun_depth(p: vec3f) -> vec2f {
    return vec2f(0.0);
}

fn light_piece(sum: LightSum, piece: LitPiece) -> LightSum {
    return sum;
}

fn light_node(sum: LightSum, ray: LightRay, node: Node) -> LightSum {
    return sum;
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    return RayLight(vec3f(0.0), vec3f(0.0));
}
