// Sunlight scattered once, and the light of sky and ground.
// @use openness

struct LightSum {
    sun: SunSum,
    diffuse: vec3f,
}

fn light_begin(ray: LightRay) -> LightSum {
    return LightSum();
}

fn light_reads_nodes() -> bool {
    return SKY_LIGHT;
}

fn light_piece(sum: LightSum, piece: LitPiece) -> LightSum {
    return LightSum(sun_piece(sum.sun, piece), sum.diffuse);
}

fn light_node(sum: LightSum, ray: LightRay, node: Node) -> LightSum {
    return LightSum(sum.sun, diffuse_node(sum.diffuse, ray, node));
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    return RayLight(sun_single(sum.sun, ray, seen, lights.sun), vec3f(0.0),
        ray.species.albedo * diffuse_light(sum.diffuse, seen, lights));
}
