// Sunlight by Beer's law with a powder effect, in one lobe (`lib/powder`), and the light of sky and ground.
// @use powder openness

struct LightSum {
    // Of the sun, without its phase function.
    sun: f32,
    diffuse: vec3f,
}

fn light_begin(ray: LightRay) -> LightSum {
    return LightSum();
}

fn light_reads_nodes() -> bool {
    return SKY_LIGHT;
}

fn light_piece(sum: LightSum, piece: LitPiece) -> LightSum {
    let share = powder_share(piece.optical_depth, piece.before.x, piece.after.x);
    return LightSum(sum.sun + piece.seen * share, sum.diffuse);
}

fn light_node(sum: LightSum, ray: LightRay, node: Node) -> LightSum {
    return LightSum(sum.sun, diffuse_node(sum.diffuse, ray, node));
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    let sun = powder_light(ray.species, sum.sun * seen.share, dot(ray.direction, ray.to_sun));
    return RayLight(sun * lights.sun, vec3f(0.0), ray.species.albedo * diffuse_light(sum.diffuse, seen, lights));
}
