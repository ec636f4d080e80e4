// Multiple forward scattering, as Harris (2003), Riley (2003) and Nes (2008) have it: light that is
// scattered by less than some angle stays in the beam. In the limit of thin slices, and with light
// taken as even across the beam, all three are one formula: sunlight falls off with the optical
// depth less the share that goes on.
// @use forward_cone openness

struct LightSum {
    sun: SunSum,
    diffuse: vec3f,
    // Share of what transport scatters that goes on.
    on: f32,
}

// The share of the phase function without its peak within the cone.
fn light_begin(ray: LightRay) -> LightSum {
    var share = 0.0;
    for (var i = 0u; i < FORWARD_POINTS; i++) {
        let u = phase_coordinate(vec3f(1.0, 0.0, 0.0), forward_direction(i));
        share += forward_ring() * textureSampleLevel(phase_table, linear, vec2f(u, phase_row()), 0.0).g;
    }
    return LightSum(SunSum(), vec3f(0.0), share);
}

fn light_reads_nodes() -> bool {
    return SKY_LIGHT;
}

fn light_piece(sum: LightSum, piece: LitPiece) -> LightSum {
    return LightSum(sun_piece(sum.sun, forward_piece(piece, sum.on)), sum.diffuse, sum.on);
}

fn light_node(sum: LightSum, ray: LightRay, node: Node) -> LightSum {
    return LightSum(sum.sun, diffuse_node(sum.diffuse, ray, node), sum.on);
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    return RayLight(sun_single(sum.sun, ray, seen, lights.sun), vec3f(0.0),
        ray.species.albedo * diffuse_light(sum.diffuse, seen, lights));
}
