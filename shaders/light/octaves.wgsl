// Single scattering, and two octaves of it for sunlight scattered more often (`lib/octave`).
// @use octave openness

struct LightSum {
    sun: SunSum,
    // Second and third octave, without their phase functions.
    octaves: vec2f,
    diffuse: vec3f,
}

fn light_begin(ray: LightRay) -> LightSum {
    return LightSum();
}

fn light_reads_nodes() -> bool {
    return SKY_LIGHT;
}

fn light_piece(sum: LightSum, piece: LitPiece) -> LightSum {
    let through = octave_transmittances(piece.optical_depth, piece.before.x, piece.after.x);
    return LightSum(sun_piece(sum.sun, piece), sum.octaves + piece.seen * through, sum.diffuse);
}

fn light_node(sum: LightSum, ray: LightRay, node: Node) -> LightSum {
    return LightSum(sum.sun, sum.octaves, diffuse_node(sum.diffuse, ray, node));
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    let octaves = octave_light(ray.species, sum.octaves * seen.share, dot(ray.direction, ray.to_sun));
    return RayLight(sun_single(sum.sun, ray, seen, lights.sun), octaves * lights.sun,
        ray.species.albedo * diffuse_light(sum.diffuse, seen, lights));
}
