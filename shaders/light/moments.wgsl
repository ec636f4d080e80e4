// Moments of the light in the cloud, solved for on a grid, and light that keeps its direction but for
// small angles in closed form, which follows from the optical depth to the sun.
// @use field harmonics slab sunlight

// Moments of the sun's light, per unit of it, and of red, green and blue of sky and ground.
@group(2) @binding(4) var sun_field: texture_3d<f32>;
@group(2) @binding(5) var sky_field: texture_3d<f32>;
// What they leave out, by scattering angle and optical depth.
@group(2) @binding(6) var remainder: texture_2d<f32>;

struct LightSum {
    sun: SunSum,
    multiple: vec3f,
    diffuse: vec3f,
}

fn light_begin(ray: LightRay) -> LightSum {
    return LightSum();
}

fn light_reads_nodes() -> bool {
    return true;
}

fn light_piece(sum: LightSum, piece: LitPiece) -> LightSum {
    return LightSum(sun_piece(sum.sun, piece), sum.multiple, sum.diffuse);
}

fn light_node(sum: LightSum, ray: LightRay, node: Node) -> LightSum {
    let inside = field_inside(light.field_low, light.field_scale, light_ray_at(ray, node.t));
    var diffuse = sum.diffuse;
    let multiple = sum.multiple + node.seen * source_of_sun(ray, inside, node.depth.x);
    if SKY_LIGHT {
        diffuse += node.seen * source_of_sky(ray, inside);
    }
    return LightSum(sum.sun, multiple, diffuse);
}

// Source of sunlight scattered more than once, per unit of irradiance.
fn source_of_sun(ray: LightRay, inside: vec3f, depth: f32) -> vec3f {
    count(MAP_READS, 2u);
    let after = -ray.direction;
    let solved = harmonics_low_sum(textureSampleLevel(sun_field, linear, inside, 0.0), after);
    let at = vec2f(phase_coordinate(-ray.to_sun, after), slab_path_coordinate(depth));
    let beyond = textureSampleLevel(remainder, linear, at, 0.0).rgb;
    return max(vec3f(solved) + beyond, vec3f(0.0));
}

// Source of the light of sky and ground.
fn source_of_sky(ray: LightRay, inside: vec3f) -> vec3f {
    count(MAP_READS, 3u);
    let layers = f32(textureDimensions(sky_field).z);
    var source = vec3f(0.0);
    for (var i = 0u; i < 3u; i++) {
        let at = field_coordinate(inside, layers, i, 3u);
        source[i] = harmonics_low_sum(textureSampleLevel(sky_field, linear, at, 0.0), -ray.direction);
    }
    return max(source, vec3f(0.0));
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    let multiple = scattered_again(ray.species, lights.sun, sum.multiple * seen.share, sum.diffuse * seen.share);
    return RayLight(sun_single(sum.sun, ray, seen, lights.sun), multiple);
}
