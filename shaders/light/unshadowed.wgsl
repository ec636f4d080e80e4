// What models without shadows share: no optical depth to the sun, and nothing to gather on the way.
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
