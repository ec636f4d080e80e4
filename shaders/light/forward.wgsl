// Multiple forward scattering, as Harris (2003), Riley (2003) and Nes (2008) have it: light that is
// scattered by less than some angle stays in the beam. In the limit of thin slices, and with light
// taken as even across the beam, all three are one formula: sunlight falls off with the optical
// depth less the share that goes on.
// @use openness

// Largest angle of scattering that leaves light in the beam, rad: 20 degrees.
const FORWARD_ANGLE: f32 = 0.34906585;
// Points of the sum over that cone.
const FORWARD_POINTS: u32 = 8u;

struct LightSum {
    sun: SunSum,
    diffuse: vec3f,
    // Share of what transport scatters that goes on.
    on: f32,
}

// The share of the phase function without its peak within the cone: a sum over rings of equal width
// in cosine, in which it is smooth.
fn light_begin(ray: LightRay) -> LightSum {
    let ring = (1.0 - cos(FORWARD_ANGLE)) / f32(FORWARD_POINTS);
    var share = 0.0;
    for (var i = 0u; i < FORWARD_POINTS; i++) {
        let cosine = 1.0 - (f32(i) + 0.5) * ring;
        let u = phase_coordinate(vec3f(1.0, 0.0, 0.0), vec3f(cosine, sqrt(1.0 - cosine * cosine), 0.0));
        share += 2.0 * PI * ring * textureSampleLevel(phase_table, linear, vec2f(u, 0.25), 0.0).g;
    }
    return LightSum(SunSum(), vec3f(0.0), share);
}

fn light_reads_nodes() -> bool {
    return SKY_LIGHT;
}

fn light_piece(sum: LightSum, piece: LitPiece) -> LightSum {
    var dimmed = piece;
    dimmed.before.x *= 1.0 - sum.on;
    dimmed.after.x *= 1.0 - sum.on;
    return LightSum(sun_piece(sum.sun, dimmed), sum.diffuse, sum.on);
}

fn light_node(sum: LightSum, ray: LightRay, node: Node) -> LightSum {
    return LightSum(sum.sun, diffuse_node(sum.diffuse, ray, node), sum.on);
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    return RayLight(sun_single(sum.sun, ray, seen, lights.sun),
        ray.species.albedo * diffuse_light(sum.diffuse, seen, lights));
}
