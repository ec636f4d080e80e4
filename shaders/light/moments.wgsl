// Light in the cloud solved for on a grid, as the eye sees it, and light that keeps its direction but for
// small angles in closed form, which follows from the optical depth to the sun.
// @use field field_view flash ray_seen shade slab sunlight

// What each cell scatters towards the eye: of the sun's light, per unit of it, to first order in the
// direction; of sky and ground, red, green and blue.
@group(2) @binding(4) var sun_field: texture_3d<f32>;
@group(2) @binding(5) var sky_field: texture_3d<f32>;
// What it leaves out, by scattering angle and optical depth.
@group(2) @binding(6) var remainder: texture_2d<f32>;

struct LightSum {
    sun: SunSum,
    multiple: vec3f,
    diffuse: vec3f,
    // A flash's own light is not seen, nor solved for, but that which droplets scatter by their peak, as good as straight
    // on, is: how far ahead it is, and what is seen of the ray before it.
    flash_ahead: f32,
    before_flash: f32,
}

fn light_begin(ray: LightRay) -> LightSum {
    return LightSum(SunSum(), vec3f(0.0), vec3f(0.0), dot(light.flash.xyz - ray.origin, ray.direction), 0.0);
}

fn light_reads_nodes() -> bool {
    return true;
}

// As on the grid.
fn light_ahead(species: Species) -> f32 {
    return species.ahead;
}

fn light_piece(sum: LightSum, piece: LitPiece) -> LightSum {
    return LightSum(sun_piece(sum.sun, piece), sum.multiple, sum.diffuse, sum.flash_ahead, before_flash(sum, piece));
}

fn light_node(sum: LightSum, ray: LightRay, node: Node) -> LightSum {
    let inside = field_inside(light.field_low, light.field_scale, light_ray_at(ray, node.t));
    var diffuse = sum.diffuse;
    let multiple = sum.multiple + node.seen * source_of_sun(ray, inside, node);
    if SKY_LIGHT {
        diffuse += node.seen * source_of_sky(ray, inside);
    }
    return LightSum(sum.sun, multiple, diffuse, sum.flash_ahead, sum.before_flash);
}

fn before_flash(sum: LightSum, piece: LitPiece) -> f32 {
    return select(sum.before_flash, piece.gathered + piece.seen, FLASH && piece.t < sum.flash_ahead);
}

fn source_of_sky(ray: LightRay, inside: vec3f) -> vec3f {
    if !REPEATS {
        count(MAP_READS, 1u);
        return textureSampleLevel(sky_field, linear, inside, 0.0).rgb;
    }
    count(MAP_READS, 3u);
    let low = harmonics_low(-ray.direction);
    var light = vec3f(0.0);
    for (var i = 0u; i < 3u; i++) {
        light[i] = dot(tile_texel(sky_field, inside, i, 3u), low);
    }
    return max(light, vec3f(0.0));
}

fn tile_texel(volume: texture_3d<f32>, inside: vec3f, number: u32, count: u32) -> vec4f {
    let texels = vec3f(textureDimensions(volume));
    return textureSampleLevel(volume, linear, field_tile_place(texels, inside, number, count), 0.0);
}

// What was solved for of the sun's light, towards a direction.
fn solved_of_sun(inside: vec3f, after: vec3f) -> f32 {
    if !REPEATS {
        count(MAP_READS, 1u);
        return expanded(textureSampleLevel(sun_field, linear, inside, 0.0), after);
    }
    count(MAP_READS, 4u);
    var moments = array<vec4f, 4>();
    for (var i = 0u; i < 4u; i++) {
        moments[i] = tile_texel(sun_field, inside, i, 4u);
    }
    return max(harmonics_sum(moments, after), 0.0);
}

// Source of sunlight scattered more than once, per unit of irradiance.
fn source_of_sun(ray: LightRay, inside: vec3f, node: Node) -> vec3f {
    count(MAP_READS, 1u);
    let after = -ray.direction;
    let thickness = 1.0 / light.field_scale.y;
    let below = thickness * saturate(1.0 - inside.y);
    let deep = light.mean_free_path * abs(ray.to_sun.y);
    let solved = solved_of_sun(inside, after) * shade_diffuse(light_ray_at(ray, node.t), thickness, below, deep);
    let at = vec2f(phase_coordinate(-ray.to_sun, after), slab_path_coordinate(node.depth.x));
    let beyond = textureSampleLevel(remainder, linear, at, 0.0).rgb;
    return max(vec3f(solved) + beyond, vec3f(0.0));
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    // What of the sky's light goes straight on from behind is scattered all the same.
    let diffuse = sum.diffuse * seen.share * opacity_ratio(seen, transported(ray.species));
    var multiple = scattered_again(ray.species, lights.sun, sum.multiple * seen.share);
    if FLASH {
        let kept = transported(ray.species) * (1.0 - light_ahead(ray.species));
        let glow = flash_along(light.flash, ray.origin, ray.direction);
        multiple += lights.sun * glow * flash_forward(1.0 - sum.before_flash, kept);
    }
    return RayLight(sun_single(sum.sun, ray, seen, lights.sun), multiple, ray.species.albedo * diffuse);
}
