// Light of sky, horizon and ground, by how well a point conducts each (`lib/eddington`): from the
// volume of optical depth up, down and aside.
// @use eddington sunlight

@group(2) @binding(4) var sky_volume: texture_3d<f32>;

// Conductances from a point up, to the four sides together, and down.
fn conductances_at(g: f32, p: vec3f) -> vec3f {
    let depths = textureSampleLevel(sky_volume, linear, light_box_coordinate(light.sky, p), 0.0).rgb;
    return diffuse_conductances(g, depths);
}

// Weights of sky, horizon and ground in the source of their diffuse light; they sum to 1.
fn diffuse_weights(species: Species, p: vec3f) -> vec3f {
    count(MAP_READS, 1u);
    let conductances = conductances_at(species.asymmetry, p);
    let weights = diffuse_shares(conductances);
    if ABSORBING {
        return weights * diffuse_absorbed(species.albedo, species.asymmetry, conductances);
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
    return weighted_lights(sum * seen.share, lights);
}

// Nothing but the peak is taken as going straight on.
fn light_ahead(species: Species) -> f32 {
    return 0.0;
}
