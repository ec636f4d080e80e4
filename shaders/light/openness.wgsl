// Light of sky, horizon and ground, by how open a point is to each: from the volume of optical depth
// up, down and aside.
// @use eddington sunlight

@group(2) @binding(4) var sky_volume: texture_3d<f32>;

// Conductances from a point up, to the four sides together, and down.
fn openness_at(g: f32, p: vec3f) -> vec3f {
    let depths = textureSampleLevel(sky_volume, linear, light_box_coordinate(light.sky, p), 0.0).rgb;
    return vec3f(diffuse_conductance(g, depths.x), 4.0 * diffuse_conductance(g, depths.z), diffuse_conductance(g, depths.y));
}

// Weights of sky, horizon and ground in the source of their diffuse light; they sum to 1.
fn diffuse_weights(species: Species, p: vec3f) -> vec3f {
    count(MAP_READS, 1u);
    let open = openness_at(species.asymmetry, p);
    let weights = open / (open.x + open.y + open.z);
    if ABSORBING {
        // Back from the largest conductance to the smallest optical depth.
        let nearest = diffuse_depth(species.asymmetry, max(open.x, open.z));
        return weights * absorbed(species.albedo, species.asymmetry, nearest);
    }
    return weights;
}

// Sum of such weights, grown by those of a node.
fn diffuse_node(sum: vec3f, ray: LightRay, node: Node) -> vec3f {
    if !SKY_LIGHT {
        return sum;
    }
    return sum + node.seen * diffuse_weights(ray.species, light_ray_at(ray, node.t));
}

// The light of such weights.
fn diffuse_light(sum: vec3f, seen: RaySeen, lights: Lights) -> vec3f {
    let weights = sum * seen.share;
    return weights.x * lights.sky + weights.y * lights.horizon + weights.z * lights.ground;
}
