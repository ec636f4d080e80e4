// What models of slabs share that find light at nodes: single scattering, and the model's own
// `multiple_source`, which is sunlight scattered more than once, per unit of irradiance.
// @use slab_maps

alias LightSum = SlabSum;

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
    let own = max(node.depth.x - node.depth.y, 0.0);
    let source = multiple_source(ray, light_ray_at(ray, node.t), own, node.depth.y);
    let diffuse = diffuse_node(sum.diffuse, ray, node);
    return LightSum(sum.sun, sum.multiple + node.seen * source, diffuse);
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    return slab_ray(sum, ray, seen, lights);
}
